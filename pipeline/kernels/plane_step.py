r"""Implicit Runge-Kutta step of a body slipping on dry friction in two directions, each stage in closed form.

.. math::

    u'' = -a - c u' - b u - \mu_k N \frac{u'}{|u'|}, \qquad c = 2 \zeta w, \quad b = w^2

with u [m], the base's acceleration a [m/s2] and the grip mu_k N [m/s2] linear in time, c [1/s], b [1/s2].

The direction of friction relaxes at the rate mu N / ``|u'|``: infinitely fast where the body starts or turns.  A
diagonally implicit method of order 4 with an explicit first stage (Kennedy and Carpenter 2003, ARK4(3)6L[2]SA) stays
stable there and costs no more than an explicit one: a stage of length h gamma ends at the velocity V for which

.. math::

    D V = W - h \gamma \mu_k N \frac{V}{|V|}

with W all that is known and D a number, so V is parallel to W and shorter by what friction takes.
"""

import math

from pipeline.kernels import bare, inlined

DIAGONAL = 0.25
C2, C3, C4, C5 = 0.5, 83.0 / 250.0, 31.0 / 50.0, 17.0 / 20.0
A31, A32 = 8611.0 / 62500.0, -1743.0 / 31250.0
A41, A42, A43 = 5012029.0 / 34652500.0, -654441.0 / 2922500.0, 174375.0 / 388108.0
A51, A52 = 15267082809.0 / 155376265600.0, -71443401.0 / 120774400.0
A53, A54 = 730878875.0 / 902184768.0, 2285395.0 / 8070912.0
B1, B3, B4, B5 = 82889.0 / 524892.0, 15625.0 / 83664.0, 69875.0 / 102672.0, -2260.0 / 8211.0
# By how much these weights differ from those of the embedded method of order 3.
E1, E3 = B1 - 4586570599.0 / 29645900160.0, B3 - 178811875.0 / 945068544.0
E4, E5, E6 = B4 - 814220225.0 / 1159782912.0, B5 + 3700637.0 / 11593932.0, DIAGONAL - 61727.0 / 225920.0


@inlined
def _stage(wx: float, wy: float, taken: float, share: float) -> tuple[float, float, float]:
    # W divided by D = 1 / share and shortened by what friction takes (taken = h g mu N / D); with the speed, which is
    # below zero where friction would have turned the body back.  The root and the quotient do not wait for each other.
    square = wx * wx + wy * wy
    size = math.sqrt(square)
    part = share - taken / square * size if square > 0.0 else 0.0
    return wx * part, wy * part, size * share - taken


