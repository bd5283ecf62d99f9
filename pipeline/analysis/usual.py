"""Numbers that tables alone say, by a few words of a record: clearance, friction, damping."""

import re
from collections.abc import Mapping
from functools import cache, lru_cache

from pipeline.records import Estimate, Furniture, Item
from pipeline.records import phrases as say
from pipeline.tables.assumed import AssumedValues, span, tables_of
from pipeline.tables.assumed_rows import WHEN_HELD, ObjectClass
from pipeline.tables.bending_rows import bending
from pipeline.tables.limit_rows import limit

_BASES = tuple(
    re.compile(pattern, re.IGNORECASE)
    for pattern in (
        r"\b(?:base|socle|zoccolo|peana|Sockel)\W+(?:of|en|de|in|di|aus)\W+(\w+)",
        r"\b(?:on|with|sur|su|auf|mit|con|sobre)\W+((?:\w+\W+){1,5}?)(?:base|socle|plinth|Sockel|peana)\b",
        r"[;,]\W*((?:\w+\W+){1,3}?)(?:base|socle|plinth|Sockel|peana)\b",
    )
)
"""Words for what a thing stands on that belongs to it: "bronze on a marble base", "hide; wooden base"."""


@lru_cache(maxsize=4096)
def _base_in(values: AssumedValues, text: str) -> str:
    told = (group for found in _BASES for match in found.finditer(text) for group in match.groups())
    plain = (re.sub(r"\bwooden\b", "wood", group, flags=re.IGNORECASE) for group in told)
    stuff = next((one for group in plain if (one := values.material_in(group)) is not None), None)
    return "" if stuff is None else stuff.friction_as


def base_of(values: AssumedValues, item: Item) -> str:
    """Return as what a thing slides by the words for its base; "" where there are none.

    Parameters
    ----------
    values : AssumedValues
        The tables that know the words.

    Returns
    -------
    str
    """
    told = item.base_material.strip()
    known = {row.pair[0] for row in values.friction}
    if told and told.lower() not in known:
        stuff = values.material_in(told)
        return told if stuff is None else stuff.friction_as or told
    return told or _base_in(values, item.medium)


ON_ANY: Mapping[Furniture | None, str] = {
    Furniture.SHOWCASE: "anything in a showcase",
    Furniture.SHELF: "any shelf",
    Furniture.PEDESTAL: "any pedestal",
}
"""What is said of a surface that nobody tells, by what it is on; of others "any floor"."""

# What depends on a table and a few words only is worked out once, not for every object of a collection.


@lru_cache(maxsize=4096)
def clearance_of(values: AssumedValues, object_class: str) -> Estimate | None:
    """Return the free distance around an object of a class [m]; None where its row says none."""
    row = values.classes[object_class]
    if row.room is None:
        return None
    note = say.CLEARANCE(room=row.room, told=row.told)
    return Estimate.assumed(row.room.value, row.room.low, row.room.high, "m", note, row.room.source)


def shelved(item: Item, row: ObjectClass) -> Estimate | None:
    """Return how far a book may slide off its shelf [m] (limits.csv); None for what stands on no bookshelf."""
    if WHEN_HELD not in row.models or not _BOOKSHELF.search(f"{item.displayed}; {item.case}; {item.title}"):
        return None
    room = limit("book_room")
    source = f"limits.csv ({room.source})"
    return Estimate.assumed(room.value, room.low, room.high, "m", say.BOOK_ROOM(room=room), source)


_BOOKSHELF = re.compile(
    r"\b(?:book ?shel(?:f|ves)|bookcases?|Bücherregale?|Bücherschr(?:a|ä)nke?|bibliothèque|rayonnages?|libreria|"
    r"scaffal[ei]|librería|estantería|"
    r"(?:standing |upright )?in (?:a |one )?rows?|in Reihen?|en rangée|in fila|en fila)\b|本棚|書架|βιβλιοθήκη",
    re.IGNORECASE,
)
"""What says that books stand in a row on a shelf."""


@lru_cache(maxsize=4096)
def friction_of(values: AssumedValues, material: str, surface: str, furniture: Furniture | None = None) -> Estimate:
    """Return the friction of a material on a surface [-]; "" for either where nobody says it.

    Parameters
    ----------
    furniture : Furniture or None, optional
        On which the surface is, of one that nobody says.

    Returns
    -------
    Estimate
    """
    rows = values.friction_of(material, surface, furniture)
    found = span(rows)
    of, on = material or "any material", surface or ON_ANY.get(furniture, "any floor")
    note = f"{say.FRICTION(friction=found, tables=tables_of(rows), material=of, surface=on)}; {say.NOT_MEASURED()}"
    return Estimate.assumed(found.value, found.low, found.high, "-", note, found.source)


@lru_cache(maxsize=4096)
def wall_damping_of(values: AssumedValues, wall: str, back: str) -> Estimate:
    """Return the damping of a work against its wall [-], by wall and back surface; "" where nobody says it."""
    rows = values.damping_of(wall, back)
    found = span(rows)
    note = say.DAMPING_ON(back=back or "its back", wall=wall or "the wall", tables=tables_of(rows))
    if not wall and not back:
        least = min(rows, key=lambda row: row.low)
        pair = {"back": least.back_surface.lower(), "wall": least.wall_surface.lower()}
        note = f"{say.DAMPING_LEAST(**pair, tables=tables_of(rows))}; {say.SURFACES_NOT_RECORDED()}"
    # With nothing known of its back the lowest damping counts.
    return Estimate.assumed(found.value if back else found.low, found.low, found.high, "-", note, found.source)


@cache
def own_damping() -> Estimate:
    """Return the damping of an object that bends [-]."""
    found = bending("damping")
    note = say.OWN_DAMPING(damping=found)
    return Estimate.assumed(found.value, found.low, found.high, "-", note, found.source)
