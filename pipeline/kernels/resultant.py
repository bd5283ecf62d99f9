r"""Linear oscillators shaken in two directions at once: the largest resultant, which is the worst of all directions.

.. math::

    \mathbf{u}'' + 2 \zeta w \mathbf{u}' + w^2 \mathbf{u} = -\mathbf{a}

with u = (u_x, u_y) [m].  Shaken along a direction d an oscillator answers with the component of u along d, so that the
largest of all directions and times is the largest length of u: two runs in place of one for every direction.

As in `pipeline.kernels.oscillator` lanes take one exact step a sample, and of each stretch of samples a rigorous bound
is kept; what may hold more than the largest at a sample is walked again and searched by closed form.  The bounds are
those of one direction with lengths of vectors in place of sizes: a vector is off its chord by at most an eighth of its
largest second derivative, and the energies of both directions add up.
"""

import math

import numpy as np

from pipeline.kernels import FIRST, inlined, inner, kernel
from pipeline.kernels.lanes import LANES, lanes
from pipeline.kernels.linear import advance, carried, transition
from pipeline.kernels.oscillator import CHUNK, STRETCHES, STRIDE, interval_energy, next_state
from pipeline.quantities import Array

PHASE = 0.25
"""Largest w (1 + 2 zeta) times the span that is searched at once: a longest resultant is alone in it."""

TRIES, CLOSE = 60, 1e-8
"""How often the time of a longest resultant is looked for, and the share of its span to which it is: a length that has
its peak there is off by the square of that."""

# How many rows there are of coefficients and of the lanes' state.
FACTORS, STATES = np.int64(15), np.int64(7)
# Rows of the coefficients: the new u by u, v and both ends of a; the same for v; w^2, 2 zeta w, w, zeta, 2 zeta,
# 1 / (w dt), and by how much |u - (its particular part)| w^2 may exceed the root of the energy.
UU, UV, U0, U1, VU, VV, V0, V1, B, C, W, ZETA, TWICE, RAMP, NORM = range(15)
# Rows of the lanes' state: u and v of both directions; largest |u|^2 and energy of the stretch, and |u| of all.
UX, VX, UY, VY, TOP, TOP_E, MOST = range(7)
# Rows of a stretch: u and v at its beginning; a bound of |u| in it; how far |u| may exceed that at the samples, and how
# far w^2 |u| may exceed |a|.
BEGIN_UX, BEGIN_VX, BEGIN_UY, BEGIN_VY, REACH, GAP, ROOM = range(7)
# Columns of a stretch of the excitation: the longest a, difference of neighbours, and second difference.
LONGEST, STEEPEST, SHARPEST = range(3)
# What is best known of one oscillator: the longest resultant, and that.
SIZE, AT_X, AT_Y = range(3)


@inner
def _coefficients(w: float, zeta: float, dt: float, k: int, factor: Array) -> None:
    g, h, h1, h2 = transition(w, zeta, dt)
    b, c = w * w, 2.0 * zeta * w
    factor[UU, k], factor[UV, k], factor[U0, k], factor[U1, k] = g, h, h2 / dt - h1, -h2 / dt
    factor[VU, k], factor[VV, k], factor[V0, k], factor[V1, k] = -b * h, g - c * h, h1 / dt - h, -h1 / dt
    factor[B, k], factor[C, k], factor[W, k], factor[ZETA, k] = b, c, w, zeta
    factor[TWICE, k], factor[RAMP, k] = 2.0 * zeta, 1.0 / (w * dt)
    factor[NORM, k] = (zeta + math.sqrt(1.0 + zeta * zeta)) ** 2


@inlined
def _gap_and_room(
    energy: float, difference: float, dt: float, twice: float, ramp: float, norm: float
) -> tuple[float, float]:
    # Between samples, how far |u| may exceed that at them, and w^2 |u| the longest a; given bounds of the root of the
    # energy, which |u''| does not exceed, and of the difference of neighbours.
    return 0.125 * dt * dt * energy, twice * ramp * difference + norm * energy


