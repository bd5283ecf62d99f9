"""An accelerogram that matches a target response spectrum: the last signal of the virtual shake table."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from pipeline.errors import InputError
from pipeline.motions.spectra import response_history, response_spectra
from pipeline.motions.synthesis import Direction, generator, one_direction, positive
from pipeline.quantities import Array
from pipeline.records import Motion
from pipeline.supports import resampled

BAND = (0.2, 20.0)
"""Frequencies in Hz that are matched unless the caller says otherwise."""

ACCEPTED = 0.10
"""Largest relative misfit in the band that is handed out."""

_SCALINGS = 6
_CORRECTIONS = 30
_ATTEMPTS = 4

# Chosen by trial on plateau, constant and code spectra: larger steps overshoot where another peak takes the lead.
_SHARE = 0.4
_RECORDED_SHARE = 0.25
_RECORDED_CORRECTIONS = 60

# Of the envelope of a record: s over which it is smoothed, and the part of its length at each end that comes to rest.
_SMOOTHED = 2.0
_ENDS = 0.05

_SOFTNESS = 0.003


def spectrum_compatible(
    periods: Sequence[float] | Array,
    target: Sequence[float] | Array,
    duration: float,
    seed: int,
    *,
    damping: float = 0.05,
    dt: float = 0.005,
    band: tuple[float, float] = BAND,
    tolerance: float = 0.07,
    direction: Direction = "x",
) -> Motion:
    """Return a motion whose pseudo-acceleration spectrum matches a target, the same for the same seed.

    Noise of random phases in an envelope gets Fourier amplitudes scaled by target / response; then it is corrected in
    time: the peak of each oscillator is moved by reversed impulse responses, here in the combination with the least
    weighted sum of squares.  A draw that stays above ACCEPTED is thrown away and the next numbers of the same seed are
    taken.  The motion starts and ends with no acceleration and no velocity and ends with no displacement.

    Parameters
    ----------
    periods : array_like, shape (m,)
        In s, increasing; they must span the band.
    target : array_like, shape (m,)
        Pseudo-acceleration in m/s2; straight lines between them in log-log.
    duration : float
        In s, at least three periods of the band's lowest frequency.
    seed : int
        Whole number from 0.
    damping : float
        Ratio to critical, 0.005 to below 1.
    dt : float
        Longest time step in s, at most a quarter period of the band's highest frequency.
    band : (float, float)
        Frequencies in Hz that are matched, the lower one first.
    tolerance : float
        Relative misfit at which the search stops; what is reached is written into the motion's steps.
    direction : {"x", "y", "z"}
        The direction that is shaken.

    Returns
    -------
    Motion
        With a relative misfit of at most ACCEPTED at every frequency of the band, checked twice as densely as
        controlled.

    Raises
    ------
    InputError
        Naming the parameter, or when the misfit stays above ACCEPTED.

    References
    ----------
    Jennings, P. C., Housner, G. W. and Tsai, N. C. (1968), for the envelope.
    Gasparini, D. A. and Vanmarcke, E. H. (1976), SIMQKE, for the amplitudes.
    Lilhanand, K. and Tseng, W. S. (1988), for the corrections in time.
    """
    f, wanted, check, wanted_there = _grid(periods, target, damping, band)
    positive(duration=duration, dt=dt, tolerance=tolerance)
    if duration < 3.0 / band[0]:
        raise InputError(f"duration must be at least {3.0 / band[0]:g} s, three periods of {band[0]:g} Hz")
    if dt > 0.25 / band[1]:
        raise InputError(f"dt must be at most {0.25 / band[1]:g} s, a quarter period of {band[1]:g} Hz, not {dt:g} s")
    n = int(np.ceil(duration / dt * (1.0 - 1e-12))) + 1
    envelope = _envelope(n)
    numbers = generator(seed)
    best, least = np.zeros(n), np.inf
    for _ in range(_ATTEMPTS):
        start = _start(n, dt, envelope, band, numbers)
        a, misfit = _matched(start, dt, envelope, (f, wanted, check, wanted_there), damping, band, tolerance)
        if misfit < least:
            best, least = a, misfit
        if least <= ACCEPTED:
            break
    if least > ACCEPTED:
        raise InputError(
            f"target: the misfit stays at {least:.0%} for seed {seed}; smooth the target, lengthen the duration "
            f"({duration:g} s) or take another seed"
        )
    told = (
        f"matched to a target spectrum at {damping:.0%} damping within {least:.1%} from {band[0]:g} to {band[1]:g} Hz, "
        f"{duration:g} s, seed {seed}"
    )
    return one_direction(best, dt, direction, f"spectrum-compatible, seed {seed}", told)


def spectrum_compatible_record(
    motion: Motion,
    periods: Sequence[float] | Array,
    target: Sequence[float] | Array,
    *,
    damping: float = 0.05,
    band: tuple[float, float] = BAND,
    tolerance: float = 0.07,
) -> Motion:
    """Return a recorded motion changed until each horizontal spectrum matches a target.

    As `spectrum_compatible`, from the record's own phases and in the record's own envelope instead of noise in a
    general one: it shakes when the record did.  The vertical is the record's, scaled by the one factor that brings the
    record's RotD50 to the target over the band.  What comes of it is no recorded motion, and its name and its steps say
    so.

    Parameters
    ----------
    motion : Motion
        A processed record.
    periods, target : array_like, shape (m,)
        In s, increasing, and in m/s2, as of `spectrum_compatible`.
    damping, band, tolerance : float, (float, float), float
        As of `spectrum_compatible`.

    Returns
    -------
    Motion
        With a relative misfit of at most ACCEPTED at every frequency of the band in x and y.

    Raises
    ------
    InputError
        Naming what is wrong, or when the misfit stays above ACCEPTED.
    """
    grid = _grid(periods, target, damping, band)
    positive(tolerance=tolerance)
    if motion.duration < 3.0 / band[0]:
        raise InputError(f"motion {motion.name!r}: {motion.duration:g} s are shorter than three periods of the band")
    pieces = int(np.ceil(motion.dt * 4.0 * band[1] * (1.0 - 1e-9)))
    fine = motion if pieces <= 1 else resampled(motion, pieces)
    check, wanted = grid[2:]
    found = response_spectra(fine, 1.0 / check, damping, ("rotd50",))["rotd50"].pseudo_acceleration[0]
    if (found == 0.0).any():
        raise InputError(f"motion {motion.name!r} has no horizontal shaking to match")
    factor = float(np.exp(np.mean(np.log(wanted / found))))
    rows, misfits = [], []
    for row in fine.acceleration[:2]:
        if not row.any():
            raise InputError(f"motion {motion.name!r}: a horizontal component is silent, and nothing can be matched")
        envelope = _recorded_envelope(row, fine.dt)
        start = _within(factor * row, envelope)
        a, misfit = _matched(start, fine.dt, envelope, grid, damping, band, tolerance, recorded=True)
        rows.append(a)
        misfits.append(misfit)
    if max(misfits) > ACCEPTED:
        raise InputError(
            f"motion {motion.name!r}: the misfit stays at {max(misfits):.0%}; smooth the target, narrow the band, or "
            f"take another record"
        )
    told = (
        f"not a recorded motion: both horizontals changed to match a target spectrum at {damping:.0%} damping within "
        f"{max(misfits):.1%} from {band[0]:g} to {band[1]:g} Hz; the vertical scaled by {factor:.4g}"
    )
    data = np.vstack([*rows, factor * fine.acceleration[2]])
    source = f"made by Kouros from a record, and no recorded motion; the record: {motion.source}"
    return Motion(fine.dt, data, f"{motion.name}, spectrum-compatible", (*motion.steps, told), source)


def _matched(
    a: Array,
    dt: float,
    envelope: Array,
    grid: tuple[Array, Array, Array, Array],
    damping: float,
    band: tuple[float, float],
    tolerance: float,
    *,
    recorded: bool = False,
) -> tuple[Array, float]:
    """A signal changed until it matches as well as it will, and its largest relative misfit.

    Of a recorded one nothing is left far below the band: its long weak end would carry a little velocity far.  Its own
    envelope leaves less room than a general one, and takes more and smaller steps.
    """
    f, wanted, check, wanted_there = grid
    best, least = a, np.inf
    share, corrections = (_RECORDED_SHARE, _RECORDED_CORRECTIONS) if recorded else (_SHARE, _CORRECTIONS)
    for step in range(_SCALINGS + corrections):
        a = _at_rest(_steady(a, dt, band) if recorded else a, envelope, dt)
        # The dense grid decides; the control frequencies are every second of it.
        response = _response(a, dt, check, damping)
        misfit = float(np.abs(response / wanted_there - 1.0).max())
        if misfit < least:
            best, least = a, misfit
        if least <= tolerance:
            break
        if step < _SCALINGS:
            a = _within(_scaled(a, dt, check, wanted_there / response, band), envelope)
        else:
            a = a + _correction(a, dt, f, wanted, response[::2], damping, envelope, band, share)
    return best, least


def _steady(a: Array, dt: float, band: tuple[float, float]) -> Array:
    """The signal without what is below a quarter of the band's lowest frequency; all of it from half of that on."""
    frequency = np.asarray(np.fft.rfftfreq(a.size, dt), dtype=np.float64)
    kept = np.clip(4.0 * frequency / band[0] - 1.0, 0.0, 1.0)
    return np.asarray(np.fft.irfft(np.fft.rfft(a) * kept, a.size), dtype=np.float64)


