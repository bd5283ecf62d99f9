"""An experiment: bodies that were shaken on a table, each run's motion, and which of them overturned (contract "An
experiment": a folder with `experiment.toml`)."""

from __future__ import annotations

import csv
import io
import json
import re
import tomllib
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any, Literal
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, ValidationError, model_validator

from pipeline.errors import InputError, mends_toml
from pipeline.motions.filtering import highpass
from pipeline.motions.intensity import measures
from pipeline.motions.reading import UNITS
from pipeline.motions.record import FileName, Table, Text, Unit
from pipeline.quantities import Array, G
from pipeline.records import Motion
from pipeline.resources import small_text

EXPERIMENT = "experiment.toml"

STRONGEST = 10.0 * G
"""m/s2 of a table's motion above which its unit is doubted."""

WEAKEST = 0.01 * G
"""m/s2 of the strongest motion of all below which the unit is doubted."""

_KEY = re.compile(r"[^{}]*\{(\w+)(:0?\d{1,2}d?)?\}[^{}]*")

Positive = Annotated[float, Field(gt=0.0)]


class ExperimentError(InputError):
    """An experiment that cannot be used: the message names file, field, what is wrong and the remedy."""


class BodyTable(Table):
    """A body that was shaken: scanned, or a block of known size.

    Attributes
    ----------
    mesh : FileName or None
        In m, z up, resting on its lowest points; a cloud of points without triangles counts as its convex hull.
    hull : bool
        The convex hull stands for a mesh that is not closed.
    width_m, depth_m, height_m : Positive or None
        Of a block, instead of a mesh; its width lies along x.
    surface : Text or None
        What stands on what, such as "marble on wood", by the names of the table of frictions where it has them.
    friction
        Its static coefficient there, where somebody measured it; else that of the table.
    mass_kg : Positive or None
        For the page; no model needs it.
    """

    name: Text
    mesh: FileName | None = None
    hull: bool = False
    width_m: Positive | None = None
    depth_m: Positive | None = None
    height_m: Positive | None = None
    mass_kg: Positive | None = None
    surface: Text | None = None
    friction: Annotated[float, Field(gt=0.0, le=5.0)] | None = None

    @property
    def sizes(self) -> tuple[float | None, float | None, float | None]:
        """Width, depth and height of a block, m."""
        return self.width_m, self.depth_m, self.height_m

    @model_validator(mode="after")
    def _known(self) -> BodyTable:
        block = [value is not None for value in self.sizes]
        if any(block) == (self.mesh is not None) or any(block) != all(block):
            raise InputError("give a mesh, or width_m, depth_m and height_m of a block, and not both")
        return self


class PredictionTable(Table):
    """What others predicted: for each body the column of the runs that holds its probability of overturning."""

    name: Text
    columns: dict[str, Text] = Field(min_length=1)


class ExperimentTable(Table):
    """What `experiment.toml` says.

    Attributes
    ----------
    runs : FileName
        CSV file, one row a run; for each body a column of its name, in which 1 is overturned and 0 is not.
    run_column, fold_column : Text
        What tells runs apart, and the motion that several of them scale: folds never part it.
    motions, motion_key
        NumPy archive (.npz), and the name in it of a run's array, such as "test{test:03d}".
    axes
        Of the table: 1 (arrays of n samples), 2 (x and y, shape (2, n)) or 3 (x, y and z).
    direction
        Degrees from the table's x axis to that of the bodies, or "unknown".
    high_pass_hz : float
        Corner below which a table's accelerometer drifts; 0 leaves the motions as they are.
    """

    title: Text
    source: Text
    licence: Text
    runs: FileName
    run_column: Text
    fold_column: Text
    motions: FileName
    motion_key: Text
    unit: Unit
    sampling_rate_hz: Positive
    axes: Literal[1, 2, 3] = 1
    direction: Literal["unknown"] | float = "unknown"
    high_pass_hz: float = Field(default=0.1, ge=0.0)
    body: tuple[BodyTable, ...] = Field(min_length=1)
    prediction: tuple[PredictionTable, ...] = ()

    @model_validator(mode="after")
    def _consistent(self) -> ExperimentTable:
        names = [body.name for body in self.body]
        if len(set(names)) < len(names):
            raise InputError("two bodies have the same name; each needs its own, as its column in the runs has")
        for one in self.prediction:
            if stray := set(one.columns) - set(names):
                raise InputError(f"prediction {one.name!r}: there is no body {min(stray)!r}; name one of {names}")
        key = _KEY.fullmatch(self.motion_key)
        if key is None or key[1] != self.run_column:
            raise InputError(
                f"motion_key {self.motion_key!r} does not hold {{{self.run_column}}}; write it as in "
                f'"test{{{self.run_column}:03d}}"'
            )
        return self


