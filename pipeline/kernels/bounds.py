r"""Bounds of the slip of a body on dry friction, above and below: sums along the record, without integration.

With s = ``|u'|`` [m/s] the speed relative to the base, a_h [m/s2] the base's horizontal acceleration, N = max(0, g +
a_z) [m/s2] and the friction mu_s at rest and mu_k while it slips [-],

.. math::

    s' = -\frac{a_h \cdot u'}{s} - \mu_k N \le |a_h| - \mu_k N, \qquad
    \text{at rest while } |a_h| \le \mu_s N

**From above.** Let W' = ``|a_h|`` - mu_k N, kept at or above 0, and held at 0 as long as ``|a_h|`` <= mu_s N.  Then s
<= W for all time: where s = W = 0 both are held by the same condition, or W may grow at once; and where s exceeded W,
since the last time at which it did not, it would have slipped all the while with s' <= W'.  So the path is at most the
integral of W, and the displacement at most the path; where W = 0 the body rests.  One direction's push is never larger
than the resultant, so the bound of two directions holds for a body shaken along any one of them.

**From below.** Let the body rest at time t0.  The friction never accelerates it by more than mu_s N, slipping or stuck.
Relative to the ground it has thus moved, at time t, by at least

.. math::

    |X(t)| - Q(t), \qquad X'' = a_h, \quad Q'' = \mu_s N

X [m] the ground's displacement since t0 in a frame that moves with the ground's velocity at t0, and Q [m] both zero at
t0 with their rates.  A body whose position at t0 is not known has been half of that away from where it stood, before or
after.  A body that slips one way only, with mu_s = mu_k, is met exactly.

Both are guarded against rounding by being looser, and the upper one counts no friction in an interval in which the
weight is lost or comes back.
"""

import math

from pipeline.kernels import kernel
from pipeline.kernels.friction_line import CAP
from pipeline.kernels.quiet import largest, next_above
from pipeline.quantities import Array, G

SLACK = 1e-9
"""Share by which pushes are taken as larger and grips as smaller than they are, or the other way round: far above the
rounding of a sum over millions of samples, far below what anybody asks of a bound."""

NO_FRICTION = 1e-300
"""Friction coefficient below which nothing ever stops a body, as in the integration."""


@kernel
def _emptied(w: float, f0: float, f1: float) -> float:
    # First time at which w + f0 t + f1 t^2 / 2, w >= 0, comes down to 0; infinite if never.
    square = f0 * f0 - 2.0 * f1 * w
    if f0 >= 0.0:
        return (f0 + math.sqrt(square)) / -f1 if f1 < 0.0 else math.inf
    return 2.0 * w / (math.sqrt(square) - f0) if square >= 0.0 else math.inf


@kernel
def _grow(w: float, f0: float, f1: float, span: float, held: bool) -> tuple[float, float]:
    # W and its integral after a stretch on which W' = f0 + f1 t, W kept at or above 0.  held: at the end of the stretch
    # it would be held; then, because |a_h| - mu_s N is convex, from its coming to rest on.
    t = _emptied(w, f0, f1)
    if t > span:
        end = w + span * (f0 + 0.5 * f1 * span)
        return max(0.0, end), max(0.0, span * (w + span * (0.5 * f0 + f1 * span / 6.0)))
    area = max(0.0, t * (w + t * (0.5 * f0 + f1 * t / 6.0)))
    again = -f0 / f1 if f1 > 0.0 else span
    if held or again >= span:
        return 0.0, area
    left = span - max(t, again)
    return 0.5 * f1 * left * left, area + f1 * left**3 / 6.0


