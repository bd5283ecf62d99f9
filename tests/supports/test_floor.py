"""A floor: the code's factor by hand, and the beam against its own equation, another method and known factors."""

import re

import numpy as np
import pytest
from scipy.linalg import eigh
from scipy.signal import cont2discrete, dlsim

from pipeline.analysis.response import trace
from pipeline.analysis.transmission import transmit
from pipeline.motions.synthesis import ricker
from pipeline.records import Motion
from pipeline.supports.floor import beam_modes, carried, floor_factor, floor_motion, scale_to_floor
from pipeline.supports.refining import BANK


def shaking(n=2000, seed=1):
    t = np.arange(n) * 0.01
    rng = np.random.default_rng(seed)
    return Motion(0.01, rng.normal(size=(3, n)).cumsum(axis=1) * 0.1 * np.sin(np.pi * t / t[-1]) ** 2, "shaking")


@pytest.mark.parametrize(
    ("ratio", "period", "factor"),
    [
        (0.0, 0.5, 1.0),
        (1.0, None, 3.5),
        (0.5, None, 2.25),
        # a1 = min(1/0.5, 2.5) = 2, a2 = 1 - 0.64 = 0.36: 1 + 2 + 0.36.
        (1.0, 0.5, 3.36),
        # a1 = 2.5 (5 is capped), a2 = max(0, 1 - 4) = 0.
        (1.0, 0.2, 3.5),
        # a1 = 1, a2 = 0.84: 1 + 0.5 + 0.84 / 1024.
        (0.5, 1.0, 1.5 + 0.84 / 1024),
    ],
)
def test_floor_factors_by_hand(ratio, period, factor):
    assert floor_factor(ratio, period) == pytest.approx(factor, rel=1e-12)
    motion = shaking()
    floor = scale_to_floor(motion, ratio, period)
    assert floor.acceleration[:2] == pytest.approx(factor * motion.acceleration[:2], rel=1e-12)
    assert (floor.acceleration[2] == motion.acceleration[2]).all()


def test_pure_bending_is_the_cantilever():
    """Euler-Bernoulli cantilever: 1.875104, 4.694091, 7.854757; participation times roof 1.5660, -0.8679"""
    beam = beam_modes(0.0, 3)
    assert beam.gamma == pytest.approx([1.8751040687, 4.6940911330, 7.8547574382], rel=1e-9)
    assert beam.participation[:2] == pytest.approx([1.5660, -0.8679], abs=1e-4)
    assert beam.period_ratios == pytest.approx((beam.gamma[0] / beam.gamma) ** 2, rel=1e-12)


def test_shear_limit_is_the_shear_beam():
    """alpha0 -> infinity: (2i - 1) pi/2, periods 1/3, 1/5, participation times roof 4/pi (-1)^(i+1) / (2i - 1).

    The bending left over at alpha0 = 650 is of the order of 1/alpha0 = 0.15 %.
    """
    beam = beam_modes(650.0, 4)
    odd = np.array([1.0, 3.0, 5.0, 7.0])
    assert beam.gamma == pytest.approx(odd * np.pi / 2, rel=3e-3)
    assert beam.period_ratios == pytest.approx(1 / odd, rel=3e-3)
    assert beam.participation == pytest.approx(4 / np.pi / odd * [1, -1, 1, -1], rel=5e-3)


@pytest.mark.parametrize("alpha0", [0.0, 3.0, 12.0, 200.0])
def test_modes_are_orthogonal_and_fixed_and_free(alpha0):
    """Uniform mass: the integral of phi_i phi_j vanishes; the base neither moves nor turns, the top carries no moment.

    Quadrature on 40,000 points (error 1e-7 or so near a boundary layer 1/alpha0 thick).
    """
    beam = beam_modes(alpha0, 5)
    x = (np.arange(40_000) + 0.5) / 40_000
    phi = beam.shapes(x)
    gram = phi @ phi.T / x.size
    size = np.sqrt(np.diag(gram))
    assert gram / np.outer(size, size) == pytest.approx(np.eye(5), abs=1e-5)
    assert beam.shapes(0.0) == pytest.approx(0.0, abs=1e-12)
    assert beam.shapes(1.0) == pytest.approx(1.0, rel=1e-12)
    # Neither moves nor turns: the shape starts as x^2.  The cubic term is of the order of alpha0 h = 2e-3.
    assert beam.shapes(2e-5) / beam.shapes(1e-5) == pytest.approx(4.0, rel=0.01)

    # The moment is the second difference; one step from the top it has come back by alpha0 h = 2 % at most.
    def curvature(at):
        return np.abs(beam.shapes(at + 1e-4 * np.arange(-2, 1)) @ [1.0, -2.0, 1.0])

    elsewhere = np.max([curvature(at) for at in np.linspace(0.1, 0.9, 17)], axis=0)
    assert (curvature(1.0) < 0.05 * elsewhere).all()


