"""Kouros's own inventory in SQL: every import is a version of it, and any earlier one can be had back."""

from pipeline.collection.inventory.differences import ChangeCounts, Difference
from pipeline.collection.inventory.history import ImportInfo, held, latest_import, versions
from pipeline.collection.inventory.records import (
    DamagedRecord,
    DamagedRecordError,
    fields_since,
    galleries,
    items_named,
    object_numbers,
    read_inventory,
    repair,
    verify_inventory,
)
from pipeline.collection.inventory.tables import IMPORT_BATCH, ITEM
from pipeline.collection.inventory.writing import add_sheet, replace_inventory, return_to

__all__ = [
    "IMPORT_BATCH",
    "ITEM",
    "ChangeCounts",
    "DamagedRecord",
    "DamagedRecordError",
    "Difference",
    "ImportInfo",
    "add_sheet",
    "fields_since",
    "galleries",
    "held",
    "items_named",
    "latest_import",
    "object_numbers",
    "read_inventory",
    "repair",
    "replace_inventory",
    "return_to",
    "verify_inventory",
    "versions",
]