@inner
def _outline(ax: Array, ay: Array, push: Array, n: int, length: int, outline: Array) -> None:
    # Of each stretch of the excitation what the columns of outline say; all have a sample more than n.
    for part in range(outline.shape[0]):
        begin = part * length
        longest, steepest, sharpest = push[begin], 0.0, 0.0
        for i in range(begin, min(n - 1, begin + length)):
            longest = max(longest, push[i + 1])
            rise_x, rise_y = ax[i + 1] - ax[i], ay[i + 1] - ay[i]
            bend_x, bend_y = ax[i + 2] - ax[i + 1] - rise_x, ay[i + 2] - ay[i + 1] - rise_y
            steepest = max(steepest, rise_x * rise_x + rise_y * rise_y)
            sharpest = max(sharpest, bend_x * bend_x + bend_y * bend_y)
        row = outline[part]
        row[LONGEST], row[STEEPEST], row[SHARPEST] = longest, math.sqrt(steepest), math.sqrt(sharpest)


@inner
def _walk(ax: Array, ay: Array, s: int, end: int, state: Array, factor: Array) -> None:
    # From sample s to sample end, STRIDE at a time, so that a state stays in its register.
    while s < end:
        x0, x1, x2, y0, y1, y2 = ax[s], ax[s + 1], ax[s + 2], ay[s], ay[s + 1], ay[s + 2]
        if s + STRIDE <= end:
            x3, x4, x5, y3, y4, y5 = ax[s + 3], ax[s + 4], ax[s + 5], ay[s + 3], ay[s + 4], ay[s + 5]
            for k in range(LANES):
                ux, vx, uy, vy, top = state[UX, k], state[VX, k], state[UY, k], state[VY, k], state[TOP, k]
                uu, uv, u0, u1 = factor[UU, k], factor[UV, k], factor[U0, k], factor[U1, k]
                vu, vv, v0, v1 = factor[VU, k], factor[VV, k], factor[V0, k], factor[V1, k]
                ux, vx = next_state(ux, vx, x0, x1, uu, uv, u0, u1, vu, vv, v0, v1)
                uy, vy = next_state(uy, vy, y0, y1, uu, uv, u0, u1, vu, vv, v0, v1)
                top = max(top, ux * ux + uy * uy)
                ux, vx = next_state(ux, vx, x1, x2, uu, uv, u0, u1, vu, vv, v0, v1)
                uy, vy = next_state(uy, vy, y1, y2, uu, uv, u0, u1, vu, vv, v0, v1)
                top = max(top, ux * ux + uy * uy)
                ux, vx = next_state(ux, vx, x2, x3, uu, uv, u0, u1, vu, vv, v0, v1)
                uy, vy = next_state(uy, vy, y2, y3, uu, uv, u0, u1, vu, vv, v0, v1)
                top = max(top, ux * ux + uy * uy)
                ux, vx = next_state(ux, vx, x3, x4, uu, uv, u0, u1, vu, vv, v0, v1)
                uy, vy = next_state(uy, vy, y3, y4, uu, uv, u0, u1, vu, vv, v0, v1)
                state[UX, k], state[VX, k], state[UY, k], state[VY, k] = ux, vx, uy, vy
                state[TOP, k] = max(top, ux * ux + uy * uy)
            _measure(state, factor, x4, y4, x5 - x4, y5 - y4)
            s += STRIDE
        else:
            for k in range(LANES):
                uu, uv, u0, u1 = factor[UU, k], factor[UV, k], factor[U0, k], factor[U1, k]
                vu, vv, v0, v1 = factor[VU, k], factor[VV, k], factor[V0, k], factor[V1, k]
                ux, vx = next_state(state[UX, k], state[VX, k], x0, x1, uu, uv, u0, u1, vu, vv, v0, v1)
                uy, vy = next_state(state[UY, k], state[VY, k], y0, y1, uu, uv, u0, u1, vu, vv, v0, v1)
                state[UX, k], state[VX, k], state[UY, k], state[VY, k] = ux, vx, uy, vy
                state[TOP, k] = max(state[TOP, k], ux * ux + uy * uy)
            _measure(state, factor, x1, y1, x2 - x1, y2 - y1)
            s += 1


