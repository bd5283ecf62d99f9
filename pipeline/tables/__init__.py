"""Tables are data: CSV files whose rows carry a value, its range and who says so.  Code never repeats their numbers."""

import csv
import errno
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, lru_cache
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


def number(row: Row, column: str, where: str) -> float:
    """Return a cell as a number.

    Parameters
    ----------
    row : Row
        Of a table.
    column : str
        Of the cell.
    where : str
        Table and row, for the message.

    Returns
    -------
    float
        In the column's unit.

    Raises
    ------
    TableError
        Naming table, row and column.
    """
    try:
        return float(row[column])
    except (KeyError, ValueError) as problem:
        raise TableError(f"{where}: column {column!r} must be a number, not {row.get(column)!r}") from problem


def spread(row: Row, value: str, low: str, high: str, where: str) -> Range:
    """Return value, low and high of a row as one range.

    Parameters
    ----------
    row : Row
        Of a table.
    value, low, high : str
        The columns.
    where : str
        Table and row, for the message.

    Returns
    -------
    Range
        In the columns' unit, with the row's source.

    Raises
    ------
    TableError
        Where they are no numbers or not in order.
    """
    out = Range(number(row, value, where), number(row, low, where), number(row, high, where), row.get("source", ""))
    if not out.low <= out.value <= out.high:
        raise TableError(f"{where}: {low} <= {value} <= {high} does not hold ({out.low} {out.value} {out.high})")
    return out


@cache
def _materials() -> tuple[tuple[re.Pattern[str], Row], ...]:
    out = []
    for row in table("materials"):
        words = [re.escape(w.strip()) for w in row["words"].split("|") if w.strip()]
        if words:
            out.append((re.compile(rf"\b(?:{'|'.join(words)})\b", re.IGNORECASE), row))
    return tuple(out)


@lru_cache(maxsize=65536)
def material_in(text: str) -> Row | None:
    """Return the row of materials.csv for the material that stands first in a text.

    Parameters
    ----------
    text : str
        In the museum's words.

    Returns
    -------
    Row or None
        None where there is none.
    """
    found = [(match.start(), row) for pattern, row in _materials() if (match := pattern.search(text))]
    return min(found, key=lambda pair: pair[0])[1] if found else None


def friction_of(object_material: str = "", surface_material: str = "") -> Range:
    """Return the friction of a pair: the median and the span of all rows that are not ruled out.

    Parameters
    ----------
    object_material, surface_material : str
        An empty name rules nothing out; a name that the table does not know leaves the other one to decide.

    Returns
    -------
    Range
        Coefficient of friction [-].

    References
    ----------
    Agbabian, M. S., Ginell, W. S., Masri, S. F. and Nigbor, R. L. (1991). Evaluation of earthquake damage mitigation
    methods for museum objects. Studies in Conservation 36. Table 3.
    """
    rows = _matching("friction", {"object_material": object_material, "surface_material": surface_material})
    # Special surfaces are chosen on purpose, never met by chance.
    if not surface_material:
        rows = [r for r in rows if r["surface_material"] not in ("Coarse sandpaper", "Teflon")]
    if not object_material:
        rows = [r for r in rows if r["object_material"] != "Teflon"]
    return _span(rows, "friction")


def damping_of(wall_surface: str = "", back_surface: str = "") -> Range:
    """Return the damping of a painting against its wall.

    With nothing known the lowest damping counts, the painting's bare wood on paint; the span is the table's.

    Parameters
    ----------
    wall_surface, back_surface : str
        As in `friction_of`.

    Returns
    -------
    Range
        Damping ratio [-].

    References
    ----------
    Agbabian et al. (1991), as in `friction_of`, Table 4.
    """
    rows = _matching("damping", {"wall_surface": wall_surface, "back_surface": back_surface})
    out = _span(rows, "damping")
    if not back_surface:
        return Range(out.low, out.low, out.high, out.source)
    return out


def _matching(name: str, wanted: Mapping[str, str]) -> list[Row]:
    """Return the rows of the pair; where the table lacks it, those of either partner, so that the span says so."""
    asked = {column: text.strip().lower() for column, text in wanted.items() if text.strip()}
    found = [[r for r in table(name) if r[column].lower() == text] for column, text in asked.items()]
    known = [rows for rows in found if rows]
    pair = [r for r in table(name) if all(r in rows for rows in known)]
    if pair:
        return pair
    return [r for r in table(name) if any(r in rows for rows in known)]


def _span(rows: list[Row], name: str) -> Range:
    values = sorted(number(r, "value", f"{name}.csv") for r in rows)
    low = min(number(r, "low", f"{name}.csv") for r in rows)
    high = max(number(r, "high", f"{name}.csv") for r in rows)
    return Range(values[(len(values) - 1) // 2], low, high, rows[0]["source"].split(" (")[0])
