"""Half widths from a contact polygon, a tilt test and assumed bases, and what the models make of them."""

from __future__ import annotations

from dataclasses import replace
from math import cos, exp, hypot, log, pi, radians, tan
from pathlib import Path

import numpy as np
import pytest

from pipeline.analysis.assess import LevelMotions, assess
from pipeline.analysis.classify import classify, object_classes
from pipeline.analysis.context import Context
from pipeline.analysis.footing import bearing_of, bearings
from pipeline.analysis.plan import plan
from pipeline.errors import InputError
from pipeline.execute import Threads
from pipeline.quantities import G
from pipeline.records import ContactPolygon, Finding, Furniture, Item, Motion, Origin, Support
from pipeline.tables import read_table, table

DT = 0.005
TIME = np.arange(200) * DT
PUSH = np.where(TIME < 0.5, 0.15 * G * np.sin(2.0 * pi * TIME), 0.0)
"""One way only: a half sine."""

STAND = Item(
    "1", "G", "Figure", height_m=0.5, width_m=0.3, depth_m=0.3, cg_height_m=0.25, mass_kg=10.0,
    support=Support.FREESTANDING, furniture=Furniture.FLOOR, clearance_m=0.3, friction=0.9,
)  # fmt: skip


def shaken(x: np.ndarray, y: np.ndarray) -> LevelMotions:
    return LevelMotions("design", "max", (Motion(dt=DT, acceleration=np.array([x, y, 0.0 * x]), name="push"),))


ZERO = np.zeros_like(PUSH)


def uplift(item: Item, level: LevelMotions) -> Finding:
    _, (findings,) = assess([classify(item)], [level], Context(Threads(1)))
    (found,) = [one for one in findings if one.model == "standing"]
    return found


def rectangle(right: float, left: float, front: float, back: float) -> tuple[tuple[float, float], ...]:
    return ((right, front), (-left, front), (-left, -back), (right, -back))


def test_reach_and_narrowest_of_a_regular_polygon() -> None:
    n, r = 7, 0.1
    outline = ContactPolygon.around([(r * cos(2 * pi * k / n), r * cos(2 * pi * k / n - pi / 2)) for k in range(n)])
    assert outline.narrowest()[0] == pytest.approx(r * cos(pi / n))
    assert outline.reach(0.0) == pytest.approx(r)
    assert outline.reach(180.0) == pytest.approx(r * cos(pi / n))
    assert outline.reach(outline.narrowest()[1]) == pytest.approx(outline.narrowest()[0])


@pytest.mark.parametrize(
    ("points", "words"),
    [
        ([(0.1, 0.1), (0.2, 0.1), (0.1, 0.2)], "does not hold the centre of gravity, which lies 0.1 m beyond"),
        ([(0.1, 0.0), (-0.1, 0.0), (0.0, 0.1)], "does not hold the centre of gravity"),
        ([(0.1, 0.1), (-0.1, -0.1), (0.2, 0.2)], "one line"),
        ([(0.1, 0.1), (-0.1, -0.1), (0.1, 0.1)], "three different points"),
        ([(0.1, float("nan")), (-0.1, -0.1), (0.2, 0.1)], "no finite number"),
    ],
)
def test_an_outline_that_nothing_stands_on(points: list[tuple[float, float]], words: str) -> None:
    with pytest.raises(InputError, match=words):
        ContactPolygon.around(points)


def test_fewer_corners_never_make_it_larger() -> None:
    around = np.linspace(0.0, 2.0 * pi, 200, endpoint=False)
    circle = ContactPolygon.around([(0.1 * float(np.cos(a)), 0.1 * float(np.sin(a))) for a in around])
    fewer = circle.inscribed(32)
    assert len(fewer.corners) == 32
    assert set(fewer.corners) <= set(circle.corners)
    for angle in range(0, 360, 5):
        assert 0.1 * cos(pi / 32) * 0.99 <= fewer.reach(angle) <= circle.reach(angle) + 1e-12


def test_without_a_direction_the_nearest_edge_counts_with_what_is_opposite() -> None:
    """A polygon beside its base: what a mount-maker drew wins over a rule laid against it."""
    item = replace(STAND, contact_polygon=rectangle(0.02, 0.05, 0.06, 0.07), base_width_m=0.3, base_depth_m=0.3)
    found = classify(item).parameters
    assert (found["half_width"].value, found["half_width_other"].value) == pytest.approx((0.02, 0.05))
    assert found["half_width"].origin is Origin.MEASURED
    assert not {"half_base_width", "half_base_depth"} & set(found)


