"""What a run writes down of how it reasoned: phrases with places for numbers and words, written and found again.

A run stores the sentence in English, with its numbers in the unit that the phrase names.  Whoever shows it finds
numbers and words in it again by the phrase that wrote it, and may say them in another unit and language.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from string import Formatter
from typing import Protocol

from pipeline.quantities import LENGTHS

SCALES = {**LENGTHS, "%": 0.01, "cm/s": 0.01, "MPa": 1e6, "GPa": 1e9}
"""What a number in the unit is multiplied by to be in SI; units that are not here are SI."""

_PLAIN = "-"
_NUMBER = r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?|-?inf|nan"


class Ranged(Protocol):
    """A number with its range, in SI."""

    @property
    def value(self) -> float: ...  # noqa: D102
    @property
    def low(self) -> float: ...  # noqa: D102
    @property
    def high(self) -> float: ...  # noqa: D102


@dataclass(frozen=True, slots=True)
class Number:
    """A number found in a sentence.

    Attributes
    ----------
    texts : tuple of str
        As it stands there, and the two ends of its range where it has one.
    unit : str
        As it stands there; "" for a ratio.
    """

    texts: tuple[str, ...]
    unit: str

    @property
    def si(self) -> tuple[float, ...]:
        """The same in SI."""
        return tuple(float(text) * SCALES.get(self.unit, 1.0) for text in self.texts)


@dataclass(frozen=True)
class Clause:
    """A clause with places: ``{name}`` for words, ``{name:unit}`` for a number in that unit, "-" for a ratio.

    ``{name:unit~2}`` writes it with two significant digits, ``{name:unit~0f}`` with no decimals; else it has up to six
    digits.  No clause has "; " in it: that parts clauses.

    Attributes
    ----------
    text : str
        In English.
    """

    text: str

    @cached_property
    def _pieces(self) -> tuple[tuple[str, str, str, str], ...]:
        """What stands before each place, its name, its unit ("" for words), and how its number is written."""
        found = []
        for before, name, spec, _ in Formatter().parse(self.text):
            unit, _, digits = (spec or "").partition("~")
            found.append((before, name or "", unit, f".{digits}{'' if digits[-1:] == 'f' else 'g'}" if digits else "g"))
        return tuple(found)

    @cached_property
    def asked(self) -> str:
        """The phrase as a catalogue has it: its places by their names alone."""
        return "".join(before + (f"{{{name}}}" if name else "") for before, name, _, _ in self._pieces)

    @property
    def letters(self) -> int:
        """How long it is without its places."""
        return sum(len(before) for before, *_ in self._pieces)

    @cached_property
    def _pattern(self) -> re.Pattern[str]:
        parts = []
        for before, name, unit, _ in self._pieces:
            parts.append(re.escape(before))
            if unit:
                sign = "" if unit == _PLAIN else re.escape(_spaced(unit))
                parts.append(
                    rf"(?P<{name}>{_NUMBER}){sign}(?: \((?P<{name}_low>{_NUMBER}) to (?P<{name}_high>{_NUMBER})\))?"
                )
            elif name:
                parts.append(f"(?P<{name}>.+?)")
        return re.compile("".join(parts), re.DOTALL)

    def __call__(self, **values: float | Ranged | tuple[float, float, float] | str) -> str:
        """Return the clause with its places filled in.

        Parameters
        ----------
        values : float | Ranged | tuple[float, float, float] | str
            Words, or numbers in SI: one alone, (low, best, high), or what has them as low, value and high.

        Returns
        -------
        str
        """
        parts = []
        for before, name, unit, spec in self._pieces:
            parts.append(before)
            if name:
                parts.append(_written(values[name], unit, spec))
        return "".join(parts)

    def places(self, clause: str) -> Mapping[str, str | Number] | None:
        """Return what fills the places of a clause that this phrase wrote; None for any other clause."""
        found = self._pattern.fullmatch(clause)
        if found is None:
            return None
        return dict(self._filled(found))

    def _filled(self, found: re.Match[str]) -> Iterator[tuple[str, str | Number]]:
        for _, name, unit, _ in self._pieces:
            if unit:
                ends = (found[name], found[f"{name}_low"], found[f"{name}_high"])
                yield name, Number(tuple(one for one in ends if one), "" if unit == _PLAIN else unit)
            elif name:
                yield name, found[name]


def _spaced(unit: str) -> str:
    return unit if unit == "°" else f" {unit}"


def _written(value: float | Ranged | tuple[float, float, float] | str, unit: str, spec: str) -> str:
    if isinstance(value, str):
        return value
    if isinstance(value, int | float):
        ends: tuple[float, ...] = (value,)
    else:
        low, best, high = value if isinstance(value, tuple) else (value.low, value.value, value.high)
        ends = (best, low, high)
    scale = SCALES.get(unit, 1.0)
    # Not "1e+01", which two digits make of 9.9.
    first, *span = (f"{float(format(one / scale, spec)):g}" for one in ends)
    sign = "" if unit == _PLAIN else _spaced(unit)
    return f"{first}{sign} ({span[0]} to {span[1]})" if span else f"{first}{sign}"
