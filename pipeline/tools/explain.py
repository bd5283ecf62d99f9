"""Explanation of a verdict on one object: every step from its record to its advice, and nothing stored."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import isnan

from pipeline.analysis.assess import assess, moving
from pipeline.analysis.context import Context
from pipeline.analysis.evidence import leaning
from pipeline.analysis.findings import findings
from pipeline.analysis.furniture import itself, loose
from pipeline.analysis.plan import Work, plan
from pipeline.analysis.refinement import FidelitySearch, examine
from pipeline.analysis.rule_table import RuleTable
from pipeline.analysis.rules import readings
from pipeline.analysis.stakes import Worth, counting, worth_of
from pipeline.analysis.verdicts import LevelMotions, capacity_of
from pipeline.collection.inventory import read_inventory
from pipeline.execute import Threads
from pipeline.mitigate.installed import Placed, assess_above
from pipeline.models import model_named
from pipeline.night.assessment import advised, place
from pipeline.night.floors import floors_with
from pipeline.night.prepare import assessed, popular
from pipeline.night.run import named
from pipeline.operations.workspace import Workspace, charts_of
from pipeline.quantities import Array, figures
from pipeline.records import Estimate, Finding, Item, Likelihood, Numerics, Progress, Recommendation, Scene
from pipeline.records.numerics import AUTO, CHART, SCAN
from pipeline.store.decisions import InForce, decisions_in_force

BEST = "best estimates"
"""What inputs are called that are all by their best estimates."""


@dataclass(frozen=True, slots=True)
class Taken:
    """A step that was taken for one parameter set under one motion.

    Attributes
    ----------
    motion : str
        Its name.
    inputs : str
        Which of the uncertain inputs is at an end of its range, and the direction where it is known.
    step : str
        Bound, chart, or the fidelity that was integrated at: a scan only of the ends of a range.
    low, high : float
        Between these the demand lies, in the capacity's unit; of a chart its value less and plus its error, of a
        history the same.
    error : float or None
        As the chart or the history states it; None of a bound, and of a scan.
    told : str
        What the object does then, where the history tells.
    """

    motion: str
    inputs: str
    step: str
    low: float
    high: float
    error: float | None = None
    told: str = ""


@dataclass(frozen=True, slots=True)
class Reasoning:
    """One model under one level: the steps in the order in which they were taken, and what came of them.

    Attributes
    ----------
    finding : Finding
        What came of them.
    capacity : Estimate
        What the demand is held against.
    taken : tuple of Taken
        None of what stands on an isolator, which is integrated under what that passes on.
    """

    finding: Finding
    capacity: Estimate
    taken: tuple[Taken, ...]


@dataclass(frozen=True, slots=True)
class Explanation:
    """The whole chain of reasoning for one object.

    Attributes
    ----------
    scene, reasonings, advice, likelihoods, worth
        What it is taken for, and what was found.
    leaning : tuple of (str, tuple of (str, float))
        What its class leans on against the next likely one: that one, and signs with the logarithm of the odds.
    """

    scene: Scene
    reasonings: tuple[Reasoning, ...]
    advice: tuple[Recommendation, ...]
    likelihoods: tuple[Likelihood, ...] = ()
    worth: Worth | None = None
    leaning: tuple[tuple[str, tuple[tuple[str, float], ...]], ...] = ()


_SIGNS = 8
"""How many signs of a class are told."""


def explain(workspace: Workspace, number: str, progress: Progress) -> list[Explanation]:
    """Assess one object as a night would, and keep every step; all records of that number, if it has several.

    Parameters
    ----------
    workspace : Workspace
        Whose inventory has the object.
    number : str
        The museum's number of the object.
    progress : callable
        Is told what is done, of how much.

    Returns
    -------
    list of Explanation
        One for each record of that number.

    Raises
    ------
    UsageError
        For an object that the inventory does not have, with close ones.
    KourosError
        As a run does.
    """
    settings = workspace.settings
    everything, inventory = workspace.object_index(), read_inventory(workspace.engine)
    items = named(inventory, objects=(number,))
    site = workspace.site()
    executor, decisions = Threads(settings.analysis.workers or None), decisions_in_force(workspace.engine)
    out = []
    for floor in floors_with(settings, site, items):
        levels = floor.shaking
        # The charts that a night uses, so that the reasons are those of the night.
        asked = assessed(everything.objects, settings.display.stores)
        charted = popular(everything, asked, workspace.rules, workspace.measures, floor.x_azimuth, workspace.house)
        with charts_of(settings, [m.hash for level in levels for m in level.motions], charted) as charts:
            context = Context(executor, progress, charts)
            for index in floor.members:
                one = _placed(workspace, items[index], decisions)
                one = replace(one, scene=replace(one.scene, floor=floor.name))
                # What is advised for a case depends on all that stand in it.
                others = [_placed(workspace, other, decisions) for other in _neighbours(items[index], inventory)]
                out.append(_explain(one, others, levels, workspace, context))
    return out


def _placed(workspace: Workspace, item: Item, decisions: InForce) -> Placed:
    return place(item, workspace.rules, decisions.get(item.object_number, ()), workspace.measures, workspace.house)


def _neighbours(item: Item, inventory: Sequence[Item]) -> list[Item]:
    where = (item.gallery, item.case)
    # As on a night, where what is not on display is no company of what is.
    company = [other for other in inventory if item.case and other.on_display == item.on_display]
    return [other for other in company if other != item and (other.gallery, other.case) == where]


def _explain(
    one: Placed,
    others: Sequence[Placed],
    levels: Sequence[LevelMotions],
    workspace: Workspace,
    context: Context,
) -> Explanation:
    numerics = workspace.settings.analysis.numerics
    todo = plan([one.scene], levels[0].x_azimuth)
    reasonings = [_reason(work, one.scene, level, context, numerics) for level in levels for work in todo.work]
    if loose(one.scene) and reasonings:
        body = itself(one.scene)
        its = plan([body], levels[0].x_azimuth)
        of_it = [_reason(work, body, level, context, numerics) for level in levels for work in its.work]
        reasonings += [replace(r, finding=moving(r.finding, one.scene, levels)) for r in of_it]
    on_top = [assess_above([each], levels, context, numerics.integrated)[0] for each in (one, *others)]
    if one.above is not None:
        above = one.above
        reasonings += [Reasoning(f, capacity_of(model_named(f.model), above)[1], ()) for f in on_top[0][0]]
    done = {r.finding.title for r in reasonings}
    left_out = {title: why for title, why in {**todo.skipped[0], **on_top[0][1]}.items() if title not in done}
    scene = replace(one.scene, skipped=left_out)
    scenes = [scene, *(other.scene for other in others)]
    around = assess(scenes[1:], levels, context, numerics)[1] if others else []
    found = [
        [r.finding for r in reasonings],
        *([*own, *above_it] for own, (above_it, _) in zip(around, on_top[1:], strict=True)),
    ]
    sampling = workspace.settings.likelihood.sampling
    chances, advice = advised((one, *others), scenes, found, levels, context, numerics, sampling, workspace.measures)
    with counting(workspace.settings.museum.value_per_c):
        worth = worth_of(scene)
    return Explanation(scene, tuple(reasonings), tuple(advice[0]), chances[0], worth, _leaning(scene, workspace.rules))


def _leaning(scene: Scene, rules: RuleTable | None) -> tuple[tuple[str, tuple[tuple[str, float], ...]], ...]:
    """Return what the class leans on against the next one; nothing where people or one rule decided."""
    second = next((name for name, _ in scene.chances if name != scene.object_class), None)
    if second is None:
        return ()
    return ((second, leaning(scene.item, readings(scene.item, rules), scene.object_class, second)[:_SIGNS]),)


def _reason(work: Work, scene: Scene, level: LevelMotions, context: Context, numerics: Numerics) -> Reasoning:
    bounds: list[Mapping[str, tuple[Array, Array]]] = []

    def watch(search: FidelitySearch) -> None:
        for found in search.found:
            found.trail = []
            bounds.append({output: (low.copy(), found.high[output].copy()) for output, low in found.low.items()})

    examined = examine(work, [scene], level, context, numerics, watch=watch)
    ((case, known),) = examined.cases
    (finding,) = findings(examined.search, case, known, [scene])
    names = _named(work)
    taken = []
    for found, bound in zip(examined.search.found, bounds, strict=True):
        low, high = bound[case.output]
        exact = work.model.exact and case.output == work.model.demand
        no_error = exact or work.model.output(case.output).unit == "bool"
        for row in dict.fromkeys(work.spans.rows.ravel().tolist()):
            # Only `auto` asks for bounds besides certificates.
            if numerics.fidelity == AUTO or low[row] == high[row]:
                taken.append(Taken(found.motion.name, names[row], "bound", float(low[row]), float(high[row])))
        for fidelity, rows, columns in found.trail or ():
            for at, row in enumerate(rows.tolist()):
                # Where the certificate is the demand, a history only tells what happens after.
                value = float(low[row]) if exact else float(columns[case.output][at])
                error = 0.0 if no_error else float(columns[work.model.error_of(case.output)][at])
                off = error if fidelity == CHART else 0.0
                one = {name: float(column[at]) for name, column in columns.items()}
                told = work.model.outcome(one, {name: float(v[row]) for name, v in work.values.items()})[1]
                stated = None if fidelity == SCAN else error
                taken.append(Taken(found.motion.name, names[row], fidelity, value - off, value + off, stated, told))
    return Reasoning(finding, case.estimates[0], tuple(taken))


def _named(work: Work) -> list[str]:
    """Say of each parameter set of one object in what it differs from the best estimates."""
    spans = work.spans
    names = [""] * work.size
    for side in range(spans.rows.shape[1]):
        best = int(spans.rows[0, side])
        for row in spans.rows[:, side].tolist():
            other = [
                f"{name} = {figures(float(column[row]), 4)}" for name, column in work.values.items()
                if column[row] != column[best] and not isnan(column[row])
            ]  # fmt: skip
            angle = float(work.angles[row])
            where = [] if isnan(angle) else [f"along {angle:.0f} degrees"]
            names[row] = ", ".join([*(other or [BEST]), *where])
    return names
