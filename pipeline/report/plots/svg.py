"""Any chart as inline SVG: drawn once a page as a symbol, used again for every object that is marked on it."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from html import escape
from math import isnan

from pipeline.records import Chart, Curve, Zone
from pipeline.report.errors import ReportError
from pipeline.report.language import _, said
from pipeline.report.plots.scales import Scale, inside, limits, roomy, thin
from pipeline.report.text import plain, short
from pipeline.report.units import Units

WIDTH, HEIGHT = 520, 340
_TOP, _BOTTOM, _LEFT, _RIGHT = 14, 48, 62, 18
_LETTER = 6.3
"""Mean width in pixels of a letter at the 12 pixel size of chart text; only used to keep labels apart."""

_LEAD = 24.0
"""Pixels between the end of a curve and its name in the margin from which a line leads there."""

_BARE = "b"
"""Follows the id of the symbol that has no names of zones."""

_TONES = {"safe": "zs", "warn": "zw", "danger": "zd"}
_DASHES = ("", "7 4", "2 3", "9 3 2 3", "12 5")

PATTERNS = (
    '<pattern id="hw" width="9" height="9" patternUnits="userSpaceOnUse" patternTransform="rotate(45)">'
    '<rect width="9" height="9" fill="#f4f1ea"/><path d="M0 0V9" stroke="#d8d2c4" stroke-width="1.4"/></pattern>'
    '<pattern id="hd" width="5" height="5" patternUnits="userSpaceOnUse" patternTransform="rotate(-45)">'
    '<rect width="5" height="5" fill="#f3ddd6"/><path d="M0 0V5" stroke="#dcae9f" stroke-width="1.6"/></pattern>'
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

    ident  : id of the symbol within its page
    raises : ReportError for a zone of unknown tone, an unknown kind of axis, or a chart with nothing to draw
    """

    def __init__(self, chart: Chart, units: Units, ident: str) -> None:
        self.chart, self.units, self.ident = chart, units, ident
        self._fx, self._fy = units.factor(chart.x.unit), units.factor(chart.y.unit)
        self._margin = [c for c in chart.curves if c.label and c.x] if not chart.equal else []
        widest = max((len(short(said(c.label), 26)) for c in self._margin), default=0)
        right = WIDTH - _RIGHT - (widest * _LETTER + 4 if widest else 0)
        self.x = self._scale("x", _LEFT, right)
        self.y = self._scale("y", HEIGHT - _BOTTOM, _TOP)
        if chart.equal:
            self._equalise()
        self._places = [(short(said(z.label), 40), self._room(z)) for z in chart.zones if z.label]

    def _scale(self, which: str, start: float, end: float) -> Scale:
        axis, factor = getattr(self.chart, which), self._fx if which == "x" else self._fy
        where = f"chart {self.chart.key!r}, {which} axis"
        if axis.scale not in ("linear", "log"):
            raise ReportError(f'{where}: scale {axis.scale!r} is not known; use "linear" or "log"')
        shapes: tuple[Curve | Zone, ...] = (*self.chart.curves, *self.chart.zones)
        values = [v * factor for shape in shapes for v in getattr(shape, which)]
        low, high = limits(values, axis.scale == "log", where, tight=which == "x" and not self.chart.equal)
        return Scale(low, high, start, end, axis.scale == "log")

    def _equalise(self) -> None:
        per_x = (self.x.high - self.x.low) / abs(self.x.end - self.x.start)
        per_y = (self.y.high - self.y.low) / abs(self.y.end - self.y.start)
        scale = max(per_x, per_y)

        def widened(s: Scale) -> Scale:
            middle, half = 0.5 * (s.low + s.high), 0.5 * scale * abs(s.end - s.start)
            return Scale(middle - half, middle + half, s.start, s.end)

        self.x, self.y = widened(self.x), widened(self.y)

    # -- the symbol ---------------------------------------------------------------------------------------------------

    def symbol(self) -> str:
        """Return the chart without marks, to be put once into a page: a <symbol>, and one without its zones' names."""
        return self._symbol

    @cached_property
    def _symbol(self) -> str:
        frame = f'viewBox="0 0 {WIDTH} {HEIGHT}"'
        inner = "".join(
            (
                *map(self._zone, self.chart.zones),
                *self._grid(),
                *(self._curve(curve, i) for i, curve in enumerate(self.chart.curves)),
                *self._curve_labels(),
            )
        )
        labels = self._zone_labels(())
        if labels:
            # Its zones are named where no mark is in the way; else a figure names them elsewhere, on the bare one.
            bare = f"{self.ident}{_BARE}"
            inner = f'<symbol id="{bare}" {frame}>{inner}</symbol><use href="#{bare}"/>{labels}'
        return f'<symbol id="{self.ident}" {frame}>{inner}</symbol>'

    def _points(self, shape: Curve | Zone) -> list[tuple[float, float]]:
        pairs = zip(shape.x, shape.y, strict=True)
        return [(self.x.at(x * self._fx), self.y.at(y * self._fy)) for x, y in pairs]

    def _zone(self, zone: Zone) -> str:
        if zone.tone not in _TONES:
            raise ReportError(
                f"chart {self.chart.key!r}, zone {zone.label!r}: tone {zone.tone!r} is not known; "
                f"use one of {', '.join(_TONES)}"
            )
        return f'<path class="{_TONES[zone.tone]}" d="{path(thin(self._points(zone)))}Z"/>'

    def _room(self, zone: Zone) -> list[tuple[float, float]]:
        points = thin(self._points(zone))
        return roomy([p[0] for p in points], [p[1] for p in points], len(short(said(zone.label), 40)) * _LETTER / 2)

    def _zone_labels(self, taken: Sequence[tuple[float, float]]) -> str:
        """Write each zone's name at its roomiest place that no mark takes.

        A zone too thin for its name goes unlabelled; the text alternative of every mark still names it.
        """
        parts = []
        for label, places in self._places:
            half = len(label) * _LETTER / 2
            free = (p for p in places if all(_clear(p, half, mark) for mark in taken))
            place = next(free, places[0] if places else None)
            if place:
                parts.append(f'<text class="zl" x="{place[0]:.0f}" y="{place[1] + 4:.0f}">{escape(label)}</text>')
        return "".join(parts)

    def _zones(self, taken: Sequence[tuple[float, float]]) -> str:
        """Return the chart below the marks: where one is in the way of a zone's name, the names are moved."""
        labels = self._zone_labels(taken)
        if labels == self._zone_labels(()):
            return f'<use href="#{self.ident}"/>'
        return f'<use href="#{self.ident}{_BARE}"/>{labels}'

    def _grid(self) -> list[str]:
        middle_x, middle_y = (self.x.start + self.x.end) / 2, (self.y.start + self.y.end) / 2
        return [
            *frame(self.x, self.y, self.x.ticks(), self.y.ticks()),
            f'<text class="al" x="{middle_x:.0f}" y="{HEIGHT - 8}">{escape(self.axis_label("x"))}</text>',
            f'<text class="al" transform="translate(15 {middle_y:.0f})rotate(-90)">'
            f"{escape(self.axis_label('y'))}</text>",
        ]

    def axis_label(self, which: str) -> str:
        """Return "Base width (cm)": the axis' label with the reader's unit."""
        axis = getattr(self.chart, which)
        unit = self.units.symbol(axis.unit)
        return short(said(axis.label), 60) + (f" ({unit})" if unit else "")

    def _curve(self, curve: Curve, index: int) -> str:
        runs: list[list[tuple[float, float]]] = [[]]
        for x, y in zip(curve.x, curve.y, strict=True):
            drawable = not (isnan(x) or isnan(y) or (self.x.log and x <= 0.0) or (self.y.log and y <= 0.0))
            if drawable:
                runs[-1].append((self.x.at(x * self._fx), self.y.at(y * self._fy)))
            elif runs[-1]:
                runs.append([])
        d = "".join(path(thin(run)) for run in runs if len(run) > 1)
        dash = _DASHES[index % len(_DASHES)]
        style = f' stroke-dasharray="{dash}"' if dash else ""
        return f'<path class="cu"{style} d="{d}"/>' if d else ""

    def _curve_labels(self) -> list[str]:
        if self.chart.equal:
            return [self._end_label(c) for c in self.chart.curves if c.label and c.x]
        ends = [(self._points(c)[-1], short(said(c.label), 26)) for c in self._margin]
        wanted = sorted((y, x, label) for (x, y), label in ends)
        placed = _spread([y for y, _, _ in wanted], 14.0, self.y.end + 4, self.y.start - 2)
        x = self.x.end + 6
        texts = [
            f'<text class="cl" x="{x:.0f}" y="{y + 4:.0f}">{escape(label)}</text>'
            for y, (_, _, label) in zip(placed, wanted, strict=True)
        ]
        # A curve that ends far from its name is led to it.
        leads = [
            f'<path class="gr" stroke-dasharray="1 3" d="M{at:.0f} {end:.0f}L{self.x.end:.0f} {y:.0f}"/>'
            for y, (end, at, _) in zip(placed, wanted, strict=True)
            if at < self.x.end - _LEAD
        ]
        return leads + texts

    def _end_label(self, curve: Curve) -> str:
        x, y = self._points(curve)[-1]
        label = short(said(curve.label), 40)
        left = x > (self.x.start + self.x.end) / 2
        side, dx = ("cl e", -8) if left else ("cl", 8)
        return f'<text class="{side}" x="{x + dx:.0f}" y="{y - 6:.0f}">{escape(label)}</text>'

    # -- a figure -----------------------------------------------------------------------------------------------------

    def figure(self, spots: Sequence[Spot], subject: str) -> str:
        """Return an <svg> that uses the symbol and marks an object on it, with a text alternative.

        subject : what is marked, in words, for the description; "" for a chart that marks nothing
        """
        shown = [s for s in spots if not (isnan(s.x) or isnan(s.y))]
        title = plain(said(self.chart.title)) + (f": {plain(short(subject, 60))}" if subject else "")
        told = " ".join(self.say(s, subject) for s in shown)
        if subject and not shown:
            told = _("Nothing is marked: the object’s place is not known.")
        elif not subject:
            told = self._contents
        if not shown:
            axes = {"x": plain(self.axis_label("x")), "y": plain(self.axis_label("y"))}
            told = (_("Horizontal: %(x)s. Vertical: %(y)s.") % axes + " " + told).rstrip()
        marks = "".join(self._spot(s, self._label_line(s, shown)) for s in shown)
        taken = [(self.x.at(s.x * self._fx), self.y.at(s.y * self._fy)) for s in shown]
        return (
            f'<svg class="chart" viewBox="0 0 {WIDTH} {HEIGHT}" role="img">'
            f"<title>{escape(title)}</title><desc>{escape(told)}</desc>"
            f"{self._zones(taken)}{marks}</svg>"
        )

    @cached_property
    def _contents(self) -> str:
        lines = ", ".join(plain(said(c.label)) for c in self.chart.curves if c.label)
        zones = ", ".join(plain(said(z.label)) for z in self.chart.zones if z.label)
        told = [_("Lines: %(names)s.") % {"names": lines}] if lines else []
        return " ".join(told + ([_("Zones: %(names)s.") % {"names": zones}] if zones else []))

    def say(self, spot: Spot, subject: str = "") -> str:
        """Tell in words and numbers where a mark lies, in which zone, and whether it is off the chart.

        subject : what the chart is about, which is not named again
        """
        x, y = self.units.text(spot.x, self.chart.x.unit), self.units.text(spot.y, self.chart.y.unit)
        zone = next((z.label for z in self.chart.zones if inside(spot.x, spot.y, z.x, z.y)), "")
        names = {"across": plain(said(self.chart.x.label)), "up": plain(said(self.chart.y.label))}
        at = _("%(across)s %(x)s, %(up)s %(y)s") % {"x": x, "y": y, **names}
        told = [at if spot.label == plain(subject) else f"{plain(spot.label)}: {at}"]
        told += [_('in the zone "%(zone)s"') % {"zone": plain(said(zone))}] if zone else []
        told += [_("beyond the edge of the chart")] if self._off(spot) != (0, 0) else []
        return ", ".join(told) + "."

    def _off(self, spot: Spot) -> tuple[int, int]:
        return self.x.side(spot.x * self._fx), self.y.side(spot.y * self._fy)

    def _label_line(self, spot: Spot, shown: Sequence[Spot]) -> int:
        """Return -1 (above) or 1 (below): the label of the lower of two neighbouring marks goes below."""
        lower = any(s is not spot and s.y > spot.y for s in shown)
        return 1 if lower else -1

    def _spot(self, spot: Spot, line: int) -> str:
        x, y = self.x.at(spot.x * self._fx), self.y.at(spot.y * self._fy)
        sx, sy = self._off(spot)
        kind = "ma" if spot.after else "mk"
        if (sx, sy) == (0, 0):
            shape = (
                f'<path class="gd" d="M{self.x.start} {y:.1f}H{x:.1f}V{self.y.start}"/>'
                f'<circle class="{kind}" cx="{x:.1f}" cy="{y:.1f}" r="5.5"/>'
            )
        else:
            turn = {(1, 0): 90, (1, 1): 45, (0, 1): 0, (-1, 1): -45, (-1, 0): -90, (-1, -1): -135, (0, -1): 180}
            angle = turn.get((sx, sy), 135)
            shape = f'<path class="{kind}" transform="translate({x:.1f} {y:.1f})rotate({angle})" d="M0 -7L7 6H-7Z"/>'
        label = short(spot.label, 44) + (" " + _("(off the chart)") if (sx, sy) != (0, 0) else "")
        up = y - 11 if line < 0 else y + 20
        up = min(max(up, self.y.end + 12), self.y.start - 6)
        room = len(label) * _LETTER + 14
        left = x + room > WIDTH - 4 and x - room > self.x.start
        anchor, dx = (" e", -9) if left else ("", 9)
        return shape + f'<text class="ml{anchor}" x="{x + dx:.1f}" y="{up:.1f}">{escape(label)}</text>'


