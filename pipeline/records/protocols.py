"""Protocols of what lower floors are handed from above: the executor of work, and the progress that is told."""

from __future__ import annotations

from collections.abc import Callable, Sequence
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
