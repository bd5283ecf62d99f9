"""Preparation of a run: motions and their pictures, rules, measures, and what is asked for.

The pictures of the motions: made while the museum's records are read, which keeps one core busy and no more.

They are kept in the cache by the content of their motion, and drawn again where that or the code is another.
"""

import os
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from datetime import datetime
from typing import Any, Literal

import numpy as np

from pipeline import __version__
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.faults import sound, without_failing
from pipeline.analysis.figures import chart_keys, draw
from pipeline.analysis.house.matching import HouseRules
from pipeline.analysis.plan import Work, plan
from pipeline.analysis.response_charts import ChartCache
from pipeline.analysis.response_charts.grouping import group_name, groups
from pipeline.analysis.rule_table import RuleTable
from pipeline.analysis.stakes import VALUE_PER_C
from pipeline.cache import PICTURES, SAMPLES, Cache, CacheEntry, key_of
from pipeline.collection.inventory import latest_import
from pipeline.collection.listing import Listing
from pipeline.collection.object_index import ObjectIndex
from pipeline.execute import Threads
from pipeline.kernels import KERNEL_VERSION
from pipeline.mitigate import MeasureCatalogue
from pipeline.motions.record import ESTIMATED, NO_VERTICAL
from pipeline.motions.site import Level, Site
from pipeline.night.context import RunContext, motions_of
from pipeline.night.floors import floors_of, notes
from pipeline.night.reading_summary import told
from pipeline.night.source_state import house_digest, rules_digest, tables_digest
from pipeline.night.stocks import StockTerms, told_floors
from pipeline.night.unit_tasks import ChartTask
from pipeline.operations.report_status import presentation, terms_of
from pipeline.operations.workspace import Workspace
from pipeline.quantities import G
from pipeline.records import Chart, Item, Model, Motion, Progress, RunRecord, Scene
from pipeline.records import phrases as say
from pipeline.report.pages.compose import PERIODS
from pipeline.report.pages.reading import INVENTORY, READING
from pipeline.resources import code_version
from pipeline.settings import Settings
from pipeline.store import codec
from pipeline.store.sound import CODE, DISPLAY, HOUSE, HOUSE_RULES, KERNELS, LEVELS, RULES, TABLES
from pipeline.verification import selftest, tradeoff

_PICTURES = dict[str, Chart]
"""All pictures of a motion, by key."""


def _key(motion: Motion) -> str:
    return key_of(chart_keys(motion), motion.hash, group=motion.hash)


class Pictures:
    """Makes the pictures of motions that are not kept, and finds those that are."""

    def __init__(self, settings: Settings) -> None:
        self._cache = Cache(settings.kept)
        # Not the charts of the verdicts, which are chosen once it is known what pays.
        self._context = Context(Threads(settings.analysis.workers), charts=ChartCache(settings.kept))
        self._hand = ThreadPoolExecutor(1)
        self._stored: dict[str, Mapping[str, Chart]] = {}
        self._begun: dict[str, Future[dict[str, Chart]]] = {}

    def begin(self, motions: Sequence[Motion]) -> None:
        """Begin with motions that will be asked for, one after the other, and return at once."""
        new = [motion for motion in motions if motion.hash not in self._stored.keys() | self._begun.keys()]
        for motion in new:
            kept = self._cache.get(PICTURES, _key(motion))
            if kept is None:
                self._begun[motion.hash] = self._hand.submit(self._draw, motion)
            else:
                self._stored[motion.hash] = codec.of_json(_PICTURES, kept.said["pictures"])

    def _draw(self, motion: Motion) -> dict[str, Chart]:
        drawn = draw(motion, self._context)
        self._cache.put(PICTURES, _key(motion), CacheEntry({"pictures": codec.to_json(_PICTURES, drawn)}))
        return drawn

    def of(self, motions: Sequence[Motion], progress: Progress) -> dict[str, Chart]:
        """Return the pictures of motions, by key."""
        self.begin(motions)
        out: dict[str, Chart] = {}
        for done, motion in enumerate(motions):
            progress.step("charts", done, len(motions))
            begun = self._begun.get(motion.hash)
            out |= self._stored[motion.hash] if begun is None else begun.result()
        progress.step("charts", len(motions), len(motions))
        return out

    def close(self) -> None:
        """Leave what is not begun; a motion that is being worked on is finished, which takes seconds."""
        self._hand.shutdown(cancel_futures=True)


