"""One step of a standing body in each of its modes, or the part of the step until the mode changes."""

import math

from pipeline.kernels import fused, inner
from pipeline.kernels.line_phase import SIZE, U0, U1, Body, after, expand, first_stop
from pipeline.kernels.rock_phase import ANGLE, SPEED, landing, lift_off, locate, rock_after
from pipeline.kernels.rocking import OVERTURNED
from pipeline.kernels.roots import narrowed, trial
from pipeline.kernels.slip_phase import PRESS, SLIP, TURN, Edge, Load, Moving, slip_after, slip_landing, slip_locate
from pipeline.kernels.slip_phase import RATE as TURNING
from pipeline.kernels.standing_body import (
    ALPHA,
    ARM,
    AWAY,
    CS,
    FALLING,
    HALF,
    HEIGHT,
    HOLD,
    INVERSE,
    MODE,
    MU_K,
    MU_S,
    PHI,
    RATE,
    RATIO,
    RESIDUAL,
    RHO2,
    ROCKS,
    SIDE,
    SLIDE_ROCKS,
    SN,
    TANGENT,
    VX,
    VY,
    WAY,
    U,
    V,
    X,
    Y,
    drift,
    fly,
    go_on_flat,
    go_on_tilted,
    hit,
    jam,
    jams,
    land,
    lies,
    spare_friction,
    sway,
    track,
)
from pipeline.quantities import Array, G

BELOW = 1.0 - 1e-9
"""Share of an angle from which on a body counts as having reached it."""

FAINT = 1e-13
"""Clear height, as a share of the height of the centre of gravity, that is rounding."""


@inner
def rest_on(state: Array, load: Load, t: float, span: float, body: Array) -> float:
    """Let a body rest until friction, an edge or its weight no longer holds it.

    Parameters
    ----------
    state, body : ndarray
        As in `pipeline.kernels.standing_body`.
    load : tuple of float
        Push and weight per mass at time 0 [m/s2], and their rates [m/s3].
    t, span : float
        From when, and until when at most, s.

    Returns
    -------
    float
        Until when, s.
    """
    a0, a1, n0, n1 = load
    hold1, hold2 = min(body[MU_S], body[TANGENT]), min(body[MU_S], body[TANGENT + 1])
    lift, way = lift_off(a0, a1, n0, n1, t, span, hold1, hold2)
    if way == 0.0:
        return span
    state[V], state[WAY] = 0.0, way
    go_on_flat(state, a0 + a1 * lift, n0 + n1 * lift, body)
    return lift


@inner
def slide_on(
    state: Array, load: Load, t: float, span: float, body: Array, line: Body, series: Array, out: Array
) -> float:
    """Let a body slide on its base, in closed form, until it stops or is thrown up.

    Parameters
    ----------
    state, load, t, span, body, out
        As in `rest_on` and `pipeline.kernels.standing_body`.
    line, series
        As in `pipeline.kernels.line_phase`.

    Returns
    -------
    float
        Until when, s.
    """
    a0, a1, n0, n1 = load
    a, n, drag = a0 + a1 * t, max(0.0, n0 + n1 * t), state[WAY] * body[MU_K]
    f0, f1 = -a - drag * n, -a1 - drag * n1
    left = span - t
    lifts = n + n1 * left < 0.0
    if lifts:
        left = -n / n1
    u, v = state[U], state[V]
    expand(u, v, f0, f1, line, series)
    vn, moved = after(series, line[SIZE], left)
    stop, there = first_stop(u, v, state[WAY], f0, f1, line, series, left, u + moved, vn)
    if stop >= 0.0:
        t += stop
        state[U], state[V], state[WAY] = there, 0.0, 0.0
        track(state, body, out)
        go_on_flat(state, a0 + a1 * t, max(0.0, n0 + n1 * t), body)
        return t
    state[U], state[V] = u + moved, vn
    track(state, body, out)
    if lifts:
        fly(state, body)
        return t + left
    return span


