"""COSMOS V0c (raw counts), V1c and V2c: channels one after the other, each with its own headers.

Text, integer, real and comment lines and the series announce their own numbers and Fortran formats.  Velocity and
displacement, in the channel of their acceleration or as channels of their own in the same file, are kept beside it.

source : COSMOS Strong Motion Programs Board (2001), Strong motion data format, version 1.20, with its tables
"""

from __future__ import annotations

import re
from typing import Any

import numpy as np

from pipeline.motions.formats import agreement, blocks, header_facts, record_text, trace_headers
from pipeline.motions.formats.record_text import Lines, Source
from pipeline.motions.formats.trace_headers import Orientation, Series
from pipeline.quantities import Array

_TITLE = re.compile(
    r"^\s*(raw|uncorrected|corrected) (?:acceleration|velocity|displacement)\b"
    r".*\(format v\s?(\d\d\.\d\d) with\s+(\d{1,2}) ",
    re.IGNORECASE,
)
_FORMAT = re.compile(r"format\s*=?\s*\(\s*(?:\dp,?)?(\d{1,2})\s*[ifeg]\s*(\d{1,2})(?:\.\d{1,2})?\s*\)", re.IGNORECASE)
_HEADER = re.compile(r"^\s*(\d{1,4})\s+(integer|real)-header values", re.IGNORECASE)
_COMMENTS = re.compile(r"^\s*(\d{1,4})\s+comment line", re.IGNORECASE)
_DATA = re.compile(
    r"^\s*(\d{1,8})\s+(?:raw\s+)?(accel|veloc|displ)\w*\.?\s*pts.*?units\s*=\s*([^,(]{1,20}?)\s*\(\s*(\d{1,2})\s*\)",
    re.IGNORECASE,
)
_END = re.compile(r"^\s*(?:end-of-data|/&)", re.IGNORECASE)
_CODE = re.compile(r"\bcode:\s*(\w{1,8})-(\w{1,8})", re.IGNORECASE)
_PLACE = re.compile(r"\bcode:\s*\w{1,8}-\w{1,8}\s+[A-Z]{2,8}\s+(\S.*?)\s*$", re.IGNORECASE)
_SCNL = re.compile(r"<SCNL>\s*(\w{1,8})\.(\w{3})\.(\w{1,8})\.(\w{2}|--)")
_CHANNEL = re.compile(r"sta chan?:?\s*([\d?]{1,3})(?::|\s)\s*(.*?)\s*(?:\(|\blocation:|\s{3}|$)", re.IGNORECASE)
_UNKNOWN = re.compile(r"unknown/unspecified:\s*(-?\d{1,7}),\s*(-?\d{1,7}\.?\d{0,6})", re.IGNORECASE)
_KINDS = {"accel": "acceleration", "veloc": "velocity", "displ": "displacement"}
_UNITS = {2: "g", 4: "cm/s2", 7: "in/s2", 10: "gal", 11: "mg", 50: "counts"}
_RATES = {("velocity", 5): 0.01, ("velocity", 8): 0.0254, ("displacement", 6): 0.01, ("displacement", 9): 0.0254}
_WORDS: dict[int, Orientation] = {400: "up", 401: "down", 402: "vertical, sense not indicated"}
_VERSION = 1.2
_STAGES = {"raw": "V0", "uncorrected": "V1", "corrected": "V2"}


def is_format(source: Source) -> bool:
    """Whether a source is a COSMOS file, from its first line and its integer header."""
    lines = record_text.parted(record_text.head(source))
    title = _TITLE.search(lines[0]) if lines else None
    return title is not None and any(_HEADER.search(line) for line in lines[: int(title[3]) + 2])


def _traces(lines: Lines, headonly: bool) -> list[Any]:
    """Return the traces of a COSMOS file, one a channel of acceleration."""
    traces: list[Any] = []
    index = 0
    while index == 0 or not lines.blank_until_end(index):
        index = _channel(lines, index, traces, headonly)
    return traces


