"""One model, one motion, many parameter sets, one fidelity."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from difflib import get_close_matches
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.response_charts import (
    SHELF,
    ResponseChart,
    Run,
    Settings,
    Shelf,
    Tabulated,
    axis_of,
    chart_of,
    tabulate,
)
from pipeline.errors import InputError
from pipeline.models import MODELS, model_named
from pipeline.models.common import BOUND, words
from pipeline.models.directions import worst_direction
from pipeline.quantities import Array, Quantity, checked, finite_angle, real_array, real_number, some_error
from pipeline.records import Columns, Excitation, Model, Motion
from pipeline.supports import TRANSMITTED, refined, support_named

if TYPE_CHECKING:
    import pandas as pd

FIDELITIES = ("screen", "bound", "chart", "history", "reference")
"""What ``respond`` can be asked for: closed-form screens, guaranteed bounds, charts, histories, tight tolerances."""

TOLERANCE = 1e-3
"""Relative error that a chart's interpolation is granted."""

DECIDES = 1e-2
"""The same where charts only have to tell a verdict: what lies closer to its capacity is integrated.

Of real objects with measured parameters less than 1 % do, sliding or swinging in every direction.
"""

REFINE = {"history": 2, "reference": 16}
"""How much finer than the coarsest step, which only ever looks for the worst direction, each fidelity integrates."""

AZIMUTH_STEP = 10.0
"""Degrees between the directions of which the worst counts when the orientation is unknown (RotD100)."""

Answer = dict[str, NDArray[Any] | list[str]]
"""A table as columns by name."""


def respond(
    model: str,
    motion: Motion,
    *,
    fidelity: str = "history",
    angle: float | None = 0.0,
    tail: float | None = None,
    azimuth_step: float = AZIMUTH_STEP,
    tolerance: float = TOLERANCE,
    charts: Shelf = SHELF,
    **parameters: Any,
) -> "pd.DataFrame":
    """Run one generic model under one motion for many objects at once.

    model        : a name of ``kouros models``
    angle        : degrees from x towards y along which a one-direction model is shaken; None means RotD100: the row of
                   the direction with the largest first output, every ``azimuth_step`` degrees
    tail         : s of rest after the record; None means until rest or past the peak, with the cap of the model
    tolerance    : of a chart's interpolation, relative to max(value, 1 % of the largest value on the chart)
    charts       : where charts are found and kept; of this process where none is given
    parameters   : the model's own, in SI; numbers or arrays, broadcast against each other
    returns      : table, one row a parameter set: the model's outputs, ``error`` (estimated, in the unit of the first
                   output), ``fidelity``, ``note``, and ``angle`` (the direction of the row; empty for two directions,
                   and for a worst direction from a chart).  Where a chart was asked for, ``fidelity`` says of each row
                   whether it came from one: what lies outside of it, or where it is not good enough, is integrated
    bound        : at this fidelity ``low`` and ``high`` follow, between which the first output lies for certain (in any
                   direction where the angle is None).  Each output holds its upper bound, or is empty where it has
                   none; a yes, or a count, is only what is certain.  ``error`` is high - low
    raises       : ValueError for an unknown model, parameter or fidelity, and for a value outside its limits
    """
    import pandas as pd

    table = answer(
        model,
        motion,
        fidelity=fidelity,
        angle=angle,
        tail=tail,
        azimuth_step=azimuth_step,
        tolerance=tolerance,
        charts=charts,
        **parameters,
    )
    return pd.DataFrame(table)


def answer(
    model: str,
    motion: Motion,
    *,
    fidelity: str = "history",
    angle: float | None = 0.0,
    tail: float | None = None,
    azimuth_step: float = AZIMUTH_STEP,
    tolerance: float = TOLERANCE,
    charts: Shelf = SHELF,
    **parameters: Any,
) -> Answer:
    """Return the table of ``respond`` as columns, for a caller that does not wait for pandas.

    returns : the columns, (n,) each, by name and in the table's order
    raises  : as ``respond``
    """
    row = model_named(model)
    if fidelity not in FIDELITIES:
        raise InputError(f"there is no fidelity {fidelity!r}; choose from {', '.join(FIDELITIES)}")
    values = prepare(row, parameters)
    if fidelity == "chart":
        columns, angles, looked = run_chart(row, motion, values, angle, tail, azimuth_step, tolerance, charts)
        came = ["chart" if found else "history" for found in looked]
    else:
        columns, angles = run_model(row, motion, values, fidelity, angle, tail, azimuth_step)
        came = [fidelity] * angles.size
    table: Answer = {q.name: _typed(q, columns[q.name]) for q in row.gives}
    table["error"] = columns["error"]
    table["fidelity"] = came
    table["note"] = [words(bits) for bits in columns["note"]]
    table["angle"] = angles
    if fidelity == "bound":
        table["low"], table["high"] = columns["low"], columns["high"]
    return table


