"""Words about an inspected record, on its page and on the terminal."""

from pipeline.motions.corner_range import corner_range_of
from pipeline.motions.doubts import doubts, scale_of
from pipeline.motions.inspection import Inspection
from pipeline.motions.pulses import WaveletPulse
from pipeline.motions.record import ESTIMATED, NO_VERTICAL
from pipeline.report.text import clean, count
from pipeline.report.units import Units, significant

EAST = 90.0
"""Azimuth of the x axis, degrees clockwise from north, of a site that is not turned to its building."""

PEAKS = (("pga", "PGA", "m/s2"), ("pgv", "PGV", "m/s"), ("pgd", "PGD", "m"))

_CHOSEN = " chosen by "
_ACCEPTED = "; accepted: "
_LICENCE = "; licence: "


def axis_names(x_azimuth: float) -> dict[str, str]:
    """Return what the axes are called, by "x", "y" and "z"; x_azimuth: degrees clockwise from north."""
    if x_azimuth == EAST:
        return {"x": "East (x)", "y": "North (y)", "z": "Up (z)"}
    return {"x": f"x, azimuth {x_azimuth:g}°", "y": f"y, azimuth {(x_azimuth - 90.0) % 360.0:g}°", "z": "Up (z)"}


def sampling(one: Inspection) -> str:
    """Say how the motion is sampled, and how it was where that differs."""
    m, b = one.motion, one.before
    told = f"{count(m.samples)} samples, {m.dt:.6g} s apart, {m.duration:.4g} s"
    return told if b.dt == m.dt else f"{told} (recorded {b.dt:.6g} s apart)"


def origin(one: Inspection) -> tuple[str, str]:
    """Return the source of the record and its licence."""
    source, _, licence = clean(one.motion.source).partition(_LICENCE)
    return source, licence


def processing(one: Inspection) -> str:
    """Say in one sentence what was done to the record here."""
    flat = "".join(f" {said[0].upper()}{said[1:]}." for said in (NO_VERTICAL, ESTIMATED) if said in one.motion.steps)
    high, low = one.corners
    if not one.filtered:
        return (
            "Processed by its source and left alone: no baseline correction and no filter was applied here, "
            f"so there is no before to compare with.{flat}"
        )
    above = "" if low is None else f", low-pass at {low:.4g} Hz"
    if high is None:
        kept = "a permanent displacement is kept, and long-period noise with it"
        return f"Corrected here without a high-pass{above}: {kept}.{flat}"
    return f"Filtered here after its baseline was corrected: high-pass at {high:.4g} Hz{above}.{flat}"


def corner_reason(one: Inspection) -> str:
    """Say who or what chose the high-pass corner, "" where there is none."""
    if one.corners[0] is None:
        return ""
    said = next((s for s in one.motion.steps if s.startswith("high-pass corner ") and _CHOSEN in s), "")
    # What is doubtful of it is said below, by itself.
    for doubt in doubts([said]):
        said = said.replace(f"; {doubt}", "")
    return f"Chosen from the record by {clean(said.split(_CHOSEN, 1)[1])}" if said else "Given in the site’s manifest"


def accepted(one: Inspection) -> tuple[str, ...]:
    """Return the refusals that a person overruled, each with the reason given."""
    return tuple(clean(step) for step in one.motion.steps if _ACCEPTED in step)


def doubted(one: Inspection) -> tuple[str, ...]:
    """Return what is doubtful of the motion, and used all the same."""
    return tuple(clean(doubt) for doubt in doubts(one.motion.steps))


def verdict(found: WaveletPulse | None, units: Units) -> str:
    """Say whether the motion is pulse-like, and by what."""
    if found is None:
        return "No pulse was looked for: the record does not shake horizontally."
    by = f"{clean(found.method)}, indicator {number(found.indicator)}, pulse-like above 0"
    if found.is_pulse:
        return f"Pulse-like ({by}): Tp {found.period:.3g} s, PGV {units.text(found.pgv, 'm/s')} in its direction."
    if found.indicator > 0.0:
        return f"Not pulse-like ({by}): the strongest candidate comes after the strong shaking has begun."
    return f"Not pulse-like ({by}); its strongest candidate has a Tp of {found.period:.3g} s."


def azimuth(found: WaveletPulse, x_azimuth: float) -> float:
    """Return the azimuth of a pulse's direction in degrees clockwise from north, from 0 to below 180."""
    return (x_azimuth - found.angle) % 180.0


def number(value: float) -> str:
    """Write a number with three significant digits, zeros at the end included: beside each other they compare."""
    return significant(value, 3, keep=True)


def measured(value: float, unit: str, units: Units) -> str:
    """Write a measure alone, in the reader's unit, as `number`."""
    return number(value * units.factor(unit))


def summary_lines(one: Inspection, units: Units) -> list[str]:
    """Return the record in eight lines and more of plain text, for a terminal."""
    source, licence = origin(one)
    now, was = one.measures, one.measures_before
    lines = [
        f"{clean(one.motion.name)}, level {clean(one.level)}, {one.place} of {clean(one.site)}",
        f"  source    {source}; licence {licence}",
        f"  sampling  {sampling(one)}",
        f"  done      {processing(one)}" + (" Below: before -> after." if one.filtered else ""),
    ]
    scale = scale_of(one.motion.steps)
    lines += [f"  scaled    by {scale:.4g}, before and after below too"] if scale != 1.0 else []
    reason = corner_reason(one)
    lines += [f"  corner    {reason}"] if reason else []
    for stem, title, unit in PEAKS:
        parts = []
        for axis in ("x", "y", "z", "resultant"):
            key = f"{stem}_{axis}"
            before = f"{measured(was[key], unit, units)} -> " if one.filtered else ""
            parts.append(f"{axis} {before}{measured(now[key], unit, units)}")
        lines.append(f"  {title.ljust(10)}{'; '.join(parts)} {units.symbol(unit)}")
    if (other := corner_range_of(one.motion.steps)) is not None:
        low, high = other.highpass_hz
        peaks = f"PGV {units.pair(*other.pgv, 'm/s')}, PGD {units.pair(*other.pgd, 'm')}"
        lines.append(f"  at        {low:.3g} to {high:.3g} Hz, half the corner to double: {peaks} (resultants)")
    arias = [
        f"{axis} " + (f"{number(was[f'arias_{axis}'])} -> " if one.filtered else "") + number(now[f"arias_{axis}"])
        for axis in "xyz"
    ]
    lines.append(f"  Arias     {'; '.join(arias)} m/s")
    span = f"{number(was['duration_5_95'])} -> " if one.filtered else ""
    lines.append(f"  D5-95     {span}{number(now['duration_5_95'])} s")
    told = verdict(one.pulse, units)
    if one.pulse is not None:
        told += f" Azimuth {azimuth(one.pulse, one.x_azimuth):.0f} degrees from north."
    lines.append(f"  pulse     {told}")
    lines += [f"  doubtful  {doubt}" for doubt in doubted(one)]
    overruled = accepted(one)
    lines += (
        [f"  accepted  {overruled[0]}" + (f" (and {len(overruled) - 1} more)" if overruled[1:] else "")]
        if overruled
        else []
    )
    return [line.replace("\u202f", " ").replace("−", "-").replace("’", "'") for line in lines]
