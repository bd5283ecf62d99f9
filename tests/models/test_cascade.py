"""Chains of supports: the error that is asked is met and told, nothing is passed on that the support does not feel."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest
from shaking import along_x, random_motion, turned

from pipeline import Motion, respond, transmit
from pipeline.analysis.transmission import cascade
from pipeline.quantities import G
from pipeline.supports.refining import difference

Chain = list[tuple[str, dict[str, Any]]]


def drawn(rng: np.random.Generator, name: str) -> tuple[str, dict[str, Any]]:
    """Return a plausible support of that name."""
    if name == "friction_isolator":
        mu = rng.uniform(0.03, 0.3)
        return name, {"friction_static": mu, "friction_kinetic": mu * rng.uniform(0.7, 1.0)}
    if name == "horizontal_isolator":
        spring = {"frequency": rng.uniform(0.3, 2.0), "damping": rng.uniform(0.0, 0.2)}
        return name, {**spring, "friction": rng.uniform(0.01, 0.15)}
    if name == "plinth":
        return name, {"frequency": np.exp(rng.uniform(np.log(2.0), np.log(40.0))), "damping": rng.uniform(0.02, 0.1)}
    pad = {"frequency": rng.uniform(2.0, 8.0), "damping": rng.uniform(0.05, 0.3)}
    return name, {**pad, "cg_height": 0.5, "inertia_ratio": rng.uniform(1.0, 2.0)}


def told(motion: Motion) -> float:
    """Return the error that a motion's steps own up to, of all its supports together."""
    reached = [re.search(r"(?:within|off by up to) ([\d.e-]+)", step) for step in motion.steps]
    return sum(float(found.group(1)) for found in reached if found)


CHAINS = [
    ["friction_isolator"],
    ["horizontal_isolator"],
    ["plinth"],
    ["rotational_isolator"],
    ["plinth", "friction_isolator"],
    ["horizontal_isolator", "plinth"],
]


def test_the_error_told_covers_the_true_one() -> None:
    """Objects of 2 to 20 Hz on random chains, slipping ones too, against the same chain sampled 256 times as finely.

    That leaves (1 / 16)^2 of the error at the finest step chosen here; 99 of 100 cases must be covered.
    """
    rng = np.random.default_rng(3)
    covered, frequencies = [], np.array([2.0, 3.3, 7.0, 13.0, 20.0])
    for seed in range(18):
        names = CHAINS[seed % len(CHAINS)]
        plain = random_motion(70 + seed, n=250, dt=float(rng.choice([0.01, 0.02])), pga=rng.uniform(3.0, 10.0))
        chain = [drawn(rng, name) for name in names]
        asked = float(rng.choice([1e-2, 3e-3, 1e-3]))
        got = cascade(chain, plain, error=asked)
        assert told(got) <= asked
        fine = plain
        for (name, parameters), refine in zip(chain, (256,) if len(chain) == 1 else (64, 4), strict=True):
            fine = transmit(name, fine, refine=refine, **parameters)
        for angle in (0.0, 90.0):
            given = {"angle": angle, "frequency": frequencies, "damping": 0.05}
            one, other = (respond("oscillator", m, **given)["displacement"].to_numpy() for m in (got, fine))
            covered.append(np.abs(one - other) <= told(got) * other)
    assert np.concatenate(covered).mean() >= 0.99


def test_a_jump_costs_the_square_of_the_step() -> None:
    """Twice as fine, at most 1 / 3 of the error is left (1 / 4 in the limit), where samples of a jump leave half.

    The median of ten random slipping isolators, from 4 to 16 samples for each of the record's.
    """
    rng = np.random.default_rng(4)
    left = []
    for seed in range(10):
        motion = random_motion(90 + seed, n=250, pga=8.0)
        name, parameters = drawn(rng, "friction_isolator")
        fine = transmit(name, motion, refine=128, **parameters)
        off = [difference(transmit(name, motion, refine=r, **parameters), fine) for r in (4, 8, 16)]
        left += [off[1] / off[0], off[2] / off[1]]
    assert np.median(left) <= 1.0 / 3.0


