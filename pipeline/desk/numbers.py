"""Numbers as people write them in a cell, in the museum's own units: "8 1/2", "0,3", "30 cm"."""

import re

from pipeline.collection.measured_cell import of_cell
from pipeline.errors import InputError
from pipeline.quantities import LENGTHS, MASSES
from pipeline.report.units import Units, significant

_FRACTIONS = {
    "½": "1/2",
    "¼": "1/4",
    "¾": "3/4",
    "⅛": "1/8",
    "⅜": "3/8",
    "⅝": "5/8",
    "⅞": "7/8",
    "⅓": "1/3",
    "⅔": "2/3",
}
_NUMBER = r"(?:(?:\d+[\s-]+)?\d+/\d+|\d+(?:[.,]\d+)?|[.,]\d+)"
_BARE = re.compile(rf"(?:(?:about|approx\.?|ca\.?|circa|~)\s*)?(?P<number>{_NUMBER})")
_WITH_UNIT = re.compile(rf"{_BARE.pattern}\s*(?P<unit>[^\W\d_]+\.?|\"|″|'|′)(?:\s*{_NUMBER}\s*(?:in|\"|″)\.?)?", re.I)
_LONGEST = 40


def cell_unit(unit: str, units: Units) -> str:
    """Return the unit in which a cell is filled in, for one of Kouros: pounds where lengths are in inches or feet.

    unit : SI, or "-"
    """
    if unit == "kg":
        return "lb" if units.length in ("in", "ft") else "kg"
    return units.symbol(unit)


def _per(unit: str, units: Units) -> float:
    """Return how much of the unit of Kouros is in one of the cell's."""
    return MASSES[cell_unit(unit, units)] if unit == "kg" else 1.0 / units.factor(unit)


def read_number(text: str, unit: str, units: Units) -> tuple[float, str]:
    """Return what stands in a cell: the number in SI, and the words with their unit.

    Parameters
    ----------
    text : str
        As somebody typed it; a length or a mass may name a unit of its own.
    unit : str
        Of the number, SI.
    units : Units
        The reader's: those of a number that names none.

    Raises
    ------
    InputError
        For what is no number, or might be two: it says how to write it.
    """
    written = " ".join(text.split())
    if len(written) > _LONGEST:
        raise InputError(f"{written[:20]}… is no number: write one, such as 8 1/2 or 0.3")
    for sign, told in _FRACTIONS.items():
        written = written.replace(sign, f" {told}").strip()
    written = re.sub(r"\s+", " ", written)
    mine = cell_unit(unit, units)
    bare = _BARE.fullmatch(written)
    if bare:
        number = _plain(bare["number"], text)
        # A length is divided and not multiplied, so that 30 cm is 0.3 m.
        return float(f"{number * _per(unit, units):.12g}"), f"{written} {mine}".strip()
    if unit in ("m", "kg") and _WITH_UNIT.fullmatch(written):
        _plain(_WITH_UNIT.fullmatch(written)["number"], text)  # type: ignore[index]
        read = of_cell(written, unit, "," if "," in written else ".")
        if read is not None:
            return read
    known = " or ".join(LENGTHS if unit == "m" else MASSES) if unit in ("m", "kg") else mine
    in_unit = f" in {known}" if known else ""
    raise InputError(f"{text.strip()[:_LONGEST]!r} is no number{in_unit}: write one, such as 8 1/2 or 0.3")


def _plain(number: str, text: str) -> float:
    if re.fullmatch(r"[1-9]\d{0,2},\d{3}", number):
        raise InputError(
            f"{text.strip()!r} may be {number.replace(',', '')} or {number.replace(',', '.')}: write it without a comma"
        )
    if "/" in number:
        *whole, fraction = re.split(r"[\s-]+", number)
        above, below = map(int, fraction.split("/"))
        if not below:
            raise InputError(f"{text.strip()!r} divides by zero: write a number, such as 8 1/2")
        return sum(map(float, whole)) + above / below
    return float(number.replace(",", "."))


def shown_number(value: float, unit: str, units: Units) -> str:
    """Return a number in SI as a cell shows it, without its unit."""
    return significant(value / _per(unit, units), 6).replace("−", "-")
