"""Response spectra of a motion, exact for its polygon, and its Fourier amplitude spectrum."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from pipeline.errors import InputError
from pipeline.kernels import samples
from pipeline.kernels.linear import advance, transition
from pipeline.kernels.oscillator import oscillator_batch, oscillator_history
from pipeline.kernels.rotated import first_guess, rotated_peaks
from pipeline.quantities import Array
from pipeline.records import Motion
from pipeline.supports import resampled

COMPONENTS = ("x", "y", "z", "rotd50", "rotd100")

NODE_PHASE = 0.2
"""Radians of the oscillator's own phase between two nodes of a rotated history, at most."""

NODE_PARTS = 16
"""Points at which each interval that may hold a rotated peak is looked at."""

_ANGLES = np.arange(180)
_NORMALS = np.vstack([np.cos(np.radians(_ANGLES)), np.sin(np.radians(_ANGLES))])


@dataclass(frozen=True, eq=False)
class Spectrum:
    """Peak response of oscillators to one component of a motion.

    Attributes
    ----------
    component : str
        "x", "y", "z", "rotd50" (median over the horizontal directions) or "rotd100" (largest of them).
    periods : array, shape (m,)
        In s.
    damping : array, shape (k,)
        Ratio to critical.
    displacement : array, shape (k, m)
        In m, largest abs(u) relative to the base (Sd).
    absolute_acceleration : array, shape (k, m), or None
        In m/s2, largest abs(a + u'') (SA); None for rotd50 and rotd100.
    """

    component: str
    periods: Array
    damping: Array
    displacement: Array
    absolute_acceleration: Array | None = None

    @property
    def pseudo_acceleration(self) -> Array:
        """PSA = w^2 Sd, (k, m) m/s2."""
        return (2.0 * np.pi / self.periods) ** 2 * self.displacement


def standard_periods(n: int = 200) -> Array:
    """Return periods from 0.01 to 20 s in equal ratios, which is 100 to 0.05 Hz.

    Parameters
    ----------
    n : int
        How many, at least two.

    Returns
    -------
    array, shape (n,)
        In s.

    Raises
    ------
    InputError
        For fewer than two.
    """
    if n < 2:
        raise InputError(f"a spectrum needs at least 2 periods, not {n}")
    return np.geomspace(0.01, 20.0, n)


def response_spectra(
    motion: Motion,
    periods: Sequence[float] | Array,
    damping: float | Sequence[float] | Array = 0.05,
    components: Iterable[str] = COMPONENTS,
) -> dict[str, Spectrum]:
    """Return the response spectra of a motion, by component, free decay after the record included.

    Parameters
    ----------
    motion : Motion
        What the oscillators stand on.
    periods : array_like, shape (m,)
        In s, each above 0.
    damping : float or array_like, shape (k,)
        Ratio to critical, each at least 0.
    components : iterable of str
        Any of "x", "y", "z", "rotd50", "rotd100".

    Returns
    -------
    dict of str to Spectrum
        By component, in the order asked for.

    Raises
    ------
    InputError
        Naming the value that is not allowed.

    Notes
    -----
    A linear oscillator lets the two histories be rotated instead of the input.  rotd50 is the median of the directions
    0, 1, ... 179 degrees; rotd100 is the peak resultant, over all directions.

    Error of x, y and z: rounding, about 1e-11 relative, peaks between samples included.  rotd50 and rotd100 are within
    1e-4 of the exact peaks of their directions (measured: 4e-5 below critical damping, 1e-4 at twice critical): the
    histories are rotated as cubics between nodes NODE_PHASE rad of the oscillator's phase apart and looked at in
    NODE_PARTS points of each interval that may hold a peak.

    References
    ----------
    Nigam, N. C. and Jennings, P. C. (1969), exact for piecewise-linear input.
    Boore, D. M. (2010), orientation-independent measures RotDnn.
    """
    t = _allowed("period", periods, above=True)
    z = _allowed("damping", np.atleast_1d(np.asarray(damping, dtype=np.float64)), above=False)
    wanted = tuple(dict.fromkeys(components))
    for name in wanted:
        if name not in COMPONENTS:
            raise InputError(f"component {name!r} is not known; use {', '.join(COMPONENTS)}")
    out: dict[str, Spectrum] = {}
    for name in wanted:
        if name in "xyz":
            u, a = _one_direction(motion, "xyz".index(name), t, z)
            out[name] = Spectrum(name, t, z, u, a)
    if "rotd50" in wanted or "rotd100" in wanted:
        median, largest = _rotated(motion, t, z)
        for name, u in (("rotd50", median), ("rotd100", largest)):
            if name in wanted:
                out[name] = Spectrum(name, t, z, u)
    return {name: out[name] for name in wanted}