def _channel(lines: Lines, top: int, traces: list[Any], headonly: bool) -> int:
    title = lines.match(top, _TITLE, "'Corrected acceleration (Format v01.20 with 13 text lines)'")
    if float(title[2]) < _VERSION:
        wrong = f"is of version {title[2]} of the format, whose headers have their numbers in other places"
        raise lines.error(top, wrong, f"give the file of version {_VERSION:05.2f}")
    text = [lines.text(top + i, "the header") for i in range(int(title[3]))]
    at_integers = top + len(text)
    integers, at_reals = _header(lines, at_integers, "integer")
    reals, index = _header(lines, at_reals, "real")
    announced = lines.match(index, _COMMENTS, "'4 Comment line(s) follow'")
    comments = [lines.text(index + 1 + i, "a comment") for i in range(int(announced[1]))]
    index += 1 + len(comments)
    unknown = next((found for line in text if (found := _UNKNOWN.search(line))), None)
    absent = (float(unknown[1]), float(unknown[2])) if unknown else (-999.0, -999.0)
    if len(integers) < 60 or len(reals) < 70:
        raise lines.error(at_integers, f"{len(integers)} integers and {len(reals)} reals; 60 and 70 are the least")
    dt = blocks.step(lines, at_reals, 0.001 * float(reals[61]))
    first = index
    series: dict[str, tuple[Array, int]] = {}
    while not _END.match(lines.text(index, "'End-of-data'")):
        kind, values, unit, end = _series(lines, index)
        if kind in series or (series and len(values) != len(next(iter(series.values()))[0])):
            raise lines.error(index, f"{kind} comes twice, or is of another length than the channel's other series")
        series[kind] = (values, unit)
        index = end
    if not series:
        raise lines.error(index, "the channel holds no data")
    more = {kind: _si(lines, first, kind, *series[kind]) for kind in series if kind != "acceleration"}
    names = _names(text, comments, integers, absent[0], dt)
    assumed = _agree(lines, at_integers + 6, names)
    if "acceleration" not in series:
        _beside(lines, top, traces, names, more)
        return index + 1
    values, unit = series["acceleration"]
    if unit not in _UNITS:
        raise lines.error(first, f"{unit} is no code of a unit of acceleration", "see table 2 of the format")
    units = _UNITS[unit]
    factor = _sensitivity(reals, absent[1]) if units == "counts" else trace_headers.FACTORS[units]
    _hold(lines, at_reals, reals, absent[1], values, dt)
    if "velocity" in more and factor is not None:
        agreement.own_velocity(lines, at_reals, factor * values, np.asarray(more["velocity"]), dt)
    known = all(integers[i] != absent[0] for i in (39, 41, 42, 43, 44)) and reals[29] != absent[1]
    when = [*(integers[i] for i in (39, 41, 42, 43, 44)), reals[29]]
    notes = ["si_factor from the header: bit, gain and sensitivity"] if units == "counts" else []
    notes += [assumed] if assumed else []
    trace = trace_headers.make_trace(
        lines,
        data=values,
        dt=dt,
        form=f"COSMOS {_STAGES[title[1].lower()]}",
        units=units,
        si_factor=factor,
        direction=names["direction"],
        processed=title[1].lower() == "corrected",
        station=names["station"],
        network=names["network"],
        location=names["location"],
        channel=names["channel"],
        start=trace_headers.start_time(lines, at_integers, *map(float, when)) if known else None,
        start_is="record" if known else "unknown",
        headonly=headonly,
        peak={"acceleration": None if factor is None or reals[63] == absent[1] else factor * float(reals[63])},
        series=more,
        more={"notes": "; ".join(notes)} if notes else {},
        about=_about(text, reals, absent[1]) | names["sensor"],
    )
    traces.append(trace)
    return index + 1


def _hold(lines: Lines, index: int, reals: Array, absent: float, values: Array, dt: float) -> None:
    """Hold a channel against the length, the peak and its time that the real header says."""
    length, peak, time = (0.0 if reals[i] == absent else float(reals[i]) for i in (62, 63, 64))
    agreement.said_length(lines, index, length, len(values), dt)
    trace_headers.said_peak(lines, index, peak, 0.0, values, 1.0, "reading")
    if peak:
        agreement.said_time(lines, index, time, values, dt)


def _header(lines: Lines, index: int, kind: str) -> tuple[Array, int]:
    found = lines.match(index, _HEADER, f"'100 {kind}-header values follow'")
    if found[2].lower() != kind:
        raise lines.error(index, f"expected the {kind} header, found the {found[2].lower()} one")
    shape = lines.match(index, _FORMAT, "'Format=(10I8)' or alike")
    return blocks.fixed(lines, index + 1, int(found[1]), int(shape[1]), int(shape[2]), f"the {kind} header")


def _series(lines: Lines, index: int) -> tuple[str, Array, int, int]:
    found = lines.match(index, _DATA, "'20000 acceleration pts, approx 100 secs, units=cm/sec2 (04), Format=(8F10.5)'")
    shape = lines.match(index, _FORMAT, "'Format=(10I8)' or alike")
    count = blocks.samples(lines, index, int(found[1]))
    kind = _KINDS[found[2].lower()]
    values, end = blocks.fixed(lines, index + 1, count, int(shape[1]), int(shape[2]), kind)
    return kind, values, int(found[4]), end


