"""The drawings of an inspected record: histories, Fourier amplitude, response spectra, the pulse."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from html import escape
from itertools import pairwise
from math import pi

import numpy as np

from pipeline.motions.inspection import Inspection
from pipeline.motions.intensity import integrate, strong_part
from pipeline.motions.manifest import TargetTable
from pipeline.motions.spectra import fourier_amplitude
from pipeline.quantities import Array, G
from pipeline.report.pages.record_words import measured
from pipeline.report.plots.scales import Scale, linear_ticks, log_between, log_ticks, thin
from pipeline.report.plots.svg import frame, path
from pipeline.report.text import plain, short
from pipeline.report.units import Units

POINTS = 600
"""Most points of a drawn history: smallest and largest of each of half as many bins, so that peaks survive."""

ROOM_BEFORE = 1.6
"""How far a panel opens for the record as it was, in peaks of the record as it is; what drifts farther is cut off."""

KONNO_OHMACHI = 40.0
"""Bandwidth b of the window of Konno and Ohmachi (1998), the usual choice for reading corners."""

FOURIER_POINTS = 240
FOURIER_FROM = 0.01
"""Hz, where the axis of the Fourier amplitude begins."""

DECADES = 4.0
"""Decades below the largest value that the axes of spectra reach down to."""

USABLE = 1.25
"""Lowest usable frequency of a response spectrum over the high-pass corner (Abrahamson and Silva 1997, as the NGA-West2
flatfile has it: Ancheta et al. 2014)."""

ROWS = (("acceleration", "Acceleration", "m/s2", "pga"), ("velocity", "Velocity", "m/s", "pgv"),
        ("displacement", "Displacement", "m", "pgd"))  # fmt: skip
"""Of the histories: name, title, SI unit, stem of the measure that is their peak."""

_NARROW, _WIDE = (64, 324), (64, 424)
"""Pixels between which the panels lie in drawings 340 and 440 wide: three in a row, and two."""

_Curve = tuple[str, str, Array, Array]
"""A kind of line, its name, x and y."""

_LETTER = 6.7
"""Mean width in pixels of a letter at the 12 pixel size of chart text."""


@dataclass(frozen=True, slots=True)
class Drift:
    """What a panel of the histories could not hold of the record as it was.

    quantity, unit : "velocity" in "m/s" or "displacement" in "m"; axes : the components; peak : the largest, SI
    """

    quantity: str
    unit: str
    axes: tuple[str, ...]
    peak: float


def usable_period(inspection: Inspection) -> float | None:
    """Return the longest usable period of the response spectra in s, None where nothing was filtered out here."""
    corner = inspection.corners[0]
    return None if corner is None else 1.0 / (USABLE * corner)


# -- panels -----------------------------------------------------------------------------------------------------------


class _Panel:
    """A frame with curves in it, clipped to it."""

    def __init__(self, ident: str, x: Scale, y: Scale, numbers: str = "xy", about: int = 6) -> None:
        self.x, self.y, self._ident, self._drawn = x, y, ident, [""]
        self._frame = frame(x, y, _ticks(x, 6), _ticks(y, about), numbers)
        fine = "".join(f"M{x.at(v):.1f} {y.start}V{y.end}" for v in log_between(x.low, x.high)) if x.log else ""
        fine += "".join(f"M{x.start} {y.at(v):.1f}H{x.end:.1f}" for v in log_between(y.low, y.high)) if y.log else ""
        self._fine = f'<path class="fine" d="{fine}"/>' if fine else ""
        self._over: list[str] = []

    def band(self, low: float, high: float) -> None:
        """Shade what lies between two values of x."""
        a, b = self.x.at(low), self.x.at(high)
        self._drawn[0] += (
            f'<rect class="band" x="{a:.1f}" y="{self.y.end}" width="{b - a:.1f}" height="{self.height}"/>'
        )

    @property
    def height(self) -> float:
        return self.y.start - self.y.end

    def curve(self, x: Array, y: Array, kind: str) -> None:
        """Draw a line of a kind, which is the class of its style."""
        points = list(zip(self.x.pixels(x).tolist(), self.y.pixels(y).tolist(), strict=True))
        self._drawn.append(f'<path class="ln {kind}" d="{path(thin(points, 0.2))}"/>')

    def upright(self, at: float, label: str, kind: str, line: int = 0) -> None:
        """Draw a vertical line with its label beside it, on the side that has room."""
        x, y = self.x.at(at), self.y.end + 13 + 15 * line
        left = x + len(label) * _LETTER + 6 > self.x.end
        self._over.append(f'<path class="{kind}" d="M{x:.1f} {self.y.start}V{self.y.end}"/>')
        side, dx = ("cl e", -5) if left else ("cl", 5)
        self._over.append(f'<text class="{side}" x="{x + dx:.1f}" y="{y}">{escape(label)}</text>')

    def note(self, text: str, *, right: bool = False) -> None:
        """Write a word into the upper corner."""
        side, x = ("cl e", self.x.end - 4) if right else ("cl", self.x.start + 5)
        self._over.append(f'<text class="{side}" x="{x:.1f}" y="{self.y.end + 12}">{escape(text)}</text>')

    def label(self, text: str) -> None:
        """Name the axis of y."""
        middle = (self.y.start + self.y.end) / 2
        self._over.append(f'<text class="al" transform="translate(12 {middle:.0f})rotate(-90)">{escape(text)}</text>')

    def svg(self) -> str:
        x, y, clip = self.x, self.y, f"{self._ident}k"
        return (
            f'<clipPath id="{clip}"><rect x="{x.start}" y="{y.end}" width="{x.end - x.start:.1f}" '
            f'height="{self.height}"/></clipPath>{self._drawn[0]}{self._fine}{"".join(self._frame)}'
            f'<g clip-path="url(#{clip})">{"".join(self._drawn[1:])}</g>{"".join(self._over)}'
        )


def _ticks(scale: Scale, about: int) -> list[float]:
    return log_ticks(scale.low, scale.high) if scale.log else linear_ticks(scale.low, scale.high, about)


def _svg(ident: str, width: float, height: float, title: str, said: str, parts: Iterable[str]) -> str:
    return (
        f'<svg class="chart" viewBox="0 0 {width:g} {height:g}" role="img" aria-labelledby="{ident}t {ident}d">'
        f'<title id="{ident}t">{escape(plain(title))}</title><desc id="{ident}d">{escape(plain(said))}</desc>'
        f"{''.join(parts)}</svg>"
    )


def _under(panel: _Panel, label: str) -> str:
    middle = (panel.x.start + panel.x.end) / 2
    return f'<text class="al" x="{middle:.0f}" y="{panel.y.start + 36:.0f}">{escape(label)}</text>'


def _legend(entries: Sequence[tuple[str, str]], left: float, top: float, right: float) -> tuple[str, float]:
    """Return the samples of kinds of lines with their names, in as many rows as they need, and the last row's y."""
    parts, x, y = [], left, top
    for kind, name in entries:
        wide = 30 + len(name) * _LETTER + 14
        if x > left and x + wide > right + 14:
            x, y = left, y + 17
        parts.append(f'<path class="ln {kind}" d="M{x:.0f} {y - 4:.0f}h24"/>')
        parts.append(f'<text x="{x + 30:.0f}" y="{y:.0f}">{escape(name)}</text>')
        x += wide
    return "".join(parts), y


