"""Fling steps: permanent displacements that the high-pass of a raw record takes away, and PGV with them."""

from __future__ import annotations

import numpy as np

from pipeline.errors import InputError
from pipeline.motions.baseline import remove_pre_event_mean, two_segment_baseline
from pipeline.motions.doubts import MAY_HOLD
from pipeline.motions.intensity import integrate, strong_part
from pipeline.motions.onset import first_arrival
from pipeline.motions.plausibility import PGD_MOST
from pipeline.quantities import Array
from pipeline.records import Motion

PGV_RATIO = 1.1
"""PGV with the step over that without it from which it is told (judgement: what a corner is doubted from is half)."""

LEAST_PGV = 0.2
"""m/s with the step: weaker motions are no near-fault ones, and a drift of noise has as much (judgement)."""

LEAST_STEP = 0.15
"""m that remain: the two segments make up to 0.13 m of a tilt of 0.015 m/s2 alone (judgement)."""

FLAT = 0.05
"""Share of the step by which what remains may wander behind the shaking (judgement)."""

TILTED = 0.3
"""Velocity that a shift of the level makes in half of the strong part, over the PGV, from which the sensor moved.

With less the PGV with the step is within 15 % of the true one; with more, without any step, 1.3 to 3.3 times too large.
"""

LAST = 0.1
"""Share of a record at its end whose level is compared with that before the event (judgement)."""

QUIET = 2.0
"""s before the first arrival from which the level of the record at rest is known."""

_KEEPS = 'baseline = { method = "two-segment" } and pre_event_s in the manifest keep the step'


def fling_step(recorded: Motion, filtered: Motion, pre_event: float | None = None) -> str | None:
    """Say that a raw record may hold a permanent displacement that its filtered motion has not, or a sensor that moved.

    The level before the event and a two-segment baseline keep it: where the horizontal displacement then comes to a
    level and stays there, and the PGV is larger by PGV_RATIO, it is told.  Where the levels before and after are too
    far apart for that (TILTED), a step cannot be told from a sensor that tilted or was knocked, and that is told.

    Parameters
    ----------
    recorded, filtered : Motion
        Of the same samples, before any baseline and after the high-pass.
    pre_event : float or None
        Seconds of rest at the start; None: up to the first arrival, where one is found.

    Returns
    -------
    str or None
        A sentence with both PGVs and what remains, or with both levels.

    Notes
    -----
    Error: of 73 motions with steps of 0.5 to 2 m within 2 to 5 s, amid shaking of 0.4 g with noise, half of them with
    a tilt of 0.01 m/s2, whose PGV the high-pass made 11 to 34 % too small, 66 are told, and the PGV that is told is
    within 8 % of the true one.  What remains is a rough number: up to 54 % off, and with the tilt up to 78 % too small.
    Of 48 motions without a step and with tilts of up to 0.02 m/s2 three are told; of 12 with up to 0.04 m/s2, seven,
    and since TILTED most of these as a sensor that moved.

    References
    ----------
    Iwan et al. (1985) and Boore (2001), see `two_segment_baseline`; Kalkan, E. and Kunnath, S. K. (2006), Effects of
    fling step and forward directivity on seismic response of buildings, Earthquake Spectra 22, 367-390.
    """
    rest = first_arrival(recorded) if pre_event is None else pre_event
    if rest is None or rest < QUIET:
        return None
    without, shaken = float(np.abs(integrate(filtered)[0][:2]).max()), strong_part(filtered)
    if said := _moved(recorded, rest, 0.5 * (shaken[1] - shaken[0]), without):
        return said
    try:
        kept = two_segment_baseline(remove_pre_event_mean(recorded, rest))
    except InputError:  # too short an end to fit
        return None
    v, u = integrate(kept)
    row = int(np.argmax(np.abs(v[:2]).max(axis=1)))
    pgv = float(np.abs(v[row]).max())
    step, wander = _remaining(u[row], int(shaken[1] / recorded.dt))
    if pgv < max(LEAST_PGV, PGV_RATIO * without) or not LEAST_STEP <= abs(step) <= PGD_MOST:
        return None
    if wander > FLAT * abs(step):
        return None
    return (
        f"{MAY_HOLD}a permanent displacement (fling step), or its sensor tilted: with its level before the event and a "
        f"two-segment baseline the PGV of its larger horizontal channel is {100.0 * pgv:.3g} cm/s and "
        f"{100.0 * abs(step):.3g} cm remain; after the high-pass it is {100.0 * without:.3g} cm/s.  {_KEEPS}"
    )


def _moved(recorded: Motion, rest: float, lasts: float, pgv: float) -> str | None:
    """Say that a horizontal level after the event is so far from that before that no step can be told from it."""
    rows, n = recorded.acceleration[:2], recorded.samples
    before = np.median(rows[:, : max(int(rest / recorded.dt), 1)], axis=1)
    after = np.median(rows[:, n - max(int(LAST * n), 1) :], axis=1)
    row = int(np.argmax(np.abs(after - before)))
    if abs(after[row] - before[row]) * lasts <= TILTED * pgv:
        return None
    return (
        f"{MAY_HOLD}a shift of its level, as of a sensor that tilted or was knocked: of one horizontal channel it is "
        f"{before[row]:.2g} m/s2 before the event and {after[row]:.2g} m/s2 at the end, and its PGV and PGD may be "
        f"wrong.  Look at the PGV that its steps give at other corners, or take another record"
    )


def _remaining(u: Array, shaken: int) -> tuple[float, float]:
    """The level of a displacement behind the strong shaking, and how far it goes from it, as a standard deviation."""
    tail = u[shaken + (u.size - shaken) // 4 :]
    return (float(tail.mean()), float(tail.std())) if tail.size else (0.0, 0.0)
