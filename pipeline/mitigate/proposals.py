"""Proposals of a measure for an object, or for all that share a support, before it is run."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from pipeline.mitigate.trials import Trial
from pipeline.models import settled_by_room, tips
from pipeline.records import Check, Finding, Scene, Support, Verdict

Numbers = Mapping[str, tuple[float, str]]
"""Value and unit [SI], by name."""

STANDING = (Support.FREESTANDING, Support.FASTENED, Support.ISOLATED)

IT = "it"
"""What is put on a support where nothing shares it."""

NAMED = 12
"""Objects of a case that a sentence names; of more it says how many."""


def _nothing(_findings: Sequence[Finding]) -> Numbers:
    return {}


Case = tuple[str, str, bool]
"""Gallery, case, and whether what stands in it is on display: what is in store is advised apart, as it is kept."""


def case_of(scene: Scene) -> Case | None:
    """Return the case that a standing object shares, None where no case is recorded."""
    item = scene.item
    return (item.gallery, item.case, item.on_display) if item.case.strip() and scene.support in STANDING else None


def known_to_swing(scene: Scene) -> bool:
    """Say whether what hangs swings for certain, and not only if it hangs in one of several ways.

    Parameters
    ----------
    scene : Scene
        An object as it stands.
    """
    freedom = scene.parameters.get("freedom")
    return scene.support is not Support.HUNG or (freedom is not None and freedom.low > 0.0)


@dataclass(frozen=True, eq=False)
class Deficiency:
    """An object under the levels of shaking that a measure is sought for, with what was found of it.

    Attributes
    ----------
    index : int
        Its place among the scenes.
    scene : Scene
        As it stands now.
    findings : tuple of Finding
        Those at these levels.
    levels : tuple of str
        Names of those at which something is to be advised for it.
    """

    index: int
    scene: Scene
    findings: tuple[Finding, ...]
    levels: tuple[str, ...]

    @property
    def wanted(self) -> bool:
        """Whether something is to be advised for it; the others only share a support with what needs it."""
        return bool(self.levels)

    @property
    def number(self) -> str:
        """Its object number."""
        return self.scene.item.object_number

    @property
    def rocks(self) -> bool:
        """Whether it fails by tipping, or may."""
        return any(tips(f.model) and f.verdict is not Verdict.PASS for f in self.findings)

    @property
    def moves(self) -> float | None:
        """How far it may move [m], all that is uncertain at its worse end; None where no model says so."""
        moving = [f.high or 0.0 for f in self.findings if settled_by_room(f.model) and f.high is not None]
        return max(moving, default=None)


@dataclass(frozen=True)
class Option:
    """One way in which an object can stand on a support, and how a sentence says it."""

    trial: Trial
    said: str


@dataclass(frozen=True)
class Candidate:
    """One thing to build or buy.

    Attributes
    ----------
    numbers : mapping of str to (float, str)
        What it is: value and unit [SI] by name.  The parameters of its recommendation.
    trials : tuple of Trial
        All must pass.
    options : tuple of (Deficiency, tuple of Option)
        Of each object on a shared support the ways to stand there, one of which must pass.
    checks : tuple of (str, Check)
        Evidence that no trial gives: strengths, and demands against another capacity; each with the name of the level
        that it is of, "" for all.  All must pass.
    words : mapping of str to str
        What the sentence asks for that is no number.
    finish : callable
        Findings of the trials -> numbers that only these tell.
    marks : mapping of str to (str, float, float)
        Where it lies on a chart, by level: kind of chart, x, y.
    mark_of : str
        Model whose finding says where it lies on a chart; "" for none.
    at_best : bool
        Whether it is sized by the best estimates.  Where its trials pass by these only, it is advised where no other
        fastening passes for sure.
    """

    numbers: Numbers
    trials: tuple[Trial, ...] = ()
    options: tuple[tuple[Deficiency, tuple[Option, ...]], ...] = ()
    checks: tuple[tuple[str, Check], ...] = ()
    words: Mapping[str, str] = field(default_factory=dict)
    finish: Callable[[Sequence[Finding]], Numbers] = _nothing
    marks: Mapping[str, tuple[str, float, float]] = field(default_factory=dict)
    mark_of: str = ""
    at_best: bool = False

    @property
    def every(self) -> tuple[Trial, ...]:
        """All trials that have to be run to judge it."""
        return (*self.trials, *(option.trial for _, options in self.options for option in options))


@dataclass(frozen=True)
class Proposal:
    """What a measure proposes: candidates, and why there are none or what to say where none passes.

    Attributes
    ----------
    candidates : tuple of Candidate
        Gentlest first.
    reason : str
        "" lets the worst of the last trial speak.
    """

    candidates: tuple[Candidate, ...] = ()
    reason: str = ""


UNCONCERNED = Proposal()
"""Where a measure has nothing to do with an object: nothing is said of it."""


def refused(reason: str) -> Proposal:
    """Return that a measure does not suit, and why."""
    return Proposal((), reason)


def company(objects: Sequence[Deficiency], one: Deficiency, unknown: Sequence[str]) -> str:
    """Say what is put on a support: the object, or its case with the others in it.

    Parameters
    ----------
    objects : sequence of Deficiency
        All that share it.
    one : Deficiency
        The one that is told.
    unknown : sequence of str
        Numbers of objects in the case that could not be assessed.
    """
    if case_of(one.scene) is None:
        return IT
    others = [other.number for other in objects if other is not one]
    with_ = f", with {listed(others)} in it," if others else ""
    open_ = f" (not checked: {listed(unknown)})" if unknown else ""
    return f"case {one.scene.item.case.strip()}{with_}{open_}"


def listed(numbers: Sequence[str]) -> str:
    """Return "A, B and C"; of many the first, and how many more."""
    shown = list(numbers[:NAMED])
    if len(numbers) > NAMED:
        shown.append(f"{len(numbers) - NAMED} more")
    return shown[0] if len(shown) == 1 else f"{', '.join(shown[:-1])} and {shown[-1]}"
