"""Composition of pages: findings about a page's objects become its view, and all pages' entries become the index."""

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import inf

from pipeline.analysis.stakes import to_check
from pipeline.quantities import sorting_key
from pipeline.records import Assessment, Page, Photo, Recommendation, RunRecord, Tally, Urgency
from pipeline.report.assumed import assumed
from pipeline.report.errors import ReportError
from pipeline.report.language import _, local, ngettext, said
from pipeline.report.pages.class_curves import class_curve_views, class_curves
from pipeline.report.pages.decided import Decided, decisions_view, merged
from pipeline.report.pages.describe import Describer, Sayings
from pipeline.report.pages.floor_plan import plan_view
from pipeline.report.pages.ground import motion_view
from pipeline.report.pages.judging import room_views, shaking_view, spacing_views
from pipeline.report.pages.museum_views import EffortView, GalleryRow, GalleryView, LevelRow, MuseumView
from pipeline.report.pages.numerics import decided_views, fidelities, self_test_view
from pipeline.report.pages.photo_views import credits_of, photo_view
from pipeline.report.pages.reading import reading_view
from pipeline.report.pages.scene_words import furniture_known
from pipeline.report.pages.survey_words import SURVEY_SECONDS, errands, survey_sentence
from pipeline.report.pages.tallies import urgency
from pipeline.report.pages.views import (
    Entry,
    Lead,
    ObjectView,
    PageView,
    Pointer,
    SinceView,
    State,
    StateCounts,
    TaskView,
)
from pipeline.report.pages.walking import WalkView, numbers_to_set, walk_view
from pipeline.report.text import clean, count, digest, slug
from pipeline.report.units import Units, percent

STORED = "not-on-display"
"""Stem of the files of the objects that are not on display; a gallery's ends in a hash, so the two never meet."""

SELECTION = "selection"
"""Key of a run's settings that is true for a run of a part of the collection."""

PERIODS = "return_periods"
"""Key of a run's settings with the return period of each level of shaking, years; None where the manifest has none."""

LEADERS = 8
"""Objects that the index names as the most urgent."""

_LAST: Urgency = (len(State), True, True, inf, inf, inf, "", "")
"""Sorts after every object."""

_HELPLESS, _UNNAMED = "\0", "\0\0"
"""Groups the objects for which nothing helps, and those to be named first; no measure of a table has such a name."""


@dataclass(frozen=True, slots=True)
class PageHead:
    """What a gallery's page says of where it comes from; it stays as it is as long as its results do.

    Attributes
    ----------
    finished : str
        When its results were found.
    """

    museum: str
    run_id: str
    finished: str
    version: str
    credit: str
    demonstration: bool
    started: str = ""


def page_head(head: RunRecord, page: Page) -> PageHead:
    """Return what a page says of the run that found it."""
    return PageHead(
        museum=clean(head.museum),
        run_id=clean(page.run),
        finished=clean(page.made),
        version=clean(head.version),
        credit=clean(str(head.settings.get("credit") or "")),
        demonstration=head.demonstration,
    )


@dataclass(frozen=True)
class Composed:
    """A gallery's page ready to be filled in, what the index says of it, and the ids and ranks of its objects.

    Attributes
    ----------
    walk : WalkView or None
        The sheet to walk the gallery with; None for what is not on display.
    """

    gallery: GalleryView
    entry: Entry
    walk: WalkView | None
    anchor: Callable[[Assessment], str]
    key: Callable[[Assessment], Urgency | None]


def compose(
    record: RunRecord,
    page: Page,
    units: Units,
    sayings: Sayings | None = None,
    *,
    several: bool,
    photos: Mapping[str, Photo] | None = None,
) -> Composed:
    """Return everything that a page shows, in the order in which it shows it.

    Parameters
    ----------
    record : RunRecord
        The run with the objects, wishes, spacings and decisions of this page only.
    sayings : Sayings or None, optional
        What was put into words on other pages of the run, in this language and these units.
    several : bool
        Whether the run has several levels of shaking.
    photos : mapping of str to Photo or None, optional
        Pictures of its objects, by number.

    Returns
    -------
    Composed

    Raises
    ------
    ReportError
        For a sentence with an unknown placeholder or a mark on a chart that the run does not hold.
    """
    describer = Describer(record, units, sayings or Sayings(record.motions, units))
    members = sorted(record.assessments, key=urgency)
    if members and all(a.aside for a in members):
        members.sort(key=lambda a: sorting_key(a.scene.item.object_number))
    file = page_name(page.gallery, page.number, on_display=page.on_display)
    spacings = spacing_views(record.spacings, units) if page.on_display else ()
    views = [replace(describer.object(a, file), photo=photo_view(a.scene.item, photos or {})) for a in members]
    pairs = list(zip(members, views, strict=True))
    by_state = Counter(v.state for v in views)
    unsettled = sum(bool(v.open_for) for v in views)
    numbers = sorted((v.number for v in views), key=sorting_key)
    gallery = GalleryView(
        name=clean(page.gallery) if page.on_display else "",
        page=PageView(file, page.number, page.of, *(numbers[:1] + numbers[-1:])),
        on_display=page.on_display,
        counts=StateCounts(**{state.value: by_state[state] for state in State}, open=unsettled),
        tasks=_tasks(pairs, describer, units),
        objects=tuple(views),
        charts=tuple(dict.fromkeys(f.chart for v in views for f in v.figures)),
        motions=tuple(dict.fromkeys(f.motion for v in views for f in v.findings)),
        several_levels=several,
        survey=errands(pairs, describer.wishes),
        surveyed=describer.surveyed,
        plan=plan_view(pairs, spacings, units),
        spacings=spacings,
        rooms=room_views(members, units) if page.on_display else (),
        shaking=shaking_view(members) if page.on_display else None,
        decisions=decisions_view([(v.decisions, v.settled, pointer(v)) for v in views if v.decisions]),
        credits=credits_of(v.photo for v in views),
    )
    walk = None
    if page.on_display:
        walk = walk_view(gallery.name, gallery.page, pairs, gallery.tasks, gallery.survey, describer.decided, units)
    return Composed(gallery, _entry(gallery, pairs, page), walk, describer.anchor, describer.key)


