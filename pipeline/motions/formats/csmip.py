"""CSMIP (CDMG, CGS) volume 1 and 2: channels of a station one after the other, also as the USGS wrote them.

Volume 1 has the uncorrected acceleration, volume 2 the corrected acceleration with its velocity and displacement.  A
channel is 13 (volume 1) or 25 lines of text, integer and real headers, then each series behind a line that gives its
length, step, unit and mostly its Fortran format, then "/&".

source : Shakal and Huang (1985), Standard tape format for CSMIP strong-motion data tapes, OSMS 85-03
"""

from __future__ import annotations

import re
from typing import Any

from pipeline.motions.formats import agreement, blocks, header_facts, record_text, trace_headers
from pipeline.motions.formats.record_text import NUMBER, Lines, Source
from pipeline.motions.formats.trace_headers import Series
from pipeline.quantities import Array

_TITLE = re.compile(r"^\s*(un)?corrected accelerogram\b", re.IGNORECASE)
_SPECTRA = re.compile(r"^\s*response and fourier amplitude spectra\b", re.IGNORECASE)
_DATA = re.compile(
    r"^\s*(?P<count>\d{1,8})\s+(?:points of (?P<kind>acc|vel|dis)\w* data|accelerogram points)\s+"
    r"(?:equally spaced at\s+(?P<step>\d{0,3}\.\d{1,6})\s*sec|at\s+(?P<rate>\d{1,4}(?:\.\d{0,4})?)\s*pts/sec)",
    re.IGNORECASE,
)
_UNIT = re.compile(
    r"\b(?:in units(?: of)?|units\s?:|units of|in)\s*([a-z]{1,3}(?:/sec(?:/sec|2|\*\*2)?)?)(?=[\s).,]|$)", re.IGNORECASE
)
_FORMAT = re.compile(r"\(\s*(\d{1,2})\s*f\s*(\d{1,2})\.\d{1,2}\s*\)", re.IGNORECASE)
_CHANNEL = re.compile(r"^\s*chan\s*(\d{1,3}):\s*(.*?)\s*(?:\(|\blocation:|\s{2}|$)", re.IGNORECASE)
_OF_STATION = re.compile(r"\(sta chn:\s*0*([1-9]\d{0,2})\)", re.IGNORECASE)
_COMPONENT = re.compile(r"^\s*comp\s+(\S.{0,20}?)\s*(?:\s\d{1,3})?\s*$", re.IGNORECASE)
STATION = re.compile(r"station (?:no\.|id\.|usc#)\s*(?:(\w{1,8})(?![\w.]))?", re.IGNORECASE)
"""The line of a station: its code, where there is one; RENADIC's goes on with the latitude."""
_PEAKS = {
    "acceleration": re.compile(rf"peak\s+acceleration\s*=\s*({NUMBER})\s*cms?/sec/sec", re.IGNORECASE),
    "velocity": re.compile(rf"peak\s+velocity\s*=\s*({NUMBER})\s*cms?/sec\b", re.IGNORECASE),
    "displacement": re.compile(rf"peak\s+displacement\s*=\s*({NUMBER})\s*cms?\b", re.IGNORECASE),
}
_PEAK_UNITS = {"acceleration": "cm/sec/sec", "velocity": "cm/sec", "displacement": "cm"}
_UNCORRECTED_PEAK = re.compile(rf"\bmax\s*=\s*({NUMBER})\s*g\b", re.IGNORECASE)
_AT = re.compile(r"\bat\s+(\d{1,5}\.\d{0,4})\s+sec", re.IGNORECASE)
_RECORD_LENGTH = re.compile(r"\brecord length\s*=\s*(\d{1,5}\.\d{0,4})\s*sec", re.IGNORECASE)
_TIME = re.compile(
    r"(?:start|trigger)\s+time:\s*(\d{1,2})[/-](\d{1,2})[/-](\d{4}|\d\d),?\s*"
    rf"(\d{{1,2}}):\s?(\d{{1,2}}):{header_facts.SECONDS}\s*(UTC|GMT|P[SD]T)",
    re.IGNORECASE,
)
_ZONES = {"UTC": 0, "GMT": 0, "PST": 8, "PDT": 7}
_TEXT_LINES = {1: 13, 2: 25}
_REALS = {1: 50, 2: 100}
_NEAR = 0.02
"""Degrees that two places of one station may differ by: headers round them to the hundredth."""
_FARTHEST = 60
_END = "/&"
_KINDS = {"acc": "acceleration", "vel": "velocity", "dis": "displacement"}
_LENGTHS = {"cm": 0.01, "in": 0.0254}
_UNITS = {"g": "g", "cm/sec/sec": "cm/s2", "cm/sec2": "cm/s2", "cm/sec**2": "cm/s2", "gal": "gal"}


