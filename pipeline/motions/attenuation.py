"""Peaks that a shallow earthquake of a magnitude makes at a distance, by Boore, Stewart, Seyhan and Atkinson (2014)."""

from __future__ import annotations

from dataclasses import dataclass
from math import exp, hypot, log

_REFERENCE_SPEED = 760.0
_KNEE = 0.1


@dataclass(frozen=True, slots=True)
class Coefficients:
    """Those of one measure, by the names of the publication; `e` is of an unspecified mechanism.

    Attributes
    ----------
    e : tuple of float
        e0, e4, e5 and e6, of the magnitude, with the hinge `hinge`.
    hinge : float
        Magnitude.
    c : (float, float, float)
        c1, c2 and c3, of the distance.
    h : float
        Pseudo-depth in km.
    site : (float, float, float, float)
        c, Vc in m/s, f4 and f5.
    far : (float, float, float)
        R1 and R2 in km, and the spread that is added from one to the other.
    soft : float
        Spread that is taken off from 300 to 225 m/s.
    within, between : (float, float)
        Spread within and between earthquakes, natural logarithm, below magnitude 4.5 and above 5.5.
    """

    e: tuple[float, float, float, float]
    hinge: float
    c: tuple[float, float, float]
    h: float
    site: tuple[float, float, float, float]
    far: tuple[float, float, float]
    soft: float
    within: tuple[float, float]
    between: tuple[float, float]


PGA = Coefficients(
    e=(0.4473, 1.431, 0.05053, -0.1662),
    hinge=5.5,
    c=(-1.134, 0.1917, -0.008088),
    h=4.5,
    site=(-0.6, 1500.0, -0.15, -0.00701),
    far=(110.0, 270.0, 0.1),
    soft=0.07,
    within=(0.695, 0.495),
    between=(0.398, 0.348),
)
"""Of the peak acceleration in g."""

PGV = Coefficients(
    e=(5.037, 1.073, -0.1536, 0.2252),
    hinge=6.2,
    c=(-1.243, 0.1489, -0.00344),
    h=5.3,
    site=(-0.84, 1300.0, -0.1, -0.00844),
    far=(105.0, 272.0, 0.082),
    soft=0.08,
    within=(0.644, 0.552),
    between=(0.401, 0.346),
)
"""Of the peak velocity in cm/s."""


def _on_rock(of: Coefficients, magnitude: float, distance: float) -> float:
    e0, e4, e5, e6 = of.e
    above = magnitude - of.hinge
    source = e0 + (e4 * above + e5 * above**2 if above <= 0.0 else e6 * above)
    c1, c2, c3 = of.c
    r = hypot(distance, of.h)
    return source + (c1 + c2 * (magnitude - 4.5)) * log(r) + c3 * (r - 1.0)


def expected(of: Coefficients, magnitude: float, distance: float, speed: float) -> tuple[float, float]:
    """Return the median of a measure and its standard deviation.

    Parameters
    ----------
    of : Coefficients
        Of the measure.
    magnitude : float
        Moment magnitude, 3 to 8.5.
    distance : float
        To the surface projection of the rupture (Joyner-Boore) in km, 0 to 400.
    speed : float
        Mean shear-wave speed of the uppermost 30 m in m/s, 150 to 1500.

    Returns
    -------
    float
        Median of the horizontal (RotD50), in g or cm/s.
    float
        Standard deviation of its natural logarithm.

    References
    ----------
    Boore, D. M., Stewart, J. P., Seyhan, E. and Atkinson, G. M. (2014), NGA-West2 equations for predicting PGA, PGV,
    and 5% damped PSA for shallow crustal earthquakes, Earthquake Spectra 30, 1057-1085; without a region and a basin.
    """
    c, fastest, f4, f5 = of.site
    linear = c * log(min(speed, fastest) / _REFERENCE_SPEED)
    bend = f4 * (exp(f5 * (min(speed, _REFERENCE_SPEED) - 360.0)) - exp(f5 * 400.0))
    softened = bend * log((exp(_on_rock(PGA, magnitude, distance)) + _KNEE) / _KNEE)
    large = min(max(magnitude - 4.5, 0.0), 1.0)
    between, within = (pair[0] + large * (pair[1] - pair[0]) for pair in (of.between, of.within))
    near, far, more = of.far
    within += more * min(max(log(max(distance, near) / near) / log(far / near), 0.0), 1.0)
    within -= of.soft * min(max(log(300.0 / speed) / log(300.0 / 225.0), 0.0), 1.0)
    return exp(_on_rock(of, magnitude, distance) + linear + softened), hypot(between, within)
