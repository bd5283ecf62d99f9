"""Record files to three aligned components in m/s2, with everything refused that would falsify them."""

from __future__ import annotations

import glob
import logging
import re
import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.motions import knet
from pipeline.motions.doubts import NO_RECORD, SENSITIVITY_ALONE
from pipeline.motions.earthquakes import earthquakes, listed, window_of
from pipeline.motions.errors import MotionError, judged, refusal
from pipeline.motions.filled import filled
from pipeline.motions.formats.trace_headers import channel_code
from pipeline.motions.joining import Row, aligned, channel_of, check_common, check_together, only_piece
from pipeline.motions.orientation import by_station, oriented
from pipeline.motions.own_facts import own_event
from pipeline.motions.parts import (
    LARGEST,
    Part,
    Piece,
    check_whole,
    holding,
    is_continuous,
    part_of,
    scan,
    whole,
    zero_of,
)
from pipeline.motions.plateaus import full_scale
from pipeline.motions.quality import alike, clipped, one_sided, uneven
from pipeline.motions.record import ESTIMATED, NO_VERTICAL, Component, Record
from pipeline.motions.responses import load_obspy, read_inventory
from pipeline.motions.several import tell_earthquakes, tell_renewals
from pipeline.motions.station_metadata import sensitivity
from pipeline.motions.unknown import unknown
from pipeline.quantities import Array, G

logger = logging.getLogger(__name__)

UNITS = {"m/s2": 1.0, "cm/s2": 0.01, "mm/s2": 0.001, "nm/s2": 1e-9, "gal": 0.01, "g": G, "mg": 0.001 * G}
"""Metres per second squared in one of each unit that a manifest may name."""

_SPELLINGS = {"m/s**2": "m/s2", "m/s/s": "m/s2", "m/s^2": "m/s2", "cm/s**2": "cm/s2", "cm/s/s": "cm/s2"}
# obspy's ASCII readers hand on the storage type in the place of the unit where a file was written without one.
_SILENT = {"", "integer", "float", "ascii", "unknown"}

_NAMELESS = {"SEGY", "SU"}
"""Formats whose traces have no names: several in a file are numbered."""

_SAC_KINDS = {6: "a displacement", 7: "a velocity"}

MOST_SAMPLES = 4_000_000
"""Samples of a component that is used as a whole; an hour at 1,000 samples a second has 3.6 million."""

PGA_MOST = 20.0 * G
WATER_LEVEL_DB = 60.0


@dataclass(frozen=True, eq=False)
class Recording:
    """Three components as recorded, aligned, in m/s2.

    Attributes
    ----------
    dt : float
        Time step in s.
    data : array, shape (3, n)
        In m/s2, rows the channels that the manifest calls x, y, z; z positive up, zero where absent.
    azimuths : (float, float)
        Degrees clockwise from north of the first two rows.
    channels : (str, str, str)
        What the files call the three rows.
    steps : tuple of str
        What was read, and done to it, in order.
    processed : bool
        Whether the agency has filtered it already, by the manifest, or else by the files.
    velocity : array, shape (3, n), or None
        In m/s as the agency computed it, with the velocity that the record starts with, of which the acceleration knows
        nothing; None unless all files hold it.
    begins : float
        Time of the first sample in s as the manifest counts it: 0 unless less than the record was read, or it counts
        from an origin time.
    window : (float, float) or None
        What is to be kept of it once it is filtered, in s as the manifest counts; None: all.
    magnitudes : set of float
        Of the earthquake, as the files say it.
    """

    dt: float
    data: Array
    azimuths: tuple[float, float]
    channels: tuple[str, str, str]
    steps: tuple[str, ...]
    processed: bool
    velocity: Array | None = None
    begins: float = 0.0
    window: tuple[float, float] | None = None
    magnitudes: frozenset[float] = frozenset()


def prefilter(sampling_hz: float, highpass_hz: float | None) -> tuple[float, float, float, float]:
    """Return the corners of the cosine taper that bounds the removal of an instrument's response.

    It is one from a fifth of the record's high-pass (0.02 Hz without one) to 0.8 of the Nyquist frequency, and zero
    below half of the former and above 0.9 of the latter: beyond, a response has nothing left that could be divided by.

    Parameters
    ----------
    sampling_hz, highpass_hz : float, float or None
        Samples per second; corner of the high-pass in Hz, None without one.

    Returns
    -------
    (float, float, float, float)
        Corners in Hz, increasing.
    """
    low = 0.02 if highpass_hz is None else 0.2 * highpass_hz
    return 0.5 * low, low, 0.40 * sampling_hz, 0.45 * sampling_hz


