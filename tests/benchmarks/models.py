"""Cost of each model per object and sample, at 0.7 g, with the share of intervals at rest and two threads' gain.

The gain is read beside the cores that the two threads were given: on a machine that is busy with something else both
fall together, and 1.1 of 1.1 is no worse than 1.9 of 2.0.
"""

import math
import time
from collections.abc import Callable

import numpy as np

from pipeline.execute import Threads
from pipeline.models import model_named
from pipeline.quantities import Array, G
from pipeline.records import Columns, Excitation, Model
from pipeline.response import REFINE, prepare
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


def in_threads(work: Callable[[Columns], None], values: Columns, alone: float) -> tuple[float, float]:
    """Return the seconds of one of several batches, each of all objects, in two threads, and the cores they had.

    alone : seconds of one batch in one thread
    """
    batches = max(BATCHES, 2 * math.ceil(SHARED / alone / 2))
    began, used = time.perf_counter(), time.process_time()
    Threads(2).map(work, [values] * batches)
    took = time.perf_counter() - began
    return took / batches, (time.process_time() - used) / took


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
    print(f"{'model':<38}{'ns per object and sample':>26}{'aim':>8}{'at rest':>9}{'two threads':>13}{'on cores':>10}")
    for title, (aim, given) in parameters().items():
        model = model_named(title.split(",")[0])
        values = prepare(model, given)
        two = model.directions == 2 or (model.directions == 0 and values["directions"][0] == 2.0)
        excitation = Excitation(motion.dt, x if two else along, y if two else None, z, None)

        def once(values: Columns = values, model: Model = model, excitation: Excitation = excitation) -> None:
            model.run(excitation, values, REFINE["history"], False)

        once()
        # In turns, so that both meet the machine as it is.
        alone, together, cores = math.inf, math.inf, 0.0
        for _ in range(ROUNDS):
            alone = min(alone, fastest(once, ALONE))
            together, cores = min((together, cores), in_threads(once, values, alone))
        cost = alone / OBJECTS / motion.samples * 1e9
        wanted = "" if np.isnan(aim) else f"{aim:g}"
        rest = at_rest(model, excitation, values)
        gain = f"{alone / together:>13.2f}{cores:>10.2f}"
        print(f"{title:<38}{cost:>26.2f}{wanted:>8}{rest:>9.0%}{gain}", flush=True)
