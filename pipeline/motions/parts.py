"""Parts of files: what lies in them, piece by piece, and the samples of a window, read without the rest."""

from __future__ import annotations

import io
import re
import warnings
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.errors import InputError
from pipeline.motions.errors import MotionError, refusal
from pipeline.motions.filtering import pad_seconds
from pipeline.motions.formats.trace_headers import Series
from pipeline.motions.record import Record
from pipeline.motions.responses import load_obspy

MARGIN = pad_seconds(0.02)
"""Seconds of the record that are read on both sides of a window, as far as they are there: the pads of a high-pass of
0.02 Hz, so that filters and the removal of a response see the record itself around the window and not zeros."""

LARGEST = 256 << 20
"""Bytes of a file that is read as a whole; three components of an hour at 1,000 samples a second have 90 MB as text."""

CHUNK = 4 << 20
"""Bytes of MiniSEED that are looked at at once; what a file of any size takes of memory."""

LARGEST_CONTINUOUS = 16 << 30
"""Bytes of a MiniSEED file of which a part is read; three components of a month at 200 samples/s have 12 as doubles."""

MOST_PIECES = 10_000
"""Pieces of a file; a week of an instrument that is interrupted every ten minutes has 3,000 in three channels."""

_RECORD = re.compile(rb"\d{6}[DRQM][ \0]")


@dataclass(frozen=True, eq=False)
class Piece:
    """Samples of a channel without a gap, in a file.

    Attributes
    ----------
    file : Path
        Where they lie.
    id, channel : str
        Network.station.location.channel, and the last of these.
    start, end : obspy.UTCDateTime
        Of the first and of the last sample.
    samples : int
        How many.
    dt : float
        Time step in s.
    trace : obspy.Trace or None
        The samples, where the file was read as a whole.
    chunks : tuple of (int, int, obspy.UTCDateTime, obspy.UTCDateTime)
        First byte and number of bytes of each part of the file that holds some, and of which time.
    """

    file: Path
    id: str
    channel: str
    start: Any
    end: Any
    samples: int
    dt: float
    trace: Any = None
    chunks: tuple[tuple[int, int, Any, Any], ...] = ()

    def between(self, start: Any, end: Any) -> Any:
        """Return the samples between two times, both included, as a trace.

        Parameters
        ----------
        start, end : obspy.UTCDateTime
            The times; what lies outside of the piece is left out.

        Returns
        -------
        obspy.Trace
            The whole trace itself, where the piece lies between them; else a copy of the part.

        Raises
        ------
        MotionError
            Naming a file whose records do not fit together.
        """
        trace = self.trace if self.trace is not None else _read(self, start, end)
        return sliced(trace, *samples_between(trace, start, end))


def whole(file: Path, trace: Any) -> Piece:
    """Return the piece that a trace is which was read as a whole."""
    s = trace.stats
    return Piece(file, trace.id, s.channel, s.starttime, s.endtime, s.npts, s.delta, trace)


def is_continuous(file: Path) -> bool:
    """Whether a file begins as MiniSEED does, of which a part can be read."""
    with file.open("rb") as stream:
        return _RECORD.match(stream.read(8)) is not None


def scan(file: Path) -> list[Piece]:
    """Return the pieces of a MiniSEED file from the headers of its records, no sample unpacked.

    Parameters
    ----------
    file : Path
        The file.

    Returns
    -------
    list of Piece
        By channel and time.

    Raises
    ------
    MotionError
        Naming a file that is damaged, cut off, too large, or of more pieces than MOST_PIECES.

    Notes
    -----
    Memory: that of CHUNK bytes and of the pieces, whatever the size of the file.
    """
    size = file.stat().st_size
    if size > LARGEST_CONTINUOUS:
        wrong = f"{size:,} bytes are more than is looked through ({LARGEST_CONTINUOUS:,} at most)"
        raise refusal(file, "file", wrong, "cut it into days")
    try:
        found = _scanned(file, size, CHUNK)
    except MotionError:
        # Records of several lengths do not end where chunks do.
        if not CHUNK < size <= LARGEST:
            raise
        found = _scanned(file, size, size)
    return [piece for name in sorted(found) for piece in _joined(found[name])]


def _scanned(file: Path, size: int, step: int) -> dict[str, list[Piece]]:
    found: dict[str, list[Piece]] = {}
    for at, count, stream in _chunks(file, size, step):
        for trace in stream:
            s = trace.stats
            if s.npts > 0 and s.delta > 0.0:
                piece = Piece(file, trace.id, s.channel, s.starttime, s.endtime, s.npts, s.delta)
                of = found.setdefault(trace.id, [])
                of.append(replace(piece, chunks=((at, count, s.starttime, s.endtime),)))
        if sum(map(len, found.values())) > MOST_PIECES:
            found = {name: _joined(pieces) for name, pieces in found.items()}
        if sum(map(len, found.values())) > MOST_PIECES:
            wrong = f"is in more than {MOST_PIECES:,} pieces"
            raise refusal(file, "file", wrong, "cut out the earthquake, or fetch it again")
    return found


