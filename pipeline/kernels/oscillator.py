"""Linear oscillators on a shaking base: exact recursion for piecewise-linear input, peaks found between the samples.

u'' + 2 zeta w u' + w^2 u = -a, and y = a + share u'' beside u.  Oscillators run in lanes.  Of each stretch of steps
only a rigorous bound of what lies in it is kept; the few stretches whose bound exceeds the largest value at a step are
walked again one oscillator at a time, and the few of their steps that can hold the peak are searched by closed form.
Lanes do not mix: a result is the same to the last bit in any company.
"""

import math

import numpy as np

from pipeline.kernels import FIRST, bare, inlined, inner, kernel
from pipeline.kernels.lanes import LANES, lanes, same_steps
from pipeline.kernels.linear import peak_inside, transition
from pipeline.quantities import Array

PHASE = 1.5
"""Largest w (1 + 2 zeta) times the step.

The bound of what lies between two steps divides by 1 - zeta w step - (w step)^2 / 8, which is then at least 1/4.
"""

CHUNK = 128
"""Steps of which the excitation is laid out at a time; the fewest steps in a stretch."""

STRETCHES = 2048
"""Stretches of which the bounds are kept, at most; a longer record has longer ones."""

# Rows of the coefficients: the new u by u, v and both ends of a; the same for v; y by u, v, a; w^2, 2 zeta w, and by
# how much the curvature between two steps may exceed the one at them.
UU, UV, U0, U1, VU, VV, V0, V1, YU, YV, YA, B, C, EASE = range(14)
# Rows of the lanes' state: u, v, largest |u|, |v|, |y| of the stretch, largest |u|, |y| of all.
U, V, TOP_U, TOP_V, TOP_Y, MAX_U, MAX_Y = range(7)
# Rows of a stretch: u, v at its beginning; bounds of |u| and |y| in it; how far they may exceed those at the steps.
BEGIN_U, BEGIN_V, REACH_U, REACH_Y, GAP_U, GAP_Y = range(6)


@inlined
def _next(
    u: float,
    v: float,
    a0: float,
    a1: float,
    uu: float,
    uv: float,
    u0: float,
    u1: float,
    vu: float,
    vv: float,
    v0: float,
    v1: float,
) -> tuple[float, float]:
    return uu * u + uv * v + (u0 * a0 + u1 * a1), vu * u + vv * v + (v0 * a0 + v1 * a1)


@inner
def _coefficients(w: float, zeta: float, share: float, step: float, k: int, factor: Array) -> None:
    g, h, h1, h2 = transition(w, zeta, step)
    b, c = w * w, 2.0 * zeta * w
    factor[UU, k], factor[UV, k], factor[U0, k], factor[U1, k] = g, h, h2 / step - h1, -h2 / step
    factor[VU, k], factor[VV, k], factor[V0, k], factor[V1, k] = -b * h, g - c * h, h1 / step - h, -h1 / step
    factor[YU, k], factor[YV, k], factor[YA, k] = -share * b, -share * c, 1.0 - share
    factor[B, k], factor[C, k] = b, c
    factor[EASE, k] = 1.0 / (1.0 - 0.5 * c * step - 0.125 * b * step * step)


@inlined
def _between(
    b: float, c: float, step: float, ease: float, a: float, rate: float, u: float, v: float
) -> tuple[float, float, float]:
    # Bounds of |u''|, |u'''|, |u''''| between the steps, given those of |a|, |a'| and, at the steps, of |u| and |v|.
    # No point is further than step / 2 from a step: |v| < v + |u''| step / 2, and at a peak |u| < u + |u''| step^2 / 8.
    second = (a + c * v + b * u) * ease
    third = rate + c * second + b * (v + 0.5 * step * second)
    return second, third, c * third + b * second


@inner
def _lay_out(base: Array, dt: float, pieces: int, start: int, count: int, a: Array) -> None:
    # The excitation at count + 1 steps from start on.
    step = dt / pieces
    i, j = start // pieces, start % pieces
    for s in range(count + 1):
        a[s] = base[i] if j == 0 else base[i] + (base[i + 1] - base[i]) / dt * (j * step)
        j += 1
        if j == pieces:
            i, j = i + 1, 0


