"""GeoNet V1A (uncorrected) and V2A (corrected): the components of a New Zealand record, one after the other.

Sixteen lines of text, four of ten integers, six of ten reals, then acceleration [mm/s2] and, where they were computed,
velocity [mm/s] and displacement [mm], ten fields of eight characters a line.

source : GNS Science, "Accelerogram data file format", 2012-03-15
"""

from __future__ import annotations

import re
from typing import Any

from pipeline.motions.formats import agreement, blocks, header_facts, record_text, trace_headers
from pipeline.motions.formats.record_text import NUMBER, Lines, Source
from pipeline.motions.formats.trace_headers import Series
from pipeline.quantities import Array

_TITLE = re.compile(r"^\s*(Uncorrected|Corrected) accelerogram\b.*GNS Science", re.IGNORECASE)
_SITE = re.compile(r"^Site\s+(\w{1,8})")
_POINTS = re.compile(r"Number of points\s+(\d{1,8})")
_CORRECTED = re.compile(r"corrected data at\s+(\d{0,3}\.\d{1,6}) sec intervals", re.IGNORECASE)
_RAW = re.compile(r"readings in units of\s+(\d{0,4}\.\d{1,6}) mm/s/s\s+at intervals of\s+(\d{0,3}\.\d{1,6}) s", re.I)
_COMPONENT = re.compile(r"^Component\s+(\S+(?:\s?\d\d?[EW]\b)?)")
_PEAK = re.compile(rf"peak\s+({NUMBER}) (mm/s/s|mm/s|mm)\b(?:\s+at\s+(\d{{1,5}}\.\d{{0,3}}) sec)?", re.IGNORECASE)
_DURATION = re.compile(r"Duration\s+(\d{1,5}(?:\.\d{0,4})?) sec")
_HEADER = 26
_HALVES = re.compile(r"\b\d{1,2} ?\d{1,2} ?\d{1,2}(?:\.\d*)?([NS])\s+\d{1,3} ?\d{1,2} ?\d{1,2}(?:\.\d*)?([EW])")
_DISTANCE = re.compile(r"\bDist\s+(\d{1,5}(?:\.\d*)?)\s?km", re.IGNORECASE)
_DEPTH = re.compile(r"\bDepth\s+(\d{1,3}(?:\.\d*)?)\s?km", re.IGNORECASE)
_SIZE = re.compile(r"\bM([WSLBD])?\s+\d{1,2}\.\d", re.IGNORECASE)


def is_format(source: Source) -> bool:
    """Whether a source is a GeoNet V1A or V2A file, from its first two lines."""
    lines = record_text.parted(record_text.head(source))[:2]
    return len(lines) == 2 and bool(_TITLE.search(lines[0])) and bool(_SITE.search(lines[1]))


def _traces(lines: Lines, headonly: bool) -> list[Any]:
    """Return the traces of a GeoNet file, one a component."""
    return record_text.one_after_other(lines, lambda top, number: _component(lines, top, number, headonly))


