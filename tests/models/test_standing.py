"""Standing bodies: against another integration, their limits rocking and sliding, closed forms, energy, symmetry."""

from __future__ import annotations

import json
import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
import standing_truth
from hypothesis import given, settings
from hypothesis import strategies as st
from shaking import along_x, random_motion, resampled, times

from pipeline import Motion, respond, trace
from pipeline.analysis.model_runs import prepare
from pipeline.kernels import corner_impact
from pipeline.models import model_named
from pipeline.models.standing import required, standing_bodies, tilt_ratios
from pipeline.motions import read_motion
from pipeline.quantities import Array, G
from pipeline.resources import resource
from tests.soak import examples

CASES: list[dict[str, Any]] = json.loads(standing_truth.FILE.read_text(encoding="utf-8"))
GIVEN = (
    "half_width",
    "half_width_other",
    "cg_height",
    "friction_static",
    "friction_kinetic",
    "restitution_factor",
)
BLOCK = {"half_width": 0.1, "cg_height": 0.4}

# Only kernels call these two: as machine code they have no entry for Python.
impulse = getattr(corner_impact.impulse, "py_func", corner_impact.impulse)
held = getattr(corner_impact.held, "py_func", corner_impact.held)


def record() -> Motion:
    """Return the strongest 12 s of the demonstration's record, with its vertical component."""
    whole = read_motion(resource("site_motions", "demo"))[0]
    strongest = int(np.argmax(np.hypot(whole.acceleration[0], whole.acceleration[1])))
    begin = max(0, strongest - round(4.0 / whole.dt))
    return Motion(whole.dt, whole.acceleration[:, begin : begin + round(12.0 / whole.dt)])


def blocks(n: int, seed: int = 3) -> dict[str, Array]:
    """Return n bodies from squat to slender."""
    rng = np.random.default_rng(seed)
    height = np.exp(rng.uniform(np.log(0.05), np.log(1.0), n))
    return {"half_width": height * rng.uniform(0.1, 0.6, n), "cg_height": height}


@pytest.mark.parametrize("case", CASES, ids=lambda case: str(case["name"]))
def test_another_integration_is_met(case: dict[str, Any]) -> None:
    """Cartesian coordinates, forces by a linear system, DOP853 at 1e-12 (tests/data/golden/README.md says more).

    `reference` to 1e-8 times the condition, `history` within its own error; every outcome and every landing.
    """
    motion = Motion(case["dt"], np.vstack([case["x"], np.zeros(len(case["x"])), case["z"]]))
    body = {name: case[name] for name in GIVEN}
    for fidelity in ("history", "reference"):
        row = respond("standing", motion, fidelity=fidelity, tail=case["tail"], **body).iloc[0]
        assert bool(row["overturned"]) == case["overturned"]
        assert row["impacts"] == case["impacts"]
        for name in ("rotation_ratio", "displacement"):
            if case[name] is None:
                continue
            fine = 1e-8 * max(1.0, case["condition"]) * case[name] + 1e-12
            granted = fine if fidelity == "reference" else row["error"] + fine
            assert abs(row[name] - case[name]) <= granted, (fidelity, name)
    assert row["residual"] == pytest.approx(
        case["residual"], rel=0.0, abs=1e-7 * max(1.0, case["condition"]) * case["displacement"]
    )


def test_the_other_integration_gives_what_is_kept() -> None:
    """One case anew: the file is what the program beside it writes."""
    kept = CASES[2]
    body = standing_truth.solved(standing_truth.drawn(2))
    assert body.away == pytest.approx(kept["displacement"], rel=1e-9)
    assert (body.fell is not None) == kept["overturned"]


def test_rocking_is_the_limit_of_friction_without_end() -> None:
    """Under a real record with its vertical component, every body: the same outcome and ratio, whatever friction.

    The base moves by no more than the tilt takes its middle along: b (1 - cos theta).
    """
    motion, given_bodies = record(), blocks(24)
    rocks = respond("rocking", motion, fidelity="reference", **given_bodies)
    ratios = []
    for friction in (2.0, 1e3):
        stands = respond("standing", motion, fidelity="reference", friction_static=friction, **given_bodies)
        ratios.append(np.abs(stands["rotation_ratio"] / rocks["rotation_ratio"].replace(0.0, np.nan) - 1.0))
        calm = ~(stands["note"].str.contains("sensitive") | rocks["note"].str.contains("sensitive"))
        assert calm.mean() > 0.5
    assert (stands["overturned"] == rocks["overturned"])[calm].all()
    same = calm & ~rocks["overturned"] & (rocks["rotation_ratio"] > 0.0)
    assert same.sum() >= 5
    assert (ratios[1][same] <= 1e-6).all()
    tilt = rocks["rotation_ratio"] * np.arctan2(given_bodies["half_width"], given_bodies["cg_height"])
    along = given_bodies["half_width"] * (1.0 - np.cos(tilt))
    np.testing.assert_allclose(stands["displacement"][same], along[same], rtol=1e-5, atol=1e-15)


