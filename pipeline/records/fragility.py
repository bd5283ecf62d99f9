"""Fragility of an object, the shaking at which it fails, and hazard of a site, how often that is exceeded."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import erf, expm1, log, sqrt
from typing import Literal

HARM = "harm"
"""What a curve is of that counts whatever harms the object."""

YEARS = 50.0
"""For which a chance is told."""

ABOVE, BELOW, FLAT = "above", "below", "flat"
"""What is known of a median that the scaling of motions did not reach, or where what fails hardly grows with it."""


@dataclass(frozen=True, slots=True)
class Fragility:
    r"""The lognormal fragility curve of one object, by the peak acceleration of its floor.

    It is of a state that joint samples reach under stripes of shaking, or, where none are drawn, of one way to fail.

    .. math::

        P(a) = \Phi\left(\frac{\ln (a / \text{median})}{\text{dispersion}}\right)

    Attributes
    ----------
    object_number : str
        The object.
    model, title : str
        The generic model, and the failure in words; "" where it is of a state.
    median : float
        At which it fails as likely as not, m/s2; where ``bound`` is ABOVE or BELOW, all that is known is that it is
        above or below this, and where it is FLAT, that no curve tells it up to this.
    low, high : float
        The median's range, of which it is outside in 1 case of 10, m/s2.
    bound : str
        "" where the median is known, else ABOVE, BELOW or FLAT.
    dispersion : float
        Standard deviation of the logarithm, all sources together [-].
    record : float
        Its part from record to record [-].
    stated : bool
        Whether that part is from tables/, because the motions are too few to tell it.
    inputs : float
        Its part from the uncertain measures of the object, and from how it is turned [-].
    modelling : float
        Its part from the generic model itself, stated in tables/ [-].
    motions : int
        How many motions were scaled, or drawn from.
    returns : bool
        Whether it stood again under some stronger scaling of the same motion.
    annual_rate, rate_low, rate_high : float or None
        Of failing, and its range, 1/year; None where the levels' return periods do not tell.
    note : str
        Why they do not, or what a reader should know.
    published : str
        Row of tables/fragility.csv that it is set beside; "" for none.
    published_median : float or None
        That row's median, m/s2.
    state : str
        HARM, or the `Harm` that it is of; "" where it is of a way to fail.
    samples : int
        Joint samples at all intensities; 0 where none were drawn.
    error, dispersion_error : float or None
        Standard errors of ln of the median and of the dispersion, by the number of samples [-].
    deviance, goodness : float or None
        From the counts at each intensity [-], and the probability of one as large by chance where the curve is right.
    degrees : int
        Degrees of freedom of the deviance.
    measure : {"pga", "pgv"}
        Peak acceleration or velocity: by which the motions differ less, and how often it happens is told.
    median_pgv, dispersion_pgv : float or None
        The median by peak velocity of the floor, m/s, and the dispersion about it [-].
    stripes : tuple of (float, int, int)
        By rising peak acceleration [m/s2], how many samples were run and how many of them reached it.
    """

    object_number: str
    model: str
    title: str
    median: float
    low: float
    high: float
    bound: str
    dispersion: float
    record: float
    stated: bool
    inputs: float
    modelling: float
    motions: int
    returns: bool
    annual_rate: float | None = None
    rate_low: float | None = None
    rate_high: float | None = None
    note: str = ""
    published: str = ""
    published_median: float | None = None
    state: str = ""
    samples: int = 0
    error: float | None = None
    dispersion_error: float | None = None
    deviance: float | None = None
    goodness: float | None = None
    degrees: int = 0
    measure: str = "pga"
    median_pgv: float | None = None
    dispersion_pgv: float | None = None
    stripes: tuple[tuple[float, int, int], ...] = ()

    @property
    def chances(self) -> tuple[float, float, float] | None:
        """The chance of it within YEARS, and the ends of its range; None where there is no rate."""
        if self.annual_rate is None or self.rate_low is None or self.rate_high is None:
            return None
        chance, low, high = (
            -expm1(-YEARS * max(0.0, rate)) for rate in (self.annual_rate, self.rate_low, self.rate_high)
        )
        return chance, low, high

    def probability(self, intensity: float) -> float:
        """Return the probability of failing.

        Parameters
        ----------
        intensity : float
            Peak acceleration of the floor, m/s2.

        Returns
        -------
        float
            From 0 to 1.
        """
        if intensity <= 0.0:
            return 0.0
        return 0.5 * (1.0 + erf(log(intensity / self.median) / (sqrt(2.0) * self.dispersion)))

    def seen(self, intensity: float) -> float | None:
        """Return the share of samples that reached it, straight in ln of the intensity between stripes.

        Parameters
        ----------
        intensity : float
            Peak acceleration of the floor, m/s2.

        Returns
        -------
        float or None
            From 0 to 1; None beyond what was tried, where it is not known.
        """
        if not self.stripes:
            return None
        shares = [(at, reached / taken) for at, taken, reached in self.stripes]
        if intensity < shares[0][0]:
            return 0.0 if shares[0][1] == 0.0 else None
        for (low, before), (high, after) in pairwise(shares):
            if intensity <= high:
                return before + (after - before) * log(intensity / low) / log(high / low)
        return shares[-1][1] if intensity == shares[-1][0] else None


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
