"""A survey that was filled in: measurements, house rules and decisions are taken up, and refused cells come back."""

import logging
import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from pipeline.collection.errors import NoRowsError
from pipeline.collection.inventory import Difference, add_sheet, object_numbers
from pipeline.collection.inventory.local_measurements import filled_in
from pipeline.collection.reading import Reading
from pipeline.errors import fault_words
from pipeline.operations.event_log import note
from pipeline.operations.workspace import Workspace
from pipeline.records import Decision
from pipeline.report.files.marked_copy import CellFault, write_listed, write_marked
from pipeline.report.files.survey_sheet import sheet_title
from pipeline.tools.decision_answers import decision_rows, take_decisions
from pipeline.tools.house_answers import add_rules, rules_of
from pipeline.tools.survey import read_sheet, sheet_columns, sheet_length

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
    out = [CellFault(sheet, one.line, one.field, _bare(one.message, path), one.remedy) for one in reading.rejected]
    for item, (_row, line) in zip(reading.items, reading.places, strict=True):
        if item.object_number in unknown:
            message = f"there is no object {item.object_number[:80]!r} in the inventory"
            out.append(CellFault(sheet, line, "object_number", message, "correct its number, or import it first"))
        for one in item.problems:
            # Where it is, the sheet only shows.
            if one.field != "gallery":
                out.append(CellFault(sheet, line, column_of(one.field), one.message, one.remedy))
    return sorted(out, key=lambda fault: fault.row)


def _bare(message: str, path: Path) -> str:
    """Return what was said of a row without its place."""
    start, _, rest = message.partition("): ")
    return rest if rest and start.startswith(f"{path.name}, row ") else message
