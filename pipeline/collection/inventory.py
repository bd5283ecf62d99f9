"""Kouros's own inventory in SQL: every import is a version of it, and any earlier one can be had back."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from typing import TYPE_CHECKING, Any

from sqlalchemy import (
    JSON,
    BigInteger,
    Boolean,
    Column,
    ColumnElement,
    Connection,
    Double,
    Engine,
    Integer,
    RowMapping,
    Table,
    Text,
    bindparam,
    cast,
    func,
    insert,
    select,
    update,
)

from pipeline.collection import noting, supplement
from pipeline.collection.database import METADATA
from pipeline.collection.errors import CollectionError, ShrunkError
from pipeline.collection.record import KINDS, digest_of, kind_of, to_items, to_records
from pipeline.collection.supplement import filled_in, laid_over
from pipeline.errors import InputError
from pipeline.records import ITEM_FIELDS, Item

if TYPE_CHECKING:
    from pipeline.collection.reading import Reading, Unread

CHUNK = 10_000
"""Rows in one executemany: bounds the memory of a large import."""

NAMED = 500
"""Object numbers in one statement: databases bound the number of parameters."""

_TYPES: dict[str, type[Any]] = {
    "text": Text,
    "number": Double,  # a C double: it comes back bit by bit
    "integer": Integer,
    "flag": Boolean,
    "choice": Text,
    "list": JSON,
}
_ALWAYS = {"on_display", *(name for name, kind in KINDS.items() if kind in ("text", "list"))}

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
    Column("kind", BigInteger(), nullable=True),
)
"""One row for each state of an object: a column for each field of Item, of the same name; lists as JSON.

since, until : the imports that brought this state and that ended it; until is null for the state of now
digest       : of the record, so that an import finds what changed without reading all of it ("" where not known)
kind         : what it shares with objects that may be alike, see `record.kind_of`; null where not known
"""

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
)
"""One row for each version: imported_at is ISO 8601 in UTC, rejected a JSON list of the rows that were kept out.