@pytest.mark.parametrize("alpha0", [0.0, 2.0, 8.0, 25.0])
def test_modes_against_finite_elements(alpha0):
    """Hermite beam elements with a shear spring (60 of them): frequencies and participation within 1e-4.

    Cubic elements converge with the fourth power of their length: 1e-6 for the third mode.
    """
    n, h = 60, 1 / 60
    bend = np.array([[12, 6 * h, -12, 6 * h], [6 * h, 4 * h * h, -6 * h, 2 * h * h]])
    bend = np.vstack([bend, [-12, -6 * h, 12, -6 * h], [6 * h, 2 * h * h, -6 * h, 4 * h * h]]) / h**3
    slope = np.array([[36, 3 * h, -36, 3 * h], [3 * h, 4 * h * h, -3 * h, -h * h]])
    slope = np.vstack([slope, [-36, -3 * h, 36, -3 * h], [3 * h, -h * h, -3 * h, 4 * h * h]]) / (30 * h)
    mass = np.array([[156, 22 * h, 54, -13 * h], [22 * h, 4 * h * h, 13 * h, -3 * h * h]])
    mass = np.vstack([mass, [54, 13 * h, 156, -22 * h], [-13 * h, -3 * h * h, -22 * h, 4 * h * h]]) * h / 420
    stiffness, inertia = np.zeros((2 * n + 2, 2 * n + 2)), np.zeros((2 * n + 2, 2 * n + 2))
    for i in range(n):
        at = slice(2 * i, 2 * i + 4)
        stiffness[at, at] += bend + alpha0**2 * slope
        inertia[at, at] += mass
    unit = np.zeros(2 * n + 2)
    unit[::2] = 1.0
    eigen, shapes = eigh(stiffness[2:, 2:], inertia[2:, 2:], subset_by_index=[0, 2])
    beam = beam_modes(alpha0, 3)
    assert (beam.gamma**2 * (beam.gamma**2 + alpha0**2)) == pytest.approx(eigen, rel=1e-4)
    # Participation times the roof's share does not depend on how a shape is normed.
    effect = (shapes.T @ (inertia @ unit)[2:]) * shapes[-2]
    assert beam.participation == pytest.approx(effect, rel=1e-4)


def test_all_modes_together_move_with_the_ground():
    """The sum of Gamma_i phi_i is 1 above the base: the ripple of 30 terms is a few per cent."""
    beam = beam_modes(5.0, 30)
    assert beam.participation @ beam.shapes(np.array([0.3, 0.5, 0.7])) == pytest.approx(1.0, abs=0.03)


def test_the_base_moves_as_the_ground():
    motion = shaking()
    floor = floor_motion(motion, 0.0, 0.6, damping=0.05, alpha0=5.0, modes=3, tail=0.0)
    assert floor.acceleration == pytest.approx(motion.acceleration, abs=1e-12)


def test_a_stiff_building_moves_as_the_ground():
    """A building of 1 ms under a 1 s pulse: the roof differs by (T/Tp)^2 and 2 zeta T/Tp, below 1e-3."""
    motion = ricker(2.0, 1.0, dt=0.0005)
    floor = floor_motion(motion, 1.0, 0.001, damping=0.05, alpha0=5.0, modes=3, tail=0.0)
    assert floor.acceleration == pytest.approx(motion.acceleration, abs=2e-3)


def test_resonance_of_one_mode():
    """A slow build-up of the ground at the first mode's frequency: the roof reaches |1 + Gamma phi (H - 1)| of it.

    H is the absolute-acceleration transfer function (1 + 2i zeta r) / (1 - r^2 + 2i zeta r) at r = 1.
    """
    f, zeta = 1.0, 0.1
    t = np.arange(8001) * 0.005
    ramp = np.sin(0.5 * np.pi * np.minimum(1.0, t / 25.0)) ** 2
    motion = Motion(0.005, [ramp * np.sin(2 * np.pi * f * t), 0 * t, 0 * t])
    beam = beam_modes(4.0, 1)
    roof = floor_motion(motion, 1.0, 1.0 / f, damping=zeta, alpha0=4.0, modes=1, tail=0.0)
    transfer = (1 + 2j * zeta) / (2j * zeta)
    # The last second is steady; 200 samples a cycle: chord and peak between samples below 5e-4.
    steady = abs(1 + beam.participation[0] * (transfer - 1))
    assert np.abs(roof.acceleration[0, -400:]).max() == pytest.approx(steady, rel=2e-3)


def test_free_vibration_after_the_record():
    """The tail dies by 1 % of the first mode's decay, and the floor says what was done."""
    motion = ricker(2.0, 0.8)
    floor = floor_motion(motion, 1.0, 0.8, damping=0.05, alpha0=5.0, modes=3)
    assert floor.duration == pytest.approx(motion.duration + np.log(100) * 0.8 / (2 * np.pi * 0.05), abs=0.01)
    end = np.abs(floor.acceleration[0, -200:]).max()
    at = motion.samples
    assert end < 0.02 * np.abs(floor.acceleration[0, at : at + 200]).max()
    assert "alpha0 5, period 0.8 s" in floor.steps[-1]


