"""How long the command takes to start: with an empty cache of machine code, and with a full one.

Compiling is what a first start takes more than a later one, in seconds of the processor: on a machine that is busy with
something else only these can be compared, and they too vary by a third.  Most of it is numba's own Python, in
proportion to the operations in a kernel's source; most of a warm start is numba's as well, which with a kernel of one
line takes 1.0 s of the 1.2.
"""

import os
import resource
import subprocess
import sys
import tempfile
import time

from pipeline.resources import resource as bundled

COLD, WARM = 6.0, 1.5
"""Seconds aimed at: of compiling, and on the wall of a warm start."""

ROUNDS = 3
"""Starts of either kind of which the fastest counts."""

WORDS = {
    "rocking": ("rocking", "half_width=0.1", "cg_height=0.4"),
    "standing": ("standing", "half_width=0.1", "cg_height=0.4", "friction_static=0.4"),
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
    print(f"kouros respond, one object, whole process; aims: compiling {COLD:g} s, warm {WARM:g} s on the wall")
    print(f"{'model':<38}{'compiling s':>14}{'cold: wall s':>14}{'warm: wall s':>14}")
    for title, words in WORDS.items():
        first, later = [], []
        for _ in range(ROUNDS):
            with tempfile.TemporaryDirectory() as cache:
                first.append(clocked(words, cache))
                later.append(clocked(words, cache))
        (cold, began), (warm, took) = min(first), min(later)
        print(f"{title:<38}{cold - warm:>14.2f}{began:>14.2f}{took:>14.2f}", flush=True)
