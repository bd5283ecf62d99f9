r"""Plate that hangs flush with its wall on hooks that are open above: it slaps the wall, and lifts off its hooks.

theta [rad] is how far its lower edge has opened from the wall, h [m] how far its hangers have risen above the hooks;
per mass, with the centre of gravity L below the hooks and c in front of them and k its radius of gyration,

.. math::

    h'' + z_\theta \theta'' + x_\theta \theta'^2 &= -(g + a_z) + v \\
    (k^2 + L^2 + c^2)\, \theta'' + z_\theta h'' &= -a\, x_\theta - (g + a_z)\, z_\theta + p \\
    x_\theta = L \cos\theta - c \sin\theta, \qquad & z_\theta = L \sin\theta + c \cos\theta

with a [m/s2] the acceleration of the wall away from itself, v >= 0 what the hooks push up (0 where h > 0) and p >= 0
the moment by which the wall pushes (0 where theta > 0).  These are the equations of Lagrange of a rigid body with two
one-sided contacts, as in Brogliato (2016); sideways it is held at the hooks.

Both contacts give back the share e of the speed.  At the wall, with the hangers on the hooks, theta' turns to -e
theta'; in flight h' changes by -c times the jump of theta'.  Where the hangers land h' turns to -e h', and theta'
changes by -z_theta / (k^2 + L^2 + c^2) times the jump of h'.

Classical Runge-Kutta steps of fourth order that end at every sample and at every event, which is found by bisection.

References
----------
Brogliato, B. (2016). Nonsmooth Mechanics. 3rd ed., Springer. Ch. 5: contacts, complementarity and impact.
"""

import math

from pipeline.kernels import CUT, EVENT_CAP, UNRESOLVED, bare, fused
from pipeline.kernels.pendulum import substeps
from pipeline.quantities import Array, G

CAP = 20.0
"""Seconds after the record at which a plate that has not come back to its wall is cut off."""

EVENTS = 100
"""Events that are followed in one sample interval."""

HALVINGS = 26
"""Of a step: an event is found to 2e-8 of it."""

STICKS = 1e-3
"""Share of a step: a bounce that is over in less is none."""

State = tuple[float, float, float, float]
Body = tuple[float, float, float, float]
Load = tuple[float, float, float, float]


@fused
def _rates(s: State, a: float, n: float, hooked: bool, walled: bool, body: Body) -> tuple[float, float]:
    # theta'' and h''; n: g + a_z.
    length, offset, inertia, _ = body
    if hooked and walled:
        return 0.0, 0.0
    if walled:
        return 0.0, -n
    sine, cosine = math.sin(s[0]), math.cos(s[0])
    along, up = length * cosine - offset * sine, length * sine + offset * cosine
    turning = (a * along + n * up) / inertia
    if hooked:
        return -turning, 0.0
    rise = (up * turning - n - along * s[1] * s[1]) / (1.0 - up * up / inertia)
    return -turning - up * rise / inertia, rise


@fused
def _step(s: State, load: Load, t: float, tau: float, hooked: bool, walled: bool, body: Body) -> State:
    a0, n0 = load[0] + load[1] * t, load[2] + load[3] * t
    am, nm = a0 + 0.5 * load[1] * tau, n0 + 0.5 * load[3] * tau
    a1, n1 = a0 + load[1] * tau, n0 + load[3] * tau
    half = 0.5 * tau
    p1, q1 = _rates(s, a0, n0, hooked, walled, body)
    s2 = (s[0] + half * s[1], s[1] + half * p1, s[2] + half * s[3], s[3] + half * q1)
    p2, q2 = _rates(s2, am, nm, hooked, walled, body)
    s3 = (s[0] + half * s2[1], s[1] + half * p2, s[2] + half * s2[3], s[3] + half * q2)
    p3, q3 = _rates(s3, am, nm, hooked, walled, body)
    s4 = (s[0] + tau * s3[1], s[1] + tau * p3, s[2] + tau * s3[3], s[3] + tau * q3)
    p4, q4 = _rates(s4, a1, n1, hooked, walled, body)
    sixth = tau / 6.0
    return (
        s[0] + sixth * (s[1] + 2.0 * (s2[1] + s3[1]) + s4[1]),
        s[1] + sixth * (p1 + 2.0 * (p2 + p3) + p4),
        s[2] + sixth * (s[3] + 2.0 * (s2[3] + s3[3]) + s4[3]),
        s[3] + sixth * (q1 + 2.0 * (q2 + q3) + q4),
    )


