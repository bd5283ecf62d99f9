"""Whether a record holds more than one earthquake: quiet between two, or shaking that begins anew in a coda."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.motions.doubts import ALL_USED, MAY_HOLD
from pipeline.motions.earthquakes import LEAST, QUIET, Earthquake, earthquakes, in_seconds, listed
from pipeline.motions.errors import judged
from pipeline.motions.parts import whole
from pipeline.motions.record import Record
from pipeline.quantities import Array

APART = 300.0
"""Seconds of quiet between two earthquakes beyond which what holds both is no one record."""

RIVAL = 0.25
"""Share of the largest peak from which another earthquake may be the one that is meant (judgement)."""

PAST = 10
"""Seconds whose decay is followed, by a straight line through the logarithms of their root mean squares."""

GUARD = 1
"""Seconds between these and what is compared with them: an onset may lie within one."""

AHEAD = 10
"""Seconds after a moment in which the shaking rises above the decay: a P wave alone may stay below it."""

ANEW = 3.0
"""Multiple of what the decay leads one to expect, and of what the PAST seconds had, at which shaking begins anew.

Clean strong motion has up to 1.3, recordings of distant earthquakes, whose S waves come in the coda of the P waves, up
to 2.5.
"""

FALLEN = 0.25
"""Share of the strongest second before that the shaking has fallen below by then: no S wave follows its P so late."""

FIRST = 0.1
"""Least share of the record's strongest second that the strongest before had: what is weaker is the noise, or the first
waves of the same earthquake."""

STRONG = 0.2
"""Least share of the record's strongest second that the new shaking has; what is weaker decides nothing."""


@dataclass(frozen=True, slots=True)
class Renewal:
    """Shaking that begins anew in a coda.

    Attributes
    ----------
    second : int
        When, in whole s from the first sample.
    ratio : float
        To what the decay before it leads one to expect.
    share : float
        Of the strongest second.
    """

    second: int
    ratio: float
    share: float


def tell_earthquakes(row: tuple[Path, Any, str], record: Record, steps: list[str]) -> list[Earthquake]:
    """Say that a record that is used as a whole holds several earthquakes; refuse what is no one record.

    Parameters
    ----------
    row : (Path, obspy.Trace, str)
        Its first component: file, samples, and what the manifest calls it.
    record : Record
        The manifest's table of it.
    steps : list of str
        Where it is said.

    Returns
    -------
    list of Earthquake
        Those that were told, none where there is but one.

    Raises
    ------
    MotionError
        Where more than APART lies between two that may be meant.
    """
    file, trace, key = row
    found = earthquakes([whole(file, trace)])
    if len(found) < 2:
        return []
    told = f"holds {len(found)} earthquakes ({key}): {listed(found, 1.0)}"
    largest = max(one.peak for one in found)
    strong = [one for one in found if one.peak >= RIVAL * largest]
    if max((later.begins - one.ends for one, later in pairwise(strong)), default=0.0) > APART:
        remedy = "choose one by origin_time or window_s"
        judged(record.accept, "several", file, f"record {record.name!r}", told, remedy, steps)
    else:
        steps.append(f"{file.name} {told}{ALL_USED}window_s or origin_time would choose")
    return found