@bare
def plane_step(
    ux: float,
    uy: float,
    vx: float,
    vy: float,
    ex: float,
    ey: float,
    speed: float,
    ax: float,
    ay: float,
    a1x: float,
    a1y: float,
    grip: float,
    grip1: float,
    b: float,
    c: float,
    h: float,
) -> tuple[float, float, float, float, float, float, float, float, float, float]:
    """Take one step.

    Parameters
    ----------
    ux, uy, vx, vy : float
        Displacement [m] and velocity [m/s].
    ex, ey, speed : float
        Direction of the velocity [-] (from rest: that of the push), and its size [m/s].
    ax, ay, a1x, a1y : float
        Acceleration of the base [m/s2] and its rate [m/s3].
    grip, grip1 : float
        mu_k N [m/s2] and its rate [m/s3].
    b, c : float
        w^2 [1/s2] and 2 zeta w [1/s].
    h : float
        Length of the step, s, above 0.

    Returns
    -------
    ux, uy, vx, vy, ex, ey, speed : float
        At its end.
    path : float
        In the step, m.
    error : float
        Of the velocity, against the embedded method of order 3, m/s.
    least : float
        The least speed of the stages [m/s]; below zero friction would have reversed the body: the step is too long.

    References
    ----------
    Kennedy, C. A. and Carpenter, M. H. (2003). Additive Runge-Kutta schemes for convection-diffusion-reaction
    equations. Applied Numerical Mathematics 44, 139-181.
    """
    # Everything that does not wait for the stage before is set apart: the stages are a chain of roots and quotients.
    # z is the velocity that a stage's acceleration makes in h / 4.
    hg = DIAGONAL * h
    stiff = hg * b
    pull = h * stiff
    share = 1.0 / (1.0 + hg * (c + stiff))
    hold, hold1 = hg * share * grip, hg * share * grip1
    forcex, forcey = vx - hg * ax - stiff * ux, vy - hg * ay - stiff * uy
    ratex, ratey = hg * a1x, hg * a1y
    z1x, z1y = -hg * (ax + grip * ex + c * vx + b * ux), -hg * (ay + grip * ey + c * vy + b * uy)

    t = C2 * h
    fx, fy = vx + z1x, vy + z1y
    wx = forcex - ratex * t - pull * DIAGONAL * vx + z1x
    wy = forcey - ratey * t - pull * DIAGONAL * vy + z1y
    x2, y2, speed2 = _stage(wx, wy, hold + hold1 * t, share)
    z2x, z2y = x2 - fx, y2 - fy

    t = C3 * h
    gx, gy = 4.0 * A31 * z1x, 4.0 * A31 * z1y
    px, py = pull * A32, pull * A32
    wx = forcex - ratex * t - pull * A31 * vx + gx + 4.0 * A32 * z2x - px * x2
    wy = forcey - ratey * t - pull * A31 * vy + gy + 4.0 * A32 * z2y - py * y2
    fx, fy = vx + gx + 4.0 * A32 * z2x, vy + gy + 4.0 * A32 * z2y
    x3, y3, speed3 = _stage(wx, wy, hold + hold1 * t, share)
    z3x, z3y = x3 - fx, y3 - fy

    t = C4 * h
    gx, gy = 4.0 * A41 * z1x + 4.0 * A42 * z2x, 4.0 * A41 * z1y + 4.0 * A42 * z2y
    px, py = pull * (A41 * vx + A42 * x2), pull * (A41 * vy + A42 * y2)
    wx = forcex - ratex * t - px + gx + 4.0 * A43 * z3x - pull * A43 * x3
    wy = forcey - ratey * t - py + gy + 4.0 * A43 * z3y - pull * A43 * y3
    fx, fy = vx + gx + 4.0 * A43 * z3x, vy + gy + 4.0 * A43 * z3y
    x4, y4, speed4 = _stage(wx, wy, hold + hold1 * t, share)
    z4x, z4y = x4 - fx, y4 - fy

    t = C5 * h
    gx = 4.0 * A51 * z1x + 4.0 * A52 * z2x + 4.0 * A53 * z3x
    gy = 4.0 * A51 * z1y + 4.0 * A52 * z2y + 4.0 * A53 * z3y
    px, py = pull * (A51 * vx + A52 * x2 + A53 * x3), pull * (A51 * vy + A52 * y2 + A53 * y3)
    wx = forcex - ratex * t - px + gx + 4.0 * A54 * z4x - pull * A54 * x4
    wy = forcey - ratey * t - py + gy + 4.0 * A54 * z4y - pull * A54 * y4
    fx, fy = vx + gx + 4.0 * A54 * z4x, vy + gy + 4.0 * A54 * z4y
    x5, y5, speed5 = _stage(wx, wy, hold + hold1 * t, share)
    z5x, z5y = x5 - fx, y5 - fy

    gx = 4.0 * B1 * z1x + 4.0 * B3 * z3x + 4.0 * B4 * z4x
    gy = 4.0 * B1 * z1y + 4.0 * B3 * z3y + 4.0 * B4 * z4y
    px, py = B1 * vx + B3 * x3 + B4 * x4, B1 * vy + B3 * y3 + B4 * y4
    wx = forcex - ratex * h - pull * px + gx + 4.0 * B5 * z5x - pull * B5 * x5
    wy = forcey - ratey * h - pull * py + gy + 4.0 * B5 * z5y - pull * B5 * y5
    fx, fy = vx + gx + 4.0 * B5 * z5x, vy + gy + 4.0 * B5 * z5y
    x6, y6, speed6 = _stage(wx, wy, hold + hold1 * h, share)
    z6x, z6y = x6 - fx, y6 - fy

    size = math.sqrt(wx * wx + wy * wy)
    if size > 0.0:
        ex, ey = wx / size, wy / size
    ux, uy = ux + h * (px + B5 * x5 + DIAGONAL * x6), uy + h * (py + B5 * y5 + DIAGONAL * y6)
    path = h * (B1 * speed + B3 * speed3 + B4 * speed4 + B5 * speed5 + DIAGONAL * speed6)
    dx = E1 * z1x + E3 * z3x + E4 * z4x + E5 * z5x + E6 * z6x
    dy = E1 * z1y + E3 * z3y + E4 * z4y + E5 * z5y + E6 * z6y
    error = 4.0 * math.sqrt(dx * dx + dy * dy)
    least = min(speed2, speed3, speed4, speed5, speed6)
    return ux, uy, x6, y6, ex, ey, speed6, path, error, least
