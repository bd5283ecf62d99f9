"""Zero-phase filters with pads, and the straight baseline that goes before them; arrays in, arrays out."""

from __future__ import annotations

from typing import Literal

import numpy as np

from pipeline.errors import InputError
from pipeline.quantities import Array

POLES = 2
"""Poles of the Butterworth filters; run forwards and backwards they fall off as four."""


def remove_baseline(data: Array, dt: float) -> tuple[Array, str]:
    """Subtract from each row its least-squares straight line (mean and drift), and say which.

    Parameters
    ----------
    data : array, shape (3, n)
        In m/s2.
    dt : float
        Time step in s.

    Returns
    -------
    array, shape (3, n)
        In m/s2, without the lines.
    str
        The step, with mean in m/s2 and slope in m/s3 of each row.
    """
    n = data.shape[1]
    # Time about the middle: the mean and the slope are then independent of each other.
    t = (np.arange(n) - 0.5 * (n - 1)) * dt
    mean = data.mean(axis=1)
    slope = (data @ t) / float(t @ t)
    line = mean[:, None] + slope[:, None] * t
    told = ", ".join(f"{axis} {m:.3g} m/s2 and {s:.3g} m/s3" for axis, m, s in zip("xyz", mean, slope, strict=True))
    return data - line, f"linear baseline removed (mean and drift): {told}"


def pad_seconds(corner_hz: float) -> float:
    """Return the zeros that a record needs before and after it for its high-pass: 1.5 n / fc.

    Parameters
    ----------
    corner_hz : float
        The corner fc in Hz.

    Returns
    -------
    float
        Seconds of zeros at each end.  n is the order, here the four of both passes together, and the whole length goes
        to each end.

    References
    ----------
    Boore, D. M. (2005), On pads and filters: processing strong-motion data, BSSA 95, 745-750.
    """
    return 1.5 * (2 * POLES) / corner_hz


def highpass(data: Array, dt: float, corner_hz: float) -> tuple[Array, str, Array]:
    """Zero-phase Butterworth high-pass of each row, padded with zeros and cut back to the record.

    Parameters
    ----------
    data : array, shape (rows, n)
        In m/s2.
    dt : float
        Time step in s.
    corner_hz : float
        In Hz.

    Returns
    -------
    array, shape (rows, n)
        In m/s2.
    str
        The step.
    array, shape (rows,)
        Velocity in m/s at the first sample.  A zero-phase filter answers before the record begins: cut off without that
        velocity, the displacement would drift from there on.

    Raises
    ------
    InputError
        Unless the corner is below the Nyquist frequency.

    References
    ----------
    Boore, D. M. (2005), as of `pad_seconds`.
    """
    out, pad, step = _filtered(data, dt, corner_hz, "highpass")
    lead = out[:, : pad + 1]
    start = dt * (lead.sum(axis=1) - 0.5 * (lead[:, 0] + lead[:, -1]))
    return np.ascontiguousarray(out[:, pad : pad + data.shape[1]]), step, start


def lowpass(data: Array, dt: float, corner_hz: float) -> tuple[Array, str]:
    """Zero-phase Butterworth low-pass of each row, padded with zeros and cut back to the record.

    Parameters
    ----------
    data : array, shape (rows, n)
        In m/s2.
    dt : float
        Time step in s.
    corner_hz : float
        In Hz.

    Returns
    -------
    array, shape (rows, n)
        In m/s2.
    str
        The step.

    Raises
    ------
    InputError
        Unless the corner is below the Nyquist frequency.
    """
    out, pad, step = _filtered(data, dt, corner_hz, "lowpass")
    return np.ascontiguousarray(out[:, pad : pad + data.shape[1]]), step


def _filtered(data: Array, dt: float, corner_hz: float, kind: Literal["highpass", "lowpass"]) -> tuple[Array, int, str]:
    from scipy.signal import butter, sosfiltfilt

    if not 0.0 < corner_hz < 0.5 / dt:
        raise InputError(f"{kind}_hz {corner_hz:g} must be below the Nyquist frequency of {0.5 / dt:g} Hz")
    sos = butter(POLES, corner_hz, kind, fs=1.0 / dt, output="sos")
    pad = int(np.ceil(pad_seconds(corner_hz) / dt))
    padded = np.pad(data, ((0, 0), (pad, pad)))
    out = np.asarray(sosfiltfilt(sos, padded, axis=1, padtype=None), dtype=np.float64)
    how = f"Butterworth of {POLES} poles forwards and backwards, padded by {pad * dt:g} s of zeros at each end"
    return out, pad, f"{kind.replace('pass', '-pass')} {corner_hz:g} Hz, {how}"
