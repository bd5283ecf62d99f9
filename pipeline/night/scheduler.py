"""One round through the sheets of a collection: which have results, who finds the others, what becomes of all."""

import logging
from collections import Counter
from collections.abc import Callable, Container, Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import AbstractContextManager, closing
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil
from time import monotonic

from pipeline.analysis.faults import Fault
from pipeline.collection.catalogue import Catalogue
from pipeline.collection.inventory import fields_since
from pipeline.collection.listing import Listing
from pipeline.collection.record import family_of
from pipeline.execute.memory import give_back
from pipeline.execute.pool import WorkerPool, cores, pool
from pipeline.night.context import Brief
from pipeline.night.decision_review import now, standing
from pipeline.night.floors import floor_name
from pipeline.night.tasks import Batch, ChartErrand, Done, Errand, KindErrand, build, find_kinds, stand, work
from pipeline.night.units import Keys, Part, cut
from pipeline.night.versions import rules_digest
from pipeline.operations.event_log import note
from pipeline.operations.workspace import Workspace
from pipeline.records import Decision, Progress, RunChanges, Sheet, Standing, Tally
from pipeline.report.files.report_writer import Edition, Shelved, link_to, sheet_key
from pipeline.report.pages.since import mentioned
from pipeline.report.pages.tallies import total
from pipeline.report.pages.views import Pointer
from pipeline.store.parcels import Parcel
from pipeline.store.results import (
    Encoded,
    Kept,
    keep,
    known_to,
    load_found,
    on_same_basis,
    outlines_of,
    packed,
)
from pipeline.store.reuse import whole_runs
from pipeline.store.runs import sheets_of

FEW = 5_000
"""Objects whose results are to be found for which other processes do not pay: they take seconds to start."""

BATCH = 16_000
"""Objects, about, that one worker works on together at most: each model is called once for all of them under each
motion, which costs some seconds however few they are."""

KIND_BATCH = 100_000
"""Kinds of objects, about, that one worker works on together at most; they are neither stored nor drawn.  Of eleven
motions 30,000 take 39 s, 90,000 take 92: some 13 s are for sets that every part asks for."""

KINDS = 400_000
"""Kinds of objects that are found before the sheets at most, of about 0.5 kB each."""

_SECONDS = 5.0
"""Longest time for which results wait to be stored together."""


@dataclass
class _Piece:
    """A sheet and what is known of it so far.

    basis : of its result, see `Keys`
    kept  : its result, where there is one
    there : the decisions about its objects as they stand, once there is a result
    """

    part: Part
    floor: str
    basis: str
    key: str
    decisions: tuple[Decision, ...]
    kept: Kept | None
    there: tuple[Standing, ...] = ()


