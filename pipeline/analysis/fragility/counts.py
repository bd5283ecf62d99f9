r"""Lognormal fragility curves through counts: of so many trials at each intensity so many failed.

.. math::

    P(x) = \Phi\left(\frac{\ln x - \ln m}{\beta}\right)

Median and dispersion are those of maximum likelihood: a probit regression on ln x, by Fisher scoring.

References
----------
Baker, J. W. (2015). Efficient analytical fragility function fitting using dynamic structural analysis. Earthquake
Spectra 31(1), 579-599 (multiple stripe analysis).
McCullagh, P. and Nelder, J. A. (1989). Generalized linear models. 2nd ed. Chapman and Hall, ch. 2 and 4.
"""

from dataclasses import dataclass
from functools import cached_property, reduce

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.fragility.curve import LOG_ROOT
from pipeline.quantities import Array

FLATTEST = 2.0
"""The largest dispersion [-] that is looked for: of what hardly rises over all intensities there is no curve."""

ROUNDS, SETTLED, HALVINGS = 100, 1e-12, 12
"""Steps of the fit at most, the gain in likelihood at which it stops, and how often a step that loses is halved."""


@dataclass(frozen=True)
class CountFit:
    """Curves through counts.

    Attributes
    ----------
    median, dispersion : ndarray, shape (m,)
        In the unit of the intensities, and of ln [-]; NaN where nothing failed, or nothing stood.
    error, dispersion_error : ndarray, shape (m,)
        Standard errors of ln median and of the dispersion [-], by the information; that of a dispersion that is held at
        an end of what is allowed is NaN.
    likelihood : ndarray, shape (m,)
        ln of it, without the part that no curve changes.
    deviance : ndarray, shape (m,)
        Twice what is lost in ln likelihood against any probability at each intensity on its own [-].
    degrees : ndarray of int, shape (m,)
        Its degrees of freedom: intensities that were tried, less two.
    """

    median: Array
    dispersion: Array
    error: Array
    dispersion_error: Array
    likelihood: Array
    deviance: Array
    degrees: NDArray[np.intp]

    # Asked for by each object on its own.
    @cached_property
    def goodness(self) -> Array:
        """The probability of a deviance as large by chance where the curve is right, (m,); NaN without freedom."""
        from scipy.special import chdtrc

        free = self.degrees > 0
        return np.where(free, chdtrc(np.where(free, self.degrees, 1), self.deviance), np.nan)


def fit_counts(intensity: Array, taken: Array, failed: Array, least: float = 0.0, most: float = FLATTEST) -> CountFit:
    """Fit a curve to counts, for each of several objects.

    Parameters
    ----------
    intensity : ndarray, shape (n,)
        That were tried, in any unit.
    taken, failed : ndarray, shape (n, m)
        Trials of each object, and how many of these failed; not necessarily whole numbers.
    least, most : float
        Dispersions between which it is looked for [-].

    Returns
    -------
    CountFit
        Of each object.
    """
    middle = float(np.mean(np.log(intensity)))
    some = (failed > 0.0).any(axis=0) & (taken > failed).any(axis=0)
    x, n, k = _tried((np.log(intensity) - middle)[:, None], taken[:, some], failed[:, some])
    low, high = 1.0 / most, 1.0 / max(least, 1e-3)
    b = np.full(k.shape[1], np.clip(2.0, low, high))
    a = -b * (_sum(n * x) / _sum(n))
    logs = _logs(a + b * x)
    found = _log_likelihood(logs, n, k)
    # What is settled stays: nobody's digits hang on how long others take, and nobody waits for them.
    going = np.arange(a.size)
    for _ in range(ROUNDS):
        counts = x[:, going], n[:, going], k[:, going]
        next_a, next_b, next_logs, better = _stepped(
            a[going], b[going], *counts, logs[:, :, going], found[going], (low, high)
        )
        gain = better - found[going]
        kept = gain >= 0.0
        moved = going[kept]
        a[moved], b[moved], found[moved] = next_a[kept], next_b[kept], better[kept]
        logs[:, :, moved] = next_logs[:, :, kept]
        going = going[gain >= SETTLED]
        if going.size == 0:
            break
    error, dispersion_error = _errors(a, b, x, n, k, logs, (low, high))
    with np.errstate(divide="ignore", invalid="ignore"):
        whole = np.where(k > 0.0, k * np.log(k / n), 0.0) + np.where(k < n, (n - k) * np.log((n - k) / n), 0.0)

    def spread(values: Array, otherwise: float = np.nan) -> Array:
        out = np.full(some.shape, otherwise)
        out[some] = values
        return out

    return CountFit(
        spread(np.exp(middle - a / b)),
        spread(1.0 / b),
        spread(error),
        spread(dispersion_error),
        spread(found, 0.0),
        spread(np.maximum(2.0 * (_sum(np.where(n > 0.0, whole, 0.0)) - found), 0.0)),
        np.maximum((taken > 0.0).sum(axis=0) - 2, 0),
    )


