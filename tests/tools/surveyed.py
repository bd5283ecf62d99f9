"""A museum whose survey's workbook was written by the command, and somebody who fills it in."""

from __future__ import annotations

import shutil
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import openpyxl

from pipeline.collection.database import open_database
from pipeline.collection.inventory import read_inventory
from pipeline.records import Item
from tests.museum import kouros, short_site, workspace

OBJECTS = [f"1922.{n}" for n in range(1, 41)]
SHEET = "survey in cm"


def museum_with_survey(folder: Path) -> None:
    """Forty vases that nobody measured, and `s.xlsx`, which asks for their sizes."""
    folder.mkdir(exist_ok=True)
    workspace(folder, [f"{number},East,Vase,,," for number in OBJECTS], site="site")
    short_site(folder)
    for words in (("import", "export.csv", "--mapping", "mapping.toml"), ("survey", "--out", "s.xlsx")):
        done = kouros("-q", *words, folder=folder)
        assert done.returncode == 0, done.stderr


def copied(museum: Path, folder: Path) -> Path:
    return Path(shutil.copytree(museum, folder / "museum", symlinks=True))


def row_of(sheet: Any, number: str) -> int:
    """Return the row of an object."""
    return next(r for r in range(3, sheet.max_row + 1) if sheet.cell(r, 1).value == number)


def fill(path: Path, cells: Mapping[tuple[str, str], Any], *, into: Path | None = None) -> Path:
    """Fill in cells of the sheet of measurements, each by the number of its object and the name of its column."""
    book = openpyxl.load_workbook(path)
    sheet = book[SHEET]
    names = [cell.value for cell in sheet[2]]
    for (number, column), value in cells.items():
        sheet.cell(row_of(sheet, number), names.index(column) + 1).value = value
    book.save(into or path)
    return into or path


def write_rows(path: Path, title: str, *rows: Mapping[str, Any]) -> Path:
    """Fill in the first free rows of another sheet, by the names of its columns."""
    book = openpyxl.load_workbook(path)
    sheet = book[title]
    names = [cell.value for cell in sheet[2]]
    free = (r for r in range(3, 200) if not any(sheet.cell(r, at + 1).value for at in range(len(names))))
    for row, at in zip(rows, free, strict=False):
        for name, value in row.items():
            sheet.cell(at, names.index(name) + 1).value = value
    book.save(path)
    return path


def inventory(folder: Path) -> dict[str, Item]:
    """Return the museum's objects by their numbers."""
    return {item.object_number: item for item in read_inventory(open_database(folder / "kouros.sqlite"))}
