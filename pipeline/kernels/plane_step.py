"""One embedded Runge-Kutta step (Dormand and Prince 1980) of a body slipping in two directions."""

import math

from pipeline.kernels import kernel
from pipeline.quantities import Array


@kernel
def plane_rates(
    ux: float, uy: float, vx: float, vy: float, ax: float, ay: float, grip: float, b: float, c: float
) -> tuple[float, float, float]:
    """Return the acceleration relative to the base (x, y) and the speed, in m/s2 and m/s.

    grip: mu_k N [m/s2];  b = w^2, c = 2 zeta w
    """
    speed = math.hypot(vx, vy)
    drag = c + (grip / speed if speed > 0.0 else 0.0)
    return -ax - drag * vx - b * ux, -ay - drag * vy - b * uy, speed


@kernel
def plane_step(state: Array, load: Array, t: float, h: float, b: float, c: float, after: Array) -> float:
    """Take one step of (ux, uy, vx, vy, path) from t to t + h into ``after``; return the velocity's error [m/s].

    load : ax0, ax1, ay0, ay1, grip0, grip1: excitation and grip are linear in t
    The error of the displacement is smaller by the step.
    """
    ux, uy, vx, vy, path = state[0], state[1], state[2], state[3], state[4]

    s = t
    kx1, ky1, p1 = plane_rates(
        ux, uy, vx, vy, load[0] + load[1] * s, load[2] + load[3] * s, load[4] + load[5] * s, b, c
    )
    s = t + h / 5.0
    x2, y2 = vx + h * kx1 / 5.0, vy + h * ky1 / 5.0
    kx2, ky2, _p2 = plane_rates(
        ux + h * vx / 5.0,
        uy + h * vy / 5.0,
        x2,
        y2,
        load[0] + load[1] * s,
        load[2] + load[3] * s,
        load[4] + load[5] * s,
        b,
        c,
    )
    s = t + 0.3 * h
    x3 = vx + h * (3.0 / 40.0 * kx1 + 9.0 / 40.0 * kx2)
    y3 = vy + h * (3.0 / 40.0 * ky1 + 9.0 / 40.0 * ky2)
    kx3, ky3, p3 = plane_rates(
        ux + h * (3.0 / 40.0 * vx + 9.0 / 40.0 * x2),
        uy + h * (3.0 / 40.0 * vy + 9.0 / 40.0 * y2),
        x3,
        y3,
        load[0] + load[1] * s,
        load[2] + load[3] * s,
        load[4] + load[5] * s,
        b,
        c,
    )
    s = t + 0.8 * h
    x4 = vx + h * (44.0 / 45.0 * kx1 - 56.0 / 15.0 * kx2 + 32.0 / 9.0 * kx3)
    y4 = vy + h * (44.0 / 45.0 * ky1 - 56.0 / 15.0 * ky2 + 32.0 / 9.0 * ky3)
    kx4, ky4, p4 = plane_rates(
        ux + h * (44.0 / 45.0 * vx - 56.0 / 15.0 * x2 + 32.0 / 9.0 * x3),
        uy + h * (44.0 / 45.0 * vy - 56.0 / 15.0 * y2 + 32.0 / 9.0 * y3),
        x4,
        y4,
        load[0] + load[1] * s,
        load[2] + load[3] * s,
        load[4] + load[5] * s,
        b,
        c,
    )
    s = t + 8.0 / 9.0 * h
    x5 = vx + h * (19372.0 / 6561.0 * kx1 - 25360.0 / 2187.0 * kx2 + 64448.0 / 6561.0 * kx3 - 212.0 / 729.0 * kx4)
    y5 = vy + h * (19372.0 / 6561.0 * ky1 - 25360.0 / 2187.0 * ky2 + 64448.0 / 6561.0 * ky3 - 212.0 / 729.0 * ky4)
    kx5, ky5, p5 = plane_rates(
        ux + h * (19372.0 / 6561.0 * vx - 25360.0 / 2187.0 * x2 + 64448.0 / 6561.0 * x3 - 212.0 / 729.0 * x4),
        uy + h * (19372.0 / 6561.0 * vy - 25360.0 / 2187.0 * y2 + 64448.0 / 6561.0 * y3 - 212.0 / 729.0 * y4),
        x5,
        y5,
        load[0] + load[1] * s,
        load[2] + load[3] * s,
        load[4] + load[5] * s,
        b,
        c,
    )
    s = t + h
    x6 = vx + h * (
        9017.0 / 3168.0 * kx1
        - 355.0 / 33.0 * kx2
        + 46732.0 / 5247.0 * kx3
        + 49.0 / 176.0 * kx4
        - 5103.0 / 18656.0 * kx5
    )
    y6 = vy + h * (
        9017.0 / 3168.0 * ky1
        - 355.0 / 33.0 * ky2
        + 46732.0 / 5247.0 * ky3
        + 49.0 / 176.0 * ky4
        - 5103.0 / 18656.0 * ky5
    )
    kx6, ky6, p6 = plane_rates(
        ux
        + h
        * (
            9017.0 / 3168.0 * vx - 355.0 / 33.0 * x2 + 46732.0 / 5247.0 * x3 + 49.0 / 176.0 * x4 - 5103.0 / 18656.0 * x5
        ),
        uy
        + h
        * (
            9017.0 / 3168.0 * vy - 355.0 / 33.0 * y2 + 46732.0 / 5247.0 * y3 + 49.0 / 176.0 * y4 - 5103.0 / 18656.0 * y5
        ),
        x6,
        y6,
        load[0] + load[1] * s,
        load[2] + load[3] * s,
        load[4] + load[5] * s,
        b,
        c,
    )
    b1, b3, b4, b5, b6 = 35.0 / 384.0, 500.0 / 1113.0, 125.0 / 192.0, -2187.0 / 6784.0, 11.0 / 84.0
    x7 = vx + h * (b1 * kx1 + b3 * kx3 + b4 * kx4 + b5 * kx5 + b6 * kx6)
    y7 = vy + h * (b1 * ky1 + b3 * ky3 + b4 * ky4 + b5 * ky5 + b6 * ky6)
    ux7 = ux + h * (b1 * vx + b3 * x3 + b4 * x4 + b5 * x5 + b6 * x6)
    uy7 = uy + h * (b1 * vy + b3 * y3 + b4 * y4 + b5 * y5 + b6 * y6)
    kx7, ky7, _p7 = plane_rates(
        ux7, uy7, x7, y7, load[0] + load[1] * s, load[2] + load[3] * s, load[4] + load[5] * s, b, c
    )
    after[0], after[1], after[2], after[3] = ux7, uy7, x7, y7
    after[4] = path + h * (b1 * p1 + b3 * p3 + b4 * p4 + b5 * p5 + b6 * p6)
    e1, e3, e4 = 71.0 / 57600.0, -71.0 / 16695.0, 71.0 / 1920.0
    e5, e6, e7 = -17253.0 / 339200.0, 22.0 / 525.0, -1.0 / 40.0
    ex = e1 * kx1 + e3 * kx3 + e4 * kx4 + e5 * kx5 + e6 * kx6 + e7 * kx7
    ey = e1 * ky1 + e3 * ky3 + e4 * ky4 + e5 * ky5 + e6 * ky6 + e7 * ky7
    return h * math.hypot(ex, ey)


