"""The C program that the benchmark sets beside the kernels computes the same."""

import numpy as np
import pytest

from pipeline.records import Excitation
from tests.benchmarks.common import shaking, strongest
from tests.benchmarks.native import compiled, friction, oscillator, rocking, swing


def test_the_c_program_gives_the_kernels_results() -> None:
    """The same algorithm on 4,000 samples: closed forms differ by rounding, measured 3e-14, and 1e-12 is granted.

    Rocking amplifies rounding from impact to impact: measured 2e-7, and 1e-5 is granted, a tenth of its promised error.
    """
    with compiled() as program:
        if program is None:
            pytest.skip("there is no gcc")
        motion = Excitation(shaking().dt, strongest()[:4000], None, shaking().acceleration[2, :4000], 0.0)
        level = Excitation(motion.dt, motion.x, None, np.zeros(4000), 0.0)
        some = np.linspace(0.05, 0.3, 32)
        for (theirs, ours), close in (
            (friction(program, motion, some), 1e-12),
            (friction(program, motion, some, np.linspace(0.3, 3.0, 32)), 1e-12),
            (oscillator(program, level, np.linspace(0.2, 20.0, 32)), 1e-12),
            (swing(program, motion, np.linspace(1.0, 3.0, 32)), 1e-12),
            (rocking(program, motion, np.linspace(0.05, 0.3, 32), np.linspace(0.3, 1.0, 32)), 1e-5),
        ):
            np.testing.assert_allclose(theirs(), ours(), rtol=close)
