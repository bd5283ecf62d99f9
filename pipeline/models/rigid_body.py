"""Rigid bodies that tip about the edges of their base: what the models of rocking have in common.

Parameters and their axes, what the kernels need of a body, outputs, the paper's criterion, and how a failure is told.
"""

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from pipeline.models.common import NO_HISTORY, largest_push, largest_speed
from pipeline.models.flips import FELL, FELL_AT, IMPACTS, LAST_NEAR, LIFTED_AT, RATIO
from pipeline.quantities import Array, G, Quantity
from pipeline.records import Columns, Excitation, Harm, Scene
from pipeline.records import phrases as say

HALF_WIDTH = Quantity("half_width", "m", "from the centre of gravity to the edge towards +axis", 0.0, exclusive=True)
HALF_WIDTH_OTHER = Quantity(
    "half_width_other", "m", "to the other edge, where it differs", 0.0, exclusive=True, optional=True
)
CG_HEIGHT = Quantity("cg_height", "m", "height of the centre of gravity above the base", 0.0, exclusive=True)
GYRATION_RADIUS = Quantity(
    "gyration_radius", "m", "about the centre of gravity; else a uniform rectangle's", 0.0, optional=True
)
RESTITUTION = Quantity(
    "restitution", "-", "rate after over before an impact; else from the geometry", 0.0, 1.0, optional=True
)

AXES = (
    {"half_width": "half_base_width", "half_width_other": "half_base_width_other"},
    {"half_width": "half_base_depth", "half_width_other": "half_base_depth_other"},
)
"""What takes the places of the half widths where the object's own axes are known."""

TIPS = (
    Quantity("overturned", "bool", "reached a quarter turn"),
    Quantity("overturning_time", "s", "when it did; empty if it did not", optional=True),
    Quantity("uplift_time", "s", "when an edge first lifted; empty if none did", optional=True),
    Quantity("impacts", "count", "landings at 1e-3 p alpha or faster"),
)
"""Outputs besides the rotation."""

VELOCITY_SCREEN = 1.0
"""V_max > 10 B / sqrt(H') in cm and s is V_max > 1.0 B / sqrt(H') in m and s (Ishiyama 1982, in the paper's form)."""

HARMLESS = "Rocking itself does not harm it, as the museum says; it fails if it falls over."
OVERTURNS, ROCKS = "overturns", "rocks"


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


def tipped(found: Array, *, estimate: bool) -> Columns:
    """Return the outputs that an integration tells of bodies that may tip.

    Parameters
    ----------
    found : ndarray, shape (n, 8 or more)
        As a `flips.Integration` returns it.
    estimate : bool
        Whether the run was made with an estimate of its error.

    Returns
    -------
    dict of str to ndarray, shape (n,)
        "rotation_ratio" and `TIPS`.  Without an estimate "near_until" besides, which `found_again` asks for.
    """
    hidden = {} if estimate else {"near_until": found[:, LAST_NEAR]}
    return hidden | {
        "rotation_ratio": found[:, RATIO],
        "overturned": found[:, FELL],
        "overturning_time": np.where(found[:, FELL_AT] < 0.0, np.nan, found[:, FELL_AT]),
        "uplift_time": np.where(found[:, LIFTED_AT] < 0.0, np.nan, found[:, LIFTED_AT]),
        "impacts": found[:, IMPACTS],
    }


def found_again(columns: Columns, width: int) -> Array:
    """Return what an integration had found of bodies, from the columns of a run without an estimate.

    Parameters
    ----------
    columns : mapping of str to ndarray, shape (n,)
        As from `tipped`.
    width : int
        Columns of the integration.

    Returns
    -------
    ndarray, shape (n, width)
        For `flips.flips`: columns that it does not look at are 0.
    """
    found = np.zeros((columns["overturned"].size, width))
    found[:, RATIO], found[:, FELL], found[:, LAST_NEAR] = (
        columns[name] for name in ("rotation_ratio", "overturned", "near_until")
    )
    found[:, FELL_AT], found[:, LIFTED_AT] = (
        np.nan_to_num(columns[name], nan=-1.0) for name in ("overturning_time", "uplift_time")
    )
    return found


