"""The night, from the museum's records to the published report."""

import warnings
from collections import Counter
from collections.abc import Mapping, Sequence
from contextlib import ExitStack, nullcontext
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from typing import Any, Protocol, TypeVar

from pipeline.analysis.faults import LIKE
from pipeline.collection.database import damage_told, verify_file
from pipeline.collection.inventory import latest_import
from pipeline.collection.inventory.records import DamagedRecordError, repair
from pipeline.collection.listing import Listing
from pipeline.errors import DamageWarning, InputError, near
from pipeline.motions.site import Site
from pipeline.night.importing import Imported, import_collection, source_of
from pipeline.night.photographs import Photographs
from pipeline.night.prepare import Pictures, admit, illustrate, pictures, run_context
from pipeline.night.publication import Publication
from pipeline.night.reading_summary import doubts_of
from pipeline.night.scheduler import Scheduler
from pipeline.night.source_state import unchanged
from pipeline.night.staff import Staff
from pipeline.night.stocks import keep_stocks
from pipeline.operations.dry_run import DryRunWarning, rehearsed
from pipeline.operations.report_status import Status, last_good, mark_good, mark_running, reports_lost, status, terms_of
from pipeline.operations.run_summary import SUMMARY, Stores, Summary, summary_text
from pipeline.operations.stopping import uninterrupted
from pipeline.operations.workspace import UsageError, Workspace, locked, open_workspace, tidy
from pipeline.records import Page, Progress, RunRecord, Tally, Urgent
from pipeline.report import lasting_name, publish
from pipeline.report.files.manifest import PreviousReport
from pipeline.report.pages.compose import PERIODS
from pipeline.report.pages.decided import by_object
from pipeline.report.pages.reading import IMAGES, READING
from pipeline.report.pages.survey_words import SURVEY_SECONDS
from pipeline.report.pages.tallies import counts
from pipeline.report.pages.views import State
from pipeline.settings import Settings
from pipeline.store.decisions import decisions_in_force
from pipeline.store.runs import changes_since, commit_run, mark_finished
from pipeline.store.sound import SELECTION, comparable, whole_runs


@dataclass(frozen=True)
class Selection:
    """Which part of the collection to run; nothing named means all of it."""

    galleries: tuple[str, ...] = ()
    objects: tuple[str, ...] = ()

    def __bool__(self) -> bool:
        """Whether anything was named."""
        return bool(self.galleries or self.objects)


def run(
    settings: Settings,
    progress: Progress,
    selection: Selection | None = None,
    *,
    dry_run: bool = False,
    resume: bool = False,
    strict: bool = False,
) -> Summary:
    """Assess the collection and publish the report; the last report stays until this one is whole.

    What has not changed is not found again: results are kept by a digest of everything that they depend on.

    Parameters
    ----------
    settings : Settings
        Of the museum.
    progress : Progress
        Is told how far it is.
    selection : Selection, optional
        The objects that are assessed; all of them where it is left out.
    dry_run : bool
        Assess and summarise; nothing is written, the museum's source not taken in.
    resume : bool
        Go on where a run was cut off: with the inventory as that run had read it, if it got so far.
    strict : bool
        Objects that cannot be assessed are the exit code 3.

    Returns
    -------
    Summary

    Raises
    ------
    KourosError
        With an `exit_code`: settings 2, motions 4, collection 5, lock 6, shrunk 7.
    """
    with rehearsed(settings, dry_run) as lent, damage_told(settings.database):
        return _run(lent, progress, selection or Selection(), dry_run=dry_run, resume=resume, strict=strict)


