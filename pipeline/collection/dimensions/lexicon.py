"""The units and words that the parser knows, from the tables dimension_units.csv and dimension_words.csv."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from typing import Annotated

from pydantic import Field

from pipeline.tables import table
from pipeline.tables.rows import Entries, Text, checked


@dataclass(frozen=True, slots=True)
class LexiconUnit:
    """A unit of the table: one of it is num / den in SI, exactly."""

    name: str
    kind: str
    num: int
    den: int
    smaller: str
    system: str


@dataclass(frozen=True, slots=True)
class _Row:
    unit: str
    kind: str
    si: Annotated[Fraction, Field(gt=0)]
    smaller: str
    system: str
    words: Entries


@dataclass(frozen=True, slots=True)
class _Word:
    kind: Text
    meaning: str
    words: Entries


@cache
def _unit_rows() -> tuple[_Row, ...]:
    return checked(_Row, table("dimension_units"), "dimension_units.csv", named="unit")


@cache
def units() -> dict[str, LexiconUnit]:
    """Return the units by name.

    Returns
    -------
    dict of str to Unit
        Of the table.

    Raises
    ------
    TableError
        Where a unit's value is no decimal number above zero.
    """
    return {
        r.unit: LexiconUnit(r.unit, r.kind, r.si.numerator, r.si.denominator, r.smaller, r.system) for r in _unit_rows()
    }


@cache
def unit_words() -> dict[str, LexiconUnit]:
    """Return the units by every word and mark that stands for one, in small letters."""
    by_name = units()
    return {word: by_name[row.unit] for row in _unit_rows() for word in row.words}


@cache
def meanings() -> dict[str, tuple[str, str]]:
    """Return kind and meaning of every word that is not a unit, in small letters."""
    rows = checked(_Word, table("dimension_words"), "dimension_words.csv", named="words")
    return {word: (row.kind, row.meaning) for row in rows for word in row.words}