def read_record(folder: str | Path, record: Record) -> Recording:
    """Read the files of a record.

    Counts go through obspy's Trace.remove_response (full response, water level 60 dB, see `prefilter`).

    Parameters
    ----------
    folder, record : str or Path, Record
        The site's folder, and the manifest's table of the record.

    Returns
    -------
    Recording
        The three components on their common span, in m/s2.

    Raises
    ------
    MotionError
        Naming file, component and sample for anything but three complete, live, finite components.
    """
    folder = Path(folder)
    steps: list[str] = []
    read, part, window = _read(folder, record, steps)
    inventory = None if record.response is None else read_inventory(folder / record.response, steps)
    rows: dict[str, Row] = {}
    azimuths: dict[str, float] = {}
    velocities: dict[str, Array] = {}
    for key, component in record.components.items():
        file, trace = read[key]
        # What lies around the window is for the filters alone: whether it is any good is asked of the window.
        seen = slice(*((0, trace.stats.npts) if part is None else part.inside(trace)))
        _check(file, key, component, trace, seen)
        if (still := one_sided(trace.data[seen])) is not None:
            steps.append(f"component {component.axis} ({key!r}) {still}{NO_RECORD}")
        flat = clipped(trace.data[None, seen], trace.stats.delta, (f"component {component.axis} ({key!r})",))
        if flat is None and inventory is not None and (full := full_scale(trace.data[seen])) is not None:
            at = full[1] + seen.start
            flat = f"component {component.axis} ({key!r}) comes to the full scale of {full[0]:.0f} at sample {at}"
        if flat is not None:
            remedy = "use a record that was not clipped"
            judged(record.accept, "clipping", file, f"record {record.name!r}", flat, remedy, steps)
        elif (gap := filled(trace.data[seen], trace.stats.delta)) is not None:
            wrong = f"component {component.axis} ({key!r}) {gap}"
            remedy = "use the record with its gap told, a window_s that leaves it out, or another record"
            judged(record.accept, "filled", file, f"record {record.name!r}", wrong, remedy, steps)
        station = None
        if inventory is not None:
            xml = folder / str(record.response)
            station = by_station(xml, key, component, trace, inventory, record.accept, steps)
        steps += _in_si(file, key, record, trace, inventory)
        said = trace.stats.get("kouros", {})
        if "velocity" in said:
            velocities[component.axis] = np.asarray(said.velocity)
        meant = component.orientation
        towards = oriented(file, key, component.axis, meant, station, said.get("orientation"), steps)
        if isinstance(towards, float):
            azimuths[component.axis] = towards
        elif towards == "down":
            trace.data = -trace.data
            velocities |= {axis: -values for axis, values in velocities.items() if axis == component.axis}
            steps.append(f"{key}: turned over, positive up")
        rows[component.axis] = (file, trace, key)
    check_together(rows, inventory, record.accept, steps)
    processed = _processed(folder, record.name, record.processed, [trace for _, trace, _ in rows.values()], steps)
    data, dt, first = aligned(rows, steps)
    steps += [said for said in (alike(data), uneven(data)) if said]
    velocity = None
    if processed and velocities.keys() == rows.keys():
        velocity = np.zeros_like(data)
        for axis, values in velocities.items():
            velocity["xyz".index(axis)] = values[first[axis] : first[axis] + data.shape[1]]
    channels = (rows["x"][2], rows["y"][2], rows["z"][2] if "z" in rows else str(record.vertical))
    if record.vertical == "estimated":
        steps.append(ESTIMATED)
    elif "z" not in rows:
        steps.append(NO_VERTICAL)
    begins = 0.0
    start = max(trace.stats.starttime for _, trace, _ in rows.values())
    told = []
    if part is None:
        check_common(rows, record.accept, steps)
        told = tell_earthquakes(rows["x"], record, steps)
    else:
        begins = start - part.zero
        # On the record's own samples, where it counts from one of them.
        begins = begins if record.origin_time is not None else round(begins / dt) * dt
    steps += tell_renewals(data, dt, start, begins, window, told)
    way = (azimuths["x"], azimuths["y"])
    return Recording(dt, data, way, channels, tuple(steps), processed, velocity, begins, window, _magnitudes(rows))


