"""What is at stake: weights by hand from tables/stakes.csv, and the danger of a fall by its closed form."""

from dataclasses import replace
from math import exp

import pytest

from pipeline.analysis.classify import classify
from pipeline.analysis.stakes import (
    Term,
    counting,
    danger_of,
    doubtful,
    expected_loss,
    ill_weighed,
    stakes,
    value_of,
    worth_of,
)
from pipeline.records import Assessment, Band, Estimate, Furniture, Item, Likelihood, Origin, Problem, Scene, Support
from tests.museum import VASE

G = 9.80665
"""Standard gravity, m/s2 (CGPM 1901)."""


def scene(
    furniture: Furniture | None = Furniture.FLOOR, mass: float = 1.0, cg: float | None = 0.2, **item: object
) -> Scene:
    """An object whose mass [kg] and height of the centre of gravity [m] are known."""
    numbers = {"mass": Estimate(mass, "kg", Origin.MEASURED, mass, mass)}
    if cg is not None:
        numbers["cg_height"] = Estimate(cg, "m", Origin.MEASURED, cg, cg)
    return Scene(
        Item("1", "G", **item),  # type: ignore[arg-type]
        "vessel", "", Support.FREESTANDING, (), numbers, furniture=furniture,
    )  # fmt: skip


@pytest.mark.parametrize(
    ("recorded", "weight"),
    [
        ({}, 2.0),
        ({"value_class": "A"}, 10.0),
        ({"value_class": " b "}, 3.0),
        ({"value_class": "C"}, 1.0),
        ({"value_class": "treasure"}, 2.0),
        ({"irreplaceable": True}, 6.0),
        ({"irreplaceable": False, "on_loan": False}, 2.0),
        ({"value_class": "A", "irreplaceable": True, "on_loan": True}, 60.0),
        ({"value": 50_000.0}, 5.0),
        ({"value": 50_000.0, "value_class": "A"}, 5.0),
        ({"value": 0.0}, 0.1),
        ({"value": 1e12}, 100.0),
        ({"value": 1e12, "irreplaceable": True, "on_loan": True}, 600.0),
    ],
    ids=str,
)
def test_weights_are_the_products_of_the_tables_rows(recorded: dict[str, object], weight: float) -> None:
    """A is 10, B 3, C 1, nothing said 2; irreplaceable thrice, on loan twice; 10,000 of money is one C, 0.1 to 100."""
    assert value_of(scene(**recorded)) == pytest.approx(weight, rel=1e-12)


def test_the_museum_says_what_its_money_is() -> None:
    valued = scene(value=1_500_000.0)
    with counting(500_000.0):
        assert value_of(valued) == pytest.approx(3.0, rel=1e-12)
        with counting(0.0):
            assert value_of(valued) == 100.0
        assert value_of(valued) == pytest.approx(3.0, rel=1e-12)
    assert value_of(valued) == 100.0


def test_what_the_weight_rests_on_is_told() -> None:
    every = scene(value_class="A", irreplaceable=True, on_loan=True)
    assert worth_of(every).terms == (Term.CLASS, Term.IRREPLACEABLE, Term.ON_LOAN)
    assert worth_of(replace(every, item=replace(every.item, value=1.0))).terms[0] is Term.VALUE
    assert worth_of(scene(value_class="treasure", irreplaceable=False)).terms == ()


@pytest.mark.parametrize(
    ("furniture", "share", "top"),
    [
        (None, 1.0, 0.0),
        (Furniture.FLOOR, 1.0, 0.0),
        (Furniture.PEDESTAL, 1.0, 1.0),
        (Furniture.SHELF, 1.0, 1.2),
        (Furniture.SHOWCASE, 0.1, 1.0),
    ],
)
def test_danger_is_the_energy_of_the_fall_to_the_floor(furniture: Furniture | None, share: float, top: float) -> None:
    """Heights of furniture.csv; 10 counts a person, 79 J is what endangers one; a closed case keeps nine of ten."""
    expected = share * 10.0 * (1.0 - exp(-2.0 * G * (0.2 + top) / 79.0))
    assert danger_of(scene(furniture, mass=2.0)) == pytest.approx(expected, rel=1e-12)


def test_the_shelf_of_furniture_that_is_known_counts_and_what_hangs_falls_from_the_height_of_eyes() -> None:
    known = scene(Furniture.PEDESTAL)
    shelf = Estimate(0.4, "m", Origin.STATED, 0.4, 0.4)
    known = replace(known, parameters={**known.parameters, "shelf_height": shelf})
    assert danger_of(known) == pytest.approx(10.0 * (1.0 - exp(-G * 0.6 / 79.0)), rel=1e-12)
    hung = scene(Furniture.WALL, cg=None)
    assert danger_of(hung) == pytest.approx(10.0 * (1.0 - exp(-G * 1.5 / 79.0)), rel=1e-12)


