"""The choice of motions whose spectra have a target's mean, and its spread where it has one: greedy, then by swaps."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.quantities import Array

SPREAD_WEIGHT = 2.0
"""Of the misfit of the spread beside that of the mean (Baker and Lee 2018)."""

_STARTS = 10
_TRIALS = 20
_SWEEPS = 50


@dataclass(frozen=True, eq=False)
class Aim:
    """What the spectra of a suite shall be, at each period.

    Attributes
    ----------
    mean : array, shape (m,)
        Of the natural logarithm of the ordinates.
    sd : array, shape (m,), or None
        Its standard deviation; None where only the mean is to match.
    correlation : array, shape (m, m), or None
        Of the logarithms between the periods; None where only the mean is to match.
    fixed : int or None
        The period at which every motion is scaled to the mean; None scales over all periods.
    """

    mean: Array
    sd: Array | None = None
    correlation: Array | None = None
    fixed: int | None = None


@dataclass(frozen=True, eq=False)
class ChosenRows:
    """A choice of motions.

    Attributes
    ----------
    rows : tuple of int
        Which spectra, in ascending order.
    factors : tuple of float
        The scale of each.
    misfit : float
        What was made small: the sum over the periods of the squares of how far the mean of the logarithms is off, and
        of `SPREAD_WEIGHT` times the square of how far their standard deviation is off.
    rivals : tuple of (int, float) or None
        For each motion, which of the others would do best in its place, and the misfit then; None where there is none.
    """

    rows: tuple[int, ...]
    factors: tuple[float, ...]
    misfit: float
    rivals: tuple[tuple[int, float] | None, ...]


def correlation(periods: Array, conditioned_at: float | None = None) -> Array:
    """Return how the logarithms of spectral accelerations at different periods are correlated.

    Parameters
    ----------
    periods : array, shape (m,)
        In s, 0.01 to 10.
    conditioned_at : float or None
        The period [s] at which the acceleration is given; None where it is not.

    Returns
    -------
    array, shape (m, m)
        One on the diagonal.  At the period that it is conditioned on nothing is left to be correlated: zero.

    References
    ----------
    Baker, J. W. and Jayaram, N. (2008), Correlation of spectral acceleration values from NGA ground motion models,
    Earthquake Spectra 24(1).
    """
    rho = _baker_jayaram(periods[:, None], periods[None, :])
    if conditioned_at is None:
        return rho
    with_it = _baker_jayaram(periods, np.array(conditioned_at))
    left = np.sqrt(np.maximum(0.0, 1.0 - with_it**2))
    known = left > 1e-6
    scale = np.where(known, left, 1.0)
    given = (rho - np.outer(with_it, with_it)) / np.outer(scale, scale)
    given *= np.outer(known, known)
    given[np.diag_indices_from(given)] = 1.0
    return np.asarray(given, dtype=np.float64)


def _baker_jayaram(first: Array, second: Array) -> Array:
    short, long = np.minimum(first, second), np.maximum(first, second)
    c1 = 1.0 - np.cos(0.5 * np.pi - 0.366 * np.log(long / np.maximum(short, 0.109)))
    c2 = 1.0 - 0.105 * (1.0 - 1.0 / (1.0 + np.exp(100.0 * np.minimum(long, 0.2) - 5.0))) * (long - short) / (
        np.maximum(long - 0.0099, 1e-12)
    )
    c3 = np.where(long < 0.109, c2, c1)
    c4 = c1 + 0.5 * (np.sqrt(c3) - c3) * (1.0 + np.cos(np.pi * short / 0.109))
    at_medium = np.where(long < 0.2, np.minimum(c2, c4), c4)
    return np.asarray(np.where(long <= 0.109, c2, np.where(short > 0.109, c1, at_medium)), dtype=np.float64)


def choose(
    spectra: Array,
    aim: Aim,
    count: int,
    *,
    largest_scale: float,
    groups: Sequence[tuple[Sequence[object], int]] = (),
    seed: int = 0,
) -> ChosenRows:
    """Choose and scale motions whose spectra have together the mean and the spread that are wanted.

    Spectra are drawn from the target's distribution, the set of draws that shows it best is taken, and to each draw the
    motion that comes closest.  Then every motion is exchanged for whichever makes the misfit least, until no exchange
    makes it less.  That is done from several draws, and the best end is returned: the same for the same seed.

    Parameters
    ----------
    spectra : array, shape (n, m)
        Natural logarithm of the unscaled motions' ordinates, in the unit of the target.
    aim : Aim
        What is wanted.
    count : int
        Motions of the suite.
    largest_scale : float
        No motion is scaled by more than this, or by less than one over it.
    groups : sequence of (sequence, int)
        Labels of the motions, one each, and how many of one label a suite may have; a label of None counts for nothing.
    seed : int
        Of the draws.

    Returns
    -------
    ChosenRows
        Of fewer motions where the scale or the groups leave no more.

    References
    ----------
    Jayaram, N., Lin, T. and Baker, J. W. (2011), A computationally efficient ground-motion selection algorithm for
    matching a target response spectrum mean and variance, Earthquake Spectra 27(3).
    Baker, J. W. and Lee, C. (2018), An improved algorithm for selecting ground motions to match a conditional spectrum,
    Journal of Earthquake Engineering 22(4).
    """
    search = _SuiteSearch(spectra, aim, np.log(largest_scale), [_LabelLimit(labels, most) for labels, most in groups])
    numbers = np.random.default_rng(seed)
    ends = []
    for start in range(_STARTS):
        wanted = _drawn(aim, count, numbers)
        # Without a spread all draws are the mean: what differs from start to start is an order at random.
        by_chance = aim.sd is None and start > 0
        ends.append(search.run(wanted, numbers.random(len(spectra)) if by_chance else None))
    return max(ends, key=lambda end: (len(end.rows), -end.misfit))


def misfit(logs: Array, aim: Aim) -> float:
    """Return how far scaled spectra are from what is wanted, see `ChosenRows.misfit`.

    Parameters
    ----------
    logs : array, shape (k, m)
        Natural logarithm of the scaled ordinates.
    aim : Aim
        What is wanted.

    Returns
    -------
    float
    """
    off = float(((logs.mean(axis=0) - aim.mean) ** 2).sum())
    if aim.sd is None or len(logs) < 2:
        return off
    return off + SPREAD_WEIGHT * float(((logs.std(axis=0, ddof=1) - aim.sd) ** 2).sum())


def _drawn(aim: Aim, count: int, numbers: np.random.Generator) -> Array:
    """Of several sets of spectra drawn from the target's distribution, the one that shows it best, (count, m)."""
    if aim.sd is None or aim.correlation is None:
        return np.tile(aim.mean, (count, 1))
    values, vectors = np.linalg.eigh(aim.correlation)
    # The published correlations are not positive definite to the last digit.
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    sets = [aim.mean + aim.sd * (numbers.standard_normal((count, len(values))) @ root.T) for _ in range(_TRIALS)]
    return min(sets, key=lambda one: misfit(one, aim))


