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
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from math import log
from pathlib import Path

import psutil

from tests.benchmarks.museum import PGA, Museum, museum

SIZES, MOTIONS, FOLDER = "KOUROS_BENCH_SIZES", "KOUROS_BENCH_MOTIONS", "KOUROS_BENCH_FOLDER"
SPREAD = "KOUROS_BENCH_SPREAD"


@dataclass(frozen=True)
class Cost:
    """Of one run: seconds, seconds of processors, megabytes of its largest process and of all (PSS), exit code.

    database : megabytes of the database after it;  load : of the machine, mean of the last minute, at its end
    """

    wall: float
    cpu: float
    peak: float
    whole: float
    database: float
    load: float
    code: int


def scale() -> None:
    """Print the table, and with what power of the number of objects the first night grows."""
    sizes = [int(size) for size in os.environ.get(SIZES, "1000,10000").split(",")]
    motions, spread = int(os.environ.get(MOTIONS, len(PGA))), float(os.environ.get(SPREAD, "0"))
    print(f"copies of a record differ by {spread:.0%}; {os.cpu_count()} cores; seconds")
    print(f"{motions} motions of 20,000 samples, three components")
    print(
        f"{'objects':>9} {'night':<24}{'wall':>8}{'cpu':>9}{'ms/object':>11}{'peak MB':>9}{'all MB':>8}"
        f"{'db MB':>7}{'load':>6}{'exit':>6}"
    )
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
        f"{cost.whole:>8,.0f}{cost.database:>7,.0f}{cost.load:>6.1f}{cost.code:>6}",
        flush=True,
    )
    return cost


def _run(made: Museum) -> Cost:
    start = time.perf_counter()
    process = subprocess.Popen(
        [sys.executable, "-c", "from pipeline.cli import main; main()", "-q", "--config", str(made.settings), "run"],
        stdout=subprocess.DEVNULL,
    )
    with _watched(process.pid) as peaks:
        _, status, used = os.wait4(process.pid, 0)
    wall = time.perf_counter() - start
    database = sum(file.stat().st_size for file in made.settings.parent.glob("kouros.sqlite*")) / 1e6
    # The processes that it started are counted with it, once they have ended.
    cpu = used.ru_utime + used.ru_stime
    code = os.waitstatus_to_exitcode(status)
    return Cost(wall, cpu, used.ru_maxrss / 1e3, max(peaks), database, os.getloadavg()[0], code)


@contextmanager
def _watched(pid: int) -> Iterator[list[float]]:
    """Measure while the block lasts, every half a second, the megabytes of a process and all that it started."""
    ended, peaks = threading.Event(), [0.0]

    def watch() -> None:
        while not ended.wait(0.5):
            peaks.append(_proportional(pid) / 1e6)

    thread = threading.Thread(target=watch)
    thread.start()
    try:
        yield peaks
    finally:
        ended.set()
        thread.join()


def _proportional(pid: int) -> int:
    """Return the bytes of a process and all below it, those that several share counted once (PSS)."""
    found = 0
    try:
        mine = psutil.Process(pid)
        for one in (mine, *mine.children(recursive=True)):
            found += one.memory_full_info().pss
    except psutil.Error:
        # One that ends while it is looked at.
        pass
    return found


def _change_object(made: Museum) -> None:
    lines = made.collection.read_text(encoding="utf-8").splitlines(keepends=True)
    at = next(i for i in range(len(lines) // 2, len(lines)) if lines[i].startswith("X."))
    lines[at] = re.sub(r",Gallery (\d+),[\d.]+,", r",Gallery \1,1.234,", lines[at])
    made.collection.write_text("".join(lines), encoding="utf-8")


def _change_motion(made: Museum) -> None:
    manifest = made.site / "manifest.toml"
    text = manifest.read_text(encoding="utf-8")
    manifest.write_text(text.replace("[[level.record]]\n", "[[level.record]]\nscale = 1.01\n", 1), encoding="utf-8")
