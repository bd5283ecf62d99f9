"""Assessment of objects on one floor: each is placed, run, judged and advised, alike ones once.

What Kouros fails on costs one object its answer (see `pipeline.analysis.faults`).
"""

from collections.abc import Hashable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter
from time import perf_counter
from typing import TYPE_CHECKING

from pipeline.analysis.assess import assess
from pipeline.analysis.classify import classify, object_classes
from pipeline.analysis.context import Context
from pipeline.analysis.faults import Fault, apart, each_apart, fault, unassessed
from pipeline.analysis.fragility.objects import fragilities
from pipeline.analysis.house.matching import HouseRules
from pipeline.analysis.likelihood.analyses import computed, scenes_by_class
from pipeline.analysis.likelihood.sampling import ACTS
from pipeline.analysis.likelihood.stripes import sampled_fragilities
from pipeline.analysis.response_charts import ChartCache
from pipeline.analysis.rule_table import RuleTable
from pipeline.analysis.survey import measurement_requests, telling_requests
from pipeline.analysis.verdicts import LevelMotions
from pipeline.collection.record import INDIVIDUAL
from pipeline.mitigate import MeasureCatalogue, advise
from pipeline.mitigate.by_class import for_every_class
from pipeline.mitigate.installed import InstalledMeasure, Placed, PlacedAs, assess_above, likely, placed, stood_of
from pipeline.mitigate.isolation import TransmittedMotions
from pipeline.mitigate.proposals import case_of
from pipeline.mitigate.trials import HarmAim
from pipeline.models import model_named
from pipeline.night.floors import Floor
from pipeline.records import (
    ITEM_FIELDS,
    Assessment,
    Decision,
    DecisionKind,
    Finding,
    Fragility,
    Item,
    Likelihood,
    MeasurementRequest,
    Numerics,
    Recommendation,
    Sampling,
    Scene,
    Support,
)
from pipeline.records.numerics import AUTO

if TYPE_CHECKING:
    from pipeline.night.context import RunContext

# The classification, whose result is a part of the scene, looks at titles; neighbours are looked at afterwards.
_shared = attrgetter(*(name for name in ITEM_FIELDS if name not in (*INDIVIDUAL, "title")))


@dataclass(frozen=True, slots=True)
class Assessed:
    """One object with everything that was found about it, without its neighbours.

    Attributes
    ----------
    assessment
        What was found.
    needing
        By name of the model, for how many of its analyses any history was run.
    wishes
        What is worth measuring on it; None where the run does not ask.
    """

    assessment: Assessment
    needing: Mapping[str, int]
    wishes: tuple[MeasurementRequest, ...] | None = None


def place(
    item: Item,
    rules: RuleTable | None,
    decisions: Sequence[Decision],
    measures: MeasureCatalogue | None = None,
    house: HouseRules | None = None,
    *,
    assessed: bool = True,
) -> Placed:
    """Return an object as people say that it is and stands: of the class decided, with the measures installed.

    Parameters
    ----------
    decisions : sequence of Decision
        Those in force about it.
    measures : MeasureCatalogue or None, optional
        What the museum has; None: Kouros's own.
    house : HouseRules or None, optional
        What the museum states once for many objects; None: nothing.
    assessed : bool, optional
        Whether anything is found of it, so that what else it may be counts.

    Returns
    -------
    Placed
    """
    scene = classify(item, rules, decided_class(decisions), house)
    there = [InstalledMeasure(d.measure, d.parameters, d.by) for d in decisions if d.kind is DecisionKind.INSTALLED]
    may_be = tuple(
        PlacedAs(classes, chance, placed(as_such, there, measures))
        for classes, chance, as_such in (scenes_by_class(scene, rules, house) if assessed else ())
    )
    return replace(placed(scene, there, measures), may_be=may_be)


def decided_class(decisions: Sequence[Decision]) -> tuple[str, str] | None:
    """Return the class that people gave an object, and who did; None where nobody did, or it is no class any more."""
    classes = [d for d in decisions if d.kind is DecisionKind.CLASS and d.object_class in object_classes()]
    return (classes[-1].object_class, classes[-1].by) if classes else None


