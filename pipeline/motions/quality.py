"""Warnings about a record, for an engineer before its shaking is believed: flat tops, and ends amid the shaking."""

from __future__ import annotations

from itertools import combinations

import numpy as np

from pipeline.motions.doubts import ALIKE, ODD_ONE
from pipeline.motions.plateaus import held
from pipeline.quantities import Array

TOP_RUN = 3
"""Samples in a row at the extreme value that make a flat top by themselves."""

TOP_PAIRS = 3
"""Pairs of samples at the extreme value, at uneven distances, that make a clipped channel together."""

SHOULDER_COUNTS = 10.0
"""Counts by which the samples on both sides of a flat top lie below it.

A crest that is smooth (a parabola over its few samples) and holds three samples within one count falls by at most 5.3
counts to the next sample on either side, one that holds two by at most 9: what falls by more was cut off.
"""

SHOULDER_SHARE = 2e-3
"""The same relative to the peak, for numbers without counts: twenty times the coarsest step of five printed digits."""

SPIKE = 3.0
"""Times that a sample stands farther out from between its neighbours than any that is no spike.

Of 104 recorded channels those that are sound have up to 1.84, behind their first samples; three have such samples: two
that are clipped, and one in which zeros stand for samples that were lost.
"""

SPIKE_SHARE = 0.3
"""Least share of the peak by which it does."""

SPIKES, SPIKE_APART = 5, 3
"""Most spikes that are looked for, and samples around each that belong to it."""

TWINS = 1e-5
"""How far the correlation of two components may be below one for them to be the same numbers, printed twice."""

UNEVEN, LARGEST_VERTICAL, LEAST_VERTICAL = 5.0, 4.0, 1.0 / 15.0
"""Ratios of r.m.s. accelerations beyond which a component is doubted (judgement): of the horizontals, and of the
vertical to the larger of them.

Of 26 recordings the horizontals differ by up to 2.7, and the vertical has 0.26 to 2.0 of the larger; one of instrument
pulses has 10.7.  A component in g among those in m/s2 makes 9.8.
"""

LONG_RUN = 5
"""Samples in a row whose edges may take two samples, because the limit may lie just above the first one outside.

The parabola of SHOULDER_COUNTS with five samples within one count falls by at most 4.3 counts over two more.
"""

COUNT_SHARE = 1e-3
"""Most that samples of a flat top may differ, relative to the peak: a coarser count must be hit exactly."""

COARSE = 0.05
"""Share of equal neighbours from which on a record counts as coarse, and its largest count relative to the peak
(judgement)."""

ENDS = 1.0
"""Seconds at either end whose shaking is compared with the strong part (a tenth of a record shorter than 10 s)."""

END_SHARE = 0.22
"""Most r.m.s. acceleration of the last second relative to that of the strong part, of a horizontal component.

Complete records (eight, on film and digital, raw and processed, of 30 to 390 s) have at most 0.10, and a weak one whose
coda still runs when its instrument stops 0.20; cut off anywhere between 6 and 95 % of their Arias intensity they have
0.25 and more, half of the cuts 1.2 and more.
"""

START_SHARE = 0.5
"""The same for the first second: an accelerograph that waits for a trigger begins in the P waves, with up to 0.26 in
those records; begun anywhere between 6 and 95 % of their Arias intensity they have 0.64 and more."""


OVERFLOW = 0.85
"""Share of a channel's range that it goes through within one sample where a digitiser overflows: from one limit to the
other.  A shaking that is sampled so coarsely goes back and forth with every sample, see SMOOTH."""

SMOOTH = 0.35
"""Most share of the range that the steps beside an overflow take (judgement)."""

RARE = 0.1
"""Most share of all steps that overflow (judgement)."""

DROP = 0.2
"""Least share of the range by which a channel falls to a level at once, and comes back, that is held for DROP_RUN
samples to the last digit: what is beyond a limit was left out."""

DROP_RUN, DROP_ALONE = 3, 8
"""The same of one that is the only one (judgement): four zeros amid a weak record are a fault of its transmission."""


HOLD_RUN, HOLD_COUNTS, HOLD_SHARE, HOLD_EDGE = 20, 100.0, 2e-3, 3.0
"""Samples that one level is held for, counts and share of the range of the usual step before and behind it, and times
that of the step into it or out of it, from which a channel has dropped out, or hung, however small the step is.

Of 104 recorded channels none has such a run; film that was interpolated has runs of up to 17.
"""

