"""Sheets of a workbook with the same columns, such as one a room -> one table, with a column of their names."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.rows import Row

SHEET = "sheet"
"""The column with the name of the sheet on which a row stands."""


def one_below_another(read: Callable[[str], Iterator[Row]], sheets: Sequence[str], file: str) -> Iterator[Row]:
    """Yield the header with SHEET behind it, and the rows of all sheets, numbered on; lines are those of their sheets.

    Parameters
    ----------
    read : callable
        Name of a sheet -> its header and rows.
    sheets : sequence of str
        In the order in which they are read; one without a header adds nothing.
    file : str
        The source's name in messages.

    Yields
    ------
    Row
        The header first.

    Raises
    ------
    CollectionError
        For a sheet with other columns than the first, and for a column called SHEET.
    """
    names: list[str] = []
    number = 0
    for sheet in sheets:
        rows = read(sheet)
        header = next(rows, None)
        if header is None:
            continue
        own = [name.strip() for name in header.cells]
        if not names:
            names = own
            if SHEET in names:
                raise CollectionError(
                    f"{file}: has a column {SHEET!r} of its own; rename it, or name one sheet in [source] sheet"
                )
            yield header._replace(cells=[*header.cells, SHEET])
        if Counter(own) != Counter(names):
            other = ", ".join(map(repr, sorted(set(own) ^ set(names))))
            raise CollectionError(
                f"{file}: sheet {sheet!r} has not the columns of the first: {other}; name them alike, or leave the "
                "sheet out of [source] sheets"
            )
        # Columns of one name keep their order.
        order = list(range(len(own))) if own == names else [own.index(name) for name in names]
        for row in rows:
            number += 1
            faults = {at: row.faults[place] for at, place in enumerate(order) if place in row.faults}
            yield row._replace(number=number, cells=[*(row.cells[at] for at in order), sheet], faults=faults)
