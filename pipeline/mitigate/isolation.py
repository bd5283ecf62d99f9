"""Isolators under the levels of a floor, each run once for all that may stand on it, and what all scenes share."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np

from pipeline.analysis.fragility.curve import ENOUGH, stated
from pipeline.analysis.likelihood.analyses import Transfer
from pipeline.analysis.model_runs import prepare
from pipeline.analysis.transmission import transmit
from pipeline.analysis.verdicts import LevelMotions
from pipeline.mitigate.hull import corners_of
from pipeline.mitigate.rows import Isolator
from pipeline.models import model_named
from pipeline.models.common import largest_push, lift_ratios
from pipeline.quantities import Array, G
from pipeline.records import Motion

TRANSMITTED_ERROR = 0.03
"""Error that the sampling of what an isolator passes on may bring to an oscillator of 20 Hz on it.

What stands on it slides at most 0.5 % off then, and is lifted 0.3 % off; 1e-3 would take eight times as long.
"""

SAMPLING_FACTOR = 1.005
"""Factor on what an isolator passes on, for what its sampling may hide."""


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


@dataclass(frozen=True, eq=False)
class LevelResponse:
    """An isolator under one level: its displacements [m], the acceleration and the level that it passes on."""

    stroke: float
    rare_stroke: float
    acceleration: float
    shaking: LevelMotions


class SharedLevel:
    """What a level of shaking is to all objects on the same floor, in the same furniture, each worked out once."""

    def __init__(self, level: LevelMotions) -> None:
        self.level = level
        self.responses: dict[Isolator, LevelResponse] = {}

    @cached_property
    def usual(self) -> "SharedLevel":
        """The same as the furniture passes it on by the best estimates, and by no other variant."""
        return SharedLevel(replace(self.level, others=()))

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


def _given(isolator: Isolator) -> dict[str, float]:
    if isolator.kind == "friction_isolator":
        return {"friction_static": isolator.friction}
    return {"frequency": isolator.frequency, "damping": isolator.damping, "friction": isolator.friction}


def run_isolator(task: tuple[SharedLevel, Isolator]) -> LevelResponse:
    """Run an isolator under a level, and pass on the motions that are felt on it."""
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


def push_of(motion: Motion) -> float:
    """Return A_max of a motion [m/s2], resultant; above 0."""
    return max(largest_push(motion.excitation(None)), np.finfo(float).tiny)
