"""The choice of a suite: against every subset of a small pool, and against distributions that are known."""

from __future__ import annotations

from itertools import combinations
from math import cos, exp, log, pi, sqrt

import numpy as np
import pytest

from pipeline.motions.selection import SPREAD_WEIGHT, Aim, choose, correlation, misfit

PERIODS = np.geomspace(0.1, 2.0, 20)


def published(first: float, second: float) -> float:
    """The correlation as Baker and Jayaram (2008) print it, case by case, for one pair of periods."""
    short, long = min(first, second), max(first, second)
    c1 = 1.0 - cos(pi / 2.0 - log(long / max(short, 0.109)) * 0.366)
    c2 = 0.0
    if long < 0.2:
        c2 = 1.0 - 0.105 * (1.0 - 1.0 / (1.0 + exp(100.0 * long - 5.0))) * (long - short) / (long - 0.0099)
    c3 = c2 if long < 0.109 else c1
    c4 = c1 + 0.5 * (sqrt(c3) - c3) * (1.0 + cos(pi * short / 0.109))
    if long <= 0.109:
        return c2
    if short > 0.109:
        return c1
    return min(c2, c4) if long < 0.2 else c4


def drawn(number: int, seed: int, sd: float = 0.5) -> np.ndarray:
    """Logarithms of spectra whose periods are correlated as those of earthquakes are."""
    root = np.linalg.cholesky(correlation(PERIODS) + 1e-9 * np.eye(PERIODS.size))
    return sd * np.random.default_rng(seed).standard_normal((number, PERIODS.size)) @ root.T


def test_the_correlation_is_the_published_one_in_all_its_cases() -> None:
    periods = np.array([0.01, 0.05, 0.1, 0.109, 0.11, 0.15, 0.19, 0.2, 0.21, 0.5, 1.0, 3.0, 10.0])
    found = correlation(periods)
    wanted = [[published(a, b) for b in periods] for a in periods]
    np.testing.assert_allclose(found, wanted, atol=1e-12)
    np.testing.assert_array_equal(found, found.T)


def test_a_conditional_correlation_is_that_of_a_conditional_normal_distribution() -> None:
    """Against the Schur complement: what is left of the covariance once one component is known."""
    given = correlation(PERIODS, 0.6)
    whole = correlation(np.append(PERIODS, 0.6))
    left = whole[:-1, :-1] - np.outer(whole[:-1, -1], whole[-1, :-1])
    size = np.sqrt(np.diag(left))
    np.testing.assert_allclose(given, left / np.outer(size, size), atol=1e-9)
    at = float(PERIODS[7])
    row = correlation(PERIODS, at)[7]
    np.testing.assert_array_equal(row, np.eye(PERIODS.size)[7])


@pytest.mark.parametrize("seed", range(6))
def test_of_a_small_pool_the_best_of_all_subsets_is_chosen(seed: int) -> None:
    pool = drawn(12, seed)
    found = choose(pool, Aim(np.zeros(PERIODS.size)), 4, largest_scale=10.0, seed=seed)
    # Scaled to the mean over the periods, each spectrum leaves what differs from it.
    left = pool - pool.mean(axis=1, keepdims=True)
    every = {rows: float((left[list(rows)].mean(axis=0) ** 2).sum()) for rows in combinations(range(12), 4)}
    best = min(every, key=every.__getitem__)
    assert found.rows == best
    assert found.misfit == pytest.approx(every[best], rel=1e-9)
    np.testing.assert_allclose(np.log(found.factors), -pool[list(best)].mean(axis=1), atol=1e-12)
    for row, rival in zip(found.rows, found.rivals, strict=True):
        others = {o: every[tuple(sorted({*best, o} - {row}))] for o in set(range(12)) - set(best)}
        assert rival is not None
        assert rival[1] == pytest.approx(min(others.values()), rel=1e-9)


