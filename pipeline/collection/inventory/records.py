"""Records of the inventory as they are read: each is checked against the digest that it was written with.

A record that a disk or a hand has changed would be assessed as if the museum had said so.  Whoever reads one gets a
`DamagedRecordError` instead; `repair` marks it, and the next reading of the museum's source writes it anew.
"""

from __future__ import annotations

import json
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

from sqlalchemy import ColumnElement, Connection, Engine, Text, and_, cast, func, select, true, update
from sqlalchemy.exc import DBAPIError

from pipeline.collection.inventory.differences import fields_changed
from pipeline.collection.inventory.source_rows import forget_source
from pipeline.collection.inventory.tables import IMPORT_BATCH, INDEXED, ITEM, current, item_seal, newest, numbered
from pipeline.collection.record import KINDS, STRUCTURED, assessment_digest_of, digest_of, to_items
from pipeline.errors import DamageWarning, KourosError
from pipeline.records import ITEM_FIELDS, Item

_LISTS = tuple(at for at, name in enumerate(ITEM_FIELDS) if KINDS[name] in STRUCTURED)

# JSON as it was written: what cannot be read is that record's damage, and not the end of the whole statement.
RECORD_COLUMNS = (
    *(cast(ITEM.c[name], Text).label(name) if KINDS[name] in STRUCTURED else ITEM.c[name] for name in ITEM_FIELDS),
    ITEM.c.digest,
)
"""The columns of a record and its digest, as `checked` reads them."""

_RECORDS = select(*RECORD_COLUMNS)

NUMBER_AT = ITEM_FIELDS.index("object_number")
"""Where the object number stands among them."""

_SHOWN = 5
"""Object numbers that an error names."""

_CHUNK = 1_000
"""Records that are read at a time."""

_STREAM = {"yield_per": _CHUNK}

_HEAD = 4
"""Columns before those of a record, where states are verified."""

_INDEXED_AT = tuple(ITEM_FIELDS.index(name) for name in INDEXED if name in ITEM_FIELDS)


class DamagedRecordError(KourosError):
    """Records of the inventory are not what was written: their digests do not match.

    Attributes
    ----------
    numbers : tuple of str
        Object numbers of the damaged records, as they stand in the database.
    database : str
        The database, without its password.
    """

    exit_code = 5

    def __init__(self, numbers: Iterable[str], database: str) -> None:
        self.numbers, self.database = tuple(numbers), database
        # As arguments, so that the error survives the way from another process.
        super().__init__(self.numbers, self.database)

    def __str__(self) -> str:
        shown = ", ".join(map(repr, self.numbers[:_SHOWN])) + (", ..." if len(self.numbers) > _SHOWN else "")
        count = len(self.numbers)
        return (
            f"{self.database}: {count:,} record{'s' if count != 1 else ''} of the inventory changed since written, in "
            f"which field is not known (object {shown}): see whether the disk is sound, and import the museum's "
            "records again (`kouros import`)"
        )


class LostRecordsError(DamagedRecordError):
    """The inventory has not as many objects as were imported: which are lost, the database does not know.

    Attributes
    ----------
    there, imported : int
        How many it has, and how many it had.
    """

    def __init__(self, there: int, imported: int, database: str) -> None:
        super().__init__((), database)
        self.there, self.imported = there, imported
        self.args = (there, imported, database)

    def __str__(self) -> str:
        return (
            f"{self.database}: the inventory has {self.there:,} objects where {self.imported:,} were imported: see "
            "whether the disk is sound, and import the museum's records again (`kouros import`)"
        )


class DamagedRecord(NamedTuple):
    """A state of an object's record that is not what was written.

    Attributes
    ----------
    object_number : str
        As it stands in the database; it may itself be what is damaged.
    since : int
        The version that brought this state.
    is_current : bool
        Whether it is the object's record of now.
    """

    object_number: str
    since: int
    is_current: bool


def checked(rows: Sequence[Sequence[Any]]) -> list[Item | None]:
    """Return the items of rows with RECORD_COLUMNS, in their order; None for a record that is not what was written."""
    return [
        item if item is not None and digest_of(item) == row[-1] else None
        for item, row in zip(_as_stored(rows), rows, strict=True)
    ]


def _as_stored(rows: Sequence[Sequence[Any]]) -> Sequence[Item | None]:
    """Return the items of rows as they stand; None for what is no record."""
    told = []
    for row in rows:
        values = list(row[:-1])
        try:
            for at in _LISTS:
                values[at] = json.loads(values[at])
        except (ValueError, TypeError):
            values = []
        told.append(dict(zip(ITEM_FIELDS, values, strict=False)))
    try:
        return to_items(told)
    except ValueError:
        return [_item(one) for one in told]


def _item(record: Mapping[str, Any]) -> Item | None:
    try:
        return to_items([record])[0]
    except ValueError:
        return None


