"""Measures against closed forms: the polygon through the samples is the motion, so they hold to rounding."""

import math

import numpy as np
import pytest

from pipeline.motions.intensity import integrate, measures, strong_part
from pipeline.quantities import G
from pipeline.records import Motion

# Sums of a few thousand doubles; nothing else is approximated.
ROUNDING = 1e-11


def along_x(a, dt):
    return Motion(dt, [a, np.zeros(len(a)), np.zeros(len(a))])


def test_constant_acceleration():
    """v = A t, u = A t^2 / 2, Arias = pi/(2 g) A^2 T, and D5-95 is the middle 90 % of the time."""
    A, dt, n = 3.0, 0.01, 501
    T = (n - 1) * dt
    m = measures(along_x(np.full(n, A), dt))
    assert m["pga"] == m["pga_x"] == m["pga_resultant"] == A
    assert m["pgv_x"] == pytest.approx(A * T, rel=ROUNDING)
    assert m["pgd_x"] == pytest.approx(A * T**2 / 2, rel=ROUNDING)
    assert m["arias_x"] == pytest.approx(math.pi / (2 * G) * A**2 * T, rel=ROUNDING)
    assert m["duration_5_95"] == pytest.approx(0.9 * T, rel=ROUNDING)
    assert m["pga_y"] == m["pgv_z"] == m["pgd_y"] == m["arias_z"] == 0.0


def test_ramp_through_zero_peaks_between_samples():
    """a = A (1 - 2 t/T) in one interval: the velocity peaks at T/2 with A T / 4, and is zero at both samples."""
    A, T = 2.0, 0.5
    m = measures(along_x(np.array([A, -A]), T))
    assert m["pgv_x"] == pytest.approx(A * T / 4, rel=ROUNDING)
    assert m["pgv_resultant"] == pytest.approx(A * T / 4, rel=ROUNDING)
    # The displacement grows all the way: A T^2/2 - A T^2/3.
    assert m["pgd_x"] == pytest.approx(A * T**2 / 6, rel=ROUNDING)


@pytest.mark.parametrize("cycles", [3, 40, 450])
def test_arias_intensity_of_a_sine_up_to_the_nyquist_frequency(cycles):
    """A^2 T / 2 of whole cycles, also at 0.9 of the Nyquist frequency, where the polygon holds 0.39 of it."""
    A, dt, n = 2.0, 0.01, 1000
    T = n * dt
    m = measures(along_x(A * np.sin(2 * math.pi * cycles * np.arange(n + 1) / n), dt))
    assert m["arias_x"] == pytest.approx(math.pi / (2 * G) * A**2 * T / 2, rel=ROUNDING)


def test_displacement_peaks_between_samples():
    """One interval from 1 to -k m/s2: v = t - (1 + k) t^2 / 2 is zero at t = 2/(1 + k), where u = 2 / (3 (1 + k)^2)."""
    k = 3.0
    m = measures(along_x(np.array([1.0, -k]), 1.0))
    # The other end: u(1) = 1/2 - (1 + k)/6, here -1/6, larger than the interior 1/24; take a case where it is not.
    assert m["pgd_x"] == pytest.approx(1 / 6, rel=ROUNDING)
    k = 2.0
    m = measures(along_x(np.array([1.0, -k]), 1.0))
    assert m["pgd_x"] == pytest.approx(2 / (3 * (1 + k) ** 2), rel=ROUNDING)


def test_half_sine_velocity():
    """v = V sin(pi t/T): PGA = V pi/T, PGV = V, PGD = 2 V T / pi; the polygon is off by (w dt)^2 / 12."""
    V, T, n = 0.8, 1.0, 2001
    t = np.linspace(0.0, T, n)
    dt = T / (n - 1)
    m = measures(along_x(V * math.pi / T * np.cos(math.pi * t / T), dt))
    chord = (math.pi / T * dt) ** 2 / 12
    assert m["pga_x"] == V * math.pi / T
    assert m["pgv_x"] == pytest.approx(V, rel=2 * chord)
    assert m["pgd_x"] == pytest.approx(2 * V * T / math.pi, rel=2 * chord)


def test_against_dense_resampling():
    """The same polygon with every interval cut into 64, integrated by the trapezoid, sees the same maxima.

    Sampling can only lose: up to (dt/64)^2/8 of the slope of the acceleration, below 1e-4 of these peaks.
    """
    rng = np.random.default_rng(7)
    n, dt, parts = 400, 0.02, 64
    a = np.cumsum(rng.normal(size=(3, n)), axis=1) * 0.1
    a -= a.mean(axis=1, keepdims=True)
    m = measures(Motion(dt, a))
    fine = np.arange((n - 1) * parts + 1) / parts
    b = np.stack([np.interp(fine, np.arange(n), row) for row in a])
    v = np.concatenate([np.zeros((3, 1)), np.cumsum((b[:, 1:] + b[:, :-1]) * dt / parts / 2, axis=1)], axis=1)
    u = np.concatenate([np.zeros((3, 1)), np.cumsum((v[:, 1:] + v[:, :-1]) * dt / parts / 2, axis=1)], axis=1)
    for name, history in (("pga", b), ("pgv", v), ("pgd", u)):
        for axis, row in zip("xyz", history, strict=True):
            assert m[f"{name}_{axis}"] == pytest.approx(np.abs(row).max(), rel=1e-4)
        assert m[f"{name}_resultant"] == pytest.approx(np.hypot(history[0], history[1]).max(), rel=1e-4)
        assert m[name] == max(m[f"{name}_x"], m[f"{name}_y"])
        assert m[f"{name}_resultant"] >= m[name]


def test_resultant_peaks_between_samples():
    """A velocity that turns within one interval: vx = t (1 - t), vy = 0.5 t: |v|^2 has an interior maximum."""
    m = measures(Motion(1.0, [[1.0, -1.0], [0.5, 0.5], [0.0, 0.0]]))
    s = np.linspace(0.0, 1.0, 2_000_001)
    # Sampled at 5e-7, a smooth maximum is missed by 1e-13.
    assert m["pgv_resultant"] == pytest.approx(np.sqrt((s - s * s) ** 2 + (0.5 * s) ** 2).max(), abs=1e-12)


def test_measures_scale_with_the_motion():
    rng = np.random.default_rng(3)
    motion = Motion(0.01, rng.normal(size=(3, 500)))
    once, twice = measures(motion), measures(motion.scaled(2.0, "test"))
    for key, value in once.items():
        power = {"arias": 4.0, "durat": 1.0}.get(key[:5], 2.0)
        assert twice[key] == pytest.approx(power * value, rel=ROUNDING)


@pytest.mark.parametrize("samples", [1, 2, 50])
def test_silence(samples):
    m = measures(Motion(0.01, np.zeros((3, samples))))
    assert set(m.values()) == {0.0}
    assert strong_part(Motion(0.01, np.zeros((3, samples)))) == (0.0, 0.0)


def test_velocity_is_at_rest_after_a_whole_cycle():
    """A symmetric zig-zag of zero mean leaves no velocity: conserved to rounding."""
    v, _ = integrate(along_x(np.array([0.0, 1.0, 0.0, -1.0, 0.0]), 0.1))
    assert v[0, -1] == pytest.approx(0.0, abs=1e-15)
    assert v[0, 2] == pytest.approx(0.1, rel=ROUNDING)
