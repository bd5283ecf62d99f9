"""What a mount-maker may not do: screw into glass, stick to lacquer, fix to a wall that there is not, hold wheels."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from pipeline.analysis.classify import classify
from pipeline.analysis.response import respond
from pipeline.mitigate.measures.clearance import FOURFOLD, FOURFOLD_IN_CASE, TWICE
from pipeline.mitigate.measures.fixings import FINISHED, HARMLESS
from pipeline.mitigate.saying import ANCHORED, EACH_PIECE
from pipeline.quantities import G
from pipeline.records import Anchorage, Furniture, Item, Motion, Support
from pipeline.report.pages.plainly import plain_measure
from pipeline.report.units import Units
from pipeline.tables import table
from pipeline.tables.finish_rows import finishes_in
from tests.soak import some

from .scenes import BLOCK, TOWER, demo_motion, solve

LIGHT = replace(TOWER, mass_kg=2.0)
PIANO = Item("1", "G", "Grand piano", object_name="piano", medium="wood, iron",
             displayed="on its castors on wooden floor",
             support=Support.FREESTANDING, furniture=Furniture.FLOOR, height_m=1.0, width_m=2.7, depth_m=1.5,
             mass_kg=480.0)  # fmt: skip


@pytest.fixture(scope="module")
def motion() -> Motion:
    return demo_motion()


@pytest.mark.parametrize(
    ("medium", "materials", "finishes"),
    [
        ("Polychrome and gilded wood", {"wood"}, ["paint", "gilding"]),
        ("legno dipinto e dorato", {"wood"}, ["paint", "gilding"]),
        ("Lackiertes Holz; Lack", {"wood"}, ["lacquer"]),
        ("bois doré", {"wood"}, ["gilding"]),
        ("madera policromada", {"wood"}, ["paint"]),
        ("木造、漆箔", {"wood"}, ["lacquer", "gilding"]),
        # Fired on, it holds.
        ("porcelain with enamel and gilded decoration", {"porcelain"}, []),
        ("glass, painted", {"glass"}, []),
        ("marble", {"marble"}, []),
    ],
)
def test_what_comes_off_is_told_by_words(medium: str, materials: set[str], finishes: list[str]) -> None:
    assert [row.finish for row in finishes_in(medium, frozenset(materials))] == finishes


def test_finishes_harm_fixings_that_there_are() -> None:
    fixings = {row["fixing"] for row in table("fixings")}
    assert all(set(filter(None, row["harms"].split("|"))) <= fixings for row in table("finishes"))


def test_what_is_painted_is_touched_where_a_conservator_says(motion: Motion) -> None:
    weak = motion.scaled(0.6, "0.42 g")
    bare, painted = solve(LIGHT, weak), solve(replace(LIGHT, medium="Bronze, painted"), weak)
    assert bare.measure == painted.measure == "wax"
    assert bare.parameters == painted.parameters, "paint changes no number"
    assert HARMLESS in bare.sentence
    assert FINISHED not in bare.sentence
    assert FINISHED in painted.sentence
    assert HARMLESS not in painted.sentence
    assert "where it may be touched" in plain_measure(painted, Units("cm"))


def test_nothing_sticks_to_lacquer(motion: Motion) -> None:
    advice = solve(replace(LIGHT, medium="Bronze, lacquered"), motion.scaled(0.6, "0.42 g"))
    assert advice.measure not in ("wax", "putty")
    assert {"Microcrystalline wax: it harms paint and lacquer", "Museum putty: it harms paint and lacquer"} <= set(
        advice.rejected
    )


def test_the_care_of_a_fixing_is_on_the_page_and_not_only_in_its_fold(motion: Motion) -> None:
    """Marble is porous: what wax stains is told to who does the work."""
    stone = replace(LIGHT, medium="Marble", allowable_stress_pa=1e9)
    advice = solve(stone, motion.scaled(0.6, "0.42 g"))
    assert advice.measure == "wax"
    assert "barrier layer" in plain_measure(advice, Units("cm"))


def test_nothing_is_screwed_into_glass(motion: Motion) -> None:
    advice = solve(replace(TOWER, surface_material="glass shelf"), motion)
    said = [text for text in advice.rejected if "into which nothing is screwed" in text]
    assert {text.partition(":")[0] for text in said} >= {"Padded pins", "Padded clips", "Padded clamps"}


@pytest.mark.parametrize("furniture", some([Furniture.SHOWCASE, Furniture.PEDESTAL, Furniture.SHELF], 2))
def test_brackets_need_a_wall(motion: Motion, furniture: Furniture) -> None:
    """A cabinet on the floor is fixed to the wall behind it; a casket in a case has none."""
    cabinet = replace(TOWER, title="Cabinet", object_name="cabinet", mass_kg=20.0, height_m=1.0)
    assert "Brackets to the wall" not in [t.partition(":")[0] for t in solve(cabinet, motion).rejected if "wall" in t]
    raised = solve(replace(cabinet, furniture=furniture), motion)
    assert raised.measure != "brackets"


def test_a_console_that_is_said_to_stand_at_a_wall_is_fixed_to_it(motion: Motion) -> None:
    """Its moment about the base is borne at its top: F h / H, as of a beam on two supports."""
    console = Item("1", "G", "Pier table", object_name="console table", medium="wood", height_m=0.9, width_m=1.2,
                   depth_m=0.25, mass_kg=30.0, allowable_stress_pa=1e9, displayed="against the wall")  # fmt: skip
    advice = solve(console, motion)
    assert advice.measure == "brackets"
    numbers = advice.parameters
    # As far as friction lets an edge lift, not more than all the push at the centre of gravity.
    push = numbers["force"] * classify(console).parameters["cg_height"].value
    assert 0.0 < numbers["moment"] <= push * (1.0 + 1e-9)
    assert solve(replace(console, displayed="in the middle of the room"), motion).measure != "brackets"


def test_no_rigging_is_screwed_to_a_wall() -> None:
    """The top of a model is its masts or its roofs."""
    assert "model" not in next(row for row in table("measures") if row["measure"] == "brackets")["classes"].split("|")


def test_what_stands_on_wheels_rolls(motion: Motion) -> None:
    """Rolling resistance of 0.01 to 0.03 by handbooks; what is kept from it does not, nor what was measured."""
    rolls = classify(PIANO).parameters["friction_static"]
    assert rolls.low <= 0.01
    assert 0.01 <= rolls.value <= 0.05
    assert rolls.high <= 0.1
    for words in ("castors locked", "on castors, chocked", "auf Rollen, festgestellt", "castors in castor cups"):
        assert classify(replace(PIANO, displayed=words)).parameters["friction_static"].low >= 0.15
    assert classify(replace(PIANO, friction=0.3)).parameters["friction_static"].value == 0.3
    # Under the motion it goes as far as a body of that friction, not as one of wood on wood.
    far, near = (
        float(respond("sliding", motion, friction_static=mu)["displacement"].iloc[0]) for mu in (rolls.value, 0.4)
    )
    assert far > 10.0 * near


def test_chocks_are_the_right_answer(motion: Motion) -> None:
    """It rolls into its neighbours; chocked it keeps to Newmark's (1965) bound, V^2 / (2 mu g) A / (mu g), mu = 0.2."""
    half = motion.scaled(0.5, "half")
    advice = solve(PIANO, half)
    assert advice.measure == "chocks"
    x, y, z = half.acceleration
    velocity = np.hypot(np.cumsum(x), np.cumsum(y)).max() * half.dt
    grip = 0.2 * (G + z.min())
    newmark = velocity**2 / (2.0 * grip) * np.hypot(x, y).max() / grip
    rolled = float(respond("sliding", half, friction_static=0.03)["displacement"].iloc[0])
    assert advice.parameters["movement"] < min(newmark, rolled)
    assert [check.model for check in advice.checks] == ["standing", "sliding"]


