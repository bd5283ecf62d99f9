"""The virtual shake table: test signals as motions, reproducible from their parameters alone.

Each signal shakes one direction, "x", "y" or "z"; the other two rest.  dt is the longest step that is allowed: where a
pulse has to end on a sample, the step is shortened until it does.
"""

from __future__ import annotations

from typing import Literal

import numpy as np

from pipeline.errors import InputError
from pipeline.quantities import Array
from pipeline.records import Motion

Direction = Literal["x", "y", "z"]
Kind = Literal["acceleration", "velocity"]

SOURCE = "virtual shake table"

MOST_SAMPLES = 5_000_000
"""Longest signal that is made; more is a mistyped duration or step."""

RICKER_HALF_LENGTH = 1.75
"""Periods on both sides of a Ricker pulse: the wavelet is below 1e-11 of its peak there."""


def sine(
    amplitude: float,
    frequency: float,
    cycles: float,
    *,
    dt: float = 0.005,
    ramp: float = 0.0,
    phase: float = 0.0,
    direction: Direction = "x",
) -> Motion:
    """Return A sin(2 pi f t + phase) over a number of cycles.

    Parameters
    ----------
    amplitude : float
        A in m/s2.
    frequency : float
        f in Hz.
    cycles : float
        How many.
    dt, ramp : float
        Longest time step, and length of the cosine ramps at both ends, in s.
    phase : float
        In degrees.
    direction : {"x", "y", "z"}
        The direction that is shaken; the others rest.

    Returns
    -------
    Motion

    Raises
    ------
    InputError
        Naming the parameter, what is allowed and why.

    Notes
    -----
    Error: the polygon through the samples falls short of the sine by up to (pi f dt)^2 / 2 of the amplitude.
    """
    positive(amplitude=amplitude, frequency=frequency, cycles=cycles, dt=dt)
    _below_nyquist("frequency", frequency, dt)
    t, step = _times(cycles / frequency, dt)
    a = amplitude * np.sin(2.0 * np.pi * frequency * t + np.radians(_finite("phase", phase)))
    a *= _ramps(t, ramp)
    told = f"sine of {amplitude:.6g} m/s2 at {frequency:g} Hz, {cycles:g} cycles, phase {phase:g} deg, ramps {ramp:g} s"
    return one_direction(a, step, direction, f"sine {frequency:g} Hz", told)


def swept_sine(
    amplitude: float,
    first: float,
    last: float,
    duration: float,
    *,
    dt: float = 0.0025,
    sweep: Literal["linear", "logarithmic"] = "linear",
    ramp: float = 0.0,
    direction: Direction = "x",
) -> Motion:
    """Return a sine whose frequency runs from one to another, linearly in time or in octaves per second.

    Parameters
    ----------
    amplitude : float
        In m/s2.
    first, last : float
        Frequencies in Hz at the start and at the end.
    duration, dt, ramp : float
        In s; dt is the longest time step, ramp the length of the cosine ramps at both ends.
    sweep : {"linear", "logarithmic"}
        How the frequency runs.
    direction : {"x", "y", "z"}
        The direction that is shaken; the others rest.

    Returns
    -------
    Motion

    Raises
    ------
    InputError
        As `sine`.
    """
    positive(amplitude=amplitude, first=first, last=last, duration=duration, dt=dt)
    if first == last:
        raise InputError(f"swept_sine: first and last are both {first:g} Hz; use sine for a single frequency")
    _below_nyquist("first and last", max(first, last), dt)
    t, step = _times(duration, dt)
    if sweep == "linear":
        turns = first * t + (last - first) * t * t / (2.0 * duration)
    elif sweep == "logarithmic":
        rate = np.log(last / first) / duration
        turns = first * np.expm1(rate * t) / rate
    else:
        raise InputError(f"swept_sine: sweep must be 'linear' or 'logarithmic', not {sweep!r}")
    a = amplitude * np.sin(2.0 * np.pi * turns) * _ramps(t, ramp)
    told = f"{sweep} sweep of {amplitude:.6g} m/s2 from {first:g} to {last:g} Hz in {duration:g} s, ramps {ramp:g} s"
    return one_direction(a, step, direction, f"sweep {first:g} to {last:g} Hz", told)