def is_format(source: Source) -> bool:
    """Whether a source is a CSMIP file of volume 1 or 2, from its first channel's header; of volume 3, to say so."""
    lines = record_text.parted(record_text.head(source))
    if lines and _SPECTRA.search(lines[0]):
        return True
    # GeoNet and COSMOS open alike; both say who they are in the same line.
    if not lines or not _TITLE.search(lines[0]) or re.search(r"GNS Science|\(Format v", lines[0], re.IGNORECASE):
        return False
    return any(_DATA.search(line) for line in lines[:_FARTHEST])


def _traces(lines: Lines, headonly: bool) -> list[Any]:
    """Return the traces of a CSMIP file, one a channel."""
    if _SPECTRA.search(lines.text(0)):
        raise lines.other(0, "the file holds response and Fourier spectra", "give the file of volume 1 or 2 (V1, V2)")
    return record_text.one_after_other(lines, lambda top, _number: _channel(lines, top, headonly))


def _channel(lines: Lines, top: int, headonly: bool) -> tuple[Any, int]:
    volume = 1 if lines.match(top, _TITLE, "'Corrected accelerogram', or 'Uncorrected ...'")[1] else 2
    text = [lines.text(top + i, "the header") for i in range(_TEXT_LINES[volume])]
    number, word, marked = named(lines, top, text)
    direction, assumed = trace_headers.component(word)
    station = next((found[1] or "" for line in text if (found := STATION.search(line))), "")
    index = next((i for i in range(top, min(top + _FARTHEST, len(lines))) if _DATA.search(lines.text(i))), None)
    if index is None:
        wrong = f"no line such as '5696 points of accel data equally spaced at .010 sec' in the next {_FARTHEST} lines"
        raise lines.error(min(top + _FARTHEST, len(lines)), wrong)
    reals = _reals(lines, index, volume)
    # The 53rd real of volume 2 is the step in s.
    precise = float(reals[52]) if volume == 2 and reals is not None and reals[52] > 0.0 else None
    series: dict[str, Array] = {}
    coarse: list[str] = []
    unit, dt, count = "", 0.0, 0
    # The University of Southern California closed its channels by nothing, some of them after the acceleration.
    while marked or not series or not _is_over(lines, index):
        if lines.text(index, f"'{_END}', the end of the channel,").startswith(_END):
            index += 1
            break
        kind, values, its_unit, its_dt, end = _series(lines, index, precise, text)
        if kind in series or kind in coarse or (not series and kind != "acceleration"):
            raise lines.error(index, f"{kind} is out of order; acceleration, velocity, displacement were expected")
        if series and its_dt > 1.5 * dt:
            # Its older files have every second velocity and every fifth displacement.
            coarse.append(kind)
        elif series and (its_dt != dt or len(values) != count):
            wrong = f"{kind} has {len(values)} samples of {its_dt:g} s, the acceleration {count} of {dt:g} s"
            raise lines.error(index, wrong)
        else:
            series[kind] = values
        if kind == "acceleration":
            unit, dt, count = its_unit, its_dt, len(values)
        index = end
    if not series:
        raise lines.error(index, "the channel holds no acceleration")
    notes = [assumed] if assumed else []
    notes += [f"{' and '.join(coarse)} of a longer step not used"] if coarse else []
    about = told(text)
    if reals is not None and _elsewhere(about, float(reals[28]), float(reals[29])):
        notes.append(
            f"its text and its numbers ({reals[28]:g}, {reals[29]:g}) have two places of the station: neither used"
        )
        about = {key: value for key, value in about.items() if key not in {"latitude", "longitude"}}
    when, start_is = started(lines, top, text)
    peaks = _peaks(text, volume)
    _hold(
        lines, top, text, volume, {**series, "acceleration": trace_headers.FACTORS[unit] * series["acceleration"]}, dt
    )
    trace = trace_headers.make_trace(
        lines,
        data=series["acceleration"],
        dt=dt,
        form=f"CSMIP V{volume}",
        units=unit,
        si_factor=trace_headers.FACTORS[unit],
        direction=direction,
        processed=volume == 2,
        station=station,
        location=f"{_of_station(text) or number:02d}",
        channel=trace_headers.channel_code(1.0 / dt, direction, number if marked else None),
        start=when,
        start_is=start_is,
        headonly=headonly,
        peak=peaks,
        series={kind: Series(values) for kind, values in series.items() if kind != "acceleration"},
        more={"notes": "; ".join(notes)} if notes else {},
        about=about,
    )
    return trace, index


