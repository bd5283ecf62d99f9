"""Joint samples of what is uncertain: one matrix of shares for all objects, and the distributions that they are of.

Each row is a sample of everything at once: of the motion, the direction, the furniture, and of every parameter by its
name.  All objects are drawn from the same rows, so that what stands in the same kind of furniture shares the shaking of
each sample, the order of two objects does not hang on luck, and the digits are the same whoever samples and with whom.
The rows are those of a scrambled Sobol' sequence, of which every first 2^k are balanced.

Of a number with a best estimate and a range nothing is taken to be known but these three: the distribution with the
largest entropy between the ends whose median is the best estimate is even on either side of it, in the logarithm for
what is a scale.  So nothing ever lies outside of a range, and what holds for the whole range holds for all samples.

References
----------
Sobol', I. M. (1967). On the distribution of points in a cube and the approximate evaluation of integrals. USSR
Computational Mathematics and Mathematical Physics 7.
Jaynes, E. T. (1968). Prior probabilities. IEEE Transactions on Systems Science and Cybernetics 4.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache, cached_property
from math import exp

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.fragility.curve import stated
from pipeline.analysis.furniture import FurnitureFilter, LooseBodies, LooseBody
from pipeline.analysis.loose import passed_on
from pipeline.analysis.model_runs import prepare
from pipeline.models import MODELS
from pipeline.models.oscillator import OSCILLATOR
from pipeline.models.standing import STANDING
from pipeline.quantities import Array, G
from pipeline.records import Estimate, Excitation, Motion
from pipeline.records.likelihood import CLASS

MOTION, DIRECTION, SCATTER = "motion", "direction", "scatter"
FREQUENCY, DAMPING, LEAN, UPHILL = "furniture frequency", "furniture damping", "lean", "uphill"
WIDE, HIGH, ROUGH = "furniture half width", "furniture centre of gravity", "furniture friction"

ROLES = (MOTION, DIRECTION, SCATTER, FREQUENCY, DAMPING, LEAN, UPHILL, WIDE, HIGH, ROUGH)
"""What the samples of all objects share besides the numbers of the objects themselves."""

SEED = 1991
"""Of the scrambling; any other one is as good."""

ONE_CAUSE: Mapping[str, str] = {
    **dict.fromkeys(
        ("half_width_other", "half_base_width", "half_base_width_other", "half_base_depth", "half_base_depth_other"),
        "half_width",
    ),
    **dict.fromkeys(("section_modulus_width", "section_modulus_depth"), "section_modulus"),
    # The height of the centre of gravity is what the lever of its weight is.
    "lever": "cg_height",
    # How a work hangs: on a wire it swings and lifts off, on security hardware neither.
    "hooks_open": "freedom",
}
"""Parameters that one cause drives with another one: they go up and down together."""

SWITCHES = ("freedom", "hooks_open")
"""Parameters that are either 0 or 1."""

OTHERWISE = 0.25
"""Probability that a switch of which nobody says how it stands is not as is usual: judgement, 0.1 to 0.5."""


@cache
def _names() -> tuple[str, ...]:
    inputs = (name for model in MODELS for name in (*model.inputs, model.capacity) if isinstance(name, str))
    return (*ROLES, *dict.fromkeys(ONE_CAUSE.get(name, name) for name in inputs))


@cache
def _places() -> dict[str, int]:
    names = _names()
    at = {name: place for place, name in enumerate((*names, CLASS))}
    return at | {name: at[cause] for name, cause in ONE_CAUSE.items() if cause in at}


@cache
def _shares(samples: int) -> Array:
    from scipy.stats import qmc

    drawn = qmc.Sobol(len(_names()), scramble=True, rng=SEED).random(samples)
    # Scrambled by itself: the class being drawn too changes no digit of what is certain.
    classes = qmc.Sobol(len(_names()) + 1, scramble=True, rng=SEED + 1).random(samples)[:, -1:]
    return np.hstack([drawn, classes])


def shares(name: str, samples: int | Sequence[int], most: int) -> Array:
    """Return the shares of a distribution below which samples lie: of a role, or of a parameter.

    Parameters
    ----------
    name : str
        Its name.
    samples : int or sequence of int
        The first so many, or those of these numbers.
    most : int
        Of how many at most.

    Returns
    -------
    ndarray, shape (n,)
    """
    which = slice(samples) if isinstance(samples, int) else samples
    return np.asarray(_shares(most)[which, _places()[name]])


@dataclass(frozen=True)
class Draw:
    """One joint sample.

    Attributes
    ----------
    number : int
        Which, from 0.
    most : int
        Of how many at most.
    """

    number: int
    most: int

    def share(self, name: str) -> float:
        """Return the share of a distribution below which the sample lies: of a role, or of a parameter."""
        return float(_shares(self.most)[self.number, _places()[name]])


@dataclass(frozen=True)
class JointDraws:
    """Some joint samples, of which several objects are drawn.

    Attributes
    ----------
    each : sequence of Draw
        Of as many at most.
    of : ndarray of int, shape (n,)
        Of each that is drawn which of them it is of.
    """

    each: Sequence[Draw]
    of: NDArray[np.intp]

    def share(self, name: str) -> Array:
        """Return the shares of a distribution below which each lies that is drawn, (n,)."""
        return shares(name, [draw.number for draw in self.each], self.each[0].most)[self.of]

    def take(self, some: NDArray[np.intp]) -> "JointDraws":
        """Return the same samples, of some of what is drawn."""
        return JointDraws(self.each, self.of[some])


@dataclass(frozen=True)
class Ranges:
    """A parameter of some objects.

    Attributes
    ----------
    name : str
        Which.
    low, best, high : ndarray, shape (m,)
        Of each object, in the unit of the parameter; the same three times where it is measured, NaN where not given.
    causes : mapping of str to ndarray of bool, shape (m,)
        Of which objects another parameter shares the cause of the range: they go up and down together.
    """

    name: str
    low: Array
    best: Array
    high: Array
    causes: Mapping[str, NDArray[np.bool_]] = field(default_factory=dict)

    @classmethod
    def of(cls, name: str, estimates: Sequence[Estimate | None], default: float) -> "Ranges":
        """Return the ranges of what is known of some objects, a default where nothing is."""
        told = [(default,) * 3 if one is None else (one.low, one.value, one.high) for one in estimates]
        low, best, high = np.array(told, dtype=float).reshape(-1, 3).T
        named = np.array(["" if one is None else one.cause for one in estimates])
        return cls(name, low, best, high, {cause: named == cause for cause in set(named.tolist()) - {""}})

    @cached_property
    def _certain(self) -> bool:
        return not np.any(self.low < self.high)

    @cached_property
    def _lines(self) -> tuple[Array, Array]:
        return _lines(self.low, self.best, self.high)

    def at(self, draws: JointDraws, chosen: NDArray[np.intp]) -> Array:
        """Return the values of joint samples, of one of the objects each, (n,)."""
        if self._certain:
            return self.best[chosen]
        share = draws.share(self.name)
        for cause, mine in self.causes.items():
            share = np.where(mine[chosen], draws.share(cause), share)
        return self._at(share, chosen)

    def _at(self, share: Array, chosen: NDArray[np.intp]) -> Array:
        low, best, high = self.low[chosen], self.best[chosen], self.high[chosen]
        if self.name in SWITCHES:
            return switched(share, low, best, high)
        lower, upper = self._lines
        start, end, log = np.where(share < 0.5, lower[:, chosen], upper[:, chosen])
        drawn, scales = start + (end - start) * share, log > 0.0
        np.exp(drawn, out=drawn, where=scales)
        # Together these two are np.clip, whose checks took longer than it.
        inside: Array = np.minimum(np.maximum(drawn, low), high)
        return inside


def value_at(share: float, low: float, best: float, high: float) -> float:
    """Return the value below which a share of a distribution lies.

    Parameters
    ----------
    share : float
        From 0 to 1.
    low, best, high : float
        Ends and median; where the best estimate is an end, the whole range is one piece.

    Returns
    -------
    float
        Within the ends.
    """
    ends = (np.array([end]) for end in (low, best, high))
    lower, upper = _lines(*ends)
    start, end, log = (lower if share < 0.5 else upper)[:, 0].tolist()
    drawn = start + (end - start) * share
    return min(max(exp(drawn) if log else drawn, low), high)


def _lines(low: Array, best: Array, high: Array) -> tuple[Array, Array]:
    """Return the lines below and above the median, (3, m) each: at shares 0 and 1, and whether of logarithms."""
    certain = ~((low < high) & np.isfinite(low) & np.isfinite(high))
    log = (low > 0.0) & ~certain
    first, middle, last = (np.where(log, np.log(np.where(log, one, 1.0)), one) for one in (low, best, high))
    first, last = np.where(certain, middle, first), np.where(certain, middle, last)
    # A range on one side alone has no median: all of it is even.
    even = (best <= low) | (best >= high)
    lower = np.stack([first, np.where(even, last, 2.0 * middle - first), log])
    upper = np.stack([np.where(even, first, 2.0 * middle - last), last, log])
    return lower, upper


def switched(share: Array, low: Array, best: Array, high: Array) -> Array:
    """Return switches: each as is usual, but for `OTHERWISE` of the samples where it may be the other way."""
    other = np.where(best <= low, share >= 1.0 - OTHERWISE, share < OTHERWISE)
    return np.where((low < high) & other, np.where(best <= low, high, low), best)


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
