"""One cell that somebody filled in by hand: a number, perhaps a fraction, with or without its unit, perhaps "about"."""

from __future__ import annotations

import re
from dataclasses import dataclass
from fractions import Fraction
from functools import cache
from unicodedata import normalize

from pipeline.collection.dimensions import parse
from pipeline.collection.dimensions.lexicon import meanings
from pipeline.errors import InputError
from pipeline.quantities import LENGTHS, MASSES

LONGEST = 60
"""Characters of a cell at most: what is longer is no number."""

_MARKS = "~≈±"
_AROUND = re.compile(r"^[^\W\d_]+\.?(?=[\s\d])")
_THOUSANDS = re.compile(r"(?<![\d.,])[1-9]\d{0,2}(?:,\d{3})+(?![\d,])|\d{1,3}(?:[.,\s]\d{3}){2,}")
_NUMBER = re.compile(
    r"(?P<whole>\d+)\s+(?P<a>\d+)\s*[/⁄]\s*(?P<b>\d+)|(?P<c>\d+)\s*[/⁄]\s*(?P<d>\d+)|(?P<e>\d*[.,]?\d+|\d+[.,])"
)
_SIGNED = re.compile(r"^\s*[-−–]")
_OTHERS = {
    "deg": {"": 1.0, "°": 1.0, "deg": 1.0, "degree": 1.0, "degrees": 1.0, "grad": 1.0, "gradi": 1.0, "grados": 1.0},
    "Hz": {"": 1.0, "hz": 1.0, "hertz": 1.0, "/s": 1.0},
    "Pa": {"": 1.0, "pa": 1.0, "kpa": 1e3, "mpa": 1e6, "n/mm2": 1e6, "n/mm²": 1e6},
    "-": {"": 1.0, "%": 0.01},
}
"""Units that a cell may name for what is neither a length nor a mass, and what a number of each is in SI."""


@dataclass(frozen=True, slots=True)
class HandCell:
    """What a cell says.

    Attributes
    ----------
    value : float
        In SI.
    written : str
        The number with its unit.
    about : bool
        Whether it is said to be about so.
    named : bool
        Whether it names its unit.
    """

    value: float
    written: str
    about: bool = False
    named: bool = False


def of_hand(text: str, unit: str) -> HandCell:
    """Return what a cell says that somebody filled in.

    Parameters
    ----------
    text : str
        Such as 8 1/2, 8", 30 cm, 0,3 or about 3.
    unit : str
        That of a number which names none: of LENGTHS or MASSES, "deg", "Hz", "Pa" or "-".

    Returns
    -------
    HandCell

    Raises
    ------
    InputError
        For what is no such number, saying why.
    """
    cell = " ".join(text.split())
    if len(cell) > LONGEST:
        raise InputError(f"{cell[:LONGEST]!r}... is longer than a number is")
    plain, about = _without_about(cell)
    if not any(c.isdigit() or c in "½⅓⅔¼¾⅕⅖⅗⅘⅙⅚⅛⅜⅝⅞" for c in plain):
        raise InputError(f"{cell!r} is no number")
    if _SIGNED.match(plain):
        raise InputError(f"{cell!r} is negative")
    if _THOUSANDS.search(plain):
        raise InputError(f"{cell!r} may be thousands or decimals")
    return (
        _measured(cell, plain, unit, about) if unit in LENGTHS or unit in MASSES else _other(cell, plain, unit, about)
    )


def _without_about(cell: str) -> tuple[str, bool]:
    """Return a cell without the words and marks that say "about", and whether it has one."""
    plain = cell.strip(" ")
    while plain[:1] and plain[0] in _MARKS:
        plain = plain[1:].strip()
    word = _AROUND.match(plain)
    if word is not None and word[0].rstrip(".").casefold() in _about():
        plain = plain[word.end() :].strip()
    if plain.endswith("?"):
        plain = plain.rstrip("? ")
    return plain, plain != cell


@cache
def _about() -> frozenset[str]:
    said = {word for word, meaning in meanings().items() if meaning == ("qualifier", "approximate")}
    return frozenset({*said, "c", "abt", "ungefähr", "around", "circa", "approx"})


def _measured(cell: str, plain: str, unit: str, about: bool) -> HandCell:
    """Read a length or a mass as the texts of dimensions are read."""
    bare = re.fullmatch(r"[\d.,/⁄\s½⅓⅔¼¾⅕⅖⅗⅘⅙⅚⅛⅜⅝⅞]+", plain) is not None
    read = parse(f"{plain} {unit}" if bare else plain)
    parts = [part for part in read.parts if part.value is not None]
    lost = read.having("remainder") or read.having("left_out") or read.having("contradiction")
    kinds = LENGTHS if unit in LENGTHS else MASSES
    kind = "length" if unit in LENGTHS else "mass"
    if len(parts) != 1 or len(read.parts) != 1 or lost:
        raise InputError(f"{cell!r} is no number with a unit that is known")
    (part,) = parts
    if (part.dimension == "weight") != (kinds is MASSES):
        raise InputError(f"{cell!r} is no {kind}")
    if part.low != part.high:
        raise InputError(f"{cell!r} is a range")
    if part.value is None or not part.value > 0.0:
        raise InputError(f"{cell!r} is zero")
    around = about or "approximate" in part.qualifiers
    return HandCell(part.value, f"{plain} {unit}" if bare else plain, around, not bare)


def _other(cell: str, plain: str, unit: str, about: bool) -> HandCell:
    found = _NUMBER.match(normalize("NFKC", _parted(plain)))
    if found is None:
        raise InputError(f"{cell!r} is no number")
    named = normalize("NFKC", _parted(plain))[found.end() :].strip().rstrip(".").casefold()
    units = _OTHERS.get(unit, {"": 1.0})
    if named not in units:
        known = ", ".join(name for name in units if name)
        raise InputError(
            f"{cell!r} has something behind its number that is not understood{f' ({known} are)' if known else ''}"
        )
    try:
        number = _fraction(found)
    except ZeroDivisionError:
        raise InputError(f"{cell!r} is divided by zero") from None
    # Rounded once, where the number is exact: 30 % is 0.3.
    value = float(number * Fraction(str(units[named])))
    return HandCell(value, plain if named else f"{plain} {unit}".removesuffix(" -"), about, bool(named))


def _parted(plain: str) -> str:
    """Part a whole number from the sign of a fraction behind it: 8½ is 8 1/2."""
    return re.sub(r"(?<=\d)(?=[½⅓⅔¼¾⅕⅖⅗⅘⅙⅚⅛⅜⅝⅞])", " ", plain)


def _fraction(found: re.Match[str]) -> Fraction:
    if found["whole"]:
        return int(found["whole"]) + Fraction(int(found["a"]), int(found["b"]))
    if found["c"]:
        return Fraction(int(found["c"]), int(found["d"]))
    return Fraction(found["e"].replace(",", ".").rstrip("."))
