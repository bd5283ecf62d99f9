"""The inventory made what a reading says, or what it was before: each time as a new version, all of it or nothing."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from datetime import UTC, datetime
from typing import Any

from sqlalchemy import Connection, Engine, and_, bindparam, func, insert, select, update

from pipeline.collection.errors import CollectionError, ShrunkError
from pipeline.collection.inventory import local_measurements, reading_report
from pipeline.collection.inventory.differences import Difference, fields_changed, renumbered
from pipeline.collection.inventory.local_measurements import filled_in, laid_over
from pipeline.collection.inventory.records import damaged_now, read_records, require_all, stored_records
from pipeline.collection.inventory.source_rows import SourceKey, store_source
from pipeline.collection.inventory.tables import (
    IMPORT_BATCH,
    ITEM,
    current,
    doubted,
    item_seal,
    newest,
    numbered,
    state_at,
)
from pipeline.collection.reading import Reading, Unread
from pipeline.collection.record import assessment_digest_of, digest_of, to_records
from pipeline.collection.sealing import require_sound, write_seals
from pipeline.errors import InputError
from pipeline.records import Item

CHUNK = 10_000
"""Rows in one executemany: bounds the memory of a large import."""

Digests = Mapping[str, tuple[str, str]]
"""By object number, the digests of a record as a whole and of what its assessment rests on."""


def replace_inventory(
    engine: Engine,
    reading: Reading,
    *,
    shrink_limit: float = 0.2,
    when: datetime | None = None,
    dry_run: bool = False,
    key: SourceKey | None = None,
) -> Difference:
    """Make the inventory what the reading says, in one transaction: all of it or nothing.

    What it was before stays as an earlier version.  A reading that says what the last one said makes no new version.
    A whole reading also mends what has become damaged since it was written.

    Parameters
    ----------
    engine : Engine
        Kouros's own database.
    reading : Reading
        What the museum's source holds.
    shrink_limit : float
        The largest share of its objects that the inventory may lose at once, 0 to 1.
    when : datetime, optional
        The time of the import, with a time zone; now where left out.
    dry_run : bool
        Say what would change, refuse what would be refused, and write nothing.
    key : SourceKey, optional
        What the source was read by: with it what is known of its rows is kept for the next reading.

    Returns
    -------
    Difference
        What the import changes.

    Raises
    ------
    ShrunkError
        Where more would be lost; nothing is written then, nor in the other cases.
    CollectionError
        For a reading without any usable object.
    ValueError
        For a limit outside 0 to 1, or a time without a zone.
    """
    if not 0.0 <= shrink_limit <= 1.0:
        raise InputError(f"shrink_limit must be a share from 0 to 1, not {shrink_limit!r}")
    moment = _moment(when)
    if not reading.objects:
        raise CollectionError(f"{reading.source}: none of its {reading.rows} rows could be used. {_first(reading)}")
    with engine.begin() as connection:
        items = laid_over(reading.items, local_measurements.current(connection))
        found, digests = _difference(connection, items, reading.unread)
        below = newest(connection)
        lost = found.before - found.after
        if found.before and lost / found.before > shrink_limit:
            raise ShrunkError(
                f"{reading.source} has {found.after} usable objects, the inventory {found.before}: "
                f"{lost / found.before:.0%} fewer, above the limit of {shrink_limit:.0%}. Nothing was written. "
                f"Check that the export is complete ({len(reading.rejected)} of its rows were rejected); "
                "if the objects are really gone, import it once by `kouros import` with a higher --shrink-limit"
            )
        described = _described(reading)
        if dry_run:
            return found
        base, version = None if found else _says(connection, described), below
        if base is None or version is None:
            version = _write(connection, items, digests, found, described | _stamp(moment))
        else:
            _write_digests(connection, items, digests)
        reading_report.note_import(connection, version, below, base or version, reading, _doubtful(connection))
        if key is not None:
            store_source(connection, key, reading)
    return found


def add_sheet(
    engine: Engine, reading: Reading, *, when: datetime | None = None, dry_run: bool = False
) -> tuple[Difference, list[str]]:
    """Lay a sheet of our own measurements over the inventory; it stays there through all later imports.

    Cells that are empty change nothing; a later sheet's cell replaces an earlier one's.

    Parameters
    ----------
    engine : Engine
        Kouros's own database.
    reading : Reading
        What the sheet holds.
    when, dry_run
        As in `replace_inventory`.

    Returns
    -------
    found : Difference
        What changed.
    unknown : list of str
        Object numbers of the sheet that the inventory does not have; they are left out.

    Raises
    ------
    CollectionError
        For a sheet without any object of the inventory.
    DamagedRecordError
        For records of the inventory that are not what was written.
    ValueError
        For a time without a zone.
    """
    moment = _moment(when)
    with engine.begin() as connection:
        filled = {item.object_number: record for item in reading.items if (record := filled_in(item))}
        there = _there(connection, [item.object_number for item in reading.items])
        unknown = [item.object_number for item in reading.items if item.object_number not in there]
        sheets = local_measurements.current(connection)
        new = {
            number: _over(sheets.get(number), reading.source, record)
            for number, record in filled.items()
            if number in there
        }
        if not new:
            raise CollectionError(
                f"{reading.source}: no row fills in anything for an object of the inventory. {_first(reading)}"
            )
        # Only their own records: a tablet beside one object does not wait for all those of the museum.
        now = [one for some in numbered(sorted(new)) for one in read_records(connection, and_(current(), some))]
        total = connection.execute(select(func.count()).select_from(ITEM).where(current())).scalar_one()
        items = laid_over(now, new)
        others = Unread(total - len(now), frozenset(), frozenset(), ())
        found, digests = _difference(connection, items, others)
        if dry_run:
            return found, unknown
        below = version = newest(connection) or 0
        if found:
            version = _write(
                connection, items, digests, found, _described(reading) | _stamp(moment) | {"kind": "sheet"}
            )
            local_measurements.store(connection, sheets | new, version)
        cells = {(number, name) for number in new for name in filled[number]}
        reading_report.note_sheet(connection, version, below, reading, set(unknown), cells, _doubtful(connection))
    return found, unknown


def _there(connection: Connection, numbers: Sequence[str]) -> set[str]:
    """Return which objects the inventory has."""
    wanted = select(ITEM.c.object_number).where(current())
    return {row.object_number for some in numbered(numbers) for row in connection.execute(wanted.where(some))}


def _over(before: tuple[str, dict[str, Any]] | None, source: str, record: dict[str, Any]) -> tuple[str, dict[str, Any]]:
    """Return what an object's sheets fill in together; one that says what they say already changes nothing."""
    if before is None:
        return source, record
    older, known = before
    said = {of["field"]: of for of in known["provenance"]}
    same = all(known.get(name) == value for name, value in record.items() if name != "provenance")
    if same and all(_told(said.get(of["field"], {})) == of for of in record["provenance"]):
        return before
    # Who measured what stays with it: a later sheet speaks for its own cells alone.
    kept = [{"sheet": older} | of for of in known["provenance"] if of["field"] not in record]
    return source, known | record | {"provenance": [*kept, *record["provenance"]]}


