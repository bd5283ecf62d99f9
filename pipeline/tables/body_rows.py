"""Rows of bodies.csv: what is assumed of a thing more particularly than its class does, by its name and its size."""

import re
from collections.abc import Iterable
from functools import cache
from typing import Annotated, Literal

from pydantic import Field, ValidationInfo, field_validator

from pipeline.errors import InputError
from pipeline.tables import table
from pipeline.tables.assumed_rows import ObjectClass, Share
from pipeline.tables.rows import Entries, Number, TableRow, Text, YesNo, any_of, checked, in_order

PAIR = "pair"
"""Two bodies that stand on each other and are followed as one."""

STACK = "stack"
"""Stones that stand on each other and are followed as one."""

SCREEN = "screen"
"""A folding screen, of which its face weighs."""

STANDS = ("harness", "costume", "stand")
"""Stands of what cannot stand by itself, which are as deep as they have to be."""

ON_EDGE = ("panel", "slab")
"""What hangs by its class and stands on its edge, as deep as it is recorded."""

CYCLES = ("cycle", "cycle_of_parts", "motorcycle", "motorcycle_of_parts")
"""What stands on two wheels, and on no shelf."""

HELD = (
    *("wind", "stringed", "footwear", "frame", "wreath", "headpiece", "wall_clock", "leaded", "bell", "lump", "boat"),
    *("aircraft", "skeleton", "cycle", "cycle_of_parts"),
)
"""What weighs what its kind does, whether it stands, hangs or a mount holds it."""

_NUMBERS = (
    *(f"{kind}_{end}" for kind in ("cg", "base", "section") for end in ("ratio", "low", "high")),
    *("fill", "fill_low", "fill_high"),
)
_FOUND = ("cg", "base", "critical", "filled", "room")
_BY_RULE = "rule:"


class BodyRow(TableRow):
    """A row of bodies.csv.

    Attributes
    ----------
    body, title : str
        In tables, and in words.
    words : tuple of str
        In an object's name or title, where * is up to three words; "rule:" before the name of a rule of
        classification, * for any.
    classes, materials : tuple of str
        Of which it is; () for any.
    taller_than : float
        Height from which it holds [m].
    cg_ratio, base_ratio, section_ratio, fill : float or None
        As in classes.csv, with the ends of their ranges; of its base all bears that is within the range.  Without a
        fill that of its class and its material holds.
    round : bool
        Whether it is as deep as it is wide.
    rocking_harms : bool
        Whether rocking itself harms it.
    source : str
        Who says so.
    """

    body: Text
    title: Text
    words: Entries
    classes: Entries
    materials: Entries
    taller_than: Annotated[Number, Field(ge=0.0)]
    cg_ratio: Share
    cg_low: Share
    cg_high: Share
    base_ratio: Share
    base_low: Share
    base_high: Share
    section: Literal["", "foot", "ring", "plan"]
    section_ratio: Share
    section_low: Share
    section_high: Share
    fill: Share
    fill_low: Share
    fill_high: Share
    round: YesNo
    rocking_harms: YesNo
    source: Text

    @field_validator("cg_high", "base_high", "section_high", "fill_high")
    @classmethod
    def _in_order(cls, high: float | None, info: ValidationInfo) -> float | None:
        kind = str(info.field_name).removesuffix("_high")
        value = "fill" if kind == "fill" else f"{kind}_ratio"
        three = (info.data.get(f"{kind}_low"), info.data.get(value), high)
        if None in three and any(one is not None for one in three):
            raise InputError(f"{value}, {kind}_low and {kind}_high go together: fill all three, or none")
        return in_order(high, info, f"{kind}_low", value)

    def of_class(self, row: ObjectClass) -> ObjectClass:
        """Return the row of a class as it holds of this body.

        Parameters
        ----------
        row : ObjectClass
            Kouros's own.
        """
        numbers = {
            name: getattr(self, name) for name in (*_NUMBERS, "section", "title", "round", "rocking_harms", "source")
        }
        if self.fill is None:
            # How much of its outline such a thing fills its class and its material say.
            numbers = {name: one for name, one in numbers.items() if not name.startswith("fill")}
        out = row.model_copy(update={**numbers, "base_source": ""})
        for name in _FOUND:
            # What was worked out of the class is not of this body.
            out.__dict__.pop(name, None)
        return out


@cache
def body_rows() -> tuple[BodyRow, ...]:
    """Return the rows of bodies.csv, of which the first that holds counts.

    Raises
    ------
    TableError
        For a cell that cannot be used, naming it.
    """
    return checked(BodyRow, table("bodies"), "bodies.csv", named="body")


def body_of(text: str, rule: str, object_class: str, material: str, height: float) -> BodyRow | None:
    """Return the row that holds of a thing.

    Parameters
    ----------
    text : str
        Its name and title.
    rule : str
        The rule by which it is of its class.
    object_class, material : str
        Rows of classes.csv and materials.csv.
    height : float
        [m], 0 where it is not recorded.

    Returns
    -------
    BodyRow or None
        None where its class says what there is to say.
    """
    by_rule = {f"{_BY_RULE}{rule}", f"{_BY_RULE}*"}
    for pattern, row in _patterns():
        if height < row.taller_than or (row.classes and object_class not in row.classes):
            continue
        if row.materials and material not in row.materials:
            continue
        # Last, for it takes the longest.
        if not by_rule.isdisjoint(row.words) or (pattern is not None and pattern.search(text)):
            return row
    return None


@cache
def _patterns() -> tuple[tuple[re.Pattern[str] | None, BodyRow], ...]:
    out = []
    for row in body_rows():
        words = [word for word in row.words if not word.startswith(_BY_RULE)]
        out.append((any_of(words) if words else None, row))
    return tuple(out)


def body_told(notes: Iterable[str]) -> str:
    """Return as what body something is assumed of a thing, in words; "" where nothing is.

    Parameters
    ----------
    notes : iterable of str
        What is said of each of its numbers.
    """
    return next((found[1] for note in notes if (found := _titles().search(note))), "")


@cache
def _titles() -> re.Pattern[str]:
    titles = sorted({row.title.lower() for row in body_rows()}, key=len, reverse=True)
    return re.compile(rf"assumed for: ({'|'.join(map(re.escape, titles))})(?![^;])")