kind        : "import" of the museum's records, "sheet" of our own measurements, or "return" to an earlier version
returned_to : that earlier version
"""


@dataclass(frozen=True, slots=True)
class ImportInfo:
    """One version: when (ISO 8601, UTC), from which source by which mapping, how its rows were accounted for."""

    id: int
    imported_at: str
    source: str
    sha256: str
    mapping: str
    museum: str
    credit: str
    rows: int
    items: int
    rejected: int
    kind: str
    returned_to: int | None
    added: int
    removed: int
    changed: int


@dataclass(frozen=True, slots=True)
class Counts:
    """What an import changed: objects before and after, of them new, gone, and with a changed record."""

    before: int
    after: int
    added: int
    removed: int
    changed: int


@dataclass(frozen=True, slots=True)
class Difference:
    """What an import changes, object by object.

    before  : how many objects the inventory has
    after   : how many it will have
    added   : object numbers, in the source's order
    removed : object numbers, sorted
    changed : object number -> field -> (the record as it is, the record as it will be), JSON-ready
    """

    before: int
    after: int
    added: tuple[str, ...]
    removed: tuple[str, ...]
    changed: Mapping[str, Mapping[str, tuple[Any, Any]]]

    @property
    def counts(self) -> Counts:
        """How many of each."""
        return Counts(self.before, self.after, len(self.added), len(self.removed), len(self.changed))

    def __bool__(self) -> bool:
        """Whether anything changes."""
        return bool(self.added or self.removed or self.changed)


def replace_inventory(
    engine: Engine,
    reading: Reading,
    *,
    shrink_limit: float = 0.2,
    when: datetime | None = None,
    dry_run: bool = False,
) -> Difference:
    """Make the inventory what the reading says, in one transaction: all of it or nothing.

    What it was before stays as an earlier version.  A reading that says what the last one said makes no new version.
    shrink_limit : the largest share of its objects that the inventory may lose at once, 0 to 1
    when         : the time of the import, with a time zone; None means now
    dry_run      : say what would change, refuse what would be refused, and write nothing
    raises       : ShrunkError where more would be lost, CollectionError for a reading without any usable object,
                   ValueError for a limit outside 0 to 1 or a time without a zone; nothing is written then
    """
    if not 0.0 <= shrink_limit <= 1.0:
        raise InputError(f"shrink_limit must be a share from 0 to 1, not {shrink_limit!r}")
    moment = _moment(when)
    if not reading.objects:
        raise CollectionError(f"{reading.source}: none of its {reading.rows} rows could be used. {_first(reading)}")
    with engine.begin() as connection:
        items = laid_over(reading.items, supplement.current(connection))
        found, digests = _difference(connection, items, reading.unread)
        below = _newest(connection)
        lost = found.before - found.after
        if found.before and lost / found.before > shrink_limit:
            raise ShrunkError(
                f"{reading.source} has {found.after} usable objects, the inventory {found.before}: "
                f"{lost / found.before:.0%} fewer, above the limit of {shrink_limit:.0%}. Nothing was written. "
                f"Check that the export is complete ({len(reading.rejected)} of its rows were rejected); "
                "if the objects are really gone, import again with a higher shrink limit"
            )
        described = _described(reading)
        if dry_run:
            return found
        base, version = None if found else _says(connection, described), below
        if base is None or version is None:
            version = _write(connection, items, digests, found, described | _stamp(moment))
        noting.note_import(connection, version, below, base or version, reading, _doubtful(connection))
    return found


def add_sheet(
    engine: Engine, reading: Reading, *, when: datetime | None = None, dry_run: bool = False
) -> tuple[Difference, list[str]]:
    """Lay a sheet of our own measurements over the inventory; it stays there through all later imports.

    Cells that are empty change nothing; a later sheet's cell replaces an earlier one's.
    dry_run : as in `replace_inventory`
    returns : what changed, and the object numbers of the sheet that the inventory does not have (left out)
    raises  : CollectionError for a sheet without any object of the inventory; ValueError for a time without a zone
    """
    moment = _moment(when)
    with engine.begin() as connection:
        now = list(_read(connection.execute(select(ITEM).where(ITEM.c.until.is_(None))).mappings()))
        there = {item.object_number for item in now}
        unknown = [item.object_number for item in reading.items if item.object_number not in there]
        sheets = supplement.current(connection)
        new = {}
        for item in reading.items:
            record = filled_in(item)
            if record and item.object_number in there:
                _, before = sheets.get(item.object_number, ("", {"provenance": []}))
                older = [of for of in before["provenance"] if of["field"] not in record]
                whole = before | record | {"provenance": [*older, *record["provenance"]]}
                new[item.object_number] = (reading.source, whole)
        if not new:
            raise CollectionError(
                f"{reading.source}: no row fills in anything for an object of the inventory. {_first(reading)}"
            )
        items = laid_over(now, new)
        found, digests = _difference(connection, items)
        if dry_run:
            return found, unknown
        below = version = _newest(connection) or 0
        if found:
            version = _write(
                connection, items, digests, found, _described(reading) | _stamp(moment) | {"kind": "sheet"}
            )
            supplement.store(connection, sheets | new, version)
        filled = {(number, name) for number, (_, record) in new.items() for name in record}
        noting.note_sheet(connection, version, below, reading, set(unknown), filled, _doubtful(connection))
    return found, unknown


def versions(engine: Engine) -> list[ImportInfo]:
    """Return all versions of the inventory, the newest first."""
    with engine.connect() as connection:
        rows = connection.execute(select(IMPORT_BATCH).order_by(IMPORT_BATCH.c.id.desc())).mappings()
        return [_info(row) for row in rows]


def return_to(engine: Engine, version: int, *, when: datetime | None = None, dry_run: bool = False) -> Difference:
    """Make the inventory what it was after an earlier import, as a new version; nothing that came later is lost.

    dry_run : as in `replace_inventory`
    raises  : CollectionError for a version that does not exist, naming those that do; ValueError for a time without a
              zone
    """
    moment = _moment(when)
    with engine.begin() as connection:
        row = connection.execute(select(IMPORT_BATCH).where(IMPORT_BATCH.c.id == version)).mappings().one_or_none()
        if row is None:
            known = connection.execute(select(IMPORT_BATCH.c.id).order_by(IMPORT_BATCH.c.id)).scalars().all()
            there = f"there are {known[0]} to {known[-1]}" if known else "nothing was imported yet"
            raise CollectionError(f"the inventory has no version {version}: {there}; `kouros import --versions` lists")
        items = tuple(_read(connection.execute(select(ITEM).where(state_at(version))).mappings()))
        found, digests = _difference(connection, items)
        if dry_run:
            return found
        kept = {name: row[name] for name in ("source", "sha256", "mapping", "museum", "credit", "rows", "rejected")}
        back = kept | _stamp(moment) | {"kind": "return", "returned_to": version}
        made = _write(connection, items, digests, found, back)
        supplement.store(connection, supplement.current(connection, version), made)
        noting.note_return(connection, made, version)
    return found


def held(engine: Engine, sha256: str) -> int | None:
    """Return the version that a person went back to from this very source, or None: a night must not undo that.

    sha256 : of the source as it is now; once the source has changed, it is read again
    """
    known = versions(engine)
    if not known or known[0].returned_to is None:
        return None
    back = known[0].returned_to
    left = {info.sha256 for info in known if info.id > back and info.kind == "import"}
    return back if sha256 in left else None


def read_inventory(engine: Engine) -> list[Item]:
    """Return all items, sorted by object number; floats are those that were written, bit by bit."""
    with engine.connect() as connection:
        items = list(_read(connection.execute(select(ITEM).where(ITEM.c.until.is_(None))).mappings()))
    # Sorted here and not in SQL: servers collate by the locale of their country.
    return sorted(items, key=lambda item: item.object_number)


def state_at(version: int) -> ColumnElement[bool]:
    """Return which rows of ITEM are the inventory as it was after an import."""
    return (ITEM.c.since <= version) & (ITEM.c.until.is_(None) | (ITEM.c.until > version))


def numbered(numbers: Sequence[str]) -> Iterator[ColumnElement[bool]]:
    """Yield which rows of ITEM are of some objects, for one statement after the other."""
    for start in range(0, len(numbers), NAMED):
        yield ITEM.c.object_number.in_(numbers[start : start + NAMED])


def items_named(engine: Engine, numbers: Sequence[str]) -> dict[str, Item]:
    """Return those of the items that there are, by object number."""
    with engine.connect() as connection:
        return dict(_named(connection, numbers))


def object_numbers(engine: Engine) -> list[str]:
    """Return all object numbers, sorted."""
    with engine.connect() as connection:
        return sorted(connection.execute(select(ITEM.c.object_number).where(ITEM.c.until.is_(None))).scalars())


def fields_since(engine: Engine, number: str, digest: str) -> tuple[str, ...]:
    """Return the fields in which an object's record is not what it was at a digest; none where that is not known."""
    mine = ITEM.c.object_number == number
    last = select(ITEM).where(mine, ITEM.c.digest == digest).order_by(ITEM.c.since.desc()).limit(1)
    with engine.connect() as connection:
        then = list(_read(connection.execute(last).mappings()))
        now = dict(_named(connection, [number]))
    return tuple(_fields_changed(then[0], now[number])) if then and number in now else ()


