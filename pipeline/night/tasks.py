"""What is done for one sheet, wherever it is done: find, judge, advise, and draw.

A `Brief` holds what all sheets of a run share and goes once to whoever works; an `Errand` is one sheet.  What comes
back depends on these two alone: the same on this machine and on another, whoever did what before.
"""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from typing import Any

from pipeline.analysis.chart_runs import deciding, response_chart
from pipeline.analysis.context import remembered
from pipeline.analysis.faults import Fault, fitting
from pipeline.collection.catalogue import read_packed
from pipeline.execute.memory import give_back
from pipeline.mitigate.installed import Placed
from pipeline.night.assessment import by_object, each_assessed, failed_on, find, placed_each
from pipeline.night.context import Brief
from pipeline.night.decision_review import now, standing
from pipeline.night.deduplication import Known, Twins, likeness
from pipeline.records import (
    Assessment,
    Decision,
    Found,
    Motion,
    RunRecord,
    Sheet,
    Standing,
)
from pipeline.report.files.page_renderer import Drawn, Pen
from pipeline.report.pages.tallies import tally
from pipeline.store.parcels import Parcel
from pipeline.store.results import Encoded, encode, unpacked


@dataclass(frozen=True)
class Errand:
    """One sheet to be worked on.

    floor     : that it stands on
    records   : of its objects, packed, where they are to be assessed; else ``found`` is what was found of them, as it
                is kept
    basis     : the digest of what is found of them depends on besides them
    before    : results of an earlier night, as they are kept, on the same basis, of objects many of which are the same
    decisions : those in force about its objects
    digests   : of the records, by object number, of the objects decided about
    changed   : (object number, digest of its record when it was decided about) -> the fields that changed since
    draw      : whether its page is wanted
    """

    sheet: Sheet
    floor: str
    records: bytes = b"[]"
    found: bytes | None = None
    basis: str = ""
    before: tuple[bytes, ...] = ()
    decisions: tuple[Decision, ...] = ()
    digests: Mapping[str, str] = field(default_factory=dict)
    changed: Mapping[tuple[str, str], tuple[str, ...]] = field(default_factory=dict)
    draw: bool = True


@dataclass(frozen=True)
class ChartErrand:
    """A response chart to be built.

    angle : degrees that what asks for it is shaken along; None for the worst direction, or for both at once
    alike : the parameters that all who ask for it share
    """

    model: str
    motion: Motion
    angle: float | None
    alike: Mapping[str, float]


def build(brief: Brief, errand: ChartErrand) -> None:
    """Put a chart into the cache, where it is not there yet, so that all who work find it."""
    given: dict[str, Any] = {name: value for name, value in errand.alike.items() if value == value}  # noqa: PLR0124 - NaN: not given
    response_chart(
        errand.model,
        errand.motion,
        angle=errand.angle,
        numerics=deciding(errand.model, brief.analysis.numerics),
        charts=brief.charts,
        **given,
    )


@dataclass(frozen=True)
class KindErrand:
    """Objects on one floor, of kinds that others are of.

    part    : which of the parts it is that the kinds were divided into, and into how many
    kinds   : of the objects;  records: theirs, packed, in the same order
    """

    floor: str
    part: tuple[int, int]
    kinds: tuple[int, ...]
    records: bytes


def find_kinds(brief: Brief, errand: KindErrand) -> Parcel:
    """Find what holds for all that are like some objects, and return it by their kinds."""
    storey = brief.storeys[errand.floor]
    first: dict[Hashable, int] = {}
    chosen, same = {}, {}
    for kind, one in zip(errand.kinds, placed_each(brief, storey, read_packed(errand.records), {}), strict=True):
        like = likeness(one.scene) if isinstance(one, Placed) else None
        if like is None or not isinstance(one, Placed):
            continue
        if first.setdefault(like, kind) == kind:
            chosen[kind] = one
        else:
            same[kind] = first[like]
    with remembered(brief.memory("kinds", errand.floor, errand.part)) as histories:
        known = each_assessed(brief, storey, list(chosen.values()), brief.working(histories))
    # What Kouros failed on is told by the sheet that it is on.
    sound = {kind: one for kind, one in zip(chosen, known, strict=True) if not isinstance(one, Exception)}
    found = Parcel.of(Known, sound, {kind: of for kind, of in same.items() if of in sound})
    del chosen, known, sound
    # What follows, sheet by sheet, takes far less.
    give_back()
    return found


@dataclass(frozen=True)
class Batch:
    """Sheets of one floor that are worked on together.

    twins : what was found beforehand of kinds that their objects may be of
    """

    errands: tuple[Errand, ...]
    twins: tuple[Parcel, ...] = ()


@dataclass(frozen=True)
class Done:
    """What came of an errand.

    result   : where it is new
    drawn    : the page, where it was wanted
    standing : the decisions about its objects as they stand
    seconds  : what finding out what is worth measuring cost
    faults   : the objects that Kouros failed on just now
    """

    result: Encoded | None
    drawn: Drawn | None
    standing: tuple[Standing, ...]
    seconds: float = 0.0
    faults: tuple[Fault, ...] = ()


