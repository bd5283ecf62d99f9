r"""Stick-slip of a body on dry friction in one direction, with or without a spring and a dashpot, in closed form.

.. math::

    u'' + 2 \zeta w u' + w^2 u + \mu_k N \operatorname{sign}(u') = -a, \qquad N = \max(0, g + a_z)

while it slips, and at rest while

.. math::

    |a + w^2 u| \le \mu_s N

with u [m] the displacement relative to the base, a and a_z [m/s2] the horizontal and the vertical acceleration of the
base, N [m/s2] the normal force per mass, mu_s and mu_k [-] the friction at rest and while slipping, w [rad/s] the
angular frequency and zeta [-] the damping ratio of spring and dashpot.  w = 0 is the free sliding block (Newmark 1965),
w > 0 the horizontal isolator (Agbabian et al. 1991, sec. 2.6).

Within a sample interval excitation and normal force are linear, so each phase has a closed form; only the instants at
which the velocity vanishes are found by iteration.
"""

import math

import numpy as np

from pipeline.kernels import CONTACT_LOST, CUT, FIRST, UNRESOLVED, inner, kernel
from pipeline.kernels.line_phase import (
    MU_K,
    MU_S,
    PHASE,
    SIZE,
    STEP,
    TERMS,
    U0,
    U1,
    UU,
    UV,
    ZETA,
    B,
    Body,
    C,
    W,
    after,
    expand,
    first_stop,
    make_body,
    passed_on,
)
from pipeline.kernels.quiet import largest, next_above
from pipeline.quantities import Array, G

CAP = 200.0
"""Seconds after the record at which a body that still moves is cut off."""

FAINT = 1e-12
"""Share of the largest displacement that is no longer followed."""

MOST_PIECES = 1000
"""Stretches of a sample interval, each half a radian of the body's own, from which on it is not followed."""

MOST_EVENTS = 100
"""Stops and starts in a stretch after which the body is not followed further; its motion has a few."""

MOST_AFTER = 5_000_000
"""Stretches after the record at which a body that still moves is cut off before CAP."""


@inner
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


@inner
def _piece(
    u: float,
    v: float,
    s: float,
    a0: float,
    a1: float,
    n0: float,
    n1: float,
    span: float,
    body: Body,
    series: Array,
    out: Array,
) -> tuple[float, float, float]:
    # One stretch on which excitation a0 + a1 t and normal force n0 + n1 t >= 0 are linear.
    # s: 0 at rest, else the direction of slip.  out: [max |u|, path, max transmitted, flags].
    now = 0.0
    b, mu_s, mu_k = body[B], body[MU_S], body[MU_K]
    for _ in range(MOST_EVENTS):
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
        expand(u, v, f0, f1, body, series)
        vn, moved = after(series, body[SIZE], left)
        un = u + moved
        stop, there = first_stop(u, v, s, f0, f1, body, series, left, un, vn)
        t = left
        if stop >= 0.0:
            t, un, vn = stop, there, 0.0
        out[1] += abs(un - u)
        out[0] = max(out[0], abs(un))
        if t > 0.0:
            out[2] = passed_on(u, v, un, vn, f0, f1, s * mu_k * n, s * mu_k * n1, t, body, out[2])
        u = un
        now += t
        if stop < 0.0:
            return u, vn, s
        a, n = a0 + a1 * now, max(0.0, n0 + n1 * now)
        v = 0.0
        q = a + b * u
        s = 0.0 if abs(q) <= mu_s * n else (-1.0 if q > 0.0 else 1.0)
    out[3] = float(int(out[3]) | UNRESOLVED)
    return u, v, s


@inner
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
    body: Body,
    series: Array,
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
                body,
                series,
                out,
            )
            u, v, s = _piece(u, v, s, a0 + a1 * cross, a1, 0.0, n1 if n0 < 0.0 else 0.0, t1 - cross, body, series, out)
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
                body,
                series,
                out,
            )
    return u, v, s


