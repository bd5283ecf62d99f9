"""A frame with two axes, and the layers that can be drawn in it: lines, areas, bands, uprights, words."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from pipeline.quantities import Array
from pipeline.report.plots.scales import Scale, linear_ticks, log_between, log_ticks
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
