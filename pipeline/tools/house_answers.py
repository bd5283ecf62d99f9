"""Answers of a survey's sheet "Rules": house rules, added to kouros.toml as if somebody had written them there."""

import shutil
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from datetime import date
from pathlib import Path
from typing import Any

import tomlkit
from pydantic import ValidationError

from pipeline.analysis.classify import object_classes
from pipeline.analysis.house.matching import HouseRules
from pipeline.analysis.house.questions import VOCABULARIES, RuleQuestion
from pipeline.analysis.house.rule import QUANTITIES, TAKEN_BACK, HouseRule
from pipeline.collection.errors import CollectionError
from pipeline.collection.hand_cell import of_hand
from pipeline.collection.sources.xlsx import read_sheet as rows_of_sheet
from pipeline.collection.sources.xlsx import visible_sheets
from pipeline.errors import InputError
from pipeline.quantities import LENGTHS
from pipeline.report.files.marked_copy import CellFault
from pipeline.report.files.rules_sheet import FOR, RULES_SHEET, SIGNED, STATES
from pipeline.report.files.sheet_cells import HEADER_ROW
from pipeline.resources import replacing, small_text
from pipeline.settings import SettingsError, load_settings
from pipeline.settings.commented import listed_table

_COLUMNS = (*FOR, *STATES, *SIGNED)


@dataclass(frozen=True)
class RulesRead:
    """House rules of a sheet, and the rows of it that were refused."""

    rules: tuple[HouseRule, ...] = ()
    faults: tuple[CellFault, ...] = ()


def rules_of(path: Path) -> RulesRead:
    """Read the house rules of a workbook's sheet "Rules", and what is wrong with the others.

    Parameters
    ----------
    path : Path
        A file that was filled in; one that is no workbook, or has no such sheet, has no rules.

    Returns
    -------
    RulesRead
        Rules of rows with a value, in their order, and the rows that were refused.  Rows for the same objects that the
        same person signed on the same day are one rule.

    Raises
    ------
    CollectionError
        For a workbook that cannot be read, or a sheet without a column.
    """
    if path.suffix.lower() != ".xlsx" or RULES_SHEET not in visible_sheets(path):
        return RulesRead()
    rows = rows_of_sheet(path, path.name, sheet=RULES_SHEET, header_row=HEADER_ROW)
    header = next(rows, None)
    names = [] if header is None else header.cells
    lost = [name for name in _COLUMNS if name not in names]
    if lost:
        raise CollectionError(f"{path.name}: the sheet {RULES_SHEET!r} has no column {lost[0]!r}; write a new survey")
    merged: dict[tuple[Any, ...], dict[str, Any]] = {}
    refused: list[CellFault] = []
    for row in rows:
        faults = [(names[at], fault) for at, fault in row.faults.items() if names[at] in _COLUMNS]
        if row.fault[0] or faults:
            column, (message, remedy) = faults[0] if faults else ("", row.fault)
            refused.append(CellFault(RULES_SHEET, row.line, column, message, remedy))
            continue
        cells = {name: cell.strip() for name, cell in zip(names, row.cells, strict=True)}
        if not any(cells[name] for name in ("value", "low", "high")):
            continue
        try:
            rule = _rule(cells)
        except _RuleError as problem:
            refused.append(CellFault(RULES_SHEET, row.line, problem.column, problem.message, problem.remedy))
            continue
        about = tuple(cells[name] for name in (*FOR, *SIGNED))
        whole = merged.setdefault(about, {})
        field = cells["states"]
        if field in whole:
            message = f"{field} is stated twice for the same objects"
            refused.append(CellFault(RULES_SHEET, row.line, "states", message, "keep one row"))
            continue
        whole.update(rule.plain())
    return RulesRead(tuple(HouseRule(**plain) for plain in merged.values()), tuple(refused))


class _RuleError(InputError):
    """A row that is no rule: the column, what is wrong, what mends it."""

    def __init__(self, column: str, message: str, remedy: str) -> None:
        super().__init__(f"{message}; {remedy}")
        self.column, self.message, self.remedy = column, message, remedy


