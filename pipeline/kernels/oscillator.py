"""Linear oscillators on a shaking base: exact recursion for piecewise-linear input, peaks found between the samples."""

import math

import numpy as np

from pipeline.kernels import kernel
from pipeline.kernels.linear import peak_inside, transition
from pipeline.quantities import Array


@kernel
def oscillator_one(
    base: Array, dt: float, w: float, zeta: float, share: float, tail: float, refine: int, history: Array
) -> tuple[float, float, float]:
    """Integrate u'' + 2 zeta w u' + w^2 u = -a and return (max |u|, max |y|, last time [s]).

    y = a + share u'', share = 1: the absolute acceleration of the mass; another share is a lever ratio.
    base    : (n,) m/s2, excitation between the first and the last sample, none outside
    tail    : s to go on after the record, or -1: until past the peaks
    history : (m, 2) receives u and y at the samples, as long as it is (it may be empty)
    """
    n = base.shape[0]
    if n < 2:
        return 0.0, 0.0, 0.0
    pieces = max(1, math.ceil(w * dt * (1.0 + zeta) / 0.9)) * refine
    step = dt / pieces
    g, h, h1, h2 = transition(w, zeta, step)
    b, c = w * w, 2.0 * zeta * w
    u, v = 0.0, 0.0
    max_u, max_y = 0.0, abs(base[0] * (1.0 - share))
    if history.shape[0] > 0:
        history[0, 0], history[0, 1] = 0.0, base[0] * (1.0 - share)
    for i in range(n - 1):
        rate = (base[i + 1] - base[i]) / dt
        for j in range(pieces):
            a = base[i] + rate * (j * step)
            f0, f1 = -a, -rate
            un = u * g + v * h + f0 * h1 + f1 * h2
            vn = -u * b * h + v * (g - c * h) + f0 * h + f1 * h1
            y = a * (1.0 - share) - share * (c * v + b * u)
            yn = (a + rate * step) * (1.0 - share) - share * (c * vn + b * un)
            # A peak between the ends can exceed them by at most the steeper end slope times the step.
            if max(abs(u), abs(un)) + step * max(abs(v), abs(vn)) > max_u:
                max_u = max(max_u, abs(un), peak_inside(u, v, f0, f1, w, zeta, step, 0.0, 0.0, 1.0, 0.0))
            lift = abs(rate * (1.0 - share)) + abs(share) * (
                c * max(abs(f0 - c * v - b * u), abs(f0 + f1 * step - c * vn - b * un)) + b * max(abs(v), abs(vn))
            )
            if max(abs(y), abs(yn)) + step * lift > max_y:
                inner = peak_inside(
                    u, v, f0, f1, w, zeta, step, a * (1.0 - share), rate * (1.0 - share), -share * b, -share * c
                )
                max_y = max(max_y, abs(yn), inner)
            u, v = un, vn
        if i + 1 < history.shape[0]:
            history[i + 1, 0] = u
            history[i + 1, 1] = base[i + 1] * (1.0 - share) - share * (c * v + b * u)
    for k in range(n, history.shape[0]):
        for _ in range(pieces):
            u, v = u * g + v * h, -u * b * h + v * (g - c * h)
        history[k, 0] = u
        history[k, 1] = -share * (c * v + b * u)
    # The excitation drops to zero at the last sample: a jump, felt when share is not 1.
    max_y = max(max_y, abs(share * (c * v + b * u)))
    # Free decay: u and y obey the same equation, so their largest extremes come within the first period; an
    # overdamped system has at most one extreme, however late.
    limit = tail if tail >= 0.0 else 1e300
    if zeta < 1.0:
        stop = 2.0 * math.pi / (w * math.sqrt((1.0 - zeta) * (1.0 + zeta)))
        stop = min(stop, 60.0 / (w * max(zeta, 1e-300)))
    else:
        stop = 60.0 * (1.0 + zeta) / w
    stop = min(stop, limit)
    t, span = 0.0, 0.5 / (w * (1.0 + zeta))
    while t < stop:
        span_now = min(span, stop - t)
        max_u = max(max_u, peak_inside(u, v, 0.0, 0.0, w, zeta, span_now, 0.0, 0.0, 1.0, 0.0))
        max_y = max(max_y, peak_inside(u, v, 0.0, 0.0, w, zeta, span_now, 0.0, 0.0, share * b, share * c))
        ge, he, _, _ = transition(w, zeta, span_now)
        u, v = u * ge + v * he, -u * b * he + v * (ge - c * he)
        max_u = max(max_u, abs(u))
        max_y = max(max_y, abs(share * (c * v + b * u)))
        t += span_now
        if zeta >= 1.0:
            span *= 1.5
    return max_u, max_y, (n - 1) * dt + t


@kernel
def oscillator_batch(
    base: Array, dt: float, w: Array, zeta: Array, share: Array, tail: float, refine: int, max_u: Array, max_y: Array
) -> None:
    """Fill max_u (m,) m and max_y (m,) m/s2 for m oscillators under one base motion."""
    nothing = np.empty((0, 2))
    for k in range(w.shape[0]):
        max_u[k], max_y[k], _ = oscillator_one(base, dt, w[k], zeta[k], share[k], tail, refine, nothing)
