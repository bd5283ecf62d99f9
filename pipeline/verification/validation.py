"""Validation against an experiment: what the models say of bodies that really fell or stood.

Two predictions: with no number fitted, from the bodies' shapes and the table of priors; and with two, half width and a
factor on the restitution, fitted on other motions.  Beside them what costs nothing: "it always stands", and a threshold
of the peak velocity, chosen on the same motions as the fit.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from pipeline.quantities import Array
from pipeline.records import Progress
from pipeline.verification.experiment import EXPERIMENT, Experiment, ExperimentError, read_experiment
from pipeline.verification.odds import FitGrid, Shape, drawn_odds, fit_grid, shape_of

BINS = 5
"""Bins of a reliability diagram; more would hold a handful of runs each."""

LEVEL = 0.9
"""Probability of the outcomes that a prediction names: one where that is enough, else both."""


@dataclass(frozen=True, slots=True)
class ReliabilityBin:
    """Runs of about one stated probability.

    Attributes
    ----------
    runs : int
        How many.
    stated, observed : float
        Mean probability of overturning that was stated, and the share that did.
    """

    runs: int
    stated: float
    observed: float


@dataclass(frozen=True, slots=True)
class Score:
    """How good a prediction was.

    Attributes
    ----------
    accuracy : float
        Share of the runs whose likelier outcome happened; a probability of one half says that the body stands.
    brier : float
        Mean square of probability minus outcome (Brier 1950): 0 is perfect, 0.25 is a coin.
    coverage : float
        Share of the runs whose outcome was among those that were named to `LEVEL`.
    stated : float
        Mean probability of the outcomes that were named: what `coverage` should be.
    fell_as_said, fell_unsaid, stood_as_said, stood_unsaid : int
        The confusion: how many runs fell or stood, as was said or otherwise.
    bins : tuple of ReliabilityBin
        Those that hold a run, from the least probability to the largest.

    References
    ----------
    Brier, G. W. (1950). Verification of forecasts expressed in terms of probability. Monthly Weather Review 78.
    """

    accuracy: float
    brier: float
    coverage: float
    stated: float
    fell_as_said: int
    fell_unsaid: int
    stood_as_said: int
    stood_unsaid: int
    bins: tuple[ReliabilityBin, ...]


def score(probability: Array, fell: NDArray[np.bool_]) -> Score:
    """Score a prediction.

    Parameters
    ----------
    probability : ndarray, shape (runs,)
        Of overturning, 0 to 1.
    fell : ndarray of bool, shape (runs,)
        Whether it did.

    Returns
    -------
    Score
        Over all runs alike.
    """
    says = probability > 0.5
    sure = np.maximum(probability, 1.0 - probability) >= LEVEL
    right = says == fell
    which = np.minimum((probability * BINS).astype(np.int64), BINS - 1)
    bins = [(which == at) for at in range(BINS)]
    return Score(
        accuracy=float(right.mean()),
        brier=float(np.mean((probability - fell) ** 2)),
        coverage=float((right | ~sure).mean()),
        stated=float(np.where(sure, np.maximum(probability, 1.0 - probability), 1.0).mean()),
        fell_as_said=int((fell & says).sum()),
        fell_unsaid=int((fell & ~says).sum()),
        stood_as_said=int((~fell & ~says).sum()),
        stood_unsaid=int((~fell & says).sum()),
        bins=tuple(
            ReliabilityBin(int(one.sum()), float(probability[one].mean()), float(fell[one].mean()))
            for one in bins
            if one.any()
        ),
    )


LAPSE = 0.03
"""Share of the runs whose outcome may be of no account (a body was knocked, a wrong outcome noted); judgement."""


@dataclass(frozen=True, slots=True)
class Fitted:
    """The two numbers that were fitted.

    Attributes
    ----------
    half_width : float
        m, to either side.
    restitution : float
        As a factor on that of theory.
    """

    half_width: float
    restitution: float


@dataclass(frozen=True, slots=True)
class BodyValidation:
    """A body, and how often what is said of it is right.

    Attributes
    ----------
    name : str
        The body.
    notes : tuple of str
        What is doubtful of its shape.
    standing, threshold, fitted, unfitted : Score
        "It always stands"; the threshold of the peak velocity; two numbers fitted; none fitted.
    parameters : Fitted
        Those fitted on all runs of the experiment, or of the other one.
    others : dict of str to Score
        Predictions by others, over the runs of which they say something.
    """

    name: str
    notes: tuple[str, ...]
    standing: Score
    threshold: Score
    fitted: Score
    unfitted: Score
    parameters: Fitted
    others: dict[str, Score]


@dataclass(frozen=True, eq=False)
class Validation:
    """An experiment held against the models.

    Attributes
    ----------
    experiment : Experiment
        What was read.
    trained_on : str
        Where the numbers were fitted, in words.
    bodies : tuple of BodyValidation
        In its order.
    """

    experiment: Experiment
    trained_on: str
    bodies: tuple[BodyValidation, ...]


def validate(folder: Path, progress: Progress, *, fit_on: Path | None = None) -> Validation:
    """Hold the models against an experiment.

    Parameters
    ----------
    folder : Path
        The experiment's.
    progress : callable
        Is told what is done, of how much.
    fit_on : Path, optional
        Folder of another experiment with the same bodies, on which alone the numbers are fitted; None: on the runs of
        all motions but that of the run in question.

    Returns
    -------
    Validation
        Body by body.

    Raises
    ------
    ExperimentError
        For an experiment that cannot be used, one with runs of a single motion, and another one without the body.
    """
    here = read_experiment(folder)
    there = here if fit_on is None else read_experiment(fit_on)
    if fit_on is None and len(set(here.folds)) < 2:
        raise ExperimentError(
            f"{folder / here.said.runs}: column {here.said.fold_column!r}: all runs are of one motion, so "
            "that there is no other to fit on; add runs of another, or name another experiment by --fit-on"
        )
    if missing := [name for name in here.names if name not in there.names]:
        raise ExperimentError(
            f"{there.folder / EXPERIMENT}: body: there is no body {missing[0]!r} to fit; name another experiment"
        )
    trained = (
        f"the other motions of this experiment, {len(set(here.folds))} folds"
        if fit_on is None
        else f"another experiment alone: {there.said.title}, {len(there.runs)} runs"
    )
    # All meshes are read before the first run: a fault of the last one is told at once.
    shapes = [shape_of(here, body) for body in here.said.body]
    others = {body.name: shape_of(there, body) for body in there.said.body if there is not here}
    found = tuple(
        _body(at, here, there, shape, others.get(here.names[at], shape), progress) for at, shape in enumerate(shapes)
    )
    return Validation(here, trained, found)


def _body(
    at: int, here: Experiment, there: Experiment, shape: Shape, trained_shape: Shape, progress: Progress
) -> BodyValidation:
    name, fell = here.names[at], here.fell[at]
    unfitted = drawn_odds(here, shape, progress, name)
    grid = fit_grid(here, shape, progress, name)
    speed = here.peak_velocities
    if there is here:
        trained, trained_fell, trained_speed = grid, fell, speed
    else:
        other = there.names.index(name)
        trained = fit_grid(there, trained_shape, progress, f"{name} of the other")
        trained_fell, trained_speed = there.fell[other], there.peak_velocities
    fitted, by_speed = np.empty(fell.size), np.empty(fell.size)
    for tested, used in folds(here, there):
        weights = fit(trained.odds[used], trained_fell[used])
        fitted[tested] = np.einsum("rwe,we->r", grid.odds[tested], weights)
        by_speed[tested] = speed[tested] > threshold(trained_speed[used], trained_fell[used])
    return BodyValidation(
        name=name,
        notes=shape.notes,
        standing=score(np.zeros(fell.size), fell),
        threshold=score(by_speed, fell),
        fitted=score(fitted, fell),
        unfitted=score(unfitted, fell),
        parameters=_parameters(trained, fit(trained.odds, trained_fell)),
        others={
            other: score(said[at][known], fell[known])
            for other, said in here.predicted.items()
            if (known := np.isfinite(said[at])).any()
        },
    )


def folds(here: Experiment, there: Experiment) -> Iterator[tuple[NDArray[np.bool_], NDArray[np.bool_]]]:
    """Yield which runs are tested, and which runs of the training experiment they are tested by.

    Parameters
    ----------
    here, there : Experiment
        Tested and trained on; the same one makes a fold of each motion.

    Yields
    ------
    tuple of ndarray of bool
        Shapes (runs,) and (training runs,): no motion is in both where both are of one experiment.
    """
    if there is not here:
        yield np.ones(len(here.runs), bool), np.ones(len(there.runs), bool)
        return
    motions = np.array(here.folds)
    for motion in dict.fromkeys(here.folds):
        yield motions == motion, motions != motion


def fit(odds: Array, fell: NDArray[np.bool_]) -> Array:
    """Return how likely each pair of half width and restitution is, all of the grid being alike beforehand.

    Parameters
    ----------
    odds : ndarray, shape (runs, w, e)
        Of overturning.
    fell : ndarray of bool, shape (runs,)
        Whether it did.

    Returns
    -------
    ndarray, shape (w, e)
        Sums to 1.
    """
    honest = LAPSE + (1.0 - 2.0 * LAPSE) * odds
    likelihood = np.log(np.where(fell[:, None, None], honest, 1.0 - honest)).sum(axis=0)
    weights = np.exp(likelihood - likelihood.max())
    return np.asarray(weights / weights.sum(), float)


def _parameters(grid: FitGrid, weights: Array) -> Fitted:
    return Fitted(
        half_width=float(np.exp((weights.sum(axis=1) * np.log(grid.half_width)).sum())),
        restitution=float((weights.sum(axis=0) * grid.restitution).sum()),
    )


def threshold(speed: Array, fell: NDArray[np.bool_]) -> float:
    """Return the speed above which "it falls" is right most often; of several such the middle one.

    Parameters
    ----------
    speed : ndarray, shape (runs,)
        m/s.
    fell : ndarray of bool, shape (runs,)
        Whether it overturned.

    Returns
    -------
    float
        m/s; between two speeds, or beyond all.
    """
    order = np.unique(speed)
    between = np.concatenate([[0.5 * order[0]], 0.5 * (order[1:] + order[:-1]), [2.0 * order[-1]]])
    right = ((speed > between[:, None]) == fell).sum(axis=1)
    best = between[right == right.max()]
    return float(best[best.size // 2])
