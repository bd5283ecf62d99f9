"""Frictions against what was measured or is printed in handbooks, and the surfaces that museums' words tell.

The truths were written down from their sources before the table was looked at.
"""

from math import radians, tan

import pytest

from pipeline.records import Furniture
from pipeline.tables import table
from pipeline.tables.assumed import assumed, span
from pipeline.tables.surface_rows import met_on, surfaces_in

PUBLISHED = (
    # Jang, Zhang, Kang and Jang 2018, Rock Mechanics and Rock Engineering 51: direct shear of ground surfaces.
    ("stone", "stone", tan(radians(29.4))),
    ("stone", "stone", tan(radians(34.1))),
    # Barton and Choubey 1977, basic friction angles, dry: gneiss to limestone.
    ("stone", "stone", tan(radians(26.0))),
    ("marble", "stone", tan(radians(37.0))),
    # Byerlee 1966: granite, finely ground, and rough.
    ("stone", "stone", 0.2),
    ("stone", "stone", 0.6),
    # Rabbat and Russell 1985: steel plate on concrete.
    ("aluminum", "concrete", 0.57),
    ("aluminum", "concrete", 0.70),
    # Handbook tables of dry friction.
    ("wood", "concrete", 0.62),
    ("wood", "metal", 0.2),
    ("wood", "metal", 0.6),
    ("aluminum", "metal", 0.35),
    ("plastic", "metal", 0.45),
)


@pytest.mark.parametrize(("first", "second", "measured"), PUBLISHED)
def test_a_published_friction_is_within_the_range_of_its_pair(first: str, second: str, measured: float) -> None:
    found = span(assumed().friction_of(first, second))
    assert found.low <= measured + 1e-12
    assert measured <= found.high


def test_polished_minerals_are_as_smooth_as_the_papers_floors() -> None:
    """Calcite, polished and dry: 0.14 (Horn and Deere 1962); marble on the JPGM's terrazzo: 0.15."""
    assert span(assumed().friction_of("Marble", "Terrazzo")).value == pytest.approx(0.14, abs=0.015)
    assert span(assumed().friction_of("Marble", "stone")).low == pytest.approx(0.14, abs=0.015)


def test_stone_on_a_floor_of_stone_is_rougher_than_on_polished_terrazzo() -> None:
    stone = span(assumed().friction_of("Marble", "on a stone floor"))
    assert stone.value > 3.0 * span(assumed().friction_of("Marble", "terrazzo")).value


@pytest.mark.parametrize("material", ["Aluminum", "Marble", "Stone", "Wood", "Ceramic", "Glass", "Plastic"])
def test_every_material_has_the_surfaces_of_cases_and_plinths(material: str) -> None:
    pairs = {row["surface_material"] for row in table("friction") if row["object_material"] == material}
    assert pairs >= {"Wood", "Metal", "Glass", "Acrylic", "Fabric", "Felt", "Rubber", "Stone"} - (
        {"Metal"} if material == "Aluminum" else set()
    )


def test_what_is_met_in_a_case_is_no_floor() -> None:
    """Nobody lays terrazzo, concrete or carpet in a showcase, or lays felt by chance."""
    case, floor = met_on(Furniture.SHOWCASE), met_on(Furniture.FLOOR)
    assert not case & {"terrazzo", "concrete", "carpet", "mosaic", "felt", "rubber"}
    assert not floor & {"glass", "acrylic", "formica", "felt", "rubber"}
    assert (
        span(assumed().friction_of("Marble", "", Furniture.FLOOR)).high
        > span(assumed().friction_of("Marble", "", Furniture.SHOWCASE)).high
    )


@pytest.mark.parametrize(
    ("words", "surfaces"),
    [
        ("on stone floor", ("stone",)),
        ("standing on a polished marble floor", ("stone",)),
        ("on glass shelf in showcase", ("glass",)),
        ("auf Steinboden", ("stone",)),
        ("su pavimento in marmo", ("stone",)),
        ("on felt on a glass shelf", ("felt",)),
        ("on an acrylic block", ("acrylic",)),
        ("on painted MDF", ("wood",)),
        ("on carpet", ("carpet",)),
        ("on a silicone pad", ("rubber",)),
        ("in a glass case", ()),
        ("on iron stand", ()),
        ("strapped to a steel brace", ()),
        ("marble bust", ()),
    ],
)
def test_a_surface_is_told_by_what_something_stands_on(words: str, surfaces: tuple[str, ...]) -> None:
    assert surfaces_in(words) == surfaces


def test_a_surface_that_is_not_there_is_none() -> None:
    assert surfaces_in("without felt pads on marble floor") == ("stone",)
    assert surfaces_in("on felt pads on marble floor") == ("felt",)
