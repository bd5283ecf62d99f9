"""Numbers for the reader: SI inside, centimetres, g, degrees and MPa on paper; eighths and weights for a hand."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from math import ceil, floor, inf, isfinite, isnan, log10
from string import Formatter

from pipeline.quantities import LENGTHS, MASSES, G
from pipeline.report.errors import ReportError
from pipeline.report.language import _, local

_FIXED: dict[str, tuple[str, float]] = {
    "m/s2": ("g", 1.0 / G),
    "rad": ("°", 57.29577951308232),
    "deg": ("°", 1.0),
    "Pa": ("MPa", 1e-6),
    "-": ("", 1.0),
    "bool": ("", 1.0),
    "": ("", 1.0),
}
_RATIOS = ("-", "")
_POWERS = {"m": ("", 1), "m2": ("²", 2), "m3": ("³", 3), "m/s": ("/s", 1)}
_MASS_PER = {"kg": ("lb", 0), "kg/m2": ("lb/ft²", 2), "kg/m3": ("lb/ft³", 3)}
"""Masses for who thinks in feet: the unit, and of which power of a foot."""
_POUND = MASSES["lb"] * G
"""Newtons that a pound weighs."""
_FORCES = {
    "N": ("lbf", 1.0 / _POUND),
    "N m": ("lbf ft", 1.0 / (_POUND * LENGTHS["ft"])),
    "N/m": ("lbf/in", LENGTHS["in"] / _POUND),
    "Pa": ("psi", LENGTHS["in"] ** 2 / _POUND),
}
"""Forces, moments, stiffnesses and stresses for who thinks in feet."""
_METRIC = {"kg/m2": "kg/m²", "kg/m3": "kg/m³"}
_NONE = 1e-3
"""Of the high end of a range of lengths, less than half a millimetre too: what its low end is nothing beside."""
_THIN = "\u202f"


def significant(value: float, digits: int, *, keep: bool = False) -> str:
    """Write a finite number with that many significant digits; zeros at the end go unless they are to be kept."""
    return local(_significant(value, digits, keep))


@lru_cache(maxsize=65536)
def _significant(value: float, digits: int, keep: bool) -> str:
    if value == 0.0:
        return "0"
    decimals = digits - 1 - floor(log10(abs(value)))
    rounded = round(value, decimals)
    if abs(rounded) >= 1e7 or abs(rounded) < 1e-6:
        return f"{value:.{digits - 1}e}".replace("-", "−")
    text = f"{rounded:.{max(0, decimals)}f}"
    return (text.rstrip("0").rstrip(".") if "." in text and not keep else text).replace("-", "−")


def percent(share: float, decimals: int = 0) -> str:
    """Write a share in hundredths, such as "12 %"; the line is not broken before the sign."""
    return local(f"{100.0 * share:.{decimals}f}\u00a0%")


def ratio(value: float) -> str:
    """Write a finite ratio with two significant digits, and more where two would hide on which side of 1 it lies."""
    return local(_digits(value)) or (_("just above 1") if value > 1.0 else _("just below 1"))


@lru_cache(maxsize=65536)
def _digits(value: float) -> str:
    if value == round(value):
        return _significant(value, 2 if abs(value) >= 100.0 else 3, False)
    for digits in range(2, 7):
        text = _significant(value, digits, True)
        if float(text.replace("−", "-")) != 1.0:
            return text
    return ""


@dataclass(frozen=True, slots=True)
class Units:
    """How numbers are written for one reader.

    length : "cm" (default), "mm", "m", "in" or "ft"; areas, volumes and velocities follow it, and masses, forces and
             stresses are in pounds where it is in or ft
    raises : ReportError for another unit of length
    """

    length: str = "cm"

    def __post_init__(self) -> None:
        if self.length not in LENGTHS:
            raise ReportError(f"units: length {self.length!r} is not known; use one of {', '.join(LENGTHS)}")

    @property
    def pounds(self) -> bool:
        """Whether masses are in pounds."""
        return self.length in ("in", "ft")

    def symbol(self, unit: str) -> str:
        """Return the reader's unit for an SI unit: "cm" for "m", "g" for "m/s2", "" for a ratio.

        A unit without a translation (s, Hz) is written as it is.
        """
        return _shown(self.length, unit)[0]

    def factor(self, unit: str) -> float:
        """Return what a number in the SI unit is multiplied by to be in the reader's unit."""
        return _shown(self.length, unit)[1]

    def number(self, value: float, unit: str) -> str:
        """Write the number alone, in the reader's unit: ratios with two significant digits, others with three."""
        if isnan(value):
            return _("not a number")
        if not isfinite(value):
            return "∞" if value > 0.0 else "−∞"
        shown = value * self.factor(unit)
        return ratio(shown) if unit in _RATIOS else significant(shown, 3)

    def text(self, value: float | None, unit: str) -> str:
        """Write a number with its unit in the reader's units, an endless one in words, and None as "not known"."""
        if value is None:
            return _("not known")
        if value == inf:
            return _("no limit (∞)")
        symbol = self.symbol(unit)
        number = self.number(value, unit)
        if not symbol or not isfinite(value):
            return number
        return number + ("" if symbol == "°" else _THIN) + symbol

    def pair(self, low: float, high: float, unit: str) -> str:
        """Write a range, such as "9 to 14 cm"; one number where both read the same."""
        low = _least(low, high, unit)
        first, last = self.text(low, unit), self.text(high, unit)
        if first == last:
            return last
        if isfinite(high):
            first = self.number(low, unit)
        return _("%(low)s to %(high)s") % {"low": first, "high": last}

    def bare(self, low: float, high: float, unit: str) -> str:
        """Write a range without its unit, which stands before it: "9 to 14"; one number where both read the same."""
        low = _least(low, high, unit)
        first, last = self.number(low, unit), self.number(high, unit)
        return last if first == last else _("%(low)s to %(high)s") % {"low": first, "high": last}

    def fill(
        self,
        sentence: str,
        values: Mapping[str, tuple[float | None, str]],
        where: str,
        write: Callable[[str, float | None, str], str] | None = None,
    ) -> str:
        """Fill the {placeholders} of a sentence with numbers in the reader's units.

        Parameters
        ----------
        values : Mapping[str, tuple[float | None, str]]
            Name -> (value in SI or None, SI unit).
        where : str
            What the error names, such as "object 12.3, finding rocking".
        write : Callable[[str, float | None, str], str] or None, optional
            Writes a number by its name, value and SI unit; `text` where it is left out.

        Returns
        -------
        str

        Raises
        ------
        ReportError
            For an unknown placeholder, a format specification or a brace that is not closed.
        """
        parts = []
        for literal, name in _pieces(sentence, where):
            parts.append(literal)
            if name is None:
                continue
            if name not in values:
                known = ", ".join("{" + key + "}" for key in values) or "none"
                raise ReportError(
                    f"{where}: the sentence {sentence!r} asks for {{{name}}}; known placeholders: {known}; "
                    "correct the sentence or supply the number"
                )
            parts.append(self.text(*values[name]) if write is None else write(name, *values[name]))
        return "".join(parts)


