"""Rows of limits.csv: how much anybody trusts shelves, wax, putty and loose furniture with."""

from functools import cache

from pipeline.tables import Range, table
from pipeline.tables.rows import RangeRow, Text, checked, once


class LimitRow(RangeRow):
    """A row of limits.csv: a limit of what is advised, with how far other judgements would have it.

    Attributes
    ----------
    name, unit : str
        Which limit, and its unit.
    """

    name: Text
    unit: Text


@cache
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
    rows = checked(LimitRow, table("limits"), "limits.csv", named="name")
    once((row.name for row in rows), "name", "limits.csv")
    return {row.name: row.range for row in rows}[name]
