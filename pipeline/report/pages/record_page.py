"""The page of a site's records: what the processing did to each, to be looked at before anyone trusts it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from markupsafe import Markup

from pipeline.motions.inspection import Inspection
from pipeline.motions.intensity import integrate
from pipeline.motions.manifest import TargetTable
from pipeline.quantities import Array, G
from pipeline.report.pages.describe import motion_anchor
from pipeline.report.pages.environment import environment, fill
from pipeline.report.pages.record_charts import (
    AT,
    KONNO_OHMACHI,
    Drift,
    amplitudes,
    fourier,
    histories,
    pulse,
    response,
    row_at,
    target_name,
    usable_period,
)
from pipeline.report.pages.record_words import (
    PEAKS,
    accepted,
    axis_names,
    azimuth,
    corner_reason,
    doubted,
    measured,
    number,
    origin,
    processing,
    sampling,
    verdict,
)
from pipeline.report.text import clean
from pipeline.report.units import Units
from pipeline.resources import replacing

PERIODS = (0.05, 0.1, 0.2, 0.3, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0, 5.0, 10.0)
"""Seconds; the table of the spectra shows the nearest computed periods."""

FREQUENCIES = (0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 40.0)
"""Hertz; the table of the Fourier amplitudes shows the nearest smoothed lines."""

Row = tuple[str, tuple[str, ...]]


@dataclass(frozen=True, slots=True)
class RecordView:
    """One record as its section shows it; numbers are texts in the reader's units, drawings are SVG."""

    anchor: str
    name: str
    level: str
    place: str
    source: str
    licence: str
    sampling: str
    hash: str
    filtered: bool
    processing: str
    reason: str
    accepted: tuple[str, ...]
    doubted: tuple[str, ...]
    columns: tuple[str, ...]
    measures: tuple[Row, ...]
    histories: tuple[Markup, ...]
    drifts: tuple[str, ...]
    fourier: tuple[Markup, ...]
    fourier_caption: str
    fourier_rows: tuple[Row, ...]
    response: tuple[Markup, ...]
    usable: str
    spectrum_columns: tuple[str, ...]
    spectrum: tuple[Row, ...]
    compared: str
    verdict: str
    pulse: Markup
    pulse_facts: tuple[tuple[str, str], ...]
    cycle_columns: tuple[str, ...]
    cycles: tuple[Row, ...]
    steps: tuple[str, ...]


def render_record(inspections: Sequence[Inspection], file: Path, units: Units) -> Path:
    """Write the page of some records of one site: one HTML file that needs nothing but a browser.

    Parameters
    ----------
    inspections : sequence of Inspection
        Of `pipeline.motions.inspection.inspect`, in the order of their sections.
    file : Path
        Written anew; what is there is replaced.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    OSError
        Where it cannot be written.
    """
    file = Path(file)
    views = [record_view(one, units, f"r{i}") for i, one in enumerate(inspections)]
    site = clean(inspections[0].site) if inspections else ""
    text = fill(environment(), "record.html", {"site": site, "records": views, "bandwidth": f"{KONNO_OHMACHI:g}"})
    with replacing(file) as unfinished:
        unfinished.write_text(text, encoding="utf-8", newline="\n")
    return file


def record_view(one: Inspection, units: Units, ident: str) -> RecordView:
    """Return one record's section; ident: prefix of the ids of its drawings within the page."""
    names = axis_names(one.x_azimuth)
    source, licence = origin(one)
    smooth = amplitudes(one)
    pictures, drifts = histories(one, names, units, f"{ident}h")
    longest = usable_period(one)
    return RecordView(
        anchor=f"{ident}-{motion_anchor(one.motion.hash)}",
        name=clean(one.motion.name),
        level=clean(one.level),
        place=clean(one.place),
        source=source,
        licence=licence,
        sampling=sampling(one),
        hash=one.motion.hash,
        filtered=one.filtered,
        processing=processing(one),
        reason=corner_reason(one),
        accepted=accepted(one),
        doubted=doubted(one),
        columns=(*names.values(), "Resultant"),
        measures=tuple(_measures(one, units)),
        histories=tuple(svg for svg in pictures),
        drifts=tuple(_drifted(drift, units) for drift in drifts),
        fourier=tuple(svg for svg in fourier(one, smooth, names, units, f"{ident}f")),
        fourier_caption=f"Smoothed amplitude in {units.symbol('m/s')} at the lines nearest to round frequencies",
        fourier_rows=tuple(_fourier(smooth, units)),
        response=tuple(svg for svg in response(one, names, f"{ident}s")),
        # Beyond the picture nothing is shaded.
        usable="" if longest is None or longest >= one.spectra["rotd100"].periods[-1] else f"{number(longest)} s",
        spectrum_columns=_spectrum_columns(one),
        spectrum=tuple(_spectrum(one)),
        compared=_compared(one),
        verdict=verdict(one.pulse, units),
        pulse=pulse(one, units, f"{ident}p"),
        pulse_facts=tuple(_pulse_facts(one, units)),
        cycle_columns=("Start (s)", "Duration (s)", f"Peak ({units.symbol('m/s')})", f"Area ({units.symbol('m')})"),
        cycles=tuple(_cycles(one, names, units)),
        steps=tuple(clean(step) for step in one.motion.steps),
    )