def psa(motion: Motion, periods: Sequence[float] | Array, damping: float = 0.05, component: str = "rotd100") -> Array:
    """Return the pseudo-acceleration spectrum of one component at one damping.

    Parameters
    ----------
    motion, periods : Motion, array_like, shape (m,)
        As of `response_spectra`; periods in s.
    damping : float
        Ratio to critical.
    component : str
        "x", "y", "z", "rotd50" or "rotd100".

    Returns
    -------
    array, shape (m,)
        In m/s2.

    Raises
    ------
    InputError
        As `response_spectra`.
    """
    acceleration: Array = response_spectra(motion, periods, damping, (component,))[component].pseudo_acceleration[0]
    return acceleration


def fourier_amplitude(motion: Motion) -> tuple[Array, Array]:
    """Return the Fourier amplitude spectra of a motion's samples.

    The record is padded with zeros to a length that transforms fast.  The amplitude is abs(dt * DFT), so that the sum
    of its squares over both signs of frequency, times the frequency step, is the sum of a^2 dt (Parseval).

    Parameters
    ----------
    motion : Motion
        What is transformed.

    Returns
    -------
    array, shape (m,)
        Frequencies in Hz.
    array, shape (3, m)
        Amplitudes in m/s, rows x, y, z.
    """
    from scipy.fft import next_fast_len, rfft, rfftfreq

    n = int(next_fast_len(motion.samples, real=True))
    amplitude = motion.dt * np.abs(rfft(motion.acceleration, n, axis=1))
    return np.asarray(rfftfreq(n, motion.dt), dtype=np.float64), np.asarray(amplitude, dtype=np.float64)


def response_history(motion: Motion, row: int, period: float, damping: float) -> tuple[Array, Array]:
    """Return the response of one oscillator to one component, at the samples.

    Parameters
    ----------
    motion : Motion
        What it stands on.
    row : int
        The component: 0 x, 1 y, 2 z.
    period : float
        In s.
    damping : float
        Ratio to critical.

    Returns
    -------
    array, shape (n,)
        u in m, relative to the base.
    array, shape (n,)
        a + u'' in m/s2.

    Notes
    -----
    Error: rounding, about 1e-12 of the largest value.
    """
    history = np.zeros((motion.samples, 2))
    base = samples(motion.acceleration[row])
    oscillator_history(base, motion.dt, 2.0 * np.pi / period, damping, 1.0, history)
    return history[:, 0].copy(), history[:, 1].copy()


def _allowed(name: str, values: Sequence[float] | Array, *, above: bool) -> Array:
    array = np.array(values, dtype=np.float64, ndmin=1)
    if array.ndim != 1 or array.size == 0:
        raise InputError(f"{name}: give a list of at least one number, not an array of shape {array.shape}")
    bad = ~np.isfinite(array) | ((array <= 0.0) if above else (array < 0.0))
    if bad.any():
        at = int(np.argmax(bad))
        raise InputError(f"{name} must be {'above' if above else 'at least'} 0, not {array[at]:g} (entry {at})")
    return array


def _one_direction(motion: Motion, row: int, periods: Array, damping: Array) -> tuple[Array, Array]:
    w = np.tile(2.0 * np.pi / periods, damping.size)
    zeta = np.repeat(damping, periods.size)
    u, a = np.empty(w.size), np.empty(w.size)
    base = samples(motion.acceleration[row])
    oscillator_batch(base, motion.dt, w, zeta, np.ones_like(w), -1.0, u, a)
    shape = (damping.size, periods.size)
    return u.reshape(shape), a.reshape(shape)


