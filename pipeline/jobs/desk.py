"""What is done for one sheet, wherever it is done: find, judge, advise, and draw.

A `Brief` holds what all sheets of a run share and goes once to whoever works; an `Errand` is one sheet.  What comes
back depends on these two alone: the same on this machine and on another, whoever did what before.
"""

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from hashlib import sha256
from pathlib import Path
from time import perf_counter
from typing import Any

from pipeline.assess import assess
from pipeline.charting import Shelf
from pipeline.classify import classify, object_classes
from pipeline.collection.catalogue import read_packed
from pipeline.execute import Threads
from pipeline.execute.memory import give_back
from pipeline.fragility.objects import fragilities
from pipeline.jobs.doubts import now, standing
from pipeline.jobs.faults import Fault, apart, each_apart, fault, fitting, unassessed
from pipeline.jobs.levels import Storey
from pipeline.jobs.twins import Known, Twins, as_own, likeness
from pipeline.jobs.workspace import HISTORIES
from pipeline.mitigate import Means, advise
from pipeline.mitigate.bench import Carriage
from pipeline.mitigate.installed import Measure, Placed, assess_above, placed
from pipeline.models import model_named
from pipeline.neighbours import neighbours
from pipeline.records import (
    Assessment,
    Decision,
    DecisionKind,
    Finding,
    Found,
    Fragility,
    Item,
    Motion,
    RunRecord,
    Scene,
    Sheet,
    Silent,
    Standing,
    Support,
    Wish,
)
from pipeline.report.language import language
from pipeline.report.sheets import Drawn, Pen
from pipeline.report.tallies import tally
from pipeline.report.units import Units
from pipeline.response import deciding, response_chart
from pipeline.rules import Table
from pipeline.settings import Analysis
from pipeline.store.parcels import Parcel
from pipeline.store.results import Encoded, encode, unpacked
from pipeline.survey import in_order, wishes


@dataclass
class Brief:
    """What all sheets of a run share.

    head      : the run without its objects: its motions and its charts, what pages say of it
    storeys   : the floors by name
    surveyed, fragile : whether to find out what is worth measuring, and from what shaking objects fail
    stores    : whether what is not on display is assessed too
    admitted  : which response charts are built (see `pipeline.charting.Shelf`); None: those that pay for a sheet
    kept      : folder in which charts are kept; None: in memory only
    threads   : of one who works
    """

    head: RunRecord
    storeys: Mapping[str, Storey]
    analysis: Analysis
    rules: Table | None
    means: Means
    surveyed: bool
    fragile: bool
    stores: bool = False
    admitted: frozenset[str] | None = None
    kept: Path | None = None
    threads: int = 1
    units: Units = field(default_factory=Units)
    tongue: str = "en"
    catalogues: Path | None = None

    def __getstate__(self) -> dict[str, Any]:
        # What was made on the way is made again where it is needed.
        made = {"shelf", "carriage", "pen", "executor", "twins"}
        return {name: value for name, value in self.__dict__.items() if name not in made}

    @property
    def motions(self) -> dict[str, Motion]:
        """The motions in use, by hash."""
        return motions_of(self.storeys)

    @cached_property
    def shelf(self) -> Shelf:
        """The response charts."""
        return Shelf(self.kept, admitted=self.admitted)

    def memory(self, *batch: object) -> Path | None:
        """Return the file in which the histories of what is worked on together are kept from night to night.

        batch : what is the same every night, such as gallery and number of its sheets
        """
        if self.kept is None:
            return None
        name = repr(batch).encode("utf-8", "surrogatepass")
        return self.kept.parent / HISTORIES / f"{sha256(name).hexdigest()[:32]}.npz"

    @cached_property
    def carriage(self) -> Carriage:
        """What isolators pass on, once for all sheets."""
        return Carriage()

    @cached_property
    def twins(self) -> Twins:
        """What was found of objects that others may be like."""
        return Twins()

    @cached_property
    def executor(self) -> Threads:
        """Where the parts of a sheet's work run."""
        return Threads(self.threads)

    @cached_property
    def pen(self) -> Pen:
        """What draws the sheets.

        raises : ReportError for a language without a catalogue
        """
        return Pen(self.head, self.units, language(self.tongue, self.catalogues))


