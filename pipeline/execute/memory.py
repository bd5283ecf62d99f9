"""Memory that is not needed any more, and how rarely Python looks for it while there is work."""

import ctypes
import gc
from collections.abc import Iterator
from contextlib import contextmanager, suppress

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
