"""Columns that are fields -> the section [columns] of a mapping: units, flags, and what is left out, and why."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import tomlkit

from pipeline.collection.cells import GROUPED
from pipeline.collection.display_words import flag_of, says_away, says_flags, tells_nothing
from pipeline.collection.errors import CollectionError
from pipeline.collection.guessing.columns import NUMBER, Column, untaken
from pipeline.collection.guessing.going_on import framed_first, goes_on_in
from pipeline.collection.guessing.names import TEXTS, bare, called, unit_in
from pipeline.collection.guessing.questions import Question, asked_unit
from pipeline.collection.guessing.units import FEET
from pipeline.collection.mapping import MAPPABLE, WRITTEN
from pipeline.collection.money import no_money
from pipeline.collection.record import CHOICES, KINDS, units_of
from pipeline.collection.sources.measurement_terms import unit_of
from pipeline.collection.sources.rows import TypedNumber
from pipeline.tables.held_rows import HeldAs, meant_of, told_by

MOST_WORDS = 30
"""Different texts that a column of flags has at most."""

_ADDED = {("ft", "in"): 12.0, ("lb", "oz"): 16.0}
"""A greater and a lesser unit -> of the lesser in one of the greater."""

_NAMING = 0.5
"""Share of a column's texts that name a unit from which each is read with its own."""

ASKED = 200
"""Different texts of a column that are asked how a thing is held: a word of each is looked for in forty rows."""
_NEXT = 100
"""A whole number of a column from which its numbers may go on to thousands (judgement)."""
_COMMA = re.compile(r"(?<![\d,.])\d+,\d{1,2}(?![\d,.])", re.ASCII)
_POINT = re.compile(r"(?<![\d,.])\d+\.\d{1,2}(?![\d,.])", re.ASCII)


def decimal_of(columns: Sequence[Column], *, parted: bool = False) -> str:
    """Return the decimal mark that most numbers have, of cells and of dimension texts.

    Parameters
    ----------
    parted : bool, optional
        Cells are parted by commas; there a number of thousands may have been put into quotes as well ("1,250").

    Returns
    -------
    str
    """
    commas = points = 0
    grouped = False
    for column in columns:
        if called(column.name, "object_number"):
            # 1990.4 is the fourth object of that year.
            continue
        if thousands_in(column, ","):
            continue
        if thousands_in(column, "."):
            grouped = True
            continue
        for number in column.values:
            # What the source itself holds as a number says nothing of how people write one.
            if not isinstance(number, TypedNumber) and NUMBER.fullmatch(number.strip()):
                commas += "," in number and not (parted and GROUPED[","].fullmatch(number.strip()))
                points += "." in number
        if not column.numeric and (column.dimensional > 0.2 or called(column.name, TEXTS)):
            for text in column.filled:
                commas += len(_COMMA.findall(text))
                points += len(_POINT.findall(text))
    return "," if commas > points or (grouped and not points) else "."


def thousands_in(column: Column, mark: str) -> bool:
    """Say whether a mark parts thousands in a column: three digits stand behind each, beside hundreds without it.

    Parameters
    ----------
    column : Column
        Of numbers.
    mark : str
        Of "," and ".".

    Returns
    -------
    bool
    """
    if called(column.name, "object_number"):
        return False
    numbers = [one.strip() for one in column.filled if not isinstance(one, TypedNumber)]
    numbers = [one for one in numbers if NUMBER.fullmatch(one)]
    marked = [one for one in numbers if mark in one]
    hundreds = sum(one.isdecimal() and int(one) >= _NEXT for one in numbers)
    return 0 < len(marked) <= 2 * hundreds and all(map(GROUPED[mark].fullmatch, marked))


def images_among(columns: Sequence[Column], used: Iterable[Column]) -> Column | None:
    """Return the column whose texts are names of photographs: files, URLs, addresses of IIIF.

    Parameters
    ----------
    columns : sequence of Column
        Of the source.
    used : iterable of Column
        Those that are fields already.

    Returns
    -------
    Column or None
        Of several the one that is filled most; a large picture before a small one.
    """
    able = [one for one in untaken(columns, used) if one.filled and one.pictured > 0.8]
    return max(able, key=lambda one: (len(one.filled), "thumb" not in one.name.casefold()), default=None)


