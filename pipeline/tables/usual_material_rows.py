"""Rows of usual_materials.csv: what things are mostly made of, for their mass where nobody recorded a material."""

from __future__ import annotations

import re
from functools import cache
from typing import Annotated

from pydantic import Field, ValidationInfo, field_validator

from pipeline.tables import Range, table
from pipeline.tables.assumed import assumed
from pipeline.tables.assumed_rows import Material
from pipeline.tables.rows import Entries, Number, TableRow, Text, any_of, checked, in_order


class UsualMaterial(TableRow):
    """A row of usual_materials.csv, of which the first that holds counts.

    Attributes
    ----------
    object_class : str
        Row of classes.csv.
    words : tuple of str
        In an object's name or title; () for any.
    taller_than : float
        Height from which it holds [m].
    material : str
        Row of materials.csv.
    density_low, density_high : float
        Ends of the range [kg/m3]: wider than the material's own, for some things are of another.
    source : str
        Who says so.
    """

    object_class: Text = Field(alias="class")
    words: Entries
    taller_than: Annotated[Number, Field(ge=0.0)]
    material: Text
    density_low: Annotated[Number, Field(gt=0.0)]
    density_high: Number
    source: Text

    @field_validator("density_high")
    @classmethod
    def _in_order(cls, high: float, info: ValidationInfo) -> float | None:
        return in_order(high, info, "density_low", "density_low")

    @property
    def of(self) -> Material:
        """The row of materials.csv."""
        return assumed().materials[self.material]

    @property
    def density(self) -> Range:
        """What a cubic metre of it weighs [kg/m3]."""
        best = self.of.density_range.value
        return Range(best, self.density_low, self.density_high, f"usual_materials.csv ({self.source})")


@cache
def _rows() -> tuple[tuple[re.Pattern[str] | None, UsualMaterial], ...]:
    rows = checked(UsualMaterial, table("usual_materials"), "usual_materials.csv", named="class")
    return tuple((any_of(row.words) if row.words else None, row) for row in rows)


def usual_material(object_class: str, words: str, height: float) -> UsualMaterial | None:
    """Return what a thing of which nobody recorded the material is mostly made of; None where it may be anything.

    Parameters
    ----------
    object_class : str
        Row of classes.csv.
    words : str
        Its name and title.
    height : float
        [m], 0 where it is not recorded.
    """
    for pattern, row in _rows():
        named = pattern is None or pattern.search(words) is not None
        if row.object_class == object_class and height >= row.taller_than and named:
            return row
    return None
