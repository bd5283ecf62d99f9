"""Trials of measures: the models of changed scenes run again, and what all scenes under the same shaking share."""

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import isinf
from typing import Any, TypeVar

import numpy as np

from pipeline.analysis.assess import assess
from pipeline.analysis.context import Context
from pipeline.analysis.fragility.curve import ENOUGH, stated
from pipeline.analysis.furnished import furnished, isolating
from pipeline.analysis.furniture import FurnitureFilter
from pipeline.analysis.likelihood.sampling import FEWEST, Stood, Transfer, likelihoods
from pipeline.analysis.model_runs import prepare
from pipeline.analysis.response import answer
from pipeline.analysis.transmission import transmit
from pipeline.analysis.verdicts import LevelMotions, capacity_of
from pipeline.mitigate.hull import corners_of
from pipeline.mitigate.rows import Isolator
from pipeline.models import model_named
from pipeline.models.common import largest_push, lift_ratios
from pipeline.quantities import Array, G
from pipeline.records import Check, Finding, Likelihood, Motion, Numerics, Progress, Sampling, Scene, Verdict
from pipeline.records.numerics import CHART
from pipeline.tables.assumed import AssumedValues, assumed

TRANSMITTED_ERROR = 0.03
"""Error that the sampling of what an isolator passes on may bring to an oscillator of 20 Hz on it.

What stands on it slides at most 0.5 % off then, and is lifted 0.3 % off; 1e-3 would take eight times as long.
"""

TIGHT = 0.1
"""Share of a demand within which a bound of it says as much as the demand."""

SAMPLING_FACTOR = 1.005
"""Factor on what an isolator passes on, for what its sampling may hide."""


_T = TypeVar("_T")


@dataclass(frozen=True, eq=False)
class IsolatorResponse:
    """An isolator under the motions of some levels, run once for all that may stand on it.

    Attributes
    ----------
    isolator : Isolator
        Its row of the catalogue.
    strokes : mapping of str to float
        Its largest displacement [m], by level, as demands of the level are combined.
    rare_strokes : mapping of str to float
        That which one in six motions like those of the level exceeds [m], by level (`upper_stroke`).
    accelerations : mapping of str to float
        The largest horizontal acceleration that it passes on [m/s2], by level.
    shaking : tuple of LevelMotions
        The levels as what stands on it feels them.
    """

    isolator: Isolator
    strokes: Mapping[str, float]
    rare_strokes: Mapping[str, float]
    accelerations: Mapping[str, float]
    shaking: tuple[LevelMotions, ...]

    @property
    def stroke(self) -> float:
        """The stroke that it needs: the 84th percentile of its displacement, at any level [m]."""
        return max(self.rare_strokes.values())

    @property
    def transfer(self) -> Transfer:
        """What it passes the motion on by."""
        return self.isolator.kind, tuple(_given(self.isolator).items())

    @property
    def acceleration(self) -> float:
        """The largest horizontal acceleration that it passes on at any level [m/s2]."""
        return max(self.accelerations.values())


@dataclass(frozen=True, slots=True)
class HarmAim:
    """How unlikely a measure has to make harm.

    Attributes
    ----------
    target : float
        Probability below which harm has to be.
    sampling : Sampling
        How that is found.
    """

    target: float
    sampling: Sampling


@dataclass(frozen=True)
class Trial:
    """A changed scene to be run.

    Attributes
    ----------
    scene : Scene
        The object with a measure in place.
    on : IsolatorResponse or None
        What it stands on; None for the floor itself.
    """

    scene: Scene
    on: IsolatorResponse | None = None


@dataclass(frozen=True, eq=False)
class LevelResponse:
    """An isolator under one level: its displacements [m], the acceleration and the level that it passes on."""

    stroke: float
    rare_stroke: float
    acceleration: float
    shaking: LevelMotions


Bodies = tuple[tuple[float, float], ...]
"""What an object on a pad may be: the height of its centre of gravity [m] with its inertia ratio."""


