"""What all sheets of a run share: it goes once to whoever works on them."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from hashlib import sha256
from pathlib import Path
from typing import Any

from pipeline.analysis.context import Context
from pipeline.analysis.response_charts import ChartCache
from pipeline.analysis.response_charts.histories import Histories
from pipeline.analysis.rules import Table
from pipeline.execute import Threads
from pipeline.mitigate import Means
from pipeline.mitigate.bench import Carriage
from pipeline.night.deduplication import Twins
from pipeline.night.floors import Storey
from pipeline.operations.workspace import HISTORIES
from pipeline.records import (
    Motion,
    RunRecord,
)
from pipeline.report.files.page_renderer import Pen
from pipeline.report.language import language
from pipeline.report.units import Units
from pipeline.settings import Analysis


@dataclass
class Brief:
    """What all sheets of a run share.

    head      : the run without its objects: its motions and its charts, what pages say of it
    storeys   : the floors by name
    surveyed, fragile : whether to find out what is worth measuring, and from what shaking objects fail
    stores    : whether what is not on display is assessed too
    admitted  : which response charts are built (see `response_charts.ChartCache`); None: those that pay for a sheet
    kept      : folder in which charts are kept; None: in memory only
    threads   : of one who works
    """

    head: RunRecord
    storeys: Mapping[str, Storey]
    analysis: Analysis
    rules: Table | None
    means: Means
    surveyed: bool
    fragile: bool
    stores: bool = False
    admitted: frozenset[str] | None = None
    kept: Path | None = None
    threads: int = 1
    units: Units = field(default_factory=Units)
    tongue: str = "en"
    catalogues: Path | None = None

    def __getstate__(self) -> dict[str, Any]:
        # What was made on the way is made again where it is needed.
        made = {"charts", "carriage", "pen", "executor", "twins"}
        return {name: value for name, value in self.__dict__.items() if name not in made}

    @property
    def motions(self) -> dict[str, Motion]:
        """The motions in use, by hash."""
        return motions_of(self.storeys)

    @cached_property
    def charts(self) -> ChartCache:
        """The response charts."""
        return ChartCache(self.kept, admitted=self.admitted)

    def memory(self, *batch: object) -> Path | None:
        """Return the file in which the histories of what is worked on together are kept from night to night.

        batch : what is the same every night, such as gallery and number of its sheets
        """
        if self.kept is None:
            return None
        name = repr(batch).encode("utf-8", "surrogatepass")
        return self.kept.parent / HISTORIES / f"{sha256(name).hexdigest()[:32]}.npz"

    @cached_property
    def carriage(self) -> Carriage:
        """What isolators pass on, once for all sheets."""
        return Carriage()

    @cached_property
    def twins(self) -> Twins:
        """What was found of objects that others may be like."""
        return Twins()

    @cached_property
    def executor(self) -> Threads:
        """Where the parts of a sheet's work run."""
        return Threads(self.threads)

    def working(self, histories: Histories) -> Context:
        """Return what an analysis of some objects works with; nobody is told how far a part of a night is.

        histories : of what is worked on together, which are taken over and noted
        """
        return Context(self.executor, charts=self.charts, histories=histories)

    @cached_property
    def pen(self) -> Pen:
        """What draws the sheets.

        raises : ReportError for a language without a catalogue
        """
        return Pen(self.head, self.units, language(self.tongue, self.catalogues))


def motions_of(storeys: Mapping[str, Storey]) -> dict[str, Motion]:
    """Return the motions of some floors by hash; one that several share is there once."""
    return {m.motion.hash: m.motion for storey in storeys.values() for level in storey.levels for m in level.motions}
