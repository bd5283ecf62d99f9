r"""Damped oscillator under a linearly varying force: closed form, for any damping and any step.

.. math::

    u'' + 2 \zeta w u' + w^2 u = f_0 + f_1 t

with u [m], w [rad/s], zeta [-], f0 [m/s2] and f1 [m/s3]; as Nigam and Jennings (1969) solve it for a piecewise-linear
excitation.
"""

import math

import numpy as np

from pipeline.kernels import bare, inlined, inner
from pipeline.kernels.roots import trial

NEGLIGIBLE = 1e-17

RECIPROCALS = np.array([0.0, *(1.0 / k for k in range(1, 46))])
"""1 / k: a division costs as much as half a term."""


@bare
def transition(w: float, zeta: float, t: float) -> tuple[float, float, float, float]:
    r"""Return the responses of an oscillator to a unit displacement, velocity, step and ramp.

    .. math::

        u(t) &= u_0 g + v_0 h + f_0 h_1 + f_1 h_2

        u'(t) &= -u_0 w^2 h + v_0 (g - 2 \zeta w h) + f_0 h + f_1 h_1

    Parameters
    ----------
    w : float
        Angular frequency [rad/s]; may be zero (a free mass).
    zeta : float
        Damping ratio [-], not below zero.
    t : float
        Time, s.

    Returns
    -------
    tuple of float
        g [-], h [s], h1 [s2] and h2 [s3], with a relative error of about 1e-14.

    References
    ----------
    Nigam, N. C. and Jennings, P. C. (1969). Calculation of response spectra from strong-motion earthquake records.
    Bulletin of the Seismological Society of America 59.
    """
    x = w * t
    if x * (1.0 + zeta) < 0.5:
        # Power series: the closed form below loses 1/x^2 digits of the step and ramp responses.
        a, b = 2.0 * zeta * x, x * x
        previous, term = 0.0, t
        h, h1, h2 = term, term * t / 2.0, term * t * t / 6.0
        k = 0
        while True:
            following = -(a * term + b * previous * RECIPROCALS[k + 1]) * RECIPROCALS[k + 2]
            previous, term = term, following
            k += 1
            h += term
            integral = term * t * RECIPROCALS[k + 2]
            h1 += integral
            h2 += integral * t * RECIPROCALS[k + 3]
            if k > 40 or abs(term) + abs(previous) < NEGLIGIBLE * t:
                break
        return 1.0 - w * w * h1, h, h1, h2
    if zeta < 1.0:
        wd = w * math.sqrt((1.0 - zeta) * (1.0 + zeta))
        decay = math.exp(-zeta * x)
        h = decay * math.sin(wd * t) / wd
        g = decay * math.cos(wd * t) + zeta * w * h
    else:
        kappa = w * math.sqrt((zeta - 1.0) * (zeta + 1.0))
        fast = zeta * w + kappa
        slow = w * w / fast
        decay = math.exp(-slow * t)
        h = decay * (t if kappa == 0.0 else -math.expm1(-2.0 * kappa * t) / (2.0 * kappa))
        g = decay + slow * h
    h1 = (1.0 - g) / (w * w)
    h2 = (t - h - 2.0 * zeta * w * h1) / (w * w)
    return g, h, h1, h2


@inlined
def carried(
    u: float, v: float, f0: float, f1: float, w: float, zeta: float, g: float, h: float, h1: float, h2: float
) -> tuple[float, float]:
    """Return what `advance` does, over a time whose `transition` is known."""
    return u * g + v * h + f0 * h1 + f1 * h2, -u * w * w * h + v * (g - 2.0 * zeta * w * h) + f0 * h + f1 * h1


@bare
def advance(u: float, v: float, f0: float, f1: float, w: float, zeta: float, t: float) -> tuple[float, float]:
    """Return displacement and velocity of an oscillator after a time.

    Parameters
    ----------
    u, v : float
        Displacement [m] and velocity [m/s] at the beginning.
    f0, f1 : float
        Force per mass [m/s2] and its rate [m/s3].
    w, zeta, t : float
        As in `transition`.

    Returns
    -------
    tuple of float
        Displacement [m] and velocity [m/s].

    References
    ----------
    Nigam and Jennings (1969), as in `transition`.
    """
    g, h, h1, h2 = transition(w, zeta, t)
    return carried(u, v, f0, f1, w, zeta, g, h, h1, h2)


@inner
def slope(
    u: float, v: float, f0: float, f1: float, w: float, zeta: float, t: float, c1: float, cu: float, cv: float
) -> float:
    """Return the rate of y = c1 t + cu u + cv u' after a time.

    Parameters
    ----------
    u, v, f0, f1, w, zeta, t
        As in `advance`.
    c1, cu, cv : float
        What y is made of.

    Returns
    -------
    float
        In y's unit per second.
    """
    un, vn = advance(u, v, f0, f1, w, zeta, t)
    return c1 + cu * vn + cv * (f0 + f1 * t - 2.0 * zeta * w * vn - w * w * un)


