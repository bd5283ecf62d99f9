"""Other classes that an object may be of: its scene as each of them, where something else is computed for it.

What a person decided, an identifier or a rule of the museum's own says is certain.  Where the record names no class, an
object is taken for the one that `classify` falls back to, and that has what the others leave.
"""

from collections.abc import Hashable, Sequence
from typing import NamedTuple

from pipeline.analysis.classify import classify
from pipeline.analysis.furniture import filter_of
from pipeline.analysis.house.matching import HouseRules
from pipeline.analysis.plan import requirements
from pipeline.analysis.rule_table import RuleTable
from pipeline.records import Scene
from pipeline.tables.assumed import assumed

LEAST = 0.05
"""Chance below which a class is left out, and the others weighed alone: judgement, 0.02 to 0.1.

Below it a class has 3 samples of 64, which tell nothing of it, and harm that only it may come to stays unlikely."""


class MayBe(NamedTuple):
    """A class that an object may be of, or several for which the same is computed.

    Attributes
    ----------
    classes : tuple of str
        Their names.
    chance : float
        How likely it is of one of them; those of an object need not add up to 1.
    scene : Scene
        The object as one of them.
    """

    classes: tuple[str, ...]
    chance: float
    scene: Scene


def scenes_by_class(scene: Scene, rules: RuleTable | None = None, house: HouseRules | None = None) -> list[MayBe]:
    """Return the scenes of an object as each class that it may be of, the one that it is taken for first.

    Parameters
    ----------
    scene : Scene
        The object as `classify` returned it.
    rules, house
        As `classify` got them.

    Returns
    -------
    list of MayBe
        None where its class is certain or makes no difference, and where nothing can be computed for the class that it
        is taken for.  A class for which nothing can be computed is not among them.
    """
    named = (assumed() if rules is None else rules.values).classes
    others = [(name, p) for name, p in scene.chances if name != scene.object_class and p >= LEAST and name in named]
    if not others or not scene.models or scene.missing:
        return []
    first = scene.chances[0]
    # Where the record says nothing it is no guess but what is left.
    mine = first[1] if first[0] == scene.object_class else max(1.0 - sum(p for _, p in others), LEAST)
    each = [(scene.object_class, mine, scene)]
    each += [
        (name, p, classify(scene.item, rules, (name, "another class that is possible"), house)) for name, p in others
    ]
    runs = _runs([one for *_, one in each])
    if not runs[0]:
        return []
    alike: dict[Hashable, MayBe] = {}
    for (name, p, one), some in zip(each, runs, strict=True):
        if some:
            known = alike.get(key := computed(one))
            alike[key] = (
                MayBe((name,), p, one)
                if known is None
                else known._replace(classes=(*known.classes, name), chance=known.chance + p)
            )
    return list(alike.values()) if len(alike) > 1 else []


def _runs(scenes: Sequence[Scene]) -> list[bool]:
    """Say of scenes whether any model is run on them."""
    some = {at for _, _, members in requirements(scenes)[0] for at in members}
    return [at in some for at in range(len(scenes))]


def computed(scene: Scene) -> Hashable:
    """Return all of a scene of an object that joint samples of it look at."""
    known = sorted(scene.parameters.items())
    return (
        *(scene.support, scene.models, scene.hanging, filter_of(scene)),
        tuple((name, one.low, one.value, one.high, one.per) for name, one in known),
    )
