"""A thread that writes one file while the rest of a report goes on."""

from collections import deque
from collections.abc import Callable
from concurrent.futures import Future, ThreadPoolExecutor
from typing import ParamSpec

Given = ParamSpec("Given")

MOST = 1 << 23
"""Bytes that wait to be written, about."""


class Behind:
    """Does one thing after the other; what waits is bounded by the memory that it holds.

    What went wrong with one thing is raised where another is handed over, or at the end.
    """

    def __init__(self) -> None:
        self._hand = ThreadPoolExecutor(1)
        self._waiting: deque[tuple[Future[None], int]] = deque()
        self._held = 0

    def do(self, held: int, work: Callable[Given, None], *given: Given.args, **named: Given.kwargs) -> None:
        """Hand something over that holds so many bytes; wait where too many would wait."""
        while self._waiting and (self._waiting[0][0].done() or (held and self._held + held > MOST)):
            self._end()
        self._waiting.append((self._hand.submit(work, *given, **named), held))
        self._held += held

    def wait(self) -> None:
        """Wait until everything is done.

        raises : what that raised
        """
        while self._waiting:
            self._end()

    def _end(self) -> None:
        first, held = self._waiting.popleft()
        self._held -= held
        try:
            first.result()
        except BaseException:
            # Nothing that follows would lie where it belongs.
            while self._waiting:
                self._waiting.pop()[0].cancel()
            self._held = 0
            raise

    def close(self) -> None:
        """Send the thread home, whatever became of what it was given."""
        self._hand.shutdown()
