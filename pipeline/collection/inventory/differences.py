"""Differences that an import makes in the inventory, object by object."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
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
    renumbered : tuple of (str, str)
        Of those removed and added: what is the same but for its number, as it was and as it will be.
    """

    before: int
    after: int
    added: tuple[str, ...]
    removed: tuple[str, ...]
    changed: Mapping[str, Mapping[str, tuple[Any, Any]]]
    renumbered: tuple[tuple[str, str], ...] = ()

    @property
    def counts(self) -> ChangeCounts:
        """How many of each."""
        return ChangeCounts(self.before, self.after, len(self.added), len(self.removed), len(self.changed))

    def __bool__(self) -> bool:
        """Whether anything changes."""
        return bool(self.added or self.removed or self.changed)


def renumbered(gone: Iterable[Item], new: Iterable[Item]) -> tuple[tuple[str, str], ...]:
    """Return the numbers of records that are alike in name, title, material, place and sizes, no other being like them.

    Parameters
    ----------
    gone, new : iterable of Item
        Records that an inventory loses and gains at once.

    Returns
    -------
    tuple of (str, str)
        The number that is gone, and the new one; none of records without a name or a size.
    """
    before, after = _alike(gone), _alike(new)
    pairs = ((numbers, after.get(what, [])) for what, numbers in before.items())
    return tuple(sorted((old[0], now[0]) for old, now in pairs if len(old) == len(now) == 1))


def _alike(items: Iterable[Item]) -> dict[tuple[Any, ...], list[str]]:
    found: dict[tuple[Any, ...], list[str]] = {}
    for item in items:
        named = (item.title, item.object_name, item.classification, item.medium)
        sides = (item.height_m, item.width_m, item.depth_m, item.mass_kg)
        if any(named) and any(side is not None for side in sides):
            found.setdefault((*named, item.gallery, *sides), []).append(item.object_number)
    return found


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
