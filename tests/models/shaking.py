"""Motions that the tests shake with: pulses, sines, and band-limited random records from a fixed seed."""

from __future__ import annotations

import numpy as np

from pipeline.quantities import Array
from pipeline.records import Motion


def along_x(values: Array | list[float], dt: float) -> Motion:
    """Return a motion with these samples along x and nothing else."""
    x = np.asarray(values, dtype=float)
    return Motion(dt, np.vstack([x, np.zeros_like(x), np.zeros_like(x)]))


def random_motion(seed: int, n: int = 600, dt: float = 0.01, pga: float = 5.0, vertical: float = 0.5) -> Motion:
    """Return a band-limited random record that rises and decays; z is `vertical` times as strong."""
    rng = np.random.default_rng(seed)
    t = np.arange(n) * dt
    envelope = np.sin(np.pi * (t + 0.5 * dt) / (t[-1] + dt)) ** 0.7
    a = np.zeros((3, n))
    for row in range(3):
        tones = np.exp(rng.uniform(np.log(0.4), np.log(12.0), 14))
        phases, sizes = rng.uniform(0.0, 2.0 * np.pi, 14), rng.uniform(0.3, 1.0, 14)
        a[row] = envelope * (sizes[:, None] * np.sin(2.0 * np.pi * tones[:, None] * t + phases[:, None])).sum(axis=0)
        a[row] *= pga / np.abs(a[row]).max()
    a[2] *= vertical
    return Motion(dt, a, f"random {seed}")


def resampled(motion: Motion, times: int) -> Motion:
    """Return the same polygon with `times` intervals for each of its own: the same excitation, written otherwise."""
    n = (motion.samples - 1) * times + 1
    at, grid = np.arange(n) / times, np.arange(motion.samples)
    return Motion(motion.dt / times, np.vstack([np.interp(at, grid, row) for row in motion.acceleration]))


def turned(motion: Motion, degrees: float) -> Motion:
    """Return the motion seen from axes turned by -degrees: its horizontal vectors turn by +degrees."""
    c, s = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    x, y, z = motion.acceleration
    return Motion(motion.dt, np.vstack([c * x - s * y, s * x + c * y, z]))


def times(motion: Motion, horizontal: float, vertical: float) -> Motion:
    """Return the motion with its components multiplied."""
    return Motion(motion.dt, motion.acceleration * np.array([[horizontal], [horizontal], [vertical]]))


def base_displacement(a: Array, dt: float) -> tuple[Array, Array]:
    """Return velocity and displacement (n,) of a base at its samples: exact for the polygon."""
    v = np.concatenate([[0.0], np.cumsum(0.5 * dt * (a[1:] + a[:-1]))])
    u = np.concatenate([[0.0], np.cumsum(v[:-1] * dt + dt**2 * (2.0 * a[:-1] + a[1:]) / 6.0)])
    return v, u