def _run(
    settings: Settings, progress: Progress, chosen: Selection, *, dry_run: bool, resume: bool, strict: bool
) -> Summary:
    with locked(settings):
        started = datetime.now(UTC)
        cut_off = status(settings)
        if not (chosen or dry_run):
            mark_running(settings)
        workspace = open_workspace(settings)
        verify_file(workspace.engine)
        shown = last_good(settings)
        lost = "" if dry_run or shown is not None else reports_lost(settings, len(whole_runs(workspace.engine)))
        if lost:
            warnings.warn(f"{lost}; this night's report is put there", DamageWarning, stacklevel=2)
        if shown is not None and not dry_run:
            # A run that was cut off when its report was shown already, and that the database did not hear of.
            mark_finished(workspace.engine, shown.run_id)
        # Nearly every night of the whole museum uses nearly all of it again.
        previous = None if chosen or dry_run else PreviousReport.read(workspace.reports / "latest")
        looking = nullcontext() if previous is None else previous.looking()
        with Staff(settings.execution) as staff, looking, ExitStack() as stack:
            if not chosen:
                staff.begin_compiling()
            site = _read_site(workspace, progress)
            drawing = stack.enter_context(pictures(workspace, site))
            if not (resume and _was_read(workspace, cut_off)):
                new = _refresh(workspace, progress, dry_run=dry_run)
                staff.call(0 if chosen else new)

            def held() -> Summary:
                night = _planned(workspace, site, chosen, drawing, started, progress, staff)
                try:
                    return _hold(night, drawing, previous, progress, chosen, dry_run=dry_run, strict=strict)
                finally:
                    tidy(settings, night.context.motions)

            try:
                return held()
            except DamagedRecordError as problem:
                if dry_run or not settings.collection.source:
                    raise
                warnings.warn(f"{problem}; they are read again now", DamageWarning, stacklevel=2)
                repair(workspace.engine, problem.numbers)
                _refresh(workspace, progress, dry_run=False)
                return held()


def _planned(
    workspace: Workspace,
    site: Site,
    chosen: Selection,
    drawing: Pictures,
    started: datetime,
    progress: Progress,
    staff: Staff,
) -> Scheduler:
    """Return the run with all that is shared in it made ready, and what there is to do known."""
    index = workspace.object_index()
    objects = _chosen(index.objects, chosen)
    context = run_context(workspace, site, index, objects, started)
    charts, models = admit(workspace, context, index, objects, site.manifest.site.x_azimuth)
    if not chosen:
        staff.begin_compiling(models)
    if charts or staff.compiling:
        # What they need is not to be built twice, nor compiled.
        illustrate(context, drawing, progress)
    return Scheduler(workspace, context, index, objects, decisions_in_force(workspace.engine), staff, charts)


def _hold(
    night: Scheduler,
    drawing: Pictures,
    previous: PreviousReport | None,
    progress: Progress,
    chosen: Selection,
    *,
    dry_run: bool,
    strict: bool,
) -> Summary:
    """Do what there is to do, store it, publish it, say what changed."""
    workspace, engine = night.workspace, night.workspace.engine
    night.assess(progress, store=not dry_run)
    illustrate(night.context, drawing, progress)
    photographs = Photographs(workspace)
    if not dry_run:
        stores = workspace.settings.display.stores
        seen = [number for page in night.pages if page.part.on_display or stores for number in page.numbers()]
        photographs.gather(seen, progress, whole=not chosen)
    shown = Publication(night, photographs, previous)
    if dry_run:
        return _judged(summarise(_ended(night, shown, chosen), shown.pages, shown.tally(progress)), strict=strict)
    with shown.writer() as writer:
        found = shown.publish(writer, progress)
        _stand_by(night, found)
        head = _with(photographs, _ended(night, shown, chosen))
        # A part is not compared: what was left out of it has not changed.
        before = None if chosen else comparable(engine, whole_runs(engine))
        strangers = shown.strangers(whole=not chosen)
        whole = replace(head, decisions=(*head.decisions, *strangers))
        told = counts(found)
        commit_run(engine, whole, shown.pages, shown.rows(), counts=told, damaged=night.damaged, published=False)
        changes = None if before is None else changes_since(engine, before, head.run_id)
        progress.step("report", 0, 1)
        # A part of the collection is worth a report, but not the name of the museum's latest one.
        latest = None if chosen else lasting_name(workspace.reports)
        summary = summarise(whole, shown.pages, found)
        index = writer.folder / "index.html"
        summary = replace(summary, fresh=night.fresh, report=index, latest=latest, changes=changes)
        summary = _judged(summary, strict=strict)
        beside = {SUMMARY: summary_text(summary, writer.folder)}
        doubts = doubts_of(workspace, head)
        ended, terms = replace(head, decisions=strangers), terms_of(workspace)
        writer.finish(ended, found, changes, shown.links(changes), beside, doubts, terms)
    with uninterrupted():
        # From here on the report is whole: first it is shown, then said to be good.
        if latest is not None:
            publish(writer.folder, workspace.reports)
        mark_finished(engine, head.run_id)
        if latest is not None:
            mark_good(workspace.settings, summary)
    if latest is not None and night.context.stock is not None:
        keep_stocks(workspace, night.context.stock, shown.pages)
    progress.step("report", 1, 1)
    return summary


