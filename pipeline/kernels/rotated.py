"""Peaks of a plane history in every direction: what RotD50 and RotD100 are read from."""

import math

import numpy as np

from pipeline.kernels import kernel
from pipeline.quantities import Array


@kernel
def rotated_peaks(u: Array, bend: Array, steps: Array, normals: Array, parts: int, peaks: Array) -> float:
    r"""Raise the peaks of each direction by a history that is a cubic between its nodes, and return the peak of all.

    .. math::

        \max_t |u(t) \cdot n_k|

    The cubic with the right second derivatives at both ends is off by 5/384 (w h)^4 of an oscillation at w [rad/s].

    Parameters
    ----------
    u, bend : ndarray, shape (2, n)
        The history at its nodes and its second derivative there, in u's unit and that per s2.
    steps : ndarray, shape (n - 1,)
        Time between nodes, s.
    normals : ndarray, shape (2, m)
        Unit vectors.
    parts : int
        Points at which an interval that may hold a peak is looked at.
    peaks : ndarray, shape (m,)
        Receives, and may hold, peaks that are known already.

    Returns
    -------
    float
        The peak ``|u|``, in u's unit.

    References
    ----------
    Boore, D. M. (2010). Orientation-independent, nongeometric-mean measures of seismic intensity from two horizontal
    components of motion. Bulletin of the Seismological Society of America 100: RotD50 and RotD100.
    """
    n, m = u.shape[1], normals.shape[1]
    far = 0.0
    for i in range(n):
        far = max(far, u[0, i] * u[0, i] + u[1, i] * u[1, i])
    far = math.sqrt(far)
    least = peaks.min()
    for i in range(n - 1):
        x0, y0, x1, y1 = u[0, i], u[1, i], u[0, i + 1], u[1, i + 1]
        h = steps[i]
        # The cubic leaves its chord by at most an eighth of the larger second derivative times the step squared.
        size = max(math.sqrt(x0 * x0 + y0 * y0), math.sqrt(x1 * x1 + y1 * y1))
        curl = max(
            math.sqrt(bend[0, i] * bend[0, i] + bend[1, i] * bend[1, i]),
            math.sqrt(bend[0, i + 1] * bend[0, i + 1] + bend[1, i + 1] * bend[1, i + 1]),
        )
        if size + 0.125 * h * h * curl <= least:
            continue
        # Least may be next to nothing where the history hardly leaves a line: then each direction is asked by itself.
        hopeful = False
        for k in range(m):
            nx, ny = normals[0, k], normals[1, k]
            chord = max(abs(x0 * nx + y0 * ny), abs(x1 * nx + y1 * ny))
            b0, b1 = abs(bend[0, i] * nx + bend[1, i] * ny), abs(bend[0, i + 1] * nx + bend[1, i + 1] * ny)
            hopeful |= chord + 0.125 * h * h * max(b0, b1) > peaks[k]
        if not hopeful and size + 0.125 * h * h * curl <= far:
            continue
        scale = h * h / 6.0
        for j in range(parts + 1):
            s = j / parts
            r = 1.0 - s
            low, high = scale * (r * r * r - r), scale * (s * s * s - s)
            x = r * x0 + s * x1 + low * bend[0, i] + high * bend[0, i + 1]
            y = r * y0 + s * y1 + low * bend[1, i] + high * bend[1, i + 1]
            radius = math.sqrt(x * x + y * y)
            far = max(far, radius)
            if radius > least:
                for k in range(m):
                    peaks[k] = max(peaks[k], abs(x * normals[0, k] + y * normals[1, k]))
        least = peaks.min()
    return far


@kernel
def first_guess(u: Array, normals: Array, peaks: Array) -> None:
    """Fill in the peaks of each direction with those of the farthest node of each sector: never above the truth.

    Parameters
    ----------
    u : ndarray, shape (2, n)
        The history at its nodes.
    normals : ndarray, shape (2, m)
        Unit vectors at equal angles over half a turn, the first along x.
    peaks : ndarray, shape (m,)
        Receives them, in u's unit.
    """
    m = normals.shape[1]
    best, where = np.zeros(m), np.full(m, -1)
    most = 0.0
    for i in range(u.shape[1]):
        most = max(most, u[0, i] * u[0, i] + u[1, i] * u[1, i])
    for i in range(u.shape[1]):
        square = u[0, i] * u[0, i] + u[1, i] * u[1, i]
        # The near ones would cost their angle and raise no guess.
        if square < 0.04 * most:
            continue
        sector = int(math.atan2(u[1, i], u[0, i]) / math.pi * m) % m
        if square > best[sector]:
            best[sector], where[sector] = square, i
    peaks[:] = 0.0
    for sector in range(m):
        if where[sector] >= 0:
            x, y = u[0, where[sector]], u[1, where[sector]]
            for k in range(m):
                peaks[k] = max(peaks[k], abs(x * normals[0, k] + y * normals[1, k]))
