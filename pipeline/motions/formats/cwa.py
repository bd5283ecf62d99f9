"""CWA (Taiwan, formerly CWB): time and three components in fixed columns, behind lines of '#key: value'.

The header announces length, rate, unit, offset and the order of the columns ("Time U(+); N(+); E(+)"), and the extremes
of each.  Times are of Taiwan, eight hours before UTC.

source : headers of the files of the Central Weather Administration, Taiwan
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from pipeline.motions.formats import blocks, header_facts, record_text, trace_headers
from pipeline.motions.formats.record_text import NUMBER, Keys, Lines, Source
from pipeline.motions.formats.trace_headers import Orientation

_KEY = re.compile(r"^#\s?([A-Za-z][A-Za-z ]{0,40}?\.?(?: [A-Z])?)\s?(\([^)]{0,12}\))?:\s*(.*)$")
_TIME = re.compile(r"^(\d{4})/(\d\d)/(\d\d)-(\d\d):(\d\d):(\d\d(?:\.\d{0,6})?)$")
_ZONE = re.compile(r"^\(GMT([+-]\d\d)\)$")
_COLUMN = re.compile(r"^([A-Z])\(([+-])\)$")
_SHAPE = re.compile(r"^(\d{1,2})F(\d{1,2})\.(\d)$")
_RANGE = re.compile(rf"^({NUMBER})\s*~\s*({NUMBER})$")
_TURNS: dict[str, tuple[Orientation, Orientation]] = {
    "U": ("up", "down"), "N": (0.0, 180.0), "E": (90.0, 270.0), "S": (180.0, 0.0), "W": (270.0, 90.0),
}  # fmt: skip
_MOST_KEYS = 100


def is_format(source: Source) -> bool:
    """Whether a source is a CWA file, from its header."""
    text = record_text.head(source)
    return (
        text.startswith(("#Earthquake Information", "#StationCode"))
        and "#StationCode" in text
        and "\n#SampleRate" in text
    )


def _traces(lines: Lines, headonly: bool) -> list[Any]:
    """Return the traces of a CWA file, one a component."""
    keys, units = _header(lines)
    top = keys.end

    def said(key: str, pattern: str, expected: str) -> tuple[int, re.Match[str]]:
        at, text = keys.said(key)
        found = re.match(pattern, text)
        if found is None:
            raise lines.error(at, f"expected {expected}, found {record_text.shown(text)}")
        return at, found

    at, found = said("SampleRate", r"^(\d{1,4}(?:\.\d{0,4})?)$", "'SampleRate(Hz): 200'")
    dt = blocks.step(lines, at, 1.0 / max(float(found[1]), 1e-9))
    at, found = said("RecordLength", r"^(\d{1,5}(?:\.\d{0,4})?)$", "'RecordLength(sec): 120'")
    announced = round(float(found[1]) / dt)
    blocks.samples(lines, at, announced)
    said("AmplitudeUnit", r"(?i)^gals?\b", "the unit 'gal'")
    at, found = said("DataSequence", r"^Time\s+(.{1,60})$", "'Time U(+); N(+); E(+)'")
    words = found[1].split(";")
    columns = [column for word in words if (column := _COLUMN.match(word.strip())) and column[1] in _TURNS]
    if len(columns) != len(words):
        raise lines.error(at, f"expected columns such as 'U(+); N(+); E(+)', found {record_text.shown(found[1])}")
    at, found = said("Data", _SHAPE.pattern, "'4F10.3'")
    if int(found[1]) != len(columns) + 1:
        raise lines.error(at, f"announces {found[1]} columns; time and {len(columns)} components make another number")
    end = len(lines)
    while end > top and not lines.lines[end - 1].strip(b" \0\x1a"):
        end -= 1
    # The length is whole seconds: the sample at its end may be there, or not.
    if not announced <= end - top <= announced + 1:
        wrong = f"holds {end - top} rows, where the header announces {announced} ({announced * dt:g} s at {dt:g} s)"
        raise lines.error(end, wrong, "it is cut off or damaged: fetch it again")
    width = int(found[1]) * (end - top)
    values, _end = blocks.fixed(lines, top, width, int(found[1]), int(found[2]), "time and acceleration")
    table = values.reshape(end - top, -1)
    off = np.abs(table[:, 0] - table[0, 0] - dt * np.arange(len(table)))
    if off.max() > 0.2 * dt + 0.001:
        at = int(np.argmax(off > 0.2 * dt + 0.001))
        raise lines.error(top + at, f"time {table[at, 0]:g} s is off the even step of {dt:g} s")
    at, found = said("StartTime", _TIME.pattern, "a time such as '2018/02/06-23:50:29.000'")
    hours, zone = _ZONE.match(units["StartTime"]), units["StartTime"]
    if hours is None and zone:
        raise lines.error(at, f"expected a zone such as (GMT+08), found {record_text.shown(zone)}")
    # Older files do not say whose clock theirs is.
    when = trace_headers.start_time(lines, at, *map(float, found.groups())) - 3600 * int(hours[1]) if hours else None
    corrected = "dcoffset(corr)" in keys["AmplitudeUnit"][1].lower().replace(" ", "")
    about = _about(keys, units)
    traces = []
    for number, column in enumerate(columns, start=1):
        name, data = column[1], table[:, number].copy()
        direction = _TURNS[name][column[2] == "-"]
        peak = _peak(lines, keys, name, data)
        traces.append(
            trace_headers.make_trace(
                lines,
                data=data,
                dt=dt,
                form="CWA",
                units="gal",
                si_factor=trace_headers.FACTORS["gal"],
                direction=direction,
                processed=False,
                network="TW",
                station=keys["StationCode"][1] if "StationCode" in keys else "",
                channel=trace_headers.channel_code(1.0 / dt, direction, number),
                start=None if when is None else when + float(table[0, 0]),
                start_is="unknown" if when is None else "record",
                headonly=headonly,
                peak={"acceleration": peak},
                more={"notes": "the agency removed the offset, and nothing else"} if corrected else {},
                about=about,
            )
        )
    return traces


def _about(keys: Keys, units: dict[str, str]) -> dict[str, Any]:
    said = {
        "latitude": "StationLatitude", "longitude": "StationLongitude",
        "event_latitude": "EpicenterLatitude", "event_longitude": "EpicenterLongitude",
    }  # fmt: skip
    places = {}
    for key, name in said.items():
        degrees, side = header_facts.number(keys, name), units.get(name, "").strip("() ")
        if degrees is not None:
            places[key] = header_facts.turned(degrees, side if side in set("NSEW") else "")
    kind = units.get("Magnitude", "").strip("() ").upper().removeprefix("M") or "L"
    time, zone = _TIME.match(keys.get("Origin Time", (0, ""))[1]), _ZONE.match(units.get("Origin Time", ""))
    when = None
    if time is not None and zone is not None:
        when = header_facts.moment(*map(float, time.groups()), zone=int(zone[1]))
    return header_facts.about(
        **places,
        **header_facts.magnitude({kind: header_facts.number(keys, "Magnitude")}),
        event_depth_km=header_facts.number(keys, "Depth"),
        event_time=when,
        station_name=keys.get("StationName", (0, ""))[1],
    )


def _header(lines: Lines) -> tuple[Keys, dict[str, str]]:
    """Return what the header says, and by key the unit, or the zone, that stands beside it."""
    keys, units = Keys(lines), dict[str, str]()
    for index in range(min(len(lines), _MOST_KEYS)):
        text = lines.text(index)
        if text.strip() and not text.startswith("#"):
            keys.end = index
            return keys, units
        if found := _KEY.match(text):
            keys.add(index, found[1], found[3].strip())
            units[found[1]] = found[2] or ""
    raise lines.error(min(len(lines), _MOST_KEYS), "expected the first row of numbers", "fetch the file again")


def _peak(lines: Lines, keys: Keys, name: str, data: Any) -> float | None:
    key = f"AmplitudeMAX. {name}"
    found = _RANGE.match(keys[key][1]) if key in keys else None
    if found is None:
        return None
    gal = trace_headers.FACTORS["gal"]
    said = gal * max(abs(float(part)) for part in found.groups())
    trace_headers.said_peak(lines, keys[key][0], said, 0.001 * gal, data, gal)
    return said


read_format = record_text.reader(_traces)
