"""Survey workbook of what to measure first, to print, fill in and import again."""

from collections.abc import Callable, Collection, Sequence
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from functools import partial
from pathlib import Path
from typing import Any

from pipeline.analysis.assess import assess
from pipeline.analysis.context import Context
from pipeline.analysis.faults import Fault, apart, fault
from pipeline.analysis.house.questions import RuleQuestion, rule_questions
from pipeline.analysis.survey import in_order, measurables, measurement_requests, telling_requests
from pipeline.analysis.verdicts import LevelMotions
from pipeline.collection.errors import CollectionError
from pipeline.collection.inventory import read_inventory
from pipeline.collection.mapping import Mapping, load_mapping
from pipeline.collection.reading import Reading, read_items
from pipeline.collection.record import KINDS
from pipeline.collection.sources.xlsx import first_rows, visible_sheets
from pipeline.execute import Threads
from pipeline.mitigate.installed import likely
from pipeline.night.assessment import place
from pipeline.night.floors import floors_with
from pipeline.operations.workspace import Workspace
from pipeline.records import Item, MeasurementRequest, Progress, Scene
from pipeline.records.numerics import AUTO, CHART
from pipeline.report.files.sheet_cells import HEADER_ROW
from pipeline.report.files.survey_sheet import MASS, SHOWN, WHY, column_name, mass_unit, sheet_title, write_survey
from pipeline.store.decisions import decisions_in_force
from pipeline.tools.sheet_heads import NUMBER, OTHER_BOOKS, SheetHeads, heads_of

LENGTH_UNITS = ("cm", "mm", "m", "in", "ft")

_HEAD = 65_536
"""Bytes of the first line of a CSV file at most."""


@dataclass(frozen=True)
class Surveyed:
    """What a survey asks for, where its workbook is, and the objects that Kouros failed on.

    Attributes
    ----------
    path : Path
        Of the workbook.
    wishes : tuple of MeasurementRequest
        What is worth measuring, the most useful first.
    objects, quantities, waste : int
        As the workbook counts them.
    rules : tuple of RuleQuestion
        The questions that one house rule answers for many objects, the most useful first.
    faults : tuple of Fault
        The objects that Kouros failed on.
    """

    path: Path
    wishes: tuple[MeasurementRequest, ...]
    objects: int
    quantities: int
    waste: int
    faults: tuple[Fault, ...] = ()
    rules: tuple[RuleQuestion, ...] = ()


def survey(
    workspace: Workspace, progress: Progress, *, galleries: tuple[str, ...] = (), path: Path | None = None
) -> Surveyed:
    """Assess the objects on display, and write what is worth measuring to a workbook.

    Parameters
    ----------
    workspace : Workspace
        Whose inventory is surveyed.
    progress : callable
        Is told what is done, of how much.
    galleries : tuple of str
        Only these; none named means all.
    path : Path or None
        Of the workbook; None for survey-<date>.xlsx beside the settings.

    Returns
    -------
    Surveyed
        What is asked for, and where.

    Raises
    ------
    CollectionError
        Where nothing is on display.
    KourosError
        As a run does, where motions or settings are wrong.
    """
    settings = workspace.settings
    items = [
        item
        for item in read_inventory(workspace.engine)
        if item.on_display and (not galleries or item.gallery in galleries)
    ]
    if not items:
        raise CollectionError("nothing on display to survey: import the collection, or name another gallery")
    site = workspace.site()
    context, numerics = Context(Threads(settings.analysis.workers or None), progress), settings.analysis.numerics
    if numerics.fidelity == CHART:
        # Each trial is asked once: a chart that is not there would not pay.
        numerics = numerics.at(AUTO)
    found: list[MeasurementRequest] = []
    decisions = decisions_in_force(workspace.engine)
    faults: list[Fault] = []
    known: dict[str, Scene] = {}

    rules, measures, house = workspace.rules, workspace.measures, workspace.house
    sampling = settings.likelihood.sampling

    def asked(shaking: Sequence[LevelMotions], some: Sequence[Item]) -> list[list[MeasurementRequest]]:
        objects = [place(item, rules, decisions.get(item.object_number, ()), measures, house) for item in some]
        scenes = [one.scene for one in objects]
        known.update((scene.item.object_number, scene) for scene in scenes)
        by_object: dict[str, list[MeasurementRequest]] = {item.object_number: [] for item in some}
        if sampling.samples:
            requests = telling_requests(scenes, likely(objects, shaking, sampling, context))
        else:
            _, findings = assess(scenes, shaking, context, numerics, outcomes=False)
            requests = measurement_requests(scenes, findings, shaking, context, numerics)
        for request in requests:
            by_object[request.object_number].append(request)
        return list(by_object.values())

    for floor in floors_with(settings, site, items):
        here = [items[index] for index in floor.members]
        for item, came in zip(here, apart(partial(asked, floor.shaking), here, lambda one: one.support), strict=True):
            if isinstance(came, Exception):
                faults.append(fault(item, came))
            else:
                found += came
    found = in_order(found)
    target = path or settings.path(f"survey-{datetime.now():%Y-%m-%d}.xlsx")
    # The counts are those of the workbook; that of a dry run goes with it.
    written = target if settings.rehearsal is None else settings.rehearsal / target.name
    questions = rule_questions(known.values(), found)
    counts = write_survey(written, found, measurables(), length=settings.report.length, rules=questions)
    return Surveyed(target, tuple(found), **counts, faults=tuple(faults), rules=tuple(questions))


