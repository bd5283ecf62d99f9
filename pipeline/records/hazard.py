"""Hazard of a site: how often a year the shaking of its ground exceeds an intensity."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

Measure = Literal["pga", "pgv"]
"""Of intensity: the peak horizontal acceleration [m/s2], or velocity [m/s]."""


@dataclass(frozen=True, slots=True)
class HazardCurve:
    """Points of a hazard curve.

    Attributes
    ----------
    measure : {"pga", "pgv"}
        Of its intensities.
    intensity : tuple of float
        Rising, m/s2 or m/s.
    rate : tuple of float
        At which each is exceeded, falling, 1/year.
    file : str
        Name of the file that tells it.
    """

    measure: Measure
    intensity: tuple[float, ...]
    rate: tuple[float, ...]
    file: str = ""