class SharedLevel:
    """What a level of shaking is to all objects on the same floor, in the same furniture, each worked out once."""

    def __init__(self, level: LevelMotions) -> None:
        self.level = level
        self.responses: dict[Isolator, LevelResponse] = {}

    @cached_property
    def push(self) -> float:
        """A_max [m/s2], resultant."""
        return self.level.worst(lambda motion: largest_push(motion.excitation(None)))

    @cached_property
    def lift(self) -> float:
        """The largest |a_h| / N: what an object's slope b/h is held against."""
        return self.level.worst(lambda motion: max(lift_ratios(motion.excitation(None))))

    @cached_property
    def hardest(self) -> Sequence[Sequence[tuple[Array, Array]]]:
        """|a_h| and N [m/s2] at the samples that may lift an edge, (k,) each, of what the level is combined from.

        Of each variant of the furniture; one takes the place of all where the largest counts.
        """
        felt = {
            m.hash: (np.hypot(*m.acceleration[:2]), np.maximum(0.0, G + m.acceleration[2])) for m in self.level.every
        }
        if self.level.combine == "mean":
            return [[corners_of(*felt[motion.hash]) for motion in some] for some in self.level.variants]
        return [[corners_of(*(np.concatenate(part) for part in zip(*felt.values(), strict=True)))]]


class TransmittedMotions:
    """What isolators pass on and other things that hang on the shaking alone, kept for as long as this object lives."""

    def __init__(self) -> None:
        self._shared: dict[Hashable, SharedLevel] = {}

    def of(self, level: LevelMotions) -> SharedLevel:
        """Return what is known of a level so far."""
        hashes = tuple(tuple(motion.hash for motion in some) for some in level.variants)
        key = (level.name, level.combine, level.x_azimuth, hashes)
        return self._shared.setdefault(key, SharedLevel(level))


