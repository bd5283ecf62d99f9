"""Surroundings of an analysis, on which its result does not depend: where it runs, who is told, what is kept."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace

from pipeline.analysis.response_charts import PROCESS_CHARTS, ChartCache
from pipeline.analysis.response_charts.charts import CommonHistories, Histories
from pipeline.cache import Cache
from pipeline.records import Executor, Progress, Silent

_SILENT = Silent()


@dataclass(frozen=True)
class Context:
    """Where an analysis runs, who is told how far it is, and what was computed before.

    Attributes
    ----------
    executor : Executor
        Where independent pieces of work run.
    progress : Progress
        Who is told.
    charts : ChartCache
        Where response charts are found and kept; those of this process where none are given.
    histories : Histories or None
        Those run before, which are taken over, and where those run now are noted; None: all are run.  It belongs to one
        batch of objects: other batches at the same time have their own.
    """

    executor: Executor
    progress: Progress = _SILENT
    charts: ChartCache = PROCESS_CHARTS
    histories: Histories | None = None

    @property
    def silent(self) -> "Context":
        """The same for a part of the work, of which nobody is told."""
        return replace(self, progress=_SILENT)


@contextmanager
def remembered(cache: Cache | None, key: str, common: CommonHistories | None = None) -> Iterator[Histories]:
    """Lend the histories that are kept under a key, and keep there those that are used until the end.

    Parameters
    ----------
    cache
        That keeps them; None: nothing is kept, and only what is asked for twice is run once.
    key
        Of what is worked on together.
    common
        The histories of this process that others who work ask for too; None: each batch runs its own.

    Yields
    ------
    Histories
        For the `Context` of one batch of objects.  Nothing is kept where the work on it fails.
    """
    histories = Histories(cache, key, common)
    yield histories
    histories.keep()
