"""Seals of what is kept in the database: what a disk or a person changed is noticed when it is read again.

A sealed table has a column `seal`, of all the other values of its row as they lie in the database.
"""

import math
from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import cache
from hashlib import blake2b
from typing import Any

from sqlalchemy import (
    JSON,
    Column,
    ColumnElement,
    Connection,
    LargeBinary,
    Select,
    String,
    Table,
    Text,
    and_,
    bindparam,
    cast,
    select,
    type_coerce,
    update,
)
from sqlalchemy.exc import DBAPIError
from sqlalchemy.types import NullType, TypeDecorator

from pipeline.errors import KourosError

_SHOWN = 5
"""Rows that an error names."""

_STREAM = {"yield_per": 1_000}

BACKUP = "nobody but a backup knows what was written: restore the database from one, and see whether the disk is sound"


class DamagedRowsError(KourosError):
    """Rows of the database are not what was written, and cannot be made again.

    Attributes
    ----------
    table : str
        Their table.
    rows : tuple of str
        Their primary keys.
    """

    exit_code = 5

    def __init__(self, table: str, rows: Collection[str], database: str) -> None:
        self.table, self.rows, self.database = table, tuple(rows), database
        # As arguments, so that the error survives the way from another process.
        super().__init__(self.table, self.rows, self.database)

    def __str__(self) -> str:
        return f"{self.database}: {told(self.table, self.rows)}; {BACKUP}"


def told(table: str, rows: Collection[str]) -> str:
    """Return which rows of a table are damaged, in words."""
    shown = ", ".join(map(repr, list(rows)[:_SHOWN])) + (", ..." if len(rows) > _SHOWN else "")
    return f"{len(rows):,} row{'s' if len(rows) != 1 else ''} of the table {table} changed since written ({shown})"


def seal(*parts: str | bytes) -> str:
    """Return the seal of what a row holds.

    Parameters
    ----------
    *parts
        What is sealed, in an order that is always the same.

    Returns
    -------
    str
        BLAKE2b of all parts and of where each of them ends, 128 bits in hexadecimal digits.
    """
    digest = blake2b(digest_size=16)
    for part in parts:
        content = part.encode("utf-8", "surrogatepass") if isinstance(part, str) else part
        digest.update(len(content).to_bytes(8, "little"))
        digest.update(content)
    return digest.hexdigest()


def seal_column() -> Column[str]:
    """Return the column of a sealed table; `write_seals` fills it in the transaction that writes the row."""
    return Column("seal", Text(), nullable=False, server_default="")


def write_seals(connection: Connection, table: Table, condition: ColumnElement[bool] | None = None) -> None:
    """Seal rows of a table as they are now.

    Parameters
    ----------
    connection : Connection
        In the transaction in which the rows were written.
    table : Table
        With a `seal_column`.
    condition : ColumnElement, optional
        Which rows; all where left out.
    """
    at = {column.name: i for i, column in enumerate(_sealed(table)) if column.primary_key}
    values = [
        {f"key_{name}": _key(row[i]) for name, i in at.items()} | {"whole": _seal_of(row[:-1])}
        for row in _rows(connection, table, condition)
    ]
    if values:
        # Keys go back as they came from the database, whatever type they have in Python.
        mine = (type_coerce(table.c[name], NullType()) == bindparam(f"key_{name}", type_=NullType()) for name in at)
        connection.execute(update(table).where(and_(*mine)).values(seal=bindparam("whole")), values)


def sealed(table: Table, row: Mapping[str, Any]) -> dict[str, Any]:
    """Return a row of texts and bytes with its seal, for tables too large to be read again when they are written."""
    return {**row, "seal": _seal_of([row[column.name] for column in _sealed(table)])}


def sound_rows(connection: Connection, table: Table, condition: ColumnElement[bool]) -> tuple[list[Any], list[str]]:
    """Return the rows of a table with a primary key of text that are what was written, and the keys of the others."""
    wanted = _whole(table).where(condition)
    (key,) = table.primary_key.columns
    try:
        rows: Sequence[Any] = connection.execute(wanted).all()
        broken = [row._mapping[key] for row in rows if row.seal != _seal_of(row[:-1])]
    except DBAPIError:
        # What is no text any more stops all that come after it.
        broken = list(damaged_rows(connection, table, condition))
        if not broken:
            raise
        rows = connection.execute(wanted.where(key.not_in(broken))).all()
    return [row for row in rows if row._mapping[key] not in broken] if broken else list(rows), broken


def damaged_rows(connection: Connection, table: Table, condition: ColumnElement[bool] | None = None) -> Iterator[str]:
    """Yield the primary keys, in words, of the rows of a sealed table that are not what was written."""
    at = [i for i, column in enumerate(_sealed(table)) if column.primary_key]
    for row in _rows(connection, table, condition):
        if row[-1] not in (found := _seal_of(row[:-1]), found.encode()):
            yield ", ".join(str(_key(row[i])) for i in at)


def require_sound(connection: Connection, table: Table, condition: ColumnElement[bool] | None = None) -> None:
    """Refuse rows of a sealed table that are not what was written.

    Raises
    ------
    DamagedRowsError
        Naming all of them.
    """
    found = list(damaged_rows(connection, table, condition))
    if found:
        raise DamagedRowsError(table.name, found, connection.engine.url.render_as_string(hide_password=True))


@cache
@cache
def _whole(table: Table) -> Select[Any]:
    return select(*_sealed(table), table.c.seal)


@cache
def _sealed(table: Table) -> list[Column[Any]]:
    # By name: tables that were changed by migrations have their columns in another order.
    return sorted((column for column in table.columns if column.name != "seal"), key=lambda column: column.name)


def _rows(connection: Connection, table: Table, condition: ColumnElement[bool] | None) -> Iterator[Sequence[Any]]:
    """Yield rows as they lie in the database, the seal last: what is no text any more is no error here."""
    lite = connection.dialect.name == "sqlite"
    wanted = select(*(_raw(column, lite).label(column.name) for column in (*_sealed(table), table.c.seal)))
    if condition is not None:
        wanted = wanted.where(condition)
    yield from connection.execute(wanted, execution_options=_STREAM)


def _raw(column: Column[Any], lite: bool) -> ColumnElement[Any]:
    kind = column.type.impl if isinstance(column.type, TypeDecorator) else column.type
    if isinstance(kind, String | JSON):
        return cast(column, LargeBinary if lite else Text)
    return type_coerce(column, NullType())


def _key(value: Any) -> Any:
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else value


def _seal_of(values: Sequence[Any]) -> str:
    return seal(*map(_part, values))


def _part(value: Any) -> str | bytes:
    """Return a value in as much as it is sealed, the same for every database."""
    if value is None:
        return ""
    if isinstance(value, str | bytes | memoryview):
        return b"=" + (value.encode() if isinstance(value, str) else bytes(value))
    if isinstance(value, bool):
        return f"={int(value)}"
    return "=NaN" if isinstance(value, float) and math.isnan(value) else f"={value!r}"
