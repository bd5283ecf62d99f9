"""Measures of a motion: peaks and significant duration, exact for piecewise-linear acceleration; Arias intensity."""

from __future__ import annotations

from math import pi

import numpy as np
from numpy.polynomial import Polynomial

from pipeline.quantities import Array, G
from pipeline.records import Motion


def integrate(motion: Motion) -> tuple[Array, Array]:
    """Return velocity and displacement at the samples, exact to rounding.

    Parameters
    ----------
    motion : Motion
        Its velocity begins with its own `start`, its displacement with zero.

    Returns
    -------
    array, shape (3, n)
        Velocity in m/s.
    array, shape (3, n)
        Displacement in m.
    """
    a, dt = motion.acceleration, motion.dt
    v = np.zeros_like(a)
    u = np.zeros_like(a)
    v[:, 0] = motion.start
    v[:, 1:] = v[:, :1] + np.cumsum(0.5 * dt * (a[:, :-1] + a[:, 1:]), axis=1)
    u[:, 1:] = np.cumsum(dt * v[:, :-1] + dt * dt * (a[:, :-1] / 3.0 + a[:, 1:] / 6.0), axis=1)
    return v, u


def measures(motion: Motion) -> dict[str, float]:
    """Return the intensity measures of a motion over its samples' span.

    Parameters
    ----------
    motion : Motion
        What is measured.

    Returns
    -------
    dict of str to float
        In SI.  pga_x, pga_y, pga_z, pga (larger horizontal component), pga_resultant (peak of the horizontal vector)
        [m/s2]; pgv and pgd likewise [m/s, m]; arias_x, arias_y, arias_z [m/s]; duration_5_95 [s], of the horizontal
        components together.

    Notes
    -----
    Maxima are over continuous time: a velocity peaks where the acceleration changes sign, between samples.

    Error: none but rounding, about 1e-12 relative; the polygon through the samples is the motion that objects are
    shaken by.  Arias intensity alone is the trapezoidal sum of squares that agencies print: exact for a record that was
    sampled often enough for its frequencies, where the polygon, which cuts peaks off, holds less (of one near-fault
    record at 100 samples/s by 7 to 17 %, at the Nyquist frequency two thirds).

    References
    ----------
    Arias, A. (1970), pi/(2g) int a^2 dt.
    Trifunac, M. D. and Brady, A. G. (1975), for the significant duration.
    """
    a, dt = motion.acceleration, motion.dt
    v, u = integrate(motion)
    a0, da = a[:, :-1], np.diff(a, axis=1)
    v0, u0 = v[:, :-1], u[:, :-1]
    # Each interval as a polynomial in s = (t - t_k) / dt, lowest power first.
    histories = {
        "pga": (a, np.stack([a0, da])),
        "pgv": (v, np.stack([v0, dt * a0, 0.5 * dt * da])),
        "pgd": (u, np.stack([u0, dt * v0, 0.5 * dt * dt * a0, dt * dt / 6.0 * da])),
    }
    # How far a history can leave the chord between two samples: an eighth of its largest second derivative.
    size = np.abs(a)
    bend = {
        "pga": np.zeros_like(a0),
        "pgv": 0.125 * dt * np.abs(da),
        "pgd": 0.125 * dt * dt * np.maximum(size[:, :-1], size[:, 1:]),
    }
    out: dict[str, float] = {}
    for name, (nodes, pieces) in histories.items():
        for row, axis in enumerate("xyz"):
            rows = slice(row, row + 1)
            out[f"{name}_{axis}"] = _peak(nodes[rows], pieces[:, rows], bend[name][rows])
        out[name] = max(out[f"{name}_x"], out[f"{name}_y"])
        out[f"{name}_resultant"] = _peak(nodes[:2], pieces[:, :2], bend[name][:2])
    for axis, row in zip("xyz", a, strict=True):
        out[f"arias_{axis}"] = pi / (2.0 * G) * float(np.trapezoid(row * row, dx=dt))
    first, last = strong_part(motion)
    out["duration_5_95"] = last - first
    return out


def strong_part(motion: Motion, low: float = 0.05, high: float = 0.95) -> tuple[float, float]:
    """Return when the horizontal components have delivered two shares of their Arias intensity.

    Parameters
    ----------
    motion : Motion
        What is looked at.
    low, high : float
        The shares, from 0 to 1.

    Returns
    -------
    (float, float)
        In s from the first sample; (0, 0) for a motion without horizontal shaking.

    Notes
    -----
    Error: none but rounding.
    """
    pieces = _energy(motion)[:2].sum(axis=0)
    total = np.concatenate([[0.0], np.cumsum(pieces)])
    if total[-1] == 0.0:
        return 0.0, 0.0
    first, last = (_reached(motion, total, share * float(total[-1])) for share in (low, high))
    return first, last


def _reached(motion: Motion, total: Array, target: float) -> float:
    from scipy.optimize import brentq

    k = min(int(np.searchsorted(total, target, side="left")), len(total) - 1) - 1
    if k < 0:
        return 0.0
    a0 = motion.acceleration[:2, k]
    da = motion.acceleration[:2, k + 1] - a0
    c1, c2, c3 = float(a0 @ a0), float(a0 @ da), float(da @ da) / 3.0

    def missing(s: float) -> float:
        return float(total[k]) + motion.dt * s * (c1 + s * (c2 + s * c3)) - target

    # Rounding may put the target on either side of the interval's end.
    if missing(1.0) <= 0.0:
        return (k + 1) * motion.dt
    return (k + float(brentq(missing, 0.0, 1.0, xtol=1e-14))) * motion.dt


def _energy(motion: Motion) -> Array:
    """The integral of the squared acceleration over each interval, (3, n - 1) m2/s3."""
    a0, a1 = motion.acceleration[:, :-1], motion.acceleration[:, 1:]
    return motion.dt / 3.0 * (a0 * a0 + a0 * a1 + a1 * a1)


def _peak(nodes: Array, pieces: Array, bend: Array) -> float:
    """The largest length of a vector history over continuous time.

    nodes  : (rows, n), the history at the samples
    pieces : (order + 1, rows, n - 1), its polynomial on each interval, lowest power first
    bend   : (rows, n - 1), how far each row can leave its chord
    """
    length = np.sqrt((nodes * nodes).sum(axis=0))
    best = float(length.max())
    bound = np.maximum(length[:-1], length[1:]) + np.sqrt((bend * bend).sum(axis=0))
    # Only the few intervals that could hold more than what is known are looked into, the most promising first.
    could = np.flatnonzero(bound > best)
    for k in could[np.argsort(-bound[could])].tolist():
        if bound[k] <= best:
            break
        square = Polynomial([0.0])
        for row in range(nodes.shape[0]):
            square += Polynomial(pieces[:, row, k]) ** 2
        slope = square.deriv()
        # A leading coefficient that is only rounding would send a root to infinity and change nothing in [0, 1].
        roots = np.asarray(slope.trim(1e-14 * float(np.abs(slope.coef).max())).roots(), dtype=np.complex128).tolist()
        inside = [r.real for r in roots if abs(r.imag) <= 1e-9 and 0.0 < r.real < 1.0]
        squares = [float(square(s)) for s in inside]
        best = max([best, *(float(np.sqrt(max(0.0, one))) for one in squares)])
    return best
