"""One-way sliding beside pySLAMMER; swing, rocking and sliding beside scipy's general integrators."""

from collections.abc import Callable
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

from pipeline.quantities import Array, G
from pipeline.records import Excitation
from tests.benchmarks.common import Comparison, Ours, clocked, fastest, level, strong, strongest
from tests.benchmarks.peers import peer
from tests.benchmarks.truth import sliding_peak

REGULAR = 1e-4
"""Speed [m/s] below which friction is smoothed for an integrator that knows no events."""

Settings = dict[str, Any]


def one_way() -> list[Comparison]:
    """Compare one-way sliding: the record's lower half is cut where friction holds, so that nothing slides back."""
    pyslammer = peer("pyslammer")
    if pyslammer is None:
        return []
    mu = np.array([0.1, 0.12, 0.15, 0.18, 0.2, 0.25])
    x = np.maximum(strongest(), -0.99 * mu[0] * G)
    motion = level(x)
    ground = pyslammer.GroundMotion(x / G, motion.dt)

    def slide(m: float) -> float:
        return float(pyslammer.RigidAnalysis(m, ground).max_sliding_disp)

    runs = [(slide(m), fastest(lambda m=m: slide(m), 3)) for m in mu.tolist()]
    ours = Ours("sliding", motion, friction_static=mu, directions=1.0)
    truth = np.array([sliding_peak(x, motion.dt, m) for m in mu])
    return [ours.beside("sliding one way", f"pySLAMMER {pyslammer.__version__} RigidAnalysis", runs, 300.0, truth)]


def by_scipy() -> list[Comparison]:
    """Compare with solve_ivp: its defaults, and settings that let it be right."""
    return [*_swing(), *_rocking(), *_sliding()]


def _swing() -> list[Comparison]:
    length, zeta = np.array([0.3, 1.0, 3.0]), 0.02
    motion = strong(1)
    ours = Ours("swing", motion, length=length, damping=zeta)
    a, n, times = _inputs(motion)

    def swing(span: float, settings: Settings) -> float:
        w = np.sqrt(G / span)

        def rates(t: float, s: Array) -> list[float]:
            return [s[1], -2 * zeta * w * s[1] - (n(t) * np.sin(s[0]) + a(t) * np.cos(s[0])) / span]

        found = solve_ivp(rates, (0.0, float(times[-1])), [0.0, 0.0], t_eval=times, **settings)
        return float(span * np.abs(np.sin(found.y[0])).max())

    settings = (("defaults", {}), ("rtol 1e-6", {"rtol": 1e-6, "atol": 1e-9}))
    return [
        ours.beside("swing", f"solve_ivp, {name}", [clocked(lambda k=k, s=s: swing(k, s)) for k in length], 1000.0)
        for name, s in settings
    ]


def _rocking() -> list[Comparison]:
    half_width, cg_height = np.array([0.12, 0.25, 0.06]), np.array([0.4, 0.7, 0.2])
    motion = strong(1)
    ours = Ours("rocking", motion, half_width=half_width, cg_height=cg_height)
    sizes = list(zip(half_width.tolist(), cg_height.tolist(), strict=True))
    fell = ours.outputs("reference")["overturned"] > 0.0
    alpha = np.arctan2(half_width, cg_height)
    rows = []
    careful = {"rtol": 1e-6, "atol": 1e-9, "max_step": motion.dt}
    for name, settings in (("defaults", {}), ("rtol 1e-6, at most dt", careful)):
        runs = [clocked(lambda b=b, h=h, s=settings: _rock(motion, b, h, s)) for b, h in sizes]
        theirs = np.array([ratio for ratio, _ in runs]) * alpha > 1.5
        outcomes = int(np.sum(theirs == fell)), fell.size
        rows.append(
            ours.beside("rocking", f"solve_ivp with events, {name}", runs, 1000.0, counted=~fell, outcomes=outcomes)
        )
    return rows


