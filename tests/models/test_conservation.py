"""Energy and momentum, where the equations conserve them: what went in is what is stored, lost and handed on.

Work is integrated from the samples of a trace by the trapezoid on a step so fine that its error is named in each test.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from shaking import along_x, random_motion, resampled

from pipeline import Motion, respond, trace, transmit
from pipeline.quantities import Array, G


def velocity(u: Array, dt: float) -> Array:
    """Return u' at the samples but for the first and the last, by central differences: off by dt^2 u''' / 6."""
    return (u[2:] - u[:-2]) / (2.0 * dt)


def integral(values: Array, dt: float) -> float:
    return float(dt * (values.sum() - 0.5 * (values[0] + values[-1])))


def quiet_end(motion: Motion, samples: int) -> Motion:
    """Return the motion with so many samples of nothing after it."""
    return Motion(motion.dt, np.pad(motion.acceleration, ((0, 0), (0, samples))))


@pytest.mark.parametrize("name", ["oscillator", "horizontal_isolator"])
@pytest.mark.parametrize("f", [0.4, 2.0])
def test_without_losses_the_work_of_the_base_is_stored(name: str, f: float) -> None:
    """u'' + w^2 u = -a: the integral of -a u' is (u'^2 + w^2 u^2) / 2.

    200 samples in each of the record's: central differences and trapezoid leave (2 pi 12 Hz h)^2 / 6 = 2e-6 at most.
    """
    motion = resampled(along_x(random_motion(11).acceleration[0], 0.01), 200)
    parameters = {"frequency": f, "damping": 0.0} | ({"friction": 0.0} if name == "horizontal_isolator" else {})
    u = trace(name, motion, **parameters)["u_x"].to_numpy()
    v = velocity(u, motion.dt)
    work = integral(-motion.acceleration[0][1:-1] * v, motion.dt)
    w = 2.0 * math.pi * f
    stored = 0.5 * (v[-1] ** 2 + (w * u[-2]) ** 2)
    assert work == pytest.approx(stored, rel=2e-6)


def test_after_the_record_an_undamped_plinth_keeps_its_energy() -> None:
    """y = a + u'' = -w^2 u: y^2 + (y'/w)^2 stays; central differences at 2 kHz are off by (w h)^2 / 6 = 6e-6."""
    f, h = 2.0, 0.0005
    motion = quiet_end(along_x(random_motion(12, n=300, dt=h * 20).acceleration[0], h * 20), 100)
    y = trace("oscillator", resampled(motion, 20), frequency=f, damping=0.0)["a_x"].to_numpy()[300 * 20 :]
    energy = y[1:-1] ** 2 + (velocity(y, h) / (2.0 * math.pi * f)) ** 2
    assert np.ptp(energy) <= 2e-5 * energy.max()


@pytest.mark.parametrize("frequency", [0.0, 0.6])
@pytest.mark.parametrize("directions", [1, 2])
def test_friction_takes_mu_n_times_the_path(frequency: float, directions: int) -> None:
    """Work of the base = mu g times the path + what spring and dashpot hold or take, from rest to rest.

    100 samples in each of the record's: central differences of 12 Hz leave (2 pi f h)^2 / 6 = 1e-5 at most, and where
    the body starts and stops, a kink of u' once in a thousand samples, (h / 2)^2 u''; 1e-5.
    """
    mu, zeta = 0.08, 0.05
    plain = random_motion(13, vertical=0.0)
    shaking = plain if directions == 2 else along_x(plain.acceleration[0], plain.dt)
    motion = resampled(quiet_end(shaking, 600), 100)
    if frequency == 0.0:
        model, parameters = "sliding", {"friction_static": mu, "directions": directions}
    else:
        model = "horizontal_isolator"
        parameters = {"frequency": frequency, "damping": zeta, "friction": mu, "directions": directions}
    history = trace(model, motion, **parameters)
    u = np.vstack([history["u_x"], history.get("u_y", 0.0 * history["u_x"])])
    v = (u[:, 2:] - u[:, :-2]) / (2.0 * motion.dt)
    assert not v[:, -1].any()
    work = integral((-motion.acceleration[:2, 1:-1] * v).sum(axis=0), motion.dt)
    path = np.hypot(*np.diff(u, axis=1)).sum()
    if frequency == 0.0:
        # The path of the kernel itself, of which 12 Hz between samples leave as little.
        assert path == pytest.approx(respond(model, motion, **parameters)["path_length"][0], rel=1e-5)
    w = 2.0 * math.pi * frequency
    spring = 0.5 * w * w * float((u[:, -1] ** 2).sum())
    dashpot = 2.0 * zeta * w * integral((v * v).sum(axis=0), motion.dt)
    assert work == pytest.approx(mu * G * path + spring + dashpot, rel=1e-5)


CHAIN = {
    "friction_isolator": {"friction_static": 0.1, "friction_kinetic": 0.08},
    "horizontal_isolator": {"frequency": 0.5, "damping": 0.1, "friction": 0.03},
    "plinth": {"frequency": 3.0, "damping": 0.1},
}


@pytest.mark.parametrize("refine", [1, 4])
@pytest.mark.parametrize("name", list(CHAIN))
def test_what_is_passed_on_carries_the_momentum_of_the_ground(name: str, refine: int) -> None:
    """From rest to rest on the support, the integral of what it passes on is the ground's velocity at the end.

    Rounding of second differences, 1e-17 m / h at a thousand samples, where it comes to rest; a plinth is cut at 1e-6
    of its peak of 20 m/s2, which at 3 Hz is 1e-6 m/s.
    """
    motion = random_motion(14, vertical=0.3)
    out = transmit(name, motion, refine=refine, **CHAIN[name])
    for row in range(2):
        handed_on = integral(out.acceleration[row], out.dt)
        assert handed_on == pytest.approx(
            integral(motion.acceleration[row], motion.dt), abs=1e-6 if name == "plinth" else 1e-13
        )


@pytest.mark.parametrize("refine", [1, 4])
def test_what_is_passed_on_leaves_the_support_where_it_stopped(refine: int) -> None:
    """Twice integrated, its difference from the ground is how far the isolator was left: its offset when it rests.

    The two sharp flows at a jump move its centre by h^2 J / 6 at most; some 100 jumps of 2 m/s2 to either side.
    """
    motion = quiet_end(random_motion(15, vertical=0.0), 300)
    out = transmit("friction_isolator", motion, refine=refine, **CHAIN["friction_isolator"])
    left = respond("friction_isolator", motion, **CHAIN["friction_isolator"])["residual"][0]
    n = (motion.samples - 1) * refine + 1
    ground = resampled(motion, refine).acceleration[:2]
    apart = np.zeros((2, n))
    apart[:, : out.samples] = out.acceleration[:2, :n]
    apart -= ground
    pace = np.cumsum(0.5 * out.dt * (apart[:, 1:] + apart[:, :-1]), axis=1)
    before = np.concatenate([np.zeros((2, 1)), pace[:, :-1]], axis=1)
    moved = (out.dt * before + out.dt**2 / 6.0 * (2.0 * apart[:, :-1] + apart[:, 1:])).sum(axis=1)
    assert np.hypot(*moved) == pytest.approx(left, abs=0.1 * out.dt**2 * 100.0 * 2.0 / 6.0 + 2e-4 * left)


def test_rocking_loses_energy_at_impacts_alone() -> None:
    """Between landings phi'^2 / 2 + p^2 cos(alpha - phi) stays; over each it falls by the restitution squared.

    Samples 0.5 ms apart: central differences (p h)^2 / 6 and less, the integration 1e-6; 1e-4 of what the body has.
    """
    b, h, e = 0.1, 0.5, 0.9
    dt = 0.0005
    r, alpha = math.hypot(b, h), math.atan2(b, h)
    p2 = 0.75 * G / r
    motion = along_x(np.zeros(8001), dt)
    given = {"half_width": b, "cg_height": h, "restitution": e}
    theta = trace("rocking", motion, initial_rotation=0.6 * alpha, **given)["rotation"].to_numpy()
    rate = velocity(theta, dt)
    inner = theta[1:-1]
    # From rest on an edge: zero there, so that what it has is what it may lose.
    energy = 0.5 * rate**2 + p2 * (np.cos(alpha - np.abs(inner)) - math.cos(alpha))
    landings = np.flatnonzero(inner[:-1] * inner[1:] < 0.0)
    assert landings.size >= 4
    ends = np.concatenate([[0], landings + 1])[:5]
    levels = []
    for begin, end in zip(ends[:-1], landings[:4], strict=True):
        free = energy[begin + 3 : end - 2]
        assert np.ptp(free) <= 1e-4 * free.max()
        levels.append(float(np.median(free)))
    np.testing.assert_allclose(np.divide(levels[1:], levels[:-1]), e**2, rtol=2e-4)


def test_an_undamped_pendulum_keeps_its_energy() -> None:
    """After the record theta'^2 / 2 + (g/L)(1 - cos theta) stays; central differences at 0.5 ms: (w h)^2 / 6 = 4e-7."""
    length, n = 1.0, 400
    motion = resampled(quiet_end(along_x(random_motion(16, n=n).acceleration[0], 0.01), 600), 20)
    theta = trace("swing", motion, length=length, damping=0.0)["rotation"].to_numpy()[(n + 1) * 20 :]
    energy = 0.5 * velocity(theta, motion.dt) ** 2 + G / length * (1.0 - np.cos(theta[1:-1]))
    assert np.ptp(energy) <= 2e-6 * energy.max()
