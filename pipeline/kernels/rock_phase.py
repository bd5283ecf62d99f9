r"""Phase of rocking about an edge that does not move: one step of it, and the instants at which something happens.

.. math::

    \phi'' = -c \left[n \sin(\alpha - \phi) + s a \cos(\alpha - \phi)\right]

with phi [rad] the rotation about the edge, s = +1 or -1 its side, alpha [rad] the slenderness towards it, c [1/m] as in
`pipeline.kernels.rocking`, a = a0 + a1 t and n = n0 + n1 t [m/s2] the horizontal acceleration of the base and the
weight per mass.
"""

import numpy as np

from pipeline.kernels import fused, inlined, inner
from pipeline.kernels.roots import narrowed, trial

ANGLE, SPEED = np.int64(0), np.int64(1)
"""What `locate` looks for."""


@inlined
def rock_step(
    phi: float,
    rate: float,
    sn: float,
    cs: float,
    a0: float,
    a1: float,
    n0: float,
    n1: float,
    t: float,
    h: float,
    s: float,
    c: float,
) -> tuple[float, float, float, float]:
    """Return rotation and rate after one classical Runge-Kutta step of fourth order.

    The sine and the cosine are integrated along with the rotation, so that a step has no transcendental function in it.

    Parameters
    ----------
    phi, rate : float
        Rotation [rad] and rate [rad/s] at its beginning.
    sn, cs : float
        Sine and cosine of alpha - phi.
    a0, a1, n0, n1 : float
        Push and weight per mass at time 0 [m/s2], and their rates [m/s3].
    t, h : float
        Its beginning and its length, s.
    s, c : float
        As above.

    Returns
    -------
    tuple of float
        phi, rate, sn and cs at its end.
    """
    half, sixth = 0.5 * h, h / 6.0
    pa, pn = s * (a0 + a1 * t), n0 + n1 * t
    ma, mn = s * (a0 + a1 * (t + half)), n0 + n1 * (t + half)
    qa, qn = s * (a0 + a1 * (t + h)), n0 + n1 * (t + h)
    k1 = -c * (pn * sn + pa * cs)
    ds1, dc1 = -rate * cs, rate * sn
    r2, s2, c2 = rate + half * k1, sn + half * ds1, cs + half * dc1
    k2 = -c * (mn * s2 + ma * c2)
    ds2, dc2 = -r2 * c2, r2 * s2
    r3, s3, c3 = rate + half * k2, sn + half * ds2, cs + half * dc2
    k3 = -c * (mn * s3 + ma * c3)
    ds3, dc3 = -r3 * c3, r3 * s3
    r4, s4, c4 = rate + h * k3, sn + h * ds3, cs + h * dc3
    k4 = -c * (qn * s4 + qa * c4)
    sa = sn + sixth * (ds1 + 2.0 * (ds2 + ds3) - r4 * c4)
    ca = cs + sixth * (dc1 + 2.0 * (dc2 + dc3) + r4 * s4)
    back = 1.5 - 0.5 * (sa * sa + ca * ca)
    return (
        phi + sixth * (rate + 2.0 * (r2 + r3) + r4),
        rate + sixth * (k1 + 2.0 * (k2 + k3) + k4),
        sa * back,
        ca * back,
    )


@fused
def rock_after(
    phi: float,
    rate: float,
    sn: float,
    cs: float,
    a0: float,
    a1: float,
    n0: float,
    n1: float,
    t: float,
    h: float,
    s: float,
    c: float,
) -> tuple[float, float, float, float]:
    """Return what `rock_step` does, as a call: for where it is not the inside of a loop, and compilation counts."""
    return rock_step(phi, rate, sn, cs, a0, a1, n0, n1, t, h, s, c)


