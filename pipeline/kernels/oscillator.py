r"""Linear oscillators on a shaking base: exact recursion for piecewise-linear input, peaks found between the samples.

.. math::

    u'' + 2 \zeta w u' + w^2 u = -a, \qquad y = a + \text{share} \cdot u''

with u [m] the displacement relative to the base, a [m/s2] the acceleration of the base, w [rad/s], zeta [-], and y
[m/s2] beside u: with a share of 1 the absolute acceleration of the mass.

Oscillators run in lanes, however stiff one step a sample.  Of each stretch of samples only a rigorous bound of what
lies in it is kept; the few stretches whose bound exceeds the largest value at a sample are walked again one oscillator
at a time, and the few of their intervals that can hold the peak are searched by closed form.  Lanes do not mix: a
result is the same to the last bit in any company.

The bound: between two samples a is linear, so that f = u'' obeys f'' + 2 zeta w f' + w^2 f = 0, whose energy
f^2 + (f' / w)^2 cannot grow.  At a sample f' jumps by as much as the slope of a.
"""

import math

import numpy as np

from pipeline.kernels import FIRST, bare, inlined, inner, kernel
from pipeline.kernels.lanes import LANES, lanes
from pipeline.kernels.linear import peak_inside, transition
from pipeline.quantities import Array

PHASE = 1.5
"""Largest w (1 + 2 zeta) times the span that is searched at once: a shorter one has at most two stationary points."""

STRIDE = 4
"""Samples from one energy that is measured to the next; between them it grows by what the slopes of a jump."""

CHUNK = 128
"""Fewest intervals in a stretch, a multiple of STRIDE."""

STRETCHES = 2048
"""Stretches of which the bounds are kept, at most; a longer record has longer ones."""

# How many rows there are of coefficients and of the lanes' state.
FACTORS, STATES = np.int64(18), np.int64(7)
# Rows of the coefficients: the new u by u, v and both ends of a; the same for v; y by u, v, a; w^2, 2 zeta w, the
# share, w, 2 zeta, 1 / (w dt), and by how much |u - (its particular part)| w^2 may exceed the root of the energy.
UU, UV, U0, U1, VU, VV, V0, V1, YU, YV, YA, B, C, SHARE, W, TWICE, RAMP, NORM = range(18)
# Rows of the lanes' state: u, v, largest |u|, |y| and energy of the stretch, largest |u|, |y| of all.
U, V, TOP_U, TOP_Y, TOP_E, MAX_U, MAX_Y = range(7)
# Rows of a stretch: u, v at its beginning; bounds of |u| and |y| in it; how far they may exceed those at the samples;
# how far w^2 |u| and |y| may exceed |a|.
BEGIN_U, BEGIN_V, REACH_U, REACH_Y, GAP_U, GAP_Y, ROOM_U, ROOM_Y = range(8)
# Columns of a stretch of the excitation: the largest |a|, difference of neighbours, and second difference.
MOST, STEEPEST, SHARPEST = range(3)


