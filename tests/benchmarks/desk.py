"""The desk under 50 clients at once: how long a page takes, and whether any is lost.

KOUROS_BENCH_FOLDER names the folder of a museum with a run behind it, of any size; it is only looked at.
KOUROS_BENCH_CLIENTS how many clients there are (50), KOUROS_BENCH_PAGES how many pages each asks for (40), and
KOUROS_BENCH_PAUSE how many seconds each reads a page before the next (0: none, harder than people are).
"""

from __future__ import annotations

import os
import random
import time
from concurrent.futures import ThreadPoolExecutor
from http.client import HTTPConnection, HTTPException
from pathlib import Path
from statistics import median, quantiles
from urllib.parse import urlencode, urlsplit

import psutil
import pyarrow.parquet as pq

from tests.desk.visiting import Visitor, desk


def desk_load() -> None:
    """Print median and 95th percentile of the time of a page, how many were lost, and what the desk computed."""
    folder = Path(os.environ["KOUROS_BENCH_FOLDER"])
    clients, pages = int(os.environ.get("KOUROS_BENCH_CLIENTS", "50")), int(os.environ.get("KOUROS_BENCH_PAGES", "40"))
    pause = float(os.environ.get("KOUROS_BENCH_PAUSE", "0"))
    listed = pq.read_table(folder / "reports" / "latest" / "objects.parquet", columns=["object_number", "title"])
    objects = listed.to_pylist()
    with desk(folder) as address:
        Visitor(address).get("/")
        Visitor(address).get("/errands")
        serving = next(one for one in psutil.Process().children() if "serve" in one.cmdline())
        spent = _processor(serving)

        def visit(seed: int) -> list[tuple[float, int]]:
            draw, browser, found = random.Random(seed), _Browser(address), list[tuple[float, int]]()
            for _ in range(pages):
                one = draw.choice(objects)
                words = (one["title"] or "vase").split()[:1]
                began = time.perf_counter()
                status = (
                    browser.get("/", q=words[0] if words else "1") if draw.random() < 0.4
                    else browser.get("/object", number=one["object_number"])
                )  # fmt: skip
                found.append((time.perf_counter() - began, status))
                time.sleep(pause * draw.random() * 2)
            return found

        began = time.perf_counter()
        with ThreadPoolExecutor(clients) as pool:
            seen = [one for some in pool.map(visit, range(clients)) for one in some]
        took, spent = time.perf_counter() - began, _processor(serving) - spent
    times = [1e3 * seconds for seconds, _ in seen]
    lost = sum(status != 200 for _, status in seen)
    load = os.getloadavg()[0]
    print(
        f"{len(objects):,} objects, {clients} clients, {len(seen):,} pages in {took:.1f} s, pause {pause:g} s: median "
        f"{median(times):.0f} ms, 95 % {quantiles(times, n=20)[-1]:.0f} ms, {lost} lost; the desk's processor "
        f"{1e3 * spent / len(seen):.1f} ms a page; load {load:.1f}"
    )


class _Browser:
    """Somebody's browser: keeps its connection open between two pages, as all do, and its cookie."""

    def __init__(self, address: str) -> None:
        parts = urlsplit(address)
        self._connection = HTTPConnection(parts.hostname or "", parts.port, timeout=30)
        self._cookie = ""

    def get(self, path: str, **query: str) -> int:
        """Ask for a page, read all of it, and return its status."""
        for again in (False, True):
            try:
                self._connection.request("GET", f"{path}?{urlencode(query)}", headers={"Cookie": self._cookie})
                answer = self._connection.getresponse()
                answer.read()
            except (HTTPException, OSError):
                # The server ended it while its user read: a browser opens another one, once.
                self._connection.close()
                if again:
                    return 0
                continue
            self._cookie = (answer.headers["set-cookie"] or self._cookie).partition(";")[0]
            return answer.status
        return 0


def _processor(process: psutil.Process) -> float:
    """Return the seconds that a process has computed so far."""
    spent = process.cpu_times()
    return float(spent.user + spent.system)


if __name__ == "__main__":
    desk_load()