def test_along_its_own_axes_each_of_four_half_widths_counts() -> None:
    found = classify(replace(STAND, contact_polygon=rectangle(0.02, 0.05, 0.06, 0.07), orientation_deg=30.0)).parameters
    names = ("half_base_width", "half_base_width_other", "half_base_depth", "half_base_depth_other")
    assert [found[name].value for name in names] == pytest.approx([0.02, 0.05, 0.06, 0.07])


def test_the_least_outline_is_the_low_end() -> None:
    least = ((0.05, 0.0), (-0.03, 0.04), (-0.03, -0.04))
    item = replace(STAND, contact_polygon=rectangle(0.05, 0.06, 0.07, 0.08), contact_polygon_least=least)
    half = classify(item).parameters["half_width"]
    # The distance of the edges from (0.05, 0) to (-0.03, 0.04), by hand.
    nearest = 0.05 * 0.04 / np.hypot(0.08, 0.04)
    assert (half.low, half.value, half.high) == pytest.approx((nearest, 0.05, 0.05))


def test_which_way_it_is_pushed_decides_on_an_uneven_base() -> None:
    """Closed form: an edge lifts at a/g = b/h of the edge that it tips over, which lies against the push."""
    item = replace(STAND, contact_polygon=rectangle(0.05, 0.10, 0.20, 0.20), orientation_deg=90.0)
    demands = [uplift(item, shaken(sign * PUSH, ZERO)).demand for sign in (1.0, -1.0)]
    assert sorted(demands) == pytest.approx([0.15 / (0.10 / 0.25), 0.15 / (0.05 / 0.25)], rel=1e-3)
    # Half a turn of the object is half a turn of the motion.
    turned = replace(item, orientation_deg=270.0)
    assert [uplift(turned, shaken(sign * PUSH, ZERO)).demand for sign in (-1.0, 1.0)] == pytest.approx(demands)
    # Along its depth, both ways alike.
    across = uplift(item, shaken(ZERO, PUSH)).demand
    assert across == pytest.approx(0.15 / (0.20 / 0.25), rel=1e-3)


@pytest.mark.parametrize("angle", [5.0, 12.0])
def test_a_tilt_test_settles_the_slope_whatever_is_assumed_of_the_height(angle: float) -> None:
    """An edge lifts at a/g = tan(angle) exactly, though centre of gravity and base are assumed."""
    item = replace(STAND, cg_height_m=None, tilt_angle_deg=angle)
    found = uplift(item, shaken(PUSH, ZERO))
    exact = 0.15 / tan(radians(angle))
    assert (found.low, found.demand, found.high) == pytest.approx((exact, exact, exact), rel=1e-3)
    parameters = classify(item).parameters
    assert parameters["half_width"].low < parameters["half_width"].high
    (work,) = [one for one in plan([classify(item)]).work if one.model.name == "standing"]
    slopes = np.degrees(np.arctan2(work.values["half_width"], work.values["cg_height"]))
    assert slopes == pytest.approx(np.full(slopes.size, angle))
    assert slopes.size > 1


def test_a_tilt_test_does_instead_of_a_base_that_nobody_measured() -> None:
    lost = replace(STAND, title="Untitled (mask)", width_m=None, depth_m=None, cg_height_m=0.2)
    assert classify(lost).missing
    assert not classify(replace(lost, tilt_angle_deg=8.0)).missing


def test_of_the_edges_along_its_axes_the_nearest_is_the_tested_one() -> None:
    item = replace(STAND, contact_polygon=rectangle(0.05, 0.06, 0.07, 0.08), orientation_deg=0.0)
    found = classify(replace(item, tilt_angle_deg=10.0)).parameters
    tested = 0.25 * tan(radians(10.0))
    names = ("half_base_width", "half_base_width_other", "half_base_depth", "half_base_depth_other")
    assert [found[name].value for name in names] == pytest.approx([tested, 0.06, 0.07, 0.08])
    assert all(found[name].low >= tested * (1.0 - 1e-12) for name in names)


