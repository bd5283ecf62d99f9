"""A run's record becomes the views: judged, ranked and counted; nothing is computed again."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from math import inf, isnan
from typing import Any

from pipeline.records import Assessment, Recommendation, RunChanges, RunRecord, Spacing, Verdict
from pipeline.report.decided import decisions_view
from pipeline.report.describe import Describer, percent
from pipeline.report.errors import ReportError
from pipeline.report.floor_plan import plan_view
from pipeline.report.ground import motion_view
from pipeline.report.judging import first_failure, room_views, shaking_view, spacing_views
from pipeline.report.language import said
from pipeline.report.numerics import decided_views, fidelities
from pipeline.report.ranking import state_of, urgency
from pipeline.report.selftest import self_test_view
from pipeline.report.since import since_view
from pipeline.report.survey_words import errands, survey_sentence
from pipeline.report.text import clean, slug, words
from pipeline.report.units import Units
from pipeline.report.views import (
    STATES,
    Counts,
    EffortView,
    GalleryView,
    MuseumView,
    ObjectView,
    State,
    TaskView,
)

STORED_PAGE = "not-on-display.html"
"""File of the objects that are not on display; a gallery's file always ends in a hash, so the two never meet."""

EFFORTS = "efforts"
"""The setting of a run that says what the verdicts of each model took."""

_HELPLESS = "\0"
"""Groups the objects for which nothing helps; no measure of a table can have this name."""


def compose(record: RunRecord, units: Units, changes: RunChanges | None = None) -> MuseumView:
    """Return everything that the pages show, in the order in which they show it.

    changes : since the run before, None where there was none
    raises : ReportError for a sentence with an unknown placeholder, a mark on a chart that the run does not hold, or
             two galleries whose files would have one name
    """
    describer = Describer(record, units)
    ranked = sorted(record.assessments, key=urgency)
    shown: dict[tuple[bool, str], list[Assessment]] = {}
    for assessment in ranked:
        item = assessment.scene.item
        shown.setdefault((item.on_display, item.gallery if item.on_display else ""), []).append(assessment)
    levels = {f.level for a in record.assessments for f in a.findings}
    between: dict[str, list[Spacing]] = {}
    for spacing in record.spacings:
        between.setdefault(spacing.gallery, []).append(spacing)
    galleries = [
        _gallery(key, members, describer, units, between.get(key[1], ()), several=len(levels) > 1)
        for key, members in shown.items()
    ]
    pages = Counter(g.page for g in galleries)
    twins = [g.name for g in galleries if pages[g.page] > 1]
    if twins:
        raise ReportError(f"galleries {twins} would share one file; rename one of them in the collection's records")
    galleries.sort(key=lambda g: (not g.on_display, -g.counts.act, -g.counts.open, -g.counts.unknown, g.name))
    everything = {(o.page, o.anchor): o for g in galleries for o in g.objects}
    order = [everything[_address(a, describer)] for a in ranked]
    by_number = {a.scene.item.object_number: o for a, o in zip(ranked, order, strict=True)}
    return MuseumView(
        museum=clean(record.museum),
        site=clean(record.site),
        run_id=clean(record.run_id),
        started=clean(record.started),
        finished=clean(record.finished),
        version=clean(record.version),
        credit=clean(str(record.settings.get("credit") or "")),
        demonstration=record.demonstration,
        counts=_total(g.counts for g in galleries),
        galleries=tuple(galleries),
        first=tuple([o for o in order if o.state is State.ACT and not o.settled][:8]),
        motions=tuple(motion_view(m, record.charts, units) for m in record.motions),
        level_notes=tuple(clean(n) for n in record.level_notes),
        efforts=tuple(_effort(e) for e in record.settings.get(EFFORTS) or ()),
        self_test=self_test_view(record),
        decided=decided_views(record),
        fidelities=fidelities(record),
        survey=survey_sentence(record),
        decisions=decisions_view(order, describer.decided.strangers(record.assessments)),
        since=None if changes is None else since_view(changes, by_number, units),
    )


def _effort(effort: Mapping[str, Any]) -> EffortView:
    analyses, needing = int(effort["analyses"]), int(effort["needing_history"])
    return EffortView(
        said(clean(str(effort["title"]))),
        analyses,
        int(effort["certificate"]),
        int(effort["chart"]),
        int(effort["history"]),
        f"{100.0 * needing / max(analyses, 1):.0f} %",
    )


