"""When nothing can move: the ratio of horizontal to available vertical acceleration, and stretches of proven rest.

|a_h| - mu (g + a_z) is convex between samples, so the samples alone decide whether a resting object stays at rest.
"""

import math

import numpy as np

from pipeline.kernels import bare, kernel
from pipeline.quantities import Array, G

BLOCK = 64
"""Samples in a block of the maxima that let a resting object skip ahead."""


@kernel
def demand_ratio(x: Array, y: Array, z: Array) -> Array:
    """Return |a_h| / max(0, g + a_z) at each sample (n,): infinite where contact is lost."""
    n = x.shape[0]
    ratio = np.empty(n)
    for i in range(n):
        normal = G + z[i]
        # Without weight an object is free: even without a push it no longer holds on.
        ratio[i] = math.hypot(x[i], y[i]) / normal if normal > 0.0 else math.inf
    return ratio


@kernel
def block_maxima(values: Array) -> Array:
    """Return the maxima of consecutive blocks of BLOCK values."""
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
    """Return the first index >= start whose value exceeds the limit, or len(values)."""
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
    """Return the largest |x| from begin up to end, given the block maxima of |x|."""
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
