"""Answers of a survey's sheet "Decisions": each row as if somebody had put it to `kouros decide`, and each once."""

import shlex
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from pipeline.collection.sources.xlsx import read_sheet as rows_of_sheet
from pipeline.collection.sources.xlsx import visible_sheets
from pipeline.errors import InputError
from pipeline.operations.workspace import Workspace
from pipeline.records import Decision, DecisionKind
from pipeline.report.files.decisions_sheet import COLUMNS, DECISIONS, DECISIONS_SHEET
from pipeline.report.files.marked_copy import CellFault
from pipeline.report.files.sheet_cells import HEADER_ROW
from pipeline.store.decisions import read_decisions
from pipeline.tools.decisions import Wish, decide

_OPTIONS = {"--why": "why", "--who": "who", "--on": "date", "--until": "until", "--model": "model", "--level": "level"}
"""Options of `kouros decide`, as its messages name them, and the columns that stand for them."""


@dataclass(frozen=True)
class DecisionRow:
    """A decision of the sheet, and the row that it stands in."""

    row: int
    wish: Wish


@dataclass(frozen=True)
class DecisionsTaken:
    """What became of the decisions of a sheet.

    Attributes
    ----------
    made : tuple of Decision
        Written down now, or by a real one.
    known : int
        How many were written down before.
    faults : tuple of CellFault
        Those that were refused.
    """

    made: tuple[Decision, ...] = ()
    known: int = 0
    faults: tuple[CellFault, ...] = ()


def decision_rows(path: Path) -> tuple[list[DecisionRow], list[CellFault]]:
    """Read the sheet "Decisions" of a workbook.

    Parameters
    ----------
    path : Path
        A file that was filled in; one that is no workbook, or has no such sheet, has no decisions.

    Returns
    -------
    list of DecisionRow
        In their order.
    list of CellFault
        Rows that say no decision.

    Raises
    ------
    CollectionError
        For a workbook that cannot be read.
    """
    rows: list[DecisionRow] = []
    faults: list[CellFault] = []
    if path.suffix.lower() != ".xlsx" or DECISIONS_SHEET not in visible_sheets(path):
        return rows, faults
    found = rows_of_sheet(path, path.name, sheet=DECISIONS_SHEET, header_row=HEADER_ROW, texts=COLUMNS)
    header = next(found, None)
    names = [] if header is None else header.cells
    lost = [name for name in COLUMNS if name not in names]
    if lost:
        return rows, [CellFault(DECISIONS_SHEET, 0, "", f"there is no column {lost[0]!r}", "write a new survey")]
    for row in found:
        broken = [(names[at], *fault) for at, fault in row.faults.items() if names[at] in COLUMNS]
        if row.fault[0]:
            broken.append(("", *row.fault))
        if broken:
            faults += [CellFault(DECISIONS_SHEET, row.line, *one) for one in broken]
            continue
        cells = {name: cell.strip() for name, cell in zip(names, row.cells, strict=True)}
        if not any(cells[name] for name in COLUMNS):
            continue
        wish = _wish(cells, row.line)
        if isinstance(wish, CellFault):
            faults.append(wish)
        else:
            rows.append(DecisionRow(row.line, wish))
    return rows, faults


def _wish(cells: Mapping[str, str], row: int) -> Wish | CellFault:
    def refused(column: str, message: str, remedy: str) -> CellFault:
        return CellFault(DECISIONS_SHEET, row, column, message, remedy)

    word, *more = " ".join(cells["decision"].casefold().split()).split(" ")
    if " ".join([word, *more]) not in DECISIONS:
        return refused("decision", f"{cells['decision'][:60]!r} is no decision", f"use one of {', '.join(DECISIONS)}")
    for column, what in (("object_number", "the object"), ("why", "the reason"), ("who", "who decides")):
        if not cells[column]:
            return refused(column, "is empty", f"write down {what}")
    if not cells["date"]:
        return refused("date", "is empty", "write the day as 2031-05-01")
    try:
        words = [*more, *shlex.split(cells["what"])]
    except ValueError:
        return refused("what", "has a quotation mark without its partner", 'write it as isolator="our 0.5 Hz"')
    told = {name: cells[name] for name in ("why", "who", "model", "level", "until")}
    return Wish(cells["object_number"], DecisionKind(word), words, on=cells["date"], **told)


def take_decisions(
    workspace: Workspace, rows: Iterable[DecisionRow], faults: Iterable[CellFault], *, dry_run: bool = False
) -> DecisionsTaken:
    """Write the decisions of a sheet down; one that was written down before, word for word, is not made again.

    Parameters
    ----------
    workspace : Workspace
        Whose log of decisions they go into.
    rows, faults : iterable of DecisionRow, of CellFault
        As `decision_rows` read them.
    dry_run : bool
        Write nothing.

    Returns
    -------
    DecisionsTaken
        What became of each.
    """
    known, made, refused = 0, [], list(faults)
    log = {_content(one) for one in read_decisions(workspace.engine)}
    for one in rows:
        withdrawal = _withdrawal(one.wish)
        try:
            if withdrawal is not None and withdrawal in log:
                known += 1
                continue
            decision = decide(workspace, one.wish, dry_run=True)
            if _content(decision) in log:
                known += 1
                continue
            if not dry_run:
                decision = decide(workspace, one.wish)
        except InputError as problem:
            refused.append(_refused(one.row, problem))
            continue
        log.add(_content(decision))
        made.append(decision)
    return DecisionsTaken(tuple(made), known, tuple(sorted(refused, key=lambda fault: fault.row)))


def _content(one: Decision) -> tuple[object, ...]:
    """Return what a decision says, without when it was written down and what it rested on."""
    return (
        one.object_number, one.kind, one.who, one.date, one.why, one.model, one.level, one.until, one.measure,
        tuple(sorted(one.parameters.items())), one.product, one.object_class, one.verdict, one.withdraws,
    )  # fmt: skip


def _withdrawal(wish: Wish) -> tuple[object, ...] | None:
    """Return what a withdrawal says: once it is made there is nothing to withdraw any more."""
    if wish.kind is not DecisionKind.WITHDRAW or len(wish.words) != 1 or not wish.words[0].isdecimal():
        return None
    return _content(
        Decision(0, wish.object_number, wish.kind, wish.who, wish.on, wish.why, "", withdraws=int(wish.words[0]))
    )


def _refused(row: int, problem: InputError) -> CellFault:
    said = str(problem)
    told = (
        column
        for option, column in _OPTIONS.items()
        if said.startswith((option, f"there is no {column} ")) or f"by {option} " in said
    )
    column = next(told, "")
    if not column:
        column = "object_number" if said.startswith("there is no object") else "what"
    for option, name in _OPTIONS.items():
        said = said.replace(f"by {option}", f"in the column {name}").replace(option, name)
    return CellFault(DECISIONS_SHEET, row, column, said, "mend the row, and give the sheet back")
