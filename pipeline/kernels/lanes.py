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
