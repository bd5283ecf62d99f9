"""A body on dry friction in one direction, with or without a spring and a dashpot: stick-slip in closed form.

u'' + 2 zeta w u' + w^2 u + mu_k N sign(u') = -a while slipping, N = max(0, g + a_z); at rest while
|a + w^2 u| <= mu_s N.  w = 0 is the free sliding block (Newmark 1965), w > 0 the horizontal isolator
(Agbabian et al. 1991, sec. 2.6).  Within a sample interval excitation and normal force are linear, so each phase has a
closed form; only the instants at which the velocity vanishes are found by iteration.
"""

import math

import numpy as np

from pipeline.kernels import kernel
from pipeline.kernels.flags import CONTACT_LOST, CUT, EVENT_CAP
from pipeline.kernels.linear import advance, peak_inside, transition
from pipeline.kernels.quiet import largest, next_above
from pipeline.quantities import Array, G

CAP = 200.0
"""Seconds after the record at which a body that still moves is cut off."""

FAINT = 1e-12
"""Share of the largest displacement that is no longer followed."""


@kernel
def _first_beyond(q0: float, q1: float, l0: float, l1: float, span: float) -> float:
    # First time in [0, span] at which |q0 + q1 t| > l0 + l1 t, given that it is not so at 0; -1 if never.
    best = -1.0
    for sign in (1.0, -1.0):
        begin, end = sign * q0 - l0, sign * (q0 + q1 * span) - (l0 + l1 * span)
        if end > 0.0:
            t = span * min(1.0, max(0.0, -begin / (end - begin)))
            if best < 0.0 or t < best:
                best = t
    return best


@kernel
def _velocity(u: float, v: float, f0: float, f1: float, w: float, zeta: float, t: float) -> float:
    g, h, h1, _ = transition(w, zeta, t)
    return -u * w * w * h + v * (g - 2.0 * zeta * w * h) + f0 * h + f1 * h1


@kernel
def _acceleration(u: float, v: float, f0: float, f1: float, w: float, zeta: float, t: float) -> float:
    un, vn = advance(u, v, f0, f1, w, zeta, t)
    return f0 + f1 * t - 2.0 * zeta * w * vn - w * w * un


@kernel
def _root(
    u: float, v: float, f0: float, f1: float, w: float, zeta: float, order: int, low: float, high: float
) -> float:
    # The zero of the velocity (order 1) or acceleration (order 2) bracketed by low and high: Newton's method, which
    # halves the bracket where it would leave it or where rounding keeps its steps from shrinking.
    b, c = w * w, 2.0 * zeta * w
    if order == 1:
        first, last = _velocity(u, v, f0, f1, w, zeta, low), _velocity(u, v, f0, f1, w, zeta, high)
    else:
        first, last = _acceleration(u, v, f0, f1, w, zeta, low), _acceleration(u, v, f0, f1, w, zeta, high)
    t = (low * last - high * first) / (last - first) if last != first else low
    before = math.inf
    for _ in range(100):
        if not low < t < high:
            t = 0.5 * (low + high)
        un, vn = advance(u, v, f0, f1, w, zeta, t)
        rate = f0 + f1 * t - c * vn - b * un
        value, slope = (vn, rate) if order == 1 else (rate, f1 - c * rate - b * vn)
        if (value > 0.0) == (last > 0.0):
            high = t
        else:
            low = t
        step = value / slope if slope != 0.0 else math.inf
        if value == 0.0 or high - low <= 4e-16 * high:
            return t
        shrinks = abs(step) <= 0.5 * before
        before = abs(step)
        t = t - step if shrinks else 0.5 * (low + high)
        # What is left is the square of the step, over the length in which the slope changes.
        if shrinks and before <= 1e-9 * high and low <= t <= high:
            return t
    return 0.5 * (low + high)


@kernel
def _first_stop(u: float, v: float, s: float, f0: float, f1: float, w: float, zeta: float, span: float) -> float:
    # First time in (0, span] at which the velocity in direction s vanishes; -1 if it does not.  span is short against
    # the period, so that the acceleration changes sign at most twice.
    end = s * _velocity(u, v, f0, f1, w, zeta, span)
    push = s * _acceleration(u, v, f0, f1, w, zeta, 0.0)
    push_end = s * _acceleration(u, v, f0, f1, w, zeta, span)
    if s * v > 0.0:
        if end <= 0.0:
            return _root(u, v, f0, f1, w, zeta, 1, 0.0, span)
        if push < 0.0 < push_end:
            dip = _root(u, v, f0, f1, w, zeta, 2, 0.0, span)
            if s * _velocity(u, v, f0, f1, w, zeta, dip) <= 0.0:
                return _root(u, v, f0, f1, w, zeta, 1, 0.0, dip)
        return -1.0
    # Starting from rest the velocity has a root at 0 that is not a stop: find a time at which it moves in direction s.
    if end > 0.0:
        return -1.0
    low = 0.5 * span
    for _ in range(60):
        if s * _velocity(u, v, f0, f1, w, zeta, low) > 0.0:
            return _root(u, v, f0, f1, w, zeta, 1, low, span)
        low *= 0.5
    return 0.0


