"""Response charts: a model's response under one motion, tabulated along one of its parameters, with error bounds."""

from pipeline.charting.grouping import Settings, Tabulated, chart_of, tabulate
from pipeline.charting.histories import prune as prune_histories
from pipeline.charting.keeping import ChartWarning, code_version
from pipeline.charting.response_chart import Looked, ResponseChart, Run, axis_of
from pipeline.charting.shelf import SHELF, Shelf

__all__ = [
    "SHELF",
    "ChartWarning",
    "Looked",
    "ResponseChart",
    "Run",
    "Settings",
    "Shelf",
    "Tabulated",
    "axis_of",
    "chart_of",
    "code_version",
    "prune_histories",
    "tabulate",
]
