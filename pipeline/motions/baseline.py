"""Baselines and resampling of raw records; every step is written into the motion."""

from __future__ import annotations

from fractions import Fraction
from typing import Literal

import numpy as np
from numpy.polynomial import Polynomial

from pipeline.errors import InputError
from pipeline.motions.intensity import integrate, strong_part
from pipeline.motions.onset import samples_before
from pipeline.quantities import Array
from pipeline.records import Motion

IWAN_THRESHOLD = 0.5
"""m/s2: the baseline is taken to shift between the first and the last time it is exceeded (Iwan et al. 1985)."""

_LANCZOS_WIDTH = 30


def remove_pre_event_mean(motion: Motion, until: float) -> Motion:
    """Subtract from each component its mean over the samples before the event.

    Parameters
    ----------
    motion : Motion
        A raw record.
    until : float
        In s from the first sample to where the shaking starts.

    Returns
    -------
    Motion
        With the step written into it.

    Raises
    ------
    InputError
        Unless at least two samples lie before it.
    """
    count = samples_before(motion, until, "until")
    mean = motion.acceleration[:, :count].mean(axis=1)
    step = f"mean of the first {count * motion.dt:g} s removed: {_told(mean, 'm/s2')}"
    return _stepped(motion, motion.acceleration - mean[:, None], step)


def polynomial_baseline(
    motion: Motion, degree: int, *, of: Literal["acceleration", "velocity"] = "acceleration"
) -> Motion:
    """Subtract a least-squares polynomial from each component.

    Parameters
    ----------
    motion : Motion
        A raw record.
    degree : int
        Of the fitted polynomial, 0 to 6 (1 to 6 for the velocity).
    of : {"acceleration", "velocity"}
        "acceleration" fits and subtracts it there; "velocity" fits a polynomial without constant term to the velocity
        from rest and subtracts its derivative from the acceleration, so that the motion still starts from rest.

    Returns
    -------
    Motion
        With the step written into it.

    Raises
    ------
    InputError
        For another degree or a record with no more samples than coefficients.

    References
    ----------
    Boore, D. M., Stephens, C. D. and Joyner, W. B. (2002), who fit a quadratic to the velocity.
    """
    least = 0 if of == "acceleration" else 1
    if isinstance(degree, bool) or not isinstance(degree, int) or not least <= degree <= 6:
        raise InputError(f"degree must be a whole number from {least} to 6 for the {of}, not {degree!r}")
    if motion.samples <= degree + 1:
        raise InputError(f"a record of {motion.samples} samples is too short for a polynomial of degree {degree}")
    n = motion.samples
    # Time runs from 0 to 1: the powers stay of one size.
    s = np.linspace(0.0, 1.0, n)
    out = np.array(motion.acceleration)
    if of == "acceleration":
        fitted = [Polynomial.fit(s, row, degree, domain=[0.0, 1.0])(s) for row in out]
    elif of == "velocity":
        powers = s[:, None] ** np.arange(1, degree + 1)
        coefficients = [np.linalg.lstsq(powers, row, rcond=None)[0] for row in integrate(motion)[0]]
        fitted = [Polynomial([0.0, *c]).deriv()(s) / motion.duration for c in coefficients]
    else:
        raise InputError(f"of must be 'acceleration' or 'velocity', not {of!r}")
    sizes = [float(np.abs(f).max()) for f in fitted]
    step = f"polynomial baseline of degree {degree}, fitted to the {of}, removed; largest value {_told(sizes, 'm/s2')}"
    return _stepped(motion, out - np.asarray(fitted), step)


def two_segment_baseline(
    motion: Motion, t1: float | None = None, t2: float | None = None, fit_from: float | None = None
) -> Motion:
    """Remove the two baseline shifts that strong shaking leaves in a record, so that its velocity ends at zero.

    A line v0 + af t is fitted to the end of the velocity; af is subtracted from the acceleration after t2, and the
    constant am = (v0 + af t2) / (t2 - t1) between t1 and t2, which makes the two segments meet.  Remove the pre-event
    mean first.

    Parameters
    ----------
    motion : Motion
        A raw record.
    t1, t2 : float or None
        In s; None: for each component the first and the last time that IWAN_THRESHOLD is exceeded, or, where it never
        is, when 5 and 95 % of the Arias intensity of the horizontals have arrived.
    fit_from : float or None
        In s, start of the fitted end; None: t2.

    Returns
    -------
    Motion
        With the step written into it.

    Raises
    ------
    InputError
        For times that are not in order, or an end with fewer than ten samples.

    Notes
    -----
    Error: the permanent displacement depends on t1 and t2, which nothing in the record fixes (Boore 2001).

    References
    ----------
    Iwan, W. D., Moser, M. A. and Peng, C.-Y. (1985), BSSA 75, 1225-1246.
    Boore, D. M. (2001), Effect of baseline corrections on displacements and response spectra, BSSA 91, 1199-1211.
    """
    v, _ = integrate(motion)
    t = np.asarray(np.arange(motion.samples) * motion.dt, dtype=np.float64)
    out = np.array(motion.acceleration)
    told = []
    for row, axis in enumerate("xyz"):
        first, last = _segment(motion, row)
        a, b = first if t1 is None else t1, last if t2 is None else t2
        start = b if fit_from is None else fit_from
        if not 0.0 <= a < b <= start < motion.duration:
            raise InputError(
                f"two-segment baseline, component {axis}: t1 {a:g}, t2 {b:g} and fit_from {start:g} s must be in this "
                f"order inside the record of {motion.duration:g} s; give them"
            )
        end = t >= start - 1e-9 * motion.dt
        if np.count_nonzero(end) < 10:
            raise InputError(
                f"two-segment baseline, component {axis}: fewer than 10 samples after {start:g} s; use an earlier "
                f"fit_from or a longer record"
            )
        # About the middle of the end, where level and slope are independent of each other.
        middle = 0.5 * (float(t[end][0]) + float(t[end][-1]))
        level, slope = (float(c) for c in Polynomial.fit(t[end] - middle, v[row, end], 1, domain=[-1.0, 1.0]).coef)
        at_b = level + slope * (b - middle)
        shift = at_b / (b - a)
        out[row] -= _held(t, a, b) * shift + _held(t, b, motion.duration + motion.dt) * slope
        told.append(
            f"{axis} {shift:.3g} m/s2 from {a:g} to {b:g} s and {slope:.3g} m/s2 after, fitted from {start:g} s"
        )
    return _stepped(motion, out, "two-segment baseline (Boore 2001) removed: " + "; ".join(told))


