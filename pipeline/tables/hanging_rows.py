"""Rows of the tables of what hangs on a wall: hangings.csv and usual_hangings.csv."""

from functools import cache
from typing import Annotated, Any

from pydantic import ValidationInfo, field_validator

from pipeline.errors import InputError
from pipeline.records import Hanging
from pipeline.tables import Range, table
from pipeline.tables.rows import Entries, Number, Optional, TableRow, Text, YesNo, checked, in_order, one_each

Ways = Annotated[tuple[Hanging, ...], Entries.__metadata__[0]]
"""A cell with ways to hang, parted by `|`."""


class HangingRow(TableRow):
    """A row of hangings.csv: one way to hang on a wall.

    Attributes
    ----------
    hanging, title : Hanging, str
        Which way, and in words.
    swings, lifts_off : bool
        Whether it swings in the plane of its wall, and whether it may be lifted off.
    hook_depth, hook_height, strength, amplification : float, with _low and _high
        Depth of its hooks [m], which there is where it may be lifted off; their height above the centre of gravity as a
        share of the work's height, what the hangers bear and by how much their load is magnified, in weights [-].
    source : str
        Who says so.
    """

    hanging: Hanging
    title: Text
    swings: YesNo
    lifts_off: YesNo
    hook_depth: Optional
    hook_depth_low: Optional
    hook_depth_high: Optional
    hook_height: Number
    hook_height_low: Number
    hook_height_high: Number
    strength: Number
    strength_low: Number
    strength_high: Number
    amplification: Number
    amplification_low: Number
    amplification_high: Number
    source: Text

    @field_validator("hook_depth_high", "hook_height_high", "strength_high", "amplification_high")
    @classmethod
    def _in_order(cls, high: float | None, info: ValidationInfo) -> float | None:
        stem = str(info.field_name).removesuffix("_high")
        if high is None and info.data.get("lifts_off"):
            raise InputError("is empty; of what may be lifted off the hooks have a depth")
        return in_order(high, info, f"{stem}_low", stem)

    def range(self, column: str) -> Range:
        """Return value, low and high of a column."""
        given: dict[str, Any] = self.model_dump()
        return Range(given[column], given[f"{column}_low"], given[f"{column}_high"], self.source)


class UsualHanging(TableRow):
    """A row of usual_hangings.csv: in which ways works of a class usually hang.

    Attributes
    ----------
    object_class : str
        Row of classes.csv; "*" for every other one.
    larger_than : float
        Largest side from which it holds [m]; of several rows that hold the one of the largest counts.
    hangings : tuple of Hanging
        The likeliest first.
    source : str
        Who says so.
    """

    object_class: Text
    larger_than: Number
    hangings: Ways
    source: Text


@cache
def hanging_rows() -> dict[Hanging, HangingRow]:
    """Return the ways to hang.

    Raises
    ------
    TableError
        For a cell that cannot be used, naming it, and for a way without a row.
    """
    rows = checked(HangingRow, table("hangings"), "hangings.csv", named="hanging")
    return one_each(rows, Hanging, "hanging", "hangings.csv", "way to hang")


@cache
def usual_hangings() -> tuple[UsualHanging, ...]:
    """Return how works of each class usually hang.

    Raises
    ------
    TableError
        For a cell that cannot be used, naming it.
    """
    return checked(UsualHanging, table("usual_hangings"), "usual_hangings.csv", named="object_class")
