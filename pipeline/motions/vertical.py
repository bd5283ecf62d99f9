"""Vertical of a record of two components, estimated from its larger horizontal by a published ratio of spectra."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pipeline.quantities import Array, G
from pipeline.records import Motion

SOURCE = "EN 1998-1:2004, 3.2.2.2 and 3.2.2.3, type 1, ground A, a_vg/a_g 0.90"
"""Whose ratio it is; for earthquakes of Ms 5.5 and less (type 2) the same clause has half of it, 0.45."""

SCATTER = 2.0
"""Factor within which the ratio of a single record lies of the code's, mostly (judgement)."""

_PEAK = 0.90
_VERTICAL = (0.05, 0.15, 1.0, 3.0)
_HORIZONTAL = (0.15, 0.40, 2.0, 2.5)
_LONGEST = 4.0
_PAD = 20.0
"""s of zeros on both sides, five of the longest periods at which the ratio changes."""


def ratio(periods: Array) -> Array:
    """Return the ratio of the vertical elastic response spectrum to the horizontal one, both at 5 % damping.

    Parameters
    ----------
    periods : array
        In s; beyond 4 s, where the spectra end, the ratio is that of 4 s.

    Returns
    -------
    array
        Of the same shape, 0.90 at a period of zero.

    References
    ----------
    EN 1998-1:2004, 3.2.2.2 (1) and table 3.2 for the horizontal spectrum (ground A), 3.2.2.3 (1) and table 3.4 for the
    vertical one.
    """
    t = np.minimum(np.asarray(periods, dtype=np.float64), _LONGEST)
    return _PEAK * _shape(t, *_VERTICAL) / _shape(t, *_HORIZONTAL)


def _shape(t: Array, b: float, c: float, d: float, most: float) -> Array:
    """An elastic spectrum relative to its peak ground acceleration, of the corner periods TB, TC and TD."""
    safe = np.maximum(t, c)
    falling = most * np.where(t <= d, c / safe, c * d / (safe * safe))
    return np.where(t <= b, 1.0 + t / b * (most - 1.0), np.where(t <= c, most, falling))


def with_vertical(motion: Motion, channels: Sequence[str]) -> Motion:
    """Return a motion with a vertical that is made from the larger horizontal.

    Parameters
    ----------
    motion : Motion
        With horizontals as recorded, and no vertical.
    channels : sequence of str
        What the horizontals are called.

    Returns
    -------
    Motion
        With the vertical, and the step.

    Notes
    -----
    A filter without phase multiplies each frequency of the horizontal by `ratio` at its period.  The response spectra
    then have that ratio where the shaking is rich in the frequency; what the peaks have to each other follows from the
    record.  Limits: the vertical has the horizontal's phase, so that its peaks come with those of the horizontal.
    That is harder on what lifts and slides at once than a recorded vertical, which is strongest in the P waves before.
    Which way is up is chance.  The ratio is that of firm ground at no distance in particular; near a fault more is
    recorded.  For four records of 1979 to 2019 the peak was 0.65, 1.2, 1.2 and 2.0 times the recorded one.
    """
    row = int(np.argmax(np.abs(motion.acceleration[:2]).max(axis=1)))
    base, dt = motion.acceleration[row], motion.dt
    pad = int(np.ceil(_PAD / dt))
    padded = np.pad(base, pad)
    frequency = np.fft.rfftfreq(padded.size, dt)
    gain = ratio(1.0 / np.maximum(frequency, 0.5 / _LONGEST))
    whole = np.fft.irfft(gain * np.fft.rfft(padded), padded.size)
    # What the filter answers before the first sample has moved the ground already.
    lead = whole[: pad + 1]
    begin = gain[0] * motion.start[row] + dt * float(lead.sum() - 0.5 * (lead[0] + lead[-1]))
    made = whole[pad : pad + base.size]
    peaks = [np.abs(one).max() / G for one in (base, made)]
    at = ", ".join(f"{ratio(np.array(t)):.2g} at {t:g} s" for t in (0.05, 0.1, 1.0))
    step = (
        f"vertical estimated from {channels[row]}, the larger horizontal ({peaks[0]:.3g} g), each frequency times the "
        f"ratio of vertical to horizontal spectra: {at} ({SOURCE}; half of it for type 2); its peak is {peaks[1]:.3g} "
        f"g, and one that was recorded is within a factor of {SCATTER:g} of that ({peaks[1] / SCATTER:.3g} to "
        f"{peaks[1] * SCATTER:.3g} g, judgement); its phase is the horizontal's"
    )
    x, y, _ = motion.start
    a = np.stack([*motion.acceleration[:2], made])
    return Motion(dt, a, motion.name, (*motion.steps, step), motion.source, (x, y, begin), motion.v_max)
