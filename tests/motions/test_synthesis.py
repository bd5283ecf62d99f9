"""The virtual shake table: closed forms of each signal, and spectra that match their targets."""

import numpy as np
import pytest

from pipeline.motions.intensity import integrate, measures
from pipeline.motions.matching import spectrum_compatible
from pipeline.motions.spectra import fourier_amplitude, psa
from pipeline.motions.synthesis import (
    band_limited_random,
    half_sine_pulse,
    mavroeidis_papageorgiou,
    rectangular_pulse,
    ricker,
    sine,
    swept_sine,
)
from pipeline.quantities import G


def test_sine():
    motion = sine(2.0, 4.0, 3.0, dt=0.001)
    assert motion.duration == pytest.approx(0.75, rel=1e-12)
    t = np.arange(motion.samples) * motion.dt
    assert motion.acceleration[0] == pytest.approx(2.0 * np.sin(2 * np.pi * 4.0 * t), abs=1e-11)
    assert not motion.acceleration[1:].any()
    assert "sine of 2 m/s2 at 4 Hz, 3 cycles" in motion.steps[0]
    # From rest, a sine that starts at zero pushes to V = 2 A / w, once each cycle; chord error (w dt)^2 / 12 = 5e-5.
    assert measures(motion)["pgv_x"] == pytest.approx(2 * 2.0 / (2 * np.pi * 4.0), rel=1e-4)


def test_ramped_sine_starts_and_ends_at_rest_in_the_chosen_direction():
    motion = sine(2.0, 4.0, 40.0, ramp=1.0, phase=90.0, direction="z")
    assert motion.acceleration[2, [0, -1]] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert np.abs(motion.acceleration[2]).max() == pytest.approx(2.0, rel=1e-3)
    assert not motion.acceleration[:2].any()


@pytest.mark.parametrize("kind", ["linear", "logarithmic"])
def test_sweep_passes_each_frequency_when_it_should(kind):
    """Zero crossings count half turns: as many as the integral of the frequency says, 1 to 20 Hz in 40 s."""
    motion = swept_sine(1.0, 1.0, 20.0, 40.0, dt=0.001, sweep=kind)
    a = motion.acceleration[0]
    t = np.arange(motion.samples) * motion.dt
    for until in (10.0, 25.0, 40.0):
        part = a[t <= until]
        crossings = np.count_nonzero(part[1:-1] * part[2:] < 0.0) + np.count_nonzero(part[1:-1] == 0.0)
        if kind == "linear":
            turns = until + 19.0 * until**2 / 80.0
        else:
            turns = 40.0 / np.log(20.0) * (20.0 ** (until / 40.0) - 1.0)
        assert crossings == pytest.approx(2 * turns, abs=1.5)


def test_random_keeps_its_band_its_size_and_its_seed():
    motion = band_limited_random(1.5, 1.0, 20.0, 60.0, 3, ramp=0.0)
    assert np.sqrt(np.mean(motion.acceleration[0] ** 2)) == pytest.approx(1.5, rel=1e-12)
    frequency = np.fft.rfftfreq(motion.samples, motion.dt)
    lines = np.abs(np.fft.rfft(motion.acceleration[0]))
    outside = (frequency < 1.0) | (frequency > 20.0)
    assert lines[outside].max() < 1e-9 * lines.max()
    # Flat: the mean square of 475 complex normal lines in each half of the band agrees within 5 standard errors.
    low = np.mean(lines[(frequency >= 1.0) & (frequency < 10.5)] ** 2)
    high = np.mean(lines[(frequency >= 10.5) & (frequency <= 20.0)] ** 2)
    assert low / high == pytest.approx(1.0, abs=5 * np.sqrt(2 / 570))
    assert band_limited_random(1.5, 1.0, 20.0, 60.0, 3, ramp=0.0).hash == motion.hash
    assert band_limited_random(1.5, 1.0, 20.0, 60.0, 4, ramp=0.0).hash != motion.hash


