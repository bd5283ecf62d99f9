"""What of a motion hangs on the choice of its high-pass corner: its peaks at half the corner and at double."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.motions.filtering import highpass
from pipeline.motions.intensity import integrate
from pipeline.quantities import Array
from pipeline.records import Motion

FACTORS = (0.5, 2.0)
"""Of the corner (judgement): of ten raw records, eight corners are within 1.6 of those of another program."""

_STEP = (
    "between high-pass corners of {0:.4g} and {1:.4g} Hz, half and double, the PGV is {2:.4g} to {3:.4g} m/s and the "
)
_STEP += "PGD {4:.4g} to {5:.4g} m (horizontal resultants)"
_READ = re.compile(re.sub(r"\\\{\d:\\.4g\\\}", r"(\\S+)", re.escape(_STEP)))


@dataclass(frozen=True, slots=True)
class CornerRange:
    """Peaks of the horizontal resultant between two corners.

    Attributes
    ----------
    highpass_hz : (float, float)
        Half the corner that is used, and double.
    pgv, pgd : (float, float)
        The least and the most of three corners, the one that is used included; in m/s and m.
    """

    highpass_hz: tuple[float, float]
    pgv: tuple[float, float]
    pgd: tuple[float, float]

    def scaled(self, factor: float) -> str:
        """Return the step of a motion that is scaled by a factor."""
        return _STEP.format(*self.highpass_hz, *(abs(factor) * value for value in (*self.pgv, *self.pgd)))


def corner_range(flat: Array, dt: float, corner_hz: float, seen: slice) -> CornerRange | None:
    """Find the peaks at other corners; None where the double one is beyond what the record holds.

    Parameters
    ----------
    flat : array, shape (3, n)
        In m/s2, its baseline corrected, before any filter; the horizontals are at right angles.
    dt : float
        Time step in s.
    corner_hz : float
        That is used, in Hz.
    seen : slice
        Samples that are kept of it; the displacement begins at the first of them.

    Returns
    -------
    CornerRange or None

    Notes
    -----
    Error: none but rounding for these corners.  That the true motion lies between is not said: below the corner the
    record knows nothing of it.
    """
    low, high = (factor * corner_hz for factor in FACTORS)
    if high >= 0.5 / dt:
        return None
    peaks = np.array([_peaks(flat, dt, one, seen) for one in (low, corner_hz, high)])
    (pgv, pgd), (most_v, most_d) = peaks.min(axis=0).tolist(), peaks.max(axis=0).tolist()
    return CornerRange((low, high), (pgv, most_v), (pgd, most_d))


def corner_range_of(steps: Sequence[str]) -> CornerRange | None:
    """Return what the steps of a motion tell of its corner; None where it was not filtered here."""
    for step in reversed(steps):
        if found := _READ.fullmatch(step):
            low, high, pgv, most_v, pgd, most_d = map(float, found.groups())
            return CornerRange((low, high), (pgv, most_v), (pgd, most_d))
    return None


def _peaks(flat: Array, dt: float, corner: float, seen: slice) -> tuple[float, float]:
    rows, _, start = highpass(flat[:2], dt, corner)
    v, u = integrate(Motion(dt, np.vstack([rows, np.zeros_like(rows[:1])]), start=(*start.tolist(), 0.0)))
    v, u = v[:2, seen], u[:2, seen]
    return float(np.hypot(*v).max()), float(np.hypot(*(u - u[:, :1])).max())