def _least(low: float, high: float, unit: str) -> float:
    """Return the low end of a range, 0 where it is a length that nobody could tell from none: "0 to 43 cm"."""
    return 0.0 if unit == "m" and abs(low) < min(5e-4, _NONE * abs(high)) else low


@lru_cache(maxsize=1024)
def _shown(length: str, unit: str) -> tuple[str, float]:
    """Return the reader's unit for an SI unit, and what a number in that is multiplied by."""
    if unit in _POWERS:
        suffix, power = _POWERS[unit]
        return length + suffix, 1.0 / LENGTHS[length] ** power
    if unit in _MASS_PER and length in ("in", "ft"):
        symbol, power = _MASS_PER[unit]
        return symbol, LENGTHS["ft"] ** power / MASSES["lb"]
    if unit in _FORCES and length in ("in", "ft"):
        return _FORCES[unit]
    return _FIXED.get(unit, (_METRIC.get(unit, unit), 1.0))


@lru_cache(maxsize=4096)
def _parse(sentence: str) -> tuple[tuple[str, str | None, str | None, str | None], ...]:
    return tuple(Formatter().parse(sentence))


def _pieces(sentence: str, where: str) -> Iterable[tuple[str, str | None]]:
    # Formatter.parse only splits; attribute access and indexing of str.format never happen on this path.
    try:
        pieces = _parse(sentence)
    except ValueError as error:
        raise ReportError(
            f"{where}: the sentence {sentence!r} has a stray brace ({error}); write {{{{ or }}}}"
        ) from error
    for literal, name, spec, conversion in pieces:
        if spec or conversion:
            raise ReportError(f"{where}: the sentence {sentence!r} formats {{{name}}}; write the name alone")
        yield literal, name


