r"""Generic isolator: rotational, a damped oscillator about the base.

With the moment of inertia I about the pivot, c and k of the pad and the centre of gravity h above it,

.. math::

    I \theta'' + c\,\theta' + (k - m g h)\,\theta = -m h\,a_h

References
----------
Agbabian, M. S., Ginell, W. S., Masri, S. F. and Nigbor, R. L. (1991). Evaluation of earthquake damage mitigation
methods for museum objects. Studies in Conservation 36. Sec. 2.6.
"""

from collections.abc import Mapping

import numpy as np

from pipeline.kernels import samples
from pipeline.kernels.oscillator import oscillator_history
from pipeline.models.common import N_, ROUNDING, after_record, needs
from pipeline.models.horizontal_isolator import DAMPING
from pipeline.models.oscillator import EXTREMES, OSCILLATES, oscillate, oscillate_bounds
from pipeline.quantities import Array, Quantity
from pipeline.records import Bounds, Columns, Excitation, Harm, Model, Scene, Support, Trials


def _run(
    motion: Excitation,
    parameters: Mapping[str, Array],
    refine: int,  # noqa: ARG001
    estimate: bool,  # noqa: ARG001
) -> Columns:
    # With r = I / (m h^2), theta = u / (r h) where u is the displacement of the plain oscillator, and the centre of
    # gravity feels a + h theta'' = a + u'' / r.
    w = 2.0 * np.pi * parameters["frequency"]
    share = 1.0 / parameters["inertia_ratio"]
    displacement, acceleration = oscillate(motion, w, parameters["damping"], share)
    rotation = displacement * share / parameters["cg_height"]
    return {"rotation": rotation, "acceleration": acceleration, "error": ROUNDING * rotation, "note": np.zeros_like(w)}


def _bound(motion: Excitation, parameters: Mapping[str, Array]) -> Bounds:
    w = 2.0 * np.pi * parameters["frequency"]
    share = 1.0 / parameters["inertia_ratio"]
    (low, high), acceleration = oscillate_bounds(motion, w, parameters["damping"], share)
    turn = share / parameters["cg_height"]
    return Bounds({"rotation": (low * turn, high * turn), "acceleration": acceleration}, np.zeros_like(w))


def _trace(motion: Excitation, parameters: Mapping[str, float]) -> Columns:
    history = np.zeros((motion.x.size + after_record(motion), 2))
    w = 2.0 * np.pi * parameters["frequency"]
    share = 1.0 / parameters["inertia_ratio"]
    oscillator_history(samples(motion.x), motion.dt, w, parameters["damping"], share, history)
    # u_x: of the centre of gravity, whose absolute acceleration a_x is.
    u = history[:, 0] * share
    return {"rotation": u / parameters["cg_height"], "u_x": u, "a_x": history[:, 1]}


def _applies(scene: Scene) -> str:
    if scene.support is not Support.ISOLATED or scene.item.isolator != ROTATIONAL_ISOLATOR.name:
        return N_("it does not stand on a rotational isolator")
    return needs(scene, "frequency", "damping", "cg_height", "inertia_ratio", "rotation_limit")


_MANY = len(EXTREMES["frequency"])

ROTATIONAL_ISOLATOR = Model(
    name="rotational_isolator",
    title="Rotational isolator",
    kind="isolator",
    source="Agbabian et al. 1991, sec. 2.6",
    equation="I theta'' + c theta' + (k - m g h) theta = -m h a_h",
    needs=(
        # k <= m g h has no frequency: such a pad would not let the object stand up, and there is nothing to enter.
        Quantity("frequency", "Hz", "of the standing system, gravity included", 0.0, exclusive=True),
        DAMPING,
        Quantity("cg_height", "m", "centre of gravity above the pivot", 0.0, exclusive=True),
        Quantity("inertia_ratio", "-", "I / (m h^2) about the pivot", 0.0, exclusive=True),
    ),
    gives=(
        Quantity("rotation", "rad", "largest |theta|"),
        Quantity("acceleration", "m/s2", "largest horizontal acceleration of the centre of gravity"),
    ),
    directions=1,
    run=_run,
    trace=_trace,
    bound=_bound,
    uncharted=OSCILLATES,
    demand="rotation",
    capacity="rotation_limit",
    applies=_applies,
    sentence="Its pad lets it turn by {demand}; {capacity} is allowed.",
    at_most="Its pad lets it turn by at most {demand}; {capacity} is allowed.",
    fails="turns too far on its pad",
    states=(Harm.FALLS,),
    trials=Trials(
        ranges={
            "frequency": (1.0, 8.0),
            "damping": (0.05, 0.3),
            "cg_height": (0.1, 1.0),
            "inertia_ratio": (1.1, 1.6),
        },
        extremes={**EXTREMES, "cg_height": [0.5] * _MANY, "inertia_ratio": [1.3] * _MANY},
    ),
    listed="Table 2, Isolator, rotational: Damped oscillator",
    supports=(Support.ISOLATED,),
)
