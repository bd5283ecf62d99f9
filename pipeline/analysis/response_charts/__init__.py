"""Response charts: a model's response under one motion, tabulated along one of its parameters, with error bounds."""

from pipeline.analysis.response_charts.grouping import Settings, Tabulated, chart_of, tabulate
from pipeline.analysis.response_charts.response_chart import Looked, ResponseChart, Run, axis_of
from pipeline.analysis.response_charts.shelf import SHELF, Shelf

__all__ = [
    "SHELF",
    "Looked",
    "ResponseChart",
    "Run",
    "Settings",
    "Shelf",
    "Tabulated",
    "axis_of",
    "chart_of",
    "tabulate",
]
