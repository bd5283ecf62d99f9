r"""Rest of an object: the ratio of horizontal to available vertical acceleration, and stretches of proven rest.

At rest is what has

.. math::

    |a_h| - \mu_s (g + a_z) \le 0

which is convex between samples, so the samples alone decide whether a resting object stays at rest.
"""

import math

import numpy as np

from pipeline.kernels import bare, inner, kernel
from pipeline.quantities import Array, G

BLOCK = 64
"""Samples in a block of the maxima that let a resting object skip ahead."""

HAIR = 1e-9
"""Share of the square of its friction by which a body on a spring must be clear of slipping to be skipped."""


@kernel
def block_maxima(values: Array) -> Array:
    """Return the maxima of consecutive blocks of BLOCK values.

    Parameters
    ----------
    values : ndarray, shape (n,)
        In any unit.

    Returns
    -------
    ndarray
        One for each block, the last of which may be shorter.
    """
    n = values.shape[0]
    blocks = (n + BLOCK - 1) // BLOCK
    out = np.empty(blocks)
    for b in range(blocks):
        best = -math.inf
        for i in range(b * BLOCK, min(n, (b + 1) * BLOCK)):
            best = max(best, values[i])
        out[b] = best
    return out


@kernel
def largest_ratio(push: Array, z: Array, sign: float) -> float:
    r"""Return the largest push over the weight that there is, in one sense.

    .. math::

        \max_t \frac{\max(0, \pm a)}{\max(0, g + a_z)}

    Parameters
    ----------
    push : ndarray, shape (n,)
        Along one direction, or the length of two [m/s2].
    z : ndarray, shape (n,)
        Vertical acceleration [m/s2].
    sign : float
        1, or -1 for the other sense of a direction.

    Returns
    -------
    float
        [-]; infinite where the weight is lost under a push, or beside one: between two samples they meet.
    """
    n, best = push.shape[0], 0.0
    for i in range(n):
        weight, here = G + z[i], sign * push[i]
        if weight > 0.0:
            best = max(best, here / weight)
        else:
            before, after = sign * push[max(i - 1, 0)], sign * push[min(i + 1, n - 1)]
            if max(here, before, after) > 0.0:
                return math.inf
    return best


@bare
def next_above(values: Array, maxima: Array, start: int, limit: float) -> int:
    """Return the first index from a start on whose value exceeds the limit.

    Parameters
    ----------
    values : ndarray, shape (n,)
        In any unit.
    maxima : ndarray
        Their block maxima.
    start : int
        Where to begin.
    limit : float
        In the same unit.

    Returns
    -------
    int
        n where there is none.
    """
    n = values.shape[0]
    i = start
    while i < n:
        if i % BLOCK == 0 and maxima[i // BLOCK] <= limit:
            i += BLOCK
            continue
        if values[i] > limit:
            return i
        i += 1
    return n


@bare
def next_slip(x: Array, y: Array, z: Array, start: int, pull_x: float, pull_y: float, friction: float) -> int:
    """Return the first index from a start on at which a body that its spring pulls at may slip.

    Parameters
    ----------
    x, y, z : ndarray, shape (n,)
        Acceleration of the base, m/s2.
    start : int
        Where to begin.
    pull_x, pull_y : float
        Of the spring on the body at rest, m/s2.
    friction : float
        At rest.

    Returns
    -------
    int
        n where there is none; too early where only rounding could tell.
    """
    for i in range(start, x.shape[0]):
        push_x, push_y, hold = x[i] + pull_x, y[i] + pull_y, friction * (G + z[i])
        # Without weight it no longer holds on, even where nothing pushes.
        if G + z[i] <= 0.0 or push_x * push_x + push_y * push_y > (1.0 - HAIR) * hold * hold:
            return i
    return x.shape[0]


@inner
def onset(qx: float, qy: float, q1x: float, q1y: float, l0: float, l1: float, span: float) -> float:
    """Return when a push that changes linearly outgrows a hold that does; it does not at first.

    Parameters
    ----------
    qx, qy, q1x, q1y : float
        The push at first, m/s2, and its rate, m/s3.
    l0, l1 : float
        The hold at first, and its rate.
    span : float
        How long it is looked at, s.

    Returns
    -------
    float
        s; below 0 where it is not.
    """
    # |q| - l is convex, so there is at most one.
    end = math.hypot(qx + q1x * span, qy + q1y * span) - (l0 + l1 * span)
    if end <= 0.0:
        return -1.0
    a = q1x * q1x + q1y * q1y - l1 * l1
    half = qx * q1x + qy * q1y - l0 * l1
    c = min(0.0, (math.hypot(qx, qy) - l0) * (math.hypot(qx, qy) + l0))
    # a t^2 + 2 half t + c = 0 with c <= 0: the root that is not negative, without cancellation.
    root = math.sqrt(max(0.0, half * half - a * c))
    if half >= 0.0:
        return min(span, -c / (half + root)) if half + root > 0.0 else 0.0
    return min(span, max(0.0, (root - half) / a)) if a > 0.0 else 0.0


@bare
def largest(x: Array, maxima: Array, begin: int, end: int) -> float:
    """Return the largest absolute value of a stretch.

    Parameters
    ----------
    x : ndarray, shape (n,)
        In any unit.
    maxima : ndarray
        Block maxima of ``|x|``.
    begin, end : int
        From which index up to which, without the last.

    Returns
    -------
    float
        In the same unit; 0 for nothing.
    """
    best = 0.0
    i = begin
    while i < end:
        if i % BLOCK == 0 and i + BLOCK <= end:
            best = max(best, maxima[i // BLOCK])
            i += BLOCK
        else:
            best = max(best, abs(x[i]))
            i += 1
    return best
