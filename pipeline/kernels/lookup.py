"""Piecewise cubic interpolation, by which a lookup in a response chart costs less than a hundred nanoseconds."""

import numpy as np

from pipeline.kernels import kernel
from pipeline.quantities import Array

POINTS = 7
"""Nodes of a cell: two cubics of four nodes each, which share the middle one."""

UNIT = POINTS - 1
"""Parts of a cell between its nodes."""

CUBIC = 4
"""Nodes of a cubic."""


@kernel
def cubic_weights(t: float, weights: Array) -> None:
    r"""Fill in the weights of the nodes 0, 1, 2, 3 of a cubic (Lagrange); at a node they are exactly 0 and 1.

    .. math::

        w_j(t) = \prod_{k \ne j} \frac{t - k}{j - k}

    Parameters
    ----------
    t : float
        Place, in steps between nodes [-].
    weights : ndarray, shape (4,)
        Receives them [-].
    """
    a, b, c = t - 1.0, t - 2.0, t - 3.0
    weights[0] = -a * b * c / 6.0
    weights[1] = 0.5 * t * b * c
    weights[2] = -0.5 * t * a * c
    weights[3] = t * a * b / 6.0


@kernel
def lookup_batch(at: Array, edges: Array, values: Array, columns: Array, cell: Array) -> None:
    """Interpolate at n points; no output is below zero.

    Parameters
    ----------
    at : ndarray, shape (n,)
        Points, between the first and the last edge, in the edges' unit.
    edges : ndarray, shape (cells + 1,)
        Rising.
    values : ndarray, shape (cells, 7, outputs)
        At nodes that divide a cell evenly, each output in its own unit.
    columns : ndarray, shape (outputs, n)
        Receives the outputs.
    cell : ndarray of int, shape (n,)
        Receives in which cell a point lies.
    """
    weights = np.empty(CUBIC)
    for i in range(at.shape[0]):
        low, high = 0, edges.shape[0] - 1
        while high - low > 1:
            middle = (low + high) // 2
            if at[i] >= edges[middle]:
                low = middle
            else:
                high = middle
        cell[i] = low
        t = (at[i] - edges[low]) * UNIT / (edges[low + 1] - edges[low])
        first = 0 if t < CUBIC - 1 else CUBIC - 1
        cubic_weights(t - first, weights)
        for output in range(values.shape[2]):
            total = 0.0
            for j in range(CUBIC):
                total += weights[j] * values[low, first + j, output]
            columns[output, i] = max(0.0, total)
