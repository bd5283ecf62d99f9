"""Extremes: nothing hangs, nothing is NaN without a note, nothing but ValueError is raised.

Each model's cases run in a process of their own, which is ended when it takes longer than it may: nothing else
interrupts a compiled loop.
"""

from __future__ import annotations

import json
import multiprocessing as mp
import queue
from multiprocessing.queues import Queue
from random import Random
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from shaking import along_x

from pipeline import Motion, respond
from pipeline.cli import kouros
from pipeline.models import MODELS
from pipeline.quantities import G
from pipeline.verification import self_measurement as numerics
from pipeline.verification.self_measurement import complaint, motions, pushed
from tests.soak import SOAK

pytestmark = pytest.mark.slow_file

LONG = pytest.mark.long("test_the_self_test_of_the_numerics")

LIMIT = 60.0
"""Seconds after which a case hangs, compilation excepted; on an idle machine all take well below ten."""
START = 60.0
"""Seconds that a process may take to start and compile."""


def work(answers: Queue[Any]) -> None:
    """Run every case of every model, or each day the same third, and put (case, problem or "") into the queue."""
    shaken, chance = motions(), Random(20261127)
    answers.put(("ready", ""))
    for model, directions in pushed():
        extra = {} if directions is None else {"directions": directions}
        columns = model.trials.extremes
        for label, motion in shaken.items():
            for row in range(len(next(iter(columns.values())))):
                one = {k: v[row] for k, v in columns.items()}
                for tail in (None, 0.0, 5.0) if label == "plain" else (None,):
                    if not SOAK and chance.random() > 1.0 / 6.0:
                        continue
                    case = f"{model.name} {one} {extra} under {label}, tail {tail}"
                    answers.put((case, None))
                    try:
                        table = respond(model.name, motion, tail=tail, **one, **extra)
                    except ValueError:
                        answers.put((case, ""))
                        continue
                    except Exception as problem:  # noqa: BLE001
                        answers.put((case, repr(problem)))
                        continue
                    answers.put((case, complaint(model, table.iloc[0])))
    answers.put(("done", ""))


@pytest.mark.long("test_the_self_test_of_the_numerics")
def test_nothing_hangs_or_is_nan_in_silence() -> None:
    """In one process for all models: what is compiled is loaded once."""
    context = mp.get_context("forkserver")
    answers: Queue[Any] = context.Queue()
    worker = context.Process(target=work, args=(answers,), daemon=True)
    worker.start()
    case, wrong, limit = "the start", [], START
    try:
        while case != "done":
            try:
                case, problem = answers.get(timeout=limit)
            except queue.Empty:
                pytest.fail(f"hangs for more than {limit:.0f} s: {case}; before that: {wrong}")
            limit = START if case == "ready" else LIMIT
            if problem:
                wrong.append(f"{case}: {problem}")
    finally:
        worker.kill()
        worker.join()
    assert not wrong, f"{len(wrong)} cases, such as {wrong[:3]}"


def asked_above(case: numerics.SelfTestCase) -> bool:
    """Whether it puts the same objects under the same motions as the test above, and asks the same of the answers."""
    return case.what.endswith("extreme objects") and not case.what.startswith("sliding")


@pytest.mark.parametrize(
    "case",
    [
        pytest.param(case, marks=LONG if case.what == "a million objects" else [])
        for case in numerics.CASES
        if not asked_above(case)
    ],
    ids=lambda case: f"{case.what}; {case.truth}",
)
def test_the_self_test_of_the_numerics(case: numerics.SelfTestCase) -> None:
    """The very cases that `kouros check --numerics` runs: each names its truth and its limit."""
    assert case.measure() <= case.limit


def test_every_model_in_time_is_pushed_to_its_extremes() -> None:
    """Stress has no history: it is a closed form of the peak; the flexible one is that of the oscillator."""
    assert {model.name for model, _ in pushed()} == {model.name for model in MODELS} - {
        "stress",
        "flexible_stress",
        "hanger_load",
    }
    assert all(model.trials.extremes for model in MODELS if model.trials.sample)
    assert {directions for model, directions in pushed() if model.name == "sliding"} == {1, 2}


