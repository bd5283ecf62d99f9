"""What a shaking did: the capacity behind two curves, the range of a number of objects, and the order of lists."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import norm

from pipeline.event.answer import (
    DRAWS,
    FEWER,
    LOW,
    Answer,
    ObjectAnswer,
    answered,
    chances,
    drawn,
    normals,
)  # fmt: skip
from pipeline.event.capacities import KINDS, Capacities, FloorMotions, Stock, capacities, stock_joined, stock_of
from pipeline.event.message import SiteShaking
from pipeline.quantities import Array, G
from pipeline.records import Assessment, Fragility, Harm, Item, Likelihood, Sampling, Scene, Support
from pipeline.records.fragility import ABOVE, HARM
from pipeline.records.likelihood import Band

FALLS = KINDS.index(Harm.FALLS.value)
MODELLING = 0.25


def assessment(number: str = "1", gallery: str = "A", *more: Fragility, **also: object) -> Assessment:
    scene = Scene(Item(number, gallery, title=f"Vase {number}"), "vase", "", Support.FREESTANDING, (), {})
    return replace(Assessment(scene, (), (), more), **also)  # type: ignore[arg-type]


def stock(objects: Sequence[Assessment], able: Capacities) -> Stock:
    """Objects that can take what is said."""
    return replace(stock_of(objects, {}), capacities=able)


def curve(state: str, medians: tuple[float, float], dispersions: tuple[float, float], **more: object) -> Fragility:
    return Fragility(
        "1", "", "", medians[0], medians[0], medians[0], "", dispersions[0], 0.0, stated=False, inputs=0.0,
        modelling=MODELLING, motions=100, returns=False, state=state, median_pgv=medians[1],
        dispersion_pgv=dispersions[1], **more,  # type: ignore[arg-type]
    )  # fmt: skip


def of_one(floor: FloorMotions, *curves: Fragility) -> Capacities:
    return capacities([assessment("1", "A", *curves)], {"": floor})


@pytest.mark.parametrize("beta", [0.0, 0.3, 0.8, 1.0])
def test_the_capacity_behind_two_curves_is_found(beta: float) -> None:
    """Simulated motions: what fails by both peaks together gives two curves, and these give both peaks' shares back."""
    spread, rest = 0.5, 0.4
    random = np.random.default_rng(3)
    ratio, noise = random.normal(-2.3, spread, 200_000), random.normal(0.0, rest, 200_000)
    # It fails where (1 - beta) ln A + beta ln V reaches ln c; scaling a motion keeps V / A.
    ln_c = math.log(1.2)
    by_a = ln_c - beta * ratio + noise
    by_v = by_a + ratio
    found = of_one(
        FloorMotions({}, -2.3, spread),
        curve("falls", (float(np.exp(by_a.mean())), float(np.exp(by_v.mean()))), (by_a.std(), by_v.std())),
    )
    # 200,000 motions tell a deviation of 0.6 to 0.001.
    assert found.beta[FALLS, 0] == pytest.approx(beta, abs=0.01)
    assert found.ln_capacity[FALLS, 0] == pytest.approx(ln_c, abs=0.01)
    whole = math.hypot(found.own[FALLS, 0], found.common[FALLS, 0])
    assert whole == pytest.approx(rest, abs=0.01)
    assert found.own[FALLS, 0] == MODELLING


def test_a_curve_by_its_own_peak_is_that_curve() -> None:
    """Where only the acceleration counts, the probability at a sure acceleration is that of the curve itself."""
    one = curve(HARM, (3.0, 0.3), (0.5, math.hypot(0.5, 0.5)))
    found = of_one(FloorMotions({}, math.log(0.1), 0.5), one)
    for pga in (1.0, 3.0, 6.0):
        shaking = SiteShaking(pga / G, 5.0, 0.0, 0.0, "")
        answer = answered(stock([assessment()], found), shaking, Sampling(), drawn(shaking))
        # 512 draws of what differs from record to record: as a balanced sequence they tell it to 0.005.
        assert answer.objects[0].probability == pytest.approx(one.probability(pga), abs=0.005)


def test_what_a_curve_does_not_tell_is_read_from_its_stripes() -> None:
    bound = replace(
        curve("falls", (9.0, 0.9), (0.6, 0.5)), bound=ABOVE, stripes=((1.0, 16, 0), (2.0, 16, 4), (4.0, 16, 2))
    )
    found = of_one(FloorMotions({}, 0.0, 0.5), bound)
    for pga, share in ((0.5, 0.0), (math.sqrt(2.0), 0.125), (2.0, 0.25), (8.0, 0.25)):
        shaking = SiteShaking(pga / G, 5.0, 0.0, 0.0, "")
        answer = answered(stock([assessment()], found), shaking, Sampling(), drawn(shaking))
        assert answer.objects[0].fallen == pytest.approx(share, abs=1e-9)