def test_the_same_vase_endangers_more_people_from_a_pedestal_than_from_the_floor_and_few_from_a_case() -> None:
    """Through the classification, as a night does it."""
    danger = {
        furniture: danger_of(classify(replace(VASE, mass_kg=4.0, furniture=furniture)))
        for furniture in (Furniture.FLOOR, Furniture.PEDESTAL, Furniture.SHOWCASE)
    }
    assert danger[Furniture.SHOWCASE] < danger[Furniture.FLOOR] < danger[Furniture.PEDESTAL] < stakes()["person"].value


def test_the_expected_loss_is_the_sum_over_harm_and_over_the_fall() -> None:
    found = Likelihood("rare", 0.5, 0.01, 512, Band.LIKELY, "falls", {"falls": 0.3, "rocks": 0.2})
    one = Assessment(scene(Furniture.PEDESTAL, mass=3.0, value_class="A", on_loan=True), (), (), likelihoods=(found,))
    danger = 10.0 * (1.0 - exp(-3.0 * G * 1.2 / 79.0))
    assert expected_loss(one) == pytest.approx(0.5 * 20.0 + 0.3 * danger, rel=1e-12)


def test_every_row_of_the_table_says_what_it_may_be() -> None:
    for name, row in stakes().items():
        assert row.low <= row.value <= row.high, name


@pytest.mark.parametrize(
    ("name", "sizes", "times"),
    [
        # Carnegie 93.117: a diameter of 1.25 in for, probably, 10.25 in.
        ("Punch bowl", (0.1143, 0.03175, 0.03175), 3.6),
        ("Covered Bowl", (0.130175, 0.130175, 0.0762), 0.0),
        # A platter on its edge, or with its sides exchanged.
        ("Platter", (0.66675, 0.55245, 0.06985), 9.5),
        ("Bottle", (0.3, 0.08, 0.08), 0.0),
        ("Bottle", (0.6, 0.08, 0.08), 7.5),
    ],
)
def test_what_no_such_thing_is_as_slender_as_has_a_doubtful_record(
    name: str, sizes: tuple[float, float, float], times: float
) -> None:
    height, width, depth = sizes
    item = replace(VASE, title=name, height_m=height, width_m=width, depth_m=depth)
    assert doubtful(classify(item)) == pytest.approx(times, abs=0.06)
    # Who has measured its base has looked at it.
    assert doubtful(classify(replace(item, base_width_m=0.03))) == 0.0


CARNEGIE_CLOCKS = ((94.5, 17.0, 10.5), (100.5, 22.125, 11.125), (86.125, 30.0, 16.0), (95.0, 19.5, 10.5),
                   (93.5, 22.0, 11.125))  # fmt: skip
"""Height, width and depth [inches] of the five tall case clocks of the Carnegie Museum of Art (open data, CC0)."""


@pytest.mark.parametrize("inches", CARNEGIE_CLOCKS, ids=str)
def test_real_longcase_clocks_stand_as_they_are_recorded(inches: tuple[float, ...]) -> None:
    """They stand, and are slender enough to fall: that is no reason to doubt their sizes."""
    height, width, depth = (0.0254 * side for side in inches)
    clock = Item("1", "G", title="Tall case clock", object_name="clock", medium="mahogany, brass", height_m=height,
                 width_m=width, depth_m=depth)  # fmt: skip
    scene = classify(clock)
    assert scene.missing == ()
    assert doubtful(scene) == 0.0
    # A mantel clock of these proportions, and one whose depth lost a digit, are doubted still.
    assert doubtful(classify(replace(clock, height_m=0.3, width_m=0.1, depth_m=0.035))) > 0.0
    assert classify(replace(clock, depth_m=0.1 * depth)).missing != ()


def test_a_mobile_weighs_as_little_as_it_does() -> None:
    light = Problem("mass_kg", "6 kg in a box of 1.5 x 2 x 2 m is 1 kg/m3", "weigh it again")
    mobile = Item("1", "G", title="Red mobile", object_name="mobile", medium="painted sheet metal, wire",
                  height_m=1.5, width_m=2.0, depth_m=2.0, mass_kg=6.0, problems=(light,))  # fmt: skip
    assert not ill_weighed(classify(mobile))
    assert ill_weighed(classify(replace(mobile, object_name="sculpture", title="Bronze figure")))
