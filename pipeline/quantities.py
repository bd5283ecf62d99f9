"""Names, units, limits and the one value of g.  SI everywhere inside; other units exist at the borders only."""

import re
from dataclasses import dataclass
from math import inf
from numbers import Real

import numpy as np
from numpy.typing import NDArray

from pipeline.errors import InputError

_DIGITS = re.compile(r"\d+")

G = 9.80665
"""Standard acceleration of gravity [m/s2]."""

Array = NDArray[np.float64]

LENGTHS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
"""Metres in one of each unit of length that a mapping may name."""

MASSES = {"kg": 1.0, "g": 0.001, "lb": 0.45359237, "oz": 0.028349523125}
"""Kilograms in one of each unit of mass that a mapping may name."""


def real_number(value: object) -> float:
    """Return a finite real number, Python's own or numpy's, as a float.

    Parameters
    ----------
    value : object
        Anything.

    Returns
    -------
    float
        NaN for whatever else it is.
    """
    array = real_array(value)
    return float(array) if array is not None and array.ndim == 0 and np.isfinite(array) else np.nan


def real_array(value: object) -> Array | None:
    """Return real numbers as an array of floats.

    Parameters
    ----------
    value : object
        Anything.

    Returns
    -------
    ndarray or None
        None for texts, truth values, complex numbers and the like.
    """
    try:
        array = np.asarray(value)
    except ValueError:  # rows of different lengths
        return None
    if array.dtype.kind == "O" and array.size:
        if not all(isinstance(v, Real) and not isinstance(v, (bool, np.bool_)) for v in array.flat):
            return None
    elif array.dtype.kind not in "iuf":
        return None
    try:
        return array.astype(np.float64)
    except OverflowError:
        return None


@dataclass(frozen=True, slots=True)
class Quantity:
    """A named number with its unit and the hard limits outside of which it means nothing.

    Attributes
    ----------
    name, unit, meaning : str
        Of it; the unit is SI, or "-".
    low, high : float
        The limits, in that unit.
    exclusive : bool
        Whether the lower limit itself is not allowed (a length is above zero, a damping may be zero).
    optional : bool
        Whether it may be left out.
    default : float or None
        What is then used; where it is None, the model derives it.
    """

    name: str
    unit: str
    meaning: str = ""
    low: float = -inf
    high: float = inf
    exclusive: bool = False
    optional: bool = False
    default: float | None = None

    def check(self, values: Array) -> None:
        """Refuse values that are not numbers or lie outside the hard limits.

        Parameters
        ----------
        values : ndarray
            Of any shape, in this quantity's unit.

        Raises
        ------
        InputError
            Naming the quantity, the first bad value, its place and what is allowed.
        """
        bad = ~np.isfinite(values) | (values < self.low) | (values > self.high)
        if self.exclusive:
            bad |= values <= self.low
        if bad.any():
            at = int(np.flatnonzero(bad.ravel())[0])
            raise InputError(f"{self.name} must be {self.allowed()}, not {values.ravel()[at]:g} (entry {at})")

    def allowed(self) -> str:
        """Say in words which values are allowed, such as "a number above 0 m"."""
        unit = "" if self.unit == "-" else f" {self.unit}"
        parts = []
        if self.low > -inf:
            parts.append(f"{'above' if self.exclusive else 'at least'} {self.low:g}")
        if self.high < inf:
            parts.append(f"at most {self.high:g}")
        return f"a finite number{' ' if parts else ''}{' and '.join(parts)}{unit}"


def figures(value: float, digits: int) -> str:
    """Write a number with so many significant digits, as people do: 1000 and not 1e+03.

    Parameters
    ----------
    value : float
        In any unit.
    digits : int
        Significant ones.

    Returns
    -------
    str
        With an exponent from 1e9 on and below 1e-4.
    """
    text = f"{value:.{digits}g}"
    return f"{float(text):.0f}" if "e+" in text and abs(value) < 1e9 else text


def counted(number: int, one: str, many: str = "") -> str:
    """Return a number with its noun: "1 run", "2,000 runs".

    Parameters
    ----------
    number : int
        How many.
    one : str
        The noun in the singular.
    many : str
        The plural, where it is not the singular with an s.

    Returns
    -------
    str
        With commas between thousands.
    """
    return f"{number:,} {one if number == 1 else many or f'{one}s'}"


SMALLEST_STEP = 0.1
"""Degrees, the smallest step between directions: 3,600 analyses of each object are enough."""


def checked(angle: object, tail: object, azimuth_step: object) -> tuple[float | None, float | None, float]:
    """Return angle, tail and azimuth step as numbers.

    Parameters
    ----------
    angle : object
        A direction in degrees, or None for RotD100.
    tail : object
        Seconds after the record, or None for until rest.
    azimuth_step : object
        Degrees between directions, SMALLEST_STEP to 90.

    Returns
    -------
    tuple
        The three, None where they may be.

    Raises
    ------
    InputError
        Naming the one that is not what it must be.
    """
    # numpy's own numbers are taken for what they are; the angle's size is what it was given as.
    after, step = real_number(tail), real_number(azimuth_step)
    if tail is not None and not after >= 0.0:
        raise InputError(f"tail must be at least 0 s, or None for until rest, not {tail!r}")
    if not SMALLEST_STEP <= step <= 90.0:
        raise InputError(
            f"azimuth_step must be above 0 and at most 90 degrees, {SMALLEST_STEP:g} at least, not {azimuth_step!r}"
        )
    return None if angle is None else finite_angle(angle), None if tail is None else after, step


def finite_angle(angle: object) -> float:
    """Return an angle.

    Parameters
    ----------
    angle : object
        In degrees.

    Returns
    -------
    float
        In degrees.

    Raises
    ------
    InputError
        For what is no number.
    """
    degrees = real_number(angle)
    if np.isnan(degrees):
        raise InputError(f"angle must be a number of degrees, or None for RotD100, not {angle!r}")
    return degrees


def some_error(error: object) -> float:
    """Return an error that is granted.

    Parameters
    ----------
    error : object
        Relative [-].

    Returns
    -------
    float
        The same.

    Raises
    ------
    InputError
        For what is no number above 0.
    """
    some = real_number(error)
    if not some > 0.0:
        raise InputError(f"error must be a number above 0, not {error!r}")
    return some


def sorting_key(number: str) -> str:
    """Return what sorts object numbers as people count: 1913.3 before 1913.20, whatever the case of letters."""
    # The length goes before the digits, so that 20 comes behind 3; nothing is lost of a number of any length.
    return _DIGITS.sub(lambda found: f"{len(found[0].lstrip('0')):04d}{found[0].lstrip('0')}", number.casefold())
