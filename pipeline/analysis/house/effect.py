"""What house rules come to for one object: what is taken of them, and what is doubtful."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import StrEnum

from pipeline.analysis.house.rule import Span
from pipeline.records import (
    Anchorage,
    Estimate,
    Furniture,
    Hanging,
    Item,
    Mount,
    Origin,
    Scene,
    Support,
    SurfaceMaterial,
)
from pipeline.records import phrases as say

_WORDS: Mapping[StrEnum, str] = {
    Hanging.WIRE: "hangs from a wire or one hook",
    Hanging.TWO_HOOKS: "hangs from two hooks",
    Hanging.CLEAT: "hangs on a cleat",
    Hanging.SECURITY: "hangs by security hardware",
    Hanging.FIXED: "is fixed to the wall",
    Furniture.FLOOR: "stands on the floor",
    Furniture.SHOWCASE: "stands in a showcase",
    Furniture.PEDESTAL: "stands on a pedestal",
    Furniture.SHELF: "stands on a shelf",
    Furniture.WALL: "hangs on the wall",
    Furniture.RAIL: "hangs from a rail",
    Anchorage.ANCHORED: "stands in furniture that is fastened",
    Anchorage.UNANCHORED: "stands in furniture that is not fastened",
    **{one: f"stands on {one.value}" for one in SurfaceMaterial},
    Mount.LYING: "lies on its largest face",
    Mount.STANDING: "stands by itself as its height says",
    Mount.LEANING: "leans on a stand or against a backing",
    Mount.RESTING: "rests on its mount, held by nothing else",
    Mount.SECURED: "is held by clips, wire, pins, wax or screws",
}


@dataclass(frozen=True, slots=True)
class HouseStatement:
    """What a rule states of an object: of which field, what, in whose words."""

    field: str
    value: Span | StrEnum
    words: str
    source: str

    @property
    def origin(self) -> str:
        """The rule in words, with who says so."""
        return f"by the house rule for {self.words} ({self.source})"

    def estimate(self, what: str, unit: str, times: float = 1.0) -> Estimate:
        """Return the number as an estimate; ``times`` is what a share is of."""
        span = self.value
        if not isinstance(span, Span):
            raise TypeError(f"{self.field} is no number")
        low, best, high = (times * end for end in (span.low, span.best, span.high))
        note = say.STATED(what=what, rule=self.words)
        return Estimate(best, unit, Origin.STATED, low, high, note, self.source)


@dataclass(frozen=True, slots=True)
class HouseEffect:
    """What the house rules come to for one object.

    Attributes
    ----------
    stated : mapping of str to HouseStatement
        What is taken, by what it is about (`HouseRule.states`).
    notes : tuple of str
        Where its record overrules a rule and where rules tie, in words.
    matched, used : tuple of int
        Positions of the rules that match it, from 0, and of those of which something is taken.
    overruled : tuple of (int, str)
        Rules that its record contradicts, and how, in words.
    ties : tuple of str
        Of rules that are equally particular and say different things, in words.
    """

    stated: Mapping[str, HouseStatement] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    matched: tuple[int, ...] = ()
    used: tuple[int, ...] = ()
    overruled: tuple[tuple[int, str], ...] = ()
    ties: tuple[str, ...] = ()

    @property
    def key(self) -> str:
        """A text that is the same where the rules come to the same; "" where they come to nothing."""
        if not (self.stated or self.notes):
            return ""
        return repr((sorted((about, repr(one)) for about, one in self.stated.items()), self.notes))

    def laid_over(self, item: Item) -> Item:
        """Return a record with what is stated where it says nothing: how it is held, and what is below it."""
        held = self.stated.get("held")
        if held is not None:
            item = replace(item, support=Support(str(held.value)))
        surface = self.stated.get("surface")
        if surface is not None:
            item = replace(item, surface_material=str(surface.value))
        return item

    def hanging(self, item: Item) -> Hanging | None:
        """Return how an object hangs, by its record or else by a rule."""
        told = self.stated.get("hanging")
        return item.hanging if told is None else Hanging(str(told.value))

    @property
    def statements(self) -> tuple[str, ...]:
        """What is stated besides numbers, and what is doubtful, in words."""
        out = []
        for one in self.stated.values():
            if one.field == "held":
                out.append(f"support: {one.value}, {one.origin}")
            elif isinstance(one.value, StrEnum):
                out.append(f"it {_WORDS[one.value]}, {one.origin}")
        return (*out, *self.notes)


NO_EFFECT = HouseEffect()


def rests_on(scene: Scene, words: str, source: str) -> bool:
    """Say whether anything of a scene is taken from a house rule, by the words and the source of that rule."""
    stated = say.STATED(what="", rule=words).removeprefix(": ")
    if any(f"{stated} ({source})" in text for text in (*scene.statements, *scene.assumptions)):
        return True
    # The source of a number stands beside its note; how a work hangs has its own in the words.
    ends = (stated, f"{stated} ({source})")
    return any(
        clause.endswith(ends if one.source == source else ends[1])
        for one in scene.parameters.values()
        if one.note
        for clause in one.note.split("; ")
    )