def _chunks(file: Path, size: int, step: int) -> Iterator[tuple[int, int, Any]]:
    """The headers of a file, with the bytes that they are of."""
    with file.open("rb") as stream:
        for at in range(0, size, step):
            raw = stream.read(step)
            headers = _unpacked(file, raw, at, headonly=True)
            if at == 0:
                length = max((trace.stats.mseed.record_length for trace in headers), default=512)
                check_whole(file, size, length)
            yield at, len(raw), headers


def check_whole(file: Path, size: int, length: int) -> None:
    """Refuse a MiniSEED file that ends within a record.

    Parameters
    ----------
    file : Path
        The file.
    size, length : int
        Bytes of it, and of each of its records.

    Raises
    ------
    MotionError
        Naming it.
    """
    if size % length:
        wrong = f"is cut off: {size} bytes are not a whole number of records of {length} bytes"
        raise refusal(file, "file", wrong, "fetch it again")


def _unpacked(file: Path, raw: bytes, at: int, **how: Any) -> Any:
    obspy = load_obspy()
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            stream = obspy.read(io.BytesIO(raw), format="MSEED", **how)
        except Exception as error:  # on a broken file obspy's readers raise anything
            wrong = f"cannot be read after byte {at:,} ({type(error).__name__}: {str(error)[:200]})"
            raise refusal(file, "file", wrong, "it is cut off or damaged; fetch it again") from error
    for warning in caught:
        if issubclass(warning.category, obspy.io.mseed.InternalMSEEDWarning):
            wrong = f"is cut off or damaged after byte {at:,} ({str(warning.message)[:200]})"
            raise refusal(file, "file", wrong, "fetch it again")
    return stream


def _joined(pieces: Sequence[Piece]) -> list[Piece]:
    """Pieces of one channel by time, those that follow each other within half a sample as one."""
    out: list[Piece] = []
    for piece in sorted(pieces, key=lambda one: (one.start.ns, one.end.ns)):
        last = out[-1] if out else None
        if last is not None and last.dt == piece.dt and abs((piece.start - last.end) / piece.dt - 1.0) < 0.5:
            chunks = (*last.chunks, *piece.chunks)
            out[-1] = replace(last, end=piece.end, samples=last.samples + piece.samples, chunks=chunks)
        else:
            out.append(piece)
    return out


def _read(piece: Piece, start: Any, end: Any) -> Any:
    obspy = load_obspy()
    stream = obspy.Stream()
    # A sample more on both sides: which of them belong is decided by their own times.
    first, last = max(start, piece.start) - piece.dt, min(end, piece.end) + piece.dt
    with piece.file.open("rb") as file:
        for at, count in sorted({(at, n) for at, n, begins, ends in piece.chunks if begins <= last and ends >= first}):
            file.seek(at)
            part = _unpacked(piece.file, file.read(count), at, starttime=first, endtime=last)
            stream += obspy.Stream(trace for trace in part if trace.id == piece.id and trace.stats.npts)
    wrong = "has samples that do not follow each other"
    try:
        stream.merge(method=-1)
    except Exception as error:  # obspy raises a bare Exception for pieces that do not belong together
        raise refusal(piece.file, piece.id, f"{wrong} ({error})", "fetch it again") from error
    if len(stream) != 1:
        told = f"{wrong} between {first} and {last} ({len(stream)} pieces)"
        raise refusal(piece.file, piece.id, told, "choose a window without a gap, or fetch it again")
    return stream[0]


def samples_between(trace: Any, start: Any, end: Any) -> tuple[int, int]:
    """Return the samples of a trace that are not before one time and not after another.

    Parameters
    ----------
    trace : obspy.Trace
        With its start and step.
    start, end : obspy.UTCDateTime
        The times.

    Returns
    -------
    (int, int)
        As of a slice; a millionth of a step is no difference.
    """
    s = trace.stats
    first = int(np.ceil((start - s.starttime) / s.delta - 1e-6))
    last = int(np.floor((end - s.starttime) / s.delta + 1e-6))
    return min(max(first, 0), s.npts), max(min(last + 1, s.npts), 0)


def sliced(trace: Any, first: int, after: int) -> Any:
    """Return samples of a trace as a trace, with the series in its header; itself where it is all of them.

    Parameters
    ----------
    trace : obspy.Trace
        The samples.
    first, after : int
        As of a slice.

    Returns
    -------
    obspy.Trace
    """
    if (first, after) == (0, trace.stats.npts):
        return trace
    obspy = load_obspy()
    stats = trace.stats.copy()
    for name, value in list(stats.get("kouros", {}).items()):
        if isinstance(value, Series):
            stats.kouros[name] = Series(value.values[first:after])
    stats.starttime = trace.stats.starttime + first * trace.stats.delta
    data = trace.data[first:after].copy()
    stats.npts = len(data)
    return obspy.Trace(data, stats)


