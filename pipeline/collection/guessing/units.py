"""The unit of a column: as its head names it, "Höhe in cm", "Maße (H x B x T in mm)", or as its numbers look."""

from __future__ import annotations

import re
from collections import Counter
from collections.abc import Callable, Sequence
from statistics import median

from pipeline.collection.dimensions.lexicon import units
from pipeline.collection.sources.measurement_terms import unit_of
from pipeline.tables.rows import UNSEEN

_OPEN, _CLOSE = "([（［", ")]）］"
_SIGNS = r"\u3040-\u30ff\u3400-\u9fff\uac00-\ud7af"
"""Of Japanese, Chinese and Korean: no blank parts these from Latin letters."""

USUAL_MM = 150
"""Median of whole numbers from which lengths are taken to be in millimetres: half of all objects are no metre and a
half."""

USUAL_M = 1.5
"""Median of lengths up to which they may be in metres."""

FEWEST = 5
"""Numbers in eighths or sixteenths from which a column is taken to be in inches."""

FEET = frozenset({"in", "ft"})
"""Units beside which weights are in pounds."""

_WRITTEN = re.compile(r"\d\s?([\"″”]|''|[^\W\d_]{1,12})(?!\w)")
"""A number and what may be its unit, in a cell."""
_WRITTEN_OFTEN = 0.3
"""Share of the cells that must name the unit before the others are in it too (judgement)."""
_FRACTION = re.compile(r"\d/(?:2|4|8|16|32|64)(?!\d)|[½¼¾⅛⅜⅝⅞]")
_HALF = re.compile(r"1/2(?!\d)|½")
_PLAIN = re.compile(r"\d+(?:[.,]\d+)?", re.ASCII)
_TENTHS = re.compile(r"\d*[.,][1-46-9]")
_HUNDREDTHS = re.compile(r"\d[.,]\d{2,3}")
_SIXTEENTHS = re.compile(r"\d*[.,](?:0625|125|1875|3125|375|4375|5625|625|6875|8125|875|9375)")

_NAMED = re.compile(
    rf"(?P<before>^|[\s_,;:/{re.escape(_OPEN + _CLOSE)}]+|(?<=[{_SIGNS}]))"
    r"(?P<by>(?:in|en|em|i|w|v|ve|в|у|σε)\s+|ב(?=[א-ת]+[\"״]))?"
    rf"(?P<word>[א-ת]+[\"״][א-ת]|[^\W\d_{_SIGNS}]+|[{_SIGNS}]+|[\"″”])\.?"
    rf"(?=\s*(?P<after>$|[,;:{re.escape(_OPEN + _CLOSE)}]))",
    re.IGNORECASE,
)
"""A word that may be a unit, and what stands on both sides of it."""

_PARTS = frozenset({"foot", "fuß", "fuss", "pied", "pieds", "pie", "pies", "piede", "piedi", "pés", "livre", "livres"})
"""Units that heads name something else by: the diameter of the foot, the title of the book."""

_WORDS = frozenset({"m", "g", "in"})
"""Units that are words or letters of an order too: not before a bracket or a comma, nor behind other words in one."""

_ENDS = frozenset({"mm", "cm", "sm", "m", "in", "ft", "kg", "g", "gr", "lb", "lbs", "oz"})
"""What is a unit at the end of a head, of all short Latin words."""

_SPELLED = 3
"""Letters of a word that is no label."""

LONGEST = 200
"""Characters of a head beyond which it is none, and nothing is looked for in it."""

_EMPTY = re.compile(rf"[{re.escape(_OPEN)}][\s,;:]*[{re.escape(_CLOSE)}]")
_LOOSE = re.compile(rf"[\s,;:]+(?=[{re.escape(_CLOSE)}])|(?<=[{re.escape(_OPEN)}])[\s,;:]+")


def told_unit(name: str) -> tuple[str, str | None]:
    """Return the head of a column without the unit that it names, and that unit.

    Parameters
    ----------
    name : str
        As it stands.

    Returns
    -------
    (str, str or None)
        None where it names none, or nothing but that.
    """
    name = UNSEEN.sub("", name)
    found = [one for one in _NAMED.finditer(name) if _is_unit(name, one)] if len(name) <= LONGEST else []
    for able in _PLACES:
        for one in found:
            rest = _LOOSE.sub("", _EMPTY.sub(" ", f"{_before(name, one)} {name[one.end() :]}")).strip()
            if able(one) and rest:
                return rest, unit_of(one["word"])
    return name, None


