"""JMA strong-motion CSV (Japan): lines of 'KEY= value', then north-south, east-west and up-down in gal.

Rows and header may end in empty cells.  Times are of Japan, nine hours before UTC.  The length is not
announced.

source : Japan Meteorological Agency, strong-motion waveforms, https://www.data.jma.go.jp/eqev/data/kyoshin
"""

from __future__ import annotations

import re
from typing import Any

from pipeline.motions.formats import blocks, record_text, trace_headers
from pipeline.motions.formats.record_text import Keys, Lines, Source

_KEY = re.compile(r"^\s*(SITE CODE|LAT\.|LON\.|SAMPLING RATE|SAMPLING FREQ|UNIT|INITIAL TIME)\s*=\s*(.*?)[\s,]*$", re.I)
_RATE = re.compile(r"^(\d{1,4}(?:\.\d{0,4})?)\s*Hz$", re.IGNORECASE)
_UNIT = re.compile(r"^gal\b", re.IGNORECASE)
_TIME = re.compile(r"^(\d{4}|\d\d)\s+(\d{1,2})\s+(\d{1,2})\s+(\d{1,2})\s+(\d{1,2})\s+(\d{1,2}(?:\.\d{0,6})?)$")
_NAMES = re.compile(r"^\s*(NS|EW|UD)\s*,\s*(NS|EW|UD)\s*,\s*(NS|EW|UD)[\s,]*$", re.IGNORECASE)
_MOST_KEYS = 20


def is_format(source: Source) -> bool:
    """Whether a source is a JMA file, from its keys."""
    lines = record_text.parted(record_text.head(source))[:_MOST_KEYS]
    keys = {found[1].upper() for line in lines if (found := _KEY.match(line))}
    return bool(lines) and lines[0].lstrip("\xef\xbb\xbf ").upper().startswith("SITE CODE") and "INITIAL TIME" in keys


def _traces(lines: Lines, headonly: bool) -> list[Any]:
    """Return the three traces of a JMA file."""
    keys, names = _header(lines)

    def said(pattern: re.Pattern[str], expected: str, *names: str) -> tuple[int, re.Match[str]]:
        at, text = next((keys[name] for name in names if name in keys), (keys.end, ""))
        found = pattern.match(text)
        if found is None:
            raise lines.error(at, f"expected {names[0]}= {expected}, found {record_text.shown(text)}")
        return at, found

    at, found = said(_RATE, "100Hz", "SAMPLING RATE", "SAMPLING FREQ")
    dt = blocks.step(lines, at, 1.0 / max(float(found[1]), 1e-9))
    said(_UNIT, "gal(cm/s/s)", "UNIT")
    at, found = said(_TIME, "2016 04 14 21 26 20", "INITIAL TIME")
    year, *rest = map(float, found.groups())
    # Two digits of the year in the oldest files, of the 1990s.
    year += 0 if year >= 100 else 1900 if year >= 33 else 2000
    when = trace_headers.start_time(lines, at, year, *rest) - 9 * 3600
    table = blocks.rows(lines, keys.end, 3, "acceleration", b",")
    code = re.match(r"[A-Za-z0-9]{1,8}", keys.get("SITE CODE", (0, ""))[1])
    traces = []
    for number, name in enumerate(names, start=1):
        direction = trace_headers.orientation(name)
        traces.append(
            trace_headers.make_trace(
                lines,
                data=table[:, number - 1].copy(),
                dt=dt,
                form="JMA CSV",
                units="gal",
                si_factor=trace_headers.FACTORS["gal"],
                direction=direction,
                processed=False,
                station=code[0] if code else "",
                channel=trace_headers.channel_code(1.0 / dt, direction, number),
                start=when,
                start_is="record",
                headonly=headonly,
            )
        )
    return traces


def _header(lines: Lines) -> tuple[Keys, tuple[str, ...]]:
    keys = Keys(lines)
    for index in range(min(len(lines), _MOST_KEYS)):
        text = lines.text(index)
        if names := _NAMES.match(text):
            columns = tuple(name.upper() for name in names.groups())
            if len(set(columns)) < 3:
                raise lines.error(index, "names a component twice")
            keys.end = index + 1
            return keys, columns
        if found := _KEY.match(text.lstrip("\xef\xbb\xbf")):
            keys.add(index, found[1].upper(), found[2])
    raise lines.error(min(len(lines), _MOST_KEYS), "expected the columns 'NS,EW,UD'", "fetch the file again")


read_format = record_text.reader(_traces)
