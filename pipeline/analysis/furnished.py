"""Shaking of what stands in furniture: the motions of a level as variants of the furniture pass them on.

Frequency and damping of furniture are ranges, and so is how level it stands.  A verdict has to hold for all that they
may be.  Every frequency of a fine grid would make each analysis thirty times dearer, and few of them miss peaks, which
at 3 % of damping are as narrow as 6 % of the frequency.  So a motion is passed on at each frequency of the grid, which
is cheap, and of these are kept some in even steps and those that do most to what stands there by four measures, each of
which governs another response; and that which does least.  docs/explanation/furniture.md says how much is missed.

Where furniture is not fastened, each of these is what shakes a body that may slide or rock: its mass is taken to move
as what stands in it, so that it slides where its own shaking exceeds its friction, and not only that of the floor.
"""

from collections.abc import Sequence
from functools import lru_cache, partial
from math import ceil

import numpy as np

from pipeline.analysis.furniture import FurnitureFilter, LooseBody
from pipeline.analysis.loose import passed_on
from pipeline.analysis.model_runs import prepare
from pipeline.analysis.transmission import transmit
from pipeline.analysis.verdicts import LevelMotions
from pipeline.models.oscillator import OSCILLATOR
from pipeline.models.sliding import SLIDING
from pipeline.quantities import Array, G
from pipeline.records import Excitation, Executor, Motion

PER_PERIOD = 15.0
"""Samples of what furniture passes on in a period of its own, at least."""

STEP = 1.06
"""Ratio of neighbouring frequencies of the grid at most: twice the lowest damping of furniture.csv."""

EVEN = 5
"""Frequencies in even steps of the grid, its ends among them, that are looked at whatever the measures say."""

MEASURES = 4
"""By how many measures others are chosen."""

SLIPPERY = (0.3, 0.7)
"""Frictions of the bodies that stand for what slides, as shares of what holds one under the motion of the floor."""


def furnished(level: LevelMotions, furniture: FurnitureFilter | None, executor: Executor | None = None) -> LevelMotions:
    """Return a level as what stands in some furniture feels it.

    Parameters
    ----------
    level : LevelMotions
        The motions of the floor; those of something that stands on it already come back as they are.
    furniture : FurnitureFilter or None
        None: nothing is between the object and its floor.
    executor : Executor, optional
        Where what it passes on is found; None: here.

    Returns
    -------
    LevelMotions
        Its motions are those by the best estimates, level; its others are, off level and least damped, those of some
        frequencies in even steps, of the largest acceleration, of the largest velocity, and of the farthest slips of
        two bodies, or else of the whole grid; then that of the least acceleration, and the floor's own.  Where it is
        not fastened, the first is passed on by its best estimates as a body and the others by what moves last; before
        the last two come two by what rocks first, and the last is that of what slides first.
    """
    if furniture is None or level.passed_on:
        return level
    return level.through(partial(_whole_grid if furniture.resonant else _variants, furniture=furniture), executor)


def isolating(level: LevelMotions, furniture: FurnitureFilter | None) -> LevelMotions:
    """Return a level as isolators in some furniture feel it, for what stands on them.

    What an isolator passes on is dear to find and to keep, so that of the variants there is one alone: that of the
    farthest slip of a body of little friction, which an isolator is.  Four kinds of isolators moved at most a seventh
    further under any other one, under three motions.  Their own movement is found under all of them (`furnished`).
    Of furniture that is not fastened that variant is of what moves last, and two of what rocks first come with it.

    Parameters
    ----------
    level, furniture
        As of `furnished`.

    Returns
    -------
    LevelMotions
        With that variant, or those, where the furniture shakes.
    """
    if furniture is None or level.passed_on:
        return level
    return level.through(partial(_for_isolators, furniture=furniture))


def _for_isolators(motion: Motion, *, furniture: FurnitureFilter) -> tuple[Motion, ...]:
    every = _variants(motion, furniture=furniture)
    if not furniture.frequency:
        return every[1:2]
    rocking = () if furniture.loose is None else every[EVEN + MEASURES + 1 : EVEN + MEASURES + 3]
    return every[EVEN + MEASURES - 1], *rocking


def best_furnished(motions: Sequence[Motion], furniture: FurnitureFilter | None) -> tuple[Motion, ...]:
    """Return motions of a floor as furniture passes them on by the best estimates."""
    return tuple(motions) if furniture is None else tuple(_variants(m, furniture=furniture)[0] for m in motions)


