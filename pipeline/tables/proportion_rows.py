"""Rows of proportions.csv: one size of an object over another one, by class."""

from functools import cache
from typing import Annotated, Literal

from pydantic import Field

from pipeline.tables import TableError, table
from pipeline.tables.assumed import assumed
from pipeline.tables.rows import RangeRow, Text, checked

Size = Literal["height", "width", "depth"]
"""A size of an object as it stands."""


class Proportion(RangeRow):
    """A row of proportions.csv: how many times one size another one is [-], the 5th, 50th and 95th percentile.

    Attributes
    ----------
    name : str
        Row of classes.csv.
    size, of : str
        Which size, and of which it is a multiple.
    above : float
        From which length [m] of the latter on: what is tall is more slender than what is small.
    known : int
        How many sizes have to be recorded for it to be assumed.
    value, low, high, source
        As of every range.
    """

    name: Text = Field(alias="class")
    size: Size
    of: Size
    low: Annotated[float, Field(gt=0.0, allow_inf_nan=False)]
    above: Annotated[float, Field(ge=0.0, allow_inf_nan=False)]
    known: Annotated[int, Field(ge=1, le=2)]


@cache
def proportions() -> dict[tuple[str, str], tuple[Proportion, ...]]:
    """Return the rows by class and by the size that they say something of, the narrowest first.

    Raises
    ------
    TableError
        For a row that cannot be used, one of a class that there is not, of a size as a multiple of itself, and two of
        the same pair.
    """
    rows = checked(Proportion, table("proportions"), "proportions.csv", named="class")
    out: dict[tuple[str, str], list[Proportion]] = {}
    seen = set()
    for line, row in enumerate(rows, start=2):
        if row.name not in assumed().classes:
            raise TableError(f"proportions.csv, line {line}: classes.csv has no class {row.name!r}; correct it")
        if row.size == row.of or (row.name, row.size, row.of, row.above) in seen:
            raise TableError(
                f"proportions.csv, line {line}: {row.size} of {row.of} is there twice or is of itself; keep one"
            )
        seen.add((row.name, row.size, row.of, row.above))
        out.setdefault((row.name, row.size), []).append(row)
    return {key: tuple(sorted(some, key=lambda row: row.high / row.low)) for key, some in out.items()}
