"""The work of a run: which units of it have no results yet, and the doing of what is left, by whoever works."""

import logging
import sys
import warnings
from array import array
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, replace
from functools import partial
from itertools import groupby
from math import ceil
from time import monotonic

from pipeline.analysis.faults import Fault
from pipeline.collection.database import Database
from pipeline.collection.listing import Listing
from pipeline.collection.object_index import ObjectIndex
from pipeline.errors import DamageWarning
from pipeline.execute.workers import WorkerPool
from pipeline.night.context import RunContext
from pipeline.night.house_effects import house_effects
from pipeline.night.source_state import rules_digest, tables_digest
from pipeline.night.staff import FEW, Staff
from pipeline.night.unit_tasks import (
    Assessments,
    ChartTask,
    FurnitureTask,
    GalleryTask,
    UnitTask,
    assess_units,
    build_chart,
    find_neighbours,
    furniture_of_units,
)
from pipeline.night.units import Decisions, PagePart, PageUnits, UnitKeys, paged
from pipeline.operations.event_log import note
from pipeline.operations.workspace import Workspace
from pipeline.quantities import counted
from pipeline.records import Decision, Furniture, Progress
from pipeline.store.pages import Members, known_pages, page_digest
from pipeline.store.results import KeptResult, Made, Stored, copy, fetch, forget, keep, known

BATCH = 12_000
"""Units, about, that one worker assesses together at most: each model is called once for all of them under each
motion, of which furniture makes fifteen of one.  Six times as many take 0.5 GB more of each worker."""

WHOLE = 1_000
"""Units in the same furniture that are not parted, however many work: of the demonstration's 670 in showcases half cost
three quarters of all."""

_HUNG = (Furniture.WALL.value, Furniture.RAIL.value)

_SECONDS = 5.0
"""Longest time for which results wait to be stored together."""


@dataclass
class PlannedPage:
    """A page of the run before anything is found.

    Attributes
    ----------
    part
        Its objects.
    units
        Theirs.
    spacings
        Key of the gaps between the neighbours of its gallery; "" where no places are known.
    key
        Of the page, where Kouros fails on nothing of it.
    kept
        Of the page in the database, where it is there.
    """

    part: PagePart
    units: PageUnits
    spacings: str = ""
    key: str = ""
    kept: Made | None = None

    @property
    def wanted(self) -> list[str]:
        """The keys of all that must be had to show the page."""
        return [*dict.fromkeys(self.units.keys), *filter(None, [self.spacings])]

    def results(self, names: Mapping[str, str]) -> tuple[tuple[str, int], ...]:
        """Return of each object the key of its unit's results, and which of these it has."""
        return tuple((names.get(key, key), at) for key, at in self.units.by_object())

    def digests(self) -> tuple[str, ...]:
        """Return the digests of the records of its objects."""
        return tuple(self.part.objects.column("digest"))

    def numbers(self) -> list[str]:
        """Return the numbers of its objects."""
        return self.part.objects.column("object_number")


_Some = list[tuple[PlannedPage, "array[int]"]]
"""Units, page by page: which of those of the page."""


@dataclass
class _Work:
    """The units of a floor that have no results yet; every: how many there are on it that differ."""

    floor: str
    assessed: bool
    units: _Some
    every: int = 0

    def __len__(self) -> int:
        return sum(len(some) for _, some in self.units)


