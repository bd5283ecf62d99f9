"""What is kept of a model's responses: charts, in memory and in a folder, and histories row for row.

Histories that were run on an earlier night, row for row, so that one changed motion costs only its own.

What a history gives depends on the model, its parameters, the motion and how finely it is run, and on nothing else; a
night that must judge a sheet again because something changed finds here all that did not.
"""

import logging
from collections import OrderedDict
from collections.abc import Callable, Mapping, Set
from concurrent.futures import Future
from itertools import islice
from pathlib import Path
from threading import Lock
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.response_charts.response_chart import ResponseChart
from pipeline.cache import CHARTS, HISTORIES, Cache, CacheEntry
from pipeline.quantities import Array
from pipeline.records import ChartAxis, Columns

logger = logging.getLogger(__name__)

KEPT = 64
"""Charts held in memory, of about 0.2 MB each; the one that was asked for longest ago goes first."""


class ChartCache:
    """Charts by identity; threads that want the same one at once wait for one of them to build it.

    Parameters
    ----------
    folder : Path or None
        Of the cache that keeps charts and histories from one process to the next; None: in memory only.
    admitted : set of str or None
        Names of the groups of parameters that charts are built for where there is a choice, so that what is looked up
        does not hang on who asked before; None: whatever is there, or pays for those who ask.
    """

    def __init__(self, folder: Path | None = None, kept: int = KEPT, *, admitted: Set[str] | None = None) -> None:
        self._cache = None if folder is None else Cache(folder)
        self._kept, self._admitted = kept, admitted
        self._lock = Lock()
        self._charts: OrderedDict[str, Future[ResponseChart]] = OrderedDict()

    def get(self, key: str, axis: ChartAxis, build: Callable[[], ResponseChart]) -> ResponseChart:
        """Return the chart of an identity: from memory, from the folder, or built.

        Parameters
        ----------
        key
            The identity.
        axis
            The axis that the chart lies along.
        build
            Makes the chart; whoever asks for the same one meanwhile waits for it.

        Returns
        -------
        ResponseChart
            The chart, the same object for all who ask while it is in memory.
        """
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
                found = self._recalled(key, axis)
                if found is None:
                    since = perf_counter()
                    found = build()
                    logger.info(
                        "response chart %s: built of %d analyses in %.2f s",
                        key, found.cells.nodes, perf_counter() - since,
                    )  # fmt: skip
                    if self._cache is not None:
                        self._cache.put(CHARTS, key, found.kept())
                chart.set_result(found)
            except BaseException as problem:
                with self._lock:
                    self._charts.pop(key, None)
                chart.set_exception(problem)
                raise
        return chart.result()

    def _recalled(self, key: str, axis: ChartAxis) -> ResponseChart | None:
        kept = None if self._cache is None else self._cache.get(CHARTS, key)
        return None if kept is None else ResponseChart.of(axis, kept)

    def pays(self, group: str, key: str, axis: ChartAxis, asking: int, least: int) -> bool:
        """Say whether parameter sets that could be integrated are to be looked up in a chart.

        Parameters
        ----------
        group
            Name of what the sets have in common, whatever the motion.
        key, axis
            Of the chart, as in `get`.
        asking
            How many sets there are.
        least
            From how many sets on building a chart pays, where nothing else decides.

        Returns
        -------
        bool
            Whether the chart is to be used.
        """
        if self._admitted is not None:
            # Neither what the cache holds nor who asks together has a say: who works on what may differ.
            return group in self._admitted
        return asking >= least or self.has(key, axis)

    def has(self, key: str, axis: ChartAxis) -> bool:
        """Say whether the chart of that identity need not be built."""
        with self._lock:
            if key in self._charts:
                return True
        # What is found is kept in memory, so that it is read once.
        found = self._recalled(key, axis)
        if found is None:
            return False
        self.get(key, axis, lambda: found)
        return True


PROCESS_CHARTS = ChartCache()
"""The charts of this process, for a caller who brings no cache."""


COMMON = 300
"""Parameter sets of a model under a motion that are common to all who work in a process: of those that tables give,
such as a friction, there are few, and all objects share them."""