@pytest.mark.parametrize("broken", [float("nan"), 2.0, ValueError("no kernel")])
def test_the_self_test_can_fail(broken: float | ValueError, monkeypatch: pytest.MonkeyPatch) -> None:
    """A NaN, a number above its limit and an exception are failures, and the cases after them still run."""

    def measure() -> float:
        if isinstance(broken, ValueError):
            raise broken
        return broken

    case = numerics.SelfTestCase
    cases = (case("broken", "one", 1.0, measure), case("sound", "zero", 0.0, lambda: 0.0))
    monkeypatch.setattr(numerics, "CASES", cases)
    first, second = numerics.outcomes()
    assert not first.ok
    assert first.problem == ("ValueError: no kernel" if isinstance(broken, ValueError) else "")
    assert second.ok
    said = CliRunner().invoke(kouros, ["check", "--numerics"], standalone_mode=False)
    assert said.return_value == 1
    assert said.stdout.startswith("failed   broken; one: ")
    assert "2 cases, 1 failed" in said.stdout
    plain = CliRunner().invoke(kouros, ["check", "--numerics", "--json"], standalone_mode=False)
    assert [row["ok"] for row in json.loads(plain.stdout)] == [False, True]
    monkeypatch.setattr(numerics, "CASES", cases[1:])
    assert not CliRunner().invoke(kouros, ["check", "--numerics"], standalone_mode=False).return_value


def test_a_nan_among_the_answers_is_seen(monkeypatch: pytest.MonkeyPatch) -> None:
    """Answers that are NaN fail every case that asks for one."""
    real = numerics.respond

    def ruined(*words: Any, **parameters: Any) -> Any:
        table = real(*words, **parameters)
        table.iloc[:, 0] = np.nan
        table["note"] = ""
        return table

    monkeypatch.setattr(numerics, "respond", ruined)
    asked = ("acceleration times", "swing", "a motion of zeros", "friction 5", "oscillator at", "sliding, 1 direction:")
    cases = tuple(case for case in numerics.CASES if case.what.startswith(asked))
    monkeypatch.setattr(numerics, "CASES", cases)
    assert len(cases) > 10
    assert not any(outcome.ok for outcome in numerics.outcomes())


def test_rocking_under_strong_vertical_motion_keeps_its_accuracy() -> None:
    """The step must shrink with the vertical acceleration as well: 100 g at 40 ms, against the reference."""
    t = np.arange(100) * 0.04
    z = 100.0 * G * np.abs(np.sin(2.0 * np.pi * 1.0 * t))
    x = 0.5 * (z + G) * np.sin(2.0 * np.pi * 1.7 * t)
    motion = Motion(0.04, np.vstack([x, 0.0 * x, z]))
    history = respond("rocking", motion, half_width=0.2, cg_height=0.5, tail=0.0).iloc[0]
    reference = respond("rocking", motion, half_width=0.2, cg_height=0.5, tail=0.0, fidelity="reference").iloc[0]
    assert history["overturned"] == reference["overturned"]
    assert history["rotation_ratio"] == pytest.approx(reference["rotation_ratio"], rel=1e-4)


def test_an_overdamped_isolator_on_friction_creeps_to_rest() -> None:
    """zeta > 1: it creeps back to |u| = mu g / w^2, from above and ever more slowly; that far it comes, to 1e-6."""
    f, zeta, mu = 1.0, 1.03, 0.05
    motion = along_x([3.0] * 60, 0.02)
    row = respond("horizontal_isolator", motion, frequency=f, damping=zeta, friction=mu, directions=1).iloc[0]
    assert row["residual"] <= mu * G / (2.0 * np.pi * f) ** 2 * (1.0 + 1e-6)
    assert row["residual"] <= row["displacement"]
