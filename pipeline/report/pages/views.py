"""Views, plain data of a page in the reader's units: the museum, a gallery, an object, a finding, a measure."""

from dataclasses import dataclass
from enum import StrEnum
from itertools import groupby

from pipeline import records
from pipeline.records import Urgency
from pipeline.report.language import parted
from pipeline.report.pages.chances import ChanceView
from pipeline.report.pages.judging import FragilityView
from pipeline.report.pages.photo_views import PhotoView
from pipeline.report.plots.chart import Spot

State = records.State

STATES = (State.ACT, State.WATCH, State.UNKNOWN, State.FINE)
"""Those of what is assessed."""


class Judged(StrEnum):
    """What a verdict says of one demand, in the order in which the report lists them."""

    FAILS = "act"
    OPEN = "open"
    PASSES = "safe"


@dataclass(frozen=True, slots=True)
class StateCounts:
    """How many objects are in each state; the five add up to all.  ``open``: of them, one measurement would decide."""

    act: int = 0
    watch: int = 0
    unknown: int = 0
    fine: int = 0
    aside: int = 0
    open: int = 0

    @property
    def total(self) -> int:
        """All objects counted."""
        return self.act + self.watch + self.unknown + self.fine + self.aside


@dataclass(frozen=True, slots=True)
class Bar:
    """A utilisation as a bar: percent of its track (the limit lies in the middle) and whether it runs off the end."""

    percent: int
    beyond: bool
    over: bool


@dataclass(frozen=True, slots=True)
class MotionLink:
    """Which motion a finding rests on: its name, the start of its hash, its section, and who answers for it."""

    name: str
    short: str
    anchor: str
    approved: str


@dataclass(frozen=True, slots=True)
class FindingView:
    """One finding in words; ``numbers`` the sums behind the sentence in one line.

    Attributes
    ----------
    size : str
        The utilisation for sorting, "" where it is not known.
    """

    title: str
    level: str
    state: Judged
    outcome: str
    sentence: str
    numbers: str
    utilisation: str
    bar: Bar | None
    screen: str
    note: str
    motion: MotionLink
    assumptions: tuple[str, ...]
    size: str


@dataclass(frozen=True, slots=True)
class CheckView:
    """One model run again on the changed chain; ``before`` and its utilisation are "" where nothing was found then."""

    title: str
    before: str
    demand: str
    capacity: str
    utilisation_before: str
    utilisation: str
    bar_before: Bar | None
    bar: Bar | None
    passes: bool


@dataclass(frozen=True, slots=True)
class MeasureView:
    """One recommendation in words; ``ended`` are the failures that can no longer happen with it.

    Attributes
    ----------
    plain : str
        What to do, for who does it.
    brief : str
        The same in a list of many objects.
    cautions : tuple of str
        What of it has to be minded, a sentence each.
    sentence : str
        The same with all its numbers.
    named : bool
        Whether somebody is to say first what the object is.
    """

    measure: str
    title: str
    level: str
    plain: str
    sentence: str
    checks: tuple[CheckView, ...]
    ended: tuple[CheckView, ...]
    rejected: tuple[str, ...]
    source: str
    named: bool = False
    brief: str = ""
    cautions: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class WishView:
    """A quantity of one object that is worth measuring: what it is, what it does, what is taken for it now."""

    what: str
    effect: str
    now: str
    waste: bool


@dataclass(frozen=True, slots=True)
class SurveyView:
    """One errand of measuring in a gallery: a quantity, how to measure it, on which objects, and what that settles."""

    what: str
    how: str
    settles: str
    objects: tuple["ObjectView", ...]


@dataclass(frozen=True, slots=True)
class NumberView:
    """A number that a model was run with: name, value and range in one text, and where it comes from."""

    text: str
    origin: str
    note: str
    source: str


@dataclass(frozen=True, slots=True)
class FigureView:
    """A chart of the run with an object's marks."""

    chart: str
    spots: tuple[Spot, ...]