def _told(of: Mapping[str, Any]) -> dict[str, Any]:
    return {name: value for name, value in of.items() if name != "sheet"}


def return_to(engine: Engine, version: int, *, when: datetime | None = None, dry_run: bool = False) -> Difference:
    """Make the inventory what it was after an earlier import, as a new version; nothing that came later is lost.

    Parameters
    ----------
    engine : Engine
        Kouros's own database.
    version : int
        The earlier version.
    when, dry_run
        As in `replace_inventory`.

    Returns
    -------
    Difference
        What changes.

    Raises
    ------
    CollectionError
        For a version that does not exist, naming those that do.
    DamagedRecordError
        For records of that version that are not what was written.
    ValueError
        For a time without a zone.
    """
    moment = _moment(when)
    with engine.begin() as connection:
        require_sound(connection, IMPORT_BATCH, IMPORT_BATCH.c.id == version)
        row = connection.execute(select(IMPORT_BATCH).where(IMPORT_BATCH.c.id == version)).mappings().one_or_none()
        if row is None:
            known = connection.execute(select(IMPORT_BATCH.c.id).order_by(IMPORT_BATCH.c.id)).scalars().all()
            there = f"there are {known[0]} to {known[-1]}" if known else "nothing was imported yet"
            raise CollectionError(f"the inventory has no version {version}: {there}; `kouros import --versions` lists")
        items = read_records(connection, state_at(version))
        require_all(connection, version, len(items))
        found, digests = _difference(connection, items)
        if dry_run:
            return found
        kept = {name: row[name] for name in ("source", "sha256", "mapping", "museum", "credit", "rows", "rejected")}
        back = kept | _stamp(moment) | {"kind": "return", "returned_to": version}
        made = _write(connection, items, digests, found, back)
        local_measurements.store(connection, local_measurements.current(connection, version), made)
        reading_report.note_return(connection, made, version)
    return found


