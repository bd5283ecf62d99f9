"""Who wants to know that machine code is being compiled: that takes half a minute, once for each version.

Who asks need not load a compiler for it.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

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