@inner
def glide_on(state: Array, x: Array, z: Array, dt: float, begin: int, body: Array, line: Body, out: Array) -> int:
    """Let a body slide on its base through the sample intervals in which it does nothing else.

    Parameters
    ----------
    state, body, line, out
        As in `slide_on`.
    x, z, dt
        As in `pipeline.kernels.standing.standing_batch`.
    begin : int
        The sample that it is at.

    Returns
    -------
    int
        The sample up to which it does; begin where it does not at all.
    """
    u, v, s, top, drag = state[U], state[V], state[WAY], 0.0, state[WAY] * body[MU_K]
    i, last = begin, x.shape[0] - 1
    while i < last and G + z[i] >= 0.0 and G + z[i + 1] >= 0.0:
        f0 = -x[i] - drag * (G + z[i])
        f1 = -((x[i + 1] - x[i]) / dt) - drag * ((z[i + 1] - z[i]) / dt)
        un = u + v * dt + f0 * line[U0] + f1 * line[U1]
        vn = v + f0 * dt + f1 * line[U0]
        if not (s * v > 0.0 and s * vn > 0.0) or s * f0 < 0.0 < s * (f0 + f1 * dt):
            break
        u, v = un, vn
        top = max(top, abs(u))
        i += 1
    state[U], state[V] = u, v
    if i > begin:
        out[AWAY], out[RESIDUAL] = max(out[AWAY], top), u
    return i


@fused
def _spared(
    at: Moving, load: Load, t: float, h: float, s: float, c: float, arm: float, mu: float
) -> tuple[float, float]:
    # The friction that a rocking edge does not need after a step, and the direction in which it would slip.
    a0, a1, n0, n1 = load
    _p, r, sn, cs = rock_after(at[0], at[1], at[2], at[3], a0, a1, n0, n1, t, h, s, c)
    return spare_friction(r, sn, cs, a0 + a1 * (t + h), n0 + n1 * (t + h), s, c, arm, mu)


@fused
def _slips(at: Moving, load: Load, t: float, h: float, s: float, c: float, arm: float, mu: float) -> float:
    # The length of the step after which a rocking edge begins to slip, which it does before h.
    low, high, side, tau = 0.0, h, 0, 0.0
    at_low, _way = _spared(at, load, t, low, s, c, arm, mu)
    if at_low <= 0.0:
        return 0.0
    at_high, _way = _spared(at, load, t, high, s, c, arm, mu)
    for _ in range(60):
        before, tau = tau, trial(low, high, at_low, at_high)
        value, _way = _spared(at, load, t, tau, s, c, arm, mu)
        low, high, at_low, at_high, side = narrowed(low, high, at_low, at_high, side, tau, value)
        if value == 0.0 or abs(tau - before) <= 1e-15 * tau:
            break
    return tau


@inner
def _turning_point(x0: float, v0: float, x1: float, v1: float, h: float) -> float:
    # Where the cubic through places and velocities of opposite sign at both ends of a step turns.
    if h <= 0.0:
        return x1
    slope = (x1 - x0) / h
    a, b = 3.0 * (v0 + v1 - 2.0 * slope), 2.0 * (3.0 * slope - 2.0 * v0 - v1)
    root = math.sqrt(max(0.0, b * b - 4.0 * a * v0))
    k = 2.0 * v0 / (-b + math.copysign(root, v0))
    # A step so short that its slope is rounding alone has no turn worth having.
    if not 0.0 <= k <= 1.0:
        return x1
    return x0 + h * k * (v0 + k * (0.5 * b + k * a / 3.0))