def test_a_floor_above_shakes_more() -> None:
    one = curve(HARM, (4.0, 0.4), (0.5, 0.5))
    ground = of_one(FloorMotions({}, 0.0, 0.5), one)
    above = of_one(FloorMotions({}, 0.0, 0.5, (math.log(2.0), math.log(2.0), 0.0)), one)
    assert above.ln_capacity[0, 0] == pytest.approx(ground.ln_capacity[0, 0] - math.log(2.0))


def test_without_curves_the_levels_tell() -> None:
    """At the level's own peaks the probability is that of the run."""
    said = Likelihood("design", 0.3, 0.02, 512, Band.POSSIBLE, "falls", {"falls": 0.2})
    floor = FloorMotions({"design": (math.log(4.0), math.log(0.4))}, math.log(0.1), 0.5)
    those = [assessment(likelihoods=(said,))]
    shaking = SiteShaking(4.0 / G, 40.0, 0.0, 0.0, "")
    answer = answered(stock(those, capacities(those, {"": floor})), shaking, Sampling(), drawn(shaking))
    assert answer.objects[0].probability == pytest.approx(0.3, abs=0.01)
    assert answer.objects[0].fallen == pytest.approx(0.2, abs=0.01)


def alike(count: int, own: float, common: float) -> tuple[list[Assessment], Capacities]:
    """Objects that are alike: at 4 m/s2 each falls as likely as not."""
    shape = len(KINDS), count
    parts: list[Array] = [np.full(shape, np.nan) for _ in range(4)]
    for part, value in zip(parts, (math.log(4.0), 0.0, common, own), strict=True):
        part[[0, FALLS]] = value
    return [assessment(str(at), f"Room {at % 4}") for at in range(count)], Capacities(*parts)


def counted(count: int, own: float, common: float, sd: float) -> Answer:
    shaking = SiteShaking(4.0 / G, 40.0, sd, sd, "")
    objects, found = alike(count, own, common)
    return answered(stock(objects, found), shaking, Sampling(), drawn(shaking))


def test_the_range_of_how_many_is_that_of_a_binomial_where_nothing_is_shared() -> None:
    """400 that fall as likely as not: 200 -+ 1.645 x 10."""
    count = counted(400, 0.3, 0.0, 0.0).count
    assert count.fallen == pytest.approx(200.0, abs=0.5)
    assert (count.low, count.high) == pytest.approx((183.6, 216.4), abs=2.0)


@pytest.mark.parametrize(("common", "sd"), [(0.4, 0.0), (0.0, 0.4), (0.3, 0.3)])
def test_what_all_share_widens_the_range(common: float, sd: float) -> None:
    """Closed form: of n alike the share that falls is Phi(z shared / own), z being standard normal."""
    own = 0.3
    count = counted(400, own, common, sd).count
    shared = math.hypot(common, sd)
    low, high = (400.0 * norm.cdf(norm.ppf(share) * shared / own) for share in (LOW, 1.0 - LOW))
    # 26 of 512 draws lie beyond each end, so that an end is told to a fifth of a standard deviation.
    assert count.low == pytest.approx(low, abs=12.0)
    assert count.high == pytest.approx(high, abs=12.0)
    assert count.high - count.low > 3 * 33


def test_lists_are_in_the_order_of_what_is_lost() -> None:
    objects, found = alike(8, 0.3, 0.0)
    objects[5] = replace(
        objects[5], scene=replace(objects[5].scene, item=replace(objects[5].scene.item, value_class="A"))
    )
    found.ln_capacity[:, 2] = np.nan
    shaking = SiteShaking(4.0 / G, 40.0, 0.0, 0.0, "")
    answer = answered(stock(objects, found), shaking, Sampling(), drawn(shaking))
    assert answer.objects[0].number == "5"
    assert (answer.objects[-1].number, answer.objects[-1].probability) == ("2", None)
    assert answer.unknown == 1
    assert [one.name for one in answer.galleries][0::3] == ["Room 1", "Room 2"]
    assert sum(one.objects for one in answer.galleries) == 8
    losses = [one.expected_loss for one in answer.galleries]
    assert losses == sorted(losses, reverse=True)


