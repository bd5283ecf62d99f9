"""Tables are data: CSV files whose rows carry a value, its range and who says so.  Code never repeats their numbers."""

import csv
import errno
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from io import StringIO
from pathlib import Path

from pipeline.errors import InputError
from pipeline.resources import small_text

Row = Mapping[str, str]

FOLDER = Path(__file__).resolve().parent


class TableError(InputError):
    """A table that cannot be used: the message names file, row, column and remedy."""


@dataclass(frozen=True, slots=True)
class Range:
    """A value with its range and source, as a table's row states it.

    Attributes
    ----------
    value, low, high : float
        In the unit that the table's column names.
    source : str
        Who says so.
    """

    value: float
    low: float
    high: float
    source: str


@cache
def table(name: str) -> tuple[Row, ...]:
    """Return the rows of one of Kouros's own tables, by column.

    Parameters
    ----------
    name : str
        Of the file, without ".csv".

    Returns
    -------
    tuple of Row
        In the order of the file.

    Raises
    ------
    TableError
        For a row of another length than the header.
    FileNotFoundError
        For an unknown table.
    """
    return read_table(FOLDER / f"{name}.csv")


def read_table(path: Path) -> tuple[Row, ...]:
    """Return the rows of a CSV file, by column.

    Parameters
    ----------
    path : Path
        A file of the museum's, or of Kouros's own; no larger than what a person writes (`pipeline.resources.SMALL`).

    Returns
    -------
    tuple of Row
        In the order of the file.

    Raises
    ------
    TableError
        For a row of another length than the header, a column named twice, what is no CSV file in UTF-8, and a file
        that is larger.
    OSError
        For a file that cannot be read.
    """
    try:
        return _read(path)
    except OSError as problem:
        if problem.errno != errno.EFBIG:
            raise
        raise TableError(f"{path.name}: {problem.strerror}; leave out what is no row of a table") from problem
    except (UnicodeDecodeError, csv.Error) as problem:
        raise TableError(f"{path.name}: no CSV file in UTF-8: {problem}; save it as CSV (UTF-8)") from problem


def _read(path: Path) -> tuple[Row, ...]:
    reader = csv.DictReader(StringIO(small_text(path).removeprefix("\ufeff"), newline=""), strict=True)
    rows = list(reader)
    columns = list(reader.fieldnames or ())
    twice = next((name for name in columns if columns.count(name) > 1), None)
    if twice is not None:
        raise TableError(f"{path.name}, line 1: column {twice!r} is there twice; keep one")
    for number, row in enumerate(rows, start=2):
        if None in row or None in row.values():
            raise TableError(
                f"{path.name}, line {number}: not as many cells as the header has; quote cells with commas"
            )
    return tuple(rows)