def assess_objects(
    context: "RunContext", floor: Floor, items: Sequence[Item], decisions: Sequence[Decision], working: Context
) -> tuple[list[Assessed], float, list[Fault]]:
    """Run everything that objects on one floor require under its motions, judge it and advise.

    Parameters
    ----------
    context
        Of the run.
    floor
        That they stand on.
    items
        Their records.
    decisions
        Those in force: classes and installed measures change what is run.
    working
        Where it runs, with the histories that were run before of what is worked on together.

    Returns
    -------
    assessed : list of Assessed
        Of each object.
    seconds : float
        What finding out what is worth measuring cost [s].
    faults : list of Fault
        What Kouros failed on.
    """
    about = by_object(decisions)
    faults: list[Fault] = []
    objects = placed_each(context, floor, items, about)
    sound = [one for one in objects if isinstance(one, Placed)]
    likes = _likes(sound, about)
    first: dict[Hashable, Placed] = {}
    for like, one in zip(likes, sound, strict=True):
        first.setdefault(like, one)
    known, seconds = _found(context, floor, first, working, faults)
    pairs = iter(zip(likes, sound, strict=True))
    out = []
    for item, placed_one in zip(items, objects, strict=True):
        if isinstance(placed_one, Exception):
            out.append(Assessed(failed_on(item, placed_one, faults), {}, () if context.surveyed else None))
            continue
        like, one = next(pairs)
        out.append(known[like] if first[like] is one else _as_own(one.scene, known[like]))
    return out, seconds, faults


def _found(
    context: "RunContext",
    floor: Floor,
    objects: Mapping[Hashable, Placed],
    working: Context,
    faults: list[Fault],
) -> tuple[dict[Hashable, Assessed], float]:
    """Return what is found of some objects of which none is like another, and the seconds that the survey cost."""
    every = [
        (failed_on(one.scene, came, faults), {}) if isinstance(came, Exception) else came
        for one, came in zip(
            objects.values(), each_assessed(context, floor, list(objects.values()), working), strict=True
        )
    ]
    assessments = tuple(assessment for assessment, _ in every)
    asked: dict[str, list[MeasurementRequest]] = {}
    began = perf_counter()
    if context.surveyed:
        numerics = context.analysis.numerics
        # Each trial is asked once: a chart would not pay.
        uncharted = Context(working.executor, charts=ChartCache(admitted=frozenset()))
        finely = numerics if numerics.fidelity == AUTO else numerics.integrated
        chances = {one.scene.item.object_number: one.likelihoods for one in assessments}

        def asked_of(scenes: Sequence[Scene], findings: Sequence[Sequence[Finding]]) -> Sequence[MeasurementRequest]:
            if context.sampling.samples:
                return telling_requests(scenes, [chances[scene.item.object_number] for scene in scenes])
            return measurement_requests(scenes, findings, floor.shaking, uncharted, finely)

        told = "what is worth measuring on it is not known"
        assessments, several = each_apart(assessments, asked_of, told, faults)
        for wish in several:
            asked.setdefault(wish.object_number, []).append(wish)
    seconds = 0.0 if context.sampling.samples or not context.surveyed else perf_counter() - began
    found = {}
    for like, assessment, (_, needing) in zip(objects, assessments, every, strict=True):
        mine = tuple(asked.get(assessment.scene.item.object_number, ())) if context.surveyed else None
        found[like] = Assessed(assessment, needing, mine)
    return found, seconds


def _likes(objects: Sequence[Placed], about: Mapping[str, Sequence[Decision]]) -> list[Hashable]:
    """Return of each object what it shares with those that are alike; its place stands for one of its own kind."""
    likes: list[Hashable] = []
    for at, one in enumerate(objects):
        like = None if one.scene.item.object_number in about else likeness(one)
        likes.append(at if like is None else like)
    return likes


