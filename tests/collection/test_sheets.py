"""Workbooks with a sheet for each room."""

from __future__ import annotations

from pathlib import Path

import openpyxl
import pytest

from pipeline.collection.errors import CollectionError
from pipeline.collection.guess import guess
from pipeline.collection.mapping import Mapping
from pipeline.collection.reading import read_items

HEAD = ["Acc. No.", "Item", "Material", "Size"]
ROOMS = {
    "Room 1": [["L1", "Teapot", "pottery", '6" h x 9" w'], ["L2", "Longcase clock", "oak", '84" h x 20" w x 10" d']],
    "Room 2": [["L3", "Spinning wheel", "wood", '38" h x 32" w x 18" d']],
    "Store": [["L5", "Churn", "wood", '24" h']],
}


def _workbook(path: Path, sheets: dict[str, list[list[str]]], heads: dict[str, list[str]] | None = None) -> Path:
    book = openpyxl.Workbook()
    book.remove(book.active)
    for name, rows in sheets.items():
        sheet = book.create_sheet(name)
        sheet.append((heads or {}).get(name, HEAD))
        for row in rows:
            sheet.append(row)
    book.save(path)
    return path


def test_sheets_with_the_same_columns_are_read_one_below_another(tmp_path: Path) -> None:
    """Names of rooms are the places of what is listed there; nothing of the workbook is lost."""
    turned = {"Room 2": ["Item", "Acc. No.", "Size", "Material"]}
    rooms = ROOMS | {"Room 2": [["Spinning wheel", "L3", '38" h x 32" w x 18" d', "wood"]]}
    for heads, sheets in (({}, ROOMS), (turned, rooms)):
        path = _workbook(tmp_path / "rooms.xlsx", sheets, heads)
        found = guess(path)
        items = read_items(path, found.mapping).items
        assert [(item.object_number, item.gallery, item.object_name) for item in items] == [
            ("L1", "Room 1", "Teapot"),
            ("L2", "Room 1", "Longcase clock"),
            ("L3", "Room 2", "Spinning wheel"),
            ("L5", "Store", "Churn"),
        ]
        assert items[2].height_m == pytest.approx(38 * 0.0254)
        assert any(said.startswith("3 sheets with the same columns") for said in found.sure)
        assert found.mapping.display is not None
        assert found.mapping.display.not_on_display == ("Store",)


def test_a_copy_of_a_sheet_and_a_list_in_other_columns_are_not_joined(tmp_path: Path) -> None:
    sheets = {"Objects": ROOMS["Room 1"], "Objects (old)": ROOMS["Room 1"], "People": [["1", "A", "B", "C"]]}
    path = _workbook(tmp_path / "copies.xlsx", sheets, {"People": ["Key", "First", "Last", "Phone"]})
    found = guess(path)
    assert len(read_items(path, found.mapping).items) == 2
    assert any("'Objects' looks most like the inventory" in doubt for doubt in found.doubts)


def test_names_of_sheets_that_are_no_places_are_left_as_such(tmp_path: Path) -> None:
    path = _workbook(tmp_path / "kinds.xlsx", {"Ceramics": ROOMS["Room 1"], "Wood": ROOMS["Room 2"]})
    found = guess(path)
    assert found.mapping.columns["gallery"].constant == "Location not recorded"
    assert any("--choose gallery=sheet takes these" in doubt for doubt in found.doubts)
    chosen = guess(path, choices={"gallery": "sheet"})
    assert {item.gallery for item in read_items(path, chosen.mapping).items} == {"Ceramics", "Wood"}


def test_a_sheet_that_changed_its_columns_is_refused_by_name(tmp_path: Path) -> None:
    found = guess(_workbook(tmp_path / "rooms.xlsx", ROOMS))
    changed = _workbook(tmp_path / "rooms.xlsx", ROOMS, {"Room 2": ["Acc. No.", "Item", "Stuff", "Size"]})
    with pytest.raises(CollectionError, match="sheet 'Room 2' has not the columns of the first: 'Material', 'Stuff'"):
        read_items(changed, found.mapping)


def test_a_mapping_with_sheets_reads_again_what_it_wrote(tmp_path: Path) -> None:
    found = guess(_workbook(tmp_path / "rooms.xlsx", ROOMS))
    assert Mapping.model_validate(found.mapping.model_dump()).source == found.mapping.source