@kernel
def _piece(
    u: float,
    v: float,
    s: float,
    a0: float,
    a1: float,
    n0: float,
    n1: float,
    span: float,
    w: float,
    zeta: float,
    mu_s: float,
    mu_k: float,
    out: Array,
) -> tuple[float, float, float]:
    # One stretch on which excitation a0 + a1 t and normal force n0 + n1 t >= 0 are linear.
    # s: 0 at rest, else the direction of slip.  out: [max |u|, path, max transmitted, flags].
    now = 0.0
    b, c = w * w, 2.0 * zeta * w
    for _ in range(1000):
        left = span - now
        if left <= 0.0:
            return u, v, s
        a, n = a0 + a1 * now, n0 + n1 * now
        if s == 0.0:
            q = a + b * u
            if abs(q) > mu_s * n:
                s = -1.0 if q > 0.0 else 1.0
            else:
                t = _first_beyond(q, a1, mu_s * n, mu_s * n1, left)
                # At rest the body shares the base's acceleration.
                if t < 0.0:
                    out[2] = max(out[2], abs(a), abs(a0 + a1 * span))
                    return u, 0.0, 0.0
                now += t
                a, n = a0 + a1 * now, max(0.0, n0 + n1 * now)
                out[2] = max(out[2], abs(a0 + a1 * (now - t)), abs(a))
                q = a + b * u
                # Without any hold (no friction, no contact) the push may be zero now: its rate says where to.
                s = -1.0 if q > 0.0 or (q == 0.0 and a1 > 0.0) else 1.0
                left = span - now
                if left <= 0.0:
                    return u, 0.0, s
            v = 0.0
        f0, f1 = -a - s * mu_k * n, -a1 - s * mu_k * n1
        stop = _first_stop(u, v, s, f0, f1, w, zeta, left)
        t = left if stop < 0.0 else stop
        un, vn = advance(u, v, f0, f1, w, zeta, t)
        out[1] += abs(un - u)
        out[0] = max(out[0], abs(un))
        lift0, lift1 = s * mu_k * n, s * mu_k * n1
        begin, end = abs(c * v + b * u + lift0), abs(c * vn + b * un + lift0 + lift1 * t)
        if t > 0.0:
            out[2] = max(out[2], begin, end)
        if w > 0.0:
            rate = c * max(abs(f0 - c * v - b * u), abs(f0 + f1 * t - c * vn - b * un)) + b * max(abs(v), abs(vn))
            if max(begin, end) + t * (rate + abs(lift1)) > out[2]:
                out[2] = max(out[2], peak_inside(u, v, f0, f1, w, zeta, t, lift0, lift1, b, c))
        u = un
        now += t
        if stop < 0.0:
            return u, vn, s
        a, n = a0 + a1 * now, max(0.0, n0 + n1 * now)
        v = 0.0
        q = a + b * u
        s = 0.0 if abs(q) <= mu_s * n else (-1.0 if q > 0.0 else 1.0)
    out[3] = float(int(out[3]) | EVENT_CAP)
    return u, v, s


@kernel
def _split(
    u: float,
    v: float,
    s: float,
    a0: float,
    a1: float,
    z0: float,
    z1: float,
    span: float,
    pieces: int,
    w: float,
    zeta: float,
    mu_s: float,
    mu_k: float,
    out: Array,
) -> tuple[float, float, float]:
    # A stretch on which excitation and vertical acceleration are linear: cut where contact ends or begins.
    n0, n1 = G + z0, z1
    end = n0 + n1 * span
    cross = -1.0
    if n0 < 0.0 < end or end < 0.0 < n0:
        cross = -n0 / n1
    if n0 < 0.0 or end < 0.0:
        out[3] = float(int(out[3]) | CONTACT_LOST)
    step = span / pieces
    for j in range(pieces):
        t0, t1 = j * step, (j + 1) * step
        if t0 < cross < t1:
            u, v, s = _piece(
                u,
                v,
                s,
                a0 + a1 * t0,
                a1,
                max(0.0, n0 + n1 * t0),
                n1 if n0 > 0.0 else 0.0,
                cross - t0,
                w,
                zeta,
                mu_s,
                mu_k,
                out,
            )
            u, v, s = _piece(
                u, v, s, a0 + a1 * cross, a1, 0.0, n1 if n0 < 0.0 else 0.0, t1 - cross, w, zeta, mu_s, mu_k, out
            )
        else:
            held = max(n0 + n1 * t0, n0 + n1 * t1) > 0.0
            u, v, s = _piece(
                u,
                v,
                s,
                a0 + a1 * t0,
                a1,
                max(0.0, n0 + n1 * t0),
                n1 if held else 0.0,
                step,
                w,
                zeta,
                mu_s,
                mu_k,
                out,
            )
    return u, v, s


