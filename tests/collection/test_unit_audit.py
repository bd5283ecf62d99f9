"""Units that a whole source has wrong are suspected, on real sizes; a sound source is not."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path
from random import Random

import pytest

from pipeline.collection.mapping import PRESETS, Mapping, load_mapping
from pipeline.collection.reading import Reading, read_items
from pipeline.tables.assumed import assumed

MAPPING = """
[source]
format = "csv"
encoding = "utf-8"
delimiter = ","
[museum]
name = "Test"
[columns]
object_number = { column = "number" }
gallery = { constant = "Hall" }
medium = { column = "medium" }
height_m = { column = "h", unit = "LENGTH" }
width_m = { column = "w", unit = "LENGTH" }
depth_m = { column = "d", unit = "LENGTH" }
mass_kg = { column = "mass", unit = "MASS" }
"""


@pytest.fixture(scope="module")
def bodies() -> list[tuple[str, list[float], float]]:
    """Medium, sides [in], mass [kg] of 300 real bodies; masses fill 5 to 60 % of the box, drawn with a fixed seed."""
    with (PRESETS.parent / "data" / "carnegie_2000.csv").open(encoding="utf-8", newline="") as stream:
        rows = list(csv.DictReader(stream))
    random = Random(7)
    out = []
    for row in rows:
        sides = [float(row[f"item_{side}"]) for side in ("height", "width", "depth")]
        material = assumed().material_in(row["medium"])
        if material is not None and all(sides) and min(sides) > 1.0 and max(sides) < 100.0:
            volume = sides[0] * sides[1] * sides[2] * 0.0254**3
            out.append((row["medium"], sides, volume * material.density * random.uniform(0.05, 0.6)))
    return out[:300]


def read(folder: Path, rows: Sequence[tuple[str, Sequence[str], str]], length: str, mass: str) -> Reading:
    (folder / "m.toml").write_text(MAPPING.replace("LENGTH", length).replace("MASS", mass), encoding="utf-8")
    with (folder / "m.csv").open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream)
        writer.writerow(["number", "medium", "h", "w", "d", "mass"])
        writer.writerows([at, medium, *sides, kg] for at, (medium, sides, kg) in enumerate(rows))
    mapping: Mapping = load_mapping(folder / "m.toml")
    return read_items(folder / "m.csv", mapping)


Bodies = list[tuple[str, list[float], float]]


def inches(bodies: Bodies) -> list[tuple[str, list[str], str]]:
    return [(medium, [f"{side:g}" for side in sides], f"{kg / 0.45359237:.3f}") for medium, sides, kg in bodies]


def centimetres(bodies: Bodies) -> list[tuple[str, list[str], str]]:
    return [(medium, [f"{2.54 * side:.1f}" for side in sides], f"{kg:.3f}") for medium, sides, kg in bodies]


def test_sound_sources_are_not_suspected(bodies: Bodies, tmp_path: Path) -> None:
    assert read(tmp_path, inches(bodies), "in", "lb").suspicions == ()
    assert read(tmp_path, centimetres(bodies), "cm", "kg").suspicions == ()


def test_kilograms_and_centimetres_labelled_pounds_and_inches(bodies: Bodies, tmp_path: Path) -> None:
    """A real museum's slip: the box seems 16 times too large, its content less than half as heavy."""
    steps, density = read(tmp_path, centimetres(bodies), "in", "lb").suspicions
    assert "taken as in and are written in tenths, as centimetres are" in steps.message
    assert 'unit = "cm"' in steps.remedy
    assert "sizes in in and masses in lb" in density.message
    assert "read as cm and kg" in density.message


def test_inches_labelled_centimetres(bodies: Bodies, tmp_path: Path) -> None:
    steps, density = read(tmp_path, inches(bodies), "cm", "lb").suspicions
    assert "eighths and sixteenths, as inches are" in steps.message
    assert "read as in and lb" in density.message


def test_grams_labelled_kilograms(bodies: Bodies, tmp_path: Path) -> None:
    grams = [(medium, sides, f"{1000.0 * float(kg):.0f}") for medium, sides, kg in centimetres(bodies)]
    reading = read(tmp_path, grams, "cm", "kg")
    # What is heavier than osmium is refused one by one, too.
    assert all(item.mass_kg is None for item in reading.items if item.problems)
    assert any("read as cm and g" in found.message for found in reading.suspicions) or (
        sum(item.mass_kg is None for item in reading.items) > 0.9 * len(bodies)
    )


def test_few_numbers_raise_no_suspicion(bodies: Bodies, tmp_path: Path) -> None:
    assert read(tmp_path, centimetres(bodies[:10]), "in", "lb").suspicions == ()
