"""Digests of the rows of the museum's source: by them a night reads only those that are not as they were.

A row is known by the digest of its cells with the header (`reading.row_digest`).  All of it holds only for the version
of the inventory, the mapping, the code and the limits that it was written with; else the source is read from scratch.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from hashlib import blake2b

from sqlalchemy import Column, Connection, Engine, Integer, Table, Text, bindparam, delete, insert, select

from pipeline.collection.database import METADATA
from pipeline.collection.inventory.tables import newest
from pipeline.collection.reading import KnownRow, Reading
from pipeline.collection.sealing import damaged_rows, seal_column, write_seals

_LOG = logging.getLogger(__name__)

SOURCE_ROW = Table(
    "source_row",
    METADATA,
    Column("digest", Text(), primary_key=True),
    Column("object_number", Text(), nullable=False),
    Column("noted", Text(), nullable=True),
    Column("evidence", Text(), nullable=True),
    Column("checksum", Text(), nullable=False),
    sqlite_with_rowid=False,
)
"""One row for each row of the source that became an object.

digest        : of its cells and the header
object_number : of its object
noted         : field, message and remedy of each of its problems, as JSON; null where it has none
evidence      : what it says about the units of the whole source (`unit_audit.Evidence`), as JSON; null for nothing
checksum      : of the four
"""

SOURCE_STATE = Table(
    "source_state",
    METADATA,
    Column("id", Integer(), primary_key=True, autoincrement=False),
    *(Column(name, Text(), nullable=False) for name in ("source", "sha256", "mapping", "code", "limits")),
    Column("version", Integer(), nullable=False),
    Column("rows", Integer(), nullable=False),
    seal_column(),
)
"""At most one row: of which source the inventory is the state, and how it was read.

source  : the path of the file; of a database's address, which may hold what is nobody's business, a digest
sha256  : of what was read
mapping : digest of the mapping;  code : of the code that reads;  limits : what was accepted, as JSON
version : of the inventory that it led to
rows    : of SOURCE_ROW; 0 where the inventory is not the state of the source's rows, as after a person's return
"""

_CHUNK = 10_000
"""Rows in one executemany: bounds the memory of a large import."""


@dataclass(frozen=True, slots=True)
class SourceKey:
    """What the meaning of a row hangs on besides its cells.

    Attributes
    ----------
    source : str
        Which source it is.
    mapping : str
        Digest of the mapping.
    code : str
        Digest of the code that reads.
    limits : str
        What is accepted, as JSON.
    """

    source: str
    mapping: str
    code: str
    limits: str


def is_unchanged(engine: Engine, key: SourceKey, sha256: str) -> bool:
    """Say whether a source is the one that the inventory is the state of, byte for byte, and would be read alike.

    Parameters
    ----------
    engine : Engine
        The inventory's database.
    key : SourceKey
        Of the source, and how it is read.
    sha256 : str
        Of its bytes.

    Returns
    -------
    bool
        Whether there is nothing to read.
    """
    with engine.connect() as connection:
        state = _state(connection, key)
    return state is not None and state[0] == sha256


def known_rows(engine: Engine, key: SourceKey) -> dict[str, KnownRow] | None:
    """Return what is known of the rows of a source, by their digests.

    Parameters
    ----------
    engine : Engine
        Kouros's own database.
    key : SourceKey
        Of the source as it would be read now.

    Returns
    -------
    dict of str to KnownRow, or None
        None where the inventory is not the state of this source, or where what is kept is damaged: then everything is
        to be read.
    """
    with engine.connect() as connection:
        state = _state(connection, key)
        if state is None or not state[1]:
            return None
        found: dict[str, KnownRow] = {}
        for digest, number, noted, evidence, checksum in connection.execute(select(*SOURCE_ROW.c)):
            if _checksum(digest, number, noted, evidence) != checksum:
                found.clear()
                break
            found[digest] = KnownRow(number, noted, evidence)
    if len(found) == state[1]:
        return found
    _LOG.warning("what was known of the source's rows is damaged: all of them are read again")
    return None


def damaged_source_rows(engine: Engine) -> Iterator[str]:
    """Yield the digests of the rows of the source of which what is known is not what was written."""
    with engine.connect() as connection:
        rows = connection.execute(select(*SOURCE_ROW.c), execution_options={"yield_per": _CHUNK})
        for digest, *told, checksum in rows:
            if _checksum(digest, *told) != checksum:
                yield str(digest)


def store_source(connection: Connection, key: SourceKey, reading: Reading) -> None:
    """Take down what is known of the rows of a source, in the transaction that makes the inventory their state.

    Parameters
    ----------
    connection : Connection
        Of that transaction.
    key : SourceKey
        Of the source, and how it is read.
    reading : Reading
        What was read.
    """
    if reading.unread is None:
        connection.execute(delete(SOURCE_ROW))
    elif reading.unread.gone:
        gone = [{"row": digest} for digest in reading.unread.gone]
        connection.execute(delete(SOURCE_ROW).where(SOURCE_ROW.c.digest == bindparam("row")), gone)
    # In the order of the key: else every row is put into another page of the table.
    new = sorted(reading.known.items())
    for start in range(0, len(new), _CHUNK):
        rows = [
            {"digest": digest, **row._asdict(), "checksum": _checksum(digest, *row)}
            for digest, row in new[start : start + _CHUNK]
        ]
        connection.execute(insert(SOURCE_ROW), rows)
    _store_state(connection, key, reading.sha256, reading.objects)


def hold_source(engine: Engine, key: SourceKey, sha256: str) -> None:
    """Take down that a source was looked at, and that the inventory is by a person's will not the state of its rows.

    Parameters
    ----------
    engine : Engine
        The inventory's database.
    key : SourceKey
        Of the source, and how it is read.
    sha256 : str
        Of its bytes.
    """
    with engine.begin() as connection:
        connection.execute(delete(SOURCE_ROW))
        _store_state(connection, key, sha256, 0)


def forget_source(connection: Connection) -> None:
    """Forget what is known of the rows of the source, so that all of them are read again."""
    connection.execute(delete(SOURCE_STATE))
    connection.execute(delete(SOURCE_ROW))


def _state(connection: Connection, key: SourceKey) -> tuple[str, int] | None:
    """Return the digest of the source and how many of its rows are known; None where the key or the version differs."""
    if any(damaged_rows(connection, SOURCE_STATE)):
        _LOG.warning("what was known of the source is damaged: all of it is read again")
        return None
    row = connection.execute(select(SOURCE_STATE)).mappings().one_or_none()
    if row is None or row["version"] != newest(connection):
        return None
    wanted: Mapping[str, str] = asdict(key)
    return (row["sha256"], row["rows"]) if all(row[name] == value for name, value in wanted.items()) else None


def _store_state(connection: Connection, key: SourceKey, sha256: str, rows: int) -> None:
    connection.execute(delete(SOURCE_STATE))
    state = {"id": 1, **asdict(key), "sha256": sha256, "version": newest(connection) or 0, "rows": rows}
    connection.execute(insert(SOURCE_STATE), state)
    write_seals(connection, SOURCE_STATE)


def _checksum(*told: str | None) -> str:
    return blake2b(repr(told).encode("utf-8", "surrogatepass"), digest_size=8).hexdigest()