class Round:
    """The sheets of a run, and the doing of them.

    fresh    : objects that must be assessed, because nothing is known of them
    sheets   : as they are stored with the run, once all is done; standing: the decisions about their objects
    seconds  : what finding out what is worth measuring cost
    charts   : response charts that are built before the sheets
    """

    def __init__(
        self,
        workspace: Workspace,
        brief: Brief,
        catalogue: Catalogue,
        objects: Listing,
        decisions: Mapping[str, tuple[Decision, ...]],
    ) -> None:
        self.workspace, self.brief = workspace, brief
        self._catalogue, self._decisions = catalogue, decisions
        settings, keys = workspace.settings, Keys(brief, rules_digest(workspace.settings))
        self._cut = cut(objects, settings)
        parts, decided = self._cut.parts, self._cut.holding(decisions.keys())
        self._numbers = catalogue.digests(list(decided))
        about: dict[int, tuple[Decision, ...]] = {}
        for number, part in decided.items():
            about[id(part)] = about.get(id(part), ()) + decisions[number]
        theirs = [about.get(id(part), ()) for part in parts]
        floors = [floor_name(settings, part.objects[0].gallery) for part in parts]
        named = [keys.of(*of) for of in zip(parts, floors, theirs, strict=True)]
        there = known_to(workspace.engine, named)
        self._pieces = [
            _Piece(part, floor, keys.basis(part, floor), key, mine, there.get(key))
            for part, floor, key, mine in zip(parts, floors, named, theirs, strict=True)
        ]
        self.fresh = sum(len(p.part.objects) for p in self._pieces if p.kept is None and self._assessed(p))
        self.seconds = 0.0
        self.charts: Sequence[ChartErrand] = ()
        self.faults: list[Fault] = []
        self._tallies: list[Tally] = []
        self._sheets: list[Sheet] = []

    @property
    def sheets(self) -> tuple[Sheet, ...]:
        """The sheets that are done, in order."""
        return tuple(self._sheets)

    @property
    def standing(self) -> tuple[Standing, ...]:
        """The decisions about the objects of the sheets that are done, as they stand."""
        return tuple(one for piece in self._pieces for one in piece.there)

    def _assessed(self, piece: _Piece) -> bool:
        return piece.part.on_display or self.brief.stores

    def strangers(self, *, whole: bool) -> tuple[Standing, ...]:
        """Return the decisions about objects that the collection does not have any more.

        whole : whether the run is of all objects: else what is not in it is not gone
        """
        if not whole:
            return ()
        gone = [d for number, mine in self._decisions.items() if number not in self._numbers for d in mine]
        at = now((), self.brief.head, {}, lambda _number, _digest: ())
        return standing(sorted(gone, key=lambda d: d.id), at)

    # -----------------------------------------------------------------------------------------------------------------

    def assess(self, progress: Progress, take: Callable[[Encoded], None] = lambda _: None) -> Tally:
        """Find what is not known, and return the totals; nothing is stored and nothing drawn.

        take : is given each new result
        """
        todo = [piece for piece in self._pieces if piece.kept is None]
        with self._pool(self.fresh) as hands, closing(self._each(hands, todo, progress, draw=False)) as done:
            for at, piece in enumerate(self._pieces):
                progress.step("sheets", at, len(self._pieces))
                came = None if piece.kept is not None else next(done)
                self._note(piece, came)
                if came is not None and came.result is not None:
                    take(came.result)
        progress.step("sheets", len(self._pieces), len(self._pieces))
        return total(self._tallies)

    def edition(self) -> Edition:
        """Return the report that the sheets go into; it is entered before `publish`, and finished after it."""
        reports = self.workspace.reports
        return Edition(reports / self.brief.head.run_id, self.brief.pen, Shelved.read(reports / "latest"))

    def publish(self, edition: Edition, progress: Progress) -> Tally:
        """Find what is not known, store it as it comes, put every sheet into the report, and return the totals."""
        for piece in self._pieces:
            if piece.kept is not None and piece.decisions:
                found = load_found(self.workspace.engine, piece.key)
                piece.there = stand(self.brief.head, found, self._told(piece))
        keys = [sheet_key(edition.pen, self._sheet(piece), piece.there) for piece in self._pieces]
        taken = {at for at, piece in enumerate(self._pieces) if piece.kept is not None and edition.has(keys[at])}
        left = [piece for at, piece in enumerate(self._pieces) if at not in taken]
        repeated = not left and edition.repeat(keys)
        waiting: list[Encoded] = []
        since = monotonic()
        todo = sum(len(piece.part.objects) for piece in left)
        with self._pool(todo) as hands, closing(self._each(hands, left, progress, draw=True)) as done:
            for at, piece in enumerate(self._pieces):
                progress.step("sheets", at, len(self._pieces))
                came = None if at in taken else next(done)
                sheet = self._note(piece, came)
                if came is None:
                    if not repeated:
                        edition.reuse(keys[at])
                elif came.drawn is not None:
                    # How the decisions stand is only known now, where there was no result.
                    edition.add(sheet_key(edition.pen, sheet, piece.there), came.drawn)
                if came is not None and came.result is not None:
                    waiting.append(came.result)
                if waiting and monotonic() - since > _SECONDS:
                    self._keep(waiting)
                    since = monotonic()
            self._keep(waiting)
        progress.step("sheets", len(self._pieces), len(self._pieces))
        return total(self._tallies)

    def _each(self, hands: WorkerPool, todo: Sequence[_Piece], progress: Progress, *, draw: bool) -> Generator[Done]:
        """Yield what comes of each sheet; charts that many ask for are built before, each by one."""
        # For a few objects not all are read: whoever asks for one finds or builds it.
        if self.charts and self.brief.kept is not None and self.fresh > FEW:
            for at, _ in enumerate(hands.each(build, self.brief, self.charts)):
                progress.step("response charts", at + 1, len(self.charts))
        fresh = [p for p in todo if p.kept is None and self._assessed(p) and not self._before(p)]
        # One who works alone remembers what he found.
        parcels = list(self._kinds(hands, fresh, progress)) if hands.workers > 1 else []
        objects = sum(len(piece.part.objects) for piece in todo)
        batches = _batches(todo, ceil(objects / _shares(objects, hands.workers, BATCH)))
        wanted = (self._batch(batch, parcels, draw=draw) for batch in batches)
        for done in hands.each(work, self.brief, wanted):
            yield from done

    def _kinds(self, hands: WorkerPool, fresh: Sequence[_Piece], progress: Progress) -> Iterator[tuple[str, Parcel]]:
        """Find what holds for many objects before the sheets that they are on: else each worker finds it for itself.

        fresh   : sheets of which the last night knew nothing
        returns : for a floor, what was found of some kinds
        """
        errands: list[tuple[str, tuple[int, int], dict[int, str]]] = []
        for floor, kinds in _frequent(fresh, self._decisions).items():
            parts = _shares(len({family_of(kind) for kind in kinds}), hands.workers, KIND_BATCH)
            shared: list[dict[int, str]] = [{} for _ in range(parts)]
            for kind, number in kinds.items():
                shared[family_of(kind) % parts][kind] = number
            errands += [(floor, (at, parts), part) for at, part in enumerate(shared)]
        wanted = (
            KindErrand(floor, place, tuple(part), self._catalogue.packed(list(part.values())))
            for floor, place, part in errands
        )
        for at, found in enumerate(hands.each(find_kinds, self.brief, wanted)):
            progress.step("kinds of objects", at + 1, len(errands))
            yield errands[at][0], found

    def _batch(self, batch: Sequence[_Piece], parcels: Sequence[tuple[str, Parcel]], *, draw: bool) -> Batch:
        errands = tuple(replace(self._errand(piece), draw=draw) for piece in batch)
        if batch[0].kept is not None:
            return Batch(errands)
        kinds = {one.kind for piece in batch for one in piece.part.objects if one.kind is not None}
        return Batch(errands, tuple(parcel.only(kinds) for floor, parcel in parcels if floor == batch[0].floor))

    def _keep(self, waiting: list[Encoded]) -> None:
        head = self.brief.head
        keep(self.workspace.engine, head.run_id, head.started, waiting)
        waiting.clear()

    def _pool(self, objects: int) -> AbstractContextManager[WorkerPool]:
        wanted = self.workspace.settings.execution
        if objects <= FEW:
            return pool()
        # What reading the records and drawing the motions took is there for the workers.
        give_back()
        if wanted.cluster:
            # Its workers may not see our folders.
            self.brief = replace(self.brief, kept=None, threads=1)
            return pool(address=wanted.cluster)
        self.brief = replace(self.brief, threads=1)
        return pool(processes=wanted.processes or cores())

    def _sheet(self, piece: _Piece) -> Sheet:
        part, kept, head = piece.part, piece.kept, self.brief.head
        run, made, counts = (head.run_id, head.started, {}) if kept is None else (kept.run, kept.made, kept.counts)
        return Sheet(piece.key, part.gallery, part.on_display, part.number, part.of, run, made, counts)

    def _told(self, piece: _Piece) -> Errand:
        """Return what is to be known of a sheet and of the decisions about its objects, whoever works on it."""
        digests = {number: self._numbers[number] for number in {d.object_number for d in piece.decisions}}
        changed = {
            (d.object_number, d.digest): tuple(fields_since(self.workspace.engine, d.object_number, d.digest))
            for d in piece.decisions
            if d.digest != digests[d.object_number]
        }
        return Errand(self._sheet(piece), piece.floor, decisions=piece.decisions, digests=digests, changed=changed)

    def _errand(self, piece: _Piece) -> Errand:
        """Return what is to be done for a sheet, with all that it takes: whoever does it has no database."""
        told = self._told(piece)
        if piece.kept is not None:
            return replace(told, found=packed(self.workspace.engine, piece.key))
        numbers = [one.object_number for one in piece.part.objects]
        told = replace(told, records=self._catalogue.packed(numbers), basis=piece.basis)
        if not self._assessed(piece):
            return told
        return replace(told, before=tuple(packed(self.workspace.engine, key) for key in self._before(piece)))

    def _before(self, piece: _Piece) -> list[str]:
        """Return the keys of what the last night found in the place of a sheet, as far as it may be taken over.

        A cut more or less shifts the numbers by one.  More are not looked at: of a gallery whose sheets all changed
        each would bring all.
        """
        part = piece.part
        places = [(part.gallery, part.on_display, part.number + shift) for shift in (-1, 0, 1)]
        gone = [self._gone[place] for place in places if place in self._gone]
        return on_same_basis(self.workspace.engine, gone, piece.basis) if gone else []

    @cached_property
    def _gone(self) -> dict[tuple[str, bool, int], str]:
        # By place, the sheets of the last night that are not shown any more: those that are hold other objects.
        shown = {one.key for one in self._pieces}
        return {
            (sheet.gallery, sheet.on_display, sheet.number): sheet.key
            for run_id in whole_runs(self.workspace.engine)[:1]
            for sheet in sheets_of(self.workspace.engine, run_id)
            if sheet.key not in shown
        }

    def _note(self, piece: _Piece, came: Done | None) -> Sheet:
        sheet, tally = self._sheet(piece), None if piece.kept is None else piece.kept.tally
        if came is not None:
            piece.there = came.standing
            self.seconds += came.seconds
            for one in came.faults:
                note(
                    "object.failed",
                    level=logging.ERROR,
                    object=one.object_number,
                    message=one.words,
                    traceback=one.traceback,
                )
            self.faults.extend(came.faults)
            if came.result is not None:
                # Perhaps under a key of its own.
                piece.key = came.result.key
                sheet, tally = replace(self._sheet(piece), counts=came.result.counts), came.result.tally
        if tally is not None:
            self._tallies.append(tally)
        self._sheets.append(sheet)
        return sheet

    # -----------------------------------------------------------------------------------------------------------------

    def links(self, changes: RunChanges | None) -> dict[str, Pointer]:
        """Return where the objects are that the index names as changed, by number."""
        named = set() if changes is None else mentioned(changes)
        keys = {id(piece.part): piece.key for piece in self._pieces}
        where = {number: keys[id(part)] for number, part in self._cut.holding(named).items()}
        sheets = {sheet.key: sheet for sheet in self._sheets}
        titles = {
            outline.object_number: (key, outline.title)
            for key in dict.fromkeys(where.values())
            for outline in outlines_of(self.workspace.engine, [key])
        }
        found = ((number, *titles[number]) for number in where if number in titles)
        return {number: link_to(sheets[key], number, title) for number, key, title in found}


