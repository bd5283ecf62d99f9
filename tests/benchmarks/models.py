"""Cost of each model per object and sample, at 0.7 g, with the share of intervals at rest and two threads' gain.

The gain is read beside that of two processes, each of which does the same alone with memory and lock of its own: that
is what the machine can give, whose two processors may share a core, its caches and its clock with each other or with
somebody else.  1.7 of 1.7 is no worse than 1.95 of 1.95.
"""

import math
import multiprocessing
import time
from collections.abc import Callable

import numpy as np

from pipeline.analysis.model_runs import prepare
from pipeline.execute import Threads
from pipeline.models import model_named
from pipeline.quantities import Array, G
from pipeline.records import Columns, Excitation, Model
from pipeline.records.numerics import REFINE
from tests.benchmarks.common import OBJECTS, SEED, fastest, shaking, strongest

ROUNDS, ALONE = 5, 3
"""Rounds, and runs alone in each, of which the fastest count."""

BATCHES = 4
"""Fewest batches of objects that two threads share."""

SHARED = 0.3
"""Seconds of work that they share at least: for less the system may leave both threads on one core."""


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
        "standing": (
            6.0,
            {"half_width": 0.5 * slope * height, "cg_height": 0.5 * height, "friction_static": friction},
        ),
        "standing, all that tilt": (
            np.nan,
            {
                "half_width": 0.5 * slope * height,
                "cg_height": 0.5 * height,
                "friction_static": slope + friction,
            },
        ),
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


def in_threads(work: Callable[[], None], batches: int) -> float:
    """Return the seconds of one of several batches, each of all objects, in two threads."""
    began = time.perf_counter()
    Threads(2).map(lambda _: work(), range(batches))
    return (time.perf_counter() - began) / batches


def in_processes(work: Callable[[], None], batches: int) -> float:
    """Return the same in two processes, from where both begin to where the later one ends."""
    fork = multiprocessing.get_context("fork")
    ready, clocks = fork.Barrier(2), fork.SimpleQueue()

    def half() -> None:
        ready.wait()
        began = time.perf_counter()
        for _ in range(batches // 2):
            work()
        clocks.put((began, time.perf_counter()))

    both = [fork.Process(target=half) for _ in range(2)]
    for one in both:
        one.start()
    times = [clocks.get() for _ in both]
    for one in both:
        one.join()
    return (max(end for _, end in times) - min(began for began, _ in times)) / batches


def at_rest(model: Model, excitation: Excitation, values: dict[str, Array]) -> float:
    """Return the share of sample intervals in which nothing moves, of every 32nd object."""
    assert model.trace is not None
    shares = []
    for k in range(0, OBJECTS, 32):
        history = model.trace(excitation, {name: float(v[k]) for name, v in values.items()})
        place = history["rotation"] if "rotation" in history else history["u_x"]
        shares.append(np.mean(np.diff(place[: excitation.x.size]) == 0.0))
    return float(np.mean(shares))


def costs() -> None:
    """Print the cost of a single pass of each model, along the record's strongest direction where it needs one."""
    motion = shaking()
    x, y, z = motion.acceleration
    along = strongest()
    print(f"{motion.samples} samples, {OBJECTS} objects, one thread, peak {np.abs(along).max() / G:.1f} g")
    print(f"{'model':<38}{'ns per object and sample':>26}{'aim':>8}{'at rest':>9}{'two threads':>13}{'processes':>11}")
    for title, (aim, given) in parameters().items():
        model = model_named(title.split(",")[0])
        values = prepare(model, given)
        two = model.directions == 2 or (model.directions == 0 and values["directions"][0] == 2.0)
        excitation = Excitation(motion.dt, x if two else along, y if two else None, z, None)

        def once(values: Columns = values, model: Model = model, excitation: Excitation = excitation) -> None:
            model.run(excitation, values, REFINE["history"], False)

        once()
        # In turns, so that all meet the machine as it is.
        alone, threads, processes = math.inf, math.inf, math.inf
        for _ in range(ROUNDS):
            alone = min(alone, fastest(once, ALONE))
            batches = max(BATCHES, 2 * math.ceil(SHARED / alone / 2))
            threads = min(threads, in_threads(once, batches))
            processes = min(processes, in_processes(once, batches))
        cost = alone / OBJECTS / motion.samples * 1e9
        wanted = "" if np.isnan(aim) else f"{aim:g}"
        rest = at_rest(model, excitation, values)
        gain = f"{alone / threads:>13.2f}{alone / processes:>11.2f}"
        print(f"{title:<38}{cost:>26.2f}{wanted:>8}{rest:>9.0%}{gain}", flush=True)
