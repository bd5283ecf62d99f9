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
    """Return zeros (rows, LANES) of which each row begins at a register's boundary: other rows cost 1.7 times."""
    raw = np.zeros(rows * LANES + REGISTER // 8)
    skip = (-(raw.ctypes.data // 8)) % (REGISTER // 8)
    return raw[skip : skip + rows * LANES].reshape(rows, LANES)


@inner
def same_steps(pieces: Array, order: Array, begin: int) -> int:
    """Return the end of the group from begin on that shares a block: as many as fit and take equally many steps.

    Only equals share, so that a result never depends on its neighbours.
    """
    end = begin + 1
    while end < order.shape[0] and end - begin < LANES and pieces[order[end]] == pieces[order[begin]]:
        end += 1
    return end
