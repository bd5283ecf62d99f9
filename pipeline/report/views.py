"""What a page shows, as plain data in the reader's units: the museum, a gallery, an object, a finding, a measure."""

from dataclasses import dataclass, field
from enum import StrEnum

from pipeline.report.svg import Spot


class State(StrEnum):
    """Where an object stands, in the order in which the report lists it."""

    ACT = "act"
    OPEN = "open"
    UNKNOWN = "unknown"
    SAFE = "safe"


STATES = tuple(State)


@dataclass(frozen=True, slots=True)
class Counts:
    """How many objects are in each state; the four add up to all."""

    act: int = 0
    open: int = 0
    unknown: int = 0
    safe: int = 0

    @property
    def total(self) -> int:
        """All objects counted."""
        return self.act + self.open + self.unknown + self.safe


@dataclass(frozen=True, slots=True)
class Bar:
    """A utilisation as a bar: percent of its track (the limit lies in the middle) and whether it runs off the end."""

    percent: float
    beyond: bool
    over: bool


@dataclass(frozen=True, slots=True)
class FindingView:
    """One finding in words; ``state`` is act, open or safe."""

    title: str
    level: str
    state: State
    outcome: str
    sentence: str
    demand_name: str
    demand: str
    span: str
    capacity: str
    capacity_origin: str
    utilisation: str
    bar: Bar | None
    fidelity: str
    error: str
    decided_by: str
    screen: str
    note: str
    motion: str
    motion_short: str
    motion_anchor: str
    approved: str


@dataclass(frozen=True, slots=True)
class CheckView:
    """One model run again on the changed chain."""

    title: str
    demand: str
    capacity: str
    utilisation: str
    passes: bool


@dataclass(frozen=True, slots=True)
class MeasureView:
    """One recommendation in words."""

    measure: str
    title: str
    level: str
    sentence: str
    numbers: tuple[tuple[str, str], ...]
    checks: tuple[CheckView, ...]
    rejected: tuple[str, ...]
    source: str


@dataclass(frozen=True, slots=True)
class NumberView:
    """A number that a model was run with: its value and range, and where it comes from."""

    name: str
    value: str
    span: str
    origin: str
    note: str
    source: str


@dataclass(frozen=True, slots=True)
class FigureView:
    """A chart of the run with an object's marks."""

    chart: str
    spots: tuple[Spot, ...]


@dataclass(frozen=True, slots=True)
class ObjectView:
    """One object with everything that the report says about it; ``lead`` is its most urgent finding."""

    number: str
    title: str
    short: str
    anchor: str
    gallery: str
    page: str
    state: State
    value_class: str
    object_class: str
    rule: str
    support: str
    place: str
    lead: FindingView | None
    findings: tuple[FindingView, ...]
    measures: tuple[MeasureView, ...]
    figures: tuple[FigureView, ...]
    numbers: tuple[NumberView, ...]
    assumptions: tuple[str, ...]
    missing: tuple[str, ...]
    problems: tuple[tuple[str, str, str], ...]
    skipped: tuple[tuple[str, str], ...]

    @property
    def carded(self) -> bool:
        """Whether the object has a card of its own: it fails or is open."""
        return self.state in (State.ACT, State.OPEN)


@dataclass(frozen=True, slots=True)
class TaskView:
    """One line of "What to do first": a measure and the objects it is for, the most urgent ones first.

    numbers : parameters of the measure with the range over the objects, such as ("clearance", "9 to 14 cm")
    """

    title: str
    objects: tuple[ObjectView, ...]
    numbers: tuple[tuple[str, str], ...] = ()
    advised: bool = True


@dataclass(frozen=True, slots=True)
class GalleryView:
    """One gallery's page."""

    name: str
    page: str
    on_display: bool
    counts: Counts
    tasks: tuple[TaskView, ...]
    objects: tuple[ObjectView, ...]
    charts: tuple[str, ...]
    several_levels: bool

    @property
    def cards(self) -> tuple[ObjectView, ...]:
        """The objects that get a card."""
        return tuple(o for o in self.objects if o.carded)


@dataclass(frozen=True, slots=True)
class MotionView:
    """One motion's section: measures with units, processing steps, who answers for it."""

    name: str
    hash: str
    short: str
    anchor: str
    level: str
    source: str
    licence: str
    approved: str
    sampling: str
    measures: tuple[tuple[str, str], ...]
    steps: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class MuseumView:
    """The index: all galleries, ranked, with totals over all objects."""

    museum: str
    site: str
    run_id: str
    started: str
    finished: str
    version: str
    demonstration: bool
    counts: Counts
    galleries: tuple[GalleryView, ...]
    first: tuple[ObjectView, ...]
    motions: tuple[MotionView, ...]
    level_notes: tuple[str, ...] = field(default=())