@inner
def _walk(a: Array, s: int, end: int, state: Array, factor: Array) -> None:
    # From step s to step end, four at a time, so that a state stays in its register.
    while s < end:
        four = s + 4 <= end
        a0, a1 = a[s], a[s + 1]
        if four:
            a2, a3, a4 = a[s + 2], a[s + 3], a[s + 4]
            for k in range(LANES):
                u, v = state[U, k], state[V, k]
                top_u, top_v, top_y = state[TOP_U, k], state[TOP_V, k], state[TOP_Y, k]
                uu, uv, u0, u1 = factor[UU, k], factor[UV, k], factor[U0, k], factor[U1, k]
                vu, vv, v0, v1 = factor[VU, k], factor[VV, k], factor[V0, k], factor[V1, k]
                yu, yv, ya = factor[YU, k], factor[YV, k], factor[YA, k]
                u, v = _next(u, v, a0, a1, uu, uv, u0, u1, vu, vv, v0, v1)
                top_u, top_v = max(top_u, abs(u)), max(top_v, abs(v))
                top_y = max(top_y, abs(ya * a1 + (yu * u + yv * v)))
                u, v = _next(u, v, a1, a2, uu, uv, u0, u1, vu, vv, v0, v1)
                top_u, top_v = max(top_u, abs(u)), max(top_v, abs(v))
                top_y = max(top_y, abs(ya * a2 + (yu * u + yv * v)))
                u, v = _next(u, v, a2, a3, uu, uv, u0, u1, vu, vv, v0, v1)
                top_u, top_v = max(top_u, abs(u)), max(top_v, abs(v))
                top_y = max(top_y, abs(ya * a3 + (yu * u + yv * v)))
                u, v = _next(u, v, a3, a4, uu, uv, u0, u1, vu, vv, v0, v1)
                top_u, top_v = max(top_u, abs(u)), max(top_v, abs(v))
                top_y = max(top_y, abs(ya * a4 + (yu * u + yv * v)))
                state[U, k], state[V, k] = u, v
                state[TOP_U, k], state[TOP_V, k], state[TOP_Y, k] = top_u, top_v, top_y
            s += 4
        else:
            for k in range(LANES):
                uu, uv, u0, u1 = factor[UU, k], factor[UV, k], factor[U0, k], factor[U1, k]
                vu, vv, v0, v1 = factor[VU, k], factor[VV, k], factor[V0, k], factor[V1, k]
                u, v = _next(state[U, k], state[V, k], a0, a1, uu, uv, u0, u1, vu, vv, v0, v1)
                state[U, k], state[V, k] = u, v
                state[TOP_U, k], state[TOP_V, k] = max(state[TOP_U, k], abs(u)), max(state[TOP_V, k], abs(v))
                y = factor[YA, k] * a1 + (factor[YU, k] * u + factor[YV, k] * v)
                state[TOP_Y, k] = max(state[TOP_Y, k], abs(y))
            s += 1


@kernel
def _shake(
    base: Array,
    dt: float,
    pieces: int,
    length: int,
    most: float,
    steepest: float,
    state: Array,
    factor: Array,
    stretch: Array,
) -> None:
    # The whole record, and of each stretch of length steps what the rows of stretch say.
    # most, steepest: the largest |a| and |a'| of the record.
    step = dt / pieces
    total = (base.shape[0] - 1) * pieces
    a = np.empty(CHUNK + 1)
    for part in range(stretch.shape[0]):
        s, end = part * length, min(total, (part + 1) * length)
        _lay_out(base, dt, pieces, s, FIRST, a)
        here = a[0]
        for k in range(LANES):
            u, v = state[U, k], state[V, k]
            stretch[part, BEGIN_U, k], stretch[part, BEGIN_V, k] = u, v
            state[TOP_U, k], state[TOP_V, k] = abs(u), abs(v)
            state[TOP_Y, k] = abs(factor[YA, k] * here + (factor[YU, k] * u + factor[YV, k] * v))
        if pieces == 1:
            _walk(base, s, end, state, factor)
        else:
            for first in range(s, end, CHUNK):
                count = min(CHUNK, end - first)
                _lay_out(base, dt, pieces, first, count, a)
                _walk(a, FIRST, count, state, factor)
        for k in range(LANES):
            top_u, top_y = state[TOP_U, k], state[TOP_Y, k]
            b, c, ease = factor[B, k], factor[C, k], factor[EASE, k]
            second, _, fourth = _between(b, c, step, ease, most, steepest, top_u, state[TOP_V, k])
            gap_u, gap_y = 0.125 * step * step * second, 0.125 * step * step * abs(1.0 - factor[YA, k]) * fourth
            stretch[part, GAP_U, k], stretch[part, GAP_Y, k] = gap_u, gap_y
            stretch[part, REACH_U, k], stretch[part, REACH_Y, k] = top_u + gap_u, top_y + gap_y
            state[MAX_U, k] = max(state[MAX_U, k], top_u)
            state[MAX_Y, k] = max(state[MAX_Y, k], top_y)


