"""A thread that writes one file while the rest of a report goes on."""

from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import ParamSpec

Given = ParamSpec("Given")


class Behind:
    """Does one thing after the other; at most one waits, so that memory is bounded.

    What went wrong with one thing is raised where the next is handed over, or at the end.
    """

    def __init__(self) -> None:
        self._hand = ThreadPoolExecutor(1)
        self._last: Future[None] | None = None

    def do(self, work: Callable[Given, None], *given: Given.args, **named: Given.kwargs) -> None:
        """Hand something over; wait for what was handed over before."""
        self.wait()
        self._last = self._hand.submit(work, *given, **named)

    def wait(self) -> None:
        """Wait until everything is done.

        raises : what that raised
        """
        last, self._last = self._last, None
        if last is not None:
            last.result()

    def close(self) -> None:
        """Send the thread home, whatever became of what it was given."""
        self._hand.shutdown()
