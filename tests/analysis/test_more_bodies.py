"""Footings, weights and lines of what is neither a block nor a vessel: tripods, stands, panels, books, eggs."""

from __future__ import annotations

from dataclasses import replace
from math import cos, pi

import pytest

from pipeline.analysis.classify import classify
from pipeline.analysis.told import line_of
from pipeline.records import Furniture, Item, Mount, Support
from pipeline.report.pages.scene_words import what_it_is
from pipeline.tables.assumed import assumed
from pipeline.tables.body_rows import body_told
from pipeline.tables.limit_rows import limit

TELESCOPE = Item("1", "G", "Refracting telescope on its tripod", object_name="telescope", medium="brass, glass",
                 height_m=1.75, width_m=1.2, depth_m=1.2, displayed="on floor")  # fmt: skip
DING = Item("2", "G", "Ding", object_name="tripod vessel", medium="bronze", height_m=0.38, width_m=0.3, depth_m=0.3,
            displayed="in showcase")  # fmt: skip
SHIELD = Item("3", "G", "War shield", object_name="shield", medium="wood", height_m=1.85, width_m=0.52, depth_m=0.08,
              displayed="on a steel stand on low platform")  # fmt: skip


def test_three_feet_tip_about_half_their_radius() -> None:
    """Between two of three points on a circle of radius r the chord is r cos(60 degrees) from its middle."""
    scene, radius = classify(TELESCOPE), 0.6
    assert scene.parameters["half_width"].value == pytest.approx(radius * cos(pi / 3.0))
    tripod, plain = (
        classify(replace(DING, object_name=name)).parameters["half_width"] for name in ("tripod vessel", "vessel")
    )
    # The feet of a vessel may stand as wide as its body, or half as wide.
    assert tripod.low <= 0.5 * 0.15 * cos(pi / 3.0) * 2.0 <= 0.15 * cos(pi / 3.0) <= tripod.high
    assert tripod.value < plain.value


def test_a_telescope_on_a_tripod_weighs_what_two_people_carry() -> None:
    mass = classify(TELESCOPE).parameters["mass"]
    assert 20.0 < mass.value < 80.0
    assert mass.high < 250.0


def test_a_flat_thing_on_a_stand_stands_on_the_stand() -> None:
    """Eight centimetres of wood two metres high would fall by a breath: whoever made the stand saw to that."""
    half = classify(SHIELD).parameters["half_width"]
    assert half.low > 0.5 * 0.08
    deep = classify(replace(SHIELD, depth_m=0.6)).parameters["half_width"]
    assert deep.high <= 0.5 * 0.6


def test_what_hangs_by_class_and_stands_by_its_record_stands_on_its_depth() -> None:
    altar = Item("4", "G", "Winged altarpiece", object_name="altarpiece", medium="carved limewood", height_m=2.9,
                 width_m=3.4, depth_m=0.38, displayed="standing on floor")  # fmt: skip
    scene = classify(altar)
    assert (scene.support, scene.missing) == (Support.FREESTANDING, ())
    assert scene.parameters["half_width"].high == pytest.approx(0.19)
    assert "base depth" in classify(replace(altar, depth_m=None)).missing


def test_who_sits_is_lower_and_wider_than_who_stands() -> None:
    stands, sits = (
        Item("5", "G", f"{how} Buddha", object_name="sculpture", medium="sandstone", height_m=1.05, width_m=0.82,
             depth_m=0.46) for how in ("Standing", "Seated")
    )  # fmt: skip
    one, other = classify(stands).parameters, classify(sits).parameters
    assert other["cg_height"].value < one["cg_height"].value
    assert other["half_width"].low > one["half_width"].low
    # What it weighs is still said by class and material.
    assert other["mass"].value == pytest.approx(classify(replace(sits, title="Buddha")).parameters["mass"].value)


@pytest.mark.parametrize(
    ("words", "metres"),
    [
        ("suspended from the ceiling by six steel cables of 3 m", 3.0),
        ("hangs by a chain of 2,5 m", 2.5),
        ("on 40 cm chains from the ceiling", 0.4),
        ("an einer Kette von 2 m", 2.0),
        ("suspendu par un câble de 12 m", 12.0),
        ("by a 6 ft rope", 1.8288),
        ("by steel cable of 6 mm", None),
        ("from the ceiling, 3 m above the floor", None),
        ("by steel wires", None),
    ],
)
def test_how_long_a_line_is(words: str, metres: float | None) -> None:
    assert line_of(words) == (None if metres is None else pytest.approx(metres))


def test_a_line_that_is_told_goes_before_one_that_is_guessed() -> None:
    """To the middle of the thing: the line, and as much of the thing itself as there may be above that."""
    lamp = Item("6", "G", "Chandelier", object_name="chandelier", medium="brass", height_m=1.0, width_m=0.8,
                depth_m=0.8, displayed="suspended by a chain of 2 m")  # fmt: skip
    length = classify(lamp).parameters["length"]
    assert (length.low, length.value, length.high) == pytest.approx((2.0, 2.5, 3.0))
    assert classify(replace(lamp, suspension_length_m=1.2)).parameters["length"].value == 1.2


def test_books_in_a_row_have_the_room_of_their_shelf() -> None:
    row = Item("7", "G", "Encyclopaedia, 35 volumes", object_name="book", medium="paper, leather", height_m=0.28,
               width_m=1.8, depth_m=0.21, displayed="on bookshelf")  # fmt: skip
    scene, room = classify(row), limit("book_room")
    assert scene.furniture is Furniture.SHELF
    assert scene.parameters["clearance"].value == room.value
    for words in ("standing in a row on shelf", "in Reihe im Regal"):
        assert classify(replace(row, displayed=words)).parameters["clearance"].value == room.value
    assert classify(replace(row, displayed="lying in showcase")).parameters["clearance"].value > room.value


def test_what_lies_in_a_ring_rests_and_a_disc_on_a_stand_leans() -> None:
    egg = Item("8", "G", "Egg of an elephant bird", object_name="egg", medium="eggshell", height_m=0.31, width_m=0.22,
               depth_m=0.22, displayed="on an acrylic ring in showcase")  # fmt: skip
    disc = Item("9", "G", "Bi disc", object_name="disc", medium="jade", height_m=0.26, width_m=0.26, depth_m=0.014,
                displayed="on a stand in showcase")  # fmt: skip
    assert classify(egg).mount is Mount.RESTING
    assert classify(disc).mount in (Mount.LEANING, Mount.UNKNOWN)
    assert classify(replace(egg, displayed="on pedestal")).mount is not Mount.RESTING


@pytest.mark.parametrize("medium", ["granodiorite", "diorite", "Porphyr", "greywacke", "travertino", "玄武岩"])
def test_stones_are_stone(medium: str) -> None:
    found = assumed().material_in(medium)
    assert found is not None
    assert found.name == "stone"


def test_what_is_tall_and_held_is_told_by_no_more_than_its_record_says() -> None:
    """Nothing of a harpoon says a figure or a costume, and nothing of an aircraft's model architecture."""
    tall = Item("1", "", "", object_name="harpoon", medium="wood", height_m=1.9, width_m=0.4, depth_m=0.3,
                displayed="on a stand")  # fmt: skip
    model = Item("2", "", "", object_name="Flugzeugmodell", height_m=0.3, width_m=1.2, depth_m=0.8,
                 displayed="von der Decke abgehängt")  # fmt: skip
    body = body_told(one.note for one in classify(tall).parameters.values())
    assert body == "a tall thing on a stand"
    scene = classify(model)
    assert (scene.support, what_it_is((scene.object_class, ""))) == (Support.SUSPENDED, "scale model")
