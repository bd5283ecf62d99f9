"""Odds of overturning: a standing body under every motion of an experiment, over ranges of what is not known.

A body slides on its base and rocks about the edges of its contact polygon (model `standing`, in a plane).  Along a
direction its half widths are the distances from the projected centre of gravity to the edge before it and to the edge
behind it; its inertia is about the axis across.  On a table of one axis that direction is the table's.  On one of
several, a body overturns where it does so along any of the directions every `SPREAD` degrees; vertical motion counts in
each.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.model_runs import prepare
from pipeline.errors import InputError
from pipeline.execute import Threads
from pipeline.meshes import scan_object
from pipeline.meshes.reading import holds_triangles
from pipeline.models import model_named
from pipeline.quantities import Array
from pipeline.records import ContactPolygon, Motion, Progress
from pipeline.tables import Range, table
from pipeline.tables.assumed import assumed, span
from pipeline.tables.rows import Number, checked
from pipeline.verification.experiment import EXPERIMENT, BodyTable, Experiment, ExperimentError

SPREAD = 30
"""Degrees between the directions that are tried where a table has several axes."""

DRAWS = 256
"""Draws of what is not known of a body that nothing is fitted for; a power of two, as a Sobol sequence asks."""

FIT_DRAWS = 2048
"""Draws of both half widths, restitution and friction, from which the odds at what could be fitted are weighed; half as
many move the accuracy on 268 runs by up to 0.006."""

WIDER, CENTRES = (0.25, 6.0), (1.0 / 3.0, 4.5)
"""Half widths that are drawn, and those among which one is fitted, as multiples of the least that the shape gives."""

WIDTHS = 31
"""How many half widths are tried."""

RESTITUTIONS = np.arange(0.6, 1.01, 0.1)
"""Factors on the restitution of theory among which one is fitted."""

TAIL = 10.0
"""Seconds after a run's record in which a body may still overturn; to wait until it rests would take twice the time."""

TOLD_EVERY = 20
"""Runs after which it is told how far the work is."""

TABLE = "validation"


@dataclass(frozen=True, slots=True)
class Prior:
    """What is assumed of a number that nobody measured: a row of the table of priors.

    Attributes
    ----------
    quantity : str
        Which number.
    distribution : str
        "lognormal" (median, standard deviation of the logarithm), "normal" (mean, standard deviation) or "uniform".
    first, second : float
        Its two parameters.
    source : str
        Who says so.
    """

    quantity: str
    distribution: Literal["lognormal", "normal", "uniform"]
    first: Number
    second: Number
    source: str

    def at(self, share: Array) -> Array:
        """Return the values below which these shares of it lie."""
        from scipy.special import ndtri

        if self.distribution == "uniform":
            return self.first + (self.second - self.first) * share
        if self.distribution == "normal":
            return self.first + self.second * np.asarray(ndtri(share), float)
        return self.first * np.exp(self.second * np.asarray(ndtri(share), float))

    def density(self, value: Array) -> Array:
        """Return how likely values are, up to a factor; of a lognormal, in the logarithm."""
        off = value - self.first if self.distribution == "normal" else np.log(value / self.first)
        return np.asarray(np.exp(-0.5 * (off / self.second) ** 2), float)


@cache
def priors() -> dict[str, Prior]:
    """Return the table of priors, by quantity."""
    rows = checked(Prior, table(TABLE), f"{TABLE}.csv", named="quantity")
    return {row.quantity: row for row in rows}


@dataclass(frozen=True, eq=False)
class Shape:
    """A body as the models know it.

    Attributes
    ----------
    reach : ndarray, shape (360,)
        Half width in each direction, degrees from the body's x axis towards y, m.
    cg_height : float
        Of the centre of gravity above the base, m.
    gyration : (float, float)
        Radii of gyration about the horizontal axes through the centre of gravity, m.
    friction : Range
        Between it and the table [-].
    notes : tuple of str
        What is doubtful of it.
    """

    reach: Array
    cg_height: float
    gyration: tuple[float, float]
    friction: Range
    notes: tuple[str, ...]

    def across(self, angle: NDArray[np.int64]) -> Array:
        """Return the radius of gyration about the horizontal axis across a direction, m; products are left out."""
        turn = np.radians(angle)
        return np.hypot(self.gyration[0] * np.sin(turn), self.gyration[1] * np.cos(turn))

    def frictions(self, share: Array) -> Array:
        """Return the frictions below which these shares of it are taken to lie.

        Half lies on either side of the best estimate, evenly in the logarithm.
        """
        ends = np.log([self.friction.low, self.friction.value, self.friction.high])
        return np.exp(np.interp(share, [0.0, 0.5, 1.0], ends))


