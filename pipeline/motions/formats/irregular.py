"""Accelerations at irregular times, as they were digitised from film, brought to equal steps."""

from __future__ import annotations

import numpy as np

from pipeline.motions.formats import blocks
from pipeline.motions.formats.record_text import Lines
from pipeline.quantities import Array

RESAMPLED = 0.005
"""Step in s that irregular pairs are resampled onto, unless the caller asks for another: the USGS's own choice for the
corrected version of such records."""

_NO_TIME = 0.1
"""Share of steps back from which on a column is no time (judgement): accelerations go back at half of their steps."""


def resampled(lines: Lines, index: int, per_line: int, times: Array, data: Array, dt: float) -> tuple[Array, str]:
    """Return the samples at equal steps, linearly between those that were digitised.

    Parameters
    ----------
    lines, index, per_line : Lines, int, int
        The file, the first line of the pairs, from 0, and pairs in a line.
    times, data : array, shape (n,)
        Times in s, and what was recorded then.
    dt : float
        Time step in s.

    Returns
    -------
    array, str
        The samples, and what was done, in words.

    Raises
    ------
    FormatError
        For times that go back, or pairs too few for their length.
    """
    blocks.step(lines, index, dt)
    spacing = np.diff(times)
    if (spacing < 0.0).any():
        at = int(np.argmax(spacing < 0.0)) + 1
        wrong = f"time goes back from {times[at - 1]:g} s to {times[at]:g} s"
        raise lines.error(index + at // per_line, wrong)
    count = int((times[-1] - times[0]) / dt + 1e-9) + 1
    blocks.samples(lines, index, count)
    # Digitised times come by the thousandth of a second; a time in days or a typing error would ask for gigabytes.
    if count > 100 * len(times):
        wrong = f"{len(times)} pairs over {times[-1] - times[0]:g} s are too few to be resampled to {dt:g} s"
        raise lines.error(index, wrong, "ask for a longer step, or fetch the file again")
    told = (
        f"linearly from {len(times)} pairs at irregular times ({np.median(spacing):.3g} s apart on the middle, at most "
        f"{spacing.max():.3g} s) to a step of {dt:g} s"
    )
    return np.interp(times[0] + dt * np.arange(count), times, data), told


def rounding(digit: float, dt: float, times: Array) -> Array:
    """Return how far times may lie off their even steps for how they are printed.

    A table that shows 0.01 s of a step of 0.005 s has each time within half of that, and a sample that is missing is
    a whole step; finer ones may also be cut off, and their first one is rounded as well.  Programs that print six
    digits have fewer places from 10 s on.

    Parameters
    ----------
    digit, dt : float
        One in the last printed place at the beginning, and the step, in s.
    times : array, shape (n,)
        In s.

    Returns
    -------
    array, shape (n,)
        In s.
    """
    six = 0.51e-5 * 10.0 ** np.floor(np.log10(np.maximum(np.abs(times), 1e-9)))
    coarse = 0.51 * digit if digit <= 2.01 * dt else 0.0
    return np.maximum(np.minimum(np.maximum(1.02 * digit, six), 0.2 * dt), coarse)


def off_step(times: Array) -> tuple[int, str, str]:
    """Say where times go on by another step than elsewhere.

    Parameters
    ----------
    times : array, shape (n,)
        In s, as `even_step` does not take them.

    Returns
    -------
    int
        The row of the time that is off, from 0.
    str
        What is wrong.
    str
        What mends it.
    """
    steps = np.diff(times)
    usual = float(np.median(steps))
    worst = int(np.argmax(np.abs(steps - usual))) + 1
    step = float(steps[worst - 1])
    told = f"its times go on by {step:.6g} s to {times[worst]:g} s, and by {usual:.6g} s elsewhere"
    if (steps < 0.0).mean() > _NO_TIME:
        wrong = "its first column goes back and forth, as no time does"
        remedy = "name the columns: kouros motions convert FILE --columns ns,ew,ud --dt 0.01 --unit g --out FOLDER"
        return worst, wrong, remedy
    if usual > 0.0 and step > 1.5 * usual:
        return worst, told, "samples are missing: give the record without the gap, or its longer part"
    if usual <= 0.0:
        worst = int(np.argmin(steps)) + 1
        wrong = f"it and {int((steps <= 0.0).sum()) - 1} rows more have the time of the row before them"
        return worst, wrong, "rows came twice, or times are rounded too far: give equal time steps"
    if step <= 0.0:
        return worst, told, "rows came twice, or their times are rounded too far: give equal time steps"
    return worst, told, "give equal time steps: resample the record first"


def even_step(times: Array, digit: float) -> float | None:
    """Return the step of times that are even but for their rounding, None where they are not.

    Parameters
    ----------
    times : array, shape (n,)
        In s.
    digit : float
        One in their last printed place, in s.

    Returns
    -------
    float or None
        In s; one over a whole number of samples per second where that is as near.
    """
    dt = float(times[-1] - times[0]) / (len(times) - 1)
    if not blocks.STEP_LEAST <= dt <= blocks.STEP_MOST:
        return None
    whole = 1.0 / max(1, round(1.0 / dt))
    if abs(whole - dt) * (len(times) - 1) <= digit:
        dt = whole
    off = np.abs(times - times[0] - dt * np.arange(len(times)))
    return dt if (off <= rounding(digit, dt, times)).all() else None