def page_of(assessment: Assessment) -> str:
    """Return the file of the page on which an object is shown."""
    item = assessment.scene.item
    return f"{slug(item.gallery)}.html" if item.on_display else STORED_PAGE


def _address(assessment: Assessment, describer: Describer) -> tuple[str, str]:
    return page_of(assessment), describer.anchor(assessment)


def _total(counts: Iterable[Counts]) -> Counts:
    listed = list(counts)
    return Counts(*(sum(getattr(c, state.value) for c in listed) for state in STATES))


def _gallery(
    key: tuple[bool, str],
    members: Sequence[Assessment],
    describer: Describer,
    units: Units,
    spacings: Sequence[Spacing],
    *,
    several: bool,
) -> GalleryView:
    on_display, name = key
    views = [describer.object(a, page_of(a)) for a in members]
    pairs = list(zip(members, views, strict=True))
    by_state = Counter(v.state for v in views)
    return GalleryView(
        name=clean(name) if on_display else "",
        page=page_of(members[0]),
        on_display=on_display,
        counts=Counts(*(by_state[state] for state in STATES)),
        tasks=_tasks(pairs, describer, units),
        objects=tuple(views),
        charts=tuple(dict.fromkeys(f.chart for v in views for f in v.figures)),
        motions=tuple(dict.fromkeys(f.motion for v in views for f in v.findings)),
        several_levels=several,
        survey=errands(pairs, describer.wishes),
        surveyed=describer.surveyed,
        plan=plan_view(pairs, units),
        spacings=spacing_views(spacings, units) if on_display else (),
        rooms=room_views(members, units) if on_display else (),
        shaking=shaking_view(members) if on_display else None,
        decisions=decisions_view(views),
    )


def _tasks(pairs: Sequence[tuple[Assessment, ObjectView]], describer: Describer, units: Units) -> tuple[TaskView, ...]:
    """Group the recommendations by measure; the pairs come by urgency, and so do the groups.

    What people accepted or overruled is no task, as long as nothing of that is in doubt.
    """
    members: dict[str, list[ObjectView]] = {}
    advice: dict[str, list[Recommendation]] = {}
    for assessment, view in pairs:
        for recommendation in assessment.recommendations:
            if describer.decided.covered(assessment, recommendation.level):
                continue
            group = members.setdefault(recommendation.measure, [])
            if not group or group[-1] is not view:
                group.append(view)
            advice.setdefault(recommendation.measure, []).append(recommendation)
        if view.state is State.ACT and not assessment.recommendations and not view.settled:
            members.setdefault(_HELPLESS, []).append(view)
    size = {view.anchor: _utilisation(assessment) for assessment, view in pairs}
    worst = {key: percent(max(size[o.anchor] for o in objects)) for key, objects in members.items()}
    return tuple(
        TaskView(said(clean(advice[key][0].title)), tuple(objects), _spans(advice[key], units), worst=worst[key])
        if key in advice
        else TaskView("", tuple(objects), advised=False, worst=worst[key])
        for key, objects in members.items()
    )


def _utilisation(assessment: Assessment) -> float:
    """Return the largest utilisation of an object, endless where one of a failure is not known."""
    sizes = [f.utilisation for f in assessment.findings if f.verdict is not Verdict.PASS]
    return max((inf if u is None or isnan(u) else u for u in sizes), default=0.0)


def _spans(advice: Sequence[Recommendation], units: Units) -> tuple[tuple[str, str], ...]:
    values: dict[tuple[str, str], list[float]] = {}
    for recommendation in advice:
        for name, value in recommendation.parameters.items():
            values.setdefault((name, recommendation.units.get(name, "")), []).append(value)
    return tuple((words(name), units.pair(min(v), max(v), unit)) for (name, unit), v in values.items())


def object_rows(record: RunRecord) -> list[Mapping[str, str | bool | float | None]]:
    """Return one plain row for every object of the run, assessed or not, for the export that adds up to all."""
    describer = Describer(record, Units())
    return [
        {
            "run": record.run_id,
            "object_number": a.scene.item.object_number,
            "title": a.scene.item.title,
            "gallery": a.scene.item.gallery,
            "on_display": a.scene.item.on_display,
            "state": state_of(a).value,
            "object_class": a.scene.object_class,
            "missing": "; ".join(a.scene.missing),
            **first_failure(a),
            "page": f"{page_of(a)}#{describer.anchor(a)}",
        }
        for a in record.assessments
    ]