def _stand_by(night: Scheduler, found: Tally) -> None:
    """Refuse a night in which Kouros failed on every object that it assessed: that is no object's doing.

    raises : RuntimeError with the first failure; the last report stays
    """
    states = (*found.states.items(), *found.stored.items())
    answered = sum(number for state, number in states if state not in (State.UNKNOWN, State.ASIDE))
    if night.faults and not answered and found.faults > LIKE:
        raise RuntimeError(
            f"nothing could be assessed: Kouros failed on {found.faults:,} objects: {night.faults[0].words}"
        )


def _judged(summary: Summary, *, strict: bool) -> Summary:
    return replace(summary, exit_code=3 if strict and summary.cannot else 0)


def _ended(night: Scheduler, shown: Publication, chosen: Selection) -> RunRecord:
    head = night.context.head
    more: dict[str, Any] = {SELECTION: bool(chosen)}
    if night.context.surveyed:
        more[SURVEY_SECONDS] = round(night.seconds, 3)
    finished = datetime.now(UTC).isoformat(timespec="milliseconds")
    return replace(head, finished=finished, settings={**head.settings, **more}, decisions=shown.standing)


def _with(photographs: Photographs, head: RunRecord) -> RunRecord:
    """Return the run with what is said of photographs that are not shown."""
    told, notes = photographs.told(), tuple(photographs.notes())
    settings = head.settings
    if told and settings.get(READING) is not None:
        settings = {**settings, READING: {**settings[READING], "images": told["images"]}, IMAGES: told[IMAGES]}
    return replace(head, settings=settings, level_notes=(*head.level_notes, *notes))


def _was_read(workspace: Workspace, cut_off: Status | None) -> bool:
    """Say whether the run that was cut off had brought the museum's source into the inventory."""
    info = latest_import(workspace.engine)
    return (
        info is not None
        and cut_off is not None
        and cut_off.stale
        and info.imported_at >= (cut_off.began or cut_off.since)
    )


def _refresh(workspace: Workspace, progress: Progress, *, dry_run: bool) -> int:
    """Bring the museum's source into the inventory, and return how many of its records are new or changed."""
    wanted = workspace.settings.collection
    new = 0
    if not wanted.source:
        return new
    progress.step("collection", 0, 1)
    if not unchanged(workspace, wanted.source, wanted.mapping):
        source = source_of(workspace, wanted.source)
        done = import_collection(
            workspace,
            source,
            wanted.mapping,
            shrink_limit=wanted.shrink_limit,
            # A database that goes with the dry run takes the records in, so that there is something to assess.
            dry_run=dry_run and not workspace.scratch,
            nightly=True,
        )
        if dry_run and not workspace.scratch:
            _told(done)
        elif done.changes:
            new = done.changes.counts.added + done.changes.counts.changed
    progress.step("collection", 1, 1)
    return new


def _told(done: Imported) -> None:
    """Say what a dry run does not take into the inventory, and so does not assess."""
    if done.changes:
        c = done.changes.counts
        warnings.warn(
            f"the real one takes the source in first: {c.added:,} new, {c.removed:,} gone, {c.changed:,} changed of "
            f"{c.after:,} objects; a dry run assesses the inventory as it is",
            DryRunWarning,
            stacklevel=2,
        )


def _chosen(objects: Listing, chosen: Selection) -> Listing:
    if objects and not chosen:
        return objects
    return Listing.of(named(objects, galleries=chosen.galleries, objects=chosen.objects))


class _Object(Protocol):
    @property
    def object_number(self) -> str: ...
    @property
    def gallery(self) -> str: ...


_Some = TypeVar("_Some", bound=_Object)


