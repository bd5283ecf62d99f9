"""What StationXML and the headers of traces say of a channel: depth, direction, and whether its response is known."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from typing import Any

from pipeline.motions.safe_names import one_line


def metadata(inventories: Iterable[Any], trace: Any) -> Mapping[str, Any] | None:
    """Return what the first inventory that knows a channel at its time says of it, None where none does.

    Parameters
    ----------
    inventories : iterable of obspy.Inventory
        Of StationXML files.
    trace : obspy.Trace
        Of the channel.

    Returns
    -------
    mapping or None
        As obspy's ``get_channel_metadata``: azimuth and dip in degrees, local_depth in m, and more.
    """
    told = (_told(inventory, trace) for inventory in inventories)
    return next((x for x in told if x is not None), None)


def _told(inventory: Any, trace: Any) -> Mapping[str, Any] | None:
    """Return what one inventory says of a channel."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return dict(inventory.get_channel_metadata(trace.id, trace.stats.starttime))
    except Exception:  # noqa: BLE001 - obspy raises a bare Exception for what it does not know
        return None


def depth(inventories: Iterable[Any], trace: Any) -> float | None:
    """Return the depth of a sensor below the ground's surface in m, None where nothing says it."""
    said = metadata(inventories, trace) or {}
    found = said.get("local_depth", trace.stats.get("kouros", {}).get("sensor_depth"))
    return None if found is None else float(found)


def place(trace: Any) -> str:
    """Return where a sensor stood in the words of its file, such as "Deck Level near Abut 1"; "" where it has none."""
    return one_line(str(trace.stats.get("kouros", {}).get("sensor_place", "")))


def has_response(inventory: Any, trace: Any) -> bool:
    """Whether an inventory has the full response of a channel at its time."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return bool(inventory.get_response(trace.id, trace.stats.starttime).response_stages)
    except Exception:  # noqa: BLE001 - obspy raises a bare Exception for what it does not know
        return False


def sac_direction(trace: Any) -> tuple[float | None, float | None]:
    """Return dip (down from the horizontal) and azimuth in degrees by the header of a SAC file; None where it has none.

    Its inclination counts from the upward vertical.
    """
    said = trace.stats.get("sac", {})
    if "cmpinc" not in said or "cmpaz" not in said:
        return None, None
    return float(said["cmpinc"]) - 90.0, float(said["cmpaz"])
