"""Traces of files to records: which channels belong to one instrument, and how each of them is oriented."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import PurePosixPath
from typing import Any

_BY_CODE: Mapping[str, float | str] = {"E": 90.0, "N": 0.0, "Z": "up"}
"""How a channel is oriented whose code ends so, by the convention of SEED."""

_BY_WORD: Mapping[str, float | str] = {"EW": 90.0, "NS": 0.0, "UD": "up"}
"""The same of K-NET, whose codes are these, and of KiK-net, where 1 is the borehole and 2 the surface."""

_ENDING = re.compile(
    r"[-_. ]*(?:(?:[A-Z]{2})?[ENZUVXYTLRH123]|NS|EW|UD|UP|DOWN|DWN|VERT(?:ICAL)?|NORTH|SOUTH|EAST|WEST|\d{3})$",
    re.IGNORECASE,
)
"""What the names of the files of one record differ by, at the end."""

_RSN = re.compile(r"^RSN(\d{1,6})_", re.IGNORECASE)
"""The number of a record in the names of PEER's files."""

_TOGETHER = 60.0
"""s, how far apart the channels of one record may have started."""

FileTrace = tuple[str, Any]
"""A file's name inside its folder, and a trace of it."""


@dataclass(frozen=True, slots=True)
class Channel:
    """A channel of a record, as a manifest names it.

    Attributes
    ----------
    code : str
        What it is called.
    axis : str
        "x", "y" or "z"; "?" for a third horizontal one.
    orientation : float, str or None
        Degrees clockwise from north, "up" or "down"; None where nothing says it.
    by_code : bool
        Whether its code alone says so, and not the file's header.
    """

    code: str
    axis: str
    orientation: float | str | None
    by_code: bool


def grouped(found: Sequence[tuple[str, Sequence[Any]]]) -> list[tuple[str, list[FileTrace]]]:
    """Return which traces are one record: a file of several channels, or files of one station and time.

    Parameters
    ----------
    found : sequence of (str, sequence of obspy.Trace)
        Each file's name inside the folder, and what it holds.

    Returns
    -------
    list of (str, list of (str, obspy.Trace))
        What each record may be called, and its traces with the names of their files.
    """
    whole: list[tuple[str, list[FileTrace]]] = []
    single: dict[tuple[Any, ...], list[FileTrace]] = {}
    for name, traces in found:
        if len(traces) > 1:
            whole += _of_file(name, traces)
            continue
        for trace in traces:
            single.setdefault(_place(name, trace, _instrument(name, trace)), []).append((name, trace))
    # Some agencies number the channels of one instrument where others number instruments: what is left is one station.
    left: dict[tuple[Any, ...], list[FileTrace]] = {}
    for key, traces in single.items():
        if len(traces) >= 3:
            whole += _by_time(key[1], traces)
            continue
        for name, trace in traces:
            of = f"{trace.stats.network}.{trace.stats.station}" if trace.stats.station else key[1]
            left.setdefault(_place(name, trace, of), []).append((name, trace))
    for key, traces in left.items():
        ids = {_instrument(name, trace) for name, trace in traces}
        whole += _by_time(next(iter(ids)) if len(ids) == 1 else key[1], traces)
    return whole


def _of_file(name: str, traces: Sequence[Any]) -> list[tuple[str, list[FileTrace]]]:
    """Records of a file of several channels: one, unless it holds several stations, instruments or earthquakes."""
    every = [(name, trace) for trace in traces]
    stations = {f"{trace.stats.network}.{trace.stats.station}" for trace in traces}
    if len(every) <= 3 and len(stations) == 1:
        return [(name, every)]
    made: list[tuple[str, list[FileTrace]]] = []
    for station in sorted(stations):
        own = [one for one in every if f"{one[1].stats.network}.{one[1].stats.station}" == station]
        for _, part in _by_time(station, own):
            instruments = sorted({_sensor(one[1]) for one in part})
            # Where each channel has an instrument's code of its own, the code only numbers channels.
            several = len(instruments) > 1 and len(part) >= 2 * len(instruments)
            split = (
                [(code, [one for one in part if _sensor(one[1]) == code]) for code in instruments]
                if several
                else [(name if len(stations) == 1 else station, part)]
            )
            made += split
    return made


def _sensor(trace: Any) -> str:
    """What the codes of one instrument's channels begin with; both of a KiK-net station, of which one is chosen."""
    kik = trace.stats.get("kouros", {}).get("format") == "KiK-net"
    return str(trace.id).rpartition(".")[0] if kik else str(trace.id[:-1])


def _instrument(name: str, trace: Any) -> str:
    """What the channels of one instrument have in common; without a station, that of their title or their file's name.

    Files that name no station would all be one otherwise.
    """
    if trace.stats.station:
        return str(trace.id[:-1])
    path = PurePosixPath(name)
    number = _RSN.match(path.name)
    title = str(trace.stats.get("kouros", {}).get("title", ""))
    if "," in title:
        called = title.rpartition(",")[0].strip()
        return f"RSN{number[1]} {called}" if number else called
    return _ENDING.sub("", path.stem) or str(trace.id[:-1])


def _place(name: str, trace: Any, of: str) -> tuple[Any, ...]:
    """What the channels of a record have in common, besides their time; its second part tells the station."""
    return str(PurePosixPath(name).parent), of, trace.stats.get("kouros", {}).get("processed")


def _by_time(of: str, traces: list[FileTrace]) -> list[tuple[str, list[FileTrace]]]:
    """Traces of one instrument, parted by when they began: a station records more than one earthquake."""
    parts: list[list[FileTrace]] = []
    for one in sorted(traces, key=lambda each: each[1].stats.starttime):
        if parts and one[1].stats.starttime - parts[-1][0][1].stats.starttime <= _TOGETHER:
            parts[-1].append(one)
        else:
            parts.append([one])
    return [(of, part) for part in parts]


def channels(traces: Sequence[Any]) -> list[Channel]:
    """Return the channels of a record with their axes: east before north, as x before y.

    Parameters
    ----------
    traces : sequence of obspy.Trace
        Of one record.

    Returns
    -------
    list of Channel
        In the order of the axes.
    """
    free = ["x", "y"]
    made: list[Channel] = []
    for trace in sorted(traces, key=lambda one: ("EN".find(one.stats.channel[-1:]) % 3, one.id)):
        code = trace.stats.channel or trace.id
        own = trace.stats.get("kouros", {}).get("orientation")
        meant = own if own is not None else _BY_WORD.get(code.rstrip("12"), _BY_CODE.get(code[-1:]))
        if meant in {"up", "down"} or (meant is None and code[-1:].upper() in {"V", "3"}):
            axis = "z"
        else:
            axis = free.pop(0) if free else "?"
        made.append(Channel(code, axis, meant, own is None and meant is not None))
    return made