def test_the_floor_is_a_support_like_others():
    motion = shaking()
    by_factor = transmit("floor", motion, height_ratio=0.5, period=0.8)
    assert np.array_equal(by_factor.acceleration, scale_to_floor(motion, 0.5, 0.8).acceleration)
    modal = {"damping": 0.05, "stiffness_ratio": 5.0, "modes": 3}
    by_modes = transmit("floor", motion, height_ratio=0.5, period=0.8, **modal)
    # At least twenty corners in a period of the highest mode.
    assert by_modes.dt <= 0.8 * beam_modes(5.0, 3).period_ratios[-1] / 20
    asked = transmit("floor", motion, height_ratio=0.5, period=0.8, refine=2, **modal)
    assert np.array_equal(asked.acceleration, carried(motion, 0.5, 0.8, **modal, refine=2).acceleration)
    with pytest.raises(ValueError, match="all four"):
        transmit("floor", motion, height_ratio=0.5, damping=0.05)


def test_a_factor_is_exact_and_says_so():
    floor = transmit("floor", shaking(), height_ratio=0.5, period=0.8, error=1e-12)
    assert floor.samples == shaking().samples
    assert floor.steps[-1].endswith("vertical unchanged; exact")


def on_the_floor(motion, height_ratio, period, damping, alpha0, modes, frequency):
    """Displacement of an oscillator (5 %) on a floor at the ground's samples: modes and oscillator as one system.

    Exact for a ground that is a polygon, by scipy's first-order hold: nothing is sampled in between.
    """
    beam = beam_modes(alpha0, modes)
    w = 2 * np.pi / (period * beam.period_ratios)
    share = beam.participation * beam.shapes(height_ratio)[:, 0]
    n = 2 * modes
    a, b = np.zeros((n + 2, n + 2)), np.zeros((n + 2, 1))
    for i in range(modes):
        a[2 * i, 2 * i + 1] = 1.0
        a[2 * i + 1, 2 * i : 2 * i + 2] = -(w[i] ** 2), -2 * damping * w[i]
        b[2 * i + 1] = -1.0
        # The floor's absolute acceleration, ground + share (u'' of the mode), drives the oscillator.
        a[n + 1, 2 * i : 2 * i + 2] = share[i] * w[i] ** 2, share[i] * 2 * damping * w[i]
    w0 = 2 * np.pi * frequency
    a[n, n + 1] = 1.0
    a[n + 1, n:] = -(w0**2), -2 * 0.05 * w0
    b[n + 1] = -(1.0 - share.sum())
    c = np.zeros((1, n + 2))
    c[0, n] = 1.0
    system = cont2discrete((a, b, c, np.zeros((1, 1))), motion.dt, method="foh")
    return np.array([dlsim(system, row)[1][:, 0] for row in motion.acceleration[:2]])


@pytest.mark.parametrize("error", [1e-2, 1e-3, 1e-4])
@pytest.mark.parametrize(("period", "modes"), [(0.15, 2), (0.7, 5)])
def test_oscillators_on_a_floor_are_within_the_error(error, period, modes):
    """What an oscillator of 2 to 20 Hz does on the floor, as a share of its peak, against one exact linear system.

    The ground begins and ends at rest, so that the polygon's end adds nothing.
    """
    motion = shaking(600)
    known = {"height_ratio": 0.8, "period": period, "damping": 0.03}
    floor = transmit("floor", motion, error=error, stiffness_ratio=6.0, modes=modes, **known)
    told = float(re.search(r"20 Hz on it is within ([\d.e-]+)$", floor.steps[-1])[1])
    assert told <= error
    every = round(motion.dt / floor.dt)
    worst = 0.0
    for frequency in BANK:
        exact = on_the_floor(motion, alpha0=6.0, modes=modes, frequency=frequency, **known)
        for row, truth in enumerate(exact):
            found = trace("oscillator", floor, angle=90.0 * row, frequency=frequency, damping=0.05)["u_x"].to_numpy()
            missed = np.abs(found[: every * motion.samples : every] - truth).max()
            worst = max(worst, missed / np.abs(exact).max())
    assert 0.0 < worst <= told


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda m: floor_factor(1.2), "height_ratio must be"),
        (lambda m: floor_factor(0.5, 0.0), "period must be"),
        (lambda m: beam_modes(-1.0, 3), "alpha0 must be"),
        (lambda m: beam_modes(1.0, 0), "modes must be"),
        (lambda m: floor_motion(m, 0.5, 1.0, damping=0.0, alpha0=1.0, modes=1), "damping must be"),
        (lambda m: floor_motion(m, 0.5, 1.0, damping=0.1, alpha0=1.0, modes=1, tail=-1.0), "tail must be"),
    ],
)
def test_refusals(make, said):
    with pytest.raises(ValueError, match=said):
        make(shaking(100))
