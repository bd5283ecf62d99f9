"""The oscillator against its textbook solutions: steady state, step response, stiff and soft limits."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from shaking import along_x, base_displacement, random_motion, resampled

from pipeline import Motion, respond, trace


@pytest.mark.parametrize("ratio", [0.2, 0.5, 0.9, 1.0, 1.1, 1.5, 3.0, 8.0])
@pytest.mark.parametrize("zeta", [0.05, 0.3])
def test_steady_state_under_a_long_sine(ratio: float, zeta: float) -> None:
    """Amplitude and phase by the transmissibility, at forcing / natural frequency r.

    u = (A / w^2) / (1 - r^2 + 2 i zeta r); a + u'' = A (1 + 2 i zeta r) / (1 - r^2 + 2 i zeta r).
    The polygon through a sine has its fundamental at sinc^2(f dt) of A; its harmonics, 1/400^2 and less, are granted.
    """
    peak, f, per_cycle = 2.0, 1.0, 400
    dt = 1.0 / (f * per_cycle)
    cycles = int(20.0 / (2.0 * np.pi * zeta / ratio)) + 40
    t = np.arange(cycles * per_cycle + 1) * dt
    w = 2.0 * np.pi * f / ratio
    history = trace("oscillator", along_x(peak * np.sin(2.0 * np.pi * f * t), dt), frequency=f / ratio, damping=zeta)
    late = t > t[-1] - 10.0 / f + 0.5 * dt
    wave = np.exp(-2j * np.pi * f * t[late])
    a = peak * np.sinc(f * dt) ** 2
    stiffness = 1.0 - ratio**2 + 2j * zeta * ratio
    # A sine is the imaginary part of exp(iwt): its complex amplitude by projection is A / 2i; u'' ... = -a.
    got_u = 2j * np.mean(history["u_x"].to_numpy()[late] * wave)
    got_a = 2j * np.mean(history["a_x"].to_numpy()[late] * wave)
    assert got_u == pytest.approx(-a / w**2 / stiffness, rel=2e-5)
    assert got_a == pytest.approx(a * (1.0 + 2j * zeta * ratio) / stiffness, rel=2e-5)


def step_response(x: np.ndarray, zeta: float) -> np.ndarray:
    """Return w^2 u / A of an oscillator under a suddenly applied force, x = w t."""
    if zeta < 1.0:
        d = np.sqrt(1.0 - zeta**2)
        return np.asarray(1.0 - np.exp(-zeta * x) * (np.cos(d * x) + zeta / d * np.sin(d * x)))
    if zeta == 1.0:
        return np.asarray(1.0 - (1.0 + x) * np.exp(-x))
    k = np.sqrt(zeta**2 - 1.0)
    s1, s2 = -zeta + k, -zeta - k
    return np.asarray(1.0 + (s2 * np.exp(s1 * x) - s1 * np.exp(s2 * x)) / (s1 - s2))


@pytest.mark.parametrize("zeta", [0.0, 0.3, 0.999999, 1.0, 1.000001, 2.0, 20.0])
@pytest.mark.parametrize("dt", [0.001, 0.04])
def test_step_response(zeta: float, dt: float) -> None:
    """The four textbook branches; the recursion is exact, so only rounding over 500 steps is granted (near zeta = 1 the
    textbook form itself loses six digits, hence 1e-9)."""
    f, peak = 1.3, 3.0
    w = 2.0 * np.pi * f
    history = trace("oscillator", along_x(np.full(501, -peak), dt), frequency=f, damping=zeta)
    want = peak / w**2 * step_response(w * history["t"].to_numpy(), zeta)
    np.testing.assert_allclose(history["u_x"], want, rtol=0.0, atol=1e-9 * peak / w**2)


@pytest.mark.parametrize("zeta", [0.0, 0.05, 0.3])
def test_overshoot_of_a_step_between_the_samples(zeta: float) -> None:
    """The first peak, (A / w^2)(1 + exp(-pi zeta / sqrt(1 - zeta^2))), lies between samples 0.04 s apart."""
    f, peak = 3.7, 2.0
    row = respond("oscillator", along_x([peak] * 200, 0.04), frequency=f, damping=zeta, tail=0.0).iloc[0]
    want = peak / (2.0 * np.pi * f) ** 2 * (1.0 + np.exp(-np.pi * zeta / np.sqrt(1.0 - zeta**2)))
    assert row["displacement"] == pytest.approx(want, rel=1e-11)
    assert row["pseudo_acceleration"] == pytest.approx(want * (2.0 * np.pi * f) ** 2, rel=1e-11)


@pytest.mark.parametrize("zeta", [0.02, 1.0, 2.0])
def test_stiff_limit_feels_the_base(zeta: float) -> None:
    """f -> infinity: the absolute acceleration is A_max.  The correction is of the order of (f_record / f)^2 and
    2 zeta f_record / f, with f_record below 12 Hz of 2 kHz."""
    motion = random_motion(2)
    row = respond("oscillator", motion, frequency=2000.0, damping=zeta).iloc[0]
    peak = np.abs(motion.acceleration[0]).max()
    assert row["absolute_acceleration"] == pytest.approx(peak, rel=0.01)
    assert row["pseudo_acceleration"] == pytest.approx(peak, rel=0.05 * max(zeta, 0.2))


@pytest.mark.parametrize("zeta", [0.0, 0.05])
def test_soft_limit_stays_in_space(zeta: float) -> None:
    """f -> 0: u is minus the base's displacement; what is neglected is 2 zeta w T + (w T)^2 of it, T = 6 s."""
    motion = random_motion(2)
    f = 1e-5
    _, base = base_displacement(motion.acceleration[0], motion.dt)
    history = trace("oscillator", motion, frequency=f, damping=zeta)
    np.testing.assert_allclose(history["u_x"], -base, rtol=0.0, atol=1e-4 * np.abs(base).max())


