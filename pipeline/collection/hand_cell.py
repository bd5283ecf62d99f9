"""One cell that somebody filled in by hand: a number, perhaps a fraction, with or without its unit, perhaps "about"."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cache
from unicodedata import normalize

from pipeline.collection.dimensions import parse
from pipeline.collection.dimensions.lexicon import meanings
from pipeline.errors import InputError
from pipeline.quantities import LENGTHS, MASSES, G

LONGEST = 60
"""Characters of a cell at most: what is longer is no number."""

_MARKS = "~≈±"
_VULGAR = "½⅓⅔¼¾⅕⅖⅗⅘⅙⅚⅛⅜⅝⅞"
_AROUND = re.compile(r"^[^\W\d_]+\.?(?=[\s\d])")
_BEHIND = re.compile(r"(?<=\S)\s+([^\W\d_]+)\.?$")
_SIGN = re.compile(r"^\s*[-−–]\s*")
_THOUSANDS = re.compile(r"[1-9]\d{0,2}(?:[,\s]\d{3})+|[1-9]\d{0,2}(?:\.\d{3}){2,}|\d{1,3}(?:[.,\s]\d{3})+[.,]\d+")
"""Figures that may be thousands; one dot and three figures are a decimal of an inch, 2.125."""
_SWISS = re.compile(r"\d['’′]\d{3}(?!\d)")
"""Thousands again, or feet and what can be no inches."""
_NUMBER = re.compile(
    r"(?P<whole>\d+)\s+(?P<a>\d+)\s*/\s*(?P<b>\d+)|(?P<c>\d+)\s*/\s*(?P<d>\d+)|(?P<e>\d*[.,]?\d+|\d+[.,])"
)
_FIGURES = re.compile(r"[.,]?\d[\d.,/\s]*")
"""All figures that nothing but spaces and marks of numbers parts."""
_HYPHEN = re.compile(r"(?<=\d)-(?=\d+\s*/)")
_NO_FIGURE = re.compile(r"[²³¹⁰⁴-⁹₀-₉]")
_DATE = re.compile(r"\d{4}-\d\d-\d\d(?:[ T].*)?|\d\d?:\d\d(?::\d\d)?")
_OPEN = re.compile(r"^[\"'×*]|[×*]$|\bx$", re.IGNORECASE)
"""A cell's end that something is to follow, or its start that something went before."""
_LESSER = re.compile(
    r"\d\s*(?:(?:['’′]|ft\b\.?|feet|foot)\s*(?P<in>\d+)|(?:lbs?|pounds?)\b\.?\s*(?P<oz>\d+)|m\s*(?P<cm>\d+)[\d.,]*\s*cm)"
)
_MOST = {"in": 12, "oz": 16, "cm": 100}
"""Of the lesser unit in one of the greater."""
_ZERO = re.compile(r"0+(?:[.,]0*)?(?![\d.,/]|\s*[\d/])")
_BARE = re.compile(r"\d+\s*/\s*\d+(?!\D*\d)")
"""A fraction that nothing with figures follows."""
_PARTS = frozenset({2, 3, 4, 5, 6, 8, 10, 12, 16, 32, 64})
"""What people part a unit into: 30/40 are two numbers."""
_PSI = MASSES["lb"] * G / LENGTHS["in"] ** 2
_OTHERS = {
    "deg": {"": 1.0, "°": 1.0, "deg": 1.0, "degree": 1.0, "degrees": 1.0, "grad": 1.0, "gradi": 1.0, "grados": 1.0},
    "Hz": {"": 1.0, "hz": 1.0, "hertz": 1.0, "/s": 1.0},
    "Pa": {"": 1.0, "pa": 1.0, "kpa": 1e3, "mpa": 1e6, "n/mm2": 1e6, "n/mm²": 1e6, "psi": _PSI, "ksi": 1e3 * _PSI},
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


def of_hand(text: str, unit: str, *, signed: bool = False) -> HandCell:
    """Return what a cell says that somebody filled in.

    Parameters
    ----------
    text : str
        Such as 8 1/2, 8", 30 cm, 0,3 or about 3.
    unit : str
        That of a number which names none: of LENGTHS or MASSES, "deg", "Hz", "Pa" or "-".
    signed : bool
        Whether a negative number may be meant.

    Returns
    -------
    HandCell

    Raises
    ------
    InputError
        For what is no such number, or may be two, saying why.
    """
    cell = " ".join(text.split())
    if len(cell) > LONGEST:
        raise InputError(f"{cell[:LONGEST]!r}... is longer than a number is")
    if _DATE.fullmatch(cell):
        raise InputError(f"{cell!r} is a date or a time, which a spreadsheet may have made of a fraction")
    plain, about = _without_about(cell)
    if not any(c.isdecimal() or c in _VULGAR for c in plain):
        raise InputError(f"{cell!r} is no number")
    sign = _SIGN.match(plain)
    if sign is not None:
        if not signed:
            raise InputError(f"{cell!r} is negative")
        plain = plain[sign.end() :]
    figures = _in_figures(cell, plain)
    if unit in LENGTHS or unit in MASSES:
        found = _measured(cell, plain, figures, unit)
    else:
        found = _other(cell, plain, figures, unit)
    found = replace(found, about=found.about or about)
    return found if sign is None else replace(found, value=-found.value, written=f"-{found.written}")


def _in_figures(cell: str, plain: str) -> str:
    """Return a cell with plain figures and fractions, each of which is one number and can be no other."""
    if _NO_FIGURE.search(plain) or _OPEN.search(plain):
        raise InputError(f"{cell!r} is no number")
    # A whole number is parted from the sign of a fraction behind it: 8½ is 8 1/2.
    parted = re.sub(rf"(?<=\d)(?=[{_VULGAR}])", " ", plain)
    parted = re.sub(rf"[{_VULGAR}]", lambda sign: normalize("NFKC", sign[0]), parted)
    figures = _HYPHEN.sub(" ", "".join(str(int(c)) if c.isdecimal() else c for c in parted.replace("⁄", "/")))
    if _SWISS.search(figures):
        raise InputError(f"{cell!r} may be thousands, or feet and inches")
    for run in _FIGURES.findall(figures):
        one = run.rstrip(" .,")
        if _THOUSANDS.fullmatch(one):
            raise InputError(f"{cell!r} may be thousands or decimals")
        number = _NUMBER.fullmatch(one)
        if number is None:
            raise InputError(f"{cell!r} is more than one number")
        _fraction(cell, number)
    for both in _LESSER.finditer(figures):
        for name, most in _MOST.items():
            if both[name] is not None and int(both[name]) >= most:
                raise InputError(f"{cell!r} has {both[name]} {name}, and {most} are one of the greater unit")
    return figures


def _without_about(cell: str) -> tuple[str, bool]:
    """Return a cell without the words and marks that say "about", and whether it has one."""
    plain = cell.strip(" ")
    while plain[:1] and plain[0] in _MARKS:
        plain = plain[1:].strip()
    word = _AROUND.match(plain)
    if word is not None and word[0].rstrip(".").casefold() in _about():
        plain = plain[word.end() :].strip()
    word = _BEHIND.search(plain)
    if word is not None and word[1].casefold() in _about():
        plain = plain[: word.start()]
    if plain.endswith("?"):
        plain = plain.rstrip("? ")
    return plain, plain != cell


@cache
def _about() -> frozenset[str]:
    said = {word for word, meaning in meanings().items() if meaning == ("qualifier", "approximate")}
    return frozenset({*said, "c", "abt", "ungefähr", "around", "circa", "approx"})


def _measured(cell: str, plain: str, figures: str, unit: str) -> HandCell:
    """Read a length or a mass as the texts of dimensions are read."""
    number = _NUMBER.fullmatch(figures.rstrip())
    if number is not None:
        return HandCell(float(_fraction(cell, number) * Fraction(str((LENGTHS | MASSES)[unit]))), f"{plain} {unit}")
    # A text of dimensions has none of nothing, and 2/16 cm are two there: what follows the one number here is its unit.
    alone = _ZERO.match(figures) or _BARE.match(figures)
    read = parse(figures if alone is None else f"1{figures[alone.end() :]}")
    parts = [part for part in read.parts if part.value is not None]
    lost = read.having("remainder") or read.having("left_out") or read.having("contradiction")
    masses = unit in MASSES
    if len(parts) != 1 or len(read.parts) != 1 or lost:
        raise InputError(f"{cell!r} is no number with a unit that is known")
    (part,) = parts
    if (part.dimension == "weight") != masses:
        raise InputError(f"{cell!r} is no {'mass' if masses else 'length'}")
    if part.low != part.high or part.value is None:
        raise InputError(f"{cell!r} is a range")
    times = Fraction(1) if alone is None else Fraction(alone[0].replace(" ", "").replace(",", ".").rstrip("."))
    return HandCell(float(Fraction(str(part.value)) * times), plain, "approximate" in part.qualifiers, named=True)


def _other(cell: str, plain: str, figures: str, unit: str) -> HandCell:
    found = _NUMBER.match(figures)
    if found is None:
        raise InputError(f"{cell!r} is no number")
    named = figures[found.end() :].strip().rstrip(".").casefold()
    units = _OTHERS.get(unit, {"": 1.0})
    if named not in units:
        known = ", ".join(name for name in units if name)
        others = f" (understood: {known})" if known else ""
        raise InputError(f"{cell!r} has something behind its number that is not understood{others}")
    # Rounded once, where the number is exact: 30 % is 0.3.
    value = float(_fraction(cell, found) * Fraction(str(units[named])))
    return HandCell(value, plain if named else f"{plain} {unit}".removesuffix(" -"), named=bool(named))


def _fraction(cell: str, found: re.Match[str]) -> Fraction:
    below = found["b"] or found["d"]
    if below is not None and not int(below):
        raise InputError(f"{cell!r} is divided by zero")
    if found["whole"]:
        part = Fraction(int(found["a"]), int(found["b"]))
        if part >= 1:
            raise InputError(f"{cell!r} has a fraction that is no part of one")
        return int(found["whole"]) + part
    if found["c"]:
        if int(found["c"]) >= int(found["d"]) or int(found["d"]) not in _PARTS:
            raise InputError(f"{cell!r} may be two numbers, or a fraction that is no part of one")
        return Fraction(int(found["c"]), int(found["d"]))
    return Fraction(found["e"].replace(",", ".").rstrip("."))
