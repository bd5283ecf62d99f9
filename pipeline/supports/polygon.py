"""Polygons: a motion on a finer step, and the polygon that stands for an acceleration which jumps."""

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


def conserving(base: Array, felt: Array, moved: Array, dt: float) -> Array:
    """Return the corners (m,) m/s2 of a polygon that hands on the momentum of an absolute acceleration.

    base  : (n,) m/s2, acceleration of the ground, a polygon that ends with its last sample
    felt  : (m,) m/s2, absolute acceleration at the samples, which may jump anywhere between them; m >= n
    moved : (m + 1,) m, displacement relative to the ground, from rest, at one sample more
    error : the integral is exact to rounding for what starts from rest and comes to rest; no corner lies beyond the
            samples of `felt` and the means between them around it.  An oscillator on top of it is off by the square of
            the step (samples of `felt`: by the step), by its cube where nothing jumps.
    source: flux-corrected transport: Zalesak (1979), J. Comput. Phys. 31, 335-362.  The means of the acceleration
            under the hat functions of the samples, which are second differences of the displacement, keep momentum and
            range but are blunt; what sharpens them to the samples flows between neighbours, as far as the range allows.
    """
    n, m = base.size, felt.size
    if m < 2:
        return felt.copy()
    mass = np.ones(m)
    mass[0], mass[-1] = 0.5, 0.5
    mean = np.zeros(m)
    mean[: n - 1] += base[:-1] / 3.0 + base[1:] / 6.0
    mean[1:n] += base[:-1] / 6.0 + base[1:] / 3.0
    pace = np.diff(moved) / dt**2
    mean[:-1] += pace[:-1]
    mean[1:] -= pace[:-1]
    mean[-1] += 0.5 * (pace[-1] + pace[-2])
    mean /= mass
    flow = np.diff(felt) / 6.0
    top, bottom = _around(np.maximum(mean, felt)), -_around(-np.minimum(mean, felt))
    rise, fall = np.maximum(flow, 0.0), np.maximum(-flow, 0.0)
    into, out_of = np.zeros_like(mean), np.zeros_like(mean)
    into[1:] += rise
    into[:-1] += fall
    out_of[1:] += fall
    out_of[:-1] += rise
    up = np.divide((top - mean) * mass, into, out=np.ones_like(mean), where=into > 0.0)
    down = np.divide((mean - bottom) * mass, out_of, out=np.ones_like(mean), where=out_of > 0.0)
    room = np.where(flow > 0.0, np.minimum(up[1:], down[:-1]), np.minimum(up[:-1], down[1:]))
    flow *= np.minimum(1.0, room)
    corners = mean
    corners[1:] += flow / mass[1:]
    corners[:-1] -= flow / mass[:-1]
    return corners


def _around(values: Array) -> Array:
    # The largest of each value and its neighbours.
    most = values.copy()
    most[1:] = np.maximum(most[1:], values[:-1])
    most[:-1] = np.maximum(most[:-1], values[1:])
    return most