@pytest.mark.parametrize(("first", "last"), [(1.0, -2.0), (1.0, -1.5), (-2.0, 5.0)])
def test_peak_inside_the_very_first_interval(first: float, last: float) -> None:
    """From rest under a0 + (a1 - a0) t/T the velocity returns to zero at 2 a0 T / (a0 - a1): with a slow, light spring
    the largest |u| of the record is 2 a0^3 T^2 / (3 (a0 - a1)^2) there, unless the end is further out.

    The spring is so soft (w T = 6e-4) that it changes nothing beyond 1e-6.
    """
    span = 0.1
    slope = (last - first) / span
    turn = -2.0 * first / slope
    inside = abs(first * turn**2 / 2.0 + slope * turn**3 / 6.0)
    end = abs(first * span**2 / 2.0 + slope * span**3 / 6.0)
    row = respond("oscillator", along_x([first, last], span), frequency=0.001, damping=0.0, tail=0.0).iloc[0]
    assert row["displacement"] == pytest.approx(max(inside, end), rel=1e-6)


def test_energy_is_conserved_without_damping() -> None:
    """After the excitation w^2 u^2 + v^2 is constant, so that every later peak is the same; 1e-10 over 60 periods."""
    f, dt = 2.0, 0.005
    x = np.zeros(6001)
    x[:41] = 3.0 * np.sin(2.0 * np.pi * np.arange(41) / 40.0)
    u = trace("oscillator", along_x(x, dt), frequency=f, damping=0.0)["u_x"].to_numpy()[50:]
    # One sample shift is an exact rotation: (u_i^2 + u_j^2 - 2 u_i u_j cos) / sin^2 is the squared amplitude.
    c, s = np.cos(2.0 * np.pi * f * dt), np.sin(2.0 * np.pi * f * dt)
    amplitude = (u[1:] ** 2 + u[:-1] ** 2 - 2.0 * c * u[1:] * u[:-1]) / s**2
    np.testing.assert_allclose(amplitude, amplitude[0], rtol=1e-10)


def test_a_result_does_not_depend_on_its_company() -> None:
    """Oscillators share vector registers and records; alone, reversed or among others each gives the same bits."""
    motion = random_motion(3)
    rng = np.random.default_rng(1)
    frequency, damping = np.exp(rng.uniform(-2.0, 4.5, 50)), rng.uniform(0.0, 1.5, 50)
    together = respond("oscillator", motion, frequency=frequency, damping=damping)
    back = respond("oscillator", motion, frequency=frequency[::-1], damping=damping[::-1])
    for k in (0, 17, 49):
        alone = respond("oscillator", motion, frequency=frequency[k], damping=damping[k]).iloc[0]
        for column in ("displacement", "absolute_acceleration"):
            assert alone[column] == together[column][k] == back[column][49 - k]


@pytest.mark.parametrize("n", [2, 3, 7, 130, 1201])
def test_no_peak_between_the_samples_is_missed(n: int) -> None:
    """The same polygon written 64 times finer is traced: its samples cannot exceed the peak, and miss it by at most the
    curvature's (w dt (1 + 2 zeta) / 64)^2 / 8, to which 1e-4 is added for curvature from the base alone.  One interval,
    odd lengths and several stretches; up to 200 Hz, at which an interval holds two periods and more."""
    base = random_motion(5, n=1201)
    motion = Motion(base.dt, base.acceleration[:, 300 : 300 + n] if n < 900 else base.acceleration)
    rng = np.random.default_rng(n)
    fine = resampled(motion, 64)
    for _ in range(12):
        f, zeta = float(np.exp(rng.uniform(-1.5, 5.3))), float(rng.choice([0.0, 0.05, 0.5, 1.0, 3.0]))
        row = respond("oscillator", motion, frequency=f, damping=zeta, tail=0.0).iloc[0]
        history = trace("oscillator", fine, frequency=f, damping=zeta)
        granted = (2.0 * np.pi * f * motion.dt * (1.0 + 2.0 * zeta) / 64.0) ** 2 / 8.0 + 1e-4
        for peak, column in ((row["displacement"], "u_x"), (row["absolute_acceleration"], "a_x")):
            samples = np.abs(history[column].to_numpy()[: fine.samples]).max()
            assert samples * (1.0 - 1e-9) <= peak <= samples * (1.0 + granted)


