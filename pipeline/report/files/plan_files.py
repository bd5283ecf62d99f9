"""The plan's files: what it is made of, read from the exports of a report, and its errands as a table and a sheet."""

import csv
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import fsum
from pathlib import Path
from typing import Any

from pipeline.analysis.stakes import expected_loss
from pipeline.planning.errands import Advised, Errand, advised, deciding, loss_left
from pipeline.planning.plan import ErrandPlan, PlanTerms, gallery_order, plan_of
from pipeline.records import DecisionStatus, Found, Page
from pipeline.report.files.exports import sentence_of
from pipeline.report.files.sheet_cells import headed, to_fill_in, write_cell
from pipeline.report.files.workbook import saved
from pipeline.report.pages.compose import anchor_of, page_name
from pipeline.report.pages.decided import Decided
from pipeline.report.pages.errand_views import number, said_of, title_of
from pipeline.report.pages.tallies import state_of
from pipeline.report.pages.views import State
from pipeline.report.text import safe_cell
from pipeline.report.units import Units
from pipeline.resources import replacing

PLAN_FILES = ("plan.html", "plan.csv")
"""The page of a report, and the list of all errands beside it."""

PLANNED_FROM = ("recommendations.parquet", "objects.parquet")
"""The exports of a report that a plan is made of."""

PLAN_COLUMNS = (
    "errand", "needs", "do", "place", "gallery", "case", "objects", "measure", "title", "sentence", "trade",
    "hours", "hours_low", "hours_high", "cost", "cost_low", "cost_high", "loss", "avoided", "takes_from_view", "page",
)  # fmt: skip

_COUNTED = (State.ACT.value, State.WATCH.value, State.UNKNOWN.value)
_OBJECT = (
    "object_number", "title", "gallery", "case", "on_display", "state", "probability", "harm_level", "expected_loss",
    "check_sizes", "page",
)  # fmt: skip
_ADVICE = ("object_number", "gallery", "level", "measure", "title", "sentence", "remaining", "settled")


@dataclass
class Gathered:
    """What a plan is made of, gathered object by object.

    Attributes
    ----------
    advised : list of Advised
        The objects to act on that nobody has settled.
    losses : list of float
        What is expected to be lost of each object on display, where that is known.
    counts : dict of str to list of int
        By gallery how many objects are to act on, to watch, and cannot be assessed.
    """

    advised: list[Advised] = field(default_factory=list)
    losses: list[float] = field(default_factory=list)
    counts: dict[str, list[int]] = field(default_factory=dict)

    def count(self, gallery: str, state: str, loss: float | None) -> None:
        """Count an object on display."""
        here = self.counts.setdefault(gallery, [0] * len(_COUNTED))
        if state in _COUNTED:
            here[_COUNTED.index(state)] += 1
        if loss is not None:
            self.losses.append(loss)

    def plan(self, terms: PlanTerms) -> ErrandPlan:
        """Return the plan on some terms."""
        return plan_of(self.advised, fsum(self.losses), gallery_order(self.counts), terms)


def gathered_from(folder: Path) -> Gathered:
    """Return what a plan is made of from the exports of a report.

    Parameters
    ----------
    folder : Path
        With objects.parquet and recommendations.parquet.
    """
    advice = {
        (row["object_number"], row["gallery"], row["level"]): row
        for row in _rows(folder / PLANNED_FROM[0], _ADVICE)
        if not row["settled"]
    }
    out = Gathered()
    for row in _rows(folder / PLANNED_FROM[1], _OBJECT):
        if not row["on_display"]:
            continue
        loss, chance = row["expected_loss"], row["probability"]
        out.count(row["gallery"], row["state"], loss)
        told = advice.get((row["object_number"], row["gallery"], row["harm_level"]))
        if told is not None and loss is not None:
            left = loss_left(loss, chance, told["remaining"])
            names = (row["object_number"], row["title"], row["gallery"], row["case"].strip())
            out.advised.append(
                Advised(
                    *names, told["measure"], told["title"], told["sentence"], loss, left, row["page"],
                    bool(row.get("check_sizes")),
                )
            )  # fmt: skip
    return out


def _rows(file: Path, columns: Sequence[str]) -> Iterator[Mapping[str, Any]]:
    import pyarrow.parquet as pq

    with pq.ParquetFile(file) as table:
        for batch in table.iter_batches(columns=list(columns)):
            yield from batch.to_pylist()


