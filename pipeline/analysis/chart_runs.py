"""One model under one motion, looked up in its response charts; what is on none of them is integrated."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.model_runs import both_ways, prepare, run_model
from pipeline.analysis.response_charts import (
    PROCESS_CHARTS,
    ChartCache,
    ChartSettings,
    ResponseChart,
    Run,
    Tabulated,
    axis_of,
    chart_of,
    tabulate,
)
from pipeline.errors import InputError
from pipeline.models import model_named
from pipeline.quantities import Array, checked, real_number
from pipeline.records import Columns, Model, Motion, Numerics
from pipeline.records.numerics import SCAN, VERDICTS

DECIDES = 1e-2
"""Tolerance of a chart that only has to tell a verdict: what lies closer to its capacity is integrated.

Of real objects with measured parameters less than 1 % do, sliding or swinging in every direction.
"""


def run_chart(
    model: Model,
    motion: Motion,
    values: Mapping[str, Array],
    numerics: Numerics,
    angle: float | None,
    tail: float | None = None,
    charts: ChartCache = PROCESS_CHARTS,
) -> tuple[Columns, Array, NDArray[np.bool_]]:
    """Look prepared parameters up in charts, as `run_model`; what is on none of them is integrated at "history".

    Parameters
    ----------
    model, motion, values, angle, tail
        As in `run_model`.
    numerics
        Tolerance of the charts, and the step between directions; the fidelity has no say.
    charts
        Where charts are found and kept.

    Returns
    -------
    columns : dict of str to ndarray
        The outputs, "error" and "note", (n,) each.
    angles : ndarray
        (n,) degrees; NaN: two directions, or a worst direction from a chart.
    looked : ndarray of bool
        (n,) which rows came from a chart.

    Raises
    ------
    InputError
        As `run_model`, for a bad tolerance, and for a model that is never tabulated.
    """
    run, settings = _charted(model, motion, values, numerics, angle, tail)
    found = tabulate(model, motion, values, run, settings, charts)
    columns, looked = found.columns, found.found
    angles = np.full(looked.size, np.nan if angle is None or both_ways(model, values) else angle)
    rest = ~looked
    if rest.any():
        others = {name: column[rest] for name, column in values.items()}
        integrated, angles[rest] = run_model(model, motion, others, settings.numerics, angle, tail)
        for name in columns:
            columns[name][rest] = integrated[name]
    return columns, angles, looked


def look_up(
    model: Model,
    motion: Motion,
    values: Mapping[str, Array],
    numerics: Numerics,
    angle: float | None,
    charts: ChartCache = PROCESS_CHARTS,
    least: int = 0,
) -> Tabulated:
    """Look prepared parameters up in charts, building those that are missing; what is on none of them is left open.

    Parameters
    ----------
    model, motion, values, numerics, angle, charts
        As in `run_chart`.  Where the tolerance is that of the first output alone, the others are NaN.
    least
        How many parameter sets must ask for a chart that is not there yet before it is built.

    Returns
    -------
    Tabulated
        Row for row of the values.

    Raises
    ------
    InputError
        As `run_chart`.
    """
    run, settings = _charted(model, motion, values, numerics, angle, None)
    return tabulate(model, motion, values, run, settings, charts, least)


def deciding(model: str, numerics: Numerics = VERDICTS) -> Numerics:
    """Return how charts for verdicts are made, whoever builds one or looks it up: else it would be another chart.

    Parameters
    ----------
    model
        Its name.
    numerics
        How verdicts are found.

    Returns
    -------
    Numerics
        The same with the tolerance of such charts.

    Raises
    ------
    InputError
        For a model that is never tabulated.
    """
    return replace(numerics, tolerance=DECIDES, first=axis_of(model_named(model)).leads)


def response_chart(
    model: str,
    motion: Motion,
    *,
    angle: float | None = None,
    numerics: Numerics = VERDICTS,
    low: float | None = None,
    charts: ChartCache = PROCESS_CHARTS,
    **fixed: Any,
) -> ResponseChart:
    """Return a model's response chart under a motion, found or built.

    Parameters
    ----------
    model
        Its name.
    motion
        What shakes it.
    angle
        Degrees from x towards y along which a one-direction model is shaken; None: the worst direction.
    numerics
        Tolerance of the chart, and the step between directions; of the fidelities only "scan" has a say.
    low
        Where the chart begins, in the unit of its axis; None: as the model says.
    charts
        Where charts are found and kept.
    **fixed
        The model's parameters besides that of the chart's axis, single numbers.

    Returns
    -------
    ResponseChart
        All outputs along the axis, with bounds of their errors.

    Raises
    ------
    InputError
        As `respond`, and for a model that is never tabulated.
    """
    row = model_named(model)
    axis = axis_of(row)
    if low is not None:
        begin = real_number(low)
        if not 0.0 < begin < axis.high:
            raise InputError(f"low must be a number above 0 and below {axis.high:g}, where the chart ends, not {low!r}")
        low = begin
    values = prepare(row, {**fixed, axis.name: axis.low})
    run, settings = _charted(row, motion, values, numerics, angle, None)
    others = {name: column[0] for name, column in values.items() if name != axis.name}
    return chart_of(row, motion, others, run, replace(settings, low=low), charts)


def _charted(
    model: Model,
    motion: Motion,
    values: Mapping[str, Array],
    numerics: Numerics,
    angle: float | None,
    tail: float | None,
) -> tuple[Run, ChartSettings]:
    """Return how the nodes of a chart are run, and what the chart depends on besides model and motion."""
    angle, tail, azimuth_step = checked(angle, tail, numerics.azimuth_step)
    both = both_ways(model, values)
    # Whatever the fidelity of what looks it up, a chart is made of histories, unless it is only drawn.
    fidelity = SCAN if numerics.fidelity == SCAN else "history"
    finely = replace(numerics, fidelity=fidelity, azimuth_step=azimuth_step)

    def run(some: Mapping[str, Array]) -> Columns:
        return run_model(model, motion, some, finely, angle, tail)[0]

    return run, ChartSettings(None if both else angle, both, tail, finely)
