r"""Stop of a body that slips in two directions: instants and ways in closed form.

Under a constant push q = -(a + b u + c u') [m/s2] and a constant grip g = mu_k N [m/s2] (a block on an incline)

.. math::

    u'' = q - g \frac{u'}{|u'|}, \qquad \frac{d}{dt} \left(g |u'| + q \cdot u'\right) = -(g^2 - |q|^2)

so that g ``|u'|`` + q . u' falls at a constant rate and vanishes with the velocity, and the way that is left is a
quadratic form of the velocity.  On a straight line a push that changes linearly has a closed form, too.
"""

import math

from pipeline.kernels import bare, inner
from pipeline.quantities import Array

NEVER = -1.0
STRAIGHT = 1e-4
"""Angle between push and velocity up to which static friction catches a body that kinetic friction would not stop."""


UNEVEN = 0.05
"""Error of a way to rest, over the way and the share of what is left of the grip that push and grip change by.

Of 400 random stops none was off by more than 0.04.
"""


@inner
def _straight_stop(speed: float, loss: float, loss1: float, span: float) -> float:
    """Return the first time [s] in (0, span] at which speed - loss t - loss1 t^2 / 2 vanishes, or NEVER."""
    square = loss * loss + 2.0 * loss1 * speed
    if square < 0.0:
        return NEVER
    below = loss + math.sqrt(square)
    if below <= 0.0 or 2.0 * speed > span * below:
        return NEVER
    return 2.0 * speed / below


@inner
def _plane_stop(
    speed: float,
    vx: float,
    vy: float,
    qx: float,
    qy: float,
    q1x: float,
    q1y: float,
    grip: float,
    grip1: float,
    span: float,
) -> float:
    """Return the time [s] in (0, span] at which the body comes to rest, or NEVER.

    Parameters
    ----------
    speed, vx, vy : float
        Of the body, m/s.
    qx, qy, q1x, q1y : float
        The push [m/s2] and its rate [m/s3], whose change along the way is taken to first order.
    grip, grip1 : float
        mu_k N [m/s2] and its rate [m/s3].
    span : float
        Seconds.
    """
    level = grip * speed + qx * vx + qy * vy
    if level <= 0.0:
        return NEVER
    square = qx * qx + qy * qy - grip * grip
    half = qx * q1x + qy * q1y - grip * grip1
    bend = q1x * q1x + q1y * q1y - grip1 * grip1
    high = span
    if square + span * (2.0 * half + span * bend) > 0.0:
        # The push wins in the end.  Friction has brought the body to rest before that, or not at all.
        inside = half * half - bend * square
        if inside < 0.0:
            return NEVER
        root = math.sqrt(inside)
        if half <= 0.0 and bend > 0.0:
            high = min(span, (root - half) / bend)
        elif half + root > 0.0:
            high = min(span, -square / (half + root))
        if not high > 0.0:
            return NEVER
    # What push and grip gain while the velocity goes to zero in proportion.
    first = square + 0.5 * (grip1 * speed + q1x * vx + q1y * vy)
    third = bend / 3.0
    if level + high * (first + high * (half + high * third)) > 0.0:
        return NEVER
    low, t = 0.0, high
    if first < 0.0:
        t = min(high, -level / first)
    for _ in range(40):
        value = level + t * (first + t * (half + t * third))
        if value > 0.0:
            low = t
        else:
            high = t
        slope = first + t * (2.0 * half + 3.0 * t * third)
        better = t - value / slope if slope < 0.0 else 0.5 * (low + high)
        if not low <= better <= high:
            better = 0.5 * (low + high)
        moved = abs(better - t)
        t = better
        if moved <= 1e-9 * t:
            break
    return t