@fused
def rock_on(state: Array, load: Load, t: float, h: float, clock: float, rest: float, body: Array, out: Array) -> float:
    """Let a body rock about an edge that does not slip: one step, or until it slips, lands or lies.

    Parameters
    ----------
    state, load, t, body, out
        As in `rest_on` and `pipeline.kernels.standing_body`.
    h : float
        Length of the step, s.
    clock : float
        Time 0 since the beginning of the record, s.
    rest : float
        As in `pipeline.kernels.standing_body.land`.

    Returns
    -------
    float
        Until when, s.
    """
    a0, a1, n0, n1 = load
    s, phi, rate, sn, cs = state[SIDE], state[PHI], state[RATE], state[SN], state[CS]
    i = 0 if s > 0.0 else 1
    alpha, c, arm, mu = body[ALPHA + i], body[INVERSE + i], body[ARM + i], body[MU_S]
    p1, r1, s1, c1 = rock_after(phi, rate, sn, cs, a0, a1, n0, n1, t, h, s, c)
    falls, landed, whole = max(FALLING, alpha), -1.0, h
    if p1 > falls and phi < falls * BELOW:
        h = locate(phi, rate, sn, cs, a0, a1, n0, n1, t, 0.0, h, phi - falls, p1 - falls, s, c, ANGLE, falls)
    elif p1 <= 0.0 or rate < 0.0 < r1:
        landed = landing(phi, rate, sn, cs, a0, a1, n0, n1, t, h, s, c, p1, r1)
        h = landed if landed >= 0.0 else h
    elif p1 >= OVERTURNED:
        low, high = phi - OVERTURNED, p1 - OVERTURNED
        h = locate(phi, rate, sn, cs, a0, a1, n0, n1, t, 0.0, h, low, high, s, c, ANGLE, OVERTURNED)
        lies(clock + t + h, alpha, out)
        return t + h
    if h != whole:
        p1, r1, s1, c1 = rock_after(phi, rate, sn, cs, a0, a1, n0, n1, t, h, s, c)
    spare, way = spare_friction(r1, s1, c1, a0 + a1 * (t + h), n0 + n1 * (t + h), s, c, arm, mu)
    slips = False
    if spare < 0.0 and state[HOLD] == 0.0:
        tau = _slips((phi, rate, sn, cs, 0.0, 0.0), load, t, h, s, c, arm, mu)
        state[PHI], state[RATE], state[SN], state[CS] = rock_after(phi, rate, sn, cs, a0, a1, n0, n1, t, tau, s, c)
        slips = not jams(state, way, body)
        if slips:
            p1, r1, s1, c1 = state[PHI], state[RATE], state[SN], state[CS]
            h, landed = tau, -1.0
    if rate > 0.0 > r1 and (phi + h * rate) / alpha > out[RATIO]:
        tau = locate(phi, rate, sn, cs, a0, a1, n0, n1, t, 0.0, h, rate, r1, s, c, SPEED, 0.0)
        out[RATIO] = max(out[RATIO], rock_after(phi, rate, sn, cs, a0, a1, n0, n1, t, tau, s, c)[0] / alpha)
    state[PHI], state[RATE], state[SN], state[CS], state[HOLD] = phi, rate, sn, cs, 0.0
    place, leaves = track(state, body, out), sway(state, body)
    state[PHI], state[RATE], state[SN], state[CS] = p1, r1, s1, c1
    there, comes = track(state, body, out), sway(state, body)
    if leaves * comes < 0.0 and p1 <= falls:
        out[AWAY] = max(out[AWAY], abs(_turning_point(place, leaves, there, comes, h)))
    out[RATIO] = max(out[RATIO], p1 / alpha)
    t += h
    if slips:
        state[MODE], state[WAY], state[V] = SLIDE_ROCKS, way, 0.0
    elif landed >= 0.0:
        land(state, a0 + a1 * t, n0 + n1 * t, rest, body, out)
    return t


NOTHING, STOPS, LIFTS, LANDS, FALLS = 0, 1, 2, 3, 4
"""What ends a step about a slipping edge."""


