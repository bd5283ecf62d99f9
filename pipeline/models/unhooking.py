r"""Generic model of a work that hangs flush with its wall: it slaps the wall, and may lift off its hooks.

A work on two hooks, D-rings or a cleat does not swing in the plane of its wall.  Out of that plane it is a plate on a
hinge, its hooks, that the wall holds back on one side: with theta how far its lower edge has opened, h how far its
hangers have risen above the hooks, L and c the centre of gravity below and in front of the hooks, K = k^2 + L^2 + c^2,
x' = L cos(theta) - c sin(theta) and z' = L sin(theta) + c cos(theta),

.. math::

    h'' + z' \theta'' + x' \theta'^2 = -(g + a_z) + v, \qquad K \theta'' + z' h'' = -a x' - (g + a_z) z' + p

where the hooks push up by v >= 0 only while h = 0, and the wall by p >= 0 only while theta = 0; both give back the
share e of the speed of a blow.  It opens once -a L > (g + a_z) c.

**When it comes off.**  The hangers leave the hooks once v = 0: on a still wall that is where the wall falls away at g
or more; a work that has opened is pushed up as well by the shaking across the wall and by what it swings.  It is off
once h exceeds the depth of the hooks.  A rectangular pulse of a_z = -A for t, on a work that stays shut, lifts it by A
(A - g) t^2 / (2 g), which is Newmark's sliding block (1965) turned upright.

**The bound.**  With R^2 = L^2 + c^2, lambda = R^2 / K and psi the angle from the plumb line through the hooks to the
centre of gravity, x' = R cos(psi) and z' = R sin(psi), so that while the hangers are on the hooks and the work below
the horizontal (x' >= 0)

.. math::

    v = (g + a_z)(1 - \lambda \sin^2\psi) - a \lambda \sin\psi \cos\psi + x' \theta'^2
      \ge (1 - \lambda \sin^2\psi)\left(g + a_z - |a| \frac{\lambda \sin\psi \cos\psi}{1 - \lambda \sin^2\psi}\right)

and the fraction is nowhere more than mu = lambda / (2 sqrt(1 - lambda)), at tan(psi) = 1 / sqrt(1 - lambda).  Where
mu |a| <= g + a_z always, v is never negative and the hangers stay where they are, whatever the work does below them.
For rings a third below the upper edge mu is 0.14, at the upper edge 0.75.

Sideways the hooks hold for as long as they hold at all; friction, and the give of hook and wall, are left out.  A
motion without a vertical component cannot lift by itself what hangs, and findings under it say so.

References
----------
Brogliato, B. (2016). Nonsmooth Mechanics. 3rd ed., Springer. Ch. 5.
Newmark, N. M. (1965). Effects of earthquakes on dams and embankments. Geotechnique 15.
"""

from collections.abc import Mapping

import numpy as np

from pipeline.kernels import SENSITIVE, samples
from pipeline.kernels.hung_plate import hung_plate_batch
from pipeline.models.common import N_, NO_VERTICAL, broadcast, grid, lift_ratios, needs, shaken
from pipeline.quantities import Array, G, Quantity
from pipeline.records import Columns, Excitation, Hanging, Harm, Model, Scene, Support, Trials
from pipeline.records import phrases as say

DOUBT = 0.01
"""Share of the lift from which the difference of two steps says that it hangs on the integration."""

LEAST = 1e-6
"""Share of a lift that is the least error told: impacts are found to 2e-8 of a step, and bounces cut at 1e-3 of one."""

LEAST_LIFT = 1e-9
"""m, the same of a lift of hardly anything."""

_OUTPUTS = ("lift", "opening", "slap")

BODY = ("hook_height", "hook_offset", "gyration", "restitution")
"""What must be known of a work and of how it hangs."""

LOCKED = frozenset({Hanging.SECURITY, Hanging.FIXED})
"""Ways to hang that nothing lifts off."""


def rise_share(parameters: Mapping[str, Array]) -> Array:
    """Return mu: by how much of the shaking across the wall hooks can be relieved at most.

    Parameters
    ----------
    parameters : mapping of str to ndarray, shape (n,)
        hook_height, hook_offset and gyration [m].

    Returns
    -------
    ndarray, shape (n,)
        lambda / (2 sqrt(1 - lambda)) [-].
    """
    square = parameters["hook_height"] ** 2 + parameters["hook_offset"] ** 2
    part = parameters["gyration"] ** 2
    # Written so that a work that is hardly more than a point far below its hooks keeps its digits.
    return np.asarray(square / (2.0 * np.sqrt(part * (part + square))))


def _followed(motion: Excitation, x: Array, parameters: Mapping[str, Array], refine: int) -> Array:
    body = [broadcast(parameters, name) for name in BODY]
    results = np.empty((body[0].size, 4))
    tail = -1.0 if motion.tail is None else float(motion.tail)
    hung_plate_batch(
        samples(x), samples(motion.z), motion.dt, shaken(motion), *body, tail, refine, results, np.empty((0, 2))
    )
    return results


def _either(motion: Excitation, parameters: Mapping[str, Array], refine: int) -> Array:
    # Which side of the work its wall is on is not recorded: the larger lift of both, and the larger of the others.
    one, other = (_followed(motion, x, parameters, refine) for x in (motion.x, -motion.x))
    flags = one[:, 3].astype(np.int64) | other[:, 3].astype(np.int64)
    return np.column_stack([np.maximum(one[:, :3], other[:, :3]), flags])


