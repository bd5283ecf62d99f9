"""Each preset reads a small file of its system: what was written into it comes back.

Adlib, MuseumPlus RIA, LIDO and Linked Art have files of their own (tests/collection/sources, newcomers.py).
"""

from __future__ import annotations

import csv
import sqlite3
from contextlib import closing
from pathlib import Path

import openpyxl
import pytest

from pipeline.collection.guess import guess
from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import Reading, read_items

from .newcomers import Newcomer, tms_like_database
from .sources.lido_files import measured, measurements, record, wrap

TABLES = {
    "tms": (
        ["accession_number", "title", "object_name", "classification", "medium", "department", "dimensions"],
        ["68.1", "Jug", "Jug", "Ceramics", "stoneware", "Hall 2", "H: 30.5 cm, W: 12 cm, D: 9 cm"],
    ),
    "museumplus_list": (
        ["Inventarnummer", "Titel", "Sachbegriff", "Material/Technik", "Aktueller Standort", "Maße"],
        ["68.1", "Jug", "Jug", "stoneware", "Hall 2", "H 30,5 cm; B 12 cm; T 9 cm"],
    ),
    "collectionspace": (
        ["objectNumber", "title", "objectName", "material", "computedCurrentLocation", "dimensionSummary"],
        ["68.1", "Jug", "Jug", "stoneware", "Hall 2", "overall: 30.5 x 12 x 9 cm"],
    ),
    "collectiveaccess": (
        [
            *("Object identifier", "Preferred labels", "Type", "Materials", "Current location"),
            *("Height", "Width", "Depth", "Weight"),
        ],
        ["68.1", "Jug", "Jug", "stoneware", "Hall 2", "30.5 cm", "12 cm", "90 mm", "2.5 kg"],
    ),
}


def written(name: str, folder: Path) -> Path:
    """Write the sample of a preset that reads a table, as its mapping says."""
    head, row = TABLES[name]
    source = load_mapping(name).source
    path = folder / f"{name}.{source.format}"
    if source.format == "xlsx":
        book = openpyxl.Workbook()
        for cells in (head, row):
            book.worksheets[0].append(cells)
        book.save(path)
        return path
    with path.open("w", encoding=source.encoding, newline="") as stream:
        csv.writer(stream, delimiter=source.delimiter).writerows([head, row])
    return path


@pytest.mark.parametrize("name", sorted(TABLES))
def test_a_table_of_each_system(name: str, tmp_path: Path) -> None:
    reading = read_items(written(name, tmp_path), load_mapping(name))
    (item,) = reading.items
    assert (item.object_number, item.title, item.medium, item.gallery) == ("68.1", "Jug", "stoneware", "Hall 2")
    assert (item.height_m, item.width_m, item.depth_m) == (0.305, 0.12, 0.09)
    assert item.mass_kg == (2.5 if "Weight" in TABLES[name][0] else None)
    assert item.problems == ()


def test_a_lenders_objects_are_planned_loans(tmp_path: Path) -> None:
    """EODEM is a profile of LIDO 1.1; the place of the lender is not where the loan will stand."""
    sizes = measurements(measured("height", "30.5"), measured("width", "12"), measured("weight", "2.5", "kg"))
    path = tmp_path / "loan.xml"
    path.write_bytes(wrap(record(number="L 7", place="The lender's store", sizes=sizes), version="1.1"))
    (item,) = read_items(path, load_mapping("eodem")).items
    assert (item.object_number, item.gallery, item.on_loan) == ("L 7", "Planned exhibition", True)
    assert (item.height_m, item.width_m, item.mass_kg) == (0.305, 0.12, 2.5)


def check(museum: Newcomer, reading: Reading) -> None:
    items = {item.object_number: item for item in reading.items}
    assert reading.rejected == ()
    assert set(items) == {one.number for one in museum.things}
    for one in museum.things:
        item = items[one.number]
        assert (one.place in item.gallery, item.on_display, item.object_name) == (True, one.shown, one.name)
        assert item.height_m == (None if one.height is None else pytest.approx(0.01 * one.height, rel=1e-12))
        assert item.mass_kg == one.mass


def test_the_tables_of_tms_in_a_database_and_as_files(tmp_path: Path) -> None:
    museum = tms_like_database(tmp_path)
    check(museum, read_items(museum.where, load_mapping("tms_database")))
    folder = tmp_path / "tables"
    folder.mkdir()
    with closing(sqlite3.connect(tmp_path / "tms.sqlite")) as database:
        for (name,) in database.execute("SELECT name FROM sqlite_master WHERE type = 'table'").fetchall():
            found = database.execute(f'SELECT * FROM "{name}"')  # noqa: S608
            with (folder / f"{name}.csv").open("w", encoding="utf-8", newline="") as stream:
                writer = csv.writer(stream)
                writer.writerow([column[0] for column in found.description])
                writer.writerows(found)
    told = guess(folder)
    assert any("preset 'tms_database'" in said for said in told.sure)
    check(museum, read_items(folder, told.mapping))
