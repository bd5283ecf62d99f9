"""The objects of one version of the inventory, as far as work is divided by them; records are had where they count."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from sqlalchemy import Engine, select

from pipeline.collection.inventory.records import NUMBER_AT, rows_where, shown, sound
from pipeline.collection.inventory.tables import ITEM, newest, numbered, state_at
from pipeline.collection.listing import Listed, Listing
from pipeline.records import Item

_COLUMNS = tuple(ITEM.c[name] for name in Listed._fields)


@dataclass(frozen=True)
class ObjectIndex:
    """The objects of one version of the inventory; ``items`` reads their records of that same version.

    Attributes
    ----------
    engine : Engine
        Kouros's own database.
    version : int
        The import that it is the state after; 0 where nothing was imported.
    objects : Listing
        Sorted by `listing.order`.
    """

    engine: Engine
    version: int
    objects: Listing

    def items(self, numbers: Sequence[str]) -> dict[str, Item]:
        """Return the records of some objects, by number, as they were in this version.

        Raises
        ------
        KeyError
            For a number that there is no object of.
        DamagedRecordError
            For records that are not what was written.
        """
        return {item.object_number: item for item in read_packed(self.packed(numbers))}

    def digests(self, numbers: Sequence[str]) -> dict[str, str]:
        """Return the digests of the records of some objects, by number; what is not there is left out."""
        places = self.objects.places(numbers)
        return {number: self.objects[at].digest for number, at in places.items()}

    def placed(self) -> set[str]:
        """Return the galleries in which places of objects on display are recorded."""
        known = ITEM.c.position_x_m.is_not(None) & ITEM.c.position_y_m.is_not(None) & ITEM.c.on_display
        with self.engine.connect() as connection:
            wanted = select(ITEM.c.gallery).where(state_at(self.version), known).distinct()
            return set(connection.execute(wanted).scalars())

    def packed(self, numbers: Sequence[str]) -> bytes:
        """Return the records of some objects as they were in this version, as JSON that `read_packed` reads.

        Who hands them on need not understand them: that is left to those who work, of whom there are many.

        Raises
        ------
        KeyError
            For a number that there is no object of.
        DamagedRecordError
            For records that the database cannot even give back as text.
        """
        found: dict[str, list[Any]] = {}
        with self.engine.connect() as connection:
            for some in numbered(numbers):
                found |= {row[NUMBER_AT]: list(row) for row in rows_where(connection, state_at(self.version) & some)}
        told = [shown(self.engine), [found[number] for number in numbers]]
        return json.dumps(told, separators=(",", ":")).encode()


def read_packed(records: bytes) -> list[Item]:
    """Return the items that `ObjectIndex.packed` packed, in the order of the numbers that it was given.

    Raises
    ------
    DamagedRecordError
        Naming all records that are not what was written.
    """
    database, rows = json.loads(records)
    return sound(rows, database)


def object_index(engine: Engine) -> ObjectIndex:
    """Return the objects of the inventory as it is now."""
    with engine.connect() as connection:
        version = newest(connection) or 0
        rows = connection.execute(select(*_COLUMNS).where(state_at(version))).all()
    # Sorted here and not in SQL: servers collate by the locale of their country.
    return ObjectIndex(engine, version, Listing.of(rows).sorted())
