r"""Generic models 4 and 5: swinging in two and in three dimensions.

A pendulum of length L [m] and damping C_v in the plane of its wall,

.. math::

    \theta'' + 2 C_v \omega \theta' + \frac{g + a_z}{L} \sin\theta = -\frac{a_h}{L} \cos\theta,
    \qquad \omega = \sqrt{g / L}

and one that swings in all directions, q the unit vector from the point of suspension to the centre of gravity,

.. math::

    q'' = -|q'|^2 q + (I - q q^T) f - 2 \zeta \omega q', \qquad f = -(a_x, a_y, g + a_z) / L

The screen of the second is the paper's estimate: 1.4 times the undamped swing in one plane.

References
----------
Agbabian, M. S., Ginell, W. S., Masri, S. F. and Nigbor, R. L. (1991). Evaluation of earthquake damage mitigation
methods for museum objects. Studies in Conservation 36. Sec. 2.4 and Figure 5.
"""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from pipeline.errors import InputError
from pipeline.kernels import UNRESOLVED, samples
from pipeline.kernels.pendulum import MOST_STEPS, pendulum_batch
from pipeline.kernels.spherical import spherical_batch
from pipeline.models.common import N_, NO_HISTORY, ROUNDING, broadcast, grid, magnified, needs, shaken, shared
from pipeline.models.horizontal_isolator import DAMPING
from pipeline.quantities import Array, Quantity
from pipeline.records import Axis, ChartAxis, ChartFigure, Columns, Excitation, Hanging, Model, Scene, Support, Trials
from pipeline.records import phrases as say
from pipeline.records import picture as on_chart

CHANDELIER = 1.4
"""The paper's factor on the undamped two-dimensional result for an object that swings in all directions."""

CHANCE = 1e-8
"""Share of a peak, at the coarsest step, up to which the peaks at two steps may agree by chance; its error is larger in
most swings.  It falls with the fourth power of the step.  Of 1,920 swings under pieces of a real record two were off by
twice of what 1e-9 grants."""

LENGTH = Quantity("length", "m", "from the point of suspension to the centre of gravity", 0.0, exclusive=True)
FREEDOM = Quantity(
    "freedom",
    "-",
    "1 where it is free to swing in the plane of its wall, 0 where two fixings keep it from that",
    0.0,
    1.0,
    optional=True,
    default=1.0,
)
# How often a short string winds itself up is chaos, of which its displacement, which is never more than its length,
# shows nothing: to follow it took four times the analyses under strong shaking, and a tenth of the axis was left open.
LENGTH_AXIS = ChartAxis("length", low=0.008, high=20.0, nodes=400, leads=True)

PICTURED_EVERY = 30.0
"""Degrees between the directions of which a swing's picture shows the worst."""

_EXTREMES = grid(length=[0.001, 0.01, 1.0, 100.0], damping=[0.0, 1.0, 2.0])
_SAMPLE = {"length": 0.01, "damping": 0.1}


def _swept(angle: Array) -> Array:
    # |L sin theta| over the whole swing: a pendulum that passed the horizontal has been as far out as it is long.
    return np.where(angle >= 0.5 * np.pi, 1.0, np.sin(np.minimum(angle, 0.5 * np.pi)))


def _least(refine: int) -> float:
    # The smallest relative error that is told: of chance and of rounding.
    return CHANCE / refine**4 + ROUNDING


def _told(length: Array, note: Array, displacement: Array, error: Array) -> Columns:
    # What was not followed has been no farther out than it is long.
    lost = np.isnan(displacement)
    return {
        "displacement": np.where(lost, length, displacement),
        "error": np.where(lost, length, error),
        "note": note,
    }


def _run_plane(motion: Excitation, parameters: Mapping[str, Array], refine: int, estimate: bool) -> Columns:
    free = parameters["freedom"]
    found = _run(motion, parameters, refine, estimate)
    return {name: column if name == "note" else free * column for name, column in found.items()}


def _certificate(motion: Excitation, parameters: Mapping[str, Array]) -> Array:  # noqa: ARG001
    # What two fixings hold does not swing in the plane of its wall.
    return np.where(parameters["freedom"] == 0.0, 0.0, np.inf)


