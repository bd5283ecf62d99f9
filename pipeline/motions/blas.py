"""The same digits whatever the number of cores: what is summed by BLAS is summed on one thread."""

from collections.abc import Iterator
from contextlib import contextmanager
from threading import Lock

from threadpoolctl import threadpool_limits

_lock = Lock()
_within: list[threadpool_limits] = []
_depth = [0]


@contextmanager
def one_thread() -> Iterator[None]:
    """Keep BLAS to one thread meanwhile, on all threads of this process; also a decorator.

    OpenBLAS parts a long sum among its threads: the straight line that is taken off a record came out with other last
    digits on two cores than on one, a slide under it with others from the tenth digit on, and everything that is kept
    by the motion's hash was worked out again.  The last to leave gives the threads back.
    """
    with _lock:
        if not _depth[0]:
            _within.append(threadpool_limits(limits=1, user_api="blas"))
        _depth[0] += 1
    try:
        yield
    finally:
        with _lock:
            _depth[0] -= 1
            if not _depth[0]:
                _within.pop().restore_original_limits()