@inner
def _measure(state: Array, factor: Array, x: float, y: float, rise_x: float, rise_y: float) -> None:
    # Raise the lanes' largest energy to that of the interval that begins here.
    for k in range(LANES):
        b, c, w, twice, ramp = factor[B, k], factor[C, k], factor[W, k], factor[TWICE, k], factor[RAMP, k]
        vx, vy = state[VX, k], state[VY, k]
        energy = interval_energy(x + (c * vx + b * state[UX, k]), vx, rise_x, w, twice, ramp)
        energy += interval_energy(y + (c * vy + b * state[UY, k]), vy, rise_y, w, twice, ramp)
        state[TOP_E, k] = max(state[TOP_E, k], energy)


@inner
def _shake(
    ax: Array, ay: Array, n: int, dt: float, length: int, outline: Array, state: Array, factor: Array, stretch: Array
) -> None:
    # The whole record of n samples, and of each stretch of length intervals what the rows of stretch say.
    for part in range(stretch.shape[0]):
        begin = part * length
        longest, steepest, sharpest = outline[part, LONGEST], outline[part, STEEPEST], outline[part, SHARPEST]
        for k in range(LANES):
            stretch[part, BEGIN_UX, k], stretch[part, BEGIN_VX, k] = state[UX, k], state[VX, k]
            stretch[part, BEGIN_UY, k], stretch[part, BEGIN_VY, k] = state[UY, k], state[VY, k]
            state[TOP, k], state[TOP_E, k] = state[UX, k] ** 2 + state[UY, k] ** 2, 0.0
        _measure(state, factor, ax[begin], ay[begin], ax[begin + 1] - ax[begin], ay[begin + 1] - ay[begin])
        _walk(ax, ay, begin, min(n - 1, begin + length), state, factor)
        for k in range(LANES):
            top = math.sqrt(state[TOP, k])
            energy = math.sqrt(state[TOP_E, k]) + (STRIDE - 1) * sharpest * factor[RAMP, k]
            gap, room = _gap_and_room(energy, steepest, dt, factor[TWICE, k], factor[RAMP, k], factor[NORM, k])
            state[MOST, k] = max(state[MOST, k], top)
            stretch[part, REACH, k] = min(top + gap, (longest + room) / factor[B, k])
            stretch[part, GAP, k], stretch[part, ROOM, k] = gap, room


@inner
def _longest(
    ux: float,
    vx: float,
    uy: float,
    vy: float,
    ax: float,
    rise_x: float,
    ay: float,
    rise_y: float,
    factor: Array,
    k: int,
    span: float,
    known: Array,
) -> None:
    # The longest resultant in a short span, if it is longer than what is known: where u . v changes its sign.
    w, zeta = factor[W, k], factor[ZETA, k]
    end_ux, end_vx = advance(ux, vx, -ax, -rise_x, w, zeta, span)
    end_uy, end_vy = advance(uy, vy, -ay, -rise_y, w, zeta, span)
    first, last, before = 0.0, span, span
    rising, falling = ux * vx + uy * vy, end_ux * end_vx + end_uy * end_vy
    if rising > 0.0 and falling < 0.0:
        # By false position; the end that stays counts half (Illinois).
        stays = 0
        for _ in range(TRIES):
            middle = first + (last - first) * rising / (rising - falling)
            end_ux, end_vx = advance(ux, vx, -ax, -rise_x, w, zeta, middle)
            end_uy, end_vy = advance(uy, vy, -ay, -rise_y, w, zeta, middle)
            if abs(middle - before) <= CLOSE * span:
                break
            rate, before = end_ux * end_vx + end_uy * end_vy, middle
            if rate > 0.0:
                first, rising = middle, rate
                falling, stays = falling * 0.5 if stays > 0 else falling, 1
            else:
                last, falling = middle, rate
                rising, stays = rising * 0.5 if stays < 0 else rising, -1
    size = math.hypot(end_ux, end_uy)
    if size > known[SIZE]:
        known[SIZE], known[AT_X], known[AT_Y] = size, end_ux, end_uy