def _measures(one: Inspection, units: Units) -> list[Row]:
    """Rows whose cells are before and after for each column, or after alone where nothing was done here."""
    shown = [one.measures_before, one.measures] if one.filtered else [one.measures]

    def row(title: str, keys: Sequence[str], write: Callable[[float], str]) -> Row:
        return title, tuple(write(values[key]) if key else "–" for key in keys for values in shown)

    rows = []
    for stem, title, unit in PEAKS:
        keys = [f"{stem}_{axis}" for axis in ("x", "y", "z", "resultant")]
        rows.append(row(f"{title} ({units.symbol(unit)})", keys, partial(measured, unit=unit, units=units)))
    ends = [integrate(motion) for motion in ((one.before, one.motion) if one.filtered else (one.motion,))]
    for which, (title, unit) in enumerate((("Velocity", "m/s"), ("Displacement", "m"))):
        left = [measured(float(end[which][axis, -1]), unit, units) for axis in range(3) for end in ends]
        rows.append((f"{title} left at the end ({units.symbol(unit)})", (*left, *("–" for _ in ends))))
    rows.append(row("Arias intensity (m/s)", ["arias_x", "arias_y", "arias_z", ""], number))
    rows.append(row("Significant duration D5–95 (s)", ["", "", "", "duration_5_95"], number))
    return rows


def _drifted(drift: Drift, units: Units) -> str:
    axes = " and ".join(drift.axes) if len(drift.axes) < 3 else "all three directions"
    return f"{drift.quantity} in {axes}, up to {units.text(drift.peak, drift.unit)}"


def _fourier(smooth: Sequence[tuple[Array, Array]], units: Units) -> list[Row]:
    """Amplitudes before and after, or after alone, of x, y and z at the lines nearest to round frequencies."""
    lines = smooth[-1][0]
    rows = []
    for k in dict.fromkeys(int(np.argmin(np.abs(np.log(lines / frequency)))) for frequency in FREQUENCIES):
        # A record that was resampled has other lines than it had.
        at = [int(np.argmin(np.abs(frequency - lines[k]))) for frequency, _ in smooth]
        cells = (
            measured(float(v[axis, i]), "m/s", units) for axis in range(3) for i, (_, v) in zip(at, smooth, strict=True)
        )
        rows.append((number(float(lines[k])), tuple(cells)))
    return rows


def _spectrum_columns(one: Inspection) -> tuple[str, ...]:
    dampings = one.spectra["rotd100"].damping.tolist()
    kept = 100.0 * dampings[row_at(one.spectra["rotd100"].damping, AT)]
    columns = [f"{name} {kept:g} %" for name in ("x", "y", "z", "RotD50")]
    columns += [f"RotD100 {100.0 * damping:g} %" for damping in dampings]
    return (*columns, f"Target, {target_name(one.target)}") if one.target else tuple(columns)


def _spectrum(one: Inspection) -> list[Row]:
    """PSA in g at the computed periods nearest to round ones."""
    spectra = one.spectra
    both = spectra["rotd100"]
    single = (spectra[name] for name in ("x", "y", "z", "rotd50"))
    curves = [s.pseudo_acceleration[row_at(s.damping, AT)] / G for s in single]
    curves += list(both.pseudo_acceleration / G)
    rows = []
    for k in dict.fromkeys(int(np.argmin(np.abs(np.log(both.periods / period)))) for period in PERIODS):
        cells = [number(float(curve[k])) for curve in curves]
        if one.target:
            cells.append(_targeted(one.target, float(both.periods[k])))
        rows.append((number(float(both.periods[k])), tuple(cells)))
    return rows


def _targeted(target: TargetTable, period: float) -> str:
    """Read the target on straight lines in log-log; outside its periods it says nothing."""
    if not target.periods_s[0] <= period <= target.periods_s[-1]:
        return "–"
    return number(float(np.exp(np.interp(np.log(period), np.log(target.periods_s), np.log(target.psa_g)))))


def _compared(one: Inspection) -> str:
    if one.target is None:
        return ""
    low, high = one.target.compared
    source = f" Source of the target: {clean(one.target.source)}." if one.target.source else ""
    return f"The target is compared with {target_name(one.target)} from {low:g} to {high:g} s.{source}"


def _pulse_facts(one: Inspection, units: Units) -> list[tuple[str, str]]:
    found = one.pulse
    if found is None:
        return []
    north = azimuth(found, one.x_azimuth)
    return [
        ("Indicator", f"{number(found.indicator)} (pulse-like above 0)"),
        ("Period Tp", f"{number(found.period)} s"),
        ("Direction", f"azimuth {north:.0f}° or {north + 180.0:.0f}° clockwise from north"),
        ("Centre", f"{number(found.time)} s"),
        ("PGV in that direction", units.text(found.pgv, "m/s")),
        ("Peak of the pulse", units.text(found.pulse_pgv, "m/s")),
        ("Peak of the residue", units.text(found.pgv_ratio * found.pgv, "m/s")),
        ("Energy left in the residue", f"{100.0 * found.energy_ratio:.3g} %"),
        ("Arrival", "late: after the strong shaking has begun" if found.late else "early"),
    ]


def _cycles(one: Inspection, names: Mapping[str, str], units: Units) -> list[Row]:
    return [
        (
            names[axis],
            (
                number(cycle.start),
                number(cycle.duration),
                measured(cycle.peak, "m/s", units),
                measured(cycle.area, "m", units),
            ),
        )
        for axis, cycles in one.half_cycles.items()
        for cycle in cycles
    ]
