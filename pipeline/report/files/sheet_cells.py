"""Cells of the sheets that people print and fill in."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from pipeline.report.files.workbook import write_text
from pipeline.report.text import safe_cell

if TYPE_CHECKING:
    from openpyxl.worksheet.worksheet import Worksheet

HEADER_ROW = 2
"""The row of the column names that the import reads; above it stand the words for people."""

_LIST = 250
"""Characters that a list of a drop-down can hold, nearly."""

_INK = "FF1F2A37"
_QUIET = "FF6B7280"
_FILL = "FFFFF6DB"
_LINE = "FF9CA3AF"


def to_fill_in(cell: Any) -> None:
    """Mark a cell as one that is to be filled in."""
    from openpyxl.styles import Border, PatternFill, Side

    cell.fill = PatternFill("solid", fgColor=_FILL)
    # A text: of 1/2 a spreadsheet would make a date, and of 8 1/2 whatever its language likes.
    cell.number_format = "@"
    cell.border = Border(*(Side(style="thin", color=_LINE) for _ in range(4)))


def choice_of(sheet: Worksheet, words: Sequence[str], column: int, first: int, last: int) -> None:
    """Let cells of a column be chosen from some words, which together have 255 characters at most."""
    from openpyxl.utils import get_column_letter
    from openpyxl.worksheet.datavalidation import DataValidation

    listed = ",".join(words)
    if last < first or len(listed) > _LIST:
        return
    choice = DataValidation(type="list", formula1=f'"{listed}"', allow_blank=True, showErrorMessage=True)
    choice.errorTitle, choice.error = "Kouros", f"One of {', '.join(words)}"[:_LIST]
    sheet.add_data_validation(choice)
    letter = get_column_letter(column)
    choice.add(f"{letter}{first}:{letter}{last}")


def headed(sheet: Worksheet, widths: Sequence[int], *, rows: int) -> None:
    """Set the widths of a sheet's columns, and its first rows apart as heads that every printed page repeats."""
    from openpyxl.styles import Alignment, Font
    from openpyxl.utils import get_column_letter

    for at, width in enumerate(widths, start=1):
        sheet.column_dimensions[get_column_letter(at)].width = width
        for row in range(1, rows + 1):
            cell = sheet.cell(row, at)
            cell.font = Font(bold=row == 1, color=_INK if row == 1 else _QUIET, size=10 if row == 1 else 8)
            cell.alignment = Alignment(wrap_text=True, vertical="bottom")
    sheet.page_setup.orientation = "landscape"
    sheet.page_setup.fitToWidth, sheet.page_setup.fitToHeight = 1, 0
    sheet.sheet_properties.pageSetUpPr.fitToPage = True
    sheet.print_title_rows = f"1:{rows}"
    # With arrows on the last of the heads, sorting by them leaves both rows of heads where they are.
    sheet.auto_filter.ref = f"A{rows}:{get_column_letter(len(widths))}{max(sheet.max_row, rows)}"
    if sheet.freeze_panes is None:
        sheet.freeze_panes = sheet.cell(rows + 1, 1)


def write_cell(cell: Any, text: str) -> None:
    """Write a text into a cell that people may edit: it comes back as it is."""
    write_text(cell, text)
    # Object numbers must come back as they are: in a sheet that people edit a quotation prefix keeps the text one.
    if safe_cell(text) != text:
        cell.quotePrefix = True
