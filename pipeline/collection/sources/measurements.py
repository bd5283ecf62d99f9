"""Measurements of one record, each with its kind, part, value and unit -> the cells of a row."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from math import isclose
from typing import Literal

from pydantic import Field

from pipeline.collection.sources.base import SourceSettings
from pipeline.collection.sources.measurement_terms import KINDS, PARTS, kind_of, kind_within, part_of, unit_of
from pipeline.collection.sources.rows import NO_FAULTS, Row
from pipeline.quantities import LENGTHS, MASSES

MEASURED = tuple(f"{part} {kind}".strip() for part in PARTS for kind in KINDS)
"""Columns of measurements: "height", "width", ... "base height", ... "frame weight"."""

OTHER = "other_measurements"
"""Column of those of unknown kinds or parts, and of second values."""

IN_WORDS = "measurements_in_words"
"""Column of all of a record whose columns do not tell the whole, as one text: it is read as texts of dimensions are."""

OF_MEASUREMENTS = (*MEASURED, OTHER, IN_WORDS)

COLUMNS = (
    "object_number",
    "record_id",
    "title",
    "object_name",
    "object_name_aat",
    "classification",
    "classification_aat",
    "medium",
    "medium_aat",
    "gallery",
    "on_display",
    "image",
    "image_credit",
    "dimensions",
    *OF_MEASUREMENTS,
)
"""The header of formats whose records are objects with measurements (Adlib XML, MuseumPlus RIA XML, Linked Art)."""
SAME = 0.01
"""Relative difference up to which two statements of one measurement agree: what is rounded when inches become cm."""

NUMBER = re.compile(r"[+-]?\d+(?:[.,]\d+)?", re.ASCII)
FRACTION = re.compile(r"(?:(\d{1,4})[ -])?(\d{1,2})/([1-9]\d?)", re.ASCII)
"""A number as inches are written: 12 3/4."""
# Three digits behind a comma may be thousands: these are left as they are, to be doubted.
_COMMA = re.compile(r"[+-]?\d+,(?:\d{1,2}|\d{4,})", re.ASCII)
_TRAILING = re.compile(r"(\.\d*?)0+$")


class MeasuredSettings(SourceSettings):
    """What formats whose records are objects with measurements have in common."""

    unit: Literal["mm", "cm", "m", "in"] | None = Field(default=None, description="Unit of lengths that name none.")


class Measurements:
    """Gathers the measurements of one record.

    A length fills the width that is not given, or else the depth; so does a thickness the depth.

    Parameters
    ----------
    unit : str or None
        The unit of lengths that name none.
    """

    def __init__(self, unit: str | None = None) -> None:
        self._unit = unit
        self._cells: dict[str, str] = {}
        self._si: dict[str, float | None] = {}
        self._told: dict[tuple[str, str | None], list[float]] = {}
        self._faults: dict[str, tuple[str, str]] = {}
        self._others: list[str] = []
        self._words: list[str] = []
        self._in_columns = True

    def add(self, kind: str, value: str, unit: str = "", part: str = "") -> None:
        """Take one measurement in the words of its record.

        What is of an unknown kind or part is kept as text. Two that contradict each other leave none.

        Parameters
        ----------
        kind, value, unit, part : str
            Such as "hoogte", "12.5", "cm", "geheel".
        """
        said = f"{part} {kind}".strip()
        within = None if part.strip() else kind_within(kind)
        if within is not None:
            known, of = within
            self.take(known, value, unit, part_of(of), said=said)
        else:
            self.take(kind_of(kind), value, unit, part_of(part), said=said)

    def take(self, kind: str | None, value: str, unit: str, part: str | None, said: str = "") -> None:
        """Take one measurement whose kind and part are known.

        Parameters
        ----------
        kind : str or None
            A key of KINDS.
        value, unit : str
            As they were written.
        part : str or None
            A key of PARTS.
        said : str
            Kind and part in the words of the record.
        """
        value = _short(value.strip())
        if not value or _is_zero(value):
            return
        named = unit_of(unit) or unit.strip() or (self._unit if kind != "weight" else None) or ""
        text = f"{value} {named}".strip()
        size = _si(value, named)
        if any(size is not None and isclose(size, other, rel_tol=SAME) for other in self._told.get((said, kind), ())):
            return  # the same in another unit
        if size is not None:
            self._told.setdefault((said, kind), []).append(size)
        # No field is for the sides of a frame; what is said of a base has columns of its own.
        in_column = kind is not None and part is not None and (not part or (part == "base" and kind != "diameter"))
        self._in_columns &= in_column
        if not in_column or not part:
            called = said if kind is None or part is None or kind_of(said) == kind else f"{part} {kind}".strip()
            self._words.append(f"{called}: {text}" if called else text)
        if kind is None or part is None:
            self._others.append(f"{said}: {text}" if said else text)
            return
        column = f"{part} {kind}".strip()
        if column not in self._cells:
            self._cells[column], self._si[column] = text, size
            return
        before = self._si[column]
        if text == self._cells[column] or (
            size is not None and before is not None and isclose(size, before, rel_tol=SAME)
        ):
            return
        self._others.append(f"{said or column}: {text}")
        self._faults[column] = (
            f"the record gives it twice: {self._cells[column]} and {text}",
            "say in the record which part each is of, or delete the wrong one",
        )

    def refuse(self, kind: str, what: str, remedy: str) -> None:
        """Note that a measurement cannot be used.

        Parameters
        ----------
        kind : str
            A column of MEASURED.
        what, remedy : str
            Why, and what mends it.
        """
        self._faults[kind] = (what, remedy)

    def cells(self) -> dict[str, str]:
        """Return column -> text, of those that have any and are not refused."""
        found = {column: text for column, text in self._cells.items() if column not in self._faults}
        for part in PARTS:
            length, width, depth, thick = (
                f"{part} {kind}".strip() for kind in ("length", "width", "depth", "thickness")
            )
            taken = {*found, *self._faults}
            if thick in found and depth not in taken:
                found[depth] = found[thick]
                taken.add(depth)
            if length in found:
                free = next((column for column in (width, depth) if column not in taken), None)
                if free is not None:
                    found[free] = found[length]
        if self._others:
            found[OTHER] = "; ".join(self._others)
        if not self._in_columns and not self._faults:
            found[IN_WORDS] = "; ".join(dict.fromkeys(self._words))
        return found

    def faults(self, columns: Iterable[str]) -> Mapping[int, tuple[str, str]]:
        """Return the faults by the place of their column, as `Row` has them."""
        if not self._faults:
            return NO_FAULTS
        return {at: self._faults[column] for at, column in enumerate(columns) if column in self._faults}


def row_of(number: int, line: int, cells: Mapping[str, str], measured: Measurements) -> Row:
    """Return a record as a row of COLUMNS.

    Parameters
    ----------
    number, line : int
        Of the row.
    cells : mapping of str to str
        What is no measurement, by column.
    measured : Measurements
        Of the record.

    Returns
    -------
    Row
        With a fault where measurements contradict each other.
    """
    found = {**cells, **measured.cells()}
    return Row(number, line, [found.get(column, "") for column in COLUMNS], faults=measured.faults(COLUMNS))


def joined(texts: Iterable[str]) -> str:
    """Return texts in one, each once, in their order, empty ones left out."""
    return "; ".join(dict.fromkeys(filter(None, (" ".join(text.split()) for text in texts))))


def _is_zero(value: str) -> bool:
    """Whether it is a nought, which databases write where nothing was measured."""
    return bool(NUMBER.fullmatch(value)) and float(value.replace(",", ".")) == 0.0


def _short(value: str) -> str:
    """Return a decimal number with a point, and without the noughts that a database adds: "24.1000000000" as "24.1"."""
    if _COMMA.fullmatch(value):
        value = value.replace(",", ".")
    return _TRAILING.sub(r"\1", value).rstrip(".") if NUMBER.fullmatch(value) else value


def _si(value: str, unit: str) -> float | None:
    factor = LENGTHS.get(unit, MASSES.get(unit))
    if not factor:
        return None
    if NUMBER.fullmatch(value):
        return float(value.replace(",", ".")) * factor
    parts = FRACTION.fullmatch(value)
    return None if parts is None else (int(parts[1] or 0) + int(parts[2]) / int(parts[3])) * factor