@inner
def _cubic_top(p0: float, d0: float, p1: float, d1: float, h: float) -> float:
    # The largest |p| on the cubic with these ends and rates there.
    first, last = h * d0 / 3.0, h * d1 / 3.0
    middle = (p1 - last) - (p0 + first)
    top = max(abs(p0), abs(p1))
    inner = middle * middle - first * last
    if inner >= 0.0:
        q = first - middle + math.copysign(math.sqrt(inner), first - middle)
        bend = first - 2.0 * middle + last
        for where in (q / bend, first / q):
            if 0.0 < where < 1.0:
                left = 1.0 - where
                here = p0 * left**3 + 3.0 * (p0 + first) * left * left * where
                top = max(top, abs(here + 3.0 * (p1 - last) * left * where * where + p1 * where**3))
    return top


@inner
def _search(
    base: Array,
    dt: float,
    pieces: int,
    begin: int,
    end: int,
    w: float,
    zeta: float,
    share: float,
    stretch: Array,
    factor: Array,
    k: int,
    max_u: float,
    max_y: float,
) -> tuple[float, float]:
    # Walk one oscillator from step begin to step end again, and search the steps that can hold the largest |u| or |y|.
    step = dt / pieces
    b, c = w * w, 2.0 * zeta * w
    # A cubic with the right ends and rates is off by at most step^4 / 384 times the fourth derivative.
    fourth = step**4 / 384.0
    u, v, gap_u, gap_y = stretch[BEGIN_U, k], stretch[BEGIN_V, k], stretch[GAP_U, k], stretch[GAP_Y, k]
    for s in range(begin, end):
        i, j = s // pieces, s % pieces
        rate = (base[i + 1] - base[i]) / dt
        a = base[i] + rate * (j * step)
        an = a + rate * step
        un = factor[UU, k] * u + factor[UV, k] * v + (factor[U0, k] * a + factor[U1, k] * an)
        vn = factor[VU, k] * u + factor[VV, k] * v + (factor[V0, k] * a + factor[V1, k] * an)
        near_u, near_v = max(abs(u), abs(un)), max(abs(v), abs(vn))
        y0, y1 = (1.0 - share) * a - share * (c * v + b * u), (1.0 - share) * an - share * (c * vn + b * un)
        near_y = max(abs(y0), abs(y1))
        if near_u + gap_u > max_u or near_y + gap_y > max_y:
            _, third, bend = _between(b, c, step, factor[EASE, k], max(abs(a), abs(an)), abs(rate), near_u, near_v)
            slack = fourth * bend
            if near_u + gap_u > max_u and _cubic_top(u, v, un, vn, step) + slack > max_u:
                max_u = max(max_u, near_u, peak_inside(u, v, -a, -rate, w, zeta, step, 0.0, 0.0, 1.0, 0.0))
            d0 = (1.0 - share) * rate + share * (c * (a + c * v + b * u) - b * v)
            d1 = (1.0 - share) * rate + share * (c * (an + c * vn + b * un) - b * vn)
            slack = fourth * abs(share) * (c * (c * bend + b * third) + b * bend)
            if near_y + gap_y > max_y and _cubic_top(y0, d0, y1, d1, step) + slack > max_y:
                inner = peak_inside(
                    u, v, -a, -rate, w, zeta, step, a * (1.0 - share), rate * (1.0 - share), -share * b, -share * c
                )
                max_y = max(max_y, near_y, inner)
        u, v = un, vn
    return max_u, max_y


