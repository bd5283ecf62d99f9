"""Corners of a convex hull: the few samples of a motion at which what holds an object may be asked for most."""

import numpy as np

from pipeline.quantities import Array


def corners_of(push: Array, weight: Array) -> tuple[Array, Array]:
    """Return those samples at which some a |a_h| - b N, with a and b above 0, is largest.

    They are the corners of the upper left of the convex hull in the plane of N and |a_h|: some ten of 20,000, so that
    what holds an object costs microseconds.
    """
    order = np.lexsort((-push, weight))
    # To be larger at a greater weight it must push harder than all that weighs less.
    harder = np.concatenate([[-1.0], np.maximum.accumulate(push[order])[:-1]])
    corners: list[tuple[float, float]] = []
    for at in order[push[order] > harder]:
        x, y = float(weight[at]), float(push[at])
        while len(corners) > 1 and _below(corners[-2], corners[-1], (x, y)):
            corners.pop()
        corners.append((x, y))
    found = np.array(corners)
    return np.ascontiguousarray(found[:, 1]), np.ascontiguousarray(found[:, 0])


def _below(first: tuple[float, float], middle: tuple[float, float], last: tuple[float, float]) -> bool:
    # Whether the middle one of three points, from left to right, is not above the line through the others.
    return (middle[0] - first[0]) * (last[1] - first[1]) >= (last[0] - first[0]) * (middle[1] - first[1])
