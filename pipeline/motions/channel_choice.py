"""The three channels of a record among those of its files, and the one version of a recording among several."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pipeline.motions.grouping import FileTrace
from pipeline.motions.station_metadata import place

_TOGETHER = 60.0
"""s, how far apart two versions of one recording may have started."""

_REMEDY = "; give the surface's files"

_FREE_FIELD = re.compile(r"\bfree[- ]?field\b", re.IGNORECASE)

_ACCELEROMETERS = "NG"
"""Instrument codes of SEED that are an accelerometer's; G stands for one in older European records."""

_VELOCITY_SENSORS = "HL"

_SATURATED = 6.0e6
"""Counts of a digitiser of 24 bits from which a velocity sensor is taken to have clipped."""


@dataclass(frozen=True, slots=True)
class ChosenChannels:
    """What is taken of the channels that belong together.

    Attributes
    ----------
    traces : sequence of FileTrace
        What is left.
    told : tuple of str
        What was left out, and why.
    refused : str
        Why none of it can be used; "" where it can.
    below : bool
        Whether that is because all of it stood in a borehole.
    """

    traces: Sequence[FileTrace]
    told: tuple[str, ...] = ()
    refused: str = ""
    below: bool = False


def instrument(trace: Any) -> str:
    """Return the instrument letter of a SEED channel code, "" for a code that is none."""
    code = trace.stats.channel
    return str(code[1]).upper() if len(code) == 3 else ""


def is_velocity(traces: Sequence[FileTrace]) -> bool:
    """Whether channels are those of a velocity sensor, by their codes."""
    return all(instrument(trace) in set(_VELOCITY_SENSORS) for _, trace in traces)


def saturated(traces: Sequence[FileTrace]) -> str:
    """Return in words which velocity sensor's counts come near the end of a digitiser of 24 bits; "" for none.

    References
    ----------
    Kleckner, J. K. et al. (2022), Seismological Research Letters 93: 6e6 counts as one of the signs of clipping.
    """
    found = [(float(np.abs(trace.data).max()), trace.id) for _, trace in traces if trace.data.dtype.kind == "i"]
    most, code = max(found, default=(0.0, ""))
    if most < _SATURATED:
        return ""
    return f"{code} is a velocity sensor and reaches {most:,.0f} counts of the 8,388,608 that 24 bits have: it clipped"


def chosen(traces: Sequence[FileTrace], wanted: Sequence[str], depth: Callable[[Any], float | None]) -> ChosenChannels:
    """Return the channels of the ground's surface and of the accelerometer, where more than three belong together.

    Parameters
    ----------
    traces : sequence of FileTrace
        Of one station and time.
    wanted : sequence of str
        Channels that somebody has named: code, full id, or the location's number; empty for none.
    depth : callable
        The depth in m of a trace's sensor, None where nothing says it.

    Returns
    -------
    ChosenChannels
        More than three channels where nothing tells which.
    """
    if wanted:
        named = [one for one in traces if any(_named(word, one) for word in wanted)]
        if named:
            out = len(traces) - len(named)
            left_out = [f"{out} of {len(traces)} channels were not asked for"] if out else []
            return ChosenChannels(named, (*left_out, *_stood(named)))
    ids = [trace.id for _, trace in traces]
    twice = sorted({one for one in ids if traces[0][1].stats.station and ids.count(one) > 1})
    if twice:
        again = [name for name, trace in traces if trace.id == twice[0]]
        where = f"{twice[0]} is there more than once ({', '.join(sorted({n.partition('/')[2] for n in again}))})"
        return ChosenChannels(
            traces, (), f"{where}: it has a gap, or the files are of several records; give one unbroken piece"
        )
    told: list[str] = []
    left = _surface(list(traces), depth, told)
    if isinstance(left, str):
        return ChosenChannels(traces, (), left, below=True)
    free = [one for one in left if _FREE_FIELD.search(place(one[1]))]
    if len(left) > 3 and len(free) == 3:
        told.append(f"{_codes(free)} stood in the free field, by the files; left: {_codes(_without(left, free))}")
        left = free
    parts: dict[str, list[FileTrace]] = {}
    for one in left:
        parts.setdefault(one[1].id[:-1], []).append(one)
    whole = [part for part in parts.values() if len(part) == 3]
    if len(left) > 3 and whole:
        best = min(whole, key=lambda part: (_rank(part), part[0][1].id))
        told.append(f"{_codes(best)} taken; left: {_codes(_without(left, best))}")
        left = best
    return ChosenChannels(left, (*told, *_stood(left)))


