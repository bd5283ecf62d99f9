"""Rows of limits.csv: how much anybody trusts shelves, wax, putty and loose furniture with."""

from pipeline.tables import Range
from pipeline.tables.rows import NamedRange, Text, named_ranges


class LimitRow(NamedRange):
    """A row of limits.csv: a limit of what is advised, with how far other judgements would have it.

    Attributes
    ----------
    unit : str
        Of its numbers.
    """

    unit: Text


def limit(name: str) -> Range:
    """Return a limit of limits.csv.

    Parameters
    ----------
    name : str
        Of its row.

    Returns
    -------
    Range
        In the unit of its row.

    Raises
    ------
    TableError
        Naming the line of limits.csv.
    KeyError
        For another name.
    """
    return named_ranges(LimitRow, "limits")[name]


BRACED = "with the brace"
"""Ends the note of what a brace changed: the factors are over what bends without any."""


HELD_ABOVE = "held above its base too"
"""The same of what its record says to be held so: by which nobody computed how."""


def ends_of(name: str) -> tuple[float, float, float]:
    """Return low, best and high of a limit of limits.csv.

    Parameters
    ----------
    name : str
        Of its row.
    """
    found = limit(name)
    return found.low, found.value, found.high
