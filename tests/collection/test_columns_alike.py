"""What the texts of a column say of each other: the language of labels, the unit that some omit, lengths for depths."""

from __future__ import annotations

from pathlib import Path

import pytest

from pipeline.collection.dimensions import choose, parse
from pipeline.collection.guess import guess
from pipeline.collection.guessing.names import named
from pipeline.collection.reading import read_items
from pipeline.records import Item


def _read(folder: Path, head: str, rows: list[str]) -> tuple[list[Item], tuple[str, ...]]:
    path = folder / "export.csv"
    path.write_text("\n".join([head, *rows]) + "\n", encoding="utf-8")
    found = guess(path)
    return list(read_items(path, found.mapping).items), found.doubts


HUNGARIAN = [f"{at};kancsó;M: {20 + at} cm, Sz: 12 cm, Mé: 11 cm;1. terem" for at in range(8)]


def test_labels_are_of_the_language_that_the_column_is_of(tmp_path: Path) -> None:
    """H alone is a height in most languages, and in Hungarian a length: magasság, szélesség, hosszúság."""
    items, doubts = _read(tmp_path, "szám;tárgynév;méretek;hely", [*HUNGARIAN, "9;bot;H: 138 cm;1. terem"])
    assert items[0].height_m == pytest.approx(0.20)
    assert (items[-1].height_m, items[-1].width_m) == (None, pytest.approx(1.38))
    assert any("language hu" in doubt and "8 of 9 texts" in doubt for doubt in doubts)


def test_a_text_of_another_kind_leaves_each_to_itself(tmp_path: Path) -> None:
    mixed = [f"{at};jug;H: {20 + at} cm, W: 12 cm, D: 11 cm;1. terem" for at in range(20, 28)]
    items, doubts = _read(tmp_path, "szám;tárgynév;méretek;hely", [*HUNGARIAN, *mixed, "9;bot;H: 138 cm;1. terem"])
    assert items[-1].height_m == pytest.approx(1.38)
    assert not any("language" in doubt for doubt in doubts)


def test_czech_depth_is_no_height() -> None:
    for text in ("v. 31 cm, š. 17 cm, h. 15 cm", "31 x 17 x 15 cm (v x š x h)"):
        chosen = choose(parse(text))
        sides = [one.value if one else None for one in (chosen.height, chosen.width, chosen.depth)]
        assert sides == pytest.approx([0.31, 0.17, 0.15])


def test_what_names_no_unit_has_that_of_the_other_texts(tmp_path: Path) -> None:
    told = [f"{at},vase,H. {20 + at} cm ; D. 12 cm,1" for at in range(12)]
    items, doubts = _read(tmp_path, "no,object,dimensions,room", [*told, "90,vase,H. 31 ; D. 14,1"])
    assert items[-1].height_m == pytest.approx(0.31)
    assert any(doubt.startswith("1 texts name no unit: read in cm, as 12 of 12 others") for doubt in doubts)


@pytest.mark.parametrize("other", ["H. 310 ; D. 4000", "H. 0.02 ; D. 0.01"])
def test_what_would_be_of_quite_another_size_is_left_open(other: str, tmp_path: Path) -> None:
    told = [f"{at},vase,H. {20 + at} cm ; D. 12 cm,1" for at in range(12)]
    items, _ = _read(tmp_path, "no,object,dimensions,room", [*told, f"90,vase,{other},1"])
    assert items[-1].height_m is None
    assert items[-1].problems


def test_a_length_is_the_depth_of_what_has_none(tmp_path: Path) -> None:
    """PastPerfect has a column for each, of which a bed fills the length and a chest the depth; 0 is no size."""
    rows = ["1,Chest,30,40,,20,Hall", "2,Bed,50,54,78,0,Hall", "3,Spoon,0,1,8,0,Hall", "4,Chair,36,20,0,19,Hall"]
    items, doubts = _read(tmp_path, "OBJECTID,OBJNAME,HEIGHTIN,WIDTHIN,LENGTHIN,DEPTHIN,HOMELOC", rows)
    assert [one.depth_m for one in items] == pytest.approx([0.508, 1.9812, 0.2032, 0.4826])
    assert any("where that tells none 'LENGTHIN'" in doubt for doubt in doubts)
    both = [f"{at},Ship,30,40,80,{20 + at},Hall" for at in range(8)]
    items, doubts = _read(tmp_path, "OBJECTID,OBJNAME,HEIGHTIN,WIDTHIN,LENGTHIN,DEPTHIN,HOMELOC", both)
    assert items[0].depth_m == pytest.approx(0.508)
    assert any(doubt.startswith("no field takes the numbers of 'LENGTHIN'") for doubt in doubts)


def test_labels_behind_which_a_dash_stands() -> None:
    chosen = choose(parse("H-7 W-24 L-68 cm"))
    assert chosen.height is not None
    assert chosen.height.value == pytest.approx(0.07)
    assert [part.dimension for part in parse("H-7 W-24 L-68 cm").parts] == ["height", "width", "length"]
    # A range of one side, and components, are no such labels.
    assert parse("H 7-9 cm").parts[0].high == pytest.approx(0.09)


@pytest.mark.parametrize(
    ("name", "field"),
    [
        ("通高(cm)", "height_m"),
        ("通宽(cm)", "width_m"),
        ("藏品总登记号", "object_number"),
        ("ESERİN ADI", "object_name"),
        ("PhyHeight (mm)", "height_m"),
        ("LocCurrentLocation", "gallery"),
        ("Betegnelse", "object_name"),
        ("Raktári hely", "gallery"),
    ],
)
def test_columns_of_chinese_turkish_nordic_and_hungarian_registers(name: str, field: str) -> None:
    what = named(name)
    assert what is not None
    assert what.field == field
