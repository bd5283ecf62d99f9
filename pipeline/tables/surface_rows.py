"""Rows of surfaces.csv: what objects stand on, by which words records tell it, and where it is met by chance."""

import re
from collections.abc import Sequence
from functools import cache, lru_cache

from pipeline.records import Furniture
from pipeline.tables import table
from pipeline.tables.rows import NO, Entries, TableRow, Text, YesNo, checked

_PLACES = (
    "floors?|flooring|ground|shel(?:f|ves)|decks?|plinths?|pedestals?|platforms?|blocks?|slabs?|tables?|"
    "tops?|boards?|steps?|Boden|Regal|Podest|Platte|Sockel|sol|étagère|socle|pavimento|mensola|ripiano|plinto|suelo|"
    "piso|estante|repisa|床|棚"
)
"""What an object stands on, behind the word for what that is made of: "on a polished marble floor"."""


class SurfaceRow(TableRow):
    """A row of surfaces.csv: a surface of friction.csv; one surface may have several rows.

    Attributes
    ----------
    surface : str
        As friction.csv names it.
    words : tuple of str
        By which records tell it.
    alone : bool
        Whether a word tells it by itself; else only before or behind what is stood on.
    met_on : tuple of str
        Furniture on which it is met by chance; () for what lies under an object on purpose alone.
    source : str
        Who says so.
    """

    surface: Text
    words: Entries
    alone: YesNo
    met_on: Entries
    source: Text


@cache
def surface_rows() -> tuple[SurfaceRow, ...]:
    """Return the rows of surfaces.csv.

    Raises
    ------
    TableError
        For a cell that cannot be used, naming it.
    """
    return checked(SurfaceRow, table("surfaces"), "surfaces.csv", named="surface")


@cache
def met_on(furniture: Furniture | None = None) -> frozenset[str]:
    """Return the surfaces, in small letters, that are met by chance on a kind of furniture, or on any.

    Parameters
    ----------
    furniture : Furniture, optional
        None for any.
    """
    places = [(row.surface.lower(), row.met_on) for row in surface_rows()]
    return frozenset(name for name, where in places if where and (furniture is None or furniture.value in where))


@lru_cache(maxsize=4096)
def surfaces_in(text: str, *, of_surface: bool = False) -> tuple[str, ...]:
    """Return the surfaces that a text tells, in small letters.

    Parameters
    ----------
    text : str
        In the museum's words.
    of_surface : bool
        Whether all of it is about the surface, so that any word counts.

    Returns
    -------
    tuple of str
        Each once, in the order of the table.  What lies under an object on purpose is what it stands on, whatever
        that lies on.
    """
    patterns = ((name, alone if of_surface else bound) for name, alone, bound in _patterns())
    found = (name for name, one in patterns if any(not NO.search(text[: m.start()]) for m in one.finditer(text)))
    told = tuple(dict.fromkeys(found))
    return tuple(name for name in told if name not in met_on()) or told


@cache
def _patterns() -> Sequence[tuple[str, re.Pattern[str], re.Pattern[str]]]:
    out = []
    for row in surface_rows():
        # Chinese and Japanese part no words from each other; German joins them: Steinboden.
        parted = [word for word in row.words if word[0] < "\u2e80"]
        joined = [re.escape(word) for word in row.words if word not in parted]
        some = "|".join(map(re.escape, parted))
        word = "|".join([rf"\b(?:{some})\b", *joined])
        near = [rf"\b(?:{some})(?:(?:\W+\w+)?\W+)?(?:{_PLACES})\b", *(f"{one}.?(?:{_PLACES})" for one in joined)]
        behind = rf"\b(?:{_PLACES})\W+(?:\w+\W+){{1,2}}(?:{some})\b"
        bound = word if row.alone else "|".join([*near, behind])
        out.append((row.surface.lower(), re.compile(word, re.IGNORECASE), re.compile(bound, re.IGNORECASE)))
    return out