@dataclass(frozen=True, eq=False)
class Experiment:
    """An experiment as it was read.

    Attributes
    ----------
    folder : Path
        Where it lies.
    said : ExperimentTable
        What its `experiment.toml` says.
    runs : tuple of str
        What each run is called.
    folds : tuple of str
        The motion of each run.
    motions : tuple of Motion
        Of each run, as the bodies were shaken.
    fell : ndarray of bool, shape (bodies, runs)
        Whether it overturned.
    predicted : mapping of str to ndarray, shape (bodies, runs)
        Probabilities by others; NaN where they give none.
    """

    folder: Path
    said: ExperimentTable
    runs: tuple[str, ...]
    folds: tuple[str, ...]
    motions: tuple[Motion, ...]
    fell: NDArray[np.bool_]
    predicted: dict[str, Array]

    @cached_property
    def peak_velocities(self) -> Array:
        """The peak velocity of each run, the larger of the two directions, m/s, shape (runs,)."""
        return np.array([measures(motion)["pgv"] for motion in self.motions])

    @property
    def names(self) -> list[str]:
        """What its bodies are called."""
        return [body.name for body in self.said.body]


def experiment_schema() -> dict[str, Any]:
    """Return the JSON Schema of an experiment, as schemas/experiment.schema.json holds it."""
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        **ExperimentTable.model_json_schema(),
        "title": "Kouros experiment",
    }


def read_experiment(folder: Path) -> Experiment:
    """Read an experiment: what is said of it, its runs and their motions.

    Parameters
    ----------
    folder : Path
        That holds `experiment.toml`.

    Returns
    -------
    Experiment
        Its meshes are not read yet.

    Raises
    ------
    ExperimentError
        For a file that is missing or no such file, a field that is missing, unknown or of another kind, an outcome that
        is not 0 or 1, and a run without a motion: naming file, row and field.
    """
    said = _said(folder / EXPERIMENT)
    rows = _rows(folder / said.runs, said)
    runs = tuple(row[said.run_column] for row in rows)
    arrays = _archive(folder / said.motions)
    motions = tuple(_motion(folder / said.motions, arrays, said, run) for run in runs)
    peak = max(float(np.abs(motion.acceleration).max()) for motion in motions)
    if not WEAKEST <= peak <= STRONGEST:
        raise ExperimentError(
            f"{folder / EXPERIMENT}: unit: the strongest motion peaks at {peak / G:.3g} g where the unit is "
            f"{said.unit!r}; correct the unit"
        )
    at = [f"{folder / said.runs}, run {run!r}" for run in runs]
    fell = np.array([[_outcome(*where, body.name) for where in zip(at, rows, strict=True)] for body in said.body], bool)
    predicted = {
        one.name: np.array(
            [
                [_probability(*where, one.columns.get(body.name)) for where in zip(at, rows, strict=True)]
                for body in said.body
            ]
        )
        for one in said.prediction
    }
    return Experiment(folder, said, runs, tuple(row[said.fold_column] for row in rows), motions, fell, predicted)


def _said(file: Path) -> ExperimentTable:
    try:
        data = tomllib.loads(small_text(file))
    except FileNotFoundError as problem:
        raise ExperimentError(f"{file}: there is no such file; give a folder that holds an {EXPERIMENT}") from problem
    except OSError as problem:
        raise ExperimentError(f"{file}: cannot be read: {problem.strerror}; see whether it is a folder") from problem
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as problem:
        raise ExperimentError(f"{file}: no TOML in UTF-8: {problem}; {mends_toml(problem)}") from problem
    try:
        return ExperimentTable.model_validate_json(json.dumps(data, default=str))
    except ValidationError as problem:
        told = "\n  ".join(_told(one) for one in problem.errors(include_url=False)[:5])
        raise ExperimentError(f"{file}: {told}") from problem


def _told(problem: Any) -> str:
    place = "".join(f"[{p}]" if isinstance(p, int) else f".{p}" for p in problem["loc"]).lstrip(".")
    if problem["type"] == "missing":
        return f"{place}: missing; add it"
    if problem["type"] == "extra_forbidden":
        return f"{place}: unknown key; remove or correct it"
    message = problem["msg"].removeprefix("Value error, ")
    given = "" if problem["type"] == "value_error" else f", not {str(problem['input'])[:80]!r}"
    return f"{place or 'the whole file'}: {message[:1].lower()}{message[1:]}{given}"


