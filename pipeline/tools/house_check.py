"""Check of the house rules against the objects on display: which match nothing, contradict a record, or tie."""

from collections import Counter
from collections.abc import Sequence

from pipeline.analysis.house.effect import HouseEffect
from pipeline.analysis.house.matching import HouseRules
from pipeline.night.house_effects import each_effect
from pipeline.operations.workspace import Workspace, near
from pipeline.quantities import counted
from pipeline.records import Item
from pipeline.store.decisions import decisions_in_force

_MOST = 3
"""Objects that are named of those of which the same is said."""


def look_at_house_rules(workspace: Workspace, inventory: Sequence[Item]) -> tuple[str, str]:
    """Ask the house rules about all objects.

    Parameters
    ----------
    workspace : Workspace
        Whose rules are asked.
    inventory : sequence of Item
        All objects.

    Returns
    -------
    state : {"ok", "warning", "wrong"}
        Wrong where rules tie; a warning where one matches nothing, is never taken or contradicts a record.
    message : str
        What each rule matches, and what is doubtful.
    """
    house = workspace.house
    if house is None:
        return "ok", "none"
    effects = _effects(workspace, house, inventory)
    matched = Counter(at for _, effect in effects for at in effect.matched)
    used = Counter(at for _, effect in effects for at in effect.used)
    told = [f"{house.named(at)} matches {counted(times, 'object')}" for at, times in sorted(matched.items())]
    doubts = [_idle(house, at, matched[at], inventory) for at, rule in enumerate(house.rules)
              if rule.holds and not used[at]]  # fmt: skip
    against: dict[int, list[str]] = {}
    ties: dict[str, list[str]] = {}
    for item, effect in effects:
        for at, words in effect.overruled:
            against.setdefault(at, []).append(f"{item.object_number}: {words}")
        for words in effect.ties:
            ties.setdefault(words, []).append(item.object_number)
    doubts += [
        f"{house.named(at)} contradicts the record of {counted(len(some), 'object')}: {_listed(some)}"
        for at, some in sorted(against.items())
    ]
    wrong = [
        f"{words} ({counted(len(some), 'object')}: {_listed(some)}); name more in one of them, or take one out"
        for words, some in ties.items()
    ]
    state = "wrong" if wrong else "warning" if doubts else "ok"
    return state, "; ".join([*wrong, *doubts, *told])


def _effects(workspace: Workspace, house: HouseRules, inventory: Sequence[Item]) -> list[tuple[Item, HouseEffect]]:
    came = each_effect(house, inventory, workspace.rules, decisions_in_force(workspace.engine))
    return [(item, one) for item, one in zip(inventory, came, strict=True) if isinstance(one, HouseEffect)]


def _idle(house: HouseRules, at: int, matched: int, inventory: Sequence[Item]) -> str:
    if matched:
        why = "records or other rules say it, or it is of what is held in another way"
        return f"nothing of {house.named(at)} is taken: {why}"
    there = {item.gallery for item in inventory}
    strange = [name for name in house.rules[at].gallery if name not in there]
    hint = f": there is no gallery {strange[0]!r}{near(strange[0], there)}" if strange else ""
    return f"{house.named(at)} matches nothing{hint}"


def _listed(some: Sequence[str]) -> str:
    more = f" and {len(some) - _MOST:,} more" if len(some) > _MOST else ""
    return ", ".join(some[:_MOST]) + more
