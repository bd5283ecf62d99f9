"""Response charts: a model's response under one motion, tabulated along one of its parameters, with error bounds."""

from pipeline.analysis.response_charts.chart_cache import ChartWarning, code_version
from pipeline.analysis.response_charts.grouping import Settings, Tabulated, chart_of, tabulate
from pipeline.analysis.response_charts.histories import prune as prune_histories
from pipeline.analysis.response_charts.response_chart import Looked, ResponseChart, Run, axis_of
from pipeline.analysis.response_charts.shelf import SHELF, Shelf

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
