"""Rows of fills.csv: how much of its outline a thing of some materials fills, where its class alone says too much.

What is made of metal is sheet, cast hollow, or of rods: a silver bowl fills a fiftieth of what one of wood does.
"""

from collections.abc import Mapping
from functools import cache
from types import MappingProxyType
from typing import Annotated

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
    taller_than : float
        Height from which it holds [m]; of several rows that hold the one of the largest counts.
    fill, fill_low, fill_high : float
        Volume of the material over that of the outline [-].
    source : str
        Who says so.
    """

    object_class: Text = Field(alias="class")
    materials: Entries
    taller_than: Annotated[Number, Field(ge=0.0)]
    fill: Number
    fill_low: Number
    fill_high: Number
    source: Text

    @field_validator("fill_high")
    @classmethod
    def _shares(cls, high: float, info: ValidationInfo) -> float | None:
        return share_in_order(high, info, "fill_low", "fill", "outline")


@cache
def fills() -> Mapping[tuple[str, str], tuple[tuple[float, Range], ...]]:
    """Return how much of its outline a thing fills, by class and material, where fills.csv says it.

    Returns
    -------
    mapping of (str, str) to tuple of (float, Range)
        Heights from which on [m], the largest first, and shares [-].

    Raises
    ------
    TableError
        Naming the line of fills.csv.
    """
    rows = checked(FillRow, table("fills"), "fills.csv", named="class")
    each = [(row, material) for row in rows for material in row.materials]
    once((f"{row.object_class} of {name} from {row.taller_than:g} m on" for row, name in each), "class", "fills.csv")
    found: dict[tuple[str, str], list[tuple[float, Range]]] = {}
    for row, material in each:
        share = Range(row.fill, row.fill_low, row.fill_high, f"fills.csv ({row.source})")
        found.setdefault((row.object_class, material), []).append((row.taller_than, share))
    return MappingProxyType({key: tuple(sorted(some, key=lambda one: -one[0])) for key, some in found.items()})


def fill_of(object_class: str, material: str, height: float) -> Range | None:
    """Return how much of its outline a thing fills [-], None where its class alone says it.

    Parameters
    ----------
    object_class, material : str
        Rows of classes.csv and materials.csv.
    height : float
        [m], 0 where it is not recorded.
    """
    return next((share for above, share in fills().get((object_class, material), ()) if height >= above), None)
