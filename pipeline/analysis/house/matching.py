"""The house rules of a museum, weighed against each other and against the record of an object; what comes of them."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from enum import StrEnum
from fnmatch import translate
from math import isclose, isnan, nan

from pipeline.analysis.house.rule import ABOVE, CRITERIA, QUANTITIES, SLOTS, STANDING, WORDS, HouseRule, Span
from pipeline.analysis.rule_table import stuff, words_of
from pipeline.errors import InputError
from pipeline.quantities import figures
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
from pipeline.tables import table
from pipeline.tables.surface_rows import surfaces_in

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


_ON_WALLS = frozenset({Furniture.WALL, Furniture.RAIL})

_WILD = re.compile(r"\[[^]]+\]|[*?]")
"""What makes a pattern of a number, as in names of files."""

MOUNTED_BY = {Support.FASTENED: Mount.SECURED, Support.FREESTANDING: Mount.STANDING}
"""How a thing is held that lies in a case or cannot stand by itself, by what its record says of its support."""

_Rank = tuple[int, int, int, int]
"""How particular a rule is for an object: see the opening of this module."""


@dataclass(frozen=True)
class _Matcher:
    """A rule ready to match; ``patterns`` of numbers are sorted, those with most characters first."""

    rule: HouseRule
    numbers: frozenset[str]
    patterns: tuple[tuple[int, re.Pattern[str]], ...]
    medium: re.Pattern[str] | None

    @classmethod
    def of(cls, rule: HouseRule) -> _Matcher:
        whole = frozenset(text for text in rule.number if not _WILD.search(text))
        # What fnmatch makes of a pattern does not run wild, whatever the pattern.
        wild = sorted((text for text in rule.number if text not in whole), key=_letters, reverse=True)
        patterns = tuple((_letters(text), re.compile(translate(text))) for text in wild)
        return cls(rule, whole, patterns, words_of(rule.medium) if rule.medium else None)

    def numbered(self, number: str) -> tuple[int, int] | None:
        """Return how particular the rule is by an object's number, None where it names others."""
        if not self.rule.number:
            return 0, 0
        if number in self.numbers:
            return 1, len(number)
        return next(((0, letters) for letters, pattern in self.patterns if pattern.match(number)), None)

    def placed(self, number: str, gallery: str) -> bool:
        """Say whether it holds, and number and gallery are those that it names."""
        return (
            self.rule.holds
            and not (self.rule.gallery and gallery not in self.rule.gallery)
            and self.numbered(number) is not None
        )

    def rank(self, item: Item, object_class: str, support: Support) -> _Rank | None:
        """Return how particular it is for an object, None where it does not match or was taken back."""
        rule = self.rule
        if not rule.holds:
            return None
        by_number = self.numbered(item.object_number)
        if by_number is None or (rule.gallery and item.gallery not in rule.gallery):
            return None
        if rule.object_class and object_class not in rule.object_class:
            return None
        if rule.support and support not in rule.support:
            return None
        if self.medium is not None and not self.medium.search(stuff(item.material, item.medium)):
            return None
        return *by_number, sum(map(bool, (rule.object_class, rule.gallery, rule.medium))), int(bool(rule.support))


class HouseRules:
    """The house rules of a museum, ready to be asked about objects.

    Parameters
    ----------
    rules
        As the settings have them.
    classes
        The classes that there are.

    Raises
    ------
    InputError
        For a class that there is not, and for two rules that name the same objects and say different things: naming
        the rules by their place in the file.
    """

    def __init__(self, rules: Sequence[HouseRule], classes: Sequence[str]) -> None:
        self.rules = tuple(rules)
        self._matchers = tuple(map(_Matcher.of, self.rules))
        for at, rule in enumerate(self.rules):
            for name in rule.object_class:
                if name not in classes:
                    close = _titled(name, classes) or get_close_matches(name, classes, n=1)
                    hint = f"; is {close[0]!r} meant?" if close else f"; use one of {', '.join(sorted(classes))}"
                    raise InputError(f"{self.named(at)}: class: there is no class {name!r}{hint}")
        for at, one in enumerate(self.rules):
            for before, other in enumerate(self.rules[:at]):
                about = _disagree(other, one) if one.holds and other.holds else ""
                if about and all(getattr(one, name) == getattr(other, name) for name in CRITERIA):
                    raise InputError(self._tie(before, at, about))

    def named(self, at: int) -> str:
        """Return a rule as messages name it: by its place in the file, and what it is for."""
        return f"[[house]] {at + 1} ({self.rules[at].words})"

    def placed(self, number: str, gallery: str) -> bool:
        """Say whether any rule may match an object of that number in that gallery."""
        return any(matcher.placed(number, gallery) for matcher in self._matchers)

    def effect(self, item: Item, object_class: str, support: Support, *, mounts: bool = False) -> HouseEffect:
        """Return what the rules come to for an object.

        Parameters
        ----------
        item
            Its record.
        object_class
            Row of classes.csv.
        support
            How it is held, by its record or else by its class.
        mounts
            Whether objects of its class lie in a case or are held by mounts.

        Returns
        -------
        HouseEffect
        """
        out = _Weighing(self, item)
        matching = self._matching(item, object_class, support)
        out.weigh(matching, "held", support)
        held = out.stated.get("held")
        if held is not None:
            support = Support(str(held.value))
            matching = self._matching(item, object_class, support)
        words = (name for name in WORDS if name != "held" and (mounts or name != "mount"))
        for about in (*words, *QUANTITIES):
            if about not in SLOTS:
                out.weigh(matching, about, support)
        return HouseEffect(
            stated=out.stated,
            notes=(*(text for _, text in out.overruled), *out.ties),
            matched=tuple(at for at, _ in matching),
            used=tuple(sorted(out.used)),
            overruled=tuple(out.overruled),
            ties=tuple(out.ties),
        )

    def _matching(self, item: Item, object_class: str, support: Support) -> list[tuple[int, _Rank]]:
        ranks = ((at, matcher.rank(item, object_class, support)) for at, matcher in enumerate(self._matchers))
        return [(at, rank) for at, rank in ranks if rank is not None]

    def _tie(self, one: int, other: int, about: str) -> str:
        name, value = self.rules[one].states[about]
        theirs, another = self.rules[other].states[about]
        return (
            f"{self.named(one)} and {self.named(other)} are equally particular and say different things: "
            f"{name} {_shown(value)} and {theirs} {_shown(another)}; name more in one of them, or take one out"
        )