def friction_of(body: BodyTable) -> Range:
    """Return the friction of a body: what is stated, or what the table of frictions says of what stands on what."""
    if body.friction is not None:
        return Range(body.friction, body.friction, body.friction, "stated")
    said = body.surface or ""
    what, on = said.split(" on ", 1) if " on " in said else ("", said)
    values = assumed()
    material = values.material_in(what)
    found = span(values.friction_of("" if material is None else material.friction_as, on))
    return replace(found, source=f"{found.source}; for {said or 'any pair'}")


def shape_of(experiment: Experiment, body: BodyTable) -> Shape:
    """Return a body's shape: of its mesh the facet that it rests on, of a block its base.

    Parameters
    ----------
    experiment : Experiment
        Where its mesh lies.
    body : BodyTable
        What is said of it.

    Returns
    -------
    Shape
        Its inertia is that of one density.

    Raises
    ------
    ExperimentError
        For a mesh that is missing or not closed, naming file and field.
    """
    if body.mesh is not None:
        return _scanned(experiment.folder, body.mesh, body)
    width, depth, height = (float(size) for size in body.sizes if size is not None)
    x, y = 0.5 * width, 0.5 * depth
    polygon = ContactPolygon(((x, y), (-x, y), (-x, -y), (x, -y)))
    gyration = (np.hypot(depth, height) / np.sqrt(12.0), np.hypot(width, height) / np.sqrt(12.0))
    return Shape(_reach(polygon), 0.5 * height, (float(gyration[0]), float(gyration[1])), friction_of(body), ())


def _scanned(folder: Path, mesh: str, body: BodyTable) -> Shape:
    where = f"body {body.name!r}: mesh"
    try:
        # A cloud of points has no surface that could be open: only its hull can stand for it.
        cloud = not holds_triangles(folder / mesh)
        found = scan_object(folder / mesh, hull=body.hull or cloud)
    except InputError as problem:
        said = str(problem).replace("--hull takes", "hull = true in its table takes")
        raise ExperimentError(f"{folder / EXPERIMENT}: {where}: {said}") from problem
    facet = found.contacts[0].polygon
    if facet is None:
        raise ExperimentError(
            f"{folder / EXPERIMENT}: {where}: {mesh}: it rests on no facet; level the mesh as the body stood"
        )
    return Shape(_reach(facet), found.cg_height, found.gyration[:2], friction_of(body), found.notes)


def _reach(polygon: ContactPolygon) -> Array:
    return np.array([polygon.reach(float(angle)) for angle in range(360)])


def drawn_odds(experiment: Experiment, shape: Shape, progress: Progress, name: str) -> Array:
    """Return the probability that a body overturns in each run, from its shape alone.

    Parameters
    ----------
    experiment : Experiment
        Its motions and direction.
    shape : Shape
        The body's.
    progress : callable
        Is told what is done.
    name : str
        Of the body.

    Returns
    -------
    ndarray, shape (runs,)
        The share of `DRAWS` of a Sobol sequence of direction, half width, restitution and friction that overturn.
    """
    share = _sobol(7, DRAWS)
    known = priors()
    direction = experiment.said.direction
    turned = 360.0 * share[:, 0] if direction == "unknown" else np.full(DRAWS, float(direction))
    factor = known["half_width_factor"].at(share[:, 1])
    before, behind = (factor * known["scatter_half_width"].at(share[:, at]) for at in (2, 3))
    restitution = known["restitution_factor"].at(share[:, 4]) + known["scatter_restitution"].at(share[:, 5])
    friction = shape.frictions(share[:, 6])

    def parameters(azimuth: int) -> dict[str, Array]:
        angle = np.rint(azimuth - turned).astype(np.int64) % 360
        sides = shape.reach[angle] * before, shape.reach[(angle + 180) % 360] * behind
        return _block(sides, shape, restitution, friction, angle)

    overturned = _overturned(experiment, parameters, progress, f"{name}, unfitted")
    return np.asarray(overturned.mean(axis=1), float)


