"""A frame with two axes, and the layers that can be drawn in it: lines, areas, bands, uprights, words."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from math import ceil, floor, isfinite, isnan, log10

import numpy as np

from pipeline.quantities import Array
from pipeline.report.errors import ReportError
from pipeline.report.plots.svg import (
    Element,
    Point,
    element,
    level,
    number,
    path,
    rect,
    sideways,
    text,
    thin,
    through,
    upright,
)


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


LETTER = 6.7
"""Mean width in pixels of a letter at the 12 pixel size of chart text, with some air."""


@dataclass(frozen=True, slots=True)
class Panel:
    """Where the data of a picture lie: x to the right, y upwards.

    Every method returns what is to be painted; the picture says in which order.
    """

    x: Scale
    y: Scale

    @property
    def middle(self) -> Point:
        """The middle of the frame."""
        return (self.x.start + self.x.end) / 2, (self.y.start + self.y.end) / 2

    def at(self, x: float, y: float) -> Point:
        """Return the place of a point; what lies outside the limits is held at the frame."""
        return self.x.at(x), self.y.at(y)

    def equalised(self) -> "Panel":
        """Return the panel with one scale for both axes, each widened about its middle."""
        scales = self.x, self.y
        each = max((s.high - s.low) / abs(s.end - s.start) for s in scales)
        middles = [(s, 0.5 * (s.low + s.high), 0.5 * each * abs(s.end - s.start)) for s in scales]
        return Panel(*(Scale(middle - half, middle + half, s.start, s.end) for s, middle, half in middles))

    # -- axes ---------------------------------------------------------------------------------------------------------

    def axes(self) -> Element:
        """Return the lines of both axes."""
        return path("ax", upright(self.x.start, self.y.end, self.y.start) + f"H{number(self.x.end)}")

    def grid(self, x_ticks: Sequence[float], y_ticks: Sequence[float], numbers: str = "xy") -> list[Element]:
        """Return the lines at the ticks and their values.

        Parameters
        ----------
        x_ticks, y_ticks : sequence of float
            Values inside the limits.
        numbers : str, optional
            The axes that carry their values; a panel above another one leaves them to that one.

        Returns
        -------
        list of Element
            The lines are one of them.
        """
        across, up = [self.x.at(v) for v in x_ticks], [self.y.at(v) for v in y_ticks]
        lines = [upright(at, self.y.start, self.y.end) for at in across]
        lines += [level(at, self.x.start, self.x.end) for at in up]
        drawn = [path("gr", "".join(lines))]
        if "x" in numbers:
            drawn += [text(tick(v), at, self.y.start + 17, "tx") for v, at in zip(x_ticks, across, strict=True)]
        if "y" in numbers:
            drawn += [text(tick(v), self.x.start - 8, at + 4, "ty") for v, at in zip(y_ticks, up, strict=True)]
        return drawn

    def paper(self) -> list[Element]:
        """Return the fine lines of log paper between the ticks of the axes that are logarithmic."""
        fine = (
            [upright(self.x.at(v), self.y.start, self.y.end) for v in log_between(self.x.low, self.x.high)]
            if self.x.log
            else []
        )
        fine += (
            [level(self.y.at(v), self.x.start, self.x.end) for v in log_between(self.y.low, self.y.high)]
            if self.y.log
            else []
        )
        return [path("fine", "".join(fine))] if fine else []

    def name_x(self, words: str, below: float = 36) -> Element:
        """Return the name of the horizontal axis, in pixels below it."""
        return text(words, round(self.middle[0]), round(self.y.start + below), "al")

    def name_y(self, words: str, x: float = 12) -> Element:
        """Return the name of the vertical axis, in pixels from the left of the picture."""
        return sideways(words, x, round(self.middle[1]))

    # -- layers -------------------------------------------------------------------------------------------------------

    def line(self, kind: str, x: Array, y: Array) -> Element:
        """Return a line of a kind through data (n,) and (n,); it leaves the frame where they do, to be clipped."""
        points = list(zip(self.x.pixels(x).tolist(), self.y.pixels(y).tolist(), strict=True))
        return path(f"ln {kind}", through(thin(points, 0.2)))

    def band(self, low: float, high: float) -> Element:
        """Return the shade of what lies between two values of x."""
        a, b = self.x.at(low), self.x.at(high)
        return rect("band", a, self.y.end, b - a, self.y.start - self.y.end)

    def upright(self, at: float, words: str, kind: str, row: int = 0) -> list[Element]:
        """Return a vertical line with its name beside it, in a row from the top, on the side that has room."""
        x, y = self.x.at(at), self.y.end + 13 + 15 * row
        side, dx = ("cl e", -5) if x + len(words) * LETTER + 6 > self.x.end else ("cl", 5)
        return [path(kind, upright(x, self.y.start, self.y.end)), text(words, x + dx, y, side)]

    def note(self, words: str, *, right: bool = False, inset: float = 5) -> Element:
        """Return words in an upper corner, in pixels from the frame at the left."""
        side, x = ("cl e", self.x.end - 4) if right else ("cl", self.x.start + inset)
        return text(words, x, self.y.end + 12, side)

    def drawn(
        self, ident: str, under: Iterable[Element], lines: Iterable[Element], over: Iterable[Element],
        numbers: str = "xy", about: int = 6,
    ) -> list[Element]:  # fmt: skip
        """Return the whole panel: frame, and layers of which the lines are clipped to it.

        Parameters
        ----------
        ident : str
            Begins the id of the frame that clips.
        under, lines, over : iterable of Element
            What is painted below the grid, inside the frame, and above everything.
        numbers : str, optional
            See `grid`.
        about : int, optional
            Roughly how many ticks a vertical axis that is linear has.

        Returns
        -------
        list of Element
            In the order in which they are painted.
        """
        frame = rect(None, self.x.start, self.y.end, self.x.end - self.x.start, self.y.start - self.y.end)
        return [
            element("clipPath", frame, id=f"{ident}k"),
            *under,
            *self.paper(),
            *self.grid(_ticks(self.x, 6), _ticks(self.y, about), numbers),
            self.axes(),
            element("g", *lines, clip_path=f"url(#{ident}k)"),
            *over,
        ]


def tick(value: float) -> str:
    """Write a tick value with the digits that it needs."""
    return f"{value:.6g}".replace("-", "−")


def legend(entries: Iterable[tuple[str, str]], left: float, top: float, right: float) -> tuple[list[Element], float]:
    """Return samples of kinds of lines with their names.

    Parameters
    ----------
    entries : iterable of (str, str)
        Kind and name of each.
    left, top, right : float
        Pixels: where the first begins, its line of writing, and what none reaches beyond.

    Returns
    -------
    list of Element
        In as many rows as they need.
    float
        Line of writing of the last row.
    """
    drawn, x, y = [], left, top
    for kind, name in entries:
        wide = 30 + len(name) * LETTER + 14
        if x > left and x + wide > right + 14:
            x, y = left, y + 17
        drawn += [path(f"ln {kind}", f"M{x:.0f} {y - 4:.0f}h24"), text(name, round(x + 30), round(y))]
        x += wide
    return drawn, y


def _ticks(scale: Scale, about: int) -> list[float]:
    return log_ticks(scale.low, scale.high) if scale.log else linear_ticks(scale.low, scale.high, about)