def named(items: Sequence[_Some], *, galleries: Sequence[str] = (), objects: Sequence[str] = ()) -> list[_Some]:
    """Return the items of these galleries and with these numbers; nothing named means all.

    Raises
    ------
    EmptyCollectionError
        Where there are none.
    UsageError
        For an unknown name, with close ones.
    """
    if not items:
        raise EmptyCollectionError("the inventory is empty: import the museum's export first (`kouros import FILE`)")
    _known("gallery", galleries, {item.gallery for item in items})
    _known("object", objects, {item.object_number for item in items})
    return [
        item
        for item in items
        if (not galleries or item.gallery in galleries) and (not objects or item.object_number in objects)
    ]


class EmptyCollectionError(InputError):
    """There is nothing to assess."""

    exit_code = 5


def _known(what: str, wanted: Sequence[str], known: set[str]) -> None:
    for name in wanted:
        if name not in known:
            raise UsageError(f"there is no {what} {name!r} in the inventory{near(name, known)}")


def _read_site(workspace: Workspace, progress: Progress) -> Site:
    progress.step("motions", 0, 1)
    site = workspace.site()
    progress.step("motions", 1, 1)
    return site


def summarise(head: RunRecord, pages: Sequence[Page], found: Tally) -> Summary:
    """Put what a run found on one screen: every object on display is in exactly one of act, watch, fine and cannot.

    Parameters
    ----------
    head : RunRecord
        The run without its objects.
    pages : sequence of Page
        Of the run.
    found : Tally
        Of all its pages together.

    Returns
    -------
    Summary
    """
    states, stored = found.states, found.stored
    shown = sum(states.values())
    stores = None
    if stored and State.ASIDE not in stored:
        told = {name: stored.get(state, 0) for name, state in _COUNTED.items()}
        stores = Stores(**told, findings=found.stored_findings, measures=found.stored_measures)
    return Summary(
        run_id=head.run_id,
        started=head.started,
        finished=head.finished,
        version=head.version,
        museum=head.museum,
        site=head.site,
        objects=shown + sum(stored.values()),
        on_display=shown,
        galleries=len({page.gallery for page in pages if page.on_display}),
        assessed=shown - states["unknown"],
        cannot=states["unknown"],
        act=states["act"],
        watch=states["watch"],
        fine=states["fine"],
        open_for=found.open_for,
        findings=found.findings,
        measures=found.measures,
        missing=found.missing,
        stores=stores,
        reading=head.settings.get(READING),
        check=found.check,
        levels=_by_level(head, found),
        first=[f"{u.object_number}  {u.title[:48]}  ({u.gallery}): {u.outcome}" for u in _unsettled(head, found)],
        stands_by=found.stands_by,
        faults=found.faults,
        worth=found.worth if found.surveyed else None,
        survey_seconds=float(head.settings.get(SURVEY_SECONDS, 0.0)),
        decisions=dict(Counter(s.decision.kind.value for s in head.decisions)),
        doubted=[
            f"{d.object_number}: {d.matter}, {d.who}, {d.date}: {'; '.join(s.doubts)}"
            for s in head.decisions
            for d in (s.decision,)
            if s.doubts
        ],
        efforts=[{"title": title, **effort} for title, effort in found.efforts.items()],
    )


def _by_level(head: RunRecord, found: Tally) -> list[dict[str, Any]]:
    """Count what is on display by each level of shaking; of a single one the states are those of the objects."""
    periods: Mapping[str, float | None] = head.settings.get(PERIODS) or {}
    states = found.levels or dict.fromkeys(list(periods)[:1], found.states)
    return [
        {"name": name, "return_period_years": years}
        | {state.value: states[name].get(state, 0) for state in (State.ACT, State.WATCH, State.FINE)}
        for name, years in periods.items()
        if name in states
    ]


_COUNTED = {"act": State.ACT, "watch": State.WATCH, "fine": State.FINE, "cannot": State.UNKNOWN}


def _unsettled(head: RunRecord, found: Tally, most: int = 5) -> list[Urgent]:
    """Return the worst objects of which not everything is accepted or overruled beyond doubt."""
    about = by_object(head.decisions)
    return [
        one
        for one in found.first
        if not all(any(s.covers(*bad) for s in about.get(one.object_number, ())) for bad in one.open)
    ][:most]