def likeness(one: Placed) -> Hashable | None:
    """Return what objects that are alike share; None for one whose company counts.

    That is one that stands in a case, whose measures are for all in it, or on an isolator.
    """
    scene = one.scene
    if scene.item.case.strip() or scene.support is Support.ISOLATED:
        return None
    return (
        *(scene.object_class, scene.rule, scene.support, scene.models, tuple(scene.parameters.items())),
        *(scene.assumptions, scene.missing, scene.floor, scene.hanging, scene.furniture, scene.furniture_origin),
        *(scene.anchorage, scene.statements, scene.mount, scene.mount_origin),
        *_shared(scene.item),
        *((each.classes, each.chance, computed(each.placed.scene)) for each in one.may_be),
    )


def _as_own(scene: Scene, twin: Assessed) -> Assessed:
    """Return what was found of one object as found of another one that is like it."""
    number, gallery, found = scene.item.object_number, scene.item.gallery, twin.assessment
    if found.fault and not found.findings:
        return replace(twin, assessment=unassessed(scene, Fault(number, found.fault, "")))
    same = replace(scene, skipped=found.scene.skipped, missing=found.scene.missing, assumptions=found.scene.assumptions)
    return replace(
        twin,
        assessment=Assessment(
            same,
            tuple(replace(one, object_number=number, gallery=gallery) for one in found.findings),
            tuple(replace(one, object_number=number, gallery=gallery) for one in found.recommendations),
            tuple(replace(one, object_number=number) for one in found.fragilities),
            found.fault,
            likelihoods=found.likelihoods,
        ),
    )


def by_object(decisions: Iterable[Decision]) -> dict[str, list[Decision]]:
    """Return decisions by the number of the object that they are about."""
    about: dict[str, list[Decision]] = {}
    for decision in decisions:
        about.setdefault(decision.object_number, []).append(decision)
    return about


def placed_each(
    context: "RunContext",
    floor: Floor,
    items: Sequence[Item],
    about: Mapping[str, Sequence[Decision]],
    *,
    assessed: bool = True,
) -> list[Placed | Exception]:
    """Return each object as it stands, or the error that placing it came to.

    Parameters
    ----------
    assessed : bool, optional
        Whether anything is found of them.

    Returns
    -------
    list of Placed | Exception
    """
    rules, measures, house = context.rules, context.measures, context.house

    def some(these: Sequence[Item]) -> list[Placed]:
        objects = [
            place(item, rules, about.get(item.object_number, ()), measures, house, assessed=assessed) for item in these
        ]
        return [replace(one, scene=replace(one.scene, floor=floor.name)) for one in objects]

    return apart(some, items, lambda item: item.support)


def failed_on(item: Item | Scene, problem: Exception, faults: list[Fault]) -> Assessment:
    """Return what is said of an object that Kouros failed on."""
    told = fault(item if isinstance(item, Item) else item.item, problem)
    faults.append(told)
    return unassessed(item, told)


def left_aside(
    context: "RunContext", floor: Floor, items: Sequence[Item], decisions: Sequence[Decision]
) -> tuple[list[Assessed], float, list[Fault]]:
    """Return objects that are not on display as what they are, with nothing found about them.

    Parameters and what is returned are those of `assess_objects`.
    """
    faults: list[Fault] = []
    objects = placed_each(context, floor, items, by_object(decisions), assessed=False)
    assessments = [
        Assessment(one.scene, (), ()) if isinstance(one, Placed) else failed_on(item, one, faults)
        for item, one in zip(items, objects, strict=True)
    ]
    asked = () if context.surveyed else None
    return [Assessed(replace(one, aside=True), {}, asked) for one in assessments], 0.0, faults


def each_assessed(
    context: "RunContext", floor: Floor, objects: Sequence[Placed], working: Context
) -> list[tuple[Assessment, dict[str, int]] | Exception]:
    """Return what is found of each object, or the error that finding it came to."""
    return apart(
        lambda some: _assessed(context, floor, some, working),
        objects,
        lambda one: (one.scene.object_class, one.scene.support),
        # What is advised for a case depends on all that stand in it.
        lambda one: case_of(one.scene),
    )


