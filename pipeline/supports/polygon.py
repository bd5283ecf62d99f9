"""The polygon of a motion on a finer step."""

import numpy as np

from pipeline.quantities import Array
from pipeline.records import Motion


def resampled(motion: Motion, refine: int) -> Motion:
    """Return the same polygon with ``refine`` samples for each of its own: the excitation does not change.

    raises : ValueError for a refinement below 1
    """
    if refine < 1:
        raise ValueError(f"refine must be at least 1, not {refine}")
    if refine == 1 or motion.samples < 2:
        return motion
    n = (motion.samples - 1) * refine + 1
    fine = np.arange(n) / refine
    grid = np.arange(motion.samples)
    rows: Array = np.vstack([np.interp(fine, grid, row) for row in motion.acceleration])
    return Motion(motion.dt / refine, rows, motion.name, motion.steps, motion.source, motion.start, motion.v_max)
