"""Places that several columns tell from the building down: "Location level 1", "Location level 2"."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from pipeline.collection.display_words import says_away
from pipeline.collection.guessing.columns import Column, internal
from pipeline.collection.guessing.names import called, plain
from pipeline.collection.guessing.notes import GuessNotes

_NUMBERED = re.compile(r"(.*\D)0?(\d)\D?", re.DOTALL)
"""The name of a column of one level: what all are called, and its number."""
_HOUSE = frozenset(
    {
        "building",
        "bldg",
        "byggnad",
        "bygning",
        "bygningen",
        "rakennus",
        "budynek",
        "budova",
        "zgrada",
        "здание",
        "predio",
        "gebaude",
        "haus",
        "batiment",
        "edificio",
        "edificiu",
        "gebouw",
        "bina",
        "κτιριο",
    }
)
"""Words, folded, of a column of houses, in which a name of a room may be that of several."""


def levels_of_place(
    able: Sequence[Column], found: Mapping[str, Column], columns: Sequence[Column], told: GuessNotes
) -> tuple[Column, ...]:
    """Return the columns that tell a place together, the widest first; () where one column tells it.

    They are numbered, or one is of houses of which several have a room of the same name.

    Parameters
    ----------
    able : sequence of Column
        That may name places.
    found : mapping of str to Column
        Field -> its column.
    columns : sequence of Column
        Of the source.
    told : GuessNotes
        What is said of it; grows.
    """
    where = found.get("gallery")
    if where is None or {"gallery", "case"} & told.choices.keys():
        return ()
    levels = _numbered(where, columns) or _by_house(where, [*able, *columns])
    others = {id(one) for field, one in found.items() if field not in ("gallery", "displayed")}
    levels = tuple(one for one in levels if id(one) not in others)
    if len(levels) < 2 or where not in levels:
        _warn_of_stores(where, [*able, *columns], told)
        return ()
    told.doubts.append(f"the place is {' and '.join(repr(one.name) for one in levels)} together")
    told.questions[:] = [one for one in told.questions if one.key != "gallery"]
    return levels


def _warn_of_stores(where: Column, able: Sequence[Column], told: GuessNotes) -> None:
    """Say that a house is perhaps a store, where the rooms alone are the places: "Magasinet" beside "Hall B"."""
    for house in able:
        stores = [text for text in house.distinct if says_away(text)]
        if house is where or not stores or not _HOUSE.intersection(plain(house.name).split()):
            continue
        told.doubts.append(
            f"column {house.name!r} has {stores[0]!r}, which may be a store: what is in it counts as on display where "
            f"{where.name!r} names no store; --choose gallery={house.name} goes by the houses"
        )
        return


def _numbered(where: Column, columns: Sequence[Column]) -> tuple[Column, ...]:
    """Return the columns called as the first level is, but for their numbers: 1, 2 and so on."""
    first = _NUMBERED.fullmatch(where.name)
    if first is None or not called(where.name, "gallery"):
        # A table without a head has "Column 1", "Column 2".
        return ()
    named = ((_NUMBERED.fullmatch(one.name), one) for one in columns if one.filled)
    levels = {int(found[2]): one for found, one in named if found is not None and found[1] == first[1]}
    out: list[Column] = []
    while len(out) + 1 in levels:
        out.append(levels[len(out) + 1])
    return tuple(out)


def _by_house(where: Column, able: Sequence[Column]) -> tuple[Column, ...]:
    """Return the column of houses and that of rooms, where rooms of several houses are called the same."""
    for house in able:
        if house is where or internal(house) or not _HOUSE.intersection(plain(house.name).split()):
            continue
        pairs = {pair for pair in zip(house.values, where.values, strict=False) if all(pair)}
        if len(pairs) > len({room for _, room in pairs}) and len(house.distinct) <= len(where.distinct):
            return house, where
    return ()
