"""Objects are put side by side in the order of their steps, as numpy's own stable sort has it."""

from __future__ import annotations

import numpy as np
import pytest

from pipeline.kernels.lanes import in_order


@pytest.mark.parametrize("size", [0, 1, 2, 3, 7, 16, 100, 513])
@pytest.mark.parametrize("most", [1, 3, 10_000])
def test_equals_stay_in_their_order(size: int, most: int) -> None:
    pieces = np.random.default_rng(size).integers(0, most, size)
    order = np.full(size, -1)
    in_order.py_func(pieces, order, np.empty_like(order))
    assert order.tolist() == np.argsort(pieces, kind="stable").tolist()
