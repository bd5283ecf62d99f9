"""The sets of one call of a kernel, shared by threads: kernels release the lock, and no set knows of another.

Parts end where lanes do, and kernels put only equals side by side: what is found is the same, bit for bit, on any
number of threads.
"""

import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from itertools import pairwise

from pipeline.kernels.lanes import LANES

WORTH = 200_000
"""Sets times samples below which handing a part on may cost more than it saves: about a millisecond of work, where
threads cost a tenth of one. They live as long as the call, so that a process that is to be forked has none."""

TURNS = 4
"""Parts for each thread: some sets take far longer than others."""

_threads = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def share_among(threads: int) -> None:
    """Share the calls of this process among so many threads; 1: each runs where it was made."""
    global _threads  # noqa: PLW0603 - of the whole process, as its cores are
    _threads = max(1, threads)


def shared(run: Callable[[slice], None], sets: int, samples: int, together: int = LANES) -> None:
    """Run a kernel on all sets, in parts that threads share.

    Parameters
    ----------
    run : callable
        Runs it on some of the sets.
    sets, samples : int
        How many there are, and of how many samples the motion is.
    together : int
        How many the kernel works on side by side.
    """
    blocks = -(-sets // together)
    parts = min(TURNS * _threads, blocks)
    if _threads < 2 or parts < 2 or sets * samples < WORTH:
        run(slice(0, sets))
        return
    ends = [min(sets, together * (blocks * part // parts)) for part in range(parts + 1)]
    # Whoever is free takes the next.
    waiting = iter([slice(*pair) for pair in pairwise(ends)])

    def take() -> None:
        for part in waiting:
            run(part)

    with ThreadPoolExecutor(min(_threads, parts) - 1, thread_name_prefix="kernel") as pool:
        others = [pool.submit(take) for _ in range(min(_threads, parts) - 1)]
        take()
    for other in others:
        other.result()
