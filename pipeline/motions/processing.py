"""Processing of a record before anything is shaken by it; every step is written down with its parameters."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from pipeline.errors import InputError
from pipeline.motions.baseline import (
    polynomial_baseline,
    remove_pre_event_mean,
    resample,
    two_segment_baseline,
)
from pipeline.motions.corner_range import CornerRange, corner_range
from pipeline.motions.corners import choose_corner
from pipeline.motions.doubts import DRIFTS, TOO_COARSE
from pipeline.motions.filtering import highpass, lowpass, remove_baseline
from pipeline.motions.fling import fling_step
from pipeline.motions.intensity import integrate
from pipeline.motions.manifest import TargetTable
from pipeline.motions.reading import PGA_MOST, Recording
from pipeline.motions.record import BaselineTable, Record
from pipeline.motions.suites import scale_to_spectrum
from pipeline.motions.vertical import with_vertical
from pipeline.quantities import Array, G
from pipeline.records import Motion

EAST = 90.0
"""Azimuth of the x axis in degrees clockwise from north, unless the manifest turns it to the building."""

ORTHOGONAL_WITHIN = 2.0
"""Degrees that two horizontal channels may be off a right angle without a word (the usual care of an installation)."""

SKEW_WITHIN = 10.0
"""Degrees that they may be off it at all.  Both directions of the ground follow from any two; but the channels of one
package are at right angles, so that more than a hasty reading of a compass is an azimuth that is wrong (judgement)."""

COARSEST = 0.025
"""s between samples from which on a record is doubted (judgement): accelerographs take 50 a second and more, agencies
print as many, and things in a museum are moved by up to 20 Hz."""

TRANSIENT = 0.001
"""Share of the PGV by which an agency's first velocity may be off the one that its record starts with (rounding)."""

DRIFTING = 0.05
"""Share of the PGV by which an agency's velocity may drift against its acceleration (judgement): CSMIP's has at most
0.01, what the USC integrated and filtered apart half."""


@dataclass(frozen=True, eq=False)
class Processed:
    """A record made ready, beside what it was before.

    Attributes
    ----------
    motion : Motion
        What objects are shaken by.
    before : Motion
        The same span as recorded, turned and scaled alike; of a raw record the mean is removed, which would hide
        everything else.
    filtered : bool
        Whether its baseline was corrected and it was filtered here, not by its source long ago.
    corners : (float or None, float or None)
        Of high-pass and low-pass in Hz, None where there was none.
    velocity : array, shape (3, n), or None
        In m/s, of the motion as its agency computed it, where the files hold it: its peak is the PGV; None for a record
        that is filtered here, resampled, or comes without.
    factor : float
        By which it is scaled.
    """

    motion: Motion
    before: Motion
    filtered: bool
    corners: tuple[float | None, float | None]
    velocity: Array | None = None
    factor: float = 1.0


