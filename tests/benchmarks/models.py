"""Cost of each model per object and sample, at 0.7 g, in one thread."""

import numpy as np

from pipeline.models import model_named
from pipeline.models.common import Quiet
from pipeline.quantities import Array
from pipeline.records import Excitation
from pipeline.response import prepare
from tests.benchmarks.common import OBJECTS, SEED, least, shaking


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


def costs() -> None:
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

        print(f"{name:<22}{least(once) / OBJECTS / motion.samples * 1e9:>26.2f}")
