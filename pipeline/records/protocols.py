"""Protocols of what lower floors are handed from above: the executor, progress, and who is told of compiling.

Who wants to know that machine code is being compiled: that takes half a minute, once for each version.

Who asks need not load a compiler for it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from typing import Protocol, TypeVar

Task = TypeVar("Task")
Answer = TypeVar("Answer")


class Executor(Protocol):
    """Place where independent pieces of work run.

    Attributes
    ----------
    workers : int
        On how many at once.
    """

    workers: int

    def map(self, work: Callable[[Task], Answer], tasks: Sequence[Task]) -> list[Answer]:
        """Run the work on each task.

        Parameters
        ----------
        work : callable
            task -> answer.
        tasks : sequence
            What it is called with.

        Returns
        -------
        list
            The answers in the order of the tasks.
        """
        ...


class Progress(Protocol):
    """Tells the person who waits how far the work is."""

    def step(self, what: str, done: int, total: int) -> None:
        """Report how far a kind of work is.

        Parameters
        ----------
        what : str
            The work.
        done, total : int
            Pieces that are finished, and all.
        """
        ...


class Silent:
    """Progress of work that is a part of another's: nobody is told of it."""

    def step(self, what: str, done: int, total: int) -> None:
        """Say nothing."""


Listener = Callable[[int, int], None]
"""(functions that are compiled, functions that were begun): is called by whichever thread compiles."""

_LISTENERS: list[Listener] = []


@contextmanager
def told_of_compiling(listener: Listener) -> Iterator[None]:
    """Let a listener be told, in the block, of every function whose compilation begins or ends in this process.

    Parameters
    ----------
    listener : callable
        See `Listener`; what is loaded from the cache of compiled code is not told.

    Yields
    ------
    None
    """
    _LISTENERS.append(listener)
    try:
        yield
    finally:
        _LISTENERS.remove(listener)


def tell_of_compiling(done: int, begun: int) -> None:
    """Tell all listeners how many functions were compiled in this process, of how many begun."""
    for listener in tuple(_LISTENERS):
        listener(done, begun)
