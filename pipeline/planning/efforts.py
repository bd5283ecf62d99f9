"""Effort of each measure: hours, cost and trade, Kouros's own or a museum's."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal, get_args

from pydantic import Field, ValidationInfo, field_validator

from pipeline.mitigate import MeasureCatalogue
from pipeline.mitigate.catalogue import own_catalogue
from pipeline.mitigate.measures.anchor import Anchor
from pipeline.mitigate.measures.remove import LAST_RESORTS, Remove
from pipeline.tables import Row, TableError, read_table, table
from pipeline.tables.rows import Number, TableRow, Text, checked, in_order, once

Trade = Literal["handler", "mount-maker", "engineer"]
"""Who does the work: those who handle objects, those who make mounts, and engineers with the makers of furniture."""

TRADES: tuple[str, ...] = get_args(Trade)

OTHER = "other"
"""The row of a measure that has none of its own and is like none that has one."""

VISIT = "visit"
"""The row of setting out in a gallery, once for all that is done there."""

_FILE = "efforts.csv"

Amount = Annotated[Number, Field(ge=0.0)]
Share = Annotated[Number, Field(ge=0.0, le=1.0)]


@dataclass(frozen=True, slots=True)
class EffortSpan:
    """An amount with its range: what is expected, and between which ends it lies."""

    value: float = 0.0
    low: float = 0.0
    high: float = 0.0

    def __add__(self, other: "EffortSpan") -> "EffortSpan":
        """Return the sum of both, each end with its like: as if all turned out so together."""
        return EffortSpan(self.value + other.value, self.low + other.low, self.high + other.high)


class EffortRow(TableRow):
    """A row of efforts.csv: what a measure takes.

    Attributes
    ----------
    measure : str
        Its name in the catalogue of measures, or `OTHER`, or `VISIT`.
    trade : str
        One of `TRADES`.
    hours, hours_low, hours_high : float
        Hours of work on the first object of an errand, of all who work together [h].
    hours_further : float
        Share of these that each further object in the same case takes [-].
    cost, cost_low, cost_high : float
        Material and outside work for the first object, in the museum's currency.
    cost_further : float
        Share of this that each further object costs [-].
    source : str
        Who says so.
    """

    measure: Text
    trade: Trade
    hours: Amount
    hours_low: Amount
    hours_high: Amount
    hours_further: Share
    cost: Amount
    cost_low: Amount
    cost_high: Amount
    cost_further: Share
    source: Text

    @field_validator("measure")
    @classmethod
    def _known(cls, name: str, info: ValidationInfo) -> str:
        known: Sequence[str] = () if info.context is None else info.context["measures"]
        if name not in known:
            raise ValueError(f"is {name!r}, which is no measure; use one of {', '.join(known)}")
        return name

    @field_validator("hours_high")
    @classmethod
    def _hours_in_order(cls, high: float, info: ValidationInfo) -> float | None:
        return in_order(high, info, "hours_low", "hours")

    @field_validator("cost_high")
    @classmethod
    def _cost_in_order(cls, high: float, info: ValidationInfo) -> float | None:
        return in_order(high, info, "cost_low", "cost")

    def hours_of(self, objects: int) -> EffortSpan:
        """Return the hours of an errand for some objects."""
        times = 1.0 + (objects - 1) * self.hours_further
        return EffortSpan(times * self.hours, times * self.hours_low, times * self.hours_high)

    def cost_of(self, objects: int) -> EffortSpan:
        """Return the cost of an errand for some objects."""
        times = 1.0 + (objects - 1) * self.cost_further
        return EffortSpan(times * self.cost, times * self.cost_low, times * self.cost_high)


@dataclass(frozen=True)
class Efforts:
    """What every measure of a museum takes.

    Parameters
    ----------
    rows : mapping of str to EffortRow
        By name of the measure; `OTHER` and `VISIT` are among them.
    titles : mapping of str to str
        Of the measures, as their table has them.
    away : tuple of str
        Names of the measures that take an object from view.
    """

    rows: Mapping[str, EffortRow]
    titles: Mapping[str, str] = field(default_factory=dict)
    away: tuple[str, ...] = LAST_RESORTS

    def of(self, measure: str) -> EffortRow:
        """Return the row of a measure; of one that nobody told the effort of, that of `OTHER`."""
        return self.rows.get(measure, self.rows[OTHER])

    @property
    def visit(self) -> EffortRow:
        """What setting out in a gallery takes."""
        return self.rows[VISIT]

    @property
    def anchor(self) -> str:
        """Name of the measure that fastens furniture."""
        return Anchor.name


def efforts(path: Path | None = None, catalogue: MeasureCatalogue | None = None) -> Efforts:
    """Return what the measures of a museum take.

    A row of the museum's takes the place of Kouros's of the same name.  A measure of the museum's own without a row
    takes what the measure takes that it is like, and one of another package without a row what `OTHER` takes.

    Parameters
    ----------
    path : Path, optional
        A CSV file with the columns of tables/efforts.csv.
    catalogue : MeasureCatalogue, optional
        The museum's measures; Kouros's own where it is left out.

    Returns
    -------
    Efforts

    Raises
    ------
    TableError
        Naming file, line, column and remedy.
    FileNotFoundError
    """
    have = catalogue or own_catalogue()
    names = tuple(dict.fromkeys((*(one.row.name for one in have.measures), OTHER, VISIT)))
    known = tuple(dict.fromkeys((*names, *(one.row.name for one in own_catalogue().measures))))
    rows = {row.measure: row for row in _read(table("efforts"), _FILE, known)}
    if path is not None:
        rows |= {row.measure: row for row in _read(read_table(path), path.name, known)}
    for one in have.measures:
        rows.setdefault(one.row.name, rows.get(one.row.like, rows[OTHER]))
    for name in LAST_RESORTS:
        rows.setdefault(name, rows[Remove.name])
    return Efforts(rows, {one.row.name: one.row.title for one in have.measures})


def _read(rows: Sequence[Row], file: str, known: Sequence[str]) -> tuple[EffortRow, ...]:
    if not rows:
        raise TableError(f"{file} has no rows; give it at least one, or leave its setting empty")
    found = checked(EffortRow, rows, file, named="measure", context={"measures": known})
    once([row.measure for row in found], "measure", file)
    return found
