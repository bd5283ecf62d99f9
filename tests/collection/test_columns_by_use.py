"""Columns that are known by what they are for: how things are displayed, cases with rooms, names, numbers, money."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from pipeline.collection.dimensions import choose, parse
from pipeline.collection.guess import guess
from pipeline.collection.money import amount, no_money
from pipeline.collection.reading import read_items
from pipeline.records import Item


def _read(path: Path, text: str) -> tuple[Item, ...]:
    path.write_text(text, encoding="utf-8")
    return tuple(read_items(path, guess(path).mapping).items)


def test_a_display_type_is_no_type_of_thing(tmp_path: Path) -> None:
    """In capitals "DISPLAY_DENOMINATION" is the denomination to be shown; this is how things are displayed."""
    text = (
        "Accession Number,Name,Description,Current Location,Display Type,Measurements,Insurance\n"
        '1990/3,"Model, ship",TSS Maheno,Maritime Hall,Table case,"1200 mm long, 280 wide, 560 high","$8,500.00"\n'
        '1888.1,Painting,Milford Sound,Gallery 2,"Hung, 2 x D rings",1030 x 1540 mm,"$250,000.00"\n'
    )
    model, painting = _read(tmp_path / "list.csv", text)
    assert (model.object_name, model.displayed, painting.displayed) == (
        "Model, ship",
        "Table case",
        "Hung, 2 x D rings",
    )
    assert (model.value, painting.value) == (8500.0, 250000.0)
    # A unit that stands once, behind the first number, is that of all.
    assert (model.height_m, model.width_m, model.depth_m) == (0.56, 0.28, 1.2)


@pytest.mark.parametrize(
    "head", ["Note allestimento", "Τρόπος στήριξης", "Fixing method", "Sistema de sujeción", "固定方法"]
)
def test_heads_of_how_things_are_held(tmp_path: Path, head: str) -> None:
    text = (
        f"Inventory No,Object,Location,Height cm,{head}\n7,statue,Hall 1,165,bolted to plinth\n8,vase,Hall 1,30,wax\n"
    )
    items = _read(tmp_path / "list.csv", text)
    assert [item.displayed for item in items] == ["bolted to plinth", "wax"]


def test_a_column_of_rooms_and_cases_is_of_places_too(tmp_path: Path) -> None:
    """Cases alone stay cases, for then no column says where they are."""
    text = "Env. No;Eser Adı;{};Ölçüler\n1;pithos;Salon 1 / Vitrin 5;Y: 45 cm\n2;sikke;Salon 3 / Vitrin 11;Y: 2 cm\n"
    for head in ("Salon / Vitrin", "Vitrin"):
        items = _read(tmp_path / f"{head[:3]}.csv", text.format(head))
        assert [(item.gallery, item.case) for item in items] == [("Salon 1", "Vitrin 5"), ("Salon 3", "Vitrin 11")]
    alone = text.replace("Salon 1 / Vitrin 5", "5").replace("Salon 3 / Vitrin 11", "11").format("Vitrin")
    assert [item.case for item in _read(tmp_path / "alone.csv", alone)] == ["5", "11"]


def test_where_a_thing_is_now_may_stand_within_its_place(tmp_path: Path) -> None:
    rows = [
        {"identifier": "A-1", "label": "Globe, terrestrial", "height_cm": 125, "place": {"current": "Library, Bay 4"}},
        {"identifier": "A-2", "label": "Orrery", "height_cm": 54, "place": {"current": "Library, showcase 2"}},
    ]
    items = _read(tmp_path / "list.json", json.dumps({"results": rows}))
    assert [(item.object_name, item.gallery) for item in items] == [
        ("Globe, terrestrial", "Library, Bay 4"),
        ("Orrery", "Library"),
    ]


def test_a_number_is_preferred_to_the_id_of_a_database(tmp_path: Path) -> None:
    text = "ID,Number,Object,Room,Height mm\n77,H.77,jug,R2,212\n78,H.78,dresser,R2,1980\n"
    assert [item.object_number for item in _read(tmp_path / "list.csv", text)] == ["H.77", "H.78"]


@pytest.mark.parametrize(
    ("text", "height", "width"),
    [
        ("H 45 cm, W 30, D 20", 0.45, 0.30),
        ("H: 1.2 m, W: 45", 1.2, None),  # 45 m wide: of another unit, which is not told
        ("U: 218 G: 98 Y: 112 cm", 1.12, 0.98),  # Turkish genişlik; behind 218 it was grams
        ("218 g; H 12 cm", 0.12, None),
    ],
)
def test_one_unit_for_several_sides(text: str, height: float, width: float | None) -> None:
    got = choose(parse(text))
    assert (got.height and got.height.value, got.width and got.width.value) == (height, width)


@pytest.mark.parametrize(
    ("text", "plain"),
    [
        ("$45,000.00", ("45000.00", "$")),
        ("45.000,00 €", ("45000.00", "€")),
        ("CHF 12'500.-", ("12500", "CHF")),
        ("1 200 000 Ft", ("1200000", "Ft")),
        ("12,50", ("12.50", "")),
        ("NZ$ 1,200", ("1200", "NZ$")),
        ("1,234,56", None),  # of one mark for two things
        ("20-30", None),
        ("$5 €", None),
        ("£1.2m", None),
        ("9" * 50, None),
    ],
)
def test_amounts(text: str, plain: tuple[str, str] | None) -> None:
    assert amount(text) == plain


def test_several_moneys_are_no_value() -> None:
    assert no_money(["$5", "7", "$1,000"]) == ""
    assert "several moneys, $, €" in no_money(["$5", "€7"])
    assert "no amounts" in no_money(["see file", "$5", "unknown"])
