"""Doubt of a rocking body's numbers: the error of its largest ratio, and whether its fate hangs on too little."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pipeline.kernels.rocking import NEAR, REST, STEP
from pipeline.models.common import ILL, NUDGE, ROUNDING
from pipeline.models.flips import FELL, FELL_AT, LAST_NEAR, RATIO, RESTED, Integration, flips
from pipeline.quantities import Array
from pipeline.records import Excitation

DOUBTFUL = 1e-6
"""Relative difference of two steps from which the condition is measured: below 3e-6 none of 1,600 exceeded 1,000."""

APART = 1e-3
"""Relative difference of two steps from which a body is sensitive, whatever its condition was measured to be."""

WAVERING = 0.02
"""Difference of two steps in the time of falling, times p, from which a body is sensitive: 0.05 or more was that of all
bodies that fell at both and stood at a finer step, 6 of 24,000 under synthetic pulses and recorded motions."""

ONSET = 5.0
"""Condition of a body that barely lifts, times (uplift ratio - 1): its ratio grows with the fifth power of that."""

RESTLESS = 1e-2
"""Share of the usual rate at which a body rests that is tried where a rest may have told on the largest ratio."""

LOCAL = 0.03
"""Relative error of a hop within one step, as a share of (fastest rate x step)^4, at a condition of 1."""

HOP = 0.2
"""The same whatever the condition, as a share of (fastest rate x step)^2: a step leaves out the fifth derivative, p^2
times the third, a twentieth of the cube that the hop is; four times over, as its top is a difference of such terms."""

RISE = 2.0
"""The most of it as a ratio, as a share of (fastest rate x step)^5: a sixtieth of a push that changes by 120 times what
lifts an edge in a time of 1 / p."""


def apart(coarse: Array, fine: Array, pace: Array) -> NDArray[np.bool_]:
    """Return which bodies two steps of integration disagree about: in their outcome, its time, or the largest ratio.

    Parameters
    ----------
    coarse, fine : ndarray, shape (n, 8 or more)
        What a `Integration` found at the one step and at the other.
    pace : ndarray, shape (n,)
        p of each, rad/s.

    Returns
    -------
    ndarray of bool, shape (n,)
        See APART and WAVERING.
    """
    late = np.abs(fine[:, FELL_AT] - coarse[:, FELL_AT]) * pace
    far = np.abs(fine[:, RATIO] - coarse[:, RATIO]) > APART * fine[:, RATIO]
    differ: NDArray[np.bool_] = (coarse[:, FELL] != fine[:, FELL]) | far | (late > WAVERING)
    return differ


def doubt(
    run: Integration, motion: Excitation, refine: int, uplift: Array, pace: Array, coarse: Array, fine: Array
) -> tuple[Array, NDArray[np.bool_]]:
    """Return the error of the largest ratio, and which bodies are sensitive.

    They are so to the step, to a part in a thousand of the motion's amplitude (condition), or to 1 % of it (outcome).
    Only those that could be are integrated again.

    Parameters
    ----------
    run : callable
        Integrates some of the bodies.
    motion : Excitation
        Along one direction.
    refine : int
        Of the coarser step.
    uplift : ndarray, shape (n,)
        Largest uplift ratio [-].
    pace : ndarray, shape (n,)
        p of each, rad/s.
    coarse, fine : ndarray, shape (n, 8 or more)
        What `run` found at that step and at half of it.

    Returns
    -------
    error : ndarray, shape (n,)
        [-].
    sensitive : ndarray of bool, shape (n,)
        As above.
    """
    ratio, fallen = fine[:, RATIO], fine[:, FELL] > 0.0
    error = np.abs(ratio - coarse[:, RATIO])
    # Both steps put a body to rest at the same rate.  What lifts again before it would have rested, as under a push
    # that hardly changes, owes some of its ratio to that rate, or would have tipped by more.
    rested = fine[:, RESTED] > 0.0
    if rested.any():
        longer = run(motion, rested, refine, rest=RESTLESS * REST)
        error[rested] += np.abs(longer[:, RATIO] - coarse[rested, RATIO])
    sensitive = apart(coarse, fine, pace) | (error > APART * ratio)
    # A chaotic sequence of impacts magnifies the error of integration as it does a change of the motion.
    doubtful = ~fallen & ~sensitive & (error > DOUBTFUL * ratio)
    condition = np.divide(ONSET, uplift - 1.0, out=np.ones_like(uplift), where=(uplift > 1.0) & ~fallen)
    if doubtful.any():
        more = replace(motion, x=(1.0 + NUDGE) * motion.x, z=(1.0 + NUDGE) * motion.z)
        # What has calmed down has been at its largest ratio, if that was above what counts as near.
        until = np.where(ratio > NEAR, fine[:, LAST_NEAR], np.inf)[doubtful]
        nudged = run(more, doubtful, refine, until)[:, RATIO]
        measured = np.abs(nudged - coarse[doubtful, RATIO]) / (NUDGE * ratio[doubtful])
        condition[doubtful] = np.maximum(condition[doubtful], measured)
        sensitive[doubtful] |= measured > ILL
    # The hop of a body that barely lifts can lie within one step, which both integrations then take alike.
    step = STEP / (2 * refine)
    local = np.minimum(1.0, LOCAL * step**4 * np.maximum(1.0, condition)) * ratio
    error += np.where(fallen, ROUNDING * ratio, local + np.minimum(HOP * step**2 * ratio, RISE * step**5))
    return error, sensitive | flips(run, motion, uplift, pace, fine, ~sensitive)