def test_rectangular_pulse_delivers_a_times_t():
    motion = rectangular_pulse(-3.0, 0.33, dt=0.02)
    assert motion.dt <= 0.02
    m = measures(motion)
    assert m["pgv_x"] == pytest.approx(3.0 * 0.33, rel=1e-12)
    assert m["pgd_x"] == pytest.approx(3.0 * 0.33**2 / 2, rel=1e-12)


def test_half_sine_pulse_delivers_two_over_pi():
    """V = 2 A T / pi; the trapezoid falls short by (pi dt / T)^2 / 12."""
    motion = half_sine_pulse(5.0, 0.4, dt=0.001)
    assert measures(motion)["pgv_x"] == pytest.approx(2 * 5.0 * 0.4 / np.pi, rel=2 * (np.pi * 0.001 / 0.4) ** 2 / 12)
    assert motion.acceleration[0, -1] == 0.0


@pytest.mark.parametrize("period", [0.3, 1.0, 4.0])
def test_ricker(period):
    """The spectrum peaks at 1/Tp, nothing is left at the end, and the pulse has the peak asked for."""
    for of in ("acceleration", "velocity"):
        motion = ricker(2.0, period, of=of, dt=period / 400)
        v, u = integrate(motion)
        history = motion.acceleration[0] if of == "acceleration" else v[0]
        # The derivative at the samples, integrated by the trapezoid: (w dt)^2 / 12 with w up to 3 times 2 pi / Tp.
        assert np.abs(history).max() == pytest.approx(2.0, rel=1e-3)
        lines = np.abs(np.fft.rfft(history, 2**17))
        assert np.fft.rfftfreq(2**17, motion.dt)[np.argmax(lines)] == pytest.approx(1 / period, rel=0.01)
        assert abs(v[0, -1]) < 1e-6 * np.abs(v).max()
        if of == "velocity":
            assert abs(u[0, -1]) < 1e-3 * np.abs(u).max()


@pytest.mark.parametrize("phase", [0.0, 45.0, 90.0])
@pytest.mark.parametrize("cycles", [1.2, 2.0, 3.0])
def test_mavroeidis_papageorgiou_velocity(cycles, phase):
    """Integrated, the acceleration is the published velocity; it starts and ends at zero, and peaks near A."""
    A, T, dt = 1.2, 2.0, 0.002
    motion = mavroeidis_papageorgiou(A, T, cycles, phase, dt=dt)
    v, _ = integrate(motion)
    t = np.linspace(-cycles * T / 2, cycles * T / 2, motion.samples)
    closed = A / 2 * (1 + np.cos(2 * np.pi * t / (T * cycles))) * np.cos(2 * np.pi * t / T + np.radians(phase))
    assert v[0] == pytest.approx(closed, abs=A * (np.pi * dt / T) ** 2)
    if phase == 0.0:
        assert measures(motion)["pgv_x"] == pytest.approx(A, rel=1e-4)


def plateau(t, short=1.0 * G, second=0.6 * G):
    """The shape of ASCE 7: 0.4 to 1 of the plateau, the plateau to S1/Ss, then 1/T."""
    corner = second / short
    return np.where(t < 0.2 * corner, short * (0.4 + 0.6 * t / (0.2 * corner)), np.minimum(short, second / t))


def eurocode(t, ag=0.3 * G, soil=1.15, b=0.2, c=0.6, d=2.0):
    """Type 1 on ground C of EN 1998-1:2004, 3.2.2.2."""
    fall = np.where(t < d, c / t, c * d / t**2)
    return ag * soil * np.where(t < b, 1 + t / b * 1.5, np.minimum(2.5, 2.5 * fall))


PERIODS = np.geomspace(0.02, 6.0, 300)