def _rotated(motion: Motion, periods: Array, damping: Array) -> tuple[Array, Array]:
    median = np.zeros((damping.size, periods.size))
    largest = np.zeros_like(median)
    if motion.samples < 2 or not motion.acceleration[:2].any():
        return median, largest
    fine: dict[int, Motion] = {}
    for i, zeta in enumerate(damping):
        for j, period in enumerate(periods):
            # A strongly damped oscillator answers with rates up to 2 zeta w.
            pieces = max(1, int(np.ceil(2.0 * np.pi / period * (1.0 + zeta) * motion.dt / NODE_PHASE)))
            if pieces not in fine:
                fine = {pieces: resampled(motion, pieces)}  # neighbouring periods share it; the others are let go
            median[i, j], largest[i, j] = _rotd(fine[pieces], float(period), float(zeta))
    return median, largest


def _rotd(motion: Motion, period: float, zeta: float) -> tuple[float, float]:
    """RotD50 and RotD100 of the displacement [m] of one oscillator; the motion is sampled finely enough."""
    w, h = 2.0 * np.pi / period, motion.dt
    u = np.empty((2, motion.samples))
    bend = np.empty_like(u)
    ends = np.empty((2, 2))
    for row in range(2):
        a = motion.acceleration[row]
        u[row], absolute = response_history(motion, row, period, zeta)
        bend[row] = absolute - a
        ends[row] = u[row, -1], _last_velocity(u[row, -2], u[row, -1], a[-2], a[-1], w, zeta, h)
    steps, tail, tail_bend = _free_decay(ends, w, zeta)
    peaks, resultant = _support(u, bend, np.full(motion.samples - 1, h))
    after, far = _support(tail, tail_bend, steps)
    return float(np.median(np.maximum(peaks, after))), max(resultant, far)


def _last_velocity(u0: float, u1: float, a0: float, a1: float, w: float, zeta: float, h: float) -> float:
    # The velocity that carries u0 into u1 under the last piece of the polygon, and what becomes of it.
    g, by_velocity, by_step, by_ramp = transition(w, zeta, h)
    f0, f1 = -a0, -(a1 - a0) / h
    v0 = (u1 - u0 * g - f0 * by_step - f1 * by_ramp) / by_velocity
    return float(advance(u0, v0, f0, f1, w, zeta, h)[1])


def _free_decay(ends: Array, w: float, zeta: float) -> tuple[Array, Array, Array]:
    """Steps (m,) s, displacement (2, m + 1) m and its second derivative after the record, past every later peak."""
    if zeta < 1.0:
        # The peaks decay, so that the largest of any direction lies within the first damped period.
        span = 2.0 * np.pi / (w * np.sqrt((1.0 - zeta) * (1.0 + zeta)))
        span = min(span, 60.0 / (w * max(zeta, 1e-300)))
        count = int(np.ceil(span * w * (1.0 + zeta) / NODE_PHASE))
        times = np.linspace(0.0, span, count + 1)
    else:
        first = NODE_PHASE / (w * (1.0 + zeta))
        times = np.concatenate([[0.0], np.geomspace(first, 60.0 * (1.0 + zeta) / w, 60 * int(np.ceil(2.0 + zeta)))])
    u, bend = np.empty((2, times.size)), np.empty((2, times.size))
    for row in range(2):
        for k, t in enumerate(times):
            u[row, k], v = advance(ends[row, 0], ends[row, 1], 0.0, 0.0, w, zeta, t)
            bend[row, k] = -2.0 * zeta * w * v - w * w * u[row, k]
    return np.diff(times), u, bend


def _support(u: Array, bend: Array, steps: Array) -> tuple[Array, float]:
    """Peak |u . n| over time in each of 180 directions (180,), and the peak |u|; arguments as `rotated_peaks`."""
    peaks = np.empty(_NORMALS.shape[1])
    first_guess(u, _NORMALS, peaks)
    largest = rotated_peaks(u, bend, steps, _NORMALS, NODE_PARTS, peaks)
    return peaks, float(largest)