def process(
    recording: Recording, record: Record, target: TargetTable | None = None, x_azimuth: float = EAST
) -> Processed:
    """Turn a recording into the motion that the manifest asks for.

    In this order: baseline, high-pass, low-pass (none of the three for a processed record), resampling, window, a
    vertical where one is to be estimated, rotation to x and y, scaling.  The window went first, on reading: what is
    filtered is the window with up to 300 s of the record on both sides (`parts.MARGIN`), which are then cut off; a
    corner is chosen from the window.  A scale to a PGA counts the larger *recorded* horizontal, before rotation.

    Parameters
    ----------
    recording : Recording
        What was read.
    record : Record
        What is to be done to it.
    target : TargetTable or None
        The level's spectrum, for a record with `scale_to_target`.
    x_azimuth : float
        Of the x axis, degrees clockwise from north.

    Returns
    -------
    Processed
        The motion, beside what it was before.

    Raises
    ------
    InputError
        Naming the manifest's key.
    """
    source = f"{record.source}; licence: {record.licence}"
    start: Iterable[float] = record.start_m_s or (0.0, 0.0, 0.0)
    steps = recording.steps
    if recording.velocity is not None and record.start_m_s is None:
        start, said = starting_velocity(recording.data, recording.velocity, recording.dt)
        steps += said
    if recording.dt > COARSEST:
        steps += (f"sampled every {recording.dt:g} s: shaking above {0.5 / recording.dt:.3g}{TOO_COARSE}",)
    motion = Motion(recording.dt, recording.data, record.name, steps, source, start)
    before = motion
    if not recording.processed:
        level = motion.acceleration.mean(axis=1, keepdims=True)
        before = motion.changed(motion.acceleration - level, "mean removed")
    corners: tuple[float | None, float | None] = (None, None)
    others = None
    if recording.processed:
        if record.raw_only:
            keys = ", ".join(record.raw_only)
            raise InputError(f"{keys}: the files say that the record is processed; drop what is for raw records")
        motion = motion.called(motion.name, "processed by its source: no baseline correction, no filter")
    else:
        flat = _flattened(motion, record, recording.begins)
        motion, corners = _filtered(flat, record, recording)
        others = _other_corners(flat, corners[0], recording)
    if record.resample_s is not None:
        if recording.processed and record.resample_s > motion.dt:
            raise InputError(
                f"resample_s: a step above the record's {motion.dt:g} s would filter it again; use a shorter one"
            )
        motion = resample(motion, record.resample_s)
    velocity = recording.velocity if record.resample_s is None else None
    if recording.window is not None:
        motion, before = (_windowed(one, recording, *recording.window) for one in (motion, before))
        if velocity is not None:
            velocity, _ = cut(velocity, recording.dt, *recording.window, recording.begins)
    if record.vertical == "estimated" and not recording.data[2].any():
        motion, before = with_vertical(motion, recording.channels), with_vertical(before, recording.channels)
        if velocity is not None:
            velocity = np.vstack([velocity[:2], integrate(motion)[0][2]])
    unscaled = float(np.abs(motion.acceleration).max())
    motion, before = _scaled_to_pga(motion, before, record, recording)
    total = float(np.abs(motion.acceleration).max()) / unscaled if unscaled > 0.0 else 1.0
    if velocity is not None:
        velocity, _ = rotate(total * velocity, *recording.azimuths, x_azimuth)
    motion, before = (_turned(one, recording.azimuths, x_azimuth) for one in (motion, before))
    if record.scale_to_target:
        if target is None:
            raise InputError("scale_to_target: the level has no target spectrum; add its table")
        wanted = [G * psa for psa in target.psa_g]
        fitted = scale_to_spectrum(
            motion,
            target.periods_s,
            wanted,
            target.compared,
            damping=target.damping,
            component=target.component,
            measure=target.measure,
        )
        factor = float(np.abs(fitted.acceleration).max()) / float(np.abs(motion.acceleration).max())
        before = before.scaled(factor, "as the processed motion")
        velocity = None if velocity is None else factor * velocity
        total *= factor
        motion = fitted
    if record.v_max_cm_s is not None:
        motion = Motion(
            motion.dt, motion.acceleration, motion.name, motion.steps, source, motion.start, 0.01 * record.v_max_cm_s
        )
    if others is not None:
        motion = motion.called(motion.name, others.scaled(total))
    peak = float(np.abs(motion.acceleration).max())
    if peak > PGA_MOST:
        raise InputError(f"scale: the scaled motion peaks at {peak / G:.3g} g, above 20 g; lower the scale")
    return Processed(motion, before, not recording.processed, corners, velocity, total)


def _flattened(motion: Motion, record: Record, begins: float) -> Motion:
    """Correct the baseline as the manifest says; by a straight line where it says nothing."""
    table = record.baseline or BaselineTable(method="linear")
    method = table.method
    if method == "none":
        return motion.called(motion.name, "no baseline correction, as the manifest says")
    if method == "linear":
        return motion.changed(*remove_baseline(motion.acceleration, motion.dt))
    if method == "mean":
        return polynomial_baseline(motion, 0)
    if method == "polynomial":
        return polynomial_baseline(motion, table.degree or 0, of=table.of or "acceleration")
    if record.pre_event_s is not None:
        motion = remove_pre_event_mean(motion, record.pre_event_s)
    if method == "two-segment":
        motion = two_segment_baseline(motion, *(_since(begins, table, key) for key in ("t1_s", "t2_s", "fit_from_s")))
    return motion


def _since(begins: float, table: BaselineTable, key: str) -> float | None:
    """A time of the manifest from the first sample that was read."""
    at: float | None = getattr(table, key)
    if at is None or begins == 0.0:
        return at
    if at < begins:
        raise InputError(
            f"baseline: {key} {at:g} s lies before {begins:g} s, from which the window is read; move either"
        )
    return at - begins


