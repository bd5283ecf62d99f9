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

from pipeline.kernels import flags
from pipeline.kernels.rocking import OVERTURNED, REST
from pipeline.models.common import (
    NO_HISTORY,
    SENSITIVE,
    broadcast,
    contact_lost,
    curve,
    largest_push,
    largest_speed,
    lift_ratios,
    needs,
    unless_free,
)
from pipeline.models.doubt import doubt
from pipeline.models.flips import (
    ALL,
    FELL,
    FELL_AT,
    FLAGS,
    IMPACTS,
    LAST_NEAR,
    LIFTED_AT,
    RATIO,
    Integration,
    Rows,
    flips,
    integrate,
)
from pipeline.quantities import Array, G, Quantity
from pipeline.records import (
    Axis,
    Bounds,
    Chart,
    Columns,
    Excitation,
    Figure,
    Model,
    Motion,
    Scene,
    Support,
    Trials,
    Zone,
)

VELOCITY_SCREEN = 1.0
"""V_max > 10 B / sqrt(H') in cm and s is V_max > 1.0 B / sqrt(H') in m and s (Ishiyama 1982, in the paper's form)."""


def sides(parameters: Mapping[str, Array]) -> tuple[Array, Array, Array]:
    """Return the half widths towards both edges and the radius of gyration squared.

    Parameters
    ----------
    parameters : mapping of str to ndarray, shape (n,)
        As in `bodies`.

    Returns
    -------
    b1, b2, rho2 : ndarray, shape (n,)
        [m], [m], [m2]; what is not given is the first one, and a uniform rectangle's.
    """
    b1, h = parameters["half_width"], parameters["cg_height"]
    other, given = parameters["half_width_other"], parameters["gyration_radius"]
    return b1, np.where(np.isnan(other), b1, other), np.where(np.isnan(given), (b1**2 + h**2) / 3.0, given**2)


def bodies(parameters: Mapping[str, Array]) -> Array:
    """Return what the kernel needs of each body.

    Parameters
    ----------
    parameters : mapping of str to ndarray, shape (n,)
        Those of the model, in SI; NaN for what is not given.

    Returns
    -------
    ndarray, shape (n, 6)
        alpha1, alpha2 [rad], c1, c2 [1/m], e12, e21 [-]: c = R / (rho^2 + R^2), so that p^2 = g c, and the restitution
        from the angular momentum about the new edge, never below 0.
    """
    h = parameters["cg_height"]
    b1, b2, rho2 = sides(parameters)
    r1, r2 = np.hypot(b1, h), np.hypot(b2, h)
    moment = rho2 + h**2 - b1 * b2
    e = parameters["restitution"]
    e12 = np.where(np.isnan(e), np.maximum(0.0, moment / (rho2 + r2**2)), e)
    e21 = np.where(np.isnan(e), np.maximum(0.0, moment / (rho2 + r1**2)), e)
    columns = (np.arctan2(b1, h), np.arctan2(b2, h), r1 / (rho2 + r1**2), r2 / (rho2 + r2**2), e12, e21)
    return np.ascontiguousarray(np.column_stack(columns))


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
    note = fine[:, FLAGS].astype(np.int64) | np.where(np.isinf(uplift), flags.CONTACT_LOST, 0)
    error = np.full(uplift.size, np.nan)
    if estimate:
        coarse = run(motion, ALL, refine)
        error, sensitive = doubt(run, motion, refine, uplift, _pace(body), coarse, fine)
        note |= np.where(sensitive, SENSITIVE, 0)
    # Only `_flips`, which goes on from a run without an estimate, wants to know how long a body was near.
    hidden = {} if estimate else {"near_until": fine[:, LAST_NEAR]}
    return hidden | {
        "rotation_ratio": fine[:, RATIO],
        "overturned": fine[:, FELL],
        "overturning_time": np.where(fine[:, FELL_AT] < 0.0, np.nan, fine[:, FELL_AT]),
        "uplift_time": np.where(fine[:, LIFTED_AT] < 0.0, np.nan, fine[:, LIFTED_AT]),
        "impacts": fine[:, IMPACTS],
        "uplift_ratio": uplift,
        "error": error,
        "note": note.astype(np.float64),
    }


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
    found = np.zeros((body.shape[0], 8))
    found[:, RATIO], found[:, FELL], found[:, LAST_NEAR] = (
        columns[name] for name in ("rotation_ratio", "overturned", "near_until")
    )
    found[:, FELL_AT], found[:, LIFTED_AT] = (
        np.nan_to_num(columns[name], nan=-1.0) for name in ("overturning_time", "uplift_time")
    )
    run = _runs(body, broadcast(parameters, "initial_rotation"))
    return flips(run, motion, columns["uplift_ratio"], _pace(body), found)


def _screen(motion: Excitation, parameters: Mapping[str, Array]) -> Columns:
    b = np.fmin(parameters["half_width"], parameters["half_width_other"])
    width, height = 2.0 * b, 2.0 * parameters["cg_height"]
    uplift = largest_push(motion) / G / (width / height)
    velocity = largest_speed(motion) / (VELOCITY_SCREEN * width / np.sqrt(height))
    nothing = np.full_like(width, np.nan)
    return {
        "rotation_ratio": nothing,
        # Of 400 blocks, 174 failed the velocity criterion and never lifted an edge: it means nothing before uplift.
        "overturned": ((velocity > 1.0) & (uplift > 1.0)).astype(np.float64),
        "overturning_time": nothing,
        "uplift_time": nothing,
        "impacts": np.zeros_like(width),
        "uplift_ratio": uplift,
        "velocity_ratio": velocity,
        "error": nothing,
        "note": np.full_like(width, float(NO_HISTORY)),
    }


