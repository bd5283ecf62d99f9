"""What StationXML and the headers of traces say of a channel: depth, direction, and whether its response is known."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from math import isfinite
from typing import Any

from pipeline.motions.formats import unit_words
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


def _response(inventory: Any, trace: Any) -> Any:
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            return inventory.get_response(trace.id, trace.stats.starttime)
    except Exception:  # noqa: BLE001 - obspy raises a bare Exception for what it does not know
        return None


def has_response(inventory: Any, trace: Any) -> bool:
    """Whether an inventory brings a channel's counts to m/s2 at its time: by its response, or by `sensitivity`."""
    response = _response(inventory, trace)
    return bool(response and (response.response_stages or sensitivity(inventory, trace)))


def sensitivity(inventory: Any, trace: Any) -> float | None:
    """Return the counts of one m/s2 of an accelerometer of which an inventory has no more than that (level=channel).

    Parameters
    ----------
    inventory : obspy.Inventory
        Of a StationXML.
    trace : obspy.Trace
        Of the channel.

    Returns
    -------
    float or None
        None where it has the response, or knows no such number of an acceleration.
    """
    response = _response(inventory, trace)
    whole = response and not response.response_stages and response.instrument_sensitivity
    if not whole or unit_words.unit_of(str(whole.input_units or "")) != ("acceleration", "m/s2"):
        return None
    return float(whole.value) if whole.value and isfinite(whole.value) else None


def sac_direction(trace: Any) -> tuple[float | None, float | None]:
    """Return dip (down from the horizontal) and azimuth in degrees by the header of a SAC file; None where it has none.

    Its inclination counts from the upward vertical.
    """
    said = trace.stats.get("sac", {})
    if "cmpinc" not in said or "cmpaz" not in said:
        return None, None
    return float(said["cmpinc"]) - 90.0, float(said["cmpaz"])
