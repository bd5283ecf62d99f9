"""The nouns that every floor shares: motions, items, scenes, models, findings, recommendations, charts."""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from enum import StrEnum
from functools import cached_property
from typing import Any, Protocol, TypeVar

import numpy as np
from numpy.typing import ArrayLike

from pipeline.quantities import Array, Quantity


@dataclass(frozen=True, eq=False)
class Motion:
    """The acceleration history of a base, piecewise linear between samples, at rest before and unexcited after.

    dt           : s, the uniform time step
    acceleration : (3, n) m/s2, rows x (east), y (north), z (up)
    name         : what a report calls it
    steps        : what was done to the record, in order, each step with its parameters
    source       : who recorded it and under which licence
    raises       : ValueError for a shape that is not (3, n), values that are not finite, a dt that is not positive
    """

    dt: float
    acceleration: Array
    name: str = "motion"
    steps: tuple[str, ...] = ()
    source: str = ""

    def __init__(
        self, dt: float, acceleration: ArrayLike, name: str = "motion", steps: Iterable[str] = (), source: str = ""
    ) -> None:
        a = np.array(acceleration, dtype=np.float64, order="C", copy=True)
        if a.ndim != 2 or a.shape[0] != 3 or a.shape[1] == 0:
            raise ValueError(f"motion {name!r}: acceleration must have the shape (3, n), rows x, y, z; it is {a.shape}")
        bad = ~np.isfinite(a)
        if bad.any():
            row, sample = (int(i[0]) for i in np.nonzero(bad))
            raise ValueError(f"motion {name!r}: component {'xyz'[row]} is {a[row, sample]} at sample {sample}")
        if not (np.isfinite(dt) and dt > 0.0):
            raise ValueError(f"motion {name!r}: dt must be a positive number of seconds, not {dt!r}")
        a.setflags(write=False)
        for key, value in (("dt", float(dt)), ("acceleration", a), ("name", name), ("source", source)):
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
        """Return the horizontal acceleration (n,) m/s2 along ``angle`` degrees from x towards y."""
        # Exact zeros at multiples of 90 degrees: cos(pi/2) is 6e-17, which would wake an object that must stay at rest.
        turn = angle % 360.0
        exact = {0.0: (1.0, 0.0), 90.0: (0.0, 1.0), 180.0: (-1.0, 0.0), 270.0: (0.0, -1.0)}
        c, s = exact.get(turn) or (float(np.cos(np.radians(turn))), float(np.sin(np.radians(turn))))
        x, y = self.acceleration[0], self.acceleration[1]
        if s == 0.0:
            return np.ascontiguousarray(c * x)
        if c == 0.0:
            return np.ascontiguousarray(s * y)
        return np.ascontiguousarray(c * x + s * y)

    def scaled(self, factor: float, why: str) -> Motion:
        """Return the motion with all three components multiplied by one factor, and the step recorded."""
        step = f"scaled by {factor:.6g} ({why})"
        return Motion(self.dt, factor * self.acceleration, self.name, (*self.steps, step), self.source)


class Support(StrEnum):
    """How an object is held."""

    FREESTANDING = "freestanding"
    FASTENED = "fastened"
    HUNG = "hung"
    SUSPENDED = "suspended"
    ISOLATED = "isolated"


class Origin(StrEnum):
    """Where a number comes from."""

    MEASURED = "measured"
    DERIVED = "derived"
    ASSUMED = "assumed"


@dataclass(frozen=True, slots=True)
class Problem:
    """Something wrong with a record: which field, what is wrong, and what mends it."""

    field: str
    message: str
    remedy: str = ""


@dataclass(frozen=True, slots=True)
class Item:
    """One object of the collection.  Lengths in m, mass in kg, stress in Pa, frequency in Hz; None where not recorded.

    Everything recorded here was measured or stated by the museum; what Kouros derives or assumes lives in the scene.
    ``problems`` keeps what the import could not accept, so that nothing is lost and nothing silently defaulted.
    """

    object_number: str
    gallery: str
    title: str = ""
    object_name: str = ""
    classification: str = ""
    medium: str = ""
    case: str = ""
    position_x_m: float | None = None
    position_y_m: float | None = None
    orientation_deg: float | None = None
    support: Support | None = None
    isolator: str = ""
    height_m: float | None = None
    base_width_m: float | None = None
    base_depth_m: float | None = None
    width_m: float | None = None
    depth_m: float | None = None
    cg_height_m: float | None = None
    mass_kg: float | None = None
    material: str = ""
    base_material: str = ""
    surface_material: str = ""
    friction: float | None = None
    frequency_hz: float | None = None
    damping: float | None = None
    suspension_length_m: float | None = None
    wall_surface: str = ""
    back_surface: str = ""
    section_shape: str = ""
    section_width_m: float | None = None
    section_depth_m: float | None = None
    section_wall_m: float | None = None
    section_height_m: float | None = None
    section_count: int | None = None
    allowable_stress_pa: float | None = None
    condition: float | None = None
    clearance_m: float | None = None
    susceptible: bool | None = None
    value_class: str = ""
    on_display: bool = True
    problems: tuple[Problem, ...] = ()


