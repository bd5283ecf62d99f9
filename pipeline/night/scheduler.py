"""The work of a run: which units have results, which pages the last report has, and who does what is left."""

import logging
import warnings
from collections.abc import Callable, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, closing
from dataclasses import dataclass, field, replace
from functools import partial
from itertools import groupby
from math import ceil
from time import monotonic
from typing import Any

from pipeline.analysis.faults import Fault
from pipeline.collection.database import Database
from pipeline.collection.inventory import fields_since
from pipeline.collection.listing import Listing
from pipeline.collection.object_index import ObjectIndex
from pipeline.errors import DamageWarning
from pipeline.execute.memory import give_back
from pipeline.execute.pool import WorkerPool, cores, pool
from pipeline.night.context import RunContext
from pipeline.night.decision_review import now, standing
from pipeline.night.page_tasks import PageTask, Rendered, render_page
from pipeline.night.paging import PagePart, paged
from pipeline.night.source_state import rules_digest, tables_digest
from pipeline.night.unit_tasks import (
    Assessments,
    ChartTask,
    GalleryTask,
    UnitTask,
    assess_units,
    build_chart,
    find_neighbours,
)
from pipeline.night.units import Decisions, Unit, UnitKeys
from pipeline.operations.event_log import note
from pipeline.operations.workspace import Workspace
from pipeline.quantities import counted
from pipeline.records import DecisionStatus, Found, Page, Progress, RunChanges, Tally
from pipeline.report.files.manifest import PreviousReport
from pipeline.report.files.report_writer import ReportWriter, link_to, page_key
from pipeline.report.pages.since import mentioned
from pipeline.report.pages.tallies import total
from pipeline.report.pages.views import Pointer
from pipeline.store.pages import Members, Shown, fetch_pages, found_of, page_digest, page_row
from pipeline.store.results import KeptResult, Stored, copy, fetch, forget, keep, known

FEW = 5_000
"""Objects to be assessed or shown for which other processes do not pay: they take seconds to start."""

BATCH = 100_000
"""Units, about, that one worker assesses together at most: each model is called once for all of them under each
motion.  Of eleven motions 30,000 take 39 s, 90,000 take 92: some 13 s are for sets that every batch asks for."""

_SECONDS = 5.0
"""Longest time for which results wait to be stored together."""


@dataclass
class _Shown:
    """A page of the run, and what is known of it so far.

    Attributes
    ----------
    part
        Its objects.
    units
        Theirs, in their order.
    spacings
        Key of the gaps between the neighbours of its gallery; "" where no places are known.
    kept
        The page in the database, where it is there.
    page, standing
        As it is shown, once all results on it are known.
    row
        Of the database, where it is not there yet.
    """

    part: PagePart
    units: list[Unit]
    spacings: str = ""
    kept: Shown | None = None
    page: Page | None = None
    standing: tuple[DecisionStatus, ...] = ()
    row: dict[str, Any] | None = None

    def results(self, names: Mapping[str, str]) -> tuple[tuple[str, int], ...]:
        """Return of each object the key of its unit's results, and which of these it has."""
        return tuple((names.get(u.key, u.key), at) for u in self.units for at in range(len(u.members)))

    def digests(self) -> tuple[str, ...]:
        return tuple(one.digest for unit in self.units for one in unit.members)

    def numbers(self) -> list[str]:
        return [one.object_number for unit in self.units for one in unit.members]


@dataclass
class _Work:
    """The units of a floor that have no results yet, by key; every: the keys of all that there are on it."""

    floor: str
    assessed: bool
    units: dict[str, Unit] = field(default_factory=dict)
    every: set[str] = field(default_factory=set)