def _recorded_envelope(a: Array, dt: float) -> Array:
    """How strongly a record shakes over time: its running root mean square, at most 1, and at rest at both ends."""
    width = max(1, round(_SMOOTHED / dt))
    window = np.hanning(width + 2)[1:-1]
    strength = np.sqrt(np.convolve(a * a, window / window.sum(), mode="same"))
    s = np.linspace(0.0, 1.0, a.size)
    ends = 0.5 - 0.5 * np.cos(np.pi * np.minimum(1.0, np.minimum(s, 1.0 - s) / _ENDS))
    return np.asarray(ends * strength / strength.max(), dtype=np.float64)


def _grid(
    periods: Sequence[float] | Array, target: Sequence[float] | Array, damping: float, band: tuple[float, float]
) -> tuple[Array, Array, Array, Array]:
    """Control frequencies and their target, and the same twice as dense."""
    t, s = np.asarray(periods, dtype=np.float64), np.asarray(target, dtype=np.float64)
    if t.ndim != 1 or t.shape != s.shape or t.size < 2:
        raise InputError(f"periods and target must be two lists of one length, at least 2: {t.shape} and {s.shape}")
    for name, values in (("periods", t), ("target", s)):
        bad = ~np.isfinite(values) | (values <= 0.0)
        if bad.any():
            raise InputError(f"{name}: entry {int(np.argmax(bad))} is {values[bad][0]:g}; it must be a number above 0")
    if (np.diff(t) <= 0.0).any():
        raise InputError(f"periods must increase; entry {int(np.argmax(np.diff(t) <= 0.0)) + 1} does not")
    if not 0.005 <= damping < 1.0:
        raise InputError(f"damping must be from 0.005 to below 1, not {damping!r}")
    low, high = band
    if not 0.0 < low < high:
        raise InputError(f"band must be two frequencies in Hz, the lower one first and above 0, not {band!r}")
    if t[0] > 1.0 / high * (1.0 + 1e-9) or t[-1] < 1.0 / low * (1.0 - 1e-9):
        raise InputError(
            f"periods span {t[0]:g} to {t[-1]:g} s; the band needs {1.0 / high:g} to {1.0 / low:g} s: "
            f"give the target there, or narrow the band"
        )
    # Closer than the oscillator's own bandwidth (2 zeta f), so that nothing hides between two control frequencies.
    spacing = min(0.02, 0.4 * damping)
    count = int(np.ceil(np.log(high / low) / spacing))
    check = np.geomspace(low, high, 2 * count + 1)
    there = np.exp(np.interp(-np.log(check), np.log(t), np.log(s)))
    return check[::2], there[::2], check, there