class TrialRunner:
    """Runs the models of changed scenes under some levels of shaking, all of which a measure has to bear.

    What is said of a level is combined from its motions as its findings are: the largest, or the mean.  Of several
    levels the largest counts.

    Parameters
    ----------
    levels : sequence of LevelMotions
        Levels of shaking of the floor, with their motions.
    isolators : sequence of Isolator
        The catalogue of isolators that there are.
    context : Context
        Where isolators and models are run.
    numerics : Numerics
        How finely: as the findings were made.
    transmitted : TransmittedMotions, optional
        What isolators pass on, kept from one runner to the next.
    values : AssumedValues, optional
        What is assumed of materials and surfaces; Kouros's own tables where it is left out.
    furniture : FurnitureFilter, optional
        What all objects that measures are tried for stand in: ``levels`` is what it passes on.
    aim : HarmAim, optional
        How unlikely harm has to become; where it is left out, it has to be excluded.
    """

    def __init__(
        self,
        levels: Sequence[LevelMotions],
        isolators: Sequence[Isolator],
        context: Context,
        numerics: Numerics,
        transmitted: TransmittedMotions | None = None,
        values: AssumedValues | None = None,
        furniture: FurnitureFilter | None = None,
        aim: HarmAim | None = None,
    ) -> None:
        self.values = values or assumed()
        self._aim = aim
        self._floor, self._isolators = tuple(levels), tuple(isolators)
        self.levels = tuple(furnished(level, furniture) for level in levels)
        self._context, self._numerics = context, numerics
        transmitted = transmitted or TransmittedMotions()
        self._shared = [transmitted.of(level) for level in self.levels]
        self._isolating = [transmitted.of(isolating(level, furniture)) for level in levels]
        self._isolated: dict[Isolator, IsolatorResponse] = {}
        self._on_pads: dict[tuple[Isolator, Bodies], tuple[float, float]] = {}
        self._made: dict[Hashable, Any] = {}

    @property
    def progress(self) -> Progress:
        """Who is told how far the trials are."""
        return self._context.progress

    def catalogue(self, kind: str) -> list[Isolator]:
        """Return the isolators of a kind that there are, in the order of their table."""
        return [isolator for isolator in self._isolators if isolator.kind == kind]

    def largest(self, of: Callable[[Motion], float]) -> float:
        """Return the largest over the levels, and over the variants of the furniture, of what is combined of each."""
        return max(level.worst(of) for level in self.levels)

    @property
    def push(self) -> float:
        """A_max [m/s2], resultant."""
        return max(shared.push for shared in self._shared)

    @property
    def lift(self) -> float:
        """The largest |a_h| / N: what an object's slope b/h is held against."""
        return max(shared.lift for shared in self._shared)

    def tilt(self, scene: Scene) -> float:
        """Return the slope b/h above which an object does not tip: what pushes it, or the friction that passes it on.

        Parameters
        ----------
        scene : Scene
            A free-standing object, its friction at the higher end.
        """
        friction = scene.parameters.get("friction_static")
        return self.lift if friction is None else min(self.lift, friction.high)

    def tipping(self, arm: float, base: float) -> float:
        """Return the largest of |a_h| times an arm less N times a base, N = max(0, g + a_z), but not below 0.

        Parameters
        ----------
        arm, base : float
            Both above 0 [m].

        Returns
        -------
        float
            In any direction [m2/s2]: times the mass the moment that lifts the base off.
        """
        each = (
            shared.level.combined([float(np.max(arm * push - base * weight)) for push, weight in some])
            for shared in self._shared
            for some in shared.hardest
        )
        return max(0.0, *each)

    def once(self, key: Hashable, make: Callable[[], _T]) -> _T:
        """Return what is made under a key, the first time that it is asked for.

        Parameters
        ----------
        key : hashable
            All that it depends on but the shaking.
        make : callable
            Makes it.
        """
        if key not in self._made:
            self._made[key] = make()
        made: _T = self._made[key]
        return made

    def run(self, trials: Sequence[Trial]) -> list[list[Finding]]:
        """Run every model of each trial's scene, equal work once, at every corner of the uncertain inputs.

        Parameters
        ----------
        trials : sequence of Trial

        Returns
        -------
        list of list of Finding
            Those of each trial, in the order of the trials.
        """
        out: list[list[Finding]] = [[] for _ in trials]
        groups: dict[int, list[int]] = {}
        for at, trial in enumerate(trials):
            groups.setdefault(id(trial.on), []).append(at)
        for members in groups.values():
            on = trials[members[0]].on
            numerics = self._numerics
            if on is not None and numerics.fidelity == CHART:
                # A chart of what one isolator passes on would be looked at once.
                numerics = numerics.integrated
            _, found = assess(
                [trials[at].scene for at in members],
                # What stands on no isolator is run in its own furniture, as it is assessed.
                self._floor if on is None else on.shaking,
                self._context.silent,
                numerics,
                outcomes=False,
            )
            for at, findings in zip(members, found, strict=True):
                out[at] = findings
        return out

    def remaining(self, trials: Sequence[Trial]) -> list[dict[str, Likelihood]]:
        """Return how likely harm remains in each trial, by level; nothing where no aim is given.

        Parameters
        ----------
        trials : sequence of Trial

        Returns
        -------
        list of dict of str to Likelihood
            Of each trial, as closely as telling on which side of the aim it is takes.
        """
        if self._aim is None or not trials:
            return [{} for _ in trials]
        stood = []
        for at, trial in enumerate(trials):
            stood.append(Stood(at, trial.scene, None if trial.on is None else trial.on.transfer))
        sampling = self._aim.sampling.deciding(self._aim.target)
        found = likelihoods(
            stood, len(trials), self._floor, sampling, self._context.executor, telling=False, first=FEWEST
        )
        return [{one.level: one for one in those} for those in found]

    @property
    def aims(self) -> bool:
        """Whether harm has to become unlikely, and need not be excluded."""
        return self._aim is not None

    def reaches_aim(self, remaining: Sequence[Mapping[str, Likelihood]]) -> bool:
        """Say whether harm is unlikely enough at every level, that of several trials together.

        Parameters
        ----------
        remaining : sequence of mapping of str to Likelihood
            Of each trial; of none of them harm is as unlikely as can be.
        """
        if self._aim is None:
            return not remaining
        names = [level.name for level in self._floor]
        return all(
            all(name in one for one in remaining) and sum(one[name].probability for one in remaining) < self._aim.target
            for name in names
        )

    def isolated(self, kind: str) -> list[IsolatorResponse]:
        """Return the isolators of a kind that stand on the floor, by the length of their stroke."""
        listed = self.catalogue(kind)
        fresh = [(g, isolator) for g in self._isolating for isolator in listed if isolator not in g.responses]
        for (shared, isolator), one in zip(fresh, self._context.executor.map(_run_isolator, fresh), strict=True):
            shared.responses[isolator] = one
        for isolator in listed:
            if isolator not in self._isolated:
                each = {shared.level.name: shared.responses[isolator] for shared in self._isolating}
                self._isolated[isolator] = IsolatorResponse(
                    isolator,
                    {name: one.stroke for name, one in each.items()},
                    {name: one.rare_stroke for name, one in each.items()},
                    {name: one.acceleration for name, one in each.items()},
                    tuple(one.shaking for one in each.values()),
                )
        return sorted((self._isolated[isolator] for isolator in listed), key=lambda one: one.stroke)

    def on_pad(self, pad: Isolator, bodies: Bodies) -> tuple[float, float]:
        """Return how far an object turns on a rotational pad, and what it feels there.

        Parameters
        ----------
        pad : Isolator
        bodies : tuple of (float, float)
            What the object may be; the largest of each output counts.

        Returns
        -------
        rotation : float
            Largest rotation [rad].
        share : float
            Largest acceleration of its centre of gravity over A_max [-].
        """
        if (pad, bodies) not in self._on_pads:
            self.on_pads(pad, [bodies])
        return self._on_pads[pad, bodies]

    def on_pads(self, pad: Isolator, objects: Sequence[Bodies]) -> None:
        """Run many objects on a pad together, for `on_pad` to be asked about each: one by one costs ten times as much.

        Parameters
        ----------
        pad : Isolator
        objects : sequence of Bodies
            What each may be.
        """
        fresh = list(dict.fromkeys(objects))
        if not fresh:
            return
        given = {
            "frequency": pad.frequency,
            "damping": pad.damping,
            "cg_height": [height for bodies in fresh for height, _ in bodies],
            "inertia_ratio": [ratio for bodies in fresh for _, ratio in bodies],
        }
        starts = np.cumsum([0, *map(len, fresh)])[:-1]
        turns = np.zeros((len(self.levels), len(fresh)))
        shares = np.zeros(len(fresh))
        for at, level in enumerate(self.levels):
            rotations = {}
            for motion in level.every:
                rows = answer("rotational_isolator", motion, given, self._numerics.at("history"), angle=None)
                rotations[motion.hash] = np.maximum.reduceat(np.asarray(rows["rotation"]), starts)
                most = np.maximum.reduceat(np.asarray(rows["acceleration"]), starts)
                shares = np.maximum(shares, most / _push(motion))
            each = [level.over([rotations[motion.hash] for motion in some]) for some in level.variants]
            turns[at] = np.max(each, axis=0)
        for one, turn, share in zip(fresh, turns.max(axis=0).tolist(), shares.tolist(), strict=True):
            self._on_pads[pad, one] = (turn, share)