@dataclass(frozen=True, slots=True)
class DecisionView:
    """What a person decided about an object, in words; ``doubts`` say why it must be looked at again."""

    kind: str
    number: str
    title: str
    what: str
    who: str
    date: str
    why: str
    until: str
    doubts: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ObjectView:
    """One object with everything that the report says about it; ``lead`` is its most urgent finding.

    Attributes
    ----------
    settled : bool
        Whether people accepted or overruled all that does not pass, and nothing of that is in doubt.
    taken : str
        How sure its class is, and which other is possible; "" where a person decided.
    worth : str
        What it counts where losses are compared, and why; "" where nothing is recorded of that.
    dangers : str
        What it may do by what it does not pass, in a sentence; "" for nothing.
    rests_on : tuple of str
        What its result rests on that nobody has looked at: wax or ties of its record, a wall that stands free.
    """

    number: str
    title: str
    short: str
    anchor: str
    gallery: str
    page: str
    state: State
    value_class: str
    worth: str
    object_class: str
    taken: str
    rule: str
    support: str
    place: str
    furniture: str
    lead: FindingView | None
    findings: tuple[FindingView, ...]
    measures: tuple[MeasureView, ...]
    figures: tuple[FigureView, ...]
    numbers: tuple[NumberView, ...]
    assumptions: tuple[str, ...]
    statements: tuple[str, ...]
    missing: tuple[str, ...]
    problems: tuple[tuple[str, str, str], ...]
    skipped: tuple[str, ...]
    wishes: tuple[WishView, ...] = ()
    grave: bool = False
    fragilities: tuple[FragilityView, ...] = ()
    chance: ChanceView | None = None
    open_for: str = ""
    decisions: tuple[DecisionView, ...] = ()
    settled: bool = False
    photo: PhotoView | None = None
    dangers: str = ""
    rests_on: tuple[str, ...] = ()

    @property
    def carded(self) -> bool:
        """Whether the object has an entry of its own below the table: something was found about it."""
        return self.state not in (State.UNKNOWN, State.ASIDE)

    @property
    def failing(self) -> tuple[FindingView, ...]:
        """The findings that the entry explains at length: those that fail or are open."""
        return tuple(f for f in self.findings if f.state is not Judged.PASSES)

    @property
    def passing(self) -> tuple[FindingView, ...]:
        """The findings that pass."""
        return tuple(f for f in self.findings if f.state is Judged.PASSES)

    @property
    def worthwhile(self) -> str:
        """What is worth measuring, in one line: in its order, what does as much said together; "" for nothing."""
        worth = (w for w in self.wishes if not w.waste)
        parts = []
        for effect, group in groupby(worth, key=lambda w: w.effect):
            told = [f"{w.what} ({w.now})" if w.now else w.what for w in group]
            parts.append(f"{', '.join(told)}: {effect}")
        return parted(parts)

    @property
    def unsettled(self) -> tuple[str, ...]:
        """What the open findings assume: measuring it settles them."""
        return tuple(dict.fromkeys(text for f in self.findings if f.state is Judged.OPEN for text in f.assumptions))

    @property
    def assumed_besides(self) -> tuple[str, ...]:
        """What is assumed besides what the entry asks to be measured."""
        named = self.unsettled if self.open_for else ()
        return tuple(text for text in self.assumptions if text not in named)


@dataclass(frozen=True, slots=True)
class Lead:
    """The most urgent finding of an object, as a page other than its own names it."""

    title: str
    outcome: str


@dataclass(frozen=True, slots=True)
class Pointer:
    """An object as a page other than its own names it: what it is, where its entry is, what happens, what to do.

    Attributes
    ----------
    measure : str
        The first recommendation in a sentence, "" where there is none.
    chance : ChanceView or None
        How likely it comes to harm, None where nobody knows.
    """

    number: str
    short: str
    page: str
    anchor: str
    gallery: str
    state: State
    lead: Lead | None = None
    measure: str = ""
    chance: ChanceView | None = None


