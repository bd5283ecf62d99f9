"""Motion of a base, its excitation of a model, and its summary in a report."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from pipeline.errors import InputError
from pipeline.quantities import Array, G, real_array, real_number
from pipeline.records import notebook

STEPS = (1e-9, 1e6)
"""s, the shortest and the longest time step of a motion: beyond them its rates leave the range of numbers."""

STRONGEST = 1e50
"""m/s2, the largest acceleration of a motion, for the same reason."""


@dataclass(frozen=True, eq=False)
class Motion:
    """The acceleration history of a base, piecewise linear between samples, at rest before and unexcited after.

    Parameters
    ----------
    dt : float
        The uniform time step in s.
    acceleration : array_like, shape (3, n)
        In m/s2, rows x (east), y (north), z (up).
    name : str
        What a report calls it.
    steps : iterable of str
        What was done to the record, in order, each step with its parameters.
    source : str
        Who recorded it and under which licence.
    start : iterable of float
        The velocity (x, y, z) in m/s that the record starts with, as an agency's own velocity series may say; no model
        is moved by it, but the PGV and the overturning criterion are.
    v_max : float or None
        What the manifest says the velocity of the overturning criterion is, in m/s; None: the PGV.

    Raises
    ------
    InputError
        For a shape that is not (3, n), values that are not finite, a dt that is not positive.
    """

    dt: float
    acceleration: Array
    name: str = "motion"
    steps: tuple[str, ...] = ()
    source: str = ""
    start: tuple[float, float, float] = (0.0, 0.0, 0.0)
    v_max: float | None = None

    def __init__(
        self,
        dt: float,
        acceleration: ArrayLike,
        name: str = "motion",
        steps: Iterable[str] = (),
        source: str = "",
        start: Iterable[float] = (0.0, 0.0, 0.0),
        v_max: float | None = None,
    ) -> None:
        real = real_array(acceleration)
        if real is None:
            raise InputError(
                f"motion {name!r}: acceleration must hold real numbers in m/s2; it holds texts, truth values, complex "
                f"numbers, or rows of different lengths"
            )
        a = np.array(real, order="C", copy=True)
        if a.ndim != 2 or a.shape[0] != 3 or a.shape[1] == 0:
            raise InputError(f"motion {name!r}: acceleration must have the shape (3, n), rows x, y, z; it is {a.shape}")
        # NaN is the largest of whatever it is among.
        largest = max(float(a.max()), -float(a.min()))
        if not np.isfinite(largest):
            row, sample = (int(i[0]) for i in np.nonzero(~np.isfinite(a)))
            raise InputError(f"motion {name!r}: component {'xyz'[row]} is {a[row, sample]} at sample {sample}")
        if largest > STRONGEST:
            raise InputError(f"motion {name!r}: an acceleration of {largest:g} m/s2 is none; check its unit")
        step = real_number(dt)
        if not STEPS[0] <= step <= STEPS[1]:
            raise InputError(
                f"motion {name!r}: dt must be a positive number of seconds, {STEPS[0]:g} to {STEPS[1]:g}, not {dt!r}"
            )
        a.setflags(write=False)
        begin = tuple(real_number(v) for v in start)
        if len(begin) != 3 or np.isnan(begin).any():
            raise InputError(f"motion {name!r}: start must be three finite velocities in m/s, not {start!r}")
        if v_max is not None and not real_number(v_max) > 0.0:
            raise InputError(f"motion {name!r}: v_max must be a velocity above 0 m/s, not {v_max!r}")
        given = {"dt": step, "acceleration": a, "name": name, "source": source, "start": begin, "v_max": v_max}
        for key, value in given.items():
            object.__setattr__(self, key, value)
        object.__setattr__(self, "steps", tuple(steps))

    @property
    def samples(self) -> int:
        """Number of samples of each component."""
        return int(self.acceleration.shape[1])

    @property
    def duration(self) -> float:
        """Seconds from the first to the last sample."""
        return (self.samples - 1) * self.dt

    @cached_property
    def hash(self) -> str:
        """SHA-256 of the time step and the samples: the identity of the excitation, whatever it is called."""
        digest = hashlib.sha256(np.float64(self.dt).tobytes())
        digest.update(self.acceleration.tobytes())
        return digest.hexdigest()

    def along(self, angle: float) -> Array:
        """Return the horizontal acceleration along a direction.

        Parameters
        ----------
        angle : float
            Degrees from x towards y.

        Returns
        -------
        ndarray, shape (n,)
            In m/s2.

        Raises
        ------
        InputError
            For what is no number.
        """
        # Exact zeros at multiples of 90 degrees: cos(pi/2) is 6e-17, which would wake an object that must stay at rest.
        degrees = real_number(angle)
        if np.isnan(degrees):
            raise InputError(f"angle must be a number of degrees, not {angle!r}")
        turn = degrees % 360.0
        exact = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), 270.0: (0.0, -1.0)}
        c, s = exact.get(turn) or (float(np.cos(np.radians(turn))), float(np.sin(np.radians(turn))))
        x, y = self.acceleration[0], self.acceleration[1]
        if s == 0.0:
            return np.ascontiguousarray(c * x)
        if c == 0.0:
            return np.ascontiguousarray(s * y)
        return np.ascontiguousarray(c * x + s * y)

    def excitation(self, angle: float | None, tail: float | None = None) -> Excitation:
        """Return what a model is shaken by.

        Parameters
        ----------
        angle : float or None
            Degrees from x towards y of its only direction; None: both.
        tail : float, optional
            Seconds after the record; None: until rest or past the peak.

        Returns
        -------
        Excitation
            Always the same one for both directions and no tail.
        """
        if angle is None:
            return self._both if tail is None else replace(self._both, tail=tail)
        z, (v_x, v_y, _) = self.acceleration[2], self.start
        along = self.along(angle)
        turn = np.radians(angle)
        begin = float(np.cos(turn) * v_x + np.sin(turn) * v_y)
        return Excitation(self.dt, along, None, z, tail, (begin, 0.0), self.v_max)

    @cached_property
    def _both(self) -> Excitation:
        # Always the same one, so that what is worked out about it once is known.
        x, y, z = self.acceleration
        return Excitation(self.dt, x, y, z, None, self.start[:2], self.v_max)

    def changed(self, acceleration: ArrayLike, step: str, dt: float | None = None) -> Motion:
        """Return the motion with other samples (and time step), and what was done recorded as its last step.

        Parameters
        ----------
        acceleration : array_like, shape (3, n)
            In m/s2, rows x, y, z.
        step : str
            What was done.
        dt : float, optional
            The time step in s; None: its own.

        Returns
        -------
        Motion
            Of the same name, source, start and v_max.
        """
        return Motion(
            self.dt if dt is None else dt,
            acceleration,
            self.name,
            (*self.steps, step),
            self.source,
            self.start,
            self.v_max,
        )

    def called(self, name: str, *steps: str) -> Motion:
        """Return the motion under another name, with further steps recorded."""
        return Motion(self.dt, self.acceleration, name, (*self.steps, *steps), self.source, self.start, self.v_max)

    def scaled(self, factor: float, why: str) -> Motion:
        """Return the motion with all three components multiplied by one factor, and the step recorded.

        Parameters
        ----------
        factor : float
            Dimensionless; the start and v_max are multiplied, too.
        why : str
            The reason, for the step.

        Returns
        -------
        Motion
            Of the same name and source.

        Raises
        ------
        InputError
            For a factor that is not a finite number.
        """
        if np.isnan(real_number(factor)):
            raise InputError(f"the factor of a motion must be a finite number, not {factor!r}")
        return Motion(
            self.dt,
            factor * self.acceleration,
            self.name,
            (*self.steps, f"scaled by {factor:.6g} ({why})"),
            self.source,
            [factor * v for v in self.start],
            None if self.v_max is None else factor * self.v_max,
        )

    def _repr_html_(self) -> str:
        peaks = np.abs(self.acceleration).max(axis=1)
        named = [(axis, peak, row) for axis, peak, row in zip("xyz", peaks, self.acceleration, strict=True)]
        rows = {
            "duration": [f"{self.duration:g} s, {self.samples:,} samples of {self.dt:g} s"],
            "largest acceleration": [f"{axis}: {peak:.3g} m/s2 ({peak / G:.3g} g)" for axis, peak, _ in named],
            "source": [self.source] if self.source else [],
            "steps": self.steps,
        }
        pictures = "".join(
            f"<div>{axis} {notebook.small_picture(row, f'acceleration {axis}, up to {peak:.3g} m/s2')}</div>"
            for axis, peak, row in named
        )
        return notebook.table(self.name, {head: lines for head, lines in rows.items() if lines}) + pictures

    def plot(self, axes: Any = None) -> Any:
        """Draw the acceleration in x, y and z over time, one below another, with matplotlib.

        Parameters
        ----------
        axes : array of matplotlib Axes, shape (3,), optional
            Where to draw; None: in a new figure.

        Returns
        -------
        ndarray of matplotlib Axes, shape (3,)
            In m/s2 over s.

        Raises
        ------
        KourosError
            Where matplotlib is not installed.
        """
        where = notebook.axes_for(3, axes)
        t = self.dt * np.arange(self.samples)
        for at, name, values in zip(where, "xyz", self.acceleration, strict=True):
            at.plot(t, values, linewidth=0.6, color="black")
            at.set_ylabel(f"{name} (m/s²)")
        where[0].set_title(self.name.replace("$", r"\$"))
        where[-1].set_xlabel("time (s)")
        return where


@dataclass(frozen=True, slots=True, eq=False, weakref_slot=True)
class Excitation:
    """The shaking of a one-direction or two-direction model.

    Attributes
    ----------
    dt : float
        Time step, s.
    x, y, z : ndarray, shape (n,)
        Acceleration of the base, m/s2; y is None for a one-direction model.
    tail : float or None
        Seconds of rest after the record; None means until rest or past the peak, capped.
    start : (float, float)
        Horizontal velocity that the record starts with (along x, and along y), m/s.
    v_max : float or None
        The velocity of the overturning criterion where the manifest says it, m/s; None: the peak velocity.
    """

    dt: float
    x: Array
    y: Array | None
    z: Array
    tail: float | None
    start: tuple[float, float] = (0.0, 0.0)
    v_max: float | None = None


@dataclass(frozen=True, slots=True)
class MotionSummary:
    """A motion as the report shows it: measures in SI, processing steps, and thinned series for its picture.

    Attributes
    ----------
    name, hash, level, source : str
        Of the motion, and the level of shaking that it is of.
    dt : float
        Time step, s.
    samples : int
        Of each component.
    measures : mapping of str to float
        By name, SI.
    steps : tuple of str
        What was done to the record, in order.
    approved_by, approved_on, licence : str
        As the manifest says.
    floor : str
        On which it is felt; "" for the ground.
    series : mapping of str to tuple of float
        By name, SI, thinned.
    """

    name: str
    hash: str
    level: str
    source: str
    dt: float
    samples: int
    measures: Mapping[str, float]
    steps: tuple[str, ...]
    approved_by: str = ""
    approved_on: str = ""
    licence: str = ""
    floor: str = ""
    series: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