def _even(peak: float) -> tuple[float, float]:
    """Limits about zero that hold a peak with a little air."""
    return (-1.12 * peak, 1.12 * peak) if peak > 0.0 else (-1.0, 1.0)


def envelope(values: Array, dt: float, points: int = POINTS) -> tuple[Array, Array]:
    """Return times [s] and values of a history with few enough points to draw: of each bin its smallest and largest."""
    n = values.size
    if n <= points:
        return np.asarray(np.arange(n) * dt, dtype=np.float64), values
    edges = np.linspace(0, n, points // 2).astype(int).tolist()
    kept = {0, n - 1}
    for a, b in pairwise(edges):
        kept |= {a + int(np.argmin(values[a:b])), a + int(np.argmax(values[a:b]))}
    at = np.array(sorted(kept))
    return np.asarray(at * dt, dtype=np.float64), values[at]


# -- figure 1: histories ----------------------------------------------------------------------------------------------


def histories(one: Inspection, names: Mapping[str, str], units: Units, ident: str) -> tuple[list[str], list[Drift]]:
    """Return one SVG a component (acceleration, velocity, displacement before and after), and what they cut off.

    names : of the axes "x", "y", "z", for the headings
    The three SVGs share their scales.  Before is drawn only where something was done here.
    """
    after = dict(zip((name for name, *_ in ROWS), (one.motion.acceleration, *integrate(one.motion)), strict=True))
    raw = dict(zip(after, (one.before.acceleration, *integrate(one.before)), strict=True)) if one.filtered else {}
    drifts, scales, row_height, top = [], {}, 108, 8
    for row, (name, _, unit, stem) in enumerate(ROWS):
        peak = max(one.measures[f"{stem}_{axis}"] for axis in "xyz")
        earlier = {axis: one.measures_before[f"{stem}_{axis}"] for axis in "xyz"} if one.filtered else {}
        most = max(earlier.values(), default=0.0)
        if peak > 0.0 and most > ROOM_BEFORE * peak:
            axes = tuple(axis for axis, value in earlier.items() if value > 1.12 * ROOM_BEFORE * peak)
            drifts += [Drift(name, unit, axes, most)] if axes else []
        foot = top + row * (row_height + 12) + row_height
        reach = _even(max(peak, min(most, ROOM_BEFORE * peak)) * units.factor(unit))
        scales[name] = Scale(*reach, foot, foot - row_height)
    seconds = Scale(0.0, max(one.motion.duration, one.motion.dt), *_NARROW)
    svgs = []
    for component, axis in enumerate("xyz"):
        parts, said = [], []
        for name, title, unit, stem in ROWS:
            last = name == ROWS[-1][0]
            panel = _Panel(f"{ident}{axis}{name[0]}", seconds, scales[name], "xy" if last else "y", about=4)
            panel.band(*strong_part(one.motion))
            if raw:
                t, v = envelope(raw[name][component], one.before.dt)
                panel.curve(t, v * units.factor(unit), "was")
            t, v = envelope(after[name][component], one.motion.dt)
            panel.curve(t, v * units.factor(unit), f"c{axis}")
            peak_text = f"{measured(one.measures[f'{stem}_{axis}'], unit, units)} {units.symbol(unit)}"
            panel.note(peak_text, right=True)
            panel.label(f"{title} ({units.symbol(unit)})")
            said.append(f"{name} with a peak of {peak_text}")
            parts.append(panel.svg())
            if last:
                parts.append(_under(panel, "Time (s)"))
        compared = " Before the processing in grey." if raw else ""
        told = f"Against time, 0 to {one.motion.duration:.4g} s: {', '.join(said)}.{compared}"
        heading = f"{short(one.motion.name, 60)}, {names[axis]}: acceleration, velocity and displacement"
        height = scales["displacement"].start + 42
        svgs.append(_svg(f"{ident}{axis}", 340, height, heading, told, parts))
    return svgs, drifts


# -- figure 2: Fourier amplitude --------------------------------------------------------------------------------------


def konno_ohmachi(
    frequency: Array, amplitude: Array, first: float, points: int = FOURIER_POINTS
) -> tuple[Array, Array]:
    """Smooth Fourier amplitudes with the main lobe of the window of Konno and Ohmachi (1998), b = 40.

    frequency : (m,) Hz, the lines of a transform, from 0; amplitude : (3, m)
    first     : Hz, where the smoothed spectrum begins, or at the first line above 0
    returns   : centres (k,), which are lines, at most ``points``; smoothed amplitudes (3, k)
    source    : Konno and Ohmachi (1998), BSSA 88, 228-241: weight (sin x / x)^4, x = b log10(f / fc)
    """
    begin = max(1, int(np.searchsorted(frequency, first)))
    wanted = np.geomspace(frequency[begin], frequency[-1], points) / frequency[1]
    at = np.unique(np.clip(np.rint(wanted).astype(int), begin, frequency.size - 1))
    reach = 10.0 ** (pi / KONNO_OHMACHI)
    out = np.empty((amplitude.shape[0], at.size))
    for k, centre in enumerate(frequency[at].tolist()):
        near = slice(
            max(1, int(np.searchsorted(frequency, centre / reach))), int(np.searchsorted(frequency, centre * reach))
        )
        weight = np.sinc(KONNO_OHMACHI / pi * np.log10(frequency[near] / centre)) ** 4
        out[:, k] = amplitude[:, near] @ weight / weight.sum()
    return np.asarray(frequency[at], dtype=np.float64), out


def amplitudes(one: Inspection) -> list[tuple[Array, Array]]:
    """Return the smoothed Fourier amplitudes of a record, each as `konno_ohmachi` does: before (where something was
    done here), and after."""
    shown = [one.before, one.motion] if one.filtered else [one.motion]
    return [konno_ohmachi(*fourier_amplitude(motion), FOURIER_FROM) for motion in shown]


def fourier(
    one: Inspection, shown: Sequence[tuple[Array, Array]], names: Mapping[str, str], units: Units, ident: str
) -> list[str]:
    """Return one SVG a component: Fourier amplitude before and after against frequency, with the corners.

    shown : of `amplitudes`
    """
    factor = units.factor("m/s")
    after = shown[-1]
    top = max(float(values.max()) for _, values in shown) * factor or 1.0
    x = Scale(FOURIER_FROM, max(float(frequency[-1]) for frequency, _ in shown), *_NARROW, log=True)
    # The room above the curves is for the names of the corners.
    y = Scale(top / 10.0**DECADES, 8.0 * top, 228, 8, log=True)
    svgs = []
    for component, axis in enumerate("xyz"):
        panel = _Panel(f"{ident}{axis}", x, y)
        for (frequency, values), kind in zip(shown, ("was", f"c{axis}")[-len(shown) :], strict=True):
            panel.curve(frequency, values[component] * factor, kind)
        told = []
        for line, (corner, what) in enumerate(zip(one.corners, ("high-pass", "low-pass"), strict=True)):
            if corner is not None:
                panel.upright(corner, f"{what} {corner:.3g} Hz", "corner", line)
                told.append(f"{what} corner at {corner:.3g} Hz")
        panel.label(f"Fourier amplitude ({units.symbol('m/s')})")
        largest = int(np.argmax(after[1][component]))
        said = (
            f"Against frequency from {x.low:g} to {x.high:g} Hz, both logarithmic; largest after the processing "
            f"{units.text(float(after[1][component][largest]), 'm/s')} at {after[0][largest]:.3g} Hz; "
            f"{' and '.join(told) or 'no filter was applied here'}."
        )
        heading = f"{short(one.motion.name, 60)}, {names[axis]}: Fourier amplitude"
        parts = [panel.svg(), _under(panel, "Frequency (Hz)")]
        svgs.append(_svg(f"{ident}{axis}", 340, 270, heading, said, parts))
    return svgs


# -- figure 3: response spectra ---------------------------------------------------------------------------------------

AT = 0.05
"""Damping of the spectra that are compared with each other."""


def row_at(damping: Array, wanted: float) -> int:
    """Return the row of a spectrum whose damping is nearest to the one wanted."""
    return int(np.argmin(np.abs(damping - wanted)))


def target_name(target: TargetTable) -> str:
    """Say which spectrum of a motion a target is for, such as "RotD100 5 %"."""
    return f"{target.component.replace('rotd', 'RotD')} {100.0 * target.damping:g} %"


def response(one: Inspection, names: Mapping[str, str], ident: str) -> list[str]:
    """Return two SVGs of PSA [g] against period: the horizontal motion with its target, and before beside after."""
    spectra, both = one.spectra, one.spectra["rotd100"]
    at = row_at(both.damping, AT)
    kept = f"{100.0 * float(both.damping[at]):g} %"
    main = {name: s.pseudo_acceleration[row_at(s.damping, AT)] / G for name, s in spectra.items()}
    labels = (("x", "cx", "x"), ("y", "cy", "y"), ("rotd50", "rd50", "RotD50"), ("rotd100", "rd100", "RotD100"))
    horizontal: list[_Curve] = [(kind, f"{label} {kept}", both.periods, main[name]) for name, kind, label in labels]
    others = [k for k in range(both.damping.size) if k != at]
    horizontal += [
        (f"thin{i % 3 + 1}", f"RotD100 {100.0 * both.damping[k]:g} %", both.periods, both.pseudo_acceleration[k] / G)
        for i, k in enumerate(others)
    ]
    if one.target is not None:
        label = f"target, {target_name(one.target)}"
        horizontal.append(("target", label, np.array(one.target.periods_s), np.array(one.target.psa_g)))
    compared: list[_Curve] = []
    if one.filtered:
        earlier = [one.spectra_before[axis] for axis in "xyz"]
        compared += [("was", "before", s.periods, s.pseudo_acceleration[0] / G) for s in earlier]
    compared += [(f"c{axis}", names[axis], both.periods, main[axis]) for axis in "xyz"]
    curves = [*horizontal, *compared]
    top = max(float(values.max()) for *_, values in curves) or 1.0
    least = min((float(values[values > 0.0].min()) for *_, values in curves if values.any()), default=top)
    limits = max(0.8 * least, top / 10.0**DECADES), 2.5 * top
    name = f"{short(one.motion.name, 60)}: response spectra"
    what = f"components at {kept} damping{', before and after' if one.filtered else ''}"
    return [
        _spectra(
            f"{ident}h", f"{name}, horizontal{', with the target' if one.target else ''}", horizontal, one, limits
        ),
        _spectra(f"{ident}c", f"{name}, {what}", compared, one, limits),
    ]


def _spectra(ident: str, title: str, curves: Sequence[_Curve], one: Inspection, reach: tuple[float, float]) -> str:
    x = Scale(float(min(p[0] for _, _, p, _ in curves)), float(max(p[-1] for _, _, p, _ in curves)), *_WIDE, log=True)
    panel = _Panel(ident, x, Scale(*reach, 280, 8, log=True))
    longest = usable_period(one)
    beyond = longest is not None and longest < x.high
    if longest is not None and beyond:
        panel.band(longest, x.high)
    for kind, _, periods, values in curves:
        panel.curve(periods, values, kind)
    if longest is not None and beyond:
        panel.upright(longest, f"usable to {longest:.3g} s", "corner")
    panel.label("Pseudo-acceleration (g)")
    told = [
        f"{label} largest {values.max():.3g} g at {periods[int(np.argmax(values))]:.3g} s"
        for kind, label, periods, values in curves
        if kind != "was"
    ]
    said = f"PSA in g against period from {x.low:g} to {x.high:g} s, both logarithmic: {'; '.join(told)}."
    names = list(dict.fromkeys((kind, label) for kind, label, _, _ in curves))
    legend, foot = _legend(names, 20, 340, 424)
    return _svg(ident, 440, foot + 10, title, said, [panel.svg(), _under(panel, "Period (s)"), legend])


# -- figure 4: the pulse ----------------------------------------------------------------------------------------------


def pulse(one: Inspection, units: Units, ident: str) -> str:
    """Return an SVG of the velocity in the pulse's direction with the pulse over it, and of what is left without it."""
    found = one.pulse
    if found is None:
        return ""
    factor, dt = units.factor("m/s"), one.motion.dt
    first, last = strong_part(one.motion)
    begin = max(0.0, min(first, found.time - 2.0 * found.period) - 3.0)
    end = min(one.motion.duration, max(last, found.time + 2.0 * found.period) + 3.0)
    a, b = int(begin / dt), int(np.ceil(end / dt)) + 1
    legend, foot = _legend([("vel", "velocity"), ("cx", "extracted pulse"), ("rest", "residue")], 64, 14, 424)
    x = Scale(a * dt, max(end, (a + 1) * dt), *_WIDE)
    peak = max(float(np.abs(row[a:b]).max()) for row in (found.velocity, found.pulse, found.residual))
    parts, height, top = [legend], 150, round(foot + 12)
    for row, curves in enumerate((((found.velocity, "vel"), (found.pulse, "cx")), ((found.residual, "rest"),))):
        at = top + row * (height + 14)
        panel = _Panel(f"{ident}{row}", x, Scale(*_even(peak * factor), at + height, at), "xy" if row else "y", about=5)
        for values, kind in curves:
            t, v = envelope(values[a:b], dt)
            panel.curve(t + a * dt, v * factor, kind)
        panel.label(f"Velocity ({units.symbol('m/s')})")
        parts.append(panel.svg())
        if row:
            parts.append(_under(panel, "Time (s)"))
    said = (
        f"Velocity in the pulse's direction, peak {units.text(found.pgv, 'm/s')}; the pulse, peak "
        f"{units.text(found.pulse_pgv, 'm/s')}, period {found.period:.3g} s, centred at {found.time:.3g} s; below, "
        f"the residue, peak {units.text(found.pgv * found.pgv_ratio, 'm/s')}."
    )
    return _svg(
        ident, 440, top + 2 * height + 56, f"{short(one.motion.name, 60)}: velocity pulse and residue", said, parts
    )
