r"""Phase of slip in one direction, short against the body's period: its Taylor series and the instant of its stop.

.. math::

    u'' + c u' + b u = f_0 + f_1 t, \qquad c = 2 \zeta w, \quad b = w^2

with u [m], f0 [m/s2] and f1 [m/s3] force per mass and its rate, c [1/s] and b [1/s2]; without a spring and a dashpot
the series end and are exact.
"""

import math

import numpy as np

from pipeline.kernels import inlined, inner
from pipeline.kernels.linear import peak_inside, transition
from pipeline.quantities import Array

PHASE = 0.5
"""Largest w (1 + zeta) times a stretch: the acceleration changes sign at most twice in it, and its series converges."""

TERMS = 24
"""Terms of a phase's Taylor series, at most: 1 / 24! is far below rounding."""

FACTORIALS = np.array([1.0 / math.factorial(k) for k in range(TERMS + 1)])
"""Reciprocals: a division costs as much as three terms."""

# What _zero looks for.
VELOCITY, ACCELERATION = np.int64(1), np.int64(2)

# What a body holds; UU to U1: the new u by u, v, force and its rate after a whole step; SIZE: terms of a series.
W, ZETA, MU_S, MU_K, STEP, B, C, UU, UV, U0, U1, EASE, SIZE = range(13)
Body = tuple[float, float, float, float, float, float, float, float, float, float, float, float, float]


@inner
def make_body(w: float, zeta: float, mu_s: float, mu_k: float, step: float) -> Body:
    """Return what a body is and what a whole step does to it: the rows named above.

    Parameters
    ----------
    w, zeta : float
        Angular frequency [rad/s] and damping ratio [-].
    mu_s, mu_k : float
        Friction at rest and while slipping [-].
    step : float
        Its longest phase, s.

    Returns
    -------
    tuple of float
        By W, ZETA, MU_S, ... SIZE.
    """
    b, c = w * w, 2.0 * zeta * w
    uu, uv, u0, u1 = transition(w, zeta, step)
    ease = 1.0 / (1.0 - 0.5 * c * step - 0.125 * b * step * step)
    # Each derivative, times its power of the step, is at most this share of the greater of the two before it.
    share = step * w * (zeta + math.sqrt(zeta * zeta + 1.0))
    size, last = 3, share / 6.0
    while size < TERMS and last > 1e-17:
        size += 1
        last *= share / size
    return w, zeta, mu_s, mu_k, step, b, c, uu, uv, u0, u1, ease, float(size)


@inner
def free_body(mu_s: float, mu_k: float, step: float) -> Body:
    """Return a body without a spring and a dashpot, of which a whole step is a cubic.

    Parameters
    ----------
    mu_s, mu_k, step
        As in `make_body`.

    Returns
    -------
    tuple of float
        As from `make_body`, which would take longer to compile.
    """
    half = 0.5 * step * step
    return 0.0, 0.0, mu_s, mu_k, step, 0.0, 0.0, 1.0, step, half, step * step * step / 6.0, 1.0, 3.0


@inlined
def expand(u: float, v: float, f0: float, f1: float, body: Body, series: Array) -> None:
    r"""Fill in the Taylor series of the velocity and the displacement of a phase.

    Each further derivative follows from the two before it:

    .. math::

        u^{(k+2)} = -c u^{(k+1)} - b u^{(k)}, \qquad k \ge 2

    Parameters
    ----------
    u, v : float
        Displacement [m] and velocity [m/s] at its beginning.
    f0, f1 : float
        Force per mass [m/s2] and its rate [m/s3].
    body : tuple of float
        From `make_body`.
    series : ndarray, shape (2, TERMS)
        Receives the coefficients of the velocity (row 0, [m/s] per power of a second) and of the displacement since the
        beginning over t (row 1, the same).
    """
    b, c = body[B], body[C]
    before, now = v, f0 - c * v - b * u
    series[0, 0], series[1, 0] = v, v
    series[0, 1], series[1, 1] = now, 0.5 * now
    before, now = now, f1 - c * now - b * before
    for k in range(2, int(body[SIZE])):
        series[0, k], series[1, k] = now * FACTORIALS[k], now * FACTORIALS[k + 1]
        # Each further derivative of u is -c times the one before it less b times the one before that.
        before, now = now, -c * now - b * before


@inlined
def after(series: Array, size: float, t: float) -> tuple[float, float]:
    """Return velocity and displacement after a part of a phase, by its series.

    Parameters
    ----------
    series : ndarray, shape (2, TERMS)
        From `expand`.
    size : float
        How many of its terms there are.
    t : float
        Seconds since the beginning.

    Returns
    -------
    tuple of float
        The velocity then [m/s], and the displacement since the beginning [m].
    """
    v, moved = 0.0, 0.0
    for k in range(int(size) - 1, -1, -1):
        v = v * t + series[0, k]
        moved = moved * t + series[1, k]
    return v, moved * t


