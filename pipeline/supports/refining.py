"""How finely a support's output is sampled: until what may stand on the support no longer feels the difference."""

from collections.abc import Callable

import numpy as np

from pipeline.kernels.oscillator import oscillator_history
from pipeline.quantities import Array
from pipeline.records import Motion

BANK = (2.0, 5.0, 10.0, 20.0)
"""Hz, oscillators that stand for what is on the support, as floor spectra do for equipment."""

BANK_DAMPING = 0.05

MOST_REFINED = 64
"""Most samples of the output for each of the input."""

MOST_SAMPLES = 4_000_000
"""Samples of an output from which on it is not refined further."""


def refined(passed: Callable[[int], Motion], error: float) -> Motion:
    """Return what a support passes on at the coarsest step at which what stands on it is off by at most ``error``.

    passed : the motion passed on, at so many samples for each of the input
    error  : largest difference of the displacement of any oscillator of BANK over the largest displacement of it
    The step is halved until the oscillators agree.  As the error falls at least with the step, the finer motion is off
    by no more than the two differ, and the coarser by no more than twice that.  The last step of the result says so,
    and where the limits above end the search, what is left.
    """
    refine = 1
    coarse = passed(refine)
    while True:
        fine = passed(2 * refine)
        apart = difference(coarse, fine)
        if 2.0 * apart <= error:
            return _told(coarse, 2.0 * apart, error)
        refine *= 2
        if apart <= error or 2 * refine > MOST_REFINED or 2 * fine.samples > MOST_SAMPLES:
            return _told(fine, apart, error)
        coarse = fine


def _told(motion: Motion, off: float, error: float) -> Motion:
    reached = f"within {off:.1g}" if off <= error else f"off by up to {off:.1g}, more than the {error:g} asked"
    said = f"{motion.steps[-1]}; an oscillator of {BANK[0]:g} to {BANK[-1]:g} Hz on it is {reached}"
    return Motion(motion.dt, motion.acceleration, motion.name, (*motion.steps[:-1], said), motion.source)


def difference(coarse: Motion, fine: Motion) -> float:
    """Return how far the oscillators of BANK on two motions are apart, as a share of their largest displacement.

    The step of the coarse motion is a whole multiple of that of the fine one; both horizontal directions count.
    """
    every = round(coarse.dt / fine.dt)
    most = 0.0
    for frequency in BANK:
        apart, size = 0.0, 0.0
        for row in range(2):
            one, other = _response(coarse, row, frequency), _response(fine, row, frequency)[::every]
            n = min(one.size, other.size)
            apart = max(apart, float(np.abs(one[:n] - other[:n]).max()))
            size = max(size, float(np.abs(other).max()))
        if apart > 0.0:
            most = max(most, apart / size if size > 0.0 else np.inf)
    return most


def _response(motion: Motion, row: int, frequency: float) -> Array:
    history = np.zeros((motion.samples, 2))
    base = np.ascontiguousarray(motion.acceleration[row])
    oscillator_history(base, motion.dt, 2.0 * np.pi * frequency, BANK_DAMPING, 1.0, history)
    return history[:, 0]
