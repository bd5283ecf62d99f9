"""Response spectra against solutions that share nothing with the compiled recursion."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq

from pipeline.motions.intensity import measures
from pipeline.motions.spectra import fourier_amplitude, psa, response_history, response_spectra, standard_periods
from pipeline.records import Motion


def along_x(a, dt):
    return Motion(dt, [a, np.zeros(len(a)), np.zeros(len(a))])


def rough(n, dt, seed=5):
    """Three components that start and end at zero, with most of their energy below 10 Hz."""
    rng = np.random.default_rng(seed)
    t = np.arange(n) * dt
    a = np.zeros((3, n))
    for row in range(3):
        for f in rng.uniform(0.3, 10.0, 25):
            a[row] += rng.normal() * np.sin(2 * np.pi * f * t + rng.uniform(0, 2 * np.pi))
    return Motion(dt, a * np.sin(np.pi * t / t[-1]) ** 2)


def exact_peaks(a, dt, w, zeta):
    """Peak |u| and |a + u''| over continuous time by the matrix exponential of the augmented system.

    State (u, v, -a, -a'): the forcing is part of the state, so one exponential advances everything exactly.
    """
    system = np.zeros((4, 4))
    system[0, 1] = 1.0
    system[1] = [-w * w, -2 * zeta * w, 1.0, 0.0]
    system[2, 3] = 1.0
    # y = a + u'' = -(2 zeta w v + w^2 u) and its rate, as rows acting on the state.
    as_y = np.array([-w * w, -2 * zeta * w, 0.0, 0.0])
    whole = expm(system * dt)
    state = np.zeros(4)
    peak_u = peak_y = 0.0
    pieces = [*pairwise(a)] + [(0.0, 0.0)] * int(2 * np.pi / w / dt / np.sqrt(1 - zeta**2) + 2)
    for a0, a1 in pieces:
        state[2:] = -a0, -(a1 - a0) / dt
        following = whole @ state
        for row in (np.array([1.0, 0, 0, 0]), as_y):
            rate = row @ system
            best = max(abs(row @ state), abs(row @ following))
            # w dt is below 0.6: what lies between can exceed the ends by 5 % at most.
            if (rate @ state) * (rate @ following) < 0.0 and 1.1 * best > (peak_y if row is as_y else peak_u):
                begin = state.copy()
                t = brentq(lambda s, r=rate, b=begin: r @ expm(system * s) @ b, 0.0, dt, xtol=1e-15)
                best = max(best, abs(row @ expm(system * t) @ begin))
            if row is as_y:
                peak_y = max(peak_y, best)
            else:
                peak_u = max(peak_u, best)
        state = following
    return peak_u, peak_y


@pytest.mark.parametrize(("frequency", "zeta"), [(0.1, 0.0), (1.3, 0.05), (6.0, 0.02), (9.0, 0.3)])
def test_against_matrix_exponential(frequency, zeta):
    """1e-9: both are exact for the polygon; what is left is rounding."""
    motion = rough(300, 0.01)
    u, y = exact_peaks(motion.acceleration[0], motion.dt, 2 * np.pi * frequency, zeta)
    spectrum = response_spectra(motion, [1.0 / frequency], zeta, ["x"])["x"]
    assert spectrum.displacement[0, 0] == pytest.approx(u, rel=1e-9)
    assert spectrum.absolute_acceleration[0, 0] == pytest.approx(y, rel=1e-9)


def test_stiff_oscillator_on_a_coarse_record():
    """10 Hz on 0.02 s samples: DOP853 at rtol 1e-12, restarted at each sample because the polygon has a corner there.

    Asked for 1e-6; two runs with tolerances ten times apart differ by 1e-11, so 1e-9 is what is asserted.
    """
    rng = np.random.default_rng(11)
    dt, w, zeta = 0.02, 2 * np.pi * 10.0, 0.05
    a = rng.normal(size=150)
    y = np.zeros(2)
    peak = 0.0
    pieces = [*pairwise(a)] + [(0.0, 0.0)] * 8
    for a0, a1 in pieces:

        def rate(t, y, a0=a0, a1=a1):
            return [y[1], -2 * zeta * w * y[1] - w * w * y[0] - (a0 + (a1 - a0) * t / dt)]

        def stopped(t, y):
            return y[1]

        run = solve_ivp(rate, (0, dt), y, "DOP853", rtol=1e-12, atol=1e-18, events=stopped)
        y = run.y[:, -1]
        peak = max([peak, abs(y[0]), *np.abs(run.y_events[0].reshape(-1, 2)[:, 0])])
    got = response_spectra(along_x(a, dt), [0.1], zeta, ["x"])["x"].displacement[0, 0]
    assert got == pytest.approx(peak, rel=1e-9)


@pytest.mark.parametrize("zeta", [0.0, 0.02, 0.05, 0.3])
def test_no_drift_from_0_05_to_100_hz(zeta):
    """A step held for 200 s: Sd = A/w^2 (1 + exp(-pi zeta / sqrt(1 - zeta^2))), and it stays there.

    40,000 samples; 1e-9 leaves a thousandfold margin over the rounding of as many steps.  Without damping the end of
    the step can only add to the free vibration, up to twice, so there only the history under the step is looked at.
    """
    A, dt = 2.0, 0.005
    motion = along_x(np.full(40_001, A), dt)
    frequencies = np.geomspace(0.05, 100.0, 12)
    static = A / (2 * np.pi * frequencies) ** 2
    overshoot = 1 + np.exp(-np.pi * zeta / np.sqrt(1 - zeta**2))
    if zeta > 0.01:
        got = response_spectra(motion, 1 / frequencies, zeta, ["x"])["x"]
        assert got.displacement[0] == pytest.approx(static * overshoot, rel=1e-9)
    for f, u0 in zip(frequencies[::3], static[::3], strict=True):
        u, _ = response_history(motion, 0, 1 / f, zeta)
        t = np.arange(motion.samples) * dt
        w = 2 * np.pi * f
        wd = w * np.sqrt(1 - zeta**2)
        closed = -u0 * (1 - np.exp(-zeta * w * t) * (np.cos(wd * t) + zeta * w / wd * np.sin(wd * t)))
        # The phase w t itself is only known to 1e-16 * w t, 1e-11 rad here at 100 Hz.
        assert np.abs(u - closed).max() < 1e-9 * u0


def test_limits_of_the_spectrum():
    """A rigid oscillator follows the ground (PSA -> PGA), a very soft one stays where it is (Sd -> PGD)."""
    motion = rough(2000, 0.01)
    # A motion that ends at rest where it began, so that the soft oscillator sees a bounded displacement.
    t = np.linspace(0.0, 1.0, motion.samples)
    motion = along_x(np.gradient(np.gradient(np.sin(np.pi * t) ** 4 * np.sin(40 * t), 0.01), 0.01), 0.01)
    m = measures(motion)
    stiff = response_spectra(motion, [0.001], 0.05, ["x"])["x"]
    # PSA/PGA - 1 is of the order of 2 zeta w_g/w and of the corner's (w_g/w)^2: below 1 % for w/w_g above 200.
    assert stiff.pseudo_acceleration[0, 0] == pytest.approx(m["pga_x"], rel=0.01)
    soft = response_spectra(motion, [4000.0], 0.05, ["x"])["x"]
    assert soft.displacement[0, 0] == pytest.approx(m["pgd_x"], rel=0.01)


def test_rotated_spectra_against_rotated_input():
    """Every degree run as a record of its own, exactly; the rotated histories promise 1e-4."""
    motion = rough(600, 0.01, seed=8)
    periods = np.array([0.02, 0.1, 0.4, 1.5, 8.0])
    damping = [0.0, 0.05, 0.7, 1.0]
    each = np.array(
        [
            response_spectra(along_x(motion.along(angle), motion.dt), periods, damping, ["x"])["x"].displacement
            for angle in range(180)
        ]
    )
    got = response_spectra(motion, periods, damping)
    assert got["rotd50"].displacement == pytest.approx(np.median(each, axis=0), rel=1e-4)
    # The peak of all directions lies between two whole degrees: at most 1/cos(0.5 deg) - 1 = 4e-5 above them.
    assert got["rotd100"].displacement == pytest.approx(each.max(axis=0), rel=1.4e-4)
    assert (got["rotd100"].displacement >= got["rotd50"].displacement).all()
    assert (got["rotd100"].displacement >= (1 - 1e-4) * got["x"].displacement).all()
    assert (got["rotd100"].displacement >= (1 - 1e-4) * got["y"].displacement).all()


@pytest.mark.parametrize("angle", [0.0, 30.0, 90.0, 137.0])
def test_a_single_component_seen_from_any_direction(angle):
    """Shaking along one line: RotD100 is its spectrum, and RotD50 is cos 45 degrees of it (the median of |cos|)."""
    line = rough(500, 0.01).acceleration[0]
    c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
    motion = Motion(0.01, [c * line, s * line, 0 * line])
    periods = [0.05, 0.3, 2.0]
    straight = response_spectra(along_x(line, 0.01), periods, 0.05, ["x"])["x"].displacement
    got = response_spectra(motion, periods)
    assert got["rotd100"].displacement == pytest.approx(straight, rel=1e-4)
    # Whole degrees: the median of 180 values of |cos| is within 0.01 of cos 45.
    assert got["rotd50"].displacement == pytest.approx(straight * np.cos(np.pi / 4), rel=0.013)


def test_uniform_circling_is_the_same_in_all_directions():
    """A whirling base: the steady response is a circle, so RotD50 and RotD100 differ only by the transient."""
    t = np.arange(6000) * 0.005
    # Smoothly in and out, so that no transient adds to the circle.
    taper = np.sin(0.5 * np.pi * np.minimum(1.0, np.minimum(t, t[-1] - t) / 10.0)) ** 2
    f = 2.0
    motion = Motion(0.005, [taper * np.cos(2 * np.pi * f * t), taper * np.sin(2 * np.pi * f * t), 0 * t])
    got = response_spectra(motion, [0.2], 0.2, ["rotd50", "rotd100"])
    assert got["rotd50"].displacement[0, 0] == pytest.approx(got["rotd100"].displacement[0, 0], rel=1e-3)
    w, wf, zeta = 2 * np.pi / 0.2, 2 * np.pi * f, 0.2
    steady = 1.0 / np.sqrt((w**2 - wf**2) ** 2 + (2 * zeta * w * wf) ** 2)
    # The polygon's fundamental is (sinc)^2 of the sine's: (w_f dt)^2 / 12 = 3e-4 lower.
    assert got["rotd100"].displacement[0, 0] == pytest.approx(steady, rel=1e-3)


def test_relations_and_shapes():
    motion = rough(300, 0.01)
    periods = standard_periods(20)
    got = response_spectra(motion, periods, [0.02, 0.05], ["z", "rotd50"])
    assert list(got) == ["z", "rotd50"]
    assert got["z"].displacement.shape == (2, 20)
    assert got["z"].pseudo_acceleration == pytest.approx((2 * np.pi / periods) ** 2 * got["z"].displacement, rel=1e-14)
    assert got["rotd50"].absolute_acceleration is None
    assert psa(motion, periods, 0.05, "z") == pytest.approx(got["z"].pseudo_acceleration[1], rel=1e-14)
    assert periods[0] == pytest.approx(0.01)
    assert periods[-1] == pytest.approx(20.0)


def test_silence():
    got = response_spectra(Motion(0.01, np.zeros((3, 50))), [0.1, 1.0])
    assert all((s.displacement == 0.0).all() for s in got.values())
    got = response_spectra(Motion(0.01, [[1.0], [1.0], [1.0]]), [0.1])
    assert all((s.displacement == 0.0).all() for s in got.values())


@pytest.mark.parametrize(
    ("periods", "damping", "components", "said"),
    [
        ([0.0], 0.05, ["x"], "period must be above 0"),
        ([np.nan], 0.05, ["x"], "period must be above 0"),
        ([], 0.05, ["x"], "at least one number"),
        ([1.0], -0.1, ["x"], "damping must be at least 0"),
        ([1.0], 0.05, ["east"], "component 'east'"),
    ],
)
def test_refusals(periods, damping, components, said):
    with pytest.raises(ValueError, match=said):
        response_spectra(rough(50, 0.01), periods, damping, components)


def test_fourier_amplitude_of_known_signals():
    """Parseval's sum, and a tone of whole cycles: A T / 2 at its own frequency, nothing elsewhere."""
    motion = rough(500, 0.01)
    frequency, amplitude = fourier_amplitude(motion)
    both_signs = 2 * (amplitude[0] ** 2).sum() - amplitude[0, 0] ** 2 - (amplitude[0, -1] ** 2) * (500 % 2 == 0)
    assert both_signs * (frequency[1] - frequency[0]) == pytest.approx((motion.acceleration[0] ** 2).sum() * 0.01)
    t = np.arange(1000) * 0.01
    frequency, amplitude = fourier_amplitude(along_x(3.0 * np.sin(2 * np.pi * 2.0 * t), 0.01))
    at = int(np.argmin(np.abs(frequency - 2.0)))
    assert amplitude[0, at] == pytest.approx(3.0 * 10.0 / 2)
    assert np.delete(amplitude[0], at).max() < 1e-9