def _before(name: str, found: re.Match[str]) -> str:
    """Return what stands before a unit, its opening bracket too where that holds more.

    A W is a width, "W mm", "Base W mm", but for heads in capitals: "WYSOKOŚĆ W CM".
    """
    ahead, by = name[: found.end("before")].rstrip(" _,;:/\n\t"), (found["by"] or "").strip()
    if len(by) == 1 and by.isupper() and not (len(ahead) >= _SPELLED and ahead[-_SPELLED:].isupper()):
        return f"{ahead} {by}".strip()
    return name[: found.end("before")].rstrip(" _,;:/\n\t")


def _is_unit(name: str, found: re.Match[str]) -> bool:
    word = found["word"].casefold()
    unit = None if word in _PARTS else unit_of(word)
    # "H x L x g": the letter of a side.
    ordered = re.search(r"[x×]\s*$", name[: found.start("word")], re.IGNORECASE)
    return unit is not None and units()[unit].kind in ("length", "mass") and not (ordered and not found["by"])


def _by_word(found: re.Match[str]) -> bool:
    return bool(found["by"])


def _enclosed(found: re.Match[str]) -> bool:
    """Whether it ends what stands in brackets, "(H x B x T mm)": a word or a letter must be alone there."""
    if found["after"] not in _CLOSE or not found["after"] or "/" in found["before"]:
        return False
    return found["word"].casefold() not in _WORDS or found["before"].rstrip()[-1:] in tuple(f"{_OPEN},;")


def _at_end(found: re.Match[str]) -> bool:
    word = found["word"].casefold()
    return not found["after"] and found.start("word") > 0 and (len(word) > 3 or not word.isascii() or word in _ENDS)


def _before_brackets(found: re.Match[str]) -> bool:
    """Whether an order or the like follows: "Maße cm (H x B x T)", "(cm, H x B x T)"."""
    return bool(found["after"]) and found["after"] not in _CLOSE and found["word"].casefold() not in _WORDS


_PLACES: tuple[Callable[[re.Match[str]], bool], ...] = (_by_word, _enclosed, _at_end, _before_brackets)
"""Where a unit may stand, the surest first."""


def usual_unit(texts: Sequence[str]) -> tuple[str, str]:
    """Return the unit that lengths are rather in where nothing tells it, and why.

    Parameters
    ----------
    texts : sequence of str
        Numbers as written, fractions among them; what is none says nothing.

    Returns
    -------
    (str, str)
        Such as ("mm", "millimetres are taken, for they are large and whole").
    """
    written = Counter(filter(None, (_written(text) for text in texts)))
    # One in a thousand that names its unit is the exception among the others.
    often = written.total() >= _WRITTEN_OFTEN * len(texts)
    if often and len(written) == 1 and (unit := next(iter(written))) != "ft":
        return unit, f"{unit} is taken, in which others are written"
    numbers = [text for text in texts if _PLAIN.fullmatch(text)]
    fractions = [text for text in texts if _FRACTION.search(text)]
    # A half alone is written of centimetres too.
    if len(fractions) >= FEWEST or not all(map(_HALF.search, fractions)):
        return "in", "inches are taken, for they have fractions"
    sixteenths = sum(bool(_SIXTEENTHS.fullmatch(n)) for n in numbers)
    tenths = sum(bool(_TENTHS.fullmatch(n)) for n in numbers)
    whole = sum(n.isdecimal() for n in numbers)
    if sixteenths >= FEWEST and sixteenths > 3 * tenths:
        return "in", "inches are taken, for they have eighths and sixteenths"
    if numbers and whole > 0.98 * len(numbers) and median(float(n.replace(",", ".")) for n in numbers) >= USUAL_MM:
        return "mm", "millimetres are taken, for they are large and whole"
    if _in_metres(numbers):
        return "m", "metres are taken, for most are small and go to the centimetre"
    return "cm", "centimetres are taken"


def _written(text: str) -> str | None:
    """Return the unit of length that a cell is written in; None where it tells none."""
    found = _WRITTEN.search(text)
    unit = None if found is None else unit_of(found[1])
    return unit if unit is not None and units()[unit].kind == "length" else None


def _in_metres(numbers: Sequence[str]) -> bool:
    """Whether lengths are rather metres: in centimetres hardly anybody writes hundredths, 0.83, of what is small."""
    fine = sum(bool(_HUNDREDTHS.fullmatch(number)) for number in numbers)
    small = median(float(number.replace(",", ".")) for number in numbers) < USUAL_M if numbers else False
    return len(numbers) >= FEWEST and fine >= 0.6 * len(numbers) and small