@dataclass(frozen=True, slots=True)
class TaskView:
    """One line of "What to do first": a measure and the objects it is for, the most urgent ones first.

    Attributes
    ----------
    measure : str
        Its name, "" where none helps.
    sets : tuple of str
        What to set on each of the objects, such as "clearance 14 cm"; "" for nothing.
    """

    title: str
    objects: tuple[ObjectView, ...]
    sets: tuple[str, ...] = ()
    advised: bool = True
    measure: str = ""

    @property
    def cautions(self) -> tuple[str, ...]:
        """What has to be minded with every one of the objects, for paper without their entries."""
        told = [m.cautions for o in self.objects for m in o.measures if m.measure == self.measure]
        return tuple(one for one in told[0] if all(one in each for each in told)) if told else ()

    @property
    def grave(self) -> int:
        """How many of the objects are likely to fall or break."""
        return sum(o.grave for o in self.objects)


@dataclass(frozen=True, slots=True)
class DecisionsView:
    """The decisions of a page: how many of each kind, and each with its object (None where that is gone).

    Attributes
    ----------
    settled : int
        How many objects are settled by them.
    doubted : tuple[tuple[DecisionView, Pointer | None], ...]
        Those that must be looked at again.
    groups
        The others by kind.
    """

    accepted: int = 0
    installed: int = 0
    classes: int = 0
    verdicts: int = 0
    settled: int = 0
    doubted: tuple[tuple[DecisionView, Pointer | None], ...] = ()
    groups: tuple[tuple[str, tuple[tuple[DecisionView, Pointer | None], ...]], ...] = ()

    def __bool__(self) -> bool:
        """Whether there is any."""
        return bool(self.doubted or self.groups)


NO_DECISIONS = DecisionsView()


@dataclass(frozen=True, slots=True)
class TurnView:
    """A verdict that turned, and why; ``view`` is the object where the report has it."""

    number: str
    view: Pointer | None
    gallery: str
    model: str
    level: str
    before: str
    after: str
    causes: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class ChangeView:
    """One line of what changed: the object where it is about one, and the change in words."""

    number: str
    view: Pointer | None
    text: str


@dataclass(frozen=True, slots=True)
class SinceView:
    """What changed since the run before; lists are cut, each with how many more there are.

    Attributes
    ----------
    before : str
        When that run began.
    counts, causes : tuple[tuple[str, str], ...]
        How many of what, those above zero only.
    """

    before: str
    changed: bool
    worse: tuple[tuple[TurnView, ...], int]
    fixed: tuple[tuple[TurnView, ...], int]
    counts: tuple[tuple[str, str], ...]
    causes: tuple[tuple[str, str], ...]
    lists: tuple[tuple[str, tuple[ChangeView, ...], int], ...]


@dataclass(frozen=True, slots=True)
class PageView:
    """Which of its gallery's pages a page is: large galleries are cut into several.

    Attributes
    ----------
    number, of : int
        From 1.
    first, last : str
        Numbers of the objects between which it lies in the catalogue's order.
    """

    file: str
    number: int = 1
    of: int = 1
    first: str = ""
    last: str = ""


@dataclass(frozen=True, slots=True)
class Entry:
    """What the index says of a gallery's page, and of those on it that it names; kept beside the report as JSON.

    Attributes
    ----------
    task : str
        What is to do first there, in words, "" where nothing is advised.
    leaders : tuple[tuple[Urgency, Pointer], ...]
        Its most urgent objects that nobody has settled, each with the key that sorts it among all.
    check : tuple[tuple[Urgency, Pointer], ...]
        The same of those whose record is to be checked first, which are not among the leaders.
    run : str
        That found what is newest on it.
    made : str
        When, ISO 8601.
    """

    name: str
    on_display: bool
    page: PageView
    counts: StateCounts
    task: str
    leaders: tuple[tuple[Urgency, Pointer], ...] = ()
    check: tuple[tuple[Urgency, Pointer], ...] = ()
    decisions: DecisionsView = DecisionsView()
    run: str = ""
    made: str = ""