def _run(motion: Excitation, parameters: Mapping[str, Array], refine: int, estimate: bool) -> Columns:
    length, zeta = broadcast(parameters, "length"), broadcast(parameters, "damping")
    motion, times = magnified(motion)
    x, z = samples(motion.x), samples(motion.z)
    tail = -1.0 if motion.tail is None else float(motion.tail)
    coarse, fine = np.full((length.size, 2), np.nan), np.empty((length.size, 2))
    runs = ((refine, coarse), (2 * refine, fine)) if estimate else ((refine, fine),)
    for steps, results in runs:
        shared(partial(_swing, (x, z), motion, length, zeta, tail, steps, results), length.size, x.size)
    displacement = length * _swept(fine[:, 0]) / times
    error = np.abs(displacement - length * _swept(coarse[:, 0]) / times) + _least(refine) * displacement
    return {**_told(length, fine[:, 1], displacement, error), "rotation": fine[:, 0] / times}


def _swing(
    ways: tuple[Array, Array],
    motion: Excitation,
    length: Array,
    zeta: Array,
    tail: float,
    steps: int,
    results: Array,
    part: slice,
) -> None:
    peak, none = shaken(motion), np.empty((0, 1))
    pendulum_batch(*ways, motion.dt, peak, length[part], zeta[part], tail, steps, results[part], none)


def _run_3d(motion: Excitation, parameters: Mapping[str, Array], refine: int, estimate: bool) -> Columns:
    length, zeta = broadcast(parameters, "length"), broadcast(parameters, "damping")
    motion, times = magnified(motion)
    x, z = samples(motion.x), samples(motion.z)
    y = np.zeros_like(x) if motion.y is None else samples(motion.y)
    tail = -1.0 if motion.tail is None else float(motion.tail)
    coarse, fine = np.full((length.size, 2), np.nan), np.empty((length.size, 2))
    runs = ((refine, coarse), (2 * refine, fine)) if estimate else ((refine, fine),)
    for steps, results in runs:
        spherical_batch(x, y, z, motion.dt, shaken(motion), length, zeta, tail, steps, results, np.empty((0, 2)))
    displacement = length * fine[:, 0] / times
    error = length * np.abs(fine[:, 0] - coarse[:, 0]) / times + _least(refine) * displacement
    return _told(length, fine[:, 1], displacement, error)


def _lost(columns: Columns) -> NDArray[np.bool_]:
    return (columns["note"].astype(np.int64) & UNRESOLVED) > 0


def _screen_3d(motion: Excitation, parameters: Mapping[str, Array]) -> Columns:
    undamped = {"length": parameters["length"], "damping": np.zeros_like(parameters["length"])}
    swings = [_run(Excitation(motion.dt, motion.x, None, motion.z, motion.tail), undamped, 1, False)]
    if motion.y is not None:
        other = Excitation(motion.dt, motion.y, None, motion.z, motion.tail)
        swings.append(_run(other, undamped, 1, False))
    nothing = np.full_like(parameters["length"], np.nan)
    return {
        "displacement": CHANDELIER * np.maximum.reduce([swing["displacement"] for swing in swings]),
        "error": nothing,
        "note": np.where(np.any([_lost(swing) for swing in swings], axis=0), UNRESOLVED, 0.0) + NO_HISTORY,
    }


def _say_3d(row: Mapping[str, float], _parameters: Mapping[str, float]) -> str:
    return say.SWING_UNDAMPED(swing=row["displacement"])


def _refuse_lost(parameters: Mapping[str, float], results: Array) -> None:
    if np.isnan(results[0, 0]):
        raise InputError(
            f"length {parameters['length']:g} m: such a pendulum is too fast to be followed through this motion "
            f"({MOST_STEPS} steps in a sample interval at most); give a longer one, or a weaker or finer motion"
        )


def _trace(motion: Excitation, parameters: Mapping[str, float]) -> Columns:
    history = np.zeros((motion.x.size, 1))
    length, zeta = np.array([parameters["length"]]), np.array([parameters["damping"]])
    x, z = samples(motion.x), samples(motion.z)
    results = np.empty((1, 2))
    pendulum_batch(x, z, motion.dt, shaken(motion), length, zeta, 0.0, 4, results, history)
    _refuse_lost(parameters, results)
    return {"rotation": history[:, 0], "u_x": parameters["length"] * np.sin(history[:, 0])}