def sound(rows: Sequence[Sequence[Any]], database: str) -> list[Item]:
    """Return the items of rows with RECORD_COLUMNS, in their order.

    Parameters
    ----------
    rows : sequence of sequence
        As the database gives them.
    database : str
        Its name in messages, without its password.

    Returns
    -------
    list of Item
        Each checked against its digest.

    Raises
    ------
    DamagedRecordError
        Naming all records that are not what was written.
    """
    items = checked(rows)
    damaged = [str(row[NUMBER_AT]) for row, item in zip(rows, items, strict=True) if item is None]
    if damaged:
        raise DamagedRecordError(damaged, database)
    return [item for item in items if item is not None]


def rows_where(connection: Connection, condition: ColumnElement[bool]) -> Iterator[Sequence[Any]]:
    """Yield the rows of records, as `records_of` takes them.

    Parameters
    ----------
    connection : Connection
        Of the inventory's database.
    condition : ColumnElement of bool
        Which rows of ITEM.

    Yields
    ------
    sequence
        A row.

    Raises
    ------
    DamagedRecordError
        For records that the database cannot even give back as text.
    """
    wanted = _RECORDS.where(condition)
    try:
        yield from connection.execute(wanted, execution_options=_STREAM)
    except DBAPIError as problem:
        numbers = connection.execute(select(ITEM.c.object_number).where(condition)).scalars().all()
        broken = [number for number in numbers if not _readable(connection, ITEM.c.object_number == number)]
        if not broken:
            raise
        raise DamagedRecordError(broken, shown(connection.engine)) from problem


def _readable(connection: Connection, condition: ColumnElement[bool]) -> bool:
    try:
        connection.execute(select(*RECORD_COLUMNS).where(condition)).all()
    except DBAPIError:
        return False
    return True


def read_records(connection: Connection, condition: ColumnElement[bool]) -> list[Item]:
    """Return the items of some rows of ITEM, each checked against its digest.

    Parameters
    ----------
    connection : Connection
        Of the inventory's database.
    condition : ColumnElement of bool
        Which rows.

    Returns
    -------
    list of Item
        In the order of the database.

    Raises
    ------
    DamagedRecordError
        Naming all of them that are not what was written.
    """
    return sound(list(rows_where(connection, condition)), shown(connection.engine))


def stored_records(connection: Connection, numbers: Sequence[str]) -> dict[str, Item]:
    """Return some objects' records of now as they stand, damaged or not.

    Parameters
    ----------
    connection : Connection
        Of the inventory's database.
    numbers : sequence of str
        The museum's numbers of the objects.

    Returns
    -------
    dict of str to Item
        By object number; none that is no record.
    """
    found: dict[str, Item] = {}
    for some in numbered(numbers):
        try:
            rows = list(rows_where(connection, and_(current(), some)))
        except DamagedRecordError as problem:
            sound = and_(current(), some, ITEM.c.object_number.not_in(problem.numbers))
            rows = list(rows_where(connection, sound))
        found |= {item.object_number: item for item in _as_stored(rows) if item is not None}
    return found


def require_all(connection: Connection, version: int, objects: int) -> None:
    """Refuse a version of the inventory that has not as many objects as were imported.

    Raises
    ------
    LostRecordsError
        Where some are lost, or are there that had ended.
    """
    wanted = connection.execute(select(IMPORT_BATCH.c["items"]).where(IMPORT_BATCH.c.id == version)).scalar()
    there = {objects}
    if version == newest(connection):
        # What the next import takes for the state of now is to be the same.
        there.add(connection.execute(select(func.count()).select_from(ITEM).where(current())).scalar_one())
    wrong = there - {wanted}
    if wanted is not None and wrong:
        raise LostRecordsError(min(wrong), wanted, shown(connection.engine))


def read_inventory(engine: Engine) -> list[Item]:
    """Return all items, sorted by object number; floats are those that were written, bit by bit.

    Raises
    ------
    DamagedRecordError
        For records that are not what was written.
    """
    with engine.connect() as connection:
        items = read_records(connection, current())
    # Sorted here and not in SQL: servers collate by the locale of their country.
    return sorted(items, key=lambda item: item.object_number)


def items_named(engine: Engine, numbers: Sequence[str]) -> dict[str, Item]:
    """Return those of the items that there are.

    Parameters
    ----------
    engine : Engine
        The inventory's database.
    numbers : sequence of str
        The museum's numbers of the objects.

    Returns
    -------
    dict of str to Item
        By object number.

    Raises
    ------
    DamagedRecordError
        For records that are not what was written.
    """
    with engine.connect() as connection:
        found = [item for some in numbered(numbers) for item in read_records(connection, and_(current(), some))]
    return {item.object_number: item for item in found}


def images(engine: Engine) -> dict[str, str]:
    """Return what the records call the photographs of objects, by object number; of those that have one."""
    with engine.connect() as connection:
        wanted = select(ITEM.c.object_number, ITEM.c.image).where(current(), ITEM.c.image != "")
        return {row.object_number: row.image for row in connection.execute(wanted)}