def _typed(quantity: Quantity, values: Array) -> Any:
    if quantity.unit == "bool":
        return values.astype(bool)
    return values.astype(np.int64) if quantity.unit == "count" else values


class Parametric(Protocol):
    """What has a name and takes parameters: a model or a support."""

    @property
    def name(self) -> str:
        """As the registry calls it."""
        ...

    @property
    def needs(self) -> tuple[Quantity, ...]:
        """Its parameters."""
        ...


def prepare(model: Parametric, parameters: Mapping[str, Any]) -> dict[str, Array]:
    """Return the model's parameters as float arrays (n,) of one length; what was left out is NaN or its default.

    raises : ValueError for a parameter that is unknown, missing, not a number, outside its limits, or of another length
    """
    known = {q.name: q for q in model.needs}
    for name in parameters:
        if name not in known:
            close = get_close_matches(name, known, n=1)
            hint = f"; did you mean {close[0]!r}?" if close else "."
            raise InputError(f"{model.name} has no parameter {name!r}{hint} It takes: {', '.join(known)}")
    arrays: dict[str, Array] = {}
    for name, quantity in known.items():
        value = parameters.get(name)
        if value is None:
            if not quantity.optional:
                raise InputError(f"{model.name} needs {name} [{quantity.unit}]: {quantity.meaning}")
            arrays[name] = np.array(np.nan if quantity.default is None else quantity.default)
            continue
        array = real_array(value)
        if array is None:
            raise InputError(f"{name} must be {quantity.allowed()}, not {value!r}")
        if array.size == 0:
            raise InputError(f"{name} is empty: give at least one value")
        if array.ndim > 1:
            raise InputError(f"{name} must be a number or one row of numbers, not an array of shape {array.shape}")
        quantity.check(np.atleast_1d(array))
        arrays[name] = array
    try:
        full = np.broadcast_arrays(*(np.atleast_1d(a) for a in arrays.values()))
    except ValueError as problem:
        sizes = ", ".join(f"{n}: {np.size(a)}" for n, a in arrays.items())
        raise InputError(f"the parameters of {model.name} have different lengths ({sizes})") from problem
    return {name: np.ascontiguousarray(a) for name, a in zip(arrays, full, strict=True)}


def run_model(
    model: Model,
    motion: Motion,
    values: Mapping[str, Array],
    fidelity: str,
    angle: float | None,
    tail: float | None,
    azimuth_step: float = AZIMUTH_STEP,
) -> tuple[Columns, Array]:
    """Run a model on prepared parameters and return its columns and the angle (n,) of each row (NaN: two directions).

    raises : ValueError for a bad tail or azimuth step, mixed `directions`, or a model without the fidelity asked
    """
    angle, tail, azimuth_step = checked(angle, tail, azimuth_step)
    size = next(iter(values.values())).size
    directions = _directions(model, values)
    if fidelity in ("screen", "bound"):
        way = None if directions == 2 else angle
        closed = _screened if fidelity == "screen" else _bounded
        return closed(model, motion.excitation(way, tail), values), np.full(size, np.nan if way is None else way)
    refine = REFINE[fidelity]
    if directions == 2:
        return model.run(motion.excitation(None, tail), values, refine, True), np.full(size, np.nan)
    if angle is not None:
        return model.run(motion.excitation(angle, tail), values, refine, True), np.full(size, angle)
    return worst_direction(model, motion, values, refine, tail, azimuth_step)