def left_below(below: ChosenChannels, others: Sequence[ChosenChannels]) -> tuple[str, bool]:
    """Say why channels are refused, and whether that stops nothing: the surface of their borehole is among others.

    Parameters
    ----------
    below : ChosenChannels
        What was refused.
    others : sequence of ChosenChannels
        Of all groups of channels.

    Returns
    -------
    (str, bool)
    """
    first = below.traces[0][1].stats
    above = below.below and any(
        not one.refused
        and (s := one.traces[0][1].stats).station == first.station != ""
        and s.network == first.network
        and abs(s.starttime - first.starttime) <= _TOGETHER
        for one in others
    )
    return below.refused.replace(_REMEDY, ", where its other record stood") if above else below.refused, above


def _stood(traces: Sequence[FileTrace]) -> list[str]:
    """Where the sensors of a record stood, in the words of its files: a floor or a deck is not the ground."""
    places = list(dict.fromkeys(place(trace) for _, trace in traces if place(trace)))
    return (
        [f"its sensors stood here, by the files: {', '.join(map(repr, places))}"] if len(traces) <= 3 and places else []
    )


def one_version(records: Sequence[Sequence[FileTrace]], raw: bool) -> list[tuple[int, str]]:
    """Return which records are left out because another is of the same recording, and why.

    Parameters
    ----------
    records : sequence of sequence of FileTrace
        Each the channels of one record.
    raw : bool
        Whether of a raw and a processed version the raw one is wanted.

    Returns
    -------
    list of (int, str)
        Places in `records`.
    """
    left: dict[int, str] = {}
    for i, first in enumerate(records):
        for j in range(i + 1, len(records)):
            if i in left or j in left or not _same_recording(first, records[j]):
                continue
            sensors = _rank(first), _rank(records[j])
            if sensors[0] != sensors[1]:
                worse, better = (i, j) if sensors[0] > sensors[1] else (j, i)
                why = f"another instrument of the same station; {_codes(records[better])} is its accelerometer"
                left[worse] = (
                    why if sensors[worse == j] > 1 else f"the same station; {_codes(records[better])} is taken"
                )
                continue
            said = [one[0][1].stats.get("kouros", {}).get("processed") for one in (first, records[j])]
            if set(said) == {True, False}:
                out = (i, j)[said.index(raw)]
                left[out] = (
                    "the processed version of the same recording; the raw one is asked for"
                    if raw
                    else "the raw version of the same recording; the processed one is taken (--raw takes this one)"
                )
    return sorted(left.items())


def _same_recording(a: Sequence[FileTrace], b: Sequence[FileTrace]) -> bool:
    one, other = a[0][1].stats, b[0][1].stats
    if not one.station or (one.network, one.station) != (other.network, other.station):
        return False
    if "unknown" in {s.get("kouros", {}).get("start") for s in (one, other)} or not one.starttime.timestamp:
        return False
    return bool(abs(one.starttime - other.starttime) <= _TOGETHER)


def _rank(traces: Sequence[FileTrace]) -> int:
    letters = {instrument(trace) for _, trace in traces}
    return 0 if letters <= set(_ACCELEROMETERS) else 1 if letters == {"L"} else 2 if letters == {"H"} else 0


def _without(traces: Sequence[FileTrace], taken: Sequence[FileTrace]) -> list[FileTrace]:
    return [one for one in traces if not any(one[1] is other for _, other in taken)]


def described(trace: Any, orientation: float | str | None) -> str:
    """Return a channel's code with its direction, and where its sensor stood, as far as its file says it."""
    words = [str(word) for word in (orientation, place(trace)) if word is not None and word != ""]
    return f"{trace.id} ({', '.join(words)})" if words else str(trace.id)


def _codes(traces: Sequence[FileTrace]) -> str:
    return ", ".join(sorted(trace.id for _, trace in traces))


def _named(word: str, one: FileTrace) -> bool:
    name, trace = one
    number = word.isdigit() and trace.stats.location.isdigit() and int(word) == int(trace.stats.location)
    return word in {trace.id, trace.stats.channel, name.partition("/")[2]} or number


def _surface(traces: list[FileTrace], depth: Callable[[Any], float | None], told: list[str]) -> list[FileTrace] | str:
    """Those at the surface of the ground: of KiK-net by its codes, of others by their depths; words where none is."""
    kik = [one for one in traces if one[1].stats.get("kouros", {}).get("format") == "KiK-net"]
    deep = {id(one[1]) for one in kik if one[1].stats.channel.endswith("1")}
    depths = {id(trace): depth(trace) for _, trace in traces}
    deep |= {key for key, metres in depths.items() if metres is not None and metres > 2.0}
    if not deep:
        return traces
    out = [one for one in traces if id(one[1]) in deep]
    if len(out) == len(traces):
        return f"{_codes(out)}: in a borehole, and a museum stands on the surface{_REMEDY}"
    told.append(f"in the borehole, left: {_codes(out)}; a museum stands on the surface")
    return [one for one in traces if id(one[1]) not in deep]
