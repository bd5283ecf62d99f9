"""The choice is the best there is: on small galleries it is that of exhaustive search."""

from __future__ import annotations

from itertools import product
from math import fsum
from random import Random

import numpy as np
import pytest
from scipy.optimize import linprog
from scipy.sparse import lil_array

from pipeline.errors import InputError
from pipeline.planning.choice import EXACT, EffortLimits, ErrandWork, bundles, choose
from pipeline.planning.efforts import Efforts, efforts
from pipeline.planning.errands import Advised, Errand, errands_of
from pipeline.planning.plan import ErrandPlan, PlanTerms, gallery_order, plan_of

from .objects import advised, collection

ORDER = {"Room 0": 0, "Room 1": 1}


def taken(errands: tuple[Errand, ...], chosen: tuple[int, ...], have: Efforts) -> tuple[float, float, dict[str, float]]:
    """Hours, cost and hours by trade of some errands, setting out counted once a gallery."""
    rooms = len({errands[at].gallery for at in chosen})
    trades: dict[str, float] = {}
    for at in chosen:
        trades[errands[at].trade] = trades.get(errands[at].trade, 0.0) + errands[at].hours.value
    trades[have.visit.trade] = trades.get(have.visit.trade, 0.0) + rooms * have.visit.hours
    hours = fsum(errands[at].hours.value for at in chosen) + rooms * have.visit.hours
    return hours, fsum(errands[at].cost.value for at in chosen) + rooms * have.visit.cost, trades


def allowed(errands: tuple[Errand, ...], chosen: tuple[int, ...], limits: EffortLimits, have: Efforts) -> bool:
    """Whether a choice is within the limits, and nothing is done before what it needs."""
    hours, cost, trades = taken(errands, chosen, have)
    # A hair for the rounding of the sums.
    return (
        all(errands[at].needs is None or errands[at].needs in chosen for at in chosen)
        and (limits.hours is None or hours <= limits.hours + 1e-6)
        and (limits.cost is None or cost <= limits.cost + 1e-6)
        and all(trades.get(name, 0.0) <= most + 1e-6 for name, most in limits.trades.items())
    )


def best_of_all(errands: tuple[Errand, ...], limits: EffortLimits, have: Efforts) -> float:
    """What is avoided at most: every set of errands is looked at."""
    best = 0.0
    for which in product((False, True), repeat=len(errands)):
        chosen = tuple(at for at, yes in enumerate(which) if yes)
        avoided = fsum(errands[at].avoided for at in chosen)
        if avoided > best and allowed(errands, chosen, limits, have):
            best = avoided
    return best


@pytest.mark.parametrize("seed", range(14))
def test_small_galleries_get_what_exhaustive_search_finds(seed: int) -> None:
    have, random = efforts(), Random(seed)
    errands = errands_of(collection(7, seed), have, ORDER)
    assert len(errands) <= 12
    whole = taken(errands, tuple(range(len(errands))), have)
    hours, cost = random.uniform(0.1, 0.8) * whole[0], random.uniform(0.1, 0.8) * whole[1]
    trades = {"mount-maker": random.uniform(0.2, 0.9) * whole[2].get("mount-maker", 1.0)}
    for limits in (
        EffortLimits(hours, cost),
        EffortLimits(hours),
        EffortLimits(None, cost),
        EffortLimits(hours, None, trades),
    ):
        found = choose(ErrandWork(errands, have.visit), limits)
        chosen = tuple(sorted(found.chosen))
        assert allowed(errands, chosen, limits, have)
        # The search compares gains to 1e-9 of the whole.
        assert found.avoided == pytest.approx(best_of_all(errands, limits, have), rel=1e-8)
        assert found.gap == 0.0
    assert any(one.needs is not None for s in range(14) for one in errands_of(collection(7, s), have, ORDER))


