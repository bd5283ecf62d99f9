"""Object numbers of a workbook are the characters that it shows; dates that it made of numbers are refused."""

from __future__ import annotations

import io
from datetime import date, datetime, time, timedelta
from pathlib import Path
from typing import Any

import openpyxl
import pytest

from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import Reading, read_items
from pipeline.collection.sources.shown import shown
from pipeline.collection.sources.xlsx import read_sheet

MAPPING = """
[source]
format = "xlsx"
[museum]
name = "Test"
[columns]
object_number = { column = "Inv.-Nr." }
gallery = { column = "Room" }
height_m = { column = "h", unit = "cm" }
"""


@pytest.mark.parametrize(
    ("value", "number_format", "text"),
    [
        # What Excel and LibreOffice show, by ECMA-376-1, 18.8.31.
        (1913.2, "0.00", "1913.20"),
        (1913.2, "General", "1913.2"),
        (1913.0999999999999, "General", "1913.1"),
        (1913, "General", "1913"),
        (1913, "0.00", "1913.00"),
        (42, "0000", "0042"),
        (12345, "0000", "12345"),
        (0, "0000", "0000"),
        (42, '"A-"0000', "A-0042"),
        (42, '0000"-b"', "0042-b"),
        (1913020, r"0000\.000", "1913.020"),
        (1913020, "0000-000", "1913-020"),
        (5551234567, "(000) 000-0000", "(555) 123-4567"),
        (1913.2, "#,##0.00", "1,913.20"),
        (1234567, "#,##0", "1,234,567"),
        (12, "#,##0", "12"),
        (0.5, "#.##", ".5"),
        (0.5, "0.##", "0.5"),
        (1913.204, "0.00", "1913.20"),
        (-7, "0000", "-0007"),
        (-7, "0;(0)", "(7)"),
        (0, '0;-0;"none"', "none"),
        (1913.25, "@", "1913.25"),
        (1913.2, '0.00_);[Red]"x"0', "1913.20 "),
        (123456789012345, "General", "123456789012345"),
        # Of other kinds of formats it is not known.
        (0.5, "0%", None),
        (0.5, "# ?/?", None),
        (1e10, "0.00E+00", None),
        (5, "[>3]0;00", None),
        (1913000, "0,", None),
        (5, "yyyy", None),
    ],
)
def test_a_number_is_shown_as_a_spreadsheet_does(value: float, number_format: str, text: str | None) -> None:
    assert shown(value, number_format) == text


def book(path: Path, rows: list[list[tuple[Any, str]]]) -> Path:
    made = openpyxl.Workbook()
    page = made.active
    page.append(["Inv.-Nr.", "Room", "h"])
    for at, row in enumerate(rows, 2):
        for place, (value, number_format) in enumerate(row, 1):
            page.cell(at, place, value).number_format = number_format
    made.save(path)
    return path


def read(folder: Path, rows: list[list[tuple[Any, str]]]) -> Reading:
    (folder / "m.toml").write_text(MAPPING, encoding="utf-8")
    return read_items(book(folder / "x.xlsx", rows), load_mapping(folder / "m.toml"))


def test_numbers_of_objects_and_rooms_keep_what_is_shown_and_sizes_their_digits(tmp_path: Path) -> None:
    room, height = (2.1, "0.00"), (12.345, "0.0")
    (found,) = read(tmp_path, [[(1913.2, "0.00"), room, height]]).items
    assert (found.object_number, found.gallery, found.height_m) == ("1913.20", "2.10", 0.12345)
    twins = read(tmp_path, [[(1913.2, "0.00"), room, height], [(1913.2, "0.0"), room, height]])
    assert [item.object_number for item in twins.items] == ["1913.20", "1913.2"], "two objects, and not one twice"


@pytest.mark.parametrize(
    ("value", "number_format", "told"),
    [
        (date(1920, 5, 13), "yyyy-mm-dd", "holds a date (1920-05-13), which a spreadsheet made of what was typed"),
        (datetime(1920, 5, 13, 7, 8), "mmm-yy", "holds a date (1920-05-13T07:08:00)"),
        (time(3, 4), "h:mm", "holds a date (03:04:00)"),
        (timedelta(hours=30), "[h]:mm", "holds a date"),
        (0.5, "0%", "holds 0.5 in the format '0%', which shows another text"),
    ],
)
def test_what_is_no_number_of_an_object_is_refused_with_the_remedy(
    tmp_path: Path, value: Any, number_format: str, told: str
) -> None:
    reading = read(
        tmp_path, [[("A 1", "General"), ("Hall", "@"), (1, "0")], [(value, number_format), ("B", "@"), (1, "0")]]
    )
    (out,) = reading.rejected
    assert (out.row, out.field) == (2, "object_number")
    assert told in out.message
    assert "format the column as text, and type the number again" in out.remedy


def test_a_column_that_is_not_named_is_read_as_before() -> None:
    made = openpyxl.Workbook()
    page = made.active
    page.append(["a", "b"])
    page.append([1913.2, 42])
    page["A2"].number_format, page["B2"].number_format = "0.00", "0000"
    stream = io.BytesIO()
    made.save(stream)
    rows = list(read_sheet(stream, "m.xlsx"))
    assert rows[1].cells == ["1913.2", "0042"]
    named = list(read_sheet(stream, "m.xlsx", key="a"))
    assert named[1].cells == ["1913.20", "0042"]
