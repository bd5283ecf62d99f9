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
from pipeline.models.common import Quiet
from pipeline.motions import read_motion
from pipeline.quantities import Array, G
from pipeline.records import Excitation, Motion
from pipeline.resources import resource
from pipeline.response import prepare

OBJECTS = 512
SEED = 20190706


def shaking() -> Motion:
    """Return the demonstration's motion, repeated to 20,000 samples."""
    motion = read_motion(resource("site_motions", "demo"))[0]
    return Motion(motion.dt, np.tile(motion.acceleration, 2)[:, :20_000], motion.name)


def parameters() -> dict[str, dict[str, Array | float]]:
    """Return parameters of plausible objects for each model (fixed seed)."""
    rng = np.random.default_rng(SEED)
    slope, height = rng.uniform(0.1, 1.5, OBJECTS), rng.uniform(0.1, 2.0, OBJECTS)
    return {
        "sliding": {"friction_static": rng.uniform(0.1, 0.6, OBJECTS)},
        "rocking": {"half_width": 0.5 * slope * height, "cg_height": 0.5 * height},
        "swing": {"length": rng.uniform(0.2, 3.0, OBJECTS), "damping": 0.02},
        "swing_3d": {"length": rng.uniform(0.2, 3.0, OBJECTS), "damping": 0.02},
        "oscillator": {"frequency": rng.uniform(0.5, 20.0, OBJECTS), "damping": 0.05},
        "horizontal_isolator": {
            "frequency": rng.uniform(0.3, 3.0, OBJECTS),
            "damping": 0.02,
            "friction": rng.uniform(0.05, 0.2, OBJECTS),
        },
        "rotational_isolator": {
            "frequency": rng.uniform(1.0, 8.0, OBJECTS),
            "damping": 0.2,
            "cg_height": height / 2,
            "inertia_ratio": 1.4,
        },
    }


def timed(work: Callable[[], object]) -> float:
    """Return the seconds of the second of two calls: the first one compiles."""
    work()
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def models() -> None:
    """Print the cost of a single pass of each model."""
    motion = shaking()
    x, y, z = motion.acceleration
    at_rest = Quiet(Excitation(motion.dt, x, y, z, None)).ratio
    print(f"{motion.samples} samples, {OBJECTS} objects, one thread, peak 0.7 g")
    print(f"share of samples at which nothing of friction 0.3 moves: {np.mean(at_rest <= 0.3):.0%}")
    print(f"{'model':<22}{'ns per object and sample':>26}")
    for name, given in parameters().items():
        model = model_named(name)
        values = prepare(model, given)
        two = model.directions == 2 or (model.directions == 0 and values["directions"][0] == 2.0)
        excitation = Excitation(motion.dt, x, y if two else None, z, None)

        def once(model: object = model, excitation: Excitation = excitation, values: dict[str, Array] = values) -> None:
            model.run(excitation, values, 2, False)  # type: ignore[attr-defined]

        print(f"{name:<22}{timed(once) / OBJECTS / motion.samples * 1e9:>26.2f}")


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
