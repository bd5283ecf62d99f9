"""Names, units, limits and the one value of g.  SI everywhere inside; other units exist at the borders only."""

from dataclasses import dataclass
from math import inf

import numpy as np
from numpy.typing import NDArray

from pipeline.errors import InputError

G = 9.80665
"""Standard acceleration of gravity [m/s2]."""

Array = NDArray[np.float64]

LENGTHS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "ft": 0.3048}
"""Metres in one of each unit of length that a mapping may name."""

MASSES = {"kg": 1.0, "g": 0.001, "lb": 0.45359237, "oz": 0.028349523125}
"""Kilograms in one of each unit of mass that a mapping may name."""


@dataclass(frozen=True, slots=True)
class Quantity:
    """A named number with its unit and the hard limits outside of which it means nothing.

    ``optional`` quantities may be left out; ``default`` is then used, or, where it is None, the model derives it.
    ``exclusive`` says that the lower limit itself is not allowed (a length is above zero, a damping may be zero).
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

        values : array of any shape, in this quantity's unit
        raises : ValueError naming the quantity, the first bad value, its place and what is allowed
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


def counted(number: int, one: str, many: str = "") -> str:
    """Return a number with its noun: "1 run", "2,000 runs".

    many : the plural, where it is not the singular with an s
    """
    return f"{number:,} {one if number == 1 else many or f'{one}s'}"
