"""Objects side by side in the vector registers of the processor."""

import numpy as np

from pipeline.kernels import inner, kernel
from pipeline.quantities import Array

LANES = 16
"""Objects integrated side by side: two registers of eight numbers, so that one waits while the other is worked on."""

REGISTER = 64
"""Bytes of the widest vector register."""


@kernel
def lanes(rows: int) -> Array:
    """Return zeros of which each row begins at a register's boundary: other rows cost 1.7 times.

    Parameters
    ----------
    rows : int
        How many.

    Returns
    -------
    ndarray, shape (rows, LANES)
        Zeros.
    """
    raw = np.zeros(rows * LANES + REGISTER // 8)
    skip = (-(raw.ctypes.data // 8)) % (REGISTER // 8)
    return raw[skip : skip + rows * LANES].reshape(rows, LANES)


@inner
def in_order(pieces: Array, order: Array, spare: Array) -> None:
    """Sort objects by their steps; those of equally many stay in their order.  numba's own sort compiles for longer.

    Parameters
    ----------
    pieces : ndarray of int, shape (m,)
        Steps of each object in a sample interval.
    order : ndarray of int, shape (m,)
        Receives the objects in the order of their steps.
    spare : ndarray of int, shape (m,)
        Is written over.
    """
    m = pieces.shape[0]
    for k in range(m):
        order[k] = k
    width = 1
    while width < m:
        # Pairs of runs are merged: of equals the left one comes first.
        for begin in range(0, m, 2 * width):
            middle, end = min(begin + width, m), min(begin + 2 * width, m)
            left, right = begin, middle
            for at in range(begin, end):
                if left < middle and (right >= end or pieces[order[left]] <= pieces[order[right]]):
                    spare[at] = order[left]
                    left += 1
                else:
                    spare[at] = order[right]
                    right += 1
        for k in range(m):
            order[k] = spare[k]
        width *= 2


@inner
def same_steps(pieces: Array, order: Array, begin: int) -> int:
    """Return the end of the group from begin on that shares a block: as many as fit and take equally many steps.

    Only equals share, so that a result never depends on its neighbours.

    Parameters
    ----------
    pieces : ndarray of int, shape (m,)
        Steps of each object in a sample interval.
    order : ndarray of int, shape (m,)
        Objects in the order of their steps.
    begin : int
        Place in order of the first of the group.

    Returns
    -------
    int
        Place in order behind the last of the group.
    """
    end = begin + 1
    while end < order.shape[0] and end - begin < LANES and pieces[order[end]] == pieces[order[begin]]:
        end += 1
    return end