@inlined
def next_state(
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
    """Return u and v a sample later, by the rows of coefficients that are named alike."""
    return uu * u + uv * v + (u0 * a0 + u1 * a1), vu * u + vv * v + (v0 * a0 + v1 * a1)


@inner
def _coefficients(w: float, zeta: float, share: float, dt: float, k: int, factor: Array) -> None:
    g, h, h1, h2 = transition(w, zeta, dt)
    b, c = w * w, 2.0 * zeta * w
    factor[UU, k], factor[UV, k], factor[U0, k], factor[U1, k] = g, h, h2 / dt - h1, -h2 / dt
    factor[VU, k], factor[VV, k], factor[V0, k], factor[V1, k] = -b * h, g - c * h, h1 / dt - h, -h1 / dt
    factor[YU, k], factor[YV, k], factor[YA, k] = -share * b, -share * c, 1.0 - share
    factor[B, k], factor[C, k], factor[SHARE, k] = b, c, share
    factor[W, k], factor[TWICE, k], factor[RAMP, k] = w, 2.0 * zeta, 1.0 / (w * dt)
    factor[NORM, k] = (zeta + math.sqrt(1.0 + zeta * zeta)) ** 2


@inlined
def interval_energy(pull: float, v: float, difference: float, w: float, twice: float, ramp: float) -> float:
    """Return f^2 + (f' / w)^2 of the interval that begins here, f being u'' and pull -f."""
    jerk = ramp * difference - twice * pull + w * v
    return pull * pull + jerk * jerk


@inlined
def _gaps(
    energy: float,
    pull: float,
    difference: float,
    dt: float,
    b: float,
    share: float,
    twice: float,
    ramp: float,
    norm: float,
) -> tuple[float, float, float, float]:
    # Between samples, how far |u|, |y| may exceed those at them, and w^2 |u|, |y| the largest |a|; given bounds of the
    # root of the energy and, at the samples, of |u''| and the difference of neighbours.  A function exceeds its chord
    # by at most dt^2 / 8 of its second derivative; the particular part of u is -a / w^2 + 2 zeta a' / w^3, of y is a.
    eighth = 0.125 * dt * dt
    second = min(energy, pull + eighth * b * (1.0 + twice) * energy)
    gap_u, gap_y = eighth * second, eighth * share * b * (twice * energy + second)
    return gap_u, gap_y, twice * ramp * difference + norm * energy, share * second


@inner
def _outline(a: Array, n: int, length: int, outline: Array) -> None:
    # Of each stretch of the excitation what the columns of outline say; a has a sample more than n.
    outline[:] = 0.0
    for i in range(n - 1):
        row = outline[i // length]
        row[MOST] = max(row[MOST], abs(a[i]), abs(a[i + 1]))
        row[STEEPEST] = max(row[STEEPEST], abs(a[i + 1] - a[i]))
        row[SHARPEST] = max(row[SHARPEST], abs(a[i + 2] - a[i + 1] - (a[i + 1] - a[i])))


@inner
def _walk(a: Array, s: int, end: int, state: Array, factor: Array) -> None:
    # From sample s to sample end, STRIDE at a time, so that a state stays in its register.
    while s < end:
        stride = s + STRIDE <= end
        a0, a1, a2 = a[s], a[s + 1], a[s + 2]
        if stride:
            a3, a4, a5 = a[s + 3], a[s + 4], a[s + 5]
            for k in range(LANES):
                u, v = state[U, k], state[V, k]
                top_u, top_y = state[TOP_U, k], state[TOP_Y, k]
                uu, uv, u0, u1 = factor[UU, k], factor[UV, k], factor[U0, k], factor[U1, k]
                vu, vv, v0, v1 = factor[VU, k], factor[VV, k], factor[V0, k], factor[V1, k]
                yu, yv, ya = factor[YU, k], factor[YV, k], factor[YA, k]
                u, v = next_state(u, v, a0, a1, uu, uv, u0, u1, vu, vv, v0, v1)
                top_u, top_y = max(top_u, abs(u)), max(top_y, abs(ya * a1 + (yu * u + yv * v)))
                u, v = next_state(u, v, a1, a2, uu, uv, u0, u1, vu, vv, v0, v1)
                top_u, top_y = max(top_u, abs(u)), max(top_y, abs(ya * a2 + (yu * u + yv * v)))
                u, v = next_state(u, v, a2, a3, uu, uv, u0, u1, vu, vv, v0, v1)
                top_u, top_y = max(top_u, abs(u)), max(top_y, abs(ya * a3 + (yu * u + yv * v)))
                u, v = next_state(u, v, a3, a4, uu, uv, u0, u1, vu, vv, v0, v1)
                pull = a4 + (factor[C, k] * v + factor[B, k] * u)
                energy = interval_energy(pull, v, a5 - a4, factor[W, k], factor[TWICE, k], factor[RAMP, k])
                state[U, k], state[V, k] = u, v
                state[TOP_U, k], state[TOP_Y, k] = max(top_u, abs(u)), max(top_y, abs(ya * a4 + (yu * u + yv * v)))
                state[TOP_E, k] = max(state[TOP_E, k], energy)
            s += STRIDE
        else:
            for k in range(LANES):
                uu, uv, u0, u1 = factor[UU, k], factor[UV, k], factor[U0, k], factor[U1, k]
                vu, vv, v0, v1 = factor[VU, k], factor[VV, k], factor[V0, k], factor[V1, k]
                u, v = next_state(state[U, k], state[V, k], a0, a1, uu, uv, u0, u1, vu, vv, v0, v1)
                pull = a1 + (factor[C, k] * v + factor[B, k] * u)
                energy = interval_energy(pull, v, a2 - a1, factor[W, k], factor[TWICE, k], factor[RAMP, k])
                state[U, k], state[V, k] = u, v
                state[TOP_U, k] = max(state[TOP_U, k], abs(u))
                state[TOP_Y, k] = max(state[TOP_Y, k], abs(a1 - factor[SHARE, k] * pull))
                state[TOP_E, k] = max(state[TOP_E, k], energy)
            s += 1


@inner
def _shake(
    a: Array, n: int, dt: float, length: int, outline: Array, state: Array, factor: Array, stretch: Array
) -> None:
    # The whole record of n samples, and of each stretch of length intervals what the rows of stretch say.
    for part in range(stretch.shape[0]):
        begin = part * length
        here, rise = a[begin], a[begin + 1] - a[begin]
        most, steepest, sharpest = outline[part, MOST], outline[part, STEEPEST], outline[part, SHARPEST]
        for k in range(LANES):
            u, v = state[U, k], state[V, k]
            pull = here + (factor[C, k] * v + factor[B, k] * u)
            top_y = abs(here - factor[SHARE, k] * pull)
            energy = interval_energy(pull, v, rise, factor[W, k], factor[TWICE, k], factor[RAMP, k])
            stretch[part, BEGIN_U, k], stretch[part, BEGIN_V, k] = u, v
            state[TOP_U, k], state[TOP_Y, k], state[TOP_E, k] = abs(u), top_y, energy
        _walk(a, begin, min(n - 1, begin + length), state, factor)
        # Two loops: of one with more arrays the compiler cannot prove that they lie apart, and takes it one by one.
        for k in range(LANES):
            state[MAX_U, k] = max(state[MAX_U, k], state[TOP_U, k])
            state[MAX_Y, k] = max(state[MAX_Y, k], state[TOP_Y, k])
        for k in range(LANES):
            top_u, top_y, share = state[TOP_U, k], state[TOP_Y, k], abs(factor[SHARE, k])
            b, twice, ramp, norm = factor[B, k], factor[TWICE, k], factor[RAMP, k], factor[NORM, k]
            energy = math.sqrt(state[TOP_E, k]) + (STRIDE - 1) * sharpest * ramp
            # Without a share y does not tell u''.
            pull = (top_y + most) / share if share > 0.0 else energy
            gap_u, gap_y, room_u, room_y = _gaps(energy, pull, steepest, dt, b, share, twice, ramp, norm)
            stretch[part, REACH_U, k] = min(top_u + gap_u, (most + room_u) / b)
            stretch[part, REACH_Y, k] = min(top_y + gap_y, most + room_y)
            stretch[part, GAP_U, k], stretch[part, GAP_Y, k] = gap_u, gap_y
            stretch[part, ROOM_U, k], stretch[part, ROOM_Y, k] = room_u, room_y


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
def _inside(
    a: float,
    difference: float,
    u: float,
    v: float,
    dt: float,
    energy: float,
    factor: Array,
    k: int,
    max_u: float,
    max_y: float,
) -> tuple[float, float]:
    # Search one interval, from u, v on, in spans short enough for closed forms; energy: the root of the interval's.
    w, b, c, share, twice = factor[W, k], factor[B, k], factor[C, k], factor[SHARE, k], factor[TWICE, k]
    parts = max(1, math.ceil(w * dt * (1.0 + twice) / PHASE))
    span, rate = dt / parts, difference / dt
    g, h, h1, h2 = transition(w, 0.5 * twice, span)
    # A cubic with the right ends and rates is off by at most span^4 / 384 times the fourth derivative; the k-th
    # derivative of u'' is at most (1 + 2 zeta)^(k - 1) w^k times the root of the energy.
    fourth = span**4 / 384.0 * b * (1.0 + twice) * energy
    slack_u, slack_y = fourth, fourth * abs(share) * b * (1.0 + twice) ** 2
    y_step, y_ramp = 1.0 - share, (1.0 - share) * rate
    for _ in range(parts):
        un, vn = g * u + h * v - (h1 * a + h2 * rate), -b * h * u + (g - c * h) * v - (h * a + h1 * rate)
        an = a + rate * span
        if _cubic_top(u, v, un, vn, span) + slack_u > max_u:
            inside = peak_inside(u, v, -a, -rate, w, 0.5 * twice, span, 0.0, 0.0, 1.0, 0.0)
            max_u = max(max_u, abs(u), abs(un), inside)
        g0, g1 = a + (c * v + b * u), an + (c * vn + b * un)
        y0, y1 = a - share * g0, an - share * g1
        d0, d1 = y_ramp + share * (c * g0 - b * v), y_ramp + share * (c * g1 - b * vn)
        if _cubic_top(y0, d0, y1, d1, span) + slack_y > max_y:
            inside = peak_inside(u, v, -a, -rate, w, 0.5 * twice, span, a * y_step, y_ramp, -share * b, -share * c)
            max_y = max(max_y, abs(y0), abs(y1), inside)
        a, u, v = an, un, vn
    return max_u, max_y


@inlined
def _beyond(
    near_u: float,
    near_y: float,
    most: float,
    b: float,
    gap_u: float,
    gap_y: float,
    room_u: float,
    room_y: float,
    max_u: float,
    max_y: float,
) -> bool:
    # Whether |u| may exceed max_u or |y| max_y.
    u_may = near_u + gap_u > max_u and most + room_u > b * max_u
    return u_may or (near_y + gap_y > max_y and most + room_y > max_y)


@inner
def _search(
    a: Array,
    begin: int,
    end: int,
    dt: float,
    stretch: Array,
    part: int,
    factor: Array,
    k: int,
    max_u: float,
    max_y: float,
) -> tuple[float, float]:
    # Walk one oscillator from sample begin to sample end again, and search what can hold the largest |u| or |y|.
    b, c, share = factor[B, k], factor[C, k], factor[SHARE, k]
    w, twice, ramp, norm = factor[W, k], factor[TWICE, k], factor[RAMP, k], factor[NORM, k]
    uu, uv, u0, u1 = factor[UU, k], factor[UV, k], factor[U0, k], factor[U1, k]
    vu, vv, v0, v1 = factor[VU, k], factor[VV, k], factor[V0, k], factor[V1, k]
    u, v = stretch[part, BEGIN_U, k], stretch[part, BEGIN_V, k]
    gap_u, gap_y = stretch[part, GAP_U, k], stretch[part, GAP_Y, k]
    room_u, room_y = stretch[part, ROOM_U, k], stretch[part, ROOM_Y, k]
    pull = a[begin] + (c * v + b * u)
    size = abs(a[begin] - share * pull)
    for s in range(begin, end):
        a0, a1 = a[s], a[s + 1]
        un, vn = next_state(u, v, a0, a1, uu, uv, u0, u1, vu, vv, v0, v1)
        pull_n = a1 + (c * vn + b * un)
        size_n = abs(a1 - share * pull_n)
        near_u, near_y, most = max(abs(u), abs(un)), max(size, size_n), max(abs(a0), abs(a1))
        # First with what the whole stretch grants, then with what this interval does.
        if _beyond(near_u, near_y, most, b, gap_u, gap_y, room_u, room_y, max_u, max_y):
            energy = math.sqrt(interval_energy(pull, v, a1 - a0, w, twice, ramp))
            most_pull = max(abs(pull), abs(pull_n))
            here = _gaps(energy, most_pull, abs(a1 - a0), dt, b, abs(share), twice, ramp, norm)
            if _beyond(near_u, near_y, most, b, here[0], here[1], here[2], here[3], max_u, max_y):
                max_u, max_y = _inside(a0, a1 - a0, u, v, dt, energy, factor, k, max_u, max_y)
        u, v, pull, size = un, vn, pull_n, size_n
    return max_u, max_y


@inner
def _sift(
    a: Array, n: int, dt: float, length: int, stretch: Array, factor: Array, lanes_used: int, state: Array
) -> None:
    # Raise the lanes' largest |u| and |y| at the samples to those between them.
    for part in range(stretch.shape[0]):
        any_beyond = False
        for k in range(LANES):
            beyond = (stretch[part, REACH_U, k] > state[MAX_U, k]) | (stretch[part, REACH_Y, k] > state[MAX_Y, k])
            any_beyond = any_beyond | beyond
        if not any_beyond:
            continue
        for k in range(lanes_used):
            max_u, max_y = state[MAX_U, k], state[MAX_Y, k]
            if stretch[part, REACH_U, k] > max_u or stretch[part, REACH_Y, k] > max_y:
                begin = part * length
                state[MAX_U, k], state[MAX_Y, k] = _search(
                    a, begin, min(n - 1, begin + length), dt, stretch, part, factor, k, max_u, max_y
                )


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
    r"""Find the peaks of m oscillators under one base motion.

    .. math::

        u'' + 2 \zeta w u' + w^2 u = -a, \qquad y = a + \text{share} \cdot u''

    Parameters
    ----------
    base : ndarray, shape (n,)
        a, m/s2: excitation between the first and the last sample, none outside.
    dt : float
        Time step, s.
    w, zeta : ndarray, shape (m,)
        Angular frequency [rad/s] and damping ratio [-].
    share : ndarray, shape (m,)
        Of u'' in y [-]: 1 for the absolute acceleration of the mass; another one is a lever ratio.
    tail : float
        Seconds to go on after the record, or -1: until past the peaks.
    max_u, max_y : ndarray, shape (m,)
        Receive the largest ``|u|`` [m] and ``|y|`` [m/s2], between the samples too.

    References
    ----------
    Nigam, N. C. and Jennings, P. C. (1969). Calculation of response spectra from strong-motion earthquake records.
    Bulletin of the Seismological Society of America 59: the recursion from sample to sample.
    """
    n, m = base.shape[0], w.shape[0]
    max_u[:], max_y[:] = 0.0, 0.0
    if n < 2:
        return
    # A sample more, so that the last one has a slope like the others; one by one, as a slice that is set brings numba's
    # messages about shapes into the compilation, a tenth of it.
    a = np.empty(n + 1)
    for i in range(n):
        a[i] = base[i]
    a[n] = base[n - 1]
    length = CHUNK * ((n - 2) // (CHUNK * STRETCHES) + 1)
    parts = (n - 2) // length + 1
    outline, stretch = np.empty((parts, 3)), np.empty((parts, 8, LANES))
    _outline(a, n, length, outline)
    factor, state = lanes(FACTORS), lanes(STATES)
    for begin in range(FIRST, m, LANES):
        end = min(begin + LANES, m)
        state[:] = 0.0
        for k in range(LANES):
            one = min(begin + k, end - 1)
            _coefficients(w[one], zeta[one], share[one], dt, k, factor)
        _shake(a, n, dt, length, outline, state, factor, stretch)
        _sift(a, n, dt, length, stretch, factor, end - begin, state)
        for k in range(end - begin):
            one = begin + k
            max_u[one], max_y[one] = _coast(
                state[U, k], state[V, k], w[one], zeta[one], share[one], tail, state[MAX_U, k], state[MAX_Y, k]
            )


@bare
def oscillator_history(base: Array, dt: float, w: float, zeta: float, share: float, history: Array) -> None:
    r"""Fill in the history of one oscillator at the samples.

    .. math::

        u'' + 2 \zeta w u' + w^2 u = -a, \qquad y = a + \text{share} \cdot u''

    Parameters
    ----------
    base : ndarray, shape (n,)
        a, m/s2.
    dt : float
        Time step, s.
    w, zeta, share : float
        As in `oscillator_batch`, of one.
    history : ndarray, shape (k, 2)
        Receives u [m] and y [m/s2]; rows after the record follow the free decay.

    References
    ----------
    Nigam and Jennings (1969), as in `oscillator_batch`.
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
