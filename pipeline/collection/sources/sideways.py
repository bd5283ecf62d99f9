"""A table in which each column is an object, as on a sheet of cards side by side -> a row for each object."""

from __future__ import annotations

from collections.abc import Iterator

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.rows import Row

MOST_FIELDS = 2000
"""Rows of such a table: fields of a museum's objects."""


def turned(rows: Iterator[Row], file: str) -> Iterator[Row]:
    """Yield the first cells of all rows as the header, and each further column as a row; an empty one is none.

    The whole table is in memory.

    Parameters
    ----------
    rows : iterator of Row
        The header first, which is the first field of all objects.
    file : str
        The source's name in messages.

    Yields
    ------
    Row
        Its line is the number of its column.

    Raises
    ------
    CollectionError
        For more fields than a museum's objects have.
    """
    table: list[Row] = []
    for row in rows:
        if len(table) == MOST_FIELDS:
            raise CollectionError(
                f"{file}: more than {MOST_FIELDS:,} rows, and [source] sideways takes each for a field of objects that "
                "stand side by side; leave it out where each row is an object"
            )
        table.append(row)
    if not table:
        return
    yield Row(0, table[0].line, [row.cells[0] if row.cells else "" for row in table])
    number = 0
    for at in range(1, len(table[0].cells)):
        cells = [row.cells[at] if at < len(row.cells) else "" for row in table]
        if not any(map(str.strip, cells)):
            continue
        number += 1
        faults = {
            place: row.fault if row.fault[0] else row.faults[at]
            for place, row in enumerate(table)
            if row.fault[0] or at in row.faults
        }
        yield Row(number, at + 1, ["" if place in faults else cell for place, cell in enumerate(cells)], faults=faults)
