"""What is told of room, of mats and of braces: truths of the field, written before the answers were seen."""

from dataclasses import replace

import pytest

from pipeline.analysis.assess import assess
from pipeline.analysis.classify import classify
from pipeline.analysis.context import Context
from pipeline.analysis.verdicts import LevelMotions
from pipeline.execute import Threads
from pipeline.mitigate import advise
from pipeline.mitigate.saying import OF_MEAN
from pipeline.models import MODELS
from pipeline.quantities import G
from pipeline.records import Furniture, Item, Recommendation, Support
from pipeline.report.pages.plainly import full_measure
from pipeline.tables.assumed import assumed
from tests.analysis.test_likelihood import pulse

BOX = Item("1", "East", title="Box", object_name="box", medium="wood", height_m=0.3, width_m=0.6, depth_m=0.6,
           base_width_m=0.6, base_depth_m=0.6, cg_height_m=0.1, mass_kg=20.0, friction=0.3, clearance_m=0.001,
           furniture=Furniture.FLOOR)  # fmt: skip
COIN = Item("2", "East", title="Coin", object_name="coin", medium="silver", height_m=0.002, width_m=0.03, depth_m=0.03,
            friction=0.2, clearance_m=0.001, furniture=Furniture.FLOOR)  # fmt: skip


def advised(item: Item, combine: str, *times: float) -> Recommendation:
    level = LevelMotions("design", combine, tuple(pulse(one * G, 0.5) for one in times))
    scene = classify(item)
    _, findings = assess([scene], [level], Context(Threads(1)))
    ((advice,),) = advise([scene], findings, [level], Context(Threads(1)))
    return advice


def test_room_for_a_mean_says_that_one_earthquake_asks_more() -> None:
    mean, most = advised(BOX, "mean", 0.32, 0.38), advised(BOX, "max", 0.32, 0.38)
    assert mean.measure == most.measure == "clearance"
    assert OF_MEAN in mean.sentence
    assert OF_MEAN not in most.sentence
    # The largest of two that differ is above their mean.
    assert mean.parameters["clearance"] < most.parameters["clearance"]
    # What it moves in the worse of the two is what the largest of both is sized by.
    assert mean.parameters["worst"] == pytest.approx(most.parameters["movement"], rel=1e-2)
    assert mean.parameters["worst"] > mean.parameters["movement"]
    # The mean of one is that one.
    assert OF_MEAN not in advised(BOX, "mean", 0.38).sentence


def test_no_sentence_of_a_demand_says_up_to() -> None:
    """The demand of a level may be a mean."""
    assert [model.name for model in MODELS if "up to {demand}" in model.sentence] == []


def test_what_lies_gets_a_mat_and_no_room() -> None:
    assert advised(COIN, "max", 0.35).measure == "grip_pad"


def test_what_lies_in_a_case_has_more_room_than_what_stands() -> None:
    """Judgement: sliding alone does it no harm."""
    classes = assumed().classes
    lies, stands = classes["small_flat"].room, classes["figurine"].room
    assert lies is not None
    assert stands is not None
    assert lies.low > stands.value


def test_a_few_grams_are_not_held_hundreds_of_times() -> None:
    sentence = "It holds {margin} times what is needed ({force} sideways)."
    one = Recommendation("1", "East", "design", "wax", "Wax", sentence, {"margin": 340.0}, {"margin": "-"}, ())
    assert full_measure(one) == "It holds more than 20 times what is needed ({force} sideways)."
    assert full_measure(replace(one, parameters={"margin": 4.0})) == sentence


@pytest.mark.parametrize(
    ("medium", "material"),
    [("Carved polystyrene foam, paint", "foam"), ("polyurethane foam", "foam"), ("Styropor", "foam"),
     ("cast polyurethane", "plastic"), ("fiberglass and polystyrene", "fibreglass")],
)  # fmt: skip
def test_foam_is_lighter_than_any_plastic(medium: str, material: str) -> None:
    found = assumed().material_in(medium)
    assert found is not None
    assert found.name == material
    # Ashby 2011, Appendix A: rigid polymer foams from 36 kg/m3 on, the densest below 500.
    assert material != "foam" or found.density_high < 500.0


def test_what_is_fastened_can_be_braced_above_its_middle() -> None:
    """12.3 MPa under 1 g, of 7 allowed; half at most of the bending remains with the brace."""
    stele = Item("3", "East", title="Stele", object_name="stele", medium="marble", height_m=1.8, width_m=0.6,
                 depth_m=0.15, base_width_m=0.6, base_depth_m=0.15, cg_height_m=0.9, mass_kg=437.0,
                 section_width_m=0.6, section_depth_m=0.056, allowable_stress_pa=7e6,
                 support=Support.FASTENED, furniture=Furniture.FLOOR)  # fmt: skip
    assert advised(stele, "max", 1.0).measure == "brace"
