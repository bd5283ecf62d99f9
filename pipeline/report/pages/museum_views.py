"""Views of the page of a gallery and of the index, put together of the views of their parts."""

from dataclasses import dataclass, field

from pipeline.report.pages.class_curves import ClassCurveView
from pipeline.report.pages.floor_plan import GalleryPlanView
from pipeline.report.pages.judging import RoomView, ShakingView, SpacingView
from pipeline.report.pages.numerics import DecidedView, SelfTestView
from pipeline.report.pages.reading import ReadingView
from pipeline.report.pages.views import (
    NO_DECISIONS,
    DecisionsView,
    MotionLink,
    ObjectView,
    PageView,
    Pointer,
    SinceView,
    State,
    StateCounts,
    SurveyView,
    TaskView,
)


@dataclass(frozen=True, slots=True)
class GalleryRow:
    """One gallery's row of the index, with all its pages.

    Attributes
    ----------
    unchanged : str
        The day on which what is newest of it was found; "" where that is of this run.
    """

    name: str
    on_display: bool
    pages: tuple[PageView, ...]
    counts: StateCounts
    task: str
    unchanged: str = ""


@dataclass(frozen=True, slots=True)
class LevelRow:
    """How many objects are in which state at one level of shaking; period: how often it comes, "" where nobody says."""

    name: str
    period: str
    counts: StateCounts


@dataclass(frozen=True, slots=True)
class MotionView:
    """One motion's section: measures with units, charts, processing steps, who answers for it.

    Attributes
    ----------
    table : tuple[tuple[str, tuple[str, ...]], ...]
        Rows of PGA, PGV, PGD, Arias intensity; one text a column (see ``columns``), "–" where not computed.
    others : tuple[tuple[str, str], ...]
        Measures that fit in no column.
    corner : str
        What of it hangs on the corner of its filter, "" where it was not filtered here.
    charts : tuple of str
        Keys of the charts that were drawn for this motion, in the order of the paper's figures.
    """

    name: str
    hash: str
    anchor: str
    level: str
    source: str
    licence: str
    approved: str
    sampling: str
    columns: tuple[str, ...]
    table: tuple[tuple[str, tuple[str, ...]], ...]
    others: tuple[tuple[str, str], ...]
    corner: str
    charts: tuple[str, ...]
    steps: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class EffortView:
    """By what the verdicts of one model were decided; ``any`` is the share of analyses for which a history was run."""

    title: str
    analyses: int
    certificate: int
    chart: int
    history: int
    any: str


@dataclass(frozen=True, slots=True)
class GalleryView:
    """One gallery's page, or one of its pages."""

    name: str
    page: PageView
    on_display: bool
    counts: StateCounts
    tasks: tuple[TaskView, ...]
    objects: tuple[ObjectView, ...]
    charts: tuple[str, ...]
    motions: tuple[MotionLink, ...]
    several_levels: bool
    survey: tuple[SurveyView, ...] = ()
    surveyed: bool = False
    plan: GalleryPlanView | None = None
    spacings: tuple[SpacingView, ...] = ()
    rooms: tuple[RoomView, ...] = ()
    shaking: ShakingView | None = None
    decisions: DecisionsView = NO_DECISIONS
    credits: tuple[tuple[str, int], ...] = ()

    def standing(self, state: State) -> tuple[ObjectView, ...]:
        """Return the objects in that state, the most urgent first."""
        return tuple(o for o in self.objects if o.state is state)


@dataclass(frozen=True, slots=True)
class MuseumView:
    """The index: all galleries, ranked, with totals over all on display; ``credit`` is the source's own line.

    Attributes
    ----------
    counts : StateCounts
        Of what is on display.
    rows : tuple of GalleryRow
        The galleries, the one with the most to do first.
    check : tuple of Pointer
        The first of those whose record is to be checked before anything is done; checks: how many there are.
    levels : tuple of LevelRow
        What there is to do at each level of shaking, where there are several.
    stores : GalleryRow or None
        What is not on display, with totals of its own; None where everything is on display.
    reading : ReadingView or None
        What was refused and is doubted of the museum's records.
    whole : bool
        Whether the run is of the whole collection.
    workbook : bool
        Whether the exports include a workbook: it is left out where it would be too long.
    decided : tuple of DecidedView
        What settled the verdicts, by kind.
    fidelities : str
        How many verdicts were asked at which fidelity, in one line.
    self_test : SelfTestView or None
        None where none was run before this run.
    furniture : str
        Of how many objects it is known from where what they stand on, in one line, "" of none.
    survey : str
        What is worth measuring in the whole museum and what asking cost, "" where it was not asked.
    classes : tuple of ClassCurveView
        From what shaking on the classes of objects come to harm; none where that was not asked.
    since : SinceView or None
        None where there was no run before.
    """

    museum: str
    site: str
    run_id: str
    started: str
    finished: str
    version: str
    credit: str
    demonstration: bool
    counts: StateCounts
    rows: tuple[GalleryRow, ...]
    first: tuple[Pointer, ...]
    motions: tuple[MotionView, ...]
    check: tuple[Pointer, ...] = ()
    checks: int = 0
    levels: tuple[LevelRow, ...] = ()
    level_notes: tuple[str, ...] = field(default=())
    efforts: tuple[EffortView, ...] = ()
    self_test: SelfTestView | None = None
    decided: tuple[DecidedView, ...] = ()
    fidelities: str = ""
    furniture: str = ""
    survey: str = ""
    decisions: DecisionsView = NO_DECISIONS
    since: SinceView | None = None
    workbook: bool = True
    stores: GalleryRow | None = None
    reading: ReadingView | None = None
    whole: bool = True
    classes: tuple[ClassCurveView, ...] = ()

    @property
    def complete(self) -> bool:
        """Whether none of the museum's objects is left out of the counts, and this is known."""
        read = self.reading
        return self.whole and self.stores is None and read is not None and read.known and not read.refused
