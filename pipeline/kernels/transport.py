"""Flux-corrected transport on a polygon: what sharpens its corners flows between neighbours, as far as circles allow.

Every corner is a vector of two that may not leave a circle of its own.  What flows from each to the next changes both,
one over the mass that each stands for, so that the sum of mass times corner stays.

References
----------
Zalesak, S. T. (1979). Fully multidimensional flux-corrected transport algorithms for fluids. Journal of Computational
Physics 31, 335-362.
"""

import math

import numpy as np

from pipeline.kernels import FIRST, inner, kernel
from pipeline.quantities import Array


@inner
def _way(start_x: float, start_y: float, step_x: float, step_y: float, limit: float) -> float:
    # How many steps lead from the start to the circle of that radius, 1 where there is no step.
    square, along = step_x * step_x + step_y * step_y, start_x * step_x + start_y * step_y
    gap = max(0.0, limit * limit - (start_x * start_x + start_y * start_y))
    root = math.sqrt(along * along + square * gap)
    # Of the two forms of the root the one without a cancellation.
    above, below = (gap, root + along) if along > 0.0 else (root - along, square)
    return above / below if below > 0.0 else 1.0


@kernel
def sharpen(corners: Array, flow: Array, limit: Array, mass: Array, rounding: float, passes: int) -> None:
    """Let flow between neighbouring corners what keeps all of them in their circles.

    Parameters
    ----------
    corners : ndarray, shape (2, m)
        Changed in place.
    flow : ndarray, shape (2, m - 1)
        What is to flow from each corner to the next; what does not flow is left in it.
    limit : ndarray, shape (m,)
        Radius of each circle, in the unit of the corners.
    mass : ndarray, shape (m,)
        What each corner stands for [-].
    rounding : float
        Share of the radius by which a corner may be beyond it.
    passes : int
        How often what is left is tried, after all has flowed that may flow whole.
    """
    m = mass.shape[0]
    free = np.ones(m - 1, dtype=np.bool_)
    trial, outside = np.empty((2, m)), np.empty(m, dtype=np.bool_)
    again = True
    while again:
        again = False
        for at in range(FIRST, m):
            came_x, came_y = 0.0, 0.0
            if at > 0 and free[at - 1]:
                came_x, came_y = flow[0, at - 1], flow[1, at - 1]
            if at < m - 1 and free[at]:
                came_x, came_y = came_x - flow[0, at], came_y - flow[1, at]
            x, y = corners[0, at] + came_x / mass[at], corners[1, at] + came_y / mass[at]
            trial[0, at], trial[1, at] = x, y
            outside[at] = math.sqrt(x * x + y * y) > limit[at] * (1.0 + rounding)
        for at in range(FIRST, m - 1):
            if free[at] and (outside[at] or outside[at + 1]):
                free[at], again = False, True
    for at in range(FIRST, m):
        corners[0, at], corners[1, at] = trial[0, at], trial[1, at]
    for at in range(FIRST, m - 1):
        if free[at]:
            flow[0, at], flow[1, at] = 0.0, 0.0
    share = np.empty(m - 1)
    for _ in range(passes):
        # A corner is the middle of what it becomes by twice the flow from either side: none may leave the circle alone.
        for at in range(FIRST, m - 1):
            share[at] = 0.0
            if not free[at]:
                x, y, after = 2.0 * flow[0, at], 2.0 * flow[1, at], at + 1
                ahead = _way(corners[0, after], corners[1, after], x / mass[after], y / mass[after], limit[after])
                back = _way(corners[0, at], corners[1, at], -x / mass[at], -y / mass[at], limit[at])
                share[at] = min(1.0, ahead, back)
        for at in range(FIRST, m - 1):
            if share[at] > 0.0:
                x, y = share[at] * flow[0, at], share[at] * flow[1, at]
                corners[0, at] -= x / mass[at]
                corners[1, at] -= y / mass[at]
                corners[0, at + 1] += x / mass[at + 1]
                corners[1, at + 1] += y / mass[at + 1]
                flow[0, at] -= x
                flow[1, at] -= y
