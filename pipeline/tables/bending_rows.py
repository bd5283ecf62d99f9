"""Rows of the tables of what bends: slender.csv, and bending.csv, whose numbers hold for all classes."""

from collections.abc import Mapping
from functools import cache
from types import MappingProxyType

from pydantic import Field, ValidationInfo, field_validator

from pipeline.tables import Range, table
from pipeline.tables.rows import NamedRange, Number, TableRow, Text, checked, named_ranges, once, share_in_order


class SlenderRow(TableRow):
    """A row of slender.csv: how much of an object of a class is about as slender as its critical section.

    Attributes
    ----------
    object_class : str
        Row of classes.csv.
    slender, slender_low, slender_high : float
        Share of its height above that section [-].
    source : str
        Who says so.
    """

    object_class: Text = Field(alias="class")
    slender: Number
    slender_low: Number
    slender_high: Number
    source: Text

    @field_validator("slender_high")
    @classmethod
    def _shares(cls, high: float, info: ValidationInfo) -> float | None:
        return share_in_order(high, info, "slender_low", "slender", "height")

    @property
    def range(self) -> Range:
        """The share with its range."""
        return Range(self.slender, self.slender_low, self.slender_high, f"slender.csv ({self.source})")


class BendingRow(NamedRange):
    """A row of bending.csv: a number that holds for whatever bends [-]."""


@cache
def slender_shares() -> Mapping[str, Range]:
    """Return how much of an object bends, by class; a class that bends in its joints or not at all has none.

    Returns
    -------
    mapping of str to Range

    Raises
    ------
    TableError
        Naming the line of slender.csv.
    """
    rows = checked(SlenderRow, table("slender"), "slender.csv", named="class")
    once((row.object_class for row in rows), "class", "slender.csv")
    return MappingProxyType({row.object_class: row.range for row in rows})


def bending(name: str) -> Range:
    """Return a number of bending.csv.

    Parameters
    ----------
    name : str
        "restraint", "damping" or "concentration".

    Returns
    -------
    Range
        [-].

    Raises
    ------
    TableError
        Naming the line of bending.csv.
    KeyError
        For another name.
    """
    return named_ranges(BendingRow, "bending")[name]
