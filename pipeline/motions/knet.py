"""What obspy's reader of K-NET and KiK-net leaves out: whole or cut off, orientation, unit, raw."""

from __future__ import annotations

import glob
import re
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.motions.errors import refusal
from pipeline.motions.formats import columns
from pipeline.motions.formats.trace_headers import PEAK_TOLERANCE, Orientation
from pipeline.motions.responses import load_obspy
from pipeline.motions.unknown import unknown

_DIRECTIONS: dict[str, Orientation] = {"NS": 0.0, "EW": 90.0, "UD": "up"}
_GAL = 0.01
_KNET = re.compile(rb"(?:\xef\xbb\xbf)?\s*origin time.{0,1500}\bscale factor\s+\d", re.IGNORECASE | re.DOTALL)


def really(file: Path, stream: Any) -> Any:
    """Return a file's traces, read by the head in words that it has where obspy takes that for one of K-NET.

    obspy goes by the first words, "Origin Time", which others write as well.

    Parameters
    ----------
    file : Path
        The record file.
    stream : obspy.Stream
        As obspy read it.

    Returns
    -------
    obspy.Stream

    Raises
    ------
    MotionError
        Of a file that is none of K-NET, and says too little.
    """
    if stream and stream[0].stats._format == "MOTION_COLUMNS":
        with file.open("rb") as text:
            first = text.read(2000)
        if _KNET.match(first):
            wrong = "has a header of K-NET that does not begin with 'Origin Time': a mark, blanks or other letters do"
            raise refusal(file, "file", wrong, "delete what stands before it, or fetch the file again")
    if not stream or stream[0].stats._format != "KNET" or "knet" in stream[0].stats:
        return stream
    with file.open("rb") as text:
        if b"Scale Factor" in text.read(2000):
            return stream
    if columns.is_format(str(file)):
        # Its plugin, by name: a reader called by itself leaves the traces without their format.
        return load_obspy().read(glob.escape(str(file)), format="MOTION_COLUMNS", check_compression=False)
    raise columns.refused(str(file)) or unknown(file)


def complete(file: Path, stream: Any) -> None:
    """Refuse a K-NET or KiK-net file that contradicts itself, and give its trace the header of Kouros's own readers.

    Parameters
    ----------
    file : Path
        The record file.
    stream : obspy.Stream
        As obspy read it; what is of another format stays as it is.  "NS1" is the instrument in the borehole, "NS2" the
        one at the surface; that of a borehole is not turned to the north as well as it is named.

    Raises
    ------
    MotionError
        Naming the file, where it holds fewer or more samples than its header announces, or has another peak.
    """
    from obspy.core import AttribDict

    for trace in stream:
        if trace.stats._format != "KNET":
            continue
        if "knet" not in trace.stats:
            wrong = "has no header of K-NET that can be read: its lines end by carriage returns alone, or are missing"
            raise refusal(file, "file", wrong, "fetch it again")
        said, factor = trace.stats.knet, float(trace.stats.calib)
        announced, found = round(said.duration * trace.stats.sampling_rate), trace.stats.npts
        if found != announced:
            wrong = f"is cut off or damaged: it announces {announced} samples and holds {found}"
            raise refusal(file, "file", wrong, "fetch it again")
        size = float(np.abs(trace.data - np.mean(trace.data)).max()) * factor
        peak = _GAL * float(said.accmax)
        # Written so that what is no number is refused as well.
        if not abs(size - peak) <= PEAK_TOLERANCE * peak + 0.001 * _GAL:
            wrong = f"announces a peak of {peak:.4g} m/s2, and its samples have {size:.4g} m/s2"
            raise refusal(file, "file", wrong, "it is damaged: fetch it again")
        below = trace.stats.channel.endswith("1")
        trace.stats.kouros = AttribDict(
            units="counts",
            si_factor=factor,
            orientation=_DIRECTIONS.get(trace.stats.channel[:2]),
            processed=False,
            format="KiK-net" if trace.stats.channel[-1] in "12" else "K-NET",
            file=str(file),
            start="record",
            peak=AttribDict(acceleration=peak, velocity=None, displacement=None),
            **({"notes": "in the borehole: it may not point where it is named for"} if below else {}),
        )
