"""Components of a record brought together: which channel each is, whether they belong to one, and their common span."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.motions.errors import Judgement, judged, refusal
from pipeline.motions.parts import Piece
from pipeline.motions.record import Component, Record
from pipeline.quantities import Array

COMMON = 0.8
"""Least share of the longest component that all components have in common: what was recorded together was so for most
of it (judgement; the components of one film record of the 1970s differ by 1 % at most)."""

NEAR = 0.001
"""Degrees, about 100 m, that the headers of one station's components may differ by rounding."""

ONE_EVENT = 60.0
"""s, how far apart the times of one earthquake may be: its solutions differ by seconds, and some are told to the minute
(judgement)."""

ONE_PLACE = 50.0
"""km, how far apart the epicentres of one earthquake may be: those of a network's first and of its last solution, or of
two agencies, may differ by tens of km (judgement)."""

Row = tuple[Path, Any, str]
"""A component's file, its trace, and what the manifest calls it."""

# Seismometers and accelerometers of SEED; the codes of KiK-net, such as NS2, are none.
_SEED = re.compile(r"[A-Z][HLGMN][A-Z0-9]")
_KIKNET = re.compile(r"(?:NS|EW|UD)([12])")
_SENSORS = {"1": "in the borehole", "2": "at the surface"}


def channel_of(
    *, folder: Path, record: Record, key: str, component: Component, pieces: Sequence[Piece], taken: set[int]
) -> list[Piece]:
    """Return the pieces of the one channel that a component of the manifest names.

    Parameters
    ----------
    folder, record : Path, Record
        The site's folder, and the manifest's table.
    key, component : str, Component
        What the manifest calls the component, and says of it.
    pieces : sequence of Piece
        Of all files of the record.
    taken : set of int
        Identities of the pieces that other components are; those of this one are added.

    Returns
    -------
    list of Piece
        By time.

    Raises
    ------
    MotionError
        For a key that names no channel, several, or that of another axis.
    """
    place = f"record {record.name!r}, component {component.axis} ({key!r})"
    fitting = [one for one in pieces if key in {one.id, one.channel} or one.file == folder / key]
    if not fitting:
        there = ", ".join(sorted({f"{one.file.name}: {one.id}" for one in pieces})) or "nothing"
        raise refusal(
            folder, place, "is missing", f"name a file, a channel or a channel id of the record; it has {there}"
        )
    file = fitting[0].file
    ids = sorted({one.id for one in fitting})
    if len(ids) > 1:
        raise refusal(
            file, place, f"fits several channels ({', '.join(ids)})", "name the full channel id in components"
        )
    if any(id(one) in taken for one in fitting):
        raise refusal(file, place, "is used for two axes", "name each component's own file or channel")
    taken.update(map(id, fitting))
    return sorted(fitting, key=lambda one: one.start.ns)


def only_piece(record: Record, key: str, component: Component, pieces: Sequence[Piece]) -> Piece:
    """Return the one piece of a channel that is used as a whole.

    Raises
    ------
    MotionError
        Naming the gap between two.
    """
    if len(pieces) > 1:
        first, second = pieces[:2]
        place = f"record {record.name!r}, component {component.axis} ({key!r})"
        wrong = f"has a gap or an overlap after sample {first.samples - 1} (the next piece starts at {second.start})"
        remedy = (
            "use a record without a gap, choose a part by window_s or origin_time, or give files with one unbroken "
        )
        raise refusal(first.file, place, wrong, f"{remedy}trace a channel")
    return pieces[0]


def check_together(rows: Mapping[str, Row], inventory: Any, accept: Mapping[Judgement, str], steps: list[str]) -> None:
    """Refuse components that are not of one earthquake at one instrument, by all that their files say.

    Parameters
    ----------
    rows : mapping of str to (Path, obspy.Trace, str)
        By axis.
    inventory : obspy.Inventory or None
        The StationXML, where there is one.
    accept : mapping of str to str
        The record's table of overruled refusals; this one is `mixed`.
    steps : list of str
        What was done to the record; an accepted refusal is appended.

    Raises
    ------
    MotionError
        Naming both files and what differs.
    """
    first_axis, *others = rows
    file, trace, key = rows[first_axis]
    known = _facts(trace, inventory)
    for axis in others:
        other, its, its_key = rows[axis]
        said = _facts(its, inventory)
        one_event = _one_earthquake(known, said)
        if one_event and (
            told := [w for w in _OF_EVENTS if w in known and w in said and not _same(w, known[w], said[w])]
        ):
            differ = ", ".join(f"{what} {_told(known[what])} and {_told(said[what])}" for what in told)
            steps.append(f"{file.name} and {other.name} tell one earthquake in two ways: {differ}")
        for what, value in said.items():
            if what in known and not (one_event and what in _OF_EVENTS) and not _same(what, known[what], value):
                wrong = (
                    f"{file.name} ({key}) and {other.name} ({its_key}) do not belong together: {what} "
                    f"{_told(known[what])} and {_told(value)}"
                )
                remedy = "give components of one earthquake at one instrument"
                judged(accept, "mixed", file, f"components {first_axis} and {axis}", wrong, remedy, steps)


