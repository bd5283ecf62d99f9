"""What a kernel leaves out of a record because it cannot matter, against the same record followed sample by sample.

A history is recorded at every sample, so that nothing is left out where one is asked for.
"""

import numpy as np
import pytest

from pipeline.kernels.friction_plane import friction_plane_batch
from pipeline.kernels.pendulum import pendulum_batch
from pipeline.kernels.quiet import next_slip
from pipeline.models.common import Quiet
from pipeline.motions.synthesis import band_limited_random
from pipeline.quantities import Array, G
from pipeline.records import Excitation

DT = 0.01


@pytest.fixture(scope="module")
def shaking() -> Array:
    """Noise of 0.5 to 8 Hz in three components that fades, comes back a little weaker after ten seconds, and fades."""
    rows = [band_limited_random(0.4 * G, 0.5, 8.0, 30.0, seed, dt=DT).acceleration[0] for seed in (1, 2, 3)]
    t = DT * np.arange(rows[0].size)
    bursts = np.exp(-(((t - 5.0) / 2.0) ** 2)) + 0.7 * np.exp(-(((t - 15.0) / 2.0) ** 2))
    return np.array(rows) * bursts


@pytest.mark.parametrize("factor", [1.0, 2.5])
def test_a_body_on_a_spring_that_rests_is_not_stepped_through(shaking: Array, factor: float) -> None:
    """All results agree to the last digits: where it is skipped, what is felt is the sample itself, not a sum.

    At 2.5 contact is lost: a body then slips without a push of its base.
    """
    quiet = Quiet(Excitation(DT, *(factor * shaking), None))
    numbers = np.random.default_rng(4)
    w, mu = 2.0 * np.pi * numbers.uniform(0.1, 10.0, 60), numbers.uniform(0.02, 3.0, 60)
    zeta = numbers.choice([0.0, 0.02, 0.2], 60)
    bodies = [w, zeta, mu, numbers.uniform(0.7, 1.0, 60) * mu]
    args = (quiet.x, quiet.y, quiet.z, quiet.ratio, quiet.maxima, quiet.push, quiet.pushes, quiet.dt, quiet.peak)
    skipped, followed = np.empty((60, 7)), np.empty((60, 7))
    friction_plane_batch(*args, *bodies, -1.0, 3e-10, 3e-10, 0.5, skipped, np.empty((0, 4)))
    for k in range(60):
        one = [column[k : k + 1] for column in bodies]
        history = np.zeros((quiet.x.size, 4))
        friction_plane_batch(*args, *one, -1.0, 3e-10, 3e-10, 0.5, followed[k : k + 1], history)
    np.testing.assert_allclose(skipped, followed, rtol=1e-13, atol=0.0)
    assert np.count_nonzero(skipped[:, 0]) > 30


def test_without_weight_nothing_holds() -> None:
    """Free fall without a push: no friction is left that a spring would have to outgrow."""
    still = np.zeros(5)
    falls = np.array([0.0, 0.0, 0.0, -G, 0.0])
    assert next_slip(still, still, falls, 0, 0.0, 0.0, 0.5) == 3
    assert next_slip(still, still, falls, 4, 0.49 * G, 0.0, 0.5) == 5
    assert next_slip(still, still, falls, 4, 0.51 * G, 0.0, 0.5) == 4


@pytest.mark.parametrize("refine", [1, 2])
def test_a_swing_that_cannot_get_as_far_again_is_not_followed_on(shaking: Array, refine: int) -> None:
    """Bit for bit, in any company: the energy that is left is below that of the peak by more than any rounding."""
    x, z = shaking[0], shaking[2]
    numbers = np.random.default_rng(5)
    length = np.exp(numbers.uniform(np.log(0.02), np.log(20.0), 64))
    zeta = numbers.choice([0.0, 0.02, 0.1, 1.5], 64)
    peak = float(np.hypot(x, z).max())
    ended, followed = np.empty((64, 2)), np.empty((64, 2))
    pendulum_batch(x, z, DT, peak, length, zeta, -1.0, refine, ended, np.empty((0, 1)))
    for k in range(64):
        history = np.zeros((x.size, 1))
        pendulum_batch(x, z, DT, peak, length[k : k + 1], zeta[k : k + 1], -1.0, refine, followed[k : k + 1], history)
        # The peak lies between samples; of some it comes with the second burst.
        assert np.abs(history).max() <= followed[k, 0] * (1.0 + 1e-12)
    np.testing.assert_array_equal(ended, followed)
