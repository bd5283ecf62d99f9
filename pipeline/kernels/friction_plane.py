r"""Stick-slip of a body on dry friction in two directions, with or without a spring and a dashpot.

.. math::

    u'' + 2 \zeta w u' + w^2 u + \mu_k N \frac{u'}{|u'|} = -a_h, \qquad \text{at rest while } |a_h + w^2 u| \le \mu_s N

with u [m] and a_h [m/s2] in the plane, and the other symbols as in `pipeline.kernels.friction_line`.

Slip is followed by an implicit Runge-Kutta method whose stages have closed forms (kernels.plane_step), one sample
interval at a time because the excitation has a kink at every sample, in more steps where its error asks for them and
where the body is about to turn or to stop; the stop itself is taken in closed form (kernels.plane_stop).
"""

import math

import numpy as np

from pipeline.kernels import CONTACT_LOST, CUT, FIRST, SENSITIVE, UNRESOLVED, inner, kernel
from pipeline.kernels.friction_line import CAP, FAINT, MOST_AFTER
from pipeline.kernels.plane_peaks import felt, inner_felt, inner_radius, note, stop_radius
from pipeline.kernels.plane_step import plane_step
from pipeline.kernels.plane_stop import come_to_rest
from pipeline.kernels.quiet import largest, next_above, next_slip, onset
from pipeline.quantities import Array, G

Control = tuple[float, float, float, float, float]
"""Tolerance of a step's error, share of its speed that a step may take off or turn away, share of push and grip that
may change during a stop, and the shortest and the longest step as shares of a sample interval."""

STEPS = 200000
"""Steps in a sample interval after which the body is not followed further."""
MOST_STEPS, MOST_EACH = 5_000_000, 3000
"""The same in a record: so many, and so many more for each of its samples."""
TRIALS = 60
"""Shorter and shorter steps that are tried before the body is taken to rest."""
CRAWL = 1e-9
"""Speed, as a share of the scale of speeds, at which a body that will stop is taken to stop."""
NEAR = 0.02
"""Share of the error that a velocity may have, below which a body that is slower may have come to rest, or one that
has may not; the error is a bound, and mostly much smaller."""
SHARE = 1.5
"""Share of its speed that a step may take off or turn away, over the eighth root of the tolerance."""
SLOW = 1e-2
"""Scale of speeds before any motion, as a share of the largest push over a sample interval."""