ITEM_FIELDS = tuple(f.name for f in fields(Item))


@dataclass(frozen=True, slots=True)
class Estimate:
    """A number with its range and where it comes from.

    ``low`` and ``high`` span what the number may be; a measured number has no span.  ``note`` names the field it was
    derived from or the default that was assumed; ``source`` says who says so.
    """

    value: float
    unit: str
    origin: Origin
    low: float
    high: float
    note: str = ""
    source: str = ""

    @classmethod
    def measured(cls, value: float, unit: str, note: str = "") -> Estimate:
        """Return a number that the museum recorded."""
        return cls(value, unit, Origin.MEASURED, value, value, note)


@dataclass(frozen=True, slots=True)
class Scene:
    """An object where it stands: its class, its support, and the estimates its models are run with.

    parameters : by name (SI), for example half_width, cg_height, friction_static, length, clearance
    missing    : the fields without which no model can be run, in the museum's words
    skipped    : models that do not apply, with the reason
    """

    item: Item
    object_class: str
    rule: str
    support: Support
    models: tuple[str, ...]
    parameters: Mapping[str, Estimate]
    assumptions: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()
    skipped: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Axis:
    """An axis of a chart: its label, SI unit of the data, and "linear" or "log"."""

    label: str
    unit: str
    scale: str = "linear"


@dataclass(frozen=True, slots=True)
class Curve:
    """A line of a chart; x and y in the axes' units."""

    label: str
    x: tuple[float, ...]
    y: tuple[float, ...]


@dataclass(frozen=True, slots=True)
class Zone:
    """A labelled region of a chart: a closed polygon and how it is judged ("safe", "warn", "danger")."""

    label: str
    x: tuple[float, ...]
    y: tuple[float, ...]
    tone: str


@dataclass(frozen=True, slots=True)
class Chart:
    """A picture of one motion's effect, shared by all objects marked on it.

    key   : identity within a run, such as "stability:<motion hash>"
    equal : the two axes share one scale (a path on the floor)
    """

    key: str
    title: str
    caption: str
    x: Axis
    y: Axis
    curves: tuple[Curve, ...]
    zones: tuple[Zone, ...] = ()
    equal: bool = False
    source: str = ""


@dataclass(frozen=True, slots=True)
class Mark:
    """Where an object lies on a chart (x, y in the axes' units)."""

    chart: str
    x: float
    y: float
    label: str = ""


class Verdict(StrEnum):
    """What a finding says."""

    PASS = "pass"  # noqa: S105
    FAIL = "fail"
    UNDETERMINED = "undetermined"


@dataclass(frozen=True, slots=True)
class Finding:
    """One demand set against one capacity (contract "A finding").

    low, high : the range of the demand that the uncertain inputs span
    sentence  : what it means, with {demand}, {capacity}, {low} and {high} to be filled in the reader's units
    title     : the failure in the field's words ("Rocking", "Sliding")
    screen    : the paper's closed-form criterion in words; reported, never deciding
    """

    object_number: str
    gallery: str
    level: str
    model: str
    title: str
    demand_name: str
    demand: float | None
    unit: str
    low: float | None
    high: float | None
    capacity: float | None
    capacity_origin: Origin | None
    utilisation: float | None
    verdict: Verdict
    fidelity: str
    error: float | None
    decided_by: str
    motion: str
    motion_hash: str
    sentence: str
    screen: str = ""
    outcome: str = ""
    note: str = ""
    assumptions: tuple[str, ...] = ()
    mark: Mark | None = None
    version: str = ""


@dataclass(frozen=True, slots=True)
class Check:
    """One model run again on the changed chain, as evidence that a recommendation works."""

    model: str
    title: str
    demand: float
    unit: str
    capacity: float
    utilisation: float
    passes: bool


@dataclass(frozen=True, slots=True)
class Recommendation:
    """A measure for one object, with the evidence of the models run again on the changed chain.

    measure    : identity of the row in tables/measures.csv
    parameters : what to build or buy, by name with unit, such as {"clearance_m": 0.14}
    sentence   : the advice in words, with {parameter} placeholders to be filled in the reader's units
    checks     : the models run again; every one passes, except for removal, which has none
    rejected   : the less intrusive measures that were tried or do not apply, and why not
    """

    object_number: str
    gallery: str
    level: str
    measure: str
    title: str
    sentence: str
    parameters: Mapping[str, float]
    units: Mapping[str, str]
    checks: tuple[Check, ...]
    rejected: tuple[str, ...] = ()
    mark: Mark | None = None
    source: str = ""


