r"""Generic model of the load on what a work hangs by: its weight and its inertia, in multiples of the weight.

A work that moves with its wall pulls at its hangers by

.. math::

    \frac{F}{m g} = \max_t \frac{\sqrt{a_x^2 + a_y^2 + (g + a_z)^2}}{g}

in whatever direction: with a = 0 that is the paper's weight times 1 + a_z / g.  Between samples the vector is a
straight line and its length convex, so that the largest at the samples is the largest of all: the closed form is
exact.  What swings or slaps pulls harder: a pendulum that swings out to theta and back by 2 (1 - cos(theta)) of its
weight more, which is once more at 60 degrees and twice at the horizontal.  `amplification` stands for that.

What hangers bear is in multiples of the weight too: hardware is chosen by the weight of the work.

References
----------
Agbabian, M. S., Ginell, W. S., Masri, S. F. and Nigbor, R. L. (1991). Evaluation of earthquake damage mitigation
methods for museum objects. Studies in Conservation 36. Sec. 2.3: F = m A.
"""

from collections.abc import Mapping

import numpy as np

from pipeline.models.common import N_, NO_VERTICAL, ROUNDING, needs, remembered
from pipeline.quantities import Array, G, Quantity
from pipeline.records import Columns, Excitation, Harm, Model, Motion, Scene, Support, Trials


@remembered
def pull(motion: Motion) -> float:
    """Return the largest pull at the hangers of what moves with its wall, in multiples of its weight.

    Parameters
    ----------
    motion : Motion
        Of the wall.

    Returns
    -------
    float
        At least 1.
    """
    x, y, z = motion.acceleration
    return max(1.0, _largest(x**2 + y**2, z))


def _largest(square: Array, z: Array) -> float:
    return float(np.sqrt((square + (G + z) ** 2).max())) / G


def _certificate(motion: Excitation, parameters: Mapping[str, Array]) -> Array:
    square = motion.x**2 if motion.y is None else motion.x**2 + motion.y**2
    return np.asarray(parameters["amplification"] * max(1.0, _largest(square, motion.z)))


def _run(
    motion: Excitation,
    parameters: Mapping[str, Array],
    refine: int,  # noqa: ARG001
    estimate: bool,  # noqa: ARG001
) -> Columns:
    load = _certificate(motion, parameters)
    return {"load": load, "error": ROUNDING * load, "note": np.zeros_like(load)}


def _applies(scene: Scene) -> str:
    if scene.support is not Support.HUNG:
        return N_("it does not hang on a wall")
    return needs(scene, "amplification")


HANGER_LOAD = Model(
    name="hanger_load",
    title="Load on its hangers",
    kind="rigid",
    source="Agbabian et al. 1991, sec. 2.3 (F = m A), of what hangs",
    equation="F / (m g) = max sqrt(a_x^2 + a_y^2 + (g + a_z)^2) / g",
    needs=(Quantity("amplification", "-", "of the load, by swing and slap", 0.0, optional=True, default=1.0),),
    gives=(Quantity("load", "-", "largest pull at the hangers, in multiples of the weight"),),
    directions=2,
    run=_run,
    certificate=_certificate,
    exact=True,
    uncharted="its closed form costs less than a lookup",
    demand="load",
    capacity="hanger_strength",
    applies=_applies,
    sentence=("Its hangers are pulled by {demand} times its weight ({low} to {high}); they bear {capacity} times."),
    fails="tears out",
    states=(Harm.FALLS,),
    trials=Trials(ranges={"amplification": (1.0, 2.0)}),
    supports=(Support.HUNG,),
    needs_size=False,
    vertical=True,
    says=(NO_VERTICAL,),
)