def latest_import(engine: Engine) -> ImportInfo | None:
    """Return the newest version, or None where nothing was imported yet."""
    newest = select(func.max(IMPORT_BATCH.c.id)).scalar_subquery()
    with engine.connect() as connection:
        row = connection.execute(select(IMPORT_BATCH).where(IMPORT_BATCH.c.id == newest)).mappings().one_or_none()
    return None if row is None else _info(row)


def galleries(items: Iterable[Item]) -> dict[str, int]:
    """Return the galleries that have objects on display, sorted by name, with how many there are in each."""
    counts: dict[str, int] = {}
    for item in items:
        if item.on_display:
            counts[item.gallery] = counts.get(item.gallery, 0) + 1
    return dict(sorted(counts.items()))


def _difference(
    connection: Connection, items: Sequence[Item], unread: Unread | None = None
) -> tuple[Difference, dict[str, str]]:
    """Return what changes, and the digest of every record that is not the one that the inventory has.

    unread : objects that are as the inventory has them and are not among the items
    """
    now = select(ITEM.c.object_number, ITEM.c.digest, ITEM.c.kind).where(ITEM.c.until.is_(None))
    if unread is None:
        rows = list(connection.execute(now))
    else:
        numbers = sorted(unread.gone.union(item.object_number for item in items))
        rows = [row for some in numbered(numbers) for row in connection.execute(now.where(some))]
    # Of what an older version of Kouros wrote, the kind or the digest may not be known.
    old = {row.object_number: "" if row.kind is None else row.digest for row in rows}
    added, differing, digests = [], {}, {}
    for item in items:
        digest = digest_of(item)
        before = old.get(item.object_number)
        if before == digest:
            continue
        digests[item.object_number] = digest
        if before is None:
            added.append(item.object_number)
        else:
            differing[item.object_number] = item
    changed = {}
    for number, then in _named(connection, list(differing)):
        fields = _fields_changed(then, differing[number])
        if fields:
            changed[number] = fields
    removed = sorted(old.keys() - {item.object_number for item in items})
    others = 0 if unread is None else unread.objects
    return Difference(len(old) + others, len(items) + others, tuple(added), tuple(removed), changed), digests