def peaks_by_fifty_digits(base: np.ndarray, dt: float, w: float, zeta: float) -> tuple[float, float]:
    """Return the largest |u| and |a + u''| of a record, every stationary point between the samples included.

    In each interval u = p0 + p1 t + exp(-zeta w t)(A cosh k t + B sinh k t / k), k^2 = w^2 (zeta^2 - 1); the rates'
    changes of sign among 200 points lead to their roots.
    """
    k = mpmath.sqrt(mpmath.mpf(zeta) ** 2 - 1) * w
    u, v = mpmath.mpf(0), mpmath.mpf(0)
    most = [mpmath.mpf(0), mpmath.mpf(0)]
    grid = [mpmath.mpf(dt) * i / 200 for i in range(201)]
    for a0, a1 in zip(map(mpmath.mpf, base[:-1]), map(mpmath.mpf, base[1:]), strict=True):
        f0, f1 = -a0, (a0 - a1) / dt
        p1 = f1 / w**2
        p0 = (f0 - 2 * zeta * w * p1) / w**2
        first = u - p0
        second = v - p1 + zeta * w * first

        def state(t, first=first, second=second, p0=p0, p1=p1, f0=f0, f1=f1):
            grow, sway = mpmath.cosh(k * t), mpmath.sinh(k * t) / k
            decay = mpmath.exp(-zeta * w * t)
            x = mpmath.re(decay * (first * grow + second * sway))
            rate = mpmath.re(decay * (second * grow + first * k * k * sway)) - zeta * w * x
            x, rate = p0 + p1 * t + x, p1 + rate
            pull = -2 * zeta * w * rate - w * w * x
            bent = f0 + f1 * t + pull
            return (x, pull), (rate, -2 * zeta * w * bent - w * w * rate)

        found = [state(t) for t in grid]
        for which in range(2):
            most[which] = max(most[which], *(abs(values[which]) for values, _ in found))
            slopes = [rates[which] for _, rates in found]
            for i in range(200):
                if slopes[i] * slopes[i + 1] < 0:
                    t = mpmath.findroot(lambda t, n=which: state(t)[1][n], (grid[i], grid[i + 1]), solver="anderson")
                    most[which] = max(most[which], abs(state(t)[0][which]))
        u, v = found[-1][0][0], found[-1][1][0]
    return float(most[0]), float(most[1])


@pytest.mark.parametrize(
    ("seed", "n", "samples_a_period", "zeta"),
    [(470, 5, 6.676751975388473, 0.02), (251, 5, 19.3, 0.02), (2444, 5, 26.9, 1.5), (70, 9, 12.96, 0.02)],
)
def test_two_extremes_inside_one_interval(seed: int, n: int, samples_a_period: float, zeta: float) -> None:
    """White noise turns an oscillator back twice between two samples, and the peak of the record lies there: to 1e-13
    of 50 digits.  Both turns in one half of the interval were overlooked: up to 3 % of the peak in these."""
    base, dt = np.random.default_rng(seed).normal(size=n), 0.01
    w = 2.0 * np.pi / (samples_a_period * dt)
    row = respond("oscillator", along_x(base, dt), frequency=w / (2.0 * np.pi), damping=zeta, tail=0.0).iloc[0]
    with mpmath.workdps(50):
        u, a = peaks_by_fifty_digits(base, dt, w, zeta)
    assert row["displacement"] == pytest.approx(u, rel=1e-13)
    assert row["absolute_acceleration"] == pytest.approx(a, rel=1e-13)


def test_no_peak_of_white_noise_is_missed() -> None:
    """19,200 oscillators of 0.7 to 60 samples a period in short white noise, against the same polygon written 16 times
    finer, whose intervals are too short to hold two extremes: 1e-11, the rounding of the finer steps."""
    rng = np.random.default_rng(1)
    for _ in range(300):
        n, m = int(rng.integers(2, 20)), 64
        motion = along_x(rng.normal(size=n), 0.01)
        frequency = 1.0 / (0.01 * np.exp(rng.uniform(np.log(0.7), np.log(60.0), m)))
        damping = rng.choice([0.0, 0.02, 0.3, 0.7, 1.0, 1.5], m)
        once, finer = (
            respond("oscillator", each, frequency=frequency, damping=damping, tail=0.0)
            for each in (motion, resampled(motion, 16))
        )
        for column in ("displacement", "absolute_acceleration"):
            np.testing.assert_allclose(once[column], finer[column], rtol=1e-11)
