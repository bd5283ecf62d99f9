"""A survey that was filled in: measurements, house rules and decisions are taken up, and refused cells come back."""

import logging
import os
import re
import shlex
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from pipeline.collection.errors import NoRowsError
from pipeline.collection.inventory import Difference, add_sheet, object_numbers
from pipeline.collection.inventory.local_measurements import filled_in
from pipeline.collection.reading import Reading
from pipeline.collection.record import CHOICES
from pipeline.collection.sources.xlsx import read_sheet as rows_of_sheet
from pipeline.collection.sources.xlsx import visible_sheets
from pipeline.errors import InputError, fault_words
from pipeline.operations.event_log import note
from pipeline.operations.workspace import Workspace
from pipeline.records import Decision, DecisionKind
from pipeline.report.files.marked_copy import CellFault, write_listed, write_marked
from pipeline.report.files.sheet_cells import HEADER_ROW
from pipeline.report.files.survey_sheet import COLUMNS, DECISIONS, DECISIONS_SHEET, sheet_title
from pipeline.store.decisions import read_decisions
from pipeline.tools.decisions import Wish, decide
from pipeline.tools.house_answers import add_rules, rules_of
from pipeline.tools.survey import read_sheet, sheet_columns, sheet_heads, sheet_length

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


MARKED = "-refused"
"""What the name of the copy with refused cells has behind that of the workbook, or of a text of them."""


_LONGEST = 200
"""Bytes of a file's name at most: file systems allow 255, and something is put before it and behind it."""


@dataclass(frozen=True)
class SheetTaken:
    """What was taken from a sheet that was filled in.

    Attributes
    ----------
    reading : Reading or None
        What was read of its measurements; None where it has no rows for any.
    changes : Difference or None
        What these changed; None where nothing was measured.
    unknown : list of str
        The objects of the sheet that the inventory does not have.
    rules : str
        The house rules that were added to the settings, as TOML; "" for none.
    decisions : tuple of Decision
        Those that were written down.
    known : int
        Decisions that had been written down before.
    faults : tuple of CellFault
        The cells that were refused.
    marked : Path or None
        The copy of the workbook in which they are marked, or a text of them; None where there are none.
    empty : bool
        Whether all that it says was refused.
    """

    reading: Reading | None
    changes: Difference | None
    unknown: list[str]
    rules: str
    decisions: tuple[Decision, ...] = ()
    known: int = 0
    faults: tuple[CellFault, ...] = ()
    marked: Path | None = None
    empty: bool = False


def take_sheet(
    workspace: Workspace, config: Path, path: Path, *, dry_run: bool = False, beside: Path | None = None
) -> SheetTaken:
    """Take up a filled-in sheet: measurements, house rules and decisions; what is refused of it is marked in a copy.

    Parameters
    ----------
    workspace : Workspace
        Whose inventory gets the measurements, and whose log the decisions.
    config : Path
        The settings' file, which gets the house rules.
    path : Path
        The sheet.
    dry_run : bool
        Only say what that would change.
    beside : Path or None
        Folder of the copy with the refused cells; None: that of the sheet.

    Returns
    -------
    SheetTaken
        What was taken.

    Raises
    ------
    CollectionError, SettingsError
        As `read_sheet`, `rules_of` and `add_rules`; nothing is changed then.
    """
    rules = rules_of(path)
    # What would be refused as a whole is refused before anything is changed.
    add_rules(config, rules.rules, dry_run=True)
    wishes, broken = decision_rows(path)
    others = bool(rules.rules or rules.faults or wishes or broken)
    changes: Difference | None = None
    unknown: list[str] = []
    try:
        reading: Reading | None = read_sheet(path)
    except NoRowsError:
        if not others:
            raise
        reading = None
    known = set(object_numbers(workspace.engine))
    if reading is not None:
        filled = [item for item in reading.items if filled_in(item)]
        unknown = [item.object_number for item in filled if item.object_number not in known]
        cells = _faults(reading, path, set(unknown))
        if len(filled) > len(unknown) or not (others or cells):
            changes, unknown = add_sheet(workspace.engine, reading, dry_run=dry_run)
    else:
        cells = []
    decided = take_decisions(workspace, wishes, broken, dry_run=dry_run)
    added = add_rules(config, rules.rules, dry_run=dry_run)
    faults = (*cells, *rules.faults, *decided.faults)
    marked = _marked(path, faults, beside or path.parent, dry_run=dry_run) if faults else None
    nothing = bool(faults) and changes is None and not (rules.rules or decided.made or decided.known)
    return SheetTaken(reading, changes, unknown, added, decided.made, decided.known, faults, marked, nothing)


_TWICE = re.compile(r"in row (\d+) already")


def bounded(stem: str) -> str:
    """Return the stem of a file's name so far as a name may have more before it and behind it."""
    return os.fsdecode(os.fsencode(stem)[:_LONGEST])


def _marked(path: Path, faults: Sequence[CellFault], folder: Path, *, dry_run: bool) -> Path:
    """Write the copy of a workbook in which the refused cells are marked, or a text of them where there can be none."""
    name = f"{bounded(path.stem.removesuffix(MARKED))}{MARKED}"
    target, listed = folder / f"{name}.xlsx", folder / f"{name}.txt"
    if path.suffix.lower() != ".xlsx":
        target = listed
    if dry_run:
        return target
    if target != listed:
        try:
            write_marked(path, faults, target)
        except Exception as problem:  # noqa: BLE001 - what was taken is taken; parts of it that nobody needs may be odd
            note("survey.unmarked", level=logging.WARNING, file=path.name, message=fault_words(problem))
        else:
            return target
    write_listed(faults, listed)
    return listed


def _faults(reading: Reading, path: Path, unknown: set[str]) -> list[CellFault]:
    """Return the cells of measurements that were refused."""
    length, column_of = sheet_length(path), sheet_columns(path)
    sheet = sheet_title(length) if length else path.name
    out = [*sheet_heads(path).faults]
    lines = dict(reading.places)
    for row in reading.rejected:
        message, remedy, first = _bare(row.message, path), row.remedy, _TWICE.search(row.message)
        if first is not None:
            # By the rows that the sheet numbers, and for whom nothing was exported.
            message = message.replace(first[0], f"in row {lines[int(first[1])]} already")
            remedy = "write all that was found of one object in one row"
        out.append(CellFault(sheet, row.line, row.field, message, remedy))
    for item, (_row, line) in zip(reading.items, reading.places, strict=True):
        if item.object_number in unknown:
            message = f"there is no object {item.object_number[:80]!r} in the inventory"
            out.append(CellFault(sheet, line, "object_number", message, "correct its number, or import it first"))
        for one in item.problems:
            # Where it is, the sheet only shows.
            if one.field != "gallery":
                # Who fills a sheet in has no mapping.
                remedy = "write one of these words" if one.field in CHOICES else one.remedy
                out.append(CellFault(sheet, line, column_of(one.field), one.message, remedy))
    return sorted(out, key=lambda fault: fault.row)


def _bare(message: str, path: Path) -> str:
    """Return what was said of a row without its place."""
    start, _, rest = message.partition("): ")
    return rest if rest and start.startswith(f"{path.name}, row ") else message
