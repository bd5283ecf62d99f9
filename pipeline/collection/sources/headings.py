"""Rows that head the rows below them, such as the name of a room across a list -> a column of that name."""

from __future__ import annotations

import re
from collections.abc import Iterator, Set

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.rows import Row

HEADING = "heading"
"""The column with the heading under which a row stands."""

_FIGURES = re.compile(r"\d+")
_SUM = re.compile(
    r"(?:(?:grand |sub-?)?totale?s?|totaal|sum|summe|gesamt|insgesamt|suma|soma|somme|ukupno|celkem|razem|összesen"
    r"|toplam|yhteensä|summa|i alt|antal|anzahl|count|σύνολο|итого|всего|合計|合计|总计|總計|총계|計)(?![^\W\d_])"
    r"|[^\W\d]{3,}:\s+\d+\b",
    re.IGNORECASE,
)
"""How a row begins that sums the others up: "Total 168", "Objects: 168"."""
_MOST_SHAPES = 10_000

MERGED = "is one of the merged cells"
"""How the fault begins of a cell that a merged one hides."""


def first_text(row: Row) -> str:
    """Return what the first cell of a row says that says anything; "" where none does."""
    return next((cell.strip() for cell in row.cells if cell.strip()), "")


def is_heading(row: Row) -> bool:
    """Say whether a row holds one text alone, perhaps merged across the others.

    Parameters
    ----------
    row : Row
        Of a table.

    Returns
    -------
    bool
    """
    filled = [cell for cell in row.cells if cell.strip()]
    return (
        len(filled) == 1
        and len(row.cells) > 2
        and any(map(str.isalpha, filled[0]))
        and not row.fault[0]
        and all(why.startswith(MERGED) for why, _ in row.faults.values())
    )


def without_heads(rows: Iterator[Row]) -> Iterator[Row]:
    """Yield the header and the rows; one that repeats the names of the columns, as above each page, is no object.

    Parameters
    ----------
    rows : iterator of Row
        The header first.

    Yields
    ------
    Row
    """
    header = next(rows, None)
    if header is None:
        return
    yield header
    names = [name.strip() for name in header.cells]
    first = next(filter(None, names), "")
    for row in rows:
        if first_text(row) == first and [cell.strip() for cell in row.cells] == names:
            yield row._replace(fault=("repeats the names of the columns", "leave it out"), faults={})
        else:
            yield row


def under_headings(rows: Iterator[Row], file: str, first: str = "") -> Iterator[Row]:
    """Yield the header and the rows with HEADING behind them; a heading is no row, but where no row stands below it.

    What differs from the number of an object above it in figures alone is one too: A 3 below A 2.

    Parameters
    ----------
    rows : iterator of Row
        The header first.
    file : str
        The source's name in messages.
    first : str
        The heading of the rows above the first one: a title above the names of the columns.

    Yields
    ------
    Row
        Numbered as they came.

    Raises
    ------
    CollectionError
        For a source that has such a column of its own.
    """
    header = next(rows, None)
    if header is None:
        return
    if HEADING in (name.strip() for name in header.cells):
        raise CollectionError(
            f"{file}: has a column {HEADING!r} of its own; rename it, or leave [source] headings out of the mapping"
        )
    yield header._replace(cells=[*header.cells, HEADING])
    above, waiting = first, None
    numbers: set[str] = set()
    for row in rows:
        if is_heading(row) and _shape(row) not in numbers:
            if waiting is not None:
                yield _headless(waiting)
            above, waiting = first_text(row), row
            continue
        waiting = None
        if len(numbers) < _MOST_SHAPES:
            numbers.add(_shape(row))
        yield row._replace(cells=[*row.cells, above])
    if waiting is not None:
        yield _headless(waiting)


def _shape(row: Row) -> str:
    """Return what a row begins with, whatever its figures: an object of which nothing else is known is no heading."""
    return _FIGURES.sub("0", first_text(row))


def _headless(row: Row) -> Row:
    told = f"{first_text(row)[:80]!r} stands alone in its row, as a heading does, and no row below it"
    fault = told, "leave it out, or fill the row"
    return row._replace(cells=[*row.cells, ""], fault=fault, faults={})


def heads_or_sums(row: Row, number: str, beside: Set[int]) -> str:
    """Say why a row parts the others, such as FURNITURE, or sums them up, such as TOTAL 168; "" where it does not.

    It is told by its empty place: where no column tells places, nothing is taken for one.

    Parameters
    ----------
    row : Row
        Of a table.
    number : str
        Of the object that it may be.
    beside : set of int
        Places of the other cells that are read; empty where none tells places.

    Returns
    -------
    str
    """
    if beside and beside <= row.faults.keys() and is_heading(row):
        return "is merged across all columns: a heading"
    if not beside or any(any(map(str.isalpha, row.cells[at])) for at in beside):
        return "sums the others up" if _SUM.fullmatch(number.strip(" :.")) else ""
    if not any(map(str.isnumeric, number)):
        return "has no figure in it and nothing but numbers beside it: a heading, or a sum"
    return "has nothing but numbers beside it: a heading, or a sum" if _SUM.match(number) else ""
