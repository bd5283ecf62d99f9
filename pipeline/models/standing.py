r"""Generic model of a standing object: a rigid body that rests, slides, rocks, does both, or is thrown up.

With (x, y) [m] the centre of gravity against the base, theta [rad] the rotation, F and N the forces on the corner at r
that touches, per mass,

.. math::

    x'' = F - a_h, \qquad y'' = N - (g + a_z), \qquad \rho^2 \theta'' = r_y F - r_x N, \qquad
    |F| \le \mu N, \; N \ge 0

It tilts only where the push exceeds what lifts an edge, and friction passes that push on:

.. math::

    \frac{\min\left(|a_h| / N_0,\, \mu_s\right)}{b / h} > 1, \qquad N_0 = \max(0, g + a_z)

That ratio is the certificate of the model, and says what a scene requires (`required`): up to 1 the body does not tilt
whatever else happens, and `sliding` alone tells all, or nothing where it does not slip either; above 1 it tilts, and
whether its edge then holds is seen on the way.

A corner that comes down stays down, by an impulse with friction; where it sticks that is Housner's landing, whose
restitution may be given, or multiplied by a factor: 0.95 to 0.97 of concrete blocks, 0.67 on rubber (ElGawady 2011).

References
----------
Shenton, H. W. (1996). Criteria for initiation of slide, rock, and slide-rock rigid-body modes. Journal of Engineering
Mechanics 122, 690-693.
Shenton, H. W. and Jones, N. P. (1991). Base excitation of rigid bodies. I: formulation. Journal of Engineering
Mechanics 117, 2286-2306.
ElGawady, M. A., Ma, Q., Butterworth, J. W. and Ingham, J. (2011). Effects of interface material on the performance of
free rocking blocks. Earthquake Engineering and Structural Dynamics 40.
Housner, G. W. (1963). The behavior of inverted pendulum structures during earthquakes. Bulletin of the Seismological
Society of America 53.
Ishiyama, Y. (1982). Motions of rigid bodies and criteria for overturning by earthquake excitations. Earthquake
Engineering and Structural Dynamics 10.
Pompei, A., Scalia, A. and Sumbatyan, M. A. (1998). Dynamics of rigid block due to horizontal ground motion. Journal of
Engineering Mechanics 124, 713-717.
Taniguchi, T. (2002). Non-linear response analyses of rectangular rigid bodies subjected to horizontal and vertical
ground motion. Earthquake Engineering and Structural Dynamics 31.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from pipeline.kernels import SENSITIVE, UNRESOLVED
from pipeline.kernels import standing_body as kernel
from pipeline.kernels.rocking import OVERTURNED, REST
from pipeline.kernels.standing import standing_batch
from pipeline.models.common import (
    NO_VERTICAL,
    ROUNDING,
    SHIFT,
    Quiet,
    lift_ratios,
    needs,
    shared,
    unless_free,
)
from pipeline.models.flips import (
    ALL,
    APART,
    FELL,
    FLAGS,
    RATIO,
    Integration,
    Rows,
    apart,
    doubt,
    flips,
)
from pipeline.models.friction import kinetic, slip_bounds
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
    bodies,
    comes_back,
    falls_over,
    found_again,
    narrow_slope,
    one_width,
    overturning,
    say_screen,
    screen,
    sides,
    tipped,
    tipping,
)
from pipeline.models.sliding import FRICTION_KINETIC, FRICTION_STATIC
from pipeline.quantities import Array, G, Quantity
from pipeline.records import Bounds, Columns, Estimate, Excitation, Harm, Model, Origin, Scene, Support, Trials
from pipeline.records import phrases as say

SLIDES = "slides"

FINER = 4
"""How much finer those are integrated anew that two steps disagree about: a chaotic sequence of impacts, mostly."""

ONSET = 0.01
"""Relative distance of the largest push from the friction at which a slip hangs on 1 % of the amplitude."""


def standing_bodies(parameters: Mapping[str, Array]) -> Array:
    """Return what the kernel needs of each body.

    Parameters
    ----------
    parameters : mapping of str to ndarray, shape (n,)
        Those of the model, in SI; NaN for what is not given.

    Returns
    -------
    ndarray, shape (n, BODY)
        As `pipeline.kernels.standing_body` says.
    """
    rocking = bodies(parameters)
    theory = bodies({**parameters, "restitution": np.full(rocking.shape[0], np.nan)})[:, 4:]
    wanted = np.minimum(1.0, rocking[:, 4:] * parameters["restitution_factor"][:, None])
    height = parameters["cg_height"]
    b1, b2, rho2 = sides(parameters)
    out = np.empty((rocking.shape[0], kernel.BODY))
    for side, half in enumerate((b1, b2)):
        arm = np.hypot(half, height)
        columns = {
            kernel.ALPHA: rocking[:, side],
            kernel.SINE: half / arm,
            kernel.COSINE: height / arm,
            kernel.TANGENT: half / height,
            kernel.INVERSE: rocking[:, 2 + side],
            kernel.ARM: arm,
            kernel.HALF: half,
            # A landing that Housner's impact brings to rest may still be given a restitution.
            kernel.GAIN: np.divide(
                wanted[:, side], theory[:, side], out=np.zeros_like(arm), where=theory[:, side] > 0.0
            ),
            kernel.DIRECT: np.where(theory[:, side] > 0.0, 0.0, wanted[:, side]),
        }
        for column, values in columns.items():
            out[:, column + side] = values
    out[:, kernel.RHO2], out[:, kernel.HEIGHT] = rho2, height
    out[:, kernel.MU_S], out[:, kernel.MU_K] = parameters["friction_static"], kinetic(parameters)
    out[:, kernel.SLOW] = np.min(np.sqrt(G * rocking[:, 2:4]) * rocking[:, :2], axis=1)
    out[:, kernel.LOSS] = 1.0 - wanted[:, 0] * wanted[:, 1]
    return out


def tilt_ratios(motion: Excitation, body: Array) -> Array:
    """Return the largest push that friction passes on, as a share of what lifts an edge: up to 1 nothing tilts.

    Parameters
    ----------
    motion : Excitation
        Along a direction, of which the ratio is exact, or in two, of which it is the most of any direction.
    body : ndarray, shape (n, BODY)
        As from `standing_bodies`.

    Returns
    -------
    ndarray, shape (n,)
        [-].

    Notes
    -----
    Proof: flat on its base the body feels a force of at most min(|a_h|, mu_s N) along the base, at a height h below the
    centre of gravity; the moment of it is held by the weight at an arm of up to b.  In the air a body that did not turn
    does not begin to; where it lands as a whole the impulse along the base, whatever the push was, is at most mu_s
    times the one that presses it down, so that the push counts as unlimited where a body is thrown up.
    """
    return _tilts(motion, body[:, kernel.MU_S], body[:, kernel.TANGENT], body[:, kernel.TANGENT + 1])


def _tilts(motion: Excitation, friction: Array, tangent: Array, tangent_other: Array) -> Array:
    to_positive, to_negative = lift_ratios(motion)
    # What it is thrown up by counts as unlimited.
    if max(to_positive, to_negative) > 0.0 and np.min(motion.z) < -G:
        to_positive = to_negative = np.inf
    return np.maximum(np.minimum(to_positive, friction) / tangent, np.minimum(to_negative, friction) / tangent_other)


def _runs(body: Array) -> Integration:
    # Those bodies as `doubt` and `flips` ask for them.
    def run(motion: Excitation, rows: Rows, refine: int, until: Array | None = None, rest: float = REST) -> Array:
        return _integrate(motion, body[rows], refine, until, rest, np.empty((0, 2)))

    return run


def _integrate(motion: Excitation, body: Array, refine: int, until: Array | None, rest: float, history: Array) -> Array:
    quiet = Quiet(motion)
    results = np.empty((body.shape[0], kernel.FOUND))
    ends = np.full(body.shape[0], np.inf) if until is None else until

    def follow(part: slice) -> None:
        standing_batch(
            quiet.x,
            quiet.z,
            quiet.ratio,
            quiet.maxima,
            quiet.dt,
            quiet.peak,
            body[part],
            quiet.tail,
            ends[part],
            refine,
            rest,
            results[part],
            history,
        )

    shared(follow, body.shape[0], quiet.x.size, together=1)
    return results


def _pace(body: Array) -> Array:
    # p [rad/s] (n,) about the first edge.
    return np.sqrt(G * body[:, kernel.INVERSE])


def _run(motion: Excitation, parameters: Mapping[str, Array], refine: int, estimate: bool) -> Columns:
    body = standing_bodies(parameters)
    run, pace, tilt = _runs(body), _pace(body), tilt_ratios(motion, body)
    fine = run(motion, ALL, 2 * refine if estimate else refine)
    error, sensitive = np.full(tilt.size, np.nan), np.zeros(tilt.size, dtype=bool)
    away = error
    if estimate:
        coarse = run(motion, ALL, refine)
        wild = apart(coarse, fine, pace)
        if wild.any():
            coarse[wild], fine[wild] = (run(motion, wild, times * refine) for times in (FINER, 2 * FINER))
        error, sensitive = doubt(run, motion, refine, tilt, pace, coarse, fine)
        away = 2.0 * np.abs(fine[:, kernel.AWAY] - coarse[:, kernel.AWAY]) + ROUNDING * fine[:, kernel.AWAY]
        sensitive |= (away > APART * fine[:, kernel.AWAY]) | _may_slip(motion, body)
    note = fine[:, FLAGS].astype(np.int64) | np.where(sensitive, SENSITIVE, 0)
    lost = (note & UNRESOLVED) > 0
    if lost.any():
        # It may do anything up to falling over, and nobody knows where its base is then.
        fine[lost, RATIO], fine[lost, FELL] = _most(body[lost]), 1.0
        fine[lost, kernel.AWAY] = fine[lost, kernel.RESIDUAL] = np.nan
        error, away = np.where(lost, fine[:, RATIO], error), np.where(lost, np.nan, away)
    return tipped(fine, estimate=estimate) | {
        "displacement": fine[:, kernel.AWAY],
        "residual": np.abs(fine[:, kernel.RESIDUAL]),
        "uplift_ratio": tilt,
        "error": np.fmax(error, away),
        "displacement_error": away,
        "note": note.astype(np.float64),
    }


def _most(body: Array) -> Array:
    # The ratio of one that falls, after which it is not followed.
    most: Array = OVERTURNED / np.min(body[:, kernel.ALPHA : kernel.ALPHA + 2], axis=1)
    return most


def _may_slip(motion: Excitation, body: Array) -> NDArray[np.bool_]:
    # Whether it slips at all hangs on 1 % of the amplitude, as in `sliding`, and it would do nothing else.
    needed, friction = max(lift_ratios(motion)), body[:, kernel.MU_S]
    slides = friction <= np.min(body[:, kernel.TANGENT : kernel.TANGENT + 2], axis=1)
    near: NDArray[np.bool_] = slides & (np.abs(friction - needed) < ONSET * friction)
    return near


def _flips(motion: Excitation, parameters: Mapping[str, Array], columns: Columns) -> NDArray[np.bool_]:
    body = standing_bodies(parameters)
    return flips(_runs(body), motion, columns["uplift_ratio"], _pace(body), found_again(columns, kernel.FOUND))


def _trace(motion: Excitation, parameters: Mapping[str, float]) -> Columns:
    body = standing_bodies({name: np.array([value]) for name, value in parameters.items()})
    history = np.zeros((motion.x.size, 2))
    _integrate(replace(motion, tail=0.0), body, 4, None, REST, history)
    return {"rotation": history[:, 0], "u_x": history[:, 1]}


def _certificate(motion: Excitation, parameters: Mapping[str, Array]) -> Array:
    # All that tilt_ratios asks of a body: it is asked before anything is run, and as a rule it says that nothing is.
    b1, b2, _ = sides(parameters)
    height = parameters["cg_height"]
    return _tilts(motion, parameters["friction_static"], b1 / height, b2 / height)


def _bound(motion: Excitation, parameters: Mapping[str, Array]) -> Bounds:
    body = standing_bodies(parameters)
    tilt, friction = tilt_ratios(motion, body), body[:, kernel.MU_S]
    tilts, thrown = tilt > 1.0, bool(np.min(motion.z) < -G)
    # Once it lifts an edge it may do anything up to falling over, after which it is not followed.
    most = np.where(tilts, _most(body), 0.0)
    slips = slip_bounds(motion, friction, body[:, kernel.MU_K], "displacement")
    low, high = slips.outputs["displacement"]
    nothing = np.zeros_like(low)
    # What is thrown up has no friction until it lands; what tilts takes its base along.
    free = tilts | (thrown & (max(lift_ratios(motion)) > friction))
    low = np.where(free, 0.0, low) if motion.y is None else nothing
    bounds = {
        "rotation_ratio": (nothing, most),
        "displacement": (low, np.where(free, np.inf, high)),
        "residual": (nothing, np.where(free, np.inf, high)),
        "overturned": (nothing, tilts.astype(np.float64)),
        "impacts": (nothing, np.where(tilts | thrown, np.inf, 0.0)),
        "uplift_ratio": (tilt if motion.y is None else nothing, tilt),
    }
    return Bounds(bounds, nothing)


def _screen(motion: Excitation, parameters: Mapping[str, Array]) -> Columns:
    # The paper's, which lets nothing slide.
    nothing = np.full_like(parameters["cg_height"], np.nan)
    return screen(motion, parameters) | {"displacement": nothing, "residual": nothing}


def _say(row: Mapping[str, float], parameters: Mapping[str, float]) -> str:
    slope, friction = narrow_slope(parameters), parameters["friction_static"]
    slides = friction < min(slope, row["uplift_ratio"] * slope)
    held = f" {say.SLIDES_BEFORE(friction=friction)}" if slides else ""
    return say_screen(row, parameters) + held


def _mark(parameters: Mapping[str, float], demand: float) -> tuple[str, float, float] | None:
    # The picture lets nothing slide: what friction alone keeps from tipping would lie in a wrong field of it.
    slope = parameters["half_width"] / parameters["cg_height"]
    if demand <= 1.0 and demand * slope >= parameters["friction_static"]:
        return None
    return "stability", 2.0 * parameters["cg_height"], 2.0 * parameters["half_width"]


def _counted(name: str, estimate: Estimate) -> Estimate:
    # A low friction that nobody measured excuses nothing (paper, 2.6): less than the best estimate is not counted on.
    assumed = name == FRICTION_STATIC.name and estimate.origin is Origin.ASSUMED
    return replace(estimate, low=estimate.value) if assumed else estimate


def required(motion: Excitation, parameters: Mapping[str, Array]) -> NDArray[np.str_]:
    """Say which model tells all about a standing object under a motion.

    Parameters
    ----------
    motion : Excitation
        Along a direction, or in two, of which what is said holds for any direction.
    parameters : mapping of str to ndarray, shape (n,)
        Those of the model, in SI; NaN for what is not given.

    Returns
    -------
    ndarray of str, shape (n,)
        "" where it rests; "sliding" where no edge lifts (proof: `tilt_ratios`); else "standing".

    Notes
    -----
    `rocking` alone, of a body that tilts, cannot be proved beforehand: the friction that an edge needs grows without a
    limit as a fast rotation takes the weight off it, and how fast it turns is not known before.  Where the edge holds
    throughout, `standing` takes the very steps that `rocking` does.
    """
    body = standing_bodies(parameters)
    slides = max(lift_ratios(motion)) > body[:, kernel.MU_S]
    return np.where(tilt_ratios(motion, body) > 1.0, "standing", np.where(slides, "sliding", ""))


def _applies(scene: Scene) -> str:
    return unless_free(scene) or needs(scene, "half_width", "cg_height", "friction_static")


def _outcome(row: Mapping[str, float], _parameters: Mapping[str, float]) -> tuple[str, str]:
    if row["overturned"]:
        return falls_over(row)
    if row["rotation_ratio"] > 0.0:
        return ROCKS, comes_back(row)
    if row["displacement"] > 0.0:
        return SLIDES, say.SLIDES_ONLY(away=row["displacement"])
    return "", ""


def _reaches(columns: Columns, _exceeded: NDArray[np.bool_], room: Array) -> Mapping[Harm, NDArray[np.bool_]]:
    # What tips over has left its place by falling, which is the worse.
    away, fell = columns["displacement"], columns["overturned"] > 0.0
    return tipping(columns) | {Harm.LEAVES: (away > room) & ~fell, Harm.SHIFTS: away > SHIFT}


_ALPHAS, _FRICTIONS = np.meshgrid([0.02, 0.2, 1.2], [0.0, 0.05, 0.4, 5.0])
_EXTREMES = {
    "half_width": (0.3 * np.tan(_ALPHAS)).ravel().tolist(),
    "cg_height": [0.3] * _ALPHAS.size,
    "friction_static": _FRICTIONS.ravel().tolist(),
}
"""Plates, columns and boxes on ice, on polished and on rough surfaces, and on one that they cannot leave."""

STANDING = Model(
    name="standing",
    title="Tipping",
    kind="rigid",
    source="Shenton 1996; Shenton and Jones 1991; Housner 1963; Ishiyama 1982",
    equation="x'' = F - a_h, y'' = N - (g + a_z), rho^2 theta'' = r_y F - r_x N, |F| <= mu N, N >= 0",
    needs=(
        HALF_WIDTH,
        CG_HEIGHT,
        FRICTION_STATIC,
        FRICTION_KINETIC,
        HALF_WIDTH_OTHER,
        GYRATION_RADIUS,
        RESTITUTION,
        Quantity(
            "restitution_factor", "-", "what that is multiplied by, up to 1", 0.0, 2.0, optional=True, default=1.0
        ),
    ),
    gives=(
        Quantity("rotation_ratio", "-", "largest |theta| / alpha"),
        Quantity("displacement", "m", "largest distance of the middle of the base from where it stood"),
        Quantity("residual", "m", "the same when it rests, or falls"),
        *TIPS,
        Quantity("uplift_ratio", "-", "largest min(|a_h| / max(0, g + a_z), mu_s) / (b/h)"),
    ),
    directions=1,
    axes=AXES,
    errors={"displacement": "displacement_error", "residual": "displacement_error"},
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
    mark=_mark,
    demand="uplift_ratio",
    capacity=1.0,
    applies=_applies,
    counted=_counted,
    symmetric=one_width,
    uncharted="its outcomes flip back and forth, so that it is never tabulated",
    sentence=(
        "The largest push that friction passes on is {demand} ({low} to {high}) times what lifts an edge of this "
        "object; from 1 on it rocks."
    ),
    fails=ROCKS,
    states=(Harm.FALLS, Harm.ROCKS, Harm.LEAVES, Harm.SHIFTS),
    reaches=_reaches,
    trials=Trials(
        ranges={"half_width": (0.02, 0.4), "cg_height": (0.05, 1.0), "friction_static": (0.1, 0.6)},
        extremes=_EXTREMES,
        sample={"half_width": 0.15, "cg_height": 0.5, "friction_static": 0.5},
        promised=1e-4,
    ),
    supports=(Support.FREESTANDING,),
    tips=True,
    vertical=True,
    says=(HARMLESS, UNHARMED, OVERTURNS, SLIDES, NO_VERTICAL),
)
