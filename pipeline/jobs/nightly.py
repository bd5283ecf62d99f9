"""The night, from the museum's records to the published report."""

import os
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path
from time import perf_counter
from typing import Any

from pipeline import __version__
from pipeline.assess import assess
from pipeline.charting import Shelf
from pipeline.charts import chart_keys, charts, picture_version
from pipeline.climb import Effort
from pipeline.collection.inventory import galleries, latest_import, read_inventory
from pipeline.execute import Threads
from pipeline.fragility.objects import fragilities
from pipeline.jobs import selftest, tradeoff
from pipeline.jobs.deciding import Decided, decided, place, stand
from pipeline.jobs.importing import import_collection, source_of
from pipeline.jobs.levels import Storey, notes, storeys
from pipeline.jobs.outcome import write_summary
from pipeline.jobs.reporting import manner
from pipeline.jobs.standing import mark_good, mark_running
from pipeline.jobs.versions import code_digest, rules_digest
from pipeline.jobs.workspace import (
    KEPT,
    UsageError,
    Workspace,
    charts_of,
    locked,
    near,
    open_workspace,
)
from pipeline.kernels import KERNEL_VERSION
from pipeline.mitigate import advise
from pipeline.mitigate.installed import assess_above
from pipeline.models import model_named
from pipeline.motions.site import Level, Site
from pipeline.neighbours import neighbours
from pipeline.records import (
    Assessment,
    Chart,
    Executor,
    Fragility,
    Item,
    Motion,
    Progress,
    RunChanges,
    RunRecord,
    Spacing,
    Standing,
    Support,
    Verdict,
    Wish,
)
from pipeline.report import publish, render
from pipeline.report.compose import EFFORTS
from pipeline.report.survey_words import SURVEY_SECONDS
from pipeline.settings import Settings
from pipeline.store.reuse import CODE, KERNELS, LEVELS, PICTURES, RULES, SELECTION, stored_charts, whole_runs
from pipeline.store.runs import compare_runs, save_run
from pipeline.survey import in_order, wishes


@dataclass(frozen=True)
class Selection:
    """Which part of the collection to run; nothing named means all of it."""

    galleries: tuple[str, ...] = ()
    objects: tuple[str, ...] = ()

    def __bool__(self) -> bool:
        """Whether anything was named."""
        return bool(self.galleries or self.objects)


@dataclass(frozen=True)
class Summary:
    """What a run did, for one screen and for programs.

    objects       : all that were looked at; act + open + safe + cannot is the same number
    worth         : how many measurements would settle a verdict, None where that was not asked
    survey_seconds: what asking cost
    missing       : why objects could not be assessed, with how many of each
    decisions     : how many of each kind are in force
    doubted       : those of them that must be looked at again, with the reasons
    efforts       : what the verdicts of each model took, see `pipeline.climb.Effort`
    report        : the report's index, None for a dry run
    """

    run_id: str
    started: str
    finished: str
    version: str
    museum: str
    site: str
    objects: int
    on_display: int
    galleries: int
    assessed: int
    cannot: int
    act: int
    open: int
    safe: int
    findings: int
    measures: Mapping[str, int]
    missing: Mapping[str, int]
    first: Sequence[str]
    worth: int | None = None
    survey_seconds: float = 0.0
    decisions: Mapping[str, int] = field(default_factory=dict)
    doubted: Sequence[str] = ()
    efforts: Sequence[Mapping[str, Any]] = ()
    report: Path | None = None
    latest: Path | None = None
    changes: RunChanges | None = field(default=None, repr=False)