def test_sliding_is_the_limit_of_squatness() -> None:
    """Where friction is below b/h, `sliding` along the same line, to rounding: with a vertical component too."""
    motion, friction = record(), np.linspace(0.02, 0.5, 25)
    for squat in (0.51, 1e3):
        stands = respond("standing", motion, half_width=0.1 * squat, cg_height=0.1, friction_static=friction)
        slides = respond("sliding", motion, friction_static=friction, directions=1)
        for name in ("displacement", "residual"):
            np.testing.assert_allclose(stands[name], slides[name], rtol=1e-10, atol=1e-14)
        assert (stands["rotation_ratio"] == 0.0).all()
        assert not stands["overturned"].any()
    # Cut where the shaking is strongest, most are on their way: the residual is where they then are.
    cut = Motion(motion.dt, motion.acceleration[:, : round(4.2 / motion.dt)])
    stands = respond("standing", cut, half_width=0.1, cg_height=0.1, friction_static=friction, tail=0.0)
    slides = respond("sliding", cut, friction_static=friction, directions=1, tail=0.0)
    assert (slides["residual"] < slides["displacement"]).any()
    np.testing.assert_allclose(stands["residual"], slides["residual"], rtol=1e-10, atol=1e-14)
    weak = {"friction_static": 0.3, "friction_kinetic": 0.2}
    one = respond("standing", motion, half_width=0.1, cg_height=0.1, **weak)["displacement"][0]
    assert one == pytest.approx(respond("sliding", motion, directions=1, **weak)["displacement"][0], rel=1e-10)


def test_nothing_tilts_below_the_slope() -> None:
    """The certificate is exact: what it puts at or below 1 does not tilt, however strong the push; above, it does."""
    motion = times(record(), 3.0, 1.0)
    slope = np.linspace(0.1, 0.6, 26)
    table = respond("standing", motion, half_width=slope * 0.5, cg_height=0.5, friction_static=0.35)
    assert ((table["rotation_ratio"] > 0.0) == (table["uplift_ratio"] > 1.0)).all()
    assert ((table["uplift_ratio"] > 1.0) == (slope < 0.35)).all()
    values = prepare(model_named("standing"), {"half_width": slope * 0.5, "cg_height": 0.5, "friction_static": 0.35})
    said = required(motion.excitation(0.0), values)
    assert set(said) == {"sliding", "standing"}
    assert ((said == "standing") == (slope < 0.35)).all()
    quiet = times(motion, 1e-3, 0.0).excitation(0.0)
    assert set(required(quiet, values)) == {""}


@pytest.mark.parametrize(("alpha", "mu"), [(0.2, 5.0), (0.2, 0.16), (0.5, 5.0), (0.9, 5.0)])
def test_a_landing_that_sticks_is_housners(alpha: float, mu: float) -> None:
    """A block that turns about one edge, 1 rad/s, and lands on the other: e = 1 - 1.5 sin^2 alpha (Housner 1963).

    The friction it takes is |P_x| / P_y = (h/b) (1 - e) / (1 + e), a ratio of momenta: with 0.16 a slope of 0.2 holds.
    """
    b, h = math.sin(alpha), math.cos(alpha)
    e = 1.0 - 1.5 * math.sin(alpha) ** 2
    px, py, slip = impulse(0.0, -2.0 * b, b, -h, 1.0 / 3.0, mu, mu)
    assert slip == 0.0
    assert abs(px) / py == pytest.approx(h / b * (1.0 - e) / (1.0 + e), rel=1e-12)
    # Turning towards -x before, about the edge there: theta' = -1; the impulse adds (r_y P_x - r_x P_y) / rho^2.
    assert 1.0 + 3.0 * (-h * px - b * py) == pytest.approx(e, rel=1e-12)
    assert held(0.0, -2.0 * b, b, -h, 1.0 / 3.0) == pytest.approx((px, py), rel=1e-12)


