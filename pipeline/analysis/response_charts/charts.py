"""The cache of response charts: a few in memory, and, where a folder is given, all that were built, run after run."""

import logging
from collections import OrderedDict
from collections.abc import Callable, Set
from concurrent.futures import Future
from pathlib import Path
from threading import Lock
from time import perf_counter

from pipeline.analysis.response_charts.response_chart import ResponseChart
from pipeline.cache import CHARTS, Cache
from pipeline.records import ChartAxis

logger = logging.getLogger(__name__)

KEPT = 64
"""Charts held in memory, of about 0.2 MB each; the one that was asked for longest ago goes first."""


class ChartCache:
    """Charts by identity; threads that want the same one at once wait for one of them to build it.

    folder   : of the cache that keeps charts and histories from one process to the next; None: in memory only
    admitted : names of the groups of parameters that charts are built for where there is a choice, so that what is
               looked up does not hang on who asked before; None: whatever is there, or pays for those who ask
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