def resample(motion: Motion, dt: float, *, method: Literal["fft", "lanczos"] = "fft") -> Motion:
    """Return the motion on another time step, taken as band-limited between its samples.

    Parameters
    ----------
    motion : Motion
        What is resampled.
    dt : float
        The new time step in s.
    method : {"fft", "lanczos"}
        "fft" goes through the Fourier transform of the record padded with zeros to twice its length (scipy) and cuts
        off what the new step cannot hold; the steps must be as two whole numbers.  "lanczos" weighs 2 x 30 neighbours
        with a windowed sinc (obspy), for any shorter step, and never filters.

    Returns
    -------
    Motion
        With the step written into it.

    Raises
    ------
    InputError
        For a step that is not positive, that the method cannot reach, or longer than the record.

    Notes
    -----
    The objects are shaken by the polygon through the samples, so a finer step changes the motion between them: to
    subdivide without a change there is no need to resample.
    """
    if not (np.isfinite(dt) and 0.0 < dt <= motion.duration):
        raise InputError(f"dt must be above 0 and at most the record's {motion.duration:g} s, not {dt!r}")
    samples = int(np.floor(motion.duration / dt * (1.0 + 1e-12))) + 1
    if method == "fft":
        ratio = Fraction(motion.dt / dt).limit_denominator(1000)
        if abs(float(ratio) * dt / motion.dt - 1.0) > 1e-9:
            raise InputError(f"{motion.dt:g} s and {dt:g} s are not as two whole numbers up to 1000; use lanczos")
        out = _by_fourier(motion.acceleration, ratio, samples)
    elif method == "lanczos":
        if dt > motion.dt:
            raise InputError(f"lanczos does not filter, so dt must be at most {motion.dt:g} s, not {dt:g} s; use fft")
        out = _by_lanczos(motion, dt, samples)
    else:
        raise InputError(f"method must be 'fft' or 'lanczos', not {method!r}")
    step = f"resampled from {motion.dt:g} s to {dt:g} s ({method})"
    return Motion(dt, out, motion.name, (*motion.steps, step), motion.source)


def _by_fourier(data: Array, ratio: Fraction, samples: int) -> Array:
    from scipy.signal import resample as through_fourier

    n = data.shape[1]
    # The transform repeats its record for ever: zeros keep one end away from the other.  Whole new samples fit in.
    padded = -(-2 * n // ratio.denominator) * ratio.denominator
    rows = np.pad(data, ((0, 0), (0, padded - n)))
    out = through_fourier(rows, padded // ratio.denominator * ratio.numerator, axis=1)
    return np.asarray(out, dtype=np.float64)[:, :samples]


def _by_lanczos(motion: Motion, dt: float, samples: int) -> Array:
    from obspy.signal.interpolation import lanczos_interpolation

    pad = _LANCZOS_WIDTH + 1
    rows = np.pad(motion.acceleration, ((0, 0), (pad, pad)))
    return np.stack(
        [lanczos_interpolation(row, -pad * motion.dt, motion.dt, 0.0, dt, samples, a=_LANCZOS_WIDTH) for row in rows]
    )


def _held(t: Array, start: float, end: float) -> Array:
    """1 between two times and 0 outside, with the share of a step at each edge that keeps the integral exact."""
    dt = float(t[1] - t[0])
    reach = np.clip((t + 0.5 * dt - start) / dt, 0.0, 1.0) - np.clip((t + 0.5 * dt - end) / dt, 0.0, 1.0)
    return np.asarray(reach, dtype=np.float64)


def _segment(motion: Motion, row: int) -> tuple[float, float]:
    above = np.flatnonzero(np.abs(motion.acceleration[row]) > IWAN_THRESHOLD)
    if above.size >= 2:
        return float(above[0] * motion.dt), float(above[-1] * motion.dt)
    return strong_part(motion)


def _told(values: Array | list[float], unit: str) -> str:
    return ", ".join(f"{axis} {value:.3g} {unit}" for axis, value in zip("xyz", values, strict=True))


def _stepped(motion: Motion, data: Array, step: str) -> Motion:
    return Motion(motion.dt, data, motion.name, (*motion.steps, step), motion.source)