def band_limited_random(
    rms: float,
    first: float,
    last: float,
    duration: float,
    seed: int,
    *,
    dt: float = 0.005,
    ramp: float = 0.5,
    direction: Direction = "x",
) -> Motion:
    """Return Gaussian noise with a flat spectrum between two frequencies, the same for the same seed.

    Parameters
    ----------
    rms : float
        Root mean square in m/s2, before the ramps.
    first, last : float
        The band in Hz.
    duration : float
        In s.
    seed : int
        Whole number from 0.
    dt, ramp : float
        Longest time step, and length of the cosine ramps at both ends, in s.
    direction : {"x", "y", "z"}
        The direction that is shaken; the others rest.

    Returns
    -------
    Motion

    Raises
    ------
    InputError
        As `sine`, and for a band that holds no line of the record's Fourier spectrum.
    """
    positive(rms=rms, last=last, duration=duration, dt=dt)
    if not 0.0 <= first < last:
        raise InputError(f"band_limited_random: first must be at least 0 and below last ({last:g} Hz), not {first!r}")
    _below_nyquist("last", last, dt)
    t, step = _times(duration, dt)
    frequency = np.fft.rfftfreq(t.size, step)
    inside = (frequency >= first) & (frequency <= last) & (frequency > 0.0)
    if not inside.any():
        raise InputError(
            f"band_limited_random: no line of a record of {duration:g} s lies from {first:g} to {last:g} Hz; "
            f"widen the band or lengthen the record"
        )
    lines = np.zeros(frequency.size, dtype=np.complex128)
    draws = generator(seed).normal(size=(2, int(inside.sum())))
    lines[inside] = draws[0] + 1j * draws[1]
    a = np.fft.irfft(lines, t.size)
    a *= rms / np.sqrt(np.mean(a * a))
    told = f"random of {rms:.6g} m/s2 rms from {first:g} to {last:g} Hz, {duration:g} s, seed {seed}, ramps {ramp:g} s"
    return one_direction(a * _ramps(t, ramp), step, direction, f"random, seed {seed}", told)


def rectangular_pulse(peak: float, duration: float, *, dt: float = 0.005, direction: Direction = "x") -> Motion:
    """Return a constant acceleration: the record jumps to it at its first sample and back to zero after its last.

    Parameters
    ----------
    peak : float
        In m/s2, of either sign.
    duration, dt : float
        In s; dt is the longest time step.
    direction : {"x", "y", "z"}
        The direction that is shaken; the others rest.

    Returns
    -------
    Motion

    Raises
    ------
    InputError
        As `sine`.
    """
    _nonzero("peak", peak)
    positive(duration=duration, dt=dt)
    t, step = _times(duration, dt)
    told = f"rectangular pulse of {peak:.6g} m/s2 over {duration:g} s"
    return one_direction(np.full(t.size, peak), step, direction, "rectangular pulse", told)


def half_sine_pulse(peak: float, duration: float, *, dt: float = 0.005, direction: Direction = "x") -> Motion:
    """Return A sin(pi t / T) over the duration T.

    Parameters
    ----------
    peak : float
        A in m/s2, of either sign.
    duration : float
        T in s.
    dt : float
        Longest time step in s.
    direction : {"x", "y", "z"}
        The direction that is shaken; the others rest.

    Returns
    -------
    Motion

    Raises
    ------
    InputError
        As `sine`.

    Notes
    -----
    Error: the polygon delivers less velocity than the half-sine by (pi dt / T)^2 / 12.
    """
    _nonzero("peak", peak)
    positive(duration=duration, dt=dt)
    t, step = _times(duration, dt)
    a = peak * np.sin(np.pi * t / duration)
    a[-1] = 0.0
    told = f"half-sine pulse of {peak:.6g} m/s2 over {duration:g} s"
    return one_direction(a, step, direction, "half-sine pulse", told)


def ricker(
    peak: float, period: float, *, of: Kind = "acceleration", dt: float = 0.005, direction: Direction = "x"
) -> Motion:
    """Return a symmetric Ricker pulse in acceleration or in velocity: (1 - 2 x^2) exp(-x^2), x = pi (t - t0) / Tp.

    Parameters
    ----------
    peak : float
        In m/s2 or m/s, of either sign.
    period : float
        Tp in s, where the pulse's Fourier spectrum peaks.
    of : {"acceleration", "velocity"}
        What has the shape of the pulse.
    dt : float
        Longest time step in s.
    direction : {"x", "y", "z"}
        The direction that is shaken; the others rest.

    Returns
    -------
    Motion

    Raises
    ------
    InputError
        As `sine`.

    References
    ----------
    Ricker, N. (1943); as a ground acceleration in Vassiliou, M. F. and Makris, N. (2011).
    """
    _nonzero("peak", peak)
    positive(period=period, dt=dt)
    _below_nyquist("period", 4.0 / period, dt)
    t, step = _times(2.0 * RICKER_HALF_LENGTH * period, dt)
    x = np.pi * (t / period - RICKER_HALF_LENGTH)
    bell = np.exp(-x * x)
    if of == "acceleration":
        a, unit = peak * (1.0 - 2.0 * x * x) * bell, "m/s2"
    elif of == "velocity":
        a, unit = peak * np.pi / period * (4.0 * x**3 - 6.0 * x) * bell, "m/s"
    else:
        raise InputError(f"ricker: of must be 'acceleration' or 'velocity', not {of!r}")
    told = f"Ricker pulse in {of}, peak {peak:.6g} {unit}, period {period:g} s"
    return one_direction(a, step, direction, f"Ricker {period:g} s", told)