def tell_renewals(
    data: Array, dt: float, start: Any, begins: float, window: tuple[float, float] | None, told: Sequence[Earthquake]
) -> list[str]:
    """Say that what is used may hold a second earthquake, which began in the coda of the first.

    It is a doubt and no finding: an earthquake whose fault broke in two parts, half a minute apart, looks alike.

    Parameters
    ----------
    data : array, shape (rows, n)
        In m/s2.
    dt : float
        Time step in s.
    start : obspy.UTCDateTime
        Of the first sample.
    begins : float
        The time of the first sample as the manifest counts, in s.
    window : (float, float) or None
        What is to be kept of it, in s as the manifest counts; None: all.
    told : sequence of Earthquake
        What was told already.

    Returns
    -------
    list of str
        A sentence, or nothing.
    """
    if window is not None:
        first, last = (max(round((at - begins) / dt), 0) for at in window)
        data, start, begins = data[:, first : last + 1], start + first * dt, begins + first * dt
    known = [one.begins - start for one in told[1:]]
    found = [one for one in renewals(data, dt) if not any(-AHEAD <= one.second - at <= QUIET for at in known)]
    if not found:
        return []
    # What is called 1970 was never timed.
    clock = start.year > 1970
    when = "; ".join(
        f"at {begins + one.second:.0f} s{f' ({str(start + one.second)[:19]}Z)' if clock else ''}, "
        f"{one.ratio:.2g} times what was left of the shaking before, {one.share:.0%} of the strongest second"
        for one in found
    )
    return [
        f"{MAY_HOLD}{'two' if len(found) == 1 else 'several'} earthquakes, or one whose fault broke in parts: it "
        f"shakes anew {when}{ALL_USED}window_s would choose"
    ]


def renewals(data: Array, dt: float) -> list[Renewal]:
    """Find where shaking begins anew before what was there has fallen to the noise.

    The envelope, one root mean square a second of all components between 1 and 20 Hz, falls exponentially in a coda.
    Where it rises ANEW times above what the seconds before lead one to expect, for LEAST seconds, after it had fallen
    to FALLEN of its strongest second, waves of another earthquake may have come, or of another part of the fault.

    Parameters
    ----------
    data : array, shape (rows, n)
        In any one unit, about any level.
    dt : float
        Time step in s.

    Returns
    -------
    list of Renewal
        By time, at least QUIET apart.

    Notes
    -----
    Error: of 13 to 15 clean records to which a copy of their own was added 60 and 90 s later, it is found in 13 and 12
    at equal size, in 9 and 10 at half; of the 4 to 6 that are long enough for 120 s and more, in all.  Within the
    strong shaking of the first, or weaker than STRONG, it is not.  None of 46 clean records is called so.

    References
    ----------
    Aki, K. and Chouet, B. (1975), Origin of coda waves: source, attenuation, and scattering effects, JGR 80, 3322-3342,
    for the decay; Allen, R. (1982), Automatic phase pickers: their present use and future prospects, BSSA 72,
    S225-S242, for the comparison of what comes with what was.
    """
    power: Array = np.zeros(0)
    for row in data:
        rms, _ = in_seconds(row, dt)
        power = rms**2 if power.size == 0 else power + rms**2
    most = int(LEAST)
    if power.size < PAST + GUARD + AHEAD or power.max() <= 0.0:
        return []
    level = np.sqrt(power / power.max())
    logs = np.log(np.maximum(level, 1e-9))
    strongest = np.maximum.accumulate(level)
    x = np.arange(PAST) - 0.5 * (PAST - 1)
    found: list[Renewal] = []
    for at in range(PAST + GUARD, level.size - most + 1):
        first = at - PAST - GUARD
        past = logs[first : at - GUARD]
        left = float(np.sqrt((level[first : at - GUARD] ** 2).mean()))
        before = float(strongest[first])
        if left > FALLEN * before or before < FIRST or (found and at - found[-1].second < QUIET):
            continue
        slope = min(float(past @ x) / float(x @ x), 0.0)  # a coda does not grow
        ahead = logs[at : at + AHEAD]
        above = ahead - (past.mean() + slope * (0.5 * (PAST - 1) + 1 + GUARD + np.arange(ahead.size)))
        share = float(np.exp(np.sort(ahead)[-most]))
        ratio = min(float(np.exp(np.sort(above)[-most])), share / max(left, 1e-9))
        if ratio >= ANEW and share >= STRONG:
            found.append(Renewal(at + int(np.argmax(above >= np.log(ANEW))), ratio, share))
    return found
