"""Kouros's own inventory in SQL: what the last import brought, and the history of the imports."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

from sqlalchemy import (
    JSON,
    Boolean,
    Column,
    Double,
    Engine,
    Integer,
    Table,
    Text,
    delete,
    func,
    insert,
    select,
)

from pipeline.collection.database import METADATA
from pipeline.collection.errors import CollectionError, ShrunkError
from pipeline.collection.record import KINDS, to_items, to_records
from pipeline.records import ITEM_FIELDS, Item

if TYPE_CHECKING:
    from pipeline.collection.reading import Reading

CHUNK = 10_000
"""Rows in one executemany: bounds the memory of a large import."""

_TYPES: dict[str, type[Any]] = {
    "text": Text,
    "number": Double,  # a C double: it comes back bit by bit
    "integer": Integer,
    "flag": Boolean,
    "choice": Text,
    "problems": JSON,
}
_ALWAYS = {"on_display", "problems", *(name for name, kind in KINDS.items() if kind == "text")}

ITEM = Table(
    "item",
    METADATA,
    *(
        Column(name, _TYPES[KINDS[name]](), primary_key=name == "object_number", nullable=name not in _ALWAYS)
        for name in ITEM_FIELDS
    ),
)
"""One column for each field of Item, of the same name; problems as a JSON list of objects."""

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
)
"""One row for each import; imported_at is ISO 8601 in UTC, rejected a JSON list of the rows that were kept out."""


@dataclass(frozen=True, slots=True)
class ImportInfo:
    """One import: when (ISO 8601, UTC), from which file by which mapping, and how its rows were accounted for."""

    imported_at: str
    source: str
    sha256: str
    mapping: str
    museum: str
    credit: str
    rows: int
    items: int
    rejected: int


@dataclass(frozen=True, slots=True)
class Counts:
    """What an import changed: objects before and after, of them new, gone, and with a changed record."""

    before: int
    after: int
    added: int
    removed: int
    changed: int


def replace_inventory(
    engine: Engine, reading: Reading, *, shrink_limit: float = 0.2, when: datetime | None = None
) -> Counts:
    """Make the inventory what the reading says, in one transaction: all of it or nothing.

    shrink_limit : the largest share of its objects that the inventory may lose at once, 0 to 1
    when         : the time of the import, with a time zone; None means now
    raises       : ShrunkError where more would be lost, CollectionError for a reading without any usable object,
                   ValueError for a limit outside 0 to 1 or a time without a zone; nothing is written then
    """
    if not 0.0 <= shrink_limit <= 1.0:
        raise ValueError(f"shrink_limit must be a share from 0 to 1, not {shrink_limit!r}")
    moment = when or datetime.now(UTC)
    if moment.tzinfo is None:
        raise ValueError(f"the time of an import needs a time zone: {moment.isoformat()} has none")
    if not reading.items:
        raise CollectionError(f"{reading.source}: none of its {reading.rows} rows could be used. {_first(reading)}")
    with engine.begin() as connection:
        old = {item.object_number: item for item in _read(connection.execute(select(ITEM)).mappings())}
        lost = len(old) - len(reading.items)
        if old and lost / len(old) > shrink_limit:
            raise ShrunkError(
                f"{reading.source} has {len(reading.items)} usable objects, the inventory {len(old)}: "
                f"{lost / len(old):.0%} fewer, above the limit of {shrink_limit:.0%}. Nothing was written. "
                f"Check that the export is complete ({len(reading.rejected)} of its rows were rejected); "
                "if the objects are really gone, import again with a higher shrink limit"
            )
        connection.execute(delete(ITEM))
        for chunk in _chunks(reading.items):
            connection.execute(insert(ITEM), to_records(chunk))
        connection.execute(insert(IMPORT_BATCH), _batch(reading, moment))
    kept = [item for item in reading.items if item.object_number in old]
    return Counts(
        before=len(old),
        after=len(reading.items),
        added=len(reading.items) - len(kept),
        removed=len(old) - len(kept),
        changed=sum(old[item.object_number] != item for item in kept),
    )


def read_inventory(engine: Engine) -> list[Item]:
    """Return all items, sorted by object number; floats are those that were written, bit by bit."""
    with engine.connect() as connection:
        items = list(_read(connection.execute(select(ITEM)).mappings()))
    # Sorted here and not in SQL: servers collate by the locale of their country.
    return sorted(items, key=lambda item: item.object_number)


def latest_import(engine: Engine) -> ImportInfo | None:
    """Return the last import, or None where nothing was imported yet."""
    newest = select(func.max(IMPORT_BATCH.c.id)).scalar_subquery()
    with engine.connect() as connection:
        row = connection.execute(select(IMPORT_BATCH).where(IMPORT_BATCH.c.id == newest)).mappings().one_or_none()
    if row is None:
        return None
    known = {key: value for key, value in row.items() if key != "id"}
    return ImportInfo(**{**known, "rejected": len(row["rejected"])})


def galleries(items: Iterable[Item]) -> dict[str, int]:
    """Return the galleries that have objects on display, sorted by name, with how many there are in each."""
    counts: dict[str, int] = {}
    for item in items:
        if item.on_display:
            counts[item.gallery] = counts.get(item.gallery, 0) + 1
    return dict(sorted(counts.items()))


def _read(rows: Iterable[Any]) -> Iterator[Item]:
    yield from to_items([dict(row) for row in rows])


def _chunks(items: tuple[Item, ...]) -> Iterator[list[Item]]:
    for start in range(0, len(items), CHUNK):
        yield list(items[start : start + CHUNK])


def _batch(reading: Reading, moment: datetime) -> dict[str, Any]:
    return {
        "imported_at": moment.astimezone(UTC).isoformat(timespec="seconds"),
        "source": reading.source,
        "sha256": reading.sha256,
        "mapping": reading.mapping,
        "museum": reading.museum,
        "credit": reading.credit,
        "rows": reading.rows,
        "items": len(reading.items),
        "rejected": [asdict(rejected) for rejected in reading.rejected],
    }


def _first(reading: Reading) -> str:
    return f"The first: {reading.rejected[0].message}; {reading.rejected[0].remedy}" if reading.rejected else ""
