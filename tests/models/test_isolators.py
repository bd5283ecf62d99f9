"""The isolators and what supports pass on: Coulomb decay, exact limits, equality with the oscillator."""

from __future__ import annotations

import numpy as np
import pytest
from golden import formula
from shaking import along_x, random_motion, resampled, times

from pipeline import Motion, respond, trace, transmit
from pipeline.quantities import G
from pipeline.supports import SUPPORTS


@pytest.mark.parametrize(("mu", "f"), [(0.02, 0.5), (0.1, 1.0), (0.005, 2.0)])
@pytest.mark.parametrize("directions", [1, 2])
def test_coulomb_friction_takes_the_same_off_every_half_cycle(mu: float, f: float, directions: int) -> None:
    """Each half cycle loses 2 mu g / w^2, and it stops where |u| <= mu g / w^2: textbook.

    Peaks by parabolas through samples dt apart: (w dt)^4 / 400 of the first; two directions are stepped at 1e-9.
    """
    w, dt = 2.0 * np.pi * f, 0.001
    x = np.zeros(20001)
    x[:201] = -20.0 * mu * G
    motion = along_x(x, dt)
    parameters = {"frequency": f, "damping": 0.0, "friction": mu, "directions": directions}
    u = trace("horizontal_isolator", motion, **parameters)["u_x"].to_numpy()
    size = np.abs(u)
    tops = [
        size[k] - (size[k + 1] - size[k - 1]) ** 2 / (8.0 * (size[k - 1] - 2.0 * size[k] + size[k + 1]))
        for k in range(250, size.size - 1)
        if size[k] > size[k - 1] and size[k] > size[k + 1] and size[k] > 3.1 * mu * G / w**2
    ]
    assert len(tops) >= 3
    loss = 2.0 * mu * G / w**2
    np.testing.assert_allclose(-np.diff(tops), loss, rtol=2e-3)
    if (mu, f) == (0.02, 0.5):
        assert 2.0 * loss == pytest.approx(formula("coulomb_decay", mu=0.02), rel=1e-12)
    row = respond("horizontal_isolator", motion, **parameters).iloc[0]
    assert row["residual"] <= mu * G / w**2 * (1.0 + 1e-6)
    # What is left: the first peak less as many losses as it takes to come under half of one.
    whole = np.ceil(tops[0] / loss - 0.5)
    assert row["residual"] == pytest.approx(abs(tops[0] - whole * loss), abs=2e-4 * tops[0])


def test_without_friction_it_is_an_oscillator() -> None:
    """mu = 0: the same equation by another kernel; 1e-9 in one direction, and in two the 1e-8 promised."""
    motion = random_motion(21, vertical=0.0)
    f, zeta = [0.4, 1.0, 3.0], 0.07
    plain = respond("oscillator", motion, frequency=f, damping=zeta)
    line = respond("horizontal_isolator", motion, frequency=f, damping=zeta, friction=0.0, directions=1)
    np.testing.assert_allclose(line["displacement"], plain["displacement"], rtol=1e-9)
    np.testing.assert_allclose(line["acceleration"], plain["absolute_acceleration"], rtol=1e-9)
    alone = along_x(motion.acceleration[0], motion.dt)
    plane = respond("horizontal_isolator", alone, frequency=f, damping=zeta, friction=0.0)
    np.testing.assert_allclose(plane["displacement"], plain["displacement"], rtol=1e-8)
    np.testing.assert_allclose(plane["acceleration"], plain["absolute_acceleration"], rtol=1e-8)


def test_held_by_its_friction_it_passes_everything_on() -> None:
    """mu g above A_max: nothing moves, and the acceleration passed on is the base's own, exactly."""
    motion = random_motion(22, vertical=0.0)
    peak = np.hypot(*motion.acceleration[:2]).max()
    row = respond("horizontal_isolator", motion, frequency=0.5, damping=0.02, friction=peak / G).iloc[0]
    assert row["displacement"] == 0.0
    assert row["acceleration"] == pytest.approx(peak, rel=1e-15)


def test_friction_isolator_passes_on_at_most_mu_g() -> None:
    """Slipping, it passes on exactly mu_k N; at rest at most mu_s N."""
    motion = random_motion(23, vertical=0.0)
    row = respond("friction_isolator", motion, friction_static=0.1, friction_kinetic=0.08).iloc[0]
    assert row["acceleration"] <= 0.1 * G * (1.0 + 1e-9)
    assert row["acceleration"] >= 0.08 * G * (1.0 - 1e-9)


@pytest.mark.parametrize("f", [0.3, 2.0, 30.0])
def test_rotational_isolator_of_a_point_mass_is_the_oscillator(f: float) -> None:
    """I = m h^2: theta = u / h and a + h theta'' is the absolute acceleration."""
    motion = random_motion(24)
    plain = respond("oscillator", motion, frequency=f, damping=0.1).iloc[0]
    pad = respond("rotational_isolator", motion, frequency=f, damping=0.1, cg_height=0.8, inertia_ratio=1.0).iloc[0]
    assert pad["rotation"] == pytest.approx(plain["displacement"] / 0.8, rel=1e-12)
    assert pad["acceleration"] == pytest.approx(plain["absolute_acceleration"], rel=1e-12)


def test_rotational_isolator_of_great_inertia_feels_the_jump() -> None:
    """I >> m h^2: the centre of gravity rides with the base, jumps at both ends included; 1/r = 1e-6 is left."""
    row = respond(
        "rotational_isolator", along_x([3.0, 3.0], 0.2), frequency=1.0, damping=0.05, cg_height=0.5, inertia_ratio=1e6
    ).iloc[0]
    assert row["acceleration"] == pytest.approx(3.0, rel=1e-5)
    assert row["rotation"] < 1e-5


