"""Groups of the rows of a call by the charts in which they are looked up."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.response_charts.charts import ChartCache
from pipeline.analysis.response_charts.response_chart import ResponseChart, Run, axis_of
from pipeline.cache import key_of
from pipeline.errors import InputError
from pipeline.quantities import Array, real_number
from pipeline.records import Columns, Model, Motion, Numerics

MOST_CHARTS = 16
"""Charts built for one call: where the fixed parameters take more combinations, the rarer ones are integrated.

Two axes at once do not pay: for swinging, length by damping, cells of two dimensions take 26,000 analyses for 1 % in
one direction and more than 40,000 for 0.1 %, because kinks run slantwise through them; one chart takes 1,500.
"""


@dataclass(frozen=True)
class ChartSettings:
    """What a chart depends on besides its model, its motion and the parameters.

    Attributes
    ----------
    angle : float or None
        Degrees, None for the worst direction or for a model that is shaken in two.
    both : bool
        Whether the model is shaken in both directions.
    tail : float or None
        s after the record; None: until rest.
    numerics : Numerics
        How finely the nodes are integrated, the step between directions, and the tolerance.
    low : float or None
        Where the axis begins; None: as the model says.

    Raises
    ------
    InputError
        For a tolerance that makes no sense.
    """

    angle: float | None
    both: bool
    tail: float | None
    numerics: Numerics
    low: float | None = None

    def __post_init__(self) -> None:
        tolerance = self.numerics.tolerance
        if not 1e-6 <= real_number(tolerance) <= 1.0:
            raise InputError(f"tolerance must be from 1e-6 to 1 of the value, not {tolerance!r}")


@dataclass(frozen=True)
class Tabulated:
    """Rows looked up in charts, (n,) each.

    Attributes
    ----------
    columns : Columns
        The outputs, "error" (of the first output) and "note"; outputs that a chart does not follow are NaN.
    bounds : Columns
        By how much each output may be wrong; of the first it is the error.
    found : NDArray[np.bool_]
        Which rows were looked up.  The others are NaN and are to be integrated: they lie outside of the chart, have a
        parameter that no chart has, or lie where the chart did not reach the tolerance.
    """

    columns: Columns
    bounds: Columns
    found: NDArray[np.bool_]


def tabulate(
    model: Model,
    motion: Motion,
    values: Mapping[str, Array],
    run: Run,
    settings: ChartSettings,
    charts: ChartCache,
    least: int = 0,
) -> Tabulated:
    """Look rows up in the charts of a model under a motion, building those that are missing.

    Parameters
    ----------
    model, motion
        The model, and what shakes it.
    values
        The model's parameters, (n,) each.
    run
        The model under the motion, with the settings, for parameters of its own.
    settings
        What the charts depend on besides.
    charts
        Where charts are found and kept.
    least
        How many sets must ask for a chart that is not there yet before it is built.

    Returns
    -------
    Tabulated
        Row for row of the values.

    Raises
    ------
    InputError
        For a model that is never tabulated.
    """
    axis = axis_of(model)
    along = values[axis.name]
    outputs = [q.name for q in model.gives]
    columns: Columns = {name: np.full(along.size, np.nan) for name in (*outputs, "error", "note")}
    bounds: Columns = {name: np.full(along.size, np.nan) for name in outputs}
    found = np.zeros(along.size, dtype=bool)
    for alike, rows in groups(model, values):
        if least:
            key = _identity(model, motion, alike, settings)
            if not charts.pays(group_name(model, settings.angle, alike), key, axis, rows.size, least):
                continue
        chart = chart_of(model, motion, alike, run, settings, charts)
        inside = rows[chart.covers(along[rows])]
        looked = chart.look(along[inside])
        good = looked.resolved
        at = inside[good]
        found[at] = True
        for name in chart.outputs[: 1 if settings.numerics.first else None]:
            columns[name][at] = looked.columns[name][good]
            bounds[name][at] = looked.bounds[name][good]
        bounds[chart.outputs[0]][at] += looked.own[good]
        columns["error"][at] = bounds[chart.outputs[0]][at]
        columns["note"][at] = looked.note[good]
    return Tabulated(columns, bounds, found)


def groups(model: Model, values: Mapping[str, Array]) -> list[tuple[dict[str, float], NDArray[np.intp]]]:
    """Return the rows that one chart could serve, with the parameters that they share, the largest groups first.

    Parameters
    ----------
    model
        The model.
    values
        Its parameters, (n,) each.

    Returns
    -------
    list of (dict of str to float, ndarray of int)
        At most MOST_CHARTS groups: the fixed parameters, and the places (m,) of the rows.

    Raises
    ------
    InputError
        For a model that is never tabulated.
    """
    axis = axis_of(model)
    possible = np.ones(values[axis.name].size, dtype=bool)
    for name in axis.absent:
        possible &= np.isnan(values[name])
    fixed = {q.name: values[q.name] for q in model.needs if q.name != axis.name}
    found = _groups(fixed, np.flatnonzero(possible))
    return [({name: float(column[rows[0]]) for name, column in fixed.items()}, rows) for rows in found]


def group_name(model: Model, angle: float | None, alike: Mapping[str, float]) -> str:
    """Return the name of the rows that one chart could serve, whatever the motion.

    Parameters
    ----------
    model
        The model.
    angle
        Degrees that they are shaken along; None for the worst direction, or for both at once.
    alike
        The parameters that they share.

    Returns
    -------
    str
        The same for the same rows in every process.
    """
    return f"{model.name} {angle} {sorted(alike.items())}"


def _groups(fixed: Mapping[str, Array], rows: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    """Return the rows that share their fixed parameters, the largest groups first, at most MOST_CHARTS."""
    if rows.size == 0:
        return []
    which = np.zeros(rows.size, dtype=np.int64)
    for column in fixed.values():
        # What was left out is left out alike.
        given = np.where(np.isnan(column), np.inf, column)[rows]
        if (given != given[0]).any():
            _, codes = np.unique(given, return_inverse=True)
            _, which = np.unique(which * (codes.max() + 1) + codes, return_inverse=True)
    if not which.any():
        return [rows]
    largest = np.argsort(-np.bincount(which), kind="stable")[:MOST_CHARTS]
    return [rows[which == group] for group in largest]


def chart_of(
    model: Model, motion: Motion, fixed: Mapping[str, float], run: Run, settings: ChartSettings, charts: ChartCache
) -> ResponseChart:
    """Return the chart of a model under a motion, found or built.

    Parameters
    ----------
    model, motion, run, settings, charts
        As in `tabulate`.
    fixed
        The model's parameters besides that of the axis (NaN: left out).

    Returns
    -------
    ResponseChart
        Along the model's axis, or the stretch of it that the settings name.

    Raises
    ------
    InputError
        As `tabulate`.
    """
    axis = axis_of(model)
    if settings.low is not None:
        axis = replace(axis, low=settings.low)
    key = _identity(model, motion, fixed, settings)
    excitation = motion.excitation(None if settings.both else settings.angle, settings.tail)
    tolerance, first = settings.numerics.tolerance, settings.numerics.first
    build = partial(ResponseChart.build, model, axis, excitation, fixed, run, tolerance, first=first)
    return charts.get(key, axis, build)


def _identity(model: Model, motion: Motion, fixed: Mapping[str, float], settings: ChartSettings) -> str:
    worst, numerics = settings.angle is None and not settings.both, settings.numerics
    return key_of(
        motion.hash,
        model.name,
        "both" if settings.both else settings.angle,
        numerics.azimuth_step if worst else None,
        settings.tail,
        numerics.fidelity,
        numerics.tolerance,
        settings.low,
        numerics.first,
        dict(fixed),
        group=motion.hash,
    )