@contextmanager
def pictures(workspace: Workspace, site: Site) -> Iterator[Pictures]:
    """Begin with the pictures of the ground's motions, which are wanted unless all galleries are on other floors."""
    found = Pictures(workspace.settings)
    try:
        if not any("*" in galleries for galleries in workspace.settings.floors.root.values()):
            found.begin([one.motion for level in site.levels for one in level.motions])
        yield found
    finally:
        found.close()


FRAGILE, SURVEYED = 1e8, 2e8
"""Objects on display times samples of all motions (of the longest, where joint samples tell the curves) up to which
curves, and wishes, are found unasked: some minutes."""

SAMPLE = 2_000
"""Objects that are looked at to see which response charts pay for the whole collection."""

WORTH = 6
"""Times the analyses of a smooth chart that must be asked for: under strong motions charts take up to twice as many,
and of those who ask, most ask the same."""

CHANGED = 0.25
"""Share of the works on walls that rubber pads are tried for, at least: a third of real ones under strong shaking."""


def run_context(
    workspace: Workspace,
    site: Site,
    index: ObjectIndex,
    chosen: Listing,
    started: datetime,
) -> RunContext:
    """Make ready what everything that is done in a run shares; its charts are to be tidied at the end.

    It has no pictures yet: see `illustrate`.

    Parameters
    ----------
    index : ObjectIndex
        All objects of the inventory.
    chosen : Listing
        Those that the run is of.

    Returns
    -------
    RunContext

    Raises
    ------
    SettingsError
        For a floor that the site does not have.
    MotionError
        For a floor's record.
    TableError, UsageError
        For tables of the museum's own.
    ReportError
        For a language without a catalogue.
    """
    settings = workspace.settings
    # What is wrong with the museum's own tables, or that a catalogue of phrases is missing, is said before the work.
    rules, measures, house = workspace.rules, workspace.measures, workspace.house
    written = presentation(settings)
    terms_of(workspace)
    floors = floors_of(settings, site, chosen.galleries)
    motions = motions_of(floors)
    samples = sum(motion.acceleration.shape[1] for motion in motions.values())
    shown = chosen.shown * samples
    # A joint sample is of one motion, however many there are.
    longest = max((motion.acceleration.shape[1] for motion in motions.values()), default=0)
    curves = chosen.shown * longest if settings.likelihood.samples else shown
    fragile = _asked(settings.analysis.fragility, curves <= FRAGILE)
    # Samples tell it for nothing.
    surveyed = _asked(settings.report.survey, bool(settings.likelihood.samples) or shown <= SURVEYED)
    info = latest_import(workspace.engine)
    said = [_level_note(level) for level in site.levels]
    said += notes(settings, site, index.objects.galleries)
    if settings.analysis.fragility and not fragile:
        said.append(_left_out("From what shaking each object fails", "[analysis] fragility = true"))
    if settings.report.survey and not surveyed:
        said.append(_left_out("Which measurements would settle a verdict", "[report] survey = true"))
    tested = selftest.kept(settings.kept)
    head = RunRecord(
        run_id=f"{started:%Y%m%dT%H%M%S}.{started.microsecond // 1000:03d}-{os.getpid()}",
        started=started.isoformat(timespec="milliseconds"),
        finished="",
        version=__version__,
        site=site.name,
        museum=settings.museum.name or (info.museum if info else ""),
        level_notes=tuple(said),
        settings=_stored_settings(workspace, site, info.credit if info else "", tested)
        | {INVENTORY: index.version, READING: told(workspace, index)},
        assessments=(),
        charts={},
        motions=tuple(summary for floor in floors.values() for summary in floor.summaries),
        demonstration=settings.demonstration,
    )
    return RunContext(
        head=head,
        floors=floors,
        analysis=settings.analysis,
        sampling=settings.likelihood.sampling,
        rules=rules,
        measures=measures,
        surveyed=surveyed,
        fragile=fragile,
        house=house,
        stores=settings.display.stores,
        kept=settings.kept,
        threads=settings.analysis.workers or Threads().workers,
        units=written["units"],
        tongue=settings.report.language,
        catalogues=settings.path(settings.report.catalogues) if settings.report.catalogues else None,
        paper=settings.report.paper,
        stock=StockTerms(settings.kept, told_floors(head.motions, site.levels), settings.museum.value_per_c),
    )


