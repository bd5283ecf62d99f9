"""A motion as its section shows it: a table of measures, the charts that were drawn for it, what was done to it."""

import re
from collections.abc import Mapping
from math import inf, isfinite

from pipeline.motions.corner_range import corner_range_of
from pipeline.motions.record import ESTIMATED, NO_VERTICAL
from pipeline.records import Chart, MotionSummary
from pipeline.report.language import _, local
from pipeline.report.pages.describe import approval, motion_anchor
from pipeline.report.pages.museum_views import MotionView
from pipeline.report.text import clean, count, plain, words
from pipeline.report.units import Units

_ROWS = (("pga", "PGA", "m/s2"), ("pgv", "PGV", "m/s"), ("pgd", "PGD", "m"), ("arias", "", ""))
_ENDS = ("_x", "_y", "_z", "", "_resultant")
_SECONDS = ("d5_", "significant_duration", "duration", "pulse_period", "tp")
_FIGURE = re.compile(r"Figure (\d+)")


def motion_view(motion: MotionSummary, charts: Mapping[str, Chart], units: Units) -> MotionView:
    """Return one motion's section.

    Parameters
    ----------
    charts : mapping of str to Chart
        All charts of the run; those whose key holds the first 16 digits of the motion's hash belong to it.

    Returns
    -------
    MotionView
    """
    table: list[tuple[str, tuple[str, ...]]] = []
    used: set[str] = set()
    flat = NO_VERTICAL in motion.steps
    up = _("Up (z), estimated") if ESTIMATED in motion.steps else _("Up (z)")
    for stem, title, unit in _ROWS:
        cells = [(f"{stem}{end}", motion.measures.get(f"{stem}{end}")) for end in _ENDS]
        if any(value is not None for _, value in cells):
            used.update(key for key, _ in cells)
            # A vertical that nobody recorded is not a vertical of zero.
            told = [(key, None if flat and key.endswith("_z") else value) for key, value in cells]
            texts = tuple("–" if value is None else _write(key, value, unit, units) for key, value in told)
            table.append((title or _("Arias intensity"), texts))
    rest = {key: value for key, value in motion.measures.items() if key not in used}
    mine = [key for key in charts if motion.hash[:16] in key]
    return MotionView(
        name=clean(motion.name),
        hash=clean(motion.hash),
        anchor=motion_anchor(motion.hash),
        level=clean(motion.level),
        source=clean(motion.source),
        licence=clean(motion.licence),
        approved=approval(motion),
        sampling=_("%(samples)s samples, %(step)s\u00a0s apart, %(duration)s\u00a0s")
        % {
            "samples": count(motion.samples),
            "step": local(f"{motion.dt:.6g}"),
            "duration": local(f"{(motion.samples - 1) * motion.dt:.4g}"),
        },
        columns=(_("East (x)"), _("North (y)"), up, _("Larger horizontal"), _("Resultant")),
        table=tuple(table),
        others=tuple((_name(key), _write(key, value, _unit(key), units)) for key, value in rest.items()),
        corner=_corner(motion, units),
        charts=tuple(sorted(mine, key=lambda key: _figure(charts[key]))),
        steps=tuple(clean(s) for s in motion.steps),
    )


def _corner(motion: MotionSummary, units: Units) -> str:
    other = corner_range_of(motion.steps)
    # Of a floor the peaks are its own.
    if other is None or motion.floor:
        return ""
    return _(
        "For seismologists: between half and double of the corner of its filter (%(low)s and %(high)s\u00a0Hz) the "
        "resultant PGV is %(pgv)s and the PGD %(pgd)s. The verdicts are of the corner that was used."
    ) % {
        "low": local(f"{other.highpass_hz[0]:.3g}"),
        "high": local(f"{other.highpass_hz[1]:.3g}"),
        "pgv": units.pair(*other.pgv, "m/s"),
        "pgd": units.pair(*other.pgd, "m"),
    }


def _figure(chart: Chart) -> float:
    # The paper's order is the one that engineers know; a chart without a figure there comes last.
    found = _FIGURE.search(chart.source)
    return float(found.group(1)) if found else inf


def _name(key: str) -> str:
    head, _bar, rest = key.partition("_")
    if head in ("pga", "pgv", "pgd"):
        return f"{head.upper()} {words(rest)}".strip()
    if key == "duration_5_95":
        return _("Significant duration (5 to 95 %)")
    told = words(plain(key))
    return told[:1].upper() + told[1:]


def _unit(key: str) -> str:
    if key.startswith(_SECONDS):
        return "s"
    return next((unit for stem, _title, unit in _ROWS if key.startswith(stem)), "")


def _write(key: str, value: float, unit: str, units: Units) -> str:
    if unit or not isfinite(value):
        return units.text(value, unit)
    # The Arias intensity is quoted in m/s everywhere; anything that is not known here is shown in SI and says so.
    return local(f"{value:.3g} m/s") if key.startswith("arias") else local(f"{value:.3g} (SI)")
