"""Bounded work: whatever the strength, the time step and the body, every call ends, and says what it did not follow."""

from __future__ import annotations

import multiprocessing as mp
import os
import queue
from multiprocessing.queues import Queue
from random import Random
from typing import Any

import numpy as np
import pytest
from shaking import random_motion, times

from pipeline import Motion, respond, trace, transmit
from pipeline.analysis.chart_runs import response_chart
from pipeline.errors import InputError
from pipeline.kernels.friction_line import MOST_PIECES
from pipeline.kernels.pendulum import MOST_STEPS, substeps
from pipeline.models import MODELS, model_named
from pipeline.quantities import G
from pipeline.records import Numerics
from pipeline.verification.self_measurement import complaint

pytestmark = pytest.mark.slow_file

LIMIT = 60.0
"""Seconds in which a call must end on a machine that is busy with other things; each takes well below two."""

ENDS: dict[str, dict[str, list[float]]] = {
    "rocking": {"half_width": [1e-3, 0.1, 3.0], "cg_height": [1e-2, 0.4, 10.0]},
    "standing": {"half_width": [1e-3, 0.1, 3.0], "cg_height": [1e-2, 0.4, 10.0], "friction_static": [0.05, 0.5, 5.0]},
    "sliding": {"friction_static": [0.0, 1e-6, 0.1, 5.0]},
    "friction_isolator": {"friction_static": [0.0, 1e-6, 0.1, 5.0]},
    "horizontal_isolator": {
        "frequency": [1e-3, 1.0, 1.0, 20.0, 1e5],
        "damping": [0.0, 0.05, 2.0, 0.0, 50.0],
        "friction": [0.05, 0.0, 1e-6, 5.0, 0.05],
    },
    "swing": {"length": [1e-6, 0.001, 1.0, 1.0, 100.0], "damping": [0.05, 0.0, 0.0, 50.0, 2.0]},
    "oscillator": {"frequency": [1e-3, 1.0, 1e5], "damping": [0.0, 0.05, 50.0]},
}
ENDS["swing_3d"] = ENDS["swing"]
ENDS["unanchored"] = ENDS["standing"]
ENDS["rotational_isolator"] = {**ENDS["oscillator"], "cg_height": [0.5], "inertia_ratio": [1.3]}
ENDS["unhooking"] = {
    "hook_height": [1e-6, 0.3, 100.0],
    "hook_offset": [0.0, 0.02, 1.0],
    "gyration": [1e-6, 0.3, 10.0],
    "restitution": [0.0, 0.3, 0.95],
}
ENDS["hanger_load"] = {"amplification": [1.0]}
ENDS["stress"] = {"mass": [5.0], "lever": [0.5], "area": [1e-3], "section_modulus": [1e-5]}
ENDS["flexible_stress"] = {**ENDS["stress"], **ENDS["oscillator"]}


def extremes() -> dict[str, Motion]:
    """Return motions of extreme strength and step, two of them without a vertical component."""
    base = random_motion(3, n=12, dt=0.02)
    strengths = {f"times {k:g}": times(base, k, k) for k in (1e-300, 1e-30, 1e-6, 1e6, 1e12)}
    level = {f"times {k:g}, level": times(base, k, 0.0) for k in (1e-300, 1e6)}
    steps = {f"dt {dt:g} s": Motion(dt, base.acceleration) for dt in (1e-6, 100.0)}
    return {**strengths, **level, **steps, "both": Motion(100.0, 1e6 * base.acceleration)}


def calls() -> list[tuple[str, Any]]:
    """Return every call by what it is: every model at every fidelity and in the worst direction, supports, charts."""
    listed: list[tuple[str, Any]] = []
    for label, motion in extremes().items():
        for model in MODELS:
            for directions in (1.0, 2.0) if model.directions == 0 else (None,):
                given: dict[str, Any] = dict(ENDS[model.name])
                given |= {} if directions is None else {"directions": directions}
                for fidelity in ("bound", "history", "reference") if label == "dt 100 s" else ("bound", "history"):
                    listed.append(
                        (f"{model.name} {directions} {fidelity} {label}", (model.name, motion, fidelity, given))
                    )
                if directions != 2.0 and model.directions != 2 and label in ("times 1e+06", "dt 100 s"):
                    worst = {**given, "angle": None, "azimuth_step": 90.0}
                    listed.append(
                        (f"{model.name} in the worst direction, {label}", (model.name, motion, "history", worst))
                    )
    return listed


WHOLE = bool(os.environ.get("KOUROS_GRID"))
"""Whether every call is made; else an eighth of them, always the same."""


