"""Rows of finishes.csv: what lies on the surface of a thing and comes off where it is touched."""

import re
from collections.abc import Collection
from functools import cache, lru_cache

from pipeline.tables import table
from pipeline.tables.rows import Entries, TableRow, Text, any_of, checked


class FinishRow(TableRow):
    """A row of finishes.csv.

    Attributes
    ----------
    finish : str
        What it is.
    words : tuple of str
        By which materials and mediums tell it.
    not_on : tuple of str
        Rows of materials.csv on which such words tell of something that was fired, and holds.
    harms : tuple of str
        Fixings that are not for it at all.
    source : str
        Who says so.
    """

    finish: Text
    words: Entries
    not_on: Entries
    harms: Entries
    source: Text


@cache
def finish_rows() -> tuple[FinishRow, ...]:
    """Return the rows of finishes.csv.

    Raises
    ------
    TableError
        For a cell that cannot be used, naming it.
    """
    return checked(FinishRow, table("finishes"), "finishes.csv", named="finish")


@lru_cache(maxsize=4096)
def finishes_in(text: str, materials: Collection[str]) -> tuple[FinishRow, ...]:
    """Return what lies on the surface of a thing.

    Parameters
    ----------
    text : str
        Its material and medium, in the museum's words.
    materials : collection of str
        Rows of materials.csv that it is made of.
    """
    return tuple(row for pattern, row in _patterns() if pattern.search(text) and not set(materials) & set(row.not_on))


@cache
def _patterns() -> tuple[tuple[re.Pattern[str], FinishRow], ...]:
    return tuple((any_of(row.words), row) for row in finish_rows())