@pytest.mark.parametrize("seed", range(4))
def test_no_choice_lies_above_the_curve_and_its_corners_can_be_had(seed: int) -> None:
    have = efforts()
    errands = errands_of(collection(7, 100 + seed), have, ORDER)
    plan = plan_of(collection(7, 100 + seed), 100.0, ORDER, PlanTerms(have))
    hours = [corner.hours for corner in plan.curve]
    avoided = [corner.avoided for corner in plan.curve]
    slopes = np.diff(avoided) / np.diff(hours)
    assert np.all(np.diff(slopes) <= 1e-12)
    for which in product((False, True), repeat=len(errands)):
        chosen = tuple(at for at, yes in enumerate(which) if yes)
        if not allowed(errands, chosen, EffortLimits(), have):
            continue
        gain = fsum(errands[at].avoided for at in chosen)
        assert gain <= np.interp(taken(errands, chosen, have)[0], hours, avoided) + 1e-9
    for corner in plan.curve[1:]:
        assert choose(ErrandWork(errands, have.visit), EffortLimits(corner.hours)).avoided == pytest.approx(
            corner.avoided
        )


def test_more_of_anything_never_avoids_less() -> None:
    have = efforts()
    found = collection(60, 5)
    for axis in ("hours", "cost"):
        last = -1.0
        for most in (0.0, 1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1e3, 1e5):
            limits = EffortLimits(hours=most) if axis == "hours" else EffortLimits(cost=most)
            plan = plan_of(found, 200.0, ORDER, PlanTerms(have, limits))
            assert plan.choice.avoided >= last - 1e-9
            assert getattr(plan, axis).value <= most + 1e-6
            last = plan.choice.avoided
        assert last == pytest.approx(plan_of(found, 200.0, ORDER, PlanTerms(have)).choice.avoided)


def test_of_many_errands_the_choice_is_bounded_and_within_its_limits() -> None:
    """Beyond what is searched through the relaxed problem bounds what any choice avoids: the gap is told."""
    have = efforts()
    found = collection(6_000, 7, galleries=30)
    order = {f"Room {room}": room for room in range(30)}
    errands = errands_of(found, have, order)
    assert len(errands) > EXACT
    for limits in (EffortLimits(100.0, 2_000.0), EffortLimits(4_000.0, trades={"engineer": 200.0})):
        choice = choose(ErrandWork(errands, have.visit), limits)
        assert allowed(errands, tuple(sorted(choice.chosen)), limits, have)
        # A rounded solution misses at most as much as the few errands that it cuts.
        assert 0.0 <= choice.gap < 0.01
        assert choice.avoided == pytest.approx(fsum(errands[at].avoided for at in choice.chosen))
        assert choice.bound >= choice.avoided


def test_the_bound_of_many_errands_is_that_of_the_relaxed_problem() -> None:
    """Independent: the relaxed problem, in which errands may be done in part, is solved by the simplex method."""
    have = efforts()
    errands = errands_of(collection(4_500, 8, galleries=20), have, {})
    assert len(errands) > EXACT
    rooms = sorted({one.gallery for one in errands})
    number = len(errands)
    gains = np.array([one.avoided for one in errands] + [0.0] * len(rooms))
    hours = np.array([one.hours.value for one in errands] + [have.visit.hours] * len(rooms))
    costs = np.array([one.cost.value for one in errands] + [have.visit.cost] * len(rooms))
    order = lil_array((number + 2, number + len(rooms)))
    for at, one in enumerate(errands):
        order[at, at] = 1.0
        order[at, number + rooms.index(one.gallery) if one.needs is None else one.needs] = -1.0
    order[number], order[number + 1] = hours, costs
    most = [0.0] * number + [800.0, 9_000.0]
    relaxed = linprog(-gains, A_ub=order.tocsr(), b_ub=most, bounds=(0.0, 1.0))
    choice = choose(ErrandWork(errands, have.visit), EffortLimits(800.0, 9_000.0))
    # The cuts stop within 1e-6 of the least bound; what does not fit by itself is left out before, which lowers it.
    assert choice.bound == pytest.approx(-relaxed.fun, rel=1e-4)
    assert choice.bound <= -relaxed.fun * (1.0 + 1e-5)


