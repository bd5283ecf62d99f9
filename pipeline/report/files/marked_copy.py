"""A copy of a workbook that came back, with the cells marked that were refused: why, and what mends each."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pipeline.report.files.sheet_cells import HEADER_ROW, to_fill_in
from pipeline.report.files.workbook import saved
from pipeline.report.text import clean, safe_cell
from pipeline.resources import replacing

AUTHOR = "Kouros"

_RED = "FFF4B6A6"
_LONGEST = 800


@dataclass(frozen=True, slots=True)
class CellFault:
    """A cell that was refused; column "" is the whole row, row 0 the whole sheet."""

    sheet: str
    row: int
    column: str
    message: str
    remedy: str

    @property
    def place(self) -> str:
        """Where it is, in words."""
        return ", ".join(filter(None, [f"sheet {self.sheet!r}", f"row {self.row}" if self.row else "", self.column]))

    def __str__(self) -> str:
        return f"{self.place}: {self.message}; {self.remedy}"


def write_listed(faults: Sequence[CellFault], target: Path) -> None:
    """Write the refused cells as a text, a line each, for a file in which none can be marked."""
    target.parent.mkdir(parents=True, exist_ok=True)
    with replacing(target) as aside:
        aside.write_text("".join(f"{clean(str(fault))[:_LONGEST]}\n" for fault in faults), encoding="utf-8")


def write_marked(path: Path, faults: Sequence[CellFault], target: Path) -> None:
    """Write the copy; marks of an earlier one are taken away first.

    Parameters
    ----------
    path : Path
        The workbook, which was read without being refused as a whole.
    target : Path
        The copy.
    """
    from openpyxl import load_workbook
    from openpyxl.comments import Comment
    from openpyxl.styles import PatternFill

    book = load_workbook(path)
    for page in book.worksheets:
        for cell in [cell for row in page.iter_rows() for cell in row if cell.comment is not None]:
            if cell.comment.author == AUTHOR:
                cell.comment = None
                to_fill_in(cell)
    names = {page.title: page for page in book.worksheets}
    told: dict[tuple[str, int, int], list[str]] = {}
    for fault in faults:
        page = names.get(fault.sheet)
        if page is None:
            continue
        heads = {str(cell.value): cell.column for cell in page[HEADER_ROW]}
        at = heads.get(fault.column, 1)
        told.setdefault((fault.sheet, max(fault.row, 1), at), []).append(f"{fault.message}. {fault.remedy}.")
    for (sheet, row, at), words in told.items():
        page = names[sheet]
        cell = page.cell(row, at)
        # Of merged cells only the first one is seen, and can be marked.
        for merged in page.merged_cells.ranges:
            if cell.coordinate in merged:
                cell = page.cell(merged.min_row, merged.min_col)
        cell.fill = PatternFill("solid", fgColor=_RED)
        # What somebody else remarked on it stays, ours and more words of the same cell first.
        before = "" if cell.comment is None else f"\n{cell.comment.text}"
        comment = Comment(clean("\n".join(words) + before)[:_LONGEST], AUTHOR)
        comment.width, comment.height = 320, 120
        cell.comment = comment
    for page in book.worksheets:
        for row in page.iter_rows(min_row=HEADER_ROW + 1):
            for cell in row:
                # What was a text stays one, whatever it begins with.
                if isinstance(cell.value, str) and safe_cell(cell.value) != cell.value:
                    cell.data_type, cell.quotePrefix = "s", True
    target.parent.mkdir(parents=True, exist_ok=True)
    with replacing(target) as aside:
        aside.write_bytes(saved(book))
