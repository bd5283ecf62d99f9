"""The picture of a motion: its three components, one above the other, on one scale."""

from functools import cache
from html import escape
from math import isfinite

from pipeline.records import MotionSummary
from pipeline.report.errors import ReportError
from pipeline.report.language import _
from pipeline.report.plots.scales import Scale, limits, thin
from pipeline.report.plots.svg import tick
from pipeline.report.text import plain, short
from pipeline.report.units import Units

WIDTH, ROW = 1050, 118
_LEFT, _RIGHT, _TOP, _BOTTOM = 76, 16, 10, 42
_TIMES = ("t", "time", "time_s")


def trace(motion: MotionSummary, units: Units, ident: str) -> str:
    """Return the motion's acceleration series as one inline SVG, or "" where the record keeps no series.

    motion.series : component name -> accelerations [m/s2]; an entry named t, time or time_s holds the seconds,
                    otherwise the values are spread evenly over the motion's duration
    raises        : ReportError for a series whose length differs from its times', naming the motion
    """
    components = {k: v for k, v in motion.series.items() if k not in _TIMES and v}
    if not components:
        return ""
    given = next((motion.series[k] for k in _TIMES if k in motion.series), None)
    factor = units.factor("m/s2")
    peak = max(abs(v) * factor for series in components.values() for v in series if isfinite(v))
    reach = limits([-peak, peak] if peak else [-1.0, 1.0], False, f"motion {motion.name!r}")
    duration = (motion.samples - 1) * motion.dt
    end = given[-1] if given else duration
    start = given[0] if given else 0.0
    x = Scale(start, max(end, start + motion.dt), _LEFT, WIDTH - _RIGHT)

    @cache
    def across(count: int) -> list[float]:
        return [x.at(t) for t in given or (duration * i / max(1, count - 1) for i in range(count))]

    parts = []
    names = {"x": _("East (x)"), "y": _("North (y)"), "z": _("Up (z)")}
    for row, (name, series) in enumerate(components.items()):
        if given and len(given) != len(series):
            raise ReportError(
                f"motion {motion.name!r}: series {name!r} has {len(series)} values for {len(given)} times; "
                "store it thinned at the same times"
            )
        top = _TOP + row * ROW
        y = Scale(*reach, top + ROW - 24, top)
        points = thin([(a, y.at(v * factor)) for a, v in zip(across(len(series)), series, strict=True)], 0.25)
        d = "M" + "L".join(f"{a:.1f} {b:.1f}" for a, b in points)
        ticks = [v for v in (reach[0], 0.0, reach[1]) if reach[0] <= v <= reach[1]]
        parts.append(f'<path class="gr" d="{"".join(f"M{_LEFT} {y.at(v):.1f}H{WIDTH - _RIGHT}" for v in ticks)}"/>')
        parts += [f'<text class="ty" x="{_LEFT - 8}" y="{y.at(v) + 4:.1f}">{tick(v)}</text>' for v in ticks]
        parts.append(f'<path class="tr" d="{d}"/>')
        label = escape(short(names.get(name, name), 40))
        parts.append(f'<text class="cl" x="{_LEFT + 6}" y="{top + 12}">{label}</text>')
    floor = _TOP + ROW * len(components) - 20
    height = floor + _BOTTOM
    seconds = "".join(f'<text class="tx" x="{x.at(v):.1f}" y="{floor + 14}">{tick(v)}</text>' for v in x.ticks())
    symbol = units.symbol("m/s2")
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
    axis, up = escape(_("Time (s)")), escape(_("Acceleration")) + f" ({symbol})"
    return (
        f'<svg class="chart wide" viewBox="0 0 {WIDTH} {height}" role="img" aria-labelledby="{ident}t {ident}d">'
        f'<title id="{ident}t">{escape(heading)}</title>'
        f'<desc id="{ident}d">{escape(told)}</desc>'
        f'{"".join(parts)}{seconds}<text class="al" x="{(_LEFT + WIDTH) / 2:.0f}" y="{height - 6}">{axis}</text>'
        f'<text class="al" transform="translate(15 {floor / 2:.0f})rotate(-90)">{up}</text></svg>'
    )