def test_what_is_alike_is_chosen_in_walking_order_whatever_order_it_comes_in() -> None:
    found = [advised(f"{n:02}", "clamps", 1.0) for n in range(30)]
    have = efforts()
    most = have.visit.hours + 7.5 * have.of("clamps").hours
    for seed in range(3):
        Random(seed).shuffle(found)
        plan = plan_of(found, 40.0, {"East": 0}, PlanTerms(have, EffortLimits(most)))
        assert [one.objects[0].object_number for one in plan.chosen] == [f"{n:02}" for n in range(7)]


def test_of_equal_gains_the_fewest_hours_are_taken() -> None:
    found = [advised("1", "strengthen", 1.0), advised("2", "wax", 1.0)]
    plan = plan_of(found, 2.0, {"East": 0}, PlanTerms(efforts(), EffortLimits(31.0, 1_500.0)))
    assert [one.measure for one in plan.chosen] == ["wax"]


def test_setting_out_is_worth_it_for_several_errands_of_a_gallery_only() -> None:
    """One errand of 1.0 in the west against two of 0.6 in the east: hours for one gallery and two errands."""
    have = efforts()
    found = [
        advised("1", "wax", 1.0, gallery="West"),
        advised("2", "wax", 0.6, gallery="East"),
        advised("3", "wax", 0.6, gallery="East"),
    ]
    most = have.visit.hours + 2.0 * have.of("wax").hours
    plan = plan_of(found, 3.0, {"East": 0, "West": 1}, PlanTerms(have, EffortLimits(most)))
    assert {one.gallery for one in plan.chosen} == {"East"}
    assert plan.hours.value == pytest.approx(most)


def test_what_takes_objects_from_view_is_chosen_only_where_that_is_wanted() -> None:
    found = [advised("1", "remove", 5.0), advised("2", "wax", 1.0)]
    kept = plan_of(found, 6.0, {"East": 0}, PlanTerms(efforts()))
    assert [one.measure for one in kept.chosen] == ["wax"]
    assert [kept.errands[at].measure for at in kept.away] == ["remove"]
    assert kept.share == pytest.approx(1.0 / 6.0)
    let = plan_of(found, 6.0, {"East": 0}, PlanTerms(efforts(), EffortLimits(away=True)))
    assert let.share == pytest.approx(1.0)
    assert let.away == ()


def test_nothing_to_do_and_nothing_to_do_it_with() -> None:
    assert plan_of([], 3.0, {}, PlanTerms(efforts(), EffortLimits(40.0))).chosen == ()
    assert plan_of([advised("1", "wax", 1.0)], 3.0, {}, PlanTerms(efforts(), EffortLimits(0.0))).chosen == ()
    useless = plan_of([advised("1", "wax", 1.0, 1.0)], 3.0, {}, PlanTerms(efforts()))
    assert useless.chosen == ()


@pytest.mark.parametrize("limits", [{"hours": -1.0}, {"cost": float("nan")}, {"trades": {"plumber": 3.0}}])
def test_limits_that_are_none_are_refused(limits: dict[str, object]) -> None:
    with pytest.raises(InputError, match=r"hours|cost|plumber"):
        EffortLimits(**limits)  # type: ignore[arg-type]


def test_the_best_bundle_holds_its_root() -> None:
    """By hand: the root costs 1 and gains nothing, its children gain 4 for 1 and 1 for 2; so 4/2 and then 1/2."""
    found = bundles([-1, 0, 0], [0.0, 4.0, 1.0], [1.0, 1.0, 2.0])
    assert [(one.nodes, one.gain, one.effort) for one in found] == [([0, 1], 4.0, 2.0), ([2], 1.0, 2.0)]


def test_an_order_is_never_before_what_it_needs() -> None:
    found = collection(400, 11, galleries=5)
    plan: ErrandPlan = plan_of(
        found, 1e3, gallery_order({f"Room {n}": (n, 0, 0) for n in range(5)}), PlanTerms(efforts())
    )
    place = {at: rank for rank, at in enumerate(plan.best_first)}
    for at in plan.best_first:
        needs = plan.errands[at].needs
        assert needs is None or place[needs] < place[at]
    # The gallery with the most to do comes first.
    assert plan.errands[0].gallery == "Room 4"
    assert all(isinstance(one, Advised) for errand in plan.errands for one in errand.objects)
