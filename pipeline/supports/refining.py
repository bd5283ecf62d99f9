"""A support's output, refined until what may stand on it no longer feels the difference."""

from collections.abc import Callable

import numpy as np

from pipeline.kernels import samples
from pipeline.kernels.oscillator import oscillator_history
from pipeline.kernels.transport import sharpen
from pipeline.quantities import Array, G
from pipeline.records import Motion

BANK = (2.0, 5.0, 10.0, 20.0)
"""Hz, oscillators that stand for what is on the support, as floor spectra do for equipment."""

BANK_DAMPING = 0.05

TRANSMITTED = 1e-3
"""Error that what stands on a support may get from the sampling of what the support passes on."""

MOST_REFINED = 64
"""Most samples of the output for each of the input."""

MOST_SAMPLES = 4_000_000
"""Samples of an output from which on it is not refined further."""


def refined(passed: Callable[[int], Motion], error: float) -> Motion:
    """Return what a support passes on at the coarsest step at which what stands on it is off by at most an error.

    The step is halved until the oscillators agree.  As the error falls at least with the step, the finer motion is off
    by no more than the two differ, and the coarser by no more than twice that.

    Parameters
    ----------
    passed : callable
        The motion passed on, at so many samples for each of the input.
    error : float
        Largest difference of the displacement of any oscillator of BANK over the largest displacement of it [-].

    Returns
    -------
    Motion
        Its last step says so, and where the limits above end the search, what is left.
    """
    refine = 1
    coarse = passed(refine)
    one = _responses(coarse)
    while True:
        fine = passed(2 * refine)
        other = _responses(fine)
        apart = _apart(one, other, 2)
        if 2.0 * apart <= error:
            return _told(coarse, 2.0 * apart, error)
        refine *= 2
        if apart <= error or 2 * refine > MOST_REFINED or 2 * fine.samples > MOST_SAMPLES:
            return _told(fine, apart, error)
        coarse, one = fine, other


def _told(motion: Motion, off: float, error: float) -> Motion:
    reached = f"within {off:.2g}" if off <= error else f"off by up to {off:.2g}, more than the {error:g} asked"
    said = f"{motion.steps[-1]}; an oscillator of {BANK[0]:g} to {BANK[-1]:g} Hz on it is {reached}"
    return Motion(motion.dt, motion.acceleration, motion.name, (*motion.steps[:-1], said), motion.source)


def difference(coarse: Motion, fine: Motion) -> float:
    """Return how far the oscillators of BANK on two motions are apart.

    Parameters
    ----------
    coarse, fine : Motion
        The step of the coarse one is a whole multiple of that of the fine one; both horizontal directions count.

    Returns
    -------
    float
        As a share of their largest displacement [-].
    """
    return _apart(_responses(coarse), _responses(fine), round(coarse.dt / fine.dt))


def _apart(coarse: Array, fine: Array, every: int) -> float:
    thinned = fine[:, :, ::every]
    n = min(coarse.shape[2], thinned.shape[2])
    apart = np.abs(coarse[:, :, :n] - thinned[:, :, :n]).max(axis=(1, 2))
    size = np.abs(fine).max(axis=(1, 2))
    return float(np.divide(apart, size, out=np.where(apart > 0.0, np.inf, 0.0), where=size > 0.0).max())


def _responses(motion: Motion) -> Array:
    # Displacements of the oscillators, (frequencies, x and y, samples).
    out = np.empty((len(BANK), 2, motion.samples))
    history = np.empty((motion.samples, 2))
    for row in range(2):
        base = samples(motion.acceleration[row])
        for k, frequency in enumerate(BANK):
            oscillator_history(base, motion.dt, 2.0 * np.pi * frequency, BANK_DAMPING, 1.0, history)
            out[k, row] = history[:, 0]
    return out


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
