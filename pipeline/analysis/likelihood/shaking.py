"""The shaking of a joint sample: a motion of the level, scaled by the scatter of the models, through its furniture."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from pipeline.analysis.fragility.curve import stated
from pipeline.analysis.furniture import FurnitureFilter, LooseBodies, LooseBody
from pipeline.analysis.likelihood.draws import (
    DAMPING,
    DIRECTION,
    FREQUENCY,
    HIGH,
    LEAN,
    MOTION,
    ROUGH,
    SCATTER,
    UPHILL,
    WIDE,
    Draw,
    value_at,
)
from pipeline.analysis.loose import passed_on
from pipeline.analysis.model_runs import prepare
from pipeline.models.oscillator import OSCILLATOR
from pipeline.models.standing import STANDING
from pipeline.quantities import G
from pipeline.records import Excitation, Motion

FARTHEST = 2.0
"""Standard deviations beyond which the scatter of the models is not followed: 1 sample of 22 is put there."""


def drawn_motion(motions: Sequence[Motion], draw: Draw) -> Motion:
    """Return the one of the motions of a level that is drawn, as strong as the scatter of the models makes it.

    What models leave out (the third dimension of rocking, the give of a floor) makes them err in both directions:
    dispersion.csv says by how much, as a dispersion of the shaking at which they say that something happens.
    """
    from scipy.special import ndtri

    at = which_motion(len(motions), draw)
    off = float(np.clip(ndtri(draw.share(SCATTER)), -FARTHEST, FARTHEST))
    return motions[at].scaled(float(np.exp(stated("modelling").value * off)), "scatter of the models")


def which_motion(motions: int, draw: Draw) -> int:
    """Return which of so many motions is drawn."""
    return min(int(draw.share(MOTION) * motions), motions - 1)


def scatter() -> float:
    """Return the standard deviation of ln of what the scatter of the models scales motions by [-]."""
    from scipy.special import ndtr

    end = FARTHEST
    density = float(np.exp(-0.5 * end * end) / np.sqrt(2.0 * np.pi))
    # What lies beyond the ends is put there.
    square = 2.0 * ndtr(end) - 1.0 - 2.0 * end * density + 2.0 * end**2 * ndtr(-end)
    return stated("modelling").value * float(np.sqrt(square))


def direction(draw: Draw) -> float:
    """Return how an object stands of which nobody says it, degrees from x towards y."""
    return 360.0 * draw.share(DIRECTION)


def through(motion: Motion, furniture: FurnitureFilter | None, draw: Draw) -> tuple[Motion, bool]:
    """Return what furniture that is drawn passes on, and whether it falls over.

    Parameters
    ----------
    motion
        Of its floor.
    furniture
        What it may be; None: nothing is between the object and the floor.
    draw
        The joint sample.

    Returns
    -------
    motion : Motion
        At the same instants.  Between them the push is taken as even, which lowers its peak by 3 % on average, and by
        8 % at most, at 12 Hz and 0.01 s.
    falls : bool
        Whether it is not fastened and falls over.
    """
    if furniture is None:
        return motion, False
    shaken, falls = motion, False
    if furniture.frequency:
        shaken = _oscillated(motion, _of(furniture.frequency, FREQUENCY, draw), _of(furniture.damping, DAMPING, draw))
        if furniture.loose is not None:
            body = _body(furniture.loose, draw)
            falls = overturns(shaken, body, direction(draw))
            # Nobody asks for it again: it is not to be remembered.
            passed = passed_on.__wrapped__(shaken, body)
            # Along the strongest push it may fall where it does not along either of these: then the motion ends.
            falls, shaken = falls or passed.samples < shaken.samples, passed
    tilt = G * float(np.sin(furniture.level_error * draw.share(LEAN)))
    if tilt == 0.0:
        return shaken, falls
    uphill = 2.0 * np.pi * draw.share(UPHILL)
    leaning = shaken.acceleration.copy()
    leaning[:2] += tilt * np.array([[np.cos(uphill)], [np.sin(uphill)]])
    return Motion(shaken.dt, leaning, shaken.name, start=shaken.start, v_max=shaken.v_max), falls


def overturns(motion: Motion, body: LooseBody, turned: float) -> bool:
    """Say whether furniture that is not fastened falls over, along its width or across it."""
    given = {"half_width": body.half_width, "cg_height": body.cg_height, "friction_static": body.friction}
    values = prepare(STANDING, given)
    ways = (motion.excitation(turned + across) for across in (0.0, 90.0))
    return any(STANDING.run(way, values, 1, False)["overturned"][0] > 0.0 for way in ways)


def _oscillated(motion: Motion, frequency: float, damping: float) -> Motion:
    given = {"frequency": frequency, "damping": damping}
    x, y, z = motion.acceleration
    rows = [OSCILLATOR.trace(Excitation(motion.dt, way, None, z, 0.0), given)["a_x"] for way in (x, y)]  # type: ignore[misc]
    return Motion(motion.dt, [*rows, z], motion.name, start=motion.start)


def _of(ends: tuple[float, ...], role: str, draw: Draw) -> float:
    return value_at(draw.share(role), *ends)


def _body(bodies: LooseBodies, draw: Draw) -> LooseBody:
    best, firm, tippy, slippery = bodies.best, bodies.firm, bodies.tippy, bodies.slippery
    return replace(
        best,
        half_width=_of((tippy.half_width, best.half_width, firm.half_width), WIDE, draw),
        cg_height=_of((firm.cg_height, best.cg_height, tippy.cg_height), HIGH, draw),
        friction=_of((slippery.friction, best.friction, firm.friction), ROUGH, draw),
    )
