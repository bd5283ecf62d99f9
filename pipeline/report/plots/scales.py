"""From data to a frame on paper: limits, tick values, positions."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, floor, isfinite, isnan, log10

import numpy as np

from pipeline.quantities import Array
from pipeline.report.errors import ReportError


@dataclass(frozen=True, slots=True)
class Scale:
    """One axis: data limits (reader's units) mapped onto pixels, linear or logarithmic."""

    low: float
    high: float
    start: float
    end: float
    log: bool = False

    def at(self, value: float) -> float:
        """Return the pixel of a value; what lies outside the limits, or is endless, is held at the frame."""
        held = self.low if isnan(value) or value <= self.low else min(value, self.high)
        share = (
            log10(held / self.low) / log10(self.high / self.low)
            if self.log
            else (held - self.low) / (self.high - self.low)
        )
        return self.start + share * (self.end - self.start)

    def pixels(self, values: Array) -> Array:
        """Return the pixels of many values (n,); what lies outside the limits lies outside the frame, to be clipped."""
        if self.log:
            share = np.log10(np.maximum(values, 1e-9 * self.low) / self.low) / log10(self.high / self.low)
        else:
            share = (values - self.low) / (self.high - self.low)
        # Numbers of a thousand frames are of no use to a browser.
        pixels: Array = self.start + np.clip(share, -9.0, 10.0) * (self.end - self.start)
        return pixels

    def side(self, value: float) -> int:
        """Return -1 below the limits, 0 inside, 1 above; a hair of rounding counts as inside."""
        slack = 1e-9 * (self.high - self.low)
        return -1 if value < self.low - slack else 1 if value > self.high + slack else 0

    def ticks(self) -> list[float]:
        """Return three to eight round tick values inside the limits."""
        return log_ticks(self.low, self.high) if self.log else linear_ticks(self.low, self.high)


def linear_ticks(low: float, high: float, about: int = 6) -> list[float]:
    """Return multiples of 1, 2, 2.5 or 5 times a power of ten from low to high, roughly ``about`` of them."""
    step = nice_step((high - low) / about)
    first, last = ceil(low / step - 1e-9), floor(high / step + 1e-9)
    return [round(i * step, 12) + 0.0 for i in range(first, last + 1)]


def log_ticks(low: float, high: float) -> list[float]:
    """Return 1, 2 and 5 times powers of ten from low to high; powers alone over many decades."""
    decades = log10(high / low)
    if decades < 0.7:
        return linear_ticks(low, high, 4)
    heads = (1.0, 2.0, 5.0) if decades <= 2.5 else (1.0,)
    every = max(1, ceil(decades / 7))
    powers = range(floor(log10(low)), ceil(log10(high)) + 1)
    values = [head * 10.0**power for power in powers if power % every == 0 for head in heads]
    return [v for v in values if low * (1 - 1e-9) <= v <= high * (1 + 1e-9)]


def log_between(low: float, high: float) -> list[float]:
    """Return 2 to 9 times each power of ten inside the limits: the lines of log paper that carry no number."""
    powers = range(floor(log10(low)), ceil(log10(high)) + 1)
    return [v for p in powers for head in range(2, 10) if low <= (v := head * 10.0**p) <= high]


def nice_step(rough: float) -> float:
    """Return the smallest of 1, 2, 2.5, 5, 10 times a power of ten that is not below ``rough``."""
    power = 10.0 ** floor(log10(rough))
    return next(m * power for m in (1.0, 2.0, 2.5, 5.0, 10.0) if m * power >= rough * (1 - 1e-9))


def limits(values: Sequence[float], log: bool, what: str, *, tight: bool = False) -> tuple[float, float]:
    """Return the limits of an axis: round numbers for a linear one unless tight, with zero where zero is near.

    Parameters
    ----------
    values : sequence of float
        What is to be drawn; what is not finite, and on a logarithmic axis not positive, does not count.
    log : bool
        Whether the axis is logarithmic.
    what : str
        Names the axis in an error.
    tight : bool, optional
        Whether a linear axis ends where its values end.

    Returns
    -------
    float, float
        The lower and the upper one; they differ.

    Raises
    ------
    ReportError
        If no value can be drawn.
    """
    drawn = [v for v in values if isfinite(v) and (v > 0.0 or not log)]
    if not drawn:
        raise ReportError(f"{what}: no value can be drawn; store the chart with finite{' positive' * log} numbers")
    low, high = min(drawn), max(drawn)
    if log:
        return (low, high) if high > low * 1.01 else (low / 2.0, high * 2.0)
    if low >= 0.0 and low < 0.4 * high:
        low = 0.0
    if high <= low:
        pad = abs(high) * 0.1 or 1.0
        low, high = low - pad, high + pad
    step = nice_step((high - low) / 6)
    if tight:
        return low, high
    return floor(low / step + 1e-9) * step, ceil(high / step - 1e-9) * step
