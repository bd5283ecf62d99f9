"""One cell of a museum's file -> one value of the record, or None and a problem that names what is wrong."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from decimal import Context, Decimal
from enum import StrEnum
from math import isinf

from pipeline.collection.dimensions.structured import words_of
from pipeline.collection.display_words import flag_of
from pipeline.collection.hand_cell import of_hand
from pipeline.collection.mapping import WRITTEN, ColumnMap
from pipeline.collection.measured_cell import of_cell
from pipeline.collection.money import amount
from pipeline.collection.record import CHOICES, plausible, units_of
from pipeline.collection.sources.rows import TypedNumber, as_text
from pipeline.errors import InputError
from pipeline.quantities import LENGTHS, figures
from pipeline.records import ContactPolygon, Origin, Problem, Provenance
from pipeline.tables.held_rows import meant_of

_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d{1,4})?", re.ASCII)
_NOTED = re.compile(r"\s*(?P<number>[^()]*\d[^()]*?)\s*(?P<note>\([^()\d]*[^\W\d_]{2}[^()\d]*\))\s*")
"""A number with a note in brackets behind it that has no number of its own: 5,3 (com pires)."""
GROUPED = {mark: re.compile(rf"[+-]?[1-9]\d{{0,2}}(?:{re.escape(mark)}\d{{3}})+(?!\d)", re.ASCII) for mark in ".,"}
"""Thousands parted by a mark: 1,450 and 1.450; by the decimal mark the same characters are another number."""
_SPACED = re.compile(r"[+-]?[1-9]\d{0,2}(?:[ \u00a0\u2009\u202f'\u2019]\d{3})+(?=[.,]\d+\Z|\Z)", re.ASCII)
"""Thousands parted by a blank or an apostrophe, which can be nothing else."""
_INFINITE = re.compile(r"[+-]?inf(inity)?", re.IGNORECASE)
_LONGEST_NUMBER = 40
_LONGEST_WRITTEN = 200
_LONGEST_OPENING = 160
_NEXT_LABEL = r"\s[^\W\d_]{4,24}:\s"
_SENTENCE = re.compile(r"(?<=\w{3})[.!?]\s|[;。；\n\r]")
"""Where the first sentence of a text ends; "c. 1900" and "St. Anne" go on."""
_MOST_POINTS = 1000
_BREAKS = re.compile("[\t\n\v\f\r\x85\u2028\u2029]+")
# The C0 and C1 controls; and the marks that turn the direction of all text that follows, also outside of the cell.
# Half a surrogate pair is no letter, and no database takes it.
_CONTROLS = re.compile("[\x00-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069\ud800-\udfff]")
_SPACE = " \t\r\n\v\f\u00a0\u3000"
# A product of two decimals is rounded once, to the nearest double: 79 in is 2.0066 m and not its neighbour.
_EXACT = Context(prec=80)
_FLAGS = {"1": True, "0": False}


@dataclass(slots=True)
class Cells:
    """The cells of one row on their way into a record.

    Attributes
    ----------
    decimal : str
        The source's decimal mark.
    thousands : bool
        Whether the other of point and comma parts thousands.
    provenance : list of Provenance
        Gathers where each number comes from.
    problems : list of Problem
        Gathers what is wrong; without the row's number, for a row that moves in its file is no other record.
    pairs : list of (str, float, float)
        Gathers what is said twice, field by field: by its own column and by a text, in SI.
    """

    decimal: str = "."
    thousands: bool = False
    provenance: list[Provenance] = field(default_factory=list)
    problems: list[Problem] = field(default_factory=list)
    pairs: list[tuple[str, float, float]] = field(default_factory=list)

    def number(self, name: str, column: ColumnMap, texts: Sequence[str]) -> float | None:
        """Return a number in SI units.

        Parameters
        ----------
        name : str
            The field.
        column : ColumnMap
            What the mapping says of it, its unit included.
        texts : sequence of str
            The cells.

        Returns
        -------
        float or None
            In SI; None where none is recorded or none can be accepted (then with a problem).
        """
        texts = [self._local(text) for text in texts]
        if column.units:
            return self._sum(name, column, texts)
        if column.first:
            texts = [next((text for text in texts if self._tells(text, column)), "")]
        text = texts[0].strip(_SPACE)
        if _missing(text, column):
            return None
        if name == "value" and (money := amount(text)) is not None:
            text = money[0].replace(".", self.decimal)
        noted = _NOTED.fullmatch(text)
        if noted is not None:
            return self._with_note(name, column, noted["note"], [noted["number"], *texts[1:]])
        if column.by_hand:
            return self._by_hand(name, column, text)
        if column.unit == WRITTEN:
            # A unit may stand in a column of its own.
            return self._written(name, column, " ".join([text, *(t.strip(_SPACE) for t in texts[1:])]).strip())
        value = self._parse(name, column, text)
        if value is None or any(value == m for m in column.missing if not isinstance(m, str)):
            return None
        units = units_of(name)
        unit = column.unit or plausible()[name].unit
        exact = _EXACT.create_decimal(self._plain(text))
        metric = float(_EXACT.multiply(exact, _EXACT.create_decimal(repr(units[unit])))) if units else value
        reason = _implausible(name, metric)
        if reason:
            shown = f"{_show(text)}{'' if unit == '-' else f' {unit}'}"
            converted = (
                f" = {figures(metric, 6)} {plausible()[name].unit}" if units and unit != plausible()[name].unit else ""
            )
            self._note(name, column, f"{shown}{converted} {reason}", _remedy(metric))
            return None
        written = as_text(exact) if unit == "-" else f"{as_text(exact)} {unit}"
        self.provenance.append(Provenance(name, Origin.MEASURED, written))
        # No negative zero: it equals zero, but a database may not give it back.
        return metric + 0.0

    def _tells(self, text: str, column: ColumnMap) -> bool:
        """Whether a cell of several says anything: a text that is not missing, and no number that means so."""
        text = text.strip(_SPACE)
        number = self._plain(text)
        nought = _NUMBER.fullmatch(number) and any(float(number) == m for m in column.missing if not isinstance(m, str))
        return not (_missing(text, column) or nought)

    def integer(self, name: str, column: ColumnMap, texts: Sequence[str]) -> int | None:
        """Return a whole number.

        Parameters
        ----------
        name, column, texts : str, ColumnMap, sequence of str
            As of `number`.

        Returns
        -------
        int or None
            None as of `number`.
        """
        value = self.number(name, column, texts)
        if value is not None and not value.is_integer():
            self._note(name, column, f"{_show(texts[0])} is not a whole number", "give a count")
            self.provenance.pop()
            return None
        return None if value is None else int(value)

    def text(self, name: str, column: ColumnMap, texts: Sequence[str], *, limit: int) -> str:
        """Return the cells' text as it is: stripped, without control characters, capped; each change with a problem.

        A text that the mapping's ``values`` do not list stays as it is: they translate, they do not restrict.

        Parameters
        ----------
        name, column, texts : str, ColumnMap, sequence of str
            As of `number`.
        limit : int
            Most characters.

        Returns
        -------
        str
            "" where nothing is recorded.
        """
        read = (_behind(words_of(text), column.behind) for text in texts)
        parts = [self._clean(name, column, _opening(text) if column.opening else text) for text in read]
        if column.first:
            parts = [next((part for part in parts if not _missing(part, column)), "")]
        text = column.separator.join(part for part in parts if part)
        if _missing(text, column):
            return ""
        if column.values:
            text = str(_translate(column).get(text.casefold(), text))
        if len(text) > limit:
            message = f"{len(text):,} characters, of which the first {limit:,} are kept"
            self._note(name, column, message, "shorten it in the museum's database")
            text = text[:limit].rstrip()
        return text

    def choice(self, name: str, column: ColumnMap, texts: Sequence[str]) -> StrEnum | None:
        """Return a word of the field's vocabulary.

        Parameters
        ----------
        name, column, texts : str, ColumnMap, sequence of str
            As of `number`.

        Returns
        -------
        StrEnum or None
            None where it is not recorded or no known word (then with a problem).
        """
        text = texts[0].strip(_SPACE)
        if _missing(text, column):
            return None
        meaning = str(_translate(column).get(text.casefold(), text.casefold()))
        known = [one.value for one in CHOICES[name]]
        # What no mapping translates may be said as people write it: "two hooks or D-rings".
        meaning = meaning if meaning in known else meant_of(name, text)
        if meaning not in known:
            given = ", ".join(map(repr, column.values))
            message = f"{_show(text)} is none of {', '.join(known)}{f', nor of {given}' if given else ''}"
            self._note(name, column, message, f"add it to the mapping, [columns.{name}] values")
            return None
        return CHOICES[name](meaning)

    def polygon(self, name: str, column: ColumnMap, texts: Sequence[str]) -> tuple[tuple[float, float], ...]:
        """Return the points of a contact polygon, in SI units.

        Parameters
        ----------
        name, column, texts : str, ColumnMap, sequence of str
            As of `number`; the cell holds "x y; x y; x y" or a JSON array of pairs.

        Returns
        -------
        tuple of (float, float)
            () where none is recorded or none can be accepted (then with a problem).
        """
        text = texts[0].strip(_SPACE)
        if _missing(text, column):
            return ()
        unit = column.unit or plausible()[name].unit
        pairs = _pairs(text, self.decimal)
        if pairs is None:
            self._note(name, column, f"{_show(text)} is no list of points", 'write it as "x y; x y; x y"')
            return ()
        points = tuple((x * LENGTHS[unit], y * LENGTHS[unit]) for x, y in pairs)
        for value in (value for point in points for value in point):
            if not plausible()[name].low <= value <= plausible()[name].high:
                self._note(
                    name, column, f"the coordinate {figures(value, 6)} m {_implausible(name, value)}", _remedy(value)
                )
                return ()
        try:
            ContactPolygon.around(points)
        except InputError as problem:
            self._note(name, column, str(problem), "measure the points from under the centre of gravity")
            return ()
        self.provenance.append(Provenance(name, Origin.MEASURED, f"{text[:_LONGEST_WRITTEN]} {unit}"))
        return points

    def flag(self, name: str, column: ColumnMap, texts: Sequence[str]) -> bool | None:
        """Return yes or no.

        Parameters
        ----------
        name, column, texts : str, ColumnMap, sequence of str
            As of `number`.

        Returns
        -------
        bool or None
            None where it is not recorded or no known word (then with a problem).
        """
        text = texts[0].strip(_SPACE)
        translated = _translate(column)
        if _missing(text, column) and not (text == "" and "" in translated):
            return None
        meaning = translated.get(text.casefold(), _FLAGS.get(text))
        if meaning is None:
            meaning = flag_of(text, display=name == "on_display")
        if not isinstance(meaning, bool):
            message = f"{_show(text)} is neither yes nor no"
            self._note(name, column, message, f"add it to the mapping, [columns.{name}] values")
            return None
        return meaning

    def plausible(self, name: str, value: float, written: str) -> bool:
        """Say whether a number of a dimension text can be true; note it where it cannot.

        Parameters
        ----------
        name : str
            The field.
        value : float
            In SI.
        written : str
            As it stands in the text.

        Returns
        -------
        bool
            False with a problem.
        """
        reason = _implausible(name, value)
        if reason:
            message = f"{_show(written)} = {figures(value, 6)} {plausible()[name].unit} {reason}"
            self.problems.append(Problem(name, message, "correct the text in the museum's database"))
        return not reason

    def refuse(self, name: str, column: ColumnMap, message: str, remedy: str) -> None:
        """Note that a cell cannot be used, as its source says.

        Parameters
        ----------
        name : str
            The field.
        column : ColumnMap
            What the mapping says of it.
        message, remedy : str
            What is wrong, and what mends it.
        """
        self._note(name, column, message, remedy)

    def _sum(self, name: str, column: ColumnMap, texts: Sequence[str]) -> float | None:
        """Return what several columns say together, each in its unit; none of them says anything where all are 0."""
        units, exact_sum, written = units_of(name), Decimal(0), list[str]()
        for text, unit in zip((text.strip(_SPACE) for text in texts), column.units, strict=True):
            value = None if _missing(text, column) else self._parse(name, column, text)
            if text and value is None and not _missing(text, column):
                return None  # a part that cannot be read leaves no sum
            if value:
                exact = _EXACT.create_decimal(self._plain(text))
                exact_sum = _EXACT.fma(exact, _EXACT.create_decimal(repr(units[unit])), exact_sum)
                written.append(f"{as_text(exact)} {unit}")
        if not written:
            return None
        total = float(exact_sum)
        reason = _implausible(name, total)
        if reason:
            shown = f"{' '.join(written)} = {figures(total, 6)} {plausible()[name].unit} {reason}"
            self._note(name, column, shown, _remedy(total))
            return None
        self.provenance.append(Provenance(name, Origin.MEASURED, " ".join(written)))
        return total

    def _with_note(self, name: str, column: ColumnMap, note: str, texts: Sequence[str]) -> float | None:
        """Return the number in front of a note, with a doubt: it may say that the number is not of the object alone."""
        value = self.number(name, column, texts)
        if value is not None:
            message = f"behind the number stands {_show(note)}; the number is taken"
            self._note(name, column, message, "see whether it is that of the whole object, and move the note elsewhere")
        return value

    def _written(self, name: str, column: ColumnMap, text: str) -> float | None:
        found = of_cell(text, plausible()[name].unit, self.decimal)
        if found is None:
            self._note(name, column, f"{_show(text)} is no number with its unit", "write it as in 23 cm or 8 1/2 in")
            return None
        if not self.plausible(name, found[0], text):
            return None
        self.provenance.append(Provenance(name, Origin.MEASURED, found[1]))
        return found[0]

    def _by_hand(self, name: str, column: ColumnMap, text: str) -> float | None:
        unit = column.unit or plausible()[name].unit
        try:
            found = of_hand(text, unit, signed=plausible()[name].low < 0.0)
        except InputError as problem:
            self._note(name, column, str(problem), f"write one number{_in_unit(unit)}, as 8 1/2 or 0.3")
            return None
        reason = _implausible(name, found.value)
        if reason:
            shown = f"{_show(text)} = {figures(found.value, 6)} {plausible()[name].unit} {reason}".replace(" - ", " ")
            self._note(name, column, shown, "measure it again, or leave the cell empty")
            return None
        said = "said to be about so" if found.about else ""
        self.provenance.append(Provenance(name, Origin.MEASURED, found.written, said))
        return found.value

    def _parse(self, name: str, column: ColumnMap, text: str) -> float | None:
        plain = self._plain(text)
        if len(plain) <= _LONGEST_NUMBER and _NUMBER.fullmatch(plain):
            value = float(plain)
            if not isinf(value):
                return value
        elif not _INFINITE.fullmatch(plain):
            hint = "write numbers without units or thousands separators"
            if not self.thousands and GROUPED[parting_mark(self.decimal)].match(text):
                hint += ", or where thousands are parted so say thousands = true in the mapping, [source]"
            if self.decimal == "." and "," in text:
                hint += ', and if the comma is the decimal mark say decimal = "," in the mapping, [source]'
            self._note(name, column, f"{_show(text)} is not a number", f"{hint}; or list it as missing in the mapping")
            return None
        self._note(name, column, f"{_show(text)} is infinite", "measure it, or leave the cell empty")
        return None

    def _local(self, text: str) -> str:
        return text.replace(".", self.decimal) if isinstance(text, TypedNumber) else text

    def _plain(self, text: str) -> str:
        text = unspaced(text)
        found = GROUPED[parting_mark(self.decimal)].match(text) if self.thousands else None
        if found is not None:
            text = re.sub("[.,]", "", found.group()) + text[found.end() :]
        # A dot in a file with decimal commas separates thousands or is a slip: both are refused, not guessed.
        return text if self.decimal == "." else text.replace(".", "?").replace(",", ".")

    def _clean(self, name: str, column: ColumnMap, text: str) -> str:
        text = text.strip(_SPACE)
        if text.isprintable():
            # Nearly all are, and none of those has what is looked for below.
            return text
        clean = _CONTROLS.sub("", _BREAKS.sub(" ", text))
        if clean != text:
            found = sorted({f"U+{ord(c):04X}" for c in _CONTROLS.findall(text) + _BREAKS.findall(text) for c in c})
            message = f"control characters were removed ({', '.join(found)}; line breaks became spaces)"
            self._note(name, column, message, "retype the text in the museum's database")
        return clean.strip(_SPACE)

    def _note(self, name: str, column: ColumnMap, message: str, remedy: str) -> None:
        source = " + ".join(_show(part) for part in column.sources)
        self.problems.append(Problem(name, f"column {source}: {message}", remedy))


def parting_mark(decimal: str) -> str:
    """Return which of point and comma may part thousands: the one that is not the decimal mark."""
    return "." if decimal == "," else ","


def unspaced(text: str) -> str:
    """Return a number without the blanks or apostrophes that part its thousands: of "1 450,5" 1450,5.

    Parameters
    ----------
    text : str
        Of a cell; what is no such number stays.
    """
    found = _SPACED.match(text)
    return text if found is None else re.sub(r"[^\d+-]", "", found.group()) + text[found.end() :]


def _in_unit(unit: str) -> str:
    named = {"in": "inches", "ft": "feet"}.get(unit, unit)
    return "" if unit == "-" else f" in {named}, or with its unit"


def _pairs(text: str, decimal: str) -> list[tuple[float, float]] | None:
    """Return the points that a cell holds, as they are written; None for what holds none."""
    try:
        if text.startswith("["):
            found = [[float(value) for value in point] for point in json.loads(text)]
        else:
            # A decimal comma cannot part x from y as well.
            plain = text.replace(".", "?").replace(",", ".") if decimal == "," else text.replace(",", " ")
            found = [[float(word) for word in part.split()] for part in plain.split(";") if part.strip()]
    except (ValueError, TypeError, RecursionError):
        return None
    if not 0 < len(found) <= _MOST_POINTS or any(len(point) != 2 for point in found):
        return None
    return [(x, y) for x, y in found]


def _behind(text: str, labels: Sequence[str]) -> str:
    """Return what stands in a text behind the first of some labels that is there; the text where none is."""
    for label in labels:
        found = re.search(rf"(?<!\w){re.escape(label)}\s*:\s*(.*?)(?={_NEXT_LABEL}|\Z)", text, re.DOTALL)
        if found is not None and found[1].strip():
            return found[1]
    return text


def _opening(text: str) -> str:
    """Return the first sentence of a description, or as many of its first words as a name may have."""
    first = _SENTENCE.split(text.strip(_SPACE), maxsplit=1)[0]
    return first if len(first) <= _LONGEST_OPENING else first[:_LONGEST_OPENING].rpartition(" ")[0]


def _missing(text: str, column: ColumnMap) -> bool:
    if not text or not column.missing:
        return not text
    return any(text.casefold() == m.casefold() for m in column.missing if isinstance(m, str))


def _translate(column: ColumnMap) -> dict[str, str | bool]:
    return {text.casefold(): meaning for text, meaning in column.values.items()}


def _implausible(name: str, value: float) -> str:
    limits = plausible()[name]
    if limits.low <= value <= limits.high:
        return ""
    if value == 0.0:
        return "is zero, which nothing real can be"
    if value < 0.0 <= limits.low:
        return "is negative"
    unit = "" if limits.unit == "-" else f" {limits.unit}"
    return f"is implausible: not within {limits.low:g} to {limits.high:g}{unit} ({limits.reason})"


def _remedy(value: float) -> str:
    if value == 0.0:
        return "if 0 means that it was not recorded, add missing = [0.0] to the mapping; else correct it"
    return "correct it in the museum's database, or the column's unit in the mapping"


def _show(text: str) -> str:
    return repr(text if len(text) <= 60 else f"{text[:60]}...")
