"""Schedules of exhibitions that tell by signs alone where a thing is: C01 a case, P03 a plinth, W05 a wall."""

from __future__ import annotations

import re
from collections.abc import Sequence
from functools import cache

import tomlkit

from pipeline.collection.guessing.columns import Column, untaken
from pipeline.collection.guessing.names import plain
from pipeline.collection.guessing.notes import GuessNotes
from pipeline.records import Furniture
from pipeline.tables.place_rows import place_words

_SIGN = re.compile(r"([A-Za-z]{1,4})[ .-]?\d{1,3}[a-z]?(?:[\s./-]+[A-Za-z]{0,3}\d{0,3})?")


def spots_by_sign(columns: Sequence[Column], found: dict[str, Column], told: GuessNotes) -> tomlkit.items.Table | None:
    """Take a column of places that are all signs of cases, plinths and walls for that, and the sections for the places.

    Parameters
    ----------
    columns : sequence of Column
        Of the source.
    found : dict of str to Column
        Field -> its column; that of the gallery may become that of the cases.
    told : GuessNotes
        What is said of it; grows.

    Returns
    -------
    Table or None
        The furniture of each sign, as a mapping has it; None where they are none.
    """
    where = found.get("gallery")
    if where is None or {"case", "furniture"} & found.keys() or {"gallery", "case", "furniture"} & told.choices.keys():
        return None
    signs = {text: _SIGN.fullmatch(text.strip()) for text in where.distinct}
    kinds = {text: _kinds().get(sign[1].casefold()) for text, sign in signs.items() if sign is not None}
    meant = {kind for kind in kinds.values() if kind is not None}
    # Rooms are called A1 and B2, too: cases beside things in the open are told by the letters of both.
    if len(kinds) < len(signs) or None in kinds.values() or Furniture.SHOWCASE not in meant or len(meant) < 2:
        return None
    del found["gallery"]
    found["case"] = where
    named = (one for one in untaken(columns, found.values()) if _sections().intersection(plain(one.name).split()))
    section = next((one for one in named if one.filled and len(one.distinct) < len(one.filled)), None)
    if section is not None:
        found["gallery"] = section
    entry = tomlkit.table()
    entry["column"] = where.name
    entry["values"] = values = tomlkit.inline_table()
    for text, kind in kinds.items():
        if kind is not None:
            values[text] = kind.value
    said = ", ".join(f"{text!r} a {kind.value}" for text, kind in list(kinds.items())[:4] if kind is not None)
    told.doubts.append(
        f"column {where.name!r} is taken to name cases, plinths and walls by their signs, {said}; --choose "
        f"gallery={where.name} takes it for the rooms"
    )
    return entry


@cache
def _kinds() -> dict[str, Furniture]:
    """Return what a designer means by the letters ahead of a number, where one list has several kinds."""
    return {letters: kind for kind in Furniture for letters in place_words(kind.value)}


@cache
def _sections() -> frozenset[str]:
    """Return the words of the head of a column of the parts of an exhibition."""
    return frozenset(map(plain, place_words("section")))
