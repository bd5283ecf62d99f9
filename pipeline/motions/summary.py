"""What a report shows of the motions of a site: measures, and series that are thinned for a picture."""

from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from pipeline.motions.intensity import strong_part
from pipeline.motions.site import Level
from pipeline.records import Motion, MotionSummary

PICTURE_POINTS = 600
"""Points of a picture's series at most."""

PICTURE_MARGIN = 5.0
"""s, shown on both sides of the strong part."""


def summaries(levels: Sequence[Level], floor: str = "") -> tuple[MotionSummary, ...]:
    """Return what a report shows of each motion, level for level, with thinned series for its picture.

    Parameters
    ----------
    levels : sequence of Level
        As a floor feels them.
    floor : str
        The floor on which these are felt; "" for the ground.

    Returns
    -------
    tuple of MotionSummary
        One for each motion.
    """
    return tuple(
        MotionSummary(
            name=one.motion.name,
            hash=one.motion.hash,
            level=level.name,
            floor=floor,
            source=one.source,
            dt=one.motion.dt,
            samples=one.motion.samples,
            measures=one.measures,
            steps=one.motion.steps,
            approved_by=level.approved_by,
            approved_on=level.approved_on,
            licence=one.licence,
            series=thinned(one.motion),
        )
        for level in levels
        for one in level.motions
    )


def thinned(motion: Motion, points: int = PICTURE_POINTS) -> dict[str, tuple[float, ...]]:
    """Return the strong part of a motion (D5-95 and 5 s on both sides) with few enough points for a picture.

    Parameters
    ----------
    motion : Motion
        What is drawn.
    points : int
        Most points of a series.

    Returns
    -------
    dict of str to tuple of float
        t [s from the motion's first sample] and x, y, z [m/s2], all of one length, at most `points`.  Each bin of
        samples is drawn as its smallest and largest value, in the order in which they occur: peaks survive.
    """
    start, end = strong_part(motion)
    if start == end:
        end = motion.duration
    a = max(0, int(np.floor((start - PICTURE_MARGIN) / motion.dt)))
    b = min(motion.samples, int(np.ceil((end + PICTURE_MARGIN) / motion.dt)) + 1)
    part = motion.acceleration[:, a:b]
    n = part.shape[1]
    if n <= points:
        times = (a + np.arange(n)) * motion.dt
        return {"t": tuple(times.tolist())} | {axis: tuple(part[i].tolist()) for i, axis in enumerate("xyz")}
    edges = np.linspace(0, n, points // 2 + 1).astype(int).tolist()
    t: list[float] = []
    rows: tuple[list[float], ...] = ([], [], [])
    for first, last in pairwise(edges):
        width = float(last - first)
        t += [(a + first + 0.25 * width) * motion.dt, (a + first + 0.75 * width) * motion.dt]
        for row, values in zip(rows, part[:, first:last], strict=True):
            low, high = int(np.argmin(values)), int(np.argmax(values))
            row += [float(values[i]) for i in sorted((low, high))]
    return {"t": tuple(t)} | {axis: tuple(row) for axis, row in zip("xyz", rows, strict=True)}
