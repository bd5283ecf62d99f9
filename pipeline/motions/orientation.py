"""Orientation of a record's components: by the manifest, the station's StationXML, or the file's own header."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from pipeline.motions.errors import Judgement, judged, refusal
from pipeline.motions.record import Component

AZIMUTH_TOLERANCE = 2.0
"""Degrees that two statements of an azimuth may differ (the usual care of an installation)."""

DIP_TOLERANCE = 5.0
"""Degrees from the vertical or the horizontal within which SEED calls a channel so (manual 2.4, appendix A)."""


def by_station(
    file: Path,
    key: str,
    component: Component,
    trace: Any,
    inventory: Any,
    accept: Mapping[Judgement, str],
    steps: list[str],
) -> float | str | None:
    """Return how a channel is oriented by its station's StationXML, checked against the manifest.

    Parameters
    ----------
    file : Path
        The StationXML.
    key : str
        What the manifest calls the channel.
    component : Component
        What the manifest says of it.
    trace : obspy.Trace
        The samples, of whose time the channel's epoch is looked up.
    inventory : obspy.Inventory
        The StationXML.
    accept : mapping of str to str
        The record's table of overruled refusals.
    steps : list of str
        What was done to the record; an accepted refusal is appended.

    Returns
    -------
    float, str or None
        Degrees clockwise from north, "up" or "down"; None where it does not say.

    Raises
    ------
    MotionError
        For a channel or a time of which it says nothing, or different things; and, unless accepted as `orientation`,
        for a channel that is neither vertical nor horizontal within DIP_TOLERANCE or is oriented otherwise than the
        manifest says.
    """
    place = f"component {component.axis} ({key!r})"
    s = trace.stats
    found = inventory.select(
        network=s.network, station=s.station, location=s.location, channel=s.channel, time=s.starttime
    )
    said = {(c.azimuth, c.dip) for network in found for station in network for c in station}
    if not said:
        wrong = f"says nothing about {trace.id} at {s.starttime}"
        raise refusal(file, place, wrong, "name the StationXML of this channel and time")
    if len(said) > 1:
        told = " and ".join(sorted(f"azimuth {a}, dip {d}" for a, d in said))
        wrong = f"says different things about {trace.id} at {s.starttime}: {told}"
        raise refusal(file, place, wrong, "drop the epoch that does not hold then")
    ((azimuth, dip),) = said
    remedy = "find out which is right and mend the manifest's orientation"
    meant = component.orientation
    level = dip is None or abs(dip) <= DIP_TOLERANCE
    upright = dip is not None and abs(abs(dip) - 90.0) <= DIP_TOLERANCE
    if not (level or upright) or (dip is not None and upright != (component.axis == "z")):
        wrong = f"the StationXML gives it a dip of {dip:g} degrees, which is no component {component.axis}"
        judged(accept, "orientation", file, place, wrong, remedy, steps)
        return None
    if component.axis == "z":
        own: float | str | None = None if dip is None else "up" if dip < 0.0 else "down"
        agrees = None in {own, meant} or own == meant
    else:
        own = None if azimuth is None else float(azimuth) % 360.0
        agrees = own is None or meant is None or apart(float(own), float(meant)) <= AZIMUTH_TOLERANCE
    if not agrees:
        wrong = f"the manifest orients it {meant}, the StationXML {own}"
        judged(accept, "orientation", file, place, wrong, remedy, steps)
    return own


def apart(one: float, other: float) -> float:
    """Return the angle between two azimuths in degrees, 0 to 180."""
    return abs((one - other + 180.0) % 360.0 - 180.0)


def oriented(
    file: Path,
    key: str,
    axis: str,
    manifest: float | str | None,
    station: float | str | None,
    header: Any,
    steps: list[str],
) -> float | str:
    """Return the orientation of a channel: the manifest's, where it is silent the StationXML's, else the file's own.

    Parameters
    ----------
    file : Path
        The record file.
    key, axis : str
        What the manifest calls the channel, and its axis.
    manifest, station, header : float, str or None
        What each of them says; None for nothing, the header also words that are none.
    steps : list of str
        What was done to the record; who said it, and who was overruled, is appended.

    Returns
    -------
    float or str
        Degrees clockwise from north, "up" or "down".

    Raises
    ------
    MotionError
        Where nobody says it, or where the file's header makes it a channel of another axis.
    """
    known = header in {"up", "down"} if axis == "z" else isinstance(header, float)
    place = f"component {axis} ({key!r})"
    if manifest is None and station is None:
        if not known:
            needed = "up or down" if axis == "z" else "an azimuth"
            wrong = f"its orientation is not known: the file says {header!r}, and not {needed}"
            raise refusal(file, place, wrong, "give orientation in the manifest")
        steps.append(f"{key}: orientation {header}, by the file")
        return header if isinstance(header, str) else float(header)
    vertical = header in {"up", "down"}
    if vertical != (axis == "z") and (vertical or isinstance(header, float)):
        wrong = f"the file says that it is oriented {header!r}, which is no component {axis}"
        raise refusal(file, place, wrong, "name the right channel in components")
    who, chosen = ("the StationXML", station) if manifest is None else ("the manifest", manifest)
    others = {"the file": header if known else None} | ({} if manifest is None else {"the StationXML": station})
    if manifest is None:
        steps.append(f"{key}: orientation {station}, by the StationXML")
    for whose, said in others.items():
        if said is not None and _differs(said, chosen):
            steps.append(f"{key}: {who}'s orientation {chosen} overrules {whose}'s {said}")
    return chosen if isinstance(chosen, str) else float(chosen)  # type: ignore[arg-type]


def _differs(one: Any, other: Any) -> bool:
    if isinstance(one, str) or isinstance(other, str):
        return bool(one != other)
    return apart(float(one), float(other)) > AZIMUTH_TOLERANCE
