"""Independent exact solutions for a base acceleration that is a polygon: oscillator and one-directional sliding."""

import numpy as np
from scipy.linalg import expm
from scipy.signal import lfilter

from pipeline.quantities import Array, G


def oscillator_peak(base: Array, dt: float, w: float, zeta: float) -> float:
    """Return max |u| [m] of an underdamped oscillator under a polygon of samples, zeta < 1.

    Independent of the kernels: z = u' + (zeta w + i w_d) u obeys z' = s z - a with s = -zeta w + i w_d, whose step is
    the exponential of a 3 x 3 matrix.  Peaks are looked for on a grid of at most 0.1 rad and a tenth of dt, and
    polished by Newton's iteration.
    """
    wd = w * np.sqrt(1.0 - zeta**2)
    s = -zeta * w + 1j * wd
    f0, f1 = -base[:-1], -np.diff(base) / dt

    def step(t: float) -> tuple[complex, complex, complex]:
        e = expm(t * np.array([[s, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, 0.0, 0.0]]))
        return e[0, 0], e[0, 1], e[0, 2]

    by_state, by_force, by_ramp = step(dt)
    z = np.zeros(base.size, dtype=complex)
    z[1:] = lfilter([1.0], [1.0, -by_state], f0 * by_force + f1 * by_ramp)
    pieces = int(np.ceil(max(w * dt, 1.0) / 0.1))
    times = np.arange(pieces) * (dt / pieces)
    grid = np.empty((pieces, base.size - 1), dtype=complex)
    for row, t in zip(grid, times, strict=True):
        by_state, by_force, by_ramp = step(t)
        row[:] = z[:-1] * by_state + f0 * by_force + f1 * by_ramp
    u = np.abs(grid.imag) / wd
    # Between two points of the grid a peak exceeds them by about 0.1^2 / 8 of itself, so 1 % finds every candidate.
    part, interval = np.nonzero(u >= 0.99 * u.max())
    h = dt / pieces
    start = times[part]
    t = start
    for _ in range(6):
        e = np.exp(s * t)
        now = z[interval] * e + f0[interval] * (e - 1.0) / s + f1[interval] * (e - 1.0 - s * t) / s**2
        at = now.imag / wd
        v = now.real - zeta * w * at
        bend = f0[interval] + f1[interval] * t - 2.0 * zeta * w * v - w**2 * at
        t = t - np.divide(v, bend, out=np.zeros_like(v), where=bend != 0.0)
        t = np.clip(t, np.maximum(0.0, start - h), start + h)
    return float(max(u.max(), np.abs(at).max()))


def sliding_peak(base: Array, dt: float, mu: float) -> float:
    """Return max |u| [m] of a body on dry friction without vertical motion, u'' = -a - mu g sign(u').

    Within a sample interval the velocity is a quadratic and the displacement a cubic: the instant at which the body
    stops is a root of the former, from numpy's polynomials.
    """
    hold = mu * G
    u = v = largest = 0.0
    for i in range(base.size - 1):
        rate, now = (base[i + 1] - base[i]) / dt, 0.0
        while now < dt:
            a = base[i] + rate * now
            side = np.sign(v)
            if side == 0.0:
                if abs(a) <= hold * (1.0 - 1e-13):
                    if abs(base[i + 1]) <= hold:
                        break
                    now = (np.copysign(hold, base[i + 1]) - base[i]) / rate
                    a = base[i] + rate * now
                side = -np.sign(a)
            velocity = np.polynomial.Polynomial([v, -a - side * hold, -0.5 * rate])
            stops = [float(t.real) for t in velocity.roots() if abs(t.imag) < 1e-12 and 1e-12 < t.real <= dt - now]
            span = min(stops, default=dt - now)
            u += velocity.integ()(span)
            v = 0.0 if stops else float(velocity(span))
            largest = max(largest, abs(u))
            now += span
    return largest