def test_every_class_with_an_assumed_base_owns_up_to_what_may_not_bear() -> None:
    """Judgement is wide: a quarter of every assumed base is in doubt, a natural one was 4 times narrower on a table."""
    based = {row["class"] for row in table("classes") if row["base_ratio"]}
    assert based <= set(object_classes())
    named = [name for row in bearings() if not row.words for name in row.classes]
    assert sorted(named) == sorted(based)
    for row in bearings():
        assert row.high - row.low >= 0.25
    natural = bearing_of(replace(STAND, title="Boulder"), "object")
    assert natural is not None
    assert natural.low <= 0.25


def test_a_narrow_base_and_one_that_hardly_bears_are_two_chances() -> None:
    """Closed form: two factors that have nothing to do with each other add up as squares, in the logarithm."""
    row = next(row for row in table("classes") if row["class"] == "statue")
    bears = bearing_of(STAND, "statue")
    assert bears is not None
    best, low, high = (float(row[name]) for name in ("base_ratio", "base_low", "base_high"))
    item = Item("1", "G", "Figure", object_name="sculpture", medium="bronze", height_m=0.9, width_m=0.6, depth_m=0.5)
    scene = classify(item)
    assert scene.object_class == "statue"
    half = scene.parameters["half_width"]
    assert half.value == pytest.approx(0.25 * best * bears.share)
    assert half.low == pytest.approx(half.value * exp(-hypot(log(best / low), log(bears.share / bears.low))))
    assert half.high == pytest.approx(half.value * exp(hypot(log(high / best), log(bears.high / bears.share))))
    # Nothing lies outside of both at their ends at once.
    assert 0.25 * low * bears.low < half.low < half.high < 0.25 * high * bears.high


RECORDED = read_table(Path(__file__).parents[1] / "data" / "collections" / "feet_and_bases.csv")


@pytest.mark.parametrize("name", sorted({row["class"] for row in RECORDED}))
def test_assumed_bases_are_those_of_recorded_things(name: str) -> None:
    """The bases of a museum none of whose were used for the table: most are within, half on either side of the best."""
    row = next(row for row in table("classes") if row["class"] == name)
    best, low, high = (float(row[f"base_{end}"]) for end in ("ratio", "low", "high"))
    kept = [one for one in RECORDED if one["class"] == name and one["kept_back"]]
    shares = np.array([min(1.0, float(one["base_cm"]) / float(one["narrowest_cm"])) for one in kept])
    assert shares.size >= 4
    assert np.mean((shares >= low) & (shares <= high)) >= 0.8
    assert best == pytest.approx(np.median(shares), rel=0.2)


def test_beakers_stand_on_the_foot_that_they_have() -> None:
    """Thirty-eight of the Metropolitan Museum and Williams College; what bears of a rounded rim is a little less."""
    feet = [one for one in RECORDED if one["object"] == "beaker"]
    shares = np.array([min(1.0, float(one["base_cm"]) / float(one["narrowest_cm"])) for one in feet])
    row = next(row for row in table("bodies") if row["body"] == "beaker")
    best, low, high = (float(row[f"base_{end}"]) for end in ("ratio", "low", "high"))
    assert shares.size == 38
    assert 0.95 <= best / np.median(shares) <= 1.0
    assert np.mean((shares >= low) & (shares <= high)) >= 0.95
    beaker = Item("1", "G", object_name="beaker", medium="glass", height_m=0.11, width_m=0.08, depth_m=0.08)
    half = classify(beaker).parameters["half_width"]
    assert (half.low, half.value, half.high) == pytest.approx((0.04 * low, 0.04 * best, 0.04 * high))
    # A bell beaker of the Bronze Age has its name from its mouth.
    bell = classify(replace(beaker, title="Bell beaker", medium="earthenware")).parameters["half_width"]
    assert bell.value < 0.7 * half.value


def test_casters_are_known_by_words_before_the_class() -> None:
    cabinet = replace(STAND, object_name="cabinet")
    feet, casters = bearing_of(cabinet, "cabinet"), bearing_of(replace(cabinet, title="Display on Casters"), "cabinet")
    assert feet is not None
    assert casters is not None
    assert (feet.contact, casters.contact) == ("feet", "casters")


def test_what_was_measured_of_a_base_bears_as_measured() -> None:
    assumed = classify(STAND).parameters["half_width"]
    assert assumed.low < 0.5 * assumed.value
    measured = classify(replace(STAND, base_width_m=0.2, base_depth_m=0.24)).parameters["half_width"]
    assert (measured.low, measured.value, measured.high) == (0.1, 0.1, 0.1)
