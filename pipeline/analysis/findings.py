"""Verdicts in the words and numbers of findings."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from pipeline import __version__
from pipeline.analysis.cases import DemandCase, Known
from pipeline.analysis.demands import Step
from pipeline.analysis.furniture import OF_FURNITURE
from pipeline.analysis.model_runs import run_model
from pipeline.analysis.plan import Indices, Work
from pipeline.analysis.refinement import FidelitySearch
from pipeline.analysis.verdicts import LevelMotions, Mask, utilisation
from pipeline.models.common import NO_VERTICAL, words
from pipeline.motions.record import ESTIMATED
from pipeline.quantities import Array
from pipeline.records import Columns, Estimate, Finding, Mark, Model, Numerics, Origin, Scene, Verdict
from pipeline.records.result import BOUNDS, DEMANDS
from pipeline.tables.mount_rows import mount_rows

_SCREEN = Numerics("screen")

_DECIDED = {Step.BOUND: "certificate", Step.CHART: "chart", Step.HISTORY: "history"}


@dataclass(frozen=True)
class _Numbers:
    """What the findings of a case say in numbers, (m,) each.

    motion, row : under which motion the best estimates demand most, and their row of the work's values
    at_most     : whether the demand is a bound, and by how much it may be less
    enclosed    : whether an end of the range is a bound: the range lies between low and high, and may be narrower
    """

    demand: Array
    low: Array
    high: Array
    used: Array
    motion: Indices
    row: Indices
    at_most: Mask
    slack: Array
    enclosed: Mask


def _numbers(search: FidelitySearch, case: DemandCase) -> _Numbers:
    level, spans = search.level, case.spans
    every = [found.points(case.output) for found in search.found]
    points = every[: len(search.best)]
    demand = level.over([spans.best(high) for _, high in points])
    slack = _gap(level.over([spans.best(low) for low, _ in points]), demand)
    motion, row = search.governing(case)
    if level.combine == "max":
        # Under the other motions it may be less by more.
        slack = np.array([_gap(low[row], high[row]) for low, high in points])[motion, np.arange(row.size)]
    # Over all variants of the furniture; the best estimates are those of the first.
    leasts = [found.points(search.work.model.least_of(case.output)) for found in search.found]
    lows = [np.min(search.each([spans.lowest(side) for side in sides]), axis=0) for sides in zip(*leasts, strict=True)]
    highs = [np.max(search.each([spans.highest(side) for side in sides]), axis=0) for sides in zip(*every, strict=True)]
    return _Numbers(
        demand,
        lows[0],
        highs[1],
        utilisation(demand, case.capacity[1]),
        motion,
        row,
        np.asarray(slack > 0.0),
        slack,
        np.asarray((_gap(*lows) > 0.0) | (_gap(*highs) > 0.0)),
    )


def _gap(low: Array, high: Array) -> Array:
    # Infinite demands, as where contact is lost, are known exactly.
    return np.subtract(high, low, out=np.zeros_like(high), where=high > low)


def findings(search: FidelitySearch, case: DemandCase, known: Known, scenes: Sequence[Scene]) -> list[Finding]:
    """Return the findings of a case.

    Parameters
    ----------
    search
        What is known of the demands under each motion of the level.
    case
        The analyses (m,).
    known
        Their verdicts.
    scenes
        Those that the analyses are of.

    Returns
    -------
    list of Finding
        In the order of the analyses.
    """
    work, level = search.work, search.level
    model = work.model
    unit = model.output(case.output).unit
    numbers = _numbers(search, case)
    rows = _Rows(search, case, numbers)
    out = []
    columns = (numbers.demand, numbers.low, numbers.high, numbers.used, numbers.motion, numbers.row, numbers.at_most)
    lists = [column.tolist() for column in (*columns, numbers.slack, numbers.enclosed, work.scenes[case.analyses])]
    steps = search.decided[case.analyses].tolist()
    verdicts = _verdicts(known)
    for demand, low, high, used, at, row, at_most, slack, enclosed, index, step, verdict, capacity in zip(
        *lists, steps, verdicts, case.estimates, strict=True
    ):
        scene, motion, said = scenes[index], level.told[at], rows.said(row, at)
        other = model.otherwise(scene)
        bound = model.at_most if at_most or enclosed else ""
        sentence = other[2] if other else (model.gripped if _gripped(scene) else "") or bound or model.sentence
        # Charts are drawn of the motions of the floor.
        marked = None if level.passed_on else model.mark(said.parameters, demand)
        out.append(
            Finding(
                object_number=scene.item.object_number,
                gallery=scene.item.gallery,
                level=level.name,
                model=model.name,
                title=model.title,
                demand_name=case.output,
                demand=demand,
                unit=unit,
                low=low,
                high=high,
                range_is=BOUNDS if enclosed else DEMANDS,
                capacity=capacity.value,
                capacity_origin=capacity.origin,
                utilisation=used,
                verdict=verdict,
                fidelity="bound" if at_most else said.fidelity,
                error=slack if at_most else said.error,
                decided_by=_DECIDED[step],
                motion=motion.name,
                motion_hash=motion.hash,
                sentence=f"{sentence} {said.sentence}" if said.sentence else sentence,
                screen=said.screen,
                # What it does by the best estimates, as the demand and the utilisation are.
                outcome=(said.outcome or model.fails) if used > 1.0 else "",
                note=said.note,
                assumptions=_assumptions(scene, model, capacity),
                mark=None if marked is None else Mark(f"{marked[0]}:{motion.hash[:16]}", marked[1], marked[2]),
                version=__version__,
            )
        )
    return out


def _gripped(scene: Scene) -> bool:
    return scene.mount is not None and mount_rows()[scene.mount].room is not None


def _verdicts(known: Known) -> list[Verdict]:
    return [
        Verdict.PASS if passes else Verdict.FAIL if fails else Verdict.UNDETERMINED
        for passes, fails in zip(known.passes.tolist(), known.fails.tolist(), strict=True)
    ]


@dataclass(frozen=True, slots=True)
class _Said:
    """What is said of one parameter set under one motion, whichever object asks."""

    parameters: Mapping[str, float]
    outcome: str
    sentence: str
    screen: str
    note: str
    fidelity: str
    error: float


class _Rows:
    """Says of each parameter set under each motion what objects have in common, once."""

    def __init__(self, search: FidelitySearch, case: DemandCase, numbers: _Numbers) -> None:
        self._search, self._output = search, case.output
        self._known: dict[tuple[int, int], _Said] = {}
        self._screens = [
            _screens(search.work, search.level, at, np.unique(numbers.row[numbers.motion == at]))
            for at in range(len(search.best))
        ]

    def said(self, row: int, at: int) -> _Said:
        """Return what is said of a row of the work's values under a motion of the level."""
        if (row, at) not in self._known:
            self._known[row, at] = self._say(row, at)
        return self._known[row, at]

    def _say(self, row: int, at: int) -> _Said:
        found, model = self._search.found[at], self._search.work.model
        parameters = {name: float(column[row]) for name, column in self._search.work.values.items()}
        told = found.told(row)
        outcome, sentence = model.outcome(told, parameters)
        step = Step(found.step[row])
        certain = step is Step.BOUND or (model.exact and self._output == model.demand)
        # A yes or no is off by nothing, or sensitive, which its note says.
        exactly = certain or model.output(self._output).unit == "bool"
        fidelity = self._search.numerics.integrated.fidelity if step is Step.HISTORY else step.name.lower()
        rows, columns = self._screens[at]
        place = int(np.searchsorted(rows, row))
        screened = {name: float(column[place]) for name, column in columns.items()}
        return _Said(
            parameters,
            outcome,
            sentence,
            model.say_screen(screened, parameters) if columns else "",
            "; ".join(filter(None, (words(told["note"]), self._unsaid(at)))),
            "bound" if certain else fidelity,
            0.0 if exactly else told[model.error_of(self._output)],
        )

    def _unsaid(self, at: int) -> str:
        motion = self._search.level.motions[at]
        if not self._search.work.model.vertical:
            return ""
        return ESTIMATED if ESTIMATED in motion.steps else "" if motion.acceleration[2].any() else NO_VERTICAL


def _screens(work: Work, level: LevelMotions, at: int, rows: Indices) -> tuple[Indices, Columns]:
    """Return the paper's criterion for some rows, ascending, under a motion; nothing where the model has none."""
    model = work.model
    if model.screen is None or rows.size == 0:
        return rows, {}
    out: Columns = {}
    for angle, some in work.by_angle(rows):
        columns = run_model(model, level.motions[at], work.some(some), _SCREEN, angle)[0]
        for name, column in columns.items():
            out.setdefault(name, np.empty(rows.size))[np.searchsorted(rows, some)] = column
    return rows, out


def _assumptions(scene: Scene, model: Model, capacity: Estimate) -> tuple[str, ...]:
    known = scene.parameters
    used = [known[name] for name in (*model.inputs, *OF_FURNITURE) if name in known]
    notes = [e.note for e in (*used, capacity) if e.origin is Origin.ASSUMED and e.note]
    return tuple(dict.fromkeys(notes))