@dataclass(frozen=True)
class Part:
    """The part of a record that is asked for.

    Attributes
    ----------
    zero : obspy.UTCDateTime
        From which `window_s` counts.
    start, end : obspy.UTCDateTime
        Of the window.
    lead, tail : float
        Seconds that are read before and after it, where they are there.
    """

    zero: Any
    start: Any
    end: Any
    lead: float
    tail: float

    def read(self, piece: Piece) -> Any:
        """Return the samples of a piece that holds the window, with those around it as far as they are numbers."""
        trace = piece.between(self.start - self.lead, self.end + self.tail)
        data = trace.data
        if np.ma.is_masked(data) or not np.issubdtype(np.asarray(data).dtype, np.floating):
            return trace
        a, b = self.inside(trace)
        bad = np.flatnonzero(~np.isfinite(data))
        before, after = bad[bad < a], bad[bad >= b]
        first = int(before[-1]) + 1 if before.size else 0
        return sliced(trace, first, int(after[0]) if after.size else len(data))

    def inside(self, trace: Any) -> tuple[int, int]:
        """Return the samples of a trace that are those of the window, as of a slice; half a step is no difference."""
        half = 0.5 * trace.stats.delta
        return samples_between(trace, self.start - half, self.end + half)


def zero_of(record: Record, channels: Sequence[Sequence[Piece]]) -> Any:
    """Return from which time a record's `window_s` counts: its origin time, or else the first common sample.

    Parameters
    ----------
    record : Record
        The manifest's table.
    channels : sequence of sequence of Piece
        Of each component, by time.

    Returns
    -------
    obspy.UTCDateTime

    Raises
    ------
    InputError
        For an origin time where a file does not say when it was recorded.
    """
    if record.origin_time is None:
        return max(pieces[0].start for pieces in channels)
    for pieces in channels:
        said = {} if pieces[0].trace is None else pieces[0].trace.stats.get("kouros", {})
        if said.get("start", "record") != "record":
            raise InputError(
                f"origin_time: {pieces[0].file.name} does not say when its first sample was recorded; choose the part "
                "by window_s alone, in s from the first sample"
            )
    return load_obspy().UTCDateTime(record.origin_time)


def part_of(record: Record, zero: Any, window: tuple[float, float], channels: Sequence[Sequence[Piece]]) -> Part:
    """Return the part of a record that a window asks for.

    Parameters
    ----------
    record : Record
        The manifest's table.
    zero : obspy.UTCDateTime
        From which the window counts.
    window : (float, float)
        Its start and end in s.
    channels : sequence of sequence of Piece
        Of each component, by time.

    Returns
    -------
    Part

    Raises
    ------
    InputError
        For a window that begins before the record or ends after it.

    Notes
    -----
    Noise before the event (`pre_event_s`) is counted from the first sample that is read: where the record begins more
    than MARGIN before the window, that is the window's first.
    """
    start, end = zero + window[0], zero + window[1]
    slack = 0.5 * max(pieces[0].dt for pieces in channels)
    if end - start < slack:
        raise InputError(f"window_s [{window[0]:g}, {window[1]:g}] holds fewer than two samples; widen it")
    first, last = max(pieces[0].start for pieces in channels), min(pieces[-1].end for pieces in channels)
    if end > last + slack:
        raise InputError(f"window_s ends at {window[1]:g} s, after the record's end at {last - zero:g} s; shorten it")
    if start < first - slack:
        raise InputError(
            f"window_s begins at {window[0]:g} s, before the record's first sample at {first - zero:g} s; shorten it"
        )
    far = record.pre_event_s is not None and start - first > MARGIN
    return Part(zero, start, end, 0.0 if far else MARGIN, MARGIN)


def holding(part: Part, pieces: Sequence[Piece], place: str) -> Piece:
    """Return the piece of a channel that holds a window.

    Parameters
    ----------
    part : Part
        The window.
    pieces : sequence of Piece
        Of the channel, by time.
    place : str
        What a message calls the channel.

    Returns
    -------
    Piece

    Raises
    ------
    MotionError
        Naming the gap, or the overlap, that lies inside of the window.
    """
    touching = [one for one in pieces if one.end >= part.start - 0.5 * one.dt and one.start <= part.end + 0.5 * one.dt]
    remedy = "choose a window without a gap, or files with one unbroken trace a channel"
    if not touching:
        later = next((str(one.start) for one in pieces if one.start > part.end), "none")
        wrong = f"has no samples between {part.start} and {part.end} (the next piece starts at {later})"
        raise refusal(pieces[0].file, place, wrong, remedy)
    if len(touching) > 1:
        one, other = touching[:2]
        wrong = f"has a gap or an overlap in the window, after {one.end} (the next piece starts at {other.start})"
        raise refusal(one.file, place, wrong, remedy)
    (only,) = touching
    begins, ends = only.start > part.start + 0.5 * only.dt, only.end < part.end - 0.5 * only.dt
    if begins or ends:
        wrong = f"has a gap in the window, {'before ' + str(only.start) if begins else 'after ' + str(only.end)}"
        raise refusal(only.file, place, wrong, remedy)
    return only