def _say(row: Mapping[str, float], parameters: Mapping[str, float]) -> str:
    slope = float(np.fmin(parameters["half_width"], parameters["half_width_other"])) / parameters["cg_height"]
    rocks = "rocks" if row["uplift_ratio"] > 1.0 else "does not rock"
    falls = "overturns" if row["overturned"] else "does not overturn"
    return (
        f"A_max/g = {row['uplift_ratio'] * slope:.2f} against B/H' = {slope:.2f}: {rocks}. "
        f"V_max is {row['velocity_ratio']:.2g} times 10 B/sqrt(H'): {falls}."
    )


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


HARMLESS = "Rocking itself does not harm it, as the museum says; it fails if it falls over."
OVERTURNS, ROCKS = "overturns", "rocks"


def _outcome(row: Mapping[str, float], _parameters: Mapping[str, float]) -> tuple[str, str]:
    if row["overturned"]:
        return OVERTURNS, f"In this motion it falls over after {row['overturning_time']:.1f} s."
    if row["rotation_ratio"] > 0.0:
        return ROCKS, (
            f"It comes back: it tips by at most {100.0 * row['rotation_ratio']:.0f} % of its critical angle and lands "
            f"{row['impacts']:.0f} times."
        )
    return "", ""


UNHARMED = "Rocking itself does not harm an object of its kind; it fails if it falls over."
"""What is said where its class says so, and the museum nothing."""

FALLS_IN = "overturned_share"
"""Parameter of a scene whose class is not harmed by rocking: the share of the motions in which it may fall over."""

HALF = 0.5 - 1e-9
"""Share of the motions from which on an object counts as overturned ("half the records" included)."""


def overturning(scene: Scene) -> tuple[str, float, str] | None:
    """Return what decides about an object that rocking itself does not harm: it fails when it falls over.

    Parameters
    ----------
    scene : Scene
        An object where it stands.

    Returns
    -------
    tuple or None
        For `Model.otherwise`.
    """
    if scene.item.susceptible is None and FALLS_IN in scene.parameters:
        return "overturned", HALF, UNHARMED
    return ("overturned", HALF, HARMLESS) if scene.item.susceptible is False else None


def _applies(scene: Scene) -> str:
    return unless_free(scene, "rock") or needs(scene, "half_width", "cg_height")


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
        band("stands", uplift, ceiling, "safe"),
        band("rocks", overturn, uplift, "warn"),
        band("overturns", floor, overturn, "danger"),
    )
    crossing = (speed / slope) ** 2 if slope > 0.0 else 0.0
    caption = (
        f"Peak resultant acceleration {slope:.2f} g, velocity {100.0 * speed * VELOCITY_SCREEN:.0f} cm/s. "
        "H' is twice the height of the centre of gravity. "
        f"Below H' = {100.0 * crossing:.0f} cm there is no band in which an object rocks without overturning. "
        "The lines are the paper's closed-form criteria; the verdict comes from the time history."
    )
    return Chart(
        key,
        "Rocking stability",
        caption,
        Axis("Equivalent height H'", "m", "log"),
        Axis("Base width B", "m", "log"),
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
    other = parameters["half_width_other"]
    same = np.isnan(other) | (other == parameters["half_width"])
    return bool(np.all(same) and np.all(parameters["initial_rotation"] == 0.0))


ROCKING = Model(
    name="rocking",
    title="Rocking",
    kind="rigid",
    source="Agbabian et al. 1991, sec. 2.1; Housner 1963; Ishiyama 1982",
    equation="theta'' = -p^2 [(1 + a_z/g) sin(alpha sgn theta - theta) + (a_h/g) cos(alpha sgn theta - theta)]",
    needs=(
        Quantity("half_width", "m", "from the centre of gravity to the edge towards +axis", 0.0, exclusive=True),
        Quantity("cg_height", "m", "height of the centre of gravity above the base", 0.0, exclusive=True),
        Quantity("half_width_other", "m", "to the other edge, where it differs", 0.0, exclusive=True, optional=True),
        Quantity("gyration_radius", "m", "about the centre of gravity; else a uniform rectangle's", 0.0, optional=True),
        Quantity(
            "restitution", "-", "rate after over before an impact; else from the geometry", 0.0, 1.0, optional=True
        ),
        Quantity("initial_rotation", "rad", "released from rest", -1.6, 1.6, optional=True, default=0.0),
    ),
    gives=(
        Quantity("rotation_ratio", "-", "largest |theta| / alpha"),
        Quantity("overturned", "bool", "reached a quarter turn"),
        Quantity("overturning_time", "s", "when it did; empty if it did not", optional=True),
        Quantity("uplift_time", "s", "when an edge first lifted; empty if none did", optional=True),
        Quantity("impacts", "count", "landings at 1e-3 p alpha or faster"),
        Quantity("uplift_ratio", "-", "largest |a_h| / (max(0, g + a_z) b/h)"),
    ),
    directions=1,
    axes=(
        {"half_width": "half_base_width", "half_width_other": "half_base_width_other"},
        {"half_width": "half_base_depth", "half_width_other": "half_base_depth_other"},
    ),
    run=_run,
    screen=_screen,
    say_screen=_say,
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
    trials=Trials(
        ranges={"half_width": (0.02, 0.4), "cg_height": (0.05, 1.0)},
        extremes=_EXTREMES,
        sample={"half_width": 0.2, "cg_height": 0.5},
        promised=1e-4,
    ),
    listed="Table 1, Rigid: Rocking",
    supports=(Support.FREESTANDING,),
    pictures=(Figure("stability", _stability),),
    says=(HARMLESS, UNHARMED, OVERTURNS),
)
