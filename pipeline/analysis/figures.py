"""The pictures of one motion: those that the models draw, and pictures of their response charts.

Of Kouros's own models these are the paper's Figures 2 to 6 and response spectra.
"""

from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from pipeline.analysis.chart_runs import deciding, response_chart
from pipeline.analysis.context import Context
from pipeline.analysis.response_charts import SAFETY, ChartCache, ResponseChart
from pipeline.models import MODELS
from pipeline.models.common import curve, rounded
from pipeline.records import Chart, ChartFigure, Curve, Figure, Model, Motion, Numerics
from pipeline.records import picture as on_chart
from pipeline.records.numerics import SCAN

PICTURED = 2e-2
"""Error that the response charts of a picture may have at points held out: a quarter of it, which it is as a rule once
these are nodes, is less than a line's width.

It is that of the output which is drawn.  That of the others, the windings of a swing without damping above all, took
two thirds of the analyses and changed nothing that can be seen.  The coarsest step that they are integrated by is off
by 0.2 % at most.
"""

SMOOTH = 240
"""Points of a curve between the nodes of its chart, so that it is drawn as the chart is read."""


def chart_key(kind: str, motion: Motion) -> str:
    """Return the identity of a motion's picture, which marks refer to."""
    return f"{kind}:{motion.hash[:16]}"


def chart_keys(motion: Motion) -> list[str]:
    """Return the identities of all pictures of a motion."""
    return [chart_key(figure.kind, motion) for model in MODELS for figure in model.pictures]


def draw(motion: Motion, context: Context) -> dict[str, Chart]:
    """Return all pictures of a motion.

    Parameters
    ----------
    motion : Motion
        What shakes.
    context : Context
        Where it runs, and where the response charts are found and kept that some are pictures of.

    Returns
    -------
    dict of str to Chart
        By key, in the order of `chart_keys`.
    """
    figures = [(model, figure) for model in MODELS for figure in model.pictures]
    # Each chart is a piece of work of its own: a picture of four would leave the other cores waiting.
    curves = [
        (model, figure, fixed)
        for model, figure in figures
        if isinstance(figure, ChartFigure)
        for fixed in figure.curves.values()
    ]
    context.executor.map(lambda one: _made(*one, motion, context.charts), curves)
    made = context.executor.map(lambda one: _drawn(*one, motion, context.charts), figures)
    return {chart.key: chart for chart in made}


def _drawn(model: Model, figure: Figure | ChartFigure, motion: Motion, charts: ChartCache) -> Chart:
    key = chart_key(figure.kind, motion)
    if isinstance(figure, Figure):
        return figure.draw(key, motion)
    made = {label: _made(model, figure, fixed, motion, charts) for label, fixed in figure.curves.items()}
    return Chart(
        key,
        figure.title,
        f"{figure.caption} {_told(made)}",
        figure.x,
        figure.y,
        tuple(_pictured(one, label) for label, one in made.items()),
        source=figure.source,
    )


def _made(
    model: Model, figure: ChartFigure, fixed: Mapping[str, float], motion: Motion, charts: ChartCache
) -> ResponseChart:
    numerics = deciding(model.name) if figure.decides else Numerics(SCAN, tolerance=SAFETY * PICTURED, first=True)
    if figure.azimuth_step is not None:
        numerics = replace(numerics, azimuth_step=figure.azimuth_step)
    return response_chart(model.name, motion, numerics=numerics, low=figure.low, charts=charts, **fixed)


def _pictured(made: ResponseChart, label: str) -> Curve:
    """Return the curve of a response chart's first output: through its nodes, read between them as a lookup reads."""
    along = np.concatenate([made.nodes, np.geomspace(made.low, made.high, SMOOTH)])
    if made.settled < made.axis.high:
        along = np.append(along, made.axis.high)
    # Read where the rounded points stand: next to a kink the chart's nodes are nearer than five digits tell apart.
    along = np.unique([rounded(value) for value in along])
    return curve(label, along, made.look(along).columns[made.outputs[0]])


def _told(made: Mapping[str, ResponseChart]) -> str:
    """Say of the curves of a picture what they are made of and how far off they may be."""
    count = sum(one.cells.nodes for one in made.values())
    errors = [
        f"{100.0 * one.worst(one.outputs[0]) / SAFETY:.2g} %" + (f" ({label})" if label else "")
        for label, one in made.items()
    ]
    return on_chart.DRAWN_FROM(count=f"{count:,}", errors=", ".join(errors))