def _read(
    folder: Path, record: Record, steps: list[str]
) -> tuple[dict[str, tuple[Path, Any]], Part | None, tuple[float, float] | None]:
    """The trace of each component: all of it, or the window that is asked for with what lies around it."""
    in_part = record.window_s is not None or record.origin_time is not None
    pieces = [piece for name in record.files for piece in _pieces(folder / name, steps, in_part=in_part)]
    taken: set[int] = set()
    channels = {
        key: channel_of(folder=folder, record=record, key=key, component=one, pieces=pieces, taken=taken)
        for key, one in record.components.items()
    }
    if not in_part:
        alone = {key: only_piece(record, key, record.components[key], of) for key, of in channels.items()}
        return {key: (piece.file, piece.trace) for key, piece in alone.items()}, None, None
    every = list(channels.values())
    zero = zero_of(record, every)
    window = record.window_s or window_of(every, zero)
    part = part_of(record, zero, window, every)
    if record.origin_time is not None:
        found = "" if record.window_s else ", that of the earthquake found there"
        steps.append(f"window_s counts from {zero}: {window[0]:.6g} to {window[1]:.6g} s{found}")
    read: dict[str, tuple[Path, Any]] = {}
    for key, of in channels.items():
        piece = holding(part, of, f"record {record.name!r}, component {record.components[key].axis} ({key!r})")
        trace = part.read(piece)
        if piece.trace is None:
            s = trace.stats
            logger.debug("%s: %s, %s, %d samples at %g Hz", piece.file, s._format, trace.id, s.npts, s.sampling_rate)
            whole = "" if s.npts == piece.samples else f", of {piece.samples} from {piece.start}"
            steps.append(f"{_read_of(piece.file, trace)}{whole}")
        elif trace.stats.npts < piece.samples:
            around = f"{trace.stats.npts} of {piece.samples} samples, from {trace.stats.starttime}"
            steps.append(f"{key}: the window and what lies around it: {around}")
        read[key] = (piece.file, trace)
    return read, part, window


def _pieces(file: Path, steps: list[str], *, in_part: bool) -> list[Piece]:
    if not is_continuous(file) or (not in_part and file.stat().st_size > LARGEST):
        return [whole(file, trace) for trace in open_traces(file, steps)]
    pieces = scan(file)
    if in_part:
        return pieces
    for name in {piece.id for piece in pieces}:
        mine = [piece for piece in pieces if piece.id == name]
        samples = sum(piece.samples for piece in mine)
        if samples > MOST_SAMPLES:
            wrong = (
                f"{name} has {samples:,} samples from {mine[0].start}, more than a record ({MOST_SAMPLES:,} at most)"
            )
            remedy = f"choose a part by window_s or origin_time; earthquakes in it: {listed(earthquakes(mine))}"
            raise refusal(file, "file", wrong, remedy)
    return [whole(file, trace) for trace in open_traces(file, steps)]


def open_traces(file: Path, steps: list[str]) -> list[Any]:
    """Return the traces of a file of any format that is read, and write down what was read.

    Parameters
    ----------
    file : Path
        The record file.
    steps : list of str
        What was done to the record; what was read and what the reader warned of is appended.

    Returns
    -------
    list of obspy.Trace

    Raises
    ------
    MotionError
        Naming the file, where it is damaged, incomplete, too large, or of an unknown format.
    """
    obspy = load_obspy()

    size = file.stat().st_size
    if size > LARGEST:
        wrong = f"{size:,} bytes are more than a record has ({LARGEST:,} at most)"
        remedy = "cut out the earthquake, choose a part by window_s (MiniSEED), or see whether it is another file"
        raise refusal(file, "file", wrong, remedy)
    with file.open("rb") as stream:
        head = stream.read(100)
    if b"obspy.core.stream" in head:
        # obspy would unpickle it while guessing the format, and a pickle can run anything.
        raise refusal(file, "file", "a pickled stream can run code and is never opened", "export it as MiniSEED or SAC")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            # Escaped, because obspy expands wildcards; never unpacked, so that what is read is what was hashed.
            stream = knet.really(file, obspy.read(glob.escape(str(file)), check_compression=False))
        except MotionError:  # Kouros's own readers say file, line and remedy themselves
            raise
        except Exception as error:  # on a broken file obspy's readers raise anything
            if isinstance(error, TypeError) and str(error).startswith("Unknown format"):
                raise unknown(file) from error
            wrong = f"cannot be read ({type(error).__name__}: {str(error)[:200]})"
            raise refusal(
                file, "file", wrong, "it is cut off, damaged or of an unknown format; fetch it again"
            ) from error
    said = [w for w in caught if issubclass(w.category, UserWarning)]
    for warning in said:
        if issubclass(warning.category, obspy.io.mseed.InternalMSEEDWarning):
            raise refusal(file, "file", f"is cut off or damaged ({str(warning.message)[:200]})", "fetch it again")
    steps += [f"{file.name}: the reader warned: {str(w.message)[:200]}" for w in said]
    _check_complete(file, stream)
    knet.complete(file, stream)
    if 1 < len(stream) < 10 and all(t.id == "..." and t.stats._format in _NAMELESS for t in stream):
        for number, trace in enumerate(stream, start=1):
            trace.stats.channel = channel_code(trace.stats.sampling_rate, None, number)
    try:
        stream.merge(method=-1)
    except Exception as error:  # obspy raises a bare Exception for pieces that do not belong together
        raise refusal(
            file, "file", f"its pieces do not fit ({error})", "give files with one trace a channel"
        ) from error
    if not stream:
        raise refusal(file, "file", "holds a header and no samples", "fetch it again")
    for trace in stream:
        s = trace.stats
        logger.debug("%s: %s, %s, %d samples at %g Hz", file, s._format, trace.id, s.npts, s.sampling_rate)
        steps.append(_read_of(file, trace))
    return list(stream)


