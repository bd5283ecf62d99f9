"""The drawings of an inspected record: histories, Fourier amplitude, response spectra, the pulse."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import chain, pairwise
from math import pi

import numpy as np
from markupsafe import Markup

from pipeline.motions.inspection import Inspection
from pipeline.motions.intensity import integrate, strong_part
from pipeline.motions.manifest import TargetTable
from pipeline.motions.spectra import fourier_amplitude
from pipeline.quantities import Array, G
from pipeline.report.pages.record_words import measured
from pipeline.report.plots.panel import Panel, Scale, legend
from pipeline.report.plots.svg import Element, picture
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


@dataclass(frozen=True, slots=True)
class Drift:
    """What a panel of the histories could not hold of the record as it was.

    Attributes
    ----------
    quantity, unit : str
        "velocity" in "m/s" or "displacement" in "m".
    axes : tuple of str
        The components.
    peak : float
        The largest, SI.
    """

    quantity: str
    unit: str
    axes: tuple[str, ...]
    peak: float


def usable_period(inspection: Inspection) -> float | None:
    """Return the longest usable period of the response spectra in s, None where nothing was filtered out here."""
    corner = inspection.corners[0]
    return None if corner is None else 1.0 / (USABLE * corner)


def _picture(width: int, height: float, title: str, told: str, drawn: Sequence[Element], ident: str) -> Markup:
    return picture("chart", width, height, plain(title), plain(told), drawn, ident)


def _even(peak: float) -> tuple[float, float]:
    """Limits about zero that hold a peak with a little air."""
    return (-1.12 * peak, 1.12 * peak) if peak > 0.0 else (-1.0, 1.0)


def envelope(values: Array, dt: float, points: int = POINTS) -> tuple[Array, Array]:
    """Return few enough points of a history to draw it: of each bin its smallest and largest.

    Parameters
    ----------
    values : ndarray, shape (n,)
        The history.
    dt : float
        Time step in s.
    points : int, optional
        Roughly how many are wanted.

    Returns
    -------
    ndarray, shape (k,)
        Times in s.
    ndarray, shape (k,)
        The values then.
    """
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


def histories(one: Inspection, names: Mapping[str, str], units: Units, ident: str) -> tuple[list[Markup], list[Drift]]:
    """Draw acceleration, velocity and displacement against time, before (where something was done here) and after.

    Parameters
    ----------
    one : Inspection
        The record.
    names : mapping of str to str
        Of the axes "x", "y", "z", for the headings.
    units : Units
        The reader's.
    ident : str
        Begins the ids of the pictures within their page.

    Returns
    -------
    list of Markup
        One picture a component; the three share their scales.
    list of Drift
        What they cut off.
    """
    after = dict(zip((name for name, *_ in ROWS), (one.motion.acceleration, *integrate(one.motion)), strict=True))
    raw = dict(zip(after, (one.before.acceleration, *integrate(one.before)), strict=True)) if one.filtered else {}
    scales, drifts = _history_scales(one, units)
    seconds = Scale(0.0, max(one.motion.duration, one.motion.dt), *_NARROW)
    pictures = []
    for component, axis in enumerate("xyz"):
        drawn, said = [], []
        for name, title, unit, stem in ROWS:
            panel, factor = Panel(seconds, scales[name]), units.factor(unit)
            lines = [(*envelope(raw[name][component], one.before.dt), "was")] if raw else []
            lines.append((*envelope(after[name][component], one.motion.dt), f"c{axis}"))
            peak = f"{measured(one.measures[f'{stem}_{axis}'], unit, units)} {units.symbol(unit)}"
            said.append(f"{name} with a peak of {peak}")
            drawn += panel.drawn(
                f"{ident}{axis}{name[0]}",
                under=[panel.band(*strong_part(one.motion))],
                lines=[panel.line(kind, t, v * factor) for t, v, kind in lines],
                over=[panel.note(peak, right=True), panel.name_y(f"{title} ({units.symbol(unit)})")],
                numbers="xy" if name == ROWS[-1][0] else "y",
                about=4,
            )
        drawn.append(panel.name_x("Time (s)"))
        compared = " Before the processing in grey." if raw else ""
        told = f"Against time, 0 to {one.motion.duration:.4g} s: {', '.join(said)}.{compared}"
        heading = f"{short(one.motion.name, 60)}, {names[axis]}: acceleration, velocity and displacement"
        pictures.append(_picture(340, panel.y.start + 42, heading, told, drawn, f"{ident}{axis}"))
    return pictures, drifts


def _history_scales(one: Inspection, units: Units) -> tuple[dict[str, Scale], list[Drift]]:
    """Return the vertical scale of each row of the histories, and what does not fit into them."""
    scales, drifts, height, top = {}, [], 108, 8
    for row, (name, _, unit, stem) in enumerate(ROWS):
        peak = max(one.measures[f"{stem}_{axis}"] for axis in "xyz")
        earlier = {axis: one.measures_before[f"{stem}_{axis}"] for axis in "xyz"} if one.filtered else {}
        most = max(earlier.values(), default=0.0)
        if peak > 0.0 and most > ROOM_BEFORE * peak:
            axes = tuple(axis for axis, value in earlier.items() if value > 1.12 * ROOM_BEFORE * peak)
            drifts += [Drift(name, unit, axes, most)] if axes else []
        foot = top + row * (height + 12) + height
        reach = _even(max(peak, min(most, ROOM_BEFORE * peak)) * units.factor(unit))
        scales[name] = Scale(*reach, foot, foot - height)
    return scales, drifts


# -- figure 2: Fourier amplitude --------------------------------------------------------------------------------------


def konno_ohmachi(
    frequency: Array, amplitude: Array, first: float, points: int = FOURIER_POINTS
) -> tuple[Array, Array]:
    """Smooth Fourier amplitudes with the main lobe of the window of Konno and Ohmachi (1998), b = 40.

    Parameters
    ----------
    frequency : ndarray, shape (m,)
        The lines of a transform in Hz, from 0.
    amplitude : ndarray, shape (3, m)
        Of each component.
    first : float
        Where the smoothed spectrum begins in Hz, or at the first line above 0.
    points : int, optional
        Most centres.

    Returns
    -------
    ndarray, shape (k,)
        Centres, which are lines.
    ndarray, shape (3, k)
        Smoothed amplitudes.

    References
    ----------
    Konno and Ohmachi (1998), BSSA 88, 228-241: weight (sin x / x)^4, x = b log10(f / fc).
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
) -> list[Markup]:
    """Draw the Fourier amplitude before and after against frequency, with the corners.

    Parameters
    ----------
    one : Inspection
        The record.
    shown : sequence of (ndarray, ndarray)
        Of `amplitudes`.
    names : mapping of str to str
        Of the axes "x", "y", "z", for the headings.
    units : Units
        The reader's.
    ident : str
        Begins the ids of the pictures within their page.

    Returns
    -------
    list of Markup
        One picture a component.
    """
    factor = units.factor("m/s")
    lines, after = shown[-1]
    top = max(float(values.max()) for _, values in shown) * factor or 1.0
    x = Scale(FOURIER_FROM, max(float(frequency[-1]) for frequency, _ in shown), *_NARROW, log=True)
    # The room above the curves is for the names of the corners.
    panel = Panel(x, Scale(top / 10.0**DECADES, 8.0 * top, 228, 8, log=True))
    corners = zip(one.corners, ("high-pass", "low-pass"), strict=True)
    filters = [(row, corner, what) for row, (corner, what) in enumerate(corners) if corner is not None]
    told = " and ".join(f"{what} corner at {corner:.3g} Hz" for _, corner, what in filters)
    uprights = [panel.upright(corner, f"{what} {corner:.3g} Hz", "corner", row) for row, corner, what in filters]
    over = [*chain.from_iterable(uprights), panel.name_y(f"Fourier amplitude ({units.symbol('m/s')})")]
    pictures = []
    for component, axis in enumerate("xyz"):
        kinds = ("was", f"c{axis}")[-len(shown) :]
        curves = [panel.line(k, f, v[component] * factor) for k, (f, v) in zip(kinds, shown, strict=True)]
        largest = int(np.argmax(after[component]))
        said = (
            f"Against frequency from {x.low:g} to {x.high:g} Hz, both logarithmic; largest after the processing "
            f"{units.text(float(after[component][largest]), 'm/s')} at {lines[largest]:.3g} Hz; "
            f"{told or 'no filter was applied here'}."
        )
        heading = f"{short(one.motion.name, 60)}, {names[axis]}: Fourier amplitude"
        drawn = [*panel.drawn(f"{ident}{axis}", (), curves, over), panel.name_x("Frequency (Hz)")]
        pictures.append(_picture(340, 270, heading, said, drawn, f"{ident}{axis}"))
    return pictures


