"""Plateaus of a clipped channel: held levels that are not exactly flat, and peaks at a digitiser's full scale."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from pipeline.quantities import Array

LENGTHS = (0.05, 0.1, 0.2, 0.4, 0.8, 1.6, 3.2, 6.4, 12.8, 25.6)
"""s: for which a level is looked for that is held; each finds what is held for up to three times as long."""

LEAST_SAMPLES = 5

HIGH = 0.3
"""Share of the peak above which a level may be a limit: a channel that comes back from it may overshoot."""

FALL = 0.1
"""Share of the peak by which the motion must fall on both sides of a plateau."""

SHARPNESS = 60.0
"""Least ratio of the fall within one length on both sides to what changes over the plateau itself.

A parabola falls by 8 times what it changes over its crest; where more crests help, it is up to 24 in 78 clean channels
(film, digital, raw and processed) and above 60 in one of 300 simulated ones.  Clipped and smoothed it is up to 1,000.
"""

REST = 0.3
"""Share of the plateau's level that the rest of the record must reach: a step alone is a fault of the baseline."""

BESIDE = 0.25
"""s beside what is at a level that belong to the way there and back."""

FULL_SCALES = (2.0**23, 2.0**15)
"""Counts of digitisers of 24 and of 16 bits."""

NEAR_FULL = 0.9
"""Share of the full scale from which on a peak is taken for clipped: sensors give out before the digitiser does."""


@dataclass(frozen=True, slots=True)
class Plateau:
    """A level that is held.

    Attributes
    ----------
    level : float
        In the data's unit.
    start : int
        Its first sample.
    samples : int
        For how many it is held.
    """

    level: float
    start: int
    samples: int


def held(row: Array, dt: float) -> Plateau | None:
    """Find the sharpest level that a channel holds amid its shaking; None where it holds none.

    Unlike a flat top it may ripple, as behind a digitiser's filter, and lie below the largest sample.

    Parameters
    ----------
    row : array, shape (n,)
        In any unit, counts included.
    dt : float
        Time step in s.

    Returns
    -------
    Plateau or None

    Notes
    -----
    Error: clipped at 90, 70, 50 and 30 % of their peak at four times the rate and then decimated, 13, 31, 61 and 63 %
    of real channels are found, and none of 78 as they were.

    References
    ----------
    Kleckner, J. K. et al. (2022), Automated detection of clipping in broadband earthquake records, SRL 93, 880-896:
    the standard deviation about a sample, here at several lengths and against the fall beside it, and the amplitude.
    """
    x = row - np.median(row)
    peak = float(np.abs(x).max())
    steps = np.abs(np.diff(x))
    steps = steps[steps > 0.0]
    if not steps.size:
        return None
    # Nothing is flatter than its own resolution, which for a coarse record is the step from sample to sample.
    finest = max(float(np.median(steps)), 1e-3 * peak)
    best, found = SHARPNESS, None
    for seconds in LENGTHS:
        m = round(seconds / dt)
        if m < LEAST_SAMPLES or 3 * m >= x.size:
            continue
        for sign in (1.0, -1.0):
            low, high = _extremes(sign * x, m)
            at = m + np.flatnonzero(low[m : x.size - 2 * m] >= HIGH * peak)
            fall = low[at] - np.maximum(low[at - m], low[at + m])
            sharp = np.where(fall > FALL * peak, fall / np.maximum(high[at] - low[at], finest), 0.0)
            k = int(np.argmax(sharp)) if at.size else 0
            if at.size and sharp[k] > best and _amid_shaking(x, float(low[at[k]]), dt):
                level = float(np.median(row[at[k] : at[k] + m]))
                best, found = float(sharp[k]), Plateau(level, int(at[k]), m)
    return found


def full_scale(counts: Array) -> tuple[float, int] | None:
    """Find the full scale that a channel of counts comes close to, and the sample where; None where it stays below.

    Parameters
    ----------
    counts : array, shape (n,)
        As the digitiser gave them.

    Returns
    -------
    (float, int) or None
        The full scale in counts and the sample.
    """
    size = np.abs(counts)
    at = int(np.argmax(size))
    for scale in FULL_SCALES:
        if NEAR_FULL * scale <= size[at] <= scale:
            return scale, at
    return None


def _extremes(y: Array, m: int) -> tuple[Array, Array]:
    """The smallest and the largest of each m samples, by the first of them."""
    from scipy.ndimage import maximum_filter1d, minimum_filter1d

    # The origin moves the window from its centre to its first sample.
    shift = -(m // 2)
    last = y.size - m + 1
    low: Array = minimum_filter1d(y, m, origin=shift)[:last]
    high: Array = maximum_filter1d(y, m, origin=shift)[:last]
    return low, high


def _amid_shaking(x: Array, level: float, dt: float) -> bool:
    """Whether the record reaches a share of a level elsewhere than on the way to it and back."""
    from scipy.ndimage import binary_dilation

    beside = 2 * round(BESIDE / dt) + 1
    rest = np.abs(x[~binary_dilation(np.abs(x) >= 0.5 * level, np.ones(beside, dtype=bool))])
    return bool(rest.size) and float(rest.max()) >= REST * level