AT_LEAST = frozenset({"clearance", "clearance_m", "stroke", "platform", "width", "force", "moment"})
"""Numbers of measures of which less is too little: they are rounded up."""

_UNWEIGHED = frozenset({"weight", "heaviest"})
"""Masses that nobody weighed: a third digit would claim too much."""

_EIGHTHS = ("", "⅛", "¼", "⅜", "½", "⅝", "¾", "⅞")


Write = Callable[[str, float | None, str], str]
"""Writes a number of a measure, given its name, its value in SI and its SI unit."""


def by_hand(units: Units) -> Write:
    """Return what writes the numbers of measures for a reader.

    A force is written as the weight that it is, in kilograms (grams below one) or pounds, and a moment as such a weight
    at an arm of a metre or a foot: nobody in a gallery thinks in newtons.  Where lengths are in inches or feet they are
    in eighths of an inch, and masses in pounds; else they are told as closely as a tape is read: to a millimetre below
    10 cm, to half a centimetre below 1 m, and to a centimetre beyond.  The checks of a measure keep newtons.

    Parameters
    ----------
    units : Units
        The reader's.
    """
    pounds = units.pounds
    mass, arm, far = (MASSES["lb"], LENGTHS["ft"], "1 ft") if pounds else (1.0, 1.0, f"1{_THIN}m")
    unit_of_mass = "lb" if pounds else "kg"

    def write(name: str, value: float | None, unit: str) -> str:
        if value is None or not isfinite(value):
            return units.text(value, unit)
        up = name in AT_LEAST
        if unit == "m":
            return inches(value, up=up) if pounds else units.text(by_tape(value, up=up), unit)
        if name in _UNWEIGHED:
            return f"{significant(value / mass, 2)}{_THIN}{unit_of_mass}"
        if unit == "kg" and pounds:
            return f"{_weight(value / mass, up=up)}{_THIN}{unit_of_mass}"
        if unit == "N" and not pounds and 0.0 < value < G:
            return f"{_weight(1e3 * value / G, up=up)}{_THIN}g"
        if unit == "N":
            return f"{_weight(value / (mass * G), up=up)}{_THIN}{unit_of_mass}"
        if unit == "N m":
            weight = f"{_weight(value / (mass * G * arm), up=up)}{_THIN}{unit_of_mass}"
            if not pounds and 0.0 < value < G:
                weight = f"{_weight(1e3 * value / G, up=up)}{_THIN}g"
            return _("%(weight)s at an arm of %(arm)s") % {"weight": weight, "arm": far}
        return units.text(value, unit)

    return write


_TAPE = ((0.01, 0.0), (0.1, 1e-3), (1.0, 5e-3), (inf, 1e-2))
"""Lengths [m] below which a tape is read to so much [m]; threads and wires are not measured by one."""


def by_tape(metres: float, *, up: bool) -> float:
    """Return a length as closely as a tape is read [m].

    Parameters
    ----------
    metres : float
        In m.
    up : bool
        Whether to take the next mark above and not the nearest one.
    """
    step = next(step for most, step in _TAPE if abs(metres) < most)
    if not step:
        return metres
    # What is above a mark by less than a hundredth of a step is at it.
    return (ceil(metres / step - 0.01) if up else round(metres / step)) * step


def inches(metres: float, *, up: bool) -> str:
    """Return a length in inches and eighths, such as "5 ⅝ in".

    Parameters
    ----------
    metres : float
        In m.
    up : bool
        Whether to take the next eighth above and not the nearest one.
    """
    # What is above an eighth by less than a thousandth of an inch is that eighth.
    eighths = metres / LENGTHS["in"] * 8.0
    whole, rest = divmod(ceil(eighths - 0.008) if up else round(eighths), 8)
    return "\u00a0".join(part for part in (str(whole) if whole or not rest else "", _EIGHTHS[rest], "in") if part)


def _weight(value: float, *, up: bool) -> str:
    """Write a weight with two significant digits, the last one up if asked; from a hundred on with three if not.

    What is asked of a mount rests on a mass that hardly anybody has weighed: a third digit would claim too much.
    """
    if value <= 0.0:
        return significant(value, 2)
    if not up:
        return significant(value, 2 if value < 100.0 else 3)
    last = 10.0 ** (floor(log10(value)) - 1)
    return significant(ceil(value / last - 1e-6) * last, 2)
