"""Reports from the galleries: simulated museums, of which the truth is known."""

from __future__ import annotations

import math

import numpy as np
import pytest

from pipeline.event.answer import answered, drawn
from pipeline.event.capacities import KINDS, Capacities
from pipeline.event.message import NINETY, SiteShaking
from pipeline.event.reports import conditioned
from pipeline.quantities import G
from pipeline.records import Sampling
from tests.event.test_answer import FALLS, assessment, stock

LOOKED_AT = 40


def museum(count: int, random: np.random.Generator) -> Capacities:
    """Objects of which some fall at 1 and some at 16 m/s2, by their acceleration alone."""
    shape = len(KINDS), count
    parts = [np.full(shape, np.nan) for _ in range(4)]
    ln_c = random.uniform(math.log(1.0), math.log(16.0), count)
    for part, value in zip(parts, (ln_c, 0.0, 0.3, 0.3), strict=True):
        part[[0, FALLS]] = value
    return Capacities(*parts)


@pytest.mark.long("test_what_was_found_changes_what_is_expected_of_the_rest")
def test_the_truth_lies_in_the_range_that_reports_leave() -> None:
    """50 museums: the true acceleration, and how many fell, lie in the ranges of 9 in 10 cases.

    Of 50 with a chance of 0.9 each, between 39 and 49 lie inside in 99 of 100 cases.
    """
    random = np.random.default_rng(5)
    told = SiteShaking(0.4, 40.0, 0.6, 0.6, "a first alert")
    objects = [assessment(str(at)) for at in range(200)]
    peaks, numbers, narrower = 0, 0, []
    for _ in range(50):
        able = museum(200, random)
        true, record = math.log(0.4 * G) + 0.6 * random.normal(), random.normal()
        fallen = true + 0.3 * record + 0.3 * random.normal(size=200) > able.ln_capacity[FALLS]
        found = {at: "fallen" if fallen[at] else "standing" for at in range(LOOKED_AT)}
        draws, after = conditioned(able, found, told)
        peaks += abs(true - math.log(after.pga_g * G)) < NINETY * after.pga_ln_sd
        answer = answered(stock(objects, able), after, Sampling(), draws, found)
        numbers += answer.count.low <= fallen.sum() <= answer.count.high
        narrower.append(after.pga_ln_sd / told.pga_ln_sd)
    assert 39 <= peaks <= 49
    # A number of objects is whole: the range holds a little more than 9 in 10 cases.
    assert 39 <= numbers <= 49
    # Closed form of normals: what is in common is 0.6 of shaking beside 0.3 of the record, which reports cannot part,
    # so that at best 0.3 / sqrt(0.6^2 + 0.3^2) = 0.45 is left.
    assert 0.44 < np.mean(narrower) < 0.6


def test_what_was_found_changes_what_is_expected_of_the_rest() -> None:
    able = museum(100, np.random.default_rng(6))
    objects = [assessment(str(at)) for at in range(100)]
    told = SiteShaking(0.4, 40.0, 0.6, 0.6, "a first alert")
    before = answered(stock(objects, able), told, Sampling(), drawn(told))
    rest = {}
    for state in ("standing", "fallen"):
        found = dict.fromkeys(range(30), state)
        draws, after = conditioned(able, found, told)
        answer = answered(stock(objects, able), after, Sampling(), draws, found)
        rest[state] = sum(one.fallen for one in answer.objects if not one.reported)
        sure = [one for one in answer.objects if one.reported]
        assert {one.fallen for one in sure} == {float(state == "fallen")}
        assert "30 reports" in after.origin
    unseen = sum(one.fallen for one in before.objects if int(one.number) >= 30)
    assert rest["standing"] < unseen < rest["fallen"]


def test_without_reports_nothing_changes() -> None:
    able = museum(10, np.random.default_rng(7))
    told = SiteShaking(0.4, 40.0, 0.6, 0.6, "a first alert")
    draws, after = conditioned(able, {}, told)
    assert after == told
    assert np.array_equal(draws.ln_pga, drawn(told).ln_pga)