def _trace_3d(motion: Excitation, parameters: Mapping[str, float]) -> Columns:
    history = np.zeros((motion.x.size, 2))
    length, zeta = np.array([parameters["length"]]), np.array([parameters["damping"]])
    x, z = samples(motion.x), samples(motion.z)
    y = np.zeros_like(x) if motion.y is None else samples(motion.y)
    results = np.empty((1, 2))
    spherical_batch(x, y, z, motion.dt, shaken(motion), length, zeta, 0.0, 4, results, history)
    _refuse_lost(parameters, results)
    return {"u_x": parameters["length"] * history[:, 0], "u_y": parameters["length"] * history[:, 1]}


def _swings(scene: Scene) -> str:
    if scene.support is Support.HUNG and scene.hanging not in (None, Hanging.WIRE):
        return N_("it does not hang on one hook or wire: it does not swing in the plane of its wall")
    return _hangs(scene, Support.HUNG, N_("it does not hang on a wall"))


def _hangs(scene: Scene, support: Support, why: str) -> str:
    return why if scene.support is not support else needs(scene, "length", "damping")


_SENTENCE = "It swings {demand} ({low} to {high}) to the side; there is room for {capacity}."

SWING = Model(
    name="swing",
    title="Swinging",
    kind="flexible",
    source="Agbabian et al. 1991, sec. 2.4 and Figure 5",
    equation="theta'' + 2 C_v w theta' + ((g + a_z)/L) sin theta = -(a_h/L) cos theta, w = sqrt(g/L)",
    needs=(LENGTH, DAMPING, FREEDOM),
    gives=(
        Quantity("displacement", "m", "largest |L sin theta|"),
        Quantity("rotation", "rad", "largest |theta|"),
    ),
    directions=1,
    run=_run_plane,
    certificate=_certificate,
    rests=0.0,
    # In the plane of its wall, that is along its width.
    axes=({},),
    trace=_trace,
    chart=LENGTH_AXIS,
    mark=lambda parameters, demand: ("swing", parameters["length"], demand),
    demand="displacement",
    capacity="clearance",
    applies=_swings,
    sentence=_SENTENCE,
    fails="swings",
    trials=Trials(
        ranges={"length": (0.1, 3.0), "damping": (0.005, 0.1)}, extremes=_EXTREMES, sample=_SAMPLE, promised=1e-6
    ),
    listed="Table 1, Flexible: 2-D, swinging",
    supports=(Support.HUNG,),
    room_settles=True,
    pictures=(
        ChartFigure(
            "swing",
            title="Swing of a hung object",
            caption=(
                f"Largest sideways displacement in the worst direction (every {PICTURED_EVERY:g} degrees), for four "
                "damping coefficients."
            ),
            x=Axis("Suspension length", "m", "log"),
            y=Axis("Largest displacement", "m"),
            source="Agbabian et al. 1991, Figure 5",
            curves={on_chart.OF_DAMPING(damping=d): {"damping": d} for d in (0.0, 0.05, 0.10, 0.20)},
            # Below, verdicts need a chart and nobody a picture.
            low=0.1,
            azimuth_step=PICTURED_EVERY,
        ),
    ),
)

SWING_3D = Model(
    name="swing_3d",
    title="Swinging in all directions",
    kind="flexible",
    source="Agbabian et al. 1991, sec. 2.4 (estimate); spherical pendulum (history)",
    equation="q'' = -|q'|^2 q + (I - q q^T) f - 2 zeta w q', f = -(a_x, a_y, g + a_z)/L",
    needs=(LENGTH, DAMPING),
    gives=(Quantity("displacement", "m", "largest horizontal distance from the plumb line"),),
    directions=2,
    run=_run_3d,
    screen=_screen_3d,
    say_screen=_say_3d,
    trace=_trace_3d,
    # What hangs from a ceiling has no short string; those whirl over the top, where no chart can follow.
    chart=replace(LENGTH_AXIS, low=0.1, nodes=1200),
    mark=lambda parameters, demand: ("swing", parameters["length"], demand),
    demand="displacement",
    capacity="clearance",
    applies=lambda scene: _hangs(scene, Support.SUSPENDED, N_("it does not hang from one point")),
    sentence=_SENTENCE,
    fails="swings",
    trials=Trials(
        ranges={"length": (0.2, 5.0), "damping": (0.002, 0.02)}, extremes=_EXTREMES, sample=_SAMPLE, promised=1e-4
    ),
    listed="Table 1, Flexible: 3-D, swinging",
    supports=(Support.SUSPENDED,),
    room_settles=True,
    turns=True,
)