@inner
def _stays(x: Array, z: Array, spring: float, mu_s: float, begin: int, end: int, out: Array) -> int:
    # The sample up to which a body at rest at begin stays so, at most end.  What holds it is convex between samples.
    top, i = 0.0, begin
    while i <= end and G + z[i] >= 0.0 and abs(x[i] + spring) <= mu_s * (G + z[i]):
        top = max(top, abs(x[i]))
        i += 1
    out[2] = max(out[2], top)
    return i - 1


@inner
def _glides(
    x: Array,
    z: Array,
    dt: float,
    pieces: int,
    u: float,
    v: float,
    s: float,
    body: Body,
    begin: int,
    end: int,
    out: Array,
) -> tuple[int, float, float]:
    # The sample up to which a body that slips at begin does nothing else, at most end, and u and v there.
    # out: [max |u|, path, max transmitted].
    b, c, mu_k, step = body[B], body[C], body[MU_K], body[STEP]
    top, path, felt = out[0], out[1], out[2]
    i = begin
    while i < end and G + z[i] >= 0.0 and G + z[i + 1] >= 0.0:
        a1, lift1 = (x[i + 1] - x[i]) / dt, s * mu_k * ((z[i + 1] - z[i]) / dt)
        p, q, slips = u, v, s * v > 0.0
        for j in range(pieces):
            lift0 = s * mu_k * (G + z[i]) + lift1 * (j * step)
            f0, f1 = -(x[i] + a1 * (j * step)) - lift0, -a1 - lift1
            un = p * body[UU] + q * body[UV] + f0 * body[U0] + f1 * body[U1]
            vn = -p * b * body[UV] + q * (body[UU] - c * body[UV]) + f0 * body[UV] + f1 * body[U0]
            dips = s * (f0 - c * q - b * p) < 0.0 < s * (f0 + f1 * step - c * vn - b * un)
            slips = slips and s * vn > 0.0 and not dips
            if not slips:
                break
            felt = passed_on(p, q, un, vn, f0, f1, lift0, lift1, step, body, felt)
            p, q = un, vn
        if not slips:
            break
        # It slips one way, so that path and displacement grow together.
        path += abs(p - u)
        top = max(top, abs(p))
        u, v = p, q
        i += 1
    out[0], out[1], out[2] = top, path, felt
    return i, u, v


@inner
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


@inner
def _follow(
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
    series: Array,
    out: Array,
    history: Array,
) -> float:
    # The body through the record and until it rests.
    n = x.shape[0]
    needed = w * dt * (1.0 + zeta) / PHASE
    if not needed <= MOST_PIECES:
        out[3] = float(UNRESOLVED)
        return 0.0
    pieces = max(1, math.ceil(needed))
    body = make_body(w, zeta, mu_s, mu_k, dt / pieces)
    u, v, s = 0.0, 0.0, 0.0
    recording = history.shape[0] > 0
    i = FIRST
    while i < n - 1 and not int(out[3]) & UNRESOLVED:
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
        if s == 0.0 and (w > 0.0 or recording):
            still = _stays(x, z, w * w * u, mu_s, i, i + 1 if recording else n - 1, out)
            if still > i:
                i = still
                continue
        elif s != 0.0:
            still, u, v = _glides(x, z, dt, pieces, u, v, s, body, i, i + 1 if recording else n - 1, out)
            if still > i:
                i = still
                continue
        u, v, s = _split(
            u,
            v,
            s,
            x[i],
            (x[i + 1] - x[i]) / dt,
            z[i],
            (z[i + 1] - z[i]) / dt,
            dt,
            pieces,
            body,
            series,
            out,
        )
        i += 1
    if n - 1 < history.shape[0]:
        history[n - 1, 0] = u
        history[n - 1, 1] = _felt(u, v, s, x[n - 1], max(0.0, G + z[n - 1]), w, zeta, mu_s, mu_k)
    for k in range(n, history.shape[0]):
        for _ in range(pieces):
            u, v, s = _piece(u, v, s, 0.0, 0.0, G, 0.0, dt / pieces, body, series, out)
        history[k, 0] = u
        history[k, 1] = _felt(u, v, s, 0.0, G, w, zeta, mu_s, mu_k)
    return abs(_coast(u, v, s, body, series, tail, out))