def gathered(
    pages: Iterable[tuple[Page, Found]],
    decisions: Sequence[DecisionStatus],
    units: Units,
    galleries: Sequence[str] = (),
) -> Gathered:
    """Return what a plan is made of from the results of a run.

    Parameters
    ----------
    pages : iterable of (Page, Found)
        Of the run.
    decisions : sequence of DecisionStatus
        As they stood then.
    units : Units
        The reader's.
    galleries : sequence of str
        Only these; none named means all.
    """
    out, decided = Gathered(), Decided(decisions, units)
    for page, found in pages:
        if not page.on_display or (galleries and page.gallery not in galleries):
            continue
        file = page_name(page.gallery, page.number)
        for one in found.assessments:
            loss = None if one.likelihood is None else expected_loss(one)
            out.count(one.scene.item.gallery, state_of(one).value, loss)
            advice = deciding(one)
            if advice is not None and not decided.covered(one, advice.level):
                place = f"{file}#{anchor_of(one.scene.item.object_number)}"
                told = advised(one, sentence_of(advice, units), place)
                out.advised += [] if told is None else [told]
    return out


def write_plan_table(file: Path, plan: ErrandPlan) -> None:
    """Write all errands of a plan as CSV, in walking order; as in other exports no text is a formula.

    Raises
    ------
    OSError
        Where it cannot be written, such as a disk that is full.
    """
    with file.open("w", encoding="utf-8", newline="") as stream:
        writer = csv.writer(stream, lineterminator="\n")
        writer.writerow(PLAN_COLUMNS)
        for at, one in enumerate(plan.errands):
            row = errand_row(plan, at, one)
            writer.writerow([_cell(row[name]) for name in PLAN_COLUMNS])


def errand_row(plan: ErrandPlan, at: int, one: Errand) -> dict[str, Any]:
    """Return an errand as a row of the list, by `PLAN_COLUMNS`.

    Parameters
    ----------
    plan : ErrandPlan
        That it is of.
    at : int
        Its place.
    one : Errand
        The errand itself.
    """
    return {
        "errand": at + 1,
        "needs": "" if one.needs is None else one.needs + 1,
        "do": at in plan.choice.chosen,
        "place": plan.ranks.get(at, ""),
        "gallery": one.gallery,
        "case": one.case,
        "objects": "; ".join(object_.object_number for object_ in one.objects),
        "measure": one.measure,
        "title": title_of(one),
        "sentence": " ".join(said_of(one)),
        "trade": one.trade,
        "hours": one.hours.value,
        "hours_low": one.hours.low,
        "hours_high": one.hours.high,
        "cost": one.cost.value,
        "cost_low": one.cost.low,
        "cost_high": one.cost.high,
        "loss": one.loss,
        "avoided": one.avoided,
        "takes_from_view": one.away,
        "page": one.objects[0].page,
    }


def _cell(value: object) -> str:
    match value:
        case bool():
            return "yes" if value else "no"
        case float():
            return f"{value:.12g}"
        case _:
            return safe_cell(str(value))


_HEADS = (
    ("Done", 7), ("Gallery", 22), ("Case", 12), ("Objects", 22), ("What to do", 60), ("Trade", 12), ("Hours", 8),
    ("Cost", 9), ("Avoids", 9), ("Needs first", 9), ("By, and when", 16),
)  # fmt: skip


def write_plan_sheet(file: Path, plan: ErrandPlan) -> None:
    """Write a workbook to print and tick off: what to do in walking order, and what takes objects from view.

    Raises
    ------
    OSError
        Where it cannot be written.
    """
    from openpyxl import Workbook

    book = Workbook()
    first = book.active
    if first is None:
        first = book.create_sheet()
    first.title = "Plan"
    _listed(first, plan, sorted(plan.choice.chosen))
    if plan.away:
        _listed(book.create_sheet("To decide with a curator"), plan, plan.away)
    file.parent.mkdir(parents=True, exist_ok=True)
    with replacing(file) as aside:
        aside.write_bytes(saved(book))


def _listed(sheet: Any, plan: ErrandPlan, places: Sequence[int]) -> None:
    from openpyxl.styles import Alignment

    numbered = {at: row for row, at in enumerate(places, start=2)}
    sheet.append([name for name, _ in _HEADS])
    for at in places:
        one, row = plan.errands[at], numbered[at]
        share = plan.share_of(one.avoided)
        needs = numbered.get(-1 if one.needs is None else one.needs)
        texts = {
            2: one.gallery,
            3: one.case,
            4: ", ".join(object_.object_number for object_ in one.objects),
            5: f"{title_of(one)}: {' '.join(said_of(one))}",
            6: one.trade,
            7: number(one.hours.value),
            8: number(one.cost.value),
            9: f"{share:.2%}",
            10: "" if needs is None else f"row {needs}",
        }
        for column, text in texts.items():
            write_cell(sheet.cell(row, column), text)
            sheet.cell(row, column).alignment = Alignment(wrap_text=True, vertical="top")
        for column in (1, len(_HEADS)):
            to_fill_in(sheet.cell(row, column))
    headed(sheet, [width for _, width in _HEADS], rows=1)