def _sum(rows: Array) -> Array:
    """Return the sum of rows, one after the other: its digits do not hang on how many objects are fitted at once."""
    total: Array = reduce(np.add, rows)
    return total


def _tried(x: Array, taken: Array, failed: Array) -> tuple[Array, Array, Array]:
    """Return intensities, trials and failures of each object where it was tried, in their order, and then nothing.

    Objects are tried at a fourth of the intensities as a rule.
    """
    there = taken > 0.0
    rows = np.argsort(~there, axis=0, kind="stable")[: int(there.sum(axis=0).max(initial=1))]
    n, k = (np.take_along_axis(some, rows, axis=0).astype(float) for some in (taken, failed))
    return np.where(n > 0.0, np.take_along_axis(np.broadcast_to(x, taken.shape), rows, axis=0), 0.0), n, k


def _logs(z: Array) -> Array:
    """Return the logarithms of the probabilities to fail and to stand."""
    from scipy.special import log_ndtr

    return np.array([log_ndtr(z), log_ndtr(-z)])


def _log_likelihood(logs: Array, n: Array, k: Array) -> Array:
    return _sum(k * logs[0] + (n - k) * logs[1])


def _slopes(z: Array, n: Array, k: Array, logs: Array) -> tuple[Array, Array]:
    """Return the derivative of ln likelihood to each z, and the information about it."""
    density = -0.5 * z * z - LOG_ROOT
    failing, standing = np.exp(density - logs[0]), np.exp(density - logs[1])
    return k * failing - (n - k) * standing, n * failing * standing


def _stepped(
    a: Array, b: Array, x: Array, n: Array, k: Array, logs: Array, found: Array, ends: tuple[float, float]
) -> tuple[Array, Array, Array, Array]:
    """Return the curves a step further, halved where it loses, their logarithms and their ln likelihoods."""
    step_a, step_b = _step(a, b, x, n, k, logs, ends)
    size = np.ones(a.shape)
    next_a, next_b, next_logs, better = a.copy(), b.copy(), logs.copy(), found.copy()
    worse = np.arange(a.size)
    for _half in range(HALVINGS):
        next_a[worse] = a[worse] + size[worse] * step_a[worse]
        next_b[worse] = np.clip(b[worse] + size[worse] * step_b[worse], *ends)
        next_logs[:, :, worse] = _logs(next_a[worse] + next_b[worse] * x[:, worse])
        better[worse] = _log_likelihood(next_logs[:, :, worse], n[:, worse], k[:, worse])
        worse = worse[better[worse] < found[worse]]
        if worse.size == 0:
            break
        size[worse] *= 0.5
    return next_a, next_b, next_logs, better


def _step(
    a: Array, b: Array, x: Array, n: Array, k: Array, logs: Array, ends: tuple[float, float]
) -> tuple[Array, Array]:
    slope, weight = _slopes(a + b * x, n, k, logs)
    da, db = _sum(slope), _sum(slope * x)
    aa, ab, bb = (_sum(weight * x**power) for power in (0, 1, 2))
    whole = aa * bb - ab * ab
    told = whole > 1e-12 * aa * bb
    whole = np.where(told, whole, 1.0)
    step_b = np.where(told, (aa * db - ab * da) / whole, 0.0)
    # At an end of what is allowed only the median is looked for.
    step_b = np.where(((b <= ends[0]) & (step_b < 0.0)) | ((b >= ends[1]) & (step_b > 0.0)), 0.0, step_b)
    step_b = np.clip(b + step_b, *ends) - b
    step_a = (da - ab * step_b) / np.maximum(aa, 1e-300)
    return np.clip(step_a, -20.0, 20.0), step_b


def _errors(
    a: Array, b: Array, x: Array, n: Array, k: Array, logs: Array, ends: tuple[float, float]
) -> tuple[Array, Array]:
    weight = _slopes(a + b * x, n, k, logs)[1]
    aa, ab, bb = (_sum(weight * x**power) for power in (0, 1, 2))
    whole = aa * bb - ab * ab
    free = (b > ends[0]) & (b < ends[1]) & (whole > 1e-12 * aa * bb)
    whole = np.where(free, whole, 1.0)
    # Of ln median = -a / b: its gradient is (-1 / b, a / b^2).
    both = (bb - 2.0 * ab * (-a / b) + aa * (a / b) ** 2) / whole
    error = np.sqrt(np.where(free, both, 1.0 / np.maximum(aa, 1e-300))) / b
    return error, np.where(free, np.sqrt(aa / whole) / b**2, np.nan)