@inner
def _coast(u: float, v: float, s: float, body: Body, series: Array, tail: float, out: Array) -> float:
    # After the record: no excitation, full weight, until the body rests for good, the tail ends, or the cap.
    if tail == 0.0:
        return u
    w, zeta, mu_s, mu_k, b, c = body[W], body[ZETA], body[MU_S], body[MU_K], body[B], body[C]
    if tail < 0.0 and mu_k == 0.0 and (w == 0.0 or zeta == 0.0):
        # Nothing will ever stop it; a spring brings its largest excursion within the first period.
        if v != 0.0 or u != 0.0:
            out[3] = float(int(out[3]) | CUT)
        if w == 0.0:
            return u
        tail = 2.0 * math.pi / w
    stop = tail if tail > 0.0 else CAP
    t, longest = 0.0, stop if w == 0.0 else PHASE / (w * (1.0 + zeta))
    cut = tail < 0.0 or stop > MOST_AFTER * longest
    stop = min(stop, MOST_AFTER * longest)
    body = make_body(w, zeta, mu_s, mu_k, longest)
    while t < stop:
        span = min(stop - t, longest)
        u, v, s = _piece(u, v, s, 0.0, 0.0, G, 0.0, span, body, series, out)
        t += span
        if s == 0.0 or int(out[3]) & UNRESOLVED:
            return u
        if tail < 0.0 and abs(b * abs(u) - mu_k * G) <= 2.0 * c * abs(v) and c * abs(v) <= FAINT * b * out[0]:
            # Overdamped, it creeps towards the end of the friction's reach and never gets there.
            return u
        if tail < 0.0 and mu_k == 0.0 and 0.5 * v * v + 0.5 * w * w * u * u <= 1e-24 * w * w * out[0] * out[0]:
            return u
    if s != 0.0 and cut:
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
    results: Array,
    history: Array,
) -> None:
    r"""Follow m bodies on dry friction in one direction.

    .. math::

        u'' + 2 \zeta w u' + w^2 u + \mu_k N \operatorname{sign}(u') = -a, \qquad N = \max(0, g + a_z)

    Parameters
    ----------
    x, z : ndarray, shape (n,)
        Horizontal (a) and vertical (a_z) acceleration of the base, m/s2, linear between samples.
    ratio, maxima : ndarray
        Of this very motion: |a_h| / (g + a_z), infinite where contact is lost (n,) [-], and its block maxima.
    pushes : ndarray
        Block maxima of ``|x|``, m/s2.
    dt : float
        Time step, s.
    w, zeta, mu_s, mu_k : ndarray, shape (m,)
        Angular frequency [rad/s], damping ratio, friction at rest and while slipping [-].
    tail : float
        Seconds to go on after the record; 0: none; below 0: until it rests for good, or CAP.
    results : ndarray, shape (m, 5)
        Receives the largest ``|u|`` [m], the residual ``|u|`` [m], the path [m], the largest acceleration passed on
        [m/s2] and the flags (`pipeline.kernels`).
    history : ndarray, shape (k, 2)
        Receives u [m] and the absolute acceleration [m/s2] of a single body at the samples, as long as it is; rows
        after the record follow the body on without excitation.

    References
    ----------
    Newmark, N. M. (1965). Effects of earthquakes on dams and embankments. Geotechnique 15.
    Agbabian, M. S., Ginell, W. S., Masri, S. F. and Nigbor, R. L. (1991). Evaluation of earthquake damage mitigation
    methods for museum objects. Studies in Conservation 36. Sec. 2.6.
    """
    results[:, :] = 0.0
    if x.shape[0] < 2:
        return
    series, out = np.empty((2, TERMS)), np.empty(4)
    for k in range(w.shape[0]):
        out[:] = 0.0
        residual = _follow(x, z, ratio, maxima, pushes, dt, w[k], zeta[k], mu_s[k], mu_k[k], tail, series, out, history)
        results[k, 0], results[k, 1], results[k, 2], results[k, 3], results[k, 4] = (
            out[0],
            residual,
            out[1],
            out[2],
            out[3],
        )
