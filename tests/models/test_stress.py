"""Stress by hand, and the paper's tilt test."""

from __future__ import annotations

import math

import numpy as np
import pytest
from shaking import along_x, random_motion

from pipeline import respond
from pipeline.quantities import G

SECTION = {"mass": 10.0, "lever": 0.3, "area": 1e-3, "section_modulus": 1e-5}


def test_stress_by_hand() -> None:
    """m = 10 kg at 0.5 g: F = 49.03325 N, M = 14.709975 Nm; M/S = 1.4709975 MPa, N/A = 0.0980665 MPa; rounding only."""
    row = respond("stress", along_x([0.1, -0.5 * G, 0.2], 0.01), **SECTION).iloc[0]
    assert row["tension"] == pytest.approx(1.4709975e6 - 98066.5, rel=1e-12)
    assert row["compression"] == pytest.approx(1.4709975e6 + 98066.5, rel=1e-12)
    assert row["shear"] == pytest.approx(49033.25, rel=1e-12)
    assert row["tilt"] == pytest.approx(30.0, rel=1e-12)


def test_what_is_hollow_is_as_strong_for_its_weight_as_what_is_solid() -> None:
    """Below the solid mass of 10 kg the stresses are those of 10 kg; above it those of the mass itself.

    On the safe side: a tube of the same outline with a share s of the metal has s (2 - s) of the modulus, so that its
    bending stress is 1 / (2 - s) of the solid's, between one half and one.
    """
    motion = along_x([0.1, -0.5 * G, 0.2], 0.01)
    masses = np.array([0.1, 1.0, 10.0, 20.0])
    found = respond("stress", motion, **{**SECTION, "mass": masses}, solid_mass=10.0)
    plain = respond("stress", motion, **{**SECTION, "mass": np.maximum(masses, 10.0)})
    for column in ("tension", "compression", "shear"):
        np.testing.assert_array_equal(found[column], plain[column])
    share = masses[:3] / 10.0
    tube = 10.0 * share * 0.5 * G * 0.3 / (1e-5 * share * (2.0 - share))
    bending = found["tension"].to_numpy()[:3] + 98066.5
    assert np.all((0.5 * bending <= tube) & (tube <= bending * (1.0 + 1e-12)))


def test_solid_round_ankle_by_hand() -> None:
    """A round section of 8 cm: A = pi d^2/4, S = pi d^3/32; 55 kg, 40 cm above it, 0.7 g.

    sigma = 32 m a l / (pi d^3) - 4 m g / (pi d^2) = 2.897 MPa by a pocket calculator (three digits).
    """
    d = 0.08
    row = respond(
        "stress",
        along_x([0.7 * G] * 2, 0.01),
        mass=55.0,
        lever=0.4,
        area=math.pi * d**2 / 4.0,
        section_modulus=math.pi * d**3 / 32.0,
    ).iloc[0]
    assert row["tension"] == pytest.approx(151.0224 / 5.026548e-5 - 539.366 / 5.026548e-3, rel=1e-5)


def test_tilt_at_the_papers_acceleration() -> None:
    """0.7 g is a tilt of arcsin 0.7 = 44.427 degrees (the paper rounds it to 45)."""
    row = respond("stress", along_x([0.7 * G] * 2, 0.01), **SECTION).iloc[0]
    assert row["tilt"] == pytest.approx(44.427004, abs=5e-7)


@pytest.mark.parametrize("share", [1.0, 1.0001, 5.0])
def test_no_tilt_at_1_g_and_above(share: float) -> None:
    row = respond("stress", along_x([share * G] * 2, 0.01), **SECTION).iloc[0]
    assert np.isnan(row["tilt"])
    assert row["note"] == "no tilt reproduces an acceleration of 1 g or more"
    assert np.isfinite(row["tension"])


def test_amplification_multiplies_the_acceleration() -> None:
    plain = respond("stress", along_x([0.6] * 2, 0.01), **SECTION).iloc[0]
    double = respond("stress", along_x([0.3] * 2, 0.01), amplification=2.0, **SECTION).iloc[0]
    for column in ("tension", "compression", "shear", "tilt"):
        assert double[column] == plain[column]


def test_flexible_stress_is_the_rigid_one_at_the_pseudo_acceleration() -> None:
    """The oscillator's w^2 Sd takes A_max's place, exactly."""
    motion = random_motion(5)
    flexible = respond("flexible_stress", motion, frequency=[1.0, 7.0], damping=0.03, **SECTION)
    plain = respond("oscillator", motion, frequency=[1.0, 7.0], damping=0.03)
    np.testing.assert_allclose(flexible["pseudo_acceleration"], plain["pseudo_acceleration"], rtol=1e-13)
    for push, tension in zip(plain["pseudo_acceleration"], flexible["tension"], strict=True):
        assert tension == pytest.approx(10.0 * push * 0.3 / 1e-5 - 98066.5, rel=1e-12)


def test_flexible_stress_of_a_stiff_section_is_the_rigid_one() -> None:
    """At 2 kHz the pseudo-acceleration is A_max within (12 Hz / 2 kHz) of it: 1 % of the bending."""
    motion = random_motion(5)
    rigid = respond("stress", motion, **SECTION).iloc[0]
    stiff = respond("flexible_stress", motion, frequency=2000.0, damping=0.02, **SECTION).iloc[0]
    assert stiff["compression"] == pytest.approx(rigid["compression"], rel=0.01)


def test_error_does_not_vanish_where_bending_and_weight_cancel() -> None:
    """Tension is a difference: its rounding error is a share of the bending, however small the difference is."""
    motion = random_motion(5)
    lever = 0.3
    bending = respond("flexible_stress", motion, frequency=3.0, damping=0.02, **SECTION).iloc[0]["tension"] + 98066.5
    # Choose the lever at which bending equals the weight's pressure.
    section = {**SECTION, "lever": lever * 98066.5 / bending}
    row = respond("flexible_stress", motion, frequency=3.0, damping=0.02, **section).iloc[0]
    assert abs(row["tension"]) < 1e-6 * 98066.5
    assert row["error"] > 1e-14 * 98066.5
