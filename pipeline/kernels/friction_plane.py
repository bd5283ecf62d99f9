"""A body on dry friction in two directions, with or without a spring and a dashpot.

u'' + 2 zeta w u' + w^2 u + mu_k N u'/|u'| = -a, N = max(0, g + a_z); at rest while |a + w^2 u| <= mu_s N.

The direction of friction turns infinitely fast where the speed vanishes.  Onset and stop are therefore stepped over
with their own expansions; in between, an embedded Runge-Kutta pair (Dormand and Prince 1980) follows the path, one
sample interval at a time because the excitation has a kink at every sample.
"""

import math

import numpy as np

from pipeline.kernels import kernel
from pipeline.kernels.flags import CONTACT_LOST, CUT, EVENT_CAP
from pipeline.kernels.friction_line import CAP, FAINT
from pipeline.kernels.plane_step import felt, plane_rates, plane_step, raise_peaks, slowest
from pipeline.kernels.quiet import largest, next_above
from pipeline.quantities import Array, G

START = 1e-5
"""Speed, as a share of the scale of speeds, up to which the expansion at slip onset is used."""
CREEP = 200.0
"""Relaxations of the direction of friction in a stretch from which on a body of next to no speed is taken to creep."""
FAINT_SPEED = 1e-6
"""Speed, as a share of the scale of speeds, below which a body may creep."""
STOP = 1e-5
"""Speed, as a share of the scale of speeds, below which a decelerating body is brought to rest in closed form."""


@kernel
def _onset(qx: float, qy: float, q1x: float, q1y: float, l0: float, l1: float, span: float) -> float:
    # First time in [0, span] at which |q| > l, given |q| <= l at 0: |q| - l is convex, so there is at most one.
    end = math.hypot(qx + q1x * span, qy + q1y * span) - (l0 + l1 * span)
    if end <= 0.0:
        return -1.0
    a = q1x * q1x + q1y * q1y - l1 * l1
    half = qx * q1x + qy * q1y - l0 * l1
    c = min(0.0, (math.hypot(qx, qy) - l0) * (math.hypot(qx, qy) + l0))
    # a t^2 + 2 half t + c = 0 with c <= 0: the root that is not negative, without cancellation.
    root = math.sqrt(max(0.0, half * half - a * c))
    if half >= 0.0:
        return min(span, -c / (half + root)) if half + root > 0.0 else 0.0
    return min(span, max(0.0, (root - half) / a)) if a > 0.0 else 0.0


@kernel
def _start(state: Array, load: Array, t: float, left: float, qx: float, qy: float, scale: float, c: float) -> float:
    # Slip from rest along the expansion v = (e t + j t^2 / 2) d, d = d0 + d1 t, up to START times the scale of speeds.
    # Returns the time used.
    size = math.hypot(qx, qy)
    if size > 0.0:
        dx, dy = -qx / size, -qy / size
    else:
        # Without any hold (no friction, no contact) the push may be zero now: its rate says where to.
        rate = math.hypot(load[1], load[3])
        dx, dy = (-load[1] / rate, -load[3] / rate) if rate > 0.0 else (0.0, 0.0)
    grip = load[4] + load[5] * t
    excess = max(0.0, size - grip)
    jerk = -(load[1] * dx + load[3] * dy) - load[5] - c * excess
    target = START * scale
    if jerk > 0.0:
        used = 2.0 * target / (excess + math.sqrt(excess * excess + 2.0 * jerk * target))
    elif excess > 0.0:
        used = target / excess
    else:
        return left
    used = min(used, left)
    if excess + jerk * used < 0.0:
        used = min(used, -0.5 * excess / jerk)
    px = -(load[1] - (load[1] * dx + load[3] * dy) * dx)
    py = -(load[3] - (load[1] * dx + load[3] * dy) * dy)
    turn = 2.0 * excess + grip
    lag = used / turn if turn > 0.0 else 0.0
    ex, ey = dx + px * lag, dy + py * lag
    norm = math.hypot(ex, ey)
    if norm == 0.0:
        return left
    ex, ey = ex / norm, ey / norm
    speed = used * (excess + 0.5 * jerk * used)
    gone = used * used * (0.5 * excess + jerk * used / 6.0)
    state[0] += gone * ex
    state[1] += gone * ey
    state[2] = speed * ex
    state[3] = speed * ey
    state[4] += gone
    return used