@fused
def _first_end(
    at: Moving, after_all: Moving, load: Load, t: float, h: float, edge: Edge, way: float, falls: float
) -> tuple[float, int]:
    # When a step about a slipping edge ends, and by what.  A slip that does not get going ends at once.
    tau, event = h, NOTHING
    p1, r1, _s1, c1, _u1, v1 = after_all
    if way * v1 <= 0.0:
        low = 0.0
        if at[5] == 0.0:
            low = h
            for _ in range(40):
                low *= 0.5
                if way * slip_after(at, load, t, low, edge)[5] > 0.0:
                    break
            else:
                return 0.0, STOPS
        tau, event = slip_locate(at, load, t, low, h, edge, SLIP, 0.0), STOPS
    if load[2] + load[3] * (t + h) - edge[2] * c1 * r1 * r1 < 0.0:
        other = slip_locate(at, load, t, 0.0, h, edge, PRESS, 0.0)
        if other < tau:
            tau, event = other, LIFTS
    if p1 <= 0.0 or at[1] < 0.0 < r1:
        other = slip_landing(at, load, t, h, edge, p1, r1)
        if other >= 0.0 and (event == NOTHING or other < tau):
            tau, event = other, LANDS
    # Once past the angle from which on its base is not followed, it lies at a quarter turn.
    level = falls if at[0] < falls * BELOW else OVERTURNED
    if event not in (NOTHING, LANDS):
        p1 = slip_after(at, load, t, tau, edge)[0]
    if event != LANDS and p1 > level:
        tau, event = slip_locate(at, load, t, 0.0, tau, edge, TURN, level), FALLS
    return tau, event


@fused
def slide_rock_on(
    state: Array, load: Load, t: float, h: float, clock: float, rest: float, body: Array, out: Array
) -> float:
    """Let a body rock about an edge that slips: one step, or until it stops, lifts off, lands or lies.

    Parameters
    ----------
    state, load, t, h, clock, rest, body, out
        As in `rock_on`.

    Returns
    -------
    float
        Until when, s.
    """
    s, way = state[SIDE], state[WAY]
    i = 0 if s > 0.0 else 1
    alpha, arm = body[ALPHA + i], body[ARM + i]
    edge = (s, way * body[MU_K], arm, body[RHO2])
    at = (state[PHI], state[RATE], state[SN], state[CS], state[U], state[V])
    if load[2] + load[3] * t - arm * at[3] * at[1] * at[1] < 0.0:
        fly(state, body)
        return t
    if jams(state, way, body):
        jam(state, body)
        return t
    falls = max(FALLING, alpha)
    then = slip_after(at, load, t, h, edge)
    tau, event = _first_end(at, then, load, t, h, edge, way, falls)
    if event == STOPS and tau == 0.0:
        # It does not get going: taken to hold for this step.
        state[MODE], state[HOLD] = ROCKS, 1.0
        return t
    if event != NOTHING:
        then = slip_after(at, load, t, tau, edge)
    p1, r1, s1, c1, u1, v1 = then
    if at[1] > 0.0 > r1 and (at[0] + tau * at[1]) / alpha > out[RATIO]:
        top = slip_locate(at, load, t, 0.0, tau, edge, TURNING, 0.0)
        out[RATIO] = max(out[RATIO], slip_after(at, load, t, top, edge)[0] / alpha)
    place, leaves = track(state, body, out), at[5] + sway(state, body)
    state[PHI], state[RATE], state[SN], state[CS], state[U], state[V] = p1, r1, s1, c1, u1, v1
    there, comes = track(state, body, out), v1 + sway(state, body)
    if leaves * comes < 0.0 and p1 <= falls:
        out[AWAY] = max(out[AWAY], abs(_turning_point(place, leaves, there, comes, tau)))
    out[RATIO] = max(out[RATIO], p1 / alpha)
    t += tau
    a, n = load[0] + load[1] * t, load[2] + load[3] * t
    if event == STOPS:
        state[V] = 0.0
        go_on_tilted(state, a, n, body)
    elif event == LIFTS:
        fly(state, body)
    elif event == LANDS:
        land(state, a, n, rest, body, out)
    elif p1 >= OVERTURNED * BELOW:
        lies(clock + t, alpha, out)
    return t


@inner
def _clear(state: Array, load: Load, t: float, h: float, side: float, body: Array) -> float:
    # How high above the surface a corner of a flying body is after a step.
    high = state[Y] + h * (state[VY] - h * (0.5 * (load[2] + load[3] * t) + load[3] * h / 6.0))
    phi = state[PHI] + h * state[RATE]
    half = body[HALF] if side > 0.0 else body[HALF + 1]
    return high - side * half * math.sin(phi) - body[HEIGHT] * math.cos(phi)


