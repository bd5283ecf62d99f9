"""Numbers as a spreadsheet shows them: what a number format makes of a value, character for character."""

from __future__ import annotations

import re
from datetime import date, time, timedelta
from decimal import ROUND_HALF_UP, Decimal
from functools import cache

from pipeline.collection.sources.rows import as_text

_TOKEN = re.compile(
    r'"([^"]*)"|\\(.)|_(.)|\[(?:Black|Blue|Cyan|Green|Magenta|Red|White|Yellow|Color\d+)\]|([0#.,])|(.)'
)
_PLAIN = frozenset(" -/()+:$€£'!^&~{}<>=|")
_MOST_DIGITS = 40

Pattern = tuple[tuple[bool, str], ...]
"""Pieces of a format: whether each stands for a digit (0 or #) or the decimal point, or is written as it is."""


def shown(value: float, number_format: str) -> str | None:
    """Return the text that a spreadsheet shows for a number.

    Parameters
    ----------
    value : int or float
        Of the cell; finite.
    number_format : str
        Of the cell, as the file has it: General, @, or digits (0 and #) with a point, commas of thousands and texts.

    Returns
    -------
    str or None
        None for a format of another kind (percent, fraction, exponent, condition): what it shows is not known here.

    References
    ----------
    ECMA-376-1:2016, 18.8.31 numFmts.
    """
    sections = _sections(number_format)
    if not sections or sections[0].strip().lower() in ("general", "@", "standard"):
        # Fifteen digits are what a spreadsheet keeps: 1913.1 may lie in the file as 1913.0999999999999.
        return as_text(value) if isinstance(value, int) else as_text(float(f"{value:.15g}"))
    negative = value < 0
    at = 1 if negative and len(sections) > 1 else 2 if value == 0 and len(sections) > 2 else 0
    pattern = _pattern(sections[at])
    if pattern is None:
        return None
    text = _filled(pattern, abs(Decimal(repr(value))))
    return f"-{text}" if negative and at == 0 else text


def is_moment(value: object) -> bool:
    """Say whether a value is a date, a time or a duration, as a spreadsheet makes of 3-4 or 1913/20."""
    return isinstance(value, date | time | timedelta)


@cache
def _sections(number_format: str) -> tuple[str, ...]:
    parts = re.split(r';(?=(?:[^"]*"[^"]*")*[^"]*$)', number_format or "")
    return tuple(parts) if any(part.strip() for part in parts) else ()


@cache
def _pattern(section: str) -> Pattern | None:
    out: list[tuple[bool, str]] = []
    for match in _TOKEN.finditer(section):
        quoted, escaped, width, digit, other = match.groups()
        if digit:
            out.append((True, digit))
        elif other is not None:
            if other not in _PLAIN:
                return None
            out.append((False, other))
        elif width is not None:
            out.append((False, " "))
        elif quoted is not None or escaped is not None:
            out.append((False, quoted if quoted is not None else escaped))
    marks = "".join(mark for is_mark, mark in out if is_mark)
    # A comma behind the last digit divides by a thousand, which no number of an object is meant to be.
    fits = re.fullmatch(r"(?:[0#](?:[0#,]*[0#])?(?:\.[0#]*)?)?", marks)
    return tuple(out) if fits and len(marks) <= _MOST_DIGITS else None


def _filled(pattern: Pattern, value: Decimal) -> str:
    point = next((at for at, piece in enumerate(pattern) if piece == (True, ".")), len(pattern))
    places = sum(is_mark and mark in "0#" for is_mark, mark in pattern[point:])
    whole, _, part = format(value.quantize(Decimal(1).scaleb(-places), ROUND_HALF_UP), "f").partition(".")
    return _before_point(pattern[:point], whole) + _from_point(pattern[point:], part)


def _before_point(pattern: Pattern, whole: str) -> str:
    """Fill places from the last to the first, which takes all digits that are left."""
    marks = [mark for is_mark, mark in pattern if is_mark]
    digits = list(whole.lstrip("0").rjust(marks.count("0"), "0"))
    left, given = len(marks) - marks.count(","), 0
    out: list[str] = []
    for is_mark, mark in reversed(pattern):
        if not is_mark:
            out.append(mark)
        elif mark != ",":
            left -= 1
            for _ in range(min(1, len(digits)) if left else len(digits)):
                if "," in marks and given and given % 3 == 0:
                    out.append(",")
                out.append(digits.pop())
                given += 1
    return "".join(reversed(out))


def _from_point(pattern: Pattern, part: str) -> str:
    # What is optional shows nothing where only zeros follow.
    wanted = "".join(mark for is_mark, mark in pattern if is_mark and mark in "0#")
    kept = max(len(part.rstrip("0")), wanted.rfind("0") + 1)
    digits = iter(part[:kept])
    return "".join(mark if not is_mark or mark == "." else next(digits, "") for is_mark, mark in pattern)