def _assessed(
    context: "RunContext", floor: Floor, objects: Sequence[Placed], working: Context
) -> list[tuple[Assessment, dict[str, int]]]:
    """Run everything that objects require, judge it and advise."""
    if not objects:
        return []
    scenes = [one.scene for one in objects]
    levels, numerics = floor.shaking, context.analysis.numerics
    needing: list[dict[str, int]] = [{} for _ in scenes]
    plan, findings = assess(scenes, levels, working, numerics, needing=needing)
    # Few objects stand on isolators, each on its own: neither charts nor bounds of what these pass on would pay.
    above = assess_above(objects, levels, Context(working.executor), numerics.integrated)
    for at, (on_top, left_out) in enumerate(above):
        findings[at] += on_top
        done = {finding.title for finding in findings[at]}
        skipped = {title: why for title, why in {**plan.skipped[at], **left_out}.items() if title not in done}
        scenes[at] = replace(scenes[at], skipped=skipped)
    chances, advice = advised(
        objects, scenes, findings, levels, working, numerics, context.sampling, context.measures, context.transmitted
    )
    curves: Sequence[tuple[Fragility, ...]] = [()] * len(scenes)
    if context.fragile and context.sampling.samples:
        shown = [s.item.on_display for s in scenes]
        curves = sampled_fragilities(
            stood_of(objects),
            len(objects),
            floor.stripes,
            floor.x_azimuth,
            context.sampling,
            working.executor,
            chosen=shown,
            told=floor.hazard,
        )
    elif context.fragile:
        shown = [s.item.on_display and _has_a_curve(s) for s in scenes]
        alone = Context(working.executor)
        curves = fragilities(scenes, plan.work, floor.stripes, alone, chosen=shown, told=floor.hazard)
    scenes = [_needing(scene, those) for scene, those in zip(scenes, findings, strict=True)]
    return [
        (Assessment(scene, tuple(those), tuple(advised), curve, likelihoods=chance), counts)
        for scene, those, advised, curve, counts, chance in zip(
            scenes, findings, advice, curves, needing, chances, strict=True
        )
    ]


def advised(
    objects: Sequence[Placed],
    scenes: Sequence[Scene],
    findings: Sequence[Sequence[Finding]],
    levels: Sequence[LevelMotions],
    working: Context,
    numerics: Numerics,
    sampling: Sampling,
    measures: MeasureCatalogue,
    transmitted: TransmittedMotions | None = None,
) -> tuple[Sequence[tuple[Likelihood, ...]], list[list[Recommendation]]]:
    """Return how likely objects come to harm, and what is advised for them: by that, or else by verdicts.

    Parameters
    ----------
    objects : sequence of Placed
        As they stand, with their scenes and what was found of them under these levels.
    sampling : Sampling
        No samples where nobody asks how likely harm is.

    Returns
    -------
    tuple[Sequence[tuple[Likelihood, ...]], list[list[Recommendation]]]
    """
    if not sampling.samples:
        advice = advise(scenes, findings, levels, working, numerics, catalogue=measures, transmitted=transmitted)
        return [()] * len(scenes), advice
    chances = likely(objects, levels, sampling, working)
    aim = HarmAim(sampling.edges[ACTS], sampling)
    advice = advise(
        scenes,
        findings,
        levels,
        working,
        numerics,
        catalogue=measures,
        transmitted=transmitted,
        chances=chances,
        aim=aim,
    )
    return chances, for_every_class(objects, advice, levels, working, aim, measures)


def _has_a_curve(scene: Scene) -> bool:
    # What an isolator passes on would have to be scaled too; of a work of which nobody knows how it hangs, nobody knows
    # how it fails at any shaking.
    return scene.support is not Support.ISOLATED and (scene.support is not Support.HUNG or scene.hanging is not None)


def _needing(scene: Scene, findings: Sequence[Finding]) -> Scene:
    """Say what is missing where none of an object's models could be run."""
    if findings or scene.missing:
        return scene
    titles = [model_named(name).title for name in scene.models]
    reasons = dict.fromkeys(scene.skipped[title] for title in titles if title in scene.skipped)
    return replace(
        scene, missing=(f"what its models need: {'; '.join(reasons) or 'none applies to it as it is held'}",)
    )
