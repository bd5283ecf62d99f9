r"""Rigid pendulum free to swing in all directions, such as a chandelier, without a singularity at rest.

With q [-] the unit vector from the pivot to the mass,

.. math::

    q'' = -|q'|^2 q + (I - q q^T) f - 2 \zeta w q', \qquad f = -\frac{(a_x, a_y, g + a_z)}{L}, \quad w = \sqrt{g / L}

with a [m/s2] the acceleration of the pivot, L [m] the length of the equivalent simple pendulum and zeta [-] the damping
ratio.  Classical Runge-Kutta steps of fourth order that end at every sample.
"""

import math

import numpy as np

from pipeline.kernels import CUT, FIRST, UNRESOLVED, inlined, inner, kernel
from pipeline.kernels.lanes import LANES, in_order, lanes, same_steps
from pipeline.kernels.pendulum import CAP, MOST_AFTER, STEP, substeps
from pipeline.kernels.roots import narrowed, trial
from pipeline.quantities import Array, G

State = tuple[float, float, float, float, float, float]
Load = State

# Rows of a block: q, q', 1 / L, 2 zeta w, then q, q' after the step, the largest square of the radius so far, and a
# bound of it within the step.
CURL, DRAG, MOST, REACH = 6, 7, 14, 15


@inlined
def _bend(
    q1: float, q2: float, q3: float, r1: float, r2: float, r3: float, f1: float, f2: float, f3: float, drag: float
) -> tuple[float, float, float]:
    along = (f1 * q1 + f2 * q2 + f3 * q3) + (r1 * r1 + r2 * r2 + r3 * r3)
    return f1 - along * q1 - drag * r1, f2 - along * q2 - drag * r2, f3 - along * q3 - drag * r3


@inlined
def _step(
    q1: float,
    q2: float,
    q3: float,
    r1: float,
    r2: float,
    r3: float,
    x0: float,
    y0: float,
    n0: float,
    xm: float,
    ym: float,
    nm: float,
    x1: float,
    y1: float,
    n1: float,
    h: float,
    curl: float,
    drag: float,
) -> State:
    # One classical Runge-Kutta step of (q, q'), then back onto the sphere.
    # x, y, n: pivot acceleration and g + a_z at its beginning, middle and end.  curl = 1 / L, drag = 2 zeta w.
    half, sixth = 0.5 * h, h / 6.0
    a1, a2, a3 = _bend(q1, q2, q3, r1, r2, r3, -x0 * curl, -y0 * curl, -n0 * curl, drag)
    s1, s2, s3 = r1 + half * a1, r2 + half * a2, r3 + half * a3
    f1, f2, f3 = -xm * curl, -ym * curl, -nm * curl
    b1, b2, b3 = _bend(q1 + half * r1, q2 + half * r2, q3 + half * r3, s1, s2, s3, f1, f2, f3, drag)
    t1, t2, t3 = r1 + half * b1, r2 + half * b2, r3 + half * b3
    c1, c2, c3 = _bend(q1 + half * s1, q2 + half * s2, q3 + half * s3, t1, t2, t3, f1, f2, f3, drag)
    u1, u2, u3 = r1 + h * c1, r2 + h * c2, r3 + h * c3
    d1, d2, d3 = _bend(q1 + h * t1, q2 + h * t2, q3 + h * t3, u1, u2, u3, -x1 * curl, -y1 * curl, -n1 * curl, drag)
    p1 = q1 + sixth * (r1 + 2.0 * (s1 + t1) + u1)
    p2 = q2 + sixth * (r2 + 2.0 * (s2 + t2) + u2)
    p3 = q3 + sixth * (r3 + 2.0 * (s3 + t3) + u3)
    v1 = r1 + sixth * (a1 + 2.0 * (b1 + c1) + d1)
    v2 = r2 + sixth * (a2 + 2.0 * (b2 + c2) + d2)
    v3 = r3 + sixth * (a3 + 2.0 * (b3 + c3) + d3)
    back = 1.5 - 0.5 * (p1 * p1 + p2 * p2 + p3 * p3)
    p1, p2, p3 = p1 * back, p2 * back, p3 * back
    out = p1 * v1 + p2 * v2 + p3 * v3
    return p1, p2, p3, v1 - out * p1, v2 - out * p2, v3 - out * p3