@inner
def _touches(state: Array, load: Load, t: float, h: float, side: float, body: Array) -> float:
    # When within a step a corner of a flying body comes down; -1 if it does not.
    low, high, last, faint = 0.0, h, 0, FAINT * body[HEIGHT]
    at_low = _clear(state, load, t, low, side, body)
    at_high = _clear(state, load, t, high, side, body)
    if at_high > (0.0 if at_low > faint else -faint):
        return -1.0
    if at_low <= faint:
        # It has just gone up: find a time at which it is up.
        low = h
        for _ in range(30):
            low *= 0.5
            at_low = _clear(state, load, t, low, side, body)
            if at_low > faint:
                break
        else:
            return 0.0
    tau = high
    for _ in range(60):
        before, tau = tau, trial(low, high, at_low, at_high)
        value = _clear(state, load, t, tau, side, body)
        low, high, at_low, at_high, last = narrowed(low, high, at_low, at_high, last, tau, value)
        if value == 0.0 or abs(tau - before) <= 1e-15 * tau:
            break
    return tau


@inner
def fly_on(state: Array, load: Load, t: float, h: float, clock: float, body: Array, out: Array) -> float:
    """Let a body fly, in closed form: one step, or until a corner comes down or it has turned by a quarter.

    Parameters
    ----------
    state, load, t, h, clock, body, out
        As in `rock_on`.

    Returns
    -------
    float
        Until when, s.
    """
    a0, a1, n0, n1 = load
    side = 1.0 if state[PHI] > 0.0 or (state[PHI] == 0.0 and state[RATE] >= 0.0) else -1.0
    touched, at = 0.0, _touches(state, load, t, h, side, body)
    if at >= 0.0:
        touched, h = side, at
    at = _touches(state, load, t, h, -side, body)
    if 0.0 <= at < h:
        touched, h = -side, at
    falls = max(FALLING, body[ALPHA] if state[RATE] > 0.0 else body[ALPHA + 1])
    if abs(state[PHI]) < falls * BELOW and abs(state[PHI] + h * state[RATE]) > falls:
        touched, h = 0.0, (falls - math.copysign(1.0, state[RATE]) * state[PHI]) / abs(state[RATE])
    a, n = a0 + a1 * t, n0 + n1 * t
    place, leaves = track(state, body, out), state[VX] + drift(state, body)
    state[X] += h * (state[VX] - h * (0.5 * a + a1 * h / 6.0))
    state[Y] += h * (state[VY] - h * (0.5 * n + n1 * h / 6.0))
    state[VX] -= h * (a + 0.5 * a1 * h)
    state[VY] -= h * (n + 0.5 * n1 * h)
    state[PHI] += h * state[RATE]
    there, comes = track(state, body, out), state[VX] + drift(state, body)
    if leaves * comes < 0.0 and abs(state[PHI]) <= falls:
        out[AWAY] = max(out[AWAY], abs(_turning_point(place, leaves, there, comes, h)))
    t += h
    tilted = state[PHI]
    alpha = body[ALPHA] if tilted > 0.0 else body[ALPHA + 1]
    if abs(tilted) >= OVERTURNED:
        lies(clock + t - (abs(tilted) - OVERTURNED) / abs(state[RATE]), alpha, out)
        return t
    out[RATIO] = max(out[RATIO], abs(tilted) / alpha)
    if touched != 0.0:
        i, phi = (0 if touched > 0.0 else 1), touched * tilted
        state[SIDE], state[PHI], state[RATE] = touched, phi, touched * state[RATE]
        state[SN], state[CS] = math.sin(body[ALPHA + i] - phi), math.cos(body[ALPHA + i] - phi)
        state[U] = state[X] - touched * (body[HALF + i] - body[ARM + i] * state[SN])
        hit(state, a0 + a1 * t, n0 + n1 * t, body, out)
    return t