def named(lines: Lines, top: int, text: list[str]) -> tuple[int, str, bool]:
    """Return the number of a channel, the words of its orientation, and whether a line with its number says them.

    Parameters
    ----------
    lines, top, text : Lines, int, list of str
        The file, the channel's first line, from 0, and the text of its header.

    Returns
    -------
    int, str, bool
        1 for a channel that has no number.

    Raises
    ------
    FormatError
        Where no line says it.
    """
    for line in text:
        if found := _CHANNEL.match(line):
            return int(found[1]), found[2], True
    # Fields of the text end in the 72nd column; behind it, some say how many characters they have.
    for line in text:
        if found := _COMPONENT.match(line[:72]):
            return 1, found[1], False
    raise lines.error(top + len(text) - 1, "the header ends without a line 'Chan  1: 360 Deg'")


def told(text: list[str]) -> dict[str, Any]:
    """Return what the text of a channel's header says of earthquake, station and sensor, see `header_facts.about`."""
    at = next((i for i, line in enumerate(text) if STATION.search(line)), len(text))
    name = header_facts.place_name(text[at + 1]) if at + 1 < len(text) else ""
    said = header_facts.of_text(text)
    sensor = next((header_facts.sensor(line) for line in text if _CHANNEL.match(line)), {})
    return header_facts.about(**said, event_name=header_facts.earthquake_name(text), station_name=name) | sensor


def _of_station(text: list[str]) -> int:
    """A channel's number at a station of several recorders, each of which counts its own from one; 0 for none."""
    found = next((found for line in text if _CHANNEL.match(line) and (found := _OF_STATION.search(line))), None)
    return int(found[1]) if found else 0


def _is_over(lines: Lines, index: int) -> bool:
    """Whether a channel that nothing closes ends before a line: the file does, or the next channel begins."""
    return index >= len(lines) or lines.blank_until_end(index) or bool(_TITLE.search(lines.text(index)))


def _series(lines: Lines, index: int, precise: float | None, text: list[str]) -> tuple[str, Array, str, float, int]:
    found = lines.match(index, _DATA, f"a line of data, or '{_END}'")
    kind = _KINDS[(found["kind"] or "acc").lower()]
    count = blocks.samples(lines, index, int(found["count"]))
    rest = lines.text(index)[found.end() :]
    said = _UNIT.search(rest)
    # Where the line is silent, the peak of its series in the header is of the same unit; samples are held against it.
    if said is None and not any(_PEAKS[kind].search(line) for line in text):
        raise lines.error(index, "the line does not say the unit of its data")
    word = said[1].lower() if said else _PEAK_UNITS[kind]
    factor = 1.0
    if kind == "acceleration":
        if word not in _UNITS:
            raise lines.error(index, f"{record_text.shown(word)} is no unit of acceleration that is known")
        unit = _UNITS[word]
    else:
        length, _, per = word.partition("/")
        if length not in _LENGTHS or per != ("sec" if kind == "velocity" else ""):
            raise lines.error(index, f"{record_text.shown(word)} is no unit of {kind} that is known")
        unit, factor = word, _LENGTHS[length]
    if found["rate"]:
        dt = 1.0 / max(float(found["rate"]), 1e-9)
    else:
        dt = float(found["step"])
        # Lines with three decimals round the step of 400 samples a second; the real header does not.
        half = 0.51 * 10.0 ** -len(found["step"].partition(".")[2])
        if precise is not None and abs(precise - dt) <= half:
            dt = precise
    blocks.step(lines, index, dt)
    shape = _FORMAT.search(rest)
    columns, width = (int(shape[1]), int(shape[2])) if shape else _shape(lines, index + 1, count)
    values, end = blocks.fixed(lines, index + 1, count, columns, width, kind)
    return kind, factor * values, unit, dt, end


