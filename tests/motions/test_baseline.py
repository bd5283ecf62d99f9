"""Baselines of known size are put into clean motions and have to come out again."""

import numpy as np
import pytest

from pipeline.motions.baseline import (
    polynomial_baseline,
    remove_pre_event_mean,
    resample,
    two_segment_baseline,
)
from pipeline.motions.intensity import integrate
from pipeline.motions.synthesis import ricker
from pipeline.records import Motion

DT = 0.01


def clean(n=6000, at=15.0, quiet=True):
    """Strong shaking from 10 to 20 s of 60 s in all directions; at rest before and after, no displacement left."""
    t = np.arange(n) * DT
    rows = []
    for k, period in enumerate((1.0, 0.7, 0.4)):
        u = np.where(np.abs(t - at) < 5.0, np.cos(np.pi * (t - at) / 10.0) ** 6 * np.sin(2 * np.pi * t / period), 0.0)
        # Exactly at rest: the acceleration whose trapezoid-integrated velocity is the difference of a known one.
        v = np.gradient(0.1 / (k + 1) * u, DT)
        a = np.zeros(n)
        for i in range(1, n):
            a[i] = 2 * (v[i] - v[i - 1]) / DT - a[i - 1]
        rows.append(np.gradient(v, DT) if quiet else a)
    return Motion(DT, rows, "clean", ("made by hand",))


def held(start, end, n=6000):
    """One between two times, half at both ends, so that the trapezoid sees exactly end - start."""
    t = np.round(np.arange(n) * DT / DT).astype(int)
    a, b = round(start / DT), round(end / DT)
    return np.where((t > a) & (t < b), 1.0, np.where((t == a) | (t == b), 0.5, 0.0))


def test_two_segment_offsets_are_recovered():
    """0.02 m/s2 during the shaking and 0.003 after it: both come out, to the rest that the clean motion itself has."""
    motion = clean()
    shift, after = np.array([0.02, -0.015, 0.01]), np.array([0.003, -0.002, 0.001])
    # After the shaking until the end: full weight at the last sample too.
    late = held(20.0, 59.99) + 0.5 * (np.arange(6000) == 5999)
    bent = Motion(DT, motion.acceleration + np.outer(shift, held(10.0, 20.0)) + np.outer(after, late), "bent")
    mended = two_segment_baseline(bent, 10.0, 20.0)
    v, u = integrate(mended)
    v0, u0 = integrate(motion)
    # The clean velocity ends at 1e-6 m/s or less; over the ten seconds between t1 and t2 that is 1e-7 m/s2.
    assert mended.acceleration == pytest.approx(motion.acceleration, abs=1e-6)
    assert v == pytest.approx(v0, abs=1e-5)
    assert np.abs(u[:, -1] - u0[:, -1]).max() < 1e-3 * np.abs(u0).max()
    assert len(mended.steps) == 1
    assert "two-segment baseline" in mended.steps[0]
    assert "x 0.02 m/s2 from 10 to 20 s and 0.003 m/s2 after" in mended.steps[0]


def test_two_segment_choice_ends_the_velocity_at_zero():
    """Whatever t1 and t2 are, the end of the velocity has neither level nor slope; its own peaks stay."""
    motion = clean()
    late = held(18.0, 59.99) + 0.5 * (np.arange(6000) == 5999)
    offsets = np.outer([0.01, -0.02, 0.004], held(12.0, 18.0)) + np.outer([0.002, 0.001, -0.003], late)
    mended = two_segment_baseline(Motion(DT, motion.acceleration + offsets))
    v, _ = integrate(mended)
    v0, _ = integrate(motion)
    t = np.arange(6000) * DT
    for row in range(3):
        slope, level = np.polyfit(t[2500:] - t[2500:].mean(), v[row, 2500:], 1)
        # 1 %: at the chosen t2 the motion is below 0.5 m/s2 but not yet at rest, which bends the fitted line.
        assert abs(level) < 0.01 * np.abs(v0[row]).max()
        assert abs(slope) * 35.0 < 0.01 * np.abs(v0[row]).max()
        # At the PGV the wrong t1 and t2 may leave at most the offsets' own velocity, 0.02 m/s2 over 6 s.
        assert np.abs(v[row]).max() == pytest.approx(np.abs(v0[row]).max(), abs=0.12)


def test_two_segment_keeps_a_permanent_displacement():
    """A step in displacement of 0.3 m (a fling) survives the correction of offsets at known times."""
    n = 6000
    t = np.arange(n) * DT
    v = 0.3 * np.where(np.abs(t - 15.0) < 2.0, np.cos(np.pi * (t - 15.0) / 4.0) ** 2 / 2.0, 0.0)
    fling = np.stack([np.gradient(v, DT)] * 3)
    offsets = 0.01 * held(12.0, 18.0) + 0.001 * (held(18.0, 59.99) + 0.5 * (np.arange(n) == n - 1))
    mended = two_segment_baseline(Motion(DT, fling + offsets), 12.0, 18.0)
    _, u = integrate(mended)
    assert u[:, -1] == pytest.approx(0.3, rel=1e-3)


