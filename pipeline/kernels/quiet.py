r"""Rest of an object: the ratio of horizontal to available vertical acceleration, and stretches of proven rest.

At rest is what has

.. math::

    |a_h| - \mu_s (g + a_z) \le 0

which is convex between samples, so the samples alone decide whether a resting object stays at rest.
"""

import math

import numpy as np

from pipeline.kernels import bare, kernel
from pipeline.quantities import Array, G

BLOCK = 64
"""Samples in a block of the maxima that let a resting object skip ahead."""


@kernel
def demand_ratio(x: Array, y: Array, z: Array) -> Array:
    r"""Return the friction that would hold an object at each sample.

    .. math::

        \frac{|a_h|}{\max(0, g + a_z)}

    Parameters
    ----------
    x, y, z : ndarray, shape (n,)
        Acceleration of the base, m/s2.

    Returns
    -------
    ndarray, shape (n,)
        Dimensionless; infinite where contact is lost.
    """
    n = x.shape[0]
    ratio = np.empty(n)
    for i in range(n):
        normal = G + z[i]
        # Without weight an object is free: even without a push it no longer holds on.
        ratio[i] = math.hypot(x[i], y[i]) / normal if normal > 0.0 else math.inf
    return ratio


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