def work(answers: Queue[Any]) -> None:
    """Make every call and put (what, complaint or "") into the queue."""
    chance = Random(20261122)
    for what, (name, motion, fidelity, given) in calls():
        if not WHOLE and chance.random() < 0.875:
            continue
        answers.put((what, None))
        try:
            table = respond(name, motion, fidelity=fidelity, **given)
        except InputError as problem:
            # Only what has no bounds, or a frequency beyond all steps, may be refused here.
            fair = "no guaranteed bounds" in str(problem) or ("too high for a time step" in str(problem))
            answers.put((what, "" if fair else repr(problem)))
            continue
        # A tension below zero is a compression.
        plain = table.drop(columns=["tension", "tension_least", "low", "high"], errors="ignore")
        wrong = [complaint(model_named(name), row) for _, row in plain.iterrows()]
        lost = table["note"].str.contains("not followed").to_numpy()
        first = table[table.columns[0]].to_numpy()
        if (table["error"].to_numpy()[lost] < 0.99 * first[lost]).any():
            wrong.append("what was not followed has an error below its value")
        answers.put((what, "; ".join(w for w in wrong if w)))
    answers.put(("done", ""))


@pytest.mark.long("test_a_pendulum_that_is_not_followed_is_out_by_its_length_at_most")
def test_every_call_ends_and_says_what_it_did_not_follow() -> None:
    """Nothing interrupts a compiled loop: the calls are made in a process that is ended when one takes too long."""
    context = mp.get_context("spawn")
    answers: Queue[Any] = context.Queue()
    worker = context.Process(target=work, args=(answers,), daemon=True)
    worker.start()
    what, wrong = "the start", []
    try:
        while what != "done":
            try:
                what, problem = answers.get(timeout=2.0 * LIMIT if what == "the start" else LIMIT)
            except queue.Empty:
                pytest.fail(f"takes more than {LIMIT:.0f} s: {what}; before that: {wrong}")
            if problem:
                wrong.append(f"{what}: {problem}")
    finally:
        worker.kill()
        worker.join()
    assert not wrong, f"{len(wrong)} calls, such as {wrong[:5]}"


@pytest.mark.parametrize("peak", [0.0, 5.0, 5e6, 5e300])
@pytest.mark.parametrize("dt", [1e-6, 0.02, 100.0])
def test_a_pendulum_takes_a_bounded_number_of_steps(peak: float, dt: float) -> None:
    """Counted, not timed: at most MOST_STEPS a sample, none for what needs more."""
    for length in (1e-6, 0.01, 1.0, 100.0):
        for damping in (0.0, 2.0, 50.0):
            assert 0 <= substeps(length, damping, peak, dt) <= MOST_STEPS


@pytest.mark.parametrize("name", ["swing", "swing_3d"])
def test_a_pendulum_that_is_not_followed_is_out_by_its_length_at_most(name: str) -> None:
    motion = times(random_motion(3, n=60, dt=0.02), 1e6, 1e6)
    row = respond(name, motion, length=1e-3, damping=0.05).iloc[0]
    assert (row["displacement"], row["error"]) == (1e-3, 1e-3)
    assert "not followed" in row["note"]


def test_an_isolator_that_is_not_followed_has_an_upper_bound() -> None:
    """A spring without damping and friction under a rectangle of A moves by 2 A / w^2 and passes 2 A on, exactly."""
    a = np.zeros((3, 6))
    a[0] = 1.0
    w = 2.0 * np.pi * MOST_PIECES / 0.02
    given = {"frequency": w / (2.0 * np.pi), "damping": 0.0, "friction": 0.0, "directions": 1}
    row = respond("horizontal_isolator", Motion(0.02, a), **given).iloc[0]
    assert "not followed" in row["note"]
    assert 2.0 / w**2 <= row["displacement"]
    assert 2.0 <= row["acceleration"] <= row["error"]


@pytest.mark.parametrize("name", ["swing", "swing_3d", "horizontal_isolator"])
def test_the_faintest_motion_is_answered_in_proportion(name: str) -> None:
    """1e-300 of a motion moves what nothing holds by 1e-294 of what 1e-6 of it does: linear, to 1e-9."""
    given: dict[str, Any] = {"length": 1.0, "damping": 0.05}
    if name == "horizontal_isolator":
        given = {"frequency": 1.0, "damping": 0.05, "friction": 0.0}
    base = random_motion(3, n=60, dt=0.02, vertical=0.0)
    faint, small = (respond(name, times(base, k, k), **given).iloc[0] for k in (1e-300, 1e-6))
    assert faint["displacement"] / 1e-300 == pytest.approx(small["displacement"] / 1e-6, rel=1e-9)
    assert 0.0 < faint["error"] < 0.1 * faint.iloc[0]