def mavroeidis_papageorgiou(
    amplitude: float,
    period: float,
    cycles: float,
    phase: float = 0.0,
    *,
    dt: float = 0.005,
    direction: Direction = "x",
) -> Motion:
    """Return the near-fault pulse v = A/2 (1 + cos(2 pi f t / gamma)) cos(2 pi f t + nu), |t| <= gamma / (2 f).

    Parameters
    ----------
    amplitude : float
        A in m/s.
    period : float
        1/f in s.
    cycles : float
        gamma, above 1.
    phase : float
        nu in degrees.
    dt : float
        Longest time step in s.
    direction : {"x", "y", "z"}
        The direction that is shaken; the others rest.

    Returns
    -------
    Motion

    Raises
    ------
    InputError
        As `sine`.

    Notes
    -----
    Error: the acceleration is the exact derivative at the samples; the polygon's velocity is off by (pi dt / Tp)^2 / 3
    at most.  Unless nu is a multiple of 90 degrees the pulse leaves a displacement.

    References
    ----------
    Mavroeidis, G. P. and Papageorgiou, A. S. (2003), A mathematical representation of near-fault ground motions, BSSA
    93, 1099-1131, equation 3.
    """
    positive(amplitude=amplitude, period=period, dt=dt)
    if not (np.isfinite(cycles) and cycles > 1.0):
        raise InputError(f"mavroeidis_papageorgiou: cycles (gamma) must be above 1, not {cycles!r}")
    _below_nyquist("period", 4.0 / period, dt)
    t, step = _times(cycles * period, dt)
    w = 2.0 * np.pi / period
    at = t - 0.5 * cycles * period
    turn = w * at + np.radians(_finite("phase", phase))
    a = (
        -0.5
        * amplitude
        * w
        * (np.sin(w * at / cycles) * np.cos(turn) / cycles + (1.0 + np.cos(w * at / cycles)) * np.sin(turn))
    )
    told = f"Mavroeidis-Papageorgiou pulse, A {amplitude:.6g} m/s, Tp {period:g} s, gamma {cycles:g}, nu {phase:g} deg"
    return one_direction(a, step, direction, f"pulse {period:g} s", told)


def one_direction(a: Array, dt: float, direction: str, name: str, told: str) -> Motion:
    """Return the motion that shakes one direction with given samples.

    Parameters
    ----------
    a : array, shape (n,)
        In m/s2.
    dt : float
        Time step in s.
    direction : {"x", "y", "z"}
        The direction that is shaken; the other two rest.
    name : str
        What a report calls the motion.
    told : str
        What it is, with its parameters: its one step.

    Returns
    -------
    Motion

    Raises
    ------
    InputError
        For a direction that is not x, y or z.
    """
    if direction not in {"x", "y", "z"}:
        raise InputError(f"direction must be 'x', 'y' or 'z', not {direction!r}")
    rows = np.zeros((3, a.size))
    rows["xyz".index(direction)] = a
    return Motion(dt, rows, name, (f"{told}; direction {direction}, time step {dt:.6g} s",), SOURCE)


def _times(duration: float, dt: float) -> tuple[Array, float]:
    """Samples from 0 to exactly the duration, no farther apart than dt, and their step."""
    if duration / dt > MOST_SAMPLES:
        raise InputError(
            f"{duration:g} s in steps of {dt:g} s are more than {MOST_SAMPLES} samples; shorten it or lengthen dt"
        )
    # A duration that is a whole number of steps but for rounding keeps the step that was asked for.
    n = max(1, int(np.ceil(duration / dt * (1.0 - 1e-12))))
    step = duration / n
    return np.linspace(0.0, duration, n + 1), step


def _ramps(t: Array, ramp: float) -> Array:
    if not (np.isfinite(ramp) and 0.0 <= ramp <= 0.5 * t[-1]):
        raise InputError(f"ramp must be from 0 to half the duration ({0.5 * t[-1]:g} s), not {ramp!r}")
    if ramp == 0.0:
        return np.ones(t.size)
    edge = np.minimum(1.0, np.minimum(t, t[-1] - t) / ramp)
    return np.asarray(0.5 - 0.5 * np.cos(np.pi * edge), dtype=np.float64)


def generator(seed: int) -> np.random.Generator:
    """Return the random numbers of a seed.

    Parameters
    ----------
    seed : int
        Whole number from 0.

    Returns
    -------
    numpy.random.Generator

    Raises
    ------
    InputError
        Unless it is a whole number from 0.
    """
    if isinstance(seed, bool) or not isinstance(seed, int) or seed < 0:
        raise InputError(f"seed must be a whole number from 0, not {seed!r}")
    return np.random.default_rng(seed)


def positive(**values: float) -> None:
    """Refuse what is not a number above 0.

    Parameters
    ----------
    **values : float
        By the names that messages give them.

    Raises
    ------
    InputError
        Naming the value.
    """
    for name, value in values.items():
        if not (np.isfinite(value) and value > 0.0):
            raise InputError(f"{name} must be a number above 0, not {value!r}")


def _finite(name: str, value: float) -> float:
    if not np.isfinite(value):
        raise InputError(f"{name} must be a finite number, not {value!r}")
    return value


def _nonzero(name: str, value: float) -> None:
    if _finite(name, value) == 0.0:
        raise InputError(f"{name} must not be 0")


def _below_nyquist(name: str, frequency: float, dt: float) -> None:
    if frequency >= 0.5 / dt:
        raise InputError(f"{name}: {frequency:g} Hz needs a time step below {0.5 / frequency:.3g} s; dt is {dt:g} s")
