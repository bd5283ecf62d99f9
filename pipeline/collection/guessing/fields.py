"""Columns that are fields -> the section [columns] of a mapping: units, flags, and what is left out, and why."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import tomlkit

from pipeline.collection.errors import CollectionError
from pipeline.collection.guessing.columns import Column
from pipeline.collection.guessing.names import unit_in
from pipeline.collection.guessing.words import shown
from pipeline.collection.mapping import MAPPABLE, WRITTEN
from pipeline.collection.record import CHOICES, KINDS, units_of
from pipeline.collection.sources.measurement_terms import unit_of

FEWEST = 5
"""Numbers in eighths or sixteenths from which a column is taken to be in inches."""

MOST_WORDS = 30
"""Different texts that a column of flags has at most."""

_TENTHS = re.compile(r"\d*[.,][1-46-9]")
_SIXTEENTHS = re.compile(r"\d*[.,](?:0625|125|1875|3125|375|4375|5625|625|6875|8125|875|9375)")
_COMMA = re.compile(r"(?<![\d,.])\d+,\d{1,2}(?![\d,.])", re.ASCII)
_POINT = re.compile(r"(?<![\d,.])\d+\.\d{1,2}(?![\d,.])", re.ASCII)


@dataclass(frozen=True)
class Question:
    """What a person may decide.

    Attributes
    ----------
    key : str
        By which the choice is given: ``--choose key=...``.
    text : str
        The question.
    options : tuple of str
        What may be chosen; the first ones are the likeliest.
    taken : str
        What is taken where nobody answers.
    """

    key: str
    text: str
    options: tuple[str, ...]
    taken: str


def decimal_of(columns: Sequence[Column]) -> str:
    """Return the decimal mark that most numbers have, of cells and of dimension texts."""
    commas = points = 0
    for column in columns:
        for number in column.numbers:
            commas += "," in number
            points += "." in number
        if not column.numeric and column.dimensional > 0.2:
            for text in column.filled:
                commas += len(_COMMA.findall(text))
                points += len(_POINT.findall(text))
    return "," if commas > points else "."


def mapped(
    found: Mapping[str, Column],
    columns: Sequence[Column],
    choices: Mapping[str, str],
    doubts: list[str],
    questions: list[Question],
) -> tuple[tomlkit.items.Table, list[Column]]:
    """Return the section [columns], and the columns that it reads.

    Parameters
    ----------
    found : mapping of str to Column
        Field -> column.
    columns : sequence of Column
        All of the source: units may stand in a column of their own.
    choices : mapping of str to str
        What a person has chosen.
    doubts, questions : list
        What is added to.

    Returns
    -------
    (tomlkit table, list of Column)
    """
    out = tomlkit.table()
    used: list[Column] = []
    for name in MAPPABLE:
        column = found.get(name)
        if column is None:
            if name == "gallery":
                out[name] = {"constant": "Location not recorded"}
                doubts.append(
                    "no column tells where an object is: all are in one gallery until --choose gallery=COLUMN names one"
                )
            continue
        entry = _entry(name, column, columns, choices, doubts, questions)
        if entry is not None:
            out[name] = entry
            used.append(column)
    return out, used


def _entry(
    name: str,
    column: Column,
    columns: Sequence[Column],
    choices: Mapping[str, str],
    doubts: list[str],
    questions: list[Question],
) -> tomlkit.items.Table | None:
    entry = tomlkit.table()
    entry["column"] = column.name
    kind = KINDS.get(name, "number")
    if units_of(name):
        return _measured(name, column, columns, choices, doubts, questions)
    if name == "aat":
        entry = tomlkit.table()
        entry["columns"] = [column.name]
    elif kind == "flag":
        return _flag(name, column, entry, doubts)
    elif kind == "choice":
        words = {one.value for one in CHOICES[name]}
        if sum(text.casefold() in words for text in column.distinct) < 0.5 * len(column.distinct):
            doubts.append(
                f"column {column.name!r} is left out: it may be {name}, but in other words than "
                f"{', '.join(sorted(words))}; give their meanings in the mapping, [columns.{name}] values"
            )
            return None
    elif kind in ("number", "integer") and column.filled and not column.numeric:
        doubts.append(f"column {column.name!r} is left out: it may be {name}, but most of its cells are no numbers")
        return None
    return entry


def _flag(name: str, column: Column, entry: tomlkit.items.Table, doubts: list[str]) -> tomlkit.items.Table | None:
    words = column.distinct
    if len(words) > MOST_WORDS:
        doubts.append(
            f"column {column.name!r} is left out: it may be {name}, but holds {len(words)} different texts; give their "
            f"meanings in the mapping, [columns.{name}] values"
        )
        return None
    known = {word: meaning for word in words if (meaning := shown(word)) is not None}
    unknown = [word for word in words if word not in known]
    if not known:
        doubts.append(
            f"column {column.name!r} is left out: it may be {name}, but none of its words is known "
            f"({', '.join(map(repr, words[:8]))}); give their meanings in the mapping, [columns.{name}] values"
        )
        return None
    values = tomlkit.inline_table()
    seen = set()
    for word, meaning in known.items():
        if word.casefold() not in seen:
            seen.add(word.casefold())
            values[word] = meaning
    entry["values"] = values
    if unknown:
        doubts.append(
            f"column {column.name!r}: what is meant by {', '.join(map(repr, unknown[:8]))}? Add it to [columns.{name}] "
            'values = { "..." = true } (or false)'
        )
    return entry


def _measured(
    name: str,
    column: Column,
    columns: Sequence[Column],
    choices: Mapping[str, str],
    doubts: list[str],
    questions: list[Question],
) -> tomlkit.items.Table | None:
    entry = tomlkit.table()
    if not column.filled:
        return None
    unit, beside = _unit(name, column, columns, choices, doubts, questions)
    if unit is None:
        return None
    if beside is None:
        entry["column"] = column.name
    else:
        entry["columns"] = [column.name, beside.name]
    entry["unit"] = unit
    if any(float(n.replace(",", ".")) == 0.0 for n in column.numbers):
        # The unit that is joined makes a text of it.
        zeros = [0.0] if unit != WRITTEN else sorted({n for n in column.numbers if float(n.replace(",", ".")) == 0.0})
        entry["missing"] = zeros
    return entry


def _unit(
    name: str,
    column: Column,
    columns: Sequence[Column],
    choices: Mapping[str, str],
    doubts: list[str],
    questions: list[Question],
) -> tuple[str | None, Column | None]:
    """Return the unit of a column, and the column that tells it cell by cell."""
    units = units_of(name)
    chosen = choices.get(f"{name}.unit")
    if chosen is not None:
        if chosen not in (*units, WRITTEN):
            raise CollectionError(f"--choose {name}.unit: {chosen!r} is none of {', '.join((*units, WRITTEN))}")
        return chosen, None
    told = unit_in(column.name)[1]
    if told is not None and told in units:
        return told, None
    if column.filled and not column.numeric:
        if column.dimensional > 0.5:
            return WRITTEN, None
        doubts.append(
            f"column {column.name!r} holds neither numbers nor lengths with units: left out; --choose {name}.unit=cm "
            "takes it nevertheless"
        )
        return None, None
    beside = _unit_column(column, columns, units)
    if beside is not None:
        same = {unit_of(text) for text in beside.distinct}
        if len(same) == 1:
            return same.pop(), None
        return WRITTEN, beside
    if "kg" in units:
        doubts.append(
            f"column {column.name!r} tells no unit: kilograms are taken; --choose {name}.unit=g takes another"
        )
        questions.append(Question(f"{name}.unit", f"in which unit is {column.name!r}?", tuple(units), "kg"))
        return "kg", None
    sixteenths = sum(bool(_SIXTEENTHS.fullmatch(n)) for n in column.numbers)
    tenths = sum(bool(_TENTHS.fullmatch(n)) for n in column.numbers)
    inches = sixteenths >= FEWEST and sixteenths > 3 * tenths
    unit = "in" if inches else "cm"
    why = "inches are taken, for it has eighths and sixteenths" if inches else "centimetres are taken"
    doubts.append(f"column {column.name!r} tells no unit: {why}; --choose {name}.unit=mm takes another")
    questions.append(Question(f"{name}.unit", f"in which unit is {column.name!r}?", tuple(units), unit))
    return unit, None


def _unit_column(column: Column, columns: Sequence[Column], units: Mapping[str, float]) -> Column | None:
    """Return the column that tells the units of another: the next one to its right of which that holds."""
    after = list(columns)[[c is column for c in columns].index(True) + 1 :]
    for other in after:
        if other.units >= 0.9 and {unit_of(text) for text in other.distinct} <= set(units) | {None}:
            return other
    return None
