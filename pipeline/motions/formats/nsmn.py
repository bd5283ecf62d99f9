"""NSMN text (Türkiye): three components in gal side by side, behind seventeen lines of 'KEY : value'.

The unit stands beside the peaks alone, until about 2011 as cm/s^2.

source : headers of the files of the Turkish National Strong Motion Network, earlier than TADAS
"""

from __future__ import annotations

import re
from typing import Any

from pipeline.motions.formats import blocks, header_facts, record_text, trace_headers
from pipeline.motions.formats.record_text import Keys, Lines, Source

_TITLE = re.compile(r"^STRONG GROUND MOTION RECORDS OF TURK", re.IGNORECASE)
_KEY = re.compile(r"^([A-Z][A-Z ]{2,30}?)\s*(\([A-Za-z][\w/^*]{0,9}\))?\s*:\s*(.*)$")
_TIMES = (
    re.compile(r"^(?P<d>\d\d)/(?P<m>\d\d)/(?P<y>\d{4}) (?P<H>\d\d):(?P<M>\d\d):(?P<S>\d\d(?:\.\d{0,9})?) \(GMT\)$"),
    re.compile(r"^(?P<y>\d{4})/(?P<m>\d\d)/(?P<d>\d\d) (?P<H>\d\d):(?P<M>\d\d):(?P<S>\d\d(?:\.\d{0,9})?) \(GMT\)$"),
)
_PEAK = re.compile(r"\(([NSEWUD]-[NSEWUD])\)\s*(-?\d{1,6}\.(\d{1,9}))")
_COLUMNS = re.compile(r"^\s*([NSEWUD]-[NSEWUD])\s+([NSEWUD]-[NSEWUD])\s+([NSEWUD]-[NSEWUD])\s*$")
_GAL = r"(?:[Gg]al|cm/s(?:\^2|\*\*2|2|/s))"
_MOST_KEYS = 40
_POINT = re.compile(r"^\s*(\d{1,2}(?:\.\d{0,9})?)([NS])\s?-\s?(\d{1,3}(?:\.\d{0,9})?)([EW])")
_SIZE = re.compile(r"^\s*(\d\.\d{1,2})\s*M([WSLBD])", re.IGNORECASE)


def is_format(source: Source) -> bool:
    """Whether a source is an NSMN file, from its first line and its keys."""
    text = record_text.head(source)
    return bool(_TITLE.match(text)) and "\nNUMBER OF DATA" in text


def _traces(lines: Lines, headonly: bool) -> list[Any]:
    """Return the traces of an NSMN file, one a component."""
    lines.match(0, _TITLE, "'STRONG GROUND MOTION RECORDS OF TURKIYE'")
    keys, units, names = _header(lines)

    def said(key: str, pattern: str, expected: str) -> tuple[int, re.Match[str]]:
        at, text = keys.said(key)
        whole = f"{text} {units[key]}".strip()
        found = re.match(pattern, whole)
        if found is None:
            raise lines.error(at, f"expected {expected}, found {record_text.shown(whole)}")
        return at, found

    at, found = said("NUMBER OF DATA", r"^(\d{1,8})$", "a number of samples")
    count = blocks.samples(lines, at, int(found[1]))
    at, found = said("SAMPLING INTERVAL", r"^(\d?\.\d{1,9}) \((?:s|sn|sec)\)$", "a step in seconds")
    dt = blocks.step(lines, at, float(found[1]))
    at, found = said("RAW PGA VALUES", rf"^(.{{1,120}}) \({_GAL}\)$", "peaks in gal or cm/s^2")
    peaks = {name: (float(text), 10.0 ** -len(digits)) for name, text, digits in _PEAK.findall(found[1])}
    at_peaks = at
    table = blocks.rows(lines, keys.end, 3, "acceleration")
    if len(table) != count:
        wrong = (
            f"the file holds {len(table)} rows of acceleration, and line {keys['NUMBER OF DATA'][0] + 1} says {count}"
        )
        raise lines.error(len(lines), wrong, "it is cut off or damaged: fetch it again")
    at, date = said("RECORD TIME", r"^(.{1,60})$", "a time such as '20/07/2017 22:30:58.000000 (GMT)'")
    when = next((told for form in _TIMES if (told := form.match(date[1]))), None)
    if when is None:
        raise lines.error(at, f"expected '20/07/2017 22:30:58.000000 (GMT)', found {record_text.shown(date[1])}")
    start = trace_headers.start_time(lines, at, *(float(when[part]) for part in "ymdHMS"))
    gal = trace_headers.FACTORS["gal"]
    about = _about(keys)
    traces = []
    for number, name in enumerate(names, start=1):
        direction, data = trace_headers.orientation(name), table[:, number - 1].copy()
        said_peak, digit = peaks.get(name, (0.0, 0.0))
        trace_headers.said_peak(lines, at_peaks, gal * said_peak, gal * digit, data, gal)
        traces.append(
            trace_headers.make_trace(
                lines,
                data=data,
                dt=dt,
                form="NSMN",
                units="gal",
                si_factor=gal,
                direction=direction,
                processed=False,
                network="TK",
                station=said("STATION ID", r"^(\w{1,8})$", "the code of a station")[1][1],
                channel=trace_headers.channel_code(1.0 / dt, direction, number),
                start=start,
                start_is="record",
                headonly=headonly,
                peak={"acceleration": gal * said_peak or None},
                about=about,
            )
        )
    return traces


def _turkish(name: str) -> str:
    """The name of a place in Turkey's eight-bit code, "" where it is not."""
    try:
        return name if name.isascii() else name.encode("latin-1").decode("iso8859-9")
    except UnicodeError:
        return ""


def _about(keys: Keys) -> dict[str, Any]:
    said: dict[str, Any] = {}
    for key, name in (("", "STATION COORDINATES"), ("event_", "EPICENTER COORDINATES")):
        if found := _POINT.match(keys.get(name, (0, ""))[1]):
            said[f"{key}latitude"] = header_facts.turned(float(found[1]), found[2])
            said[f"{key}longitude"] = header_facts.turned(float(found[3]), found[4])
    size = _SIZE.match(keys.get("EARTHQUAKE MAGNITUDE", (0, ""))[1])
    date = keys.get("EARTHQUAKE DATE", (0, ""))[1]
    when = re.match(r"^(\d{4})/(\d\d)/(\d\d) (\d\d):(\d\d):(\d\d(?:\.\d{0,6})?)", date)
    return header_facts.about(
        **said,
        **(header_facts.magnitude({size[2].upper(): float(size[1])}) if size else {}),
        event_depth_km=header_facts.number(keys, "EARTHQUAKE DEPTH"),
        event_time=None if when is None else header_facts.moment(*map(float, when.groups())),
        station_name=_turkish(keys.get("PLACE", (0, ""))[1]),
    )


def _header(lines: Lines) -> tuple[Keys, dict[str, str], tuple[str, ...]]:
    """Return what the header says, by key the unit that stands beside it, and the names of the columns."""
    keys, units = Keys(lines), dict[str, str]()
    for index in range(min(len(lines), _MOST_KEYS)):
        text = lines.text(index)
        if columns := _COLUMNS.match(text):
            if len(set(columns.groups())) < 3:
                raise lines.error(index, "names a component twice")
            keys.end = index + 1
            return keys, units, columns.groups()
        if found := _KEY.match(text):
            keys.add(index, found[1], found[3].strip())
            units[found[1]] = found[2] or ""
    raise lines.error(min(len(lines), _MOST_KEYS), "expected the columns 'N-S E-W U-D'", "fetch the file again")


read_format = record_text.reader(_traces)
