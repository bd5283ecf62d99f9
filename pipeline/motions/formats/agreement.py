"""What a header says twice: length, time of the peak, and a velocity beside its acceleration, held against the step.

A time step that is half or double of the true one makes an accelerogram like any other.  What else the header says in
seconds is all that tells it.
"""

from __future__ import annotations

import numpy as np

from pipeline.motions.formats.record_text import Lines
from pipeline.quantities import Array

LENGTH_TOLERANCE = 0.02
"""How far a printed length may be from that of the samples, of itself (judgement)."""

ALIKE = 0.97
"""Share of the peak from which on a sample may be the one that was meant: agencies print the time of a crest that the
correction of the instrument moved (judgement)."""

TIME_TOLERANCE, SAMPLES = 0.02, 2.5
"""s and samples that the printed time of a peak may be off: it is printed with two digits, and counted from 0 or 1."""

MISTAKEN = (0.1, 0.2, 0.25, 0.4, 0.5, 2.0, 2.5, 4.0, 5.0, 10.0)
"""Factors by which a step is mistaken: a printed time that none of them explains counts from another second."""

EARLIEST = 2.0
"""s: a peak before is as near to others by chance."""

SLOPE, FOLLOWS = (0.8, 1.25), 0.9
"""How much faster or slower a velocity may change than its acceleration, and how well it follows it at least.

Of a dozen recorded channels the slope is 1.00 to 1.08, with a correlation of 0.99 and more; the larger ones are of a
record that was thinned to 50 samples a second after it was integrated."""

_REMEDY = "find out which is right, and mend the other"


def said_length(lines: Lines, index: int, said: float, count: int, dt: float) -> None:
    """Refuse a record whose header prints another length than its samples and its step come to.

    Parameters
    ----------
    lines, index : Lines, int
        The file, and the line that says it, from 0.
    said : float
        The length in s; zero and below is taken for one that was not filled in.
    count, dt : int, float
        Samples, and their step in s.

    Raises
    ------
    FormatError
        That names both.
    """
    if said > 0.0 and abs(said - count * dt) > LENGTH_TOLERANCE * said + 1.5 * dt + 0.01:
        wrong = f"says a length of {said:g} s, and {count} samples with a step of {dt:g} s have {count * dt:g} s"
        raise lines.error(index, wrong, _REMEDY)


def told_length(lines: Lines, index: int, said: float, count: int, dt: float) -> None:
    """Refuse a record of which a head says a length that another step would give, as `said_length` in its parameters.

    Where it is no more than "Duration" it may be that of the strong part, and another one tells nothing.
    """
    if any(abs(said - factor * count * dt) <= 2.5 * factor * dt + 0.01 for factor in MISTAKEN):
        said_length(lines, index, said, count, dt)


def said_time(lines: Lines, index: int, said: float, data: Array, dt: float) -> None:
    """Refuse a record whose header prints a time of the peak at which, by its step, it is not, but by another would be.

    Parameters
    ----------
    lines, index : Lines, int
        The file, and the line that says it, from 0.
    said : float
        The time in s from the first sample; before EARLIEST nothing is told by it.
    data : array, shape (n,)
        The samples.
    dt : float
        Their step in s.

    Raises
    ------
    FormatError
        That names both.
    """
    if said < EARLIEST:
        return
    sizes = np.abs(data), np.abs(data - data.mean())
    if not all(size.any() for size in sizes):
        return
    crests = np.flatnonzero(np.logical_or(*(size >= ALIKE * size.max() for size in sizes)))

    def there(step: float) -> bool:
        return bool(np.abs(crests * step - said).min() <= TIME_TOLERANCE + SAMPLES * step)

    if there(dt):
        return
    factor = next((factor for factor in MISTAKEN if there(factor * dt)), None)
    if factor is not None:
        at = float(crests[np.argmin(np.abs(crests * factor * dt - said))] * dt)
        wrong = f"says a peak at {said:g} s, and with its step of {dt:g} s that is at {at:.4g} s"
        raise lines.error(index, f"{wrong}, with one of {factor * dt:g} s where it says", _REMEDY)


def own_velocity(lines: Lines, index: int, acceleration: Array, velocity: Array, dt: float) -> None:
    """Refuse a record whose velocity changes faster or slower than its acceleration lets it.

    Parameters
    ----------
    lines, index : Lines, int
        The file, and a line of its header, from 0.
    acceleration, velocity : array, shape (n,)
        In m/s2 and m/s, at the same samples.
    dt : float
        Their step in s.

    Raises
    ------
    FormatError
        That names the ratio.
    """
    changes = np.diff(velocity) / dt
    middle = 0.5 * (acceleration[1:] + acceleration[:-1])
    changes, middle = changes - changes.mean(), middle - middle.mean()
    power, other = float(middle @ middle), float(changes @ changes)
    if power == 0.0 or other == 0.0:
        return
    both = float(changes @ middle)
    slope = both / power
    if both >= FOLLOWS * np.sqrt(power * other) and not SLOPE[0] <= slope <= SLOPE[1]:
        wrong = f"the velocity changes {slope:.3g} times as fast as the acceleration says, with a step of {dt:g} s"
        raise lines.error(index, wrong, "its step, or the unit of one of the two, is wrong: fetch it again")
