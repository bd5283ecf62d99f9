"""CSMNC (China): one component in cm/s2, behind sixteen lines of English text.

The record's own time is not in the file: it has the earthquake's, of Beijing, eight hours before UTC.

source : headers of the files of the China Strong Motion Networks Centre
"""

from __future__ import annotations

import re
from typing import Any

from pipeline.motions.formats import blocks, header_facts, record_text, trace_headers
from pipeline.motions.formats.record_text import NUMBER, Lines, Source

_PLACE = r"(\d{1,3}(?:\.\d{0,6})?)\s?([NS])[\s,]+(\d{1,3}(?:\.\d{0,6})?)\s?([EW])\b"
_EPICENTRE = re.compile(rf"^EPICENTER\s*:?\s*{_PLACE}(?:\s+DEPTH\s*:?\s*(\d{{1,3}}(?:\.\d{{0,3}})?)\s*KM\b)?")
_MAGNITUDE = re.compile(r"^MAGNITUDE\s*:?\s*(\d{1,2}(?:\.\d{0,2})?)\s*(?:\(\s*M([A-Za-z])\w?\s*\))?")
_STANDS = re.compile(rf"^STATION\s*:.*?\b{_PLACE}")
_STATION = re.compile(r"^STATION\s*:\s*(?:\S.*?\s)??(\w{2,8})\s+\d{1,2}(?:\.\d{0,6})?\s?[NS]\b")
_COMPONENT = re.compile(r"^COMP\.?\s*:?\s*(\S.{0,20}?)\s*$")
_KIND = re.compile(r"^(UNCORRECTED|CORRECTED)\s+(ACCELERATION|VELOCITY|DISPLACEMENT)\s+UNIT\s*:\s*(\S{1,20})")
_POINTS = re.compile(r"^NO\. OF POINTS\s*:\s*(\d{1,8})\s+EQUALLY SPACED INTERVALS OF\s*:\s*(\d{0,2}\.\d{1,6})\s*SEC")
_PEAK = re.compile(rf"^PEAK VALUE\s*:\s*({NUMBER})\s+AT\b")
_TIME = re.compile(r"\b(\d{4})-(\d{1,2})-(\d{1,2})\s+(\d{1,2}):(\d{1,2}):(\d{1,2}(?:\.\d{0,6})?)\s*(BTM|BJT|UTC|GMT)\b")
_UNITS = {"CM/SEC/SEC": "cm/s2", "CM/S/S": "cm/s2", "CM/SEC**2": "cm/s2", "CM/S2": "cm/s2", "GAL": "gal"}
_MOST_LINES = 40


def is_format(source: Source) -> bool:
    """Whether a source is a CSMNC file, from its header."""
    lines = record_text.parted(record_text.head(source))[:_MOST_LINES]
    return any(_POINTS.match(line) for line in lines) and any(_KIND.match(line) for line in lines)


def _traces(lines: Lines, headonly: bool) -> list[Any]:
    """Return the trace of a CSMNC file."""
    at, kind = _said(lines, _KIND, "'UNCORRECTED ACCELERATION UNIT: CM/SEC/SEC'")
    if kind[2] != "ACCELERATION":
        raise lines.other(at, f"the file holds {kind[2].lower()}")
    if kind[3].upper() not in _UNITS:
        raise lines.error(at, f"expected one of {', '.join(_UNITS)}, found {record_text.shown(kind[3])}")
    unit = _UNITS[kind[3].upper()]
    top, points = _said(lines, _POINTS, "'NO. OF POINTS: 12000 EQUALLY SPACED INTERVALS OF: 0.005 SEC'")
    count = blocks.samples(lines, top, int(points[1]))
    dt = blocks.step(lines, top, float(points[2]))
    word = _said(lines, _COMPONENT, "'COMP. EW'")[1]
    direction, assumed = trace_headers.component(word[1])
    start = top + 1
    while start < min(len(lines), _MOST_LINES) and not re.match(r"^\s*-?\d*\.\d+", lines.text(start)):
        start += 1
    data = blocks.free(lines, start, count, "acceleration")
    factor = trace_headers.FACTORS[unit]
    peak = next(((i, found) for i in range(top, start) if (found := _PEAK.match(lines.text(i)))), None)
    if peak is not None:
        digit = 10.0 ** -len(peak[1][1].partition(".")[2])
        trace_headers.said_peak(lines, peak[0], factor * float(peak[1][1]), factor * digit, data, factor)
    when = _time(lines, top)
    station = next((found[1] for i in range(top) if (found := _STATION.match(lines.text(i)))), "")
    trace = trace_headers.make_trace(
        lines,
        data=data,
        dt=dt,
        form="CSMNC",
        units=unit,
        si_factor=factor,
        direction=direction,
        processed=kind[1] == "CORRECTED",
        station=station,
        channel=trace_headers.channel_code(1.0 / dt, direction, None),
        start=when,
        start_is="unknown" if when is None else "earthquake",
        headonly=headonly,
        peak={"acceleration": None if peak is None else factor * float(peak[1][1])},
        more={**_about(lines, top, when), **({"notes": assumed} if assumed else {})},
    )
    return [trace]


def _about(lines: Lines, top: int, when: Any) -> dict[str, Any]:
    """What the lines above the samples say of earthquake and station, by the names of `header_facts.about`."""
    said: dict[str, Any] = {"event_time": when}
    for text in (lines.text(index) for index in range(top)):
        for prefix, pattern in (("event_", _EPICENTRE), ("", _STANDS)):
            if found := pattern.match(text):
                said[f"{prefix}latitude"] = header_facts.turned(float(found[1]), found[2])
                said[f"{prefix}longitude"] = header_facts.turned(float(found[3]), found[4])
                if prefix and found[5]:
                    said["event_depth_km"] = float(found[5])
        if found := _MAGNITUDE.match(text):
            said |= header_facts.magnitude({(found[2] or "").upper(): float(found[1])})
    return header_facts.about(**said)


def _said(lines: Lines, pattern: re.Pattern[str], expected: str) -> tuple[int, re.Match[str]]:
    for index in range(min(len(lines), _MOST_LINES)):
        if found := pattern.match(lines.text(index)):
            return index, found
    raise lines.error(min(len(lines), _MOST_LINES), f"the header ends without {expected}", "fetch the file again")


def _time(lines: Lines, top: int) -> Any:
    for index in range(top):
        if found := _TIME.search(lines.text(index)):
            when = trace_headers.start_time(lines, index, *(float(part) for part in found.groups()[:6]))
            return when - 8 * 3600 if found[7] in {"BTM", "BJT"} else when
    return None


read_format = record_text.reader(_traces)