def illustrate(context: RunContext, pictures: Pictures, progress: Progress) -> None:
    """Give a run the pictures of its motions, which its pages show; they are waited for once.

    Parameters
    ----------
    pictures : Pictures
        Where they are had.
    """
    if context.head.charts:
        return
    # Of motions that two floors share only once.
    drawn = pictures.of(list(context.motions.values()), progress)
    measured = None if context.kept is None else tradeoff.kept(context.kept)
    if measured is not None:
        picture = tradeoff.picture(measured)
        drawn[picture.key] = picture
    context.head = replace(context.head, charts=drawn)


def admit(
    workspace: Workspace, context: RunContext, index: ObjectIndex, chosen: Listing, x_azimuth: float
) -> tuple[list[ChartTask], frozenset[str]]:
    """Decide which response charts are used (see `popular`); what the same objects asked for last time is kept.

    Returns
    -------
    tuple[list[ChartTask], frozenset[str]]
        Those to be built before the sheets, and the names of the models that a sample of the objects is run with.
    """
    sample, every = _sample(assessed(chosen, context.stores))
    # They are read in any case: damage to what is kept of them is told.
    items = index.items(sample.column("object_number"))
    settings = workspace.settings
    own = rules_digest(settings), tables_digest(settings), house_digest(settings), repr(context.measures)
    key = key_of(own, x_azimuth, every, [(one.object_number, one.digest) for one in sample])
    cache = None if context.kept is None else Cache(context.kept)
    entry = None if cache is None else cache.get(SAMPLES, key)
    if entry is None:
        scenes = _classed(items, context.rules, context.house)
        found = _paying(scenes, every, context.measures, x_azimuth)
        told = {name: (model.name, angle, alike) for name, (model, angle, alike) in sorted(found.items())}
        entry = CacheEntry({"groups": told, "models": sorted({name for scene in scenes for name in scene.models})})
        if cache is not None:
            cache.put(SAMPLES, key, entry)
    context.admitted = frozenset(entry.said["groups"])
    tasks = [
        ChartTask(model, motion, angle, alike)
        for model, angle, alike in entry.said["groups"].values()
        for motion in context.motions.values()
    ]
    return tasks, frozenset(entry.said["models"])


def assessed(objects: Listing, stores: bool) -> Listing:
    """Return those of the objects of a sorted listing that are assessed: those on display, or with stores all."""
    return objects if stores else objects[: objects.shown]


Group = tuple[Model, float | None, dict[str, float]]
"""What one chart under each motion serves: the model, the direction, the parameters that all who ask share."""


def popular(
    index: ObjectIndex,
    chosen: Listing,
    rules: RuleTable | None,
    measures: MeasureCatalogue,
    x_azimuth: float,
    house: HouseRules | None = None,
) -> dict[str, Group]:
    """Return the groups of parameters whose charts pay for a collection, as a sample of its objects says, by name.

    What an object is found to do must not hang on which others happen to be worked on with it, or on who asked first.
    Of the measures few make something of many objects that one chart could serve (`Measure.charted`).
    """
    sample, every = _sample(chosen)
    items = index.items(sample.column("object_number"))
    return _paying(_classed(items, rules, house), every, measures, x_azimuth)


