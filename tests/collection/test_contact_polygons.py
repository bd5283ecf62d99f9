"""Contact polygons and tilt tests on their way from a museum's file into the record."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import Reading, read_items
from pipeline.records import Item, Origin, Problem

from .conftest import Read

SQUARE = ((0.1, 0.1), (-0.1, 0.1), (-0.1, -0.1), (0.1, -0.1))


def filled(tmp_path: Path, **cells: str) -> Reading:
    """Read one row of a file with the columns of the preset "kouros"."""
    quoted = ('"' + cell.replace('"', '""') + '"' for cell in cells.values())
    path = tmp_path / "objects.csv"
    path.write_text(f"object_number,gallery,{','.join(cells)}\nA.1,East,{','.join(quoted)}\n", encoding="utf-8")
    return read_items(path, load_mapping("kouros"))


def one(tmp_path: Path, **cells: str) -> Item:
    (item,) = filled(tmp_path, **cells).items
    return item


@pytest.mark.parametrize(
    "cell",
    [
        "0.1 0.1; -0.1 0.1; -0.1 -0.1; 0.1 -0.1",
        "0.1,0.1;-0.1,0.1;-0.1,-0.1;0.1,-0.1;",
        "[[0.1, 0.1], [-0.1, 0.1], [-0.1, -0.1], [0.1, -0.1]]",
    ],
)
def test_points_are_read_as_they_are_written(tmp_path: Path, cell: str) -> None:
    item = one(tmp_path, contact_polygon=cell)
    assert item.contact_polygon == SQUARE
    assert item.problems == ()
    (of,) = item.provenance
    assert (of.field, of.origin) == ("contact_polygon", Origin.MEASURED)
    assert of.written.startswith(cell)


def test_units_and_decimal_commas(read: Read) -> None:
    mapping = """
[source]
format = "csv"
encoding = "utf-8"
delimiter = "|"
decimal = ","

[museum]
name = "M"

[columns]
object_number = { column = "Nr" }
gallery = { column = "Ort" }
contact_polygon = { column = "Standfläche", unit = "mm" }
"""
    (item,) = read("Nr|Ort|Standfläche\n1|Saal|12,5 10; -12,5 10; 0 -20\n", mapping).items
    assert item.contact_polygon == ((0.0125, 0.01), (-0.0125, 0.01), (0.0, -0.02))


@pytest.mark.parametrize(
    ("cell", "words"),
    [
        ("0.1 0.1; 0.3 0.1; 0.2 0.3", "does not hold the centre of gravity"),
        ("0.1 0.1; -0.1 -0.1; 0.2 0.2", "one line"),
        ("0.1 0.1; -0.1 0.1", "three different points"),
        ("0.1 0.1; -0.1 0.1; 0", "no list of points"),
        ("round", "no list of points"),
        ("[[0.1, 0.1], null]", "no list of points"),
        ('{"x": 1}', "no list of points"),
        ("[" * 5000, "no list of points"),
        ("nan nan; 1 1; 2 2", "coordinate nan m"),
        ("1e9 0; -1 1; -1 -1", "coordinate 1e.09 m is implausible"),
    ],
)
def test_what_nothing_stands_on_is_left_out_and_says_so(tmp_path: Path, cell: str, words: str) -> None:
    """The column and the field are named; file and row by the report of the reading; the object itself stays."""
    item = one(tmp_path, contact_polygon=cell)
    assert (item.contact_polygon, item.provenance) == ((), ())
    (problem,) = item.problems
    assert problem.field == "contact_polygon"
    assert "column 'contact_polygon'" in problem.message
    assert problem.remedy
    assert re.search(words, problem.message)


def about(item: Item, field: str) -> Problem:
    (problem,) = [one for one in item.problems if one.field == field]
    return problem


def test_a_polygon_larger_than_the_object_is_doubted(tmp_path: Path) -> None:
    cell = "0.1 0.1; -0.1 0.1; -0.1 -0.1; 0.1 -0.1"
    assert one(tmp_path, contact_polygon=cell, width_m="0.2", depth_m="0.25").problems == ()
    item = one(tmp_path, contact_polygon=cell, width_m="0.02", depth_m="0.25")
    assert item.contact_polygon == SQUARE
    assert "0.2 m across where the object itself is 0.02 m" in about(item, "contact_polygon").message


def test_the_least_polygon_needs_the_polygon(tmp_path: Path) -> None:
    item = one(tmp_path, contact_polygon_least="0.1 0.1; -0.1 0.1; 0 -0.1")
    assert item.contact_polygon_least == ()
    assert about(item, "contact_polygon_least").remedy == "record both"


def test_a_tilt_test_against_the_base_that_is_recorded(tmp_path: Path) -> None:
    """tan 10 degrees times 0.25 m is 0.044 m: a base of 0.09 m agrees with it, one of 0.05 m does not."""
    agrees = {"tilt_angle_deg": "10", "cg_height_m": "0.25"}
    assert one(tmp_path, base_width_m="0.09", **agrees).problems == ()
    item = one(tmp_path, base_width_m="0.05", **agrees)
    assert item.tilt_angle_deg == 10.0
    assert "as if its base were 0.08816 m wide; recorded are 0.05 m" in about(item, "tilt_angle_deg").message
    assert about(one(tmp_path, tilt_angle_deg="95"), "tilt_angle_deg").message.startswith("column 'tilt_angle_deg'")
