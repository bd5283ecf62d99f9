"""What is done to a record before anything is shaken by it; every step is written down with its parameters."""

from __future__ import annotations

from typing import Literal

import numpy as np

from pipeline.motions.manifest import Record
from pipeline.motions.reading import PGA_MOST, Recording
from pipeline.quantities import Array, G
from pipeline.records import Motion

POLES = 2
"""Poles of the Butterworth filters; run forwards and backwards they fall off as four."""

ORTHOGONAL_WITHIN = 2.0
"""Degrees that two horizontal channels may be off a right angle (the usual care of an installation)."""


def process(recording: Recording, record: Record) -> Motion:
    """Turn a recording into the motion that the manifest asks for.

    In this order: linear baseline, high-pass, low-pass (none of the three for a processed record), window, rotation
    to east and north, scaling.  The scale counts the larger *recorded* horizontal component, before the rotation.

    raises : ValueError naming the manifest's key
    """
    data, steps = recording.data, list(recording.steps)
    if recording.processed:
        if record.highpass_hz is not None or record.lowpass_hz is not None:
            raise ValueError("highpass_hz, lowpass_hz: the files say that the record is processed; drop both")
        steps.append("processed by its source: no baseline correction, no filter")
    else:
        data, said = remove_baseline(data, recording.dt)
        steps.append(said)
        if record.highpass_hz is not None:
            data, said = highpass(data, recording.dt, record.highpass_hz)
            steps.append(said)
        if record.lowpass_hz is not None:
            data, said = lowpass(data, recording.dt, record.lowpass_hz)
            steps.append(said)
    if record.window_s is not None:
        data, said = cut(data, recording.dt, *record.window_s)
        steps.append(said)
    factor, why = _scale(recording, record, data)
    data, said = rotate(data, *recording.azimuths)
    steps.append(said)
    motion = Motion(recording.dt, data, record.name, steps, f"{record.source}; licence: {record.licence}")
    if why:
        motion = motion.scaled(factor, why)
    peak = float(np.abs(motion.acceleration).max())
    if peak > PGA_MOST:
        raise ValueError(f"scale: the scaled motion peaks at {peak / G:.3g} g, above 20 g; lower the scale")
    return motion


def _scale(recording: Recording, record: Record, data: Array) -> tuple[float, str]:
    """Return the factor of all three components and its reason; (1, "") where the manifest asks for none."""
    if record.scale is not None:
        return record.scale, "as the manifest says"
    if record.scale_to_pga_g is None:
        return 1.0, ""
    peaks = np.abs(data[:2]).max(axis=1)
    larger = int(np.argmax(peaks))
    if peaks[larger] == 0.0:
        raise ValueError("scale_to_pga_g: both horizontal components are zero in the window; widen window_s")
    why = f"{recording.channels[larger]}, the larger recorded horizontal component, from {peaks[larger] / G:.4f} g"
    return record.scale_to_pga_g * G / float(peaks[larger]), f"{why} to {record.scale_to_pga_g:g} g"


def starting_velocity(recording: Recording, record: Record) -> Array | None:
    """Return the velocity (3,) m/s, x east, y north, z up, that a processed record starts with, scaled like its motion.

    An agency's own velocity series may start with a velocity that its acceleration does not show; integrating from rest
    is 3.5 % off in PGV on one near-fault record.  None where the files carry no velocity.
    """
    if recording.velocity is None:
        return None
    data, velocity = recording.data, recording.velocity
    if record.window_s is not None:
        data, _ = cut(data, recording.dt, *record.window_s)
        velocity, _ = cut(velocity, recording.dt, *record.window_s)
    factor, _ = _scale(recording, record, data)
    turned, _ = rotate(velocity, *recording.azimuths)
    return factor * np.asarray(turned)[:, 0]


def remove_baseline(data: Array, dt: float) -> tuple[Array, str]:
    """Subtract from each row its least-squares straight line (mean and drift), and say which.

    data    : (3, n) m/s2
    returns : (3, n) m/s2 and the step
    """
    n = data.shape[1]
    # Time about the middle: the mean and the slope are then independent of each other.
    t = (np.arange(n) - 0.5 * (n - 1)) * dt
    mean = data.mean(axis=1)
    slope = (data @ t) / float(t @ t)
    line = mean[:, None] + slope[:, None] * t
    told = ", ".join(f"{axis} {m:.3g} m/s2 and {s:.3g} m/s3" for axis, m, s in zip("xyz", mean, slope, strict=True))
    return data - line, f"linear baseline removed (mean and drift): {told}"