def _letters(pattern: str) -> int:
    """Count the characters of a pattern but for * and ?; a set such as [12] is one."""
    return len(_WILD.sub(lambda found: "" if found[0] in "*?" else "x", pattern))


class _Weighing:
    """The rules that match one object, weighed quantity by quantity."""

    def __init__(self, house: HouseRules, item: Item) -> None:
        self._house, self._item = house, item
        self.stated: dict[str, HouseStatement] = {}
        self.used: set[int] = set()
        self.overruled: list[tuple[int, str]] = []
        self.ties: list[str] = []

    def weigh(self, matching: Sequence[tuple[int, _Rank]], about: str, support: Support) -> None:
        """Take the most particular statement about one thing, where the record does not say it."""
        rules = self._house.rules
        saying = [(rank, at) for at, rank in matching if about in rules[at].states]
        saying = [(rank, at) for rank, at in saying if _applies(*rules[at].states[about], support)]
        if not saying:
            return
        most = max(rank for rank, _ in saying)
        first, *others = [at for rank, at in saying if rank == most]
        rule = rules[first]
        name, value = rule.states[about]
        recorded = _recorded(self._item, name)
        if recorded is not None:
            for at in (first, *others):
                name, value = rules[at].states[about]
                if not _agrees(recorded, value):
                    said = f"{name}: its record says {_shown(recorded)}, which is used; "
                    said += f"the house rule for {rules[at].words} ({rules[at].source}) says {_shown(value)}"
                    self.overruled.append((at, said))
            return
        tied = next((at for at in others if rules[at].states[about] != (name, value)), None)
        if tied is not None:
            other = rules[tied]
            self.ties.append(
                f"{name}: the house rules for {rule.words} ({rule.source}) and for {other.words} ({other.source}) are "
                f"equally particular and say {_shown(value)} and {_shown(other.states[about][1])}: neither is used"
            )
            return
        self.used.add(first)
        self.stated[about] = HouseStatement(name, value, rule.words, rule.source)


def _titled(name: str, classes: Sequence[str]) -> list[str]:
    """Return the classes in whose titles a word stands: who says paintings means framed."""
    word = name.casefold().removesuffix("s")
    titles = {row["class"]: row["title"].casefold() for row in table("classes")} if word else {}
    return [one for one in classes if re.search(rf"\b{re.escape(word)}", titles.get(one, ""))]


def _disagree(one: HouseRule, other: HouseRule) -> str:
    """Return the first thing that both state and of which they do not say the same; "" where there is none."""
    return next((about for about, said in one.states.items() if other.states.get(about, said) != said), "")


def _applies(name: str, value: Span | StrEnum, support: Support) -> bool:
    """Say whether a statement can be of an object that is held so."""
    if name == "held":
        return True
    if name == "hanging":
        return support is Support.HUNG
    if name in ("furniture_anchorage", "surface", "mount"):
        return support in STANDING
    if name == "furniture":
        return support in (ABOVE if value in _ON_WALLS else STANDING)
    return support in QUANTITIES[name][1]


def _recorded(item: Item, name: str) -> float | StrEnum | None:
    """Return what a record says of what a rule may state."""
    if name == "held":
        return item.support
    if name == "mount":
        return None if item.support is None else MOUNTED_BY.get(item.support)
    if name == "surface":
        told = surfaces_in(item.surface_material, of_surface=True)
        # In words that the table does not know it is recorded, but nothing to compare with.
        known = next((one for one in SurfaceMaterial if one.value in told), nan)
        return known if item.surface_material.strip() else None
    if name in SLOTS:
        length: float | None = getattr(item, SLOTS[name])
        # Without a height it is recorded, but nothing to compare with.
        return length if length is None else length / item.height_m if item.height_m else nan
    if name == "base_ratio":
        both = ((item.base_width_m, item.width_m), (item.base_depth_m, item.depth_m))
        shares = [base / size for base, size in both if base is not None and size]
        # One side alone does not say what the other is.
        return shares[0] if len(shares) == len(both) and isclose(*shares, rel_tol=0.1) else None
    recorded: float | StrEnum | None = getattr(item, name)
    return recorded


def _agrees(recorded: float | StrEnum, value: Span | StrEnum) -> bool:
    if isinstance(recorded, StrEnum) or not isinstance(value, Span):
        return recorded == value
    if isnan(recorded):
        return True
    slack = 1e-9 * max(abs(recorded), abs(value.high))
    return value.low - slack <= recorded <= value.high + slack


def _shown(value: float | StrEnum | Span) -> str:
    if isinstance(value, Span):
        return f"{value.best:g}" if value.low == value.high else f"{value.best:g} ({value.low:g} to {value.high:g})"
    return str(value) if isinstance(value, StrEnum) else figures(value, 4)