def _entry(gallery: GalleryView, pairs: Sequence[tuple[Assessment, ObjectView]], page: Page) -> Entry:
    open_ = [(a, v) for a, v in pairs if v.state is State.ACT and not v.settled]
    leaders = [(urgency(a), pointer(v)) for a, v in open_ if not to_check(a)]
    check = [(urgency(a), pointer(v)) for a, v in open_ if to_check(a)]
    return Entry(
        name=gallery.name,
        on_display=gallery.on_display,
        page=gallery.page,
        counts=gallery.counts,
        task=_first_task(gallery),
        leaders=tuple(leaders[:LEADERS]),
        check=tuple(check[:LEADERS]),
        decisions=decisions_view([(v.decisions, v.settled, pointer(v)) for _, v in pairs if v.decisions]),
        run=clean(page.run),
        made=clean(page.made),
    )


def pointer(view: ObjectView) -> Pointer:
    """Return an object as other pages than its own name it."""
    return Pointer(
        number=view.number,
        short=view.short,
        page=view.page,
        anchor=view.anchor,
        gallery=view.gallery,
        state=view.state,
        lead=None if view.lead is None else Lead(view.lead.title, view.lead.outcome),
        measure=view.measures[0].brief if view.measures else "",
        chance=view.chance,
    )


def _first_task(gallery: GalleryView) -> str:
    if not gallery.tasks:
        return ""
    task = gallery.tasks[0]
    number = len(task.objects)
    if task.advised:
        told = ngettext("%(title)s: %(shown)s object", "%(title)s: %(shown)s objects", number)
    else:
        told = ngettext(
            "No measure found for %(shown)s object: ask an engineer",
            "No measure found for %(shown)s objects: ask an engineer",
            number,
        )
    return told % {"title": task.title, "shown": count(number)}


def museum_view(
    head: RunRecord, entries: Sequence[Entry], tally: Tally, units: Units, since: SinceView | None, *, workbook: bool
) -> MuseumView:
    """Return everything that the index, the method page and the motion page show.

    Parameters
    ----------
    head : RunRecord
        The run without its objects; the decisions about objects that the run does not have are told besides.
    entries : sequence of Entry
        Of all pages.
    tally : Tally
        Of all pages together.

    Returns
    -------
    MuseumView

    Raises
    ------
    ReportError
        Where two galleries' files would have one name.
    """
    pages = Counter(entry.page.file for entry in entries)
    twins = [entry.name for entry in entries if pages[entry.page.file] > 1]
    if twins:
        raise ReportError(f"galleries {twins} would share one file; rename one of them in the collection's records")
    shown = [entry for entry in entries if entry.on_display]
    leaders = sorted((leader for entry in shown for leader in entry.leaders), key=lambda leader: leader[0])
    check = sorted((one for entry in shown for one in entry.check), key=lambda one: one[0])
    strangers = decisions_view([((d,), False, None) for d in Decided(head.decisions, units).all()])
    return MuseumView(
        museum=clean(head.museum),
        site=clean(head.site),
        run_id=clean(head.run_id),
        started=clean(head.started),
        finished=clean(head.finished),
        version=clean(head.version),
        credit=clean(str(head.settings.get("credit") or "")),
        demonstration=head.demonstration,
        counts=_total(entry.counts for entry in shown),
        rows=_rows(shown, head.run_id),
        stores=next(iter(_rows([entry for entry in entries if not entry.on_display], head.run_id)), None),
        first=tuple(leader for _, leader in leaders[:LEADERS]),
        check=tuple(one for _, one in check[:LEADERS]),
        checks=tally.check,
        levels=_levels(head, tally),
        motions=tuple(motion_view(m, head.charts, units) for m in head.motions),
        level_notes=tuple(_note(clean(n), units) for n in head.level_notes),
        efforts=tuple(_effort(title, efforts) for title, efforts in tally.efforts.items()),
        self_test=self_test_view(head),
        decided=decided_views(tally),
        fidelities=fidelities(tally),
        furniture=furniture_known(tally.stands_by),
        survey=survey_sentence(tally, float(head.settings.get(SURVEY_SECONDS, 0.0))),
        decisions=merged([*(entry.decisions for entry in entries), strangers]),
        since=since,
        workbook=workbook,
        reading=reading_view(head.settings),
        whole=not head.settings.get(SELECTION),
        classes=class_curve_views(class_curves(tally)),
    )