@pytest.mark.parametrize(("shape", "seed"), [(plateau, 0), (plateau, 4), (eurocode, 0), (eurocode, 4)])
def test_spectrum_compatible(shape, seed):
    """Within 10 % from 0.2 to 20 Hz at 5 %, at 700 frequencies other than the controlled ones."""
    motion = spectrum_compatible(PERIODS, shape(PERIODS), 20.0, seed, dt=0.01)
    check = 1.0 / np.geomspace(0.2, 20.0, 700)
    assert np.abs(psa(motion, check, 0.05, "x") / shape(check) - 1.0).max() < 0.10
    v, u = integrate(motion)
    # At rest at both ends, back where it began: what remains is rounding.
    assert motion.acceleration[0, [0, -1]] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert abs(v[0, -1]) < 1e-9 * np.abs(v).max()
    assert abs(u[0, -1]) < 1e-9 * np.abs(u).max()
    assert f"seed {seed}" in motion.steps[0]


def test_seed_decides_the_compatible_motion():
    target = eurocode(PERIODS)
    band = (1.0, 10.0)
    one, same, other = (
        spectrum_compatible(PERIODS, target, 8.0, seed, dt=0.02, band=band, tolerance=0.09) for seed in (5, 5, 6)
    )
    assert one.hash == same.hash
    assert one.hash != other.hash
    frequency, amplitude = fourier_amplitude(one)
    assert amplitude[0, frequency < 0.2].max() < 0.2 * amplitude[0].max()


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda: sine(0.0, 1.0, 1.0), "amplitude must be a number above 0"),
        (lambda: sine(1.0, 200.0, 1.0), "frequency: 200 Hz needs a time step below 0.0025"),
        (lambda: sine(1.0, 1.0, 2.0, ramp=5.0), "ramp must be from 0 to half"),
        (lambda: sine(1.0, 1.0, 1.0, direction="up"), "direction must be"),
        (lambda: sine(1.0, 1.0, 1e9), "samples"),
        (lambda: sine(1.0, 1.0, 1.0, phase=np.nan), "phase must be a finite"),
        (lambda: swept_sine(1.0, 5.0, 5.0, 1.0), "use sine"),
        (lambda: swept_sine(1.0, 1.0, 5.0, 1.0, sweep="up"), "sweep must be"),
        (lambda: band_limited_random(1.0, 5.0, 2.0, 1.0, 0), "below last"),
        (lambda: band_limited_random(1.0, 1.0, 2.0, 1.0, -1), "seed must be"),
        (lambda: band_limited_random(1.0, 1.2, 1.4, 1.0, 0), "no line"),
        (lambda: rectangular_pulse(0.0, 1.0), "peak must not be 0"),
        (lambda: half_sine_pulse(np.inf, 1.0), "peak must be a finite"),
        (lambda: ricker(1.0, 1.0, of="jerk"), "of must be"),
        (lambda: mavroeidis_papageorgiou(1.0, 1.0, 1.0), "must be above 1"),
        (lambda: spectrum_compatible([0.1, 1.0], [1.0, 1.0], 20.0, 0), "periods span"),
        (lambda: spectrum_compatible([1.0, 0.1], [1.0, 1.0], 20.0, 0), "must increase"),
        (lambda: spectrum_compatible([0.01, 9.0], [1.0, -1.0], 20.0, 0), "target: entry 1"),
        (lambda: spectrum_compatible([0.01, 9.0], [1.0], 20.0, 0), "one length"),
        (lambda: spectrum_compatible([0.01, 9.0], [1.0, 1.0], 5.0, 0), "duration must be at least 15"),
        (lambda: spectrum_compatible([0.01, 9.0], [1.0, 1.0], 20.0, 0, dt=0.02), "dt must be at most"),
        (lambda: spectrum_compatible([0.01, 9.0], [1.0, 1.0], 20.0, 0, damping=0.0), "damping must be"),
        (lambda: spectrum_compatible([0.01, 9.0], [1.0, 1.0], 20.0, 0, band=(2.0, 1.0)), "band must be"),
    ],
)
def test_refusals(make, said):
    with pytest.raises(ValueError, match=said):
        make()
