"""Hazard curve of a floor, told or through the levels' return periods, and the annual rate of failure by it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.errors import InputError
from pipeline.models.common import N_
from pipeline.quantities import Array
from pipeline.records.fragility import HazardCurve, Measure

EXTENDED = 2.0
"""Factor of intensity by which the straight ends of a hazard curve are drawn out beyond its levels, and no further."""


class NoHazardError(InputError):
    """The levels do not make a hazard curve; the message says why."""


@dataclass(frozen=True)
class Hazard:
    """Annual rate of exceeding an intensity: straight between its points in logarithms of both.

    Attributes
    ----------
    intensity : ndarray, shape (n,)
        Rising, m/s2 or m/s.
    rate : ndarray, shape (n,)
        Falling, 1/year.
    measure : {"pga", "pgv"}
        Of the intensity.
    """

    intensity: Array
    rate: Array
    measure: Measure = "pga"

    @property
    def ends(self) -> tuple[float, float]:
        """The intensities between which anything is said."""
        return float(self.intensity[0]), float(self.intensity[-1])

    @classmethod
    def told(cls, curve: HazardCurve) -> "Hazard":
        """Return a curve as it is told, without anything beyond its ends."""
        return cls(np.array(curve.intensity), np.array(curve.rate), curve.measure)

    @classmethod
    def of(
        cls,
        intensities: Sequence[float],
        periods: Sequence[float],
        extended: float = EXTENDED,
        measure: Measure = "pga",
    ) -> "Hazard":
        """Return the curve through levels of shaking.

        Parameters
        ----------
        intensities : sequence of float
            Of the levels, m/s2 or m/s.
        periods : sequence of float
            Their return periods, years.
        extended : float
            Factor by which it is drawn out at both ends [-].
        measure : {"pga", "pgv"}
            Of the intensities.

        Returns
        -------
        Hazard
            With a point at each end besides those given.

        Raises
        ------
        NoHazardError
            For fewer than two return periods, or where a rarer level does not shake more.
        """
        order = np.argsort(periods, kind="stable")
        x, years = np.asarray(intensities, dtype=float)[order], np.asarray(periods, dtype=float)[order]
        if np.unique(years).size < 2:
            raise NoHazardError(N_("how often it happens needs return periods of two levels or more"))
        if not (np.all(np.isfinite(x)) and x[0] > 0.0 and np.all(np.diff(x) > 0.0) and np.all(np.diff(years) > 0.0)):
            raise NoHazardError(
                N_("how often it happens cannot be told: a rarer level must shake more than a common one")
            )
        logs, rates = np.log(x), -np.log(years)
        first = rates[0] - (rates[1] - rates[0]) / (logs[1] - logs[0]) * np.log(extended)
        last = rates[-1] + (rates[-1] - rates[-2]) / (logs[-1] - logs[-2]) * np.log(extended)
        return cls(
            np.concatenate([[x[0] / extended], x, [x[-1] * extended]]),
            np.exp(np.concatenate([[first], rates, [last]])),
            measure,
        )

    def beyond(self, median: float, dispersion: float) -> tuple[float, float]:
        """Return which shares of a lognormal fragility lie below the curve's intensities and above them.

        Parameters
        ----------
        median : float
            Of the intensity at failure, m/s2 or m/s.
        dispersion : float
            Standard deviation of its ln, above 0 [-].

        Returns
        -------
        below, above : float
            From 0 to 1.
        """
        from scipy.special import ndtr

        first, last = ((np.log(end) - np.log(median)) / dispersion for end in self.ends)
        return float(ndtr(first)), float(ndtr(-last))

    def most(self, median: float, dispersion: float) -> float:
        """Return the annual rate of failure if beyond its upper end the curve stayed as high as there, 1/year.

        It cannot be higher there; `failures` takes it as none.  Parameters are those of `failures`.
        """
        return self.failures(median, dispersion) + float(self.rate[-1]) * self.beyond(median, dispersion)[1]

    def failures(self, median: float, dispersion: float) -> float:
        r"""Return the annual rate of failure of a lognormal fragility: the hazard, averaged over its failure intensity.

        On a straight piece of the curve, without ends, it is

        .. math::

            \lambda = k_0 m^{-k} \exp\left(\tfrac{1}{2} k^2 \beta^2\right), \qquad \text{rate} = k_0 x^{-k}

        with m the median and beta the dispersion.  Exact for each straight piece.  Below the curve the rate is taken as
        that at its lower end and above it as none, so that the result is a lower bound; it is close where the median
        lies well inside.

        Parameters
        ----------
        median : float
            Of the intensity at failure, m/s2 or m/s.
        dispersion : float
            Standard deviation of its ln [-].

        Returns
        -------
        float
            In 1/year.

        References
        ----------
        Jalayer, F. and Cornell, C. A. (2003). A technical framework for probability-based demand and capacity factor
        design (DCFD) seismic formulations. PEER Report 2003/08.
        """
        from scipy.special import ndtr

        x, rate = np.log(self.intensity), np.log(self.rate)
        at = np.log(median)
        if dispersion == 0.0:
            inside = np.interp(at, x, rate, right=-np.inf)
            return float(np.exp(inside))
        k = -np.diff(rate) / np.diff(x)
        # The integral of k0 x^-k over the density of x between two ends: the density moved by -k beta^2.
        whole = rate[:-1] + k * (x[:-1] - at) + 0.5 * (k * dispersion) ** 2
        ends = (x - at) / dispersion
        share = ndtr(ends[1:] + k * dispersion) - ndtr(ends[:-1] + k * dispersion)
        return float(np.sum(np.exp(whole) * share) + self.rate[0] * ndtr(ends[0]))
