"""The survey as a workbook: a sheet to print and fill in (and import again), what comes first, and how to measure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from pipeline.collection.record import CHOICES
from pipeline.models import MODELS
from pipeline.quantities import LENGTHS, MASSES
from pipeline.records import DecisionKind, MeasurementRequest
from pipeline.report.files.rules_sheet import RULES_SHEET, write_rules
from pipeline.report.files.sheet_cells import HEADER_ROW, choice_of, headed, to_fill_in, write_cell
from pipeline.report.files.workbook import saved
from pipeline.report.units import Units
from pipeline.resources import replacing

if TYPE_CHECKING:
    from openpyxl.worksheet.worksheet import Worksheet

    from pipeline.analysis.house.questions import RuleQuestion
    from pipeline.analysis.survey import Measurable


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

    Parameters
    ----------
    models : sequence of str
        Names of the models, as the column "model" may name them.
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


SHOWN = ("object_number", "gallery", "title")
"""Columns that say which object it is."""

WHY = "why"

MASS = "mass_kg"
"""The field of masses; so its column was called, whatever the lengths, before it named pounds."""


def sheet_title(length: str) -> str:
    """Return the name of the sheet to fill in; it says the unit of all its lengths."""
    return f"survey in {length}"


def column_name(field: str, length: str) -> str:
    """Return the name of a field's column: lengths and pounds name their unit, the others are the fields themselves."""
    if field == MASS and mass_unit(length) != "kg":
        return f"mass [{mass_unit(length)}]"
    return f"{field.removesuffix('_m')} [{length}]" if field.endswith("_m") else field


def mass_unit(length: str) -> str:
    """Return the unit of masses where lengths are in that unit: pounds beside inches and feet."""
    return Units(length).symbol("kg")


def write_survey(
    path: Path,
    found: Sequence[MeasurementRequest],
    fields: Sequence[Measurable],
    *,
    length: str = "cm",
    rules: Sequence[RuleQuestion] = (),
) -> dict[str, int]:
    """Write the workbook of what is worth measuring; what would settle nothing is counted and left out.

    Parameters
    ----------
    found : sequence of MeasurementRequest
        Measurements, in the order in which they should be done.
    fields : sequence of Measurable
        All that a survey may ask for, with words and how to measure it.
    length : str, optional
        Unit of lengths.
    rules : sequence of RuleQuestion, optional
        Questions that one house rule answers for many objects.

    Returns
    -------
    mapping of str to int
        How many objects and quantities it asks for, and how many would settle nothing.
    """
    from openpyxl import Workbook

    asked = [request for request in found if not request.settles_nothing]
    book = Workbook()
    names = [m for m in fields if any(request.field == m.field for request in asked)]
    first = book.active
    if first is None:
        first = book.create_sheet()
    first.title = sheet_title(length)
    _fill_in(first, asked, names, length)
    write_rules(book.create_sheet(RULES_SHEET), rules, length)
    write_decisions(book.create_sheet(DECISIONS_SHEET), [model.name for model in MODELS])
    _ranking(book.create_sheet("what first"), asked, {m.field: m.label for m in fields})
    _how(book.create_sheet("how to measure"), names, length)
    path.parent.mkdir(parents=True, exist_ok=True)
    with replacing(path) as aside:
        aside.write_bytes(saved(book))
    return {
        "objects": len({request.object_number for request in asked}),
        "quantities": len(asked),
        "waste": len(found) - len(asked),
    }