def _fields_changed(then: Item, now: Item) -> dict[str, tuple[Any, Any]]:
    before, after = to_records([then, now])
    return {name: (before[name], after[name]) for name in ITEM_FIELDS if before[name] != after[name]}


def _named(connection: Connection, numbers: Sequence[str]) -> Iterator[tuple[str, Item]]:
    for some in numbered(numbers):
        rows = connection.execute(select(ITEM).where(ITEM.c.until.is_(None), some))
        for item in _read(rows.mappings()):
            yield item.object_number, item


def _write(
    connection: Connection,
    items: Sequence[Item],
    digests: Mapping[str, str],
    found: Difference,
    batch: Mapping[str, Any],
) -> int:
    counts = {"items": found.after, "added": len(found.added), "removed": len(found.removed)}
    record = {**batch, **counts, "changed": len(found.changed)}
    version: int = connection.execute(insert(IMPORT_BATCH).values(record).returning(IMPORT_BATCH.c.id)).scalar_one()
    new = {*found.added, *found.changed}
    ended = [*found.removed, *found.changed]
    for some in numbered(ended):
        connection.execute(update(ITEM).where(ITEM.c.until.is_(None), some).values(until=version))
    same = digests.keys() - new
    if same:
        # The same records, of which an older version of Kouros did not write all.
        told = [
            {"number": item.object_number, "found": digests[item.object_number], "like": kind_of(item)}
            for item in items
            if item.object_number in same
        ]
        mine = (ITEM.c.object_number == bindparam("number")) & ITEM.c.until.is_(None)
        connection.execute(update(ITEM).where(mine).values(digest=bindparam("found"), kind=bindparam("like")), told)
    fresh = [item for item in items if item.object_number in new]
    for start in range(0, len(fresh), CHUNK):
        chunk = fresh[start : start + CHUNK]
        records = to_records(chunk)
        for item, record in zip(chunk, records, strict=True):
            digest = digests[item.object_number]
            record |= {"since": version, "until": None, "digest": digest, "kind": kind_of(item)}
        connection.execute(insert(ITEM), records)
    return version


def _newest(connection: Connection) -> int | None:
    return connection.execute(select(func.max(IMPORT_BATCH.c.id))).scalar()


def doubted(version: int) -> ColumnElement[bool]:
    """Return which rows of ITEM are objects of a version with problems."""
    return state_at(version) & (cast(ITEM.c.problems, Text) != "[]")


def _doubtful(connection: Connection) -> int:
    newest = _newest(connection) or 0
    return connection.execute(select(func.count()).select_from(ITEM).where(doubted(newest))).scalar_one()


def _says(connection: Connection, described: Mapping[str, Any]) -> int | None:
    """Return the newest version, sheets of our own left out, if it is an import of the same source, row for row."""
    newest = select(func.max(IMPORT_BATCH.c.id)).where(IMPORT_BATCH.c.kind != "sheet").scalar_subquery()
    row = connection.execute(select(IMPORT_BATCH).where(IMPORT_BATCH.c.id == newest)).mappings().one_or_none()
    same = row is not None and row["kind"] == "import" and all(row[k] == v for k, v in described.items())
    return int(row["id"]) if same and row is not None else None


def _read(rows: Iterable[Any]) -> Iterator[Item]:
    yield from to_items([{name: row[name] for name in ITEM_FIELDS} for row in rows])


def _moment(when: datetime | None) -> datetime:
    moment = when or datetime.now(UTC)
    if moment.tzinfo is None:
        raise ValueError(f"the time of an import needs a time zone: {moment.isoformat()} has none")
    return moment


def _stamp(moment: datetime) -> dict[str, Any]:
    return {"imported_at": moment.astimezone(UTC).isoformat(timespec="seconds")}


def _described(reading: Reading) -> dict[str, Any]:
    return {
        "source": reading.source,
        "sha256": reading.sha256,
        "mapping": reading.mapping,
        "museum": reading.museum,
        "credit": reading.credit,
        "rows": reading.rows,
        "rejected": [asdict(rejected) for rejected in reading.rejected],
    }


def _info(row: RowMapping) -> ImportInfo:
    return ImportInfo(**{**dict(row), "rejected": len(row["rejected"])})


def _first(reading: Reading) -> str:
    return f"The first: {reading.rejected[0].message}; {reading.rejected[0].remedy}" if reading.rejected else ""
