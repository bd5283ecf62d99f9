"""Earthquakes in a continuous recording: where the shaking rises above the noise, found block by block."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from pipeline.errors import InputError
from pipeline.motions.parts import Piece
from pipeline.motions.responses import load_obspy
from pipeline.quantities import Array, G

BLOCK = 3600.0
"""Seconds that are looked at at once; what a recording of any length takes of memory."""

BAND = (1.0, 20.0)
"""Hz, of local earthquakes above the noise of the sea and below that of machines."""

NOISE_SHARE = 0.1
"""Share of the seconds of a block that hold no more than its noise, an earthquake or not."""

ON, OFF = 8.0, 2.0
"""Multiples of the noise at which an earthquake begins and ends (judgement: above most passing lorries)."""

QUIET = 60.0
"""Seconds below OFF that part two earthquakes; less lies between the P and the S waves of one."""

LEAST = 3.0
"""Seconds that an earthquake lasts at least; what is shorter is a knock."""

SMALL = 0.1
"""Share of the largest peak below which an earthquake is not told: it decides nothing."""

MOST_TOLD = 20
"""Earthquakes that are told, the strongest."""

BEFORE, AFTER = 30.0, 30.0
"""Seconds of a chosen earthquake's window before it rises above the noise, and after it fell back."""

TRAVEL = 300.0
"""Seconds within which the waves of an earthquake that matters arrive, 2,000 km from it and less."""

LONGEST = 31 * 86400.0
"""Seconds of a recording that are searched."""


@dataclass(frozen=True)
class Earthquake:
    """Shaking that stands above the noise.

    Attributes
    ----------
    begins, ends : obspy.UTCDateTime
        When it rises above the noise and falls back, to a second.
    peak : float
        In the unit of the samples, between 1 and 20 Hz.
    strongest : obspy.UTCDateTime
        The second of the peak.
    """

    begins: Any
    ends: Any
    peak: float
    strongest: Any


def earthquakes(pieces: Sequence[Piece], start: Any = None, end: Any = None) -> list[Earthquake]:
    """Return the earthquakes of a channel, those whose peak is SMALL beside the largest left out.

    Parameters
    ----------
    pieces : sequence of Piece
        Of one channel, by time.
    start, end : obspy.UTCDateTime, optional
        Between which is searched; None: all.

    Returns
    -------
    list of Earthquake
        By time, at most MOST_TOLD.

    Notes
    -----
    The root mean square of each second is compared with the noise of its block, the quietest tenth of its seconds; an
    average over the minutes before, as a trigger in a field has it, would miss what a triggered record begins with.
    Memory: that of one block and of one number a second.
    """
    found: list[Earthquake] = []
    for piece in pieces:
        first = piece.start if start is None else max(piece.start, start)
        last = piece.end if end is None else min(piece.end, end)
        if last - first > LEAST:
            found += _in_piece(piece, first, min(last, first + LONGEST))
    largest = max((one.peak for one in found), default=0.0)
    told = sorted((one for one in found if one.peak >= SMALL * largest), key=lambda one: -one.peak)[:MOST_TOLD]
    return sorted(told, key=lambda one: one.begins.ns)


def _in_piece(piece: Piece, first: Any, last: Any) -> list[Earthquake]:
    load_obspy()
    from obspy.signal.trigger import trigger_onset

    peak, ratio = [], []
    at = first
    while at < last:
        # A block that would leave less than another is taken with what is left.
        end = at + BLOCK if last - at > 1.5 * BLOCK else last
        rms, most = _seconds(piece, at, end)
        at = end
        if rms.size == 0:
            continue
        noise = np.quantile(rms, NOISE_SHARE)
        peak.append(most)
        ratio.append(rms / noise if noise > 0.0 else np.where(rms > 0.0, np.inf, 0.0))
    if not peak:
        return []
    peaks, ratios = np.concatenate(peak), np.concatenate(ratio)
    spans: list[list[int]] = []
    for a, b in trigger_onset(ratios, ON, OFF):
        if spans and a - spans[-1][1] <= QUIET:
            spans[-1][1] = int(b)
        else:
            spans.append([int(a), int(b)])
    found = [(a, b, a + int(np.argmax(peaks[a : b + 1]))) for a, b in spans if b - a + 1 >= LEAST]
    return [Earthquake(first + a, first + b + 1, float(peaks[at]), first + at) for a, b, at in found]


