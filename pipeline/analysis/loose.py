r"""Furniture that is not fastened: what it passes on where it slides on its floor, or rocks.

Where friction holds it and no edge lifts, it passes on exactly what shakes it.  Where no edge can lift, whatever the
direction, it slides in the plane as `sliding` says, and the friction limits what it passes on.  Else it is a `standing`
body, which moves in a plane: nobody knows how it is turned, so that it is followed along the direction of the strongest
push, and across it by itself.  With u [m] the place of the middle of its base and theta [rad] its rotation, b [m] its
half width, what stands at a height z [m] above the middle of its base moves by

.. math::

    u + z \sin \theta, \qquad b \left| \sin \theta \right| - z \left(1 - \cos \theta\right)

along and upwards, against the floor.  The latter is of the first direction alone: a body lifts on one edge.
"""

from functools import lru_cache
from math import ceil

import numpy as np

from pipeline.analysis.furniture import LooseBody
from pipeline.analysis.model_runs import prepare
from pipeline.analysis.response import answer, trace
from pipeline.analysis.transmission import transmit
from pipeline.models.standing import STANDING, required
from pipeline.quantities import Array, G
from pipeline.records import Motion, Numerics

IMPACT = 0.02
"""Seconds that an impact takes to turn a velocity over: hard feet on a floor; judgement.

Half as long, twice the push."""

ANGLES = {"sliding": (0.0,), "standing": tuple(np.arange(0.0, 180.0, 10.0).tolist())}
"""Degrees from x towards y along which furniture is followed to see how far it moves; that of sliding is not asked."""

FREE = 8.0
"""Seconds after the record for which free rocking is passed on."""

FINEST = 0.005
"""Seconds between samples of what slides, at most."""


@lru_cache(maxsize=256)
def passed_on(motion: Motion, body: LooseBody) -> Motion:
    """Return the motion of what stands in furniture that is not fastened.

    Parameters
    ----------
    motion : Motion
        What shakes it.
    body : LooseBody
        The furniture.

    Returns
    -------
    Motion
        The very motion where it neither slides nor rocks.  Where the furniture falls over, it ends as that passes its
        critical angle: what stands in it falls with it.
    """
    what = str(required(motion.excitation(None), prepare(STANDING, _given(body)))[0])
    if not what:
        return motion
    if what == "standing":
        return _rocked(motion, body)
    refine = max(1, ceil(motion.dt / FINEST - 1e-9))
    slid = transmit("friction_isolator", motion, refine=refine, friction_static=body.friction)
    return slid.called(f"{motion.name}, furniture slides")


@lru_cache(maxsize=512)
def movement(motion: Motion, body: LooseBody) -> float:
    """Return how far furniture that is not fastened gets from where it stood.

    Parameters
    ----------
    motion, body
        As of `passed_on`.

    Returns
    -------
    float
        In the plane where it only slides, and along the worst direction where it tilts [m].
    """
    what = str(required(motion.excitation(None), prepare(STANDING, _given(body)))[0])
    if not what:
        return 0.0
    given = {"friction_static": body.friction} if what == "sliding" else _given(body)
    numerics = Numerics("history")
    far = [answer(what, motion, given, numerics, angle=angle)["displacement"][0] for angle in ANGLES[what]]
    return float(np.fmax.reduce([float(one) for one in far]))


def _given(body: LooseBody) -> dict[str, float]:
    return {"half_width": body.half_width, "cg_height": body.cg_height, "friction_static": body.friction}


def _rocked(motion: Motion, body: LooseBody) -> Motion:
    quiet = ceil(FREE / motion.dt)
    ground = Motion(motion.dt, np.pad(motion.acceleration, ((0, 0), (0, quiet))), motion.name, start=motion.start)
    x, y, z = ground.acceleration
    weight = np.maximum(G + z, 1e-3 * G)
    hardest = int(np.argmax(np.hypot(x, y) / weight))
    turn = float(np.arctan2(y[hardest], x[hardest]))
    ends, felt, moves = ground.samples, [], motion.samples
    rise = np.zeros(ground.samples)
    for way in (turn, turn + 0.5 * np.pi):
        found = trace("standing", ground, angle=float(np.degrees(way)), **_given(body))
        theta = found["rotation"].to_numpy()
        falls = np.flatnonzero(np.abs(theta) >= np.arctan2(body.half_width, body.cg_height))
        ends = min(ends, int(falls[0]) if falls.size else ends)
        moved = found["u_x"].to_numpy() + body.shelf_height * np.sin(theta)
        along = np.cos(way) * x + np.sin(way) * y
        felt.append(_felt(along, moved, ground.dt))
        if way == turn:
            rise = body.half_width * np.abs(np.sin(theta)) - body.shelf_height * (1.0 - np.cos(theta))
        changes = np.flatnonzero(np.diff(moved))
        moves = max(moves, int(changes[-1]) + 3 if changes.size else 0)
    ends = max(2, min(ends, moves))
    main, across = felt
    rows = np.vstack([
        np.cos(turn) * main - np.sin(turn) * across,
        np.sin(turn) * main + np.cos(turn) * across,
        _felt(z, rise, ground.dt),
    ])[:, :ends]  # fmt: skip
    step = f"on furniture that rocks: half width {body.half_width:g} m, centre of gravity at {body.cg_height:g} m, "
    step += f"friction {body.friction:g}, {body.shelf_height:g} m above its floor, impacts of {IMPACT:g} s"
    name = f"{motion.name}, furniture rocks"
    return Motion(motion.dt, rows, name, (*motion.steps, step), motion.source, motion.start)


def _felt(ground: Array, moved: Array, dt: float) -> Array:
    """Return the acceleration of what moves against its ground by so much, the ground's own wherever it does not.

    Where it moves, means over impacts: of the hat functions of the samples, which are second differences of the
    displacement and keep the momentum, over a hat of IMPACT.
    """
    own = np.zeros_like(ground)
    own[1:-1] = np.diff(moved, 2) / dt**2
    means = ground.copy()
    means[1:-1] = (ground[:-2] + 4.0 * ground[1:-1] + ground[2:]) / 6.0
    half = max(1, round(IMPACT / dt))
    hat = 1.0 - np.abs(np.arange(-half + 1, half)) / half
    hat /= hat.sum()
    near = np.convolve(own != 0.0, np.ones(2 * half + 1), mode="same") > 0.5
    return np.where(near, np.convolve(means + own, hat, mode="same"), ground)
