"""The tables of the inventory: the states of every object's record, and the imports that brought and ended them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

from sqlalchemy import (
    JSON,
    Boolean,
    Column,
    ColumnElement,
    Connection,
    Double,
    Integer,
    Table,
    Text,
    cast,
    func,
    select,
)

from pipeline.collection.database import METADATA
from pipeline.collection.record import KINDS, STRUCTURED
from pipeline.collection.sealing import seal, seal_column
from pipeline.records import ITEM_FIELDS

NAMED = 500
"""Object numbers in one statement: databases bound the number of parameters."""

_TYPES: dict[str, type[Any]] = {
    "text": Text,
    "number": Double,  # a C double: it comes back bit by bit
    "integer": Integer,
    "flag": Boolean,
    "choice": Text,
    "polygon": JSON,
    "list": JSON,
}
_ALWAYS = {"on_display", *(name for name, kind in KINDS.items() if kind == "text" or kind in STRUCTURED)}

ITEM = Table(
    "item",
    METADATA,
    *(
        Column(name, _TYPES[KINDS[name]](), primary_key=name == "object_number", nullable=name not in _ALWAYS)
        for name in ITEM_FIELDS
    ),
    Column("since", Integer(), primary_key=True, autoincrement=False),
    Column("until", Integer(), nullable=True),
    Column("digest", Text(), nullable=False),
    Column("assessment_digest", Text(), nullable=False, server_default=""),
    seal_column(),
)
"""One row for each state of an object: a column for each field of Item, of the same name; lists as JSON.

since, until      : the imports that brought this state and that ended it; until is null for the state of now
digest            : `record.digest_of` the record: what changed is found by it, and a damaged record is recognised;
                    "" of a record that was found damaged and is to be read anew
assessment_digest : `record.assessment_digest_of` the record; "" of states that ended before it was kept
seal              : of INDEXED: by it the two digests are known to be those that were written with the record
"""

INDEXED = ("object_number", "gallery", "case", "on_display", "digest", "assessment_digest")
"""Columns of ITEM by which objects are found without reading their records."""


def item_seal(*indexed: Any) -> str:
    """Return the seal of a row of ITEM, from the values of INDEXED in their order."""
    return seal(
        *(one if isinstance(one, str) else str(int(one)) if isinstance(one, bool) else repr(one) for one in indexed)
    )


IMPORT_BATCH = Table(
    "import_batch",
    METADATA,
    Column("id", Integer(), primary_key=True),
    Column("imported_at", Text(), nullable=False),
    Column("source", Text(), nullable=False),
    Column("sha256", Text(), nullable=False),
    Column("mapping", Text(), nullable=False),
    Column("museum", Text(), nullable=False),
    Column("credit", Text(), nullable=False),
    Column("rows", Integer(), nullable=False),
    Column("items", Integer(), nullable=False),
    Column("rejected", JSON(), nullable=False),
    Column("kind", Text(), nullable=False, server_default="import"),
    Column("returned_to", Integer(), nullable=True),
    Column("added", Integer(), nullable=False, server_default="0"),
    Column("removed", Integer(), nullable=False, server_default="0"),
    Column("changed", Integer(), nullable=False, server_default="0"),
    seal_column(),
)
"""One row for each version: imported_at is ISO 8601 in UTC, rejected a JSON list of the rows that were kept out.

kind        : "import" of the museum's records, "sheet" of our own measurements, or "return" to an earlier version
returned_to : that earlier version
"""


def state_at(version: int) -> ColumnElement[bool]:
    """Return which rows of ITEM are the inventory as it was after an import."""
    return (ITEM.c.since <= version) & (ITEM.c.until.is_(None) | (ITEM.c.until > version))


def current() -> ColumnElement[bool]:
    """Return which rows of ITEM are the inventory as it is now."""
    return ITEM.c.until.is_(None)


def numbered(numbers: Sequence[str]) -> Iterator[ColumnElement[bool]]:
    """Yield which rows of ITEM are of some objects, for one statement after the other."""
    if len(numbers) == 1:
        # What is asked most, and compiled once.
        yield ITEM.c.object_number == numbers[0]
        return
    for start in range(0, len(numbers), NAMED):
        yield ITEM.c.object_number.in_(numbers[start : start + NAMED])


def doubted(version: int) -> ColumnElement[bool]:
    """Return which rows of ITEM are objects of a version with problems."""
    return state_at(version) & (cast(ITEM.c.problems, Text) != "[]")


def newest(connection: Connection) -> int | None:
    """Return the newest version; None where nothing was imported yet."""
    return connection.execute(select(func.max(IMPORT_BATCH.c.id))).scalar()
