"""Scenes x motions -> demands -> findings: each demand against its capacity, with a number for how sure we are."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pipeline import __version__
from pipeline.charting import SHELF, Shelf
from pipeline.plan import Plan, Work, plan
from pipeline.quantities import Array
from pipeline.records import (
    Columns,
    Estimate,
    Executor,
    Finding,
    Mark,
    Model,
    Motion,
    Origin,
    Progress,
    Scene,
    Verdict,
)
from pipeline.response import look_up, run_model

CHUNK = 96
"""Parameter sets in one task: small enough to share between workers, large enough to make the task worth its call."""


@dataclass(frozen=True)
class LevelMotions:
    """The motions of one level of the site, and how their demands are combined ("max" or "mean")."""

    name: str
    combine: str
    motions: tuple[Motion, ...]

    def combined(self, each: Sequence[float] | Array) -> float:
        """Return the demand of the level from that under each of its motions."""
        return float(np.mean(each) if self.combine == "mean" else np.max(each))


@dataclass(frozen=True)
class Demands:
    """The columns of one model under one motion, row for row of its work's values.

    run     : which rows were run at all: integrated or looked up
    charted : which of them were looked up
    bounds  : by how much the outputs of those may be wrong; 0 for the others
    """

    columns: Columns
    run: NDArray[np.bool_]
    charted: NDArray[np.bool_]
    bounds: Columns

    def off(self, output: str, by: float) -> Array:
        """Return an output, (n,), as far off as the chart says it may be, upwards (1), downwards (-1) or not (0)."""
        values = self.columns[output]
        # What is tabulated is never below zero.
        return np.where(self.charted, np.maximum(values + by * self.bounds[output], 0.0), values)


Rows = NDArray[np.intp]
"""Rows of a work's values, (k,)."""

Task = tuple[Model, Motion, Mapping[str, Array], str, float]


def _integrate(task: Task) -> Columns:
    model, motion, values, fidelity, azimuth_step = task
    return run_model(model, motion, values, fidelity, None, None, azimuth_step)[0]


def demands(
    work: Work,
    motion: Motion,
    executor: Executor,
    outcomes: Collection[int],
    *,
    fidelity: str = "history",
    azimuth_step: float = 10.0,
    charts: Shelf = SHELF,
) -> Demands:
    """Run one model's parameter sets under one motion, in chunks on the executor.

    What the certificate shows to stay at rest is not integrated: its demand is exactly the certificate's.
    outcomes : rows of the work's values whose history is wanted even where the certificate is the demand
    fidelity : "chart" looks up what is on a chart of the model, and integrates the rest at "history"
    """
    model, values = work.model, work.values
    size = next(iter(values.values())).size
    certificate = None
    needed = np.ones(size, dtype=bool)
    if model.certificate is not None:
        certificate = model.certificate(motion.excitation(None), values)
        if model.rests is not None:
            needed = certificate > model.rests
        if model.exact and model.rests is not None:
            # The certificate is the demand: the integration only tells what happens after, for the best estimates.
            told = np.zeros(size, dtype=bool)
            told[list(outcomes)] = True
            needed &= told
    columns = {q.name: np.zeros(size) for q in model.gives}
    bounds = {q.name: np.zeros(size) for q in model.gives}
    columns |= {"error": np.zeros(size), "note": np.zeros(size)}
    found = Demands(columns, needed, np.zeros(size, dtype=bool), bounds)
    rows = np.flatnonzero(needed)
    if fidelity == "chart":
        rows = _look_up(found, work, motion, rows, azimuth_step, charts)
    integrate(found, work, motion, rows, executor, integrated_at(fidelity), azimuth_step)
    if certificate is not None and model.exact:
        columns[model.demand] = np.where(np.isnan(certificate), columns[model.demand], certificate)
    return found


def integrated_at(fidelity: str) -> str:
    """Return the fidelity at which what is on no chart is integrated."""
    return "history" if fidelity == "chart" else fidelity


def _look_up(found: Demands, work: Work, motion: Motion, rows: Rows, azimuth_step: float, charts: Shelf) -> Rows:
    """Fill in what is on a chart of the model; the other rows are returned."""
    if work.model.chart is None or rows.size == 0:
        return rows
    some = {name: column[rows] for name, column in work.values.items()}
    looked = look_up(work.model, motion, some, None, None, azimuth_step, charts=charts)
    at = rows[looked.found]
    for name, column in looked.columns.items():
        found.columns[name][at] = column[looked.found]
    for name, column in looked.bounds.items():
        found.bounds[name][at] = column[looked.found]
    found.charted[at] = True
    return rows[~looked.found]


