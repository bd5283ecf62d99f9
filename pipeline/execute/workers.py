"""Worker pools in general: results in the order of the tasks, bounded work ahead of them, and their errors."""

from __future__ import annotations

import ctypes
import gc
import logging
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import contextmanager, suppress
from time import perf_counter
from typing import Protocol, TypeVar

from pipeline.errors import KourosError

logger = logging.getLogger(__name__)

Shared = TypeVar("Shared")
Task = TypeVar("Task")
Result = TypeVar("Result")
_Result_co = TypeVar("_Result_co", covariant=True)

AHEAD = 2
"""Tasks that are handed out for each worker at a time: nobody waits, and memory stays bounded by them."""

DEATHS = 3
"""Workers that may die of one task before it is given up."""


class PoolError(KourosError):
    """The workers cannot be reached, or die of a task."""

    exit_code = 1


class MissingClusterError(PoolError):
    """The settings name a Dask cluster, and Dask is not installed."""

    exit_code = 2


class WorkerPool(Protocol):
    """Runs a function on many tasks."""

    @property
    def workers(self) -> int:
        """How many tasks are worked on at a time."""
        ...

    def each(self, work: Callable[[Shared, Task], Result], shared: Shared, tasks: Iterable[Task]) -> Generator[Result]:
        """Yield what the function returns for each task, in the order of the tasks.

        Parameters
        ----------
        work : callable
            A function at the top of a module, which workers can import.
        shared : object
            The first argument of every call; it goes to each worker once.
        tasks : iterable
            The second argument of each call; read no more than `AHEAD` tasks a worker ahead of the results.

        Raises
        ------
        PoolError
            Where `DEATHS` workers died of one task.
        Exception
            Whatever a task raises, when it is that task's turn.
        """
        ...


class Pending(Protocol[_Result_co]):
    """A result that is being worked on, of the standard library or of Dask."""

    def result(self) -> _Result_co:
        """Wait for the result."""
        ...


def in_order(
    submit: Callable[[Task], Pending[Result]], tasks: Iterable[Task], ahead: int, waiting: deque[Pending[Result]]
) -> Generator[Result]:
    """Yield the results of tasks in their order, with a bounded number of them handed out.

    Parameters
    ----------
    submit : callable
        Hands a task out.
    tasks : iterable
        Read as far as tasks are handed out.
    ahead : int
        Tasks that are handed out and whose results were not yet taken, at most.
    waiting : deque
        Holds those tasks, so that the caller can drop them at the end.
    """
    began, count = perf_counter(), 0
    for task in tasks:
        waiting.append(submit(task))
        count += 1
        if len(waiting) >= ahead:
            yield _first(waiting)
    while waiting:
        yield _first(waiting)
    logger.info("%d tasks done in %.2f s", count, perf_counter() - began)


def _first(waiting: deque[Pending[Result]]) -> Result:
    result = waiting[0].result()
    waiting.popleft()
    return result


RARELY = (100_000, 20, 50)
"""How often Python looks for garbage that refers to itself, as `gc.set_threshold` takes it, while there is work."""


@contextmanager
def collecting_rarely() -> Iterator[None]:
    """Look for garbage that refers to itself `RARELY` within the block.

    What a task makes stays to its end: to look for garbage in it every 700 objects takes an eighth of the time.
    """
    before = gc.get_threshold()
    gc.set_threshold(*RARELY)
    try:
        yield
    finally:
        gc.set_threshold(*before)


MANY = 5_000
"""Objects from which on a piece of work leaves enough behind to be looked for: a look takes up to half a second."""


def give_back(objects: int) -> None:
    """Give the system back what was freed, after a piece of work of another size than what follows.

    Reading half a million records leaves 660 MB with the process, of which it uses 290.  Where the C library cannot be
    asked, nothing happens.

    Parameters
    ----------
    objects : int
        Of so many the work was; below `MANY` nothing happens.
    """
    if objects < MANY:
        return
    gc.collect()
    with suppress(OSError, AttributeError):
        ctypes.CDLL(None).malloc_trim(0)
