"""The objects of one version of the inventory, as far as work is divided by them; records are had where they count."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from sqlalchemy import Engine, func, select
from sqlalchemy.exc import DBAPIError

from pipeline.collection.inventory.records import (
    NUMBER_AT,
    DamagedRecordError,
    damaged_now,
    require_all,
    rows_where,
    shown,
    sound,
)
from pipeline.collection.inventory.tables import ITEM, item_seal, newest, numbered, state_at
from pipeline.collection.listing import Listed, Listing
from pipeline.records import Item

_AT_ONCE = 10_000
"""Objects that are listed at a time."""

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

    @cached_property
    def _numbers(self) -> frozenset[str]:
        return frozenset(one.object_number for one in self.objects)

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
        lost = [number for number in numbers if number not in found and number in self._numbers]
        if lost:
            # The listing came from the table, the records by its index: which is damaged.
            raise DamagedRecordError(lost, shown(self.engine))
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


def verify_count(engine: Engine) -> None:
    """Refuse an inventory that has not as many objects as were imported.

    Raises
    ------
    LostRecordsError
    """
    with engine.connect() as connection:
        version = newest(connection) or 0
        there = connection.execute(select(func.count()).select_from(ITEM).where(state_at(version))).scalar_one()
        require_all(connection, version, there)


def object_index(engine: Engine) -> ObjectIndex:
    """Return the objects of the inventory as it is now.

    Raises
    ------
    DamagedRecordError
        Where what they are told apart by is not what was written, or where some are lost.
    """
    parts: list[Listing] = []
    damaged: list[str] = []
    with engine.connect() as connection:
        version = newest(connection) or 0
        wanted = select(*_COLUMNS, ITEM.c.seal).where(state_at(version))
        try:
            # Some at a time: as rows of Python they take several times as much as in columns.
            for rows in connection.execute(wanted, execution_options={"yield_per": _AT_ONCE}).partitions():
                damaged += [str(row[0]) for row in rows if item_seal(*row[:-1]) != row[-1]]
                parts.append(Listing.of([row[:-1] for row in rows]))
        except DBAPIError as problem:
            broken = damaged_now(connection)
            if not broken:
                raise
            raise DamagedRecordError(sorted(broken), shown(engine)) from problem
        if damaged:
            raise DamagedRecordError(damaged, shown(engine))
        require_all(connection, version, sum(map(len, parts)))
    # Sorted here and not in SQL: servers collate by the locale of their country.
    return ObjectIndex(engine, version, Listing.joining(parts).sorted())
