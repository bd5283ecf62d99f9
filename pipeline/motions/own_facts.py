"""What the header of a trace says of its earthquake and its station, as tables of a manifest."""

from __future__ import annotations

from datetime import UTC
from typing import Any

from pydantic import ValidationError

from pipeline.motions.errors import MotionError
from pipeline.motions.record import EventTable, StationTable
from pipeline.motions.safe_names import one_line

_OF_EVENTS = {
    "event_name": "name", "event_time": "time", "event_latitude": "latitude", "event_longitude": "longitude",
    "event_depth_km": "depth_km", "magnitude": "magnitude", "magnitude_type": "magnitude_type",
}  # fmt: skip
"""What `header_facts.about` calls an earthquake's facts, and a manifest."""


def plain(text: Any) -> str:
    """Return the text of a catalogue or a header without what steers a terminal, in one line."""
    return "" if text is None else one_line(str(text))


def finite(value: Any) -> float | None:
    """Return a value as a finite number, None where it is none."""
    if isinstance(value, bool) or value is None:
        return None
    try:
        found = float(value)
    except (TypeError, ValueError):
        return None
    return found if abs(found) < float("inf") else None


def own_event(trace: Any) -> EventTable | None:
    """Return the earthquake that a trace's header names, None where it names none.

    Parameters
    ----------
    trace : obspy.Trace

    Returns
    -------
    EventTable or None
    """
    said = trace.stats.get("knet")
    if said is not None:
        time = said.evot.datetime.replace(tzinfo=UTC)
        depth, size = finite(said.evdp), finite(said.mag)
        found = {"time": time, "latitude": said.evla, "longitude": said.evlo, "depth_km": depth, "magnitude": size}
    elif any(key in trace.stats.get("kouros", {}) for key in _OF_EVENTS):
        said = trace.stats.kouros
        found = {ours: said.get(its) for its, ours in _OF_EVENTS.items()}
        found["name"] = plain(found["name"]) or None
        if found["time"] is not None:
            found["time"] = found["time"].datetime.replace(tzinfo=UTC)
    else:
        said = trace.stats.get("sac")
        if said is None or "evla" not in said or "evlo" not in said:
            return None
        found = {"latitude": finite(said.evla), "longitude": finite(said.evlo), "magnitude": finite(said.get("mag"))}
    try:
        return EventTable(**{key: value for key, value in found.items() if value is not None})
    except (ValidationError, MotionError):
        return None


def own_station(trace: Any) -> StationTable | None:
    """Return the station that a trace's header names, with its place where the header has one.

    Parameters
    ----------
    trace : obspy.Trace

    Returns
    -------
    StationTable or None
        None where the file names no station.
    """
    stats = trace.stats
    place = stats.get("knet") or stats.get("sac") or {}
    said_here = stats.get("kouros", {})
    name = plain(said_here.get("station_name", ""))
    said: dict[str, Any] = {
        "code": plain(f"{stats.network}.{stats.station}".strip(".")),
        "name": name,
        "latitude": finite(place.get("stla", said_here.get("latitude"))),
        "longitude": finite(place.get("stlo", said_here.get("longitude"))),
    }
    try:
        made = StationTable(**{key: value for key, value in said.items() if value not in {None, ""}})
    except ValidationError:
        return None
    return made if made.code or made.name else None
