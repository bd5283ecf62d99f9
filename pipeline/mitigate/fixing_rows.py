"""Rows of fixings.csv: what one piece of a fixing holds, and which materials it harms."""

from collections.abc import Mapping
from functools import cache
from typing import Annotated, Literal

from pydantic import BeforeValidator, Field, ValidationInfo, field_validator

from pipeline.errors import InputError
from pipeline.tables import table
from pipeline.tables.assumed import assumed
from pipeline.tables.rows import Entries, Number, TableRow, Text, checked, in_order, once

NotBelow0 = Annotated[Number, Field(ge=0.0)]


def _sizes(cell: object) -> object:
    return tuple(float(each) for each in cell.split("|") if each.strip()) if isinstance(cell, str) else cell


def _counts(cell: object) -> object:
    return tuple(int(each) for each in cell.split("|")) if isinstance(cell, str) else cell


class FixingStrength(TableRow):
    """A row of fixings.csv: a fixing that is to be had, and what it holds.

    Attributes
    ----------
    fixing : str
        Name of its measure.
    piece : str
        What one piece of it is.
    sizes : tuple of float
        Diameters of a piece [m] that may be taken, smallest first; empty where the piece has the one size.
    pieces : tuple of int
        How many of them may be taken, fewest first; at least three hold in every direction.
    tension, shear : float
        What it bears away from what it is fixed to, and along that, with ``_low`` and ``_high``, in `unit`.
    unit : {"Pa", "N"}
        Of a strength for the area of each piece, or of the force on one piece.
    factor : float
        How many times what is needed it must hold at least, all by the best estimates [-].
    harms, care_for : tuple of str
        Rows of materials.csv that it harms, and those on which it needs care.
    care : str
        What that care is, in words.
    source : str
        Who says so.
    """

    fixing: Text
    piece: Text
    sizes: Annotated[tuple[Annotated[float, Field(gt=0.0, lt=1.0)], ...], BeforeValidator(_sizes)]
    pieces: Annotated[tuple[Annotated[int, Field(gt=0)], ...], BeforeValidator(_counts), Field(min_length=1)]
    tension: NotBelow0
    tension_low: NotBelow0
    tension_high: NotBelow0
    shear: NotBelow0
    shear_low: NotBelow0
    shear_high: NotBelow0
    unit: Literal["Pa", "N"]
    factor: Annotated[Number, Field(ge=1.0, le=10.0)]
    harms: Entries
    care_for: Entries
    care: str
    source: Text

    @field_validator("tension_high", "shear_high")
    @classmethod
    def _in_order(cls, high: float, info: ValidationInfo) -> float | None:
        kind = (info.field_name or "").removesuffix("_high")
        return in_order(high, info, f"{kind}_low", kind)

    @field_validator("unit")
    @classmethod
    def _sized(cls, unit: str, info: ValidationInfo) -> str:
        if (unit == "Pa") is not bool(info.data.get("sizes")):
            raise InputError("is 'Pa' where sizes are given, and 'N' where none are: a strength needs an area")
        return unit

    @field_validator("harms", "care_for")
    @classmethod
    def _known(cls, materials: tuple[str, ...]) -> tuple[str, ...]:
        strange = next((name for name in materials if name not in assumed().materials), None)
        if strange is not None:
            raise InputError(f"names {strange!r}, which is no material; see materials.csv")
        return materials


@cache
def fixing_strengths() -> Mapping[str, FixingStrength]:
    """Return the rows of fixings.csv by the name of their fixing.

    Raises
    ------
    TableError
        Naming file, line, column and remedy.
    """
    rows = table("fixings")
    once([row["fixing"] for row in rows], "fixing", "fixings.csv")
    return {row.fixing: row for row in checked(FixingStrength, rows, "fixings.csv", named="fixing")}