@inner
def _search(
    ax: Array,
    ay: Array,
    push: Array,
    begin: int,
    end: int,
    dt: float,
    stretch: Array,
    part: int,
    factor: Array,
    k: int,
    known: Array,
) -> None:
    # Walk one oscillator from sample begin to sample end again, and search what can hold the longest resultant.
    b, c, w, zeta = factor[B, k], factor[C, k], factor[W, k], factor[ZETA, k]
    twice, ramp, norm = factor[TWICE, k], factor[RAMP, k], factor[NORM, k]
    uu, uv, u0, u1 = factor[UU, k], factor[UV, k], factor[U0, k], factor[U1, k]
    vu, vv, v0, v1 = factor[VU, k], factor[VV, k], factor[V0, k], factor[V1, k]
    ux, vx, uy, vy = (
        stretch[part, BEGIN_UX, k],
        stretch[part, BEGIN_VX, k],
        stretch[part, BEGIN_UY, k],
        stretch[part, BEGIN_VY, k],
    )
    spans = max(1, math.ceil(w * dt * (1.0 + twice) / PHASE))
    # Of one span, once for all: a stiff oscillator has hundreds of them in a sample interval.
    span = dt / spans
    g, h, h1, h2 = transition(w, zeta, span)
    size = math.sqrt(ux * ux + uy * uy)
    for s in range(begin, end):
        x0, x1, y0, y1 = ax[s], ax[s + 1], ay[s], ay[s + 1]
        next_ux, next_vx = next_state(ux, vx, x0, x1, uu, uv, u0, u1, vu, vv, v0, v1)
        next_uy, next_vy = next_state(uy, vy, y0, y1, uu, uv, u0, u1, vu, vv, v0, v1)
        next_size = math.sqrt(next_ux * next_ux + next_uy * next_uy)
        near, longest = max(size, next_size), max(push[s], push[s + 1])
        # First with what the whole stretch grants, then with what this interval does.
        if near + stretch[part, GAP, k] >= known[SIZE] and longest + stretch[part, ROOM, k] >= b * known[SIZE]:
            energy = interval_energy(x0 + (c * vx + b * ux), vx, x1 - x0, w, twice, ramp)
            energy += interval_energy(y0 + (c * vy + b * uy), vy, y1 - y0, w, twice, ramp)
            gap, room = _gap_and_room(
                math.sqrt(energy), math.sqrt((x1 - x0) ** 2 + (y1 - y0) ** 2), dt, twice, ramp, norm
            )
            if near + gap >= known[SIZE] and longest + room >= b * known[SIZE]:
                rise_x, rise_y = (x1 - x0) / dt, (y1 - y0) / dt
                gap_here = gap / (spans * spans)
                here_ux, here_vx, here_uy, here_vy = ux, vx, uy, vy
                for part_of in range(spans):
                    t = part_of * span
                    begin_x, begin_y = x0 + t * rise_x, y0 + t * rise_y
                    then_ux, then_vx = carried(here_ux, here_vx, -begin_x, -rise_x, w, zeta, g, h, h1, h2)
                    then_uy, then_vy = carried(here_uy, here_vy, -begin_y, -rise_y, w, zeta, g, h, h1, h2)
                    ends = math.sqrt(max(here_ux * here_ux + here_uy * here_uy, then_ux * then_ux + then_uy * then_uy))
                    if ends + gap_here >= known[SIZE]:
                        _longest(
                            here_ux, here_vx, here_uy, here_vy, begin_x, rise_x, begin_y, rise_y, factor, k, span, known
                        )
                    here_ux, here_vx, here_uy, here_vy = then_ux, then_vx, then_uy, then_vy
        ux, vx, uy, vy, size = next_ux, next_vx, next_uy, next_vy, next_size


