"""A rigid pendulum free to swing in all directions, such as a chandelier, without a singularity at rest.

q is the unit vector from the pivot to the mass: q'' = -|q'|^2 q + (I - q q^T) f - 2 zeta w q',
f = -(a_x, a_y, g + a_z) / L,  w = sqrt(g / L).
"""

import math

import numpy as np

from pipeline.kernels import kernel
from pipeline.kernels.flags import CUT
from pipeline.quantities import Array, G

STEP = 0.1
"""Largest step of the integration, in radians of the fastest pendulum motion."""

CAP = 200.0
"""Seconds after the record at which a pendulum that never turns back is cut off."""


@kernel
def _bend(q: Array, r: Array, fx: float, fy: float, fz: float, c: float, out: Array) -> None:
    along = fx * q[0] + fy * q[1] + fz * q[2] + r[0] * r[0] + r[1] * r[1] + r[2] * r[2]
    out[0] = fx - along * q[0] - c * r[0]
    out[1] = fy - along * q[1] - c * r[1]
    out[2] = fz - along * q[2] - c * r[2]


@kernel
def _step(s: Array, load: Array, t: float, h: float, length: float, c: float, k: Array, after: Array) -> None:
    # One classical Runge-Kutta step of (q, q'); load: x0, x1, y0, y1, n0, n1 with n = g + a_z.
    half = 0.5 * h
    for stage in range(4):
        at = t if stage == 0 else (t + h if stage == 3 else t + half)
        reach = 0.0 if stage == 0 else (h if stage == 3 else half)
        for i in range(3):
            if stage == 0:
                k[9, i], k[8, i] = s[i], s[3 + i]
            else:
                k[9, i] = s[i] + reach * k[4 + stage - 1, i]
                k[8, i] = s[3 + i] + reach * k[stage - 1, i]
            k[4 + stage, i] = k[8, i]
        fx = -(load[0] + load[1] * at) / length
        fy = -(load[2] + load[3] * at) / length
        fz = -(load[4] + load[5] * at) / length
        _bend(k[9], k[8], fx, fy, fz, c, k[stage])
    for i in range(3):
        after[i] = s[i] + h / 6.0 * (k[4, i] + 2.0 * (k[5, i] + k[6, i]) + k[7, i])
        after[3 + i] = s[3 + i] + h / 6.0 * (k[0, i] + 2.0 * (k[1, i] + k[2, i]) + k[3, i])


@kernel
def _normalise(s: Array) -> None:
    # Back onto the sphere: the horizontal part is the result, so the vertical part takes the correction.
    size = math.sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2])
    for i in range(3):
        s[i] /= size
    along = s[0] * s[3] + s[1] * s[4] + s[2] * s[5]
    for i in range(3):
        s[3 + i] -= along * s[i]


@kernel
def _turn(
    s: Array,
    load: Array,
    t: float,
    h: float,
    length: float,
    c: float,
    k: Array,
    trial: Array,
    begin: float,
    end: float,
) -> float:
    # The radius [-] at its stationary point within the step.
    low, high, at_low, at_high = 0.0, h, begin, end
    side = 0
    for _ in range(40):
        tau = (low * at_high - high * at_low) / (at_high - at_low)
        if not low < tau < high:
            tau = 0.5 * (low + high)
        _step(s, load, t, tau, length, c, k, trial)
        value = trial[0] * trial[3] + trial[1] * trial[4]
        if value == 0.0 or high - low < 1e-10 * h:
            break
        if (value > 0.0) == (at_high > 0.0):
            high, at_high = tau, value
            if side == 1:
                at_low *= 0.5
            side = 1
        else:
            low, at_low = tau, value
            if side == -1:
                at_high *= 0.5
            side = -1
        if at_high == at_low:
            break
    return math.hypot(trial[0], trial[1])