def _given(isolator: Isolator) -> dict[str, float]:
    if isolator.kind == "friction_isolator":
        return {"friction_static": isolator.friction}
    return {"frequency": isolator.frequency, "damping": isolator.damping, "friction": isolator.friction}


def _run_isolator(task: tuple[SharedLevel, Isolator]) -> LevelResponse:
    level, isolator = task[0].level, task[1]
    given: dict[str, Any] = _given(isolator)
    model = model_named(isolator.kind)
    strokes, accelerations, passed_on = {}, {}, {}
    for motion in level.every:
        # One pass without an error estimate: it only ranks, and its own model is run again with the rest.
        own = model.run(motion.excitation(None), prepare(model, given), 2, False)
        passed = transmit(isolator.kind, motion, error=TRANSMITTED_ERROR, **given)
        strokes[motion.hash] = float(own["displacement"][0])
        accelerations[motion.hash] = max(float(own["acceleration"][0]), largest_push(passed.excitation(None)))
        passed_on[motion.hash] = passed.scaled(SAMPLING_FACTOR, "for what its sampling may hide")
    stroke = level.worst(lambda motion: strokes[motion.hash])
    rare = max(upper_stroke([strokes[motion.hash] for motion in some]) for some in level.variants)
    return LevelResponse(
        stroke,
        max(stroke, rare),
        level.worst(lambda motion: accelerations[motion.hash]),
        level.through(lambda motion: (passed_on[motion.hash],)),
    )