@dataclass(frozen=True, eq=False)
class _LabelLimit:
    labels: Sequence[object]
    most: int

    def full(self, rows: Sequence[int]) -> list[bool]:
        """Whether each motion is of a label of which there are enough already."""
        held = [self.labels[row] for row in rows]
        return [label is not None and held.count(label) >= self.most for label in self.labels]


@dataclass(frozen=True, eq=False)
class _SuiteSearch:
    spectra: Array
    aim: Aim
    bound: float
    groups: Sequence[_LabelLimit]

    def run(self, wanted: Array, order: Array | None) -> ChosenRows:
        """The choice that exchanges end in, from the closest motion to each draw, or from the first by an order."""
        rows: list[int] = []
        kept: list[int] = []
        for draw, one in enumerate(wanted):
            logs, allowed = self._scaled(one, rows)
            if not allowed.any():
                continue
            cost = ((logs - one) ** 2).sum(axis=1) if order is None else order
            rows.append(int(np.argmin(np.where(allowed, cost, np.inf))))
            kept.append(draw)
        wanted = wanted[kept]
        for _ in range(_SWEEPS if rows else 0):
            before = list(rows)
            wanted = wanted + self._level(rows, wanted)
            for place in range(len(rows)):
                costs = self._costs(rows, wanted, place)
                other = int(np.argmin(costs))
                # A tie changes nothing: else two equals would be exchanged for ever.
                if costs[other] < costs[rows[place]] - 1e-12:
                    rows[place] = other
            if rows == before:
                break
        return self._told(rows, wanted)

    def _scaled(self, draw: Array, taken: Sequence[int]) -> tuple[Array, Array]:
        """All spectra as they are scaled to a draw (n, m), and which may be taken beside those that are (n,)."""
        missing = draw - self.spectra if self.aim.fixed is None else (self.aim.mean - self.spectra)[:, [self.aim.fixed]]
        shift = missing.mean(axis=1)
        allowed = np.abs(shift) <= self.bound * (1.0 + 1e-12)
        allowed[list(taken)] = False
        for group in self.groups:
            allowed &= ~np.array(group.full(taken), dtype=bool)
        return self.spectra + shift[:, None], allowed

    def _costs(self, rows: Sequence[int], wanted: Array, place: int) -> Array:
        """The misfit of the suite with each motion in one place (n,); infinite where a motion may not stand there."""
        others = [row for at, row in enumerate(rows) if at != place]
        rest = np.array([self._one(row, wanted[at]) for at, row in enumerate(rows) if at != place])
        logs, allowed = self._scaled(wanted[place], others)
        k = len(rows)
        mean = (rest.sum(axis=0) + logs) / k if others else logs
        cost = ((mean - self.aim.mean) ** 2).sum(axis=1)
        if self.aim.sd is not None and k > 1:
            squares = (rest**2).sum(axis=0) + logs**2 - k * mean**2
            sd = np.sqrt(np.maximum(0.0, squares / (k - 1)))
            cost = cost + SPREAD_WEIGHT * ((sd - self.aim.sd) ** 2).sum(axis=1)
        return np.asarray(np.where(allowed, cost, np.inf), dtype=np.float64)

    def _level(self, rows: Sequence[int], wanted: Array) -> float:
        """By how much all draws go up for the suite to have the right level, as far as no scale becomes too large."""
        if self.aim.sd is None or self.aim.fixed is not None:
            return 0.0
        logs = np.array([self._one(row, draw) for row, draw in zip(rows, wanted, strict=True)])
        scales = (logs - self.spectra[rows])[:, 0]
        up = float((self.aim.mean - logs.mean(axis=0)).mean())
        return float(np.clip(up, -self.bound - scales.min(), self.bound - scales.max()))

    def _one(self, row: int, draw: Array) -> Array:
        line = self.spectra[row]
        missing = draw - line if self.aim.fixed is None else (self.aim.mean - line)[[self.aim.fixed]]
        return np.asarray(line + missing.mean(), dtype=np.float64)

    def _told(self, rows: Sequence[int], wanted: Array) -> ChosenRows:
        rivals: list[tuple[int, float] | None] = []
        for place, row in enumerate(rows):
            costs = self._costs(rows, wanted, place)
            costs[row] = np.inf
            other = int(np.argmin(costs)) if np.isfinite(costs).any() else None
            rivals.append(None if other is None else (other, float(costs[other])))
        logs = np.array([self._one(row, wanted[at]) for at, row in enumerate(rows)])
        factors = [float(np.exp((line - self.spectra[row])[0])) for line, row in zip(logs, rows, strict=True)]
        order = sorted(range(len(rows)), key=rows.__getitem__)
        return ChosenRows(
            rows=tuple(rows[i] for i in order),
            factors=tuple(factors[i] for i in order),
            misfit=misfit(logs, self.aim) if rows else float("inf"),
            rivals=tuple(rivals[i] for i in order),
        )
