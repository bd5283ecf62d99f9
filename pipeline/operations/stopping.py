"""Ctrl-C and SIGTERM: a command ends within a second or two, whatever it is at.

Python hands a signal to the main thread only between two of its steps, and waits for all threads before it ends: a
kernel that is being compiled, or a chart that is being built, would hold a command for half a minute.  So a thread of
its own listens too, and ends the process where the main thread has not done so in time.  That is as safe as a kill.
"""

import os
import signal
import socket
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import Any

GRACE = 1.0
"""Seconds that the main thread has for ending in good order."""

_SIGNALS = (signal.SIGINT, signal.SIGTERM)

_WORDS = {
    signal.SIGINT: "it was stopped by hand (Ctrl-C)",
    signal.SIGTERM: "it was told to end (SIGTERM), as when a service or the machine is stopped",
}


class Stopped(KeyboardInterrupt):
    """Somebody stopped the command.

    Attributes
    ----------
    exit_code : int
        128 and the signal's number, as a shell has it.
    """

    def __init__(self, number: int) -> None:
        super().__init__(_WORDS.get(signal.Signals(number), "it was stopped"))
        self.exit_code = 128 + number


def _raise(number: int, _frame: FrameType | None) -> None:
    raise Stopped(number)


@contextmanager
def _handled(handler: Callable[[int, FrameType | None], Any]) -> Iterator[None]:
    before = {number: signal.signal(number, handler) for number in _SIGNALS}
    try:
        yield
    finally:
        for number, one in before.items():
            signal.signal(number, signal.SIG_DFL if one is None else one)


def _signals_come_here() -> bool:
    return threading.current_thread() is threading.main_thread()


@contextmanager
def stoppable(last_words: Callable[[Stopped], None]) -> Iterator[None]:
    """Let Ctrl-C and SIGTERM raise `Stopped` in the block, and end the process GRACE seconds later at the latest.

    In a thread other than the main one, which no signal reaches, nothing is done.

    Parameters
    ----------
    last_words : callable
        Called by another thread where the process is ended because the main thread did not come to it.

    Yields
    ------
    None

    Raises
    ------
    Stopped
        In the block, where a signal comes.
    """
    if not _signals_come_here():
        yield
        return
    reader, writer = socket.socketpair()
    writer.setblocking(False)
    before = signal.set_wakeup_fd(writer.fileno(), warn_on_full_buffer=False)
    threading.Thread(target=_listen, args=(reader, last_words), daemon=True).start()
    try:
        with _handled(_raise):
            yield
    finally:
        signal.set_wakeup_fd(before)
        writer.close()


def _listen(reader: socket.socket, last_words: Callable[[Stopped], None]) -> None:
    with reader:
        number = 0
        while number not in _SIGNALS:
            told = reader.recv(1)
            if not told:
                return  # The block is over, and no signal came.
            number = told[0]
    with suppress(BaseException):
        print("kouros: stopped", file=sys.stderr, flush=True)
    # The block may be over meanwhile, and the process wait for its threads.
    threading.Event().wait(GRACE)
    with suppress(BaseException):
        last_words(Stopped(number))
    with suppress(BaseException):
        if sys.__stderr__ is not None and sys.__stderr__.isatty():
            print("\x1b[?25h", end="", file=sys.__stderr__)  # A progress bar hides the cursor.
        sys.stdout.flush()
        sys.stderr.flush()
    os._exit(128 + number)


@contextmanager
def uninterrupted() -> Iterator[None]:
    """Let no signal of these cut the block, which takes a moment: what comes meanwhile comes too late.

    `stoppable` ends the process all the same if it has not ended soon.
    """
    if not _signals_come_here():
        yield
        return
    with _handled(lambda _number, _frame: None):
        yield
