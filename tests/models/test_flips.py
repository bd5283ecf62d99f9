"""Which rocking bodies 1 % of the amplitude throws over, or leaves standing: against a dense scan of amplitudes."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray
from shaking import random_motion, times

from pipeline import Motion, respond
from pipeline.analysis.model_runs import prepare, run_model
from pipeline.kernels import SENSITIVE
from pipeline.models import model_named
from pipeline.quantities import Array, G
from pipeline.records import Numerics

AMPLITUDES = np.linspace(-0.01, 0.01, 41)
"""Relative changes of the dense scan."""

SEEDS = (70, 71, 72, 73, 74)


def shaken(seed: int, n: int) -> tuple[Motion, dict[str, Array]]:
    """Return shaking of 0.3 to 0.7 g, and blocks of which some rest, some rock, and some fall."""
    rng = np.random.default_rng(seed)
    motion = random_motion(seed, n=1500, pga=rng.uniform(3.0, 7.0), vertical=0.5)
    height = np.exp(rng.uniform(np.log(0.05), np.log(2.0), n))
    return motion, {"half_width": height * np.tan(rng.uniform(0.05, 0.6, n)), "cg_height": height}


def outcomes(motion: Motion, values: dict[str, Array], angle: float, change: float) -> NDArray[np.bool_]:
    """Return which blocks the motion throws over at another amplitude, with the step of `history`."""
    excitation = times(motion, 1.0 + change, 1.0 + change).excitation(angle)
    found: NDArray[np.bool_] = model_named("rocking").run(excitation, values, 4, False)["overturned"] > 0.0
    return found


def told_of(motion: Motion, values: dict[str, Array], angle: float | None) -> tuple[NDArray[np.bool_], Array]:
    columns, _ = run_model(model_named("rocking"), motion, values, Numerics("history"), angle)
    return (columns["note"].astype(np.int64) & SENSITIVE) > 0, columns["overturned"] > 0.0


def test_nineteen_of_twenty_flips_are_told() -> None:
    """Of the blocks whose outcome one of 41 amplitudes within 1 % changes; of the others that lift an edge a third.

    On recorded motions, which shake less steadily, it is a fifth.  Those others have conditions above 1,000, flip
    between the 41 amplitudes, or jump from one way of falling to another: what is silent must be trusted.
    """
    flips, told, lifted = [], [], []
    for seed in SEEDS:
        motion, blocks = shaken(seed, 300)
        values = prepare(model_named("rocking"), blocks)
        said, fell = told_of(motion, values, 0.0)
        flips.append(np.any([outcomes(motion, values, 0.0, k) != fell for k in AMPLITUDES], axis=0))
        told.append(said)
        lifted.append(respond("rocking", motion, **blocks)["rotation_ratio"].to_numpy() > 0.0)
    flip, tell, lift = (np.concatenate(each) for each in (flips, told, lifted))
    assert flip.sum() >= 100
    assert tell[flip].mean() >= 0.95
    assert tell[lift & ~flip].mean() <= 0.33
    assert not tell[~lift].any()


@pytest.mark.long("test_nineteen_of_twenty_flips_are_told")
def test_flips_of_the_worst_direction_are_told() -> None:
    """With unknown orientation it is whether a block falls in any direction that counts: 11 amplitudes, half as strong.

    Of 20 flips one may be missed.  A block that falls in every direction hangs on none of them.
    """
    flips, told = [], []
    for seed in SEEDS[:3]:
        motion, blocks = shaken(seed, 250)
        motion = times(motion, 0.5, 0.5)
        values = prepare(model_named("rocking"), blocks)
        said, fell = told_of(motion, values, None)
        differs = []
        for change in AMPLITUDES[::4]:
            falls = np.zeros(fell.size, dtype=bool)
            for angle in np.arange(0.0, 180.0, 10.0):
                some = {name: value[~falls] for name, value in values.items()}
                falls[~falls] = outcomes(motion, some, float(angle), change)
            differs.append(falls != fell)
        flips.append(np.any(differs, axis=0))
        told.append(said)
    flip, tell = np.concatenate(flips), np.concatenate(told)
    assert flip.sum() >= 20
    assert tell[flip].mean() >= 0.95
    assert tell[~flip].mean() <= 0.15


@pytest.mark.parametrize("angle", [0.0, None])
def test_what_falls_at_once_is_not_told(angle: float | None) -> None:
    """A block pushed fifty times harder than what lifts it falls whatever 1 % of the amplitude does."""
    motion, _ = shaken(70, 1)
    slope = 0.02 * float(np.abs(motion.along(0.0)).max()) / G
    slender = respond("rocking", motion, half_width=[0.3 * slope], cg_height=0.3, angle=angle)
    assert slender["overturned"].all()
    assert slender["note"][0] == ""


def test_a_worst_direction_that_a_finer_step_does_not_confirm() -> None:
    """A slender body that falls over its nearer edge in some directions and over the other in most: the coarse step
    found it over the nearer one in 330 degrees, the finer one did not, and the next direction was not looked at, so
    that `reference` said 26.5 and `history` 33.9, each with an estimate of rounding.  The ratio is 90 degrees of the
    edge's own."""
    motion = random_motion(5, n=2000, pga=1.0)
    body = {"half_width": 0.0311, "cg_height": 0.67, "half_width_other": 0.0398}
    for fidelity in ("history", "reference"):
        row = respond("rocking", motion, fidelity=fidelity, angle=None, azimuth_step=30.0, **body).iloc[0]
        assert row["overturned"]
        assert row["rotation_ratio"] == pytest.approx(0.5 * np.pi / np.arctan2(0.0311, 0.67), rel=1e-12)