@inner
def _advance(s: State, load: Load, h: float, curl: float, drag: float) -> State:
    # load: x, y, n at the beginning and their rates.
    x0, y0, n0, x1, y1, n1 = load
    half = 0.5 * h
    return _step(
        s[0],
        s[1],
        s[2],
        s[3],
        s[4],
        s[5],
        x0,
        y0,
        n0,
        x0 + x1 * half,
        y0 + y1 * half,
        n0 + n1 * half,
        x0 + x1 * h,
        y0 + y1 * h,
        n0 + n1 * h,
        h,
        curl,
        drag,
    )


@inner
def _turn(s: State, load: Load, h: float, curl: float, drag: float, after: State) -> float:
    # The square of the radius [-] where it is stationary within the step; it is of second order in the time's error.
    low, high = 0.0, h
    at_low, at_high = s[0] * s[3] + s[1] * s[4], after[0] * after[3] + after[1] * after[4]
    side, t, best = 0, low, 0.0
    for _ in range(40):
        before, t = t, trial(low, high, at_low, at_high)
        q = _advance(s, load, t, curl, drag)
        best = q[0] * q[0] + q[1] * q[1]
        value = q[0] * q[3] + q[1] * q[4]
        low, high, at_low, at_high, side = narrowed(low, high, at_low, at_high, side, t, value)
        if value == 0.0 or abs(t - before) < 1e-8 * h or at_high == at_low:
            break
    return best


@inner
def _shake(x: Array, y: Array, z: Array, dt: float, pieces: int, block: Array, history: Array) -> None:
    # Integrate a block of LANES pendulums through the record.  history: q of the first lane.
    n = x.shape[0]
    h = dt / pieces
    half = 0.5 * h
    for i in range(n - 1):
        if i < history.shape[0]:
            history[i, 0], history[i, 1] = block[0, 0], block[1, 0]
        dx, dy, dn = (x[i + 1] - x[i]) / dt, (y[i + 1] - y[i]) / dt, (z[i + 1] - z[i]) / dt
        for j in range(pieces):
            x0, y0, n0 = x[i] + dx * (j * h), y[i] + dy * (j * h), G + z[i] + dn * (j * h)
            xm, ym, nm = x0 + dx * half, y0 + dy * half, n0 + dn * half
            x1, y1, n1 = x0 + dx * h, y0 + dy * h, n0 + dn * h
            turning = 0
            for k in range(LANES):
                q1, q2, q3 = block[0, k], block[1, k], block[2, k]
                r1, r2, r3 = block[3, k], block[4, k], block[5, k]
                p1, p2, p3, v1, v2, v3 = _step(
                    q1, q2, q3, r1, r2, r3, x0, y0, n0, xm, ym, nm, x1, y1, n1, h, block[CURL, k], block[DRAG, k]
                )
                block[8, k], block[9, k], block[10, k] = p1, p2, p3
                block[11, k], block[12, k], block[13, k] = v1, v2, v3
                begin, end = q1 * r1 + q2 * r2, p1 * v1 + p2 * v2
                before, after = q1 * q1 + q2 * q2, p1 * p1 + p2 * p2
                most = max(block[MOST, k], after)
                # The square of the radius rises at twice these rates; twice that again for a rate that grows first.
                reach = max(before, after) + 4.0 * h * max(begin, -end)
                reach = reach if begin > 0.0 else 0.0
                reach = reach if end < 0.0 else 0.0
                block[MOST, k], block[REACH, k] = most, reach
                turning += 1 if reach > most else 0
            if turning > 0:
                for k in range(LANES):
                    if block[REACH, k] > block[MOST, k]:
                        s = (block[0, k], block[1, k], block[2, k], block[3, k], block[4, k], block[5, k])
                        ahead = (block[8, k], block[9, k], block[10, k], block[11, k], block[12, k], block[13, k])
                        load = (x0, y0, n0, dx, dy, dn)
                        top = _turn(s, load, h, block[CURL, k], block[DRAG, k], ahead)
                        block[MOST, k] = max(block[MOST, k], top)
            for row in range(6):
                for k in range(LANES):
                    block[row, k] = block[row + 8, k]
    if n - 1 < history.shape[0]:
        history[n - 1, 0], history[n - 1, 1] = block[0, 0], block[1, 0]