def pictures_said(columns: Sequence[Column], taken: Column, used: Iterable[Column]) -> str:
    """Return in words which column is taken to name photographs, and which others may.

    Parameters
    ----------
    columns : sequence of Column
        Of the source.
    taken : Column
        That which is taken.
    used : iterable of Column
        Those that are fields, and so name none.

    Returns
    -------
    str
    """
    fields = {id(column) for column in used}
    others = [one.name for one in columns if id(one) not in fields and one.filled and one.pictured > 0.8]
    first = next(filter(None, taken.filled), "")
    said = f"column {taken.name!r} is taken to name photographs, such as {first[:80]!r}"
    if others:
        said += f"; so may {', '.join(map(repr, others))}: --choose image=COLUMN takes another"
    return said


def flag_among(columns: Sequence[Column], used: Iterable[Column]) -> Column | None:
    """Return the column all of whose words say whether an object is on display, and not yes and no alone.

    Parameters
    ----------
    columns : sequence of Column
        Of the source.
    used : iterable of Column
        Those that are fields already.

    Returns
    -------
    Column or None
    """
    return next((one for one in untaken(columns, used) if one.filled and says_flags(one.filled)), None)


def tells_display(column: Column) -> bool:
    """Say whether a column tells in words how objects are displayed or held, and is no flag and no vocabulary.

    Parameters
    ----------
    column : Column
        Of texts.

    Returns
    -------
    bool
    """
    vocabulary = {one.value for one in CHOICES["support"]}
    some = [text for text in column.distinct if flag_of(text, display=True) is None]
    free = [text for text in some if text.casefold() not in vocabulary]
    return len(free) >= 0.5 * len(column.distinct) > 0 and any(told_by(text) != HeldAs() for text in free[:ASKED])


