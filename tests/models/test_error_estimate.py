"""The estimated error covers what the reference finds: in 99 of 100 random cases, for every model."""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from itertools import product

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from shaking import along_x, random_motion, resampled

from pipeline import Motion, respond
from pipeline.analysis.model_runs import prepare
from pipeline.models import MODELS, model_named
from pipeline.models.flips import RATIO, integrate
from pipeline.models.rigid_body import bodies
from pipeline.motions import read_motion
from pipeline.motions.synthesis import sine
from pipeline.quantities import Array, G
from pipeline.resources import resource
from tests.soak import SOAK

LONG = pytest.mark.long("test_the_estimated_error_covers_the_true_one")

ROWS, MOTIONS = int(os.environ.get("KOUROS_ROWS", "12")), 6
"""Objects under each motion; `make soak` takes forty."""


def drawn(name: str, rng: np.random.Generator, n: int) -> dict[str, Array | float]:
    """Return n plausible museum objects for a model."""

    def log(low: float, high: float) -> Array:
        return np.exp(rng.uniform(np.log(low), np.log(high), n))

    def flat(low: float, high: float) -> Array:
        return rng.uniform(low, high, n)

    if name == "rocking":
        h = log(0.05, 2.0)
        return {"half_width": h * np.tan(flat(0.02, 0.7)), "cg_height": h}
    if name in ("standing", "unanchored"):
        h = log(0.05, 2.0)
        return {"half_width": h * np.tan(flat(0.02, 0.7)), "cg_height": h, "friction_static": flat(0.05, 0.8)}
    if name.startswith("sliding"):
        mu = flat(0.02, 0.5)
        return {"friction_static": mu, "friction_kinetic": mu * flat(0.7, 1.0), "directions": float(name[-1])}
    if name.startswith("horizontal_isolator"):
        return {
            "frequency": log(0.2, 5.0),
            "damping": flat(0.0, 0.3),
            "friction": flat(0.01, 0.2),
            "directions": float(name[-1]),
        }
    if name == "friction_isolator":
        return {"friction_static": flat(0.02, 0.3)}
    if name.startswith("swing"):
        return {"length": log(0.05, 5.0), "damping": flat(0.0, 0.2)}
    if name == "unhooking":
        height = log(0.1, 2.0)
        return {
            "hook_height": height * flat(0.1, 0.5),
            "hook_offset": flat(0.005, 0.05),
            "gyration": 0.3 * height,
            "restitution": flat(0.0, 0.6),
        }
    if name == "hanger_load":
        return {"amplification": flat(0.9, 2.0)}
    section = {"mass": flat(1.0, 50.0), "lever": flat(0.05, 1.0), "area": 1e-3, "section_modulus": 1e-5}
    if name == "stress":
        return section
    oscillator = {"frequency": log(0.1, 50.0), "damping": flat(0.0, 0.3)}
    if name == "flexible_stress":
        return {**section, **oscillator}
    if name == "rotational_isolator":
        return {**oscillator, "cg_height": flat(0.1, 1.0), "inertia_ratio": flat(1.0, 2.0)}
    return oscillator


CASES = [
    "rocking",
    "standing",
    "unanchored",
    "sliding 1",
    "sliding 2",
    "stress",
    "flexible_stress",
    "swing",
    "swing_3d",
    "friction_isolator",
    "horizontal_isolator 1",
    "horizontal_isolator 2",
    "rotational_isolator",
    "oscillator",
    "unhooking",
    "hanger_load",
]


RECORDS = {
    "a few samples": (4, 10, 1e-3, 10.0),
    "short": (11, 50, 1e-3, 10.0),
    "long": (300, 800, 1e-3, 10.0),
    "long and strong": (300, 800, 2.0, 12.0),
}
"""Samples from and to, and peak acceleration from and to [m/s2]; time steps of 0.5 to 40 ms."""


