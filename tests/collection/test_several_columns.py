"""What several columns say together: feet beside inches, a place now beside the usual one, a work beside its frame."""

from __future__ import annotations

import pytest

from .conftest import HEADER, MAPPING, Read, one

FEET = MAPPING.replace('column = "height", unit = "in"', 'columns = ["height", "mass"], units = ["ft", "in"]')
FEET = "\n".join(line for line in FEET.splitlines() if not line.startswith("mass_kg"))


@pytest.mark.parametrize(
    ("feet", "inches", "height", "written"),
    [
        ("6", "2.25", 1.88595, "6 ft 2.25 in"),  # 74.25 in of 25.4 mm
        ("0", "9.000", 0.2286, "9 in"),
        ("2", "", 0.6096, "2 ft"),
        ("0", "0.000", None, ""),
        ("", "", None, ""),
    ],
)
def test_feet_beside_inches_add_up(read: Read, feet: str, inches: str, height: float | None, written: str) -> None:
    item = one(read(f"{HEADER}A1,Hall,,{feet},{inches}\n", FEET))
    assert item.height_m == height
    assert [of.written for of in item.provenance] == [written][: bool(written)]
    assert not item.problems


@pytest.mark.parametrize(("feet", "inches", "said"), [("6", "about 2", "is not a number"), ("900", "1", "implausible")])
def test_a_sum_of_which_a_part_cannot_be_is_none(read: Read, feet: str, inches: str, said: str) -> None:
    item = one(read(f"{HEADER}A1,Hall,,{feet},{inches}\n", FEET))
    assert item.height_m is None
    assert said in item.problems[0].message


def test_the_first_place_that_is_told_counts(read: Read) -> None:
    mapping = MAPPING.replace(
        'gallery = { column = "location" }', 'gallery = { columns = ["title", "location"], first = true }'
    )
    mapping = mapping.replace('title = { column = "title" }\n', "")
    lent, home = read(f"{HEADER}A1,Hall,Store,,\nA2,Hall,,,\n", mapping).items
    assert (lent.gallery, lent.on_display, home.gallery, home.on_display) == ("Store", False, "Hall", True)


def test_an_empty_location_is_no_fault_of_what_a_flag_says_to_be_away(read: Read) -> None:
    mapping = MAPPING.replace("title = {", 'on_display = { column = "title" }\ncase = {').replace(
        'case = { column = "title" }\n', ""
    )
    shown, away = read(f"{HEADER}A1,,yes,,\nA2,,no,,\n", mapping).items
    assert [problem.field for problem in shown.problems] == ["gallery"]
    assert not away.problems
    assert not shown.on_display
    assert not away.on_display


FRAMED = MAPPING.replace('unit = "in"', 'unit = "cm"') + '[dimensions]\ncolumns = ["mass"]\n'
FRAMED = "\n".join(line for line in FRAMED.splitlines() if not line.startswith("mass_kg"))


@pytest.mark.parametrize(
    ("text", "height", "depth", "problems"),
    [
        ("overall: 66 x 38 cm; framed: 88 x 58 x 9 cm", 0.88, 0.09, 0),  # as it hangs, and the column says the same
        ("overall: 77 x 38 cm; framed: 88 x 58 x 9 cm", 0.66, 0.09, 1),  # the column says neither
        ("66 x 38 cm", 0.66, None, 0),
    ],
)
def test_a_column_of_the_work_is_no_contradiction_of_its_frame(
    read: Read, text: str, height: float, depth: float | None, problems: int
) -> None:
    item = one(read(f"{HEADER}A1,Hall,,66,{text}\n", FRAMED))
    assert (item.height_m, item.depth_m, len(item.problems)) == (height, depth, problems)
