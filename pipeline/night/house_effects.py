"""Effects of the house rules on the objects of a run, before any of them is assessed: a part of the keys of units.

What the rules come to for an object takes its class, and so its record: it is kept from night to night under the digest
of the record, so that a night reads the records of those alone that are new to the rules.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.classify import house_effect
from pipeline.analysis.faults import apart
from pipeline.analysis.house.matching import HouseEffect, HouseRules
from pipeline.analysis.rule_table import RuleTable
from pipeline.cache import HOUSE, Cache, CacheEntry, key_of
from pipeline.collection.listing import Listed, Listing
from pipeline.collection.object_index import ObjectIndex
from pipeline.collection.sealing import seal
from pipeline.night.assessment import decided_class
from pipeline.night.context import RunContext
from pipeline.night.source_state import house_digest, rules_digest, tables_digest
from pipeline.night.units import Decisions
from pipeline.operations.workspace import Workspace
from pipeline.records import DecisionKind, Item

BATCH = 5_000
"""Records that are read at a time."""


def house_effects(
    workspace: Workspace, context: RunContext, index: ObjectIndex, objects: Listing, decisions: Decisions
) -> dict[str, str]:
    """Return what the house rules come to for the objects of a run.

    Parameters
    ----------
    workspace
        Whose settings have the rules.
    context
        Of the run.
    index
        Where records are had.
    objects
        Of the run.
    decisions
        Those in force: rules match by the class that people gave an object.

    Returns
    -------
    dict of str to str
        A digest by object number, of those for whom the rules come to anything.
    """
    house = context.house
    if house is None:
        return {}
    near = [one for one in objects if house.placed(one.object_number, one.gallery)]
    classed = sorted(repr(d) for mine in decisions.values() for d in mine if d.kind is DecisionKind.CLASS)
    settings = workspace.settings
    key = key_of(house_digest(settings), rules_digest(settings), tables_digest(settings), classed)
    cache = None if context.kept is None else Cache(context.kept)
    entry = None if cache is None else cache.get(HOUSE, key)
    found = {} if entry is None else _kept(entry)
    new = [one for one in near if _place(one) not in found]
    for start in range(0, len(new), BATCH):
        some = new[start : start + BATCH]
        items = list(index.items([one.object_number for one in some]).values())
        effects = each_effect(house, items, context.rules, decisions)
        found |= zip(map(_place, some), map(_digest, effects), strict=True)
    if cache is not None and new and len(objects) == len(index.objects):
        # A run of a part of the collection would forget the others.
        cache.put(HOUSE, key, _entry({_place(one): found[_place(one)] for one in near}))
    every = ((one.object_number, found[_place(one)]) for one in near)
    return {number: effect for number, effect in every if effect}


def each_effect(
    house: HouseRules, items: Sequence[Item], rules: RuleTable | None, decisions: Decisions
) -> list[HouseEffect | Exception]:
    """Return what the house rules come to for some objects, each by itself.

    Parameters
    ----------
    house
        The rules.
    items
        Records of the objects.
    rules
        The table that decides the class; None for Kouros's own.
    decisions
        Those in force.

    Returns
    -------
    list of HouseEffect or Exception
        An error where an object cannot even be classed: it is told where that is done.
    """

    def some(these: Sequence[Item]) -> list[HouseEffect]:
        return [
            house_effect(item, house, rules, decided_class(decisions.get(item.object_number, ()))) for item in these
        ]

    return apart(some, items, lambda item: item.support)


def _digest(effect: HouseEffect | Exception) -> str:
    return "" if isinstance(effect, Exception) or not effect.key else seal(effect.key)


def _place(one: Listed) -> int:
    """Return what stands for the record of an object: 64 bits of its digest."""
    return int(one.digest[:16] or "0", 16)


def _entry(found: dict[int, str]) -> CacheEntry:
    effects = sorted(set(found.values()))
    at = {effect: position for position, effect in enumerate(effects)}
    arrays: dict[str, NDArray[np.generic]] = {
        "place": np.fromiter(found, np.uint64, len(found)),
        "effect": np.fromiter((at[effect] for effect in found.values()), np.int64, len(found)),
    }
    return CacheEntry({"effects": effects}, arrays)


def _kept(entry: CacheEntry) -> dict[int, str]:
    effects = entry.said["effects"]
    places, which = entry.arrays["place"].tolist(), entry.arrays["effect"].tolist()
    return {place: effects[at] for place, at in zip(places, which, strict=True)}
