"""One object as the desk shows it: what the last night found, with the record and the decisions of now."""

import hashlib
import json
from collections import OrderedDict
from dataclasses import dataclass, replace
from threading import Lock

from pipeline.analysis.house.questions import VOCABULARIES
from pipeline.analysis.survey import Measurable, measurables
from pipeline.collection.inventory import items_named
from pipeline.collection.record import digest_of
from pipeline.desk.guard import NotThereError
from pipeline.desk.numbers import cell_unit, shown_number
from pipeline.desk.run_facts import RunFacts
from pipeline.records import (
    Assessment,
    Decision,
    DecisionKind,
    DecisionStatus,
    Found,
    Item,
    MeasurementRequest,
    Page,
    Support,
    in_force,
)
from pipeline.report.language import said, speaking
from pipeline.report.pages.compose import page_name
from pipeline.report.pages.describe import Describer
from pipeline.report.pages.museum_views import GalleryView
from pipeline.report.pages.views import ObjectView, PageView, StateCounts
from pipeline.report.units import Units
from pipeline.store.desk import Picture, pictures_of
from pipeline.store.pages import load_one

_COMPUTED = frozenset({DecisionKind.CLASS, DecisionKind.INSTALLED})
"""Decisions that the next run computes with."""

KEPT = 2_000
"""Objects that are kept in words: those that people come back to."""


@dataclass(frozen=True, slots=True)
class CellView:
    """A field of the record to fill in: what it is, its unit, what is recorded, and what is taken for it now.

    Attributes
    ----------
    choices : tuple of str
        The words it may be; none for a number.
    wished : bool
        Whether measuring it is worth something.
    """

    field: str
    label: str
    how: str
    unit: str
    recorded: str
    choices: tuple[str, ...]
    wished: bool


@dataclass(frozen=True)
class ObjectFacts:
    """An object.

    Attributes
    ----------
    item : Item
        Its record of now.
    version : str
        Of record, decisions and pictures: who changes something says which they saw.
    view, gallery : ObjectView, GalleryView, or None
        What the last run found, in words; None where it had no such object.
    assessment : Assessment or None
        The same in numbers.
    wishes : tuple of MeasurementRequest
        What is worth measuring on it.
    decisions : tuple of DecisionStatus
        In force now, by id.
    changed : bool
        Whether its record, or what was decided and is computed with, is another than the last run's.
    pictures : tuple of Picture
        Of its mount.
    """

    item: Item
    version: str
    view: ObjectView | None
    gallery: GalleryView | None
    assessment: Assessment | None
    wishes: tuple[MeasurementRequest, ...]
    decisions: tuple[DecisionStatus, ...]
    changed: bool
    pictures: tuple[Picture, ...]


_InWords = tuple[ObjectView, GalleryView, Assessment, tuple[MeasurementRequest, ...]]


class ObjectDesk:
    """Gives objects; what was put into words is kept for whoever comes back."""

    def __init__(self) -> None:
        self._kept: OrderedDict[tuple[object, ...], _InWords] = OrderedDict()
        self._lock = Lock()

    def facts(self, run: RunFacts, number: str, log: tuple[Decision, ...], *, pictured: bool = True) -> ObjectFacts:
        """Return an object.

        Parameters
        ----------
        run : RunFacts
            The newest.
        number : str
            The museum's.
        log : tuple of Decision
            All decisions about it, by id.
        pictured : bool
            Whether there are photographs of mounts at all.

        Raises
        ------
        NotThereError
            Where the inventory has none of that number.
        """
        engine = run.workspace.engine
        item = items_named(engine, [number]).get(number)
        if item is None:
            raise NotThereError(f"there is no object {number[:60]!r} in the inventory; search for it")
        pictures, mine = pictures_of(engine, number) if pictured else (), in_force(log)
        digest = digest_of(item)
        version = hashlib.sha256(
            json.dumps([digest, [d.id for d in log], [p.id for p in pictures]]).encode()
        ).hexdigest()[:32]
        place = run.place(number)
        told = {standing.decision.id: standing for standing in run.head.decisions}
        standings = tuple(told.get(d.id) or DecisionStatus(d) for d in mine)
        if place is None:
            return ObjectFacts(item, version, None, None, None, (), standings, False, pictures)
        page, key, at, then = place
        known = (run.run_id, number, key, at, digest, tuple(d.id for d in mine))
        with self._lock:
            kept = self._kept.get(known)
        if kept is None:
            kept = self._in_words(run, page, load_one(engine, key, at, item), standings)
            with self._lock:
                self._kept[known] = kept
                while len(self._kept) > KEPT:
                    self._kept.popitem(last=False)
        view, gallery, assessment, wishes = kept
        # What the last run did not know of, or computed with and holds no longer.
        changed = digest != then or any(d.kind in _COMPUTED and (d.id in told) != (d in mine) for d in log)
        return ObjectFacts(item, version, view, gallery, assessment, wishes, standings, changed, pictures)

    @staticmethod
    def _in_words(run: RunFacts, page: Page, found: Found, standings: tuple[DecisionStatus, ...]) -> _InWords:
        record = replace(run.head, assessments=found.assessments, wishes=found.wishes, spacings=(), decisions=standings)
        file = page_name(page.gallery, page.number, on_display=page.on_display)
        with speaking(run.language):
            told = Describer(record, run.units, run.sayings).object(found.assessments[0], file)
        # Charts are on the report's own page, which is a link away; of its gallery nothing else is shown here.
        view = replace(told, figures=())
        gallery = GalleryView(
            name=page.gallery if page.on_display else "",
            page=PageView(file, page.number, page.of),
            on_display=page.on_display,
            counts=StateCounts(),
            tasks=(),
            objects=(view,),
            charts=(),
            motions=tuple(dict.fromkeys(f.motion for f in view.findings)),
            several_levels=run.several,
        )
        return view, gallery, found.assessments[0], found.wishes or ()


_PLAIN_SIZES = ("height_m", "width_m", "depth_m", "mass_kg")


def cells(facts: ObjectFacts, units: Units) -> list[CellView]:
    """Return what may be filled in of an object, what is worth most first, then what a tape and a scale tell."""
    worth = {w.field: w for w in facts.wishes if not w.settles_nothing}
    order = [*worth, *(name for name in _PLAIN_SIZES if name not in worth)]
    found = [_cell(one, facts.item, units, one.field in worth) for one in measurables()]
    return sorted(found, key=lambda cell: order.index(cell.field) if cell.field in order else len(order))


def _cell(one: Measurable, item: Item, units: Units, wished: bool) -> CellView:
    value = getattr(item, one.field, None)
    unit = "" if one.unit == "-" else one.unit
    choices = vocabulary(one.field)
    recorded = "" if value is None else str(value) if choices else shown_number(value, one.unit, units)
    return CellView(
        one.field, said(one.label), said(one.how), cell_unit(unit, units) if unit else "", recorded, choices, wished
    )


def vocabulary(field: str) -> tuple[str, ...]:
    """Return the words that a field may hold; none for one that holds a number."""
    return tuple(Support) if field == "support" else tuple(VOCABULARIES.get(field, ()))