def integrate(
    found: Demands, work: Work, motion: Motion, rows: Rows, executor: Executor, fidelity: str, azimuth_step: float
) -> None:
    """Integrate rows of a work, in chunks on the executor, and fill them in, whatever stands there."""
    chunks = [rows[i : i + CHUNK] for i in range(0, rows.size, CHUNK)]
    tasks: list[Task] = [
        (work.model, motion, {n: v[chunk] for n, v in work.values.items()}, fidelity, azimuth_step) for chunk in chunks
    ]
    for chunk, answer in zip(chunks, executor.map(_integrate, tasks), strict=True):
        for name, column in answer.items():
            found.columns[name][chunk] = column
    found.charted[rows] = False
    for column in found.bounds.values():
        column[rows] = 0.0


@dataclass(frozen=True)
class Judgement:
    """A demand against a capacity, both with their ranges."""

    demand: float
    low: float
    high: float
    capacity: float
    utilisation: float
    verdict: Verdict


def judge(demand: float, low: float, high: float, capacity: Estimate) -> Judgement:
    """Compare: pass or fail only where the whole range of the uncertain inputs says so, else undetermined.

    A demand of exactly the capacity passes.
    """
    utilisation = _ratio(demand, capacity.value)
    most, least = _ratio(high, capacity.low), _ratio(low, capacity.high)
    if most <= 1.0:
        verdict = Verdict.PASS
    elif least > 1.0:
        verdict = Verdict.FAIL
    else:
        verdict = Verdict.UNDETERMINED
    return Judgement(demand, low, high, capacity.value, utilisation, verdict)


def _ratio(demand: float, capacity: float) -> float:
    if demand <= 0.0:
        return 0.0
    return demand / capacity if capacity > 0.0 else float("inf")


def assess(
    scenes: Sequence[Scene],
    levels: Sequence[LevelMotions],
    executor: Executor,
    progress: Progress,
    *,
    fidelity: str = "history",
    azimuth_step: float = 10.0,
    charts: Shelf = SHELF,
) -> tuple[Plan, list[list[Finding]]]:
    """Run everything the scenes require under every motion and judge it.

    fidelity : "chart", "history" or "reference"; what a chart's error leaves undecided is integrated
    charts   : where charts are found and kept
    returns : the plan (with the reasons for models not run) and the findings of each scene, in the order of the scenes
    """
    todo = plan(scenes)
    findings: list[list[Finding]] = [[] for _ in scenes]
    total = len(todo.work) * sum(len(level.motions) for level in levels)
    done = 0
    progress.step("analyses", done, total)
    for level in levels:
        for work in todo.work:
            results = []
            screens = [_screens(work, motion) for motion in level.motions]
            wanted = _wanted(work, scenes)
            for motion in level.motions:
                results.append(
                    demands(work, motion, executor, wanted, fidelity=fidelity, azimuth_step=azimuth_step, charts=charts)
                )
                done += 1
                progress.step("analyses", done, total)
            _settle(work, scenes, level, results, executor, azimuth_step)
            for at, index in enumerate(work.scenes):
                findings[index].append(_finding(scenes[index], work, at, level, results, screens, fidelity))
    return todo, findings


def _settle(
    work: Work,
    scenes: Sequence[Scene],
    level: LevelMotions,
    results: Sequence[Demands],
    executor: Executor,
    azimuth_step: float,
) -> None:
    """Integrate what was looked up wherever the error of a chart could change a verdict."""
    doubtful: set[int] = set()
    for at, index in enumerate(work.scenes):
        rows = [work.best[at], *work.spread[at]]
        if any(result.charted[rows].any() for result in results):
            output, capacity = capacity_of(work.model, scenes[index])
            # A larger demand never mends a verdict: what both ends agree on, all between them do.
            least, most = (_judged(work, at, level, results, output, capacity, by).verdict for by in (-1.0, 1.0))
            if least is not most:
                doubtful.update(rows)
    again = np.array(sorted(doubtful), dtype=np.intp)
    for result, motion in zip(results, level.motions, strict=True):
        looked = again[result.charted[again]]
        integrate(result, work, motion, looked, executor, "history", azimuth_step)