def check_common(rows: Mapping[str, Row], accept: Mapping[Judgement, str], steps: list[str]) -> None:
    """Refuse components of which less than COMMON of the longest is common to all.

    Parameters
    ----------
    rows, accept, steps : mapping, mapping, list of str
        As of `check_together`.

    Raises
    ------
    MotionError
        Naming both files and their times.
    """
    traces = [trace for _, trace, _ in rows.values()]
    shared = min(t.stats.endtime for t in traces) - max(t.stats.starttime for t in traces)
    longest = max((axis for axis in rows), key=lambda axis: rows[axis][1].stats.npts * rows[axis][1].stats.delta)
    lasts = (rows[longest][1].stats.npts - 1) * rows[longest][1].stats.delta
    if 0.0 < shared < COMMON * lasts:
        other = max(
            (axis for axis in rows if axis != longest),
            key=lambda axis: max(
                rows[axis][1].stats.starttime - rows[longest][1].stats.starttime,
                rows[longest][1].stats.endtime - rows[axis][1].stats.endtime,
            ),
        )
        files = [f"{rows[axis][0].name} ({rows[axis][2]})" for axis in (longest, other)]
        spans = [f"{rows[axis][1].stats.starttime} to {rows[axis][1].stats.endtime}" for axis in (longest, other)]
        wrong = (
            f"{' and '.join(files)} do not belong together: {' and '.join(spans)}, of which all components have only "
            f"{shared:g} s in common"
        )
        remedy = "give components of one earthquake, or choose what they have in common by window_s"
        judged(accept, "mixed", rows[longest][0], f"components {longest} and {other}", wrong, remedy, steps)


def _facts(trace: Any, inventory: Any) -> dict[str, Any]:
    """What a file, or the StationXML, says of the earthquake and of the instrument; nothing that it does not say."""
    s = trace.stats
    said = s.get("kouros", {})
    facts: dict[str, Any] = {"network": s.network, "station": s.station}
    # Kouros's readers number the channels of one instrument in the place of the location code, as agencies do.
    if "kouros" not in s:
        facts["location code"] = s.location or "--"
        if _SEED.fullmatch(s.channel):
            facts["band and instrument code"] = s.channel[:2]
    if sensor := _KIKNET.fullmatch(s.channel):
        facts["sensor"] = _SENSORS[sensor[1]]
    if said.get("start") == "earthquake":
        facts["earthquake of"] = s.starttime
    # A title of PEER ends in the component's own direction.
    facts["title"] = " ".join(str(said.get("title", "")).rpartition(",")[0].split())
    for name, what in _KOUROS.items():
        facts[what] = said.get(name, facts.get(what, ""))
    facts |= _of_knet(s.get("knet", {})) | _of_sac(s)
    if inventory is not None:
        facts |= _of_station(trace, inventory)
    return {what: value for what, value in facts.items() if value is not None and not _is_blank(value)}


_TIME, _PLACE = "earthquake of", ("epicentre's latitude", "epicentre's longitude")
_OF_EVENTS = (_TIME, *_PLACE, "earthquake", "magnitude")
"""Facts that are of the earthquake."""


def _one_earthquake(known: Mapping[str, Any], said: Mapping[str, Any]) -> bool:
    """Whether two headers tell one earthquake by its time, and its place where both know it; whatever they call it."""
    if not all(_TIME in facts for facts in (known, said)):
        return False
    if abs(known[_TIME] - said[_TIME]) > ONE_EVENT:
        return False
    if not all(part in facts for part in _PLACE for facts in (known, said)):
        return True
    from obspy.geodetics import gps2dist_azimuth

    places = [float(facts[part]) for facts in (known, said) for part in _PLACE]
    if not all(abs(value) <= most for value, most in zip(places, (90.0, 360.0) * 2, strict=True)):
        return False
    return float(gps2dist_azimuth(*places)[0]) <= 1000.0 * ONE_PLACE


_KOUROS = {
    "event_time": "earthquake of", "event_latitude": "epicentre's latitude", "event_longitude": "epicentre's longitude",
    "event_name": "earthquake", "station_name": "station name", "latitude": "station's latitude",
    "longitude": "station's longitude", "sensor_depth": "sensor depth", "sensor_place": "sensor's place",
}  # fmt: skip
"""What `header_facts.about` calls a fact, and a refusal."""


