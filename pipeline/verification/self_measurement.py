"""The numerical self-test: the compiled kernels of this very machine at the extremes, each against its exact limit."""

import tracemalloc
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from time import perf_counter
from typing import Any

import numpy as np

from pipeline.analysis.response import respond, trace
from pipeline.models import MODELS
from pipeline.quantities import Array, G, counted
from pipeline.records import Model, Motion
from pipeline.verification.outcome import Outcome

STRONG = 5.0
"""Peak of each horizontal component of the shaking [m/s2]."""

BESIDE = ("angle", "fidelity", "note")
"""Columns beside the outputs and their error, which may be empty or are not numbers."""


def shaking(samples: int = 300, dt: float = 0.02, vertical: float = 0.5) -> Motion:
    """Return band-limited random shaking (0.4 to 12 Hz) that rises and decays, the same at each call.

    Parameters
    ----------
    samples : int
        How many.
    dt : float
        Time step in s.
    vertical : float
        Peak of the vertical relative to that of each horizontal.

    Returns
    -------
    Motion
        With peaks of STRONG in the horizontals.
    """
    rng = np.random.default_rng(71)
    t = np.arange(samples) * dt
    envelope = np.sin(np.pi * (t + 0.5 * dt) / (t[-1] + dt)) ** 0.7
    a = np.zeros((3, samples))
    for row, share in enumerate((1.0, 1.0, vertical)):
        tones, phases = np.exp(rng.uniform(np.log(0.4), np.log(12.0), (14, 1))), rng.uniform(0.0, 2.0 * np.pi, (14, 1))
        a[row] = envelope * np.sin(2.0 * np.pi * tones * t + phases).sum(axis=0)
        a[row] *= share * STRONG / np.abs(a[row]).max()
    return Motion(dt, a, "shaking")


def along_x(values: Array, dt: float, vertical: float = 0.0) -> Motion:
    """Return a motion with given samples along x, and a constant vertical acceleration.

    Parameters
    ----------
    values : array, shape (n,)
        In m/s2.
    dt : float
        Time step in s.
    vertical : float
        In m/s2, up.

    Returns
    -------
    Motion
        With nothing along y.
    """
    return Motion(dt, np.vstack([values, np.zeros_like(values), np.full_like(values, vertical)]))


def motions() -> dict[str, Motion]:
    """Return the motions that a response must survive, by name."""
    base = shaking()
    a = base.acceleration
    return {
        "plain": base,
        "times 1e-6": Motion(base.dt, 1e-6 * a),
        "times 1000": Motion(base.dt, 1000.0 * a),
        "vertical below -g": Motion(base.dt, a * np.array([[1.0], [1.0], [6.0]])),
        "dt 0.5 ms": Motion(0.0005, a),
        "dt 40 ms": Motion(0.04, a),
        "one sample": Motion(0.02, a[:, 50:51]),
        "two samples": Motion(0.02, a[:, 50:52]),
        "denormals": Motion(0.02, 1e-310 * a),
        "zeros": Motion(0.02, 0.0 * a),
        "weightless": Motion(0.02, np.vstack([a[0], a[1], np.full(300, -G)])),
        "huge offset": Motion(0.02, a + 1e4),
    }


def pushed() -> list[tuple[Model, int | None]]:
    """Return each model that is integrated in time, and in how many directions where it can be told.

    Returns
    -------
    list of (Model, int or None)
        Those of the registry with extreme objects; a model that takes both comes once for each.
    """
    return [
        (model, directions)
        for model in MODELS
        if model.trials.extremes
        for directions in ((1, 2) if model.directions == 0 else (None,))
    ]


def complaint(model: Model, row: Mapping[str, Any]) -> str:
    """Return what is wrong with a result: a NaN or an infinity that no note explains, a negative size.

    Parameters
    ----------
    model : Model
        Whose optional outputs may be empty.
    row : mapping
        One row of the table of `respond`.

    Returns
    -------
    str
        "" where nothing is.
    """
    may_be_empty = {*BESIDE, *(q.name for q in model.gives if q.optional)}
    for column, value in row.items():
        if column in may_be_empty:
            continue
        if not np.isfinite(float(value)) and not row["note"]:
            return f"{column} is {value} without a note"
        if float(value) < 0.0:
            return f"{column} is {value}"
    return ""


@dataclass(frozen=True)
class SelfTestCase:
    """An extreme, the truth that it is held against, and how far off it may be.

    Attributes
    ----------
    what, truth : str
        The extreme, and what it is held against.
    limit : float
        The largest result that is accepted.
    measure : callable
        Returns what is held against the limit: a relative error where nothing else is said.
    """

    what: str
    truth: str
    limit: float
    measure: Callable[[], float]


