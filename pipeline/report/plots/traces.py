"""The picture of a motion: its three components, one above the other, on one scale."""

from math import isfinite

from markupsafe import Markup

from pipeline.records import MotionSummary
from pipeline.report.errors import ReportError
from pipeline.report.language import _
from pipeline.report.plots.panel import Panel, Scale, limits, tick
from pipeline.report.plots.svg import Element, path, picture, sideways, text, thin, through
from pipeline.report.text import plain, short
from pipeline.report.units import Units

WIDTH, ROW = 1050, 118
_LEFT, _RIGHT, _TOP, _BOTTOM = 76, 16, 10, 42
_TIMES = ("t", "time", "time_s")


def trace(motion: MotionSummary, units: Units, ident: str) -> Markup:
    """Return the picture of a motion's acceleration series.

    Parameters
    ----------
    motion : MotionSummary
        Its series hold the accelerations in m/s2 of each component by name; one named t, time or time_s holds the
        seconds, otherwise the values are spread evenly over the motion's duration.
    units : Units
        The reader's.
    ident : str
        Begins the ids of the picture within its page.

    Returns
    -------
    Markup
        An ``<svg>``; nothing where the record keeps no series.

    Raises
    ------
    ReportError
        For a series whose length differs from its times', naming the motion.
    """
    components = {k: v for k, v in motion.series.items() if k not in _TIMES and v}
    if not components:
        return Markup("")
    given = next((motion.series[k] for k in _TIMES if k in motion.series), None)
    duration, factor = (motion.samples - 1) * motion.dt, units.factor("m/s2")
    peak = max(abs(v) * factor for series in components.values() for v in series if isfinite(v))
    reach = limits([-peak, peak] if peak else [-1.0, 1.0], False, f"motion {motion.name!r}")
    start, end = (given[0], given[-1]) if given else (0.0, duration)
    x = Scale(start, max(end, start + motion.dt), _LEFT, WIDTH - _RIGHT)
    drawn: list[Element] = []
    names = {"x": _("East (x)"), "y": _("North (y)"), "z": _("Up (z)")}
    for row, (name, series) in enumerate(components.items()):
        if given and len(given) != len(series):
            raise ReportError(
                f"motion {motion.name!r}: series {name!r} has {len(series)} values for {len(given)} times; "
                "store it thinned at the same times"
            )
        times = given or [duration * i / max(1, len(series) - 1) for i in range(len(series))]
        top = _TOP + row * ROW
        panel = Panel(x, Scale(*reach, top + ROW - 24, top))
        line = thin([panel.at(t, v * factor) for t, v in zip(times, series, strict=True)], 0.25)
        drawn += panel.grid((), [v for v in (reach[0], 0.0, reach[1]) if reach[0] <= v <= reach[1]])
        drawn += [path("tr", through(line)), panel.note(short(names.get(name, name), 40), inset=6)]
    floor = _TOP + ROW * len(components) - 20
    symbol = units.symbol("m/s2")
    drawn += [text(tick(v), x.at(v), floor + 14, "tx") for v in x.ticks()]
    drawn.append(text(_("Time (s)"), round((_LEFT + WIDTH) / 2), floor + _BOTTOM - 6, "al"))
    drawn.append(sideways(_("Acceleration") + f" ({symbol})", 15, round(floor / 2)))
    told = _(
        "Acceleration in %(unit)s against time from %(start)s to %(end)s seconds, components %(names)s; "
        "largest value drawn %(peak)s."
    ) % {
        "unit": symbol,
        "start": f"{x.low:.3g}",
        "end": f"{x.high:.3g}",
        "names": ", ".join(components),
        "peak": units.text(peak / factor, "m/s2"),
    }
    heading = _("%(motion)s: accelerogram") % {"motion": plain(motion.name)}
    return picture("chart wide", WIDTH, floor + _BOTTOM, heading, told, drawn, ident)
