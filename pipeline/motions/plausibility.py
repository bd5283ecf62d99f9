"""Plausibility of a record: what is outside of what earthquakes do is doubted, and a person is asked."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pipeline.motions.doubts import TOO_QUICK
from pipeline.motions.errors import Judgement
from pipeline.motions.intensity import integrate, measures
from pipeline.quantities import Array, G
from pipeline.records import Motion

PGA = (0.002 * G, 3.0 * G)
"""m/s2 of the larger horizontal that pass: weaker ones move nothing in a museum, and of stronger ones there are few."""

LEAST = 1e-9 * G
"""m/s2: a component that peaks below it holds something else than the acceleration of an earthquake."""

PGV = (0.001, 4.0)
"""m/s of the larger horizontal that pass; the largest ever recorded is about 3.2 (Chi-Chi 1999, TCU068)."""

VELOCITY_TO_ACCELERATION = (0.005, 1.0)
"""s: PGV over PGA that passes.  Records have 0.02 to 0.4, near-fault ones up to 0.75 (judgement)."""

QUICK = 0.015
"""s: PGV over PGA below which it is doubted aloud, though it passes (judgement): a time step ten times too small."""

LONGEST_PERIOD = 2.5
"""s: mean period (Rathje et al. 1998) that passes alone; longer with LONG_RATIO, a velocity was taken for acceleration.

The bed of Mexico City's lake has about 2; the velocity of large earthquakes has 2.8 and more.
"""

LONG_RATIO = 0.35
"""s: PGV over PGA above which a longer mean period is doubted."""

PGD_MOST = 10.0
"""m of a processed record; the largest permanent displacement recorded is about 10."""

OFFSET = 0.05
"""Mean of a vertical [g] that no processed record has (judgement): a logger's has 1."""

RESIDUAL = 0.2
"""Most mean velocity in the last tenth of a processed record relative to its PGV.

Records as agencies publish them, integrated from rest, have up to 0.1; a raw one called processed drifts to its end.
"""


@dataclass(frozen=True, slots=True)
class Implausibility:
    """Something that a person must judge.

    Attributes
    ----------
    judgement : str
        The name under which it may be accepted.
    wrong : str
        What is doubtful.
    remedy : str
        What may be the cause, and mends it.
    """

    judgement: Judgement
    wrong: str
    remedy: str


def doubt_recorded(data: Array) -> Implausibility | None:
    """Doubt the size of what was recorded, before anything is filtered or scaled.

    Parameters
    ----------
    data : array, shape (3, n)
        In m/s2, as recorded, the horizontals first.

    Returns
    -------
    Implausibility or None
    """
    # About the median, because a raw accelerometer carries an offset that is not shaking.
    peaks = np.abs(data - np.median(data, axis=1, keepdims=True)).max(axis=1)
    low, high = (bound / G for bound in PGA)
    which, peak = "larger horizontal", float(peaks[:2].max())
    if tiny := [row for row in range(3) if 0.0 < peaks[row] < LEAST]:
        which, peak = "xyz"[tiny[0]], float(peaks[tiny[0]])
    elif peaks.max() > PGA[1]:
        which, peak = "xyz"[int(np.argmax(peaks))], float(peaks.max())
    elif not 0.0 < peak < PGA[0]:
        return None
    return Implausibility(
        "size",
        f"its {which} component peaks at {peak / G:.3g} g, outside of {low:g} to {high:g} g",
        "this looks like a wrong unit or sensitivity, or too small a shaking: mend the unit or the response",
    )


