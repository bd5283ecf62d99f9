"""Numbers that somebody sets or builds for: eighths of an inch, and forces as the weights that a hand knows."""

from collections.abc import Callable
from math import ceil, floor, isfinite, log10

from pipeline.quantities import LENGTHS, MASSES, G
from pipeline.report.language import _
from pipeline.report.units import Units, significant

AT_LEAST = frozenset({"clearance", "clearance_m", "stroke", "platform", "width", "force", "moment"})
"""Numbers of measures of which less is too little: they are rounded up."""

_EIGHTHS = ("", "⅛", "¼", "⅜", "½", "⅝", "¾", "⅞")
_THIN = "\u202f"

Write = Callable[[str, float | None, str], str]
"""Writes a number of a measure, given its name, its value in SI and its SI unit."""


def by_hand(units: Units) -> Write:
    """Return what writes the numbers of measures for a reader.

    A force is written as the weight that it is, in kilograms (grams below one) or pounds, and a moment as such a weight
    at an arm of a metre or a foot: nobody in a gallery thinks in newtons.  Where lengths are in inches or feet they are
    in eighths of an inch, and masses in pounds.  The checks of a measure keep newtons.

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
        if unit == "m" and pounds:
            return inches(value, up=up)
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
