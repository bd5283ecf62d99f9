"""Errands: what is shared is one, what they take adds up, and what they avoid is what simulation finds."""

from __future__ import annotations

import csv
from math import exp

import numpy as np
import pytest

from pipeline.analysis.stakes import expected_loss
from pipeline.planning.choice import EffortLimits
from pipeline.planning.efforts import efforts
from pipeline.planning.errands import advised as advised_of
from pipeline.planning.errands import deciding, errands_of, loss_left
from pipeline.planning.plan import PlanTerms, plan_of
from pipeline.quantities import G
from pipeline.records import Assessment, Band, Estimate, Item, Likelihood, Origin, Recommendation, Scene, Support
from pipeline.tables import FOLDER

from .objects import advised

HAVE = efforts()


def test_objects_of_a_case_with_the_same_measure_are_one_errand_and_others_are_not() -> None:
    found = [
        advised("3", "wax", 1.0, case="A"),
        advised("1", "wax", 2.0, 0.5, case="A"),
        advised("2", "putty", 1.0, case="A"),
        advised("4", "wax", 1.0, case="B"),
        advised("5", "wax", 1.0),
        advised("6", "wax", 1.0),
        advised("7", "wax", 1.0, case="A", gallery="West"),
    ]
    errands = errands_of(found, HAVE, {"West": 0, "East": 1})
    said = [(one.gallery, one.case, one.measure, [o.object_number for o in one.objects]) for one in errands]
    assert said == [
        ("West", "A", "wax", ["7"]),
        ("East", "", "wax", ["5"]),
        ("East", "", "wax", ["6"]),
        ("East", "A", "wax", ["1", "3"]),
        ("East", "A", "putty", ["2"]),
        ("East", "B", "wax", ["4"]),
    ]
    both, row = errands[3], HAVE.of("wax")
    assert both.hours.value == pytest.approx(row.hours * (1.0 + row.hours_further))
    assert both.hours.high == pytest.approx(row.hours_high * (1.0 + row.hours_further))
    assert both.cost.low == pytest.approx(row.cost_low * (1.0 + row.cost_further))
    assert (both.loss, both.avoided) == (3.0, 2.5)


def test_a_case_on_an_isolator_is_bought_once() -> None:
    found = [advised(str(n), "horizontal_isolator", 1.0, case="A") for n in range(5)]
    (one,) = errands_of(found, HAVE, {})
    row = HAVE.of("horizontal_isolator")
    assert one.cost.value == row.cost
    assert row.hours < one.hours.value < 1.1 * row.hours
    assert one.avoided == 5.0
    assert one.trade == "engineer"


def test_what_has_doubtful_sizes_is_an_errand_of_its_own_and_its_furniture_is_fastened_once() -> None:
    found = [
        advised("1", "wax", 1.0, case="A", anchored=True),
        advised("2", "wax", 1.0, case="A", anchored=True, check=True),
        advised("3", "anchor", 1.0, case="A", check=True),
    ]
    said = [([o.object_number for o in e.objects], e.measure, e.needs, e.check) for e in errands_of(found, HAVE, {})]
    assert said == [(["3"], "anchor", None, True), (["1"], "wax", 0, False), (["2"], "wax", 0, True)]


def test_furniture_that_has_to_be_fastened_first_is_an_errand_that_others_need() -> None:
    found = [
        advised("1", "wax", 1.0, case="A", anchored=True),
        advised("2", "ties", 1.0, case="A", anchored=True),
        advised("3", "wax", 1.0, case="A"),
        advised("4", "wax", 1.0, anchored=True),
    ]
    errands = errands_of(found, HAVE, {})
    said = [(one.case, one.measure, one.needs, one.prepares, one.avoided) for one in errands]
    assert said == [
        ("", "anchor", None, True, 0.0),
        ("", "wax", 0, False, 1.0),
        ("A", "anchor", None, True, 0.0),
        ("A", "wax", None, False, 1.0),
        ("A", "wax", 2, False, 1.0),
        ("A", "ties", 2, False, 1.0),
    ]
    # With its own objects to help it avoids something itself, and is still one errand.
    more = errands_of([*found, advised("5", "anchor", 3.0, case="A")], HAVE, {})
    (anchor,) = [one for one in more if one.measure == "anchor" and one.case == "A"]
    assert (anchor.avoided, anchor.prepares) == (3.0, False)