def _levels(head: RunRecord, tally: Tally) -> tuple[LevelRow, ...]:
    periods: Mapping[str, float | None] = head.settings.get(PERIODS) or {}
    names = [*(name for name in periods if name in tally.levels), *(n for n in tally.levels if n not in periods)]
    rows = []
    for name in names:
        years = periods.get(name)
        period = "" if years is None else _("%(years)s years") % {"years": local(f"{years:,g}")}
        rows.append(LevelRow(clean(name), period, StateCounts(**tally.levels[name])))
    return tuple(rows)


def _rows(entries: Sequence[Entry], run_id: str) -> tuple[GalleryRow, ...]:
    """Gather the pages of each gallery into a row, the gallery with the most to do first."""
    galleries: dict[tuple[bool, str], list[Entry]] = {}
    for entry in entries:
        galleries.setdefault((entry.on_display, entry.name), []).append(entry)
    rows = []
    for (on_display, name), members in galleries.items():
        members.sort(key=lambda entry: entry.page.number)
        # What comes first is what comes first on the page of the gallery's worst object.
        worst = min(members, key=lambda entry: entry.leaders[0][0] if entry.leaders else _LAST)
        task = worst.task or next((entry.task for entry in members if entry.task), "")
        old = all(entry.run != clean(run_id) for entry in members)
        unchanged = max(entry.made for entry in members)[:10] if old else ""
        pages, counts = tuple(e.page for e in members), _total(e.counts for e in members)
        rows.append(GalleryRow(name, on_display, pages, counts, task, unchanged))
    return tuple(sorted(rows, key=lambda g: (-g.counts.act, -g.counts.watch, -g.counts.unknown, g.name)))


def page_name(gallery: str, number: int = 1, *, on_display: bool = True) -> str:
    """Return the file of a gallery's page; the first one's has no number."""
    stem = slug(gallery) if on_display else STORED
    return f"{stem}.html" if number == 1 else f"{stem}-{number}.html"


def anchor_of(object_number: str) -> str:
    """Return the id of an object on its page; it stays the same from run to run."""
    return f"o{digest(object_number, 10)}"


def _effort(title: str, effort: Mapping[str, int]) -> EffortView:
    analyses, needing = effort["analyses"], effort["needing_history"]
    return EffortView(
        said(clean(title)),
        analyses,
        effort["certificate"],
        effort["chart"],
        effort["history"],
        percent(needing / max(analyses, 1)),
    )


def _note(text: str, units: Units) -> str:
    """Say what a run noted of its levels and floors: a phrase as a whole, or clauses."""
    whole = said(text)
    return whole if whole != text else f"{assumed(text.removesuffix('.'), units)}{_('.')}"


def _total(counts: Iterable[StateCounts]) -> StateCounts:
    listed = list(counts)
    names = (*(state.value for state in State), "open")
    return StateCounts(**{name: sum(getattr(c, name) for c in listed) for name in names})


def _tasks(pairs: Sequence[tuple[Assessment, ObjectView]], describer: Describer, units: Units) -> tuple[TaskView, ...]:
    """Group the recommendations by measure; the pairs come by urgency, and so do the groups.

    What people accepted or overruled is no task, as long as nothing of that is in doubt.
    """
    members: dict[str, list[ObjectView]] = {}
    advice: dict[str, list[Recommendation]] = {}
    sets: dict[str, list[str]] = {}
    for assessment, view in pairs:
        for recommendation in assessment.recommendations:
            if describer.decided.covered(assessment, recommendation.level):
                continue
            group = members.setdefault(recommendation.measure, [])
            if not group or group[-1] is not view:
                group.append(view)
                doubtful = view.chance is not None and view.chance.slender
                told = _("Check its sizes first") if doubtful else numbers_to_set(recommendation, units)
                sets.setdefault(recommendation.measure, []).append(told)
            advice.setdefault(recommendation.measure, []).append(recommendation)
        if view.state is State.ACT and not assessment.recommendations and not view.settled:
            unnamed = view.chance is not None and view.chance.unnamed
            members.setdefault(_UNNAMED if unnamed else _HELPLESS, []).append(view)
    return tuple(
        TaskView(
            said(clean(advice[key][0].title)),
            tuple(objects),
            tuple(sets[key]),
            measure=key,
        )
        if key in advice
        else TaskView(_("Say first what it is") if key == _UNNAMED else "", tuple(objects), advised=key == _UNNAMED)
        for key, objects in members.items()
    )