def _si(lines: Lines, index: int, kind: str, values: Array, unit: int) -> Series:
    if (kind, unit) not in _RATES:
        raise lines.error(index, f"{unit} is no code of a unit of {kind}", "see table 2 of the format")
    return Series(_RATES[kind, unit] * values)


def _sensitivity(reals: Array, absent: float) -> float | None:
    microvolts, volts_per_g, gain = (float(reals[i]) for i in (21, 41, 46))
    if absent in {microvolts, volts_per_g, gain} or min(microvolts, volts_per_g, gain) <= 0.0:
        return None
    return 1e-6 * microvolts / volts_per_g / gain * trace_headers.FACTORS["g"]


def _names(text: list[str], comments: list[str], integers: Array, absent: float, dt: float) -> dict[str, Any]:
    said = next((found for line in text if (found := _CHANNEL.search(line))), None)
    azimuth = int(integers[53])
    direction: Orientation
    if azimuth in _WORDS:
        direction = _WORDS[azimuth]
    elif azimuth != absent and 0 <= azimuth <= 360:
        direction = float(azimuth) % 360.0
    else:
        direction = trace_headers.orientation(said[2]) if said else None
    code = next((found for line in text if (found := _CODE.search(line))), None)
    station, network = (code[2], code[1]) if code else ("", "")
    number = int(said[1]) if said and said[1].isdigit() else max(0, int(integers[49]))
    location, channel = (
        f"{number:02d}" if number else "",
        trace_headers.channel_code(1.0 / dt, direction, number or None),
    )
    if scnl := next((found for line in comments if (found := _SCNL.search(line))), None):
        station, channel, network, location = scnl[1], scnl[2], scnl[3], scnl[4].replace("-", "")
    return {
        "direction": direction,
        "station": station,
        "network": network,
        "location": location,
        "channel": channel,
        "sensor": next((header_facts.sensor(line) for line in text if _CHANNEL.search(line)), {}),
    }


def _about(text: list[str], reals: Array, absent: float) -> dict[str, Any]:
    """What the real header says of earthquake and station, the text where that is silent."""

    def real(index: int) -> float | None:
        return None if reals[index] == absent else float(reals[index])

    said = header_facts.of_text(text)
    said |= header_facts.about(latitude=real(0), longitude=real(1), event_latitude=real(9), event_longitude=real(10),
                               event_depth_km=real(11), distance_km=real(16))  # fmt: skip
    said |= header_facts.magnitude({"W": real(12), "S": real(13), "L": real(14)})
    station = next((found[1] for line in text if (found := _PLACE.search(line))), "")
    return header_facts.about(**said, event_name=header_facts.earthquake_name(text), station_name=station)


def _agree(lines: Lines, index: int, names: dict[str, Any]) -> str:
    """What the channel's SEED code says of an orientation that is open, or is the zero of a vertical."""
    direction, code = names["direction"], names["channel"]
    coded = trace_headers.seed_orientation(code)
    if coded == "up" and isinstance(direction, float):
        # Headers made from StationXML have its azimuth, which is 0 for what points up.
        if direction != 0.0:
            wrong = f"says an azimuth of {direction:g}, and the channel's code {code} a vertical"
            raise lines.error(index, wrong, "find out which is right, and mend the other")
        names["direction"] = "up"
        return f"up, by the channel's code {code}: the header has the azimuth 0 of a vertical"
    if (
        coded is not None
        and not isinstance(direction, float)
        and direction not in set(_WORDS.values()) | {"up", "down"}
    ):
        names["direction"] = coded
        return f"orientation by the channel's code {code} (SEED: N and E within 5 degrees)"
    return ""


def _beside(lines: Lines, top: int, traces: list[Any], names: dict[str, Any], series: dict[str, Series]) -> None:
    seed = f"{names['network']}.{names['station']}.{names['location']}.{names['channel']}"
    owner = next((trace for trace in reversed(traces) if trace.id == seed), None)
    kinds = " and ".join(series)
    if owner is None:
        raise lines.other(top, f"{kinds} of {seed} without its acceleration")
    for kind, values in series.items():
        if kind in owner.stats.kouros or len(values) != owner.stats.npts:
            raise lines.error(top, f"{kind} of {seed} comes twice, or is of another length than its acceleration")
        owner.stats.kouros[kind] = values


read_format = record_text.reader(_traces)
