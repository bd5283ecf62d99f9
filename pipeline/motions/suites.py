"""Scaling motions to a level of shaking."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal

import numpy as np

from pipeline.errors import InputError
from pipeline.motions.spectra import psa
from pipeline.quantities import Array
from pipeline.records import Motion


def target_at(periods: Array, target_periods: Sequence[float] | Array, target: Sequence[float] | Array) -> Array:
    """Return a target spectrum at other periods, by straight lines in log-log.

    Parameters
    ----------
    periods : array, shape (m,)
        In s.
    target_periods : array_like, shape (k,)
        In s, increasing.
    target : array_like, shape (k,)
        Pseudo-acceleration in m/s2.

    Returns
    -------
    array, shape (m,)
        In m/s2.

    Raises
    ------
    InputError
        For values that are not above 0, periods that do not increase, or periods outside the target.
    """
    t, s = np.asarray(target_periods, dtype=np.float64), np.asarray(target, dtype=np.float64)
    if t.ndim != 1 or t.shape != s.shape or t.size < 2:
        raise InputError(
            f"target: give two lists of one length, at least 2, not {t.shape} periods and {s.shape} values"
        )
    for name, values in (("target period", t), ("target", s)):
        if not (np.isfinite(values).all() and (values > 0.0).all()):
            raise InputError(f"{name}: every entry must be a number above 0")
    if (np.diff(t) <= 0.0).any():
        raise InputError("target periods must increase")
    if periods.min() < t[0] * (1.0 - 1e-9) or periods.max() > t[-1] * (1.0 + 1e-9):
        raise InputError(
            f"target spans {t[0]:g} to {t[-1]:g} s, but {periods.min():g} to {periods.max():g} s are asked for; "
            f"extend the target or narrow the range"
        )
    return np.asarray(np.exp(np.interp(np.log(periods), np.log(t), np.log(s))), dtype=np.float64)


def scale_to_spectrum(
    motion: Motion,
    target_periods: Sequence[float] | Array,
    target: Sequence[float] | Array,
    period_range: tuple[float, float],
    *,
    damping: float = 0.05,
    component: str = "rotd100",
    measure: Literal["log", "linear"] = "log",
) -> Motion:
    """Scale the three components by the one factor that brings a response spectrum closest to a target.

    Parameters
    ----------
    motion : Motion
        What is scaled.
    target_periods : array_like, shape (k,)
        In s, increasing.
    target : array_like, shape (k,)
        Pseudo-acceleration in m/s2.
    period_range : (float, float)
        In s, from and to; 100 periods in equal ratios are compared.
    damping : float
        Ratio to critical, of target and spectrum.
    component : str
        Of the motion's spectrum, as `spectra.response_spectra`.
    measure : {"log", "linear"}
        "log": least squares of ln(factor PSA / target), the geometric mean of the ratios; "linear": least squares of
        factor PSA - target.

    Returns
    -------
    Motion
        With the step written into it, and the misfit left.

    Raises
    ------
    InputError
        As `target_at`, and for a motion without shaking in that component.
    """
    low, high = period_range
    if not (np.isfinite(high) and 0.0 < low < high):
        raise InputError(f"period_range must be two periods in s, the shorter first and above 0, not {period_range!r}")
    periods = np.geomspace(low, high, 100)
    wanted = target_at(periods, target_periods, target)
    found = psa(motion, periods, damping, component)
    if (found == 0.0).any():
        raise InputError(f"motion {motion.name!r} has no shaking in component {component}; it cannot be scaled")
    if measure == "log":
        factor = float(np.exp(np.mean(np.log(wanted / found))))
    elif measure == "linear":
        factor = float(found @ wanted / (found @ found))
    else:
        raise InputError(f"measure must be 'log' or 'linear', not {measure!r}")
    left = float(np.sqrt(np.mean(np.log(factor * found / wanted) ** 2)))
    why = (
        f"{component} PSA at {damping:.0%} damping to the target by {measure} least squares from {low:g} to {high:g} "
        f"s, misfit {left:.2f} in natural log"
    )
    return motion.scaled(factor, why)


def _above_zero(name: str, value: float) -> None:
    if not (np.isfinite(value) and value > 0.0):
        raise InputError(f"{name} must be a number above 0, not {value!r}")
