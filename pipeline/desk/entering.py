"""Measurements and house rules that somebody enters: checked, and given to what the commands give theirs to."""

import csv
import hashlib
import time
from collections.abc import Collection, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from datetime import date
from pathlib import Path
from tempfile import TemporaryDirectory
from threading import Lock
from typing import Any

from pydantic import ValidationError

from pipeline.analysis.house.questions import VOCABULARIES
from pipeline.analysis.house.rule import QUANTITIES, HouseRule
from pipeline.analysis.survey import measurables
from pipeline.collection.consistency import contradictions
from pipeline.collection.inventory import add_sheet
from pipeline.collection.mapping import load_mapping
from pipeline.collection.reading import read_items
from pipeline.collection.record import plausible, to_records
from pipeline.desk.guard import DeskError
from pipeline.desk.numbers import read_number
from pipeline.desk.object_facts import vocabulary
from pipeline.errors import InputError
from pipeline.operations.workspace import LockedError, Workspace, locked
from pipeline.records import Item
from pipeline.report.assumed import assumed
from pipeline.report.language import _, said
from pipeline.report.units import Units
from pipeline.resources import small_text
from pipeline.settings import Settings
from pipeline.tools.decisions import WHY_LIMIT
from pipeline.tools.house_answers import add_rules, take_back

PATIENCE = 8.0
"""Seconds that somebody waits for another to have written."""

_ONE_AT_A_TIME = Lock()
_SIDES = dict.fromkeys(("height_m", "width_m", "depth_m"))


class CellsError(DeskError):
    """Cells that cannot be used: by field what is wrong."""

    def __init__(self, cells: Mapping[str, str]) -> None:
        self.cells = dict(cells)
        super().__init__("nothing was saved: " + "; ".join(self.cells.values()))


@contextmanager
def writing(settings: Settings) -> Iterator[None]:
    """Hold the workspace's lock, waiting a moment for others at the desk.

    Raises
    ------
    DeskError
        Where a run or a command is at work for longer.
    """
    last = time.monotonic() + PATIENCE
    if not _ONE_AT_A_TIME.acquire(timeout=PATIENCE):
        raise DeskError("others are writing: nothing was saved yet, and what you entered still stands here; send again")
    try:
        while True:
            with _lock(settings, last) as held:
                if held:
                    yield
                    return
            time.sleep(0.1)
    finally:
        _ONE_AT_A_TIME.release()


@contextmanager
def _lock(settings: Settings, last: float) -> Iterator[bool]:
    holder = locked(settings)
    try:
        holder.__enter__()
    except LockedError as problem:
        if time.monotonic() > last:
            raise DeskError(
                "a run is at work: nothing was saved yet, and what you entered still stands here; send it again when "
                "the run is over"
            ) from problem
        yield False
        return
    try:
        yield True
    finally:
        holder.__exit__(None, None, None)


def enter(workspace: Workspace, item: Item, typed: Mapping[str, str], who: str, units: Units) -> list[str]:
    """Lay what somebody measured on an object over its record, as a sheet of a survey is.

    Parameters
    ----------
    workspace : Workspace
        Whose lock is held.
    item : Item
        The object as it is recorded.
    typed : mapping of str to str
        By field what stands in its cell; empty cells say nothing.
    who : str
        Who measured it.
    units : Units
        Those of a number that names none.

    Returns
    -------
    list of str
        The fields that were filled in.

    Raises
    ------
    CellsError
        Naming each cell that cannot be used; nothing is saved then.
    """
    values, words, wrong = _values(typed, units)
    if not wrong and not values:
        wrong = {"": "no cell is filled in: write what you measured"}
    if wrong:
        raise CellsError(wrong)
    with TemporaryDirectory(prefix="kouros-desk-") as folder:
        file = Path(folder) / "desk.csv"
        row = {"object_number": item.object_number, "gallery": item.gallery, **values}
        with file.open("w", encoding="utf-8", newline="") as stream:
            out = csv.DictWriter(stream, row)
            out.writeheader()
            out.writerow(row)
        reading = read_items(file, load_mapping("kouros"))
    if reading.rejected or len(reading.items) != 1:
        raise CellsError({"": "; ".join(f"{r.message}; {r.remedy}" for r in reading.rejected)})
    read = reading.items[0]
    problems = {p.field: f"{labels().get(p.field, p.field)}: {p.message}; {p.remedy}" for p in read.problems}
    problems |= _against_the_record(item, read, values, units)
    if problems:
        raise CellsError(problems)
    said_by = tuple(replace(of, written=words.get(of.field, of.written)) for of in read.provenance)
    reading = replace(reading, items=(replace(read, provenance=said_by),), source=f"desk, {who}")
    add_sheet(workspace.engine, reading)
    return list(values)


def labels() -> dict[str, str]:
    """Return what the fields are called that may be filled in."""
    return {one.field: str(said(one.label)) for one in measurables()}


