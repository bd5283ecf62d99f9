"""The objects of one version of the inventory, as far as work is divided by them; records are had where they count."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sqlalchemy import Connection, Engine, func, select

from pipeline.collection.inventory import IMPORT_BATCH, ITEM, numbered, state_at
from pipeline.collection.listing import Listed, Listing, order, read_listing, write_listing
from pipeline.collection.record import to_items
from pipeline.records import ITEM_FIELDS, Item
from pipeline.resources import code_version

FEW = 1_000
"""States that changed since a listing was kept up to which it is brought up to date."""

_COLUMNS = tuple(ITEM.c[name] for name in Listed._fields)


@dataclass(frozen=True)
class Catalogue:
    """The objects of one version of the inventory; ``items`` reads their records of that same version.

    version : the import that it is the state after; 0 where nothing was imported
    objects : sorted by `listing.order`.  A digest that newer code has since written in the place of the one of before
              stands for the same record, and need not have got here; `digests` says what is written now
    """

    engine: Engine
    version: int
    objects: Listing

    def items(self, numbers: Sequence[str]) -> dict[str, Item]:
        """Return the records of some objects, by number, as they were in this version."""
        return {item.object_number: item for item in read_packed(self.packed(numbers))}

    def digests(self, numbers: Sequence[str]) -> dict[str, str]:
        """Return the digests of the records of some objects, by number; what is not there is left out."""
        wanted = select(ITEM.c.object_number, ITEM.c.digest).where(state_at(self.version))
        out: dict[str, str] = {}
        with self.engine.connect() as connection:
            for some in numbered(numbers):
                out |= {row.object_number: row.digest for row in connection.execute(wanted.where(some))}
        return out

    def placed(self) -> set[str]:
        """Return the galleries in which places of objects on display are recorded."""
        known = ITEM.c.position_x_m.is_not(None) & ITEM.c.position_y_m.is_not(None) & ITEM.c.on_display
        with self.engine.connect() as connection:
            wanted = select(ITEM.c.gallery).where(state_at(self.version), known).distinct()
            return set(connection.execute(wanted).scalars())

    def packed(self, numbers: Sequence[str]) -> bytes:
        """Return the records of some objects as they were in this version, as JSON that `read_packed` reads.

        Who hands them on need not understand them: that is left to those who work, of whom there are many.
        raises : KeyError for a number that there is no object of
        """
        found: dict[str, list[Any]] = {}
        columns = [ITEM.c[name] for name in ITEM_FIELDS]
        at = ITEM_FIELDS.index("object_number")
        with self.engine.connect() as connection:
            for some in numbered(numbers):
                for row in connection.execute(select(*columns).where(state_at(self.version), some)):
                    found[row[at]] = list(row)
        return json.dumps([found[number] for number in numbers], separators=(",", ":")).encode()


def read_packed(records: bytes) -> list[Item]:
    """Return the items that `Catalogue.packed` packed, in the order of the numbers that it was given."""
    return to_items([dict(zip(ITEM_FIELDS, record, strict=True)) for record in json.loads(records)])


def catalogue(engine: Engine, kept: Path | None = None) -> Catalogue:
    """Return the objects of the inventory as it is now.

    kept : file in which their listing is kept from night to night: what has changed since is all that is asked for
    """
    with engine.begin() as connection:
        version = connection.execute(select(func.max(IMPORT_BATCH.c.id))).scalar() or 0
        objects = None if kept is None else _brought_up(connection, kept, version)
        if objects is not None:
            return Catalogue(engine, version, objects)
        rows = connection.execute(select(*_COLUMNS).where(state_at(version)))
        # Sorted here and not in SQL: servers collate by the locale of their country.
        objects = Listing.of(sorted(map(Listed._make, rows), key=order))
        told = _told(connection, version)
    # Of a record that an older version of Kouros wrote digest and kind are filled in later, in its place.
    if kept is not None and told is not None and objects.complete:
        write_listing(kept, objects, told)
    return Catalogue(engine, version, objects)


def _brought_up(connection: Connection, kept: Path, version: int) -> Listing | None:
    """Return a listing that was kept with what changed since; None where it is none of this inventory's, or too old."""
    found = read_listing(kept)
    if found is None:
        return None
    listing, told = found
    then = told.get("version")
    if not isinstance(then, int) or told != _told(connection, then):
        return None
    if then < version:
        since = ITEM.c.since.between(then + 1, version)
        until = (ITEM.c.since <= then) & ITEM.c.until.between(then + 1, version)
        gone = connection.execute(select(ITEM.c.object_number).where(until).limit(FEW + 1)).scalars().all()
        new = connection.execute(select(*_COLUMNS).where(since, state_at(version)).limit(FEW + 1)).all()
        if len(gone) > FEW or len(new) > FEW:
            return None
        listing = listing.changed(gone, map(Listed._make, new))
    # What does not add up, whatever the reason, is asked for anew.
    items = connection.execute(select(IMPORT_BATCH.c["items"]).where(IMPORT_BATCH.c.id == version)).scalar()
    return listing if items == len(listing) else None


def _told(connection: Connection, version: int) -> dict[str, Any] | None:
    """Return what says which version of which inventory a listing is of; None where there is no such version."""
    row = connection.execute(select(IMPORT_BATCH).where(IMPORT_BATCH.c.id == version)).one_or_none()
    if row is None:
        return None
    batch = hashlib.sha256(repr(tuple(row)).encode("utf-8", "surrogatepass")).hexdigest()
    return {"version": version, "import": batch, "code": code_version()}