def run(
    settings: Settings, progress: Progress, selection: Selection | None = None, *, dry_run: bool = False
) -> Summary:
    """Assess the collection and publish the report; the last report stays until this one is whole.

    dry_run : assess and summarise, but store and publish nothing
    raises  : errors with an `exit_code`: settings 2, motions 4, collection 5, lock 6, shrunk 7
    """
    chosen = selection or Selection()
    with locked(settings):
        started = datetime.now(UTC)
        if not (chosen or dry_run):
            mark_running(settings)
        manner(settings)  # A catalogue that is missing is said before the night's work, not after it.
        workspace = open_workspace(settings)
        _refresh(workspace, progress, dry_run=dry_run)
        inventory = read_inventory(workspace.engine)
        items = named(inventory, galleries=chosen.galleries, objects=chosen.objects)
        site = _read_site(workspace, progress)
        decisions = decided(workspace)
        record = assess_items(workspace, items, inventory, site, started, progress, decisions)
        record = replace(
            record,
            settings={**record.settings, SELECTION: bool(chosen)},
            decisions=stand(workspace, record, decisions, whole=not chosen),
        )
        summary = summarise(record)
        if dry_run:
            return summary
        # A part is not compared: what was left out of it has not changed.
        before = [] if chosen else whole_runs(workspace.engine)[:1]
        save_run(workspace.engine, record)
        changes = compare_runs(workspace.engine, before[0], record.run_id) if before else None
        progress.step("report", 0, 1)
        index = render(record, workspace.reports / record.run_id, changes=changes, **manner(settings))
        # A part of the collection is worth a report, but not the name of the museum's latest one.
        latest = None if chosen else publish(index.parent, workspace.reports)
        progress.step("report", 1, 1)
        summary = replace(summary, report=index, latest=latest, changes=changes)
        write_summary(summary, index.parent)
        if latest is not None:
            mark_good(settings, summary)
        return summary


def _refresh(workspace: Workspace, progress: Progress, *, dry_run: bool) -> None:
    wanted = workspace.settings.collection
    if not wanted.source:
        return
    progress.step("collection", 0, 1)
    source = source_of(workspace, wanted.source)
    import_collection(
        workspace, source, wanted.mapping, shrink_limit=wanted.shrink_limit, dry_run=dry_run, nightly=True
    )
    progress.step("collection", 1, 1)


