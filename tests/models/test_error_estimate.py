"""The estimated error covers what the reference finds: in 99 of 100 random cases, for every model."""

from __future__ import annotations

import numpy as np
import pytest
from shaking import along_x, random_motion

from pipeline import Motion, respond
from pipeline.models import MODELS
from pipeline.quantities import Array, G

ROWS, MOTIONS = 60, 4


def drawn(name: str, rng: np.random.Generator, n: int) -> dict[str, Array | float]:
    """Return n plausible museum objects for a model."""

    def log(low: float, high: float) -> Array:
        return np.exp(rng.uniform(np.log(low), np.log(high), n))

    def flat(low: float, high: float) -> Array:
        return rng.uniform(low, high, n)

    if name == "rocking":
        h = log(0.05, 2.0)
        return {"half_width": h * np.tan(flat(0.02, 0.7)), "cg_height": h}
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
]


@pytest.mark.parametrize("samples", [4, 500])
@pytest.mark.parametrize("name", CASES)
def test_the_estimated_error_covers_the_true_one(name: str, samples: int) -> None:
    """|history - reference| <= error, but for 1 case of 100, in records of any length.

    The reference is 8 times finer (8^4 in error), so its own error counts as nothing; 1e-13 of the value is rounding.
    A rocking body whose outcome is flagged sensitive has said so.
    """
    rng = np.random.default_rng(5)
    outside = []
    for seed in range(MOTIONS):
        motion = random_motion(50 + seed, n=samples, pga=rng.uniform(2.0, 12.0), vertical=0.5 * (seed % 2))
        parameters = drawn(name, rng, ROWS)
        history = respond(name.split(maxsplit=1)[0], motion, **parameters)
        reference = respond(name.split(maxsplit=1)[0], motion, fidelity="reference", **parameters)
        first = history.columns[0]
        missed = np.abs(history[first] - reference[first]).to_numpy()
        granted = history["error"].to_numpy() + 1e-13 * np.abs(reference[first].to_numpy())
        told = history["note"].str.contains("sensitive").to_numpy()
        outside.append((missed > granted) & ~told)
    share = 1.0 - np.concatenate(outside).mean()
    assert share >= 0.99, f"{name}: {100.0 * share:.1f} % of {ROWS * MOTIONS} cases covered"


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