def _read_of(file: Path, trace: Any) -> str:
    s = trace.stats
    return f"read {file.name} ({s._format}, {trace.id}): {s.npts} samples at {s.sampling_rate:g} Hz from {s.starttime}"


def _check_complete(file: Path, stream: Any) -> None:
    form = stream[0].stats._format if len(stream) else ""
    if form == "MSEED":
        check_whole(file, file.stat().st_size, stream[0].stats.mseed.record_length)
    elif form in {"SLIST", "TSPAIR"}:
        text = file.read_text(encoding="ascii", errors="replace")
        declared = sum(int(n) for n in re.findall(r"^TIMESERIES [^,\n]*, *(\d+) samples", text, re.MULTILINE))
        # Counted, not taken from the header, whose word obspy passes on.
        found = sum(len(trace.data) for trace in stream)
        if found != declared:
            wrong = f"is cut off: it announces {declared} samples and holds {found}"
            raise refusal(file, "file", wrong, "fetch it again")


def _check(file: Path, key: str, component: Component, trace: Any, seen: slice) -> None:
    place = f"component {component.axis} ({key!r})"
    if trace.stats.npts < 2:
        raise refusal(file, place, f"is empty ({trace.stats.npts} samples)", "fetch it again")
    if not (np.isfinite(trace.stats.delta) and trace.stats.delta > 0.0):
        raise refusal(file, place, f"has a time step of {trace.stats.delta} s", "fetch it again")
    if np.ma.is_masked(trace.data):
        at = int(np.flatnonzero(np.ma.getmaskarray(trace.data))[0])
        raise refusal(file, place, f"has a gap at sample {at}", "use a record without a gap")
    try:
        values = np.array(trace.data, dtype=np.float64)
    except (TypeError, ValueError) as error:
        raise refusal(file, place, f"holds no numbers ({trace.data.dtype})", "name a channel of samples") from error
    bad = np.flatnonzero(~np.isfinite(values))
    if bad.size:
        wrong = f"is {values[bad[0]]} at sample {bad[0]} ({bad.size} such samples)"
        raise refusal(file, place, wrong, "use a record without missing samples")
    if component.silent and values.any():
        at = int(np.flatnonzero(values)[0])
        wrong = f"is declared silent and is {values[at]:g} at sample {at}"
        raise refusal(file, place, wrong, "drop silent from the manifest, or name the right channel")
    if not component.silent and seen.stop - seen.start > 1 and np.ptp(values[seen]) == 0.0:
        raise refusal(file, place, f"is dead: every sample is {values[seen][0]:g}", "use a record of a working channel")
    trace.data = values


def _processed(folder: Path, name: str, manifest: bool | None, traces: list[Any], steps: list[str]) -> bool:
    words = {True: "processed", False: "raw", None: "neither"}
    headers = {trace.stats.get("kouros", {}).get("processed") for trace in traces}
    if manifest is not None:
        if manifest not in headers and headers != {None}:
            told = " and ".join(sorted(words[header] for header in headers - {None}))
            steps.append(f"the manifest says that the record is {words[manifest]}, and overrules its files ({told})")
        return manifest
    if len(headers) != 1 or None in headers:
        told = ", ".join(sorted(words[header] for header in headers))
        wrong = f"neither the manifest nor the files say whether it is processed (the files: {told})"
        raise refusal(folder, f"record {name!r}", wrong, "give processed = true or false in the manifest")
    (header,) = headers
    steps.append(f"{words[header]}, by the files")
    return bool(header)


