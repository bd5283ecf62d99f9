"""What the workers of these tests are given to do; a module of its own, for they must be able to import it."""

import os
import time
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Shared:
    """What all errands share: a folder in which they leave marks."""

    folder: Path
    factor: int = 3


def product(shared: Shared, errand: int) -> tuple[int, int]:
    """Return the errand times the factor, and who did it."""
    return errand * shared.factor, os.getpid()


def dies_once(shared: Shared, errand: int) -> int:
    """End the worker without a word, as when memory runs out, the first time that errand 5 is done."""
    mark = shared.folder / "died"
    if errand == 5 and not mark.exists():
        mark.touch()
        os._exit(9)
    return errand * shared.factor


def dies(shared: Shared, errand: int) -> int:
    """End the worker whenever errand 2 is done."""
    if errand == 2:
        os._exit(9)
    return errand * shared.factor


def fails(shared: Shared, errand: int) -> int:
    """Raise at errand 4."""
    if errand == 4:
        raise ValueError("errand 4 cannot be done")
    return errand * shared.factor


def slow(shared: Shared, errand: int) -> int:
    """Leave a mark, and take a while."""
    (shared.folder / f"begun-{errand}").touch()
    time.sleep(0.3)
    return errand
