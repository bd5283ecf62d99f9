r"""Generic model 2: rigid body sliding.

With u [m] from where it stood, N = max(0, g + a_z) and friction mu_s at rest and mu_k while it slips,

.. math::

    u'' = -a_h - \mu_k N \frac{u'}{|u'|}, \qquad \text{at rest while } |a_h| \le \mu_s N

References
----------
Agbabian, M. S., Ginell, W. S., Masri, S. F. and Nigbor, R. L. (1991). Evaluation of earthquake damage mitigation
methods for museum objects. Studies in Conservation 36. Sec. 2.2, Figures 3 and 4.
Newmark, N. M. (1965). Effects of earthquakes on dams and embankments. Geotechnique 15.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from pipeline.models.common import N_, NO_VERTICAL, SHIFT, curve, lift_ratios, needs, unless_free
from pipeline.models.friction import kinetic, slip_bounds, stick_slip, stick_slip_trace
from pipeline.quantities import Array, Quantity
from pipeline.records import (
    Axis,
    Bounds,
    Chart,
    ChartAxis,
    ChartFigure,
    Columns,
    Excitation,
    Figure,
    Harm,
    Model,
    Motion,
    Mount,
    Scene,
    Support,
    Trials,
)
from pipeline.records import picture as on_chart

FRICTION_STATIC = Quantity("friction_static", "-", "coefficient at rest", 0.0)
FRICTION_KINETIC = Quantity(
    "friction_kinetic", "-", "coefficient while slipping; else the static one", 0.0, optional=True
)
DIRECTIONS = Quantity("directions", "-", "2, or 1 along the angle", 1.0, 2.0, optional=True, default=2.0)

FRICTION_AXIS = ChartAxis(
    "friction_static",
    low=0.01,
    high=1.5,
    nodes=250,
    absent=("friction_kinetic",),
    # From here on it rests: it moves only where |a_h| exceeds mu (g + a_z).
    settled=lambda motion: max(lift_ratios(motion)),
)

FRICTION_EXTREMES = {"friction_static": [0.0, 1e-6, 0.1, 5.0]}


def _run(motion: Excitation, parameters: Mapping[str, Array], refine: int, estimate: bool) -> Columns:
    mu_s = parameters["friction_static"]
    free = np.zeros_like(mu_s)
    out = stick_slip(motion, free, free, mu_s, kinetic(parameters), refine, estimate)
    del out["acceleration"], out["acceleration_error"]
    return out


def _trace(motion: Excitation, parameters: Mapping[str, float]) -> Columns:
    mu_k = kinetic({name: np.array([value]) for name, value in parameters.items()})
    return stick_slip_trace(motion, 0.0, 0.0, parameters["friction_static"], float(mu_k[0]))


def _bound(motion: Excitation, parameters: Mapping[str, Array]) -> Bounds:
    mu_s, mu_k = parameters["friction_static"], kinetic(parameters)
    bounds = slip_bounds(motion, mu_s, mu_k, "displacement", "residual", "path_length")
    if motion.y is None:
        return bounds
    # Of one direction among all that it may be shaken along, the least is not known.
    two = parameters["directions"] == 2.0
    return Bounds({name: (np.where(two, low, 0.0), high) for name, (low, high) in bounds.outputs.items()}, bounds.note)


def _certificate(motion: Excitation, parameters: Mapping[str, Array]) -> Array:
    # It moves only where |a_h| exceeds mu (g + a_z); otherwise the displacement is exactly nothing.
    at_rest = max(lift_ratios(motion)) <= parameters["friction_static"]
    return np.where(at_rest, 0.0, np.inf)


def _applies(scene: Scene) -> str:
    # What a mount holds slides on it once its grip is overcome, on a pin too of which nobody says how it grips.
    if scene.mount in (Mount.SECURED, Mount.UNKNOWN):
        return needs(scene, "friction_static")
    return unless_free(scene) or needs(scene, "friction_static")


PATH_FRICTION = 0.05
PATH_POINTS = 1500


def _path(key: str, motion: Motion) -> Chart:
    # Figure 3.
    given = {"friction_static": PATH_FRICTION, "friction_kinetic": np.nan, "directions": 2.0}
    path = _trace(motion.excitation(None, 0.0), given)
    every = max(1, path["u_x"].size // PATH_POINTS)
    x, y = path["u_x"][::every], path["u_y"][::every]
    far = float(np.hypot(path["u_x"], path["u_y"]).max())
    return Chart(
        key,
        on_chart.PATH(friction=PATH_FRICTION),
        on_chart.PATH_SEEN(far=far),
        Axis(N_("East"), "m"),
        Axis(N_("North"), "m"),
        (curve("", x, y),),
        equal=True,
        source="Agbabian et al. 1991, Figure 3",
    )


def _reaches(columns: Columns, exceeded: NDArray[np.bool_], _room: Array) -> Mapping[Harm, NDArray[np.bool_]]:
    return {Harm.LEAVES: exceeded, Harm.SHIFTS: columns["displacement"] > SHIFT}


SLIDING = Model(
    name="sliding",
    title="Sliding",
    kind="rigid",
    source="Agbabian et al. 1991, sec. 2.2 and Figure 4; Newmark 1965",
    equation="u'' = -a_h - mu_k N u'/|u'|, N = max(0, g + a_z); at rest while |a_h| <= mu_s N",
    needs=(FRICTION_STATIC, FRICTION_KINETIC, DIRECTIONS),
    gives=(
        Quantity("displacement", "m", "largest distance from where it stood"),
        Quantity("residual", "m", "distance from where it stood when it rests"),
        Quantity("path_length", "m", "length of the path on its support"),
    ),
    directions=0,
    run=_run,
    trace=_trace,
    bound=_bound,
    certificate=_certificate,
    rests=0.0,
    chart=FRICTION_AXIS,
    mark=lambda parameters, demand: ("sliding", parameters["friction_static"], demand),
    demand="displacement",
    capacity="clearance",
    applies=_applies,
    sentence=("It slides {demand} ({low} to {high}) from where it stands; there is room for {capacity}."),
    at_most=(
        "It slides at most {demand} from where it stands (at most {high}, its friction being uncertain); there is room "
        "for {capacity}."
    ),
    gripped=(
        "On its mount it slips by {demand} ({low} to {high}) once that no longer grips it; it comes off at {capacity}."
    ),
    fails="slides",
    states=(Harm.LEAVES, Harm.SHIFTS),
    reaches=_reaches,
    trials=Trials(
        ranges={"friction_static": (0.1, 0.6)},
        extremes=FRICTION_EXTREMES,
        sample={"friction_static": 0.1},
        promised=5e-4,
    ),
    listed="Table 1, Rigid: Sliding",
    supports=(Support.FREESTANDING,),
    needs_size=False,
    vertical=True,
    says=(NO_VERTICAL,),
    room_settles=True,
    pictures=(
        ChartFigure(
            "sliding",
            title="Sliding against friction",
            caption="Largest distance an object slides from where it stood, for each friction coefficient of its base.",
            x=Axis("Friction coefficient", "-", "log"),
            y=Axis("Largest displacement", "m"),
            source="Agbabian et al. 1991, Figure 4",
            curves={"": {}},
            decides=True,
        ),
        Figure("path", _path),
    ),
)
