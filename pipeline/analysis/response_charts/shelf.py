"""Where charts are kept: a few in memory, and, where a folder is given, all that were built, from night to night."""

import logging
from collections import OrderedDict
from collections.abc import Callable, Collection, Iterator, Set
from concurrent.futures import Future
from contextlib import contextmanager
from pathlib import Path
from threading import Lock, local
from time import perf_counter

from pipeline.analysis.response_charts.chart_cache import keep, prune, recall
from pipeline.analysis.response_charts.histories import Histories
from pipeline.analysis.response_charts.response_chart import ResponseChart
from pipeline.records import ChartAxis

logger = logging.getLogger(__name__)

KEPT = 64
"""Charts held in memory, of about 0.2 MB each; the one that was asked for longest ago goes first."""


class Shelf:
    """Charts by identity; threads that want the same one at once wait for one of them to build it.

    folder   : where charts are kept from one process to the next; None: in memory only
    admitted : names of the groups of parameters that charts are built for where there is a choice, so that what is
               looked up does not hang on who asked before; None: whatever is there, or pays for those who ask
    """

    def __init__(self, folder: Path | None = None, kept: int = KEPT, *, admitted: Set[str] | None = None) -> None:
        self._folder, self._kept, self._admitted = folder, kept, admitted
        self._remembered = local()
        self._lock = Lock()
        self._charts: OrderedDict[str, Future[ResponseChart]] = OrderedDict()

    @property
    def histories(self) -> Histories | None:
        """Those that this thread takes over and keeps (see `remembering`): others may work on other objects at once."""
        found: Histories | None = getattr(self._remembered, "histories", None)
        return found

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
                if found is not None:
                    logger.debug("response chart %s: read from %s", key, self._folder)
                else:
                    since = perf_counter()
                    found = build()
                    logger.info(
                        "response chart %s: built of %d analyses in %.2f s",
                        key, found.cells.nodes, perf_counter() - since,
                    )  # fmt: skip
                    if self._folder is not None:
                        keep(self._folder, key, found)
                chart.set_result(found)
            except BaseException as problem:
                with self._lock:
                    self._charts.pop(key, None)
                chart.set_exception(problem)
                raise
        return chart.result()

    @contextmanager
    def remembering(self, file: Path | None) -> Iterator[None]:
        """Take over the histories that are kept in a file, and keep there those that are used until the end.

        file : None: until the end only
        """
        self._remembered.histories = histories = Histories(file)
        try:
            yield
            histories.keep()
        finally:
            del self._remembered.histories

    def pays(self, group: str, key: str, axis: ChartAxis, asking: int, least: int) -> bool:
        """Say whether a chart is to be used by some who could be integrated too.

        group  : what they have in common, whatever the motion
        asking : how many they are;  least : of how many it pays to build one, where nothing else decides
        """
        if self._admitted is not None:
            # Neither what the shelf holds nor who asks together has a say: who works on what may differ.
            return group in self._admitted
        return asking >= least or self.has(key, axis)

    def has(self, key: str, axis: ChartAxis) -> bool:
        """Say whether the chart of that identity need not be built."""
        with self._lock:
            if key in self._charts:
                return True
        # What is found is kept in memory, so that it is read once.
        found = None if self._folder is None else recall(self._folder, key, axis)
        if found is None:
            return False
        self.get(key, axis, lambda: found)
        return True

    def tidy(self, *, days: float, most_bytes: int, using: Collection[str] = ()) -> None:
        """Remove from the folder what `prune` removes; what is in memory stays."""
        if self._folder is not None:
            prune(self._folder, days=days, most_bytes=most_bytes, using=using)


SHELF = Shelf()
"""The charts of this process, for a caller who brings no shelf."""