def named(items: Sequence[Item], *, galleries: Sequence[str] = (), objects: Sequence[str] = ()) -> list[Item]:
    """Return the items of these galleries and with these numbers; nothing named means all.

    raises : EmptyCollectionError where there are none; UsageError for an unknown name, with close ones
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


class EmptyCollectionError(ValueError):
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


def assess_items(
    workspace: Workspace,
    items: Sequence[Item],
    inventory: Sequence[Item],
    site: Site,
    started: datetime,
    progress: Progress,
    decisions: Decided,
) -> RunRecord:
    """Run everything that the objects require under the site's motions, floor by floor, judge it and advise.

    inventory : all objects, the others included: which galleries there are
    decisions : those in force: classes and installed measures change what is run
    started   : when the run began, which names it
    raises    : SettingsError for a floor that the site does not have, MotionError for a floor's record
    """
    settings = workspace.settings
    executor = Threads(settings.analysis.workers or None)
    floors = storeys(settings, site, items)
    assessments: dict[int, Assessment] = {}
    asked = _Asked() if settings.report.survey else None
    # Motions that two floors share (one record for several) are drawn once.
    motions = {one.motion.hash: one.motion for f in floors for level in f.levels for one in level.motions}
    efforts: dict[str, Effort] = {}
    spacings: list[Spacing] = []
    with charts_of(settings, motions) as shelf:
        # The pictures first: the verdicts use their charts.
        drawn = _charts(workspace, list(motions.values()), executor, progress, shelf)
        for storey in floors:
            spacings += _assess_storey(
                storey, items, workspace, executor, progress, shelf, assessments, decisions, efforts, asked
            )
    measured = tradeoff.kept(settings.path(KEPT))
    if measured is not None:
        picture = tradeoff.picture(measured)
        drawn[picture.key] = picture
    tested = selftest.kept(settings.path(KEPT))
    info = latest_import(workspace.engine)
    levels_said = [_level_note(level) for level in site.levels]
    return RunRecord(
        run_id=f"{started:%Y%m%dT%H%M%S}.{started.microsecond // 1000:03d}-{os.getpid()}",
        started=started.isoformat(timespec="milliseconds"),
        finished=datetime.now(UTC).isoformat(timespec="milliseconds"),
        version=__version__,
        site=site.name,
        museum=settings.museum.name or (info.museum if info else ""),
        level_notes=(*levels_said, *notes(settings, site, {item.gallery for item in inventory})),
        settings=_stored_settings(settings, site, info.credit if info else "", tested, efforts)
        | ({} if asked is None else {SURVEY_SECONDS: round(asked.seconds, 3)}),
        assessments=tuple(assessments[index] for index in range(len(items))),
        charts=drawn,
        motions=tuple(summary for storey in floors for summary in storey.summaries),
        demonstration=settings.demonstration,
        wishes=None if asked is None else tuple(in_order(asked.found)),
        spacings=tuple(spacings),
    )


@dataclass
class _Asked:
    """What is worth measuring, storey by storey, and the seconds that finding out took."""

    found: list[Wish] = field(default_factory=list)
    seconds: float = 0.0


def _assess_storey(
    storey: Storey,
    items: Sequence[Item],
    workspace: Workspace,
    executor: Executor,
    progress: Progress,
    shelf: Shelf,
    assessments: dict[int, Assessment],
    decisions: Decided,
    efforts: dict[str, Effort],
    asked: _Asked | None,
) -> list[Spacing]:
    """Fill in what is found about the objects of a storey; return what was found between them."""
    # Before the long work: a table that cannot be used is told at once.
    means = workspace.means
    objects = [place(workspace, items[index], decisions) for index in storey.members]
    scenes = [replace(one.scene, floor=storey.name) for one in objects]
    settings, levels = workspace.settings, storey.shaking
    step = settings.analysis.azimuth_step
    plan, findings = assess(
        scenes,
        levels,
        executor,
        progress,
        fidelity=settings.analysis.fidelity,
        azimuth_step=step,
        charts=shelf,
        efforts=efforts,
    )
    above = assess_above(objects, levels, executor, progress, fidelity=_integrating(settings), azimuth_step=step)
    for at, (on_top, left_out) in enumerate(above):
        findings[at] += on_top
        done = {finding.title for finding in findings[at]}
        skipped = {title: why for title, why in {**plan.skipped[at], **left_out}.items() if title not in done}
        scenes[at] = replace(scenes[at], skipped=skipped)
    advice = advise(
        scenes,
        findings,
        levels,
        executor,
        progress,
        means=means,
        fidelity=settings.analysis.fidelity,
        azimuth_step=step,
        charts=shelf,
    )
    curves: Sequence[tuple[Fragility, ...]] = [()] * len(scenes)
    if settings.analysis.fragility:
        # What an isolator passes on would have to be scaled too.
        shown = [s.item.on_display and s.support is not Support.ISOLATED for s in scenes]
        curves = fragilities(scenes, plan.work, storey.stripes, executor, progress, chosen=shown)
    for index, scene, found, advised, curve in zip(storey.members, scenes, findings, advice, curves, strict=True):
        assessments[index] = Assessment(scene, tuple(found), tuple(advised), curve)
    if asked is not None:
        began = perf_counter()
        # Each trial is asked once: a chart would not pay.
        fidelity = _integrating(settings)
        asked.found += wishes(scenes, findings, levels, executor, progress, fidelity=fidelity, azimuth_step=step)
        asked.seconds += perf_counter() - began
    return neighbours(scenes, findings, levels)


def _integrating(settings: Settings) -> str:
    # Few objects stand on isolators, each on its own: neither charts nor bounds of what these pass on would pay.
    return "reference" if settings.analysis.fidelity == "reference" else "history"


def _stored_settings(
    settings: Settings, site: Site, credit: str, tested: selftest.SelfTest | None, efforts: Mapping[str, Effort]
) -> dict[str, Any]:
    # Never the database's address: it may hold a password.
    return {
        KERNELS: KERNEL_VERSION,
        PICTURES: picture_version(),
        CODE: code_digest(),
        RULES: rules_digest(settings),
        LEVELS: {level.name: level.combine for level in site.levels},
        "credit": credit,
        "analysis": settings.analysis.model_dump(),
        "length": settings.report.length,
        "site": settings.site.folder,
        "floors": settings.floors.model_dump(),
        EFFORTS: [{"title": model_named(name).title, **effort.plain()} for name, effort in efforts.items()],
        "numerics": None if tested is None else tested.plain(),
    }


def _charts(
    workspace: Workspace, motions: Sequence[Motion], executor: Executor, progress: Progress, shelf: Shelf
) -> dict[str, Chart]:
    drawn: dict[str, Chart] = {}
    for done, motion in enumerate(motions):
        progress.step("charts", done, len(motions))
        kept = stored_charts(workspace.engine, chart_keys(motion), picture_version())
        drawn |= kept if len(kept) == len(chart_keys(motion)) else charts(motion, executor, shelf)
    progress.step("charts", len(motions), len(motions))
    return drawn


def _level_note(level: Level) -> str:
    period = "" if level.return_period_years is None else f", return period {level.return_period_years:g} years"
    answers = (
        f"approved by {level.approved_by} on {level.approved_on}"
        if level.approved_by
        else "no engineer has approved these motions"
    )
    number = len(level.motions)
    how = "1 motion" if number == 1 else f"the {level.combine} of {number} motions"
    caution = f"; {level.caution}" if level.caution else ""
    return f"Level {level.name}{period}: {how}{caution}; {answers}."


def summarise(record: RunRecord) -> Summary:
    """Count what a run found: every object is in exactly one of act, open, safe and cannot."""
    act = open_ = safe = 0
    for assessment in record.assessments:
        if not assessment.assessed:
            continue
        verdicts = {finding.verdict for finding in assessment.findings}
        if Verdict.FAIL in verdicts:
            act += 1
        elif Verdict.UNDETERMINED in verdicts:
            open_ += 1
        else:
            safe += 1
    objects = len(record.assessments)
    items = [assessment.scene.item for assessment in record.assessments]
    advice = [advised for assessment in record.assessments for advised in assessment.recommendations]
    missing = Counter(
        reason for assessment in record.assessments if not assessment.assessed for reason in assessment.scene.missing
    )
    return Summary(
        run_id=record.run_id,
        started=record.started,
        finished=record.finished,
        version=record.version,
        museum=record.museum,
        site=record.site,
        objects=objects,
        on_display=sum(item.on_display for item in items),
        galleries=len(galleries(items)),
        assessed=act + open_ + safe,
        cannot=objects - act - open_ - safe,
        act=act,
        open=open_,
        safe=safe,
        findings=sum(len(assessment.findings) for assessment in record.assessments),
        measures=dict(Counter(advised.title for advised in advice).most_common()),
        missing=dict(missing.most_common()),
        first=_first(record),
        worth=None if record.wishes is None else sum(not wish.waste for wish in record.wishes),
        survey_seconds=float(record.settings.get(SURVEY_SECONDS, 0.0)),
        decisions=dict(Counter(s.decision.kind.value for s in record.decisions)),
        doubted=[
            f"{d.object_number}: {d.matter}, {d.who}, {d.date}: {'; '.join(s.doubts)}"
            for s in record.decisions
            for d in (s.decision,)
            if s.doubts
        ],
        efforts=record.settings.get(EFFORTS, ()),
    )


def _first(record: RunRecord, most: int = 5) -> list[str]:
    """Name the objects on display that fail worst: those that fall or break, by how far they are beyond.

    What is accepted, and not in doubt, is not among them.
    """
    settled: dict[str, list[Standing]] = {}
    for standing in record.decisions:
        settled.setdefault(standing.decision.object_number, []).append(standing)
    failing = []
    for assessment in record.assessments:
        mine = settled.get(assessment.scene.item.object_number, ())
        worst = [
            f
            for f in assessment.findings
            if f.verdict is Verdict.FAIL and not any(s.covers(f.model, f.level) for s in mine)
        ]
        if worst and assessment.scene.item.on_display:
            finding = max(worst, key=lambda f: (f.outcome in ("overturns", "breaks"), f.utilisation or 0.0))
            failing.append(
                (finding.outcome in ("overturns", "breaks"), finding.utilisation or 0.0, assessment, finding)
            )
    failing.sort(key=lambda entry: (-entry[0], -entry[1], entry[2].scene.item.object_number))
    return [
        f"{a.scene.item.object_number}  {a.scene.item.title[:48]}  ({a.scene.item.gallery}): {f.outcome}"
        for _, _, a, f in failing[:most]
    ]