def _filtered(motion: Motion, record: Record, recording: Recording) -> tuple[Motion, tuple[float | None, float | None]]:
    corner = record.corner_hz
    wanted = record.highpass_hz
    if wanted is None and record.baseline is not None and record.baseline.method == "two-segment":
        wanted = "none"
    if wanted in {None, "auto"}:
        # A header's magnitude is the agency's first word, in whichever scale it had that day: with it a corner
        # would be raised, and the motion be weaker, for having been added from its files.
        magnitude = None if record.event is None else record.event.magnitude
        if magnitude is not None and magnitude in recording.magnitudes:
            magnitude = None
        chosen = choose_corner(_used(motion, record, recording), record.pre_event_s, magnitude=magnitude)
        corner = chosen.frequency
        motion = motion.called(motion.name, f"high-pass corner {corner:.4g} Hz chosen by {chosen.reason}")
    if corner is None:
        motion = motion.called(motion.name, "no high-pass: a permanent displacement is kept, and noise with it")
    else:
        data, said, start = highpass(motion.acceleration, motion.dt, corner)
        filtered = Motion(motion.dt, data, motion.name, start=start)
        step = (
            None if recording.window else fling_step(Motion(recording.dt, recording.data), filtered, record.pre_event_s)
        )
        told = (said,) if step is None else (said, step)
        motion = Motion(motion.dt, data, motion.name, (*motion.steps, *told), motion.source, start)
    if record.lowpass_hz is not None:
        if corner is not None and corner >= record.lowpass_hz:
            raise InputError(f"lowpass_hz {record.lowpass_hz:g} must be above the high-pass corner of {corner:.4g} Hz")
        motion = motion.changed(*lowpass(motion.acceleration, motion.dt, record.lowpass_hz))
    return motion, (corner, record.lowpass_hz)


def _other_corners(flat: Motion, corner: float | None, recording: Recording) -> CornerRange | None:
    """What hangs on the corner, in the span that is used; None where the record is not filtered."""
    if corner is None:
        return None
    seen = slice(None)
    if recording.window is not None:
        first, last = (round((at - recording.begins) / flat.dt) for at in recording.window)
        seen = slice(max(first, 0), last + 1)
    turned, _ = rotate(flat.acceleration, *recording.azimuths)
    return corner_range(turned, flat.dt, corner, seen)


def _used(motion: Motion, record: Record, recording: Recording) -> Motion:
    """What a corner is chosen from: the window, from the noise before the event on where the manifest tells of it."""
    if recording.window is None:
        return motion
    first, last = recording.window
    if record.pre_event_s is not None:
        first = recording.begins
    part, _ = cut(motion.acceleration, motion.dt, first, last, recording.begins)
    return Motion(motion.dt, part, motion.name)


def starting_velocity(data: Array, velocity: Array, dt: float) -> tuple[Array, tuple[str, ...]]:
    """Return the velocity that a processed record starts with, by all of its agency's velocity.

    That and the integral of the acceleration differ by the velocity at the start alone.  The first sample is that
    velocity, unless the transient of the agency's filters is in it: then the mean of the difference is.  Where the
    difference drifts by more than DRIFTING, the agency corrected its velocity apart from the acceleration, and the
    first sample is all there is.

    Parameters
    ----------
    data, velocity : array, shape (3, n)
        In m/s2, and in m/s as the agency computed it.
    dt : float
        Time step in s.

    Returns
    -------
    array, shape (3,)
        In m/s.
    tuple of str
        What is worth knowing of it.

    Notes
    -----
    Error: on CSMIP's Coalinga record of 1983 (CE36456) the PGD is 0.085 m, and 0.089 m as printed; by the first sample,
    -0.0117 m/s for -0.0004 m/s, it was 0.74 m after 65 s.
    """
    apart = velocity - integrate(Motion(dt, data))[0]
    first, mean = velocity[:, 0], apart.mean(axis=1)
    peak = np.abs(velocity).max(axis=1)
    drift = 2.0 * np.abs(np.polyfit(np.linspace(-1.0, 1.0, apart.shape[1]), apart.T, 1)[0])
    off = np.abs(mean - first) > TRANSIENT * peak
    drifts = drift > DRIFTING * peak
    told = [
        f"{'xyz'[i]}{DRIFTS}, by {drift[i]:.2g} m/s until its end: its displacement is not that of its source"
        for i in np.flatnonzero(drifts)
    ]
    told += [
        f"{'xyz'[i]}: starts at {mean[i]:.2g} m/s, by all of the velocity of its files; their first sample is "
        f"{first[i]:.2g} m/s"
        for i in np.flatnonzero(off & ~drifts)
    ]
    return np.where(off & ~drifts, mean, first), tuple(told)


def _windowed(motion: Motion, recording: Recording, start: float, end: float) -> Motion:
    part, said = cut(motion.acceleration, motion.dt, start, end, recording.begins)
    if recording.velocity is not None and motion.dt == recording.dt:
        own, _ = cut(recording.velocity, recording.dt, start, end, recording.begins)
        begin, _ = starting_velocity(part, own, recording.dt)
    else:
        begin = integrate(motion)[0][:, round((start - recording.begins) / motion.dt)]
    return Motion(motion.dt, part, motion.name, (*motion.steps, said), motion.source, begin)