def _sample(chosen: Listing) -> tuple[Listing, int]:
    """Return the objects that are looked at, and of how many each is one."""
    every = max(1, len(chosen) // SAMPLE)
    return chosen[::every], every


def _classed(items: Mapping[str, Item], rules: RuleTable | None, house: HouseRules | None) -> list[Scene]:
    # What cannot even be planned for is told where it is assessed.
    return sound(lambda some: [classify(item, rules, house=house) for item in some], list(items.values()))


def _paying(scenes: Sequence[Scene], every: int, measures: MeasureCatalogue, x_azimuth: float) -> dict[str, Group]:
    def planned(some: Sequence[Scene]) -> list[tuple[Work, float]]:
        return [
            (work, share)
            for those, share in ((some, 1.0), ([s for one in measures.measures for s in one.charted(some)], CHANGED))
            for work in plan(those, x_azimuth).work
        ]

    asking: dict[str, float] = {}
    found: dict[str, Group] = {}
    for work, share in without_failing(planned, scenes):
        if work.model.chart is None:
            continue
        for angle, rows in work.by_angle(np.arange(work.size)):
            for alike, those in groups(work.model, work.some(rows)):
                name = group_name(work.model, angle, alike)
                asking[name] = asking.get(name, 0.0) + share * those.size
                found[name] = (work.model, angle, alike)
    return {
        name: group
        for name, group in found.items()
        if group[0].chart is not None and asking[name] * every >= WORTH * group[0].chart.nodes
    }


def _asked(wanted: bool | Literal["auto"], affordable: bool) -> bool:
    return affordable if wanted == "auto" else bool(wanted)


def _left_out(what: str, remedy: str) -> str:
    return f"{what} was not found out: of so many objects and motions that takes long ({remedy} does it all the same)."


def _stored_settings(workspace: Workspace, site: Site, credit: str, tested: selftest.SelfTest | None) -> dict[str, Any]:
    # Never the database's address: it may hold a password.
    settings = workspace.settings
    return {
        KERNELS: KERNEL_VERSION,
        CODE: code_version()[:12],
        RULES: rules_digest(settings),
        TABLES: tables_digest(settings),
        HOUSE: house_digest(settings),
        HOUSE_RULES: [rule.told() for rule in settings.house],
        LEVELS: {level.name: level.combine for level in site.levels},
        PERIODS: {level.name: level.return_period_years for level in site.levels},
        "credit": credit,
        VALUE_PER_C: settings.museum.value_per_c,
        "analysis": settings.analysis.model_dump(),
        "length": settings.report.length,
        "site": settings.site.folder,
        "floors": settings.floors.model_dump(),
        DISPLAY: settings.display.model_dump(),
        "numerics": None if tested is None else tested.plain(),
    }


def _level_note(level: Level) -> str:
    """Say how strong the motions of a level are, and who answers for them."""
    named, many = level.name, len(level.motions)
    # What topples an object is velocity more than acceleration: both are said.
    pga = [one.measures["pga"] / G for one in level.motions]
    pgv = [one.measures["pgv"] for one in level.motions]
    if many == 1:
        told = [say.LEVEL_ALONE(case=named, pga=pga[0], pgv=pgv[0])]
    else:
        phrase = say.LEVEL_MEAN if level.combine == "mean" else say.LEVEL_WORST
        ends = {"least_pga": min(pga), "pga": max(pga), "least_pgv": min(pgv), "pgv": max(pgv)}
        told = [phrase(case=named, motions=float(many), **ends)]
    if level.return_period_years is not None:
        told.append(say.LEVEL_PERIOD(years=level.return_period_years))
    told += [level.caution] if level.caution else []
    for phrase, step in ((say.LEVEL_FLAT, NO_VERTICAL), (say.LEVEL_ESTIMATED, ESTIMATED)):
        which = [one.motion.name for one in level.motions if step in one.motion.steps]
        told += [phrase(words=", ".join(which))] if which else []
    told.append(
        say.LEVEL_APPROVED(words=level.approved_by, case=str(level.approved_on))
        if level.approved_by
        else say.LEVEL_UNANSWERED()
    )
    return f"{'; '.join(told)}."
