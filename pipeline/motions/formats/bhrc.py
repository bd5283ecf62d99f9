"""BHRC volume 1 (Iran): the components L, V and T of an instrument one after the other, uncorrected, in tenths of g.

A component is 13 lines of text, 100 integers and 50 reals, which are not used, then ten fields of thirteen characters a
line, then "/&".  The azimuths of L and T stand in the station's line; V is taken as positive up.

source : headers of the files of the Iran Strong Motion Network (Building and Housing Research Center)
"""

from __future__ import annotations

import re
from typing import Any

from pipeline.motions.formats import blocks, header_facts, record_text, trace_headers
from pipeline.motions.formats.record_text import Lines, Source
from pipeline.motions.formats.trace_headers import Orientation

_TITLE = re.compile(r"^\* VOL(\d)\w{0,4} FILE:\s*(\d{1,8})(?:-\d{1,3})?/(\d{1,4})")
_COMPONENT = re.compile(r"^COMP\s+([LVT])\s?(\d{0,2})\s*$")
_AZIMUTH = re.compile(r"Azimuth\s+L\s*(\d{1,3})\s+T\s*(\d{1,3})", re.IGNORECASE)
_POINTS = re.compile(r"NO\. OF POINTS\s*=\s*(\d{1,8})\s+DURATION\s*=\s*(\d{1,5}\.\d{0,4})")
_UNITS = re.compile(r"UNITS ARE SECONDS AND (G/10|G)\s*$")
_PLACE = re.compile(r"\b(\d{1,2}(?:\.\d{0,6})?)\s?([NS])\s+(\d{1,3}(?:\.\d{0,6})?)\s?([EW])\b")
_DEPTH = re.compile(r"\bFD\s*(\d{1,3}(?:\.\d*)?)\s*Km", re.IGNORECASE)
_SIZE = re.compile(r"\bM([WSLB])\s*(\d\.\d{1,2})\b", re.IGNORECASE)
_ORIGIN = re.compile(r"^Origin Time\s*:\s*(\d{4})/(\d\d)/(\d\d)\s+(\d{1,2}):(\d\d):(\d\d(?:\.\d{0,3})?)")
_TEXT, _HEADERS = 13, 14


def is_format(source: Source) -> bool:
    """Whether a source is a BHRC file, from its first lines."""
    lines = record_text.parted(record_text.head(source))[:_TEXT]
    return len(lines) == _TEXT and bool(_TITLE.search(lines[0])) and lines[6].startswith("COMP")


def _traces(lines: Lines, headonly: bool) -> list[Any]:
    """Return the traces of a BHRC file, one a component."""
    return record_text.one_after_other(lines, lambda top, number: _component(lines, top, number, headonly))


def _component(lines: Lines, top: int, number: int, headonly: bool) -> tuple[Any, int]:
    title = lines.match(top, _TITLE, "'* VOL1DS FILE:  5526/01'")
    if title[1] != "1":
        raise lines.error(top, f"the file is of volume {title[1]}", "give the uncorrected file, of volume 1")
    name = lines.match(top + 6, _COMPONENT, "'COMP L1', V or T")[1]
    azimuths = lines.match(top + 7, _AZIMUTH, "'Azimuth L 50 T 140'")
    direction: Orientation = "up"
    if name != "V":
        direction = trace_headers.orientation(azimuths[1 if name == "L" else 2])
    said = lines.match(top + 10, _POINTS, "'NO. OF POINTS = 9472 DURATION = 47.360'")
    count = blocks.samples(lines, top + 10, int(said[1]))
    unit = lines.match(top + 11, _UNITS, "'UNITS ARE SECONDS AND G/10'")[1].lower()
    dt = _step(lines, top, count, said[2])
    data, end = blocks.fixed(lines, top + _TEXT + _HEADERS, count, 10, 13, "acceleration")
    lines.match(end, re.compile("^/&"), "'/&', the end of the component,")
    when = _ORIGIN.search(lines.text(top + 2))
    trace = trace_headers.make_trace(
        lines,
        data=data,
        dt=dt,
        form="BHRC V1",
        units=unit,
        si_factor=trace_headers.FACTORS[unit],
        direction=direction,
        processed=False,
        network="I1",
        station=title[2],
        location=title[3],
        channel=trace_headers.channel_code(1.0 / dt, direction, number),
        start=None if when is None else trace_headers.start_time(lines, top + 2, *map(float, when.groups())),
        start_is="unknown" if when is None else "earthquake",
        headonly=headonly,
        more={"notes": "V is taken as vertical, positive up"} if name == "V" else {},
        about=_about(lines, top, when),
    )
    return trace, end + 1


def _about(lines: Lines, top: int, when: Any) -> dict[str, Any]:
    station, quake = lines.text(top + 7), lines.text(top + 8)
    said: dict[str, Any] = {}
    for prefix, text in (("", station), ("event_", quake)):
        if found := _PLACE.search(text):
            said[f"{prefix}latitude"] = header_facts.turned(float(found[1]), found[2])
            said[f"{prefix}longitude"] = header_facts.turned(float(found[3]), found[4])
    depth = _DEPTH.search(quake)
    return header_facts.about(
        **said,
        **header_facts.magnitude({kind.upper(): float(size) for kind, size in _SIZE.findall(quake)}),
        event_depth_km=float(depth[1]) if depth else None,
        event_time=None if when is None else header_facts.moment(*map(float, when.groups())),
        station_name=station.partition("  ")[0].strip(),
    )


def _step(lines: Lines, top: int, count: int, said: str) -> float:
    # Counted by some from the first sample, by others to the end of the last: the whole rate that is nearer.
    seconds, digit = float(said), 10.0 ** -len(said.partition(".")[2])
    rates = [rate for rate in (count / max(seconds, digit), (count - 1) / max(seconds, digit)) if rate >= 1.0]
    rate = min(rates, key=lambda each: abs(each - round(each)), default=0.0)
    if not rate or abs(rate - round(rate)) > rate * max(digit / max(seconds, digit), 1e-3):
        raise lines.error(top + 10, f"{count} points in {said} s make no whole number of samples per second")
    return blocks.step(lines, top + 10, 1.0 / round(rate))


read_format = record_text.reader(_traces)
