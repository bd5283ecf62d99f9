r"""Rigid pendulum swinging in one vertical plane, its pivot shaken horizontally and vertically.

.. math::

    \theta'' + 2 \zeta w \theta' + \frac{g + a_z}{L} \sin\theta = -\frac{a}{L} \cos\theta, \qquad w = \sqrt{g / L}

with theta [rad] from the vertical, a and a_z [m/s2] the horizontal and the vertical acceleration of the pivot, L [m]
the length of the equivalent simple pendulum, zeta [-] (Agbabian et al. 1991, sec. 2.4: viscous damping and in-plane
vertical excitation included).

Classical Runge-Kutta steps of fourth order that end at every sample, where the excitation has its kinks.  Sine and
cosine of theta are integrated along with it (s' = c theta', c' = -s theta'), so that a step has no transcendental
function in it and several pendulums share the vector registers.
"""

import math

import numpy as np

from pipeline.kernels import CUT, FIRST, UNRESOLVED, bare, fused, inlined, kernel
from pipeline.kernels.lanes import LANES, in_order, lanes, same_steps
from pipeline.kernels.roots import narrowed, trial
from pipeline.quantities import Array, G

CAP = 200.0
"""Seconds after the record at which a pendulum that never turns back is cut off."""

FAINT = 1e-9
"""Share of the peak's energy below which what is left of the swing cannot matter."""

STEP = 0.1
"""Largest step of the integration, in radians of the fastest pendulum motion."""

MOST_STEPS = 300
"""Steps in a sample interval, at a refinement of 1, from which on a pendulum is not followed: 30 radians of its own."""

MOST_AFTER = 1_000_000
"""Steps after the record, at a refinement of 1, at which a pendulum that never turns back is cut off before CAP."""

ASKED = 256
"""Samples after which it is asked whether what is left of the record can still matter."""

CLEAR = 1e-4
"""Share of its speed by which a swing must stay below its peak for the rest to be left: errors of steps are less."""


# Rows of a block of pendulums: the state, the constants 1 / L and 2 zeta w, the state before the step, the largest
# |theta| so far, and how far it may go within the step.
THETA, SINE, COSINE, RATE, CURL, DRAG, OLD, OLD_SINE, OLD_COSINE, OLD_RATE, MOST, REACH = range(12)


@inlined
def _step(
    theta: float,
    s: float,
    c: float,
    rate: float,
    a0: float,
    am: float,
    a1: float,
    n0: float,
    nm: float,
    n1: float,
    h: float,
    curl: float,
    drag: float,
) -> tuple[float, float, float, float]:
    # One classical Runge-Kutta step; a, n: pivot acceleration and g + a_z at its beginning, middle and end.
    # curl = 1 / L, drag = 2 zeta w.
    half, sixth = 0.5 * h, h / 6.0
    k1 = -drag * rate - (n0 * s + a0 * c) * curl
    ds1, dc1 = c * rate, -s * rate
    r2, s2, c2 = rate + half * k1, s + half * ds1, c + half * dc1
    k2 = -drag * r2 - (nm * s2 + am * c2) * curl
    ds2, dc2 = c2 * r2, -s2 * r2
    r3, s3, c3 = rate + half * k2, s + half * ds2, c + half * dc2
    k3 = -drag * r3 - (nm * s3 + am * c3) * curl
    ds3, dc3 = c3 * r3, -s3 * r3
    r4, s4, c4 = rate + h * k3, s + h * ds3, c + h * dc3
    k4 = -drag * r4 - (n1 * s4 + a1 * c4) * curl
    sn = s + sixth * (ds1 + 2.0 * (ds2 + ds3) + c4 * r4)
    cn = c + sixth * (dc1 + 2.0 * (dc2 + dc3) - s4 * r4)
    back = 1.5 - 0.5 * (sn * sn + cn * cn)
    return (
        theta + sixth * (rate + 2.0 * (r2 + r3) + r4),
        sn * back,
        cn * back,
        rate + sixth * (k1 + 2.0 * (k2 + k3) + k4),
    )