class Scheduler:
    """The units of a run, and the doing of what is not done yet.

    Attributes
    ----------
    staff
        Those who work.
    pages
        What is on each page of the run.
    fresh
        Objects that must be assessed, because nothing is known of them; those that are alike each by itself.
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
        staff: Staff,
        charts: Sequence[ChartTask] = (),
    ) -> None:
        self.staff = staff
        self.workspace, self.context, self.index, self.decisions = workspace, context, index, decisions
        self._charts = charts
        self.pages = self._planned(objects)
        self._names: dict[str, str] = {}
        self._made: dict[str, Made] = {}
        self._broken: set[str] = set()
        self._memory: dict[str, KeptResult] | None = None
        self.damaged: frozenset[str] = frozenset()
        self.fresh = 0
        self._work = self._missing()
        self.seconds = 0.0
        self.faults: list[Fault] = []

    # -----------------------------------------------------------------------------------------------------------------
    # What there is

    def _planned(self, objects: Listing) -> list[PlannedPage]:
        settings = self.workspace.settings
        house = house_effects(self.workspace, self.context, self.index, objects, self.decisions)
        keys = UnitKeys(self.context, rules_digest(settings), tables_digest(settings), house)
        planned = [PlannedPage(part, keys.units(part, self.decisions)) for part in paged(objects, settings)]
        placed = self.index.placed()
        for (gallery, shown), several in groupby(planned, lambda one: (one.part.gallery, one.part.on_display)):
            if shown and gallery in placed:
                pages = list(several)
                named = keys.neighbours([(page.part, page.units) for page in pages])
                for page in pages:
                    page.spacings = named
        return planned

    def _missing(self) -> list[_Work]:
        """Find out which pages are as they were, and which units of the others have no results yet."""
        for page in self.pages:
            page.key = page_digest(page.digests(), page.results({}), page.spacings)
        found, damaged = known_pages(self.workspace.engine, [page.key for page in self.pages])
        self.damaged = frozenset(damaged)
        _damage("page", damaged)
        floors: dict[tuple[str, bool], list[PlannedPage]] = {}
        for page in self.pages:
            page.kept = found.get(page.key)
            floors.setdefault(self._which(page), []).append(page)
        self._look_up({key for page in self.pages if page.kept is None for key in page.units.keys})
        work = []
        for which, pages in floors.items():
            new = [page for page in pages if page.kept is None]
            missing = {key for page in new for key in page.units.keys if key not in self._made}
            if missing:
                every = len({key for page in pages for key in page.units.keys})
                one = _Work(*which, _first(new, missing), every)
                work.append(one)
                self.fresh += sum(_objects(page, missing) for page in new) if one.assessed else 0
        return work

    def _look_up(self, keys: Collection[str]) -> None:
        """Find out which results are there; what is damaged is not, and is made with what is missing."""
        found, damaged = known(self.workspace.engine, keys)
        self._made |= found
        self._broken |= set(damaged)
        _damage("result", damaged)

    def _which(self, page: PlannedPage) -> tuple[str, bool]:
        """Return what is worked on together: the floor, and whether what is on the page is assessed."""
        return page.part.floor, page.part.on_display or self.context.stores

    # -----------------------------------------------------------------------------------------------------------------
    # Assessing

    def assess(self, progress: Progress, *, store: bool = True) -> None:
        """Find what is not known, and store it as it comes.

        Parameters
        ----------
        store : bool, optional
            False: it is held in memory only.
        """
        if not store:
            self._memory = {}
        if self._work:
            with self.staff.workers(self.fresh, self.context) as (workers, context):
                if self._charts and context.kept is not None and self.fresh > FEW:
                    for at, _ in enumerate(workers.each(build_chart, context, self._charts)):
                        progress.step("response charts", at + 1, len(self._charts))
                tasks = [self._batches(work, workers, context) for work in self._work]
                number = sum(len(some) for some in tasks)
                each = (task() for some in tasks for task in some)
                with closing(workers.each(assess_units, context, each)) as done:
                    self._take(done, number, progress)
        self._neighbours()

    def _batches(self, work: _Work, workers: WorkerPool, context: RunContext) -> list[Callable[[], UnitTask]]:
        """Part the units of a floor by what they stand in, and by their records: the same come together every night.

        What shakes an object is found for its furniture, in each sample anew, and is most of the work: parts that
        shared a kind of furniture would find it twice.
        """
        size = len(work)
        kinds = [""] * size
        if work.assessed and size > FEW:
            asked = (self._furniture_task(page, some) for page, some in work.units)
            with closing(workers.each(furniture_of_units, context, asked)) as told:
                kinds = [sys.intern(kind) for some in told for kind in some]
        parts = {kind: _parts(number, size, workers.workers) for kind, number in Counter(kinds).items()}
        shared: dict[tuple[str, int], _Some] = {}
        each = iter(kinds)
        for page, units in work.units:
            digests = page.part.objects.column("assessment_digest")
            for at in units:
                kind = next(each)
                turn = int(digests[page.units.bounds(at)[0]][:8] or "0", 16) * parts[kind] >> 32
                mine = shared.setdefault((kind, turn), [])
                if not mine or mine[-1][0] is not page:
                    mine.append((page, array("I")))
                mine[-1][1].append(at)
        # A few among many would take the place of what is kept of all.
        whole = 2 * size > work.every
        # What takes longest comes first: what hangs is run by a fraction of the models.
        order = sorted(shared, key=lambda one: (one[0] in _HUNG, -sum(len(some) for _, some in shared[one]), one))
        return [
            partial(
                self._task,
                work,
                shared[kind, at],
                ("units", work.floor, kind, at, parts[kind]) if whole else None,
            )
            for kind, at in order
        ]

    def _furniture_task(self, page: PlannedPage, units: Iterable[int]) -> FurnitureTask:
        listed = page.numbers()
        numbers = [listed[page.units.bounds(at)[0]] for at in units]
        return FurnitureTask(self.index.packed(numbers), self._about(numbers))

    def _about(self, numbers: Iterable[str]) -> tuple[Decision, ...]:
        return tuple(decision for number in numbers for decision in self.decisions.get(number, ()))

    def _task(self, work: _Work, units: _Some, batch: tuple[object, ...] | None) -> UnitTask:
        keys: list[str] = []
        sizes: list[int] = []
        numbers: list[str] = []
        for page, some in units:
            listed = page.numbers()
            for at in some:
                start, end = page.units.bounds(at)
                keys.append(page.units.keys[at])
                sizes.append(end - start)
                numbers += listed[start:end]
        records = self.index.packed(numbers)
        return UnitTask(work.floor, work.assessed, tuple(keys), tuple(sizes), records, self._about(numbers), batch)

    def _take(self, done: Iterable[Assessments], number: int, progress: Progress) -> None:
        waiting: list[Stored] = []
        since = monotonic()
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
        self.failed(came.faults)
        # What failed is kept under a key of its own: it is tried again every night, whatever it depends on.
        names = {key: f"{key}:{self.context.head.run_id}" for key in came.failed}
        self._names |= names
        return [replace(one, key=names.get(one.key, one.key)) for one in came.stored]

    def failed(self, faults: Iterable[Fault]) -> None:
        """Take note of objects that Kouros failed on."""
        for one in faults:
            about = {"object": one.object_number, "message": one.words, "traceback": one.traceback}
            note("object.failed", level=logging.ERROR, **about)
            self.faults.append(one)

    def _keep(self, waiting: list[Stored]) -> None:
        head = self.context.head
        if self._memory is None:
            # What is there is left as it is: what is damaged would stay.
            forget(self.workspace.engine, self._broken)
            self._broken.clear()
            keep(self.workspace.engine, head.run_id, head.started, waiting)
        else:
            self._memory |= {one.key: KeptResult(head.run_id, head.started, one.outline, one.found) for one in waiting}
        waiting.clear()

    def _neighbours(self) -> None:
        """Find the gaps between the neighbours of those galleries of which they are not known."""
        keys = dict.fromkeys(page.spacings for page in self.pages if page.spacings and page.kept is None)
        self._look_up(keys)
        for key in keys:
            if key not in self._made:
                self._gaps(key)

    def _gaps(self, key: str) -> None:
        # Of all its pages, those that are as they were among them: their results are there.
        pages = [page for page in self.pages if page.spacings == key]
        results = self._results([k for page in pages for k in page.units.keys])
        members = tuple(replace(self.members(page), spacings="") for page in pages)
        task = GalleryTask(key, pages[0].part.floor, members, {k: one.found for k, one in results.items()})
        self._keep(self._told(find_neighbours(self.context, task)))

    # -----------------------------------------------------------------------------------------------------------------
    # What was found

    def is_failed(self, page: PlannedPage) -> bool:
        """Say whether Kouros failed on something of a page in this run."""
        return bool(self._names) and any(key in self._names for key in page.wanted)

    def key_of(self, page: PlannedPage) -> str:
        """Return the key of a page, now that it is known what Kouros failed on."""
        if not self.is_failed(page):
            return page.key
        named = page.results(self._names)
        return page_digest(page.digests(), named, self._names.get(page.spacings, page.spacings))

    def newest_of(self, page: PlannedPage) -> Made:
        """Return when the newest of the results on a page was made, and by which run."""
        mine = Made(self.context.head.started, self.context.head.run_id)
        return max(self._made.get(key, mine) for key in page.wanted)

    def members(self, page: PlannedPage) -> Members:
        """Return the objects of a page as they are kept."""
        return Members(
            self.index.packed(page.numbers()),
            page.digests(),
            page.results(self._names),
            self._names.get(page.spacings, page.spacings),
        )

    def found(self, page: PlannedPage) -> tuple[Members, dict[str, bytes]]:
        """Return the objects of a page, and their results by key."""
        results = self._results(page.wanted)
        return self.members(page), {key: one.found for key, one in results.items()}

    def _results(self, keys: Iterable[str]) -> dict[str, KeptResult]:
        """Return the results of units; those that are damaged are made again."""
        wanted = list(dict.fromkeys(keys))
        found, damaged = self._fetch(wanted)
        gone = {key for key in wanted if self._names.get(key, key) not in found}
        if gone:
            _damage("result", damaged)
            self._again(gone)
            found |= self._fetch(list(gone))[0]
        return found

    def _fetch(self, keys: Sequence[str]) -> tuple[dict[str, KeptResult], list[str]]:
        named = [self._names.get(key, key) for key in keys]
        mine = {} if self._memory is None else {key: self._memory[key] for key in named if key in self._memory}
        found, damaged = fetch(self.workspace.engine, [key for key in named if key not in mine])
        return mine | found, damaged

    def _again(self, keys: set[str]) -> None:
        for key in keys:
            self._broken.add(self._names.get(key, key))
            self._made.pop(key, None)
        floors: dict[tuple[str, bool], list[PlannedPage]] = {}
        for page in self.pages:
            floors.setdefault(self._which(page), []).append(page)
        for which, pages in floors.items():
            some = _first(pages, keys)
            if some:
                came = assess_units(self.context, self._task(_Work(*which, some), some, None))
                self._keep(self._told(came))
        for key in {page.spacings for page in self.pages} & keys:
            self._gaps(key)

    def copy_results(self, target: Database) -> None:
        """Copy all results of the run into another database, those that are held in memory only among them."""
        head = self.context.head
        mine = [Stored(key, one.outline, one.found) for key, one in (self._memory or {}).items()]
        keep(target, head.run_id, head.started, mine)
        keys = dict.fromkeys(self._names.get(key, key) for page in self.pages for key in page.wanted)
        copy(self.workspace.engine, target, list(keys))


def _first(pages: Iterable[PlannedPage], keys: Collection[str]) -> _Some:
    """Return where on some pages there are units with some keys: of those that are alike the first."""
    left, out = set(keys), []
    for page in pages:
        some = array("I")
        for at, key in enumerate(page.units.keys):
            if key in left:
                left.remove(key)
                some.append(at)
        if some:
            out.append((page, some))
    return out


def _objects(page: PlannedPage, keys: Collection[str]) -> int:
    return sum(size for key, size in zip(page.units.keys, page.units.sizes, strict=True) if key in keys)


def _damage(what: str, keys: Sequence[str]) -> None:
    """Say that rows of the database are not what was written, and are made again."""
    if keys:
        note(f"{what}.damaged", level=logging.WARNING, keys=list(keys))
        told = f"{counted(len(keys), what)} of the database changed since written: see whether the disk is sound"
        warnings.warn(f"{told}; made again", DamageWarning, stacklevel=3)


def _parts(units: int, of: int, workers: int) -> int:
    """Return how many parts so many units in the same furniture are cut into, of all those that are to be done."""
    return ceil(units / max(WHOLE, min(BATCH, ceil(of / workers))))