def test_what_has_moved_and_stands_is_told_as_weaker() -> None:
    objects, found = alike(1, 0.3, 0.0)
    for part, value in zip((found.ln_capacity, found.beta, found.common, found.own), (math.log(1.0), 0.0, 0.0, 0.3),
                           strict=True):  # fmt: skip
        part[KINDS.index("rocks")] = value
    found.ln_capacity[[0, FALLS]] = math.log(16.0)
    shaking = SiteShaking(4.0 / G, 40.0, 0.0, 0.0, "")
    one = answered(stock(objects, found), shaking, Sampling(), drawn(shaking)).objects[0]
    assert one.moved > 0.99
    assert one.aftershock
    assert one.fallen < 0.01
    # Nothing is known of its mass, so that nobody is told to fear it.
    assert not one.make_safe
    # However heavy it is, it cannot fall: nobody need make it safe before they go in.
    heavy = replace(stock(objects, found), danger=np.array([50.0]))
    assert not answered(heavy, shaking, Sampling(), drawn(shaking)).objects[0].make_safe
    found.ln_capacity[[0, FALLS]] = math.log(1.0)
    falling = replace(stock(objects, found), danger=np.array([50.0]))
    assert answered(falling, shaking, Sampling(), drawn(shaking)).objects[0].make_safe


def test_what_is_kept_answers_as_what_was_found() -> None:
    """Packed page by page and read again, with curves and with shares, it is the same to the last bit."""
    stripes = ((1.0, 16, 0), (2.0, 16, 4), (4.0, 16, 8))
    told = replace(curve("falls", (9.0, 0.9), (0.6, 0.5)), bound=ABOVE, stripes=stripes)
    objects = [
        assessment(str(at), f"Room {at % 2}", curve(HARM, (3.0 + at, 0.3), (0.5, 0.6)), *([told] if at % 3 else []))
        for at in range(12)
    ]
    floors = {"": FloorMotions({}, math.log(0.1), 0.5)}
    whole = stock_of(objects, floors)
    parts = [Stock.of_packed(stock_of(objects[at : at + 5], floors).packed()) for at in (0, 5, 10)]
    again = stock_joined(parts)
    shaking = SiteShaking(0.3, 30.0, 0.4, 0.4, "")
    assert again.numbers == whole.numbers == tuple(map(str, range(12)))
    answers = [answered(one, shaking, Sampling(), drawn(shaking)) for one in (whole, again)]
    assert answers[0] == answers[1]
    assert whole.capacities.known.all()
    some = [7, 2, 5]
    few = whole.capacities.some(some)
    chance = chances(whole.capacities, drawn(shaking), slice(0, 12))
    assert np.array_equal(chances(few, drawn(shaking), slice(0, 3)), chance[:, :, some])


@pytest.mark.parametrize("same", [True, False])
def test_what_is_known_at_the_peaks_takes_the_place_of_curves(same: bool) -> None:
    """At the very peaks the probability is that; twice as strong it is more; what others do stays as it was."""
    objects, able = alike(4, 0.3, 0.2)
    peaks = math.log(4.0), math.log(0.4)
    sure = able.centred({2: {HARM: 0.25, "falls": 0.125}}, *peaks, same=same)

    def told(able: Capacities, pga: float) -> dict[str, ObjectAnswer]:
        shaking = SiteShaking(pga / G, 10.0 * pga, 0.0, 0.0, "")
        return {one.number: one for one in answered(stock(objects, able), shaking, Sampling(), drawn(shaking)).objects}

    one = told(sure, 4.0)["2"]
    assert (one.probability, one.fallen) == pytest.approx((0.25, 0.125), abs=0.003)
    twice = told(sure, 8.0)["2"].fallen
    sigma = 0.3 if same else math.hypot(0.3, 0.2)
    assert twice == pytest.approx(norm.cdf(norm.ppf(0.125) + math.log(2.0) / sigma), abs=0.01)
    assert all(told(sure, 4.0)[number] == told(able, 4.0)[number] for number in "013")


def test_what_no_curve_told_is_known_at_the_peaks_too() -> None:
    objects, able = alike(2, 0.3, 0.2)
    for part in (able.ln_capacity, able.beta, able.common, able.own):
        part[:, 1] = np.nan
    assert able.known.tolist() == [True, False]
    sure = able.centred({1: {HARM: 0.5, "shifts": 0.9}}, math.log(4.0), math.log(0.4), same=True)
    shaking = SiteShaking(4.0 / G, 40.0, 0.0, 0.0, "")
    one = answered(stock(objects, sure), shaking, Sampling(), drawn(shaking)).objects
    found = next(each for each in one if each.number == "1")
    assert (found.probability, found.states, found.moved) == (
        pytest.approx(0.5), {"shifts": pytest.approx(0.9)}, pytest.approx(0.9)
    )  # fmt: skip


def test_draws_are_far_more_even_than_chance() -> None:
    """Against scipy's own measure, the square of what a mean is missed by, of the best of 99 random ones."""
    from scipy.special import ndtr
    from scipy.stats import qmc

    for count in (FEWER, DRAWS):
        ours = qmc.discrepancy(ndtr(normals(count=count)))
        chance = min(qmc.discrepancy(np.random.default_rng(seed).random((count, 3))) for seed in range(99))
        assert ours < 0.5 * chance