@fused
def _turn(
    theta: float,
    s: float,
    c: float,
    rate: float,
    a0: float,
    slope: float,
    n0: float,
    rise: float,
    h: float,
    curl: float,
    drag: float,
    after: float,
) -> float:
    # The angle at which the pendulum turns back within the step (Illinois on the rate).
    # The angle is of second order in the time's error.
    low, high, at_low, at_high, side = 0.0, h, rate, after, 0
    tau, angle = low, theta
    for _ in range(40):
        before, tau = tau, trial(low, high, at_low, at_high)
        angle, _s, _c, value = _step(
            theta,
            s,
            c,
            rate,
            a0,
            a0 + 0.5 * slope * tau,
            a0 + slope * tau,
            n0,
            n0 + 0.5 * rise * tau,
            n0 + rise * tau,
            tau,
            curl,
            drag,
        )
        low, high, at_low, at_high, side = narrowed(low, high, at_low, at_high, side, tau, value)
        if value == 0.0 or abs(tau - before) < 1e-8 * h or at_high == at_low:
            break
    return angle


@fused
def _over(block: Array, gain: float) -> bool:
    # Whether no pendulum of a block can get as far as it was, by energy: the root of it, as a speed, grows by the
    # integral of the pivot's acceleration at most, which is gain [m/s] from here on.
    for k in range(LANES):
        swing = 2.0 * G * block[CURL, k]
        now = math.sqrt(block[RATE, k] ** 2 + swing * max(0.0, 1.0 - block[COSINE, k])) + gain * block[CURL, k]
        most = block[MOST, k]
        if most >= math.pi or now > (1.0 - CLEAR) * math.sqrt(swing * (1.0 - math.cos(most))):
            return False
    return True


@fused
def _shake(x: Array, z: Array, dt: float, pieces: int, gains: Array, block: Array, history: Array) -> None:
    # Integrate a block of LANES pendulums through the record, as far as it matters.  history: theta of the first lane.
    n = x.shape[0]
    h = dt / pieces
    for i in range(n - 1):
        if i % ASKED == 0 and history.shape[0] == 0 and _over(block, gains[i]):
            return
        if i < history.shape[0]:
            history[i, 0] = block[THETA, 0]
        slope, rise = (x[i + 1] - x[i]) / dt, (z[i + 1] - z[i]) / dt
        for j in range(pieces):
            a0, n0 = x[i] + slope * (j * h), G + z[i] + rise * (j * h)
            am, nm = a0 + 0.5 * slope * h, n0 + 0.5 * rise * h
            a1, n1 = a0 + slope * h, n0 + rise * h
            turning = 0
            for k in range(LANES):
                theta, s, c, rate = block[THETA, k], block[SINE, k], block[COSINE, k], block[RATE, k]
                ahead, sn, cn, after = _step(
                    theta, s, c, rate, a0, am, a1, n0, nm, n1, h, block[CURL, k], block[DRAG, k]
                )
                most = max(block[MOST, k], abs(ahead))
                reach = max(abs(theta), abs(ahead)) + h * max(abs(rate), abs(after))
                reach = reach if rate * after < 0.0 else 0.0
                block[OLD, k], block[OLD_SINE, k], block[OLD_COSINE, k], block[OLD_RATE, k] = theta, s, c, rate
                block[THETA, k], block[SINE, k], block[COSINE, k], block[RATE, k] = ahead, sn, cn, after
                block[MOST, k], block[REACH, k] = most, reach
                turning += 1 if reach > most else 0
            if turning > 0:
                for k in range(LANES):
                    if block[REACH, k] > block[MOST, k]:
                        top = _turn(
                            block[OLD, k],
                            block[OLD_SINE, k],
                            block[OLD_COSINE, k],
                            block[OLD_RATE, k],
                            a0,
                            slope,
                            n0,
                            rise,
                            h,
                            block[CURL, k],
                            block[DRAG, k],
                            block[RATE, k],
                        )
                        block[MOST, k] = max(block[MOST, k], abs(top))
    if n - 1 < history.shape[0]:
        history[n - 1, 0] = block[THETA, 0]


@fused
def _coast(
    theta: float, rate: float, most: float, length: float, zeta: float, tail: float, refine: int
) -> tuple[float, float]:
    # After the record the energy cannot grow: the next turning point, or an energy below the peak's, ends it.
    w = math.sqrt(G / length)
    drag = 2.0 * zeta * w
    s, c = math.sin(theta), math.cos(theta)
    h = 0.8 * STEP / (w * (1.0 + 2.0 * zeta)) / refine
    stop = min(tail if tail >= 0.0 else CAP, MOST_AFTER * refine * h)
    cut = tail < 0.0 or stop < tail
    t = 0.0
    while t < stop:
        if tail < 0.0:
            lift = 2.0 * math.sin(0.5 * min(most, math.pi)) ** 2
            left = 0.5 * rate * rate / (w * w) + 2.0 * math.sin(0.5 * theta) ** 2
            if left <= lift * (1.0 - FAINT) or left == 0.0:
                return most, 0.0
        now = min(h, stop - t)
        ahead, sn, cn, after = _step(theta, s, c, rate, 0.0, 0.0, 0.0, G, G, G, now, 1.0 / length, drag)
        if rate * after < 0.0:
            top = _turn(theta, s, c, rate, 0.0, 0.0, G, 0.0, now, 1.0 / length, drag, after)
            most = max(most, abs(top))
            if tail < 0.0:
                return most, 0.0
        most = max(most, abs(ahead))
        theta, s, c, rate = ahead, sn, cn, after
        t += now
    return most, float(CUT) if cut else 0.0