_LEAST_SHAKEN, _FEW_CROSSINGS = 50, 8
"""Samples from which a channel is looked at, and crossings of its trend that are too few for shaking (judgement)."""


def clipped(data: Array, dt: float, channels: tuple[str, ...]) -> str | None:
    """Say which channel was cut off at the limit of its instrument, and where; None where none was.

    Looked for are tops that are flat to within a digitiser's count and have sharp edges: three samples in a row, or
    several pairs at uneven distances (a sine that is sampled in step with its period repeats its pairs evenly).  A
    single sample at the limit cannot be told from a crest.  A limit that a filter smoothed is no longer flat: levels
    that are held are looked for, see `plateaus.held`.  What overflowed, or was left out beyond a limit, jumps.  Give
    the samples as the file has them, with their response.

    Parameters
    ----------
    data : array, shape (rows, n)
        In any unit, counts included.
    dt : float
        Time step in s.
    channels : tuple of str
        What the rows are called.

    Returns
    -------
    str or None
        A sentence with the channel, the level in the data's unit, the sample and the time from the first sample.

    References
    ----------
    Kleckner, J. K. et al. (2022), Automated detection of clipping in broadband earthquake records, SRL 93, 880-896, for
    the flat top; the bounds follow from the parabola of a crest, see SHOULDER_COUNTS.
    """
    for row, channel in zip(data, channels, strict=True):
        for sign, side in ((1.0, "upper"), (-1.0, "lower")):
            starts, lengths = _flat_tops(sign * row)
            longest = int(lengths.max(initial=0))
            uneven = starts.size >= TOP_PAIRS and int(np.ptp(np.diff(starts))) > 2
            if longest >= TOP_RUN or uneven:
                at = int(starts[np.argmax(lengths)])
                return (
                    f"{channel} is clipped: its {side} limit of {row[at]:.6g} is held for {longest} samples from "
                    f"sample {at} ({at * dt:.6g} s), and {starts.size} tops in all are flat"
                )
        if (plateau := held(row, dt)) is not None:
            return (
                f"{channel} is clipped: it holds {plateau.level:.6g} for {plateau.samples} samples and more from "
                f"sample {plateau.start} ({plateau.start * dt:.6g} s), and falls away on both sides"
            )
        if (jump := _jumped(row) or _spiked(row)) is not None:
            at, how = jump
            return f"{channel} {how} from sample {at} ({at * dt:.6g} s)"
    return None


def alike(data: Array) -> str | None:
    """Say that two components of a record are one and the same but for a factor; None where they are not.

    Parameters
    ----------
    data : array, shape (3, n)
        In any unit, the horizontals first.

    Returns
    -------
    str or None
        What is so.
    """
    rows = data - data.mean(axis=1, keepdims=True)
    for a, b in combinations(range(len(rows)), 2):
        size = float(np.sqrt((rows[a] @ rows[a]) * (rows[b] @ rows[b])))
        if size > 0.0 and abs(float(rows[a] @ rows[b])) >= (1.0 - TWINS) * size:
            factor = float(rows[a] @ rows[b]) / float(rows[a] @ rows[a])
            return f"two components are the same numbers, {'xyz'[b]} {factor:.4g} times {'xyz'[a]}{ALIKE}"
    return None


def uneven(data: Array) -> str | None:
    """Say that one component of a record is far stronger or weaker than the others; None where none is.

    Parameters
    ----------
    data : array, shape (3, n)
        In m/s2, the horizontals first; a component that is zero throughout is not looked at.

    Returns
    -------
    str or None
        What is so.
    """
    x, y, z = np.sqrt(((data - np.median(data, axis=1, keepdims=True)) ** 2).mean(axis=1)).tolist()
    larger = max(x, y)
    if min(x, y) > 0.0 and larger > UNEVEN * min(x, y):
        strong, weak, ratio = "xy"[y > x], "xy"[x > y], larger / min(x, y)
    elif z > 0.0 and larger > 0.0 and not LEAST_VERTICAL <= z / larger <= LARGEST_VERTICAL:
        strong, weak, ratio = "xy"[y > x], "z", larger / z
        if z > larger:
            strong, weak, ratio = weak, strong, z / larger
    else:
        return None
    return f"{strong} is {ratio:.3g} times as strong as {weak}{ODD_ONE}"


