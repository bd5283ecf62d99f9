"""The pictures of one motion: those that the models draw, and pictures of their response charts.

Of Kouros's own models these are the paper's Figures 2 to 6 and response spectra.
"""

import hashlib
from collections.abc import Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from pipeline.analysis.response import AZIMUTH_STEP, deciding, response_chart
from pipeline.analysis.response_charts import ResponseChart, Shelf, code_version
from pipeline.models import MODELS
from pipeline.models.common import curve, rounded
from pipeline.records import Chart, ChartFigure, Curve, Executor, Figure, Model, Motion

PICTURED = 2e-2
"""Tolerance of the response charts that are made for a picture: half of it, its error as a rule, is a line's width.

It is that of the output which is drawn.  That of the others, the windings of a swing without damping above all, took
two thirds of the analyses and changed nothing that can be seen.
"""

SMOOTH = 240
"""Points of a curve between the nodes of its chart, so that it is drawn as the chart is read."""


def chart_key(kind: str, motion: Motion) -> str:
    """Return the identity of a motion's picture, which marks refer to."""
    return f"{kind}:{motion.hash[:16]}"


def chart_keys(motion: Motion) -> list[str]:
    """Return the identities of all pictures of a motion."""
    return [chart_key(figure.kind, motion) for model in MODELS for figure in model.pictures]


@cache
def picture_version() -> str:
    """Return the version of the kernels and of all code that a picture depends on besides its motion."""
    return f"{code_version()}-{hashlib.sha256(Path(__file__).read_bytes()).hexdigest()[:12]}"


def charts(motion: Motion, executor: Executor, shelf: Shelf) -> dict[str, Chart]:
    """Return all pictures of a motion.

    Parameters
    ----------
    motion : Motion
        What shakes.
    executor : Executor
        On which the charts are made.
    shelf : Shelf
        Where the response charts are found and kept that some are pictures of.

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
    executor.map(lambda one: _made(*one, motion, shelf), curves)
    made = executor.map(lambda one: _drawn(*one, motion, shelf), figures)
    return {chart.key: chart for chart in made}


def _drawn(model: Model, figure: Figure | ChartFigure, motion: Motion, shelf: Shelf) -> Chart:
    key = chart_key(figure.kind, motion)
    if isinstance(figure, Figure):
        return figure.draw(key, motion)
    made = {label: _made(model, figure, fixed, motion, shelf) for label, fixed in figure.curves.items()}
    return Chart(
        key,
        figure.title,
        f"{figure.caption} {_told(made)}",
        figure.x,
        figure.y,
        tuple(_pictured(one, label) for label, one in made.items()),
        source=figure.source,
    )


def _made(model: Model, figure: ChartFigure, fixed: Mapping[str, float], motion: Motion, shelf: Shelf) -> ResponseChart:
    how: dict[str, Any] = deciding(model.name) if figure.decides else {"tolerance": PICTURED, "first": True}
    step = AZIMUTH_STEP if figure.azimuth_step is None else figure.azimuth_step
    return response_chart(model.name, motion, azimuth_step=step, low=figure.low, charts=shelf, **{**how, **fixed})


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
        f"{100.0 * one.worst(one.outputs[0]):.2g} %" + (f" ({label})" if label else "") for label, one in made.items()
    ]
    return (
        f"Drawn from {count:,} analyses, closest together where the response turns. Error measured at points held out: "
        f"at most {', '.join(errors)} of the value, or of a hundredth of the largest value where that is more."
    )
