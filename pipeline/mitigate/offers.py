"""What a measure proposes for an object, or for all that share a support, before it is run."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field

from pipeline.mitigate.bench import Trial
from pipeline.records import Check, Finding, Scene

Numbers = Mapping[str, tuple[float, str]]
"""Value and unit [SI], by name."""


def _nothing(_findings: Sequence[Finding]) -> Numbers:
    return {}


@dataclass(frozen=True, eq=False)
class Need:
    """An object under the levels of shaking that a measure is sought for.

    index    : its place among the scenes
    findings : at those levels
    levels   : names of those at which something is to be advised for it
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


@dataclass(frozen=True)
class Way:
    """One way in which an object can stand on a support, and how a sentence says it."""

    trial: Trial
    said: str


@dataclass(frozen=True)
class Offer:
    """One thing to build or buy.

    numbers : what it is
    trials  : all of which must pass
    stands  : of each object on a shared support the ways to stand there, one of which must pass
    checks  : evidence that no trial gives: strengths, and demands against another capacity; each with the name of
              the level that it is of, "" for all
    words   : what the sentence asks for that is no number
    finish  : numbers that only the findings of the trials tell
    marks   : (kind of chart, x, y), by level
    mark_of : model whose finding says where it lies on a chart; "" for none
    """

    numbers: Numbers
    trials: tuple[Trial, ...] = ()
    stands: tuple[tuple[Need, tuple[Way, ...]], ...] = ()
    checks: tuple[tuple[str, Check], ...] = ()
    words: Mapping[str, str] = field(default_factory=dict)
    finish: Callable[[Sequence[Finding]], Numbers] = _nothing
    marks: Mapping[str, tuple[str, float, float]] = field(default_factory=dict)
    mark_of: str = ""

    @property
    def every(self) -> tuple[Trial, ...]:
        """All trials that have to be run to judge it."""
        return (*self.trials, *(way.trial for _, ways in self.stands for way in ways))


@dataclass(frozen=True)
class Proposal:
    """Offers, gentlest first, and why there are none or what to say where none passes.

    reason : "" lets the worst of the last trial speak
    """

    offers: tuple[Offer, ...] = ()
    reason: str = ""


def refused(reason: str) -> Proposal:
    """Return that a measure does not suit, and why."""
    return Proposal((), reason)
