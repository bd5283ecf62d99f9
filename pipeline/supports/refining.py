"""Refinement of a support's output: until what may stand on the support no longer feels the difference."""

from collections.abc import Callable

import numpy as np

from pipeline.kernels import samples
from pipeline.kernels.oscillator import oscillator_history
from pipeline.quantities import Array
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