@kernel
def felt(state: Array, grip: float, b: float, c: float) -> float:
    """Return the absolute acceleration of a slipping body [m/s2]: what spring, dashpot and friction push it with."""
    vx, vy = state[2], state[3]
    speed = math.hypot(vx, vy)
    drag = c + (grip / speed if speed > 0.0 else 0.0)
    return math.hypot(drag * vx + b * state[0], drag * vy + b * state[1])


@kernel
def felt_rate(state: Array, ax: float, ay: float, grip: float, grip1: float, b: float, c: float) -> float:
    """Return half the rate of the squared absolute acceleration [m2/s5]."""
    ux, uy, vx, vy = state[0], state[1], state[2], state[3]
    speed = math.hypot(vx, vy)
    if speed == 0.0:
        return 0.0
    qx, qy, _ = plane_rates(ux, uy, vx, vy, ax, ay, grip, b, c)
    ex, ey = vx / speed, vy / speed
    along = ex * qx + ey * qy
    yx, yy = c * vx + b * ux + grip * ex, c * vy + b * uy + grip * ey
    rx = c * qx + b * vx + grip1 * ex + grip * (qx - ex * along) / speed
    ry = c * qy + b * vy + grip1 * ey + grip * (qy - ey * along) / speed
    return yx * rx + yy * ry


