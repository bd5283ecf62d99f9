"""Cost of each model per object and sample, beside a general integrator on the same work, and of the stages of a night.

Machines are noisy: read the ratios, not the times.
"""

import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from pipeline.models import model_named
from pipeline.motions import read_motion
from pipeline.quantities import Array, G
from pipeline.records import Excitation, Model, Motion
from pipeline.resources import resource
from pipeline.response import REFINE, prepare

OBJECTS = 512
SEED = 20190706


def shaking() -> Motion:
    """Return the demonstration's motion, repeated to 20,000 samples."""
    motion = read_motion(resource("site_motions", "demo"))[0]
    return Motion(motion.dt, np.tile(motion.acceleration, 2)[:, :20_000], motion.name)


def parameters() -> dict[str, tuple[float, dict[str, Array | float]]]:
    """Return, for each model, the ns per object and sample aimed at (NaN: none) and plausible objects (fixed seed)."""
    rng = np.random.default_rng(SEED)
    slope, height = rng.uniform(0.1, 1.5, OBJECTS), rng.uniform(0.1, 2.0, OBJECTS)
    friction, length = rng.uniform(0.1, 0.6, OBJECTS), rng.uniform(0.2, 3.0, OBJECTS)
    pad = {"frequency": rng.uniform(0.3, 3.0, OBJECTS), "damping": 0.02, "friction": rng.uniform(0.05, 0.2, OBJECTS)}
    return {
        "sliding, one direction": (10.0, {"friction_static": friction, "directions": 1.0}),
        "sliding, two directions": (np.nan, {"friction_static": friction, "directions": 2.0}),
        "rocking": (3.0, {"half_width": 0.5 * slope * height, "cg_height": 0.5 * height}),
        "swing": (8.0, {"length": length, "damping": 0.02}),
        "swing_3d": (80.0, {"length": length, "damping": 0.02}),
        "oscillator": (0.6, {"frequency": rng.uniform(0.5, 20.0, OBJECTS), "damping": 0.05}),
        "horizontal_isolator, one direction": (10.0, {**pad, "directions": 1.0}),
        "horizontal_isolator, two directions": (np.nan, {**pad, "directions": 2.0}),
        "rotational_isolator": (
            np.nan,
            {
                "frequency": rng.uniform(1.0, 8.0, OBJECTS),
                "damping": 0.2,
                "cg_height": height / 2,
                "inertia_ratio": 1.4,
            },
        ),
    }


def timed(work: Callable[[], object], times: int = 1) -> float:
    """Return the seconds of the fastest of so many calls after a first one, which compiles."""
    work()
    best = np.inf
    for _ in range(times):
        start = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - start)
    return best


def at_rest(model: Model, excitation: Excitation, values: dict[str, Array]) -> float:
    """Return the share of sample intervals in which nothing moves, of every 32nd object."""
    assert model.trace is not None
    shares = []
    for k in range(0, OBJECTS, 32):
        history = model.trace(excitation, {name: float(v[k]) for name, v in values.items()})
        place = history["rotation"] if "rotation" in history else history["u_x"]
        shares.append(np.mean(np.diff(place[: excitation.x.size]) == 0.0))
    return float(np.mean(shares))


def models() -> None:
    """Print the cost of a single pass of each model, along the record's strongest direction where it needs one."""
    motion = shaking()
    x, y, z = motion.acceleration
    along = max((x, y), key=lambda a: float(np.abs(a).max()))
    print(f"{motion.samples} samples, {OBJECTS} objects, one thread, peak {np.abs(along).max() / G:.1f} g")
    print(f"{'model':<38}{'ns per object and sample':>26}{'aim':>8}{'at rest':>9}")
    for title, (aim, given) in parameters().items():
        model = model_named(title.split(",")[0])
        values = prepare(model, given)
        two = model.directions == 2 or (model.directions == 0 and values["directions"][0] == 2.0)
        excitation = Excitation(motion.dt, x if two else along, y if two else None, z, None)

        def once(model: Model = model, excitation: Excitation = excitation, values: dict[str, Array] = values) -> None:
            model.run(excitation, values, REFINE["history"], False)

        cost = timed(once, 3) / OBJECTS / motion.samples * 1e9
        wanted = "" if np.isnan(aim) else f"{aim:g}"
        print(f"{title:<38}{cost:>26.2f}{wanted:>8}{at_rest(model, excitation, values):>9.0%}")


def peers() -> None:
    """Print how much faster the compiled swing is than scipy's general integrator, with the error of both."""
    motion = shaking()
    x, _, z = motion.acceleration
    t = motion.dt * np.arange(motion.samples)
    length, damping = 1.0, 0.02
    w = np.sqrt(G / length)

    def rates(at: float, state: Array) -> list[float]:
        a, n = np.interp(at, t, x), G + np.interp(at, t, z)
        return [
            state[1],
            -2 * damping * w * state[1] - (n * np.sin(state[0]) + a * np.cos(state[0])) / length,
        ]

    start = time.perf_counter()
    peer = solve_ivp(rates, (0.0, float(t[-1])), [0.0, 0.0], t_eval=t)
    slow = time.perf_counter() - start
    model = model_named("swing")
    values = prepare(model, {"length": np.full(OBJECTS, length), "damping": damping})
    excitation = Excitation(motion.dt, x, None, z, 0.0)
    fast = timed(lambda: model.run(excitation, values, 2, False)) / OBJECTS
    ours = float(model.run(excitation, values, 2, False)["displacement"][0])
    truth = float(model.run(excitation, values, 32, False)["displacement"][0])
    theirs = float(np.max(np.abs(length * np.sin(peer.y[0]))))
    print(f"swing, one object: {slow / fast:,.0f} times faster than scipy solve_ivp with its defaults")
    print(f"    error of the peak: ours {abs(ours / truth - 1):.1e}, theirs {abs(theirs / truth - 1):.1e}")


def night() -> None:
    """Print what the first and the second night of the demonstration cost."""
    from pipeline.cli.console import Console
    from pipeline.jobs.demo import demo

    with tempfile.TemporaryDirectory() as folder:
        for which in ("first", "second"):
            start = time.perf_counter()
            demo(Path(folder), Console(quiet=True))
            print(f"{which} night of the demonstration: {time.perf_counter() - start:.1f} s")


if __name__ == "__main__":
    models()
    peers()
    night()