@pytest.mark.parametrize(
    ("times", "said"),
    [
        ({"t1": 20.0, "t2": 10.0}, "in this order"),
        ({"t1": 10.0, "t2": 20.0, "fit_from": 15.0}, "in this order"),
        ({"t1": 10.0, "t2": 59.95}, "fewer than 10 samples"),
        ({"t1": 10.0, "t2": 70.0}, "in this order"),
    ],
)
def test_two_segment_refusals(times, said):
    with pytest.raises(ValueError, match=said):
        two_segment_baseline(clean(), **times)


@pytest.mark.parametrize("degree", [0, 1, 2, 4])
def test_polynomial_of_the_acceleration_is_removed(degree):
    """Exact on a polynomial: what is left is rounding."""
    t = np.linspace(-1, 1, 500)
    rows = np.stack([(k + 1) * np.polyval(np.arange(1, degree + 2), t) for k in range(3)])
    out = polynomial_baseline(Motion(DT, rows), degree)
    assert np.abs(out.acceleration).max() < 1e-11 * np.abs(rows).max()
    assert f"degree {degree}" in out.steps[-1]


def test_polynomial_of_the_velocity_is_removed():
    """A constant and a ramp in the acceleration are a quadratic in the velocity: nothing is left."""
    t = np.arange(1000) * DT
    drift = np.stack([0.02 + 0.003 * t, -0.01 + 0.001 * t, 0.005 * t])
    out = polynomial_baseline(Motion(DT, drift), 2, of="velocity")
    assert np.abs(out.acceleration).max() < 1e-12
    motion = clean()
    v, _ = integrate(polynomial_baseline(Motion(DT, motion.acceleration + 0.02), 2, of="velocity"))
    assert np.abs(v[:, 4000:]).max() < 0.05 * np.abs(v).max()


def test_pre_event_mean():
    motion = clean()
    out = remove_pre_event_mean(Motion(DT, motion.acceleration + np.array([[0.1], [0.2], [-0.3]])), 9.0)
    assert out.acceleration == pytest.approx(motion.acceleration, abs=1e-14)
    assert "x 0.1 m/s2, y 0.2 m/s2, z -0.3 m/s2" in out.steps[-1]
    with pytest.raises(ValueError, match="at least two samples before"):
        remove_pre_event_mean(motion, 0.0)


@pytest.mark.parametrize(("method", "dt"), [("fft", 0.004), ("fft", 0.02), ("lanczos", 0.004), ("lanczos", 0.0033)])
def test_resampling_keeps_a_band_limited_signal(method, dt):
    """A Ricker pulse of 1 s has nothing above 5 Hz: its values at the new times are those of the formula.

    fft: rounding of the zero-padded ends (1e-11 of the pulse).  lanczos: its window leaves 1e-4 at a tenth of Nyquist.
    """
    motion = ricker(2.0, 1.0, dt=DT)
    out = resample(motion, dt, method=method)
    x = np.pi * (np.arange(out.samples) * dt - 1.75)
    assert out.acceleration[0] == pytest.approx(
        2.0 * (1 - 2 * x * x) * np.exp(-x * x), abs=1e-9 if method == "fft" else 5e-4
    )
    assert out.dt == dt
    assert out.duration == pytest.approx(motion.duration, abs=dt)
    assert out.steps[-1] == f"resampled from 0.01 s to {dt:g} s ({method})"


def test_resampling_cuts_off_what_the_new_step_cannot_hold():
    """2 Hz and 40 Hz on 0.01 s, brought to 0.02 s: only the 2 Hz survive, away from the ends."""
    t = np.arange(2000) * DT
    taper = np.sin(np.pi * t / t[-1]) ** 2
    row = taper * (np.sin(2 * np.pi * 2 * t) + np.sin(2 * np.pi * 40 * t))
    out = resample(Motion(DT, [row, row, row]), 0.02)
    assert out.acceleration[0] == pytest.approx((taper * np.sin(2 * np.pi * 2 * t))[::2], abs=1e-6)


@pytest.mark.parametrize(
    ("dt", "method", "said"),
    [
        (0.0, "fft", "dt must be above 0"),
        (DT / np.pi, "fft", "use lanczos"),
        (0.02, "lanczos", "does not filter"),
        (0.02, "spline", "method must be"),
    ],
)
def test_resampling_refusals(dt, method, said):
    with pytest.raises(ValueError, match=said):
        resample(clean(), dt, method=method)