def test_a_plan_pays_for_the_furniture_that_it_fastens() -> None:
    found = [advised("1", "wax", 1.0, case="A", anchored=True)]
    needed = HAVE.visit.hours + HAVE.of("anchor").hours + HAVE.of("wax").hours
    assert plan_of(found, 1.0, {}, PlanTerms(HAVE, EffortLimits(needed - 0.01))).chosen == ()
    plan = plan_of(found, 1.0, {}, PlanTerms(HAVE, EffortLimits(needed)))
    assert [one.measure for one in plan.chosen] == ["anchor", "wax"]
    assert plan.hours.value == pytest.approx(needed)
    assert set(plan.by_trade) == {"handler", "engineer"}
    assert sum(span.value for span in plan.by_trade.values()) == pytest.approx(needed)


def test_the_loss_that_is_left_is_in_proportion_to_the_harm_that_remains() -> None:
    assert loss_left(3.0, 0.6, None) == 0.0
    assert loss_left(3.0, 0.6, 0.06) == pytest.approx(0.3)
    assert loss_left(3.0, 0.6, 0.9) == 3.0
    assert loss_left(0.0, 0.0, 0.1) == 0.0


def assessed(number: str, worth: str, chance: float, falls: float, left: float | None, kind: str) -> Assessment:
    """An object of 8 kg whose centre of gravity is 0.4 m high, with what is known of its harm and what is advised."""
    numbers = {"mass": 8.0, "cg_height": 0.4}
    scene = Scene(
        Item(number, "East", "Vase", value_class=worth),
        "vessel",
        "",
        Support.FREESTANDING,
        (),
        {name: Estimate(value, "", Origin.MEASURED, value, value) for name, value in numbers.items()},
        (),
    )
    likely = Likelihood("design", chance, 0.01, 512, Band.LIKELY, "falls", {"falls": falls})
    weak = Likelihood("frequent", 0.2 * chance, 0.01, 512, Band.POSSIBLE)
    advice = [
        Recommendation(number, "East", level, measure, measure.title(), "Do it.", {}, {}, (), remaining=left)
        for level, measure in (("frequent", "clearance"), ("design", kind))
    ]
    return Assessment(scene, (), tuple(advice), likelihoods=(weak, likely))


def test_what_is_lost_and_avoided_is_what_a_simulation_of_earthquakes_finds() -> None:
    """Independent: each object is harmed, and falls, by chance; weights are read from the table itself.

    Of 400,000 earthquakes the mean is within 0.5 % of what is expected (four standard errors); 2 % is asked.
    """
    objects = [
        assessed("1", "A", 0.9, 0.5, 0.05, "wax"),
        assessed("2", "B", 0.5, 0.1, None, "clamps"),
        assessed("3", "C", 0.7, 0.7, 0.2, "ties"),
        assessed("4", "", 0.3, 0.0, 0.09, "fasten"),
        assessed("5", "A", 0.2, 0.15, None, "remove"),
    ]
    found = [one for one in (advised_of(a, "Do it.") for a in objects) if one is not None]
    assert [one.measure for one in found] == ["wax", "clamps", "ties", "fasten", "remove"]
    plan = plan_of(found, sum(map(expected_loss, objects)), {}, PlanTerms(HAVE))
    with (FOLDER / "stakes.csv").open(encoding="utf-8", newline="") as stream:
        weights = {row["name"]: float(row["value"]) for row in csv.DictReader(stream)}
    random, times = np.random.default_rng(1), 400_000
    before, after = np.zeros(times), np.zeros(times)
    person = weights["person"] * (1.0 - exp(-8.0 * G * 0.4 / weights["energy"]))
    for assessment in objects:
        likely, advice = assessment.likelihood, deciding(assessment)
        assert likely is not None
        assert advice is not None
        worth = weights[f"class_{assessment.scene.item.value_class.lower() or 'unknown'}"]
        draw, again = random.random(times), random.random(times)
        lost = worth * (draw < likely.probability) + person * (draw < likely.states["falls"])
        before += lost
        if advice.measure == "remove":
            after += lost
        elif advice.remaining is not None:
            # What harms it with the measure harmed it without: these earthquakes are some of those.
            after += lost * (again < advice.remaining / likely.probability)
    assert plan.loss == pytest.approx(before.mean(), rel=0.02)
    assert plan.loss - plan.choice.avoided == pytest.approx(after.mean(), rel=0.02)


def test_what_nobody_knows_or_is_in_a_store_is_no_errand() -> None:
    from dataclasses import replace

    one = assessed("1", "A", 0.9, 0.5, None, "wax")
    stored = replace(one, scene=replace(one.scene, item=replace(one.scene.item, on_display=False)))
    assert advised_of(stored, "") is None
    assert advised_of(replace(one, likelihoods=()), "") is None
    assert advised_of(replace(one, recommendations=one.recommendations[:1]), "") is None
