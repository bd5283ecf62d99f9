"""Extremes: nothing hangs, nothing is NaN without a note, nothing but ValueError is raised.

Each model's cases run in a process of their own, which is ended when it takes longer than it may: nothing else
interrupts a compiled loop.
"""

from __future__ import annotations

import multiprocessing as mp
import queue
from multiprocessing.queues import Queue
from typing import Any

import numpy as np
import pytest
from shaking import along_x, random_motion, times

from pipeline import Motion, respond
from pipeline.quantities import G

LIMIT = 20.0
"""Seconds that one case may take, the first one's compilation excepted."""
START = 60.0
"""Seconds that a process may take to start and compile."""


def motions() -> dict[str, Motion]:
    """Return the motions that a response must survive, by name."""
    base = random_motion(71, n=300, dt=0.02)
    a = base.acceleration
    return {
        "plain": base,
        "times 1e-6": times(base, 1e-6, 1e-6),
        "times 1000": times(base, 1000.0, 1000.0),
        "vertical below -g": times(base, 1.0, 6.0),
        "dt 0.5 ms": Motion(0.0005, a),
        "dt 40 ms": Motion(0.04, a),
        "one sample": Motion(0.02, a[:, 50:51]),
        "two samples": Motion(0.02, a[:, 50:52]),
        "denormals": Motion(0.02, 1e-310 * a),
        "zeros": Motion(0.02, 0.0 * a),
        "weightless": Motion(0.02, np.vstack([a[0], a[1], np.full(300, -G)])),
        "huge offset": Motion(0.02, a + 1e4),
    }


def objects(name: str) -> dict[str, list[float]]:
    """Return the extreme parameter sets of a model, as columns."""
    frictions = [0.0, 1e-6, 0.1, 5.0]
    if name == "rocking":
        alphas, e = np.array([0.02, 0.2, 1.2] * 3), np.repeat([0.0, 0.6, 1.0], 3)
        return {"half_width": list(0.3 * np.tan(alphas)), "cg_height": [0.3] * 9, "restitution": list(e)}
    if name in ("sliding", "friction_isolator"):
        return {"friction_static": frictions}
    if name == "horizontal_isolator":
        f, zeta, mu = np.meshgrid([0.02, 1.0, 500.0], [0.0, 1.0, 2.0], [0.0, 1e-6, 5.0])
        return {"frequency": list(f.ravel()), "damping": list(zeta.ravel()), "friction": list(mu.ravel())}
    if name.startswith("swing"):
        length, zeta = np.meshgrid([0.001, 0.01, 1.0, 100.0], [0.0, 1.0, 2.0])
        return {"length": list(length.ravel()), "damping": list(zeta.ravel())}
    f, zeta = np.meshgrid([0.02, 1.0, 20.0, 500.0], [0.0, 1.0, 2.0])
    out = {"frequency": list(f.ravel()), "damping": list(zeta.ravel())}
    if name == "rotational_isolator":
        out |= {"cg_height": [0.5] * f.size, "inertia_ratio": [1.3] * f.size}
    return out


def work(name: str, directions: int | None, answers: Queue[Any]) -> None:
    """Run every case of a model and put (case, problem or "") into the queue."""
    extra = {} if directions is None else {"directions": directions}
    answers.put(("ready", ""))
    columns = objects(name)
    chosen = motions()
    if name == "horizontal_isolator":
        # Its overdamped cases creep for the whole cap of 200 s: only the motions that ask something new of it.
        chosen = {k: chosen[k] for k in ("plain", "times 1000", "denormals", "zeros", "weightless")}
    for label, motion in chosen.items():
        for row in range(len(next(iter(columns.values())))):
            one = {k: v[row] for k, v in columns.items()}
            for tail in (None, 0.0, 5.0) if label == "plain" else (None,):
                case = f"{name} {one} {extra} under {label}, tail {tail}"
                answers.put((case, None))
                try:
                    table = respond(name, motion, tail=tail, **one, **extra)
                except ValueError:
                    answers.put((case, ""))
                    continue
                except Exception as problem:  # noqa: BLE001
                    answers.put((case, repr(problem)))
                    continue
                answers.put((case, complaint(table.iloc[0])))
    answers.put(("done", ""))


def complaint(row: Any) -> str:
    """Return what is wrong with a result: a NaN or an infinity that no note explains, a negative size."""
    for column, value in row.items():
        if column in ("overturning_time", "uplift_time", "angle", "fidelity", "note"):
            continue
        if not np.isfinite(float(value)) and not row["note"]:
            return f"{column} is {value} without a note"
        if float(value) < 0.0:
            return f"{column} is {value}"
    return ""


@pytest.mark.parametrize(
    ("name", "directions"),
    [
        ("rocking", None),
        ("sliding", 1),
        ("sliding", 2),
        ("friction_isolator", None),
        ("horizontal_isolator", 1),
        ("horizontal_isolator", 2),
        ("rotational_isolator", None),
        ("oscillator", None),
        ("swing", None),
        ("swing_3d", None),
    ],
)
def test_nothing_hangs_or_is_nan_in_silence(name: str, directions: int | None) -> None:
    context = mp.get_context("spawn")
    answers: Queue[Any] = context.Queue()
    worker = context.Process(target=work, args=(name, directions, answers), daemon=True)
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


def test_tiny_motions_scale() -> None:
    """A millionth of a motion is a millionth of the linear response: 1e-9 for what is linear, theta^2 for the swing."""
    motion = random_motion(72, vertical=0.0)
    small = times(motion, 1e-6, 1e-6)
    for name, parameters in (("oscillator", {"frequency": 2.0, "damping": 0.02}),):
        one, tiny = (respond(name, m, **parameters)["displacement"][0] for m in (motion, small))
        assert tiny == pytest.approx(1e-6 * one, rel=1e-9)
    for name in ("swing", "swing_3d"):
        one, tiny = (
            respond(name, m, length=1.0, damping=0.05)["displacement"][0] for m in (times(motion, 1e-3, 0.0), small)
        )
        assert tiny == pytest.approx(1e-3 * one, rel=1e-5)


@pytest.mark.parametrize(("dt", "n"), [(0.0005, 400), (0.04, 200)])
def test_any_sampling_against_the_reference(dt: float, n: int) -> None:
    """0.5 ms to 40 ms: history against the reference, within each model's promise."""
    motion = random_motion(73, n=n, dt=dt)
    cases: list[tuple[str, dict[str, float], float]] = [
        ("sliding", {"friction_static": 0.1}, 5e-4),
        ("swing", {"length": 0.01, "damping": 0.1}, 1e-6),
        ("swing_3d", {"length": 0.01, "damping": 0.1}, 1e-4),
        ("oscillator", {"frequency": 100.0, "damping": 0.02}, 1e-9),
        ("horizontal_isolator", {"frequency": 10.0, "damping": 0.1, "friction": 0.05}, 5e-4),
        ("rocking", {"half_width": 0.2, "cg_height": 0.5}, 1e-4),
    ]
    for name, parameters, rel in cases:
        history = respond(name, motion, **parameters).iloc[0]
        reference = respond(name, motion, fidelity="reference", **parameters).iloc[0]
        assert history.iloc[0] == pytest.approx(reference.iloc[0], rel=rel, abs=1e-9), name


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
