"""The sheet "Rules" of a survey's workbook: questions that one house rule answers for many objects, to be filled in."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from pipeline.quantities import LENGTHS, counted, figures
from pipeline.report.files.sheet_cells import HEADER_ROW, headed, to_fill_in, write_cell
from pipeline.report.text import words

if TYPE_CHECKING:
    from openpyxl.worksheet.worksheet import Worksheet

    from pipeline.analysis.house.questions import RuleQuestion

RULES_SHEET = "Rules"

FOR = ("number", "class", "gallery", "medium", "support")
"""Columns that say what a rule is for; several entries of a cell are parted by `|`."""

STATES = ("states", "value", "low", "high", "unit")
"""Columns that say what it states: the field, and the value with its unit."""

SIGNED = ("said_by", "said_on")

_SPARE = 10
"""Rows without a question, for rules that nobody asked for."""

_LABELS = {
    "number": "Only these numbers",
    "class": "Class",
    "gallery": "Only these galleries",
    "medium": "Only with these words in the medium",
    "support": "Held so",
    "states": "What",
    "value": "Value (the best)",
    "low": "Lowest that may be",
    "high": "Highest that may be",
    "unit": "Unit",
    "said_by": "Who says so",
    "said_on": "When (2031-05-01)",
    "why": "Why",
}


def write_rules(sheet: Worksheet, questions: Sequence[RuleQuestion], length: str) -> None:
    """Write the questions, one a row; what is filled in becomes house rules.

    Parameters
    ----------
    questions : sequence of RuleQuestion
        What settles most first.
    length : str
        Unit of lengths.
    """
    from openpyxl.styles import Alignment
    from openpyxl.worksheet.datavalidation import DataValidation

    from pipeline.analysis.house.questions import VOCABULARIES

    columns = [*FOR, *STATES, *SIGNED, "why"]
    sheet.append([_LABELS[name] for name in columns])
    sheet.append(columns)
    lists = {}
    for field, vocabulary in VOCABULARIES.items():
        lists[field] = DataValidation(type="list", formula1=f'"{",".join(vocabulary)}"', allow_blank=True)
        sheet.add_data_validation(lists[field])
    for row, question in enumerate((*questions, *(None for _ in range(_SPARE))), start=HEADER_ROW + 1):
        texts = {} if question is None else _texts(question, length)
        for at, name in enumerate(columns, start=1):
            cell = sheet.cell(row, at)
            if name in texts:
                write_cell(cell, texts[name])
                cell.alignment = Alignment(wrap_text=True, vertical="top")
            if question is None or name in (*SIGNED, "value") or (name in ("low", "high") and question.unit):
                to_fill_in(cell)
        if question is not None and question.field in lists:
            lists[question.field].add(sheet.cell(row, columns.index("value") + 1).coordinate)
    headed(sheet, [16, 18, 20, 20, 14, 20, 14, 12, 12, 8, 20, 14, 70], rows=HEADER_ROW)


def _texts(question: RuleQuestion, length: str) -> dict[str, str]:
    per, unit = (LENGTHS[length], length) if question.unit == "m" else (1.0, question.unit)
    why = f"one answer for {counted(question.objects, 'object')}"
    if question.low is not None and question.high is not None:
        of = "" if unit == "-" else f" {unit}"
        why += f"; taken as {figures(question.low / per, 3)} to {figures(question.high / per, 3)}{of} now"
    if question.settles:
        why += f"; would settle about {counted(max(1, round(question.settles)), 'case')}"
    if question.unlocks:
        why += f"; without it {counted(question.unlocks, 'check')} cannot be made"
    if not (question.settles or question.unlocks):
        why += f"; {words(question.field)} is not recorded"
    return {**question.criteria, "states": question.field, "why": why} | ({} if unit in ("", "-") else {"unit": unit})
