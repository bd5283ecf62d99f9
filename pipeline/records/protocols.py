"""What lower floors are handed from above: where work runs, and who is told how far it is."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Protocol, TypeVar

Task = TypeVar("Task")
Answer = TypeVar("Answer")


class Executor(Protocol):
    """Where independent pieces of work run, on so many workers."""

    workers: int

    def map(self, work: Callable[[Task], Answer], tasks: Sequence[Task]) -> list[Answer]:
        """Run the work on each task and return the answers in the order of the tasks."""
        ...


class Progress(Protocol):
    """Tells the person who waits how far the work is."""

    def step(self, what: str, done: int, total: int) -> None:
        """Report that ``done`` of ``total`` pieces of ``what`` are finished."""
        ...


class Silent:
    """Progress of work that is a part of another's: nobody is told of it."""

    def step(self, what: str, done: int, total: int) -> None:
        """Say nothing."""
