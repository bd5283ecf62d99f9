"""What a night costs at the size of the collection: first, unchanged, one object changed, one motion changed.

KOUROS_BENCH_SIZES names the numbers of objects, KOUROS_BENCH_MOTIONS how many of the eleven motions shake them,
KOUROS_BENCH_SPREAD by how much copies of one real record differ (0.05; none: not at all), see `museum` for more;
KOUROS_BENCH_FOLDER where everything is written (tens of gigabytes for half a million objects).
"""

import os
import re
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from itertools import pairwise
from math import log
from pathlib import Path

from tests.benchmarks.museum import PGA, Museum, museum

SIZES, MOTIONS, FOLDER = "KOUROS_BENCH_SIZES", "KOUROS_BENCH_MOTIONS", "KOUROS_BENCH_FOLDER"
SPREAD = "KOUROS_BENCH_SPREAD"


@dataclass(frozen=True)
class Cost:
    """Of one run: seconds, seconds of processors, megabytes of its largest process, exit code."""

    wall: float
    cpu: float
    peak: float
    code: int


def scale() -> None:
    """Print the table, and with what power of the number of objects the first night grows."""
    sizes = [int(size) for size in os.environ.get(SIZES, "1000,10000").split(",")]
    motions, spread = int(os.environ.get(MOTIONS, len(PGA))), float(os.environ.get(SPREAD, "0"))
    print(f"copies of a record differ by {spread:.0%}; {os.cpu_count()} cores; seconds")
    print(f"{motions} motions of 20,000 samples, three components")
    print(f"{'objects':>9} {'night':<24}{'wall':>8}{'cpu':>9}{'ms/object':>11}{'peak MB':>9}{'exit':>6}")
    first = {}
    with tempfile.TemporaryDirectory() as temporary:
        for size in sizes:
            made = museum(Path(os.environ.get(FOLDER) or temporary) / str(size), size, motions=motions, spread=spread)
            first[size] = _tell(size, "first", made)
            _tell(size, "unchanged", made)
            _change_object(made)
            _tell(size, "one object changed", made)
            _change_motion(made)
            _tell(size, "one motion changed", made)
    for small, large in pairwise(sizes):
        power = log(first[large].cpu / first[small].cpu) / log(large / small)
        print(f"from {small:,} to {large:,} objects the first night's cpu grows with the power {power:.2f}")


def _tell(size: int, what: str, made: Museum) -> Cost:
    cost = _run(made)
    print(
        f"{size:>9,} {what:<24}{cost.wall:>8.1f}{cost.cpu:>9.1f}{1e3 * cost.cpu / size:>11.2f}{cost.peak:>9,.0f}"
        f"{cost.code:>6}",
        flush=True,
    )
    return cost


def _run(made: Museum) -> Cost:
    start = time.perf_counter()
    process = subprocess.Popen(
        [sys.executable, "-c", "from pipeline.cli import main; main()", "-q", "--config", str(made.settings), "run"],
        stdout=subprocess.DEVNULL,
    )
    _, status, used = os.wait4(process.pid, 0)
    wall = time.perf_counter() - start
    # The processes that it started are counted with it, once they have ended.
    return Cost(wall, used.ru_utime + used.ru_stime, used.ru_maxrss / 1e3, os.waitstatus_to_exitcode(status))


def _change_object(made: Museum) -> None:
    lines = made.collection.read_text(encoding="utf-8").splitlines(keepends=True)
    at = next(i for i in range(len(lines) // 2, len(lines)) if lines[i].startswith("X."))
    lines[at] = re.sub(r",Gallery (\d+),[\d.]+,", r",Gallery \1,1.234,", lines[at])
    made.collection.write_text("".join(lines), encoding="utf-8")


def _change_motion(made: Museum) -> None:
    manifest = made.site / "manifest.toml"
    text = manifest.read_text(encoding="utf-8")
    manifest.write_text(text.replace("[[level.record]]\n", "[[level.record]]\nscale = 1.01\n", 1), encoding="utf-8")