@inner
def _way_left(speed: float, vx: float, vy: float, qx: float, qy: float, grip: float) -> tuple[float, float, float]:
    """Return the way (x, y) and the path [m] to rest under a constant push that is weaker than the grip."""
    push = qx * qx + qy * qy
    along = qx * vx + qy * vy
    # v = part q + side: each has a factor of its own.
    part = along / push if push > 1e-30 * grip * grip else 0.0
    cross = (2.0 * grip * speed + along) / (4.0 * grip * grip - push)
    straight = (speed * speed + part * (2.0 * grip * speed + along)) / (4.0 * (grip * grip - push))
    dx = straight * qx + cross * (vx - part * qx)
    dy = straight * qy + cross * (vy - part * qy)
    return dx, dy, (0.5 * speed * speed + qx * dx + qy * dy) / grip


@bare
def come_to_rest(
    speed: float,
    vx: float,
    vy: float,
    ex: float,
    ey: float,
    qx: float,
    qy: float,
    q1x: float,
    q1y: float,
    load: Array,
    t: float,
    left: float,
    change: float,
    stiff: float,
    crawls: bool,
) -> tuple[float, float, float, float, float]:
    """Return when and where a slipping body comes to rest, if that can be said now.

    Parameters
    ----------
    speed, vx, vy, ex, ey : float
        Size of the velocity, the velocity [m/s] and its direction [-].
    qx, qy, q1x, q1y : float
        The push -(a + b u + c u') [m/s2] and its rate [m/s3].
    load : ndarray, shape (8,)
        As in `pipeline.kernels.friction_plane`: excitation, grip and hold with their rates.
    t, left : float
        The instant in the stretch on which the load is linear, and what is left of the stretch, s.
    change : float
        Share of push and grip that may change on the way, where they are held constant.
    stiff : float
        b + c^2 [1/s2], by which spring and dashpot bend the push.
    crawls : bool
        Whether it is so slow that any way to rest will do.

    Returns
    -------
    tuple of float
        The time to rest [s], below zero for not now; the way (x, y), the path to there, and the way's error [m].
    """
    grip, grip1 = load[4] + load[5] * t, load[5]
    loss, loss1 = grip - qx * ex - qy * ey, grip1 - q1x * ex - q1y * ey
    wait = _straight_stop(speed, loss, loss1, left)
    push = math.sqrt(qx * qx + qy * qy)
    if wait > 0.0:
        astray = abs(qx * ey - qy * ex) + abs(q1x * ey - q1y * ex) * wait
        bent = max(astray, stiff * wait * wait * (grip + push))
        if bent <= 0.1 * change * change * (grip + push):
            endx, endy = qx + q1x * wait, qy + q1y * wait
            final, s = math.sqrt(endx * endx + endy * endy), t + wait
            # Between kinetic and static friction only a body that comes straight is caught.
            slips = final <= load[4] + load[5] * s or final > load[6] + load[7] * s
            if slips or astray <= STRAIGHT * (grip + push):
                path = wait * (2.0 / 3.0 * speed - loss * wait / 6.0)
                return wait, path * ex, path * ey, path, 0.5 * bent * wait * wait
    if grip <= 0.0:
        return NEVER, 0.0, 0.0, 0.0, 0.0
    wait = _plane_stop(speed, vx, vy, qx, qy, q1x, q1y, grip, grip1, left)
    if wait < 0.0:
        return NEVER, 0.0, 0.0, 0.0, 0.0
    changes = (math.sqrt(q1x * q1x + q1y * q1y) + abs(grip1)) * wait
    if changes <= change * (grip - push) and stiff * wait * wait <= change * change:
        # The push and the grip that, held constant, end at the same place to first order: those after a third.
        third = wait / 3.0
        dx, dy, path = _way_left(speed, vx, vy, qx + q1x * third, qy + q1y * third, grip + grip1 * third)
        return wait, dx, dy, path, path * (UNEVEN * changes / (grip - push) + stiff * wait * wait)
    if crawls:
        way = 0.5 * speed * wait
        return wait, 0.5 * vx * wait, 0.5 * vy * wait, way, way
    return NEVER, 0.0, 0.0, 0.0, 0.0
