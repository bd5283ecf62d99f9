"""Rows of texts, which every source gives, and how a typed value becomes the text that a file would hold."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from datetime import date, datetime, time
from decimal import Decimal
from math import isfinite
from types import MappingProxyType
from typing import NamedTuple

from pipeline.collection.errors import CollectionError

NO_FAULTS: Mapping[int, tuple[str, str]] = MappingProxyType({})
"""The faults of cells of a row that has none."""


class TypedNumber(str):
    """The text of a cell that its source holds as a number: its point is the decimal one, whatever texts have."""

    __slots__ = ()


class Row(NamedTuple):
    """A row as it stands in its source: its number, its first line, its cells as texts.

    Attributes
    ----------
    number : int
        1 = first data row; 0 is the header.
    line : int
        Of the file or the sheet; of a query's result, the same as the number.
    cells : list of str
        As many as the header has.
    fault : (str, str)
        Why the row cannot be used, with the remedy; ("", "") where it can.
    faults : mapping of int to (str, str)
        By cell (0 = first), why that cell alone cannot be used, with the remedy; the cell is an empty text then.
    """

    number: int
    line: int
    cells: list[str]
    fault: tuple[str, str] = ("", "")
    faults: Mapping[int, tuple[str, str]] = NO_FAULTS


def check_columns(keyed: Iterable[tuple[str, str | None]], names: Sequence[str], where: str) -> None:
    """Refuse a section of a mapping that names a column which is not there.

    Parameters
    ----------
    keyed : iterable of (str, str or None)
        The keys of the section, each with the column that it names.
    names : sequence of str
        The columns that are there.
    where : str
        The source and the section, in messages.

    Raises
    ------
    CollectionError
        Naming the key, the column and those that are there.
    """
    for key, name in keyed:
        if name is not None and name not in names:
            raise CollectionError(
                f"{where} {key}: there is no column {name!r}; its columns are {', '.join(map(repr, names[:80]))}. Name "
                "one of them in the mapping"
            )


def as_text(value: object) -> str:
    """Return the text of a typed value (of a spreadsheet or a database): the same for the same number in every source.

    That of a number with a fraction is a `TypedNumber`.

    None is an empty text; numbers are written with all their digits and no more: 79.0 as 79, decimals exactly; flags
    are true and false; dates are ISO 8601.

    Parameters
    ----------
    value : object
        A text, number, flag, date, time, or None.

    Returns
    -------
    str
        Its text.

    Raises
    ------
    TypeError
        For what is no text, number, flag, date or time.
    ValueError
        For a number that is not finite.
    """
    if value is None:
        return ""
    if isinstance(value, str):
        return value
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, float):
        if not isfinite(value):
            raise ValueError(f"{value} is no number that was measured")
        return str(int(value)) if value.is_integer() and abs(value) < 1e16 else TypedNumber(repr(value))
    if isinstance(value, Decimal):
        if not value.is_finite():
            raise ValueError(f"{value} is no number that was measured")
        plain = value.normalize()
        return TypedNumber(format(plain, "f") if -20 < plain.adjusted() < 20 else str(plain))
    if isinstance(value, datetime | date | time):
        return value.isoformat()
    raise TypeError(f"a value of the kind {type(value).__name__}")