@inner
def _coast(
    u: float, v: float, w: float, zeta: float, share: float, tail: float, max_u: float, max_y: float
) -> tuple[float, float]:
    # Free decay.  The excitation drops to zero at the last sample: a jump of y, felt when share is not 1.
    b, c = w * w, 2.0 * zeta * w
    y, rise = -share * (c * v + b * u), share * (c * (c * v + b * u) - b * v)
    max_y = max(max_y, abs(y))
    # u and y obey the same equation, so that their energies cannot grow.
    if math.hypot(u, v / w) <= max_u and math.hypot(y, rise / w) <= max_y:
        return max_u, max_y
    # Their largest extremes come within the first period; an overdamped system has at most one, however late.
    limit = tail if tail >= 0.0 else 1e300
    if zeta < 1.0:
        stop = 2.0 * math.pi / (w * math.sqrt((1.0 - zeta) * (1.0 + zeta)))
        stop = min(stop, 60.0 / (w * max(zeta, 1e-300)))
    else:
        stop = 60.0 * (1.0 + zeta) / w
    stop = min(stop, limit)
    t, span = 0.0, 0.5 / (w * (1.0 + zeta))
    while t < stop:
        now = min(span, stop - t)
        max_u = max(max_u, peak_inside(u, v, 0.0, 0.0, w, zeta, now, 0.0, 0.0, 1.0, 0.0))
        max_y = max(max_y, peak_inside(u, v, 0.0, 0.0, w, zeta, now, 0.0, 0.0, share * b, share * c))
        g, h, _, _ = transition(w, zeta, now)
        u, v = u * g + v * h, -u * b * h + v * (g - c * h)
        max_u = max(max_u, abs(u))
        max_y = max(max_y, abs(share * (c * v + b * u)))
        t += now
        if zeta >= 1.0:
            span *= 1.5
    return max_u, max_y


@kernel
def oscillator_batch(
    base: Array, dt: float, w: Array, zeta: Array, share: Array, tail: float, max_u: Array, max_y: Array
) -> None:
    """Fill max_u (m,) m and max_y (m,) m/s2 for m oscillators under one base motion.

    base  : (n,) m/s2, excitation between the first and the last sample, none outside
    share : (m,) y = a + share u'': 1 for the absolute acceleration of the mass; another one is a lever ratio
    tail  : s to go on after the record, or -1: until past the peaks
    """
    m = w.shape[0]
    max_u[:], max_y[:] = 0.0, 0.0
    if base.shape[0] < 2:
        return
    pieces = np.empty(m, dtype=np.int64)
    for k in range(m):
        pieces[k] = max(1, math.ceil(w[k] * dt * (1.0 + 2.0 * zeta[k]) / PHASE))
    most, steepest = abs(base[0]), 0.0
    for i in range(base.shape[0] - 1):
        most, steepest = max(most, abs(base[i + 1])), max(steepest, abs(base[i + 1] - base[i]) / dt)
    order = np.argsort(pieces, kind="mergesort")
    factor, state = lanes(14), lanes(7)
    begin = FIRST
    while begin < m:
        end = same_steps(pieces, order, begin)
        parts = pieces[order[begin]]
        total = (base.shape[0] - 1) * parts
        length = CHUNK * ((total - 1) // (CHUNK * STRETCHES) + 1)
        stretch = np.empty(((total - 1) // length + 1, 6, LANES))
        state[:] = 0.0
        for k in range(LANES):
            one = order[min(begin + k, end - 1)]
            _coefficients(w[one], zeta[one], share[one], dt / parts, k, factor)
        _shake(base, dt, parts, length, most, steepest, state, factor, stretch)
        for k in range(end - begin):
            one = order[begin + k]
            most_u, most_y = state[MAX_U, k], state[MAX_Y, k]
            for b in range(stretch.shape[0]):
                if stretch[b, REACH_U, k] > most_u or stretch[b, REACH_Y, k] > most_y:
                    most_u, most_y = _search(
                        base,
                        dt,
                        parts,
                        b * length,
                        min(total, (b + 1) * length),
                        w[one],
                        zeta[one],
                        share[one],
                        stretch[b],
                        factor,
                        k,
                        most_u,
                        most_y,
                    )
            max_u[one], max_y[one] = _coast(
                state[U, k], state[V, k], w[one], zeta[one], share[one], tail, most_u, most_y
            )
        begin = end


@bare
def oscillator_history(base: Array, dt: float, w: float, zeta: float, share: float, history: Array) -> None:
    """Fill history (m, 2) with u [m] and y = a + share u'' [m/s2] of one oscillator at the samples.

    base : (n,) m/s2; rows of the history after the record follow the free decay
    """
    n = base.shape[0]
    g, h, h1, h2 = transition(w, zeta, dt)
    b, c = w * w, 2.0 * zeta * w
    u, v = 0.0, 0.0
    for i in range(history.shape[0]):
        if 0 < i < n:
            f0, f1 = -base[i - 1], (base[i - 1] - base[i]) / dt
            u, v = u * g + v * h + f0 * h1 + f1 * h2, -u * b * h + v * (g - c * h) + f0 * h + f1 * h1
        elif i > 0:
            u, v = u * g + v * h, -u * b * h + v * (g - c * h)
        a = base[i] if i < n else 0.0
        history[i, 0] = u
        history[i, 1] = a * (1.0 - share) - share * (c * v + b * u)
