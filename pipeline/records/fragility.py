"""From what shaking on an object fails, and how sure that is."""

from __future__ import annotations

from dataclasses import dataclass
from math import erf, log, sqrt

ABOVE, BELOW = "above", "below"
"""What is known of a median that the scaling of motions did not reach."""


@dataclass(frozen=True, slots=True)
class Fragility:
    """The lognormal fragility curve of one object and one way to fail: peak acceleration of its floor, in m/s2.

    median    : at which it fails as likely as not; where ``bound`` is ABOVE or BELOW, all that is known is that it is
                above or below this
    low, high : the median's range, of which it is outside in 1 case of 10
    dispersion: standard deviation of the logarithm, all sources together
    record    : its part from record to record; ``stated`` where the motions are too few to tell it, from tables/
    inputs    : its part from the uncertain measures of the object
    modelling : its part from the generic model itself, stated in tables/
    motions   : how many motions were scaled
    returns   : whether it stood again under some stronger scaling of the same motion
    annual_rate, rate_low, rate_high : of failing, 1/year; None where the levels' return periods do not tell
    note      : why they do not, or what a reader should know
    published, published_median : row of tables/fragility.csv that it is set beside; "" for none
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
        """Return the probability of failing at a peak acceleration of the floor, m/s2."""
        if intensity <= 0.0:
            return 0.0
        return 0.5 * (1.0 + erf(log(intensity / self.median) / (sqrt(2.0) * self.dispersion)))