def _envelope(n: int) -> Array:
    """Rise as a square, level, exponential decay (Jennings, Housner and Tsai 1968), and a cosine to zero at the end."""
    s = np.linspace(0.0, 1.0, n)
    shape = np.where(s < 0.1, (s / 0.1) ** 2, np.where(s < 0.55, 1.0, np.exp(-4.0 * (s - 0.55))))
    return np.asarray(shape * (0.5 - 0.5 * np.cos(np.pi * np.minimum(1.0, (1.0 - s) / 0.1))), dtype=np.float64)


def _start(n: int, dt: float, envelope: Array, band: tuple[float, float], numbers: np.random.Generator) -> Array:
    frequency = np.asarray(np.fft.rfftfreq(n, dt), dtype=np.float64)
    phase = numbers.uniform(0.0, 2.0 * np.pi, frequency.size)
    return np.asarray(envelope * np.fft.irfft(_taper(frequency, band) * np.exp(1j * phase), n), dtype=np.float64)


def _taper(frequency: Array, band: tuple[float, float]) -> Array:
    """Nothing far outside the band: it would move the ground without being asked for."""
    low = np.minimum(1.0, frequency / band[0]) ** 3
    return np.asarray(low * np.clip(2.0 - frequency / band[1], 0.0, 1.0), dtype=np.float64)