def _sobol(numbers: int, draws: int) -> Array:
    """Return shares of distributions, shape (draws, numbers), that need no seed, and none of which is 0 or 1."""
    from scipy.stats import qmc

    return np.asarray(qmc.Sobol(numbers, scramble=False).random(draws) + 0.5 / draws, float)


@dataclass(frozen=True, eq=False)
class FitGrid:
    """Odds of overturning over the two numbers that are fitted.

    Attributes
    ----------
    half_width : ndarray, shape (w,)
        To either side in every direction, m.
    restitution : ndarray, shape (e,)
        Factors on that of theory.
    odds : ndarray, shape (runs, w, e)
        With the scatter from run to run.
    """

    half_width: Array
    restitution: Array
    odds: Array


def fit_grid(experiment: Experiment, shape: Shape, progress: Progress, name: str) -> FitGrid:
    """Return the odds of overturning in each run at every half width and restitution that could be fitted.

    Parameters
    ----------
    experiment, shape, progress, name
        As in `drawn_odds`; of the shape only height, inertia and friction are used.

    Returns
    -------
    FitGrid
        Of draws that are weighed by the scatter of the table of priors about each pair: from run to run the two half
        widths differ from each other and from those of the last run.
    """
    share, least = _sobol(4, FIT_DRAWS), float(shape.reach.min())
    low, high = WIDER
    before, behind = (least * low * (high / low) ** share[:, at] for at in (0, 1))
    restitution = RESTITUTIONS[0] + (RESTITUTIONS[-1] - RESTITUTIONS[0]) * share[:, 2]
    # Of no direction in particular: the mean of the inertia about its two axes.
    mean = float(np.sqrt(0.5 * (shape.gyration[0] ** 2 + shape.gyration[1] ** 2)))
    round_one = replace(shape, gyration=(mean, mean))
    friction = shape.frictions(share[:, 3])

    def parameters(azimuth: int) -> dict[str, Array]:
        return _block((before, behind), round_one, restitution, friction, np.full(FIT_DRAWS, azimuth % 360))

    fell = _overturned(experiment, parameters, progress, f"{name}, fitted").astype(float)
    widths = least * np.geomspace(*CENTRES, WIDTHS)
    known = priors()
    by_width = known["scatter_half_width"].density(before / widths[:, None])
    by_width *= known["scatter_half_width"].density(behind / widths[:, None])
    by_restitution = known["scatter_restitution"].density(restitution - RESTITUTIONS[:, None])
    weights = by_width[:, None] * by_restitution
    weights /= weights.sum(axis=-1, keepdims=True)
    return FitGrid(widths, RESTITUTIONS, np.einsum("wen,rn->rwe", weights, fell))


def _block(
    sides: tuple[Array, Array], shape: Shape, factor: Array, friction: Array, angle: NDArray[np.int64]
) -> dict[str, Array]:
    given = {
        "half_width": sides[0],
        "half_width_other": sides[1],
        "cg_height": np.full(factor.size, shape.cg_height),
        "gyration_radius": shape.across(angle),
        "friction_static": friction,
        "restitution_factor": factor,
    }
    return prepare(model_named("standing"), given)


def _overturned(
    experiment: Experiment, parameters: Callable[[int], dict[str, Array]], progress: Progress, what: str
) -> NDArray[np.bool_]:
    """Return whether each parameter set overturns in each run, shape (runs, n)."""
    azimuths = (0,) if experiment.said.axes == 1 else range(0, 180, SPREAD)
    sets = [(azimuth, parameters(azimuth)) for azimuth in azimuths]

    def run(motion: Motion) -> NDArray[np.bool_]:
        fell = [_run(motion, azimuth, values) for azimuth, values in sets]
        return np.asarray(np.any(fell, axis=0), np.bool_)

    threads, out = Threads(), list[NDArray[np.bool_]]()
    progress.step(what, 0, len(experiment.motions))
    for start in range(0, len(experiment.motions), TOLD_EVERY):
        out += threads.map(run, experiment.motions[start : start + TOLD_EVERY])
        progress.step(what, len(out), len(experiment.motions))
    return np.array(out, bool)


def _run(motion: Motion, azimuth: int, values: dict[str, Array]) -> NDArray[np.bool_]:
    # At the coarsest step: the odds are over a thousand outcomes, of which it changes fewer than the draws do.
    found = model_named("standing").run(motion.excitation(float(azimuth), TAIL), values, 1, False)
    fell: NDArray[np.bool_] = found["overturned"] > 0.0
    return fell