def _shape(lines: Lines, index: int, count: int) -> tuple[int, int]:
    # Eight fields a line, of ten characters or, in older files of volume 1, of nine; only their line tells.
    fields = min(8, count)
    size = len(lines.text(index, "the first line of data"))
    return 8, 9 if size == 9 * fields else 10


def _reals(lines: Lines, data_line: int, volume: int) -> Array | None:
    """The reals in the lines before a channel's data; older files leave some of them blank: None."""
    count = _REALS[volume]
    top = data_line - -(-count // 8)
    try:
        return blocks.fixed(lines, top, count, 8, 10, "the real header")[0] if top >= 0 else None
    except record_text.FormatError:
        return None


def _elsewhere(said: dict[str, Any], north: float, east: float) -> bool:
    """Whether numbers are a place of the Americas, and another one than a header's text says."""
    if "latitude" not in said or not (0.0 < abs(north) <= 90.0 and -180.0 <= east < 0.0):
        return False
    return max(abs(north - float(said["latitude"])), abs(east - float(said["longitude"]))) > _NEAR


def started(lines: Lines, top: int, text: list[str]) -> tuple[Any, str]:
    """Return when a channel's record began, and what that time is of.

    Parameters
    ----------
    lines, top, text : Lines, int, list of str
        The file, the channel's first line, from 0, and the text of its header.

    Returns
    -------
    obspy.UTCDateTime or None, str
        The time, and "record", "earthquake" or "unknown", as `trace_headers.make_trace` takes them.

    Raises
    ------
    FormatError
        For words that make no time.
    """
    for offset, line in enumerate(text):
        if found := _TIME.search(line):
            month, day, year, hour, minute, second = (float(part) for part in found.groups()[:6])
            if year < 100:
                # Two digits of the year: the first accelerogram was written in 1933.
                year += 1900 if year >= 33 else 2000
            when = trace_headers.start_time(lines, top + offset, year, month, day, hour, minute, second)
            # What a recorder says whose clock was never set.
            unset = (year, month, day, hour, minute) == (1980, 1, 1, 0, 0)
            return (None, "unknown") if unset else (when + 3600 * _ZONES[found[7].upper()], "record")
    _, when = header_facts.earthquake_minute(text)
    return (None, "unknown") if when is None else (when, "earthquake")


def _peak_pattern(volume: int, kind: str = "acceleration") -> re.Pattern[str]:
    return _UNCORRECTED_PEAK if volume == 1 else _PEAKS[kind]


def _hold(lines: Lines, top: int, text: list[str], volume: int, series: dict[str, Array], dt: float) -> None:
    """Hold a channel in SI against its peaks, the time of its strongest acceleration, and its own velocity."""
    for kind, values in series.items():
        for at, line in enumerate(text, start=top):
            if found := _peak_pattern(volume, kind).search(line):
                unit = trace_headers.FACTORS["g"] if volume == 1 else 0.01
                trace_headers.said_peak(lines, at, unit * float(found[1]), 0.001 * unit, values, 1.0, kind)
                if kind == "acceleration" and (time := _AT.search(line[found.end() :])):
                    agreement.said_time(lines, at, float(time[1]), values, dt)
                break
    if volume == 1:
        for at, line in enumerate(text, start=top):
            if found := _RECORD_LENGTH.search(line):
                agreement.said_length(lines, at, float(found[1]), len(series["acceleration"]), dt)
    if "velocity" in series:
        agreement.own_velocity(lines, top, series["acceleration"], series["velocity"], dt)


def _peaks(text: list[str], volume: int) -> dict[str, float | None]:
    if volume == 1:
        found = next((found for line in text if (found := _UNCORRECTED_PEAK.search(line))), None)
        return {"acceleration": None if found is None else trace_headers.FACTORS["g"] * float(found[1])}
    peaks: dict[str, float | None] = {}
    for kind, pattern in _PEAKS.items():
        found = next((found for line in text if (found := pattern.search(line))), None)
        peaks[kind] = None if found is None else 0.01 * float(found[1])
    return peaks


read_format = record_text.reader(_traces)
