"""Whether the sizes of a whole source fit what its things are: chairs of nine millimetres are chairs in another unit.

The witness is the class of each thing, by its words alone, and how large things of that class are.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from math import log10
from statistics import median
from typing import Annotated, NamedTuple

from pydantic import BaseModel, Field

from pipeline.analysis.classify import class_of
from pipeline.collection.unit_audit import Suspicion
from pipeline.quantities import LENGTHS, figures
from pipeline.records import Item
from pipeline.tables import table
from pipeline.tables.rows import Text, checked

SEEN = 400
"""Objects that it is told by, evenly chosen: what runs through a source shows in as many."""
FEWEST = 12
"""Objects of a usual size below which nothing is said."""
MOST = 0.75
"""Share of them that must be too large, or too small, alike."""
TOO = 0.5
"""Decimal logarithm of how many times: half of the step from one metric unit to the next."""
LEAST = 0.65
"""The same of the object in the middle at least, 4.5 times: of eleven museums in their right unit it is 0.9 to 2.1."""
ALONE = 0.9
"""The same where all things are of one class, 8 times: a collection of floor vases is one; judgement."""
NEAR = 0.4
"""How far it may then be from its usual size in the unit that fits."""
SURE = 0.3
"""Probability from which a class is believed that words alone say."""
_SIDES = ("height_m", "width_m", "depth_m")
_UNITS = ("mm", "cm", "m")


class _UsualSize(BaseModel):
    object_class: Annotated[str, Field(alias="class")]
    largest: Annotated[float, Field(gt=0.0)]
    source: Text


@cache
def _usual() -> dict[str, float]:
    rows = checked(_UsualSize, table("usual_sizes"), "usual_sizes.csv", named="class")
    return {row.object_class: row.largest for row in rows}


def unfit_sizes(items: Sequence[Item]) -> tuple[Suspicion, ...]:
    """Return the unit in which most things are ten times too large, or too small, for what they are called.

    Parameters
    ----------
    items : sequence of Item
        The objects.

    Returns
    -------
    tuple of Suspicion
        With the unit that fits, and some of the things.
    """
    seen: dict[str, list[_Apart]] = {}
    for item in items[:: max(1, len(items) // SEEN)]:
        found = _apart(item)
        if found is not None:
            seen.setdefault(found.unit, []).append(found)
    return tuple(one for unit, those in sorted(seen.items()) for one in _unfit(unit, those))


class _Apart(NamedTuple):
    """A thing, its class, the unit of its largest side, and how far that is from the usual size."""

    unit: str
    far: float
    object_class: str
    item: Item


def _apart(item: Item) -> _Apart | None:
    """Return how far a thing's largest side is from the usual size; None where that or its unit is not known."""
    sides = {side: value for side in _SIDES if (value := getattr(item, side)) is not None}
    if not sides:
        return None
    side = max(sides, key=lambda one: sides[one])
    unit = next((of.written.rpartition(" ")[2] for of in item.provenance if of.field == side), "")
    taken = class_of(replace(item, height_m=None, width_m=None, depth_m=None))
    usual = _usual().get(taken.name)
    sure = dict(taken.chances).get(taken.name, 0.0) >= SURE
    if unit not in _UNITS or usual is None or not sure:
        return None
    return _Apart(unit, log10(sides[side] / usual), taken.name, item)


def _unfit(unit: str, those: Sequence[_Apart]) -> list[Suspicion]:
    middle = median(one.far for one in those)
    apart = {one: abs(middle + log10(LENGTHS[one] / LENGTHS[unit])) for one in _UNITS}
    other = min(_UNITS, key=lambda one: apart[one])
    alike = [one for one in those if one.far * middle > 0.0 and abs(one.far) > TOO]
    least = LEAST if len({one.object_class for one in those}) > 1 else ALONE
    if len(those) < FEWEST or abs(middle) < least or apart[other] > NEAR or len(alike) < MOST * len(those):
        return []
    much = figures(10.0 ** abs(middle), 2)
    return [
        Suspicion(
            "height_m",
            f"{len(alike):,} of {len(those):,} things whose sizes are read in {unit} are far too "
            f"{'large' if middle > 0.0 else 'small'} for what they are called, in the middle {much} times; they would "
            f"fit in {other}",
            f'measure one object again; if it was {other}, say unit = "{other}" in the mapping, if not [holds] units = '
            '"mapping"',
            "units",
            tuple(_in_words(one.item) for one in alike[:3]),
        )
    ]


def _in_words(item: Item) -> str:
    sizes = ", ".join(of.written for of in item.provenance if of.field in _SIDES)
    return f"{item.object_number}: {(item.object_name or item.title)[:60]!r}, {sizes}"
