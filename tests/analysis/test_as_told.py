"""What the rest of a record tells of how a thing is held goes before what its class usually does."""

from dataclasses import replace
from pathlib import Path

import pytest

from pipeline.analysis.classify import classify, object_classes
from pipeline.analysis.house.matching import HouseRules
from pipeline.analysis.house.rule import HouseRule
from pipeline.analysis.stakes import doubtful, ill_weighed, to_check
from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import read_items
from pipeline.mitigate.installed import InstalledMeasure, placed
from pipeline.records import (
    UNTOLD_ISOLATOR,
    Assessment,
    Band,
    Furniture,
    Hanging,
    Item,
    Likelihood,
    Mount,
    Support,
)

STELE = Item("1", "East", object_name="stele", medium="marble", height_m=1.8, width_m=0.6, depth_m=0.15)
HARP = Item("2", "East", object_name="harp", medium="maple", height_m=1.75, width_m=0.9, depth_m=0.4)
SHELVES = Item("3", "East", object_name="cabinet", medium="mahogany", height_m=2.2, width_m=0.5, depth_m=0.23)
KOUROS = Item("4", "East", object_name="statue", medium="marble", height_m=1.9, width_m=0.6, depth_m=0.5, mass_kg=600.0)
SPRINGS = {"frequency": 0.5, "damping": 0.02, "friction": 0.05, "stroke": 0.3}


@pytest.mark.parametrize("item", [STELE, HARP, SHELVES], ids=lambda item: item.object_name)
def test_what_has_a_footing_that_was_measured_stands_on_it(item: Item) -> None:
    """A slab that hangs, a thing that a mount holds and one that is ten times as high as deep: each tips at b/h."""
    scene = classify(replace(item, base_width_m=0.4, base_depth_m=0.2, cg_height_m=0.9, furniture=Furniture.FLOOR))
    assert (scene.support, scene.missing) == (Support.FREESTANDING, ())
    assert scene.mount in (None, Mount.STANDING)
    assert "standing" in scene.models
    assert scene.parameters["half_width"].value / scene.parameters["cg_height"].value == pytest.approx(0.1 / 0.9)
    assert scene.assumptions[0] == "support: freestanding, as its record says on what it stands"


def test_without_a_footing_it_is_taken_as_such_things_are() -> None:
    assert classify(STELE).support is Support.HUNG
    # What is as tall and as deep as a harp has a foot of its own; what is smaller is held by a mount.
    assert classify(HARP).mount is Mount.STANDING
    assert classify(replace(HARP, height_m=0.6, width_m=0.4, depth_m=0.2)).mount is Mount.UNKNOWN
    assert "cannot stand by itself" in classify(SHELVES).missing[0]


def test_what_usually_hangs_and_stands_on_furniture_by_its_record_does_not_hang() -> None:
    on_plinth = classify(replace(STELE, furniture=Furniture.PEDESTAL))
    assert on_plinth.support is Support.FREESTANDING
    # A block of one stone stands on its whole foot, a relief on its edge as deep as it is; else that is to be measured.
    assert on_plinth.missing == ()
    carved = replace(STELE, object_name="relief", medium="wood", furniture=Furniture.PEDESTAL)
    assert classify(carved).missing == ()
    assert classify(replace(carved, depth_m=None)).missing == ("base width", "base depth")
    # A thing that the record hangs, hangs.
    hooked = classify(replace(STELE, hanging=Hanging.TWO_HOOKS, base_width_m=0.6))
    assert hooked.support is Support.HUNG


def test_a_house_rule_goes_before_what_a_footing_tells() -> None:
    rule = {"gallery": "East", "held": "fastened", "said_by": "A", "said_on": "2031-05-01"}
    house = HouseRules([HouseRule.model_validate(rule)], sorted(object_classes()))
    assert classify(replace(STELE, base_width_m=0.6, base_depth_m=0.15), house=house).support is Support.FASTENED


@pytest.mark.parametrize("support", [None, Support.ISOLATED])
@pytest.mark.parametrize("isolator", ["generic 0.5 Hz, friction 0.05", "horizontal_isolator", "the Getty's"])
def test_an_isolator_without_numbers_is_asked_for(support: Support | None, isolator: str) -> None:
    """It is not judged as if the floor shook it: it cannot be assessed, until the isolator is written down."""
    scene = classify(replace(KOUROS, support=support, isolator=isolator))
    assert (scene.support, scene.missing) == (Support.ISOLATED, (UNTOLD_ISOLATOR,))
    there = placed(scene, [InstalledMeasure("horizontal_isolator", SPRINGS, "decided by Ann")])
    assert there.scene.support is Support.ISOLATED
    assert there.scene.models == ("horizontal_isolator",)
    assert there.scene.missing == ()
    # What stands on it is what would stand there if its record said nothing of an isolator.
    bare = placed(classify(KOUROS), [InstalledMeasure("horizontal_isolator", SPRINGS, "decided by Ann")])
    assert there.above is not None
    assert bare.above is not None
    assert there.above.models == bare.above.models
    assert there.above.parameters == bare.above.parameters
    assert there.above.missing == ()