@inner
def _coast(ux: float, vx: float, uy: float, vy: float, factor: Array, k: int, tail: float, known: Array) -> None:
    # Free decay: the sum of both energies cannot grow.
    w, zeta = factor[W, k], factor[ZETA, k]
    if math.sqrt(ux * ux + uy * uy + (vx * vx + vy * vy) / (w * w)) <= known[SIZE]:
        return
    # From one period of it to the next every resultant becomes shorter.
    if zeta < 1.0:
        stop = 2.0 * math.pi / (w * math.sqrt((1.0 - zeta) * (1.0 + zeta)))
        stop = min(stop, 60.0 / (w * max(zeta, 1e-300)))
    else:
        stop = 60.0 * (1.0 + zeta) / w
    stop = min(stop, tail if tail >= 0.0 else 1e300)
    t, span = 0.0, PHASE / (w * (1.0 + 2.0 * zeta))
    while t < stop:
        now = min(span, stop - t)
        _longest(ux, vx, uy, vy, 0.0, 0.0, 0.0, 0.0, factor, k, now, known)
        ux, vx = advance(ux, vx, 0.0, 0.0, w, zeta, now)
        uy, vy = advance(uy, vy, 0.0, 0.0, w, zeta, now)
        t += now
        if zeta >= 1.0:
            span *= 1.5


@kernel
def resultant_batch(
    base_x: Array, base_y: Array, dt: float, w: Array, zeta: Array, tail: float, most: Array, angle: Array
) -> None:
    r"""Find the longest resultants of m oscillators under one base motion in two directions.

    .. math::

        \mathbf{u}'' + 2 \zeta w \mathbf{u}' + w^2 \mathbf{u} = -\mathbf{a}

    Parameters
    ----------
    base_x, base_y : ndarray, shape (n,)
        a, m/s2: excitation between the first and the last sample, none outside.
    dt : float
        Time step, s.
    w, zeta : ndarray, shape (m,)
        Angular frequency [rad/s] and damping ratio [-].
    tail : float
        Seconds to go on after the record, or -1: until past the peaks.
    most : ndarray, shape (m,)
        Receives the largest ``|u|`` [m], between the samples too.
    angle : ndarray, shape (m,)
        Receives the direction of u then, or the one opposite to it [rad], from x towards y.

    References
    ----------
    Nigam and Jennings (1969), as in `pipeline.kernels.oscillator.oscillator_batch`; Boore, D. M. (2010).
    Orientation-independent, nongeometric-mean measures of seismic intensity from two horizontal components of motion.
    Bulletin of the Seismological Society of America 100: RotD100.
    """
    n, m = base_x.shape[0], w.shape[0]
    most[:], angle[:] = 0.0, 0.0
    if n < 2:
        return
    # A sample more, so that the last one has a slope like the others.
    ax, ay = np.empty(n + 1), np.empty(n + 1)
    for i in range(n):
        ax[i], ay[i] = base_x[i], base_y[i]
    ax[n], ay[n] = base_x[n - 1], base_y[n - 1]
    length = CHUNK * ((n - 2) // (CHUNK * STRETCHES) + 1)
    parts = (n - 2) // length + 1
    # Roots of squares, here and below, as the lanes have them: hypot costs five times as much.
    push = np.empty(n + 1)
    for i in range(n + 1):
        push[i] = math.sqrt(ax[i] * ax[i] + ay[i] * ay[i])
    outline, stretch, known = np.empty((parts, 3)), np.empty((parts, 7, LANES)), np.empty(3)
    _outline(ax, ay, push, n, length, outline)
    factor, state = lanes(FACTORS), lanes(STATES)
    for begin in range(FIRST, m, LANES):
        end = min(begin + LANES, m)
        state[:] = 0.0
        for k in range(LANES):
            one = min(begin + k, end - 1)
            _coefficients(w[one], zeta[one], dt, k, factor)
        _shake(ax, ay, n, dt, length, outline, state, factor, stretch)
        for k in range(end - begin):
            # The longest at a sample is found again on the way, with its direction.
            known[SIZE], known[AT_X], known[AT_Y] = (1.0 - 1e-12) * state[MOST, k], 0.0, 0.0
            for part in range(parts):
                if 0.0 < stretch[part, REACH, k] >= known[SIZE]:
                    start = part * length
                    _search(ax, ay, push, start, min(n - 1, start + length), dt, stretch, part, factor, k, known)
            _coast(state[UX, k], state[VX, k], state[UY, k], state[VY, k], factor, k, tail, known)
            most[begin + k], angle[begin + k] = known[SIZE], math.atan2(known[AT_Y], known[AT_X])
