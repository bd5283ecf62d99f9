"""Questions of a survey that one house rule answers in place of a measurement of each of many objects."""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from statistics import median
from typing import Any

from pipeline.analysis.house.rule import QUANTITIES, STANDING
from pipeline.records import (
    Anchorage,
    Furniture,
    Hanging,
    MeasurementRequest,
    Mount,
    Origin,
    Scene,
    Support,
    SurfaceMaterial,
)

MANY = 5
"""Objects of which the same is asked, from which one rule is asked for first."""

_STATED = {
    "friction": "friction",
    "clearance_m": "clearance_m",
    "cg_height_m": "cg_ratio",
    "base_width_m": "base_ratio",
    "suspension_length_m": "suspension_ratio",
    "damping": "damping",
    "frequency_hz": "frequency_hz",
    "support": "held",
    "hanging": "hanging",
    "mount": "mount",
}
"""Field that a survey asks for, or what is looked at -> what a rule would state instead: lengths of many as shares."""

_SHARE_OF = {"cg_ratio": "height_m", "suspension_ratio": "height_m", "base_ratio": "width_m"}

_FASTENED_OR_NOT = frozenset({Furniture.SHOWCASE, Furniture.PEDESTAL, Furniture.SHELF})

VOCABULARIES: Mapping[str, Sequence[str]] = {
    "hanging": tuple(Hanging),
    "furniture": tuple(Furniture),
    "furniture_anchorage": tuple(Anchorage),
    "surface": tuple(SurfaceMaterial),
    "held": tuple(Support),
    "mount": tuple(way for way in Mount if way is not Mount.UNKNOWN),
}
"""What a rule may state as a word."""


@dataclass(frozen=True, slots=True)
class RuleQuestion:
    """One question whose answer is a house rule.

    Attributes
    ----------
    object_class, support : str
        Of the objects that it would be for; support is "" where the class says enough.
    field, unit : str
        What it would state, SI.
    low, best, high : float or None
        As it is taken now: the lowest and the highest of all objects, and the middle of the best.
    objects : int
        How many objects it would be for.
    settles, unlocks : float, int
        What measuring each of them would settle, and how many models it would make possible.
    """

    object_class: str
    support: str
    field: str
    unit: str
    low: float | None
    best: float | None
    high: float | None
    objects: int
    settles: float
    unlocks: int

    @property
    def criteria(self) -> dict[str, str]:
        """What the rule would be for, as the keys of [[house]]."""
        return {"class": self.object_class} | ({"support": self.support} if self.support else {})

    def plain(self, when: object) -> dict[str, Any]:
        """Return the rule as the keys and values of [[house]]: what is taken now, for somebody to mend and to sign.

        Parameters
        ----------
        when : object
            The day on which it is asked.

        Returns
        -------
        mapping of str to Any
        """
        value: Any = " | ".join(VOCABULARIES.get(self.field, ()))
        if self.best is not None:
            low, best, high = (float(f"{end:.3g}") for end in (self.low, self.best, self.high) if end is not None)
            value = {"low": low, "best": best, "high": high}
        return self.criteria | {self.field: value, "said_by": "", "said_on": when}


def stated_by(field: str) -> str:
    """Return what a house rule states that a measurement of a field would say; "" where none does."""
    return _STATED.get(field, "")


def rule_questions(scenes: Iterable[Scene], wishes: Iterable[MeasurementRequest]) -> list[RuleQuestion]:
    """Return the questions that one rule answers for many objects, what settles most first.

    Parameters
    ----------
    scenes : iterable of Scene
        The objects on display.
    wishes : iterable of MeasurementRequest
        What is worth measuring on them, each by itself.

    Returns
    -------
    list of RuleQuestion
        After those that would settle something: how works hang, what things stand on and whether that is fastened,
        where neither records nor rules say it.
    """
    known = {scene.item.object_number: scene for scene in scenes}
    groups: dict[tuple[str, Support, str], list[MeasurementRequest]] = defaultdict(list)
    for wish in wishes:
        stated = _STATED.get(wish.field)
        scene = known.get(wish.object_number)
        if stated is not None and scene is not None and not wish.settles_nothing:
            groups[scene.object_class, scene.support, stated].append(wish)
    supports: dict[str, set[Support]] = defaultdict(set)
    for scene in known.values():
        supports[scene.object_class].add(scene.support)
    asked = [
        _question(*about, several=len(supports[about[0]]) > 1, wishes=some, known=known)
        for about, some in groups.items()
        if len(some) >= MANY
    ]
    asked.sort(key=lambda one: (-one.settles - one.unlocks, -one.objects, one.object_class, one.field))
    said = {(one.object_class, one.support, one.field) for one in asked}
    unsaid = _unsaid(known.values(), supports)
    return [*asked, *(one for one in unsaid if (one.object_class, one.support, one.field) not in said)]


def _question(
    object_class: str,
    support: Support,
    field: str,
    *,
    several: bool,
    wishes: Sequence[MeasurementRequest],
    known: Mapping[str, Scene],
) -> RuleQuestion:
    spans = []
    for wish in wishes:
        size = getattr(known[wish.object_number].item, _SHARE_OF[field]) if field in _SHARE_OF else 1.0
        if wish.low is not None and wish.best is not None and wish.high is not None and size:
            spans.append((wish.low / size, wish.best / size, wish.high / size))
    lows, bests, highs = zip(*spans, strict=True) if spans else ((), (), ())
    return RuleQuestion(
        object_class,
        support.value if several and field != "held" else "",
        field,
        QUANTITIES[field][0] if field in QUANTITIES else "",
        min(lows, default=None),
        median(bests) if bests else None,
        max(highs, default=None),
        len(wishes),
        sum(wish.settles for wish in wishes),
        sum(wish.unlocks for wish in wishes),
    )


def _unsaid(scenes: Iterable[Scene], supports: Mapping[str, set[Support]]) -> list[RuleQuestion]:
    """Return the questions how things hang or are held, what they stand on, and whether that is fastened."""
    numbers: Counter[tuple[str, Support, str]] = Counter()
    for scene in scenes:
        if scene.support is Support.HUNG and scene.hanging is None:
            numbers[scene.object_class, scene.support, "hanging"] += 1
        if scene.mount_origin is Origin.ASSUMED:
            numbers[scene.object_class, scene.support, "mount"] += 1
        if scene.support in STANDING and scene.furniture_origin is Origin.ASSUMED and scene.models:
            numbers[scene.object_class, scene.support, "furniture"] += 1
        if scene.furniture in _FASTENED_OR_NOT and scene.anchorage is None and scene.models:
            numbers[scene.object_class, scene.support, "furniture_anchorage"] += 1
    return [
        RuleQuestion(kind, held.value if len(supports[kind]) > 1 else "", field, "", None, None, None, number, 0.0, 0)
        for (kind, held, field), number in sorted(numbers.items(), key=lambda entry: (-entry[1], entry[0]))
        if number >= MANY
    ]