@kernel
def spherical_one(
    x: Array,
    y: Array,
    z: Array,
    dt: float,
    peak: float,
    length: float,
    zeta: float,
    tail: float,
    refine: int,
    history: Array,
) -> tuple[float, float]:
    """Integrate one pendulum and return (max horizontal displacement / L [-], flags).

    x, y, z : (n,) m/s2;  peak: the largest acceleration of the pivot
    history : (m, 2) receives the horizontal displacement / L at the samples, as long as it is
    """
    n = x.shape[0]
    if n < 2:
        return 0.0, 0.0
    w = math.sqrt(G / length)
    c = 2.0 * zeta * w
    fastest = math.sqrt((G + peak) / length) * (1.0 + 2.0 * zeta)
    pieces = max(1, math.ceil(fastest * dt / STEP)) * refine
    step = dt / pieces
    s, after, trial, load, k = np.zeros(6), np.zeros(6), np.zeros(6), np.zeros(6), np.zeros((10, 3))
    s[2] = -1.0
    most = 0.0
    for i in range(n - 1):
        if i < history.shape[0]:
            history[i, 0], history[i, 1] = s[0], s[1]
        load[0], load[1] = x[i], (x[i + 1] - x[i]) / dt
        load[2], load[3] = y[i], (y[i + 1] - y[i]) / dt
        load[4], load[5] = G + z[i], (z[i + 1] - z[i]) / dt
        for j in range(pieces):
            t = j * step
            _step(s, load, t, step, length, c, k, after)
            begin, end = s[0] * s[3] + s[1] * s[4], after[0] * after[3] + after[1] * after[4]
            radius = math.hypot(after[0], after[1])
            if begin > 0.0 > end and max(radius, math.hypot(s[0], s[1])) + step * math.hypot(s[3], s[4]) > most:
                most = max(most, _turn(s, load, t, step, length, c, k, trial, begin, end))
            most = max(most, radius)
            s[:] = after
            _normalise(s)
    if n - 1 < history.shape[0]:
        history[n - 1, 0], history[n - 1, 1] = s[0], s[1]
    stop = tail if tail >= 0.0 else CAP
    h = 0.8 * STEP / (w * (1.0 + 2.0 * zeta)) / refine
    load[:] = 0.0
    load[4] = G
    t, turns = 0.0, 0
    while t < stop:
        speed2 = s[3] * s[3] + s[4] * s[4] + s[5] * s[5]
        if tail < 0.0:
            # Energy as a height above the lowest point, in lengths.  In free swing it cannot grow, so a peak higher
            # than it is final; in an undamped ellipse the largest radius comes within two turns.
            left = 0.5 * speed2 / (w * w) + _height(s)
            lift = most * most / (1.0 + math.sqrt(max(0.0, 1.0 - most * most)))
            if left <= lift * (1.0 - 1e-9) or left == 0.0 or turns >= 3:
                return min(most, 1.0), 0.0
        now = min(h, stop - t)
        _step(s, load, 0.0, now, length, c, k, after)
        begin, end = s[0] * s[3] + s[1] * s[4], after[0] * after[3] + after[1] * after[4]
        if begin > 0.0 > end:
            most = max(most, _turn(s, load, 0.0, now, length, c, k, trial, begin, end))
            turns += 1
        most = max(most, math.hypot(after[0], after[1]))
        s[:] = after
        _normalise(s)
        t += now
    return min(most, 1.0), float(CUT) if tail < 0.0 else 0.0


@kernel
def _height(s: Array) -> float:
    # 1 + q_z without cancellation near the lowest point.
    r2 = s[0] * s[0] + s[1] * s[1]
    return r2 / (1.0 - s[2]) if s[2] < 0.0 else 1.0 + s[2]


@kernel
def spherical_batch(
    x: Array,
    y: Array,
    z: Array,
    dt: float,
    peak: float,
    length: Array,
    zeta: Array,
    tail: float,
    refine: int,
    results: Array,
) -> None:
    """Fill results (m, 2): max horizontal displacement / L [-], flags."""
    nothing = np.empty((0, 2))
    for k in range(length.shape[0]):
        results[k, 0], results[k, 1] = spherical_one(x, y, z, dt, peak, length[k], zeta[k], tail, refine, nothing)
