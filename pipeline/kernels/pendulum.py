"""A rigid pendulum swinging in one vertical plane, its pivot shaken horizontally and vertically.

theta'' + 2 zeta w theta' + ((g + a_z) / L) sin theta = -(a / L) cos theta,  w = sqrt(g / L)
(Agbabian et al. 1991, sec. 2.4: viscous damping and in-plane vertical excitation included).
"""

import math

import numpy as np

from pipeline.kernels import kernel
from pipeline.kernels.flags import CUT
from pipeline.quantities import Array, G

CAP = 200.0
"""Seconds after the record at which a pendulum that never turns back is cut off."""

FAINT = 1e-9
"""Share of the peak's energy below which what is left of the swing cannot matter."""


@kernel
def _bend(theta: float, rate: float, a: float, n: float, length: float, c: float) -> float:
    return -c * rate - (n * math.sin(theta) + a * math.cos(theta)) / length


@kernel
def _step(
    theta: float, rate: float, a0: float, a1: float, n0: float, n1: float, t: float, h: float, length: float, c: float
) -> tuple[float, float]:
    half = 0.5 * h
    am, nm = a0 + a1 * (t + half), n0 + n1 * (t + half)
    k1 = _bend(theta, rate, a0 + a1 * t, n0 + n1 * t, length, c)
    r2 = rate + half * k1
    k2 = _bend(theta + half * rate, r2, am, nm, length, c)
    r3 = rate + half * k2
    k3 = _bend(theta + half * r2, r3, am, nm, length, c)
    r4 = rate + h * k3
    k4 = _bend(theta + h * r3, r4, a0 + a1 * (t + h), n0 + n1 * (t + h), length, c)
    return theta + h / 6.0 * (rate + 2.0 * (r2 + r3) + r4), rate + h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4)


@kernel
def _turn(
    theta: float, rate: float, a0: float, a1: float, n0: float, n1: float, t: float, h: float, length: float, c: float,
    after: float,
) -> float:
    # The angle at which the pendulum turns back within the step (Illinois on the rate).
    low, high, at_low, at_high = 0.0, h, rate, after
    side = 0
    angle = theta
    for _ in range(40):
        tau = (low * at_high - high * at_low) / (at_high - at_low)
        if not low < tau < high:
            tau = 0.5 * (low + high)
        angle, value = _step(theta, rate, a0, a1, n0, n1, t, tau, length, c)
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
    return angle


@kernel
def pendulum_one(
    x: Array, z: Array, dt: float, peak: float, length: float, zeta: float, tail: float, refine: int, history: Array
) -> tuple[float, float]:
    """Integrate one pendulum and return (max |theta| [rad], flags).

    x, z    : (n,) m/s2;  peak: the largest acceleration of the pivot
    history : (m, 1) receives theta at the samples, as long as it is
    """
    n = x.shape[0]
    if n < 2:
        return 0.0, 0.0
    w = math.sqrt(G / length)
    c = 2.0 * zeta * w
    fastest = math.sqrt((G + peak) / length) * (1.0 + 2.0 * zeta)
    pieces = max(1, int(math.ceil(fastest * dt / 0.05))) * refine
    step = dt / pieces
    theta, rate, most = 0.0, 0.0, 0.0
    for i in range(n - 1):
        if i < history.shape[0]:
            history[i, 0] = theta
        a1, n0, n1 = (x[i + 1] - x[i]) / dt, G + z[i], (z[i + 1] - z[i]) / dt
        for j in range(pieces):
            t = j * step
            ahead, after = _step(theta, rate, x[i], a1, n0, n1, t, step, length, c)
            if rate * after < 0.0 and max(abs(theta), abs(ahead)) + step * max(abs(rate), abs(after)) > most:
                most = max(most, abs(_turn(theta, rate, x[i], a1, n0, n1, t, step, length, c, after)))
            most = max(most, abs(ahead))
            theta, rate = ahead, after
    if n - 1 < history.shape[0]:
        history[n - 1, 0] = theta
    # After the record the energy cannot grow: the next turning point, or an energy below the peak's, ends it.
    stop = tail if tail >= 0.0 else CAP
    h = 0.04 / (w * (1.0 + 2.0 * zeta)) / refine
    t = 0.0
    while t < stop:
        if tail < 0.0:
            lift = 1.0 - math.cos(min(most, math.pi))
            left = 0.5 * rate * rate / (w * w) + 1.0 - math.cos(theta)
            if left <= lift * (1.0 - FAINT) or left == 0.0:
                return most, 0.0
        now = min(h, stop - t)
        ahead, after = _step(theta, rate, 0.0, 0.0, G, 0.0, 0.0, now, length, c)
        if rate * after < 0.0:
            most = max(most, abs(_turn(theta, rate, 0.0, 0.0, G, 0.0, 0.0, now, length, c, after)))
            if tail < 0.0:
                return most, 0.0
        most = max(most, abs(ahead))
        theta, rate = ahead, after
        t += now
    return most, float(CUT) if tail < 0.0 else 0.0


@kernel
def pendulum_batch(
    x: Array, z: Array, dt: float, peak: float, length: Array, zeta: Array, tail: float, refine: int, results: Array
) -> None:
    """Fill results (m, 2): max |theta| [rad], flags."""
    nothing = np.empty((0, 1))
    for k in range(length.shape[0]):
        results[k, 0], results[k, 1] = pendulum_one(x, z, dt, peak, length[k], zeta[k], tail, refine, nothing)