@dataclass(frozen=True, slots=True)
class Excitation:
    """What a one-direction or two-direction model is shaken by.

    dt, x, y, z : s and (n,) m/s2; y is None for a one-direction model
    tail        : s of rest after the record; None means until rest or past the peak, capped
    """

    dt: float
    x: Array
    y: Array | None
    z: Array
    tail: float | None


Columns = dict[str, Array]
"""Output name -> (n,) values; "error" and "note" (bit flags, see models.NOTES) are always there."""


@dataclass(frozen=True)
class Model:
    """A generic model or isolator: one row of the registry (see pipeline.models.MODELS).

    needs      : its parameters, in the order a caller would name them
    gives      : its outputs; the first is the one that ranks directions (RotD100) and carries the error
    directions : 1 (along an angle), 2 (both horizontal directions) or 0 (the parameter `directions` says)
    run        : (excitation, parameters, refine, estimate) -> columns; parameters are broadcast (n,) arrays, refine
                 divides the standard step; without estimate the error is left out (NaN) and the cost is a third
    demand     : which output is set against the capacity
    capacity   : parameter of the scene that the demand is held against, or a constant
    applies    : scene -> "" where the model applies, else the reason why not
    symmetric  : parameters -> True when the response does not change with the sign of the motion
    screen     : (excitation, parameters) -> columns by the paper's closed-form criterion; reported, never deciding
    say_screen : (one row of the screen, one set of parameters) -> the criterion in words
    trace      : (excitation, one set of parameters) -> time histories at the samples, (n,) each
    certificate: (excitation in two directions, parameters) -> the demand itself or an upper bound of it for any
                 direction, without integration; what it shows to be below the capacity is never integrated
    exact      : the certificate is the demand itself, not only a bound
    rests      : certificate up to which nothing moves, so that there is nothing to integrate; None: always integrate
    outcome    : (one row, one set of parameters) -> what the object does, in a word and in a sentence
    otherwise  : scene -> (output, capacity, sentence) that take the place of its own for this scene, or None
    mark       : (one set of parameters, demand) -> (kind of chart, x, y), or None
    fails      : what an object does whose demand exceeds the capacity, such as "slides"
    """

    name: str
    title: str
    kind: str
    source: str
    equation: str
    needs: tuple[Quantity, ...]
    gives: tuple[Quantity, ...]
    directions: int
    run: Callable[[Excitation, Mapping[str, Array], int, bool], Columns]
    demand: str
    capacity: str | float
    applies: Callable[[Scene], str]
    sentence: str
    fails: str
    symmetric: Callable[[Mapping[str, Array]], bool] = lambda _: True
    screen: Callable[[Excitation, Mapping[str, Array]], Columns] | None = None
    say_screen: Callable[[Mapping[str, float], Mapping[str, float]], str] = lambda _row, _parameters: ""
    trace: Callable[[Excitation, Mapping[str, float]], Columns] | None = None
    certificate: Callable[[Excitation, Mapping[str, Array]], Array] | None = None
    exact: bool = False
    rests: float | None = None
    outcome: Callable[[Mapping[str, float], Mapping[str, float]], tuple[str, str]] = lambda _row, _parameters: ("", "")
    otherwise: Callable[[Scene], tuple[str, float, str] | None] = lambda _scene: None
    mark: Callable[[Mapping[str, float], float], tuple[str, float, float] | None] = lambda _parameters, _demand: None

    def output(self, name: str) -> Quantity:
        """Return the output of that name.

        raises : KeyError
        """
        return next(q for q in self.gives if q.name == name)


@dataclass(frozen=True, slots=True)
class MotionSummary:
    """A motion as the report shows it: measures in SI, processing steps, and thinned series for its picture."""

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
    series: Mapping[str, tuple[float, ...]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Assessment:
    """One object with everything that was found about it."""

    scene: Scene
    findings: tuple[Finding, ...]
    recommendations: tuple[Recommendation, ...]

    @property
    def assessed(self) -> bool:
        """Whether at least one verdict could be reached."""
        return bool(self.findings) and not self.scene.missing


@dataclass(frozen=True, slots=True)
class RunRecord:
    """A whole run, as the store gives it back: all that the reports need, and nothing is computed again."""

    run_id: str
    started: str
    finished: str
    version: str
    site: str
    museum: str
    level_notes: tuple[str, ...]
    settings: Mapping[str, Any]
    assessments: tuple[Assessment, ...]
    charts: Mapping[str, Chart]
    motions: tuple[MotionSummary, ...]
    demonstration: bool = False


Task = TypeVar("Task")
Answer = TypeVar("Answer")


class Executor(Protocol):
    """Where independent pieces of work run."""

    def map(self, work: Callable[[Task], Answer], tasks: Sequence[Task]) -> list[Answer]:
        """Run the work on each task and return the answers in the order of the tasks."""
        ...


class Progress(Protocol):
    """Tells the person who waits how far the work is."""

    def step(self, what: str, done: int, total: int) -> None:
        """Report that ``done`` of ``total`` pieces of ``what`` are finished."""
        ...
