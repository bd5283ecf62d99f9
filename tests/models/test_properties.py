"""What must hold for any motion and object: scaling, symmetry, rotation, no influence of neighbours or sampling."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from parameters import VALID
from shaking import along_x, random_motion, resampled, times, turned

from pipeline import Motion, respond, trace
from pipeline.analysis.model_runs import prepare
from pipeline.models import MODELS, model_named
from pipeline.quantities import Array, G

few = settings(
    max_examples=15, deadline=None, derandomize=True, database=None, suppress_health_check=[HealthCheck.too_slow]
)
seeds = st.integers(0, 40)
frictions = st.floats(0.02, 0.4)


@few
@given(seed=seeds, mu=frictions, k=st.floats(1e-3, 1e3), directions=st.sampled_from([1, 2]))
def test_sliding_scales_with_acceleration_and_friction(seed: int, mu: float, k: float, directions: int) -> None:
    """u'' = -a - mu g sign: a and mu times k give u times k, without vertical motion.

    Rounding in one direction; in two the step control scales too, so that the same steps are taken.
    """
    motion = random_motion(seed, n=300, vertical=0.0)
    one = respond("sliding", motion, friction_static=mu, directions=directions).iloc[0]
    many = respond("sliding", times(motion, k, 0.0), friction_static=k * mu, directions=directions).iloc[0]
    rel = 1e-9 if directions == 1 else 1e-5
    for column in ("displacement", "path_length"):
        assert many[column] == pytest.approx(k * one[column], rel=rel, abs=1e-12 * k)


@few
@given(seed=seeds, name=st.sampled_from(sorted(VALID)))
def test_mirrored_motion_gives_the_same(seed: int, name: str) -> None:
    """Every symmetric object is blind to the sign of the horizontal motion: bit for bit."""
    motion = random_motion(seed, n=300)
    same = respond(name, motion, **VALID[name])
    pd.testing.assert_frame_equal(same, respond(name, times(motion, -1.0, 1.0), **VALID[name]), check_exact=True)


@few
@given(seed=seeds, b1=st.floats(0.05, 0.3), b2=st.floats(0.05, 0.3))
def test_mirrored_body_in_a_mirrored_motion_gives_the_same(seed: int, b1: float, b2: float) -> None:
    """Swapping the edges and the sign of x is only another way of looking at it; the inertia is given, because the one
    assumed (a uniform rectangle of the first edge's half width) would not be the same body's."""
    motion = random_motion(seed, n=300)
    one = respond("rocking", motion, half_width=b1, half_width_other=b2, cg_height=0.6, gyration_radius=0.4)
    other = respond(
        "rocking", times(motion, -1.0, 1.0), half_width=b2, half_width_other=b1, cg_height=0.6, gyration_radius=0.4
    )
    edges = ["half_width", "half_width_other"]
    pd.testing.assert_frame_equal(one.drop(columns=edges), other.drop(columns=edges), check_exact=False, rtol=1e-9)


TWO_WAYS: list[tuple[str, dict[str, Any], float]] = [
    ("sliding", {"friction_static": 0.1, "friction_kinetic": 0.08}, 1e-4),
    ("friction_isolator", {"friction_static": 0.07}, 1e-4),
    ("horizontal_isolator", {"frequency": 0.6, "damping": 0.05, "friction": 0.05}, 1e-4),
    ("swing_3d", {"length": 0.8, "damping": 0.03}, 1e-5),
]


@few
@given(seed=seeds, degrees=st.floats(0.0, 360.0), which=st.sampled_from(TWO_WAYS))
def test_two_directional_models_know_no_axes(
    seed: int, degrees: float, which: tuple[str, dict[str, Any], float]
) -> None:
    """Turning the motion turns the response: radii, paths and accelerations stay, within the step tolerance."""
    name, parameters, rel = which
    motion = random_motion(seed, n=300)
    one = respond(name, motion, **parameters).iloc[0]
    other = respond(name, turned(motion, degrees), **parameters).iloc[0]
    for quantity in model_named(name).gives:
        scale = abs(one["displacement"]) if quantity.unit == "m" else abs(one[quantity.name])
        assert other[quantity.name] == pytest.approx(one[quantity.name], rel=rel, abs=rel * scale)


@few
@given(seed=seeds, mu=frictions, share=st.floats(0.3, 1.0), degrees=st.floats(0.0, 360.0))
def test_two_directional_sliding_on_a_line_is_one_directional(
    seed: int, mu: float, share: float, degrees: float
) -> None:
    """The plane's stepped integration against the line's closed form: 5e-4 is promised."""
    plain = random_motion(seed, n=300)
    motion = Motion(plain.dt, np.vstack([plain.acceleration[0], 0.0 * plain.acceleration[1], plain.acceleration[2]]))
    parameters = {"friction_static": mu, "friction_kinetic": share * mu}
    line = respond("sliding", motion, directions=1, **parameters).iloc[0]
    plane = respond("sliding", turned(motion, degrees), directions=2, **parameters).iloc[0]
    for column in ("displacement", "residual", "path_length"):
        assert plane[column] == pytest.approx(line[column], rel=5e-4, abs=5e-4 * line["displacement"] + 1e-15)


@pytest.mark.parametrize("kinetic", [0.0, 1e-9, 1e-4, 1e-3, 1e-2, 0.1])
def test_a_low_kinetic_friction_on_a_line(kinetic: float) -> None:
    """Static friction catches the body where it stops, however low the kinetic one is: plane and line agree."""
    motion = along_x(random_motion(3).acceleration[0], 0.01)
    parameters = {"friction_static": 0.3, "friction_kinetic": kinetic, "tail": 1.0}
    line = respond("sliding", motion, directions=1, **parameters)["displacement"][0]
    plane = respond("sliding", motion, directions=2, **parameters)["displacement"][0]
    assert plane == pytest.approx(line, rel=5e-4)


@few
@given(
    seed=seeds, f=st.floats(0.2, 3.0), zeta=st.floats(0.0, 0.5), mu=st.floats(0.0, 0.2), degrees=st.floats(0.0, 360.0)
)
def test_two_directional_isolator_on_a_line_is_one_directional(
    seed: int, f: float, zeta: float, mu: float, degrees: float
) -> None:
    plain = random_motion(seed, n=300)
    motion = Motion(plain.dt, np.vstack([plain.acceleration[0], 0.0 * plain.acceleration[1], plain.acceleration[2]]))
    parameters = {"frequency": f, "damping": zeta, "friction": mu, "tail": 5.0}
    line = respond("horizontal_isolator", motion, directions=1, **parameters).iloc[0]
    plane = respond("horizontal_isolator", turned(motion, degrees), directions=2, **parameters).iloc[0]
    for column in ("displacement", "residual", "acceleration"):
        scale = line["displacement"] if column != "acceleration" else line["acceleration"]
        assert plane[column] == pytest.approx(line[column], rel=5e-4, abs=5e-4 * scale + 1e-15)


SPREAD: dict[str, dict[str, tuple[float, float]]] = {
    "rocking": {"half_width": (0.02, 0.5), "cg_height": (0.1, 2.0)},
    "standing": {"half_width": (0.02, 0.5), "cg_height": (0.1, 2.0), "friction_static": (0.1, 0.8)},
    "unanchored": {"half_width": (0.1, 0.6), "cg_height": (0.3, 1.2), "friction_static": (0.1, 0.8)},
    "sliding": {"friction_static": (0.0, 0.6)},
    "stress": {"mass": (1.0, 50.0), "lever": (0.05, 1.0), "area": (1e-4, 1e-2), "section_modulus": (1e-6, 1e-4)},
    "flexible_stress": {
        "mass": (1.0, 50.0),
        "lever": (0.05, 1.0),
        "area": (1e-4, 1e-2),
        "section_modulus": (1e-6, 1e-4),
        "frequency": (0.5, 40.0),
        "damping": (0.0, 2.0),
    },
    "swing": {"length": (0.001, 20.0), "damping": (0.0, 2.0)},
    "swing_3d": {"length": (0.01, 20.0), "damping": (0.0, 2.0)},
    "unhooking": {
        "hook_height": (0.05, 0.5),
        "hook_offset": (0.01, 0.05),
        "gyration": (0.1, 0.6),
        "restitution": (0.1, 0.6),
    },
    "hanger_load": {"amplification": (1.0, 2.0)},
    "friction_isolator": {"friction_static": (0.0, 0.3)},
    "horizontal_isolator": {"frequency": (0.2, 5.0), "damping": (0.0, 0.5), "friction": (0.0, 0.2)},
    "rotational_isolator": {
        "frequency": (0.5, 40.0),
        "damping": (0.0, 2.0),
        "cg_height": (0.1, 2.0),
        "inertia_ratio": (1.0, 2.0),
    },
    "oscillator": {"frequency": (0.02, 100.0), "damping": (0.0, 2.0)},
}


@pytest.mark.parametrize("name", sorted(SPREAD))
@pytest.mark.parametrize("fidelity", ["history", "reference"])
def test_a_result_never_depends_on_its_neighbours(name: str, fidelity: str) -> None:
    """Bit-identical alone, in a batch of 100, and in that batch in another order."""
    rng = np.random.default_rng(7)
    n = 100 if fidelity == "history" else 20
    motion = random_motion(41, n=250, dt=0.02)
    many = {k: np.exp(rng.uniform(np.log(lo or 1e-3), np.log(hi), n)) for k, (lo, hi) in SPREAD[name].items()}
    for k, (lo, _) in SPREAD[name].items():
        if lo == 0.0:
            many[k][::7] = 0.0
    table = respond(name, motion, fidelity=fidelity, **many)
    order = rng.permutation(n)
    again = respond(name, motion, fidelity=fidelity, **{k: v[order] for k, v in many.items()})
    pd.testing.assert_frame_equal(again, table.iloc[order].reset_index(drop=True), check_exact=True)
    for k in range(0, n, max(1, n // 10)):
        alone = respond(name, motion, fidelity=fidelity, **{key: v[k] for key, v in many.items()})
        pd.testing.assert_frame_equal(alone, table.iloc[[k]].reset_index(drop=True), check_exact=True)


def test_every_model_is_spread() -> None:
    assert set(SPREAD) == {model.name for model in MODELS}


@few
@given(
    seed=seeds, alpha=st.floats(0.05, 0.6), size=st.floats(0.2, 2.0), ratio=st.floats(0.6, 1.3), e=st.floats(0.3, 1.0)
)
def test_rocking_depends_on_p_alpha_and_restitution_alone(
    seed: int, alpha: float, size: float, ratio: float, e: float
) -> None:
    """A body of another size with the same c = R / (rho^2 + R^2) rocks the same, to rounding that grows to 1e-7."""
    motion = random_motion(seed, n=300)
    c = 3.0 / (4.0 * size)
    # A point mass has c = 1 / R: no body of this p can be larger than 1 / c.
    other = min(ratio * size, 0.99 / c)
    rho = np.sqrt(other / c - other**2)
    bodies = [
        {"half_width": size * np.sin(alpha), "cg_height": size * np.cos(alpha)},
        {"half_width": other * np.sin(alpha), "cg_height": other * np.cos(alpha), "gyration_radius": rho},
    ]
    one, two = (respond("rocking", motion, restitution=e, tail=3.0, **body).iloc[0] for body in bodies)
    assert one["overturned"] == two["overturned"]
    assert two["rotation_ratio"] == pytest.approx(one["rotation_ratio"], rel=1e-7, abs=1e-9)
    assert two["uplift_ratio"] == pytest.approx(one["uplift_ratio"], rel=1e-12)


@pytest.mark.parametrize("more", [2, 3])
@pytest.mark.parametrize(
    ("name", "rel"),
    [
        ("rocking", 1e-4),
        ("sliding", 5e-4),
        ("stress", 1e-12),
        ("flexible_stress", 1e-9),
        ("swing", 1e-6),
        ("swing_3d", 1e-4),
        ("friction_isolator", 5e-4),
        ("horizontal_isolator", 5e-4),
        ("rotational_isolator", 1e-9),
        ("oscillator", 1e-9),
    ],
)
def test_the_polygon_may_be_sampled_more_finely(name: str, rel: float, more: int) -> None:
    """The same polygon with 2 or 3 times the samples is the same excitation: each within its model's promise."""
    motion = random_motion(43, n=300, dt=0.02)
    one = respond(name, motion, **VALID[name]).iloc[0]
    two = respond(name, resampled(motion, more), **VALID[name]).iloc[0]
    for quantity in model_named(name).gives:
        if quantity.unit in ("bool", "count"):
            assert one[quantity.name] == two[quantity.name]
        elif not np.isnan(one[quantity.name]):
            assert two[quantity.name] == pytest.approx(one[quantity.name], rel=rel, abs=1e-12)


@few
@given(seed=seeds, quiet=st.integers(1, 300))
def test_rest_before_the_record_changes_nothing(seed: int, quiet: int) -> None:
    """Leading rest only shifts times; a whole interval ramps up from it, so the record begins and ends at zero here."""
    motion = random_motion(seed, n=200)
    a = motion.acceleration * np.sin(np.pi * np.arange(200) / 199.0)
    a[:, [0, -1]] = 0.0
    early, late = Motion(0.01, a), Motion(0.01, np.hstack([np.zeros((3, quiet)), a]))
    for name in ("rocking", "sliding", "swing", "swing_3d", "oscillator", "horizontal_isolator"):
        one, two = (respond(name, m, **VALID[name]).iloc[0] for m in (early, late))
        first = model_named(name).gives[0].name
        assert two[first] == pytest.approx(one[first], rel=1e-5)
    shift = respond("rocking", late, **VALID["rocking"]).iloc[0]["uplift_time"]
    start = respond("rocking", early, **VALID["rocking"]).iloc[0]["uplift_time"]
    assert np.isnan(start) == np.isnan(shift)
    if not np.isnan(start):
        assert shift - start == pytest.approx(quiet * 0.01, abs=1e-9)


@few
@given(seed=seeds, mu=frictions)
def test_a_certificate_bounds_every_direction(seed: int, mu: float) -> None:
    """Where the certificate says rest, nothing moves at any angle; where it gives the demand, no angle exceeds it."""
    from pipeline.records import Excitation

    motion = random_motion(seed, n=200, pga=mu * G)
    both = Excitation(motion.dt, motion.acceleration[0], motion.acceleration[1], motion.acceleration[2], None)
    for model in MODELS:
        if model.certificate is None:
            continue
        parameters = {"friction_static": mu} if model.name == "sliding" else VALID[model.name]
        bound = model.certificate(both, prepare(model, parameters))[0]
        for angle in (0.0, 45.0, 90.0, 160.0):
            demand = respond(model.name, motion, angle=angle, **parameters)[model.demand][0]
            assert demand <= bound * (1.0 + 1e-9) + 1e-15


ORDER_4: dict[str, dict[str, Any]] = {
    "rocking": {"half_width": np.linspace(0.1, 0.25, 40), "cg_height": 0.6},
    "swing": {"length": np.geomspace(0.05, 3.0, 40), "damping": 0.02},
    "swing_3d": {"length": np.geomspace(0.05, 3.0, 40), "damping": 0.02},
}
EXACT: dict[str, dict[str, Any]] = {
    "sliding": {"friction_static": np.linspace(0.05, 0.3, 40), "directions": 1.0},
    "oscillator": {"frequency": np.geomspace(0.1, 20.0, 40), "damping": 0.02},
    "rotational_isolator": {
        "frequency": np.geomspace(1.0, 8.0, 40),
        "damping": 0.2,
        "cg_height": 0.5,
        "inertia_ratio": 1.4,
    },
}


def at_steps(name: str, parameters: dict[str, Any], refinements: tuple[int, ...]) -> list[Array]:
    """Return the first output of the rows that move, at each refinement of the step."""
    model = model_named(name)
    excitation = random_motion(7, n=300, dt=0.02).excitation(None if model.directions == 2 else 0.0, 0.0)
    values = prepare(model, parameters)
    first = model.gives[0].name
    runs = [model.run(excitation, values, refine, False)[first] for refine in refinements]
    return [run[runs[-1] > 0.0] for run in runs]


@pytest.mark.parametrize("name", sorted(ORDER_4))
def test_refinement_converges_at_the_fourth_order(name: str) -> None:
    """A quarter of the step is 4^4 of the error, as the kernels' docstrings say, through kinks, lift-offs and impacts.

    Of the median errors of 40 objects; 0.2 covers what is not yet asymptotic.
    """
    coarse, fine, truth = at_steps(name, ORDER_4[name], (2, 8, 128))
    larger, smaller = (float(np.median(np.abs(run / truth - 1.0))) for run in (coarse, fine))
    assert np.log2(larger / smaller) / 2.0 == pytest.approx(4.0, abs=0.2)


def circling(cycles: float = 4.4) -> Motion:
    """Return a push of constant size that turns: what it drags along neither stops nor turns sharply."""
    t = np.arange(round(100.0 * cycles / 1.1) + 1) * 0.01
    turn = 2.0 * np.pi * 1.1 * t
    return Motion(0.01, np.vstack([4.0 * np.cos(turn), 4.0 * np.sin(turn), 0.0 * t]))


IN_THE_PLANE: list[tuple[str, dict[str, Any]]] = [
    ("sliding", {}),
    ("horizontal_isolator", {"frequency": 0.6, "damping": 0.05}),
]


def plane_orders(name: str, motion: Motion, parameters: dict[str, Any], refinements: tuple[int, ...]) -> Array:
    """Return the order between neighbouring refinements of the median error of displacements, against 32."""
    values = prepare(model_named(name), parameters)
    excitation = motion.excitation(None, 0.0)
    runs = [model_named(name).run(excitation, values, k, False)["displacement"] for k in (*refinements, 32)]
    errors = [float(np.median(np.abs(run / runs[-1] - 1.0))) for run in runs[:-1]]
    return -np.diff(np.log2(errors)) / np.diff(np.log2(refinements))


@pytest.mark.parametrize(("name", "others"), IN_THE_PLANE)
def test_slip_in_the_plane_converges_at_the_fourth_order(name: str, others: dict[str, Any]) -> None:
    """40 bodies that slip all the time: the order of the method at 1, 2 and 4; 0.7 covers what a peak's place adds."""
    held = {"friction_static" if name == "sliding" else "friction": np.linspace(0.01, 0.04, 40)}
    assert plane_orders(name, circling(), {**others, **held}, (1, 2, 4)) == pytest.approx(4.0, abs=0.7)


@pytest.mark.parametrize(("name", "others"), IN_THE_PLANE)
def test_stick_and_slip_in_the_plane_converges_at_the_fourth_order_on_average(
    name: str, others: dict[str, Any]
) -> None:
    """40 bodies that stop and start: the error falls with the fourth power from 1 to 8, without a spring.

    With one, the tolerance rules, which falls with the sixth power, from 1 to 4: at 8 the error is rounding.  Half an
    order is granted for the median of 40.
    """
    motion = random_motion(7, n=300, dt=0.02)
    held, least = ("friction_static", 3.5) if name == "sliding" else ("friction", 5.0)
    frictions = np.linspace(0.2, 0.5, 40) if name == "sliding" else np.linspace(0.15, 0.4, 40)
    for mu in frictions[::13]:
        moves = np.diff(trace(name, motion, **{**others, held: mu})["u_x"]) != 0.0
        assert np.diff(moves.astype(int)).tolist().count(1) >= 4, "it starts again"
    steps = (1, 8) if name == "sliding" else (1, 4)
    assert plane_orders(name, motion, {**others, held: frictions}, steps)[0] > least


@pytest.mark.parametrize("name", sorted(EXACT))
def test_what_is_exact_needs_no_refinement(name: str) -> None:
    """Closed forms between the samples: the coarsest step gives what the finest gives, to 1e-12."""
    coarse, fine = at_steps(name, EXACT[name], (1, 16))
    np.testing.assert_allclose(coarse, fine, rtol=1e-12)


@few
@given(seed=seeds, k=st.floats(1.001, 3.0))
def test_the_uplift_ratio_grows_with_the_motion_and_falls_with_the_base(seed: int, k: float) -> None:
    """k times the horizontal motion is k times the ratio, and k times the base a k-th of it, whatever is vertical."""
    motion = random_motion(seed, n=200)
    one, wide = respond("rocking", motion, half_width=[0.1, 0.1 * k], cg_height=0.5)["uplift_ratio"]
    strong = respond("rocking", times(motion, k, 1.0), half_width=0.1, cg_height=0.5)["uplift_ratio"][0]
    assert strong == pytest.approx(k * one, rel=1e-12)
    assert wide == pytest.approx(one / k, rel=1e-12)