def _scaled_to_pga(motion: Motion, before: Motion, record: Record, recording: Recording) -> tuple[Motion, Motion]:
    """Apply the manifest's factor, if any, to both."""
    if record.scale is not None:
        factor, why = record.scale, "as the manifest says"
    elif record.scale_to_pga_g is not None:
        peaks = np.abs(motion.acceleration[:2]).max(axis=1)
        larger = int(np.argmax(peaks))
        if peaks[larger] == 0.0:
            raise InputError("scale_to_pga_g: both horizontal components are zero in the window; widen window_s")
        which = f"{recording.channels[larger]}, the larger recorded horizontal component"
        factor = record.scale_to_pga_g * G / float(peaks[larger])
        why = f"{which}, from {peaks[larger] / G:.4f} g to {record.scale_to_pga_g:g} g"
    else:
        return motion, before
    return motion.scaled(factor, why), before.scaled(factor, "as the processed motion")


def cut(data: Array, dt: float, start: float, end: float, begins: float = 0.0) -> tuple[Array, str]:
    """Cut a history to a window, and say what velocity that leaves.

    Parameters
    ----------
    data : array, shape (3, n)
        In m/s2.
    dt : float
        Time step in s.
    start, end : float
        In s, as `begins` counts.
    begins : float
        Time of the first sample in s.

    Returns
    -------
    array, shape (3, m)
        In m/s2, both ends included.
    str
        The step.

    Raises
    ------
    InputError
        For a window that holds fewer than two samples or ends after the record.
    """
    last = begins + (data.shape[1] - 1) * dt
    if end > last + 0.5 * dt:
        raise InputError(f"window_s ends at {end:g} s, after the record's end at {last:g} s; shorten it")
    a, b = max(round((start - begins) / dt), 0), min(round((end - begins) / dt), data.shape[1] - 1)
    if b - a < 1:
        raise InputError(f"window_s [{start:g}, {end:g}] holds fewer than two samples; widen it")
    part = data[:, a : b + 1]
    left = dt * (part.sum(axis=1) - 0.5 * (part[:, 0] + part[:, -1]))
    told = ", ".join(f"{axis} {v:.2g}" for axis, v in zip("xyz", left, strict=True))
    span = f"{begins + a * dt:g} s to {begins + b * dt:g} s"
    return part, f"cut to {span} of the record; velocity left at the end [m/s]: {told}"


def _turned(motion: Motion, azimuths: tuple[float, float], x_azimuth: float) -> Motion:
    turned, said = rotate(motion.acceleration, *azimuths, x_azimuth)
    start, _ = rotate(np.array(motion.start)[:, None], *azimuths, x_azimuth)
    return Motion(motion.dt, turned, motion.name, (*motion.steps, said), motion.source, start[:, 0], motion.v_max)


def rotate(data: Array, first: float, second: float, x_azimuth: float = EAST) -> tuple[Array, str]:
    """Rotate two horizontal channels into x and y.

    Parameters
    ----------
    data : array, shape (3, n)
        In any unit, rows first channel, second channel, up.
    first, second : float
        Azimuths in degrees clockwise from north.
    x_azimuth : float
        Of the x axis; y is 90 degrees anticlockwise of it, as north is of east.

    Returns
    -------
    array, shape (3, n)
        In the same unit, rows x, y, up.
    str
        The step.

    Raises
    ------
    InputError
        For channels that are more than SKEW_WITHIN off a right angle.
    """
    skew = abs((second - first) % 180.0 - 90.0)
    if skew > SKEW_WITHIN:
        raise InputError(
            f"components: the horizontal azimuths {first:g} and {second:g} are {skew:.3g} degrees off a right angle, "
            f"and {SKEW_WITHIN:g} at most can be undone"
        )
    axes = (
        "x east, y north"
        if x_azimuth == EAST
        else f"the building's axes, x at {x_azimuth:g} and y at {(x_azimuth - 90.0) % 360.0:g} degrees"
    )
    if ((first - x_azimuth) % 360.0, (second - x_azimuth) % 360.0) == (0.0, 270.0):
        return data, f"{axes} as recorded"
    # Rows: what each channel measures of x and y; solved, so that a small skew of the channels is undone too.
    seen = np.array([[_sine(azimuth - x_azimuth + 90.0), _sine(x_azimuth - azimuth)] for azimuth in (first, second)])
    out = np.array(data)
    out[:2] = np.linalg.inv(seen) @ data[:2]
    off = f", {skew:.3g} degrees off a right angle," if skew > ORTHOGONAL_WITHIN else ""
    return out, f"rotated from azimuths {first:g} and {second:g} degrees{off} to {axes}"


def _sine(degrees: float) -> float:
    # Exact at right angles, so that a silent direction stays silent.
    exact = {0.0: 0.0, 90.0: 1.0, 180.0: 0.0, 270.0: -1.0}
    turn = degrees % 360.0
    return exact[turn] if turn in exact else float(np.sin(np.radians(turn)))
