"""Where charts are kept: a few in memory, and, where a folder is given, all that were built, from night to night."""

import hashlib
import json
import os
from collections import OrderedDict
from collections.abc import Callable
from concurrent.futures import Future
from dataclasses import fields
from functools import cache
from pathlib import Path
from threading import Lock, get_ident
from typing import Any
from zipfile import BadZipFile

import numpy as np

from pipeline.charting.refine import Cells
from pipeline.charting.response_chart import ResponseChart
from pipeline.kernels import KERNEL_VERSION
from pipeline.records import ChartAxis

KEPT = 64
"""Charts held in memory, of about 0.2 MB each; the one that was asked for longest ago goes first."""


@cache
def _code() -> bytes:
    """What computes a chart besides the kernels, as one hash: models, records, charts and the search of directions."""
    digest = hashlib.sha256()
    package = Path(__file__).parents[1]
    for source in sorted(s for folder in ("charting", "models", "records") for s in (package / folder).glob("*.py")):
        digest.update(source.read_bytes())
    digest.update((package / "response.py").read_bytes())
    return digest.digest()


def chart_identity(**parts: object) -> str:
    """Return the identity of a chart: of the code, the kernels and all that it depends on besides."""
    digest = hashlib.sha256(_code())
    digest.update(KERNEL_VERSION.encode())
    digest.update(json.dumps(parts, sort_keys=True).encode())
    return digest.hexdigest()


class Shelf:
    """Charts by identity; threads that want the same one at once wait for one of them to build it.

    folder : where charts are kept from one process to the next; None: in memory only
    """

    def __init__(self, folder: Path | None = None, kept: int = KEPT) -> None:
        self._folder, self._kept = folder, kept
        self._lock = Lock()
        self._charts: OrderedDict[str, Future[ResponseChart]] = OrderedDict()

    def get(self, key: str, axis: ChartAxis, build: Callable[[], ResponseChart]) -> ResponseChart:
        """Return the chart of that identity: from memory, from the folder, or built."""
        with self._lock:
            chart = self._charts.get(key)
            mine = chart is None
            if chart is None:
                chart = self._charts[key] = Future()
            self._charts.move_to_end(key)
            while len(self._charts) > self._kept:
                self._charts.popitem(last=False)
        if mine:
            try:
                found = None if self._folder is None else recall(self._folder, key, axis)
                if found is None:
                    found = build()
                    if self._folder is not None:
                        keep(self._folder, key, found)
                chart.set_result(found)
            except BaseException as problem:
                with self._lock:
                    self._charts.pop(key, None)
                chart.set_exception(problem)
                raise
        return chart.result()


SHELF = Shelf()
"""The charts of this process, for a caller who brings no shelf."""

_CELLS = tuple(field.name for field in fields(Cells))


def keep(folder: Path, key: str, chart: ResponseChart) -> None:
    """Keep a chart, atomically; a folder that cannot be written only costs the next process its time."""
    said = {
        "key": key,
        "axis": chart.axis.name,
        "outputs": chart.outputs,
        "low": chart.low,
        "high": chart.high,
        "settled": chart.settled,
        "tolerance": chart.tolerance,
    }
    aside = folder / f".{os.getpid()}-{get_ident()}.npz"
    cells: dict[str, Any] = {name: np.asarray(getattr(chart.cells, name)) for name in _CELLS}
    try:
        folder.mkdir(parents=True, exist_ok=True)
        np.savez(aside, said=np.array(json.dumps(said)), **cells)
        aside.replace(folder / f"{key}.npz")
    except OSError:
        aside.unlink(missing_ok=True)


def recall(folder: Path, key: str, axis: ChartAxis) -> ResponseChart | None:
    """Return the chart that was kept under this very identity, or None; a damaged file counts as none."""
    try:
        with np.load(folder / f"{key}.npz", allow_pickle=False) as kept:
            said = json.loads(str(kept["said"]))
            if said["key"] != key or said["axis"] != axis.name:
                return None
            cells = Cells(**{name: kept[name] for name in _CELLS[:-1]}, nodes=int(kept["nodes"]))
            return ResponseChart(
                axis, tuple(said["outputs"]), said["low"], said["high"], said["settled"], said["tolerance"], cells
            )
    except (OSError, ValueError, KeyError, TypeError, EOFError, BadZipFile):
        return None