def _scaled(a: Array, dt: float, f: Array, ratio: Array, band: tuple[float, float]) -> Array:
    frequency = np.asarray(np.fft.rfftfreq(a.size, dt), dtype=np.float64)
    inside = np.clip(frequency, band[0], band[1])
    factor = np.interp(np.log(inside), np.log(f), ratio) * np.where(_taper(frequency, band) > 0.0, 1.0, 0.0)
    return np.asarray(np.fft.irfft(np.fft.rfft(a) * factor, a.size), dtype=np.float64)


def _within(a: Array, envelope: Array) -> Array:
    """The signal without what scaling has moved to where the envelope ends."""
    return np.asarray(a * np.minimum(1.0, 20.0 * envelope), dtype=np.float64)


def _at_rest(a: Array, envelope: Array, dt: float) -> Array:
    """Add the least weighted correction that leaves neither velocity nor displacement at the end."""
    rest = np.arange(a.size)[::-1] * dt  # what a unit of velocity, given now, adds to the final displacement per second
    rows = dt * np.stack([np.ones(a.size), rest])
    weighted = rows * envelope**2
    # Both ends are zero, so that the trapezoid's sums are these plain ones.
    missing = -(rows @ a)
    return np.asarray(a + weighted.T @ np.linalg.solve(weighted @ rows.T, missing), dtype=np.float64)


def _response(a: Array, dt: float, f: Array, damping: float) -> Array:
    spectrum = response_spectra(one_direction(a, dt, "x", "", ""), 1.0 / f, damping, ("x",))["x"]
    return np.asarray(spectrum.pseudo_acceleration[0], dtype=np.float64)


def _correction(
    a: Array,
    dt: float,
    f: Array,
    wanted: Array,
    response: Array,
    damping: float,
    envelope: Array,
    band: tuple[float, float],
    share: float,
) -> Array:
    """The least weighted change that moves the peak of each oscillator a good part of the way to its target."""
    motion = one_direction(a, dt, "x", "", "")
    rows = np.zeros((f.size, a.size))
    for i, frequency in enumerate(f):
        w = 2.0 * np.pi * frequency
        wd = w * np.sqrt(1.0 - damping * damping)
        u, _ = response_history(motion, 0, 1.0 / float(frequency), damping)
        at = int(np.argmax(np.abs(u)))
        ago = np.arange(at, -1, -1) * dt
        rows[i, : at + 1] = -np.sign(u[at]) * w * w * dt * np.exp(-damping * w * ago) * np.sin(wd * ago) / wd
    # The weight is the envelope in time and the taper in frequency: without the latter the ground would drift.
    shaped = _shaped(rows * (envelope / wanted[:, None]), dt, band)
    missing = share * (1.0 - response / wanted)
    # A little damping of the least squares: neighbours whose peaks coincide cannot be moved apart.
    gram = shaped @ shaped.T
    gram[np.diag_indices_from(gram)] += _SOFTNESS * np.trace(gram) / f.size
    return np.asarray(envelope * _shaped(shaped.T @ np.linalg.solve(gram, missing), dt, band), dtype=np.float64)


def _shaped(rows: Array, dt: float, band: tuple[float, float]) -> Array:
    n = rows.shape[-1]
    frequency = np.asarray(np.fft.rfftfreq(n, dt), dtype=np.float64)
    return np.asarray(np.fft.irfft(np.fft.rfft(rows) * _taper(frequency, band), n), dtype=np.float64)
