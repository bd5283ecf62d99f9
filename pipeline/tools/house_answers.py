"""Answers of a survey's sheet "Rules": house rules, added to kouros.toml as if somebody had written them there."""

import shutil
import tomllib
from collections.abc import Iterable, Mapping
from datetime import date
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from pipeline.analysis.classify import object_classes
from pipeline.analysis.house.matching import HouseRules
from pipeline.analysis.house.questions import VOCABULARIES, RuleQuestion
from pipeline.analysis.house.rule import QUANTITIES, HouseRule
from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.xlsx import read_sheet as rows_of_sheet
from pipeline.collection.sources.xlsx import visible_sheets
from pipeline.errors import InputError
from pipeline.quantities import LENGTHS
from pipeline.report.files.rules_sheet import FOR, RULES_SHEET, SIGNED, STATES
from pipeline.report.files.sheet_cells import HEADER_ROW
from pipeline.resources import replacing, small_text
from pipeline.settings import SettingsError, load_settings
from pipeline.settings.commented import listed_table

_COLUMNS = (*FOR, *STATES, *SIGNED)


def read_rules(path: Path) -> tuple[HouseRule, ...]:
    """Read the house rules of a workbook's sheet "Rules".

    Parameters
    ----------
    path : Path
        A file that was filled in; one that is no workbook, or has no such sheet, has no rules.

    Returns
    -------
    tuple of HouseRule
        Of rows with a value, in their order; rows for the same objects that the same person signed on the same day are
        one rule.

    Raises
    ------
    CollectionError
        For a sheet or a row that cannot be used: naming file, row, column and remedy.
    """
    if path.suffix.lower() != ".xlsx" or RULES_SHEET not in visible_sheets(path):
        return ()
    rows = rows_of_sheet(path, path.name, sheet=RULES_SHEET, header_row=HEADER_ROW)
    header = next(rows, None)
    names = [] if header is None else header.cells
    lost = [name for name in _COLUMNS if name not in names]
    if lost:
        raise CollectionError(f"{path.name}: the sheet {RULES_SHEET!r} has no column {lost[0]!r}; write a new survey")
    merged: dict[tuple[Any, ...], dict[str, Any]] = {}
    for row in rows:
        where = f"{path.name}, sheet {RULES_SHEET!r}, row {row.line}"
        faults = [(names[at], fault) for at, fault in row.faults.items() if names[at] in _COLUMNS]
        if row.fault[0] or faults:
            column, (message, remedy) = faults[0] if faults else ("", row.fault)
            raise CollectionError(f"{where}{f', {column}' if column else ''}: {message}; {remedy}")
        cells = {name: cell.strip() for name, cell in zip(names, row.cells, strict=True)}
        if not any(cells[name] for name in ("value", "low", "high")):
            continue
        rule = _rule(cells, where)
        about = tuple(cells[name] for name in (*FOR, *SIGNED))
        whole = merged.setdefault(about, {})
        field = cells["states"]
        if field in whole:
            raise CollectionError(f"{where}, states: {field} is stated twice for the same objects; keep one row")
        whole.update(rule.plain())
    return tuple(HouseRule(**plain) for plain in merged.values())


def _rule(cells: Mapping[str, str], where: str) -> HouseRule:
    field, value = cells["states"], cells["value"]
    if field not in (*QUANTITIES, *VOCABULARIES):
        raise CollectionError(
            f"{where}, states: {field[:60]!r} is nothing that a rule states; use one of "
            f"{', '.join((*VOCABULARIES, *QUANTITIES))}"
        )
    given: dict[str, Any] = {name: [part.strip() for part in cells[name].split("|")] for name in FOR if cells[name]}
    given |= {name: cells[name] for name in SIGNED}
    for name in SIGNED:
        if not cells[name]:
            raise CollectionError(f"{where}, {name}: is empty; a rule says who says so, and when")
    given[field] = value if field in VOCABULARIES else _span(cells, QUANTITIES[field][0], where)
    try:
        return HouseRule(**given)
    except ValidationError as problem:
        first = problem.errors(include_url=False)[0]
        column = str(first["loc"][0]) if first["loc"] else "states"
        column = "value" if column == field else column
        raise CollectionError(f"{where}, {column}: {first['msg']}; mend the cell") from None


