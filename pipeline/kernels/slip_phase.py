r"""Phase of rocking about an edge that slips: one step of it, and the instants at which something happens.

With s = +1 or -1 the side of the edge, phi [rad] the rotation about it, R [m] its distance from the centre of gravity,
u [m] how far it has slipped, sigma the direction of the slip, and S, C the sine and the cosine of alpha - phi,

.. math::

    N = \frac{n - R C \phi'^2}{1 + R^2 S q / \rho^2}, \quad q = S - s \sigma \mu_k C, \qquad
    \phi'' = -\frac{N R q}{\rho^2}, \qquad
    u'' = -\sigma \mu_k N - a - s R (C \phi'' + S \phi'^2)

References
----------
Shenton, H. W. (1996). Criteria for initiation of slide, rock, and slide-rock rigid-body modes. Journal of Engineering
Mechanics 122, 690-693.
Pompei, A., Scalia, A. and Sumbatyan, M. A. (1998). Dynamics of rigid block due to horizontal ground motion. Journal of
Engineering Mechanics 124, 713-717.
"""

import numpy as np

from pipeline.kernels import fused, inlined
from pipeline.kernels.roots import narrowed, trial

TURN, RATE, SLIP, PRESS = np.int64(0), np.int64(1), np.int64(2), np.int64(3)
"""What `slip_locate` looks for: a rotation, its rate, the velocity of the slip, what presses the edge down."""


Moving = tuple[float, float, float, float, float, float]
"""Where a body is that turns about an edge, see `slip_after`."""

Load = tuple[float, float, float, float]
"""Push and weight per mass at time 0 [m/s2], and their rates [m/s3]."""

Edge = tuple[float, float, float, float]
"""Side, friction times direction of the slip, R and rho^2, see `slip_accelerations`."""


@inlined
def slip_accelerations(rate: float, sn: float, cs: float, a: float, n: float, edge: Edge) -> tuple[float, float]:
    """Return the angular acceleration about a slipping edge and the acceleration of its slip.

    Parameters
    ----------
    rate : float
        Of the rotation, rad/s.
    sn, cs : float
        Sine and cosine of alpha - phi.
    a, n : float
        Push and weight per mass, m/s2.
    edge : tuple of float
        Its side, its friction times the direction of the slip [-], R [m] and the radius of gyration squared [m2].

    Returns
    -------
    tuple of float
        In rad/s2 and m/s2.
    """
    s, drag, arm, rho2 = edge
    q = sn - s * drag * cs
    square = rate * rate
    normal = (n - arm * cs * square) / (1.0 + arm * arm * sn * q / rho2)
    turn = -normal * arm * q / rho2
    return turn, -drag * normal - a - s * arm * (cs * turn + sn * square)


