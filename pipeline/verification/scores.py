"""Scores of probabilities against what happened: how often right, how far off, and as often as stated or not."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pipeline.quantities import Array

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
