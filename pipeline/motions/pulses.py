"""Pulses of a motion: half-cycles between zero crossings, and near-fault velocity pulses found with a wavelet."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from math import exp

import numpy as np

from pipeline.errors import InputError
from pipeline.quantities import Array

PERIODS = (0.25, 15.0)
"""Shortest and longest pulse period looked for [s] (Baker 2007; Shahi and Baker 2014)."""

WAVELETS = 10
"""Wavelets of one scale whose sum is the pulse (Baker 2007)."""

CANDIDATES = 5
"""Places in time where Shahi and Baker (2014) look for a pulse."""

NEARBY = 10.0 / 25.0
"""Further wavelets lie within this share of the scale of the first one, before and after."""

BAKER_LIKELY = 0.85
"""Pulse indicator above which Baker (2007) calls a motion pulse-like."""

BAKER_PGV = 0.30
"""Least PGV of a pulse-like motion [m/s] (Baker 2007)."""

_SCALE_RATIO = 1.05


@dataclass(frozen=True, slots=True)
class HalfCycle:
    """What lies between two zero crossings of a history.

    Attributes
    ----------
    start : float
        In s from the first sample.
    duration : float
        In s.
    peak : float
        Signed largest value, m/s of a velocity or m/s2 of an acceleration.
    area : float
        Signed integral: the displacement increment in m, or the velocity increment in m/s.
    """

    start: float
    duration: float
    peak: float
    area: float


@dataclass(frozen=True, eq=False)
class WaveletPulse:
    """The strongest pulse found in a velocity history, whether or not it makes the motion pulse-like.

    Attributes
    ----------
    is_pulse : bool
        The verdict of the method.
    indicator : float
        Baker: a probability, pulse-like above 0.85; Shahi and Baker: pulse-like above 0.
    period : float
        Tp in s, the pseudo-period of the wavelet.
    angle : float
        Degrees from x towards y of the direction that it was found in (0 where one history was given).
    time : float
        In s from the first sample, the centre of the largest wavelet.
    pgv : float
        In m/s, of the velocity in that direction.
    pulse_pgv : float
        In m/s, of the pulse alone.
    pgv_ratio, energy_ratio : float
        The residual's PGV and sum of squares over those of the whole.
    late : bool
        The pulse comes after the strong shaking has begun, so it is not taken for directivity.
    velocity, pulse, residual : array, shape (n,)
        In m/s each; velocity = pulse + residual.
    method : str
        Source of the criterion.
    """

    is_pulse: bool
    indicator: float
    period: float
    angle: float
    time: float
    pgv: float
    pulse_pgv: float
    pgv_ratio: float
    energy_ratio: float
    late: bool
    velocity: Array
    pulse: Array
    residual: Array
    method: str


def velocity_half_cycles(acceleration: Array, dt: float, initial_velocity: float = 0.0) -> tuple[HalfCycle, ...]:
    """Return every half-cycle of the velocity between its zero crossings, in order of time.

    Parameters
    ----------
    acceleration : array, shape (n,)
        In m/s2, piecewise linear.
    dt : float
        Time step in s.
    initial_velocity : float
        In m/s.

    Returns
    -------
    tuple of HalfCycle
        Peaks in m/s, areas in m.

    Raises
    ------
    InputError
        For anything but one row of at least two finite values.

    Notes
    -----
    Error: rounding; crossings and peaks between samples are exact for the polygon.
    """
    t, a, v, u = _refined(acceleration, dt, initial_velocity)
    crossing = np.flatnonzero(v[:-1] * v[1:] < 0.0)
    a0, v0 = a[crossing], v[crossing]
    rate = np.diff(a)[crossing] / np.diff(t)[crossing]
    # The velocity is monotone between two neighbours here, so the root is the one that it moves towards.
    root = np.sqrt(np.maximum(0.0, a0 * a0 - 2.0 * rate * v0))
    wait = -2.0 * v0 / (a0 - np.sign(v0) * root)
    area = u[crossing] + wait * (v0 + wait * (a0 / 2.0 + wait * rate / 6.0))
    at = crossing + 1
    return _between_zeros(np.insert(t, at, t[crossing] + wait), np.insert(v, at, 0.0), np.insert(u, at, area))


def baker_pulse(velocity: Array, dt: float) -> WaveletPulse:
    """Identify a velocity pulse in one direction by the criterion of Baker (2007).

    Parameters
    ----------
    velocity : array, shape (n,)
        In m/s, in the direction of interest (fault-normal in the paper).
    dt : float
        Time step in s.

    Returns
    -------
    WaveletPulse
        Pulse-like when the indicator exceeds 0.85, the pulse arrives early and the PGV is at least 0.3 m/s.

    Raises
    ------
    InputError
        For a velocity that is zero, not finite or shorter than the shortest wavelet.

    Notes
    -----
    Largest coefficient of the continuous transform with the Daubechies wavelet of order 4; ten wavelets of that scale;
    PI = 1/(1 + exp(-23.3 + 14.6 PGV ratio + 20.5 energy ratio)); late when the pulse reaches 10 % of its energy after
    the motion reached 20 %.  The scales are in ratios of 1.05, refined around the largest, and the energy is the sum of
    squares.

    Error: Tp of Ricker pulses and of most pulses of one or two lobes is within 10 % of the period that they were made
    with; with more lobes, or between odd and even, it is up to 17 % off: the wavelet has few lobes.

    References
    ----------
    Baker, J. W. (2007), Quantitative classification of near-fault ground motions using wavelet analysis, BSSA 97,
    1486-1501.
    """
    v = _checked(velocity, dt, rows=1)[0]
    scales = _scales(dt)
    size = np.abs(_transform(v, scales))
    row, at = np.unravel_index(int(np.argmax(size)), size.shape)
    found = _extract(v, dt, float(scales[row]), int(at))
    indicator = 1.0 / (1.0 + exp(min(700.0, -23.3 + 14.6 * found.pgv_ratio + 20.5 * found.energy_ratio)))
    late = _reaches(found.pulse, 0.10) > _reaches(v, 0.20)
    likely = indicator > BAKER_LIKELY and not late and found.pgv >= BAKER_PGV
    return _judged(found, likely, indicator, 0.0, late, v, "Baker 2007")


def shahi_baker_pulses(velocity: Array, dt: float) -> tuple[WaveletPulse, ...]:
    """Return the five candidate pulses of Shahi and Baker (2014), each in its own direction and judged.

    Parameters
    ----------
    velocity : array, shape (2, n) or (3, n)
        In m/s, rows x, y (and z, which is not looked at).
    dt : float
        Time step in s.

    Returns
    -------
    tuple of WaveletPulse
        The strongest first; fewer than five where nothing is left to look at.

    Raises
    ------
    InputError
        For a velocity that is zero, not finite or shorter than the shortest wavelet.

    Notes
    -----
    The direction with the largest coefficient follows from those of x and y; each candidate blocks its surroundings in
    time for the next.  With A = 0.63 PGV ratio + 0.777 energy ratio, P = (A - 1.208421)/0.2462717 and V = (PGV -
    11.58861)/18.88015 in cm/s the indicator is -7.817 - 0.5679 P^2 - 0.1516 V^2 - 3.0253 P - 1.7396 V - 2.7156 P V;
    late when the motion has released 17 % of its energy before the pulse has 5 % of its own.  Scales and energy as in
    `baker_pulse`.

    References
    ----------
    Shahi, S. K. and Baker, J. W. (2014), An efficient algorithm to identify strong-velocity pulses in multicomponent
    ground motions, BSSA 104, 2456-2466, and the constants of the authors' published implementation
    (github.com/shreyshahi/PulseClassification).
    """
    rows = _checked(velocity, dt, rows=2)
    scales = _scales(dt)
    x, y = _transform(rows[0], scales), _transform(rows[1], scales)
    size = x * x + y * y
    out: list[WaveletPulse] = []
    for _ in range(CANDIDATES):
        row, at = (int(i) for i in np.unravel_index(int(np.argmax(size)), size.shape))
        if size[row, at] == 0.0:
            break
        angle = float(np.degrees(np.arctan2(y[row, at], x[row, at])) % 180.0)
        v = np.cos(np.radians(angle)) * rows[0] + np.sin(np.radians(angle)) * rows[1]
        found = _extract(v, dt, float(scales[row]), at)
        p = (0.63 * found.pgv_ratio + 0.777 * found.energy_ratio - 1.208421) / 0.2462717
        q = (100.0 * found.pgv - 11.58861) / 18.88015
        indicator = -7.817 - 0.5679 * p * p - 0.1516 * q * q - 3.0253 * p - 1.7396 * q - 2.7156 * p * q
        released = np.cumsum(v * v) / (v @ v)
        of_pulse = np.cumsum(found.pulse**2) / (found.pulse @ found.pulse)
        begun = int(np.searchsorted(of_pulse, 0.05, side="right")) - 1
        late = bool(released[max(0, begun)] >= 0.17)
        out.append(_judged(found, indicator > 0.0 and not late, indicator, angle, late, v, "Shahi and Baker 2014"))
        reach = NEARBY * float(scales[row])
        size[:, max(0, int(np.ceil(at - reach))) : int(np.floor(at + reach)) + 1] = 0.0
    return tuple(out)


def shahi_baker_pulse(velocity: Array, dt: float) -> WaveletPulse:
    """Return the first candidate of `shahi_baker_pulses` that is a pulse, or else the strongest candidate.

    Parameters
    ----------
    velocity : array, shape (2, n) or (3, n)
        In m/s, rows x, y (and z, which is not looked at).
    dt : float
        Time step in s.

    Returns
    -------
    WaveletPulse
        With the direction that it was found in.

    Raises
    ------
    InputError
        As `shahi_baker_pulses`.
    """
    candidates = shahi_baker_pulses(velocity, dt)
    return next((one for one in candidates if one.is_pulse), candidates[0])


def _refined(acceleration: Array, dt: float, initial_velocity: float) -> tuple[Array, Array, Array, Array]:
    """Times, acceleration, velocity and displacement at the samples and at the zeros of the acceleration."""
    a = np.asarray(acceleration, dtype=np.float64)
    if a.ndim != 1 or a.size < 2 or not np.isfinite(a).all():
        raise InputError(f"half-cycles need a history of at least two finite values, not an array of shape {a.shape}")
    t = np.asarray(np.arange(a.size) * dt, dtype=np.float64)
    crossing = np.flatnonzero(a[:-1] * a[1:] < 0.0)
    share = a[crossing] / (a[crossing] - a[crossing + 1])
    t = np.asarray(np.insert(t, crossing + 1, (crossing + share) * dt), dtype=np.float64)
    a = np.insert(a, crossing + 1, 0.0)
    h = np.diff(t)
    v: Array = np.zeros_like(a)
    v[1:] = np.cumsum(0.5 * h * (a[:-1] + a[1:]))
    v += initial_velocity
    u: Array = np.concatenate([[0.0], np.cumsum(h * v[:-1] + h * h * (a[:-1] / 3.0 + a[1:] / 6.0))])
    return t, a, v, u


def _between_zeros(t: Array, values: Array, integral: Array) -> tuple[HalfCycle, ...]:
    edges = np.unique(np.concatenate([[0], np.flatnonzero(values == 0.0), [values.size - 1]]))
    out = []
    highest = np.maximum.reduceat(values, edges[:-1])
    lowest = np.minimum.reduceat(values, edges[:-1])
    ends = values[edges[1:]]  # the last sample of the record need not be a zero
    for i, (a, b) in enumerate(pairwise(edges.tolist())):
        high, low = max(highest[i], ends[i]), min(lowest[i], ends[i])
        peak = float(high if high >= -low else low)
        if peak != 0.0:
            out.append(HalfCycle(float(t[a]), float(t[b] - t[a]), peak, float(integral[b] - integral[a])))
    return tuple(out)


@dataclass(frozen=True, eq=False)
class _Extracted:
    period: float
    time: float
    pgv: float
    pgv_ratio: float
    energy_ratio: float
    pulse: Array
    residual: Array


def _judged(
    found: _Extracted, is_pulse: bool, indicator: float, angle: float, late: bool, velocity: Array, method: str
) -> WaveletPulse:
    return WaveletPulse(
        is_pulse=is_pulse,
        indicator=indicator,
        period=found.period,
        angle=angle,
        time=found.time,
        pgv=found.pgv,
        pulse_pgv=float(np.abs(found.pulse).max()),
        pgv_ratio=found.pgv_ratio,
        energy_ratio=found.energy_ratio,
        late=late,
        velocity=velocity,
        pulse=found.pulse,
        residual=found.residual,
        method=method,
    )


def _checked(velocity: Array, dt: float, rows: int) -> Array:
    v = np.asarray(velocity, dtype=np.float64)
    shaped = v.ndim == 1 if rows == 1 else v.ndim == 2 and v.shape[0] in {2, 3}
    if not shaped:
        wanted = "(n,)" if rows == 1 else "(2, n) or (3, n), rows x and y"
        raise InputError(f"pulse identification: the velocity must have the shape {wanted}; it is {v.shape}")
    v = v.reshape(-1, v.shape[-1])[:rows]
    if not np.isfinite(v).all():
        raise InputError("pulse identification: the velocity holds a value that is not finite; mend the record")
    if not (np.isfinite(dt) and dt > 0.0):
        raise InputError(f"pulse identification: dt must be a positive number of seconds, not {dt!r}")
    if (v.shape[1] - 1) * dt < PERIODS[0]:
        raise InputError(f"pulse identification: a record of {(v.shape[1] - 1) * dt:g} s is too short for any pulse")
    if not v.any():
        raise InputError("pulse identification: the velocity is zero; there is nothing to look for")
    return v


@cache
def _mother() -> tuple[Array, Array, float]:
    import pywt

    wavelet = pywt.Wavelet("db4")
    _, psi, x = wavelet.wavefun(level=10)
    return np.asarray(x, dtype=np.float64), np.asarray(psi, dtype=np.float64), float(pywt.central_frequency("db4"))


def _scales(dt: float) -> Array:
    """Scales in samples whose pseudo-periods span PERIODS; none so short that its wavelet has no samples."""
    _, _, frequency = _mother()
    shortest = max(PERIODS[0], 4.0 * dt)
    count = int(np.ceil(np.log(PERIODS[1] / shortest) / np.log(_SCALE_RATIO))) + 1
    return np.geomspace(shortest, PERIODS[1], count) * frequency / dt


def _atom(scale: float) -> Array:
    """The wavelet of that scale (samples) on an odd number of samples about its centre, with a sum of squares of 1."""
    x, psi, _ = _mother()
    half = int(np.ceil(0.5 * x[-1] * scale))
    out: Array = np.interp(np.arange(-half, half + 1) / scale + 0.5 * x[-1], x, psi, left=0.0, right=0.0)
    out /= np.sqrt(out @ out)
    return out


def _transform(v: Array, scales: Array) -> Array:
    """Coefficients (scales, n): the inner products of the history, zero outside, with every shifted wavelet."""
    from scipy.signal import fftconvolve

    return np.stack([np.asarray(fftconvolve(v, _atom(float(s))[::-1], mode="same")) for s in scales])


def _placed(atom: Array, at: int, n: int) -> Array:
    half = atom.size // 2
    out = np.zeros(n)
    first, last = max(0, at - half), min(n, at + half + 1)
    out[first:last] = atom[first - at + half : last - at + half]
    return out


def _extract(v: Array, dt: float, scale: float, at: int) -> _Extracted:
    """Take the pulse at a scale and a place out of a history: ten wavelets, the largest of what is left each time."""
    n = v.size
    bounds = _scales(dt)[[0, -1]]
    near = np.clip(scale * np.geomspace(1.0 / _SCALE_RATIO, _SCALE_RATIO, 21), *bounds)
    scale = float(max(near, key=lambda s: abs(float(_placed(_atom(float(s)), at, n) @ v))))
    atom = _atom(scale)
    reach = int(np.ceil(NEARBY * scale))
    first, last = max(0, at - reach), min(n, at + reach + 1)
    pulse = np.zeros(n)
    centre = at
    for k in range(WAVELETS):
        coefficients = _transform(v - pulse, np.array([scale]))[0]
        best = first + int(np.argmax(np.abs(coefficients[first:last])))
        if k == 0:
            centre = best
        pulse += coefficients[best] * _placed(atom, best, n)
    residual = v - pulse
    pgv = float(np.abs(v).max())
    return _Extracted(
        period=scale * dt / _mother()[2],
        time=centre * dt,
        pgv=pgv,
        pgv_ratio=float(np.abs(residual).max()) / pgv,
        energy_ratio=float(residual @ residual) / float(v @ v),
        pulse=pulse,
        residual=residual,
    )


def _reaches(v: Array, share: float) -> int:
    """The first sample at which a history has released that share of its sum of squares."""
    energy = np.cumsum(v * v)
    return int(np.searchsorted(energy, share * energy[-1]))
