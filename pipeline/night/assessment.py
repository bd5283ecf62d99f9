"""What is found about objects on one floor: each is placed, run, judged and advised, alike ones once.

What Kouros fails on costs one object its answer (see `pipeline.analysis.faults`).
"""

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import replace
from time import perf_counter

from pipeline.analysis.assess import assess
from pipeline.analysis.classify import classify, object_classes
from pipeline.analysis.context import Context
from pipeline.analysis.faults import Fault, apart, each_apart, fault, unassessed
from pipeline.analysis.fragility.objects import fragilities
from pipeline.analysis.neighbours import neighbours
from pipeline.analysis.rules import Table
from pipeline.analysis.survey import in_order, measurement_requests
from pipeline.mitigate import advise
from pipeline.mitigate.installed import Measure, Placed, assess_above, placed
from pipeline.models import model_named
from pipeline.night.context import Brief
from pipeline.night.deduplication import Known, Twins, as_own, likeness
from pipeline.night.floors import Storey
from pipeline.records import (
    Assessment,
    Decision,
    DecisionKind,
    Finding,
    Found,
    Fragility,
    Item,
    MeasurementRequest,
    Scene,
    Support,
)


def place(item: Item, rules: Table | None, decisions: Sequence[Decision]) -> Placed:
    """Return an object as people say that it is and stands: of the class decided, with the measures installed.

    decisions : those in force about it
    """
    classes = [d for d in decisions if d.kind is DecisionKind.CLASS and d.object_class in object_classes()]
    scene = classify(item, rules, (classes[-1].object_class, classes[-1].by) if classes else None)
    measures = [Measure(d.measure, d.parameters, d.by) for d in decisions if d.kind is DecisionKind.INSTALLED]
    return placed(scene, measures)


def find(
    brief: Brief,
    storey: Storey,
    items: Sequence[Item],
    decisions: Sequence[Decision],
    twins: Twins,
    context: Context,
) -> tuple[Found, float, list[Fault]]:
    """Run everything that objects on one floor require under its motions, judge it and advise.

    decisions : those in force: classes and installed measures change what is run
    twins     : what is known of objects that these may be like
    context   : where it runs, with the histories that were run before of what is worked on together
    returns   : what was found, the seconds that finding out what is worth measuring cost, and what Kouros failed on
    """
    about = by_object(decisions)
    faults: list[Fault] = []
    objects = placed_each(brief, storey, items, about)
    sound = [one for one in objects if isinstance(one, Placed)]
    decided = [one.scene.item.object_number in about for one in sound]
    known = iter(_known(brief, storey, sound, decided, twins, context, faults))
    every = [
        next(known) if isinstance(one, Placed) else failed_on(item, one, faults)
        for item, one in zip(items, objects, strict=True)
    ]
    assessments = tuple(assessment for assessment, _ in every)
    began = perf_counter()
    requests: tuple[MeasurementRequest, ...] | None = None
    if brief.surveyed:
        # Each trial is asked once: a chart would not pay.
        assessments, asked = each_apart(
            assessments,
            lambda scenes, found: measurement_requests(
                scenes, found, storey.shaking, Context(context.executor), brief.analysis.numerics.integrated
            ),
            "what is worth measuring on it is not known",
            faults,
        )
        requests = tuple(in_order(asked))
    seconds = perf_counter() - began if brief.surveyed else 0.0
    assessments, spacings = each_apart(
        assessments,
        lambda scenes, found: neighbours(scenes, found, storey.shaking),
        "how near its neighbours come is not known",
        faults,
    )
    needing = {a.scene.item.object_number: counts for a, counts in every if counts}
    return Found(assessments, requests, tuple(spacings), needing), seconds, faults


def by_object(decisions: Iterable[Decision]) -> dict[str, list[Decision]]:
    """Return decisions by the number of the object that they are about."""
    about: dict[str, list[Decision]] = {}
    for decision in decisions:
        about.setdefault(decision.object_number, []).append(decision)
    return about


def placed_each(
    brief: Brief, storey: Storey, items: Sequence[Item], about: Mapping[str, Sequence[Decision]]
) -> list[Placed | Exception]:
    """Return each object as it stands, or the error that placing it came to."""

    def some(these: Sequence[Item]) -> list[Placed]:
        objects = [place(item, brief.rules, about.get(item.object_number, ())) for item in these]
        return [replace(one, scene=replace(one.scene, floor=storey.name)) for one in objects]

    return apart(some, items, lambda item: item.support)


def failed_on(item: Item | Scene, problem: Exception, faults: list[Fault]) -> Known:
    """Return what is said of an object that Kouros failed on."""
    told = fault(item if isinstance(item, Item) else item.item, problem)
    faults.append(told)
    return unassessed(item, told), {}


def each_assessed(brief: Brief, storey: Storey, objects: Sequence[Placed], context: Context) -> list[Known | Exception]:
    """Return what is found of each object, or the error that finding it came to."""
    return apart(
        lambda some: _assessed(brief, storey, some, context),
        objects,
        lambda one: (one.scene.object_class, one.scene.support),
        # What is advised for a case depends on all that stand in it.
        lambda one: (one.scene.item.gallery, one.scene.item.case) if one.scene.item.case.strip() else None,
    )


def _known(
    brief: Brief,
    storey: Storey,
    objects: Sequence[Placed],
    decided: Sequence[bool],
    twins: Twins,
    context: Context,
    faults: list[Fault],
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
    own = each_assessed(brief, storey, [objects[at] for at in fresh.values()], context)
    for (like, at), came in zip(fresh.items(), own, strict=True):
        if isinstance(came, Exception):
            known[like] = failed_on(objects[at].scene, came, faults)
            continue
        known[like] = came
        if not isinstance(like, int):
            twins.note(like, *came)
    out = []
    for at, (like, one) in enumerate(zip(likes, objects, strict=True)):
        assessment, needing = known[like]
        out.append((assessment if fresh.get(like) == at else as_own(one.scene, assessment), needing))
    return out


def _assessed(brief: Brief, storey: Storey, objects: Sequence[Placed], context: Context) -> list[Known]:
    """Run everything that objects require, judge it and advise."""
    if not objects:
        return []
    scenes = [one.scene for one in objects]
    levels, numerics = storey.shaking, brief.analysis.numerics
    needing: list[dict[str, int]] = [{} for _ in scenes]
    plan, findings = assess(scenes, levels, context, numerics, needing=needing)
    # Few objects stand on isolators, each on its own: neither charts nor bounds of what these pass on would pay.
    above = assess_above(objects, levels, Context(context.executor), numerics.integrated)
    for at, (on_top, left_out) in enumerate(above):
        findings[at] += on_top
        done = {finding.title for finding in findings[at]}
        skipped = {title: why for title, why in {**plan.skipped[at], **left_out}.items() if title not in done}
        scenes[at] = replace(scenes[at], skipped=skipped)
    advice = advise(scenes, findings, levels, context, numerics, means=brief.means, carriage=brief.carriage)
    curves: Sequence[tuple[Fragility, ...]] = [()] * len(scenes)
    if brief.fragile:
        # What an isolator passes on would have to be scaled too.
        shown = [s.item.on_display and s.support is not Support.ISOLATED for s in scenes]
        curves = fragilities(scenes, plan.work, storey.stripes, Context(context.executor), chosen=shown)
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