def run_chart(
    model: Model,
    motion: Motion,
    values: Mapping[str, Array],
    angle: float | None,
    tail: float | None,
    azimuth_step: float = AZIMUTH_STEP,
    tolerance: float = TOLERANCE,
    charts: Shelf = SHELF,
) -> tuple[Columns, Array, NDArray[np.bool_]]:
    """Look prepared parameters up in charts, as ``run_model``; what is on none of them is integrated at `history`.

    returns : columns, angles, and which rows (n,) came from a chart
    raises  : ValueError as ``run_model``, for a bad tolerance, and for a model that is never tabulated
    """
    found = look_up(model, motion, values, angle, tail, azimuth_step, tolerance, charts)
    columns, looked = found.columns, found.found
    angles = np.full(looked.size, np.nan if angle is None or _directions(model, values) == 2 else angle)
    rest = ~looked
    if rest.any():
        others = {name: column[rest] for name, column in values.items()}
        integrated, angles[rest] = run_model(model, motion, others, "history", angle, tail, azimuth_step)
        for name in columns:
            columns[name][rest] = integrated[name]
    return columns, angles, looked


def look_up(
    model: Model,
    motion: Motion,
    values: Mapping[str, Array],
    angle: float | None,
    tail: float | None,
    azimuth_step: float = AZIMUTH_STEP,
    tolerance: float = TOLERANCE,
    charts: Shelf = SHELF,
    least: int = 0,
    *,
    first: bool = False,
) -> Tabulated:
    """Look prepared parameters up in charts, building those that are missing; what is on none of them is left open.

    least  : how many sets must ask for a chart that is not on the shelf before it is built
    first  : whether the tolerance is that of the first output alone; the others are NaN
    raises : as ``run_chart``
    """
    run, settings = _charted(model, motion, values, angle, tail, azimuth_step, tolerance)
    return tabulate(model, motion, values, run, replace(settings, first=first), charts, least)


def deciding(model: str) -> dict[str, Any]:
    """Return how charts for verdicts are made, whoever builds one or looks it up: else it would be another chart.

    raises : ValueError for a model that is never tabulated
    """
    return {"tolerance": DECIDES, "first": axis_of(model_named(model)).leads}


def response_chart(
    model: str,
    motion: Motion,
    *,
    angle: float | None = None,
    azimuth_step: float = AZIMUTH_STEP,
    tolerance: float = TOLERANCE,
    low: float | None = None,
    first: bool = False,
    charts: Shelf = SHELF,
    **fixed: Any,
) -> ResponseChart:
    """Return a model's response chart under a motion, from the shelf or built.

    angle  : as in ``respond``
    low    : where the chart begins; None: as the model says
    first  : whether the tolerance is that of the first output alone, as for a picture of it
    fixed  : the model's parameters besides that of the chart's axis, single numbers
    raises : ValueError as ``respond``, and for a model that is never tabulated
    """
    row = model_named(model)
    axis = axis_of(row)
    if low is not None:
        begin = real_number(low)
        if not 0.0 < begin < axis.high:
            raise InputError(f"low must be a number above 0 and below {axis.high:g}, where the chart ends, not {low!r}")
        low = begin
    values = prepare(row, {**fixed, axis.name: axis.low})
    run, settings = _charted(row, motion, values, angle, None, azimuth_step, tolerance)
    others = {name: column[0] for name, column in values.items() if name != axis.name}
    return chart_of(row, motion, others, run, replace(settings, low=low, first=first), charts)


def _charted(
    model: Model,
    motion: Motion,
    values: Mapping[str, Array],
    angle: float | None,
    tail: float | None,
    azimuth_step: float,
    tolerance: float,
) -> tuple[Run, Settings]:
    """Return how the nodes of a chart are run, and what the chart depends on besides model and motion."""
    angle, tail, azimuth_step = checked(angle, tail, azimuth_step)
    both = _directions(model, values) == 2

    def run(some: Mapping[str, Array]) -> Columns:
        return run_model(model, motion, some, "history", angle, tail, azimuth_step)[0]

    return run, Settings(None if both else angle, both, tail, azimuth_step, REFINE["history"], tolerance)


def _directions(model: Model, values: Mapping[str, Array]) -> int:
    if model.directions != 0:
        return model.directions
    asked = np.unique(values["directions"])
    if asked.size > 1 or asked[0] not in (1.0, 2.0):
        raise InputError(f"directions must be 1 or 2 for all rows, not {asked.tolist()}")
    return int(asked[0])


