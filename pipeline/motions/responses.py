"""Instrument responses from StationXML, and obspy itself."""

from __future__ import annotations

import glob
import warnings
from functools import cache
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from pipeline.motions.errors import MotionError, refusal


@cache
def load_obspy() -> Any:
    """Return obspy, with its reader of MiniSEED; imported on demand, as it takes a second."""
    with warnings.catch_warnings():
        # How obspy looks up its plugins is deprecated on some versions of Python; that is no news about a record.
        warnings.simplefilter("ignore")
        import obspy
        import obspy.io.mseed
    for plugin in obspy.core.util.base.ENTRY_POINTS["waveform"].values():
        # For each file obspy asks every plugin for the name of its package, and Python reads the metadata anew each
        # time: a fifth of what it takes to add a record.
        vars(plugin)["dist"] = SimpleNamespace(name=plugin.dist.name)
    return obspy


def read_inventory(file: Path, steps: list[str]) -> Any:
    """Return the stations of a StationXML.

    Parameters
    ----------
    file : Path
        The file.
    steps : list of str
        What was done to the record; what the reader warned of is appended.

    Returns
    -------
    obspy.Inventory

    Raises
    ------
    MotionError
        Naming a file that is no StationXML.
    """
    obspy = load_obspy()
    try:
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always")
            inventory = obspy.read_inventory(glob.escape(str(file)), format="STATIONXML")
    except Exception as error:  # on a broken file obspy's readers raise anything
        wrong = f"is no StationXML ({type(error).__name__}: {str(error)[:200]})"
        raise refusal(file, "response", wrong, "fetch it again with level=response") from error
    steps += [
        f"{file.name}: the reader warned: {w.message!s:.200}" for w in caught if issubclass(w.category, UserWarning)
    ]
    return inventory


def channels_known(file: Path) -> set[str] | None:
    """Return the channels that a StationXML knows, None for a file that is none.

    Parameters
    ----------
    file : Path
        The file.

    Returns
    -------
    set of str, or None
        Network.station.location.channel of each.
    """
    try:
        return set(read_inventory(file, []).get_contents()["channels"])
    except MotionError:
        return None