def _run(motion: Excitation, parameters: Mapping[str, Array], refine: int, estimate: bool) -> Columns:
    fine = _either(motion, parameters, 2 * refine if estimate else refine)
    # Closed hooks: whatever would have lifted it does not.
    opened = parameters["hooks_open"]
    lost = ~np.isfinite(fine[:, 0])
    out = {name: fine[:, at] for at, name in enumerate(_OUTPUTS)}
    out["lift"] = np.where(opened > 0.0, opened * out["lift"], 0.0)
    note = fine[:, 3]
    if not estimate:
        return {**out, "error": np.full_like(note, np.nan), "note": note}
    coarse = np.where(lost, 0.0, _either(motion, parameters, refine)[:, 0])
    lift = np.where(lost, 0.0, fine[:, 0])
    gap = np.abs(lift - coarse)
    least = np.where(lift > 0.0, LEAST * lift + LEAST_LIFT, 0.0)
    doubtful = ~lost & (gap > DOUBT * lift) & (gap > LEAST_LIFT)
    note = np.where(doubtful, note.astype(np.int64) | SENSITIVE, note).astype(float)
    error = np.where(lost, np.inf, 2.0 * gap + least)
    return {**out, "error": np.where(opened > 0.0, opened * error, 0.0), "note": note}


def _certificate(motion: Excitation, parameters: Mapping[str, Array]) -> Array:
    # The proof at the top of this module; along any direction, for |a| is the resultant of both.
    # A wall that falls away faster than g lifts what stays shut, however little it is pushed.
    held_down = float(motion.z.min()) >= -G
    stays = held_down & (rise_share(parameters) * max(lift_ratios(motion)) <= 1.0)
    return np.where(stays | (parameters["hooks_open"] == 0.0), 0.0, np.inf)


def _trace(motion: Excitation, parameters: Mapping[str, float]) -> Columns:
    body = [np.array([parameters[name]]) for name in BODY]
    z, peak = samples(motion.z), shaken(motion)
    sides = []
    for x in (samples(motion.x), samples(-motion.x)):
        history, results = np.zeros((motion.x.size, 2)), np.empty((1, 4))
        hung_plate_batch(x, z, motion.dt, peak, *body, 0.0, 4, results, history)
        sides.append(history)
    # The side on which it opens the farther.
    opening, lift = max(sides, key=lambda history: float(history[:, 0].max())).T
    return {"opening": opening, "lift": lift}


def _applies(scene: Scene) -> str:
    if scene.support is not Support.HUNG:
        return N_("it does not hang on a wall")
    if scene.hanging in LOCKED:
        return N_("its hardware is closed: nothing lifts it off")
    return needs(scene, "hooks_open", *BODY)


def _outcome(row: Mapping[str, float], parameters: Mapping[str, float]) -> tuple[str, str]:
    if row["slap"] <= 0.0 or parameters["hooks_open"] <= 0.0:
        return "", ""
    return "", say.OPENS(angle=float(np.degrees(row["opening"])), speed=row["slap"])


UNHOOKING = Model(
    name="unhooking",
    title="Jumping off its hooks",
    kind="rigid",
    source="Lagrange's equations with one-sided contacts (Brogliato 2016); Newmark 1965, turned upright",
    equation=(
        "h'' + z' theta'' + x' theta'^2 = -(g + a_z) + v, K theta'' + z' h'' = -a x' - (g + a_z) z' + p; "
        "v >= 0 where h = 0, p >= 0 where theta = 0"
    ),
    needs=(
        Quantity("hook_height", "m", "from the centre of gravity up to the hooks", 0.0, exclusive=True),
        Quantity("hook_offset", "m", "from the hooks forward to the centre of gravity", 0.0),
        Quantity("gyration", "m", "radius of gyration about the width", 0.0, exclusive=True),
        Quantity("restitution", "-", "share of its speed that a blow on wall or hook gives back", 0.0, 0.95),
        Quantity("hooks_open", "-", "1 where hooks are open above, 0 closed", 0.0, 1.0, optional=True, default=1.0),
    ),
    gives=(
        Quantity("lift", "m", "largest height of its hangers above the hooks"),
        Quantity("opening", "rad", "largest angle from the wall"),
        Quantity("slap", "m/s", "largest speed at which its lower edge strikes the wall"),
    ),
    directions=1,
    across=True,
    run=_run,
    axes=({},),
    certificate=_certificate,
    rests=0.0,
    trace=_trace,
    uncharted="its certificate decides most works, and the others differ in all their measures",
    demand="lift",
    capacity="hook_depth",
    applies=_applies,
    outcome=_outcome,
    sentence="Its hangers rise {demand} ({low} to {high}) above its hooks, which are {capacity} deep.",
    fails="comes off its hooks",
    states=(Harm.FALLS,),
    trials=Trials(
        ranges={
            "hook_height": (0.05, 0.5),
            "hook_offset": (0.01, 0.05),
            "gyration": (0.1, 0.6),
            "restitution": (0.1, 0.6),
        },
        extremes=grid(
            hook_height=[0.001, 0.2, 10.0], hook_offset=[0.0, 0.03], gyration=[0.01, 3.0], restitution=[0.0, 0.9]
        ),
    ),
    supports=(Support.HUNG,),
    vertical=True,
    says=(NO_VERTICAL,),
    unasked="how it hangs is not asked of this class",
)