def _values(typed: Mapping[str, str], units: Units) -> tuple[dict[str, str], dict[str, str], dict[str, str]]:
    """Return by field the values in SI as text, how they were written, and what is wrong."""
    values, words, wrong = {}, {}, {}
    for one in measurables():
        text = typed.get(one.field, "").strip()
        if not text:
            continue
        choices = vocabulary(one.field)
        label = said(one.label)
        if choices:
            if text in choices:
                values[one.field] = text
            else:
                wrong[one.field] = f"{label}: {text[:40]!r} is none of {', '.join(choices)}"
            continue
        try:
            value, words[one.field] = read_number(text, one.unit, units)
        except InputError as problem:
            wrong[one.field] = f"{label}: {problem}"
            continue
        limits = plausible().get(one.field)
        if limits is not None and not limits.low <= value <= limits.high:
            cannot = (
                _("%(typed)s is too little to be true: measure it again, or leave the cell empty")
                if value < limits.low
                else _("%(typed)s is too much to be true: measure it again, or leave the cell empty")
            )
            wrong[one.field] = f"{label}: {cannot % {'typed': repr(text[:40])}}"
        else:
            values[one.field] = repr(value)
    return values, words, wrong


def _against_the_record(item: Item, read: Item, filled: Collection[str], units: Units) -> dict[str, str]:
    """Return by field why what was filled in cannot be beside what is recorded: pounds typed as tonnes, say."""
    before, now = to_records([item, read])
    record = {**before, **{name: now[name] for name in filled}}
    found = {}
    for name, problem in contradictions(record):
        if not name or not {name, *_SIDES}.intersection(filled):
            continue
        told = assumed(f"{problem.message}; {problem.remedy}", units)
        if name == "mass_kg":
            box = " × ".join(units.text(float(record[side]), "m") for side in _SIDES)
            cannot = _("%(mass)s in %(box)s cannot be: weigh it again, and enter its size with it")
            told = cannot % {"mass": units.text(float(record[name]), "kg"), "box": box}
        found[name if name in filled else ""] = f"{labels().get(name, name)}: {told}"
    return found


def rules_version(config: Path) -> str:
    """Return the version of the settings that a form about house rules was made of."""
    return hashlib.sha256(small_text(config).encode()).hexdigest()[:32]


def house_rule(given: Mapping[str, str], who: str, when: date, units: Units) -> HouseRule:
    """Return the house rule that a form states.

    Parameters
    ----------
    given : mapping of str to str
        ``class``, ``gallery``, ``support``, ``medium`` and ``number``, which say what it is for; ``states``, what it
        is about; ``word``, or ``low``, ``best`` and ``high``.
    who, when
        Who says so, and on which day.
    units : Units
        Those of a number that names none.

    Raises
    ------
    DeskError
        Saying what is missing or cannot be.
    """
    states = given.get("states", "")
    plain: dict[str, Any] = {
        name: given[name] for name in ("class", "gallery", "medium", "number", "support") if given.get(name)
    }
    plain |= {"said_by": who, "said_on": when}
    if states in VOCABULARIES:
        plain[states] = given.get("word", "")
        if plain[states] not in VOCABULARIES[states]:
            raise DeskError(f"say which: one of {', '.join(VOCABULARIES[states])}")
    elif states in QUANTITIES:
        best = given.get("best", "")
        if not best.strip():
            raise DeskError("write the number that is likeliest; low and high may be left out, both together")
        if bool(given.get("low", "").strip()) != bool(given.get("high", "").strip()):
            raise DeskError("write low and high, or neither of them")
        unit = QUANTITIES[states][0]
        span = {name: given.get(name, "").strip() or best for name in ("low", "best", "high")}
        plain[states] = {name: read_number(text, unit, units)[0] for name, text in span.items()}
    else:
        raise DeskError("say what the rule is about")
    try:
        return HouseRule(**plain)
    except ValidationError as problem:
        first = problem.errors(include_url=False)[0]
        raise DeskError(str(first["msg"]).removeprefix("Value error, ")) from None


def end_rule(config: Path, at: str, who: str, when: date, why: str) -> None:
    """Write down that a house rule is taken back.

    Parameters
    ----------
    config : Path
        The settings.
    at : str
        Its place among the rules, from 0, as a form says it.
    who, when, why : str, date, str
        Who takes it back.

    Raises
    ------
    DeskError
        Where no reason is given, or there is no such rule.
    SettingsError
        As of `take_back`.
    """
    if not why.strip():
        raise DeskError("write why: whoever stated the rule will ask")
    if len(why) > WHY_LIMIT:
        raise DeskError(f"a reason has at most {WHY_LIMIT} characters: say it shorter")
    if not (at.isascii() and at.isdigit() and len(at) < 6):
        raise DeskError("there is no such rule")
    take_back(config, int(at), who, when, " ".join(why.split()))


def state_rule(config: Path, rule: HouseRule) -> bool:
    """Add a house rule to the settings; say whether they did not have it already.

    Raises
    ------
    SettingsError
        Where another rule says something else of the same objects; nothing is written then.
    """
    return bool(add_rules(config, (rule,)))
