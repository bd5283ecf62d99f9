"""Rows of place_words.csv: sides and surfaces of rooms, sections of exhibitions, and signs of what things stand in."""

from functools import cache

from pipeline.tables import table
from pipeline.tables.rows import Entries, TableRow, Text, checked


class PlaceWords(TableRow):
    """A row of place_words.csv.

    Attributes
    ----------
    kind : str
        What the words are: surface, side, section, or the furniture that a sign stands for.
    words : tuple of str
        In small letters or capitals, which count the same.
    source : str
        Who says so.
    """

    kind: Text
    words: Entries
    source: Text


@cache
def _rows() -> tuple[PlaceWords, ...]:
    return tuple(checked(PlaceWords, table("place_words"), "place_words.csv", named="kind"))


@cache
def place_words(kind: str) -> tuple[str, ...]:
    """Return the words of a kind, in the order of the table; () for a kind that has none.

    Parameters
    ----------
    kind : str
        As of the column.
    """
    return tuple(word for row in _rows() if row.kind == kind for word in row.words)
