"""Lognormal fragility curves: the median and the dispersion of the shaking at which something fails."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from math import log, pi, sqrt

import numpy as np

from pipeline.quantities import Array
from pipeline.records.fragility import ABOVE, BELOW
from pipeline.tables import Range, table
from pipeline.tables.rows import RangeRow, Text, checked

LOG_ROOT = 0.5 * log(2.0 * pi)
"""Of the standard normal density: log f(z) = -z^2 / 2 - log sqrt(2 pi)."""

ENOUGH = 7
"""Motions from which on their own scatter is believed, as codes let a mean decide; with fewer, not below the stated."""

NINETY = 1.6448536269514722
"""Standard deviations on each side of the median within which 9 of 10 cases lie."""

ROUNDS, SETTLED = 500, 1e-10
"""Steps of the fit at most, and the change of the mean of ln at which it stops."""


@dataclass(frozen=True)
class Fit:
    """Medians and dispersions from record to record.

    Attributes
    ----------
    median : ndarray, shape (m,)
        In the unit of the capacities.
    dispersion : ndarray, shape (m,)
        Of ln, as measured [-]; NaN where fewer than two motions tell it.
    bound : sequence of str, (m,)
        "" where the median is known, else "above" or "below": it is only known to be that.
    """

    median: Array
    dispersion: Array
    bound: Sequence[str]


class Dispersion(RangeRow):
    """A row of dispersion.csv: standard deviation of ln [-]."""

    name: Text


@cache
def stated(name: str) -> Range:
    """Return a dispersion of tables/dispersion.csv.

    Parameters
    ----------
    name : str
        Of the row.

    Returns
    -------
    Range
        Standard deviation of ln [-].

    Raises
    ------
    KeyError
        For a name that the table does not have.
    """
    rows = checked(Dispersion, table("dispersion"), "dispersion.csv", named="name")
    return {row.name: row for row in rows}[name].range


def fit(capacity: Array, least: Array, most: Array) -> Fit:
    """Fit a lognormal to the intensities at which objects failed, motion by motion.

    A motion that was not scaled far enough still counts: maximum likelihood for censored samples, by the EM algorithm.
    With less than half of the motions telling where, and with fewer than two of several, the median is only bounded.

    Parameters
    ----------
    capacity : ndarray, shape (m, n)
        Of m objects under n motions, in m/s2 or any other unit; 0 where it failed at the least that was tried, infinite
        where at nothing.
    least, most : ndarray, shape (n,)
        Intensities between which each motion was scaled, in the same unit.

    Returns
    -------
    Fit
        Of each object.

    References
    ----------
    Baker, J. W. (2015). Efficient analytical fragility function fitting using dynamic structural analysis. Earthquake
    Spectra 31, 579-599 (truncated IDA).
    Dempster, A. P., Laird, N. M. and Rubin, D. B. (1977). Maximum likelihood from incomplete data via the EM algorithm.
    Journal of the Royal Statistical Society B 39, 1-38.
    """
    with np.errstate(divide="ignore"):
        logs = np.log(capacity)
    low, high = np.log(least), np.log(most)
    short, far = np.isneginf(logs), np.isposinf(logs)
    seen = ~(short | far)
    number = capacity.shape[1]
    count = seen.sum(axis=1)
    held = np.clip(logs, low, high)
    mean = held.mean(axis=1)
    known = (2 * count >= number) & (count >= min(2, number))
    deviation = np.full(mean.shape, np.nan)
    if number > 1 and known.any():
        whole = seen.all(axis=1) & known
        deviation[whole] = held[whole].std(axis=1)
        cut = known & ~whole
        if cut.any():
            mean[cut], deviation[cut] = _censored(held[cut], short[cut], far[cut])
        # The scatter of a sample is that much smaller than that of what it was drawn from.
        deviation *= sqrt(number / (number - 1))
    bounds = np.where(known, "", np.where(far.sum(axis=1) >= short.sum(axis=1), ABOVE, BELOW))
    return Fit(np.exp(mean), deviation, bounds.tolist())


def _censored(held: Array, short: Array, far: Array) -> tuple[Array, Array]:
    """Return mean and deviation (m,) of normal samples (m, n), some known only to be beyond where they stand."""
    from scipy.special import log_ndtr

    mean, deviation = held.mean(axis=1), np.maximum(held.std(axis=1), 1e-3)
    for _ in range(ROUNDS):
        z = (held - mean[:, None]) / deviation[:, None]
        # What is expected of a sample beyond z, and of its square, in standard deviations.
        density = -0.5 * z**2 - LOG_ROOT
        over, under = np.exp(density - log_ndtr(-z)), np.exp(density - log_ndtr(z))
        first = np.where(far, over, np.where(short, -under, z))
        second = np.where(far, 1.0 + z * over, np.where(short, 1.0 - z * under, z * z))
        shift = first.mean(axis=1)
        before = mean
        mean = mean + deviation * shift
        deviation = deviation * np.sqrt(np.maximum(second.mean(axis=1) - shift**2, 1e-12))
        if np.max(np.abs(mean - before)) < SETTLED:
            break
    return mean, deviation


def from_span(low: float | Array, high: float | Array) -> Array:
    """Return the dispersion of a quantity whose ln lies between two values in 9 of 10 cases.

    Parameters
    ----------
    low, high : float or ndarray
        The two values of ln [-].

    Returns
    -------
    ndarray
        Standard deviation of ln [-].
    """
    return np.asarray(np.abs(np.asarray(high) - np.asarray(low)) / (2.0 * NINETY))
