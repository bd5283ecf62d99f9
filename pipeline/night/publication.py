"""The pages of a run: drawn by workers into the report, with how the decisions about what is on them stand."""

from collections.abc import Callable, Collection, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, closing
from dataclasses import dataclass, field
from functools import partial
from math import isinf
from typing import Any

from pipeline.analysis.classify import object_classes
from pipeline.analysis.faults import Fault, fitting
from pipeline.collection.inventory import fields_since
from pipeline.night.context import RunContext
from pipeline.night.photographs import Photographs
from pipeline.night.scheduler import PlannedPage, Scheduler
from pipeline.records import (
    Assessment,
    Basis,
    Decision,
    DecisionKind,
    DecisionStatus,
    Finding,
    Found,
    MotionSummary,
    Page,
    Photo,
    Progress,
    RunChanges,
    RunRecord,
    Tally,
    Verdict,
)
from pipeline.report.files.manifest import PreviousReport
from pipeline.report.files.page_renderer import PageRenderer, RenderedPage
from pipeline.report.files.report_writer import ReportWriter, link_to, page_key
from pipeline.report.pages.since import mentioned
from pipeline.report.pages.tallies import total
from pipeline.report.pages.views import Pointer
from pipeline.store.pages import Members, found_of, page_row

MORE = 1.1
"""How many times its utilisation at the time of a decision a finding may reach before the decision is in doubt."""

_RESTING = (DecisionKind.ACCEPT, DecisionKind.VERDICT)
"""Kinds of decisions that rest on findings, and are nothing without them."""

_BESIDE = frozenset({"provenance", "image", "image_credit"})
"""Fields on which no decision rests: where a number was read from may change without the number."""

_SEVERITY = {Verdict.PASS: 0, Verdict.UNDETERMINED: 1, Verdict.FAIL: 2}


@dataclass(frozen=True)
class Now:
    """What a run found, and the inventory of now, for the objects that were decided about.

    Attributes
    ----------
    digests : mapping of str to str
        Of the records, by object number; an object without one is gone.
    changed : Callable[[str, str], Collection[str]]
        Object number and digest of its record then -> the fields that changed since, as far as that is known.
    today : str
        ISO 8601.
    """

    assessments: Mapping[str, Assessment]
    motions: Collection[MotionSummary]
    digests: Mapping[str, str]
    changed: Callable[[str, str], Collection[str]]
    today: str


def now(
    assessments: Iterable[Assessment],
    head: RunRecord,
    digests: Mapping[str, str],
    changed: Callable[[str, str], Collection[str]],
) -> Now:
    """Return what decisions are held against after a run; today is the day on which it began.

    Parameters
    ----------
    assessments : iterable of Assessment
        Of the objects decided about.
    head : RunRecord
        The run, for its motions and its day.

    Returns
    -------
    Now
    """
    found = {assessment.scene.item.object_number: assessment for assessment in assessments}
    return Now(found, head.motions, digests, changed, head.started[:10])


def standing(decisions: Iterable[Decision], at: Now) -> tuple[DecisionStatus, ...]:
    """Return the decisions, each with the reasons for which it must be looked at again."""
    return tuple(DecisionStatus(decision, tuple(dict.fromkeys(_doubts(decision, at)))) for decision in decisions)


def _doubts(decision: Decision, at: Now) -> Iterable[str]:
    if decision.until and at.today > decision.until:
        yield f"the risk was accepted until {decision.until} only"
    if decision.object_class and decision.object_class not in object_classes():
        yield f"there is no class {decision.object_class} any more, so that it is not used"
    digest = at.digests.get(decision.object_number)
    if digest is None:
        yield "the object is no longer in the inventory"
        return
    if digest != decision.digest:
        fields = list(at.changed(decision.object_number, decision.digest))
        told = [name for name in fields if name not in _BESIDE]
        if told or not fields:
            yield f"its record has changed{': ' if told else ''}{', '.join(told)}"
    assessment = at.assessments.get(decision.object_number)
    if assessment is None or decision.kind is DecisionKind.CLASS:
        return
    if assessment.aside:
        # What it rests on was not computed, so that nothing can be held against it.
        if decision.kind in _RESTING:
            yield "the object is not on display, and was not assessed"
        return
    yield from _shaken(decision, assessment, at.motions)
    yield from _judged(decision, assessment)


def _shaken(decision: Decision, assessment: Assessment, motions: Collection[MotionSummary]) -> Iterable[str]:
    floor = assessment.scene.floor
    for basis in decision.basis:
        if basis.motion_hash not in {m.hash for m in motions if (m.level, m.floor) == (basis.level, floor)}:
            yield f"the motion {basis.motion} of level {basis.level} has changed"