def _fill_in(sheet: Worksheet, asked: Sequence[MeasurementRequest], fields: Sequence[Measurable], length: str) -> None:
    from openpyxl.styles import Alignment

    columns = [*SHOWN, *(m.field for m in fields), WHY]
    labels = ["Object", "Gallery", "Title", *(_labelled(m, length) for m in fields), "Why"]
    keys = [*SHOWN, *(column_name(m.field, length) for m in fields), WHY]
    sheet.append(labels)
    sheet.append(keys)
    objects: dict[str, list[MeasurementRequest]] = {}
    for request in asked:
        objects.setdefault(request.object_number, []).append(request)
    # By gallery, for a person walks from one to the next; in each the objects that settle most come first.
    order = sorted(objects.values(), key=lambda mine: mine[0].gallery)
    for row, mine in enumerate(order, start=HEADER_ROW + 1):
        why = "; ".join(_reason(request, length) for request in mine)
        texts = {"object_number": mine[0].object_number, "gallery": mine[0].gallery, "title": mine[0].title, WHY: why}
        wanted = {request.field for request in mine}
        for at, name in enumerate(columns, start=1):
            cell = sheet.cell(row, at)
            if name in texts:
                write_cell(cell, texts[name])
                cell.alignment = Alignment(wrap_text=True, vertical="top")
            if name in wanted:
                to_fill_in(cell)
    for at, m in enumerate(fields, start=len(SHOWN) + 1):
        if m.field in CHOICES:
            choice_of(sheet, [one.value for one in CHOICES[m.field]], at, HEADER_ROW + 1, HEADER_ROW + len(order))
    headed(sheet, [16, 24, 32, *(14 for _ in fields), 60], rows=HEADER_ROW)
    sheet.freeze_panes = sheet.cell(HEADER_ROW + 1, len(SHOWN) + 1)


def _ranking(sheet: Worksheet, asked: Sequence[MeasurementRequest], labels: Mapping[str, str]) -> None:
    sheet.append(["Gallery", "Quantity", "Objects", "What it would settle", "Models it would make possible"])
    totals: dict[tuple[str, str], list[float]] = {}
    for request in asked:
        total = totals.setdefault((request.gallery, request.field), [0, 0.0, 0])
        total[0] += 1
        total[1] += request.settles
        total[2] += request.unlocks
    ranked = sorted(totals.items(), key=lambda entry: (-(entry[1][1] + entry[1][2]), entry[0]))
    for row, ((gallery, field), (objects, settles, unlocks)) in enumerate(ranked, start=2):
        write_cell(sheet.cell(row, 1), gallery)
        write_cell(sheet.cell(row, 2), labels[field])
        for at, number in ((3, objects), (4, round(settles, 1)), (5, unlocks)):
            sheet.cell(row, at).value = number
    headed(sheet, [32, 36, 10, 22, 26], rows=1)


def _how(sheet: Worksheet, fields: Sequence[Measurable], length: str) -> None:
    from openpyxl.styles import Alignment

    sheet.append(["Quantity", "Column", "How to measure it"])
    for row, m in enumerate(fields, start=2):
        for at, text in enumerate((m.label, column_name(m.field, length), m.how), start=1):
            write_cell(sheet.cell(row, at), text)
            sheet.cell(row, at).alignment = Alignment(wrap_text=True, vertical="top")
    headed(sheet, [36, 24, 100], rows=1)


def _labelled(m: Measurable, length: str) -> str:
    unit, _per = _cell_unit(m.unit, length)
    return f"{m.label} ({unit})" if unit else m.label


def _cell_unit(unit: str, length: str) -> tuple[str, float]:
    """Return the unit of a cell to fill in, "" for a ratio, and what a number in it is multiplied by to be in SI."""
    if unit == "m":
        return length, LENGTHS[length]
    if unit == "kg":
        return mass_unit(length), MASSES[mass_unit(length)]
    return "" if unit == "-" else unit, 1.0


def _reason(request: MeasurementRequest, length: str) -> str:
    if request.unlocks:
        return f"{column_name(request.field, length)}: {request.reason}, without it nothing can be said"
    span = ""
    if request.low is not None and request.high is not None:
        unit, per = _cell_unit(request.unit, length)
        span = f"{request.low / per:.3g} to {request.high / per:.3g} {unit}".strip()
        span = f", taken as {span} now"
    if request.drawn:
        chance = f"{100.0 * min(request.settles, 1.0):.0f} %"
        return f"{column_name(request.field, length)}: changes what is decided with a chance of {chance}{span}"
    return f"{column_name(request.field, length)}: settles {request.settles:.2g} of {request.open} open verdicts{span}"
