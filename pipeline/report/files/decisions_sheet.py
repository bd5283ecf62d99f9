"""The sheet "Decisions" of a survey's workbook: what people decide about objects, one row a decision, to fill in."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from pipeline.records import DecisionKind
from pipeline.report.files.sheet_cells import HEADER_ROW, choice_of, headed, to_fill_in

if TYPE_CHECKING:
    from openpyxl.worksheet.worksheet import Worksheet

DECISIONS_SHEET = "Decisions"

COLUMNS = ("object_number", "decision", "what", "model", "level", "until", "why", "who", "date")

DECISIONS = tuple(
    word
    for kind in DecisionKind
    for word in (("verdict pass", "verdict fail") if kind is DecisionKind.VERDICT else (kind.value,))
)
"""What a cell of the column "decision" may hold."""

_ROWS = 60
"""Rows to be filled in."""

_LABELS = {
    "object_number": "Object",
    "decision": "Decision",
    "what": "What: the measure with NAME=VALUE (4in, 10cm, 3lb; else SI), the class, or the id",
    "model": "Only this model",
    "level": "Only this level",
    "until": "Until (2031-05-01)",
    "why": "Why",
    "who": "Who decides",
    "date": "When (2031-05-01)",
}


def write_decisions(sheet: Worksheet, models: Sequence[str]) -> None:
    """Write the empty sheet.

    models : names of the models, as the column "model" may name them
    """
    sheet.append([_LABELS[name] for name in COLUMNS])
    sheet.append(COLUMNS)
    last = HEADER_ROW + _ROWS
    for row in range(HEADER_ROW + 1, last + 1):
        for at in range(1, len(COLUMNS) + 1):
            to_fill_in(sheet.cell(row, at))
    for name, words in (("decision", DECISIONS), ("model", models)):
        choice_of(sheet, words, COLUMNS.index(name) + 1, HEADER_ROW + 1, last)
    headed(sheet, [18, 14, 40, 18, 14, 16, 50, 22, 16], rows=HEADER_ROW)