# -- figure 3: response spectra ---------------------------------------------------------------------------------------

AT = 0.05
"""Damping of the spectra that are compared with each other."""


def row_at(damping: Array, wanted: float) -> int:
    """Return the row of a spectrum whose damping is nearest to the one wanted."""
    return int(np.argmin(np.abs(damping - wanted)))


def target_name(target: TargetTable) -> str:
    """Say which spectrum of a motion a target is for, such as "RotD100 5 %"."""
    return f"{target.component.replace('rotd', 'RotD')} {100.0 * target.damping:g} %"


def response(one: Inspection, names: Mapping[str, str], ident: str) -> list[Markup]:
    """Draw PSA in g against period: the horizontal motion with its target, and before beside after.

    Parameters
    ----------
    one : Inspection
        The record.
    names : mapping of str to str
        Of the axes "x", "y", "z".
    ident : str
        Begins the ids of the pictures within their page.

    Returns
    -------
    list of Markup
        Two pictures.
    """
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


def _spectra(ident: str, title: str, curves: Sequence[_Curve], one: Inspection, reach: tuple[float, float]) -> Markup:
    x = Scale(float(min(p[0] for _, _, p, _ in curves)), float(max(p[-1] for _, _, p, _ in curves)), *_WIDE, log=True)
    panel, longest = Panel(x, Scale(*reach, 280, 8, log=True)), usable_period(one)
    beyond = [] if longest is None or longest >= x.high else [longest]
    uprights = [panel.upright(period, f"usable to {period:.3g} s", "corner") for period in beyond]
    drawn = panel.drawn(
        ident,
        under=[panel.band(period, x.high) for period in beyond],
        lines=[panel.line(kind, periods, values) for kind, _, periods, values in curves],
        over=[*chain.from_iterable(uprights), panel.name_y("Pseudo-acceleration (g)")],
    )
    told = [
        f"{label} largest {values.max():.3g} g at {periods[int(np.argmax(values))]:.3g} s"
        for kind, label, periods, values in curves
        if kind != "was"
    ]
    said = f"PSA in g against period from {x.low:g} to {x.high:g} s, both logarithmic: {'; '.join(told)}."
    names, foot = legend(dict.fromkeys((kind, label) for kind, label, _, _ in curves), 20, 340, 424)
    return _picture(440, foot + 10, title, said, [*drawn, panel.name_x("Period (s)"), *names], ident)