@kernel
def _piece(
    state: Array,
    after: Array,
    trial: Array,
    load: Array,
    span: float,
    slipping: bool,
    guess: float,
    b: float,
    c: float,
    scale: float,
    rtol: float,
    out: Array,
) -> tuple[bool, float]:
    # One stretch on which excitation, grip and hold are linear.  load[4:6] is the kinetic grip mu_k N, load[6:8] the
    # hold mu_s N; state as in plane_step.
    # Returns whether the body slips at the end, and the step size to begin the next stretch with.
    t = 0.0
    for _ in range(200000):
        left = span - t
        if left <= 1e-14 * span:
            return slipping, guess
        ax, ay = load[0] + load[1] * t, load[2] + load[3] * t
        grip = load[4] + load[5] * t
        if not slipping:
            state[2], state[3] = 0.0, 0.0
            qx, qy = ax + b * state[0], ay + b * state[1]
            hold, hold1 = load[6] + load[7] * t, load[7]
            if math.hypot(qx, qy) <= hold:
                wait = _onset(qx, qy, load[1], load[3], hold, hold1, left)
                out[2] = max(out[2], math.hypot(ax, ay))
                if wait < 0.0:
                    out[2] = max(out[2], math.hypot(load[0] + load[1] * span, load[2] + load[3] * span))
                    return False, guess
                t += wait
                ax, ay = load[0] + load[1] * t, load[2] + load[3] * t
                out[2] = max(out[2], math.hypot(ax, ay))
                qx, qy = ax + b * state[0], ay + b * state[1]
                left = span - t
            slipping = True
            if left <= 1e-14 * span:
                return True, guess
            t += _start(state, load, t, left, qx, qy, scale, c)
            out[0] = max(out[0], math.hypot(state[0], state[1]))
            out[2] = max(out[2], felt(state, load[4] + load[5] * t, b, c))
            guess = min(guess, left)
            continue
        vx, vy = state[2], state[3]
        speed = math.hypot(vx, vy)
        rx, ry, _s = plane_rates(state[0], state[1], vx, vy, ax, ay, grip, b, c)
        if speed == 0.0:
            slipping = False
            continue
        if speed <= STOP * scale:
            slowing = -(rx * vx + ry * vy) / speed
            size = math.hypot(rx, ry)
            astray = abs(rx * vy - ry * vx) / size if size > 0.0 else 0.0
            qx, qy = ax + b * state[0], ay + b * state[1]
            push = math.hypot(qx, qy)
            stays = push <= load[6] + load[7] * t
            wait = speed / slowing if slowing > 0.0 else math.inf
            if wait <= left and (stays or astray <= 1e-4 * speed):
                gone = 0.5 * speed * wait
                state[0] += gone * vx / speed
                state[1] += gone * vy / speed
                state[4] += gone
                out[0] = max(out[0], math.hypot(state[0], state[1]))
                t += wait
                slipping = False
                continue
            if speed <= FAINT_SPEED * scale and grip * left > CREEP * speed and push > 0.0:
                # It creeps: friction keeps it on the line of the push, and its speed follows push and drag alone.
                gain, rise = push - grip, (qx * load[1] + qy * load[3]) / push - load[5]
                h = 0.25 * left
                h = min(h, FAINT_SPEED * scale / max(abs(gain), 1e-300))
                h = min(h, math.sqrt(FAINT_SPEED * scale / max(abs(rise), 1e-300)))
                later = max(0.0, (speed + h * (gain + 0.5 * rise * h)) / (1.0 + c * h))
                gone = 0.5 * h * (speed + later)
                state[0] -= gone * qx / push
                state[1] -= gone * qy / push
                state[2], state[3] = -later * qx / push, -later * qy / push
                state[4] += gone
                out[0] = max(out[0], math.hypot(state[0], state[1]))
                t += h
                continue
        # The direction of friction relaxes at the rate grip / speed; a larger step would only be rejected.
        h = min(guess, left)
        if grip > 0.0:
            h = min(h, 2.5 * speed / grip + 1e-12 * span)
        error = plane_step(state, load, t, h, b, c, after)
        allowed = rtol * max(scale, speed) * max(h / span, 0.02)
        if error > allowed and h > 1e-13 * span:
            guess = h * max(0.2, 0.9 * (allowed / error) ** 0.2)
            continue
        begin, end = rx * vx + ry * vy, 0.0
        if begin < 0.0:
            fx, fy, _s = plane_rates(
                after[0],
                after[1],
                after[2],
                after[3],
                load[0] + load[1] * (t + h),
                load[2] + load[3] * (t + h),
                load[4] + load[5] * (t + h),
                b,
                c,
            )
            end = fx * after[2] + fy * after[3]
        if begin < 0.0 < end and speed > STOP * scale and load[6] + load[7] * t > 0.0:
            # The speed has a least value inside: nothing, for a body that reverses on a line, and there it may stick.
            # Go most of the way, until the closed form above takes over.
            tau = slowest(state, trial, load, t, h, b, c, begin, end)
            if math.hypot(trial[2], trial[3]) <= 1e-3 * speed:
                guess = 0.9 * tau
                continue
        raise_peaks(state, after, trial, load, t, h, b, c, out)
        state[:] = after
        t += h
        grow = 5.0 if error == 0.0 else min(5.0, max(0.3, 0.9 * (allowed / error) ** 0.2))
        guess = min(h * grow, 4.0 * span)
    out[3] = float(int(out[3]) | EVENT_CAP)
    return slipping, guess