def _in_si(file: Path, key: str, record: Record, trace: Any, inventory: Any) -> list[str]:
    stats = trace.stats
    own, factor = own_unit(stats)
    if inventory is not None:
        if own not in {"", "counts"}:
            raise refusal(file, f"component {key!r}", f"is in {own} already", "drop response from the manifest")
        if (counts := sensitivity(inventory, trace)) is not None:
            trace.data = trace.data / counts
            return [f"{key}: {counts:.9g} counts for 1 m/s2, by {record.response}{SENSITIVITY_ALONE}"]
        corners = prefilter(stats.sampling_rate, record.corner_hz)
        try:
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always")
                # Without a taper: one of obspy's 5 % would eat the onset of a record that was triggered late.
                trace.remove_response(
                    inventory, output="ACC", water_level=WATER_LEVEL_DB, pre_filt=corners, zero_mean=True, taper=False
                )
        except Exception as error:  # obspy and its C library raise anything on an incomplete response
            wrong = f"the response cannot be removed ({type(error).__name__}: {str(error)[:200]})"
            raise refusal(
                file, f"component {key!r}", wrong, f"give the full StationXML, not {record.response!r}"
            ) from error
        said = [f"{key}: removing the response warned: {str(w.message)[:200]}" for w in caught]
        taper = ", ".join(f"{c:g}" for c in corners)
        how = f"mean removed, pre-filter {taper} Hz, water level {WATER_LEVEL_DB:g} dB"
        step = f"{key}: response of {record.response} removed to m/s2, {how}"
        return [step, *said]
    unit = record.units or own
    if (kind := _SAC_KINDS.get(stats.get("sac", {}).get("idep"))) is not None:
        wrong = f"its header says that it holds {kind} (IDEP), no acceleration"
        raise refusal(file, f"component {key!r}", wrong, "give the acceleration, or counts with their response")
    if stats.get("kouros", {}).get("units"):
        return _by_header(file, key, record, trace)
    if own and record.units and UNITS[record.units] != factor:
        wrong = f"the file says {own}, the manifest {record.units}"
        raise refusal(file, f"component {key!r}", wrong, "drop units from the manifest, which may only fill a silence")
    if own not in UNITS and own:
        raise refusal(
            file, f"component {key!r}", f"is in {own[:40]!r}, not an acceleration", "name its response in the manifest"
        )
    if not unit:
        remedy = f"give units ({', '.join(UNITS)}), or response for counts, in the manifest"
        raise refusal(file, f"component {key!r}", "neither the file nor the manifest says its unit", remedy)
    # K-NET files hold counts and their factor to m/s2; for every other file the unit is the samples' own.
    factor = stats.calib if stats._format == "KNET" else UNITS[unit]
    trace.data = factor * trace.data
    return [f"{key}: {unit} to m/s2, times {factor:.9g}"]


def _by_header(file: Path, key: str, record: Record, trace: Any) -> list[str]:
    """Bring a trace of Kouros's own readers to m/s2: its header knows the factor, which the manifest may overrule."""
    said = trace.stats.kouros
    unit, factor = said.units, said.si_factor
    steps = [f"{key}: {said[word]}" for word in ("notes", "resampled") if said.get(word)]
    if record.units is not None and UNITS[record.units] != factor:
        steps.append(f"{key}: the manifest's unit {record.units} overrules the file's {unit}")
        unit, factor = record.units, UNITS[record.units]
    if factor is None:
        wrong = f"is in {unit}, and the file does not say their sensitivity"
        raise refusal(file, f"component {key!r}", wrong, "name its response in the manifest")
    trace.data = factor * trace.data
    return [*steps, f"{key}: {unit} to m/s2, times {factor:.9g}"]


def own_unit(stats: Any) -> tuple[str, float]:
    """Return the unit that a trace's file says, and how many m/s2 one of it is.

    Parameters
    ----------
    stats : obspy.core.trace.Stats

    Returns
    -------
    (str, float)
        The unit, "" where the file says none, and its factor to m/s2, 0.0 where that is open.
    """
    if "kouros" in stats:
        return stats.kouros.units, stats.kouros.si_factor or 0.0
    if stats._format == "KNET":
        return "m/s2", 1.0
    said = str(stats.get("ascii", {}).get("unit", "")).strip().lower()
    if said in _SILENT:
        return "", 0.0
    unit = _SPELLINGS.get(said, said)
    return unit, UNITS.get(unit, 0.0)


def _magnitudes(rows: Mapping[str, tuple[Path, Any, str]]) -> frozenset[float]:
    """The magnitudes that the files say."""
    events = [own_event(trace) for _, trace, _ in rows.values()]
    return frozenset(one.magnitude for one in events if one is not None and one.magnitude is not None)