@pytest.mark.parametrize(
    ("name", "kind"),
    # Every day each model with half of the records, in turn.
    [
        pytest.param(name, kind, marks=LONG if kind.startswith("long") else [])
        for at, (name, kind) in enumerate(product(CASES, sorted(RECORDS)))
        if SOAK or (at + at // len(RECORDS)) % 2 == 0
    ],
)
def test_the_estimated_error_covers_the_true_one(name: str, kind: str) -> None:
    """|history - reference| <= error, but for 1 case of 100, in records of any length, step and strength.

    The reference is 8 times finer (8^4 in error), and runs on the same polygon with twice the samples, so that a closed
    form meets other numbers too: its own error counts as nothing; 1e-13 of the value is rounding.
    What is flagged sensitive has said so.  Friction and slenderness follow the strength, so that most objects move.
    """
    rng = np.random.default_rng(5)
    shortest, longest, weak, strong = RECORDS[kind]
    outside = []
    for seed in range(MOTIONS):
        pga = float(np.exp(rng.uniform(np.log(weak), np.log(strong))))
        dt = float(np.exp(rng.uniform(np.log(5e-4), np.log(0.04))))
        n = int(rng.integers(shortest, longest + 1))
        motion = random_motion(50 + seed, n=n, dt=dt, pga=pga, vertical=0.5 * (seed % 2))
        parameters = drawn(name, rng, ROWS)
        for held in {"friction", "friction_static", "friction_kinetic", "half_width"} & set(parameters):
            parameters[held] = parameters[held] * min(1.0, pga / 6.0)
        history = respond(name.split(maxsplit=1)[0], motion, **parameters)
        finer = resampled(motion, 2)
        reference = respond(name.split(maxsplit=1)[0], finer, fidelity="reference", **parameters)
        first = history.columns[0]
        missed = np.abs(history[first] - reference[first]).to_numpy()
        granted = history["error"].to_numpy() + 1e-13 * np.abs(reference[first].to_numpy())
        told = history["note"].str.contains("sensitive").to_numpy()
        outside.append((missed > granted)[~told])
    share = 1.0 - np.concatenate(outside).mean()
    assert share >= 0.99, f"{name}: {100.0 * share:.1f} % of {np.concatenate(outside).size} cases covered"


def polygon(motion: Motion, row: int, t: float) -> float:
    """Return one component of a motion at a time [m/s2]."""
    return float(np.interp(t, motion.dt * np.arange(motion.samples), motion.acceleration[row]))


def swung(motion: Motion, length: float, damping: float) -> float:
    """Return the largest |L sin theta| of a plane pendulum in a record, by DOP853 between the kinks."""
    w = math.sqrt(G / length)
    most, state = 0.0, np.zeros(2)

    def rates(t: float, y: Array) -> list[float]:
        weight, push = G + polygon(motion, 2, t), polygon(motion, 0, t)
        return [y[1], -2.0 * damping * w * y[1] - (weight * math.sin(y[0]) + push * math.cos(y[0])) / length]

    for i in range(motion.samples - 1):
        span = (i * motion.dt, (i + 1) * motion.dt)
        part = solve_ivp(
            rates, span, state, method="DOP853", rtol=1e-12, atol=1e-15, events=lambda _t, y: y[1], dense_output=True
        )
        state = part.y[:, -1]
        most = max([most, abs(state[0]), *(abs(y[0]) for y in part.y_events[0])])
    return length * math.sin(most)


def rocked(motion: Motion, half_width: float, cg_height: float) -> float:
    """Return the largest |theta| / alpha of a block in a record, by DOP853 between kinks, lift-offs and landings."""
    alpha, r = math.atan2(half_width, cg_height), math.hypot(half_width, cg_height)
    p2, e = 0.75 * G / r, 1.0 - 1.5 * math.sin(alpha) ** 2
    most, side, state = 0.0, 0.0, np.zeros(2)

    def pushes(t: float) -> tuple[float, float]:
        return polygon(motion, 0, t) / G, 1.0 + polygon(motion, 2, t) / G

    def rates(t: float, y: Array) -> list[float]:
        push, weight = pushes(t)
        return [y[1], -p2 * (weight * math.sin(alpha - y[0]) + side * push * math.cos(alpha - y[0]))]

    def landing(_t: float, y: Array) -> float:
        return float(y[0])

    def top(_t: float, y: Array) -> float:
        return float(y[1])

    landing.terminal, landing.direction = True, -1.0  # type: ignore[attr-defined]
    t = 0.0
    for i in range(motion.samples - 1):
        end = (i + 1) * motion.dt
        while t < end:
            if side == 0.0:
                lifts = [(_crossing(pushes, s * math.tan(alpha), t, end), s) for s in (1.0, -1.0)]
                t, side = min(lifts, key=lambda lift: lift[0])
                if t >= end:
                    t, side = end, 0.0
                    break
                state = np.zeros(2)
            part = solve_ivp(
                rates,
                (t, end),
                state,
                method="DOP853",
                rtol=1e-12,
                atol=1e-16,
                events=[landing, top],
                max_step=motion.dt,
            )
            most = max([most, part.y[0].max() / alpha, *(y[0] / alpha for y in part.y_events[1])])
            t, state = float(part.t[-1]), part.y[:, -1]
            if part.status == 1:
                side, state = -side, np.array([0.0, -e * state[1]])
                if state[1] < 1e-4 * math.sqrt(p2) * alpha:
                    side = 0.0
    return most


def _crossing(pushes: Callable[[float], tuple[float, float]], slope: float, begin: float, end: float) -> float:
    # When the push first exceeds what holds the block down, infinite if it does not: both are linear in between.
    first, last = (
        -push * math.copysign(1.0, slope) - abs(slope) * weight for push, weight in map(pushes, (begin, end))
    )
    if first > 0.0:
        return begin
    return begin + (end - begin) * first / (first - last) if last > 0.0 else math.inf


def test_the_estimated_error_covers_what_an_independent_integrator_finds() -> None:
    """History against DOP853 at 1e-12 with located events: 40 pendulums and 40 blocks in records of 5 to 40 samples."""
    rng = np.random.default_rng(8)
    outside, moved = [], 0
    for seed in range(8):
        motion = random_motion(90 + seed, n=int(rng.integers(5, 41)), dt=0.02, pga=6.0, vertical=0.4)
        swings, blocks = drawn("swing", rng, 5), drawn("rocking", rng, 5)
        for name, parameters, truth in (("swing", swings, swung), ("rocking", blocks, rocked)):
            table = respond(name, motion, tail=0.0, **parameters)
            want = np.array([truth(motion, *row) for row in zip(*parameters.values(), strict=True)])
            got = table[table.columns[0]].to_numpy()
            told = table["note"].str.contains("sensitive").to_numpy()
            outside.append((np.abs(got - want) > table["error"].to_numpy() + 1e-10 * want)[~told])
            moved += int((want > 0.0).sum())
    assert moved >= 50
    assert np.concatenate(outside).mean() <= 0.01


def test_every_model_is_measured() -> None:
    assert {name.split()[0] for name in CASES} == {model.name for model in MODELS}


def shaken_bodies(seed: int) -> tuple[Motion, dict[str, Array | float]]:
    """Return strong shaking with vertical motion, and bodies of which many rock through hundreds of impacts."""
    motion = random_motion(seed, n=1000, pga=8.0, vertical=0.5)
    rng = np.random.default_rng(seed)
    height = rng.uniform(0.1, 1.0, 150)
    return motion, {"half_width": height * rng.uniform(0.1, 0.6, height.size), "cg_height": height}


@pytest.mark.parametrize("seed", [60, 61, 62])
def test_what_is_not_sensitive_is_right(seed: int) -> None:
    """Every outcome and the ratio to 1e-4, as `history` promises, for every body that is not said to be sensitive."""
    motion, bodies = shaken_bodies(seed)
    history = respond("rocking", motion, **bodies)
    reference = respond("rocking", motion, fidelity="reference", **bodies)
    ordinary = ~history["note"].str.contains("sensitive")
    assert 0.5 < ordinary.mean() < 1.0
    assert (history["overturned"] == reference["overturned"])[ordinary].all()
    np.testing.assert_allclose(
        history["rotation_ratio"][ordinary], reference["rotation_ratio"][ordinary], rtol=1e-4, atol=0.0
    )


@pytest.mark.parametrize("directions", [1, 2])
def test_what_hardly_slides_says_so(directions: int) -> None:
    """A thousandth above its friction a body's displacement is ill-conditioned; 2 % above or below it is not."""
    motion = along_x([3.0] * 40, 0.01)
    mu = 3.0 / G / np.array([0.98, 0.999, 1.001, 1.02])
    told = respond("sliding", motion, friction_static=mu, directions=directions)["note"].str.contains("sensitive")
    assert told.tolist() == [False, True, True, False]


SMALL = {"half_width": 0.0025, "cg_height": 0.08}
"""A small block, p = 9.6 /s."""


def pushed(beyond: float, before: float = 0.5, after: float = 0.6) -> Motion:
    """Return samples 0.01 s apart of which one lifts the small block, by this share, and what is beside it."""
    shape = np.array([0.0, 0.0, before, 1.0 + beyond, after, min(after - 0.3, 0.0), 0.0, 0.0, 0.0])
    return along_x(shape * G * SMALL["half_width"] / SMALL["cg_height"], 0.01)


@pytest.mark.parametrize("fidelity", ["history", "reference"])
def test_hops_within_one_step_are_covered(fidelity: str) -> None:
    """Both steps of an estimate can take a hop alike: it covers what steps 16 times finer than `reference` show.

    Estimates were up to 24 times too small at ratios of 1e-8; one of more than a hundredth is told.
    """
    body = prepare(model_named("rocking"), SMALL)
    for beyond, before, after in product(
        (0.005, 0.0094, 0.0129, 0.03, 0.085, 0.2), (0.0, 0.5, 0.95), (-1.0, -0.3, 0.3, 0.6)
    ):
        motion = pushed(beyond, before, after)
        row = respond("rocking", motion, fidelity=fidelity, tail=0.0, **SMALL).iloc[0]
        excitation = motion.excitation(0.0, 0.0)
        want = integrate(excitation, bodies(body), body["initial_rotation"], 256)[0, RATIO]
        assert abs(row["rotation_ratio"] - want) <= row["error"], (beyond, before, after)
        assert row["error"] <= 1e-2 * want or "sensitive" in row["note"], (beyond, before, after)


@pytest.mark.parametrize("beyond", [0.02, 0.05])
def test_a_hop_by_an_independent_integrator(beyond: float) -> None:
    """At ratios of 3e-6 and 3e-5 DOP853 with located events is met to 1e-8."""
    row = respond("rocking", pushed(beyond), fidelity="reference", tail=0.0, **SMALL).iloc[0]
    assert row["rotation_ratio"] == pytest.approx(rocked(pushed(beyond), **SMALL), rel=1e-8)


@pytest.mark.parametrize("fidelity", ["history", "reference"])
def test_what_hangs_on_the_rate_at_which_a_body_rests_is_told(fidelity: str) -> None:
    """Very slender blocks that a sine lifts by parts in ten thousand go on landing for longer than half its period:
    put to rest at a hundredth of the usual rate they tip by up to 10,000 times as much.  None of those is silent."""
    motion = sine(0.1, 2.0, 6.0, dt=0.01)
    beyond = np.tile(np.geomspace(1e-4, 2e-3, 6), 2)
    height = np.repeat([0.2, 0.5], 6)
    half_width = height * np.abs(motion.acceleration[0]).max() / G / (1.0 + beyond)
    found = respond("rocking", motion, fidelity=fidelity, half_width=half_width, cg_height=height)
    body = bodies(prepare(model_named("rocking"), {"half_width": half_width, "cg_height": height}))
    restless = integrate(motion.excitation(0.0), body, np.zeros(12), 8, rest=1e-6)[:, RATIO]
    ratio, told = found["rotation_ratio"].to_numpy(), found["note"].str.contains("sensitive").to_numpy()
    hangs = np.abs(restless - ratio) > found["error"].to_numpy()
    assert (restless > 1000.0 * ratio).sum() >= 4
    assert told[hangs].all()


@pytest.mark.parametrize(
    ("name", "start", "samples", "factor", "given"),
    [
        # Before, the last three were off by up to 1.4 times of what both estimates granted together.
        ("swing", 5981, 3176, 1.9767224251616669, {"length": 0.1628865904354977, "damping": 0.022674610290003405}),
        ("swing_3d", 4221, 2635, 0.5939090070784281, {"length": 0.02046693625732521, "damping": 0.017259991341145548}),
        ("friction_isolator", 2711, 2750, 0.9307171496811589, {"friction_static": 0.12729131311593544}),
        ("friction_isolator", 2708, 3425, 1.0861948147970655, {"friction_static": 0.15357748635675178}),
    ],
)
def test_pieces_of_a_real_record(name: str, start: int, samples: int, factor: float, given: dict[str, float]) -> None:
    """Cut out of the demonstration's record where synthetic motions had shown nothing."""
    whole = read_motion(resource("site_motions", "demo"))[0]
    part = factor * whole.acceleration[:, start : start + samples]
    motion = Motion(name="piece", dt=whole.dt, acceleration=part)
    rows = [respond(name, motion, fidelity=fidelity, **given).iloc[0] for fidelity in ("history", "reference")]
    assert abs(rows[0].iloc[0] - rows[1].iloc[0]) <= rows[0]["error"] + rows[1]["error"]