@fused
def _push_up(s: State, a: float, n: float, walled: bool, body: Body) -> float:
    # v, while the hangers are on the hooks.
    if walled:
        return n
    length, offset, _, _ = body
    sine, cosine = math.sin(s[0]), math.cos(s[0])
    along, up = length * cosine - offset * sine, length * sine + offset * cosine
    return n + up * _rates(s, a, n, True, False, body)[0] + along * s[1] * s[1]


@fused
def _holds(s: State, load: Load, t: float, hooked: bool, walled: bool, body: Body) -> bool:
    # Whether the contacts are as they were said to be, a touch that only just begins or ends included.
    a, n = load[0] + load[1] * t, load[2] + load[3] * t
    wall = a * body[0] + (n * body[1] if hooked else 0.0) if walled else s[0]
    hook = _push_up(s, a, n, walled, body) if hooked else s[2]
    return wall >= 0.0 and hook >= 0.0


@fused
def _contacts(s: State, a: float, n: float, body: Body) -> tuple[bool, bool]:
    # Which of the contacts that are touched without speed hold: the complementarity problem, whose answer is one only.
    length, offset, inertia, _ = body
    hook, wall = s[2] <= 0.0 and s[3] <= 0.0, s[0] <= 0.0 and s[1] <= 0.0
    closing = a * length + n * offset
    if hook and wall:
        if n >= 0.0 and closing >= 0.0:
            return True, True
        if closing < 0.0 and n - offset * closing / inertia >= 0.0:
            return True, False
        return False, a >= 0.0 and n < 0.0
    if hook:
        return _push_up(s, a, n, False, body) >= 0.0, False
    return False, wall and a >= 0.0


@fused
def _struck(s: State, a: float, n: float, hooked: bool, restitution: float, sticks: float, body: Body) -> State:
    # The state after the impacts that are due; bounces that are over at once are none.
    length, offset, inertia, _ = body
    theta, omega, h, w = s
    if theta <= 0.0:
        theta = 0.0
        if omega < 0.0:
            after = -restitution * omega
            closing = (a * length + n * offset) / inertia
            after = 0.0 if after * 2.0 <= closing * sticks else after
            w = w if hooked else w - offset * (after - omega)
            omega = after
    if h <= 0.0 and not hooked:
        h = 0.0
        if w < 0.0:
            after = -restitution * w
            after = 0.0 if after * 2.0 <= n * sticks else after
            up = length * math.sin(theta) + offset * math.cos(theta)
            omega -= up / inertia * (after - w)
            omega = 0.0 if theta == 0.0 and omega < 0.0 else omega
            w = after
    return theta, omega, h, w