@pytest.mark.parametrize("refine", [1, 3])
def test_no_corner_is_beyond_the_friction(refine: int) -> None:
    """Without vertical motion |a| <= mu_s g at every instant, and so for the polygon; 1e-12 is rounding."""
    for seed in range(6):
        motion = random_motion(100 + seed, vertical=0.0)
        out = transmit("friction_isolator", motion, refine=refine, friction_static=0.1, friction_kinetic=0.07)
        assert np.hypot(*out.acceleration[:2]).max() <= 0.1 * G * (1.0 + 1e-12)


def test_what_lifts_an_object_on_an_isolator_is_not_exaggerated() -> None:
    """|a| / N, against which slopes are held, with vertical motion: mu_s at most where friction alone acts.

    A corner is held to the shares of its neighbours, the means among them, and a mean of mu N over two steps of 5 ms
    differs from its middle by h^2 / 12 N'' / N, 0.4 % for the 12 Hz that shake it up and down with 2.5 m/s2.
    """
    motion = random_motion(110, vertical=0.5)
    out = transmit("friction_isolator", motion, refine=2, friction_static=0.1)
    x, y, z = out.acceleration
    assert (np.hypot(x, y) / (G + z)).max() <= 0.1 * 1.005


def test_what_is_passed_on_knows_no_axes() -> None:
    """Turning the ground turns it: the limits are circles.  1e-9 of a peak is rounding, second differences included."""
    motion = random_motion(111)
    given = {"frequency": 6.0, "damping": 0.05}
    one = turned(transmit("plinth", motion, refine=2, **given), 30.0)
    other = transmit("plinth", turned(motion, 30.0), refine=2, **given)
    n = min(one.samples, other.samples)
    scale = np.abs(one.acceleration).max()
    np.testing.assert_allclose(one.acceleration[:, :n], other.acceleration[:, :n], rtol=0.0, atol=1e-9 * scale)


def test_an_error_out_of_reach_is_said_plainly() -> None:
    """64 samples for each of the record's is the end: what is left is told, and is more than what was asked."""
    motion = random_motion(112, n=100)
    out = transmit("friction_isolator", motion, error=1e-9, friction_static=0.1)
    assert round(motion.dt / out.dt) == 64
    assert "64 samples for each of its input" in out.steps[-1]
    assert re.search(r"is off by up to [\d.e-]+, more than the 1e-09 asked$", out.steps[-1])
    assert told(out) > 1e-9


def test_nothing_is_refined_where_nothing_jumps_or_moves() -> None:
    """A body that its friction holds hands its input on as it came, sample by sample."""
    motion = random_motion(113, n=100)
    out = transmit("friction_isolator", motion, error=1e-9, friction_static=5.0)
    assert out.dt == motion.dt
    np.testing.assert_allclose(out.acceleration, motion.acceleration, rtol=0.0, atol=1e-12)


def test_a_chain_is_its_supports_one_after_the_other() -> None:
    """Each with its share of the error, in the order from the ground up; no support: the motion itself."""
    motion = random_motion(114, n=100)
    plinth, pad = ("plinth", {"frequency": 8.0, "damping": 0.05}), ("friction_isolator", {"friction_static": 0.1})
    below = transmit(plinth[0], motion, error=1e-3, **plinth[1])
    assert cascade([plinth, pad], motion, error=2e-3).hash == transmit(pad[0], below, error=1e-3, **pad[1]).hash
    assert cascade([pad, plinth], motion).hash != cascade([plinth, pad], motion).hash
    assert cascade([], motion) is motion


@pytest.mark.parametrize("error", [0.0, -1.0, float("nan"), "small"])
def test_an_error_that_is_none_is_refused(error: Any) -> None:
    motion = along_x([1.0] * 3, 0.01)
    with pytest.raises(ValueError, match="error must be a number above 0"):
        transmit("plinth", motion, error=error, frequency=8.0, damping=0.05)
    with pytest.raises(ValueError, match="error must be a number above 0"):
        cascade([], motion, error=error)
