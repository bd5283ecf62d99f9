"""Differences that an import makes in the inventory, object by object."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pipeline.collection.record import to_records
from pipeline.records import ITEM_FIELDS, Item


@dataclass(frozen=True, slots=True)
class ChangeCounts:
    """What an import changed: objects before and after, of them new, gone, and with a changed record."""

    before: int
    after: int
    added: int
    removed: int
    changed: int


@dataclass(frozen=True, slots=True)
class Difference:
    """What an import changes, object by object.

    Attributes
    ----------
    before, after : int
        How many objects the inventory has, and will have.
    added : tuple of str
        Object numbers, in the source's order.
    removed : tuple of str
        Object numbers, sorted.
    changed : mapping of str
        Object number -> field -> (the record as it is, the record as it will be), JSON-ready.
    """

    before: int
    after: int
    added: tuple[str, ...]
    removed: tuple[str, ...]
    changed: Mapping[str, Mapping[str, tuple[Any, Any]]]

    @property
    def counts(self) -> ChangeCounts:
        """How many of each."""
        return ChangeCounts(self.before, self.after, len(self.added), len(self.removed), len(self.changed))

    def __bool__(self) -> bool:
        """Whether anything changes."""
        return bool(self.added or self.removed or self.changed)


def fields_changed(then: Item, now: Item) -> dict[str, tuple[Any, Any]]:
    """Return the fields in which two records differ.

    Parameters
    ----------
    then, now : Item
        The records.

    Returns
    -------
    dict of str to (Any, Any)
        Both values of each field, JSON-ready.
    """
    before, after = to_records([then, now])
    return {name: (before[name], after[name]) for name in ITEM_FIELDS if before[name] != after[name]}