def _clear(place: tuple[float, float], half: float, mark: tuple[float, float]) -> bool:
    # A mark's own label reaches some 90 pixels to either side of it and 24 above or below.
    return abs(place[0] - mark[0]) > half + 90 or abs(place[1] - mark[1]) > 34


def tick(value: float) -> str:
    """Write a tick value with the digits that it needs."""
    return f"{value:.6g}".replace("-", "−")


def frame(x: Scale, y: Scale, x_ticks: Sequence[float], y_ticks: Sequence[float], numbers: str = "xy") -> list[str]:
    """Return the grid of a panel, the values at its ticks and the lines of its two axes.

    numbers : the axes that carry their values; a panel above another one leaves them to that one
    """
    x0, x1, y0, y1 = x.start, x.end, y.start, y.end
    lines, words = [], []
    for value in x_ticks:
        at = x.at(value)
        lines.append(f"M{at:.1f} {y0}V{y1}")
        words += [f'<text class="tx" x="{at:.1f}" y="{y0 + 17}">{tick(value)}</text>'] if "x" in numbers else []
    for value in y_ticks:
        at = y.at(value)
        lines.append(f"M{x0} {at:.1f}H{x1:.1f}")
        words += [f'<text class="ty" x="{x0 - 8}" y="{at + 4:.1f}">{tick(value)}</text>'] if "y" in numbers else []
    return [f'<path class="gr" d="{"".join(lines)}"/>', *words, f'<path class="ax" d="M{x0} {y1}V{y0}H{x1:.1f}"/>']


def path(points: Sequence[tuple[float, float]]) -> str:
    """Return the data of a path through the points (pixels)."""
    return "M" + "L".join(f"{_few(x)} {_few(y)}" for x, y in points)


def _few(value: float) -> str:
    return f"{value:.1f}".removesuffix(".0")


def _spread(wanted: Sequence[float], gap: float, top: float, bottom: float) -> list[float]:
    """Move sorted label positions apart until no two are closer than the gap, inside the frame where they fit."""
    placed: list[float] = []
    for y in wanted:
        placed.append(max(y, placed[-1] + gap if placed else top))
    limit = bottom
    for i in reversed(range(len(placed))):
        placed[i] = min(placed[i], limit)
        limit = placed[i] - gap
    return placed