# ---------------------------------------------------------------------------------------------------------------------
# What is passed on


def test_friction_isolator_at_rest_passes_the_input_on() -> None:
    motion = random_motion(25)
    out = transmit("friction_isolator", motion, friction_static=5.0)
    fine = resampled(motion, round(motion.dt / out.dt))
    np.testing.assert_allclose(out.acceleration, fine.acceleration, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("damping", [0.02, 0.5])
def test_stiff_plinth_passes_the_input_on(damping: float) -> None:
    """At 5 kHz: what is left is 2 zeta f_record / f, below 12 Hz / 5 kHz, and the ringing of the polygon's corners."""
    motion = random_motion(25)
    out = transmit("plinth", motion, frequency=5000.0, damping=damping)
    fine = resampled(motion, round(motion.dt / out.dt))
    n = fine.samples
    np.testing.assert_allclose(out.acceleration[:, 1:n], fine.acceleration[:, 1:], rtol=0.0, atol=0.02)


def test_the_vertical_component_goes_through_unchanged() -> None:
    motion = random_motion(25)
    for name, parameters in SETS.items():
        out = transmit(name, motion, refine=2, **parameters)
        fine = resampled(motion, 2)
        np.testing.assert_array_equal(out.acceleration[2, : fine.samples], fine.acceleration[2])
        assert not out.acceleration[2, fine.samples :].any()
        assert "passed on by" in out.steps[-1]


SETS: dict[str, dict[str, float]] = {
    "friction_isolator": {"friction_static": 0.1},
    "horizontal_isolator": {"frequency": 0.5, "damping": 0.05, "friction": 0.05},
    "rotational_isolator": {"frequency": 3.0, "damping": 0.2, "cg_height": 0.5, "inertia_ratio": 1.3},
    "plinth": {"frequency": 4.0, "damping": 0.05},
}


def test_every_support_is_tested() -> None:
    """All that have a demand of their own; the floor has none, and tests of its own."""
    assert {support.name for support in SUPPORTS if support.model is not None} == set(SETS)
    assert {support.name for support in SUPPORTS if support.model is None} == {"floor"}


@pytest.mark.parametrize("name", list(SETS))
def test_what_is_passed_on_peaks_where_the_demand_says(name: str) -> None:
    """The output's peak along x is the support's own demand, and nothing is along y; 1 % for sampling at refine 8."""
    motion = times(random_motion(26, vertical=0.0), 1.0, 0.0)
    motion = along_x(motion.acceleration[0] - motion.acceleration[0, 0], motion.dt)
    out = transmit(name, motion, refine=8, **SETS[name])
    model = next(support.model for support in SUPPORTS if support.name == name)
    assert model is not None
    row = respond(model.name, motion, **SETS[name]).iloc[0]
    want = row["absolute_acceleration" if model.name == "oscillator" else "acceleration"]
    assert np.abs(out.acceleration[0]).max() == pytest.approx(want, rel=0.01)
    assert np.abs(out.acceleration[1]).max() < 1e-9


def test_a_plinth_that_still_rings_after_the_record_passes_that_on() -> None:
    """A push of 0.05 s on a plinth of 1 Hz: nearly all of its motion comes after the record has ended.

    What stands on the plinth feels it: the output's peak must be the oscillator's largest absolute acceleration.
    """
    motion = along_x([5.0] * 6, 0.01)
    out = transmit("plinth", motion, frequency=1.0, damping=0.05)
    felt = respond("oscillator", motion, frequency=1.0, damping=0.05)["absolute_acceleration"][0]
    assert np.abs(out.acceleration[0]).max() == pytest.approx(felt, rel=0.01)


@pytest.mark.parametrize("name", ["friction_isolator", "horizontal_isolator"])
def test_a_jump_past_the_friction_limit_is_not_passed_on(name: str) -> None:
    """The record begins at 5 m/s2: the body slips at once and feels mu g = 0.98 m/s2, at the very first sample too."""
    parameters = {"friction_static": 0.1} if name == "friction_isolator" else {**SETS[name], "friction": 0.1}
    out = transmit(name, along_x([5.0] * 3, 0.01), **parameters)
    felt = respond(name, along_x([5.0] * 3, 0.01), **parameters)["acceleration"][0]
    assert np.abs(out.acceleration[0]).max() <= felt * (1.0 + 1e-9)


def test_transmit_takes_one_support_at_a_time() -> None:
    """Two frequencies cannot make one motion: an error, not silently the first of them."""
    motion = random_motion(27)
    with pytest.raises(ValueError, match="one"):
        transmit("plinth", motion, frequency=[1.0, 20.0], damping=0.05)


@pytest.mark.parametrize(
    ("support", "parameters", "message"),
    [
        ("plint", {"frequency": 1.0, "damping": 0.1}, "there is no support 'plint'.*plinth"),
        ("plinth", {"frequency": 1.0}, "plinth needs damping"),
        ("plinth", {"frequency": 1.0, "dampin": 0.1}, "did you mean 'damping'"),
        ("plinth", {"frequency": -1.0, "damping": 0.1}, "frequency must be a finite number above 0 Hz, not -1"),
        ("plinth", {"frequency": 1.0, "damping": 0.1, "refine": 0}, "refine must be at least 1, not 0"),
        ("friction_isolator", {"friction_static": np.nan}, "friction_static must be a finite number"),
    ],
)
def test_transmit_says_what_is_wrong(support: str, parameters: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        transmit(support, random_motion(27), **parameters)


def test_one_and_two_samples_pass_through() -> None:
    for n in (1, 2):
        motion = Motion(0.01, np.ones((3, n)))
        for name, parameters in SETS.items():
            assert np.isfinite(transmit(name, motion, **parameters).acceleration).all()