@settings(deadline=None, max_examples=examples(200))
@given(
    v=st.floats(-3.0, 3.0),
    w=st.floats(0.01, 3.0),
    turn=st.floats(-1.4, 1.4),
    rho2=st.floats(0.05, 1.0),
    mu=st.floats(0.0, 3.0),
)
def test_an_impact_keeps_the_laws_of_friction(v: float, w: float, turn: float, rho2: float, mu: float) -> None:
    """It pushes, within the cone, against the slip; the corner is not driven on; energy is not won."""
    rx, ry = math.sin(turn), -math.cos(turn)
    px, py, slip = impulse(v, -w, rx, ry, rho2, mu, mu)
    assert py > 0.0
    assert abs(px) <= mu * py * (1.0 + 1e-9) + 1e-12
    a, b, c = 1.0 + ry * ry / rho2, rx * ry / rho2, 1.0 + rx * rx / rho2
    assert -w - b * px + c * py == pytest.approx(0.0, abs=1e-9 * (1.0 + w + abs(px) + py) * c)
    assert v + a * px - b * py == pytest.approx(slip, abs=1e-9 * (1.0 + abs(v) + a * abs(px) + py))
    # The work of an impulse is its mean velocity times it.
    assert 0.5 * (px * (v + slip) + py * (-w)) <= 1e-12


def test_a_push_that_friction_cannot_pass_on_slides_and_rocks_as_shenton_says() -> None:
    """Trap of pure rocking: at a sudden push A = a/g a block of y = h/b needs mu >= (A (4 + y^2) + 3 y) /
    (1 + 4 y^2 + 3 A y) to rock without sliding (Shenton 1996); 1 % more holds, 1 % less slips at once."""
    for y, push in ((3.0, 0.6), (5.0, 0.5), (2.0, 1.5)):
        mu = (push * (4.0 + y * y) + 3.0 * y) / (1.0 + 4.0 * y * y + 3.0 * push * y)
        motion = along_x(np.full(3, push * G), 1e-4)
        moved = [
            respond("standing", motion, tail=0.0, half_width=0.5 / y, cg_height=0.5, friction_static=k * mu).iloc[0]
            for k in (1.01, 0.99)
        ]
        assert all(row["rotation_ratio"] > 0.0 for row in moved)
        # What slips is behind by a share of a t^2 / 2; the middle of what rocks moves with the fourth power.
        assert moved[0]["displacement"] < 1e-4 * moved[1]["displacement"]


def test_thrown_up_it_flies_and_lands() -> None:
    """a = 2 m/s2, a_z = -1.5 g for 0.1 s, then 0: a parabola, 0.5 g t^2 up against the base and 2 t^2 / 2 back.

    Landed flat at v = 0.2 m/s and more, it slides on until friction has taken it: all in closed form.
    """
    dt, up = 1e-4, 1001
    x = np.concatenate([np.full(up, 2.0), np.zeros(3000)])
    z = np.concatenate([np.full(up, -1.5 * G), np.zeros(3000)])
    motion = Motion(dt, np.vstack([x, 0.0 * x, z]))
    row = respond("standing", motion, half_width=0.5, cg_height=0.2, friction_static=0.4).iloc[0]
    # Between the two levels the polygon takes one interval, of which half counts.
    t = 0.1 + 0.5 * dt
    v, fall = 2.0 * t, 0.5 * G * t
    high = 0.5 * 0.5 * G * t * t
    # Ground velocity stays; the body falls from `high` with the rate `fall` upwards.
    air = (fall + math.sqrt(fall**2 + 2.0 * G * high)) / G
    hits = math.sqrt(fall**2 + 2.0 * G * high)
    left = max(0.0, v - 0.4 * hits)
    want = 0.5 * 2.0 * t * t + v * air + left**2 / (2.0 * 0.4 * G)
    assert row["displacement"] == pytest.approx(want, rel=2e-4)
    assert row["rotation_ratio"] == 0.0
    assert row["impacts"] == 1


def test_free_rocking_loses_energy_at_landings_alone() -> None:
    """After a pulse, with friction enough, energy about the edge is constant between landings, and falls at each."""
    motion = along_x(np.concatenate([4.0 * np.ones(40), np.zeros(800)]), 0.005)
    given_body = {"half_width": 0.15, "cg_height": 0.5, "friction_static": 3.0}
    theta = trace("standing", motion, **given_body)["rotation"].to_numpy()
    alpha, r = math.atan2(0.15, 0.5), math.hypot(0.15, 0.5)
    rate = np.gradient(theta, 0.005)
    energy = 0.5 * rate**2 - 0.75 * G / r * (1.0 - np.cos(np.abs(theta) - alpha))
    free = np.arange(theta.size) > 60
    away = free & (np.abs(theta) > 0.02) & (np.abs(np.roll(theta, 2)) > 0.02) & (np.abs(np.roll(theta, -2)) > 0.02)
    parts = np.split(np.flatnonzero(away), np.flatnonzero(np.diff(np.flatnonzero(away)) > 1) + 1)
    levels = [np.median(energy[part]) for part in parts if part.size > 8]
    assert len(levels) >= 3
    # Samples 5 ms apart give the rate to (p dt)^2: 3e-4 of the energy.
    assert all(np.ptp(energy[part]) < 5e-3 * 0.75 * G / r for part in parts if part.size > 8)
    assert all(later < earlier for earlier, later in pairwise(levels))


