"""One model, one motion, many parameter sets, one fidelity: the table that `respond` gives."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.chart_runs import run_chart
from pipeline.analysis.model_runs import prepare, run_model, single
from pipeline.analysis.response_charts import PROCESS_CHARTS, ChartCache
from pipeline.errors import InputError
from pipeline.models import model_named
from pipeline.models.common import words
from pipeline.quantities import Array, Quantity, finite_angle
from pipeline.records import Motion, Numerics
from pipeline.records.numerics import AZIMUTH_STEP, TOLERANCE

if TYPE_CHECKING:
    import pandas as pd

FIDELITIES = ("screen", "bound", "chart", "history", "reference")
"""What ``respond`` can be asked for: closed-form screens, guaranteed bounds, charts, histories, tight tolerances."""

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
    charts: ChartCache = PROCESS_CHARTS,
    **parameters: Any,
) -> "pd.DataFrame":
    """Run one generic model under one motion for many objects at once.

    Parameters
    ----------
    model
        A name of ``kouros models``.
    motion
        What shakes the objects.
    fidelity
        One of `FIDELITIES`.
    angle
        Degrees from x towards y along which a one-direction model is shaken; None means RotD100: the row of the
        direction with the largest first output, every ``azimuth_step`` degrees.
    tail
        Seconds of rest after the record; None means until rest or past the peak, with the cap of the model.
    azimuth_step
        Degrees between those directions, above 0 and at most 90.
    tolerance
        Of a chart's interpolation, relative to max(value, 1 % of the largest value on the chart).
    charts
        Where charts are found and kept; of this process where none is given.
    **parameters
        The model's own, in SI: numbers, or arrays (n,), broadcast against each other.

    Returns
    -------
    pandas.DataFrame
        One row a parameter set: the model's outputs, ``error`` (estimated, in the unit of the first output),
        ``fidelity``, ``note``, and ``angle`` (degrees, the direction of the row; empty for two directions, and for a
        worst direction from a chart or of dynamic stress, which looks for no angle). Where a chart was asked for,
        ``fidelity`` says of each row whether it came from one: what lies outside of it, or where it is not good enough,
        is integrated. At fidelity "bound" ``low`` and ``high`` follow, between which the first output lies for certain
        (in any direction where the angle is None). Each output holds its upper bound then, or is empty where it has
        none; a yes, or a count, is only what is certain, and ``error`` is high - low. The parameters come last, a
        column each, those included that were left out and have a value by default. ``attrs`` holds "model",
        "motion" (its name), "motion_hash" and "units": the unit of each column that has one, "-" for a ratio.

    Raises
    ------
    InputError
        For an unknown model, parameter or fidelity, and for a value outside its limits; it is a ValueError.

    References
    ----------
    Boore (2010), "Orientation-independent, nongeometric-mean measures of seismic intensity from two horizontal
    components of motion", Bulletin of the Seismological Society of America 100(4): RotD100.
    """
    import pandas as pd

    numerics = Numerics(fidelity, azimuth_step, tolerance)
    found = answer(model, motion, parameters, numerics, angle=angle, tail=tail, charts=charts)
    row = model_named(model)
    # NaN throughout is a parameter that is left out.
    used = {name: values for name, values in prepare(row, parameters).items() if not np.isnan(values).all()}
    table = pd.DataFrame({**found, **used})
    units = {q.name: q.unit for q in (*row.gives, *row.needs) if q.name in table}
    first = row.gives[0].unit
    units |= {name: first for name in ("error", "low", "high") if name in table} | {"angle": "degree"}
    table.attrs.update({**_told(model, motion), "units": units})
    return table


def _told(model: str, motion: Motion) -> dict[str, str]:
    return {"model": model, "motion": motion.name, "motion_hash": motion.hash}


def answer(
    model: str,
    motion: Motion,
    parameters: Mapping[str, Any],
    numerics: Numerics,
    *,
    angle: float | None = 0.0,
    tail: float | None = None,
    charts: ChartCache = PROCESS_CHARTS,
) -> Answer:
    """Return the table of `respond` as columns, for a caller that does not wait for pandas.

    Parameters
    ----------
    model, motion, angle, tail, charts
        As in `respond`.
    parameters
        The model's own by name, in SI: numbers, or arrays (n,), broadcast against each other.
    numerics
        Fidelity, step between directions and tolerance, as in `respond`.

    Returns
    -------
    dict of str to ndarray or list of str
        The columns, (n,) each, by name and in the table's order.

    Raises
    ------
    InputError
        As `respond`.
    """
    row = model_named(model)
    fidelity = numerics.fidelity
    if fidelity not in FIDELITIES:
        raise InputError(f"there is no fidelity {fidelity!r}; choose from {', '.join(FIDELITIES)}")
    values = prepare(row, parameters)
    if fidelity == "chart":
        columns, angles, looked = run_chart(row, motion, values, numerics, angle, tail, charts)
        came = ["chart" if found else "history" for found in looked]
    else:
        columns, angles = run_model(row, motion, values, numerics, angle, tail)
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


def trace(model: str, motion: Motion, *, angle: float = 0.0, **parameters: Any) -> "pd.DataFrame":
    """Return the time history of one object.

    Parameters
    ----------
    model
        A name of ``kouros models``.
    motion
        What shakes the object.
    angle
        Degrees from x towards y along which a one-direction model is shaken.
    **parameters
        The model's own, in SI, single numbers.

    Returns
    -------
    pandas.DataFrame
        ``t`` [s] and the model's own columns, one row a sample of the motion.  ``attrs`` holds "model", "motion" (its
        name), "motion_hash" and "parameters" (SI).

    Raises
    ------
    InputError
        As `respond`, and for a model without a history (stress) or more than one parameter set.
    """
    import pandas as pd

    row = model_named(model)
    if row.trace is None:
        raise InputError(f"{model} has no time history of its own; ask for the oscillator's")
    angle = finite_angle(angle)
    one = single(row, parameters, "trace follows one object at a time")
    two = row.directions == 2 or (row.directions == 0 and one["directions"] == 2.0)
    columns = row.trace(motion.excitation(None if two else angle, 0.0), one)
    table = pd.DataFrame({"t": motion.dt * np.arange(motion.samples), **columns})
    table.attrs.update({**_told(model, motion), "parameters": {k: v for k, v in one.items() if not np.isnan(v)}})
    return table
