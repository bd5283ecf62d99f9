"""Any chart of a run: drawn once a page as a symbol, used again for every object that is marked on it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import isnan

import numpy as np
from markupsafe import Markup

from pipeline.quantities import Array
from pipeline.records import Chart, Curve, Zone
from pipeline.report.assumed import pictured
from pipeline.report.errors import ReportError
from pipeline.report.language import _, said
from pipeline.report.plots import svg
from pipeline.report.plots.panel import Panel, Scale, limits
from pipeline.report.plots.svg import Element, Point
from pipeline.report.text import plain, short
from pipeline.report.units import Units

LETTER = 6.3
"""Mean width in pixels of a letter at the 12 pixel size of chart text; only used to keep labels apart."""


def spread(wanted: Sequence[float], gap: float, top: float, bottom: float) -> list[float]:
    """Return sorted positions moved apart until no two are closer than the gap, between top and bottom if they fit."""
    placed: list[float] = []
    for y in wanted:
        placed.append(max(y, placed[-1] + gap if placed else top))
    limit = bottom
    for i in reversed(range(len(placed))):
        placed[i] = min(placed[i], limit)
        limit = placed[i] - gap
    return placed


def clear(place: Point, half: float, mark: Point) -> bool:
    """Say whether a label at a place, with half its width in pixels, is out of the way of a mark and its own label."""
    # A mark's own label reaches some 90 pixels to either side of it and 24 above or below.
    return abs(place[0] - mark[0]) > half + 90 or abs(place[1] - mark[1]) > 34


def inside(x: float, y: float, px: Sequence[float], py: Sequence[float]) -> bool:
    """Say whether a point lies in a closed polygon (even-odd rule)."""
    within = False
    for i in range(len(px)):
        x0, y0, x1, y1 = px[i - 1], py[i - 1], px[i], py[i]
        if (y0 > y) != (y1 > y) and x < (x1 - x0) * (y - y0) / (y1 - y0) + x0:
            within = not within
    return within


def roomy(px: Sequence[float], py: Sequence[float], half: float) -> list[Point]:
    """Return places for a label in a polygon.

    Parameters
    ----------
    px, py : sequence of float, shape (n,)
        Corners of the polygon in pixels.
    half : float
        Half the label's width in pixels.

    Returns
    -------
    list of Point
        Points of a grid where the whole label lies inside, the one farthest from the sides first; none for a polygon
        that is too thin.
    """
    across = np.linspace(min(px), max(px), 26)[1:-1]
    up = np.linspace(min(py), max(py), 26)[1:-1]
    x, y = (grid.ravel() for grid in np.meshgrid(across, up, indexing="ij"))
    held = np.ones(x.size, bool)
    for dx in (-half, 0.0, half):
        for dy in (-7.0, 7.0):
            held &= _all_inside(x + dx, y + dy, np.array(px), np.array(py))
    places: list[tuple[float, float, float]] = []
    for a, b in zip(x[held].tolist(), y[held].tolist(), strict=True):
        room = min(_distance((a, b), (px[i - 1], py[i - 1]), (px[i], py[i])) for i in range(len(px)))
        if room > 8.0:
            places.append((-room, a, b))
    return [(a, b) for _, a, b in sorted(places)]


def _all_inside(x: Array, y: Array, px: Array, py: Array) -> Array:
    """Return which points (m,) lie in a closed polygon of n corners, as `inside` says of one."""
    x0, y0 = np.roll(px, 1), np.roll(py, 1)
    crosses = (y0 > y[:, None]) != (py > y[:, None])
    with np.errstate(divide="ignore", invalid="ignore"):
        where = (px - x0) * (y[:, None] - y0) / (py - y0) + x0
    within: Array = np.count_nonzero(crosses & (x[:, None] < where), axis=1) % 2 == 1
    return within


def _distance(point: Point, start: Point, end: Point) -> float:
    (x, y), (x0, y0), (x1, y1) = point, start, end
    dx, dy = x1 - x0, y1 - y0
    square = dx * dx + dy * dy
    share = min(1.0, max(0.0, ((x - x0) * dx + (y - y0) * dy) / square)) if square else 0.0
    return float(np.hypot(x - x0 - share * dx, y - y0 - share * dy))


WIDTH, HEIGHT = 520, 340
_TOP, _BOTTOM, _LEFT, _RIGHT = 14, 48, 62, 18

_LEAD = 24.0
"""Pixels between the end of a curve and its name in the margin from which a line leads there."""

_BARE = "b"
"""Follows the id of the symbol that has no names of zones."""

_TONES = {"safe": "zs", "warn": "zw", "danger": "zd"}
_DASHES = (None, "7 4", "2 3", "9 3 2 3", "12 5")
_ANGLES = {(1, 0): 90, (1, 1): 45, (0, 1): 0, (-1, 1): -45, (-1, 0): -90, (-1, -1): -135, (0, -1): 180, (1, -1): 135}
"""Degrees by which the arrow of a mark off the chart is turned, by the side of each axis where it is."""

PATTERNS = svg.write(
    svg.hatch("hw", 9, "#f4f1ea", svg.stripe(9, "#d8d2c4", 1.4), turn=45),
    svg.hatch("hd", 5, "#f3ddd6", svg.stripe(5, "#dcae9f", 1.6), turn=-45),
)
"""Hatches of the zones: warn is sparse and light, danger dense and dark, so that a grey print tells them apart."""


@dataclass(frozen=True, slots=True)
class Spot:
    """A mark to draw: position in SI, what it is, and whether it shows the object as it stands or after the measure."""

    x: float
    y: float
    label: str
    after: bool = False


class Drawing:
    """One chart in the reader's units, ready to be defined once and marked many times.

    Parameters
    ----------
    chart : Chart
        What is drawn, in SI.
    units : Units
        The reader's.
    ident : str
        Id of the symbol within its page.

    Raises
    ------
    ReportError
        For a zone of unknown tone, an unknown kind of axis, or a chart with nothing to draw.
    """

    def __init__(self, chart: Chart, units: Units, ident: str) -> None:
        self.chart, self.units, self.ident = chart, units, ident
        self._fx, self._fy = units.factor(chart.x.unit), units.factor(chart.y.unit)
        longest = 40 if chart.equal else 26
        self._named = [(c, short(self._said(c.label), longest)) for c in chart.curves if c.label and c.x]
        widest = 0 if chart.equal else max((len(name) for _curve, name in self._named), default=0)
        right = WIDTH - _RIGHT - (widest * LETTER + 4 if widest else 0)
        x, y = self._scale("x", _LEFT, right), self._scale("y", HEIGHT - _BOTTOM, _TOP)
        self.panel = Panel(x, y).equalised() if chart.equal else Panel(x, y)
        names = ((short(self._said(z.label), 40), self._outline(z)) for z in chart.zones if z.label)
        self._places = [
            (name, roomy([p[0] for p in outline], [p[1] for p in outline], len(name) * LETTER / 2))
            for name, outline in names
        ]

    @property
    def title(self) -> str:
        """What it is, in the reader's language."""
        return self._said(self.chart.title)

    @property
    def caption(self) -> str:
        """What stands under it, in the reader's language and units."""
        return self._said(self.chart.caption)

    def _said(self, text: str) -> str:
        return pictured(text, self.units)

    def _scale(self, which: str, start: float, end: float) -> Scale:
        axis, factor = getattr(self.chart, which), self._fx if which == "x" else self._fy
        where = f"chart {self.chart.key!r}, {which} axis"
        if axis.scale not in ("linear", "log"):
            raise ReportError(f'{where}: scale {axis.scale!r} is not known; use "linear" or "log"')
        shapes: tuple[Curve | Zone, ...] = (*self.chart.curves, *self.chart.zones)
        values = [v * factor for shape in shapes for v in getattr(shape, which)]
        low, high = limits(values, axis.scale == "log", where, tight=which == "x" and not self.chart.equal)
        return Scale(low, high, start, end, axis.scale == "log")

    def _at(self, x: float, y: float) -> Point:
        return self.panel.at(x * self._fx, y * self._fy)

    # -- the symbol ---------------------------------------------------------------------------------------------------

    def symbol(self) -> Markup:
        """Return the chart without marks, to be put once into a page: a <symbol>, and one without its zones' names."""
        return self._symbol

    @cached_property
    def _symbol(self) -> Markup:
        panel, frame = self.panel, f"0 0 {WIDTH} {HEIGHT}"
        inner = [
            *map(self._zone, self.chart.zones),
            *panel.grid(panel.x.ticks(), panel.y.ticks()),
            panel.axes(),
            panel.name_x(self.axis_label("x"), HEIGHT - 8 - panel.y.start),
            panel.name_y(self.axis_label("y"), 15),
            *(line for i, curve in enumerate(self.chart.curves) for line in self._curve(curve, i)),
            *(self._end_labels() if self.chart.equal else self._margin_labels()),
        ]
        labels = self._zone_labels(())
        if labels:
            # Its zones are named where no mark is in the way; else a figure names them elsewhere, on the bare one.
            bare = svg.element("symbol", *inner, id=f"{self.ident}{_BARE}", viewBox=frame)
            inner = [bare, svg.element("use", href=f"#{self.ident}{_BARE}"), *labels]
        return svg.write(svg.element("symbol", *inner, id=self.ident, viewBox=frame))

    def _outline(self, zone: Zone) -> list[Point]:
        return svg.thin([self._at(x, y) for x, y in zip(zone.x, zone.y, strict=True)])

    def _zone(self, zone: Zone) -> Element:
        if zone.tone not in _TONES:
            raise ReportError(
                f"chart {self.chart.key!r}, zone {zone.label!r}: tone {zone.tone!r} is not known; "
                f"use one of {', '.join(_TONES)}"
            )
        return svg.path(_TONES[zone.tone], svg.through(self._outline(zone)) + "Z")

    def _zone_labels(self, taken: Sequence[Point]) -> list[Element]:
        """Write each zone's name at its roomiest place that no mark takes.

        A zone too thin for its name goes unlabelled; the text alternative of every mark still names it.
        """
        drawn = []
        for label, places in self._places:
            half = len(label) * LETTER / 2
            free = (p for p in places if all(clear(p, half, mark) for mark in taken))
            place = next(free, places[0] if places else None)
            if place:
                drawn.append(svg.text(label, round(place[0]), round(place[1] + 4), "zl"))
        return drawn

    def axis_label(self, which: str) -> str:
        """Return "Base width (cm)": the axis' label with the reader's unit."""
        axis = getattr(self.chart, which)
        unit = self.units.symbol(axis.unit)
        return short(said(axis.label), 60) + (f" ({unit})" if unit else "")

    def _curve(self, curve: Curve, index: int) -> list[Element]:
        runs: list[list[Point]] = [[]]
        log_x, log_y = self.panel.x.log, self.panel.y.log
        for x, y in zip(curve.x, curve.y, strict=True):
            if not (isnan(x) or isnan(y) or (log_x and x <= 0.0) or (log_y and y <= 0.0)):
                runs[-1].append(self._at(x, y))
            elif runs[-1]:
                runs.append([])
        d = "".join(svg.through(svg.thin(run)) for run in runs if len(run) > 1)
        return [svg.path("cu", d, stroke_dasharray=_DASHES[index % len(_DASHES)])] if d else []

    def _margin_labels(self) -> list[Element]:
        end = self.panel.x.end
        wanted = sorted((y, x, label) for (x, y), label in ((self._at(c.x[-1], c.y[-1]), n) for c, n in self._named))
        placed = spread([y for y, _, _ in wanted], 14.0, self.panel.y.end + 4, self.panel.y.start - 2)
        # A curve that ends far from its name is led to it.
        leads = [
            svg.path("gr", f"M{x:.0f} {at:.0f}L{end:.0f} {y:.0f}", stroke_dasharray="1 3")
            for y, (at, x, _) in zip(placed, wanted, strict=True)
            if x < end - _LEAD
        ]
        names = zip(placed, wanted, strict=True)
        return leads + [svg.text(label, round(end + 6), round(y + 4), "cl") for y, (_, _, label) in names]

    def _end_labels(self) -> list[Element]:
        drawn = []
        for curve, label in self._named:
            x, y = self._at(curve.x[-1], curve.y[-1])
            side, dx = ("cl e", -8) if x > self.panel.middle[0] else ("cl", 8)
            drawn.append(svg.text(label, round(x + dx), round(y - 6), side))
        return drawn

    # -- a figure -----------------------------------------------------------------------------------------------------

    def figure(self, spots: Sequence[Spot], subject: str) -> Markup:
        """Return a picture that uses the symbol and marks an object on it, with a text alternative.

        Parameters
        ----------
        spots : sequence of Spot
            The marks; one whose place is not known (NaN) is not drawn.
        subject : str
            What is marked, in words, for the description; "" for a chart that marks nothing.

        Returns
        -------
        Markup
            An ``<svg>``.
        """
        shown = [s for s in spots if not (isnan(s.x) or isnan(s.y))]
        title = plain(self.title) + (f": {plain(short(subject, 60))}" if subject else "")
        told = " ".join(self.say(s, subject) for s in shown)
        if subject and not shown:
            told = _("Nothing is marked: the object’s place is not known.")
        elif not subject:
            told = self._contents
        if not shown:
            axes = {"x": plain(self.axis_label("x")), "y": plain(self.axis_label("y"))}
            told = (_("Horizontal: %(x)s. Vertical: %(y)s.") % axes + " " + told).rstrip()
        # The label of the lower of two neighbouring marks goes below.
        marks = [part for s in shown for part in self._mark(s, below=any(o is not s and o.y > s.y for o in shown))]
        chart = self._below([self._at(s.x, s.y) for s in shown])
        return svg.picture("chart", WIDTH, HEIGHT, title, told, [*chart, *marks])

    def _below(self, taken: Sequence[Point]) -> list[Element]:
        """Return the chart below the marks: where one is in the way of a zone's name, the names are moved."""
        labels = self._zone_labels(taken)
        if labels == self._zone_labels(()):
            return [svg.element("use", href=f"#{self.ident}")]
        return [svg.element("use", href=f"#{self.ident}{_BARE}"), *labels]

    @cached_property
    def _contents(self) -> str:
        lines = ", ".join(plain(self._said(c.label)) for c in self.chart.curves if c.label)
        zones = ", ".join(plain(self._said(z.label)) for z in self.chart.zones if z.label)
        told = [_("Lines: %(names)s.") % {"names": lines}] if lines else []
        return " ".join(told + ([_("Zones: %(names)s.") % {"names": zones}] if zones else []))

    def say(self, spot: Spot, subject: str = "") -> str:
        """Tell in words and numbers where a mark lies, in which zone, and whether it is off the chart.

        Parameters
        ----------
        spot : Spot
            The mark.
        subject : str, optional
            What the chart is about, which is not named again.

        Returns
        -------
        str
            One sentence.
        """
        x, y = self.units.text(spot.x, self.chart.x.unit), self.units.text(spot.y, self.chart.y.unit)
        zone = next((z.label for z in self.chart.zones if inside(spot.x, spot.y, z.x, z.y)), "")
        names = {"across": plain(said(self.chart.x.label)), "up": plain(said(self.chart.y.label))}
        at = _("%(across)s %(x)s, %(up)s %(y)s") % {"x": x, "y": y, **names}
        told = [at if spot.label == plain(subject) else f"{plain(spot.label)}: {at}"]
        told += [_('in the zone "%(zone)s"') % {"zone": plain(self._said(zone))}] if zone else []
        told += [_("beyond the edge of the chart")] if self._off(spot) != (0, 0) else []
        return ", ".join(told) + "."

    def _off(self, spot: Spot) -> tuple[int, int]:
        return self.panel.x.side(spot.x * self._fx), self.panel.y.side(spot.y * self._fy)

    def _mark(self, spot: Spot, *, below: bool) -> list[Element]:
        frame, (x, y), off = self.panel, self._at(spot.x, spot.y), self._off(spot)
        kind, label = "ma" if spot.after else "mk", short(spot.label, 44)
        if off == (0, 0):
            to_axes = svg.level(y, frame.x.start, x) + f"V{svg.number(frame.y.start)}"
            shape = [svg.path("gd", to_axes), svg.element("circle", class_=kind, cx=x, cy=y, r=5.5)]
        else:
            label += " " + _("(off the chart)")
            turned = f"translate({svg.number(x)} {svg.number(y)})rotate({_ANGLES[off]})"
            shape = [svg.path(kind, "M0 -7L7 6H-7Z", transform=turned)]
        up = min(max(y + 20 if below else y - 11, frame.y.end + 12), frame.y.start - 6)
        room = len(label) * LETTER + 14
        side, dx = ("ml e", -9) if x + room > WIDTH - 4 and x - room > frame.x.start else ("ml", 9)
        return [*shape, svg.text(label, x + dx, up, side)]