def test_a_low_friction_pad_whose_friction_is_recorded_is_computed() -> None:
    scene = classify(replace(KOUROS, isolator="friction_isolator", friction=0.05, clearance_m=0.3))
    assert (scene.support, scene.missing) == (Support.ISOLATED, ())
    assert "friction_isolator" in scene.models


@pytest.mark.parametrize(
    "item",
    [
        Item("5", "East", object_name="coin", medium="silver", height_m=0.024, width_m=0.024, depth_m=0.004),
        Item("6", "East", object_name="spoon", medium="silver", height_m=0.23, width_m=0.04, depth_m=0.02),
        Item("7", "East", object_name="sword", medium="steel", height_m=1.0, width_m=0.1, depth_m=0.05),
    ],
    ids=lambda item: item.object_name,
)
def test_the_record_of_what_lies_or_is_held_is_not_doubted_for_its_slenderness(item: Item) -> None:
    assert doubtful(classify(item)) == 0.0


def test_the_record_of_what_would_have_to_stand_on_its_edge_is() -> None:
    assert doubtful(classify(Item("8", "East", object_name="vase", height_m=0.4, width_m=0.3, depth_m=0.05))) == 8.0


def test_a_weight_that_does_not_go_with_the_size_is_to_be_checked_before_anything_is_built(tmp_path: Path) -> None:
    """A cube of bronze of a metre weighs 8.7 t; of 0.5 kg somebody mistook a unit.  A hollow cast of 300 kg is none."""
    path = tmp_path / "export.csv"
    path.write_text(
        "object_number,gallery,object_name,medium,height_m,width_m,depth_m,mass_kg\n"
        "1,G,sculpture,bronze,1,1,1,0.5\n2,G,sculpture,bronze,1,1,1,300\n"
    )
    wrong, right = read_items(path, load_mapping("kouros")).items
    assert ill_weighed(classify(wrong))
    assert not ill_weighed(classify(right))
    possible = Likelihood("design", 0.2, 0.01, 64, Band.POSSIBLE, "falls", {"falls": 0.2})
    assert to_check(Assessment(classify(wrong), (), (), likelihoods=(possible,)))
    assert not to_check(Assessment(classify(right), (), (), likelihoods=(possible,)))


def test_a_slab_that_is_made_fast_is_judged_as_thick_as_it_is() -> None:
    """Its section is 0.95 of its width and its depth (bodies.csv), of modulus W D^2 / 6."""
    strapped = classify(replace(STELE, support=Support.FASTENED, base_width_m=0.6, base_depth_m=0.15, mass_kg=437.0))
    assert strapped.missing == ()
    assert strapped.parameters["section_modulus"].value == pytest.approx(0.95**3 * 0.6 * 0.15**2 / 6.0)


@pytest.mark.parametrize("case", ["case 8", "Vitrine 3", "case 10, shelf 2"])
@pytest.mark.parametrize("name", ["miniature painting", "icon", "relief"])
def test_what_would_hang_is_held_by_a_mount_where_its_record_names_a_case(name: str, case: str) -> None:
    """It moves with the case, and nobody says how it is held there; "North wall" in that field names none."""
    item = Item("5", "East", object_name=name, height_m=0.3, width_m=0.2, depth_m=0.02)
    cased = classify(replace(item, case=case))
    assert (cased.support, cased.mount, cased.missing) == (Support.FREESTANDING, Mount.UNKNOWN, ())
    assert cased.furniture in (Furniture.SHOWCASE, Furniture.SHELF)
    assert classify(replace(item, case=case, height_m=0.06, width_m=0.05)).mount is Mount.LYING
    recorded = classify(replace(item, furniture=Furniture.SHOWCASE))
    assert (recorded.support, recorded.mount) == (Support.FREESTANDING, Mount.UNKNOWN)
    for hung in (item, replace(item, case="North wall"), replace(item, case=case, support=Support.HUNG)):
        assert classify(hung).support is Support.HUNG
