"""The C program that the benchmark sets beside the kernels computes the same."""

import numpy as np
import pytest

from pipeline.records import Excitation
from tests.benchmarks.common import shaking
from tests.benchmarks.native import compiled, oscillator, sliding


def test_the_c_program_gives_the_kernels_results() -> None:
    """Both are exact for the polygon: 4,000 samples leave rounding, measured 3e-14, and 1e-12 is granted."""
    with compiled() as program:
        if program is None:
            pytest.skip("there is no gcc")
        x, _, z = shaking().acceleration[:, :4000]
        motion = Excitation(shaking().dt, x, None, z, 0.0)
        for theirs, ours in (
            sliding(program, motion, np.linspace(0.05, 0.3, 32)),
            oscillator(program, motion, np.linspace(0.2, 13.0, 32)),
        ):
            np.testing.assert_allclose(theirs(), ours(), rtol=1e-12)