@inner
def _stationary(
    u: float,
    v: float,
    f0: float,
    f1: float,
    w: float,
    zeta: float,
    c0: float,
    c1: float,
    cu: float,
    cv: float,
    low: float,
    high: float,
    at_low: float,
    at_high: float,
) -> float:
    # |y| where the rate of y = c0 + c1 t + cu u + cv u', of opposite signs at low and high, vanishes: Newton inside the
    # bracket.  A last move of 1e-5 of it, allowed for to second order, leaves 1e-15 of the value.
    near = 1e-5 * (high - low)
    t, top = trial(low, high, at_low, at_high), 0.0
    for _ in range(60):
        un, vn = advance(u, v, f0, f1, w, zeta, t)
        pull = f0 + f1 * t - 2.0 * zeta * w * vn - w * w * un
        value = c1 + cu * vn + cv * pull
        bend = cu * pull + cv * (f1 - 2.0 * zeta * w * pull - w * w * vn)
        move = -value / bend if bend != 0.0 else high - low
        top = c0 + c1 * t + cu * un + cv * vn
        if value == 0.0:
            break
        if (value > 0.0) == (at_high > 0.0):
            high = t
        else:
            low = t
        # A move out of the bracket goes to another root, such as that of a beginning at rest.
        inside = low <= t + move <= high
        if inside and abs(move) <= near:
            return abs(top + 0.5 * value * move)
        t = t + move if inside else 0.5 * (low + high)
    return abs(top)


@inner
def _turn(u: float, v: float, f0: float, f1: float, w: float, zeta: float, cu: float, cv: float, sign: float) -> float:
    # The first time at which the rate of cu u + cv u', heading for zero from this sign, turns back; -1 if it does not.
    # What vanishes there, q = cu f + cv f' with f = u'', obeys the free oscillator's equation like f: a closed form.
    b, c = w * w, 2.0 * zeta * w
    pull = f0 - c * v - b * u
    jerk = f1 - c * pull - b * v
    q, rate = cu * pull + cv * jerk, cu * jerk - cv * (c * jerk + b * pull)
    if not q * sign < 0.0:
        return -1.0
    size, back = abs(q), (rate if sign > 0.0 else -rate) - zeta * w * abs(q)
    root = w * math.sqrt(abs(1.0 - zeta) * (1.0 + zeta))
    if zeta < 1.0 and root > 0.0:
        return math.atan2(size * root, back) / root
    if back <= size * root:
        return -1.0
    return size / back if root == 0.0 else math.atanh(size * root / back) / root


@bare
def peak_inside(
    u: float,
    v: float,
    f0: float,
    f1: float,
    w: float,
    zeta: float,
    span: float,
    c0: float,
    c1: float,
    cu: float,
    cv: float,
) -> float:
    """Return the largest ``|y|`` at a stationary point of y = c0 + c1 t + cu u + cv u' strictly inside a span.

    Parameters
    ----------
    u, v, f0, f1, w, zeta
        As in `advance`.
    span : float
        Seconds, short against the period (w span < pi), so that y has at most two stationary points inside.
    c0, c1, cu, cv : float
        What y is made of.

    Returns
    -------
    float
        In y's unit; 0 where there is none.
    """
    low = 0.0
    begin = slope(u, v, f0, f1, w, zeta, 0.0, c1, cu, cv)
    if begin == 0.0:
        # A stationary beginning (a body at rest) has no sign of its own: look just behind it.
        low = 1e-6 * span
        begin = slope(u, v, f0, f1, w, zeta, low, c1, cu, cv)
    end = slope(u, v, f0, f1, w, zeta, span, c1, cu, cv)
    if begin == 0.0 and end == 0.0:
        return 0.0
    if begin * end < 0.0:
        return _stationary(u, v, f0, f1, w, zeta, c0, c1, cu, cv, low, span, begin, end)
    # Of one sign at both ends it has changed sign twice or never, and twice only around its own turning point.
    turn = _turn(u, v, f0, f1, w, zeta, cu, cv, begin)
    if not low < turn < span:
        return 0.0
    inside = slope(u, v, f0, f1, w, zeta, turn, c1, cu, cv)
    if begin * inside >= 0.0:
        return 0.0
    return max(
        _stationary(u, v, f0, f1, w, zeta, c0, c1, cu, cv, low, turn, begin, inside),
        _stationary(u, v, f0, f1, w, zeta, c0, c1, cu, cv, turn, span, inside, end),
    )
