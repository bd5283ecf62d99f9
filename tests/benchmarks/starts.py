"""How long the command takes to start: with an empty cache of machine code, and with a full one.

Processor seconds beside seconds on the wall: on a machine that is busy with something else only the first can be
compared, and they too grow by half.  A cold start of two-directional sliding takes 7 s of the processor on
such a machine: most is numba's own Python, in proportion to the operations in a kernel's source, and an eighth the
optimiser of LLVM; nothing is compiled twice.  Most of a warm start is numba's as well: it loads scipy.linalg, and with
a kernel of one line it takes 1.0 s of the 1.2.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time

from pipeline.resources import resource as bundled

COLD, WARM = 6.0, 1.5
"""Seconds on the wall aimed at, of an idle machine."""

ROUNDS = 3
"""Warm starts of which the fastest counts."""

WORDS = {
    "rocking": ("rocking", "half_width=0.1", "cg_height=0.4"),
    "sliding, one direction": ("sliding", "friction_static=0.1", "directions=1"),
    "sliding, two directions": ("sliding", "friction_static=0.1"),
    "swing": ("swing", "length=0.5", "damping=0.02"),
    "swing_3d": ("swing_3d", "length=0.5", "damping=0.02"),
    "oscillator": ("oscillator", "frequency=2", "damping=0.05"),
}


def clocked(words: tuple[str, ...], cache: str) -> tuple[float, float]:
    """Return the seconds of the processor and on the wall of one `kouros respond`."""
    program = "from pipeline.cli import main; main()"
    before, began = resource.getrusage(resource.RUSAGE_CHILDREN), time.perf_counter()
    subprocess.run(
        [sys.executable, "-c", program, "respond", *words],
        check=True,
        stdout=subprocess.DEVNULL,
        cwd=bundled("schemas").parent,
        env={**os.environ, "NUMBA_CACHE_DIR": cache},
    )
    took, after = time.perf_counter() - began, resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, took


def starts() -> None:
    """Print the cost of a first and of a later `kouros respond` of each model, its motion kept."""
    print(f"kouros respond, one object, whole process; aims on the wall: cold {COLD:g} s, warm {WARM:g} s")
    print(f"{'model':<38}{'cold: processor s':>20}{'wall s':>10}{'warm: processor s':>20}{'wall s':>10}")
    for title, words in WORDS.items():
        with tempfile.TemporaryDirectory() as cache:
            first = clocked(words, cache)
            later = min(clocked(words, cache) for _ in range(ROUNDS))
        cells = "".join(f"{used:>20.2f}{took:>10.2f}" for used, took in (first, later))
        print(f"{title:<38}{cells}", flush=True)
