"""How a refused motion is told."""

from pathlib import Path
from typing import ClassVar


class MotionError(ValueError):
    """A record or a manifest that Kouros refuses to assess anything with.

    The message names the file, the place in it (key path, component, sample), what is wrong and what mends it.
    """

    exit_code: ClassVar[int] = 4


def refusal(file: Path, place: str, wrong: str, remedy: str) -> MotionError:
    """Return the error, so that every refusal reads alike: file: place: what is wrong; remedy."""
    return MotionError(f"{file}: {place}: {wrong}; {remedy}")