def test_a_spread_is_matched_where_chance_would_not() -> None:
    pool = drawn(150, 1, sd=0.8) + log(0.3)
    mean, sd = np.full(PERIODS.size, log(0.4)), np.full(PERIODS.size, 0.5)
    aim = Aim(mean, sd, correlation(PERIODS))
    found = choose(pool, aim, 11, largest_scale=4.0, seed=3)
    scaled = pool[list(found.rows)] + np.log(found.factors)[:, None]
    # The 84th percentile over the median within 10 %, as the mean: what `choosing` accepts.
    assert np.abs(scaled.mean(axis=0) - mean).max() < log(1.1)
    assert np.abs(scaled.std(axis=0, ddof=1) - sd).max() < log(1.1)
    by_hand = sum(
        (np.mean(one) - m) ** 2 + SPREAD_WEIGHT * (sqrt(sum((v - np.mean(one)) ** 2 for v in one) / 10) - s) ** 2
        for one, m, s in zip(scaled.T, mean, sd, strict=True)
    )
    assert found.misfit == pytest.approx(by_hand, rel=1e-9)
    # Samples of the very distribution that is wanted, 11 at a time: none of a thousand does as well.
    numbers = np.random.default_rng(9)
    root = np.linalg.cholesky(correlation(PERIODS) + 1e-9 * np.eye(PERIODS.size))
    by_chance = (mean + 0.5 * numbers.standard_normal((11, PERIODS.size)) @ root.T for _ in range(1000))
    assert found.misfit < min(misfit(one, aim) for one in by_chance)


def test_a_conditional_target_is_met_exactly_at_its_period() -> None:
    sd = 0.6 * np.sqrt(1.0 - np.array([published(0.5, t) for t in PERIODS]) ** 2)
    at = int(np.argmin(np.abs(PERIODS - 0.5)))
    sd[at] = 0.0
    aim = Aim(np.full(PERIODS.size, -1.0), sd, correlation(PERIODS, float(PERIODS[at])), at)
    pool = drawn(100, 5, sd=0.6) - 1.0
    found = choose(pool, aim, 11, largest_scale=4.0)
    scaled = pool[list(found.rows)] + np.log(found.factors)[:, None]
    np.testing.assert_allclose(scaled[:, at], -1.0, atol=1e-12)
    assert np.abs(scaled.mean(axis=0) + 1.0).max() < log(1.1)
    assert np.abs(scaled.std(axis=0, ddof=1) - sd).max() < log(1.1)
    # The best in the place of the first, by trying each that may be scaled so.
    others = [row for row in range(100) if row not in found.rows and abs(-1.0 - pool[row, at]) <= log(4.0)]
    tried = [misfit(np.vstack([scaled[1:], pool[row] - pool[row, at] - 1.0]), aim) for row in others]
    assert found.rivals[0] is not None
    assert found.rivals[0] == (others[int(np.argmin(tried))], pytest.approx(min(tried), rel=1e-9))


def test_the_limits_hold_and_the_seed_decides() -> None:
    pool = drawn(60, 2, sd=0.7)
    aim = Aim(np.full(PERIODS.size, 0.2), np.full(PERIODS.size, 0.5), correlation(PERIODS))
    events = [i // 10 for i in range(59)] + [None]
    found = choose(pool, aim, 11, largest_scale=1.5, groups=[(events, 2)], seed=7)
    assert all(1.0 / 1.5 - 1e-9 <= factor <= 1.5 + 1e-9 for factor in found.factors)
    taken = [events[row] for row in found.rows]
    assert max(taken.count(event) for event in set(taken)) == 2
    assert len(set(found.rows)) == 11
    again = choose(pool, aim, 11, largest_scale=1.5, groups=[(events, 2)], seed=7)
    assert (again.rows, again.factors) == (found.rows, found.factors)
    # Six events of which two each may be taken, one more without a name: a hundred cannot be found.
    assert len(choose(pool, aim, 100, largest_scale=50.0, groups=[(events, 2)]).rows) <= 13


def test_all_that_would_be_scaled_too_far_leaves_nothing() -> None:
    found = choose(drawn(5, 1) - 10.0, Aim(np.zeros(PERIODS.size)), 3, largest_scale=4.0)
    assert found.rows == ()
    assert found.misfit == float("inf")
