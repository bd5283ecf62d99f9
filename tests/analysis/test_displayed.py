"""How a thing is displayed, in museums' words: what they tell of support, furniture, hanging and mount."""

from dataclasses import replace

import pytest

from pipeline.analysis.classify import classify
from pipeline.analysis.told import as_displayed
from pipeline.records import Anchorage, Furniture, Hanging, Item, Mount, Origin, Support
from pipeline.tables.held_rows import HeldAs, told_by

PLANE = Item("1", "Hall", object_name="aeroplane", title="Biplane", medium="wood, fabric", height_m=2.25,
             width_m=7.4, depth_m=6.6, mass_kg=390.0)  # fmt: skip
PLATE = Item("2", "Hall", object_name="plate", medium="earthenware", height_m=0.04, width_m=0.35, depth_m=0.35)
BUST = Item("3", "Hall", object_name="bust", medium="marble", height_m=0.68, width_m=0.48, depth_m=0.28)


@pytest.mark.parametrize(
    ("words", "told"),
    [
        ("suspended from ceiling by steel cables", HeldAs(Support.SUSPENDED, None, Furniture.RAIL)),
        ("hängt von der Decke", HeldAs(Support.SUSPENDED, None, Furniture.RAIL)),
        ("suspendu au plafond", HeldAs(Support.SUSPENDED, None, Furniture.RAIL)),
        ("screwed to the wall", HeldAs(Support.HUNG, Hanging.FIXED)),
        ("on wall with Velcro on a batten", HeldAs(Support.HUNG, Hanging.FIXED)),
        ("hung by chains from a picture rail", HeldAs(Support.HUNG, Hanging.WIRE)),
        ("an der Wand", HeldAs(Support.HUNG)),
        ("on a wall bracket", HeldAs(Support.FREESTANDING, None, Furniture.SHELF)),
        ("strapped to a steel brace at its back", HeldAs(Support.FASTENED, None, None, None, Mount.SECURED)),
        ("fixed in a concrete footing", HeldAs(Support.FASTENED)),
        ("on plate stand on shelf", HeldAs(Support.FREESTANDING, None, Furniture.SHELF, None, Mount.LEANING)),
        ("apoyado en la pared", HeldAs(Support.FREESTANDING, None, None, None, Mount.LEANING)),
        ("appoggiata su piedistallo", HeldAs(Support.FREESTANDING, None, Furniture.PEDESTAL)),
        ("appoggiati alla parete", HeldAs(Support.FREESTANDING, None, None, None, Mount.LEANING)),
        ("appoggiato su leggio", HeldAs(Support.FREESTANDING, None, None, None, Mount.LEANING)),
        ("apoyada sobre peana", HeldAs(Support.FREESTANDING, None, Furniture.PEDESTAL)),
        ("posé sur un socle en marbre", HeldAs(Support.FREESTANDING, None, Furniture.PEDESTAL)),
        ("Case 12, glass shelf 3", HeldAs(None, None, Furniture.SHOWCASE)),
        ("in drawer", HeldAs(None, None, None, None, Mount.LYING)),
        ("standing on a mannequin with wooden base", HeldAs(Support.FREESTANDING)),
        ("lying in showcase", HeldAs(None, None, Furniture.SHOWCASE, None, Mount.LYING)),
        ("bust standing loose on its column", HeldAs(Support.FREESTANDING, None, Furniture.PEDESTAL,
                                                   Anchorage.UNANCHORED)),
        ("on wooden floor", HeldAs(Support.FREESTANDING, None, Furniture.FLOOR)),
        ("in showcase", HeldAs(None, None, Furniture.SHOWCASE)),
        ("third floor, room 3", HeldAs()),
        ("", HeldAs()),
    ],
)  # fmt: skip
def test_words_of_display(words: str, told: HeldAs) -> None:
    assert told_by(words) == told


def with_words(item: Item, words: str) -> Item:
    return replace(item, displayed=words)


def test_what_hangs_from_the_ceiling_swings() -> None:
    scene = classify(with_words(PLANE, "suspended from ceiling by steel cables"))
    assert (scene.support, scene.models) == (Support.SUSPENDED, ("swing_3d",))
    assert scene.furniture is Furniture.RAIL
    assert any("as its record says of its display" in note for note in scene.assumptions)


