"""Scaling by hand calculation."""

import numpy as np
import pytest

from pipeline.motions.spectra import psa
from pipeline.motions.suites import scale_to_spectrum, target_at
from pipeline.records import Motion


def shaking(n=2000, seed=1):
    t = np.arange(n) * 0.01
    rng = np.random.default_rng(seed)
    return Motion(0.01, rng.normal(size=(3, n)).cumsum(axis=1) * 0.1 * np.sin(np.pi * t / t[-1]) ** 2, "shaking")


def test_target_is_a_straight_line_in_log_log():
    assert target_at(np.array([0.1, 0.2, 0.4]), [0.1, 0.4], [1.0, 4.0]) == pytest.approx([1.0, 2.0, 4.0], rel=1e-12)


@pytest.mark.parametrize("measure", ["log", "linear"])
def test_scaling_to_ones_own_spectrum_gives_the_factor_back(measure):
    """The target is 2.5 times the motion's own RotD100: both kinds of least squares must say 2.5.

    1e-6: the target is read off between its own periods, which are those that are compared.
    """
    motion = shaking()
    periods = np.geomspace(0.1, 2.0, 100)
    own = psa(motion, periods, 0.05)
    scaled = scale_to_spectrum(motion, periods, 2.5 * own, (0.1, 2.0), measure=measure)
    assert scaled.acceleration[2] == pytest.approx(2.5 * motion.acceleration[2], rel=1e-6)
    assert "least squares from 0.1 to 2 s, misfit 0.00" in scaled.steps[-1]


def test_log_and_linear_least_squares_are_least():
    """Any other factor, larger or smaller by 1 %, has a larger sum of squares."""
    motion = shaking()
    target = np.array([0.05, 3.0]), np.array([4.0, 1.0])
    periods = np.geomspace(0.1, 2.0, 100)
    own, wanted = psa(motion, periods, 0.05, "x"), target_at(periods, *target)
    for measure, distance in (
        ("log", lambda k: np.sum(np.log(k * own / wanted) ** 2)),
        ("linear", lambda k: np.sum((k * own - wanted) ** 2)),
    ):
        scaled = scale_to_spectrum(motion, *target, (0.1, 2.0), component="x", measure=measure)
        k = scaled.acceleration[0, 999] / motion.acceleration[0, 999]
        assert distance(k) < min(distance(1.01 * k), distance(0.99 * k))


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda m: scale_to_spectrum(m, [0.1, 1.0], [1.0, 1.0], (0.05, 1.0)), "target spans"),
        (lambda m: scale_to_spectrum(m, [0.1, 1.0], [1.0, 1.0], (1.0, 0.1)), "period_range must be"),
        (lambda m: scale_to_spectrum(m, [0.1, 1.0], [1.0, np.nan], (0.1, 1.0)), "number above 0"),
        (lambda m: scale_to_spectrum(m, [0.1, 1.0], [1.0], (0.1, 1.0)), "one length"),
    ],
)
def test_refusals(make, said):
    with pytest.raises(ValueError, match=said):
        make(shaking(100))
