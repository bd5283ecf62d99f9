"""USGS SMC: one component of acceleration in cm/s2, uncorrected or corrected.

Eleven lines of text, 48 integers, 50 reals, comments, then eight fields of ten characters a line, or five of fourteen.
A file of unknown kind, as programs make them of other formats, says neither its unit nor whether it is corrected.  A
file without a sampling rate holds pairs of time and acceleration as they were digitised from film, at irregular times;
they are resampled linearly, which the trace says.  Files may end in a stale record or in NUL bytes, left by the system
that wrote them; the count in the header says where the data end.

source : USGS National Strong-Motion Program, SMC-format data files, https://nsmp.wr.usgs.gov/smcfmt.html
"""

from __future__ import annotations

import re
from datetime import date, timedelta
from typing import Any

from pipeline.motions.formats import blocks, header_facts, irregular, record_text, trace_headers
from pipeline.motions.formats.record_text import NUMBER, Lines, Source
from pipeline.motions.formats.trace_headers import Orientation
from pipeline.quantities import Array

_TITLE = re.compile(
    r"^\s*([0-5]) (UNKNOWN|UNCORRECTED ACCELEROGRAM|CORRECTED ACCELEROGRAM|VELOCITY|DISPLACEMENT|RESPONSE)"
)
_INTEGERS = re.compile(r"^(?:[ \d-]{10}){8}$")
_COMPONENT = re.compile(r"component=\s*(.*)$")
_STATION = re.compile(r"station\s*=\s*(.*?)\s*component")
_EVENT = re.compile(r"^\s*\d{4}\s+\d{1,2}\s+\d{1,2}\s+\d{1,4}\s+([A-Za-z].{0,60}?)\s*$")
_PEAK = re.compile(rf"\bpk(?: acc)?\s*=\s*({NUMBER})")
_TEXT, _INTEGER_LINES = 11, 6
_FORMS = {"0": "SMC of unknown kind", "1": "SMC uncorrected", "2": "SMC corrected"}
_PRECISE = 8
"""Digits, by the 47th integer, of files whose numbers have fourteen characters in place of ten."""


def is_format(source: Source) -> bool:
    """Whether a source is an SMC file, from its first line and its integer header."""
    lines = record_text.parted(record_text.head(source))
    if len(lines) < _TEXT + _INTEGER_LINES or not _TITLE.search(lines[0]):
        return False
    return all(_INTEGERS.match(line.rstrip().ljust(80)) for line in lines[_TEXT : _TEXT + _INTEGER_LINES])


