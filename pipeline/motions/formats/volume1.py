"""Volume 1 of film: pairs of time and acceleration, as CSMIP, RENADIC (Chile) and the USC (Los Angeles) digitised them.

A channel is 13 lines of text, 100 integers and 50 reals, then five pairs a line in fields of seven characters, those of
the USC after one blank.  CSMIP and RENADIC end a channel by "/&", the USC by nothing.  Pairs at even times keep their
step; others are resampled linearly, which the trace says.

source : Shakal and Huang (1985), Standard tape format for CSMIP strong-motion data tapes, OSMS 85-03, volume 1, and the
headers of the files themselves
"""

from __future__ import annotations

import re
from typing import Any

from pipeline.motions.formats import blocks, csmip, irregular, record_text, trace_headers
from pipeline.motions.formats.record_text import Lines, Source
from pipeline.quantities import Array

_TITLE = re.compile(r"^\s*(?:file\s+\d{1,6} of )?uncorrected accelerogram data\b", re.IGNORECASE)
_POINTS = re.compile(r"^\s*no\. of points\s*=\s*(\d{1,8})\b", re.IGNORECASE)
_UNITS = re.compile(r"^\s*units (?:of uncor accel )?(?:are|is) sec(?:onds)? and (g/10|g)(?=[\s.,]|$)", re.IGNORECASE)
_PEAK = re.compile(r"\bmax\s*=\s*(-?\d{0,4}\.(\d{1,6}))\s*g\b", re.IGNORECASE)
_TEXT, _PAIRS = 13, 5
_AT_POINTS, _AT_UNITS = 10, 11
_DIGIT = 0.001


def is_format(source: Source) -> bool:
    """Whether a source is a volume 1 of pairs, from its first channel's header."""
    lines = record_text.parted(record_text.head(source))[:_TEXT]
    return (
        len(lines) == _TEXT
        and bool(_TITLE.search(lines[0]) and _POINTS.search(lines[_AT_POINTS]) and _UNITS.search(lines[_AT_UNITS]))
        and not csmip.is_format(source)
    )


def read_format(source: Source, headonly: bool = False, resample: float = irregular.RESAMPLED, **_: Any) -> Any:
    """Return the traces of a file of pairs, one a channel.

    Parameters
    ----------
    source : str, Path or binary stream
        The file.
    headonly : bool
        Whether the headers alone are wanted.
    resample : float
        Time step in s for irregular times; without effect on a channel that has its own step.
    **_ : Any
        What obspy hands to every reader; not used.

    Returns
    -------
    obspy.Stream
        In g or tenths of g.  `trace_headers.make_trace` tells what a header holds.

    Raises
    ------
    FormatError
        Naming file and line.
    """
    from obspy import Stream

    lines = record_text.open_lines(source)
    return Stream(record_text.one_after_other(lines, lambda top, _number: _channel(lines, top, headonly, resample)))


def _channel(lines: Lines, top: int, headonly: bool, resample: float) -> tuple[Any, int]:
    lines.match(top, _TITLE, "'Uncorrected accelerogram data'")
    text = [lines.text(top + i, "the header") for i in range(_TEXT)]
    number, word, marked = csmip.named(lines, top, text)
    direction, assumed = trace_headers.component(word)
    count = int(lines.match(top + _AT_POINTS, _POINTS, "'No. of points = 7000'")[1])
    blocks.samples(lines, top + _AT_POINTS, count)
    unit = lines.match(top + _AT_UNITS, _UNITS, "'Units are sec and g/10'")[1].lower()
    integers, index = blocks.fixed(lines, top + _TEXT, 100, 16, 5, "the integer header")
    if integers[27] not in {0.0, float(count)}:
        wrong = f"the integer header announces {integers[27]:g} points, line {top + _AT_POINTS + 1} says {count}"
        raise lines.error(top + _TEXT + 1, wrong)
    _, index = blocks.fixed(lines, index, 50, 8, 10, "the real header")
    times, data, end = _pairs(lines, index, count)
    when, start_is = csmip.started(lines, top, text)
    notes, more = [assumed] if assumed else [], {}
    step = irregular.even_step(times, _DIGIT)
    if step is None:
        step = resample
        samples, more["resampled"] = irregular.resampled(lines, index, _PAIRS, times, data, resample)
    else:
        samples = data
    factor = trace_headers.FACTORS[unit]
    peak = _PEAK.search(text[_AT_UNITS])
    if peak is not None:
        digit = trace_headers.FACTORS["g"] * 10.0 ** -len(peak[2])
        said = trace_headers.FACTORS["g"] * float(peak[1])
        trace_headers.said_peak(lines, top + _AT_UNITS, said, digit, data, factor)
    if notes:
        more["notes"] = "; ".join(notes)
    trace = trace_headers.make_trace(
        lines,
        data=samples,
        dt=step,
        form="film V1",
        units=unit,
        si_factor=factor,
        direction=direction,
        processed=False,
        station=_station(text),
        location=f"{number:02d}",
        channel=trace_headers.channel_code(1.0 / step, direction, number if marked else None),
        start=when if when is None or start_is == "earthquake" else when + float(times[0]),
        start_is=start_is,
        headonly=headonly,
        peak={"acceleration": None if peak is None else trace_headers.FACTORS["g"] * float(peak[1])},
        more=more,
        about=csmip.told(text),
    )
    if not marked:
        return trace, end
    lines.match(end, re.compile("^/&"), "'/&', the end of the channel,")
    return trace, end + 1


def _pairs(lines: Lines, index: int, count: int) -> tuple[Array, Array, int]:
    # The file has no word on its fields; its first line is full, or the only one, and they are seven characters.
    size = len(lines.text(index, "the first pairs of time and acceleration"))
    lead = size - 14 * min(_PAIRS, count)
    if lead not in {0, 1}:
        wrong = f"expected {min(_PAIRS, count)} pairs in fields of seven characters, found a line of {size}"
        raise lines.error(index, wrong)
    if not lead:
        values, end = blocks.fixed(lines, index, 2 * count, 2 * _PAIRS, 7, "time and acceleration")
        return values[::2], values[1::2], end
    rows = -(-count // _PAIRS)
    if index + rows > len(lines):
        wrong = f"the file ends where line {index + rows} was expected ({count} pairs are announced)"
        raise lines.error(len(lines), wrong, "it is cut off: fetch the file again")
    held = [line[1:] if line[:1] == b" " else b"?" for line in lines.lines[index : index + rows]]
    shifted = Lines(lines.file, [*lines.lines[:index], *held], lines.skipped)
    values, end = blocks.fixed(shifted, index, 2 * count, 2 * _PAIRS, 7, "time and acceleration")
    return values[::2], values[1::2], end


def _station(text: list[str]) -> str:
    found = csmip.STATION.search(text[4])
    return found[1] if found and found[1] and not re.fullmatch(r"0+", found[1]) else ""