def one_sided(row: Array) -> str | None:
    """Say that numbers are no shaking: never below zero (or above), and about their own trend all but still.

    A spectrum or an envelope under the unit of an acceleration is so.  What is shaken crosses its trend again and
    again, also where a sensor's offset keeps it on one side of zero.

    Parameters
    ----------
    row : array, shape (n,)
        Samples of one channel, in any unit.

    Returns
    -------
    str or None
        None for a record.
    """
    if len(row) < _LEAST_SHAKEN or (row.min() < 0.0 < row.max()) or not np.ptp(row):
        return None
    place = np.linspace(-1.0, 1.0, len(row))
    about = row - np.polynomial.Polynomial.fit(place, row, 1)(place)
    crossings = int(np.count_nonzero(np.diff(np.signbit(about))))
    if crossings > _FEW_CROSSINGS:
        return None
    side = "below" if row.max() > 0.0 else "above"
    return f"is never {side} zero, and crosses its own trend {crossings} times in {len(row)} samples: no shaking does"


def cut_off(data: Array, dt: float, channels: tuple[str, ...]) -> str | None:
    """Say whether a record ends, or begins, during strong shaking, and of which channel; None where it is complete.

    The r.m.s. acceleration of the last and of the first second, about the median, is compared with that of the strong
    part, when 5 to 95 % of the Arias intensity of both horizontals arrive.  The vertical is not asked: a triggered
    instrument misses the beginning of the P waves as a rule.

    Parameters
    ----------
    data : array, shape (3, n)
        In any unit, the horizontals first.
    dt : float
        Time step in s.
    channels : tuple of str
        What the rows are called.

    Returns
    -------
    str or None
        A sentence with the channel, the sample and the time from the first sample.

    References
    ----------
    Trifunac, M. D. and Brady, A. G. (1975) for the strong part, outside of which a complete record is quiet; the shares
    are between what complete and cut records have, see END_SHARE.
    """
    level = data[:2] - np.median(data[:2], axis=1, keepdims=True)
    square = level * level
    arrived = np.cumsum(square.sum(axis=0))
    n = arrived.size
    if arrived[-1] == 0.0:
        return None
    first, last = (int(np.searchsorted(arrived, share * arrived[-1])) for share in (0.05, 0.95))
    strong = np.sqrt(square[:, first : last + 1].mean(axis=1))
    count = max(2, round(min(ENDS / dt, 0.1 * n)))
    said, most = None, 1.0
    for share, at, what in ((END_SHARE, n - count, "ends"), (START_SHARE, 0, "begins")):
        size = np.sqrt(square[:, at : at + count].mean(axis=1))
        ratio = np.divide(size, strong, out=np.zeros(2), where=strong > 0.0)
        row = int(np.argmax(ratio))
        # Of a record that begins late, what is left is flat to its end: the graver of the two is told.
        if ratio[row] / share > most:
            most = float(ratio[row]) / share
            said = (
                f"{channels[row]} {what} during strong shaking: over {count * dt:.3g} s from sample {at} "
                f"({at * dt:.6g} s) its r.m.s. acceleration is {ratio[row]:.0%} of that of the strong part "
                f"({first * dt:.6g} to {last * dt:.6g} s), more than {share:.0%}"
            )
    return said