def _rule(cells: Mapping[str, str]) -> HouseRule:
    field, value = cells["states"], cells["value"]
    if field not in (*QUANTITIES, *VOCABULARIES):
        known = ", ".join((*VOCABULARIES, *QUANTITIES))
        raise _RuleError("states", f"{field[:60]!r} is nothing that a rule states", f"use one of {known}")
    given: dict[str, Any] = {name: [part.strip() for part in cells[name].split("|")] for name in FOR if cells[name]}
    given |= {name: cells[name] for name in SIGNED}
    for name in SIGNED:
        if not cells[name]:
            raise _RuleError(name, "is empty", "a rule says who says so, and when")
    given[field] = value if field in VOCABULARIES else _span(cells, QUANTITIES[field][0])
    try:
        return HouseRule(**given)
    except ValidationError as problem:
        first = problem.errors(include_url=False)[0]
        column = str(first["loc"][0]) if first["loc"] else "states"
        column = "value" if column == field else column
        if column == "said_on":
            message = f"{cells[column][:40]!r} is no day that can be read"
            raise _RuleError(column, message, "write the day as 2031-05-01") from None
        raise _RuleError(column, str(first["msg"]), "mend the cell") from None


def _span(cells: Mapping[str, str], unit: str) -> dict[str, float]:
    if unit == "m" and cells["unit"] not in LENGTHS:
        message = f"{cells['unit'][:20]!r} is no unit of lengths"
        raise _RuleError("unit", message, f"use {', '.join(LENGTHS)}")
    if unit != "m" and cells["unit"] not in ("", unit):
        message = f"{cells['states']} is in {unit}, not in {cells['unit'][:20]!r}"
        raise _RuleError("unit", message, f"write {unit}, or leave it empty")
    if bool(cells["low"]) != bool(cells["high"]):
        raise _RuleError("", "give low and high, or neither of them", "fill in the other one")
    span = {}
    for key, column in (("low", "low"), ("best", "value"), ("high", "high")):
        try:
            found = of_hand(cells[column] or cells["value"], cells["unit"] if unit == "m" else unit)
        except InputError as problem:
            raise _RuleError(column, str(problem), "write one number, as 0.3") from None
        # Not 0.30000000000000004 m for 30 cm.
        span[key] = float(f"{found.value:.12g}")
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
    holding = tuple(rule for rule in known if rule.holds)
    wanted = tuple(rule for rule in (_without(rule, holding) for rule in rules) if rule is not None)
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
        _write(config, text)
    return added


def take_back(config: Path, at: int, who: str, when: date, why: str) -> None:
    """Write beside a house rule of kouros.toml that it was taken back; it stays there, with who said it.

    Parameters
    ----------
    config : Path
        The settings.
    at : int
        Its place among the rules, from 0.
    who, when, why : str, date, str
        Who takes it back.

    Raises
    ------
    SettingsError
        Where there is no such rule, somebody took it back already, or the file is written in another way than as
        tables [[house]].  Nothing is written then.
    """
    known = load_settings(config).house
    if not 0 <= at < len(known):
        raise SettingsError(f"{config}: there is no rule {at + 1}; it has {len(known)}")
    if not known[at].holds:
        raise SettingsError(f"{config}: [[house]] {at + 1} was taken back by {known[at].taken_back_by} already")
    given = known[at].plain() | dict(zip(TAKEN_BACK, (who, when, why), strict=True))
    try:
        wanted = HouseRule(**given)
    except ValidationError as problem:
        raise SettingsError(str(problem.errors(include_url=False)[0]["msg"]).removeprefix("Value error, ")) from None
    document = tomlkit.parse(small_text(config))
    table = document["house"][at]
    for name in TAKEN_BACK:
        table[name] = getattr(wanted, name)
    text = tomlkit.dumps(document)
    if tuple(HouseRule(**one) for one in tomllib.loads(text)["house"]) != (*known[:at], wanted, *known[at + 1 :]):
        raise SettingsError(f"{config}: [[house]] {at + 1} cannot be changed as it is written; change it by hand")
    _write(config, text)


def _write(config: Path, text: str) -> None:
    with replacing(config) as aside:
        aside.write_text(text, encoding="utf-8")
        shutil.copymode(config, aside)


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