def test_a_title_that_says_that_a_large_thing_hangs_is_believed() -> None:
    dinghy = Item("4", "Stairwell", object_name="dinghy", title="Clinker dinghy suspended above stairs", medium="wood",
                  height_m=0.9, width_m=1.4, depth_m=3.6)  # fmt: skip
    scene = classify(dinghy)
    assert scene.support is Support.SUSPENDED
    assert classify(replace(dinghy, title="Clinker dinghy")).support is Support.FREESTANDING
    assert classify(replace(dinghy, furniture=Furniture.FLOOR)).support is Support.FREESTANDING
    pendant = replace(dinghy, object_name="pendant", height_m=0.05, width_m=0.03, depth_m=0.01)
    assert classify(pendant).support is not Support.SUSPENDED


@pytest.mark.parametrize(
    ("name", "words", "support"),
    [
        ("chandelier", "appeso a catena", Support.SUSPENDED),
        ("chandelier", "by chains from a bracket on the wall", Support.HUNG),
        ("painting", "by chains", Support.HUNG),
    ],
)
def test_chains_alone_hold_a_chandelier_from_above(name: str, words: str, support: Support) -> None:
    item = Item("5", "Staircase", object_name=name, height_m=1.8, width_m=1.3, displayed=words)
    scene = classify(item)
    assert scene.support is support
    assert (scene.models == ("swing_3d",)) is (support is Support.SUSPENDED)


def test_a_plate_on_a_stand_leans_and_one_in_a_case_lies() -> None:
    """It comes away from what it leans on where the push exceeds g times the tangent of its lean, 8 to 25 degrees."""
    leaning, lying = classify(with_words(PLATE, "on plate stand")), classify(with_words(PLATE, "in showcase"))
    assert leaning.mount is Mount.LEANING
    assert lying.mount is None
    slope = leaning.parameters["half_width"].value / leaning.parameters["cg_height"].value
    assert 0.14 < slope < 0.47
    assert slope < lying.parameters["half_width"].value / lying.parameters["cg_height"].value


def test_what_is_strapped_is_to_be_recorded_as_installed() -> None:
    scene = classify(with_words(BUST, "strapped to a steel brace at its back"))
    assert scene.support is Support.FASTENED
    assert "recorded as installed" in scene.assumptions[0]


def test_a_record_goes_before_its_words() -> None:
    item = replace(with_words(BUST, "on stone floor"), furniture=Furniture.PEDESTAL, support=Support.FASTENED)
    told = as_displayed(item)
    assert (told.furniture, told.support) == (Furniture.PEDESTAL, Support.FASTENED)
    assert told.surface_material == "stone"


def test_a_surface_told_by_its_display_is_that_of_its_friction() -> None:
    friction = classify(with_words(BUST, "on stone floor")).parameters["friction_static"]
    assert friction.origin is Origin.ASSUMED
    assert (friction.low, friction.value, friction.high) == (0.15, 0.55, 0.85)


@pytest.mark.parametrize(
    "words",
    [
        "on plinth, not fixed",
        "not bolted to its plinth",
        "nicht befestigt auf dem Sockel",
        "nicht an der Wand befestigt",
        "must be clamped to the plinth",
        "to be strapped",
        "formerly screwed to the wall, now on a pedestal",
        "doit être fixé au socle",
        "non fissato, su plinto",
        "sin fijar, sobre peana",
        "ohne Befestigung in der Vitrine",
        "no longer bolted",
        "unstrapped",
        "固定されていない",
    ],
)
def test_what_is_not_so_or_only_meant_to_be_holds_nothing(words: str) -> None:
    told = told_by(words)
    assert told.support in (None, Support.FREESTANDING)
    assert told.mount is None


@pytest.mark.parametrize(
    "words", ["bolted to the floor", "vissé au socle", "fissato al plinto", "台座に固定", "strapped to its stand"]
)
def test_what_is_so_holds(words: str) -> None:
    assert told_by(words).support is Support.FASTENED


def test_a_showcase_stays_one_where_nothing_holds_what_is_in_it() -> None:
    assert told_by("in showcase, not fixed").furniture is Furniture.SHOWCASE