# -- figure 4: the pulse ----------------------------------------------------------------------------------------------


def pulse(one: Inspection, units: Units, ident: str) -> Markup:
    """Draw the velocity in the pulse's direction with the pulse over it, and what is left without it.

    Parameters
    ----------
    one : Inspection
        The record.
    units : Units
        The reader's.
    ident : str
        Begins the ids of the picture within its page.

    Returns
    -------
    Markup
        One picture; nothing where no pulse was looked for.
    """
    found = one.pulse
    if found is None:
        return Markup("")
    factor, dt = units.factor("m/s"), one.motion.dt
    first, last = strong_part(one.motion)
    begin = max(0.0, min(first, found.time - 2.0 * found.period) - 3.0)
    end = min(one.motion.duration, max(last, found.time + 2.0 * found.period) + 3.0)
    a, b = int(begin / dt), int(np.ceil(end / dt)) + 1
    drawn, foot = legend([("vel", "velocity"), ("cx", "extracted pulse"), ("rest", "residue")], _WIDE[0], 14, _WIDE[1])
    x = Scale(a * dt, max(end, (a + 1) * dt), *_WIDE)
    peak = max(float(np.abs(row[a:b]).max()) for row in (found.velocity, found.pulse, found.residual))
    height, top = 150, round(foot + 12)
    for row, curves in enumerate((((found.velocity, "vel"), (found.pulse, "cx")), ((found.residual, "rest"),))):
        at = top + row * (height + 14)
        panel = Panel(x, Scale(*_even(peak * factor), at + height, at))
        points = [(*envelope(values[a:b], dt), kind) for values, kind in curves]
        lines = [panel.line(kind, t + a * dt, v * factor) for t, v, kind in points]
        over = [panel.name_y(f"Velocity ({units.symbol('m/s')})")]
        drawn += panel.drawn(f"{ident}{row}", (), lines, over, "xy" if row else "y", about=5)
    drawn.append(panel.name_x("Time (s)"))
    said = (
        f"Velocity in the pulse's direction, peak {units.text(found.pgv, 'm/s')}; the pulse, peak "
        f"{units.text(found.pulse_pgv, 'm/s')}, period {found.period:.3g} s, centred at {found.time:.3g} s; below, "
        f"the residue, peak {units.text(found.pgv * found.pgv_ratio, 'm/s')}."
    )
    title = f"{short(one.motion.name, 60)}: velocity pulse and residue"
    return _picture(440, top + 2 * height + 56, title, said, drawn, ident)