@fused
def _interval(
    s: State, load: Load, dt: float, step: float, restitution: float, body: Body, most: Array, history: Array, row: int
) -> State:
    # From one sample to the next; most: the largest lift, opening and speed at the wall so far, and the flags.
    t, events = 0.0, 0
    a, n = load[0], load[2]
    hooked, walled = _contacts(s, a, n, body)
    while t < dt:
        if hooked and walled and _holds(s, load, dt, hooked, walled, body):
            # Both forces are linear in time: at rest at both ends it rests between them.
            break
        tau = min(step, dt - t)
        after = _step(s, load, t, tau, hooked, walled, body)
        event = not _holds(after, load, t + tau, hooked, walled, body)
        if event:
            low, high = 0.0, tau
            for _ in range(HALVINGS):
                middle = 0.5 * (low + high)
                if _holds(_step(s, load, t, middle, hooked, walled, body), load, t + middle, hooked, walled, body):
                    low = middle
                else:
                    high = middle
            tau = high
            after = _step(s, load, t, tau, hooked, walled, body)
        if s[3] > 0.0 > after[3]:
            most[0] = max(most[0], s[2] + 0.5 * s[3] * tau * s[3] / (s[3] - after[3]))
        if s[1] > 0.0 > after[1]:
            most[1] = max(most[1], s[0] + 0.5 * s[1] * tau * s[1] / (s[1] - after[1]))
        t = dt if tau == dt - t else t + tau
        most[0], most[1] = max(most[0], after[2]), max(most[1], after[0])
        s = after
        if event:
            events += 1
            a, n = load[0] + load[1] * t, load[2] + load[3] * t
            if s[0] <= 0.0 and s[1] < 0.0:
                most[2] = max(most[2], -s[1] * body[3])
            s = _struck(s, a, n, hooked, restitution, STICKS * step, body)
            if events > EVENTS:
                s = (s[0], 0.0, s[2], 0.0)
                most[3] = float(int(most[3]) | EVENT_CAP)
                break
            hooked, walled = _contacts(s, a, n, body)
    if row < history.shape[0]:
        history[row, 0], history[row, 1] = s[0], s[2]
    return s


@bare
def hung_plate_batch(
    x: Array,
    z: Array,
    dt: float,
    peak: float,
    length: Array,
    offset: Array,
    gyration: Array,
    restitution: Array,
    tail: float,
    refine: int,
    results: Array,
    history: Array,
) -> None:
    """Follow m plates by the equations at the top of this module.

    Parameters
    ----------
    x, z : ndarray, shape (n,)
        Acceleration of the wall, away from itself and up, m/s2, linear between samples.
    dt, peak : float
        Time step, s, and the largest acceleration of the wall, m/s2.
    length, offset, gyration, restitution : ndarray, shape (m,)
        L, c and k, m, and e.
    tail : float
        Seconds that it is followed after the record; negative: until it has come back to its wall and its hooks.
    refine : int
        Divides the step.
    results : ndarray, shape (m, 4)
        Receives the largest lift, m, opening, rad, and speed at which the lower edge strikes the wall, m/s, and the
        flags (`pipeline.kernels`); infinite where it is not followed.
    history : ndarray, shape (k, 2)
        Receives theta, rad, and h, m, of a single plate at the samples, as long as it is.
    """
    n = x.shape[0]
    results[:, :] = 0.0
    for one in range(length.shape[0]):
        square = length[one] * length[one] + offset[one] * offset[one]
        inertia = gyration[one] * gyration[one] + square
        edge = length[one] + math.sqrt(3.0) * gyration[one]
        body = (length[one], offset[one], inertia, edge)
        most = results[one]
        pieces = substeps(inertia / math.sqrt(square), 0.0, peak, dt) * refine
        if pieces == 0:
            most[0], most[1], most[2], most[3] = math.inf, math.inf, math.inf, float(UNRESOLVED)
            continue
        step = dt / pieces
        s = (0.0, 0.0, 0.0, 0.0)
        for i in range(n - 1):
            load = (x[i], (x[i + 1] - x[i]) / dt, G + z[i], (z[i + 1] - z[i]) / dt)
            s = _interval(s, load, dt, step, restitution[one], body, most, history, i + 1)
        at_rest = (0.0, 0.0, G, 0.0)
        left = CAP if tail < 0.0 else tail
        while left > 0.0:
            if s[0] <= 0.0 and s[2] <= 0.0 and s[3] <= 0.0 and (tail < 0.0 or s[1] <= 0.0):
                # What the wall gives back opens it less far than it came from.
                break
            now = min(dt, left)
            strikes = most[2]
            s = _interval(s, at_rest, now, step, restitution[one], body, most, history, history.shape[0])
            left -= now
            if tail < 0.0 and s[2] <= 0.0 and most[2] > strikes:
                break
            if tail < 0.0 and left <= 0.0:
                most[3] = float(int(most[3]) | CUT)