class NightRun:
    """The units and the pages of a run, and the doing of what is not done yet.

    Attributes
    ----------
    fresh
        Objects that must be assessed, because nothing is known of them.
    seconds
        What finding out what is worth measuring cost [s].
    faults
        Objects that Kouros failed on.
    damaged
        Keys of pages whose rows in the database are not what was written.
    """

    def __init__(
        self,
        workspace: Workspace,
        context: RunContext,
        index: ObjectIndex,
        objects: Listing,
        decisions: Decisions,
        charts: Sequence[ChartTask] = (),
    ) -> None:
        self.workspace, self.context, self._charts = workspace, context, charts
        self._index, self._decisions = index, decisions
        keys = UnitKeys(context, rules_digest(workspace.settings), tables_digest(workspace.settings))
        self._pages = [_Shown(part, keys.units(part, decisions)) for part in paged(objects, workspace.settings)]
        placed = index.placed()
        for (gallery, shown), several in groupby(self._pages, lambda one: (one.part.gallery, one.part.on_display)):
            pages = list(several)
            if shown and gallery in placed:
                named = keys.neighbours(pages[0].part, [unit for page in pages for unit in page.units])
                for page in pages:
                    page.spacings = named
        self._digests = index.digests(list(decisions))
        self._names: dict[str, str] = {}
        self._memory: dict[str, KeptResult] | None = None
        self._work = self._missing()
        self.fresh = self._unknown()
        self.seconds = 0.0
        self.faults: list[Fault] = []

    # -----------------------------------------------------------------------------------------------------------------
    # What there is

    def _missing(self) -> list[_Work]:
        """Find out which pages are as they were, and which units of the others have no results yet."""
        engine = self.workspace.engine
        keys = [page_digest(page.digests(), page.results({}), page.spacings) for page in self._pages]
        found, damaged = fetch_pages(engine, keys)
        self.damaged = frozenset(damaged)
        _damage("page", damaged)
        work: dict[tuple[str, bool], _Work] = {}
        wanted: list[_Shown] = []
        for page, key in zip(self._pages, keys, strict=True):
            page.kept = found.get(key)
            if page.kept is not None:
                page.page = self._page(page, key, page.kept.run, page.kept.made)
            else:
                wanted.append(page)
        there = known(engine, {unit.key for page in wanted for unit in page.units})
        for page in self._pages:
            which = self._which(page)
            mine = work.setdefault(which, _Work(*which))
            mine.every.update(unit.key for unit in page.units)
            if page.kept is None:
                mine.units.update((unit.key, unit) for unit in page.units if unit.key not in there)
        return [one for one in work.values() if one.units]

    def _which(self, page: _Shown) -> tuple[str, bool]:
        """Return what is worked on together: the floor, and whether what is on the page is assessed."""
        return page.part.floor, page.part.on_display or self.context.stores

    def _unknown(self) -> int:
        """Count the objects that must be assessed, those that are alike each by itself."""
        missing = {(work.floor, work.assessed): set(work.units) if work.assessed else set() for work in self._work}
        new = (page for page in self._pages if page.kept is None)
        return sum(len(u.members) for page in new for u in page.units if u.key in missing.get(self._which(page), set()))

    def _page(self, shown: _Shown, key: str, run: str, made: str) -> Page:
        part = shown.part
        return Page(key, part.gallery, part.on_display, part.number, part.of, run, made)

    @property
    def pages(self) -> tuple[Page, ...]:
        """The pages of the run, once all is known."""
        return tuple(one.page for one in self._pages if one.page is not None)

    def rows(self, *, kept: bool = False) -> Iterator[dict[str, Any]]:
        """Yield the rows of those pages that the database does not have, or, for another database, of all."""
        for one in self._pages:
            if (kept or one.kept is None) and one.page is not None:
                yield one.row or page_row(one.page, self._members(one))

    @property
    def standing(self) -> tuple[DecisionStatus, ...]:
        """The decisions about the objects of the run, as they stand."""
        return tuple(one for page in self._pages for one in page.standing)

    def strangers(self, *, whole: bool) -> tuple[DecisionStatus, ...]:
        """Return the decisions about objects that the collection does not have any more.

        whole : whether the run is of all objects: else what is not in it is not gone
        """
        if not whole:
            return ()
        gone = [d for number, mine in self._decisions.items() if number not in self._digests for d in mine]
        at = now((), self.context.head, {}, lambda _number, _digest: ())
        return standing(sorted(gone, key=lambda d: d.id), at)

    # -----------------------------------------------------------------------------------------------------------------
    # Assessing

    def assess(self, progress: Progress, *, store: bool = True) -> None:
        """Find what is not known, and store it as it comes.

        store : False: it is held in memory only
        """
        if not store:
            self._memory = {}
        if self._work:
            with self._pool(self.fresh) as workers:
                if self._charts and self.context.kept is not None and self.fresh > FEW:
                    for at, _ in enumerate(workers.each(build_chart, self.context, self._charts)):
                        progress.step("response charts", at + 1, len(self._charts))
                tasks = [self._batches(work, workers.workers) for work in self._work]
                number = sum(len(some) for some in tasks)
                each = (task() for some in tasks for task in some)
                self._take(workers, each, number, progress)
        self._neighbours()
        for page in self._pages:
            self._settle(page)

    def _batches(self, work: _Work, workers: int) -> list[Callable[[], UnitTask]]:
        """Part the units of a floor by their records, so that the same ones come together every night."""
        parts = _shares(len(work.units), workers, BATCH) if len(work.units) > FEW else 1
        shared: list[list[Unit]] = [[] for _ in range(parts)]
        for unit in work.units.values():
            shared[int(unit.members[0].assessment_digest[:8] or "0", 16) % parts].append(unit)
        # A few among many would take the place of what is kept of all.
        whole = 2 * len(work.units) > len(work.every)
        return [
            partial(self._task, work, some, ("units", work.floor, at, parts) if whole else None)
            for at, some in enumerate(shared)
            if some
        ]

    def _task(self, work: _Work, units: Sequence[Unit], batch: tuple[object, ...] | None) -> UnitTask:
        numbers = [one.object_number for unit in units for one in unit.members]
        about = [decision for number in numbers for decision in self._decisions.get(number, ())]
        return UnitTask(
            work.floor,
            work.assessed,
            tuple(unit.key for unit in units),
            tuple(len(unit.members) for unit in units),
            self._index.packed(numbers),
            tuple(about),
            batch,
        )

    def _take(self, workers: WorkerPool, tasks: Iterable[UnitTask], number: int, progress: Progress) -> None:
        waiting: list[Stored] = []
        since = monotonic()
        with closing(workers.each(assess_units, self.context, tasks)) as done:
            for at, came in enumerate(done):
                waiting += self._told(came)
                progress.step("objects", at + 1, number)
                if monotonic() - since > _SECONDS:
                    self._keep(waiting)
                    since = monotonic()
        self._keep(waiting)

    def _told(self, came: Assessments) -> list[Stored]:
        """Take note of what came of a task, and return what is to be kept of it."""
        self.seconds += came.seconds
        self._failed(came.faults)
        # What failed is kept under a key of its own: it is tried again every night, whatever it depends on.
        names = {key: f"{key}:{self.context.head.run_id}" for key in came.failed}
        self._names |= names
        return [replace(one, key=names.get(one.key, one.key)) for one in came.stored]

    def _failed(self, faults: Iterable[Fault]) -> None:
        for one in faults:
            about = {"object": one.object_number, "message": one.words, "traceback": one.traceback}
            note("object.failed", level=logging.ERROR, **about)
            self.faults.append(one)

    def _keep(self, waiting: list[Stored]) -> None:
        head = self.context.head
        if self._memory is None:
            keep(self.workspace.engine, head.run_id, head.started, waiting)
        else:
            self._memory |= {one.key: KeptResult(head.run_id, head.started, one.outline, one.found) for one in waiting}
        waiting.clear()

    def copy_results(self, target: Database) -> None:
        """Copy all results of the run into another database, those that are held in memory only among them."""
        head = self.context.head
        mine = [Stored(key, one.outline, one.found) for key, one in (self._memory or {}).items()]
        keep(target, head.run_id, head.started, mine)
        keys = (self._names.get(unit.key, unit.key) for page in self._pages for unit in page.units)
        copy(self.workspace.engine, target, [*dict.fromkeys(keys), *{page.spacings for page in self._pages} - {""}])

    def _neighbours(self) -> None:
        """Find the gaps between the neighbours of those galleries of which they are not known."""
        galleries: dict[str, list[_Shown]] = {}
        for page in self._pages:
            if page.spacings and page.kept is None:
                galleries.setdefault(page.spacings, []).append(page)
        there = known(self.workspace.engine, galleries)
        for key in galleries.keys() - there:
            self._gaps(key)

    def _gaps(self, key: str) -> None:
        # Of all its pages, those that are as they were among them: their results are there.
        pages = [page for page in self._pages if page.spacings == key]
        members = tuple(replace(self._members(page), spacings="") for page in pages)
        results = self._results([k for one in members for k in one.keys])
        task = GalleryTask(key, pages[0].part.floor, members, {k: one.found for k, one in results.items()})
        self._keep(self._told(find_neighbours(self.context, task)))

    def _members(self, page: _Shown) -> Members:
        if page.kept is not None:
            return page.kept.members
        return Members(
            self._index.packed(page.numbers()),
            page.digests(),
            page.results(self._names),
            self._names.get(page.spacings, page.spacings),
        )

    def _results(self, keys: Iterable[str]) -> dict[str, KeptResult]:
        """Return results by key; those that are damaged are made again."""
        wanted = list(dict.fromkeys(keys))
        mine = {} if self._memory is None else {key: self._memory[key] for key in wanted if key in self._memory}
        left = [key for key in wanted if key not in mine]
        found, damaged = fetch(self.workspace.engine, left)
        gone = {key for key in left if key not in found}
        if gone:
            _damage("result", damaged)
            found |= self._again(gone)
        return mine | found

    def _again(self, keys: set[str]) -> dict[str, KeptResult]:
        if self._memory is None:
            forget(self.workspace.engine, keys)
        work: dict[tuple[str, bool], _Work] = {}
        for page in self._pages:
            which = self._which(page)
            for unit in page.units:
                if self._names.get(unit.key, unit.key) in keys:
                    work.setdefault(which, _Work(*which)).units[unit.key] = unit
        for one in work.values():
            came = assess_units(self.context, self._task(one, list(one.units.values()), None))
            self._keep([*self._told(came)])
        for key in {page.spacings for page in self._pages}:
            if self._names.get(key, key) in keys:
                self._gaps(key)
        found, _ = fetch(self.workspace.engine, keys) if self._memory is None else (self._memory, [])
        return {key: found[key] for key in keys if key in found}

    def _settle(self, page: _Shown) -> None:
        """Say where a page belongs, now that all results on it are known, and how the decisions about it stand."""
        mine = sorted((d for number in page.numbers() for d in self._decisions.get(number, ())), key=lambda d: d.id)
        if page.kept is None:
            named, gaps = page.results(self._names), self._names.get(page.spacings, page.spacings)
            made, run = self._newest([*dict.fromkeys(key for key, _ in named), *filter(None, [gaps])])
            page.page = self._page(page, page_digest(page.digests(), named, gaps), run, made)
        if mine:
            members = self._members(page)
            results = self._results(members.wanted)
            found = found_of(members, {key: one.found for key, one in results.items()})
            page.standing = self._standing(found, mine)

    def _newest(self, keys: Sequence[str]) -> tuple[str, str]:
        """Return when the newest of some results was made, and by which run."""
        return max((one.made, one.run) for one in self._results(keys).values())

    def _standing(self, found: Found, decisions: Sequence[Any]) -> tuple[DecisionStatus, ...]:
        digests = {number: self._digests[number] for number in {d.object_number for d in decisions}}
        engine = self.workspace.engine
        at = now(
            found.assessments,
            self.context.head,
            digests,
            lambda number, digest: () if digest == digests[number] else tuple(fields_since(engine, number, digest)),
        )
        return standing(decisions, at)

    # -----------------------------------------------------------------------------------------------------------------
    # Pages

    def writer(self) -> ReportWriter:
        """Return the report that the pages go into; it is entered before `publish`, and finished after it."""
        reports = self.workspace.reports
        return ReportWriter(
            reports / self.context.head.run_id, self.context.renderer, PreviousReport.read(reports / "latest")
        )

    def publish(self, writer: ReportWriter, progress: Progress) -> Tally:
        """Put every page into the report, and return the totals."""
        keys = [
            page_key(self.context.renderer, page, one.standing)
            for page, one in zip(self.pages, self._pages, strict=True)
        ]
        reused = [writer.has(key) for key in keys]
        left = [page for page, there in zip(self._pages, reused, strict=True) if not there]
        tallies = []
        with self._rendered(left, draw=True) as rendered:
            for at, (key, there) in enumerate(zip(keys, reused, strict=True)):
                progress.step("pages", at, len(keys))
                if there:
                    tallies.append(writer.reuse(key))
                    continue
                came = next(rendered)
                self._failed(came.faults)
                if came.page is None:
                    raise ValueError("a page that was to be rendered was not")
                # A page on which an object failed is tried again every night.
                writer.add(f"{key}:{self.context.head.run_id}" if came.faults else key, came.page)
                tallies.append(came.tally)
        progress.step("pages", len(keys), len(keys))
        return total(tallies)

    def tally(self, progress: Progress) -> Tally:
        """Return the totals without a report."""
        tallies = []
        with self._rendered(self._pages, draw=False) as rendered:
            for at, came in enumerate(rendered):
                progress.step("pages", at + 1, len(self._pages))
                tallies.append(came.tally)
        return total(tallies)

    def _rendered(self, pages: Sequence[_Shown], *, draw: bool) -> AbstractContextManager[Generator[Rendered]]:
        return closing(self._each_rendered(pages, draw=draw))

    def _each_rendered(self, pages: Sequence[_Shown], *, draw: bool) -> Generator[Rendered]:
        with self._pool(sum(len(page.part.objects) for page in pages)) as workers:
            tasks = (self._page_task(page, draw=draw) for page in pages)
            with closing(workers.each(render_page, self.context, tasks)) as done:
                yield from done

    def _page_task(self, shown: _Shown, *, draw: bool) -> PageTask:
        members = self._members(shown)
        results = self._results(members.wanted)
        if shown.page is None:
            raise ValueError("a page is rendered before all results on it are known")
        if shown.kept is None and draw:
            shown.row = page_row(shown.page, members)
        return PageTask(shown.page, members, {k: one.found for k, one in results.items()}, shown.standing, draw)

    def links(self, changes: RunChanges | None) -> dict[str, Pointer]:
        """Return where the objects are that the index names as changed, by number."""
        named = set() if changes is None else mentioned(changes)
        out: dict[str, Pointer] = {}
        for shown in self._pages:
            mine = named.intersection(shown.numbers()) if named else set()
            if mine and shown.page is not None:
                members = self._members(shown)
                titles = dict(zip(members.column("object_number"), members.column("title"), strict=True))
                out |= {number: link_to(shown.page, number, titles[number]) for number in sorted(mine)}
        return out

    def _pool(self, objects: int) -> AbstractContextManager[WorkerPool]:
        wanted = self.workspace.settings.execution
        if objects <= FEW:
            return pool()
        # What reading the records and drawing the motions took is there for the workers.
        give_back()
        if wanted.cluster:
            # Its workers may not see our folders.
            self.context = replace(self.context, kept=None, threads=1)
            return pool(address=wanted.cluster)
        self.context = replace(self.context, threads=1)
        return pool(processes=wanted.processes or cores())


def _damage(what: str, keys: Sequence[str]) -> None:
    """Say that rows of the database are not what was written, and are made again."""
    if keys:
        note(f"{what}.damaged", level=logging.WARNING, keys=list(keys))
        told = f"{counted(len(keys), what)} of the database changed since written: see whether the disk is sound"
        warnings.warn(f"{told}; made again", DamageWarning, stacklevel=3)


def _shares(units: int, workers: int, most: int) -> int:
    """Return how many parts work is cut into: of so many units at most, and as many for each worker: none waits."""
    return workers * max(1, ceil(units / (workers * most)))
