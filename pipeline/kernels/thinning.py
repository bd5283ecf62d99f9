"""Simplification of a line to the points that its picture needs (Douglas and Peucker 1973): a report has hundreds."""

import math

import numpy as np

from pipeline.kernels import kernel
from pipeline.quantities import Array


@kernel
def needed(x: Array, y: Array, tolerance: float) -> Array:
    """Return which points a line must keep so that none lies farther from what is left than the tolerance.

    Parameters
    ----------
    x, y : ndarray, shape (n,)
        In the tolerance's unit; the first and the last point are kept.
    tolerance : float
        The largest distance.

    Returns
    -------
    ndarray, shape (n,)
        1 for those that it must keep, else 0.

    References
    ----------
    Douglas, D. H. and Peucker, T. K. (1973). Algorithms for the reduction of the number of points required to represent
    a digitized line or its caricature. The Canadian Cartographer 10, 112-122.
    """
    n = x.shape[0]
    keep = np.zeros(n)
    if n == 0:
        return keep
    keep[0] = keep[n - 1] = 1.0
    firsts, lasts = np.empty(n, np.int64), np.empty(n, np.int64)
    firsts[0], lasts[0] = 0, n - 1
    waiting = 1
    while waiting > 0:
        waiting -= 1
        first, last = firsts[waiting], lasts[waiting]
        dx, dy = x[last] - x[first], y[last] - y[first]
        square = dx * dx + dy * dy
        far, middle = tolerance, -1
        for i in range(first + 1, last):
            ax, ay = x[i] - x[first], y[i] - y[first]
            share = min(1.0, max(0.0, (ax * dx + ay * dy) / square)) if square > 0.0 else 0.0
            away = math.hypot(ax - share * dx, ay - share * dy)
            if away > far:
                far, middle = away, i
        if middle >= 0:
            keep[middle] = 1.0
            # Of n points no more than n - 1 stretches wait at once.
            firsts[waiting], lasts[waiting] = first, middle
            firsts[waiting + 1], lasts[waiting + 1] = middle, last
            waiting += 2
    return keep
