"""The objects of a page in the database, under a digest of them, and how runs that nobody needs leave it."""

import json
import zlib
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

from sqlalchemy import Connection, Engine, delete, insert, select, update

from pipeline.analysis.faults import with_fault
from pipeline.analysis.survey import in_order
from pipeline.collection.object_index import read_packed
from pipeline.collection.sealing import seal, sealed, sound_rows
from pipeline.records import ITEM_FIELDS, Found, Item, MeasurementRequest, Page, Result
from pipeline.store.codec import StoreError
from pipeline.store.results import DamagedRunError, Made, decode, decode_spacings, fetch, forget, made_of, of_object
from pipeline.store.tables import PAGE, RESULT, RUN, RUN_PAGE

NEIGHBOURS = "how near its neighbours come is not known"

_AT_ONCE = 20
"""Pages that are read at a time: each may be a few hundred kilobytes."""


@dataclass(frozen=True)
class Members:
    """The objects of a page, in their order.

    Attributes
    ----------
    items
        Their records, packed as `collection` packs them.
    fields
        Names of the fields of a packed record.
    digests
        Of their records.
    results
        Of each the key of its unit's results, and which of these it has.
    spacings
        Key of the gaps between the neighbours of its gallery; "" where there are none.
    """

    items: bytes
    digests: tuple[str, ...]
    results: tuple[tuple[str, int], ...]
    spacings: str = ""
    fields: tuple[str, ...] = ITEM_FIELDS

    @property
    def keys(self) -> list[str]:
        """The keys of all results, each once."""
        return list(dict.fromkeys(key for key, _ in self.results))

    @property
    def wanted(self) -> list[str]:
        """The keys of all that must be had to show the page: the results, and the gaps where there are any."""
        return [*self.keys, *filter(None, [self.spacings])]

    @cached_property
    def _rows(self) -> list[list[Any]]:
        rows: list[list[Any]] = json.loads(self.items)[1]
        return rows

    def column(self, name: str) -> list[Any]:
        """Return one field of all records."""
        at = self.fields.index(name)
        return [row[at] for row in self._rows]

    def packed(self) -> bytes:
        """Return what is kept."""
        head = {"fields": self.fields, "digests": self.digests, "results": self.results, "spacings": self.spacings}
        return zlib.compress(json.dumps(head, separators=(",", ":")).encode() + b"\n" + self.items, 1)

    @classmethod
    def of_packed(cls, content: bytes) -> "Members":
        """Read what `packed` gave.

        Raises
        ------
        StoreError
            Where it is damaged.
        """
        try:
            head, _, items = zlib.decompress(content).partition(b"\n")
            told = json.loads(head)
            results = tuple((str(key), int(at)) for key, at in told["results"])
            return cls(items, tuple(told["digests"]), results, str(told["spacings"]), tuple(told["fields"]))
        except (zlib.error, ValueError, KeyError, TypeError) as error:
            raise StoreError(f"a page is damaged: {error}; the database was changed by hand or is broken") from error

    def read(self) -> list[Item]:
        """Return the records.

        Raises
        ------
        DamagedRecordError
            Where one is not what was written.
        """
        return read_packed(self.items)


def found_of(members: Members, kept: Mapping[str, bytes]) -> Found:
    """Return everything that was found about the objects of a page.

    Parameters
    ----------
    members
        Of the page.
    kept
        Results by key, as they are kept.

    Raises
    ------
    StoreError
        Where a result is not there, or damaged.
    """
    try:
        results = {key: decode(kept[key]) for key in members.keys}
        gaps, failed = decode_spacings(kept[members.spacings]) if members.spacings else ((), {})
    except KeyError as error:
        raise StoreError(f"there is no result {error.args[0][:12]}; it was pruned while it was read") from error
    pairs = [(results[key][at], item) for (key, at), item in zip(members.results, members.read(), strict=True)]
    assessments = tuple(of_object(result, item) for result, item in pairs)
    numbers = {item.object_number for _, item in pairs}
    asked = bool(pairs) and all(result.wishes is not None for result, _ in pairs)
    wishes = [one for result, item in pairs for one in _wishes(result, item)]
    if failed.keys() & numbers:
        assessments = tuple(
            with_fault(one, failed[one.scene.item.object_number], NEIGHBOURS)
            if one.scene.item.object_number in failed
            else one
            for one in assessments
        )
    return Found(
        assessments,
        tuple(in_order(wishes)) if asked else None,
        tuple(gap for gap in gaps if gap.first in numbers),
        {item.object_number: result.needing for result, item in pairs if result.needing},
    )


def page_digest(digests: Sequence[str], results: Sequence[tuple[str, int]], spacings: str) -> str:
    """Return the key of a page.

    Parameters
    ----------
    digests
        Of the records of its objects, their numbers and places among them.
    results
        Of each the key of its unit's results, and which of these it has.
    spacings
        Key of the gaps between the neighbours of its gallery.
    """
    return seal(*digests, *(f"{key} {at}" for key, at in results), spacings)