@dataclass
class Fields:
    """Writes the section [columns] of a mapping.

    Attributes
    ----------
    columns : sequence of Column
        All of the source: units may stand in a column of their own.
    choices : mapping of str to str
        What a person has chosen.
    doubts, questions : list
        What is to be looked at, and what may be decided; grows.
    usual : Column or None
        Of the usual places of objects, which counts where that of the places now is empty.
    place : Column or None
        Of the places now.
    joined : mapping of str to tuple of Column
        Field -> the columns whose texts it has together: of materials and of techniques.
    second : Column or None
        Of other numbers, for objects of which that of the objects' numbers says only that they have none.
    length : Column or None
        Of the lengths of objects that have no depth.
    """

    columns: Sequence[Column]
    choices: Mapping[str, str]
    doubts: list[str]
    questions: list[Question]
    usual: Column | None = None
    place: Column | None = None
    joined: Mapping[str, tuple[Column, ...]] = field(default_factory=dict)
    second: Column | None = None
    length: Column | None = None

    def mapped(self, found: Mapping[str, Column]) -> tuple[tomlkit.items.Table, list[Column]]:
        """Return the section, and the columns that it reads.

        Parameters
        ----------
        found : mapping of str to Column
            Field -> column.

        Returns
        -------
        (tomlkit table, list of Column)
        """
        out = tomlkit.table()
        used: list[Column] = []
        untold = {
            name: column
            for name, column in found.items()
            if "m" in units_of(name)
            and (column.numeric or (column.measured and column.dimensional <= _NAMING))
            and not any(self._told_unit(name, column))
        }
        sides = [column for name, column in found.items() if "m" in units_of(name)]
        unit = self._common_unit(untold, sides) if untold else self._told_in_common(found)
        for name in MAPPABLE:
            column = found.get(name)
            if column is None:
                if name == "gallery":
                    out[name] = {"constant": "Location not recorded"}
                    self.doubts.append(
                        "no column tells where an object is: all are in one gallery until --choose gallery=COLUMN "
                        "names one"
                    )
                continue
            entry = self._measured(name, column, unit) if units_of(name) else self._entry(name, column)
            if name == "gallery" and self.usual is not None:
                entry = self._or_usual(column, self.usual)
                used.append(self.usual)
            if name == "object_number" and self.second is not None:
                entry = self._or_second(column, self.second)
                used.append(self.second)
            if name == "depth_m" and self.length is not None and entry is not None and "column" in entry:
                self._or_length(entry, self.length)
                used.append(self.length)
            more = goes_on_in(column, self.columns) if entry is not None and entry.get("unit") == WRITTEN else None
            pair = (column, more) if more is not None else framed_first(column, self.columns)
            if entry is not None and pair and entry.pop("column", None):
                entry["columns"], entry["first"] = [one.name for one in pair], True
                self.questions[:] = [question for question in self.questions if question.key != name]
                used += pair
            if self.joined.get(name):
                entry = tomlkit.table()
                entry["columns"], entry["separator"] = [one.name for one in self.joined[name]], ", "
                used += (one for one in self.joined[name] if one is not column)
            if entry is not None:
                out[name] = entry
                used.append(column)
        return out, used

    def _or_usual(self, column: Column, usual: Column) -> tomlkit.items.Table:
        entry = tomlkit.table()
        entry["columns"], entry["first"] = [column.name, usual.name], True
        self.doubts.append(f"an object's place is {column.name!r}, and where that is empty {usual.name!r}")
        return entry

    def _or_length(self, entry: tomlkit.items.Table, length: Column) -> None:
        depth = str(entry.pop("column"))
        entry["columns"], entry["first"], entry["missing"] = [depth, length.name], True, [0.0]
        self.doubts.append(
            f"the depth is {depth!r}, and where that tells none {length.name!r}; --choose depth_m={depth} leaves that "
            "out"
        )

    def _or_second(self, column: Column, second: Column) -> tomlkit.items.Table:
        entry = tomlkit.table()
        entry["columns"], entry["first"], entry["missing"] = [column.name, second.name], True, list(column.blanks)
        self.doubts.append(
            f"column {column.name!r} says {', '.join(map(repr, column.blanks[:4]))} of several objects, which is no "
            f"number: these have that of {second.name!r}; --choose object_number={column.name} leaves that out"
        )
        return entry

    def _entry(self, name: str, column: Column) -> tomlkit.items.Table | None:
        entry = tomlkit.table()
        entry["column"] = column.name
        kind = KINDS.get(name, "number")
        if name == "aat":
            entry = tomlkit.table()
            entry["columns"] = [column.name]
        elif kind == "flag":
            return self._flag(name, column, entry)
        elif kind == "choice":
            return self._choice(name, column, entry)
        why = ""
        if name == "value":
            why = no_money(column.filled)
        elif kind in ("number", "integer") and column.filled and not column.numeric:
            why = "most of its cells are no numbers"
        if why:
            self.doubts.append(f"column {column.name!r} is left out: it may be {name}, but {why}")
            return None
        return entry

    def _choice(self, name: str, column: Column, entry: tomlkit.items.Table) -> tomlkit.items.Table | None:
        """Return the entry of words that are some of a vocabulary, or mean some of it."""
        words = {one.value for one in CHOICES[name]}
        texts = list({text.casefold(): text for text in reversed(column.distinct)}.values())[::-1]
        said = {text: text.casefold() if text.casefold() in words else meant_of(name, text) for text in texts}
        unknown = [text for text, meaning in said.items() if not meaning]
        if len(unknown) > 0.5 * len(said) or len(said) > MOST_WORDS:
            self._leave_out(name, column, f"in other words than {', '.join(sorted(words))}")
            return None
        if any(meaning != text.casefold() for text, meaning in said.items() if meaning):
            entry["values"] = values = tomlkit.inline_table()
            for text, meaning in said.items():
                if meaning:
                    values[text] = meaning
            told = ", ".join(f"{text!r} as {meaning}" for text, meaning in list(said.items())[:8] if meaning)
            self.doubts.append(f"column {column.name!r} is read as {name.replace('_', ' ')}: {told}")
        if unknown:
            told = ", ".join(map(repr, unknown[:8]))
            self.doubts.append(f"column {column.name!r}: what is meant by {told}? Add it to [columns.{name}] values")
        return entry

    def _leave_out(self, name: str, column: Column, why: str) -> None:
        self.doubts.append(
            f"column {column.name!r} is left out: it may be {name}, but {why}; give the meanings in the mapping, "
            f"[columns.{name}] values"
        )

    def _flag(self, name: str, column: Column, entry: tomlkit.items.Table) -> tomlkit.items.Table | None:
        words = column.distinct
        if len(words) > MOST_WORDS:
            self._leave_out(name, column, f"holds {len(words)} different texts")
            return None
        display = name == "on_display"
        known = {word: said for word in words if (said := flag_of(word, display=display)) is not None}
        unknown = ", ".join([repr(word) for word in words if word not in known][:8])
        if not known:
            self._leave_out(name, column, f"none of its words is known ({unknown})" if words else "it is empty")
            return None
        values = tomlkit.inline_table()
        seen = set()
        for word, meaning in known.items():
            if word.casefold() not in seen:
                seen.add(word.casefold())
                values[word] = meaning
        if display and self._places_tell(column):
            self.doubts.append(
                f"column {column.name!r} is empty where {self.place.name if self.place else ''!r} names a gallery: an "
                f'empty cell says nothing, and the place tells; put "" = false into [columns.{name}] values where it '
                "means no"
            )
        elif display and False not in known.values() and len(column.filled) < len(column.values):
            values[""] = False  # a box that is ticked or not
            self.doubts.append(
                f"column {column.name!r} says nothing but {', '.join(map(repr, known))}: an empty cell means "
                f'no; leave "" out of [columns.{name}] values where it says nothing'
            )
        entry["values"] = values
        if unknown:
            self.doubts.append(f"column {column.name!r}: what is meant by {unknown}? Add it to [columns.{name}] values")
        return entry

    def _places_tell(self, column: Column) -> bool:
        """Whether places say by themselves what is not on display, and others are named where a flag is empty."""
        if self.place is None or not any(map(says_away, self.place.distinct)):
            return False
        pairs = zip(column.values, self.place.values, strict=False)
        return any(place.strip() and not flag.strip() and not says_away(place) for flag, place in pairs)

    def _measured(self, name: str, column: Column, common: str) -> tomlkit.items.Table | None:
        """Return the entry of a length or a mass; ``common`` is the unit of lengths that tell none."""
        if not column.filled:
            return None
        units = units_of(name)
        unit, beside = self._told_unit(name, column)
        parts = self._added(name, column)
        if parts:
            return self._sum(name, parts)
        # Of a column of fractions and inch marks that names its unit, or has one chosen for it.
        fractions = len(column.numbers) < len(column.filled) and column.by_hand >= 0.5 and beside is None
        if fractions and (unit in units or (unit is None and column.dimensional <= _NAMING and "m" in units)):
            return self._by_hand(column, unit or common)
        if unit is None and not column.numeric:
            # "heavy" and "n/a" say nothing of how the others are written.
            figured = sum(any(map(str.isdecimal, text)) for text in column.filled)
            if column.dimensional * len(column.filled) <= _NAMING * figured:
                what, unit = ("weights", "kg") if "kg" in units else ("lengths", "cm")
                self.doubts.append(
                    f"column {column.name!r} holds neither numbers alone nor mostly {what} with units: left out; "
                    f"--choose {name}.unit={unit} takes it nevertheless"
                )
                return None
            unit = WRITTEN
        if unit is None and "kg" in units:
            unit, why = (
                ("lb", "pounds are taken, as lengths are in inches")
                if common in FEET
                else ("kg", "kilograms are taken")
            )
            self.doubts.append(f"column {column.name!r} tells no unit: {why}; --choose {name}.unit=g takes another")
            self.questions.append(Question(f"{name}.unit", f"in which unit is {column.name!r}?", tuple(units), unit))
        entry = tomlkit.table()
        if beside is None:
            entry["column"] = column.name
        else:
            entry["columns"] = [column.name, beside.name]
        entry["unit"] = unit or common
        zeros = sorted({number for number in column.numbers if float(number.replace(",", ".")) == 0.0})
        if zeros:
            # The unit that is joined makes a text of it.
            entry["missing"] = [0.0] if unit != WRITTEN else zeros
        return entry

    def _by_hand(self, column: Column, unit: str) -> tomlkit.items.Table:
        entry = tomlkit.table()
        entry["column"], entry["unit"], entry["by_hand"] = column.name, unit, True
        blanks = [text for text in column.distinct if tells_nothing(text)]
        if blanks:
            entry["missing"] = blanks
        self.doubts.append(f"column {column.name!r} is read as written by hand: fractions, inch marks, {unit} else")
        return entry

    def _added(self, name: str, column: Column) -> list[tuple[Column, str]]:
        """Return the columns of a greater and a lesser unit that add up: feet beside inches, pounds beside ounces."""
        base = bare(column.name)
        there = {unit_in(one.name)[1]: one for one in self.columns if bare(one.name) == base and one.numeric}
        for (great, less), most in _ADDED.items():
            pair = there.get(great), there.get(less)
            if pair[0] is None or pair[1] is None or great not in units_of(name) or column not in pair:
                continue
            whole = all(float(text.replace(",", ".")).is_integer() for text in pair[0].numbers)
            if whole and all(float(text.replace(",", ".")) < most for text in pair[1].numbers):
                return [(pair[0], great), (pair[1], less)]
        return []

    def _sum(self, name: str, parts: Sequence[tuple[Column, str]]) -> tomlkit.items.Table:
        entry = tomlkit.table()
        entry["columns"], entry["units"] = [one.name for one, _ in parts], [unit for _, unit in parts]
        words = name.removesuffix("_m").removesuffix("_kg").replace("_", " ")
        self.doubts.append(f"the {words} is {' and '.join(f'{one.name!r} ({unit})' for one, unit in parts)} together")
        return entry

    def _told_unit(self, name: str, column: Column) -> tuple[str | None, Column | None]:
        """Return the unit that was chosen, or that the name or another column tells, and that other column."""
        units = units_of(name)
        chosen = self.choices.get(f"{name}.unit") or (self.choices.get("unit") if "m" in units else None)
        if chosen is not None:
            if chosen not in (*units, WRITTEN):
                raise CollectionError(f"--choose {name}.unit: {chosen!r} is none of {', '.join((*units, WRITTEN))}")
            return chosen, None
        told = unit_in(column.name)[1]
        if told is not None and told in units:
            return told, None
        beside = _unit_column(column, self.columns, units) if column.numeric else None
        if beside is None:
            return None, None
        same = {unit_of(text) for text in beside.distinct}
        return (same.pop(), None) if len(same) == 1 else (WRITTEN, beside)

    def _told_in_common(self, found: Mapping[str, Column]) -> str:
        """Return the unit that all columns of lengths tell; "" for none, or several."""
        told = {self._told_unit(name, column)[0] for name, column in found.items() if "m" in units_of(name)}
        return (told.pop() or "") if len(told) == 1 else ""

    def _common_unit(self, untold: Mapping[str, Column], sides: Sequence[Column]) -> str:
        """Return the unit of the lengths that tell none, which one file has in common, and ask about it."""
        numbers = [text for column in sides for text in column.filled]
        return asked_unit([column.name for column in untold.values()], numbers, self.doubts, self.questions)


def _unit_column(column: Column, columns: Sequence[Column], units: Mapping[str, float]) -> Column | None:
    """Return the column that tells the units of another: the next one to its right of which that holds, else the only
    one that there is."""
    at = [c is column for c in columns].index(True)
    able = [
        (where, other)
        for where, other in enumerate(columns)
        if other.units >= 0.9 and {unit_of(text) for text in other.distinct} <= set(units) | {None}
    ]
    after = [other for where, other in able if where > at]
    return after[0] if after else able[0][1] if len(able) == 1 else None
