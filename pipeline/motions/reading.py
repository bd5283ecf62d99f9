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

from pipeline.motions.errors import Judgement, MotionError, judged, refusal
from pipeline.motions.quality import clipped
from pipeline.motions.record import NO_VERTICAL, Component, Record
from pipeline.motions.responses import load_obspy, read_inventory
from pipeline.quantities import Array, G

logger = logging.getLogger(__name__)

UNITS = {"m/s2": 1.0, "cm/s2": 0.01, "mm/s2": 0.001, "gal": 0.01, "g": G, "mg": 0.001 * G}
"""Metres per second squared in one of each unit that a manifest may name."""

_SPELLINGS = {"m/s**2": "m/s2", "m/s/s": "m/s2", "m/s^2": "m/s2", "cm/s**2": "cm/s2", "cm/s/s": "cm/s2"}
# obspy's ASCII readers hand on the storage type in the place of the unit where a file was written without one.
_SILENT = {"", "integer", "float", "ascii", "unknown"}

LARGEST = 256 << 20
"""Bytes of a file of a record; three components of an hour at 1,000 samples a second have 90 MB as text."""

PGA_MOST = 20.0 * G
PGA_LEAST = 1e-9 * G
WATER_LEVEL_DB = 60.0
AZIMUTH_TOLERANCE = 2.0


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
        nothing; None unless all three files hold it.
    """

    dt: float
    data: Array
    azimuths: tuple[float, float]
    channels: tuple[str, str, str]
    steps: tuple[str, ...]
    processed: bool
    velocity: Array | None = None


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
    traces = [(folder / name, trace) for name in record.files for trace in open_traces(folder / name, steps)]
    inventory = None if record.response is None else read_inventory(folder / record.response, steps)
    rows: dict[str, tuple[Path, Any, str]] = {}
    azimuths: dict[str, float] = {}
    velocities: dict[str, Array] = {}
    taken: set[int] = set()
    for key, component in record.components.items():
        file, trace = _component(folder=folder, record=record, key=key, component=component, traces=traces, taken=taken)
        _check(file, key, component, trace)
        flat = clipped(trace.data[None, :], trace.stats.delta, (f"component {component.axis} ({key!r})",))
        if flat is not None:
            remedy = "use a record that was not clipped"
            judged(record.accept, "clipping", file, f"record {record.name!r}", flat, remedy, steps)
        if inventory is not None:
            _check_orientation(folder / str(record.response), key, component, trace, inventory, record.accept, steps)
        steps += _in_si(file, key, record, trace, inventory)
        said = trace.stats.get("kouros", {})
        if "velocity" in said:
            velocities[component.axis] = np.asarray(said.velocity)
        oriented = _oriented(file, key, component.axis, component.orientation, said, steps)
        if isinstance(oriented, float):
            azimuths[component.axis] = oriented
        elif oriented == "down":
            trace.data = -trace.data
            velocities |= {axis: -values for axis, values in velocities.items() if axis == component.axis}
            steps.append(f"{key}: turned over, positive up")
        if not component.silent:
            _check_size(file, key, component, trace, record.accept, steps)
        rows[component.axis] = (file, trace, key)
    processed = _processed(folder, record.name, record.processed, [trace for _, trace, _ in rows.values()], steps)
    data, dt, first = _aligned(rows, steps)
    velocity = None
    if processed and velocities.keys() == rows.keys():
        velocity = np.zeros_like(data)
        for axis, values in velocities.items():
            velocity["xyz".index(axis)] = values[first[axis] : first[axis] + data.shape[1]]
    channels = (rows["x"][2], rows["y"][2], rows["z"][2] if "z" in rows else "absent")
    if "z" not in rows:
        steps.append(NO_VERTICAL)
    return Recording(dt, data, (azimuths["x"], azimuths["y"]), channels, tuple(steps), processed, velocity)


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
        raise refusal(file, "file", wrong, "cut out the earthquake, or see whether it is another file")
    with file.open("rb") as stream:
        head = stream.read(100)
    if b"obspy.core.stream" in head:
        # obspy would unpickle it while guessing the format, and a pickle can run anything.
        raise refusal(file, "file", "a pickled stream can run code and is never opened", "export it as MiniSEED or SAC")
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            # Escaped, because obspy expands wildcards; never unpacked, so that what is read is what was hashed.
            stream = obspy.read(glob.escape(str(file)), check_compression=False)
        except MotionError:  # Kouros's own readers say file, line and remedy themselves
            raise
        except Exception as error:  # on a broken file obspy's readers raise anything
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
    try:
        stream.merge(method=-1)
    except Exception as error:  # obspy raises a bare Exception for pieces that do not belong together
        raise refusal(
            file, "file", f"its pieces do not fit ({error})", "give files with one trace a channel"
        ) from error
    for trace in stream:
        s = trace.stats
        logger.debug("%s: %s, %s, %d samples at %g Hz", file, s._format, trace.id, s.npts, s.sampling_rate)
        steps.append(
            f"read {file.name} ({s._format}, {trace.id}): {s.npts} samples at {s.sampling_rate:g} Hz from {s.starttime}"
        )
    return list(stream)


def _check_complete(file: Path, stream: Any) -> None:
    form = stream[0].stats._format if len(stream) else ""
    if form == "MSEED":
        length, size = stream[0].stats.mseed.record_length, file.stat().st_size
        if size % length:
            wrong = f"is cut off: {size} bytes are not a whole number of records of {length} bytes"
            raise refusal(file, "file", wrong, "fetch it again")
    elif form in {"SLIST", "TSPAIR"}:
        text = file.read_text(encoding="ascii", errors="replace")
        declared = sum(int(n) for n in re.findall(r"^TIMESERIES [^,\n]*, *(\d+) samples", text, re.MULTILINE))
        # Counted, not taken from the header, whose word obspy passes on.
        found = sum(len(trace.data) for trace in stream)
        if found != declared:
            wrong = f"is cut off: it announces {declared} samples and holds {found}"
            raise refusal(file, "file", wrong, "fetch it again")


def _component(
    *, folder: Path, record: Record, key: str, component: Component, traces: list[tuple[Path, Any]], taken: set[int]
) -> tuple[Path, Any]:
    place = f"record {record.name!r}, component {component.axis} ({key!r})"
    fitting = [(f, t) for f, t in traces if key in {t.id, t.stats.channel} or f == folder / key]
    if not fitting:
        there = ", ".join(sorted({f"{f.name}: {t.id}" for f, t in traces})) or "nothing"
        raise refusal(
            folder, place, "is missing", f"name a file, a channel or a channel id of the record; it has {there}"
        )
    file, trace = fitting[0]
    ids = sorted({t.id for _, t in fitting})
    if len(ids) > 1:
        raise refusal(
            file, place, f"fits several channels ({', '.join(ids)})", "name the full channel id in components"
        )
    if len(fitting) > 1:
        later = fitting[1][1].stats.starttime
        wrong = f"has a gap or an overlap after sample {trace.stats.npts - 1} (the next piece starts at {later})"
        raise refusal(file, place, wrong, "use a record without a gap, or files with one unbroken trace a channel")
    if id(trace) in taken:
        raise refusal(file, place, "is used for two axes", "name each component's own file or channel")
    taken.add(id(trace))
    return file, trace


def _check(file: Path, key: str, component: Component, trace: Any) -> None:
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
    if np.ptp(values) == 0.0 and not component.silent:
        raise refusal(file, place, f"is dead: every sample is {values[0]:g}", "use a record of a working channel")
    trace.data = values


def _check_orientation(
    file: Path,
    key: str,
    component: Component,
    trace: Any,
    inventory: Any,
    accept: Mapping[Judgement, str],
    steps: list[str],
) -> None:
    place = f"component {component.axis} ({key!r})"
    try:
        known = inventory.get_channel_metadata(trace.id, trace.stats.starttime)
    except Exception as error:  # obspy raises a bare Exception
        wrong = f"says nothing about {trace.id} at {trace.stats.starttime}"
        raise refusal(file, place, wrong, "name the StationXML of this channel and time") from error
    if component.axis == "z":
        said = {-90.0: "up", 90.0: "down"}.get(known["dip"])
        agrees = said is None or component.orientation in {None, said}
    else:
        said = known["azimuth"]
        meant = component.orientation
        agrees = None in {said, meant} or abs((said - meant + 180.0) % 360.0 - 180.0) <= AZIMUTH_TOLERANCE
    if not agrees:
        wrong = f"the manifest orients it {component.orientation}, the StationXML {said}"
        remedy = "find out which is right and mend the manifest's orientation"
        judged(accept, "orientation", file, place, wrong, remedy, steps)


def _oriented(
    file: Path, key: str, axis: str, manifest: float | str | None, said: Any, steps: list[str]
) -> float | str:
    """Return the orientation by the manifest, or, where it is silent, by the file's header; degrees, "up" or "down"."""
    header = said.get("orientation")
    known = header in {"up", "down"} if axis == "z" else isinstance(header, float)
    place = f"component {axis} ({key!r})"
    if manifest is None:
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
    if known and isinstance(header, str):
        differs = header != manifest
    else:
        differs = known and abs((header - float(manifest) + 180.0) % 360.0 - 180.0) > AZIMUTH_TOLERANCE
    if differs:
        steps.append(f"{key}: the manifest's orientation {manifest} overrules the file's {header}")
    return manifest if isinstance(manifest, str) else float(manifest)


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
    if "kouros" in stats:
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


def _check_size(
    file: Path, key: str, component: Component, trace: Any, accept: Mapping[Judgement, str], steps: list[str]
) -> None:
    # About the mean, because a raw accelerometer carries an offset that is not shaking.
    size = np.abs(trace.data - np.mean(trace.data))
    at = int(np.argmax(size))
    if not PGA_LEAST <= size[at] <= PGA_MOST:
        place = f"component {component.axis} ({key!r})"
        wrong = f"peaks at {size[at] / G:.3g} g (sample {at}), outside of 1e-9 g to 20 g"
        remedy = "this looks like a wrong unit: mend units or response in the manifest"
        judged(accept, "size", file, place, wrong, remedy, steps)


def _aligned(rows: dict[str, tuple[Path, Any, str]], steps: list[str]) -> tuple[Array, float, dict[str, int]]:
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
        raise refusal(rows["x"][0], "components x, y, z", "have no common time", "use components of one event")
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