CommonHistories = dict[str, tuple[tuple[str, ...], dict[bytes, Array]]]
"""By key, the names of the columns and the histories by their parameters."""


class Histories:
    """The histories of what is worked on together: those that were kept, and those used or run now, to be kept.

    Parameters
    ----------
    cache : Cache, optional
        None: nothing is kept, and only what is asked for twice is run once.
    key : str, optional
        Under which they are kept together.
    common : CommonHistories, optional
        Those of this process that others who work ask for too.
    """

    def __init__(self, cache: Cache | None = None, key: str = "", common: CommonHistories | None = None) -> None:
        self._cache, self._key, self._common = cache, key, common
        self._old = {} if cache is None else _tables(cache.get(HISTORIES, key))
        self._places: dict[str, dict[bytes, int]] = {}
        self._used: dict[str, dict[bytes, Array]] = {}
        self._names: dict[str, tuple[str, ...]] = {}

    def recall(self, key: str, values: Mapping[str, Array]) -> tuple[NDArray[np.bool_], Columns]:
        """Return which rows are there, and the columns of those.

        Parameters
        ----------
        key : str
            Of everything but the parameters, see `pipeline.cache.key_of`.
        values : mapping of str to ndarray, shape (n,)
            The parameters, in SI; those that are not given are NaN.

        Returns
        -------
        there : ndarray of bool, shape (n,)
        columns : dict of str to ndarray, shape (there.sum(),)
        """
        rows = _rows(values)
        used = self._used.setdefault(key, {})
        if key in self._old:
            names, table = self._old[key]
            self._names[key] = names
            if key not in self._places:
                parameters = np.ascontiguousarray(table[:, : len(values)])
                self._places[key] = {row.tobytes(): at for at, row in enumerate(parameters)}
            places = self._places[key]
            used.update((row, table[places[row], len(values) :]) for row in rows if row in places and row not in used)
        if self._common is not None and key in self._common:
            names, common = self._common[key]
            self._names[key] = names
            used.update((row, common[row]) for row in rows if row not in used and row in common)
        there = np.array([row in used for row in rows], dtype=bool)
        if not there.any():
            return there, {}
        found = np.array([used[row] for row in rows if row in used])
        return there, {name: np.ascontiguousarray(found[:, i]) for i, name in enumerate(self._names[key])}

    def note(self, key: str, values: Mapping[str, Array], columns: Columns) -> None:
        """Take down histories that were run now.

        Parameters
        ----------
        key, values
            As in `recall`.
        columns : mapping of str to ndarray, shape (n,)
            What they gave.
        """
        self._names[key] = tuple(columns)
        table = np.column_stack([np.asarray(column, dtype=np.float64) for column in columns.values()])
        fresh = dict(zip(_rows(values), table, strict=True))
        self._used.setdefault(key, {}).update(fresh)
        if self._common is not None:
            _, common = self._common.setdefault(key, (self._names[key], {}))
            for row, told in islice(fresh.items(), max(0, COMMON - len(common))):
                common[row] = told

    def keep(self) -> None:
        """Keep what was used."""
        if self._cache is None:
            return
        used = {key: rows for key, rows in self._used.items() if rows}
        arrays = {}
        for number, rows in enumerate(used.values()):
            parameters = np.frombuffer(b"".join(rows), dtype=np.float64).reshape(len(rows), -1)
            arrays[str(number)] = np.hstack([parameters, np.array(list(rows.values()))])
        said = {"tables": [[key, *self._names[key]] for key in used]}
        self._cache.put(HISTORIES, self._key, CacheEntry(said, arrays))


def _rows(values: Mapping[str, Array]) -> list[bytes]:
    # Bit for bit, so that NaN (not given) equals NaN.
    matrix = np.ascontiguousarray(np.column_stack(list(values.values())), dtype=np.float64)
    return [row.tobytes() for row in matrix]


def _tables(kept: CacheEntry | None) -> dict[str, tuple[tuple[str, ...], Array]]:
    if kept is None:
        return {}
    return {key: (tuple(names), kept.arrays[str(at)]) for at, (key, *names) in enumerate(kept.said["tables"])}