@bare
def substeps(length: float, zeta: float, peak: float, dt: float) -> int:
    """Return how many steps a sample interval takes.

    Parameters
    ----------
    length : float
        L, m.
    zeta : float
        Damping ratio [-].
    peak : float
        The largest acceleration of the pivot, m/s2.
    dt : float
        Sample interval, s.

    Returns
    -------
    int
        0 for more than are taken.
    """
    steps = math.sqrt((G + peak) / length) * (1.0 + 2.0 * zeta) * dt / STEP
    return max(1, math.ceil(steps)) if steps <= MOST_STEPS else 0


@kernel
def pendulum_batch(
    x: Array,
    z: Array,
    dt: float,
    peak: float,
    length: Array,
    zeta: Array,
    tail: float,
    refine: int,
    results: Array,
    history: Array,
) -> None:
    r"""Follow m pendulums in one vertical plane.

    .. math::

        \theta'' + 2 \zeta w \theta' + \frac{g + a_z}{L} \sin\theta = -\frac{a}{L} \cos\theta, \qquad w = \sqrt{g / L}

    Lanes do not mix: a result is the same to the last bit in any company.

    Parameters
    ----------
    x, z : ndarray, shape (n,)
        Horizontal (a) and vertical (a_z) acceleration of the pivot, m/s2, linear between samples.
    dt : float
        Time step, s.
    peak : float
        The largest acceleration of the pivot, m/s2.
    length, zeta : ndarray, shape (m,)
        L [m] and damping ratio [-].
    tail : float
        Seconds to go on after the record; below 0: until past the peak, or CAP.
    refine : int
        By what the standard step is divided; the error falls with its fourth power.
    results : ndarray, shape (m, 2)
        Receives the largest ``|theta|`` [rad] and the flags (`pipeline.kernels`); NaN where it is not followed.
    history : ndarray, shape (k, 1)
        Receives theta [rad] of a single pendulum at the samples, as long as it is.

    References
    ----------
    Agbabian, M. S., Ginell, W. S., Masri, S. F. and Nigbor, R. L. (1991). Evaluation of earthquake damage mitigation
    methods for museum objects. Studies in Conservation 36. Sec. 2.4.
    """
    m = length.shape[0]
    results[:, :] = 0.0
    if x.shape[0] < 2:
        return
    pieces, order, spare = np.empty(m, np.int64), np.empty(m, np.int64), np.empty(m, np.int64)
    for k in range(m):
        pieces[k] = substeps(length[k], zeta[k], peak, dt) * refine
    in_order(pieces, order, spare)
    gains = np.zeros(x.shape[0])
    for i in range(x.shape[0] - 2, -1, -1):
        gains[i] = gains[i + 1] + 0.5 * dt * (math.hypot(x[i], z[i]) + math.hypot(x[i + 1], z[i + 1]))
    block = lanes(12)
    begin = FIRST
    while begin < m:
        end = same_steps(pieces, order, begin)
        block[:] = 0.0
        for k in range(LANES):
            one = order[min(begin + k, end - 1)]
            block[COSINE, k] = 1.0
            block[CURL, k] = 1.0 / length[one]
            block[DRAG, k] = 2.0 * zeta[one] * math.sqrt(G / length[one])
        if pieces[order[begin]] == 0:
            for k in range(end - begin):
                results[order[begin + k], 0], results[order[begin + k], 1] = math.nan, float(UNRESOLVED)
            begin = end
            continue
        _shake(x, z, dt, pieces[order[begin]], gains, block, history)
        for k in range(end - begin):
            one = order[begin + k]
            results[one, 0], results[one, 1] = _coast(
                block[THETA, k], block[RATE, k], block[MOST, k], length[one], zeta[one], tail, refine
            )
        begin = end