def _span(cells: Mapping[str, str], unit: str, where: str) -> dict[str, float]:
    if unit == "m" and cells["unit"] not in LENGTHS:
        raise CollectionError(f"{where}, unit: {cells['unit'][:20]!r} is no unit of lengths; use {', '.join(LENGTHS)}")
    if unit != "m" and cells["unit"] not in ("", unit):
        raise CollectionError(f"{where}, unit: {cells['states']} is in {unit}, not in {cells['unit'][:20]!r}")
    per = LENGTHS[cells["unit"]] if unit == "m" else 1.0
    if bool(cells["low"]) != bool(cells["high"]):
        raise CollectionError(f"{where}: give low and high, or neither of them")
    span = {}
    for key, column in (("low", "low"), ("best", "value"), ("high", "high")):
        text = cells[column] or cells["value"]
        try:
            # Not 0.30000000000000004 m for 30 cm.
            span[key] = float(f"{per * float(text):.12g}")
        except ValueError as problem:
            raise CollectionError(f"{where}, {column}: {text[:40]!r} is no number; write one, as 0.3") from problem
    return span


def add_rules(config: Path, rules: tuple[HouseRule, ...], *, dry_run: bool = False) -> str:
    """Add house rules at the end of kouros.toml; what it states already for the same objects is left out.

    Parameters
    ----------
    config : Path
        The settings.
    rules : tuple of HouseRule
        To be added.
    dry_run : bool
        Write nothing.

    Returns
    -------
    str
        What is added, as TOML; "" for nothing.

    Raises
    ------
    SettingsError
        Where the file would not be what Kouros can use any more: a rule of it says something else of the same objects.
        Nothing is written then.
    """
    known = load_settings(config).house
    wanted = tuple(rule for rule in (_without(rule, known) for rule in rules) if rule is not None)
    if not wanted:
        return ""
    try:
        HouseRules((*known, *wanted), tuple(object_classes()))
    except InputError as problem:
        raise SettingsError(f"{config}: the sheet's rules would be added as the last ones: {problem}") from None
    added = "\n".join(listed_table("house", rule.plain()).strip() + "\n" for rule in wanted)
    text = f"{small_text(config).rstrip()}\n\n{added}"
    try:
        tomllib.loads(text)
    except tomllib.TOMLDecodeError as problem:
        raise SettingsError(f"{config}: rules cannot be added at its end ({problem}); add by hand: {added}") from None
    if not dry_run:
        with replacing(config) as aside:
            aside.write_text(text, encoding="utf-8")
            shutil.copymode(config, aside)
    return added


def _without(rule: HouseRule, known: tuple[HouseRule, ...]) -> HouseRule | None:
    """Return a rule without what another states of the same objects in the same words; None where nothing is left."""
    plain, about = rule.plain(), {*FOR, *SIGNED}
    for other in known:
        theirs = other.plain()
        if all(plain.get(name) == theirs.get(name) for name in FOR):
            plain = {name: value for name, value in plain.items() if name in about or theirs.get(name) != value}
    return HouseRule(**plain) if set(plain) - about else None


def to_paste(questions: Iterable[RuleQuestion], when: date) -> str:
    """Return the rules that would answer some questions, one for all about the same objects, as TOML to be pasted.

    Parameters
    ----------
    questions : iterable of RuleQuestion
        Each is answered with what is taken now, and a choice with its vocabulary: for somebody to mend and to sign.
    when : date
        On which it is asked.

    Returns
    -------
    str
        Of [[house]], which Kouros refuses until it is signed.
    """
    rules: dict[tuple[tuple[str, str], ...], dict[str, Any]] = {}
    for question in questions:
        about = tuple(question.criteria.items())
        stated = {name: value for name, value in question.plain(when).items() if name not in SIGNED}
        rules[about] = rules.get(about, {}) | stated
    return "\n".join(listed_table("house", plain | {"said_by": "", "said_on": when}) for plain in rules.values())
