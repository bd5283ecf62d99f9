"""Incremental dynamic analysis (Vamvatsikos and Cornell 2002): the multiple of a motion at which an object fails."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.context import Context
from pipeline.analysis.demands import bounded, integrate
from pipeline.analysis.plan import Indices, Work
from pipeline.analysis.verdicts import utilisation
from pipeline.quantities import Array
from pipeline.records import Estimate, Motion, Numerics

FACTORS = tuple(float(f) for f in np.geomspace(0.1, 3.0, 8))
"""What a motion is multiplied by; the first of these at which something fails counts."""

HALVINGS = 2
"""How often the step between standing and failing is halved where its ends do not say well where failure begins."""

STEEP = 2.0
"""Power of the factor up to which a demand is interpolated at once; what only just begins to move is steeper."""


@dataclass(frozen=True)
class Questions:
    """Demands against capacities, v of them: which parameter sets, which output, how much is allowed.

    Attributes
    ----------
    work : Work
        Whose values are meant.
    output : str
        Of the model.
    rows : ndarray of int, shape (v, a)
        Rows of the work's values, of which the larger demand counts.
    capacity : ndarray, shape (v,)
        In the output's unit.
    """

    work: Work
    output: str
    rows: Indices
    capacity: Array

    @classmethod
    def of(cls, work: Work, output: str, members: Indices, capacities: Sequence[Estimate]) -> "Questions":
        """Return, for some analyses of a work, all their parameter sets, then the best ones at both ends of capacity.

        The sets of an analysis come as in the work: the best one first, then the corners of its uncertain inputs.

        Parameters
        ----------
        work : Work
            Of the plan.
        output : str
            Of its model.
        members : ndarray of int, shape (m,)
            Which analyses.
        capacities : sequence of Estimate
            Of each, in the output's unit.

        Returns
        -------
        Questions
            (v + 2m,) of them.
        """
        spans = work.spans.take(members)
        low, best, high = (np.array([getattr(c, end) for c in capacities]) for end in ("low", "value", "high"))
        own = spans.rows[spans.starts]
        rows = np.concatenate([spans.rows, own, own])
        return cls(work, output, rows, np.concatenate([spans.spread(best), low, high]))

    def used(self, motion: Motion, which: Indices, context: Context, numerics: Numerics) -> Array:
        """Return demand / capacity of some questions under a motion.

        Parameters
        ----------
        motion
            What shakes the objects.
        which
            (n,) places of the questions.
        context, numerics
            Where they are integrated, and how finely.

        Returns
        -------
        ndarray
            (n,) of each question the larger of its parameter sets.
        """
        rows = self.rows[which]
        wanted = np.unique(rows)
        found = bounded(self.work, motion, (self.output,), context.executor, whole=False)
        low, high = found.low[self.output], found.high[self.output]
        integrate(found, wanted[low[wanted] < high[wanted]], context, numerics)
        demand = low[rows].max(axis=1)
        return utilisation(demand, self.capacity[which])


@dataclass(frozen=True)
class ScaledFailure:
    """The factors at which each question fails first.

    Attributes
    ----------
    factor : ndarray, shape (v,)
        Of the motion [-]: 0 where at the least one, infinite where at none.
    returns : ndarray of bool, shape (v,)
        Whether it stood again at a larger one; only a yes or no is followed beyond its first failure.
    """

    factor: Array
    returns: NDArray[np.bool_]


def first_failures(questions: Questions, motion: Motion, context: Context, numerics: Numerics) -> ScaledFailure:
    """Scale a motion and return the least factor at which each question fails.

    Demands need not grow with the factor: the least of those tried that fails counts, whatever larger ones do.
    Between two factors a demand is interpolated, straight in logarithms; where it begins between them, the factor is
    the middle of what is left after halving, within 7 %.

    Parameters
    ----------
    questions
        Demands against capacities, (v,) of them.
    motion
        What is scaled.
    context, numerics
        Where histories are run, and how finely.

    Returns
    -------
    Found
        The factors (v,).

    References
    ----------
    Vamvatsikos, D. and Cornell, C. A. (2002), "Incremental dynamic analysis", Earthquake Engineering & Structural
    Dynamics 31(3), 491-514.
    """
    size = questions.capacity.size
    follow = questions.work.model.output(questions.output).unit == "bool"
    used = np.full((len(FACTORS), size), np.nan)
    failed = np.zeros(size, dtype=bool)
    returns = np.zeros(size, dtype=bool)
    for at, factor in enumerate(FACTORS):
        asked = np.arange(size) if follow else np.flatnonzero(~failed)
        if asked.size == 0:
            break
        used[at, asked] = questions.used(_times(motion, factor), asked, context, numerics)
        returns |= failed & (used[at] <= 1.0)
        failed |= used[at] > 1.0
    fails = used > 1.0
    never, at_once, first = ~failed, fails[0], np.argmax(fails, axis=0)
    between = np.flatnonzero(~never & ~at_once)
    logs = np.log(np.array(FACTORS))
    below, above = logs[first[between] - 1], logs[first[between]]
    least, most = used[first[between] - 1, between], used[first[between], between]
    for _ in range(HALVINGS):
        # In the logarithms a step is halved; questions in the same step share their motion.
        for step in np.unique(0.5 * (below + above)):
            asked = np.flatnonzero((0.5 * (below + above) == step) & ~_smooth(below, above, least, most))
            if asked.size == 0:
                continue
            middle = questions.used(_times(motion, float(np.exp(step))), between[asked], context, numerics)
            failed = middle > 1.0
            above[asked[failed]], most[asked[failed]] = step, middle[failed]
            below[asked[~failed]], least[asked[~failed]] = step, middle[~failed]
    share = np.full(between.shape, 0.5)
    told = (least > 0.0) & np.isfinite(most)
    share[told] = -np.log(least[told]) / (np.log(most[told]) - np.log(least[told]))
    least_factors = np.where(never, np.inf, 0.0)
    least_factors[between] = np.exp(below + share * (above - below))
    return ScaledFailure(least_factors, returns)


def _smooth(below: Array, above: Array, least: Array, most: Array) -> NDArray[np.bool_]:
    """Say where a demand is a gentle power of the factor between two of them (logarithms)."""
    with np.errstate(divide="ignore"):
        rise = np.log(most) - np.log(least)
    return np.asarray(rise <= STEEP * (above - below))


def _times(motion: Motion, factor: float) -> Motion:
    return motion.scaled(factor, "to find where it fails")