@inner
def _piece(
    state: Array,
    load: Array,
    span: float,
    slipping: bool,
    guess: float,
    b: float,
    c: float,
    scale: float,
    control: Control,
    out: Array,
) -> tuple[bool, float]:
    # One stretch on which excitation, grip and hold are linear: load holds ax, its rate, ay, its rate, the kinetic grip
    # mu_k N, its rate, the hold mu_s N, its rate; state is ux, uy, vx, vy, path,
    # the direction of v and its size.
    # Returns whether the body slips at the end, and the step size to begin the next stretch with.
    ux, uy, vx, vy, path = state[0], state[1], state[2], state[3], state[4]
    ex, ey, speed = state[5], state[6], state[7]
    rtol, share, change, faint = control[0], control[1], control[2], control[3] * span
    longest = control[4] * span
    stray, off = state[8], state[9]
    w = math.sqrt(b)
    most, top, felt_most = out[0] * out[0], out[0] * out[0], out[2]
    t = 0.0
    done = False
    used, unseen, late = 0, out[4], 0.0
    for used in range(min(STEPS, int(state[10]))):  # noqa: B007
        left = span - t
        if left <= 1e-14 * span:
            done = True
            break
        ax, ay = load[0] + load[1] * t, load[2] + load[3] * t
        if not slipping:
            vx, vy, speed = 0.0, 0.0, 0.0
            qx, qy = ax + b * ux, ay + b * uy
            hold = load[6] + load[7] * t
            if qx * qx + qy * qy <= hold * hold:
                if late > 0.0:
                    if ax * ax + ay * ay > felt_most * felt_most:
                        out[5] = max(out[5], late * (math.hypot(load[1], load[3]) + abs(load[5])))
                    late = 0.0
                stray = w * off
                wait = onset(qx, qy, load[1], load[3], hold, load[7], left)
                felt_most = max(felt_most, math.sqrt(ax * ax + ay * ay))
                if wait < 0.0:
                    ax, ay = load[0] + load[1] * span, load[2] + load[3] * span
                    felt_most = max(felt_most, math.sqrt(ax * ax + ay * ay))
                    done = True
                    break
                t += wait
                ax, ay = load[0] + load[1] * t, load[2] + load[3] * t
                felt_most = max(felt_most, math.sqrt(ax * ax + ay * ay))
                left = span - t
            slipping = True
            guess = longest
            if left <= 1e-14 * span:
                done = True
                break
        qx, qy = -ax - b * ux - c * vx, -ay - b * uy - c * vy
        grip, hold = load[4] + load[5] * t, load[6] + load[7] * t
        h = left
        if speed > 0.0:
            rx, ry = qx - grip * ex, qy - grip * ey
            turn = abs(rx * ey - ry * ex) + max(0.0, -rx * ex - ry * ey)
            # Without any hold it neither stops nor turns at once.
            if h * turn > share * speed and max(load[6], load[7]) > 0.0:
                q1x, q1y = -load[1] - 0.5 * b * vx - c * rx, -load[3] - 0.5 * b * vy - c * ry
                wait, dx, dy, way, astray = come_to_rest(
                    speed, vx, vy, ex, ey, qx, qy, q1x, q1y, load, t, left, change, b + c * c, speed <= CRAWL * scale
                )
                if wait >= 0.0:
                    if ux * vx + uy * vy > 0.0 and (math.sqrt(ux * ux + uy * uy) + way) ** 2 > top:
                        inner = stop_radius(ux, uy, vx * wait, vy * wait, dx, dy)
                        top, unseen = max(top, inner), max(unseen, math.sqrt(inner) - math.hypot(ux + dx, uy + dy))
                    ux, uy, path = ux + dx, uy + dy, path + way
                    top = max(top, ux * ux + uy * uy)
                    off += stray * wait + astray
                    stray += 2.0 * astray / wait
                    # What is felt at rest begins with the base's acceleration at an instant that is known so well.
                    late = stray * wait / speed
                    last = felt(ux, uy, 0.0, 0.0, ex, ey, grip + load[5] * wait, b, c)
                    if last > felt_most:
                        # On a spring the friction adds to its pull by a direction that is not known at the end.
                        out[5] = max(out[5], last - felt_most if b > 0.0 else late * abs(load[5]))
                        felt_most = last
                    t += wait
                    # Had it been so much faster, would the push have outgrown the grip before it stopped?
                    if load[6] > load[4]:
                        endx, endy = qx + q1x * wait, qy + q1y * wait
                        spare = load[4] + load[5] * t - math.sqrt(endx * endx + endy * endy)
                        rise = math.sqrt(q1x * q1x + q1y * q1y) + abs(load[5])
                        if spare > 0.0 and spare * spare < 2.0 * NEAR * stray * rise:
                            out[3] = float(int(out[3]) | SENSITIVE)
                    slipping = False
                    continue
                h = min(h, max(share * speed / turn, faint))
                if speed <= NEAR * stray and load[6] > load[4] and qx * qx + qy * qy <= hold * hold:
                    out[3] = float(int(out[3]) | SENSITIVE)
        else:
            # From rest it follows the push; without a hold the push may be zero now: its rate says where to.
            ex, ey = qx, qy
            if ex == 0.0 and ey == 0.0:
                ex, ey = -load[1], -load[3]
            size = math.sqrt(ex * ex + ey * ey)
            if size > 0.0:
                ex, ey = ex / size, ey / size
        h = min(h, guess, longest)
        allowed = rtol * max(scale, speed)
        for _ in range(TRIALS):
            wx, wy, sx, sy, dx, dy, pace, way, error, least = plane_step(
                ux, uy, vx, vy, ex, ey, speed, ax, ay, load[1], load[3], grip, load[5], b, c, h
            )
            if least >= 0.0 and (error <= allowed or h <= faint):
                break
            h *= 0.5 if least < 0.0 else max(0.2, 0.9 * math.sqrt(math.sqrt(allowed / error)))
        if least < 0.0:
            # Friction holds it however short the step: it rests.
            off += (stray + speed) * h
            slipping = False
            t += h
            continue
        top = max(top, wx * wx + wy * wy)
        begin, end = ux * vx + uy * vy, wx * sx + wy * sy
        if begin > 0.0 > end:
            inner = inner_radius(
                ux, uy, vx, vy, ex, ey, speed, ax, ay, load[1], load[3], grip, load[5], b, c, h, begin, end, top
            )
            top = max(top, inner)
        first = felt(ux, uy, vx, vy, ex, ey, grip, b, c)
        last = felt(wx, wy, sx, sy, dx, dy, grip + load[5] * h, b, c)
        felt_most = max(felt_most, first, last)
        if b > 0.0 and 1.1 * max(first, last) > felt_most:
            inner = inner_felt(
                ux,
                uy,
                vx,
                vy,
                ex,
                ey,
                speed,
                ax,
                ay,
                load[1],
                load[3],
                grip,
                load[5],
                b,
                c,
                h,
                wx,
                wy,
                sx,
                sy,
                dx,
                dy,
                pace,
            )
            felt_most = max(felt_most, inner)
        stray += error
        off += stray * h
        if w * off > stray:
            off = stray / w
        ux, uy, vx, vy, ex, ey, speed, path = wx, wy, sx, sy, dx, dy, pace, path + way
        t += h
        # The root is worth its time only where the next step may have to be shorter than the interval.
        guess = 4.0 * h if 400.0 * error <= allowed else 0.9 * h * math.sqrt(math.sqrt(allowed / error))
    if not done:
        out[3] = float(int(out[3]) | UNRESOLVED)
    state[0], state[1], state[2], state[3], state[4] = ux, uy, vx, vy, path
    state[5], state[6], state[7] = ex, ey, speed
    state[8], state[9] = stray, off
    state[10] -= used
    if top > most:
        out[0] = math.sqrt(top)
    out[2], out[4] = felt_most, unseen
    return slipping, guess


