"""Scenes x motions -> demands -> findings: each demand against its capacity, with a number for how sure we are."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pipeline import __version__
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
from pipeline.response import run_model

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
    """The columns of one model under one motion, row for row of its work's values, and which rows were integrated."""

    columns: Columns
    integrated: Array


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
) -> Demands:
    """Run one model's parameter sets under one motion, in chunks on the executor.

    What the certificate shows to stay at rest is not integrated: its demand is exactly the certificate's.
    outcomes : rows of the work's values whose history is wanted even where the certificate is the demand
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
    columns |= {"error": np.zeros(size), "note": np.zeros(size)}
    rows = np.flatnonzero(needed)
    chunks = [rows[i : i + CHUNK] for i in range(0, rows.size, CHUNK)]
    tasks: list[Task] = [
        (model, motion, {n: v[chunk] for n, v in values.items()}, fidelity, azimuth_step) for chunk in chunks
    ]
    for chunk, answer in zip(chunks, executor.map(_integrate, tasks), strict=True):
        for name, column in answer.items():
            columns[name][chunk] = column
    if certificate is not None and model.exact:
        columns[model.demand] = np.where(np.isnan(certificate), columns[model.demand], certificate)
    return Demands(columns, needed)


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
    outcomes: bool = True,
) -> tuple[Plan, list[list[Finding]]]:
    """Run everything the scenes require under every motion and judge it.

    outcomes : whether to integrate the best estimates of what a certificate decides, to tell what happens after
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
            wanted = _wanted(work, scenes, outcomes)
            for motion in level.motions:
                results.append(demands(work, motion, executor, wanted, fidelity=fidelity, azimuth_step=azimuth_step))
                done += 1
                progress.step("analyses", done, total)
            for at, index in enumerate(work.scenes):
                findings[index].append(_finding(scenes[index], work, at, level, results, screens, fidelity))
    return todo, findings


def _wanted(work: Work, scenes: Sequence[Scene], outcomes: bool) -> set[int]:
    rows = set(work.best) if outcomes else set()
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
    each = np.array([r.columns[output][best] for r in results])
    lows = np.array([r.columns[output][span].min() for r in results])
    highs = np.array([r.columns[output][span].max() for r in results])
    governing = int(np.argmax(each))
    verdict = judge(level.combined(each), level.combined(lows), level.combined(highs), capacity)
    result, motion = results[governing], level.motions[governing]
    row = {name: float(column[best]) for name, column in result.columns.items()}
    parameters = {name: float(column[best]) for name, column in work.values.items()}
    certified = model.exact and output == model.demand
    at_rest = not result.integrated[best]
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
        fidelity="bound" if certified or at_rest else fidelity,
        error=0.0 if certified or at_rest else row["error"],
        decided_by="certificate" if certified or at_rest else "history",
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