@kernel
def _glide(
    u: float,
    v: float,
    s: float,
    a0: float,
    a1: float,
    n0: float,
    n1: float,
    span: float,
    w: float,
    zeta: float,
    mu_k: float,
    of_span: tuple[float, float, float, float],
    out: Array,
) -> tuple[bool, float, float]:
    # A whole sample interval in direction s, of_span being its transition: whether nothing stops the body in it, and
    # where it ends.  Nothing is done when it may stop.  span is short against the period, and the weight holds.
    g, h, h1, h2 = of_span
    b, c = w * w, 2.0 * zeta * w
    lift0, lift1 = s * mu_k * n0, s * mu_k * n1
    f0, f1 = -a0 - lift0, -a1 - lift1
    un = u * g + v * h + f0 * h1 + f1 * h2
    vn = -u * b * h + v * (g - c * h) + f0 * h + f1 * h1
    push, push_end = f0 - c * v - b * u, f0 + f1 * span - c * vn - b * un
    slowest = min(s * v, s * vn)
    if slowest <= 0.0:
        return False, u, v
    if s * push < 0.0 < s * push_end and slowest <= span * (abs(push) + abs(push_end)):
        # The velocity has a least value inside.
        return False, u, v
    most = max(abs(c * v + b * u + lift0), abs(c * vn + b * un + lift0 + lift1 * span))
    if w > 0.0:
        # By its second derivative, what the body feels exceeds its values at the ends by at most this.
        bend = abs(c * (f1 - c * push - b * v) + b * push) + abs(c * (f1 - c * push_end - b * vn) + b * push_end)
        if most + 0.125 * span * span * bend > out[2]:
            most = max(most, peak_inside(u, v, f0, f1, w, zeta, span, lift0, lift1, b, c))
    out[0] = max(out[0], abs(un))
    out[1] += abs(un - u)
    out[2] = max(out[2], most)
    return True, un, vn


@kernel
def _felt(
    u: float, v: float, s: float, a: float, weight: float, w: float, zeta: float, mu_s: float, mu_k: float
) -> float:
    # The absolute acceleration at a sample.  A jump past the hold is not felt: the friction of the slip is.
    q = a + w * w * u
    if s == 0.0 and abs(q) <= mu_s * weight:
        return a
    if s == 0.0:
        s = -1.0 if q > 0.0 else 1.0
    return -(2.0 * zeta * w * v + w * w * u + s * mu_k * weight)