def tipping(columns: Columns) -> dict[Harm, NDArray[np.bool_]]:
    """Return which bodies rock, and which of them fall over.

    Parameters
    ----------
    columns : mapping of str to ndarray, shape (n,)
        What the model gives.

    Returns
    -------
    dict of Harm to ndarray of bool, shape (n,)
        For `Model.reaches`.
    """
    return {Harm.FALLS: columns["overturned"] > 0.0, Harm.ROCKS: columns["rotation_ratio"] > 0.0}


def one_width(parameters: Mapping[str, Array]) -> bool:
    """Say whether all bodies, with their `HALF_WIDTH` (n,), are the same turned by half a turn."""
    other = parameters["half_width_other"]
    return bool(np.all(np.isnan(other) | (other == parameters["half_width"])))


def screen(motion: Excitation, parameters: Mapping[str, Array]) -> Columns:
    """Return the paper's criterion, A_max/g > B/H' and V_max > 10 B/sqrt(H') [cm, s].

    Parameters
    ----------
    motion : Excitation
        What shakes them.
    parameters : mapping of str to ndarray, shape (n,)
        Half widths and height of the centre of gravity [m].

    Returns
    -------
    dict of str to ndarray, shape (n,)
        "uplift_ratio", "velocity_ratio", "overturned"; the outputs that it knows nothing of are NaN.

    References
    ----------
    Agbabian et al. (1991), sec. 2.1; Ishiyama (1982).
    """
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


def narrow_slope(parameters: Mapping[str, float]) -> float:
    """Return b/h of one body towards its nearer edge [-]."""
    return float(np.fmin(parameters["half_width"], parameters["half_width_other"])) / parameters["cg_height"]


def say_screen(row: Mapping[str, float], parameters: Mapping[str, float]) -> str:
    """Return the paper's criterion in words.

    Parameters
    ----------
    row : mapping of str to float
        One of `screen`.
    parameters : mapping of str to float
        Of that body.
    """
    slope = narrow_slope(parameters)
    lifts = say.LIFTS if row["uplift_ratio"] > 1.0 else say.STAYS_DOWN
    falls = say.OVERTURNS if row["overturned"] else say.STAYS_UP
    return f"{lifts(push=row['uplift_ratio'] * slope, slope=slope)} {falls(ratio=row['velocity_ratio'])}"


def falls_over(row: Mapping[str, float]) -> tuple[str, str]:
    """Return what a body does that falls over, in a word and in a sentence."""
    return OVERTURNS, say.FALLS_OVER(time=row["overturning_time"])


def comes_back(row: Mapping[str, float]) -> str:
    """Return in a sentence how far a body tips that comes back, and where it ends if it has moved."""
    if "residual" in row:
        return say.COMES_BACK_MOVED(share=row["rotation_ratio"], times=row["impacts"], away=row["residual"])
    return say.COMES_BACK(share=row["rotation_ratio"], times=row["impacts"])


UNHARMED = "Rocking itself does not harm an object of its kind; it fails if it falls over."
"""What is said where its class says so, and the museum nothing."""

FALLS_IN = "overturned_share"
"""Parameter of a scene whose class is not harmed by rocking: the share of the motions in which it may fall over."""

HALF = 0.5 - 1e-9
"""Share of the motions from which on an object counts as overturned ("half the records" included)."""


def rocking_harms(scene: Scene) -> bool:
    """Say whether rocking itself harms an object: unless the museum, or else its class, says that it does not.

    Parameters
    ----------
    scene : Scene
        An object where it stands.

    Returns
    -------
    bool
        As `overturning` judges it.
    """
    return overturning(scene) is None


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