def _rows(file: Path, said: ExperimentTable) -> list[dict[str, str]]:
    try:
        reader = csv.DictReader(io.StringIO(small_text(file)), strict=True)
        rows = list(reader)
    except FileNotFoundError as problem:
        raise ExperimentError(f"{file}: there is no such file; put it there, or correct `runs`") from problem
    except (OSError, UnicodeDecodeError, csv.Error) as problem:
        raise ExperimentError(f"{file}: cannot be read as CSV in UTF-8: {problem}; export it again") from problem
    wanted = [said.run_column, said.fold_column, *(body.name for body in said.body)]
    wanted += [column for one in said.prediction for column in one.columns.values()]
    for column in wanted:
        if column not in (reader.fieldnames or ()):
            raise ExperimentError(
                f"{file}: there is no column {column!r}, which {EXPERIMENT} names; add it, or correct the name there"
            )
    if not rows:
        raise ExperimentError(f"{file}: it holds no runs; add a row for each")
    seen: set[str] = set()
    for line, row in enumerate(rows, start=2):
        # A row that is too short ends in None, one that is too long holds a list under None.
        if None in row or None in row.values():
            raise ExperimentError(f"{file}, line {line}: it has not as many cells as the first line; mend the row")
        run = row[said.run_column]
        if run in seen or not run or not row[said.fold_column]:
            column = said.fold_column if run and run not in seen else said.run_column
            raise ExperimentError(
                f"{file}, line {line}: column {column!r} is empty, or says the run {run!r} again; each run is one row"
            )
        seen.add(run)
    return rows


def _outcome(where: str, row: dict[str, str], column: str) -> bool:
    if row[column].strip() not in ("0", "1"):
        raise ExperimentError(
            f"{where}: column {column!r} holds {row[column][:40]!r}; write 1 where the body overturned, 0 "
            "where not, and leave out a run of which nobody knows"
        )
    return row[column].strip() == "1"


def _probability(where: str, row: dict[str, str], column: str | None) -> float:
    text = row[column].strip() if column is not None else ""
    try:
        value = float(text) if text else np.nan
    except ValueError:
        value = -1.0
    if not (np.isnan(value) or 0.0 <= value <= 1.0):
        raise ExperimentError(
            f"{where}: column {column!r} holds {text[:40]!r}; write a probability from 0 to 1, or nothing"
        )
    return value


def _archive(file: Path) -> Any:
    try:
        found = np.load(file, allow_pickle=False)
    except FileNotFoundError as problem:
        raise ExperimentError(f"{file}: there is no such file; put it there, or correct `motions`") from problem
    except (OSError, ValueError, BadZipFile, EOFError) as problem:
        raise ExperimentError(
            f"{file}: no NumPy archive (.npz) that can be read: {problem}; save it again"
        ) from problem
    if isinstance(found, np.ndarray):
        raise ExperimentError(f"{file}: it holds one array; save the motions with numpy.savez under their names")
    return found


def _motion(file: Path, arrays: Any, said: ExperimentTable, run: str) -> Motion:
    try:
        key = said.motion_key.format(**{said.run_column: int(run) if run.isdecimal() else run})
    except ValueError as problem:
        raise ExperimentError(
            f"{file.parent / EXPERIMENT}: motion_key {said.motion_key!r} does not fit the run {run!r}: {problem}"
        ) from problem
    if key not in arrays:
        raise ExperimentError(
            f"{file}: there is no motion {key!r} of run {run!r}; add it, or take the run out of {said.runs}"
        )
    try:
        raw = np.asarray(arrays[key], dtype=np.float64)
    except (ValueError, TypeError, BadZipFile, EOFError, OSError) as problem:
        raise ExperimentError(f"{file}: motion {key!r} is no array of numbers: {problem}; save it again") from problem
    rows = np.atleast_2d(raw)
    if raw.ndim > 2 or rows.shape[0] != said.axes or rows.shape[1] < 2 or not np.isfinite(rows).all():
        wanted = "(n,)" if said.axes == 1 else f"({said.axes}, n)"
        raise ExperimentError(
            f"{file}: motion {key!r} has the shape {raw.shape}, or numbers that are not finite; it must be {wanted} as "
            f"axes = {said.axes} says"
        )
    dt = 1.0 / said.sampling_rate_hz
    acceleration, start = np.zeros((3, rows.shape[1])), np.zeros(3)
    acceleration[: said.axes] = UNITS[said.unit] * rows
    steps: tuple[str, ...] = ()
    if said.high_pass_hz > 0.0:
        if said.high_pass_hz >= 0.5 * said.sampling_rate_hz:
            raise ExperimentError(
                f"{file.parent / EXPERIMENT}: high_pass_hz {said.high_pass_hz:g} is not below half of the sampling rate"
            )
        acceleration, told, start = highpass(acceleration, dt, said.high_pass_hz)
        steps = (told,)
    return Motion(dt, acceleration, f"run {run}", steps, said.source, start)