def object_numbers(engine: Engine) -> list[str]:
    """Return all object numbers, sorted."""
    with engine.connect() as connection:
        return sorted(connection.execute(select(ITEM.c.object_number).where(current())).scalars())


def fields_since(engine: Engine, number: str, digest: str) -> tuple[str, ...]:
    """Return the fields in which an object's record is not what it was.

    Parameters
    ----------
    engine : Engine
        The inventory's database.
    number : str
        The museum's number of the object.
    digest : str
        Of its record as it was.

    Returns
    -------
    tuple of str
        Empty where that record, or the object, is not known.

    Raises
    ------
    DamagedRecordError
        Where the record of now is not what was written.

    Warns
    -----
    DamageWarning
        The record of then is not what was written.
    """
    mine = ITEM.c.object_number == number
    last = select(*RECORD_COLUMNS).where(mine, ITEM.c.digest == digest).order_by(ITEM.c.since.desc()).limit(1)
    with engine.connect() as connection:
        then = checked(connection.execute(last).all())
        now = read_records(connection, and_(current(), mine))
    if then and then[0] is None:
        problem = f"an earlier record of object {number!r} changed in the database since it was written"
        warnings.warn(f"{problem}: what differs from it is not known", DamageWarning, stacklevel=2)
        return ()
    return tuple(fields_changed(then[0], now[0])) if then and then[0] is not None and now else ()


def galleries(items: Iterable[Item]) -> dict[str, int]:
    """Return the galleries that have objects on display, sorted by name, with how many there are in each."""
    counts: dict[str, int] = {}
    for item in items:
        if item.on_display:
            counts[item.gallery] = counts.get(item.gallery, 0) + 1
    return dict(sorted(counts.items()))


def damaged_now(connection: Connection) -> frozenset[str]:
    """Return the object numbers of the records of now that are not what was written."""
    return frozenset(one.object_number for one in _damaged(connection, current()))


def verify_inventory(engine: Engine) -> Iterator[DamagedRecord]:
    """Yield every state of a record that is not what was written, earlier versions included.

    Parameters
    ----------
    engine : Engine
        Kouros's own database; it is only read.

    Yields
    ------
    DamagedRecord
        In no particular order.
    """
    with engine.connect() as connection:
        yield from _damaged(connection, true())


def repair(engine: Engine, numbers: Sequence[str]) -> None:
    """Mark the records of now of some objects as damaged, so that the next reading of the source writes them anew.

    Until then they stay in the inventory, and reading one raises a `DamagedRecordError`.  What was known of the rows of
    the source is forgotten: all of them are read again.

    Parameters
    ----------
    engine : Engine
        Kouros's own database.
    numbers : sequence of str
        Object numbers, as a `DamagedRecordError` names them.
    """
    with engine.begin() as connection:
        for some in numbered(numbers):
            connection.execute(update(ITEM).where(current(), some).values(digest=""))
        # What is of now came with some version that there is: one from after the newest would be in none.
        last = newest(connection) or 0
        connection.execute(update(ITEM).where(current(), ITEM.c.since > last).values(since=last))
        connection.execute(update(ITEM).where(ITEM.c.until > last).values(until=None))
        forget_source(connection)


def _damaged(connection: Connection, condition: ColumnElement[bool]) -> Iterator[DamagedRecord]:
    wanted = select(ITEM.c.since, ITEM.c.until, ITEM.c.assessment_digest, ITEM.c.seal, *RECORD_COLUMNS).where(condition)
    told = set()
    try:
        for some in connection.execute(wanted, execution_options=_STREAM).partitions(_CHUNK):
            for one in _mismatches(some):
                told.add(one)
                yield one
    except DBAPIError:
        # One that the database cannot give back as text stops all that come after it: one by one, then.
        keys = connection.execute(select(ITEM.c.object_number, ITEM.c.since, ITEM.c.until).where(condition)).all()
        for number, since, until in keys:
            mine = and_(ITEM.c.object_number == number, ITEM.c.since == since)
            try:
                yield from (one for one in _mismatches(connection.execute(wanted.where(mine)).all()) if one not in told)
            except DBAPIError:
                yield DamagedRecord(number, since, until is None)


def _mismatches(rows: Sequence[Sequence[Any]]) -> Iterator[DamagedRecord]:
    items = checked([row[_HEAD:] for row in rows])
    for (since, until, assessed, whole, *record), item in zip(rows, items, strict=True):
        sealed = whole == item_seal(*(record[at] for at in _INDEXED_AT), record[-1], assessed)
        # Of states that ended before it was kept the second digest is not known.
        if item is None or not sealed or (assessed and assessment_digest_of(item) != assessed):
            yield DamagedRecord(str(record[NUMBER_AT]), since, until is None)


def shown(engine: Engine) -> str:
    """Return a database in words, without its password."""
    return engine.url.render_as_string(hide_password=True)