def _judged(
    work: Work,
    at: int,
    level: LevelMotions,
    results: Sequence[Demands],
    output: str,
    capacity: Estimate,
    by: float = 0.0,
) -> Judgement:
    """Judge one analysis, with the demands as far off as their charts say they may be (see `Demands.off`)."""
    best, span = work.best[at], list(work.spread[at])
    each = [result.off(output, by) for result in results]
    demand = level.combined([float(one[best]) for one in each])
    low = level.combined([float(one[span].min()) for one in each])
    high = level.combined([float(one[span].max()) for one in each])
    return judge(demand, low, high, capacity)


def _wanted(work: Work, scenes: Sequence[Scene]) -> set[int]:
    rows = set(work.best)
    for index, span in zip(work.scenes, work.spread, strict=True):
        if work.model.otherwise(scenes[index]) is not None:
            rows.update(span)
    return rows


def capacity_of(model: Model, scene: Scene) -> tuple[str, Estimate]:
    """Return which output of the model counts for this scene, and the capacity it is held against."""
    other = model.otherwise(scene)
    if other is not None:
        return other[0], Estimate(other[1], "-", Origin.DERIVED, other[1], other[1], "half of the motions")
    if isinstance(model.capacity, float):
        fixed = model.capacity
        return model.demand, Estimate(fixed, "-", Origin.DERIVED, fixed, fixed, "the onset itself")
    return model.demand, scene.parameters[model.capacity]


def _finding(
    scene: Scene,
    work: Work,
    at: int,
    level: LevelMotions,
    results: Sequence[Demands],
    screens: Sequence[Columns],
    fidelity: str,
) -> Finding:
    model = work.model
    output, capacity = capacity_of(model, scene)
    best, span = work.best[at], list(work.spread[at])
    governing = int(np.argmax([r.columns[output][best] for r in results]))
    verdict = _judged(work, at, level, results, output, capacity)
    result, motion = results[governing], level.motions[governing]
    row = {name: float(column[best]) for name, column in result.columns.items()}
    parameters = {name: float(column[best]) for name, column in work.values.items()}
    certified = model.exact and output == model.demand
    at_rest = not result.run[best]
    by_chart = bool(result.charted[[best, *span]].any())
    other = model.otherwise(scene)
    outcome, sentence = model.outcome(row, parameters)
    if not outcome and verdict.verdict is not Verdict.PASS:
        outcome = model.fails
    marked = model.mark(parameters, verdict.demand)
    unit = model.output(output).unit
    return Finding(
        object_number=scene.item.object_number,
        gallery=scene.item.gallery,
        level=level.name,
        model=model.name,
        title=model.title,
        demand_name=output,
        demand=verdict.demand,
        unit=unit,
        low=verdict.low,
        high=verdict.high,
        capacity=verdict.capacity,
        capacity_origin=capacity.origin,
        utilisation=verdict.utilisation,
        verdict=verdict.verdict,
        fidelity="bound" if certified or at_rest else "chart" if by_chart else integrated_at(fidelity),
        error=0.0 if certified or at_rest else float(result.bounds[output][best]) or row["error"],
        decided_by="certificate" if certified or at_rest else "chart" if by_chart else "history",
        motion=motion.name,
        motion_hash=motion.hash,
        sentence=f"{other[2] if other else model.sentence} {sentence}".strip(),
        screen=_said(model, screens[governing], best, parameters),
        outcome=outcome,
        note=_note(row),
        assumptions=_assumptions(scene, model, capacity),
        mark=None if marked is None else Mark(f"{marked[0]}:{motion.hash[:16]}", marked[1], marked[2]),
        version=__version__,
    )


def _note(row: Mapping[str, float]) -> str:
    from pipeline.models.common import words

    return words(row["note"])


def _screens(work: Work, motion: Motion) -> Columns:
    """Return the paper's criterion for all parameter sets of a work at once; nothing where it has none."""
    if work.model.screen is None:
        return {}
    return run_model(work.model, motion, work.values, "screen", None, None)[0]


def _said(model: Model, screens: Columns, row: int, parameters: Mapping[str, float]) -> str:
    if not screens:
        return ""
    return model.say_screen({name: float(column[row]) for name, column in screens.items()}, parameters)


def _assumptions(scene: Scene, model: Model, capacity: Estimate) -> tuple[str, ...]:
    used = [scene.parameters[q.name] for q in model.needs if q.name in scene.parameters]
    notes = [e.note for e in (*used, capacity) if e.origin is Origin.ASSUMED and e.note]
    return tuple(dict.fromkeys(notes))