def _judged(decision: Decision, assessment: Assessment) -> Iterable[str]:
    found = {(f.model, f.level, f.title): f for f in assessment.findings}
    looked_at = {(b.model, b.level, b.title): b for b in decision.basis}
    rests = decision.kind in _RESTING
    for key, basis in looked_at.items():
        finding = found.get(key)
        where = f"{basis.title}, level {basis.level}"
        if finding is None:
            # A measure or another class takes models away, and is meant to.
            if rests:
                yield f"{where}: there is no such finding any more"
        elif _SEVERITY[finding.verdict] > _SEVERITY[basis.verdict]:
            yield f"{where}: {basis.verdict} then, {finding.verdict} now"
        elif _more(decision, basis, finding):
            yield f"{where}: utilisation {_written(basis.utilisation)} then, {_written(finding.utilisation)} now"
    if decision.kind is DecisionKind.ACCEPT:
        for key, finding in found.items():
            if key not in looked_at and finding.verdict is not Verdict.PASS and decision.concerns(*key[:2]):
                yield f"{finding.title}, level {finding.level}: {finding.verdict} now, and was not looked at then"


def _written(utilisation: float | None) -> str:
    return "∞" if utilisation is None or isinf(utilisation) else f"{utilisation:.2f}"


def _more(decision: Decision, basis: Basis, finding: Finding) -> bool:
    if basis.utilisation is None or finding.utilisation is None:
        return False
    # Of what passes only that counts which the decision names: else a hundredth of the limit would matter.
    counts = finding.verdict is not Verdict.PASS or decision.model
    return bool(counts) and finding.utilisation > MORE * basis.utilisation


@dataclass(frozen=True)
class PageTask:
    """A page to be rendered.

    Attributes
    ----------
    page
        Where it belongs.
    members
        Its objects.
    results
        Theirs by key, as they are kept.
    decisions
        About its objects, as they stand.
    draw
        Whether it is wanted itself; else its totals alone.
    photos
        Pictures of its objects by number.
    """

    page: Page
    members: Members
    results: Mapping[str, bytes]
    decisions: tuple[DecisionStatus, ...] = field(default=())
    draw: bool = True
    photos: Mapping[str, Photo] = field(default_factory=dict)


@dataclass(frozen=True)
class Rendered:
    """What came of a `PageTask`: the totals, the page where it was wanted, and the objects that Kouros failed on."""

    tally: Tally
    page: RenderedPage | None = None
    faults: tuple[Fault, ...] = ()


def render_page(context: RunContext, task: PageTask) -> Rendered:
    """Render a page; an object that Kouros fails on is shown as one that cannot be assessed, and told."""
    found = found_of(task.members, task.results)
    if not task.draw:
        return Rendered(context.renderer.tally(found))
    if context.stock is not None and task.page.on_display:
        context.stock.keep(task.page, found)
    faults: list[Fault] = []
    # What renders is made outside of any object's guard: a language without a catalogue is nobody's fault here.
    shown, page = fitting(found, partial(_drawn, context.renderer, task), faults)
    return Rendered(page.tally if shown is found else context.renderer.tally(shown), page, tuple(faults))


def _drawn(renderer: PageRenderer, task: PageTask, found: Found) -> RenderedPage:
    return renderer.draw(task.page, found, task.decisions, task.photos)


@dataclass
class _PublishedPage:
    """A page of the run, now that all results on it are known.

    Attributes
    ----------
    planned
        What is on it.
    page
        Where it belongs.
    standing
        The decisions about its objects, as they stand.
    row
        Of the database, where it is not there yet and was made already.
    photographed
        Whether an object on it has a picture.
    """

    planned: PlannedPage
    page: Page
    standing: tuple[DecisionStatus, ...]
    row: dict[str, Any] | None = None
    photographed: bool = False


