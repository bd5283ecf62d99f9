r"""Peaks of a body slipping in two directions: the largest radius and acceleration inside a step; and its samples.

Passed on is, with the symbols of `pipeline.kernels.plane_step`,

.. math::

    f = b u + c u' + \mu_k N \frac{u'}{|u'|}

in m/s2.
"""

import math

from pipeline.kernels import inner
from pipeline.kernels.plane_step import plane_step
from pipeline.quantities import Array

STATIONS = 32
"""Points of a way to rest at which its largest radius is looked for."""

TRIALS = 12
"""Shorter steps taken to find a stationary point: at one, the value itself is second order in the time's error."""


@inner
def felt(ux: float, uy: float, vx: float, vy: float, ex: float, ey: float, grip: float, b: float, c: float) -> float:
    """Return the absolute acceleration of a slipping body: what spring, dashpot and friction push it with.

    Parameters
    ----------
    ux, uy, vx, vy, ex, ey, grip, b, c : float
        As in `pipeline.kernels.plane_step.plane_step`.

    Returns
    -------
    float
        ``|f|``, m/s2.
    """
    if b == 0.0:
        return grip
    fx, fy = b * ux + c * vx + grip * ex, b * uy + c * vy + grip * ey
    return math.sqrt(fx * fx + fy * fy)


@inner
def _felt_rate(
    ux: float,
    uy: float,
    vx: float,
    vy: float,
    ex: float,
    ey: float,
    speed: float,
    ax: float,
    ay: float,
    grip: float,
    grip1: float,
    b: float,
    c: float,
) -> float:
    # Half the rate of the squared absolute acceleration [m2/s5].
    speed = math.sqrt(vx * vx + vy * vy)
    if speed == 0.0:
        return 0.0
    fx, fy = b * ux + c * vx + grip * ex, b * uy + c * vy + grip * ey
    rx, ry = -ax - fx, -ay - fy
    along = ex * rx + ey * ry
    gx = c * rx + b * vx + grip1 * ex + grip * (rx - ex * along) / speed
    gy = c * ry + b * vy + grip1 * ey + grip * (ry - ey * along) / speed
    return fx * gx + fy * gy


@inner
def inner_radius(
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
    begin: float,
    end: float,
    most: float,
) -> float:
    """Return the largest square of the radius inside a step, where the body turns back.

    Parameters
    ----------
    ux, uy, vx, vy, ex, ey, speed, ax, ay, a1x, a1y, grip, grip1, b, c, h
        As in `pipeline.kernels.plane_step.plane_step`.
    begin, end : float
        u . v at the ends of the step [m2/s]: begin > 0 > end.
    most : float
        The largest so far, m2.

    Returns
    -------
    float
        ``|u|^2`` [m2], or 0 where it cannot exceed ``most``.
    """
    reach = math.sqrt(ux * ux + uy * uy) + h * speed
    if reach * reach <= most:
        return 0.0
    low, high, best, side = 0.0, h, 0.0, 0
    for _ in range(TRIALS):
        tau = (low * end - high * begin) / (end - begin)
        if not low < tau < high:
            tau = 0.5 * (low + high)
        wx, wy, sx, sy, _dx, _dy, _pace, _path, _error, _least = plane_step(
            ux, uy, vx, vy, ex, ey, speed, ax, ay, a1x, a1y, grip, grip1, b, c, tau
        )
        best = max(best, wx * wx + wy * wy)
        value = wx * sx + wy * sy
        # Illinois: an end that stays is halved.
        if value > 0.0:
            low, begin = tau, value
            end *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            high, end = tau, value
            begin *= 0.5 if side == -1 else 1.0
            side = -1
        if value == 0.0 or high - low <= 1e-7 * h:
            break
    return best


@inner
def stop_radius(ux: float, uy: float, wx: float, wy: float, dx: float, dy: float) -> float:
    """Return the largest square of the radius on the way to rest: at the beginning, inside or at the end.

    The way is taken for the cubic that begins at u with the velocity there and ends at u + d at rest; it is off by a
    share of what it rises above both ends.

    Parameters
    ----------
    ux, uy : float
        Where the way begins, m.
    wx, wy : float
        The velocity there times the time to rest, m.
    dx, dy : float
        The way, m.

    Returns
    -------
    float
        ``|u|^2`` [m2].
    """
    best = 0.0
    for k in range(STATIONS + 1):
        s = k / STATIONS
        begins, ends = s * (1.0 - s) * (1.0 - s), s * s * (3.0 - 2.0 * s)
        x, y = ux + begins * wx + ends * dx, uy + begins * wy + ends * dy
        best = max(best, x * x + y * y)
    return best


@inner
def inner_felt(
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
    wx: float,
    wy: float,
    sx: float,
    sy: float,
    dx: float,
    dy: float,
    pace: float,
) -> float:
    """Return the largest absolute acceleration at a stationary point inside a step.

    Parameters
    ----------
    ux, uy, vx, vy, ex, ey, speed : float
        At its beginning, as in `pipeline.kernels.plane_step.plane_step`.
    ax, ay, a1x, a1y, grip, grip1, b, c, h : float
        As there.
    wx, wy, sx, sy, dx, dy, pace : float
        Displacement [m], velocity [m/s], its direction and size at its end.

    Returns
    -------
    float
        In m/s2; 0 where there is none.
    """
    begin = _felt_rate(ux, uy, vx, vy, ex, ey, speed, ax, ay, grip, grip1, b, c)
    end = _felt_rate(wx, wy, sx, sy, dx, dy, pace, ax + a1x * h, ay + a1y * h, grip + grip1 * h, grip1, b, c)
    if not begin > 0.0 > end:
        return 0.0
    low, high, best, side = 0.0, h, 0.0, 0
    for _ in range(TRIALS):
        tau = (low * end - high * begin) / (end - begin)
        if not low < tau < high:
            tau = 0.5 * (low + high)
        wx, wy, sx, sy, dx, dy, pace, _path, _error, _least = plane_step(
            ux, uy, vx, vy, ex, ey, speed, ax, ay, a1x, a1y, grip, grip1, b, c, tau
        )
        best = max(best, felt(wx, wy, sx, sy, dx, dy, grip + grip1 * tau, b, c))
        value = _felt_rate(
            wx, wy, sx, sy, dx, dy, pace, ax + a1x * tau, ay + a1y * tau, grip + grip1 * tau, grip1, b, c
        )
        if value > 0.0:
            low, begin = tau, value
            end *= 0.5 if side == 1 else 1.0
            side = 1
        else:
            high, end = tau, value
            begin *= 0.5 if side == -1 else 1.0
            side = -1
        if value == 0.0 or high - low <= 1e-7 * h:
            break
    return best


@inner
def note(
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
    """Fill in a sample of a history.

    Parameters
    ----------
    history : ndarray, shape (k, 4)
        Receives in row i ux, uy [m] and the absolute acceleration along both [m/s2].
    i : int
        The sample.
    state : ndarray
        As in `pipeline.kernels.friction_plane`: ux, uy [m], vx, vy [m/s] first.
    ax, ay : float
        Acceleration of the base, m/s2.
    mu_s, mu_k : float
        Friction at rest and while slipping [-].
    weight : float
        N, m/s2.
    b, c : float
        w^2 [1/s2] and 2 zeta w [1/s].
    slipping : bool
        Whether it slips.
    """
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