@kernel
def _weigh(load: Array, mu_s: float, mu_k: float, n0: float, n1: float) -> None:
    load[4], load[5], load[6], load[7] = mu_k * n0, mu_k * n1, mu_s * n0, mu_s * n1


@kernel
def _stretch(
    state: Array,
    after: Array,
    trial: Array,
    load: Array,
    x0: float,
    x1: float,
    y0: float,
    y1: float,
    z0: float,
    z1: float,
    span: float,
    slipping: bool,
    guess: float,
    b: float,
    c: float,
    mu_s: float,
    mu_k: float,
    scale: float,
    rtol: float,
    out: Array,
) -> tuple[bool, float]:
    # A sample interval, cut where contact ends or begins.
    n0, n1 = G + z0, z1
    end = n0 + n1 * span
    if n0 < 0.0 or end < 0.0:
        out[3] = float(int(out[3]) | CONTACT_LOST)
    cut = -1.0
    if (n0 < 0.0 < end) or (end < 0.0 < n0):
        cut = -n0 / n1
    load[0], load[1], load[2], load[3] = x0, x1, y0, y1
    if cut < 0.0:
        _weigh(load, mu_s, mu_k, max(0.0, n0), n1 if max(n0, end) > 0.0 else 0.0)
        return _piece(state, after, trial, load, span, slipping, guess, b, c, scale, rtol, out)
    _weigh(load, mu_s, mu_k, max(0.0, n0), n1 if n0 > 0.0 else 0.0)
    slipping, guess = _piece(state, after, trial, load, cut, slipping, guess, b, c, scale, rtol, out)
    load[0], load[2] = x0 + x1 * cut, y0 + y1 * cut
    _weigh(load, mu_s, mu_k, 0.0, n1 if n0 < 0.0 else 0.0)
    return _piece(state, after, trial, load, span - cut, slipping, guess, b, c, scale, rtol, out)


@kernel
def friction_plane_one(
    x: Array,
    y: Array,
    z: Array,
    ratio: Array,
    maxima: Array,
    push: Array,
    pushes: Array,
    dt: float,
    peak: float,
    w: float,
    zeta: float,
    mu_s: float,
    mu_k: float,
    tail: float,
    rtol: float,
    out: Array,
    history: Array,
) -> float:
    """Integrate one body and return its residual displacement |u| [m].

    x, y, z        : (n,) m/s2;  peak: the largest of push = |a_h|;  pushes: block maxima of push
    ratio, maxima  : from kernels.quiet, of this very motion
    rtol           : tolerance of the velocity in each sample interval, relative to the scale of speeds
    out            : (4,) receives max |u| [m], path [m], max transmitted acceleration [m/s2], flags
    history        : (m, 4) receives ux, uy and the absolute accelerations at the samples, as long as it is; rows after
                     the record follow the body on without excitation
    """
    n = x.shape[0]
    out[:] = 0.0
    if n < 2 or peak == 0.0:
        return 0.0
    b, c = w * w, 2.0 * zeta * w
    # Nothing to slip over a denormal friction: it divides grips by it.
    if mu_k < 1e-300:
        mu_k = 0.0
    state, after, trial, load = np.zeros(5), np.zeros(5), np.zeros(5), np.zeros(8)
    scale = peak * dt
    slipping, guess = False, dt
    recording = history.shape[0] > 0
    i = 0
    while i < n - 1:
        if not slipping and w == 0.0 and not recording:
            ahead = next_above(ratio, maxima, i, mu_s)
            if ahead >= n:
                out[2] = max(out[2], largest(push, pushes, i, n))
                break
            if ahead > i + 1:
                out[2] = max(out[2], largest(push, pushes, i, ahead))
                i = ahead - 1
        if i < history.shape[0]:
            _note(history, i, state, x[i], y[i], mu_s, mu_k, max(0.0, G + z[i]), b, c, slipping)
        slipping, guess = _stretch(
            state,
            after,
            trial,
            load,
            x[i],
            (x[i + 1] - x[i]) / dt,
            y[i],
            (y[i + 1] - y[i]) / dt,
            z[i],
            (z[i + 1] - z[i]) / dt,
            dt,
            slipping,
            guess,
            b,
            c,
            mu_s,
            mu_k,
            scale,
            rtol,
            out,
        )
        scale = max(scale, math.hypot(state[2], state[3]))
        i += 1
    if n - 1 < history.shape[0]:
        _note(history, n - 1, state, x[n - 1], y[n - 1], mu_s, mu_k, max(0.0, G + z[n - 1]), b, c, slipping)
    if history.shape[0] > n:
        load[:] = 0.0
        _weigh(load, mu_s, mu_k, G, 0.0)
        for k in range(n, history.shape[0]):
            slipping, guess = _piece(state, after, trial, load, dt, slipping, guess, b, c, scale, rtol, out)
            _note(history, k, state, 0.0, 0.0, mu_s, mu_k, G, b, c, slipping)
    _coast(state, after, trial, load, slipping, guess, w, zeta, mu_s, mu_k, tail, scale, rtol, dt, out)
    out[1] = state[4]
    return math.hypot(state[0], state[1])