def _screened(model: Model, motion: Excitation, values: Mapping[str, Array]) -> Columns:
    if model.screen is None:
        raise InputError(f"the paper gives no closed-form criterion for {model.name}; ask for history")
    return model.screen(motion, values)


def _bounded(model: Model, motion: Excitation, values: Mapping[str, Array]) -> Columns:
    if model.bound is None:
        others = ", ".join(m.name for m in MODELS if m.bound is not None)
        raise InputError(f"{model.name} has no guaranteed bounds; ask for history (bounds have: {others})")
    bounds = model.bound(motion, values)
    low, high = bounds.outputs[model.gives[0].name]
    columns: Columns = {}
    for quantity in model.gives:
        certain, most = bounds.outputs.get(quantity.name, (np.zeros_like(low), np.full_like(low, np.nan)))
        columns[quantity.name] = certain if quantity.unit in ("bool", "count") else most
    error = np.subtract(high, low, out=np.zeros_like(low), where=high > low)
    return columns | {"low": low, "high": high, "error": error, "note": bounds.note + BOUND}


def trace(model: str, motion: Motion, *, angle: float = 0.0, **parameters: Any) -> "pd.DataFrame":
    """Return the time history of one object: t [s] and the model's own columns, one row a sample.

    raises : ValueError as ``respond``, and for a model without a history (stress) or more than one parameter set
    """
    import pandas as pd

    row = model_named(model)
    if row.trace is None:
        raise InputError(f"{model} has no time history of its own; ask for the oscillator's")
    angle = finite_angle(angle)
    one = _single(row, parameters, "trace follows one object at a time")
    two = row.directions == 2 or (row.directions == 0 and one["directions"] == 2.0)
    columns = row.trace(motion.excitation(None if two else angle, 0.0), one)
    return pd.DataFrame({"t": motion.dt * np.arange(motion.samples), **columns})


def transmit(
    support: str, motion: Motion, *, refine: int | None = None, error: float = TRANSMITTED, **parameters: Any
) -> Motion:
    """Return the motion that a support passes on to what stands on it.

    support    : a name of ``pipeline.supports.SUPPORTS``
    refine     : samples of the output for each of the input; None: as many as the error asks for.  The input is a
                 polygon, so more samples add nothing to it, but what stick and slip pass on jumps between them
    error      : largest error of the displacement of an oscillator of 2 to 20 Hz and 5 % damping on the support, as a
                 share of its peak; what is reached stands in the last of the motion's steps
    raises     : ValueError for an unknown support or parameter, and for an error that is not above 0
    A floor by its factor is exact on the samples of its input, so that no error is asked of it.
    """
    row = support_named(support)
    values = _single(row, parameters, "transmit passes a motion through one support")
    if values.get("directions", 2.0) != 2.0:
        raise InputError("transmit passes both horizontal directions on; leave directions out")
    error = some_error(error)
    if refine is not None and not (real_number(refine) >= 1.0 and real_number(refine).is_integer()):
        raise InputError(f"refine must be at least 1, not {refine!r}; a whole number, or None for as many as it takes")
    if refine is not None or not row.refines(values):
        return row.transmit(motion, values, 1 if refine is None else int(refine))
    return refined(lambda samples: row.transmit(motion, values, samples), error)


def cascade(chain: Sequence[tuple[str, Mapping[str, Any]]], motion: Motion, *, error: float = TRANSMITTED) -> Motion:
    """Return the motion on top of a chain of supports, the error shared out equally between them.

    chain  : (support, its parameters) from the ground up; empty: the motion itself
    error  : as in `transmit`, of all of them together
    raises : ValueError as `transmit`
    """
    error = some_error(error)
    for support, parameters in chain:
        motion = transmit(support, motion, error=error / len(chain), **parameters)
    return motion


def _single(model: Parametric, parameters: Mapping[str, Any], why: str) -> dict[str, float]:
    values = prepare(model, parameters)
    if any(column.size > 1 for column in values.values()):
        raise InputError(f"{why}; give single numbers")
    return {name: float(column[0]) for name, column in values.items()}
