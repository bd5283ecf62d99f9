"""The run context: motions, rules and settings that all tasks of a run share; it goes once to each worker."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import Any

from pipeline.analysis.context import Context, remembered
from pipeline.analysis.house.matching import HouseRules
from pipeline.analysis.response_charts import ChartCache
from pipeline.analysis.response_charts.charts import CommonHistories
from pipeline.analysis.rule_table import RuleTable
from pipeline.cache import Cache, key_of
from pipeline.execute import Threads
from pipeline.mitigate import MeasureCatalogue
from pipeline.mitigate.isolation import TransmittedMotions
from pipeline.models.band import sharing_spectra
from pipeline.models.common import share_among
from pipeline.night.floors import Floor
from pipeline.night.stocks import StockTerms
from pipeline.records import (
    Motion,
    RunRecord,
    Sampling,
)
from pipeline.report.files.page_renderer import PageRenderer
from pipeline.report.language import language
from pipeline.report.units import Units
from pipeline.settings import Analysis


@dataclass
class RunContext:
    """What everything that is done in a run shares.

    Attributes
    ----------
    head : RunRecord
        The run without its objects: its motions and its charts, what pages say of it.
    floors : mapping of str to Floor
        The floors by name.
    sampling : Sampling
        How probabilities are found; no samples: they are not.
    surveyed, fragile : bool
        Whether to find out what is worth measuring, and from what shaking objects fail.
    house : HouseRules or None
        The museum's house rules.
    stores : bool
        Whether what is not on display is assessed too.
    admitted : frozenset of str or None
        Which response charts are built (see `response_charts.ChartCache`); None: those that pay.
    kept : Path or None
        Folder of the cache; None: in memory only.
    threads : int
        Of one who works.
    stock : StockTerms or None
        What an earthquake's answer needs of each page rests on; None: it is not kept.
    """

    head: RunRecord
    floors: Mapping[str, Floor]
    analysis: Analysis
    sampling: Sampling
    rules: RuleTable | None
    measures: MeasureCatalogue
    surveyed: bool
    fragile: bool
    house: HouseRules | None = None
    stores: bool = False
    admitted: frozenset[str] | None = None
    kept: Path | None = None
    threads: int = 1
    units: Units = field(default_factory=Units)
    tongue: str = "en"
    catalogues: Path | None = None
    paper: str = "A4"
    stock: StockTerms | None = None

    def __getstate__(self) -> dict[str, Any]:
        # What was made on the way is made again where it is needed.
        made = {"charts", "transmitted", "renderer", "executor", "common"}
        return {name: value for name, value in self.__dict__.items() if name not in made}

    @property
    def motions(self) -> dict[str, Motion]:
        """The motions in use, by hash."""
        return motions_of(self.floors)

    @cached_property
    def charts(self) -> ChartCache:
        """The response charts."""
        return ChartCache(self.kept, admitted=self.admitted)

    @contextmanager
    def working(self, batch: tuple[object, ...] | None) -> Iterator[Context]:
        """Lend what an analysis of some objects works with; nobody is told how far a part of a night is.

        Parameters
        ----------
        batch
            What the histories of what is worked on together are kept under from night to night; None: they are not.
        """
        cache = None if self.kept is None else Cache(self.kept)
        kept = None if batch is None else cache
        with sharing_spectra(cache), remembered(kept, key_of(*batch or ()), self.common) as histories:
            yield Context(self.executor, charts=self.charts, histories=histories)

    @cached_property
    def common(self) -> CommonHistories:
        """Histories that batches of this process share."""
        return {}

    @cached_property
    def transmitted(self) -> TransmittedMotions:
        """What isolators pass on, once for all objects."""
        return TransmittedMotions()

    @cached_property
    def executor(self) -> Threads:
        """Where the parts of the work run."""
        threads = Threads(self.threads)
        share_among(threads.workers)
        return threads

    @cached_property
    def renderer(self) -> PageRenderer:
        """What draws the pages.

        Raises
        ------
        ReportError
            For a language without a catalogue.
        """
        return PageRenderer(
            self.head, self.units, language(self.tongue, self.catalogues), self.paper, bool(self.sampling.samples)
        )


def motions_of(floors: Mapping[str, Floor]) -> dict[str, Motion]:
    """Return the motions of some floors by hash; one that several share is there once."""
    return {m.motion.hash: m.motion for floor in floors.values() for level in floor.levels for m in level.motions}