@fused
def locate(
    phi: float,
    rate: float,
    sn: float,
    cs: float,
    a0: float,
    a1: float,
    n0: float,
    n1: float,
    t: float,
    low: float,
    high: float,
    at_low: float,
    at_high: float,
    s: float,
    c: float,
    what: int,
    level: float,
) -> float:
    """Return the length of the step after which the rotation or its rate reaches a level.

    Illinois, each trial being one step from the same beginning.

    Parameters
    ----------
    phi, rate, sn, cs, a0, a1, n0, n1, t, s, c
        As in `rock_step`.
    low, high : float
        Lengths between which it is, s.
    at_low, at_high : float
        What is looked for after these, less the level: whoever brackets an instant knows both, at 0 without a step.
    what : int
        ANGLE or SPEED.
    level : float
        In rad or rad/s.

    Returns
    -------
    float
        In s.
    """
    side, tau = 0, high
    for _ in range(60):
        if at_high == at_low:
            break
        before, tau = tau, trial(low, high, at_low, at_high)
        p, r, _s, _c = rock_step(phi, rate, sn, cs, a0, a1, n0, n1, t, tau, s, c)
        value = (p if what == ANGLE else r) - level
        low, high, at_low, at_high, side = narrowed(low, high, at_low, at_high, side, tau, value)
        if value == 0.0 or abs(tau - before) <= 1e-15 * tau:
            break
    return tau


@fused
def landing(
    phi: float,
    rate: float,
    sn: float,
    cs: float,
    a0: float,
    a1: float,
    n0: float,
    n1: float,
    t: float,
    h: float,
    s: float,
    c: float,
    p1: float,
    r1: float,
) -> float:
    """Return when within a step the other edge lands; -1 if it does not.

    Parameters
    ----------
    phi, rate, sn, cs, a0, a1, n0, n1, t, h, s, c
        As in `rock_step`.
    p1, r1 : float
        Rotation [rad] and rate [rad/s] at the end of the step.

    Returns
    -------
    float
        Length of the step until then, s.
    """
    if phi > 0.0:
        if p1 < 0.0:
            return locate(phi, rate, sn, cs, a0, a1, n0, n1, t, 0.0, h, phi, p1, s, c, ANGLE, 0.0)
        if rate < 0.0 < r1:
            dip = locate(phi, rate, sn, cs, a0, a1, n0, n1, t, 0.0, h, rate, r1, s, c, SPEED, 0.0)
            lowest, _r, _s, _c = rock_after(phi, rate, sn, cs, a0, a1, n0, n1, t, dip, s, c)
            if lowest < 0.0:
                return locate(phi, rate, sn, cs, a0, a1, n0, n1, t, 0.0, dip, phi, lowest, s, c, ANGLE, 0.0)
    elif p1 <= 0.0:
        # A hop that begins and ends within the step: find a time at which the body is up.
        low = 0.5 * h
        for _k in range(50):
            p, _r, _s, _c = rock_after(phi, rate, sn, cs, a0, a1, n0, n1, t, low, s, c)
            if p > 0.0:
                return locate(phi, rate, sn, cs, a0, a1, n0, n1, t, low, h, p, p1, s, c, ANGLE, 0.0)
            low *= 0.5
        return 0.0
    return -1.0


@inner
def lift_off(
    a0: float, a1: float, n0: float, n1: float, now: float, span: float, hold1: float, hold2: float
) -> tuple[float, float]:
    """Return when what holds a resting body is first exceeded, and the side that the body is then pushed to.

    Parameters
    ----------
    a0, a1, n0, n1 : float
        As in `rock_step`.
    now, span : float
        The first and the last time that are looked at, s.
    hold1, hold2 : float
        The push, as a share of the weight, that is held towards +axis and towards the other side: of an edge the
        tangent of the slenderness, of friction its coefficient.

    Returns
    -------
    time, side : float
        In s, and 1 or -1; (-1, 0) if it is not.
    """
    time, edge = -1.0, 0.0
    for s in (1.0, -1.0):
        hold = hold1 if s > 0.0 else hold2
        begin = -s * (a0 + a1 * now) - hold * (n0 + n1 * now)
        end = -s * (a0 + a1 * span) - hold * (n0 + n1 * span)
        if begin > 0.0:
            t = now
        elif end > 0.0:
            t = now + (span - now) * min(1.0, -begin / (end - begin))
        else:
            continue
        if time < 0.0 or t < time:
            time, edge = t, s
    return time, edge