def upper_stroke(strokes: Sequence[float]) -> float:
    """Return the 84th percentile of an isolator's displacement under motions like some: one sigma above their median.

    Parameters
    ----------
    strokes : sequence of float
        Under each motion of a suite [m].

    Returns
    -------
    float
        The geometric mean times exp(beta) [m].  beta is the scatter of the suite; with fewer than seven motions it is
        not less than that of tables/dispersion.csv, so that one record is not taken for all.

    References
    ----------
    ASCE/SEI 7-16, sec. 16.2 (what fewer than seven motions tell of the scatter).
    """
    moved = np.array([stroke for stroke in strokes if stroke > 0.0])
    if moved.size == 0:
        return 0.0
    logs = np.log(moved)
    beta = float(logs.std(ddof=1)) if moved.size > 1 else 0.0
    if len(strokes) < ENOUGH:
        beta = max(beta, stated("record_velocity").value)
    return float(np.exp(logs.mean() + beta))


def _push(motion: Motion) -> float:
    return max(largest_push(motion.excitation(None)), np.finfo(float).tiny)


def passes(findings: Sequence[Finding]) -> bool:
    """Say whether something was run and all of it passes, at every corner of what is uncertain."""
    return bool(findings) and all(finding.verdict is Verdict.PASS for finding in findings)


def passes_at_best(findings: Sequence[Finding]) -> bool:
    """Say whether something was run and all of it passes by the best estimates."""
    return bool(findings) and all(_at_best(finding) for finding in findings)


def _at_best(finding: Finding) -> bool:
    return finding.utilisation is not None and finding.utilisation <= 1.0


def checks(findings: Sequence[Finding], before: Sequence[Finding], *, at_best: bool = False) -> tuple[Check, ...]:
    """Return the findings of a trial as evidence, each beside the demand before the measure.

    at_best : whether they were asked to pass by the best estimates only
    """
    demands = {finding.model: finding.demand for finding in before}
    every = (
        Check(
            model=finding.model,
            title=finding.title,
            demand=finding.demand or 0.0,
            unit=finding.unit,
            capacity=finding.capacity or 0.0,
            utilisation=finding.utilisation or 0.0,
            passes=_at_best(finding) if at_best else finding.verdict is Verdict.PASS,
            before=demands.get(finding.model),
        )
        for finding in findings
    )
    # Of two trials on the floor each judges the furniture that is not fastened.
    return tuple(dict.fromkeys(every))


def why_not(scene: Scene, findings: Sequence[Finding]) -> str:
    """Say in words what a trial still fails by: the worst of what its uncertain inputs give, against its capacity."""
    worst = [(_worst(scene, finding), finding) for finding in findings if finding.verdict is not Verdict.PASS]
    if not worst:
        return "none of its models can be run then"
    times, finding = max(worst, key=lambda pair: pair[0])
    error, demand = finding.error or 0.0, finding.demand or 0.0
    if finding.fidelity == "bound" and error and (isinf(error) or error > TIGHT * demand):
        return f"{finding.title.lower()} may still be more than is allowed"
    if finding.high is not None and isinf(finding.high):
        return f"nothing limits {finding.title.lower()} then"
    if times == float("inf"):
        return f"nothing would be left of what {finding.title.lower()} is allowed"
    best = finding.utilisation or 0.0
    sure = f", {best:.2g} times by the best estimates" if times > 1.05 * best else ""
    return f"{finding.title.lower()} may still reach {times:.2g} times what is allowed{sure}"


def _worst(scene: Scene, finding: Finding) -> float:
    _, capacity = capacity_of(model_named(finding.model), scene)
    return (finding.high or 0.0) / capacity.low if capacity.low > 0.0 else float("inf")
