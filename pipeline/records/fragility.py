"""Fragility of an object: the shaking at which it fails, and how sure that is."""

from __future__ import annotations

from dataclasses import dataclass
from math import erf, log, sqrt

ABOVE, BELOW = "above", "below"
"""What is known of a median that the scaling of motions did not reach."""


@dataclass(frozen=True, slots=True)
class Fragility:
    r"""The lognormal fragility curve of one object and one way to fail, by the peak acceleration of its floor.

    .. math::

        P(a) = \Phi\left(\frac{\ln (a / \text{median})}{\text{dispersion}}\right)

    Attributes
    ----------
    object_number : str
        The object.
    model, title : str
        The generic model, and the failure in words.
    median : float
        At which it fails as likely as not, m/s2; where ``bound`` is ABOVE or BELOW, all that is known is that it is
        above or below this.
    low, high : float
        The median's range, of which it is outside in 1 case of 10, m/s2.
    bound : str
        "" where the median is known, else ABOVE or BELOW.
    dispersion : float
        Standard deviation of the logarithm, all sources together [-].
    record : float
        Its part from record to record [-].
    stated : bool
        Whether that part is from tables/, because the motions are too few to tell it.
    inputs : float
        Its part from the uncertain measures of the object [-].
    modelling : float
        Its part from the generic model itself, stated in tables/ [-].
    motions : int
        How many motions were scaled.
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