def test_a_mirrored_body_does_the_same() -> None:
    """The other way round in the mirrored motion: every number."""
    motion = random_motion(44, n=500, pga=7.0)
    body = {"cg_height": 0.5, "friction_static": 0.45, "friction_kinetic": 0.4, "gyration_radius": 0.3}
    one = respond("standing", motion, half_width=0.12, half_width_other=0.16, **body).iloc[0]
    other = respond("standing", times(motion, -1.0, 1.0), half_width=0.16, half_width_other=0.12, **body).iloc[0]
    assert one["rotation_ratio"] > 0.0
    for name in ("rotation_ratio", "displacement", "residual", "overturned", "impacts"):
        assert one[name] == pytest.approx(other[name], rel=1e-9), name


def test_a_body_of_another_size_is_the_same_in_another_time() -> None:
    """Twice as large under the motion stretched by the root of two: the same angles, twice the way (dimensions)."""
    motion = random_motion(45, n=500, pga=5.0)
    slow = Motion(motion.dt * math.sqrt(2.0), motion.acceleration)
    body = blocks(20, seed=9)
    large = {name: 2.0 * value for name, value in body.items()}
    one = respond("standing", motion, friction_static=0.4, tail=4.0, fidelity="reference", **body)
    two = respond("standing", slow, friction_static=0.4, tail=4.0 * math.sqrt(2.0), fidelity="reference", **large)
    calm = ~(one["note"].str.contains("sensitive") | two["note"].str.contains("sensitive"))
    assert calm.sum() >= 8
    assert (one["rotation_ratio"][calm] > 0.0).sum() >= 4
    np.testing.assert_allclose(one["rotation_ratio"][calm], two["rotation_ratio"][calm], rtol=1e-5)
    np.testing.assert_allclose(2.0 * one["displacement"][calm], two["displacement"][calm], rtol=1e-4, atol=1e-12)


def test_a_factor_on_the_restitution_is_the_restitution_times_it() -> None:
    """0.9 on a block whose Housner restitution is e gives what restitution 0.9 e gives; more than 1 is never won."""
    motion, body = record(), {**BLOCK, "friction_static": 0.6}
    e = 1.0 - 1.5 * math.sin(math.atan2(0.1, 0.4)) ** 2
    one = respond("standing", motion, restitution_factor=0.9, **body).iloc[0]
    two = respond("standing", motion, restitution=0.9 * e, **body).iloc[0]
    assert one["rotation_ratio"] == pytest.approx(two["rotation_ratio"], rel=1e-9)
    values = prepare(model_named("standing"), {**body, "restitution_factor": 2.0})
    assert standing_bodies(values)[0, -1] == 0.0


def test_a_polygon_written_with_more_samples_gives_the_same() -> None:
    """Twice the samples of the same polygon: other steps, the same answer within both errors."""
    motion, body = random_motion(46, n=300, pga=6.0), blocks(20, seed=5)
    one = respond("standing", motion, friction_static=0.35, **body)
    two = respond("standing", resampled(motion, 2), friction_static=0.35, **body)
    calm = ~(one["note"].str.contains("sensitive") | two["note"].str.contains("sensitive"))
    for name in ("rotation_ratio", "displacement"):
        assert (np.abs(one[name] - two[name]) <= one["error"] + two["error"] + 1e-12)[calm].all(), name


def test_the_worst_direction_of_what_only_slides_is_that_of_its_slide() -> None:
    """Nothing tilts in any direction: the row is of the direction with the largest displacement."""
    motion = random_motion(47, n=300, pga=5.0)
    body = {"half_width": 0.3, "cg_height": 0.2, "friction_static": 0.2}
    row = respond("standing", motion, angle=None, azimuth_step=30.0, **body).iloc[0]
    each = [respond("standing", motion, angle=float(a), **body)["displacement"][0] for a in range(0, 180, 30)]
    assert row["displacement"] == pytest.approx(max(each), rel=1e-9)


def test_the_certificate_bounds_every_direction() -> None:
    """Of a motion in two directions it is at least that of any one."""
    motion = random_motion(48, n=200, pga=5.0)
    body = standing_bodies(prepare(model_named("standing"), {**BLOCK, "friction_static": [0.2, 0.3, 2.0]}))
    both = tilt_ratios(motion.excitation(None), body)
    for angle in range(0, 360, 15):
        assert (tilt_ratios(motion.excitation(float(angle)), body) <= both * (1.0 + 1e-12)).all()