@inner
def _zero(
    u: float,
    f0: float,
    f1: float,
    body: Body,
    series: Array,
    order: int,
    low: float,
    high: float,
    at_high: float,
    guess: float,
) -> tuple[float, float]:
    # Where the velocity or the acceleration, as the order says, vanishes, its sign being that of at_high only at high,
    # and the displacement or the velocity there: Halley inside the bracket.
    b, c = body[B], body[C]
    near = 1e-5 * high
    t = guess if low < guess < high else 0.5 * (low + high)
    what = 0.0
    for _ in range(100):
        v, moved = after(series, body[SIZE], t)
        a = f0 + f1 * t - c * v - b * (u + moved)
        jerk = f1 - c * a - b * v
        if order == VELOCITY:
            value, rate, bend, what = v, a, jerk, u + moved
        else:
            value, rate, bend, what = a, jerk, -c * jerk - b * a, v
        if value == 0.0:
            break
        if (value > 0.0) == (at_high > 0.0):
            high = t
        else:
            low = t
        below = 2.0 * rate * rate - value * bend
        move = -2.0 * value * rate / below if below != 0.0 else high - low
        # The next error is the cube of the last move, but for a root that is nearly double.
        if low < t + move < high and abs(move) <= near:
            return t + move, what + move * (value + 0.5 * move * rate)
        if high - low <= 4e-16 * high:
            break
        t = t + move if low < t + move < high else 0.5 * (low + high)
    return t, what


@inner
def first_stop(
    u: float, v: float, s: float, f0: float, f1: float, body: Body, series: Array, span: float, un: float, vn: float
) -> tuple[float, float]:
    """Return the first time at which the velocity in a direction vanishes, and the displacement then.

    Parameters
    ----------
    u, v, f0, f1, body, series
        As in `expand`, which has filled the series.
    s : float
        The direction, 1 or -1.
    span : float
        Length of the phase [s], at most a body's step: short against its period, so that the acceleration changes sign
        at most twice.
    un, vn : float
        Displacement [m] and velocity [m/s] after span.

    Returns
    -------
    tuple of float
        The time in (0, span] [s], -1 if it does not vanish; and the displacement [m].
    """
    moving = s * v > 0.0
    first, half = s * series[0, 1], s * series[0, 2]
    dips = first < 0.0 < s * (f0 + f1 * span - body[C] * vn - body[B] * un)
    if s * vn > 0.0 and not (moving and dips):
        return -1.0, 0.0
    low, high = 0.0, span
    if not moving:
        # Starting from rest the velocity has a root at 0 that is no stop: find a time at which it moves in direction s.
        low = 0.5 * span
        for _ in range(60):
            if s * after(series, body[SIZE], low)[0] > 0.0:
                break
            low *= 0.5
        else:
            return 0.0, u
    elif s * vn > 0.0:
        high, speed = _zero(u, f0, f1, body, series, ACCELERATION, 0.0, span, s, -0.5 * first / half)
        if s * speed > 0.0:
            return -1.0, 0.0
    # Where it would stop if its acceleration changed linearly, as a free body's does.
    inner = math.sqrt(max(0.0, first * first - 4.0 * s * v * half))
    guess = 2.0 * s * v / (inner - first) if first < 0.0 else -0.5 * (first + inner) / half
    return _zero(u, f0, f1, body, series, VELOCITY, low, high, -s, guess)


@inlined
def passed_on(
    u: float,
    v: float,
    un: float,
    vn: float,
    f0: float,
    f1: float,
    lift0: float,
    lift1: float,
    t: float,
    body: Body,
    most: float,
) -> float:
    r"""Return the largest acceleration passed on so far or in a slip.

    .. math::

        |c u' + b u + \text{lift}_0 + \text{lift}_1 t|

    Parameters
    ----------
    u, v, un, vn : float
        Displacement [m] and velocity [m/s] at its beginning and its end.
    f0, f1, lift0, lift1 : float
        Force per mass and friction [m/s2] at its beginning, and their rates [m/s3].
    t : float
        Length of the slip, s.
    body : tuple of float
        From `make_body`.
    most : float
        The largest so far, m/s2.

    Returns
    -------
    float
        In m/s2.
    """
    b, c = body[B], body[C]
    near = max(abs(c * v + b * u + lift0), abs(c * vn + b * un + lift0 + lift1 * t))
    most = max(most, near)
    # Between the ends it rises by at most its curvature times t^2 / 8: see the oscillator's bounds.
    push, speed = max(abs(f0), abs(f0 + f1 * t)), max(abs(v), abs(vn))
    second = (push + c * speed + b * max(abs(u), abs(un))) * body[EASE]
    bend = c * (abs(f1) + c * second + b * (speed + 0.5 * t * second)) + b * second
    if b > 0.0 and near + 0.125 * t * t * bend > most:
        return max(most, peak_inside(u, v, f0, f1, body[W], body[ZETA], t, lift0, lift1, b, c))
    return most