def read_format(source: Source, headonly: bool = False, resample: float = irregular.RESAMPLED, **_: Any) -> Any:
    """Return the trace of an SMC file.

    Parameters
    ----------
    source : str, Path or binary stream
        The file.
    headonly : bool
        Whether the headers alone are wanted.
    resample : float
        Time step in s for irregular times; without effect on a file that has its own step.
    **_ : Any
        What obspy hands to every reader; not used.

    Returns
    -------
    obspy.Stream
        In cm/s2.  `trace_headers.make_trace` tells what a header holds.

    Raises
    ------
    FormatError
        Naming file and line.
    """
    from obspy import Stream

    lines = record_text.open_lines(source)
    kind = lines.match(0, _TITLE, "'1 UNCORRECTED ACCELEROGRAM', or '2 CORRECTED ACCELEROGRAM'")
    if kind[1] not in _FORMS:
        raise lines.other(0, f"the file holds {kind[2].lower()}")
    integers, index = blocks.fixed(lines, _TEXT, 48, 8, 10, "the integer header")
    reals, index = blocks.fixed(lines, index, 50, 5, 15, "the real header")
    index = _after_comments(lines, index, integers)
    count = _whole(lines, _TEXT + 2, integers[16], "the number of values")
    blocks.samples(lines, _TEXT + 2, count)
    fields, width = (5, 14) if integers[46] == _PRECISE else (8, 10)
    values, end = blocks.fixed(lines, index, count, fields, width, "acceleration")
    more = _rest(lines, end)
    direction = _direction(lines, integers)
    uneven = _missing(reals, reals[1])
    if uneven:
        data, dt, more["resampled"] = _pairs(lines, index, values, fields // 2, resample)
    else:
        data, dt = values, blocks.step(lines, _TEXT + _INTEGER_LINES, 1.0 / max(float(reals[1]), 1e-9))
    found, when = _PEAK.search(lines.text(6)), _earthquake(lines, integers)
    if name := _STATION.search(lines.text(5)):
        more["station_name"] = name[1]
    quake = _EVENT.match(lines.text(3))
    if found and kind[1] != "0":
        digit = 0.01 * 10.0 ** -len(found[1].partition(".")[2])
        trace_headers.said_peak(lines, 6, 0.01 * float(found[1]), digit, values[1::2] if uneven else values, 0.01)
    unknown = kind[1] == "0"
    number = int(integers[8]) if integers[8] > 0 and not _missing(integers, integers[8]) else None
    trace = trace_headers.make_trace(
        lines,
        data=data,
        dt=dt,
        form=_FORMS[kind[1]],
        units="" if unknown else "cm/s2",
        si_factor=None if unknown else trace_headers.FACTORS["cm/s2"],
        direction=direction,
        processed=None if unknown else kind[1] == "2",
        station="" if integers[7] == integers[0] else f"{integers[7]:.0f}",
        channel=trace_headers.channel_code(1.0 / dt, direction, number),
        start=when,
        start_is="unknown" if when is None else "earthquake",
        headonly=headonly,
        peak={"acceleration": None if found is None else 0.01 * float(found[1])},
        more=more,
        about=_about(reals, quake[1] if quake else "", when),
    )
    return Stream([trace])


def _about(reals: Array, event: str, when: Any) -> dict[str, Any]:
    def real(index: int) -> float | None:
        return None if _missing(reals, reals[index]) else float(reals[index])

    return header_facts.about(
        event_name=event,
        event_time=when,
        event_latitude=real(2),
        event_longitude=real(3),
        event_depth_km=real(4),
        latitude=real(10),
        longitude=real(11),
        distance_km=real(16),
        **header_facts.magnitude({"W": real(5), "S": real(6), "L": real(7)}),
    )


def _missing(header: Array, value: float) -> bool:
    # The first number of each header is what stands for an unknown one.
    return bool(value == header[0])


def _whole(lines: Lines, index: int, value: float, what: str) -> int:
    if value != int(value) or not 0 <= value < 1e8:
        raise lines.error(index, f"{value:g} cannot be {what}")
    return int(value)


def _after_comments(lines: Lines, index: int, integers: Array) -> int:
    comments = 0 if _missing(integers, integers[15]) else _whole(lines, _TEXT + 1, integers[15], "a number of comments")
    for line in range(index, min(index + comments, len(lines))):
        if not lines.text(line).startswith("|"):
            raise lines.error(
                line, f"expected a comment that starts with |, found {record_text.shown(lines.text(line))}"
            )
    return index + comments


def _rest(lines: Lines, end: int) -> dict[str, str]:
    if lines.blank_until_end(end):
        return {}
    if lines.blank_until_end(end + 1):
        return {"notes": f"line {end + 1}, after the announced values, is a stale record and was not read"}
    raise lines.error(end + 1, "the file goes on after the number of values that its header announces")


def _direction(lines: Lines, integers: Array) -> Orientation:
    vertical, azimuth = integers[12], integers[13]
    said: Orientation = None
    if vertical == 0.0:
        said = "up"
    elif vertical == 180.0:
        said = "down"
    elif vertical == 90.0 and 0.0 <= azimuth <= 360.0:
        said = float(azimuth) % 360.0
    component = _COMPONENT.search(lines.text(5))
    words = trace_headers.orientation(component[1]) if component else None
    if said is None:
        return words
    if (isinstance(words, float) or words in {"up", "down"}) and words != said:
        wrong = f"the text says that the component is {words}, the integer header in line {_TEXT + 2} {said}"
        raise lines.error(5, wrong, "find out which is right, and mend the other")
    return said


def _earthquake(lines: Lines, integers: Array) -> Any:
    year, day, hour, minute, second = (float(value) for value in integers[1:6])
    if _missing(integers, year) or _missing(integers, day):
        return None
    if not (1850 <= year <= 2200 and 1 <= day <= 366):
        raise lines.error(_TEXT, f"day {day:g} of {year:g} is no date")
    when = date(int(year), 1, 1) + timedelta(days=int(day) - 1)
    parts = [0.0 if _missing(integers, part) else part for part in (hour, minute, second)]
    return trace_headers.start_time(lines, _TEXT, when.year, when.month, when.day, *parts)


def _pairs(lines: Lines, index: int, values: Array, per_line: int, dt: float) -> tuple[Array, float, str]:
    if len(values) % 2:
        raise lines.error(_TEXT + 2, f"{len(values)} values make no pairs of time and acceleration")
    data, told = irregular.resampled(lines, index, per_line, values[::2], values[1::2], dt)
    return data, dt, told
