"""Onset of an event in a record: where its first arrival is, and what lies before a time."""

from __future__ import annotations

import numpy as np

from pipeline.errors import InputError
from pipeline.quantities import Array
from pipeline.records import Motion

BAND = (1.0, 20.0)
"""Hz: where the first waves of earthquakes stand out from a drifting baseline and from the microseisms."""

ARRIVED = 0.2
"""Share of the horizontal Arias intensity before which the first arrival is looked for."""

CLEAR = 10.0
"""Least ratio of the r.m.s. acceleration in the AFTER seconds behind an arrival to that before it (judgement)."""

AFTER = 3.0

GUARD = 1.0
"""s before the arrival that are not called noise: the first waves may be weaker than what is seen of them."""

_LEAST = 200


def first_arrival(motion: Motion) -> float | None:
    """Return the time before which a raw record holds noise alone; None where it begins in the event.

    On each component, between 1 and 20 Hz, the time is taken that parts what is before the strong shaking best into two
    pieces of one variance each, by Akaike's criterion; it counts where the shaking behind it is clearly stronger.

    Parameters
    ----------
    motion : Motion
        A raw record.

    Returns
    -------
    float or None
        In s from the first sample, a second before the earliest arrival of the components.

    Notes
    -----
    Error: on records with pre-event memory within some tenths of a second of a person's pick, on the early side.

    References
    ----------
    Maeda, N. (1985), A method for reading and checking phase times in autoprocessing system of seismic wave data, Zisin
    38, 365-379.
    """
    from obspy.signal.trigger import aic_simple
    from scipy.signal import butter, sosfilt

    level = motion.acceleration - np.median(motion.acceleration, axis=1, keepdims=True)
    arrived = np.cumsum((level[:2] ** 2).sum(axis=0))
    end = int(np.searchsorted(arrived, ARRIVED * arrived[-1]))
    high = min(BAND[1], 0.4 / motion.dt)
    if end < _LEAST or high <= BAND[0]:
        return None
    sections = butter(2, (BAND[0], high), "bandpass", fs=1.0 / motion.dt, output="sos")
    edge = _LEAST // 10
    found = []
    for row in level:
        part: Array = sosfilt(sections, row[: end + round(AFTER / motion.dt)] - row[0])
        if not part[:end].any():
            continue
        at = edge + int(np.argmin(aic_simple(part[:end])[edge:-edge]))
        before, after = part[:at], part[at : at + max(1, round(AFTER / motion.dt))]
        if np.sqrt(np.mean(after**2)) >= CLEAR * np.sqrt(np.mean(before**2)):
            found.append(at * motion.dt)
    return min(found) - GUARD if found and min(found) > GUARD else None


def samples_before(motion: Motion, until: float, name: str) -> int:
    """Return how many whole samples lie before a time.

    Parameters
    ----------
    motion : Motion
        A record.
    until : float
        In s from the first sample.
    name : str
        What the time is called, for the message.

    Returns
    -------
    int

    Raises
    ------
    InputError
        Unless at least two lie before it, and not all.
    """
    count = int(np.floor(until / motion.dt * (1.0 + 1e-12))) if np.isfinite(until) else 0
    if not 2 <= count < motion.samples:
        raise InputError(
            f"{name} must be a time in s with at least two samples before it, inside the record of "
            f"{motion.duration:g} s, not {until!r}"
        )
    return count
