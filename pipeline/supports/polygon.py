"""Polygons: a motion on a finer step, and the polygon that stands for an acceleration which jumps."""

import numpy as np

from pipeline.kernels.transport import sharpen
from pipeline.quantities import Array, G
from pipeline.records import Motion

LIGHTEST = 1e-3 * G
"""m/s2, weight per mass below which shares of it mean nothing: contact is being lost."""

ROUNDING = 1e-12
"""Share of its limit by which a corner may be beyond it."""

PASSES = 2
"""Times that what is left of the flows is tried: a third gains nothing."""


def resampled(motion: Motion, refine: int) -> Motion:
    """Return the same polygon with more samples: the excitation does not change.

    Parameters
    ----------
    motion : Motion
        Linear between samples.
    refine : int
        Samples for each of its own.

    Returns
    -------
    Motion
        With a time step that is by that much smaller.

    Raises
    ------
    ValueError
        For a refinement below 1.
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


def conserving(base: Array, felt: Array, moved: Array, weight: Array, dt: float) -> Array:
    """Return the corners of a polygon that hands on the momentum of an absolute acceleration.

    The means of the acceleration under the hat functions of the samples, which are second differences of the
    displacement, keep momentum and range but are blunt; what sharpens them to the samples flows between neighbours, as
    far as the range allows (flux-corrected transport, with a convex limit for vectors).

    Parameters
    ----------
    base : ndarray, shape (2, n)
        Acceleration of the ground along x and y, m/s2, a polygon that ends with its last sample.
    felt : ndarray, shape (2, m)
        Absolute acceleration at the samples, m/s2, which may jump anywhere between them; m >= n.
    moved : ndarray, shape (2, m + 1)
        Displacement relative to the ground, from rest, at one sample more, m.
    weight : ndarray, shape (m,)
        g + a_z, m/s2.
    dt : float
        Time step, s.

    Returns
    -------
    ndarray, shape (2, m)
        In m/s2.  The integral is exact to rounding for what starts from rest and comes to rest.  An oscillator on top
        of it is off by the square of the step (on the samples of `felt`: by the step), by its cube where nothing jumps.
        As a share of the weight, which is what lifts and shifts an object, no corner is larger than both `felt` and its
        mean are at one of the three samples around it.

    References
    ----------
    Zalesak, S. T. (1979). Fully multidimensional flux-corrected transport algorithms for fluids. Journal of
    Computational Physics 31, 335-362. Guermond, J.-L., Popov, B. and Tomas, I. (2019). Invariant domain preserving
    discretization-independent schemes and convex limiting for hyperbolic systems. Computer Methods in Applied Mechanics
    and Engineering 347, 143-175.
    """
    n, m = base.shape[1], felt.shape[1]
    if m < 2:
        return felt.copy()
    mass = np.ones(m)
    mass[0], mass[-1] = 0.5, 0.5
    corners = np.zeros((2, m))
    corners[:, : n - 1] += base[:, :-1] / 3.0 + base[:, 1:] / 6.0
    corners[:, 1:n] += base[:, :-1] / 6.0 + base[:, 1:] / 3.0
    pace = np.diff(moved, axis=1) / dt**2
    corners[:, :-1] += pace[:, :-1]
    corners[:, 1:] -= pace[:, :-1]
    corners[:, -1] += 0.5 * (pace[:, -1] + pace[:, -2])
    corners /= mass
    carried = np.maximum(weight, LIGHTEST)
    # Roots of squares: hypot costs ten times as much.
    share = np.sqrt(np.maximum((corners**2).sum(axis=0), (felt**2).sum(axis=0))) / carried
    most = share.copy()
    most[1:] = np.maximum(most[1:], share[:-1])
    most[:-1] = np.maximum(most[:-1], share[1:])
    limit = carried * most
    # All of it wherever no corner then leaves its circle; the rest as far as that allows.
    sharpen(corners, np.diff(felt, axis=1) / 6.0, limit, mass, ROUNDING, PASSES)
    return corners
