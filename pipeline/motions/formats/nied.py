"""K-NET CSV, as NIED (Japan) offers K-NET and KiK-net since 2024: a head of names and values, then rows of gal.

Every line of the head begins with '#', and a line of names is followed by one of their values.  Rows are a time of
Japan, nine hours before UTC, the seconds since the first, and three accelerations, or six of KiK-net: 1 to 3 are those
of the borehole, 4 to 6 those at the surface, each north-south, east-west and up-down.  They are raw, with their offset.

It is read as a CSV with units (`table`), by whose plugin obspy finds it.
source : National Research Institute for Earth Science and Disaster Resilience, strong-motion seismograph networks
"""

from __future__ import annotations

import re
from dataclasses import replace
from typing import Any

import numpy as np

from pipeline.motions.formats import blocks, header_facts, record_text, trace_headers
from pipeline.motions.formats.record_text import Keys, Lines, Source

_FIRST = "#K-NET CSV"
_TIME = re.compile(r"^(\d{4})/(\d\d)/(\d\d) (\d\d):(\d\d):(\d\d(?:\.\d{0,6})?)$")
_COLUMNS = re.compile(r"^#Time,RelativeTime\(s\),([^,]{1,12}(?:,[^,]{1,12}){0,8})$")
_KNET = {"N-S(gal)": "NS", "E-W(gal)": "EW", "U-D(gal)": "UD"}
_KIKNET = {f"{n}(gal)": code for n, code in enumerate(("NS1", "EW1", "UD1", "NS2", "EW2", "UD2"), start=1)}
_DEEP = "in the borehole: it may not point where it is named for"
_JAPAN = 9 * 3600
_MOST_HEAD = 40


def is_format(source: Source) -> bool:
    """Whether a source is a K-NET CSV, from its first line."""
    return record_text.head(source).startswith(_FIRST)


def is_first(lines: Lines) -> bool:
    """Whether lines begin as a K-NET CSV does."""
    return len(lines) > 0 and lines.text(0).startswith(_FIRST)


def traces(lines: Lines, headonly: bool) -> list[Any]:
    """Return the three traces of a K-NET CSV, or the six of KiK-net.

    Parameters
    ----------
    lines : Lines
        Of the file.
    headonly : bool
        Whether the samples are left out.

    Returns
    -------
    list of obspy.Trace

    Raises
    ------
    FormatError
        Naming the line, where the head lacks or contradicts something.
    """
    keys, names = _header(lines)
    rate = _value(lines, keys, "SamplingFrequency(Hz)")
    dt = blocks.step(lines, keys.said("SamplingFrequency(Hz)")[0], 1.0 / max(rate, 1e-9))
    moment = _TIME.match(lines.text(keys.end, "a row of samples").partition(",")[0])
    if moment is None:
        raise lines.error(keys.end, f"expected a time, found {record_text.shown(lines.text(keys.end))}")
    start = trace_headers.start_time(lines, keys.end, *map(float, moment.groups())) - _JAPAN
    rows = [line.partition(b",")[2] for line in lines.lines[keys.end :]]
    told = replace(lines, lines=lines.lines[: keys.end] + rows)
    table = blocks.rows(told, keys.end, 1 + len(names), "samples", b",")
    announced = round(_value(lines, keys, "DurationTime(s)") * rate)
    if announced != len(table):
        wrong = f"announces {announced} samples, and {len(table)} are there"
        raise lines.error(keys.said("DurationTime(s)")[0], wrong, "it is cut off or damaged: fetch it again")
    off = np.abs(table[:, 0] - dt * np.arange(len(table)))
    if off.max() > 0.011:
        worst = int(np.argmax(off))
        raise lines.error(keys.end + worst, f"time {table[worst, 0]:g} s is off the even step of {dt:g} s")
    said = _about(lines, keys)
    code = re.match(r"\w{1,8}", keys.said("Code")[1])
    found = []
    for number, channel in enumerate(names, start=1):
        direction = trace_headers.orientation(channel[:2])
        kik = channel[-1] in "12"
        found.append(
            trace_headers.make_trace(
                lines,
                data=table[:, number].copy(),
                dt=dt,
                form="KiK-net" if kik else "K-NET CSV",
                units="gal",
                si_factor=trace_headers.FACTORS["gal"],
                direction=direction,
                processed=False,
                station=code[0] if code else "",
                channel=channel,
                start=start,
                start_is="record",
                headonly=headonly,
                more={"notes": _DEEP} if channel.endswith("1") else {},
                about=said,
            )
        )
    return found


def _header(lines: Lines) -> tuple[Keys, list[str]]:
    keys = Keys(lines)
    index = 0
    while index < min(len(lines), _MOST_HEAD):
        text = lines.text(index).strip()
        if columns := _COLUMNS.match(text):
            words = columns[1].split(",")
            known = _KIKNET if words[0] in _KIKNET else _KNET
            if len(set(words)) != len(words) or set(words) != set(known):
                raise lines.error(index, f"expected the columns {', '.join(known)}, found {record_text.shown(text)}")
            keys.end = index + 1
            return keys, [known[word] for word in words]
        after = lines.text(index + 1, "the head's values").strip()
        names, values = (one.removeprefix("#").split(",") for one in (text, after))
        # A title, such as "#Event", stands alone: what follows it are names.
        if (len(names) == len(values) and not re.match(r"[A-Za-z]", values[0].strip() or "A")) or names[0] == "Code":
            if len(names) != len(values):
                raise lines.error(index + 1, f"expected {len(names)} values, found {record_text.shown(after)}")
            for name, value in zip(names, values, strict=True):
                key = f"{'Station' if names[0] == 'Code' and name != 'Code' else ''}{name.strip()}"
                keys.add(index + 1, key, value.strip())
            index += 1
        index += 1
    raise lines.error(min(len(lines), _MOST_HEAD), "expected the columns '#Time,RelativeTime(s),...'", "fetch it again")


def _value(lines: Lines, keys: Keys, name: str) -> float:
    at, word = keys.said(name)
    if re.fullmatch(r"\d{1,6}(?:\.\d{0,6})?", word) is None:
        raise lines.error(at, f"expected a number for {name}, found {record_text.shown(word)}")
    return float(word)


def _about(lines: Lines, keys: Keys) -> dict[str, Any]:
    at, word = keys.get("OriginTime", (0, ""))
    moment = _TIME.match(word)
    when = None if moment is None else trace_headers.start_time(lines, at, *map(float, moment.groups())) - _JAPAN
    wanted = {
        "event_latitude": "Latitude", "event_longitude": "Longitude", "event_depth_km": "Depth(km)",
        "magnitude": "Magnitude", "latitude": "StationLatitude", "longitude": "StationLongitude",
    }  # fmt: skip
    said = {key: keys.get(name, (0, ""))[1] for key, name in wanted.items()}
    numbers = {key: float(text) for key, text in said.items() if re.fullmatch(r"-?\d{1,4}(?:\.\d{0,8})?", text)}
    return header_facts.about(event_time=when, **numbers)
