r"""Generic model 1: rigid body rocking.

With s the sign of the angle theta [rad], R the distance from an edge to the centre of gravity, alpha the slenderness
and rho the radius of gyration,

.. math::

    \theta'' = -p^2 \left[\left(1 + \frac{a_z}{g}\right) \sin(s\alpha - \theta)
               + \frac{a_h}{g} \cos(s\alpha - \theta)\right], \qquad p^2 = \frac{g R}{\rho^2 + R^2}

and at each landing, by the angular momentum about the new edge (b to either side, h high),

.. math::

    \theta'_+ = e\,\theta'_-, \qquad e = \max\left(0, \frac{\rho^2 + h^2 - b_1 b_2}{\rho^2 + R_2^2}\right)

An edge lifts at |a_h| > (g + a_z) b/h.  The screen is the paper's: A_max/g > B/H' and V_max > 10 B/sqrt(H') [cm, s].

References
----------
Agbabian, M. S., Ginell, W. S., Masri, S. F. and Nigbor, R. L. (1991). Evaluation of earthquake damage mitigation
methods for museum objects. Studies in Conservation 36. Sec. 2.1.
Housner, G. W. (1963). The behavior of inverted pendulum structures during earthquakes. Bulletin of the Seismological
Society of America 53.
Ishiyama, Y. (1982). Motions of rigid bodies and criteria for overturning by earthquake excitations. Earthquake
Engineering and Structural Dynamics 10.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pipeline.kernels import CONTACT_LOST, SENSITIVE
from pipeline.kernels.rocking import OVERTURNED, REST
from pipeline.models.common import (
    N_,
    NO_VERTICAL,
    broadcast,
    contact_lost,
    curve,
    largest_push,
    largest_speed,
    lift_ratios,
    needs,
    unless_free,
)
from pipeline.models.flips import (
    ALL,
    FLAGS,
    Integration,
    Rows,
    doubt,
    flips,
    integrate,
)
from pipeline.models.rigid_body import (
    AXES,
    CG_HEIGHT,
    GYRATION_RADIUS,
    HALF_WIDTH,
    HALF_WIDTH_OTHER,
    HARMLESS,
    OVERTURNS,
    RESTITUTION,
    ROCKS,
    TIPS,
    UNHARMED,
    VELOCITY_SCREEN,
    bodies,
    comes_back,
    falls_over,
    found_again,
    one_width,
    overturning,
    say_screen,
    screen,
    tipped,
    tipping,
)
from pipeline.quantities import Array, G, Quantity
from pipeline.records import (
    Axis,
    Bounds,
    Chart,
    Columns,
    Excitation,
    Figure,
    Harm,
    Model,
    Motion,
    Scene,
    Trials,
    Zone,
)
from pipeline.records import picture as on_chart


def uplift_ratios(motion: Excitation, body: Array) -> Array:
    """Return the largest |a_h| / (N b/h) over time, N = max(0, g + a_z).

    Parameters
    ----------
    motion : Excitation
        Along a direction, of which the ratio is exact, or in two, of which it is the most of any direction.
    body : ndarray, shape (n, 6)
        As from `bodies`.

    Returns
    -------
    ndarray, shape (n,)
        [-]; infinite where contact is lost under a push.
    """
    to_positive, to_negative = lift_ratios(motion)
    return np.maximum(to_positive / np.tan(body[:, 0]), to_negative / np.tan(body[:, 1]))


def _run(motion: Excitation, parameters: Mapping[str, Array], refine: int, estimate: bool) -> Columns:
    body = bodies(parameters)
    run = _runs(body, broadcast(parameters, "initial_rotation"))
    uplift = uplift_ratios(motion, body)
    fine = run(motion, ALL, 2 * refine if estimate else refine)
    note = fine[:, FLAGS].astype(np.int64) | np.where(np.isinf(uplift), CONTACT_LOST, 0)
    error = np.full(uplift.size, np.nan)
    if estimate:
        coarse = run(motion, ALL, refine)
        error, sensitive = doubt(run, motion, refine, uplift, _pace(body), coarse, fine)
        note |= np.where(sensitive, SENSITIVE, 0)
    return tipped(fine, estimate=estimate) | {"uplift_ratio": uplift, "error": error, "note": note.astype(np.float64)}


def _runs(body: Array, initial: Array) -> Integration:
    # Those bodies as `doubt` and `flips` ask for them.
    def run(motion: Excitation, rows: Rows, refine: int, until: Array | None = None, rest: float = REST) -> Array:
        return integrate(motion, body[rows], initial[rows], refine, until, rest=rest)

    return run


def _pace(body: Array) -> Array:
    # p [rad/s] (n,) about the first edge.
    return np.sqrt(G * body[:, 2])


def _flips(motion: Excitation, parameters: Mapping[str, Array], columns: Columns) -> NDArray[np.bool_]:
    body = bodies(parameters)
    run = _runs(body, broadcast(parameters, "initial_rotation"))
    return flips(run, motion, columns["uplift_ratio"], _pace(body), found_again(columns, 8))


def _trace(motion: Excitation, parameters: Mapping[str, float]) -> Columns:
    body = bodies({k: np.array([v]) for k, v in parameters.items()})
    history = np.zeros((motion.x.size, 1))
    integrate(replace(motion, tail=0.0), body, np.array([parameters["initial_rotation"]]), 4, history=history)
    return {"rotation": history[:, 0]}


def _certificate(motion: Excitation, parameters: Mapping[str, Array]) -> Array:
    return uplift_ratios(motion, bodies(parameters))


def _bound(motion: Excitation, parameters: Mapping[str, Array]) -> Bounds:
    body = bodies(parameters)
    uplift = uplift_ratios(motion, body)
    tilted = np.abs(parameters["initial_rotation"])
    begin = tilted / np.where(parameters["initial_rotation"] > 0.0, body[:, 0], body[:, 1])
    rests = (uplift <= 1.0) & (tilted == 0.0)
    fallen = tilted >= OVERTURNED
    # Once it lifts an edge it may do anything up to falling over, after which it is not followed.
    most = np.where(rests | fallen, begin, OVERTURNED / np.minimum(body[:, 0], body[:, 1]))
    bounds = {
        "rotation_ratio": (begin, most),
        "overturned": (fallen.astype(np.float64), np.where(rests, 0.0, 1.0)),
        "impacts": (np.zeros_like(uplift), np.where(rests | fallen, 0.0, np.inf)),
        "uplift_ratio": (uplift if motion.y is None else np.zeros_like(uplift), uplift),
    }
    return Bounds(bounds, contact_lost(motion, uplift.size))


def _outcome(row: Mapping[str, float], _parameters: Mapping[str, float]) -> tuple[str, str]:
    if row["overturned"]:
        return falls_over(row)
    return (ROCKS, comes_back(row)) if row["rotation_ratio"] > 0.0 else ("", "")


def _applies(scene: Scene) -> str:
    return unless_free(scene) or needs(scene, "half_width", "cg_height")


def _stability(key: str, motion: Motion) -> Chart:
    # Figure 2: base width against equivalent height H' = 2 h_cg.  The lines are the paper's screens A_max/g = B/H' and
    # V_max = 10 B/sqrt(H') (Ishiyama 1982).  Overturning asks for both: below their crossing no object rocks without.
    excitation = motion.excitation(None)
    slope = largest_push(excitation) / G
    speed = largest_speed(excitation) / VELOCITY_SCREEN
    heights = np.geomspace(0.02, 5.0, 40)
    uplift = slope * heights
    overturn = np.minimum(uplift, speed * np.sqrt(heights))
    low, high = 0.005, 5.0

    def band(label: str, bottom: Array, top: Array, tone: str) -> Zone:
        xs = np.concatenate([heights, heights[::-1]])
        ys = np.clip(np.concatenate([bottom, top[::-1]]), low, high)
        outline = curve("", xs, ys)
        return Zone(label, outline.x, outline.y, tone)

    floor, ceiling = np.full_like(heights, low), np.full_like(heights, high)
    zones = (
        band(N_("stands"), uplift, ceiling, "safe"),
        band(N_("rocks"), overturn, uplift, "warn"),
        band(N_("overturns"), floor, overturn, "danger"),
    )
    crossing = (speed / slope) ** 2 if slope > 0.0 else 0.0
    caption = on_chart.STABILITY(push=slope, speed=speed * VELOCITY_SCREEN, crossing=crossing)
    return Chart(
        key,
        N_("Rocking stability"),
        caption,
        Axis(N_("Equivalent height H'"), "m", "log"),
        Axis(N_("Base width B"), "m", "log"),
        (
            curve("A_max/g = B/H'", heights, uplift),
            curve("V_max = 10 B/√H'", heights, np.clip(speed * np.sqrt(heights), low, high)),
        ),
        zones,
        source="Agbabian et al. 1991, Figure 2; Ishiyama 1982",
    )


_ALPHAS = np.tile([0.02, 0.2, 1.2], 3)
_EXTREMES = {
    "half_width": (0.3 * np.tan(_ALPHAS)).tolist(),
    "cg_height": [0.3] * 9,
    "restitution": np.repeat([0.0, 0.6, 1.0], 3).tolist(),
}
"""Plates, columns and boxes, each with a landing that takes all, some and nothing of its rate."""


def _symmetric(parameters: Mapping[str, Array]) -> bool:
    return one_width(parameters) and bool(np.all(parameters["initial_rotation"] == 0.0))


ROCKING = Model(
    name="rocking",
    title="Rocking",
    kind="rigid",
    source="Agbabian et al. 1991, sec. 2.1; Housner 1963; Ishiyama 1982",
    equation="theta'' = -p^2 [(1 + a_z/g) sin(alpha sgn theta - theta) + (a_h/g) cos(alpha sgn theta - theta)]",
    needs=(
        HALF_WIDTH,
        CG_HEIGHT,
        HALF_WIDTH_OTHER,
        GYRATION_RADIUS,
        RESTITUTION,
        Quantity("initial_rotation", "rad", "released from rest", -1.6, 1.6, optional=True, default=0.0),
    ),
    gives=(
        Quantity("rotation_ratio", "-", "largest |theta| / alpha"),
        *TIPS,
        Quantity("uplift_ratio", "-", "largest |a_h| / (max(0, g + a_z) b/h)"),
    ),
    directions=1,
    axes=AXES,
    run=_run,
    screen=screen,
    say_screen=say_screen,
    trace=_trace,
    bound=_bound,
    certificate=_certificate,
    exact=True,
    rests=1.0,
    flips=_flips,
    outcome=_outcome,
    otherwise=overturning,
    mark=lambda parameters, _: ("stability", 2.0 * parameters["cg_height"], 2.0 * parameters["half_width"]),
    demand="uplift_ratio",
    capacity=1.0,
    applies=_applies,
    symmetric=_symmetric,
    uncharted="its outcomes flip back and forth, so that it is never tabulated",
    sentence=(
        "The largest horizontal push is {demand} ({low} to {high}) times what lifts an edge of this object; from 1 on "
        "it rocks."
    ),
    fails=ROCKS,
    states=(Harm.FALLS, Harm.ROCKS),
    reaches=lambda columns, _exceeded, _room: tipping(columns),
    trials=Trials(
        ranges={"half_width": (0.02, 0.4), "cg_height": (0.05, 1.0)},
        extremes=_EXTREMES,
        sample={"half_width": 0.2, "cg_height": 0.5},
        promised=1e-4,
    ),
    listed="Table 1, Rigid: Rocking",
    tips=True,
    pictures=(Figure("stability", _stability),),
    vertical=True,
    says=(HARMLESS, UNHARMED, OVERTURNS, NO_VERTICAL),
)