@kernel
def friction_line_one(
    x: Array,
    z: Array,
    ratio: Array,
    maxima: Array,
    pushes: Array,
    dt: float,
    w: float,
    zeta: float,
    mu_s: float,
    mu_k: float,
    tail: float,
    refine: int,
    out: Array,
    history: Array,
) -> float:
    """Integrate one body and return its residual displacement |u| [m].

    x, z           : (n,) m/s2
    ratio, maxima  : from kernels.quiet, of this very motion; pushes: block maxima of |x|
    out            : (4,) receives max |u| [m], path [m], max transmitted acceleration [m/s2], flags
    history        : (m, 2) receives u and the absolute acceleration at the samples, as long as it is; rows after the
                     record follow the body on without excitation
    """
    n = x.shape[0]
    out[:] = 0.0
    if n < 2:
        return 0.0
    cuts = max(1, math.ceil(w * dt * (1.0 + zeta) / 0.5))
    pieces = cuts * (max(1, refine // 2) if w > 0.0 else 1)
    of_span = transition(w, zeta, dt)
    u, v, s = 0.0, 0.0, 0.0
    recording = history.shape[0] > 0
    i = 0
    while i < n - 1:
        if s == 0.0 and w == 0.0 and not recording:
            ahead = next_above(ratio, maxima, i, mu_s)
            if ahead >= n:
                out[2] = max(out[2], largest(x, pushes, i, n))
                break
            if ahead > i + 1:
                out[2] = max(out[2], largest(x, pushes, i, ahead))
                i = ahead - 1
        if i < history.shape[0]:
            history[i, 0] = u
            history[i, 1] = _felt(u, v, s, x[i], max(0.0, G + z[i]), w, zeta, mu_s, mu_k)
        a1, n0, n1 = (x[i + 1] - x[i]) / dt, G + z[i], (z[i + 1] - z[i]) / dt
        if cuts == 1 and n0 > 0.0 and G + z[i + 1] > 0.0:
            if s != 0.0:
                glides, u, v = _glide(u, v, s, x[i], a1, n0, n1, dt, w, zeta, mu_k, of_span, out)
                if glides:
                    i += 1
                    continue
            elif max(abs(x[i] + w * w * u) - mu_s * n0, abs(x[i + 1] + w * w * u) - mu_s * (G + z[i + 1])) <= 0.0:
                out[2] = max(out[2], abs(x[i]), abs(x[i + 1]))
                i += 1
                continue
        u, v, s = _split(
            u,
            v,
            s,
            x[i],
            a1,
            z[i],
            n1,
            dt,
            pieces,
            w,
            zeta,
            mu_s,
            mu_k,
            out,
        )
        i += 1
    if n - 1 < history.shape[0]:
        history[n - 1, 0] = u
        history[n - 1, 1] = _felt(u, v, s, x[n - 1], max(0.0, G + z[n - 1]), w, zeta, mu_s, mu_k)
    for k in range(n, history.shape[0]):
        for _ in range(pieces):
            u, v, s = _piece(u, v, s, 0.0, 0.0, G, 0.0, dt / pieces, w, zeta, mu_s, mu_k, out)
        history[k, 0] = u
        history[k, 1] = _felt(u, v, s, 0.0, G, w, zeta, mu_s, mu_k)
    return abs(_coast(u, v, s, w, zeta, mu_s, mu_k, tail, out))


@kernel
def _coast(
    u: float, v: float, s: float, w: float, zeta: float, mu_s: float, mu_k: float, tail: float, out: Array
) -> float:
    # After the record: no excitation, full weight, until the body rests for good, the tail ends, or the cap.
    if tail == 0.0:
        return u
    if tail < 0.0 and mu_k == 0.0 and (w == 0.0 or zeta == 0.0):
        # Nothing will ever stop it; a spring brings its largest excursion within the first period.
        if v != 0.0 or u != 0.0:
            out[3] = float(int(out[3]) | CUT)
        if w == 0.0:
            return u
        tail = 2.0 * math.pi / w
    stop = tail if tail > 0.0 else CAP
    t = 0.0
    while t < stop:
        span = stop - t if w == 0.0 else min(stop - t, 0.5 / (w * (1.0 + zeta)))
        u, v, s = _piece(u, v, s, 0.0, 0.0, G, 0.0, span, w, zeta, mu_s, mu_k, out)
        t += span
        if s == 0.0:
            return u
        b, c = w * w, 2.0 * zeta * w
        if tail < 0.0 and abs(b * abs(u) - mu_k * G) <= 2.0 * c * abs(v) and c * abs(v) <= FAINT * b * out[0]:
            # Overdamped, it creeps towards the end of the friction's reach and never gets there.
            return u
        if tail < 0.0 and mu_k == 0.0 and 0.5 * v * v + 0.5 * w * w * u * u <= 1e-24 * w * w * out[0] * out[0]:
            return u
    if s != 0.0 and tail < 0.0:
        out[3] = float(int(out[3]) | CUT)
    return u


@kernel
def friction_line_batch(
    x: Array,
    z: Array,
    ratio: Array,
    maxima: Array,
    pushes: Array,
    dt: float,
    w: Array,
    zeta: Array,
    mu_s: Array,
    mu_k: Array,
    tail: float,
    refine: int,
    results: Array,
) -> None:
    """Fill results (m, 5): max |u|, residual, path [m], max transmitted acceleration [m/s2], flags."""
    nothing = np.empty((0, 2))
    out = np.empty(4)
    for k in range(w.shape[0]):
        residual = friction_line_one(
            x, z, ratio, maxima, pushes, dt, w[k], zeta[k], mu_s[k], mu_k[k], tail, refine, out, nothing
        )
        results[k, 0], results[k, 1], results[k, 2], results[k, 3], results[k, 4] = (
            out[0],
            residual,
            out[1],
            out[2],
            out[3],
        )
