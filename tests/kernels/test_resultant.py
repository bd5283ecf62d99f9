"""The longest resultant of an oscillator: against one direction at a time, closed forms, and in any company."""

import math

import numpy as np
import pytest

from pipeline.kernels.resultant import resultant_batch
from pipeline.models.oscillator import oscillate, oscillate_any
from pipeline.motions import read_motion
from pipeline.quantities import Array
from pipeline.records import Excitation, Motion
from pipeline.resources import resource


@pytest.fixture(scope="module")
def record() -> Motion:
    return read_motion(resource("site_motions", "demo"))[0]


def longest(motion: Motion, f: Array, zeta: Array, tail: float = -1.0) -> tuple[Array, Array]:
    x, y = (np.array(way) for way in motion.acceleration[:2])
    most, angle = np.empty(f.size), np.empty(f.size)
    resultant_batch(x, y, motion.dt, 2.0 * np.pi * f, zeta, tail, most, angle)
    return most, angle


def along(motion: Motion, degrees: float, f: Array, zeta: Array) -> Array:
    return oscillate(motion.excitation(degrees), 2.0 * np.pi * f, zeta, np.ones_like(f))[0]


def test_along_its_own_direction_one_run_gives_the_same(record: Motion) -> None:
    """The component of the longest resultant along itself: to rounding, from 0.02 Hz to 500 Hz, damped or not."""
    f, zeta = (one.ravel() for one in np.meshgrid([0.02, 0.3, 1.0, 7.0, 33.0, 500.0], [0.0, 0.01, 0.05, 1.0, 2.0]))
    most, angle = longest(record, f, zeta)
    for at in range(f.size):
        one = slice(at, at + 1)
        assert along(record, math.degrees(angle[at]), f[one], zeta[one])[0] == pytest.approx(most[at], rel=1e-9)


def test_no_direction_is_worse(record: Motion) -> None:
    """Every half a degree: of the worst at most 1 - cos(0.25 deg) is missed."""
    f = np.geomspace(0.2, 80.0, 48)
    zeta = np.full_like(f, 0.02)
    worst = np.max([along(record, d, f, zeta) for d in np.arange(0.0, 180.0, 0.5)], axis=0)
    most, _ = longest(record, f, zeta)
    assert (worst <= most * (1.0 + 1e-12)).all()
    assert (worst >= most * math.cos(math.radians(0.25)) * (1.0 - 1e-6)).all()


def test_shaking_in_a_circle_at_resonance_in_closed_form() -> None:
    """A / (2 zeta w^2) whatever the direction: 200 cycles leave exp(-2 pi 200 zeta) of the transient, 3e-6.

    The wave is drawn by 50 lines a cycle, whose fundamental is (pi / 50)^2 / 6 = 7e-4 below the sine's.
    """
    f, zeta, peak, dt = 4.0, 0.01, 3.0, 1.0 / 200.0
    turn = 2.0 * np.pi * f * dt * np.arange(200 * 50)
    motion = Motion(dt, [peak * np.cos(turn), peak * np.sin(turn), np.zeros_like(turn)])
    most, _ = longest(motion, np.array([f]), np.array([zeta]))
    steady = peak / (2.0 * zeta * (2.0 * np.pi * f) ** 2)
    # It comes up from rest, and never exceeds what it comes to by more than rounding and the lines' harmonics.
    assert most[0] == pytest.approx(steady, rel=1.5e-3)


def test_a_slanted_push_is_that_of_one_direction_and_the_decay_counts() -> None:
    """Two pulses at once along (3, 4): five times the answer to one; the peak comes after the record has ended."""
    pulse = np.array([0.0, 1.0, 0.0])
    motion = Motion(0.02, [3.0 * pulse, 4.0 * pulse, 0.0 * pulse])
    f, zeta = np.array([0.5, 2.0, 9.0]), np.array([0.0, 0.05, 1.5])
    most, angle = longest(motion, f, zeta)
    alone = Motion(0.02, [5.0 * pulse, 0.0 * pulse, 0.0 * pulse])
    assert most == pytest.approx(along(alone, 0.0, f, zeta), rel=1e-12)
    assert np.tan(angle) == pytest.approx([4.0 / 3.0] * 3, rel=1e-12)
    # Without the decay it is what it is when the record ends, or before.
    assert (longest(motion, f, zeta, 0.0)[0][:1] < 0.5 * most[:1]).all()


def test_each_is_found_alike_in_any_company(record: Motion) -> None:
    """To the last bit."""
    f = np.geomspace(0.5, 60.0, 37)
    zeta = np.where(np.arange(37) % 2, 0.01, 0.07)
    together = longest(record, f, zeta)
    for at in (0, 15, 16, 36):
        alone = longest(record, f[at : at + 1], zeta[at : at + 1])
        assert [alone[0][0], alone[1][0]] == [together[0][at], together[1][at]]


def test_no_shaking_gives_nothing() -> None:
    still = Motion(0.01, np.zeros((3, 40)))
    most, _ = longest(still, np.array([1.0]), np.array([0.05]))
    assert most[0] == 0.0
    one = Excitation(0.01, np.ones(1), np.ones(1), np.zeros(1), None)
    assert oscillate_any(one, np.array([6.0]), np.array([0.05]))[0] == 0.0