class Publication:
    """The pages of a run whose units have results.

    Parameters
    ----------
    scheduler
        Of the run, after its `assess`.
    photographs
        Of its objects, gathered; none are shown without.
    previous
        The report whose pages may be used again; the latest, read when it is needed, where it is left out.
    """

    def __init__(
        self, scheduler: Scheduler, photographs: Photographs | None = None, previous: PreviousReport | None = None
    ) -> None:
        self._scheduler, self._previous = scheduler, previous
        self._photographs = photographs or Photographs(None)
        self._digests = scheduler.index.digests(list(scheduler.decisions))
        self._pages = [self._settled(page) for page in scheduler.pages]

    def _settled(self, planned: PlannedPage) -> _PublishedPage:
        """Say where a page belongs, and how the decisions about it stand."""
        stands = self._standing(planned)
        if self._scheduler.is_failed(planned):
            # What is kept of it names results that are not there.
            planned.kept = None
        part, made = planned.part, planned.kept or self._scheduler.newest_of(planned)
        key = self._scheduler.key_of(planned)
        page = Page(key, part.gallery, part.on_display, part.number, part.of, made.run, made.made)
        return _PublishedPage(planned, page, stands)

    def _standing(self, planned: PlannedPage) -> tuple[DecisionStatus, ...]:
        about = self._scheduler.decisions
        mine = [decision for number in planned.numbers() for decision in about.get(number, ())] if about else []
        if not mine:
            return ()
        found = found_of(*self._scheduler.found(planned))
        return self._stands(found, sorted(mine, key=lambda decision: decision.id))

    def _stands(self, found: Found, decisions: Sequence[Decision]) -> tuple[DecisionStatus, ...]:
        digests = {number: self._digests[number] for number in {d.object_number for d in decisions}}
        engine = self._scheduler.workspace.engine
        at = now(
            found.assessments,
            self._scheduler.context.head,
            digests,
            lambda number, digest: () if digest == digests[number] else tuple(fields_since(engine, number, digest)),
        )
        return standing(decisions, at)

    @property
    def pages(self) -> tuple[Page, ...]:
        """The pages of the run."""
        return tuple(one.page for one in self._pages)

    def rows(self, *, kept: bool = False) -> Iterator[dict[str, Any]]:
        """Yield the rows of those pages that the database does not have, or, for another database, of all."""
        for one in self._pages:
            if kept or one.planned.kept is None:
                yield one.row or page_row(one.page, self._scheduler.members(one.planned))

    @property
    def standing(self) -> tuple[DecisionStatus, ...]:
        """The decisions about the objects of the run, as they stand."""
        return tuple(one for page in self._pages for one in page.standing)

    def strangers(self, *, whole: bool) -> tuple[DecisionStatus, ...]:
        """Return the decisions about objects that the collection does not have any more.

        Parameters
        ----------
        whole : bool
            Whether the run is of all objects: else what is not in it is not gone.

        Returns
        -------
        tuple of DecisionStatus
        """
        if not whole:
            return ()
        decisions = self._scheduler.decisions
        gone = [d for number, mine in decisions.items() if number not in self._digests for d in mine]
        at = now((), self._scheduler.context.head, {}, lambda _number, _digest: ())
        return standing(sorted(gone, key=lambda d: d.id), at)

    # -----------------------------------------------------------------------------------------------------------------
    # The report

    def writer(self) -> ReportWriter:
        """Return the report that the pages go into; it is entered before `publish`, and finished after it."""
        reports, head = self._scheduler.workspace.reports, self._scheduler.context.head
        previous = self._previous or PreviousReport.read(reports / "latest")
        return ReportWriter(reports / head.run_id, self._scheduler.context.renderer, previous)

    def publish(self, writer: ReportWriter, progress: Progress) -> Tally:
        """Put every page into the report, and return the totals."""
        context = self._scheduler.context
        keys = [page_key(context.renderer, one.page, one.standing, self._known(one)) for one in self._pages]
        writer.look(keys)
        reused = [writer.has(key) for key in keys]
        left = [page for page, there in zip(self._pages, reused, strict=True) if not there]
        tallies = []
        with self._rendered(left, draw=True) as rendered:
            for at, (one, key, there) in enumerate(zip(self._pages, keys, reused, strict=True)):
                progress.step("pages", at, len(keys))
                if there:
                    tallies.append(writer.reuse(key))
                    continue
                came = next(rendered)
                self._scheduler.failed(came.faults)
                if came.page is None:
                    raise ValueError("a page that was to be rendered was not")
                # A page on which an object failed is tried again every night.
                again = came.faults or self._scheduler.is_failed(one.planned)
                again = again or (one.photographed and self._photographs.lost(one.planned.numbers()))
                writer.add(f"{key}:{context.head.run_id}" if again else key, came.page)
                tallies.append(came.tally)
        progress.step("pages", len(keys), len(keys))
        return total(tallies)

    def _known(self, one: _PublishedPage) -> dict[str, Photo]:
        known = self._photographs.known(one.planned.numbers())
        one.photographed = bool(known)
        return known

    def tally(self, progress: Progress) -> Tally:
        """Return the totals without a report."""
        tallies = []
        with self._rendered(self._pages, draw=False) as rendered:
            for at, came in enumerate(rendered):
                progress.step("pages", at + 1, len(self._pages))
                tallies.append(came.tally)
        return total(tallies)

    def _rendered(self, pages: Sequence[_PublishedPage], *, draw: bool) -> AbstractContextManager[Generator[Rendered]]:
        return closing(self._each_rendered(pages, draw=draw))

    def _each_rendered(self, pages: Sequence[_PublishedPage], *, draw: bool) -> Generator[Rendered]:
        objects = sum(len(page.planned.part.objects) for page in pages)
        scheduler = self._scheduler
        with scheduler.staff.workers(objects, scheduler.context, showing=True) as (workers, context):
            tasks = (self._page_task(page, draw=draw) for page in pages)
            with closing(workers.each(render_page, context, tasks)) as done:
                yield from done

    def _page_task(self, one: _PublishedPage, *, draw: bool) -> PageTask:
        members, results = self._scheduler.found(one.planned)
        if one.planned.kept is None and draw:
            one.row = page_row(one.page, members)
        photos = self._photographs.of(one.planned.numbers()) if draw and one.photographed else {}
        return PageTask(one.page, members, results, one.standing, draw, photos)

    def links(self, changes: RunChanges | None) -> dict[str, Pointer]:
        """Return where the objects are that the index names as changed, by number."""
        named = set() if changes is None else mentioned(changes)
        out: dict[str, Pointer] = {}
        for one in self._pages if named else ():
            mine = named.intersection(one.planned.numbers())
            if mine:
                items = self._scheduler.index.items(sorted(mine))
                out |= {number: link_to(one.page, number, item.called) for number, item in items.items()}
        return out
