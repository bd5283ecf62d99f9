"""Numbers that a source holds as numbers beside texts with decimal commas: each is read as it is meant."""

import json
import sqlite3
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest
from openpyxl import Workbook

from pipeline.collection.guess import guess
from pipeline.collection.reading import read_items

NAMES = ("inv_nr", "titel", "hoehe_cm", "breite_cm", "gewicht_kg")
ROWS = [
    ("1987.12", "Madonna", 112.5, 38.25, "46"),
    ("1987.13", "Pokal", 38.2, 14.0, "2,1"),
    ("1990.4", "Vase", 45, 22.5, "3,4"),
    ("1990.5", "Teller", 3.5, 27.25, "0,6"),
]


def workbook(folder: Path) -> str:
    book = Workbook()
    sheet = book.active
    assert sheet is not None
    for row in (NAMES, *ROWS):
        sheet.append(row)
    book.save(folder / "own.xlsx")
    return str(folder / "own.xlsx")


def database(folder: Path) -> str:
    with closing(sqlite3.connect(folder / "own.sqlite")) as connection:
        connection.execute(
            "CREATE TABLE objekte (inv_nr TEXT, titel TEXT, hoehe_cm REAL, breite_cm REAL, gewicht_kg TEXT)"
        )
        connection.executemany("INSERT INTO objekte VALUES (?, ?, ?, ?, ?)", ROWS)
        connection.commit()
    return f"sqlite:///{folder / 'own.sqlite'}"


def lines(folder: Path) -> str:
    (folder / "own.json").write_text(json.dumps([dict(zip(NAMES, row, strict=True)) for row in ROWS]), "utf-8")
    return str(folder / "own.json")


@pytest.mark.parametrize("source", [workbook, database, lines])
def test_typed_numbers_keep_their_point_beside_texts_with_commas(source: Callable[[Path], str], tmp_path: Path) -> None:
    """Before: of a workbook in which some had typed 2,1 as text either these or all fractions of numbers were lost."""
    where = source(tmp_path)
    mapping = guess(where).mapping
    assert mapping.source.decimal == ","
    found = read_items(where, mapping)
    assert not [problem for item in found.items for problem in item.problems]
    for item, (number, _, height, width, mass) in zip(found.items, ROWS, strict=True):
        assert item.object_number == number
        assert (item.height_m, item.width_m) == pytest.approx((height / 100.0, width / 100.0))
        assert item.mass_kg == pytest.approx(float(mass.replace(",", ".")))
