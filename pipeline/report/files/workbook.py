"""The exports as one workbook: a sheet a table, under the names that the text files have."""

from collections.abc import Iterable, Mapping, Sequence
from datetime import datetime
from io import BytesIO
from itertools import islice
from math import isfinite, isnan
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo

from pipeline.report.text import clean

_MOST = 32_767
"""Characters that a cell of a spreadsheet can hold."""

_ROWS = 1_048_575
"""Rows below the header that a sheet can hold; more go on in another sheet."""

_TAKEN_AMISS = ("=", "#")
"""What a text begins with that openpyxl would take for a formula, or for an error as "#N/A" is one."""

_DATE = (1980, 1, 1, 0, 0, 0)


def write_workbook(
    path: Path, sheets: Mapping[str, tuple[Sequence[str], Iterable[Mapping[str, Any]]]], made: datetime
) -> None:
    """Write tables to a workbook, row by row; equal tables give equal bytes.

    Parameters
    ----------
    sheets : Mapping[str, tuple[Sequence[str], Iterable[Mapping[str, Any]]]]
        Name -> (columns, rows); a text is written as text whatever it begins with, a number that no cell can hold as
        the text "inf" or "-inf", what is unknown as an empty cell, a list joined by "; ".
    made : datetime
        When the run began, as the workbook's own date.
    """
    from openpyxl import Workbook
    from openpyxl.styles import Font
    from openpyxl.utils import get_column_letter

    book, font = Workbook(write_only=True), Font(bold=True)
    for name, (columns, rows) in sheets.items():
        waiting, number = iter(rows), 1
        batch = list(islice(waiting, _ROWS))
        while batch or number == 1:
            sheet = book.create_sheet(name if number == 1 else f"{name} {number}")
            sheet.freeze_panes = "A2"
            for at, column in enumerate(columns, start=1):
                sheet.column_dimensions[get_column_letter(at)].width = max(12, min(40, len(column) + 4))
            sheet.append([_header(sheet, column, font) for column in columns])
            for row in batch:
                sheet.append([_cell(sheet, row[column]) for column in columns])
            batch, number = list(islice(waiting, _ROWS)), number + 1
    book.properties.creator, book.properties.lastModifiedBy = "Kouros", "Kouros"
    book.properties.created = book.properties.modified = made
    path.write_bytes(_steady(saved(book), made))


def saved(book: Any) -> bytes:
    """Return a workbook as the bytes of its file.

    Not into the file at once: where the disk is full, openpyxl leaves a zip behind that tries again when it is
    forgotten, and then prints a traceback.
    """
    content = BytesIO()
    book.save(content)
    return content.getvalue()


def _header(sheet: Any, column: str, font: Any) -> Any:
    from openpyxl.cell import WriteOnlyCell

    cell = WriteOnlyCell(sheet, column)
    cell.font = font
    return cell


def _cell(sheet: Any, value: object) -> Any:
    """Return what openpyxl is given for a value: a cell of our own costs three times what a plain value does."""
    if value is None or (isinstance(value, float) and isnan(value)):
        return None
    if isinstance(value, bool | int) or (isinstance(value, float) and isfinite(value)):
        return value
    text = "; ".join(str(part) for part in value) if isinstance(value, list) else str(value)
    if text[:1] not in _TAKEN_AMISS:
        return clean(text)[:_MOST]
    from openpyxl.cell import WriteOnlyCell

    cell = WriteOnlyCell(sheet)
    write_text(cell, text)
    return cell


def write_text(cell: Any, text: str) -> None:
    """Write a text into a cell as a text, whatever it begins with; what no cell can hold is replaced or cut."""
    # XML refuses more than openpyxl does: U+FFFE in one title would end the night.
    cell.value = clean(text)[:_MOST]
    # A leading "=" makes openpyxl write a formula, unless the type says that it is a text.
    cell.data_type = "s"


def _steady(content: bytes, made: datetime) -> bytes:
    """Return a workbook with one date in place of the clock's, which a zip and openpyxl's properties would keep."""
    stamp = made.strftime("%Y-%m-%dT%H:%M:%SZ").encode()
    steady = BytesIO()
    with ZipFile(BytesIO(content)) as old, ZipFile(steady, "w", ZIP_DEFLATED) as new:
        for info in old.infolist():
            data = old.read(info.filename)
            if info.filename == "docProps/core.xml":
                data = _stamped(data, stamp)
            fixed = ZipInfo(info.filename, _DATE)
            fixed.compress_type = ZIP_DEFLATED
            new.writestr(fixed, data)
    return steady.getvalue()


def _stamped(properties: bytes, stamp: bytes) -> bytes:
    import re

    return re.sub(rb"(<dcterms:(?:created|modified)[^>]*>)[^<]*", rb"\g<1>" + stamp, properties)