def work(brief: Brief, batch: Batch) -> tuple[Done, ...]:
    """Do what there is to do for some sheets of one floor; what must be found is found together, which is quicker.

    What Kouros fails on costs the object its answer, and is told (see `pipeline.analysis.faults`).
    """
    seconds, faults = 0.0, list[Fault]()
    results: dict[str, tuple[Found, Encoded]] = {}
    fresh = []
    for errand in batch.errands:
        if errand.found is None and not (errand.sheet.on_display or brief.stores):
            left = left_aside(brief, errand, faults)
            results[errand.sheet.key] = fitting(left, partial(_encoded, brief, errand), faults)
        elif errand.found is None:
            fresh.append(errand)
    if fresh:
        items = [read_packed(errand.records) for errand in fresh]
        floor, everything = fresh[0].floor, [item for some in items for item in some]
        decisions = [decision for errand in fresh for decision in errand.decisions]
        # What comes with the batch is forgotten with it, so that memory does not grow with the collection.
        twins = Twins() if batch.twins else brief.twins
        for parcel in batch.twins:
            twins.take(parcel.opened())
        for errand in fresh:
            for earlier in errand.before:
                twins.learn(unpacked(earlier))
        sheets = ((e.sheet.gallery, e.sheet.on_display, e.sheet.number, e.floor) for e in fresh)
        with remembered(brief.memory(*sheets)) as histories:
            context = brief.working(histories)
            whole, seconds, failed = find(brief, brief.storeys[floor], everything, decisions, twins, context)
        faults += failed
        for errand, found in zip(fresh, parted(whole, [len(some) for some in items]), strict=True):
            results[errand.sheet.key] = fitting(found, partial(_encoded, brief, errand), faults)
    done = []
    # What draws is made outside of any object's guard: a language without a catalogue is nobody's fault here.
    pen = brief.pen if any(errand.draw for errand in batch.errands) else None
    for errand in batch.errands:
        known = errand.found
        found = results[errand.sheet.key][0] if known is None else unpacked(known)
        result = results[errand.sheet.key][1] if known is None else None
        there = stand(brief.head, found, errand)
        drawn = None
        if pen is not None and errand.draw:
            shown, drawn = fitting(found, partial(_drawn, pen, errand.sheet, there), faults)
            if shown is not found and result is not None:
                result = _encoded(brief, errand, shown)
        done.append(Done(result, drawn, there, seconds, tuple(faults)))
        seconds, faults = 0.0, []
    return tuple(done)


def _encoded(brief: Brief, errand: Errand, found: Found) -> Encoded:
    key = errand.sheet.key
    if any(assessment.fault for assessment in found.assessments):
        # Under a key of its own: what failed is tried again every night, whatever it depends on.
        key = f"{key}:{brief.head.run_id}"
    return encode(key, errand.basis, found, tally)


def _drawn(pen: Pen, sheet: Sheet, decisions: Sequence[Standing], found: Found) -> Drawn:
    return pen.draw(sheet, found, decisions)


def parted(whole: Found, sizes: Sequence[int]) -> list[Found]:
    """Part what was found about the objects of several sheets; a pair of neighbours belongs where its first object is.

    sizes : how many of the objects, in order, each sheet has
    """
    out, start = [], 0
    for size in sizes:
        mine = whole.assessments[start : start + size]
        start += size
        # In order, so that the same is stored as the same bytes.
        numbers = dict.fromkeys(a.scene.item.object_number for a in mine)
        wished = None if whole.wishes is None else tuple(w for w in whole.wishes if w.object_number in numbers)
        out.append(
            Found(
                assessments=mine,
                wishes=wished,
                spacings=tuple(s for s in whole.spacings if s.first in numbers),
                needing={number: whole.needing[number] for number in numbers if number in whole.needing},
            )
        )
    return out


def stand(head: RunRecord, found: Found, errand: Errand) -> tuple[Standing, ...]:
    """Return the decisions about the objects of a sheet, with what is to be doubted."""
    if not errand.decisions:
        return ()
    at = now(found.assessments, head, errand.digests, lambda number, digest: errand.changed[number, digest])
    return standing(sorted(errand.decisions, key=lambda d: d.id), at)


def left_aside(brief: Brief, errand: Errand, faults: list[Fault]) -> Found:
    """Return objects that are not on display as what they are, with nothing found about them.

    faults : what Kouros fails on is added
    """
    items = read_packed(errand.records)
    objects = placed_each(brief, brief.storeys[errand.floor], items, by_object(errand.decisions))
    assessments = (
        Assessment(one.scene, (), ()) if isinstance(one, Placed) else failed_on(item, one, faults)[0]
        for item, one in zip(items, objects, strict=True)
    )
    return Found(tuple(replace(a, aside=True) for a in assessments), wishes=() if brief.surveyed else None)