def pad_seconds(corner_hz: float) -> float:
    """Return the zeros in s before and after a record that its high-pass needs: 1.5 n / fc.

    source : Boore, D.M. (2005), On pads and filters: processing strong-motion data, BSSA 95, 745-750; n is the order,
             here the four of both passes together, and the whole length goes to each end.
    """
    return 1.5 * (2 * POLES) / corner_hz


def highpass(data: Array, dt: float, corner_hz: float) -> tuple[Array, str]:
    """Zero-phase Butterworth high-pass of each row, padded with zeros and cut back to the record.

    data   : (rows, n) m/s2
    raises : ValueError unless the corner is below the Nyquist frequency
    """
    return _filtered(data, dt, corner_hz, "highpass")


def lowpass(data: Array, dt: float, corner_hz: float) -> tuple[Array, str]:
    """Zero-phase Butterworth low-pass of each row, padded with zeros and cut back to the record.

    data   : (rows, n) m/s2
    raises : ValueError unless the corner is below the Nyquist frequency
    """
    return _filtered(data, dt, corner_hz, "lowpass")


def _filtered(data: Array, dt: float, corner_hz: float, kind: Literal["highpass", "lowpass"]) -> tuple[Array, str]:
    from scipy.signal import butter, sosfiltfilt

    if not 0.0 < corner_hz < 0.5 / dt:
        raise ValueError(f"{kind}_hz {corner_hz:g} must be below the Nyquist frequency of {0.5 / dt:g} Hz")
    sos = butter(POLES, corner_hz, kind, fs=1.0 / dt, output="sos")
    pad = int(np.ceil(pad_seconds(corner_hz) / dt))
    padded = np.pad(data, ((0, 0), (pad, pad)))
    out = np.asarray(sosfiltfilt(sos, padded, axis=1, padtype=None), dtype=np.float64)
    how = f"Butterworth of {POLES} poles forwards and backwards, padded by {pad * dt:g} s of zeros at each end"
    step = f"{kind.replace('pass', '-pass')} {corner_hz:g} Hz, {how}"
    return np.ascontiguousarray(out[:, pad : pad + data.shape[1]]), step


def cut(data: Array, dt: float, start: float, end: float) -> tuple[Array, str]:
    """Cut to the samples from ``start`` to ``end`` (s from the first sample), and say what velocity that leaves.

    data   : (3, n) m/s2
    raises : ValueError for a window that holds fewer than two samples or ends after the record
    """
    last = (data.shape[1] - 1) * dt
    if end > last + 0.5 * dt:
        raise ValueError(f"window_s ends at {end:g} s, after the record's end at {last:g} s; shorten it")
    a, b = round(start / dt), round(end / dt)
    if b - a < 1:
        raise ValueError(f"window_s [{start:g}, {end:g}] holds fewer than two samples; widen it")
    part = data[:, a : b + 1]
    left = dt * (part.sum(axis=1) - 0.5 * (part[:, 0] + part[:, -1]))
    told = ", ".join(f"{axis} {v:.2g}" for axis, v in zip("xyz", left, strict=True))
    return part, f"cut to {a * dt:g} s to {b * dt:g} s of the record; velocity left at the end [m/s]: {told}"


def rotate(data: Array, first: float, second: float) -> tuple[Array, str]:
    """Rotate two horizontal channels into x (east) and y (north).

    data          : (3, n) m/s2, rows first channel, second channel, up
    first, second : azimuths in degrees clockwise from north
    raises        : ValueError unless the two are at right angles within 2 degrees
    """
    between = (second - first) % 180.0
    if abs(between - 90.0) > ORTHOGONAL_WITHIN:
        raise ValueError(f"components: the horizontal azimuths {first:g} and {second:g} are not at right angles")
    if (first % 360.0, second % 360.0) == (90.0, 0.0):
        return data, "x is east and y is north as recorded"
    # Rows: what each channel measures of east and north; solved, so that a small skew of the channels is undone too.
    seen = np.array([[_sine(azimuth), _sine(azimuth + 90.0)] for azimuth in (first, second)])
    out = np.array(data)
    out[:2] = np.linalg.inv(seen) @ data[:2]
    return out, f"rotated from azimuths {first:g} and {second:g} degrees to x east, y north"


def _sine(degrees: float) -> float:
    # Exact at right angles, so that a silent direction stays silent.
    exact = {0.0: 0.0, 90.0: 1.0, 180.0: 0.0, 270.0: -1.0}
    turn = degrees % 360.0
    return exact[turn] if turn in exact else float(np.sin(np.radians(turn)))
