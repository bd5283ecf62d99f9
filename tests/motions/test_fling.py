"""Fling steps of known size are put into shaking with noise and tilts, and what the high-pass takes away is told."""

import re

import numpy as np
import pytest

from pipeline.motions.baseline import remove_pre_event_mean, two_segment_baseline
from pipeline.motions.corners import choose_corner
from pipeline.motions.filtering import highpass, remove_baseline
from pipeline.motions.fling import fling_step
from pipeline.motions.intensity import integrate
from pipeline.records import Motion

DT, QUIET, BEGINS = 0.01, 10.0, 14.0


def recorded(seed: int, step: float = 0.0, rise: float = 3.0, tilt: float = 0.0) -> tuple[Motion, Motion]:
    """70 s as an instrument writes them, and the ground's own motion: x has the step, y a part of it the other way.

    The ground's velocity goes by as one half-cycle, 2 step / rise at its largest.
    """
    rng = np.random.default_rng(seed)
    t = DT * np.arange(7000)
    since = np.clip(t - QUIET, 0.0, None) / 4.0
    lines = np.fft.rfft(rng.standard_normal((3, t.size)) * since * np.exp(1.0 - since), 4 * t.size, axis=1)
    f = np.fft.rfftfreq(4 * t.size, DT)
    shape = f**2 / (0.25**2 + f**2) / (1.0 + (0.12 / np.maximum(f, 1e-9)) ** 8) / np.sqrt(1.0 + (f / 12.0) ** 8)
    a = np.fft.irfft(lines * shape, axis=1)[:, : t.size]
    a *= np.array([[4.0], [5.0], [2.0]]) / np.abs(a).max(axis=1, keepdims=True)
    moving = (t >= BEGINS) & (t < BEGINS + rise)
    fling = np.where(moving, 2.0 * np.pi * step / rise**2 * np.sin(2.0 * np.pi * (t - BEGINS) / rise), 0.0)
    a += np.array([[1.0], [-0.4], [0.0]]) * fling
    level = np.array([[0.02], [-0.03], [0.01]]) + tilt * np.array([[1.0], [-0.7], [0.0]]) / (
        1 + np.exp((17.0 - t) / 0.4)
    )
    return Motion(DT, a + level + 5e-4 * rng.standard_normal(a.shape)), Motion(DT, a)


def filtered(motion: Motion) -> Motion:
    flat, _ = remove_baseline(motion.acceleration, DT)
    data, _, start = highpass(flat, DT, choose_corner(Motion(DT, flat)).frequency)
    return Motion(DT, data, start=start)


def pgv(motion: Motion) -> float:
    return float(np.abs(integrate(motion)[0][:2]).max())


@pytest.mark.parametrize("tilt", [0.0, 0.01])
@pytest.mark.parametrize(("step", "rise"), [(0.7, 3.0), (1.2, 4.0), (2.0, 5.0)])
def test_what_the_high_pass_takes_away_is_told(step, rise, tilt):
    """By truth: the PGV is more than 10 % too small after the high-pass, and within 10 % by what is told.

    What remains is a rough number, and a tilt makes it smaller.
    """
    motion, truth = recorded(3, step, rise, tilt)
    after = filtered(motion)
    assert pgv(after) < pgv(truth) / 1.1
    said = fling_step(motion, after)
    assert said is not None
    told = [0.01 * float(one) for one in re.findall(r"([\d.]+) cm", said)]
    assert told[0] == pytest.approx(pgv(truth), rel=0.1)
    assert 0.15 <= told[1] < 1.5 * step
    assert told[2] == pytest.approx(pgv(after), rel=0.005)


@pytest.mark.parametrize("tilt", [0.0, 0.005])
@pytest.mark.parametrize("seed", range(4))
def test_shaking_without_a_step_is_none(seed, tilt):
    motion, truth = recorded(seed, tilt=tilt)
    assert pgv(truth) > 0.2, "so large that a step would be told"
    assert fling_step(motion, filtered(motion)) is None


def test_without_rest_before_nothing_is_said():
    motion, _ = recorded(3, 1.2, 4.0)
    begun = Motion(DT, motion.acceleration[:, round((QUIET + 1.0) / DT) :])
    assert fling_step(begun, filtered(begun), 1.0) is None


def test_what_is_advised_keeps_the_step():
    motion, truth = recorded(3, 1.2, 4.0)
    kept = two_segment_baseline(remove_pre_event_mean(motion, QUIET))
    assert pgv(kept) == pytest.approx(pgv(truth), rel=0.03)
    assert integrate(kept)[1][0, -1] == pytest.approx(1.2, rel=0.1)


@pytest.mark.parametrize("tilt", [0.05, 0.1, 0.2])
@pytest.mark.parametrize("seed", range(2))
def test_a_sensor_that_tilted_is_told_and_no_velocity_of_its_level(seed, tilt):
    """By truth: what two segments make of it is 1.25 to 3.5 times too fast, which was told as a fling step."""
    motion, truth = recorded(seed, tilt=tilt)
    wrong = two_segment_baseline(remove_pre_event_mean(motion, QUIET))
    assert pgv(wrong) > 1.25 * pgv(truth)
    said = fling_step(motion, filtered(motion))
    assert said is not None
    assert "a sensor that tilted or was knocked" in said
    assert "cm/s" not in said
    before, after = (float(one) for one in re.findall(r"(-?[\d.]+) m/s2", said))
    assert after - before == pytest.approx(tilt, rel=0.05)


def test_an_offset_of_the_whole_record_is_no_tilt():
    motion, _ = recorded(1)
    assert fling_step(Motion(DT, motion.acceleration + 3.0), filtered(motion)) is None


def test_a_step_that_no_fault_makes_is_none():
    """A hundred times the size: 120 m, of shaking without a tilt."""
    motion, _ = recorded(3, 1.2, 4.0)
    huge = Motion(DT, 100.0 * motion.acceleration)
    assert fling_step(motion, filtered(motion)) is not None
    assert fling_step(huge, filtered(huge)) is None