def doubt_motion(motion: Motion, *, velocity: Array | None, processed: bool) -> Implausibility | None:
    """Doubt a motion by its velocity, its shape and what it leaves at its end, before it is scaled.

    Parameters
    ----------
    motion : Motion
        Filtered here or long ago.
    velocity : array, shape (3, n), or None
        In m/s as its agency computed it.
    processed : bool
        Whether its source filtered it: then nothing may drift.

    Returns
    -------
    Implausibility or None
        The gravest.
    """
    if not motion.acceleration[:2].any():
        return None
    v, u = integrate(motion)
    v = v if velocity is None else velocity
    pgv = float(np.abs(v[:2]).max())
    if processed and (said := _residual(motion, v, u)):
        remedy = (
            "this looks like a raw record: give processed = false in the manifest (--raw), or the agency's processed "
            "files"
        )
        return Implausibility("drift", said, remedy)
    if not PGV[0] <= pgv <= PGV[1]:
        low, high = (100.0 * bound for bound in PGV)
        return Implausibility(
            "size",
            f"its PGV is {100.0 * pgv:.3g} cm/s, outside of {low:g} to {high:g} cm/s",
            "this looks like a wrong unit, a drift or too small a shaking: mend the unit, the response or highpass_hz",
        )
    ratio, period = pgv / measures(motion)["pga"], mean_period(motion)
    low, high = VELOCITY_TO_ACCELERATION
    if low <= ratio <= high and (period <= LONGEST_PERIOD or ratio <= LONG_RATIO):
        return None
    return Implausibility(
        "size",
        f"its PGV over its PGA is {ratio:.3g} s and its mean period {period:.3g} s, which no acceleration of an "
        f"earthquake has",
        "this looks like velocity or displacement called acceleration, or a wrong time step: mend the unit "
        "or the response",
    )


def quick(motion: Motion) -> str | None:
    """Say that a motion has too little velocity for its acceleration; None where it has enough.

    Parameters
    ----------
    motion : Motion
        As of `doubt_motion`, which lets it pass.

    Returns
    -------
    str or None
    """
    peaks = measures(motion)
    if not 0.0 < peaks["pgv"] < QUICK * peaks["pga"]:
        return None
    return f"its PGV over its PGA is {peaks['pgv'] / peaks['pga']:.3g} s, below {QUICK:g} s{TOO_QUICK}"


def mean_period(motion: Motion) -> float:
    """Return the mean period of the stronger horizontal component in s, from 0.1 to 20 Hz.

    Parameters
    ----------
    motion : Motion
        What is looked at.

    Returns
    -------
    float
        0 where it has nothing between.

    References
    ----------
    Rathje, E. M., Abrahamson, N. A. and Bray, J. D. (1998), Simplified frequency content estimates of earthquake ground
    motions, JGGE 124, 150-159: the sum of C^2 / f over that of C^2.
    """
    row = motion.acceleration[int(np.argmax(np.abs(motion.acceleration[:2]).max(axis=1)))]
    power = np.abs(np.fft.rfft(row)) ** 2
    f = np.fft.rfftfreq(row.size, motion.dt)
    inside = (f >= 0.1) & (f <= 20.0)
    total = float(power[inside].sum())
    return float((power[inside] / f[inside]).sum()) / total if total > 0.0 else 0.0


def _residual(motion: Motion, v: Array, u: Array) -> str:
    n = motion.samples
    peaks = np.abs(v[:2]).max(axis=1)
    left = np.abs(v[:2, int(0.9 * n) :].mean(axis=1))
    row = int(np.argmax(left))
    if left[row] > RESIDUAL * peaks[row]:
        return (
            f"it is called processed, and in the last tenth the velocity of its {'xy'[row]} component is still "
            f"{100.0 * left[row]:.3g} cm/s, {left[row] / peaks[row]:.0%} of its peak, more than {RESIDUAL:.0%}"
        )
    pgd = float(np.abs(u[:2]).max())
    if pgd > PGD_MOST:
        return f"it is called processed, and its displacement reaches {pgd:.3g} m, more than {PGD_MOST:g} m"
    # A drift of the vertical moves nothing; an offset is a part of what holds things down.
    mean = float(motion.acceleration[2].mean()) / G
    if abs(mean) > OFFSET:
        return f"it is called processed, and the mean of its vertical is {mean:.3g} g: gravity may be in it"
    return ""
