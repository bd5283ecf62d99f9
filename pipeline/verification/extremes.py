"""The motions at which a model may break, for the numerical self-test and the tests; its objects: `Model.trials`."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from pipeline.models import MODELS
from pipeline.quantities import Array, G
from pipeline.records import Model, Motion

STRONG = 5.0
"""Peak of each horizontal component of the shaking [m/s2]."""

BESIDE = ("angle", "fidelity", "note")
"""Columns beside the outputs and their error, which may be empty or are not numbers."""


def shaking(samples: int = 300, dt: float = 0.02, vertical: float = 0.5) -> Motion:
    """Return band-limited random shaking (0.4 to 12 Hz) that rises and decays, the same at each call.

    Parameters
    ----------
    samples : int
        How many.
    dt : float
        Time step in s.
    vertical : float
        Peak of the vertical relative to that of each horizontal.

    Returns
    -------
    Motion
        With peaks of STRONG in the horizontals.
    """
    rng = np.random.default_rng(71)
    t = np.arange(samples) * dt
    envelope = np.sin(np.pi * (t + 0.5 * dt) / (t[-1] + dt)) ** 0.7
    a = np.zeros((3, samples))
    for row, share in enumerate((1.0, 1.0, vertical)):
        tones, phases = np.exp(rng.uniform(np.log(0.4), np.log(12.0), (14, 1))), rng.uniform(0.0, 2.0 * np.pi, (14, 1))
        a[row] = envelope * np.sin(2.0 * np.pi * tones * t + phases).sum(axis=0)
        a[row] *= share * STRONG / np.abs(a[row]).max()
    return Motion(dt, a, "shaking")


def along_x(values: Array, dt: float, vertical: float = 0.0) -> Motion:
    """Return a motion with given samples along x, and a constant vertical acceleration.

    Parameters
    ----------
    values : array, shape (n,)
        In m/s2.
    dt : float
        Time step in s.
    vertical : float
        In m/s2, up.

    Returns
    -------
    Motion
        With nothing along y.
    """
    return Motion(dt, np.vstack([values, np.zeros_like(values), np.full_like(values, vertical)]))


def motions() -> dict[str, Motion]:
    """Return the motions that a response must survive, by name."""
    base = shaking()
    a = base.acceleration
    return {
        "plain": base,
        "times 1e-6": Motion(base.dt, 1e-6 * a),
        "times 1000": Motion(base.dt, 1000.0 * a),
        "vertical below -g": Motion(base.dt, a * np.array([[1.0], [1.0], [6.0]])),
        "dt 0.5 ms": Motion(0.0005, a),
        "dt 40 ms": Motion(0.04, a),
        "one sample": Motion(0.02, a[:, 50:51]),
        "two samples": Motion(0.02, a[:, 50:52]),
        "denormals": Motion(0.02, 1e-310 * a),
        "zeros": Motion(0.02, 0.0 * a),
        "weightless": Motion(0.02, np.vstack([a[0], a[1], np.full(300, -G)])),
        "huge offset": Motion(0.02, a + 1e4),
    }


def pushed() -> list[tuple[Model, int | None]]:
    """Return each model that is integrated in time, and in how many directions where it can be told.

    Returns
    -------
    list of (Model, int or None)
        Those of the registry with extreme objects; a model that takes both comes once for each.
    """
    return [
        (model, directions)
        for model in MODELS
        if model.trials.extremes
        for directions in ((1, 2) if model.directions == 0 else (None,))
    ]


def complaint(model: Model, row: Mapping[str, Any]) -> str:
    """Return what is wrong with a result: a NaN or an infinity that no note explains, a negative size.

    Parameters
    ----------
    model : Model
        Whose optional outputs may be empty.
    row : mapping
        One row of the table of `respond`.

    Returns
    -------
    str
        "" where nothing is.
    """
    may_be_empty = {*BESIDE, *(q.name for q in model.gives if q.optional)}
    for column, value in row.items():
        if column in may_be_empty:
            continue
        if not np.isfinite(float(value)) and not row["note"]:
            return f"{column} is {value} without a note"
        if float(value) < 0.0:
            return f"{column} is {value}"
    return ""