def outcomes() -> Iterator[Outcome]:
    """Run each case and yield its outcome; a case that fails does not stop the others."""
    for case in CASES:
        start = perf_counter()
        result, problem = np.nan, ""
        try:
            result = float(case.measure())
        except Exception as wrong:  # noqa: BLE001 - a self-test reports whatever its cases raise
            problem = f"{type(wrong).__name__}: {wrong}"
        # A NaN is not within any limit.
        ok, number = result <= case.limit, result if np.isfinite(result) else None
        yield Outcome(case.what, case.truth, number, case.limit, ok, perf_counter() - start, problem)


def _worst(got: Any, want: Any, scale: Any = None) -> float:
    got, want = np.asarray(got, dtype=np.float64), np.asarray(want, dtype=np.float64)
    return float(np.max(np.abs(got - want) / (np.abs(want) if scale is None else scale)))


def _largest(values: Iterable[float]) -> float:
    # Unlike max(), which passes a NaN over.
    return float(np.max(list(values)))


def _ground(a: Array, dt: float) -> Array:
    # Displacement (n,) of a base at its samples, exact for the polygon.
    v = np.concatenate([[0.0], np.cumsum(0.5 * dt * (a[1:] + a[:-1]))])
    return np.concatenate([[0.0], np.cumsum(v[:-1] * dt + dt**2 * (2.0 * a[:-1] + a[1:]) / 6.0)])


def _in_space(motion: Motion, friction: float) -> float:
    # What nothing holds stays in space: u = -ground displacement.
    want = -_ground(motion.acceleration[0], motion.dt)
    moved = [trace("sliding", motion, friction_static=friction, directions=d)["u_x"][: want.size] for d in (1, 2)]
    return _largest(_worst(u, want, np.abs(want).max()) for u in moved)


def _newmark(friction: Array, directions: int, peak: float = 0.5 * G, duration: float = 0.2) -> float:
    # d = V^2 / (2 mu g) (1 - mu g / A), V = A T (Newmark 1965): two samples are a rectangular pulse.
    pulse = along_x(np.full(2, -peak), duration)
    tail = 1.1 * peak * duration / (float(friction.min()) * G)
    slid = respond("sliding", pulse, friction_static=friction, directions=directions, tail=tail)["displacement"]
    coast = (peak * duration) ** 2 / (2.0 * friction * G)
    return _worst(slid, coast * np.maximum(0.0, 1.0 - friction * G / peak), coast)


def step_response(x: Array, zeta: float) -> Array:
    """Return w^2 u / A of an oscillator under a suddenly applied force: the four textbook branches.

    Parameters
    ----------
    x : array, shape (n,)
        w t in rad.
    zeta : float
        Damping, ratio to critical.

    Returns
    -------
    array, shape (n,)
        Relative to the static response.
    """
    if zeta < 1.0:
        d = np.sqrt(1.0 - zeta**2)
        return np.asarray(1.0 - np.exp(-zeta * x) * (np.cos(d * x) + zeta / d * np.sin(d * x)))
    if zeta == 1.0:
        return np.asarray(1.0 - (1.0 + x) * np.exp(-x))
    k = np.sqrt(zeta**2 - 1.0)
    s1, s2 = -zeta + k, -zeta - k
    return np.asarray(1.0 + (s2 * np.exp(s1 * x) - s1 * np.exp(s2 * x)) / (s1 - s2))


def _steps(zeta: float) -> float:
    errors = []
    for frequency in (0.02, 1.0, 20.0, 500.0):
        w = 2.0 * np.pi * frequency
        history = trace("oscillator", along_x(np.full(501, -3.0), 0.02), frequency=frequency, damping=zeta)
        want = 3.0 / w**2 * step_response(w * history["t"].to_numpy(), zeta)
        errors.append(_worst(history["u_x"], want, 3.0 / w**2))
    return _largest(errors)


def _static(name: str, **extra: float) -> float:
    # w -> infinity: u = -a / w^2.  What the kinks of the polygon add is at most 2 / (w dt) of the peak: 1 / w dt here.
    motion, w = shaking(vertical=0.0), 2.0 * np.pi * 500.0
    asked: dict[str, Any] = {"frequency": 500.0, "damping": 1.0, "tail": 0.0, **extra}
    moved = respond(name, motion, **asked)["displacement"]
    return _worst(moved, np.abs(motion.acceleration[0]).max() / w**2)


def _soft() -> float:
    # w -> 0: u = -ground displacement; what is left is about (w t)^2 = 1e-6 here.
    motion = shaking(vertical=0.0)
    w = 1e-3 / motion.duration
    moved = respond("oscillator", motion, frequency=w / (2.0 * np.pi), damping=0.0, tail=0.0)["displacement"]
    return _worst(moved, np.abs(_ground(motion.acceleration[0], motion.dt)).max())