@inner
def _weigh(load: Array, mu_s: float, mu_k: float, n0: float, n1: float) -> None:
    load[4], load[5], load[6], load[7] = mu_k * n0, mu_k * n1, mu_s * n0, mu_s * n1


@inner
def _stretch(
    state: Array,
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
    control: Control,
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
        return _piece(state, load, span, slipping, guess, b, c, scale, control, out)
    _weigh(load, mu_s, mu_k, max(0.0, n0), n1 if n0 > 0.0 else 0.0)
    slipping, guess = _piece(state, load, cut, slipping, guess, b, c, scale, control, out)
    load[0], load[2] = x0 + x1 * cut, y0 + y1 * cut
    _weigh(load, mu_s, mu_k, 0.0, n1 if n0 < 0.0 else 0.0)
    return _piece(state, load, span - cut, slipping, guess, b, c, scale, control, out)


@inner
def _follow(
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
    control: Control,
    state: Array,
    load: Array,
    out: Array,
    history: Array,
) -> float:
    # The body through the record and until it rests.
    n = x.shape[0]
    b, c = w * w, 2.0 * zeta * w
    scale = SLOW * peak * dt
    slipping, guess = state[7] > 0.0, dt
    recording = history.shape[0] > 0
    i = FIRST
    state[10] = float(MOST_STEPS + MOST_EACH * n)
    while i < n - 1 and not int(out[3]) & UNRESOLVED:
        if not slipping and not recording:
            if w == 0.0:
                ahead = next_above(ratio, maxima, i, mu_s)
            else:
                ahead = next_slip(x, y, z, i, b * state[0], b * state[1], mu_s)
            if ahead >= n:
                out[2] = max(out[2], largest(push, pushes, i, n))
                break
            if ahead > i + 1:
                out[2] = max(out[2], largest(push, pushes, i, ahead))
                state[8] = w * state[9]
                i = ahead - 1
        if i < history.shape[0]:
            note(history, i, state, x[i], y[i], mu_s, mu_k, max(0.0, G + z[i]), b, c, slipping)
        slipping, guess = _stretch(
            state,
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
            control,
            out,
        )
        scale = max(scale, state[7])
        i += 1
    if n - 1 < history.shape[0]:
        note(history, n - 1, state, x[n - 1], y[n - 1], mu_s, mu_k, max(0.0, G + z[n - 1]), b, c, slipping)
    if history.shape[0] > n:
        load[:] = 0.0
        _weigh(load, mu_s, mu_k, G, 0.0)
        for k in range(n, history.shape[0]):
            slipping, guess = _piece(state, load, dt, slipping, guess, b, c, scale, control, out)
            note(history, k, state, 0.0, 0.0, mu_s, mu_k, G, b, c, slipping)
    _coast(state, load, slipping, guess, w, zeta, mu_s, mu_k, tail, scale, control, dt, out)
    out[1] = state[4]
    return math.hypot(state[0], state[1])


@inner
def _coast(
    state: Array,
    load: Array,
    slipping: bool,
    guess: float,
    w: float,
    zeta: float,
    mu_s: float,
    mu_k: float,
    tail: float,
    scale: float,
    control: Control,
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
    cut = tail < 0.0 or stop > MOST_AFTER * span
    stop = min(stop, MOST_AFTER * span)
    load[:] = 0.0
    _weigh(load, mu_s, mu_k, G, 0.0)
    while t < stop:
        now = min(span, stop - t)
        slipping, guess = _piece(state, load, now, slipping, guess, b, c, scale, control, out)
        t += now
        if not slipping or int(out[3]) & UNRESOLVED:
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
    if slipping and cut:
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
    stopping: float,
    longest: float,
    results: Array,
    history: Array,
) -> None:
    """Follow m bodies on dry friction in two directions, by the equation at the top of this module.

    Parameters
    ----------
    x, y, z, ratio, maxima, dt, w, zeta, mu_s, mu_k, tail
        As in `pipeline.kernels.friction_line.friction_line_batch`, y beside x.
    push, pushes, peak : ndarray, shape (n,); ndarray; float
        ``|a_h|``, its block maxima and the largest of it, m/s2.
    rtol, stopping, longest : float
        Tolerance of a step's velocity, relative to the scale of speeds; that of a stop; the longest step as a share of
        a sample interval.
    results : ndarray, shape (m, 7)
        Receives the largest ``|u|``, the residual ``|u|``, the path [m], the largest acceleration passed on [m/s2], the
        flags; and what each step may have been off by, summed up, of u [m] and of that acceleration [m/s2].
    history : ndarray, shape (k, 4)
        Receives ux, uy [m] and the absolute accelerations [m/s2] of a single body at the samples, as long as it is;
        rows after the record follow the body on without excitation.

    References
    ----------
    Newmark (1965) and Agbabian et al. (1991), as in `pipeline.kernels.friction_line.friction_line_batch`.
    """
    moving = x.shape[0] > 1 and peak > 0.0
    control = (rtol, SHARE * rtol**0.125, 2.0 * stopping**0.25, 1e-2 * math.sqrt(stopping), longest)
    state, load, out = np.empty(11), np.empty(8), np.empty(6)
    for k in range(w.shape[0]):
        residual = 0.0
        state[:], load[:] = 0.0, 0.0
        out[:] = 0.0
        if moving:
            residual = _follow(
                x,
                y,
                z,
                ratio,
                maxima,
                push,
                pushes,
                dt,
                peak,
                w[k],
                zeta[k],
                mu_s[k],
                # Grips are divided by: a denormal friction is none.
                mu_k[k] if mu_k[k] >= 1e-300 else 0.0,
                tail,
                control,
                state,
                load,
                out,
                history,
            )
        results[k, 0], results[k, 1], results[k, 2], results[k, 3], results[k, 4] = (
            out[0],
            residual,
            out[1],
            out[2],
            out[3],
        )
        results[k, 5], results[k, 6] = state[9] + out[4], out[5]