def motions_of(storeys: Mapping[str, Storey]) -> dict[str, Motion]:
    """Return the motions of some floors by hash; one that several share is there once."""
    return {m.motion.hash: m.motion for storey in storeys.values() for level in storey.levels for m in level.motions}


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
    """Put a chart on the shelf, where it is not there yet, so that all who work find it."""
    given: dict[str, Any] = {name: value for name, value in errand.alike.items() if value == value}  # noqa: PLR0124 - NaN: not given
    response_chart(
        errand.model,
        errand.motion,
        angle=errand.angle,
        azimuth_step=brief.analysis.azimuth_step,
        charts=brief.shelf,
        **deciding(errand.model),
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
    for kind, one in zip(errand.kinds, _placed(brief, storey, read_packed(errand.records), {}), strict=True):
        like = likeness(one.scene) if isinstance(one, Placed) else None
        if like is None or not isinstance(one, Placed):
            continue
        if first.setdefault(like, kind) == kind:
            chosen[kind] = one
        else:
            same[kind] = first[like]
    with brief.shelf.remembering(brief.memory("kinds", errand.floor, errand.part)):
        known = _each_assessed(brief, storey, list(chosen.values()))
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

    What Kouros fails on costs the object its answer, and is told (see `pipeline.jobs.faults`).
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
        with brief.shelf.remembering(brief.memory(*sheets)):
            whole, seconds, failed = find(brief, brief.storeys[floor], everything, decisions, twins)
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


def place(item: Item, rules: Table | None, decisions: Sequence[Decision]) -> Placed:
    """Return an object as people say that it is and stands: of the class decided, with the measures installed.

    decisions : those in force about it
    """
    classes = [d for d in decisions if d.kind is DecisionKind.CLASS and d.object_class in object_classes()]
    scene = classify(item, rules, (classes[-1].object_class, classes[-1].by) if classes else None)
    measures = [Measure(d.measure, d.parameters, d.by) for d in decisions if d.kind is DecisionKind.INSTALLED]
    return placed(scene, measures)


def find(
    brief: Brief, storey: Storey, items: Sequence[Item], decisions: Sequence[Decision], twins: Twins
) -> tuple[Found, float, list[Fault]]:
    """Run everything that objects on one floor require under its motions, judge it and advise.

    decisions : those in force: classes and installed measures change what is run
    twins     : what is known of objects that these may be like
    returns   : what was found, the seconds that finding out what is worth measuring cost, and what Kouros failed on
    """
    about = _by_object(decisions)
    faults: list[Fault] = []
    objects = _placed(brief, storey, items, about)
    sound = [one for one in objects if isinstance(one, Placed)]
    decided = [one.scene.item.object_number in about for one in sound]
    known = iter(_known(brief, storey, sound, decided, twins, faults))
    every = [
        next(known) if isinstance(one, Placed) else _failed(item, one, faults)
        for item, one in zip(items, objects, strict=True)
    ]
    assessments = tuple(assessment for assessment, _ in every)
    began = perf_counter()
    wished: tuple[Wish, ...] | None = None
    if brief.surveyed:
        fidelity, step = _integrating(brief), brief.analysis.azimuth_step
        # Each trial is asked once: a chart would not pay.
        assessments, asked = each_apart(
            assessments,
            lambda scenes, found: wishes(
                scenes, found, storey.shaking, brief.executor, Silent(), fidelity=fidelity, azimuth_step=step
            ),
            "what is worth measuring on it is not known",
            faults,
        )
        wished = tuple(in_order(asked))
    seconds = perf_counter() - began if brief.surveyed else 0.0
    assessments, spacings = each_apart(
        assessments,
        lambda scenes, found: neighbours(scenes, found, storey.shaking),
        "how near its neighbours come is not known",
        faults,
    )
    needing = {a.scene.item.object_number: counts for a, counts in every if counts}
    return Found(assessments, wished, tuple(spacings), needing), seconds, faults


def left_aside(brief: Brief, errand: Errand, faults: list[Fault]) -> Found:
    """Return objects that are not on display as what they are, with nothing found about them.

    faults : what Kouros fails on is added
    """
    items = read_packed(errand.records)
    objects = _placed(brief, brief.storeys[errand.floor], items, _by_object(errand.decisions))
    assessments = (
        Assessment(one.scene, (), ()) if isinstance(one, Placed) else _failed(item, one, faults)[0]
        for item, one in zip(items, objects, strict=True)
    )
    return Found(tuple(replace(a, aside=True) for a in assessments), wishes=() if brief.surveyed else None)


def _by_object(decisions: Iterable[Decision]) -> dict[str, list[Decision]]:
    about: dict[str, list[Decision]] = {}
    for decision in decisions:
        about.setdefault(decision.object_number, []).append(decision)
    return about


def _placed(
    brief: Brief, storey: Storey, items: Sequence[Item], about: Mapping[str, Sequence[Decision]]
) -> list[Placed | Exception]:
    """Return each object as it stands, or the error that placing it came to."""

    def some(these: Sequence[Item]) -> list[Placed]:
        objects = [place(item, brief.rules, about.get(item.object_number, ())) for item in these]
        return [replace(one, scene=replace(one.scene, floor=storey.name)) for one in objects]

    return apart(some, items, lambda item: item.support)


def _failed(item: Item | Scene, problem: Exception, faults: list[Fault]) -> Known:
    """Return what is said of an object that Kouros failed on."""
    told = fault(item if isinstance(item, Item) else item.item, problem)
    faults.append(told)
    return unassessed(item, told), {}


def _each_assessed(brief: Brief, storey: Storey, objects: Sequence[Placed]) -> list[Known | Exception]:
    """Return what is found of each object, or the error that finding it came to."""
    return apart(
        lambda some: _assessed(brief, storey, some),
        objects,
        lambda one: (one.scene.object_class, one.scene.support),
        # What is advised for a case depends on all that stand in it.
        lambda one: (one.scene.item.gallery, one.scene.item.case) if one.scene.item.case.strip() else None,
    )


def _integrating(brief: Brief) -> str:
    return "reference" if brief.analysis.fidelity == "reference" else "history"


def _known(
    brief: Brief, storey: Storey, objects: Sequence[Placed], decided: Sequence[bool], twins: Twins, faults: list[Fault]
) -> list[Known]:
    """Return what is found of each object, where several are alike that of the first."""
    likes: list[Hashable] = []
    for at, (one, mine) in enumerate(zip(objects, decided, strict=True)):
        like = None if mine else likeness(one.scene)
        # Its place, which nothing else has, stands for an object of its own kind.
        likes.append(at if like is None else like)
    known = {like: before for like in likes if (before := twins.get(like)) is not None}
    fresh: dict[Hashable, int] = {}
    for at, like in enumerate(likes):
        if like not in known:
            fresh.setdefault(like, at)
    own = _each_assessed(brief, storey, [objects[at] for at in fresh.values()])
    for (like, at), came in zip(fresh.items(), own, strict=True):
        if isinstance(came, Exception):
            known[like] = _failed(objects[at].scene, came, faults)
            continue
        known[like] = came
        if not isinstance(like, int):
            twins.note(like, *came)
    out = []
    for at, (like, one) in enumerate(zip(likes, objects, strict=True)):
        assessment, needing = known[like]
        out.append((assessment if fresh.get(like) == at else as_own(one.scene, assessment), needing))
    return out


def _assessed(brief: Brief, storey: Storey, objects: Sequence[Placed]) -> list[Known]:
    """Run everything that objects require, judge it and advise."""
    if not objects:
        return []
    told = Silent()
    scenes = [one.scene for one in objects]
    levels, executor = storey.shaking, brief.executor
    fidelity, step = brief.analysis.fidelity, brief.analysis.azimuth_step
    needing: list[dict[str, int]] = [{} for _ in scenes]
    plan, findings = assess(
        scenes, levels, executor, told, fidelity=fidelity, azimuth_step=step, charts=brief.shelf, needing=needing
    )
    # Few objects stand on isolators, each on its own: neither charts nor bounds of what these pass on would pay.
    above = assess_above(objects, levels, executor, told, fidelity=_integrating(brief), azimuth_step=step)
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
        told,
        means=brief.means,
        fidelity=fidelity,
        azimuth_step=step,
        charts=brief.shelf,
        carriage=brief.carriage,
    )
    curves: Sequence[tuple[Fragility, ...]] = [()] * len(scenes)
    if brief.fragile:
        # What an isolator passes on would have to be scaled too.
        shown = [s.item.on_display and s.support is not Support.ISOLATED for s in scenes]
        curves = fragilities(scenes, plan.work, storey.stripes, executor, told, chosen=shown)
    scenes = [_needing(scene, those) for scene, those in zip(scenes, findings, strict=True)]
    return [
        (Assessment(scene, tuple(those), tuple(advised), curve), counts)
        for scene, those, advised, curve, counts in zip(scenes, findings, advice, curves, needing, strict=True)
    ]


def _needing(scene: Scene, findings: Sequence[Finding]) -> Scene:
    """Say what is missing where none of an object's models could be run."""
    if findings or scene.missing:
        return scene
    titles = [model_named(name).title for name in scene.models]
    reasons = dict.fromkeys(scene.skipped[title] for title in titles if title in scene.skipped)
    return replace(
        scene, missing=(f"what its models need: {'; '.join(reasons) or 'none applies to it as it is held'}",)
    )