@fused
def slip_after(at: Moving, load: Load, t: float, h: float, edge: Edge) -> Moving:
    """Return the motion after one classical Runge-Kutta step of fourth order.

    The sine and the cosine are integrated along with the rotation, as in `pipeline.kernels.rock_phase.rock_step`.

    Parameters
    ----------
    at : tuple of float
        Rotation [rad] and its rate [rad/s], sine and cosine of alpha - phi, slip [m] and its velocity [m/s].
    load : tuple of float
        Push and weight per mass at time 0 [m/s2], and their rates [m/s3].
    t, h : float
        Beginning and length of the step, s.
    edge : tuple of float
        As in `slip_accelerations`.

    Returns
    -------
    tuple of float
        As `at`, at its end.
    """
    phi, rate, sn, cs, u, v = at
    a0, a1, n0, n1 = load
    half, sixth = 0.5 * h, h / 6.0
    am, nm = a0 + a1 * (t + half), n0 + n1 * (t + half)
    k1, w1 = slip_accelerations(rate, sn, cs, a0 + a1 * t, n0 + n1 * t, edge)
    ds1, dc1 = -rate * cs, rate * sn
    r2, s2, c2 = rate + half * k1, sn + half * ds1, cs + half * dc1
    k2, w2 = slip_accelerations(r2, s2, c2, am, nm, edge)
    ds2, dc2 = -r2 * c2, r2 * s2
    r3, s3, c3 = rate + half * k2, sn + half * ds2, cs + half * dc2
    k3, w3 = slip_accelerations(r3, s3, c3, am, nm, edge)
    ds3, dc3 = -r3 * c3, r3 * s3
    r4, s4, c4 = rate + h * k3, sn + h * ds3, cs + h * dc3
    k4, w4 = slip_accelerations(r4, s4, c4, a0 + a1 * (t + h), n0 + n1 * (t + h), edge)
    sa = sn + sixth * (ds1 + 2.0 * (ds2 + ds3) - r4 * c4)
    ca = cs + sixth * (dc1 + 2.0 * (dc2 + dc3) + r4 * s4)
    back = 1.5 - 0.5 * (sa * sa + ca * ca)
    return (
        phi + sixth * (rate + 2.0 * (r2 + r3) + r4),
        rate + sixth * (k1 + 2.0 * (k2 + k3) + k4),
        sa * back,
        ca * back,
        u + h * v + h * sixth * (w1 + w2 + w3),
        v + sixth * (w1 + 2.0 * (w2 + w3) + w4),
    )


@fused
def slip_locate(
    at: Moving, load: Load, t: float, low: float, high: float, edge: Edge, what: int, level: float
) -> float:
    """Return the length of the step after which something reaches a level.

    Illinois, each trial being one step from the same beginning.

    Parameters
    ----------
    at, load, t, edge
        As in `slip_after`.
    low, high : float
        Lengths between which it is, s.
    what : int
        TURN, RATE, SLIP or PRESS.
    level : float
        In rad, rad/s, m/s or m/s2.

    Returns
    -------
    float
        In s.
    """
    at_low, at_high, side, tau = 0.0, 0.0, 0, high
    for trials in range(62):
        before = tau
        if trials < 2:
            tau = low if trials == 0 else high
        else:
            if at_high == at_low:
                break
            tau = trial(low, high, at_low, at_high)
        p, r, _s, c, _u, w = slip_after(at, load, t, tau, edge)
        if what == TURN:
            value = p - level
        elif what == RATE:
            value = r - level
        elif what == SLIP:
            value = w - level
        else:
            value = load[2] + load[3] * (t + tau) - edge[2] * c * r * r - level
        if trials == 0:
            at_low = value
        elif trials == 1:
            at_high = value
        else:
            low, high, at_low, at_high, side = narrowed(low, high, at_low, at_high, side, tau, value)
            if value == 0.0 or abs(tau - before) <= 1e-15 * tau:
                break
    return tau


@fused
def slip_landing(at: Moving, load: Load, t: float, h: float, edge: Edge, p1: float, r1: float) -> float:
    """Return when within a step the other edge lands; -1 if it does not.

    Parameters
    ----------
    at, load, t, h, edge
        As in `slip_after`.
    p1, r1 : float
        Rotation [rad] and rate [rad/s] at the end of the step.

    Returns
    -------
    float
        Length of the step until then, s.
    """
    low, high = 0.0, h
    if at[0] > 0.0:
        if p1 >= 0.0:
            if not at[1] < 0.0 < r1:
                return -1.0
            high = slip_locate(at, load, t, 0.0, h, edge, RATE, 0.0)
            if slip_after(at, load, t, high, edge)[0] >= 0.0:
                return -1.0
    elif p1 > 0.0:
        return -1.0
    else:
        # A hop that begins and ends within the step: find a time at which the body is up.
        low = h
        for _k in range(50):
            low *= 0.5
            if slip_after(at, load, t, low, edge)[0] > 0.0:
                break
        else:
            return 0.0
    return slip_locate(at, load, t, low, high, edge, TURN, 0.0)