def _batches(pieces: Iterable[_Piece], most: int) -> Iterator[list[_Piece]]:
    """Yield what is worked on together: sheets of one floor, in their order, that have a result or have none.

    most : objects, about
    """
    batch: list[_Piece] = []
    size = 0
    for piece in pieces:
        alike = batch and (batch[0].floor, batch[0].kept is None) == (piece.floor, piece.kept is None)
        # The sheet with which it would be larger by more than half of that sheet is left to the next.
        if batch and (not alike or size + len(piece.part.objects) // 2 > most):
            yield batch
            batch, size = [], 0
        batch.append(piece)
        size += len(piece.part.objects)
    if batch:
        yield batch


def _shares(objects: int, workers: int, most: int) -> int:
    """Return how many parts work is cut into: of so many objects at most, and as many for each worker: none waits."""
    return workers * max(1, ceil(objects / (workers * most)))


def _frequent(pieces: Iterable[_Piece], decided: Container[str]) -> dict[str, dict[int, str]]:
    """Return the kinds that more than one object on a floor may be of, with the number of the first of each.

    Where all kinds can be held they are all taken: many at once are quicker than a few with each sheet.

    decided : numbers of the objects that decisions were made about; what these change is theirs alone
    """
    times: Counter[tuple[str, int]] = Counter()
    first: dict[tuple[str, int], str] = {}
    for piece in pieces:
        for one in piece.part.objects:
            if one.kind is None or one.case or one.object_number in decided:
                continue
            times[piece.floor, one.kind] += 1
            first.setdefault((piece.floor, one.kind), one.object_number)
    out: dict[str, dict[int, str]] = {}
    few = len(times) <= KINDS
    for (floor, kind), often in times.most_common(KINDS):
        if few or often > 1:
            out.setdefault(floor, {})[kind] = first[floor, kind]
    return out