def test_supports_and_charts_end_too() -> None:
    """A support and a chart under a million times the shaking: an answer, or a refusal that names the length."""
    strong = times(random_motion(3, n=30, dt=0.02), 1e6, 1e6)
    passed = transmit("horizontal_isolator", strong, frequency=20.0, damping=0.05, friction=0.05, refine=1)
    assert np.isfinite(passed.acceleration).all()
    chart = response_chart("swing", strong, angle=0.0, damping=0.02, numerics=Numerics(tolerance=0.1, first=True))
    looked = chart.look(np.array([0.01, 1.0]))
    # No pendulum is out by more than it is long; the chart may be off by a tenth.
    assert (looked.columns["displacement"] <= [0.011, 1.1]).all()
    with pytest.raises(InputError, match="1e-05 m: such a pendulum is too fast"):
        trace("swing", strong, length=1e-5, damping=0.02)


def test_weight_is_that_of_the_record() -> None:
    """The bound of what is not followed holds under four times the weight: friction passes on mu N."""
    a = np.zeros((3, 6))
    a[0], a[2] = 1.0, 3.0 * G
    row = respond("horizontal_isolator", Motion(0.02, a), frequency=1e6, damping=0.0, friction=5.0, directions=1).iloc[
        0
    ]
    assert row["acceleration"] >= 5.0 * 4.0 * G


def test_the_two_directional_estimate_sees_what_both_passes_miss() -> None:
    """Sliding at `history` against `reference`, tolerances apart by 1e5: 600 bodies, none off by more than it says.

    Both passes take a stop in one closed form, so that their difference alone was short for 1 in 100.
    """
    rng = np.random.default_rng(12)
    for seed in range(6):
        motion = random_motion(200 + seed, n=500, dt=float(rng.choice([0.005, 0.01, 0.02])), pga=4.0)
        static = np.exp(rng.uniform(np.log(0.005), np.log(0.4), 100))
        given = {"friction_static": static, "friction_kinetic": static * rng.uniform(0.4, 1.0, 100)}
        history, reference = (respond("sliding", motion, fidelity=f, **given) for f in ("history", "reference"))
        missed = np.abs(history["displacement"] - reference["displacement"])
        told = history["note"].str.contains("sensitive")
        assert (missed <= history["error"])[~told].all()
        assert told.mean() < 0.1


@pytest.mark.parametrize("angle", [np.float64(30.0), np.int64(30), np.array(30.0), np.float32(30.0)])
def test_numbers_of_numpy_are_numbers(angle: Any) -> None:
    motion = random_motion(3, n=60)
    given = {"tail": np.int64(1), "length": np.float32(1.0), "damping": np.array(0.05)}
    assert respond("swing", motion, angle=angle, **given)["angle"].iloc[0] == 30.0


@pytest.mark.parametrize("bad", [True, np.bool_(True), float("nan"), 1j, "30", np.array([1.0, 2.0]), [[1.0], []]])
@pytest.mark.parametrize("name", ["angle", "tail", "azimuth_step", "tolerance", "length", "dt", "start", "v_max"])
def test_what_is_no_number_is_refused_by_name(name: str, bad: Any) -> None:
    motion = random_motion(3, n=60)
    if name == "length" and isinstance(bad, np.ndarray):
        return
    with pytest.raises(InputError, match=name):
        given_as(name, bad, motion)


def given_as(name: str, value: Any, motion: Motion) -> None:
    """Give a value by its name to the call that takes it."""
    if name in ("dt", "start", "v_max"):
        Motion(acceleration=motion.acceleration, **{"dt": 0.01, name: [value, 0.0, 0.0] if name == "start" else value})
        return
    fidelity = "chart" if name == "tolerance" else "history"
    respond("swing", motion, fidelity=fidelity, **{"length": 1.0, "damping": 0.1, "angle": 0.0, name: value})


@pytest.mark.parametrize(
    "bad", [np.ones((3, 5)) * 1j, np.full((3, 5), "1"), np.ones((3, 5), bool), np.full((3, 5), 1e60)]
)
def test_accelerations_are_real_numbers(bad: Any) -> None:
    with pytest.raises(InputError, match="acceleration"):
        Motion(0.01, bad)
    with pytest.raises(InputError, match="dt must be"):
        Motion(None, np.ones((3, 5)))  # type: ignore[arg-type]


def test_the_worst_of_directions_without_a_second_output_is_found() -> None:
    """What is not followed has no rotation in any direction: none is the larger, and the search still ends."""
    motion = times(random_motion(3, n=12, dt=0.02), 1e6, 1e6)
    row = respond("swing", motion, length=1e-3, damping=0.05, angle=None, azimuth_step=90.0).iloc[0]
    assert (row["displacement"], np.isnan(row["rotation"])) == (1e-3, True)
