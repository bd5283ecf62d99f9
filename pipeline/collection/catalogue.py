"""The objects of one version of the inventory, as far as work is divided by them; records are had where they count."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

from sqlalchemy import Engine, func, select

from pipeline.collection.inventory import IMPORT_BATCH, ITEM, NAMED, state_at
from pipeline.collection.record import to_items
from pipeline.records import ITEM_FIELDS, Item


class Listed(NamedTuple):
    """An object in as much as the objects of a collection are sorted by.

    kind : see ITEM
    """

    object_number: str
    gallery: str
    case: str
    on_display: bool
    digest: str
    kind: int | None


@dataclass(frozen=True)
class Catalogue:
    """The objects of one version of the inventory; ``items`` reads their records of that same version.

    version : the import that it is the state after; 0 where nothing was imported
    """

    engine: Engine
    version: int
    objects: tuple[Listed, ...]

    def items(self, numbers: Sequence[str]) -> dict[str, Item]:
        """Return the records of some objects, by number, as they were in this version."""
        return {item.object_number: item for item in read_packed(self.packed(numbers))}

    def packed(self, numbers: Sequence[str]) -> bytes:
        """Return the records of some objects as they were in this version, as JSON that `read_packed` reads.

        Who hands them on need not understand them: that is left to those who work, of whom there are many.
        raises : KeyError for a number that there is no object of
        """
        found: dict[str, list[Any]] = {}
        columns = [ITEM.c[name] for name in ITEM_FIELDS]
        at = ITEM_FIELDS.index("object_number")
        with self.engine.connect() as connection:
            for start in range(0, len(numbers), NAMED):
                some = ITEM.c.object_number.in_(numbers[start : start + NAMED])
                for row in connection.execute(select(*columns).where(state_at(self.version), some)):
                    found[row[at]] = list(row)
        return json.dumps([found[number] for number in numbers], separators=(",", ":")).encode()


def read_packed(records: bytes) -> list[Item]:
    """Return the items that `Catalogue.packed` packed, in the order of the numbers that it was given."""
    return to_items([dict(zip(ITEM_FIELDS, record, strict=True)) for record in json.loads(records)])


def catalogue(engine: Engine) -> Catalogue:
    """Return the objects of the inventory as it is now, sorted by object number."""
    with engine.begin() as connection:
        version = connection.execute(select(func.max(IMPORT_BATCH.c.id))).scalar() or 0
        columns = (ITEM.c.object_number, ITEM.c.gallery, ITEM.c["case"], ITEM.c.on_display, ITEM.c.digest, ITEM.c.kind)
        rows = connection.execute(select(*columns).where(state_at(version)))
        objects = [Listed._make(row) for row in rows]
    # Sorted here and not in SQL: servers collate by the locale of their country.
    return Catalogue(engine, version, tuple(sorted(objects, key=lambda one: one.object_number)))