@lru_cache(maxsize=128)
def _variants(motion: Motion, *, furniture: FurnitureFilter) -> tuple[Motion, ...]:
    """Return what furniture passes on: by the best estimates, then at the ends of what is uncertain."""
    tilt = G * np.sin(furniture.level_error)
    if not furniture.frequency:
        return motion, _off_level(motion, motion, tilt), motion
    loose = furniture.loose
    usually, firm = (None, None) if loose is None else (loose.best, loose.firm)
    _, best, _ = furniture.frequency
    lively, usual, dull = furniture.damping
    grid = _grid(furniture)
    even = [round(at) for at in np.linspace(0, len(grid) - 1, EVEN)]
    sketches = [_off_level(_sketch(motion, frequency, lively), motion, tilt) for frequency in grid]
    measures = np.array([(_acceleration(one), _velocity(one), *_slips(one, motion)) for one in sketches])
    kept = (*even, *measures.argmax(axis=0).tolist())
    shaken = {at: _passed(motion, grid[at], lively) for at in dict.fromkeys(kept)}
    lively_at = {at: _off_level(_stood(one, firm), motion, tilt) for at, one in shaken.items()}
    # On what is far softer than the shaking is quick, an object may feel less than on the floor.
    weak = {frequency: _acceleration(_sketch(motion, frequency, dull)) for frequency in (grid[at] for at in even)}
    softest = min(weak, key=lambda frequency: weak[frequency])
    mildest = _passed(motion, softest, dull) if weak[softest] < _acceleration(motion) else motion
    # What pushes hardest is what makes it rock.
    hardest = shaken[kept[EVEN]]
    other = () if loose is None else tuple(passed_on(one, loose.tippy) for one in (hardest, motion))
    return (
        _stood(_passed(motion, best, usual), usually),
        *(lively_at[at] for at in kept),
        *other,
        _stood(mildest, firm),
        motion if loose is None else passed_on(motion, loose.slippery),
    )


def _stood(motion: Motion, body: LooseBody | None) -> Motion:
    return motion if body is None else passed_on(motion, body)


def _grid(furniture: FurnitureFilter) -> list[float]:
    low, _, high = furniture.frequency
    each: list[float] = np.geomspace(low, high, 1 + ceil(np.log(high / low) / np.log(STEP))).tolist()
    return each


@lru_cache(maxsize=16)
def _whole_grid(motion: Motion, *, furniture: FurnitureFilter) -> tuple[Motion, ...]:
    """Return what furniture passes on: by the best estimates, at every frequency of the grid, and other ends."""
    best, *others = _variants(motion, furniture=furniture)
    if not furniture.frequency:
        return best, *others
    tilt = G * np.sin(furniture.level_error)
    firm = None if furniture.loose is None else furniture.loose.firm
    each = (_stood(_passed(motion, frequency, furniture.damping[0]), firm) for frequency in _grid(furniture))
    return best, *(_off_level(one, motion, tilt) for one in each), *others[EVEN + MEASURES :]


def _passed(motion: Motion, frequency: float, damping: float) -> Motion:
    refine = max(1, ceil(motion.dt * frequency * PER_PERIOD - 1e-9))
    passed = transmit("plinth", motion, refine=refine, frequency=frequency, damping=damping)
    return passed.called(f"{motion.name}, in furniture of {frequency:.3g} Hz")


def _sketch(motion: Motion, frequency: float, damping: float) -> Motion:
    """Return the samples alone of what furniture passes on, to find the frequency by: a quarter of the work."""
    given = {"frequency": frequency, "damping": damping}
    x, y, z = motion.acceleration
    rows = [OSCILLATOR.trace(Excitation(motion.dt, way, None, z, 0.0), given)["a_x"] for way in (x, y)]  # type: ignore[misc]
    return Motion(motion.dt, [*rows, z])


def _acceleration(motion: Motion) -> float:
    # Not `largest_push`, which would remember sketches that nobody asks for again.
    return float(np.hypot(*motion.acceleration[:2]).max())


def _velocity(motion: Motion) -> float:
    if motion.v_max is not None:
        return motion.v_max
    a = motion.acceleration[:2]
    steps = np.cumsum(0.5 * motion.dt * (a[:, 1:] + a[:, :-1]), axis=1)
    return float(np.hypot(*(steps + np.array(motion.start[:2])[:, None])).max(initial=0.0))


def _slippery(floor: Motion) -> list[float]:
    return [share * _acceleration(floor) / G for share in SLIPPERY]


def _slips(motion: Motion, floor: Motion) -> Array:
    rows = SLIDING.run(motion.excitation(None), prepare(SLIDING, {"friction_static": _slippery(floor)}), 1, False)
    return rows["displacement"]


def _off_level(motion: Motion, floor: Motion, tilt: float) -> Motion:
    """Return the motion of what leans: downhill is where what slides on it while it is level comes to rest.

    Off level by an angle phi, a body feels g sin(phi) downhill, as if its base were accelerated uphill for ever; the
    share 1 - cos(phi) of its weight that it loses is below 0.4 % up to 5 degrees, and is left out.
    """
    if tilt == 0.0:
        return motion
    given = {"friction_static": _slippery(floor)[0], "friction_kinetic": np.nan, "directions": 2.0}
    path = SLIDING.trace(motion.excitation(None, 0.0), given)  # type: ignore[misc]
    x, y = (float(path[name][-1]) for name in ("u_x", "u_y"))
    size = float(np.hypot(x, y))
    # What rests all the while leans as well as it may.
    way = (1.0, 0.0) if size == 0.0 else (-x / size, -y / size)
    leaning = motion.acceleration.copy()
    leaning[:2] += tilt * np.array(way)[:, None]
    angle, uphill = np.degrees(np.arcsin(tilt / G)), np.degrees(np.arctan2(way[1], way[0]))
    step = f"off level by {angle:.2g} degrees, uphill to {uphill:.0f} degrees from x towards y"
    # Only the shaking has a velocity: the lean is no motion of the base.
    v_max = _velocity(motion) or None
    return Motion(motion.dt, leaning, motion.name, (*motion.steps, step), motion.source, motion.start, v_max)