def test_nothing_else_is_asked_of_wheels(motion: Motion) -> None:
    """A mat below wheels holds nothing, and there is no foot to clamp."""
    cart = replace(TOWER, displayed="on wheels", friction=None, object_name="cart", mass_kg=500.0)
    advice = solve(replace(cart, clearance_m=0.02), motion.scaled(2.0, "more"))
    titles = {text.partition(":")[0]: text for text in advice.rejected}
    assert "it rolls" in titles["Non-slip pad"]
    assert "no foot to be held by" in titles["Padded clamps"]


WHEELED = (
    Item("1", "G", "Horch 8 saloon", object_name="motor car", medium="steel, glass, leather", height_m=1.7,
         width_m=1.8, depth_m=4.6),
    Item("2", "G", "Cannon on its field carriage", object_name="cannon", medium="bronze, oak", height_m=1.4,
         width_m=1.8, depth_m=3.2),
    Item("3", "G", "Tank engine", object_name="locomotive", medium="steel", height_m=3.8, width_m=2.6, depth_m=9.0),
    Item("4", "G", "Chariot", object_name="model", medium="wood", height_m=0.4, width_m=0.3, depth_m=0.5,
         displayed="auf Schienen"),
)  # fmt: skip


@pytest.mark.parametrize("item", WHEELED, ids=lambda item: item.title)
def test_what_nobody_needs_to_say_is_on_wheels_rolls(item: Item, motion: Motion) -> None:
    """Handbook rolling resistances are far below any friction of Table 3 (0.11 and more); chocked it slides."""
    rolls = classify(item).parameters["friction_static"]
    assert rolls.value < 0.11
    assert solve(replace(item, mass_kg=1500.0), motion.scaled(0.4, "less")).measure == "chocks"
    kept = replace(item, displayed=f"{item.displayed}; wheels scotched, handbrake on")
    assert classify(kept).parameters["friction_static"].low >= 0.11