@kernel
def raise_peaks(
    state: Array, after: Array, trial: Array, load: Array, t: float, h: float, b: float, c: float, out: Array
) -> None:
    """Raise the running maxima of ``out`` by what happened inside an accepted step.

    The step is taken again to the instant at which the radius (or the felt acceleration) is stationary.
    """
    r0, r1 = math.hypot(state[0], state[1]), math.hypot(after[0], after[1])
    out[0] = max(out[0], r1)
    begin = state[0] * state[2] + state[1] * state[3]
    end = after[0] * after[2] + after[1] * after[3]
    if begin > 0.0 > end and max(r0, r1) + h * math.hypot(state[2], state[3]) > out[0]:
        low, high, at_low, at_high = 0.0, h, begin, end
        for k in range(24):
            tau = (low * at_high - high * at_low) / (at_high - at_low) if k % 3 < 2 else 0.5 * (low + high)
            plane_step(state, load, t, tau, b, c, trial)
            value = trial[0] * trial[2] + trial[1] * trial[3]
            if value > 0.0:
                low, at_low = tau, value
            else:
                high, at_high = tau, value
            if value == 0.0 or high - low < 1e-11 * h:
                break
        out[0] = max(out[0], math.hypot(trial[0], trial[1]))
    g0, g1 = load[4] + load[5] * t, load[4] + load[5] * (t + h)
    y0, y1 = felt(state, g0, b, c), felt(after, g1, b, c)
    out[2] = max(out[2], y0, y1)
    if b > 0.0 and 1.1 * max(y0, y1) > out[2]:
        begin = felt_rate(state, load[0] + load[1] * t, load[2] + load[3] * t, g0, load[5], b, c)
        s = t + h
        end = felt_rate(after, load[0] + load[1] * s, load[2] + load[3] * s, g1, load[5], b, c)
        if begin > 0.0 > end:
            low, high, at_low, at_high = 0.0, h, begin, end
            for k in range(24):
                tau = (low * at_high - high * at_low) / (at_high - at_low) if k % 3 < 2 else 0.5 * (low + high)
                plane_step(state, load, t, tau, b, c, trial)
                s = t + tau
                value = felt_rate(
                    trial, load[0] + load[1] * s, load[2] + load[3] * s, load[4] + load[5] * s, load[5], b, c
                )
                if value > 0.0:
                    low, at_low = tau, value
                else:
                    high, at_high = tau, value
                if value == 0.0 or high - low < 1e-11 * h:
                    break
            out[2] = max(out[2], felt(trial, load[4] + load[5] * (t + tau), b, c))


@kernel
def slowest(
    state: Array, trial: Array, load: Array, t: float, h: float, b: float, c: float, begin: float, end: float
) -> float:
    """Return the step length at which the speed is least (its rate changes sign); trial receives the state there."""
    low, high, at_low, at_high = 0.0, h, begin, end
    tau = h
    for k in range(40):
        tau = (low * at_high - high * at_low) / (at_high - at_low) if k % 3 < 2 else 0.5 * (low + high)
        plane_step(state, load, t, tau, b, c, trial)
        s = t + tau
        rx, ry, _s = plane_rates(
            trial[0],
            trial[1],
            trial[2],
            trial[3],
            load[0] + load[1] * s,
            load[2] + load[3] * s,
            load[4] + load[5] * s,
            b,
            c,
        )
        value = rx * trial[2] + ry * trial[3]
        if value < 0.0:
            low, at_low = tau, value
        else:
            high, at_high = tau, value
        if value == 0.0 or high - low < 1e-15 * h:
            break
    return tau