def _rock(motion: Excitation, b: float, h: float, settings: Settings) -> float:
    """Return max |theta| / alpha of a uniform rectangle: restarted at each impact, at rest until the next uplift.

    As ours it ends at a quarter turn, from which no body comes back.
    """
    a, n, times = _inputs(motion)
    end = float(times[-1])
    alpha, radius = np.arctan2(b, h), np.hypot(b, h)
    p2, e = 0.75 * G / radius, 1.0 - 1.5 * np.sin(alpha) ** 2
    # How far the push exceeds what lifts the body over either edge; linear between samples.
    excess = np.stack([-motion.x, motion.x]) - (G + motion.z) * b / h

    def next_lift(after: float) -> tuple[float, float]:
        first = int(after / motion.dt)
        now = [np.interp(after, times, row) for row in excess]
        if max(now) > 0.0:
            return after, (1.0, -1.0)[int(np.argmax(now))]
        found = []
        for side, row in zip((1.0, -1.0), excess, strict=True):
            above = first + 1 + np.flatnonzero(row[first + 1 :] > 0.0)
            if above.size:
                k = int(above[0])
                found.append((times[k] - motion.dt * row[k] / (row[k] - row[k - 1]), side))
        return min(found, default=(end, 1.0))

    def rates(t: float, s: Array) -> list[float]:
        lean = side * alpha - s[0]
        return [s[1], -p2 / G * (n(t) * np.sin(lean) + a(t) * np.cos(lean))]

    def impact(_t: float, s: Array) -> float:
        return float(side * s[0])

    impact.terminal, impact.direction = True, -1.0  # type: ignore[attr-defined]

    def fall(_t: float, s: Array) -> float:
        return float(abs(s[0]) - 0.5 * np.pi)

    fall.terminal = True  # type: ignore[attr-defined]
    largest, t, rate, side = 0.0, 0.0, 0.0, 0.0
    while t < end:
        if abs(rate) < 1e-4 * np.sqrt(p2) * alpha:
            t, side = next_lift(t)
            rate = 0.0
            if t >= end:
                break
        else:
            side = float(np.sign(rate))
        found = solve_ivp(rates, (t, end), [0.0, rate], events=(impact, fall), **settings)
        largest = max(largest, float(np.abs(found.y[0]).max()) / alpha)
        if found.t_events[1].size:
            break
        t, rate = float(found.t[-1]), e * float(found.y[1, -1])
    return largest


def _sliding() -> list[Comparison]:
    mu = np.array([0.1, 0.15, 0.25])
    motion = strong(2)
    ours = Ours("sliding", motion, friction_static=mu)
    times = motion.dt * np.arange(motion.x.size)
    components = (motion.x, motion.y, motion.z)

    def slide(m: float) -> float:
        def rates(t: float, s: Array) -> list[float]:
            x, y, z = (np.interp(t, times, row) for row in components)  # type: ignore[arg-type]
            drag = m * (G + z) / np.sqrt(s[2] ** 2 + s[3] ** 2 + REGULAR**2)
            return [s[2], s[3], -x - drag * s[2], -y - drag * s[3]]

        found = solve_ivp(rates, (0.0, float(times[-1])), np.zeros(4), method="LSODA", rtol=1e-6, atol=1e-9)
        return float(np.hypot(found.y[0], found.y[1]).max())

    runs = [clocked(lambda m=m: slide(m)) for m in mu.tolist()]
    return [ours.beside("sliding 2-D", "solve_ivp LSODA, friction smoothed", runs, 1000.0)]


def _inputs(motion: Excitation) -> tuple[Callable[[float], float], Callable[[float], float], Array]:
    """Return the base's acceleration and the apparent gravity as functions of time, and the times of the samples."""
    times = motion.dt * np.arange(motion.x.size)
    weight = G + motion.z
    return (
        lambda t: float(np.interp(t, times, motion.x)),
        lambda t: float(np.interp(t, times, weight)),
        times,
    )
