"""What the workers of these tests are given to do; a module of its own, for they must be able to import it."""

import os
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Shared:
    """What all tasks share: a folder in which they leave marks."""

    folder: Path
    factor: int = 3


def product(shared: Shared, task: int) -> tuple[int, int]:
    """Return the task times the factor, and who did it."""
    return task * shared.factor, os.getpid()


def dies_once(shared: Shared, task: int) -> int:
    """End the worker without a word, as when memory runs out, the first time that task 5 is done."""
    mark = shared.folder / "died"
    if task == 5 and not mark.exists():
        mark.touch()
        os._exit(9)
    return task * shared.factor


def dies(shared: Shared, task: int) -> int:
    """End the worker whenever task 2 is done."""
    if task == 2:
        os._exit(9)
    return task * shared.factor


def runs_out(shared: Shared, task: int) -> int:
    """Run out of memory, the first time that task 5 is done."""
    mark = shared.folder / "full"
    if task == 5 and not mark.exists():
        mark.touch()
        raise MemoryError
    return task * shared.factor


def fails(shared: Shared, task: int) -> int:
    """Raise at task 4."""
    if task == 4:
        raise ValueError("task 4 cannot be done")
    return task * shared.factor


def slow(shared: Shared, task: int) -> int:
    """Leave a mark, and take a while."""
    (shared.folder / f"begun-{task}").touch()
    time.sleep(0.3)
    return task


def given_up(_shared: Shared, task: int) -> int:
    """Raise what Dask raises of a task of which workers die, again and again."""
    from types import SimpleNamespace

    from distributed import KilledWorker

    raise KilledWorker(f"task {task}", SimpleNamespace(address="tcp://127.0.0.1:9", name=0), 3)


def calls(_shared: Shared, task: Callable[..., float]) -> float:
    """Call a function of Kouros with nothing that it can read."""
    return task(None, "value", "here")


class OddError(Exception):
    """Can be pickled, but not be made again of that."""

    def __init__(self, one: str, two: str) -> None:
        super().__init__(f"{one} and {two}")


def fails_oddly(_shared: Shared, task: int) -> int:
    """Raise what no other process can make again."""
    raise OddError("this", str(task))


def unsendable(_shared: Shared, _task: int) -> object:
    """Return what no other process can be given."""
    return lambda: None


def threads(_shared: Shared, _task: int) -> set[int]:
    """Return how many threads the libraries of linear algebra use."""
    import numpy as np
    from threadpoolctl import threadpool_info

    assert np.ones((2, 2)).any()
    return {library["num_threads"] for library in threadpool_info()}


def sleeps(shared: Shared, task: int) -> int:
    """Leave a mark with the number of the process, and take a minute."""
    aside = shared.folder / f"aside-{task}"
    aside.write_text(str(os.getpid()), encoding="utf-8")
    aside.rename(shared.folder / f"sleeps-{task}")
    time.sleep(60.0)
    return task