def _component(lines: Lines, top: int, number: int, headonly: bool) -> tuple[Any, int]:
    corrected = lines.match(top, _TITLE, "'... accelerogram ... GNS Science'")[1].lower() == "corrected"
    station = lines.match(top + 1, _SITE, "'Site CODE'")[1]
    points = int(lines.match(top + 9, _POINTS, "'Number of points'")[1])
    if corrected:
        scale, dt = 1.0, float(lines.match(top + 10, _CORRECTED, "'... corrected data at 0.020 sec intervals'")[1])
    else:
        expected = "'Raw readings in units of 1.00 mm/s/s at intervals of 0.005 s'"
        raw = lines.match(top + 10, _RAW, expected)
        scale, dt = float(raw[1]), float(raw[2])
    blocks.step(lines, top + 10, dt)
    if scale <= 0.0:
        raise lines.error(top + 10, "the readings are in units of 0 mm/s/s")
    direction = trace_headers.orientation(lines.match(top + 12, _COMPONENT, "'Component N16E', or 'Component Up'")[1])
    integers, _ = blocks.fixed(lines, top + 16, 40, 10, 8, "the integer header")
    reals, _ = blocks.fixed(lines, top + 20, 60, 10, 8, "the real header")
    counts = integers[33:36]
    if counts[0] != points or any(count not in {0.0, counts[0]} for count in counts[1:]):
        told = ", ".join(f"{count:g}" for count in counts)
        wrong = f"announces {told} values of acceleration, velocity and displacement; line {top + 10} says {points}"
        raise lines.error(top + 19, wrong)
    # The header's text has three decimals, its field four; the field is the better of two that agree.
    if abs(reals[25] - dt) <= 0.00051 and reals[25] > 0.0:
        dt = float(reals[25])
    else:
        raise lines.error(top + 22, f"says a time step of {reals[25]:g} s, and line {top + 11} one of {dt:g} s")
    blocks.samples(lines, top + 9, points)
    index = top + _HEADER
    series: dict[str, Array] = {}
    for what, count in zip(("acceleration", "velocity", "displacement"), counts, strict=True):
        if count:
            series[what], index = blocks.fixed(lines, index, points, 10, 8, what)
    if said := _DURATION.search(lines.text(top + 9)):
        agreement.said_length(lines, top + 9, float(said[1]), points, dt)
    for at, (what, values) in enumerate(series.items(), start=top + 13):
        _hold(lines, at, what, (scale if what == "acceleration" else 1.0) * values, dt)
    if "velocity" in series:
        agreement.own_velocity(lines, top + 10, scale * series["acceleration"], series["velocity"], dt)
    start = [integers[8], integers[9], integers[18], integers[19], integers[38], integers[39] / 1000.0]
    trace = trace_headers.make_trace(
        lines,
        data=scale * series["acceleration"],
        dt=dt,
        form="GeoNet V2A" if corrected else "GeoNet V1A",
        units="mm/s2",
        si_factor=trace_headers.FACTORS["mm/s2"],
        direction=direction,
        processed=corrected,
        station=station,
        network="NZ",
        channel=trace_headers.channel_code(1.0 / dt, direction, number),
        start=trace_headers.start_time(lines, top + 19, *map(float, start)),
        start_is="record",
        headonly=headonly,
        peak={what: _peak(lines, top + 13 + i) for i, what in enumerate(("acceleration", "velocity", "displacement"))},
        series={what: Series(0.001 * values) for what, values in series.items() if what != "acceleration"},
        about=_about(lines, top, integers, reals),
    )
    return trace, index


def _about(lines: Lines, top: int, integers: Array, reals: Array) -> dict[str, Any]:
    """Places stand without their hemisphere in the real header; the text has its letters."""
    said: dict[str, Any] = {}
    for at, first, prefix in ((top + 1, 10, ""), (top + 8, 12, "event_")):
        if halves := _HALVES.search(lines.text(at)):
            said[f"{prefix}latitude"] = header_facts.turned(float(reals[first]), halves[1])
            said[f"{prefix}longitude"] = header_facts.turned(float(reals[first + 1]), halves[2])
    quake = lines.text(top + 8)
    for key, pattern in (("distance_km", _DISTANCE), ("event_depth_km", _DEPTH)):
        if found := pattern.search(quake):
            said[key] = float(found[1])
    kind = _SIZE.search(quake)
    said |= header_facts.magnitude({(kind[1] or "L").upper() if kind else "L": float(reals[14])})
    if kind is None or not kind[1]:
        said.pop("magnitude_type", None)
    parts = [float(value) for value in integers[:6]]
    said["event_time"] = header_facts.moment(*parts[:5], parts[5] / 10.0)
    said["event_name"] = header_facts.place_name(lines.text(top + 6))
    return header_facts.about(**said, station_name=header_facts.place_name(lines.text(top + 2)))


def _peak(lines: Lines, index: int) -> float | None:
    found = _PEAK.search(lines.text(index))
    return None if found is None else 0.001 * float(found[1])


def _hold(lines: Lines, index: int, what: str, values: Array, dt: float) -> None:
    """Hold a series in mm and seconds against the line of its peak."""
    if found := _PEAK.search(lines.text(index)):
        digit = 0.001 * 10.0 ** -len(found[1].partition(".")[2])
        trace_headers.said_peak(lines, index, 0.001 * float(found[1]), digit, values, 0.001, what)
        if found[3]:
            agreement.said_time(lines, index, float(found[3]), values, dt)


read_format = record_text.reader(_traces)