def _difference(
    connection: Connection, items: Sequence[Item], unread: Unread | None = None, *, verify: bool = True
) -> tuple[Difference, Digests]:
    """Return what changes, and the digests of every record that are not those that the inventory has.

    unread : objects that are as the inventory has them and are not among the items
    verify : whether a record that is not what was written counts as another; where all records are read
    """
    now = select(ITEM.c.object_number, ITEM.c.digest, ITEM.c.assessment_digest).where(current())
    if unread is None:
        rows = list(connection.execute(now))
        damaged = damaged_now(connection) if verify else frozenset()
    else:
        numbers = sorted(unread.numbers.union(item.object_number for item in items))
        rows = [row for some in numbered(numbers) for row in connection.execute(now.where(some))]
        damaged = frozenset()
    old = {number: ("" if number in damaged else digest, assessed) for number, digest, assessed in rows}
    added, differing = [], {}
    digests: dict[str, tuple[str, str]] = {}
    for item in items:
        found = digest_of(item), assessment_digest_of(item)
        before = old.get(item.object_number)
        if before == found:
            continue
        digests[item.object_number] = found
        if before is None:
            added.append(item.object_number)
        elif before[0] != found[0]:
            differing[item.object_number] = item
    then = stored_records(connection, list(differing))
    changed = {}
    for number, item in differing.items():
        # What is no record any more says nothing of what it was.
        fields = fields_changed(then.get(number, Item(number, "")), item)
        if fields:
            changed[number] = fields
    removed = sorted(old.keys() - {item.object_number for item in items})
    others = 0 if unread is None else unread.objects
    new = set(added)
    same = renumbered(
        stored_records(connection, removed if added else []).values(),
        (item for item in items if removed and item.object_number in new),
    )
    counts = len(old) + others, len(items) + others
    return Difference(*counts, tuple(added), tuple(removed), changed, same), digests


def _write(
    connection: Connection, items: Sequence[Item], digests: Digests, found: Difference, batch: Mapping[str, Any]
) -> int:
    counts = {"items": found.after, "added": len(found.added), "removed": len(found.removed)}
    record = {**batch, **counts, "changed": len(found.changed)}
    version: int = connection.execute(insert(IMPORT_BATCH).values(record).returning(IMPORT_BATCH.c.id)).scalar_one()
    write_seals(connection, IMPORT_BATCH, IMPORT_BATCH.c.id == version)
    new = {*found.added, *found.changed}
    for some in numbered([*found.removed, *found.changed]):
        connection.execute(update(ITEM).where(current(), some).values(until=version))
    _write_digests(connection, items, {number: both for number, both in digests.items() if number not in new})
    fresh = [item for item in items if item.object_number in new]
    for start in range(0, len(fresh), CHUNK):
        chunk = fresh[start : start + CHUNK]
        records = to_records(chunk)
        for item, record in zip(chunk, records, strict=True):
            digest, assessed = digests[item.object_number]
            record |= {"since": version, "until": None, "digest": digest, "assessment_digest": assessed}
            record["seal"] = _seal(item, digest, assessed)
        connection.execute(insert(ITEM), records)
    return version


def _seal(item: Item, digest: str, assessed: str) -> str:
    return item_seal(item.object_number, item.gallery, item.case, item.on_display, digest, assessed)


def _write_digests(connection: Connection, items: Sequence[Item], digests: Digests) -> None:
    """Write the digests of records that are the same, and of which the inventory has others."""
    if not digests:
        return
    told = [
        {"number": item.object_number, "whole": both[0], "assessed": both[1], "sealed": _seal(item, *both)}
        for item in items
        for both in (digests.get(item.object_number),)
        if both is not None
    ]
    mine = and_(current(), ITEM.c.object_number == bindparam("number"))
    values = update(ITEM).values(
        digest=bindparam("whole"), assessment_digest=bindparam("assessed"), seal=bindparam("sealed")
    )
    connection.execute(values.where(mine), told)


def _doubtful(connection: Connection) -> int:
    version = newest(connection) or 0
    return connection.execute(select(func.count()).select_from(ITEM).where(doubted(version))).scalar_one()


def _says(connection: Connection, described: Mapping[str, Any]) -> int | None:
    """Return the newest version, sheets of our own left out, if it is an import of the same source, row for row."""
    last = select(func.max(IMPORT_BATCH.c.id)).where(IMPORT_BATCH.c.kind != "sheet").scalar_subquery()
    row = connection.execute(select(IMPORT_BATCH).where(IMPORT_BATCH.c.id == last)).mappings().one_or_none()
    same = row is not None and row["kind"] == "import" and all(row[k] == v for k, v in described.items())
    return int(row["id"]) if same and row is not None else None


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


def _first(reading: Reading) -> str:
    return f"The first: {reading.rejected[0].message}; {reading.rejected[0].remedy}" if reading.rejected else ""