def page_row(page: Page, members: Members) -> dict[str, Any]:
    """Return a page as a row of its table."""
    return sealed(PAGE, {"key": page.key, "run_id": page.run, "made": page.made, "members": members.packed()})


def add_pages(connection: Connection, rows: Iterable[Mapping[str, Any]], damaged: Collection[str] = ()) -> None:
    """Write pages that are not there yet, as a part of a transaction.

    Parameters
    ----------
    damaged : collection of str, optional
        Keys of pages that are there and are not what was written; these are written anew.
    """
    for row in rows:
        mine = PAGE.c.key == row["key"]
        if row["key"] in damaged:
            connection.execute(update(PAGE).where(mine).values(dict(row)))
        elif connection.execute(select(PAGE.c.key).where(mine)).scalar() is None:
            connection.execute(insert(PAGE), [dict(row)])


def known_pages(engine: Engine, keys: Collection[str]) -> tuple[dict[str, Made], list[str]]:
    """Return of those pages that there are the newest of their results, by key, and the keys of those damaged."""
    with engine.connect() as connection:
        return made_of(connection, PAGE, keys, _AT_ONCE)


def fetch_members(connection: Connection, key: str) -> tuple[Members | None, bool]:
    """Return the objects of a page, None where they cannot be had, and whether that is because it is damaged."""
    rows, broken = sound_rows(connection, PAGE, PAGE.c.key == key)
    return (Members.of_packed(bytes(rows[0].members)) if rows else None), bool(broken)


def load_members(connection: Connection, key: str) -> Members:
    """Return the objects of a page.

    Raises
    ------
    DamagedRunError
        Where there is no such page, or where it is damaged.
    """
    members, damaged = fetch_members(connection, key)
    if members is None:
        why = "is damaged: the database was changed by hand or is broken" if damaged else "was pruned while it was read"
        raise DamagedRunError(f"page {key[:12]} {why}; choose another run")
    return members


def load_page(database: Engine | Connection, key: str) -> Found:
    """Return everything that was found about the objects of a page.

    Raises
    ------
    StoreError
        Where there is no such page, or where something of it is gone or damaged.
    """
    if isinstance(database, Engine):
        with database.connect() as connection:
            return load_page(connection, key)
    members = load_members(database, key)
    kept, damaged = fetch(database, members.wanted)
    if damaged:
        raise StoreError(
            f"result {damaged[0][:12]} is damaged: the database was changed by hand or is broken; `kouros run` makes "
            "it again"
        )
    return found_of(members, {key: one.found for key, one in kept.items()})


Places = Mapping[str, tuple[str, int, str]]
"""By object number: the key of its unit's results, which of these it has, and the digest of its record."""


def load_places(database: Engine, key: str) -> Places:
    """Return where the results of the objects of a page are.

    Raises
    ------
    DamagedRunError
        Where there is no such page, or where it is damaged.
    """
    with database.connect() as connection:
        members = load_members(connection, key)
    told = zip(members.column("object_number"), members.results, members.digests, strict=True)
    return {number: (result, at, digest) for number, (result, at), digest in told}


def load_one(database: Engine, key: str, at: int, item: Item) -> Found:
    """Return everything that was found about one object, but for its neighbours.

    Parameters
    ----------
    database
        Of the store.
    key, at
        Of its unit's results, and which of these it has (see `load_places`).
    item
        Its record.

    Raises
    ------
    StoreError
        Where the result is gone or damaged.
    """
    kept, _ = fetch(database, [key])
    if key not in kept:
        raise StoreError(f"result {key[:12]} is gone or damaged; `kouros run` makes it again")
    result = decode(kept[key].found)[at]
    return Found((of_object(result, item),), None if result.wishes is None else tuple(in_order(_wishes(result, item))))


def _wishes(result: Result, item: Item) -> list[MeasurementRequest]:
    """Return what is worth measuring on an object, with its name."""
    named = (item.object_number, item.gallery, item.title)
    return [replace(one, object_number=named[0], gallery=named[1], title=named[2]) for one in result.wishes or ()]


def remove_runs(engine: Engine, run_ids: Iterable[str]) -> None:
    """Remove runs, each in a transaction of its own, and then the pages and the results that no run holds.

    What an interrupted run found belongs to no run, and is lost here: a good run came after it.  The space is used
    again by later runs; an SQLite file does not become smaller by itself.

    Parameters
    ----------
    run_ids : iterable of str
        One that is not there is passed by.
    """
    for run_id in run_ids:
        with engine.begin() as connection:
            connection.execute(delete(RUN).where(RUN.c.run_id == run_id))
    with engine.begin() as connection:
        connection.execute(delete(PAGE).where(PAGE.c.key.not_in(select(RUN_PAGE.c.key))))
    used: set[str] = set()
    with engine.connect() as connection:
        # Page by page: a page names a thousand results.
        for key in connection.execute(select(PAGE.c.key)).scalars().all():
            members, _ = fetch_members(connection, key)
            used.update([] if members is None else members.wanted)
        there = set(connection.execute(select(RESULT.c.key)).scalars())
    forget(engine, there - used)