def _jumped(row: Array) -> tuple[int, str] | None:
    """The first sample behind a jump that no shaking makes, and what it is; None for none."""
    steps = np.diff(row)
    size = float(np.ptp(row))
    if size == 0.0 or steps.size < 3:
        return None
    beside = np.abs(np.concatenate([[0.0], steps, [0.0]]))
    through = (beside[1:-1] >= OVERFLOW * size) & (np.maximum(beside[:-2], beside[2:]) <= SMOOTH * size)
    # A channel that rises to its limit goes on rising from the other one.
    signs = np.sign(np.concatenate([[0.0], steps, [0.0]]))
    over = np.flatnonzero(through & (signs[:-2] * signs[1:-1] <= 0.0) & (signs[2:] * signs[1:-1] <= 0.0))
    # A tone of a quarter of the sampling rate goes through its range with every other sample.
    rare = np.count_nonzero(through) <= RARE * steps.size
    if rare and over.size >= 2 and np.ptp(np.sign(steps[over])) > 0.0:
        return int(over[0]) + 1, f"is clipped: it goes from one limit to the other within a sample, {over.size} times"
    edges = np.diff(np.concatenate([[False], steps == 0.0, [False]]).astype(np.int8))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    # The steps into a run of equal samples and out of it; at either end of the record there is none.
    into, out = beside[starts], beside[ends + 1]
    dropped = np.flatnonzero((ends - starts + 1 >= DROP_RUN) & (np.minimum(into, out) >= DROP * size))
    longest = int((ends - starts + 1)[dropped].max(initial=0))
    if dropped.size >= 2 or longest >= DROP_ALONE:
        wrong = "drops out, or is clipped: amid its shaking it falls to one level at once and comes back"
        return int(starts[dropped[0]]), f"{wrong}, {dropped.size} times"
    count = float(np.diff(np.unique(row)).min())
    for start, end, edge in zip(starts, ends, np.maximum(into, out), strict=True):
        if end - start + 1 >= HOLD_RUN and start > 0 and end < steps.size:
            around = np.concatenate([steps[max(0, 2 * start - end - 1) : start], steps[end : 2 * end - start + 1]])
            usual = float(np.median(np.abs(around)))
            if usual >= max(HOLD_COUNTS * count, HOLD_SHARE * size) and edge >= HOLD_EDGE * usual:
                return int(start), f"drops out: amid its shaking it holds one level for {end - start + 1} samples"
    return None


def _spiked(row: Array) -> tuple[int, str] | None:
    """The largest of a few samples that stand alone, and what it is; None for none."""
    bend = np.abs(row[1:-1] - 0.5 * (row[:-2] + row[2:]))
    # Where a filter begins or ends, a sample may stand alone.
    bend[:SPIKE_APART] = bend[-SPIKE_APART:] = 0.0
    found: list[tuple[float, int]] = []
    while len(found) <= SPIKES and bend.any():
        at = int(np.argmax(bend))
        found.append((float(bend[at]), at + 1))
        bend[max(0, at - SPIKE_APART) : at + SPIKE_APART + 1] = 0.0
    sizes = [size for size, _ in found]
    count = next((n for n in range(1, len(sizes)) if sizes[n - 1] >= SPIKE * sizes[n]), 0)
    alone = [at for _, at in found[:count] if (row[at] - row[at - 1]) * (row[at] - row[at + 1]) > 0.0]
    if not count or len(alone) < count or sizes[0] < SPIKE_SHARE * float(np.abs(row - np.median(row)).max()):
        return None
    times = f", {sizes[0] / sizes[count]:.2g} times as far as any other" if sizes[count] > 0.0 else ""
    return alone[0], f"has a spike, no shaking: {count} of its samples stand alone{times},"


def _flat_tops(row: Array) -> tuple[Array, Array]:
    """First samples and lengths, two and more, of the tops that are flat and have sharp edges."""
    top = float(row.max())
    size = top - float(np.median(row))
    if size <= 0.0:
        return np.zeros(0, dtype=np.int64), np.zeros(0, dtype=np.int64)
    # Near the middle, numbers printed with so many digits have finer steps than at the top.
    steps = np.diff(np.unique(row[row - (top - size) >= 0.05 * size]))
    count = float(steps.min(initial=size))
    # Where neighbours are equal far from the top, a few counts were interpolated: the finest step is not the count.
    inner = np.abs(row - (top - size)) < 0.5 * size
    between = np.abs(np.diff(row))[inner[1:] & inner[:-1]]
    if between.size and np.count_nonzero(between == 0.0) > COARSE * between.size and between.any():
        count = max(count, min(float(np.median(between[between > 0.0])), COARSE * size))
    shoulder = max(SHOULDER_COUNTS * count, SHOULDER_SHARE * size)
    # Half a count more, so that the rounding of a factor between counts and unit does not matter.
    high = row >= top - min(1.5 * count, COUNT_SHARE * size)
    edges = np.diff(np.concatenate([[False], high, [False]]).astype(np.int8))
    starts, ends = np.flatnonzero(edges == 1), np.flatnonzero(edges == -1)
    lengths = ends - starts
    # Beyond the record's own ends there is nothing to compare with.
    outside = np.concatenate([[-np.inf, -np.inf], row, [-np.inf, -np.inf]])
    reach = np.where(lengths >= LONG_RUN, 2, 1)
    edge = np.maximum(outside[starts + 2 - reach], outside[ends + 1 + reach])
    sharp = (lengths >= 2) & (edge < top - shoulder)
    return starts[sharp], lengths[sharp]
