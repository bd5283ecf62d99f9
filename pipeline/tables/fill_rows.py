"""Rows of fills.csv: how much of its outline a thing of some materials fills, where its class alone says too much.

What is made of metal is sheet, cast hollow, or of rods: a silver bowl fills a fiftieth of what one of wood does.
"""

from collections.abc import Mapping
from functools import cache
from types import MappingProxyType

from pydantic import Field, ValidationInfo, field_validator

from pipeline.tables import Range, table
from pipeline.tables.rows import Entries, Number, TableRow, Text, checked, once, share_in_order


class FillRow(TableRow):
    """A row of fills.csv.

    Attributes
    ----------
    object_class : str
        Row of classes.csv.
    materials : tuple of str
        Rows of materials.csv.
    fill, fill_low, fill_high : float
        Volume of the material over that of the outline [-].
    source : str
        Who says so.
    """

    object_class: Text = Field(alias="class")
    materials: Entries
    fill: Number
    fill_low: Number
    fill_high: Number
    source: Text

    @field_validator("fill_high")
    @classmethod
    def _shares(cls, high: float, info: ValidationInfo) -> float | None:
        return share_in_order(high, info, "fill_low", "fill", "outline")


@cache
def fills() -> Mapping[tuple[str, str], Range]:
    """Return how much of its outline a thing fills, by class and material, where fills.csv says it.

    Returns
    -------
    mapping of (str, str) to Range
        [-].

    Raises
    ------
    TableError
        Naming the line of fills.csv.
    """
    rows = checked(FillRow, table("fills"), "fills.csv", named="class")
    pairs = [(row.object_class, material) for row in rows for material in row.materials]
    once((f"{name} of {material}" for name, material in pairs), "class", "fills.csv")
    found = [
        Range(row.fill, row.fill_low, row.fill_high, f"fills.csv ({row.source})") for row in rows for _ in row.materials
    ]
    return MappingProxyType(dict(zip(pairs, found, strict=True)))