def _is_blank(value: Any) -> bool:
    return isinstance(value, str) and not value


def _of_knet(knet: Any) -> dict[str, Any]:
    names = {
        "evot": "earthquake of", "evla": "epicentre's latitude", "evlo": "epicentre's longitude", "mag": "magnitude",
        "stla": "station's latitude", "stlo": "station's longitude", "stel": "sensor's height",
    }  # fmt: skip
    return {what: knet[name] for name, what in names.items() if name in knet}


def _of_sac(stats: Any) -> dict[str, Any]:
    sac = stats.get("sac", {})
    names = {
        "kevnm": "earthquake", "evla": "epicentre's latitude", "evlo": "epicentre's longitude",
        "stla": "station's latitude", "stlo": "station's longitude", "stdp": "sensor's depth",
    }  # fmt: skip
    facts = {what: sac[name] for name, what in names.items() if name in sac}
    if "kevnm" in sac:
        facts["earthquake"] = str(sac["kevnm"]).strip()
    # Times of SAC count from the reference, as that of the first sample (b) does.
    if "o" in sac and "b" in sac:
        facts["earthquake of"] = stats.starttime + (float(sac["o"]) - float(sac["b"]))
    return {what: value for what, value in facts.items() if value not in (-12345.0, "-12345")}


def _of_station(trace: Any, inventory: Any) -> dict[str, Any]:
    s = trace.stats
    found = inventory.select(
        network=s.network, station=s.station, location=s.location, channel=s.channel, time=s.starttime
    )
    for network in found:
        for station in network:
            for channel in station:
                return {
                    "station's latitude": channel.latitude,
                    "station's longitude": channel.longitude,
                    "sensor's depth": channel.depth,
                }
    return {}


def _same(what: str, one: Any, other: Any) -> bool:
    if isinstance(one, str) or isinstance(other, str):
        return " ".join(str(one).split()).casefold() == " ".join(str(other).split()).casefold()
    # Times in s, depths and heights in m, places in degrees.
    if hasattr(one, "timestamp") or what.endswith(("depth", "height")):
        return bool(abs(one - other) <= 1.0)
    return abs(float(one) - float(other)) <= NEAR


def _told(value: Any) -> str:
    return repr(value[:60]) if isinstance(value, str) else f"{value}" if hasattr(value, "timestamp") else f"{value:g}"


def aligned(rows: Mapping[str, Row], steps: list[str]) -> tuple[Array, float, dict[str, int]]:
    """Return the common span of components as one array.

    Parameters
    ----------
    rows : mapping of str to (Path, obspy.Trace, str)
        By axis, "x" among them, in m/s2.
    steps : list of str
        What was done to the record; what was cut off is appended.

    Returns
    -------
    array, shape (3, n)
        In m/s2, rows x, y, z; zero where there is none.
    float
        Time step in s.
    dict of str to int
        By axis, the first sample of the span.

    Raises
    ------
    MotionError
        For different time steps, and for components without a common time.
    """
    dt = rows["x"][1].stats.delta
    for axis, (file, trace, key) in rows.items():
        if abs(trace.stats.delta - dt) > 1e-6 * dt:
            wrong = f"has a time step of {trace.stats.delta:g} s, component x of {dt:g} s"
            raise refusal(file, f"component {axis} ({key!r})", wrong, "use three components of one time step")
    latest = max(trace.stats.starttime for _, trace, _ in rows.values())
    late = {axis: (latest - trace.stats.starttime) / dt for axis, (_, trace, _) in rows.items()}
    first = {axis: round(samples) for axis, samples in late.items()}
    n = min(trace.stats.npts - first[axis] for axis, (_, trace, _) in rows.items())
    if n < 2:
        begins = ", ".join(f"{file.name} ({key}) from {t.stats.starttime}" for file, t, key in rows.values())
        wrong = f"have no common time: {begins}"
        raise refusal(rows["x"][0], "components x, y, z", wrong, "use components of one event")
    cuts = {axis: (first[axis], trace.stats.npts - first[axis] - n) for axis, (_, trace, _) in rows.items()}
    if any(any(cut) for cut in cuts.values()):
        told = ", ".join(f"{axis} {a} at the start and {b} at the end" for axis, (a, b) in sorted(cuts.items()))
        steps.append(f"cut to the common span from {latest} ({n} samples); samples dropped: {told}")
    skew = max(abs(late[axis] - first[axis]) for axis in rows) * dt
    if skew > 1e-3 * dt:
        steps.append(f"aligned to the nearest sample; the components' clocks differ by up to {skew:.3g} s")
    # A vertical that was not recorded is none.
    data = np.zeros((3, n))
    for axis, (_, trace, _) in rows.items():
        data["xyz".index(axis)] = trace.data[first[axis] : first[axis] + n]
    return data, float(dt), first
