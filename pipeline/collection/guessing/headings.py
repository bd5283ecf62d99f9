"""Lists with headings between their rows: whether they name places, and what then tells where a thing is."""

from __future__ import annotations

import re
from collections.abc import Sequence

from pipeline.collection.display_words import says_away
from pipeline.collection.guessing.columns import Column
from pipeline.collection.guessing.fields import tells_display
from pipeline.collection.guessing.names import called, outright
from pipeline.collection.places import parted
from pipeline.collection.sources.headings import HEADING, first_text, is_heading
from pipeline.collection.sources.rows import Row
from pipeline.collection.sources.sheets import SHEET
from pipeline.tables.held_rows import in_no_case

FEWEST = 2
"""Headings from which a list is taken to have some; one alone may be a remark."""

_FIGURES = re.compile(r"\d+")

_MOST = 0.5
"""Share of the rows that headings are at most."""


def has_headings(rows: Sequence[Row], first: str = "") -> bool:
    """Say whether rows that hold one text alone head those below them, and name places.

    Parameters
    ----------
    rows : sequence of Row
        Of a table, without its header.
    first : str
        What stands alone above the header.

    Returns
    -------
    bool
    """
    texts = _headings(rows)
    texts += [first] if heads_first(rows, first) else []
    places = sum(map(_names_place, texts))
    return FEWEST <= len(texts) <= _MOST * len(rows) and places >= FEWEST and 2 * places >= len(texts)


def heads_first(rows: Sequence[Row], title: str) -> bool:
    """Say whether a title above the names of the columns heads the rows below: Gallery 1, where Gallery 2 is below.

    Parameters
    ----------
    rows : sequence of Row
        Of a table, without its header.
    title : str
        What stands alone above the header; "" for nothing.
    """
    begins = _FIGURES.sub("0", title).split()[:2]
    return bool(begins) and any(_FIGURES.sub("0", one).split()[:2] == begins for one in _headings(rows))


def _headings(rows: Sequence[Row]) -> list[str]:
    """Return the texts of rows that stand alone, and above others that do not."""
    alone = [is_heading(row) for row in rows]
    return [
        first_text(row) for row, one, below in zip(rows, alone, [*alone[1:], True], strict=False) if one and not below
    ]


def _names_place(text: str) -> bool:
    # "CASE 2 - TRADE" and "OPEN DISPLAY" tell where things are, as rooms do.
    return says_away(text) or called(text, "gallery") or bool(parted(text).case) or in_no_case(text)


def place_by_heading(found: dict[str, Column], columns: Sequence[Column]) -> str:
    """Take headings, or names of sheets, for the places of a list that has no column called so outright, and say so.

    Parameters
    ----------
    found : dict of str to Column
        Field -> its column; a column that was nearly called a place becomes one of cases or of words on the display.
    columns : sequence of Column
        Of the source.

    Returns
    -------
    str
        What is to be said; "" where there are none.
    """
    heading = next((one for one in columns if one.name in (HEADING, SHEET) and one.filled), None)
    if heading is None:
        return ""
    such = f"such as {heading.distinct[0][:80]!r}"
    said = (
        f"{len(heading.distinct)} sheets have names, {such}"
        if heading.name == SHEET
        else f"{len(heading.distinct)} rows are headings of the rows below them, {such}, and no objects"
    )
    place = found.get("gallery")
    named_so = heading.name == HEADING or 2 * sum(map(_names_place, heading.distinct)) >= len(heading.distinct)
    if (place is not None and outright(place.name)) or not named_so:
        taken = "the names are taken for no places" if place is None else f"places are taken from {place.name!r}"
        return f"{said}; {taken}: --choose gallery={heading.name} takes these"
    found["gallery"] = heading
    if place is not None:
        found.setdefault("displayed" if tells_display(place) else "case", place)
    return f"{said}, and are taken for their places; --choose gallery=COLUMN takes others"
