"""A demand against a capacity, both with their ranges: pass, fail or undetermined."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from pipeline.quantities import Array
from pipeline.records import Estimate, Executor, Model, Motion, Origin, Scene, Verdict

EAST = 90.0
"""Azimuth of the x axis where a site does not turn it [degrees clockwise from north]."""

Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class LevelMotions:
    """The motions of one level of the site, and how their demands are combined ("max" or "mean").

    Attributes
    ----------
    x_azimuth : float
        Degrees clockwise from north of their x axis.
    others : tuple[tuple[Motion, ...], ...]
        Where something that is uncertain passes them on, the same motions as its other variants do; ``motions`` are
        those by its best estimates then.
    site : tuple of Motion
        Those of the floor, where something passes them on; findings are of these, whatever passes them on.
    """

    name: str
    combine: str
    motions: tuple[Motion, ...]
    x_azimuth: float = EAST
    others: tuple[tuple[Motion, ...], ...] = ()
    site: tuple[Motion, ...] = ()

    @property
    def passed_on(self) -> bool:
        """Whether something stands between the floor and what feels these motions."""
        return bool(self.site)

    @property
    def of_mean(self) -> bool:
        """Whether its demands are a mean, so that some of its motions ask more."""
        return self.combine == "mean" and len(self.motions) > 1

    @property
    def told(self) -> tuple[Motion, ...]:
        """The motions that findings are of, in the order of ``motions``."""
        return self.site or self.motions

    @property
    def variants(self) -> tuple[tuple[Motion, ...], ...]:
        """The motions under each variant of what passes them on, the best estimates first."""
        return (self.motions, *self.others)

    @property
    def every(self) -> tuple[Motion, ...]:
        """The motions under all variants, each once."""
        return tuple({motion.hash: motion for some in self.variants for motion in some}.values())

    def through(self, passed: Callable[[Motion], Sequence[Motion]], executor: Executor | None = None) -> LevelMotions:
        """Return the level as it is passed on.

        Parameters
        ----------
        passed : Callable[[Motion], Sequence[Motion]]
            A motion -> the same as each variant passes it on, the best estimates first; always as many.
        executor : Executor or None, optional
            Where that is found; None: here.

        Returns
        -------
        LevelMotions
        """
        every = executor.map if executor else lambda work, some: [work(one) for one in some]
        each = [every(passed, some) for some in self.variants]
        variants = [tuple(made[at] for made in some) for some in each for at in range(len(some[0]))]
        return replace(self, motions=variants[0], others=tuple(variants[1:]), site=self.told)

    def worst(self, of: Callable[[Motion], float]) -> float:
        """Return the largest over the variants of what is combined from the motions of each."""
        return max(self.combined([of(motion) for motion in some]) for some in self.variants)

    def combined(self, each: Sequence[float] | Array) -> float:
        """Return the demand of the level from that under each of its motions."""
        return float(np.mean(each) if self.combine == "mean" else np.max(each))

    def over(self, each: Sequence[Array]) -> Array:
        """Return the demands (m,) of the level from those under each of its motions."""
        total = each[0].copy()
        for other in each[1:]:
            total = total + other if self.combine == "mean" else np.maximum(total, other)
        return total / len(each) if self.combine == "mean" else total


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
    """Compare: pass or fail only where both ends of the demand and of the capacity say so, else undetermined.

    low, high : of the demand, over all that was looked at of what is uncertain (see `pipeline.analysis.plan.corners`)
    A demand of exactly the capacity passes.
    """
    used = utilisation(np.array([demand, high, low]), np.array([capacity.value, capacity.low, capacity.high]))
    if used[1] <= 1.0:
        verdict = Verdict.PASS
    elif used[2] > 1.0:
        verdict = Verdict.FAIL
    else:
        verdict = Verdict.UNDETERMINED
    return Judgement(demand, low, high, capacity.value, float(used[0]), verdict)


def utilisation(demand: Array, capacity: Array) -> Array:
    """Return demand / capacity, (m,) each: 0 where nothing is demanded, infinite where there is no capacity for it."""
    ratio = np.divide(demand, capacity, out=np.full(demand.shape, np.inf), where=capacity > 0.0)
    return np.where(demand <= 0.0, 0.0, ratio)


def exceeds(demand: Array, capacity: Array) -> Mask:
    """Say whether a demand is above a capacity, (m,) each, as `judge` sees it."""
    return np.asarray(utilisation(demand, capacity) > 1.0)


def capacity_of(model: Model, scene: Scene) -> tuple[str, Estimate]:
    """Return which output of the model counts for this scene, and the capacity it is held against."""
    other = model.otherwise(scene)
    if other is not None:
        return other[0], Estimate(other[1], "-", Origin.DERIVED, other[1], other[1], "half of the motions")
    if isinstance(model.capacity, float):
        fixed = model.capacity
        return model.demand, Estimate(fixed, "-", Origin.DERIVED, fixed, fixed, "the onset itself")
    return model.demand, scene.parameters[model.capacity]
