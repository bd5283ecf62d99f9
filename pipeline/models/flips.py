"""Doubt of a rocking body: the error of its largest ratio, and whether its fate hangs on too little.

Overturning is not monotone in the amplitude: islands of another outcome lie as close together as one looks.  They lie
where the response jumps from one amplitude to the next: there a body lands before or after a push, or just fails to
fall.  So a body is sensitive where a run at another amplitude has another outcome, and where its response still jumps
between the runs.
"""

from dataclasses import replace
from itertools import pairwise
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from pipeline.kernels.rocking import NEAR, REST, STEP, rocking_batch
from pipeline.models.common import ILL, NUDGE, ROUNDING, Quiet
from pipeline.quantities import Array
from pipeline.records import Excitation

RATIO, FELL, FELL_AT, LIFTED_AT, IMPACTS, FLAGS, LAST_NEAR, RESTED = range(8)
"""Columns of `integrate`, and the first ones of what any `Integration` returns."""

Rows = NDArray[np.bool_] | slice
"""Some of several bodies."""

ALL = slice(None)


class Integration(Protocol):
    """The integration of some of several bodies that rock."""

    def __call__(
        self, motion: Excitation, rows: Rows, refine: int, until: Array | None = None, rest: float = REST
    ) -> Array:
        """Return what is found, (k, 8 or more): refine and rest as in the kernel, until for each of the rows."""
        ...


FAR, HALFWAY = 0.01, 0.005
"""Relative changes of amplitude, either way, that are tried; the second where the first are rough."""

LINGERS = 7.0
"""Time from uplift to falling, times p, up to which a body falls at once, whatever the amplitude."""

HARDEST = 10.0
"""Uplift ratio from which a body is not pushed any harder: where contact is lost it is infinite."""

SMOOTH = (0.003, 0.025)
"""Change of the response over FAR up to which it is smooth: of the largest ratio of a body that stood, times the larger
one, and of the time of falling [s] of a body that fell, over its uplift ratio, as what is pushed hard falls after all.
Chosen, as the next, on 2,500 flips of 20,000 bodies that lifted an edge under seven records."""

JUMP = (0.005, 0.05)
"""The same over HALFWAY, from which it is a jump."""


def integrate(
    motion: Excitation,
    body: Array,
    initial: Array,
    refine: int,
    until: Array | None = None,
    history: Array | None = None,
    rest: float = REST,
) -> Array:
    """Return what `kernels.rocking.rocking_batch` finds.

    Parameters
    ----------
    motion : Excitation
        Along one direction.
    body : ndarray, shape (n, 6)
        As from `models.rigid_body.bodies`.
    initial : ndarray, shape (n,)
        Angle that each is released at [rad].
    refine : int
        As in that kernel.
    until : ndarray, shape (n,), optional
        [s] after which a body that has calmed down is not followed; None: every body is, to the end.
    history : ndarray, shape (k, 1), optional
        Receives the angle of a single body at the samples [rad].
    rest : float
        As in that kernel.

    Returns
    -------
    ndarray, shape (n, 8)
        Columns RATIO, FELL, FELL_AT, LIFTED_AT, IMPACTS, FLAGS, LAST_NEAR and RESTED.
    """
    quiet = Quiet(motion)
    results = np.empty((body.shape[0], 8))
    ends = np.full(body.shape[0], np.inf) if until is None else until
    rocking_batch(
        quiet.x,
        quiet.z,
        quiet.ratio,
        quiet.maxima,
        quiet.dt,
        quiet.peak,
        body,
        initial,
        quiet.tail,
        ends,
        refine,
        rest,
        results,
        np.empty((0, 1)) if history is None else history,
    )
    return results


def flips(
    run: Integration,
    motion: Excitation,
    uplift: Array,
    pace: Array,
    found: Array,
    among: NDArray[np.bool_] | None = None,
) -> NDArray[np.bool_]:
    """Return which bodies may stand instead of fall, or fall instead of stand, within 1 % of the motion's amplitude.

    Parameters
    ----------
    run : callable
        Integrates some of the bodies.
    motion : Excitation
        Along one direction.
    uplift : ndarray, shape (n,)
        Largest uplift ratio [-].
    pace : ndarray, shape (n,)
        p of each, rad/s.
    found : ndarray, shape (n, 8 or more)
        Their own response, as from `run`.
    among : ndarray of bool, shape (n,), optional
        Those that are asked about; None: all.

    Returns
    -------
    ndarray of bool, shape (n,)
        What stays below NEAR, or falls at once, is not asked.

    Notes
    -----
    Of 1,506 flips that 81 amplitudes show it finds 97 of 100, and it says so of 19 of 100 of the other bodies that lift
    an edge, at 44 % of the cost of two integrations (22,400 bodies, seven records, scaled to 0.2 to 0.7 g).  Of 120 of
    those others, in random motions, 16 flip at one of 1,601: the rest fall at another time, or tip to another angle.
    """
    fallen = found[:, FELL] > 0.0
    took = (found[:, FELL_AT] - np.maximum(0.0, found[:, LIFTED_AT])) * pace
    asked = np.where(fallen, took > LINGERS, found[:, RATIO] > NEAR)
    if among is not None:
        asked &= among
    # What fell has to be followed to the end to see that it stands; what stood calms down when it did.
    until = np.where(fallen, np.inf, found[:, LAST_NEAR])

    def at(change: float) -> Array:
        again = found.copy()
        if asked.any():
            scaled = replace(motion, x=(1.0 + change) * motion.x, z=(1.0 + change) * motion.z)
            again[asked] = run(scaled, asked, 1, until[asked])
        return again

    less, more = at(-FAR), at(FAR)
    rough = np.maximum(_apart(less, found, uplift), _apart(found, more, uplift))
    # A change of two jumps over FAR has a jump on one half of it.
    flipped: NDArray[np.bool_] = asked & ((less[:, FELL] != found[:, FELL]) | (more[:, FELL] != found[:, FELL]))
    flipped |= asked & (rough > 2.0 * np.where(fallen, JUMP[1], JUMP[0]))
    asked &= ~flipped & (rough > np.where(fallen, SMOOTH[1], SMOOTH[0]))
    runs = [less, at(-HALFWAY), found, at(HALFWAY), more]
    rough = np.maximum.reduce([_apart(one, other, uplift) for one, other in pairwise(runs)])
    flipped |= asked & (rough > np.where(fallen, JUMP[1], JUMP[0]))
    for other in runs[1::2]:
        flipped |= asked & (other[:, FELL] != found[:, FELL])
    return flipped


def _apart(one: Array, other: Array, uplift: Array) -> Array:
    # How far two responses at neighbouring amplitudes are apart, as SMOOTH says; two times for two that fell.
    tipped = np.abs(one[:, RATIO] - other[:, RATIO]) * np.maximum(one[:, RATIO], other[:, RATIO])
    waited = np.abs(one[:, FELL_AT] - other[:, FELL_AT]) / np.clip(uplift, 1.0, HARDEST)
    apart: Array = np.where((one[:, FELL] > 0.0) & (other[:, FELL] > 0.0), waited, tipped)
    return apart


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