def _tilted(name: str, length: float) -> float:
    # Undamped, under a suddenly applied constant a, it swings about atan(a / g) and out to twice that (energy).
    a = 2.0
    swing = respond(name, along_x(np.full(801, a), 0.02), length=length, damping=0.0, tail=0.0)["displacement"]
    return _worst(swing, length * np.sin(2.0 * np.arctan(a / G)))


def _crept(name: str) -> float:
    # Overdamped it creeps to the angle at which it would hang for good.
    a = 2.0
    still = along_x(np.full(4001, a), 0.02)
    swung = respond(name, still, length=[0.001, 1.0], damping=[1.0, 2.0], tail=0.0)["displacement"]
    return _worst(swung, np.array([0.001, 1.0]) * np.sin(np.arctan(a / G)))


def _uplift(alpha: float) -> float:
    # Lifts at a = g tan(alpha), to a part in 1e9, and not below: 0 where both are right.
    body = {"half_width": 0.5 * np.tan(alpha), "cg_height": 0.5}
    ratios = [
        respond("rocking", along_x(np.full(2, G * np.tan(alpha) * k), 0.01), **body)["rotation_ratio"][0]
        for k in (1.0 - 1e-9, 1.0 + 1e-9)
    ]
    return float(ratios[0] > 0.0) + float(ratios[1] == 0.0)


def _released(alpha: float, e: float) -> float:
    # Let go at half its angle it comes down, and e times the rate is left: with phi the rotation, by energy,
    # cos(alpha - phi) - cos(alpha) is e^2 of what it was (Housner 1963).  Of alpha.
    dt = 0.0005
    still = along_x(np.zeros(round(4.0 / dt)), dt)
    theta = trace(
        "rocking", still, half_width=0.5 * np.tan(alpha), cg_height=0.5, restitution=e, initial_rotation=0.5 * alpha
    )["rotation"]
    peak = -float(theta.to_numpy().min())
    if e == 0.0:
        return peak / alpha
    left = np.cos(alpha) + e**2 * (np.cos(0.5 * alpha) - np.cos(alpha))
    return _worst(peak, alpha - np.arccos(left), alpha)


def _scaled(k: float) -> float:
    # k times the motion is k times what is linear, and k times the slip where the friction is k times as well.
    motion = shaking(vertical=0.0)
    larger = Motion(motion.dt, k * motion.acceleration)
    stiff: dict[str, Any] = {"frequency": 2.0, "damping": 0.02}
    linear = [respond("oscillator", m, **stiff)["displacement"] for m in (motion, larger)]
    slid = [
        respond("sliding", m, friction_static=0.1 * times, directions=1)["displacement"]
        for m, times in ((motion, 1.0), (larger, k))
    ]
    return _largest(_worst(large, k * small) for small, large in (linear, slid))


def _small_swings() -> float:
    # A thousandth of a small swing is a thousandth of it, but for theta^2 / 16.
    base = shaking(vertical=0.0)
    small, tiny = (Motion(base.dt, k * base.acceleration) for k in (1e-3, 1e-6))
    return _largest(
        _worst(*(k * respond(n, m, length=1.0, damping=0.05)["displacement"] for k, m in ((1.0, tiny), (1e-3, small))))
        for n in ("swing", "swing_3d")
    )


def _sampled(model: Model, dt: float) -> float:
    motion = shaking(samples=400, dt=dt)
    parameters: dict[str, Any] = dict(model.trials.sample)
    history, reference = (
        float(respond(model.name, motion, fidelity=fidelity, **parameters).iloc[:, 0].to_numpy()[0])
        for fidelity in ("history", "reference")
    )
    return abs(history - reference) / max(abs(reference), 1e-12)


def _long() -> float:
    # The steady state under 3 million samples of a sine at resonance: u = A / (2 zeta w^2), A that of the polygon's
    # fundamental; its harmonics, 1 / per_cycle^2 and less, are granted.
    per_cycle, zeta, dt = 400, 0.05, 0.0025
    w = 2.0 * np.pi / (per_cycle * dt)
    x = np.sin(2.0 * np.pi / per_cycle * np.arange(3_000_000))
    moved = respond("oscillator", along_x(x, dt), frequency=w / (2.0 * np.pi), damping=zeta, tail=0.0)["displacement"]
    return _worst(moved, np.sinc(1.0 / per_cycle) ** 2 / (2.0 * zeta * w**2))


def _million() -> float:
    return _newmark(np.linspace(0.1, 0.6, 1_000_000), 1)


def _memory() -> float:
    # Bytes held at the worst moment for each of many objects; fewer than a million, as tracing takes its time.
    count = 100_000
    friction = np.linspace(0.1, 0.6, count)
    tracemalloc.start()
    try:
        _newmark(friction, 1)
        return tracemalloc.get_traced_memory()[1] / count
    finally:
        tracemalloc.stop()