def _seconds(piece: Piece, start: Any, end: Any) -> tuple[Array, Array]:
    """Root mean square and peak of each whole second between two times, in the band."""
    return in_seconds(piece.between(start, end).data, piece.dt)


def in_seconds(samples: Any, dt: float) -> tuple[Array, Array]:
    """Return root mean square and peak of each whole second, in the band.

    Parameters
    ----------
    samples : array, shape (n,)
        In any unit; what is masked or not finite counts as zero.
    dt : float
        Time step in s.

    Returns
    -------
    (array, array), each of shape (seconds,)
        Nothing for less than two seconds, or less than four samples in one.
    """
    from scipy.signal import butter, sosfilt, sosfilt_zi

    data = np.nan_to_num(np.asarray(np.ma.filled(samples, 0), dtype=np.float64), posinf=0.0, neginf=0.0)
    rate = 1.0 / dt
    count = round(rate)
    if count < 4 or data.size < 2 * count:
        return np.zeros(0), np.zeros(0)
    low, high = BAND[0], min(BAND[1], 0.4 * rate)
    sos = butter(2, (low, high), "bandpass", fs=rate, output="sos")
    # At rest on the first sample, so that a block does not begin with the filter's answer to it.
    band, _ = sosfilt(sos, data, zi=sosfilt_zi(sos) * data[0])
    seconds = band[: data.size // count * count].reshape(-1, count)
    return np.sqrt((seconds * seconds).mean(axis=1)), np.abs(seconds).max(axis=1)


def listed(found: Sequence[Earthquake], factor: float = 0.0) -> str:
    """Return earthquakes in words.

    Parameters
    ----------
    found : sequence of Earthquake
        By time.
    factor : float
        m/s2 of one unit of the samples; 0 where it is not known.

    Returns
    -------
    str
        Times in UTC, peaks, and how long each lasts.
    """

    def told(one: Earthquake) -> str:
        peak = f"{one.peak * factor / G:.3g} g" if factor else f"{one.peak:.4g} counts"
        return f"{str(one.begins)[:19]}Z, {one.ends - one.begins:.0f} s, peak {peak}"

    return "; ".join(map(told, found)) or "none"


def window_of(channels: Sequence[Sequence[Piece]], origin: Any) -> tuple[float, float]:
    """Return the window of the earthquake that arrives first after an origin time, or is stronger after it than before.

    Parameters
    ----------
    channels : sequence of sequence of Piece
        Of each component, by time; the first is searched.
    origin : obspy.UTCDateTime
        Of the earthquake, or when it was found to begin.

    Returns
    -------
    (float, float)
        In s from the origin, inside the pieces that hold its beginning.

    Raises
    ------
    InputError
        Naming the earthquakes that were found instead.
    """
    pieces = channels[0]
    near = earthquakes(pieces, origin - 2.0 * TRAVEL, origin + 4.0 * TRAVEL)
    # Shaking that a foreshock began is the earthquake's, where its peak comes after the origin.
    chosen = next(
        (
            one
            for one in near
            if one.begins - origin <= TRAVEL and (one.begins >= origin - 5.0 or one.strongest >= origin)
        ),
        None,
    )
    if chosen is None:
        # A triggered record that is shaken from end to end has no noise to rise above.
        short = [p for p in pieces if -60.0 <= p.start - origin <= TRAVEL and p.end - p.start < BLOCK]
        if len(pieces) == 1 or not short:
            raise InputError(
                f"origin_time: no earthquake is found within {TRAVEL:g} s after {origin}; give window_s as well, "
                f"or the time of one of these: {listed(earthquakes(pieces))}"
            )
        chosen = Earthquake(short[0].start, short[0].end, 0.0, short[0].start)
    start, end = chosen.begins - BEFORE, chosen.ends + AFTER
    for channel in channels:
        for piece in channel:
            if piece.start <= chosen.begins + 1.0 and piece.end >= chosen.begins:
                start, end = max(start, piece.start), min(end, piece.end)
    return start - origin, end - origin
