"""Masses that are assumed against masses that museums recorded."""

import csv
from dataclasses import replace
from math import pi
from pathlib import Path

import pytest

from pipeline.analysis.classify import classify
from pipeline.analysis.rule_table import with_own
from pipeline.records import Item
from pipeline.tables import table
from pipeline.tables.assumed import assumed, assumed_with
from pipeline.tables.fill_rows import fills
from pipeline.tables.usual_material_rows import usual_material


def test_every_class_and_material_of_the_table_is_one() -> None:
    classes, materials = {row["class"] for row in table("classes")}, set(assumed().materials)
    assert {name for name, _ in fills()} <= classes
    assert {material for _, material in fills()} <= materials


@pytest.mark.parametrize(
    ("name", "medium", "sizes", "kilograms"),
    [
        # Recorded weights: Metropolitan Museum, Open Access, and Museum of Modern Art, public collection data.
        ("Punch bowl", "Silver", (0.12, 0.26, 0.26), 1.022),
        ("Two-handled bowl", "Silver", (0.14, 0.35, 0.35), 0.807),
        ("Sugar bowl", "Silver", (0.07, 0.11, 0.11), 0.191),
        ("Box", "Gold", (0.04, 0.12, 0.07), 0.386),
        ("Sculpture", "Bronze", (0.91, 0.40, 0.52), 55.3),
        ("Sculpture", "Bronze", (1.43, 0.37, 0.24), 27.2),
        ("Sculpture", "Cast iron", (0.57, 0.97, 0.55), 171.9),
        ("Sculpture", "Painted steel", (3.93, 3.54, 2.77), 2948.4),
        ("Sculpture", "Wood", (1.283, 0.638, 0.73), 25.9),
    ],
)
def test_metal_weighs_what_it_does(name: str, medium: str, sizes: tuple[float, float, float], kilograms: float) -> None:
    """Within the range, and within a factor of 4 of the best estimate; by the class alone it is 15 times as much."""
    height, width, depth = sizes
    item = Item("1", "Hall", object_name=name, medium=medium, height_m=height, width_m=width, depth_m=depth)
    mass = classify(item).parameters["mass"]
    assert mass.low <= kilograms <= mass.high
    assert 0.25 <= mass.value / kilograms <= 4.0


@pytest.mark.parametrize(
    ("height", "across", "wall", "density"), [(0.45, 0.36, 0.010, 2300.0), (0.64, 0.41, 0.007, 1950.0)]
)
def test_a_large_vessel_weighs_what_its_wall_does(height: float, across: float, wall: float, density: float) -> None:
    """A jar of stoneware and an amphora of terracotta, as a spheroid's shell of an even wall."""
    medium = "stoneware" if density > 2000.0 else "terracotta"
    a, c = 0.5 * across, 0.5 * height
    volume = 4.0 / 3.0 * pi * (a * a * c - (a - wall) ** 2 * (c - wall))
    jar = Item("1", "G", object_name="jar", medium=medium, height_m=height, width_m=across, depth_m=across)
    mass = classify(jar).parameters["mass"]
    assert mass.low <= density * volume <= mass.high
    assert mass.value == pytest.approx(density * volume, rel=0.35)
    # What is no taller than a hand is thicker for its size.
    small = classify(replace(jar, height_m=0.1 * height / across, width_m=0.1, depth_m=0.1)).parameters["mass"]
    assert small.value / (0.1 / across) ** 3 > 1.5 * mass.value


def test_a_museums_own_row_of_a_class_goes_before(tmp_path: Path) -> None:
    rows = [row for row in table("classes") if row["class"] == "vessel"]
    with (tmp_path / "own.csv").open("w", newline="", encoding="utf-8") as stream:
        out = csv.DictWriter(stream, rows[0])
        out.writeheader()
        out.writerows(rows)
    own = assumed_with({"classes": tmp_path / "own.csv"})
    item = Item("1", "Hall", object_name="Vase", medium="Silver", height_m=0.2, width_m=0.1, depth_m=0.1)
    plain, theirs = classify(item).parameters["mass"], classify(item, with_own(None, own)).parameters["mass"]
    assert theirs.value > 5.0 * plain.value


@pytest.mark.parametrize(
    ("sizes", "medium", "weighs"),
    [
        # A slab of limestone as thick as its box, less a tenth that is carved away: 0.107 m3 x 2.6 t/m3.
        ((0.9, 1.1, 0.12), "limestone", 280.0),
        # A bronze plaque cast 8 mm thick: 0.4 x 0.3 x 0.008 m x 8700 kg/m3, in a box of 2 cm.
        ((0.4, 0.3, 0.02), "bronze", 8.4),
        # A carved panel of oak as thick as its box.
        ((1.0, 0.5, 0.05), "oak", 17.5),
    ],
)
def test_a_slab_on_a_wall_weighs_what_its_material_does(
    sizes: tuple[float, float, float], medium: str, weighs: float
) -> None:
    height, width, depth = sizes
    relief = Item("1", "G", object_name="relief", medium=medium, height_m=height, width_m=width, depth_m=depth)
    mass = classify(relief).parameters["mass"]
    assert mass.low <= weighs <= mass.high
    # Without its depth or its material it is as what hangs on walls.
    for bare in (replace(relief, medium=""), Item("2", "G", object_name="painting", height_m=height, width_m=width)):
        assert classify(bare).parameters["mass"].value == pytest.approx(15.0 * height * width)


@pytest.mark.parametrize(
    ("name", "title", "material", "low", "high"),
    [
        ("wardrobe", "", "wood", 350.0, 1500.0),
        ("grandfather clock", "Longcase", "wood", 350.0, 2000.0),
    ],
)
def test_what_nobody_says_is_of_what_such_things_mostly_are(
    name: str, title: str, material: str, low: float, high: float
) -> None:
    """Furniture without a material weighed three times as much as of wood: 600 kg for a wardrobe of two doors."""
    item = Item("1", "G", object_name=name, title=title, height_m=2.1, width_m=1.3, depth_m=0.55)
    bare, said = (classify(one).parameters["mass"] for one in (item, replace(item, medium=material)))
    best = assumed().materials[material].density
    assert bare.value == pytest.approx(said.value, rel=1e-12)
    assert (bare.low / said.low, bare.high / said.high) == pytest.approx(
        (low / assumed().materials[material].density_low, high / assumed().materials[material].density_high)
    )
    assert f"{material} of {best:g} kg/m3, as such things mostly are" in " ".join(classify(item).assumptions)
    sarcophagus = usual_material("cabinet", "sarcophagus", 1.0)
    assert sarcophagus is not None
    assert sarcophagus.material == "stone"
    # A vase may be of anything.
    assert usual_material("vessel", "vase", 0.3) is None