def _moved(motion: str) -> float:
    # Metres, or a share of an angle.
    return _largest(_answers(*one, motion).iloc[:, 0].to_numpy().max() for one in pushed())


def _answers(model: Model, directions: int | None, motion: str) -> Any:
    asked: dict[str, Any] = {**model.trials.extremes, "tail": 1.0}
    if directions is not None:
        asked["directions"] = directions
    return respond(model.name, motions()[motion], **asked)


def _unexplained(model: Model, directions: int | None) -> float:
    problems = [
        f"{motion}: {said}"
        for motion in motions()
        for _, row in _answers(model, directions, motion).iterrows()
        if (said := complaint(model, row))
    ]
    if problems:
        raise ArithmeticError(f"{counted(len(problems), 'result')}, such as {problems[0]}")
    return 0.0


def _cases() -> Iterator[SelfTestCase]:
    plain = shaking(vertical=0.0)
    sunk = Motion(plain.dt, np.vstack([plain.acceleration[:2], np.full((1, plain.samples), -2.0 * G)]))
    stays = "it stays in space: minus the ground's displacement"
    yield SelfTestCase("friction 0", stays, 1e-9, partial(_in_space, plain, 0.0))
    yield SelfTestCase("vertical below -g: no friction", stays, 1e-9, partial(_in_space, sunk, 0.3))
    for directions, limit in ((1, 1e-11), (2, 1e-5)):
        for mu in (1e-6, 0.2):
            what = f"friction {mu:g}, {directions} direction{'s'[: directions - 1]}, two samples"
            yield SelfTestCase(what, "Newmark 1965", limit, partial(_newmark, np.array([mu]), directions))
    yield SelfTestCase("friction 5", "does not move", 0.0, partial(_newmark, np.array([5.0]), 2))
    for zeta in (0.0, 1.0, 2.0):
        what = f"damping {zeta:g}, 0.02 to 500 Hz at dt 0.02"
        yield SelfTestCase(what, "closed form of the step response", 1e-9, partial(_steps, zeta))
    yield SelfTestCase("oscillator at 500 Hz", "static: u = a / w^2", 0.03, partial(_static, "oscillator"))
    isolated = {"friction": 0.0, "directions": 1.0}
    yield SelfTestCase(
        "isolator at 500 Hz", "static: u = a / w^2", 0.03, partial(_static, "horizontal_isolator", **isolated)
    )
    yield SelfTestCase("oscillator at 3e-5 Hz", stays, 1e-5, _soft)
    for name, limit in (("swing", 1e-6), ("swing_3d", 1e-4)):
        for length in (0.001, 0.01, 1.0, 100.0):
            what = f"{name}, {length:g} m, undamped"
            yield SelfTestCase(what, "twice the tilt, by energy", limit, partial(_tilted, name, length))
        yield SelfTestCase(f"{name}, damping 1 and 2", "hangs tilted", limit, partial(_crept, name))
    for alpha in (0.02, 0.2, 1.2):
        yield SelfTestCase(f"slenderness {alpha:g} rad", "lifts at g tan(alpha)", 0.0, partial(_uplift, alpha))
        for e in (0.0, 0.6, 1.0):
            what = f"slenderness {alpha:g} rad, restitution {e:g}"
            yield SelfTestCase(what, "energy after an impact (Housner 1963)", 1e-5, partial(_released, alpha, e))
    for k in (1e-6, 1000.0):
        yield SelfTestCase(f"acceleration times {k:g}", "scales", 1e-9, partial(_scaled, k))
    yield SelfTestCase("swings of 1e-3 and 1e-6 of it", "scale", 1e-5, _small_swings)
    for dt in (0.0005, 0.04):
        for model in MODELS:
            if model.trials.sample:
                what = f"{model.name} at dt {1000.0 * dt:g} ms"
                yield SelfTestCase(what, "reference", model.trials.promised, partial(_sampled, model, dt))
    yield SelfTestCase("one sample", "does not move", 0.0, partial(_moved, "one sample"))
    yield SelfTestCase("3 million samples", "steady state at resonance", 1e-5, _long)
    yield SelfTestCase("a million objects", "Newmark 1965", 1e-11, _million)
    yield SelfTestCase("many objects: memory", "bytes for each object", 1000.0, _memory)
    yield SelfTestCase("denormal accelerations", "nothing that can be seen", 1e-290, partial(_moved, "denormals"))
    yield SelfTestCase("a motion of zeros", "does not move", 0.0, partial(_moved, "zeros"))
    for model, ways in pushed():
        what = model.name if ways is None else f"{model.name}, {ways} direction{'s'[: ways - 1]}"
        yield SelfTestCase(
            f"{what}: {counted(len(motions()), 'motion')}, extreme objects",
            "no NaN without a reason",
            0.0,
            partial(_unexplained, model, ways),
        )


CASES = tuple(_cases())
"""Every extreme that the self-test runs."""