@kernel
def slip_bounds_one(
    x: Array,
    y: Array,
    z: Array,
    push: Array,
    ratio: Array,
    maxima: Array,
    pushes: Array,
    dt: float,
    mu_s: float,
    mu_k: float,
    tail: float,
    out: Array,
) -> None:
    """Bound the response of one body on dry friction, by the two bounds derived above.

    Parameters
    ----------
    x, y, z : ndarray, shape (n,)
        Acceleration of the base, m/s2.
    push : ndarray, shape (n,)
        ``|a_h|``, m/s2.
    ratio, maxima : ndarray
        Of this very motion: |a_h| / (g + a_z), infinite where contact is lost (n,) [-], and its block maxima.
    pushes : ndarray
        Block maxima of push, m/s2.
    dt : float
        Time step, s.
    mu_s, mu_k : float
        Friction at rest and while slipping [-].
    tail : float
        Seconds after the record; below 0: until rest.
    out : ndarray, shape (4,)
        Receives the least displacement [m], the longest path [m] (infinite where nothing stops it), the least and the
        largest horizontal acceleration passed on [m/s2].

    References
    ----------
    Newmark, N. M. (1965). Effects of earthquakes on dams and embankments. Geotechnique 15: the block.  The bounds are
    derived at the top of this module.
    """
    n = x.shape[0]
    out[:] = 0.0
    if n < 2:
        return
    w, path, low, felt_low, felt_high = 0.0, 0.0, 0.0, 0.0, 0.0
    sure = 1.0
    vx, vy, px, py, brake, drag = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
    begun = False
    i = 0
    while i < n - 1:
        if w == 0.0:
            # At rest: what holds it is convex between samples, so the samples decide.
            ahead = next_above(ratio, maxima, i, mu_s)
            if ahead > i:
                felt_low = max(felt_low, largest(push, pushes, i, min(ahead, n)))
                i = ahead - 1
                if ahead >= n:
                    break
            elif not begun:
                # It slips from the first instant, and passes on its friction.
                felt_low = mu_k * max(0.0, G + z[i])
            sure = 0.5 if begun else 1.0
            begun = True
            vx, vy, px, py, brake, drag = 0.0, 0.0, 0.0, 0.0, 0.0, 0.0
        n0, n1 = G + z[i], G + z[i + 1]
        k0, k1 = max(0.0, n0), max(0.0, n1)
        if n0 < 0.0 or n1 < 0.0:
            n0, n1 = 0.0, 0.0
        f0 = (1.0 + SLACK) * push[i] - (1.0 - SLACK) * mu_k * n0
        f1 = ((1.0 + SLACK) * push[i + 1] - (1.0 - SLACK) * mu_k * n1 - f0) / dt
        w, more = _grow(w, f0, f1, dt, ratio[i + 1] <= mu_s)
        path += more
        grip = max(k0, k1)
        felt_high = max(felt_high, mu_k * grip, min(max(push[i], push[i + 1]), mu_s * grip))
        rx, ry = x[i + 1] - x[i], y[i + 1] - y[i]
        px += dt * (vx + dt * (0.5 * x[i] + rx / 6.0))
        py += dt * (vy + dt * (0.5 * y[i] + ry / 6.0))
        vx += dt * (x[i] + 0.5 * rx)
        vy += dt * (y[i] + 0.5 * ry)
        # max(0, N) is convex: its chord is above it.
        drag += dt * (brake + mu_s * dt * (k0 / 3.0 + k1 / 6.0))
        brake += 0.5 * mu_s * dt * (k0 + k1)
        low = max(low, sure * ((1.0 - SLACK) * math.hypot(px, py) - (1.0 + SLACK) * drag))
        i += 1
    if w > 0.0 and tail != 0.0:
        felt_high = max(felt_high, mu_k * G)
        low = max(low, sure * _coasted(px, py, vx, vy, brake, drag, mu_s, mu_k, tail))
        if mu_k >= NO_FRICTION:
            t = w / ((1.0 - SLACK) * mu_k * G)
            path += 0.5 * w * t if tail < 0.0 or t <= tail else tail * (w - 0.5 * (1.0 - SLACK) * mu_k * G * tail)
        else:
            path += w * tail if tail > 0.0 else math.inf
    out[0], out[1], out[2], out[3] = low, path, felt_low, max(felt_low, felt_high)


@kernel
def _coasted(
    px: float,
    py: float,
    vx: float,
    vy: float,
    brake: float,
    drag: float,
    mu_s: float,
    mu_k: float,
    tail: float,
) -> float:
    # The largest |X| - Q after the record, X going on with the last velocity; 0 where it only becomes smaller.
    away = math.hypot(px, py)
    # Nothing stops a body without friction: its history ends with the record.
    if away == 0.0 or (tail < 0.0 and mu_k < NO_FRICTION):
        return 0.0
    speed = (1.0 - SLACK) * (px * vx + py * vy) / away - (1.0 + SLACK) * brake
    if speed <= 0.0:
        return 0.0
    stop = tail if tail > 0.0 else CAP
    decay = (1.0 + SLACK) * mu_s * G
    t = min(stop, speed / decay) if decay > 0.0 else stop
    return (1.0 - SLACK) * away - (1.0 + SLACK) * drag + t * (speed - 0.5 * decay * t)


@kernel
def slip_bounds_batch(
    x: Array,
    y: Array,
    z: Array,
    push: Array,
    ratio: Array,
    maxima: Array,
    pushes: Array,
    dt: float,
    mu_s: Array,
    mu_k: Array,
    tail: float,
    results: Array,
) -> None:
    """Bound the responses of m bodies on dry friction.

    Parameters
    ----------
    x, y, z, push, ratio, maxima, pushes, dt, tail
        As in `slip_bounds_one`.
    mu_s, mu_k : ndarray, shape (m,)
        Friction at rest and while slipping [-].
    results : ndarray, shape (m, 4)
        Receives of each body what `slip_bounds_one` fills in: [m], [m], [m/s2], [m/s2].

    References
    ----------
    As in `slip_bounds_one`.
    """
    for k in range(mu_s.shape[0]):
        slip_bounds_one(x, y, z, push, ratio, maxima, pushes, dt, mu_s[k], mu_k[k], tail, results[k])