@inner
def _coast(s: State, most: float, length: float, zeta: float, tail: float, refine: int) -> tuple[float, float]:
    # After the record the energy cannot grow; most and the result are squares of the radius.
    w = math.sqrt(G / length)
    curl, drag = 1.0 / length, 2.0 * zeta * w
    load = (0.0, 0.0, G, 0.0, 0.0, 0.0)
    h = 0.8 * STEP / (w * (1.0 + 2.0 * zeta)) / refine
    stop = min(tail if tail >= 0.0 else CAP, MOST_AFTER * refine * h)
    cut = tail < 0.0 or stop < tail
    t, turns = 0.0, 0
    while t < stop:
        if tail < 0.0:
            # Energy as a height above the lowest point, in lengths.  A peak higher than it is final; in an undamped
            # ellipse the largest radius comes within two turns.
            left = 0.5 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]) / (w * w) + _height(s)
            lift = most / (1.0 + math.sqrt(max(0.0, 1.0 - most)))
            if left <= lift * (1.0 - 1e-9) or left == 0.0 or turns >= 3:
                return most, 0.0
        now = min(h, stop - t)
        after = _advance(s, load, now, curl, drag)
        if s[0] * s[3] + s[1] * s[4] > 0.0 > after[0] * after[3] + after[1] * after[4]:
            most = max(most, _turn(s, load, now, curl, drag, after))
            turns += 1
        most = max(most, after[0] * after[0] + after[1] * after[1])
        s = after
        t += now
    return most, float(CUT) if cut else 0.0


@inner
def _height(s: State) -> float:
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
    history: Array,
) -> None:
    """Follow m pendulums that swing in all directions, by the equation at the top of this module.

    Lanes do not mix: a result is the same to the last bit in any company.

    Parameters
    ----------
    x, y, z : ndarray, shape (n,)
        Acceleration of the pivot, m/s2, linear between samples.
    dt, peak, length, zeta, tail, refine
        As in `pipeline.kernels.pendulum.pendulum_batch`.
    results : ndarray, shape (m, 2)
        Receives the largest horizontal displacement over L [-] and the flags (`pipeline.kernels`); NaN where it
        is not followed.
    history : ndarray, shape (k, 2)
        Receives the horizontal displacement over L [-] of a single pendulum at the samples, as long as it is.

    References
    ----------
    Agbabian, M. S., Ginell, W. S., Masri, S. F. and Nigbor, R. L. (1991). Evaluation of earthquake damage mitigation
    methods for museum objects. Studies in Conservation 36. Sec. 2.4: the pendulum in one plane.
    """
    m = length.shape[0]
    results[:, :] = 0.0
    if x.shape[0] < 2:
        return
    pieces, order, spare = np.empty(m, np.int64), np.empty(m, np.int64), np.empty(m, np.int64)
    for k in range(m):
        pieces[k] = substeps(length[k], zeta[k], peak, dt) * refine
    in_order(pieces, order, spare)
    block = lanes(16)
    begin = FIRST
    while begin < m:
        end = same_steps(pieces, order, begin)
        block[:] = 0.0
        for k in range(LANES):
            one = order[min(begin + k, end - 1)]
            block[2, k] = -1.0
            block[CURL, k] = 1.0 / length[one]
            block[DRAG, k] = 2.0 * zeta[one] * math.sqrt(G / length[one])
        if pieces[order[begin]] == 0:
            for k in range(end - begin):
                results[order[begin + k], 0], results[order[begin + k], 1] = math.nan, float(UNRESOLVED)
            begin = end
            continue
        _shake(x, y, z, dt, pieces[order[begin]], block, history)
        for k in range(end - begin):
            one = order[begin + k]
            s = (block[0, k], block[1, k], block[2, k], block[3, k], block[4, k], block[5, k])
            most, flags = _coast(s, block[MOST, k], length[one], zeta[one], tail, refine)
            results[one, 0], results[one, 1] = min(math.sqrt(most), 1.0), flags
        begin = end