@pytest.mark.parametrize(
    ("name", "height"), [("car mascot", 0.14), ("locomotive whistle", 0.3), ("tram bell", 0.25), ("vase", 1.2)]
)
def test_a_part_of_a_vehicle_does_not_roll(name: str, height: float) -> None:
    """Nor does what shows one."""
    part = Item("1", "G", "Racing car", object_name=name, medium="brass", height_m=height, width_m=0.1, depth_m=0.1,
                displayed="on pedestal")  # fmt: skip
    assert classify(part).parameters["friction_static"].value > 0.11


def test_what_is_done_to_a_service_is_done_to_each_piece(motion: Motion) -> None:
    service = Item("1", "G", "Tea service", object_name="tea service", medium="porcelain", height_m=0.35, width_m=0.1,
                   depth_m=0.1, mass_kg=2.0, displayed="on floor", friction=0.6)  # fmt: skip
    advice = solve(service, motion)
    assert advice.sentence.startswith(EACH_PIECE)
    assert EACH_PIECE not in solve(replace(service, title="Teapot", object_name="teapot"), motion).sentence
    assert "each of its pieces" in plain_measure(advice, Units("cm"))


def test_what_rolls_stands_on_the_floor() -> None:
    camera = Item("1", "G", "Studio camera", object_name="camera", medium="beech", height_m=0.6, width_m=0.45,
                  depth_m=0.5, displayed="sur roulettes")  # fmt: skip
    assert classify(camera).furniture is Furniture.FLOOR
    assert classify(replace(camera, displayed="freestanding")).furniture is Furniture.PEDESTAL
    toy = replace(camera, object_name="toy", title="Horse on wheels", height_m=0.25, width_m=0.25, depth_m=0.1)
    assert classify(toy).furniture is Furniture.SHOWCASE


def test_wheels_are_no_answer_for_what_has_none(motion: Motion) -> None:
    assert not any(text.startswith("Chock") for text in solve(BLOCK, motion.scaled(2.0, "more")).rejected)


def test_what_swings_hangs_from_what_bears_twice_its_weight() -> None:
    """Let go at an angle an ideal pendulum pulls by 3 - 2 cos of it: at 60 degrees twice its weight."""
    lamp = Item("1", "G", "Lamp", object_name="chandelier", medium="brass", support=Support.SUSPENDED, height_m=1.0,
                width_m=0.8, suspension_length_m=1.0, mass_kg=20.0, clearance_m=0.01)  # fmt: skip
    advice = solve(lamp, demo_motion())
    assert advice.measure == "clearance"
    assert TWICE in advice.sentence
    assert "twice its weight" in plain_measure(advice, Units("cm"))
    # From half a metre and less it is tugged harder than any pendulum that is let go.
    short = solve(replace(lamp, suspension_length_m=0.4), demo_motion())
    assert (short.measure, FOURFOLD in short.sentence, TWICE in short.sentence) == ("clearance", True, False)
    # Within a case there is no ceiling, and no more room than a case spares.
    cased = solve(replace(lamp, suspension_length_m=0.4, displayed="sospeso in vetrina"), demo_motion())
    assert cased.measure != "clearance"
    assert any(text.startswith("Keep clear: it would need") for text in cased.rejected)
    assert (FOURFOLD_IN_CASE in cased.sentence, "ceiling must" in cased.sentence) == (True, False)
    swing = advice.parameters["movement"]
    assert 3.0 - 2.0 * (1.0 - swing**2) ** 0.5 < 2.0


@pytest.mark.parametrize(
    "mass", [95.0, pytest.param(2.0, marks=pytest.mark.long("test_nothing_heavy_is_fixed_to_what_may_fall_itself"))]
)
def test_nothing_heavy_is_fixed_to_what_may_fall_itself(motion: Motion, mass: float) -> None:
    """A bust of 95 kg takes a loose pedestal along, which is fastened first; one of 2 kg does not."""
    bust = replace(TOWER, object_name="bust", title="Bust", mass_kg=mass, allowable_stress_pa=5e7,
                   furniture=Furniture.PEDESTAL, furniture_anchorage=Anchorage.UNANCHORED)  # fmt: skip
    advice = solve(bust, motion.scaled(1.5, "more"))
    assert advice.measure not in ("remove", "clearance")
    assert advice.sentence.startswith(ANCHORED) is (mass > 10.0)