@kernel
def _note(
    history: Array,
    i: int,
    state: Array,
    ax: float,
    ay: float,
    mu_s: float,
    mu_k: float,
    weight: float,
    b: float,
    c: float,
    slipping: bool,
) -> None:
    history[i, 0], history[i, 1] = state[0], state[1]
    speed = math.hypot(state[2], state[3])
    qx, qy = ax + b * state[0], ay + b * state[1]
    push = math.hypot(qx, qy)
    if slipping and speed > 0.0:
        drag = c + mu_k * weight / speed
        history[i, 2], history[i, 3] = -drag * state[2] - b * state[0], -drag * state[3] - b * state[1]
    elif push > mu_s * weight:
        # A jump past the hold is not felt: what is felt is the friction of the slip that begins here.
        history[i, 2] = mu_k * weight * qx / push - b * state[0]
        history[i, 3] = mu_k * weight * qy / push - b * state[1]
    else:
        history[i, 2], history[i, 3] = ax, ay


@kernel
def _coast(
    state: Array,
    after: Array,
    trial: Array,
    load: Array,
    slipping: bool,
    guess: float,
    w: float,
    zeta: float,
    mu_s: float,
    mu_k: float,
    tail: float,
    scale: float,
    rtol: float,
    dt: float,
    out: Array,
) -> None:
    # After the record: no excitation, full weight, until the body rests for good, the tail ends, or the cap.
    if tail == 0.0:
        return
    b, c = w * w, 2.0 * zeta * w
    endless = mu_k == 0.0 and (w == 0.0 or zeta == 0.0)
    if tail < 0.0 and endless:
        if slipping:
            out[3] = float(int(out[3]) | CUT)
        if w == 0.0:
            return
        tail = 2.0 * math.pi / w
    stop = tail if tail > 0.0 else CAP
    t = 0.0
    span = max(dt, min(0.1, 0.05 * stop)) if w == 0.0 else min(0.25 / (w * (1.0 + zeta)), max(dt, 0.01))
    load[:] = 0.0
    _weigh(load, mu_s, mu_k, G, 0.0)
    while t < stop:
        now = min(span, stop - t)
        slipping, guess = _piece(state, after, trial, load, now, slipping, guess, b, c, scale, rtol, out)
        t += now
        if not slipping:
            return
        speed = math.hypot(state[2], state[3])
        excess = abs(b * math.hypot(state[0], state[1]) - mu_k * G)
        if tail < 0.0 and excess <= 2.0 * c * speed and c * speed <= FAINT * b * out[0]:
            # Overdamped, it creeps towards the end of the friction's reach and never gets there: what is left of the
            # way is less than any digit of it.
            return
        if tail < 0.0 and mu_k == 0.0:
            energy = state[2] * state[2] + state[3] * state[3] + b * (state[0] * state[0] + state[1] * state[1])
            if energy <= 1e-24 * b * out[0] * out[0]:
                return
    if slipping and tail < 0.0:
        out[3] = float(int(out[3]) | CUT)


@kernel
def friction_plane_batch(
    x: Array,
    y: Array,
    z: Array,
    ratio: Array,
    maxima: Array,
    push: Array,
    pushes: Array,
    dt: float,
    peak: float,
    w: Array,
    zeta: Array,
    mu_s: Array,
    mu_k: Array,
    tail: float,
    rtol: float,
    results: Array,
) -> None:
    """Fill results (m, 5): max |u|, residual, path [m], max transmitted acceleration [m/s2], flags."""
    nothing = np.empty((0, 4))
    out = np.empty(4)
    for k in range(w.shape[0]):
        residual = friction_plane_one(
            x, y, z, ratio, maxima, push, pushes, dt, peak, w[k], zeta[k], mu_s[k], mu_k[k], tail, rtol, out, nothing
        )
        results[k, 0], results[k, 1], results[k, 2], results[k, 3], results[k, 4] = (
            out[0],
            residual,
            out[1],
            out[2],
            out[3],
        )