def read_sheet(path: Path) -> Reading:
    """Read a sheet that was filled in: a survey's workbook, or a CSV with the columns of the preset "kouros".

    Parameters
    ----------
    path : Path
        The sheet.

    Returns
    -------
    Reading
        Its rows, and what was refused of them.

    Raises
    ------
    CollectionError
        For a file that cannot be read, or a workbook without the survey's sheet.
    """
    length = sheet_length(path)
    if length:
        lost = sheet_heads(path).lost
        return read_items(path, sheet_mapping(length, old_mass=_in_kilograms(path, length), without=lost))
    if path.suffix.lower() in OTHER_BOOKS:
        packed = path.suffix.lower() == ".zip"
        remedy = "take the workbook out of it" if packed else "save it as an .xlsx workbook where it was filled in"
        raise CollectionError(f"{path.name}: a sheet comes back as .xlsx or .csv; {remedy}")
    if path.suffix.lower() == ".xlsx":
        there = ", ".join(map(repr, visible_sheets(path)))
        raise CollectionError(
            f"{path.name}: no sheet of a survey, such as {sheet_title('cm')!r}; its sheets are {there}: give the "
            "workbook that `kouros survey` wrote, and leave its sheets their names"
        )
    whole = load_mapping("kouros").model_dump(exclude_none=True, exclude_defaults=True)
    return read_items(path, _by_hand(whole | {"source": whole["source"] | {"delimiter": _delimiter(path)}}))


def sheet_heads(path: Path) -> SheetHeads:
    """Return what is wrong with the heads of a sheet that was filled in; nothing of one that is no workbook.

    Parameters
    ----------
    path : Path
        The sheet.

    Raises
    ------
    CollectionError
        As `heads_of`.
    """
    length = sheet_length(path)
    if not length:
        return SheetHeads()
    old = _in_kilograms(path, length)
    there = [one.column for one in sheet_mapping(length, old_mass=old).columns.values() if one.column]
    return heads_of(path, sheet_title(length), frozenset({*there, *SHOWN, WHY}))


def _delimiter(path: Path) -> str:
    """Return what parts the cells of a CSV file: where numbers have a decimal comma programs write a semicolon."""
    with suppress(OSError), path.open("rb") as stream:
        head = stream.readline(_HEAD).decode("utf-8-sig", "replace")
        for mark in (";", "\t"):
            if mark in head and NUMBER in (cell.strip(' "\r\n') for cell in head.split(mark)):
                return mark
    return ","


def sheet_length(path: Path) -> str:
    """Return the unit of the lengths of a survey's workbook.

    Parameters
    ----------
    path : Path
        A file that was filled in.

    Returns
    -------
    str
        "" for any other file.

    Raises
    ------
    CollectionError
        For a workbook that cannot be read.
    """
    if path.suffix.lower() != ".xlsx":
        return ""
    titles = visible_sheets(path)
    return next((length for length in LENGTH_UNITS if sheet_title(length) in titles), "")


def sheet_columns(path: Path) -> Callable[[str], str]:
    """Return what names the column of a field in a sheet that was filled in.

    Parameters
    ----------
    path : Path
        The sheet.
    """
    length = sheet_length(path)
    if not length:
        return str
    old = _in_kilograms(path, length)
    return lambda field: MASS if old and field == MASS else column_name(field, length)


def _in_kilograms(path: Path, length: str) -> bool:
    """Whether a sheet asks for kilograms by the name of the field, as all did once."""
    heads = first_rows(path, sheet_title(length), HEADER_ROW)
    names = heads[HEADER_ROW - 1] if len(heads) >= HEADER_ROW else []
    return MASS in names and column_name(MASS, length) not in names


def sheet_mapping(length: str, *, old_mass: bool = False, without: Collection[str] = ()) -> Mapping:
    """Return the mapping that reads a survey's sheet.

    Parameters
    ----------
    length : {"cm", "mm", "m", "in", "ft"}
        The unit of its lengths.
    old_mass : bool
        Whether it asks for kilograms, whatever its lengths are in.
    without : collection of str
        Columns that are not to be read.

    Returns
    -------
    Mapping
        Of the sheet's columns.
    """
    whole = load_mapping("kouros").model_dump(exclude_none=True, exclude_defaults=True)
    whole["source"] = {"format": "xlsx", "sheet": sheet_title(length), "header_row": HEADER_ROW}
    columns = {}
    for field, column in whole["columns"].items():
        unit = {"unit": length} if field.endswith("_m") else {}
        if field == MASS and not old_mass:
            unit = {"unit": mass_unit(length)}
        name = MASS if old_mass and field == MASS else column_name(field, length)
        if name in without:
            continue
        columns[field] = column | {"column": name} | unit
    return _by_hand(whole | {"columns": columns})


def _by_hand(whole: dict[str, Any]) -> Mapping:
    """Return a mapping whose numbers somebody filled in by hand."""
    kinds = ("number", "integer")
    columns = {
        field: column | ({"by_hand": True} if KINDS.get(field, "number") in kinds else {})
        for field, column in whole["columns"].items()
    }
    return Mapping.model_validate(whole | {"columns": columns})
