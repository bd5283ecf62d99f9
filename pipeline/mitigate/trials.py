"""Trials of measures: the models of changed scenes run again, and how likely harm remains."""

from collections.abc import Callable, Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, TypeVar

import numpy as np

from pipeline.analysis.assess import assess
from pipeline.analysis.context import Context
from pipeline.analysis.furnished import best_furnished, furnished, isolating
from pipeline.analysis.furniture import FurnitureFilter, filter_of, loose, without_furniture
from pipeline.analysis.likelihood.analyses import Stood
from pipeline.analysis.likelihood.sampling import FEWEST, likelihoods
from pipeline.analysis.response import answer
from pipeline.analysis.verdicts import LevelMotions
from pipeline.mitigate.isolation import IsolatorResponse, TransmittedMotions, push_of, run_isolator
from pipeline.mitigate.rows import Isolator
from pipeline.models import settled_by_room
from pipeline.records import Finding, Likelihood, Motion, Numerics, Progress, Sampling, Scene
from pipeline.records.numerics import CHART
from pipeline.tables.assumed import AssumedValues, assumed

_T = TypeVar("_T")

MOST = 128
"""Samples of a trial at most: what leaves so near to the aim that these do not tell on which side it is is told with
its error, 0.03 at the aim of 0.1."""


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


Bodies = tuple[tuple[float, float], ...]
"""What an object on a pad may be: the height of its centre of gravity [m] with its inertia ratio."""


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
    def usual_push(self) -> float:
        """A_max [m/s2], resultant, as the furniture passes it on by the best estimates."""
        return max(shared.usual.push for shared in self._shared)

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

    def tipping(self, arm: float, base: float, *, usual: bool = False) -> float:
        """Return the largest of |a_h| times an arm less N times a base, N = max(0, g + a_z), but not below 0.

        Parameters
        ----------
        arm, base : float
            Both above 0 [m].
        usual : bool
            Whether the furniture is taken by its best estimates, and not by the worst that it may be.

        Returns
        -------
        float
            In any direction [m2/s2]: times the mass the moment that lifts the base off.
        """
        # Every fixing asks it of the same objects.
        return self.once(("tipping", arm, base, usual), lambda: self._tipping(arm, base, usual))

    def _tipping(self, arm: float, base: float, usual: bool) -> float:
        each = (
            shared.level.combined([float(np.max(arm * push - base * weight)) for push, weight in some])
            for shared in self._shared
            for some in (shared.usual if usual else shared).hardest
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

    def farthest(self, scene: Scene) -> float:
        """Return how far an object moves in the motion that moves it farthest, by the best estimates [m].

        Parameters
        ----------
        scene : Scene
            As it stands.
        """
        moving = tuple(name for name in scene.models if settled_by_room(name))
        alone = [replace(level, combine="max", others=()) for level in self.levels]
        one = replace(settled(scene), models=moving)
        _, (found,) = assess([one], alone, self._context.silent, self._numerics.integrated)
        return max((finding.demand or 0.0 for finding in found), default=0.0)

    def run(self, trials: Sequence[Trial]) -> list[list[Finding]]:
        """Run every model of each trial's scene, equal work once.

        Where harm has to be excluded, at every corner of the uncertain inputs; where it has to become unlikely, by the
        best estimates alone: joint samples tell the rest (`remaining`).

        Parameters
        ----------
        trials : sequence of Trial

        Returns
        -------
        list of list of Finding
            Those of each trial, in the order of the trials.
        """
        out: list[list[Finding]] = [[] for _ in trials]
        groups: dict[tuple[int, bool, FurnitureFilter | None], list[int]] = {}
        for at, trial in enumerate(trials):
            groups.setdefault((id(trial.on), *self._best_in(trial)), []).append(at)
        for (_, best, furniture), members in groups.items():
            on = trials[members[0]].on
            # What stands on no isolator is run in its own furniture, as it is assessed.
            levels = self._floor if on is None else on.shaking
            scenes = [trials[at].scene for at in members]
            if best:
                levels = self.once(("best", id(on), furniture), partial(_best_levels, levels, furniture))
                scenes = [settled(scene) for scene in scenes]
            numerics = self._numerics
            if on is not None and numerics.fidelity == CHART:
                # A chart of what one isolator passes on would be looked at once.
                numerics = numerics.integrated
            _, found = assess(scenes, levels, self._context.silent, numerics, outcomes=False)
            for at, findings in zip(members, found, strict=True):
                out[at] = findings
        return out

    def _best_in(self, trial: Trial) -> tuple[bool, FurnitureFilter | None]:
        """Return whether the best estimates alone are asked for, and in which furniture."""
        # Furniture that is not fastened is judged by itself, in all that it may be.
        if self._aim is None or loose(trial.scene):
            return False, None
        return True, filter_of(trial.scene) if trial.on is None else None

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
        found = likelihoods(
            stood,
            len(trials),
            self._floor,
            most_sampled(self._aim),
            self._context.executor,
            telling=False,
            first=FEWEST,
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
            all(name in one for one in remaining) and sum(one[name].expected for one in remaining) < self._aim.target
            for name in names
        )

    def isolated(self, kind: str) -> list[IsolatorResponse]:
        """Return the isolators of a kind that stand on the floor, by the length of their stroke."""
        listed = self.catalogue(kind)
        fresh = [(g, isolator) for g in self._isolating for isolator in listed if isolator not in g.responses]
        for (shared, isolator), one in zip(fresh, self._context.executor.map(run_isolator, fresh), strict=True):
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
                shares = np.maximum(shares, most / push_of(motion))
            each = [level.over([rotations[motion.hash] for motion in some]) for some in level.variants]
            turns[at] = np.max(each, axis=0)
        for one, turn, share in zip(fresh, turns.max(axis=0).tolist(), shares.tolist(), strict=True):
            self._on_pads[pad, one] = (turn, share)


def most_sampled(aim: HarmAim) -> Sampling:
    """Return how closely harm is drawn that a measure leaves: as telling on which side of the aim it is takes."""
    sampling = aim.sampling.deciding(aim.target)
    return replace(sampling, samples=min(sampling.samples, MOST))


def settled(scene: Scene) -> Scene:
    """Return a scene of which every number is its best estimate, and which feels what its furniture passes on."""
    bare = without_furniture(scene)
    sure = {name: replace(one, low=one.value, high=one.value) for name, one in bare.parameters.items()}
    return replace(bare, parameters=sure)


def _best_levels(levels: Sequence[LevelMotions], furniture: FurnitureFilter | None) -> tuple[LevelMotions, ...]:
    """Return levels as furniture passes them on by the best estimates; None: what feels them already."""
    return tuple(
        replace(level, others=()).through(lambda motion: best_furnished((motion,), furniture)) for level in levels
    )
