"""Response charts: a model's response under one motion, tabulated along one of its parameters, with error bounds."""

from pipeline.analysis.response_charts.charts import PROCESS_CHARTS, ChartCache
from pipeline.analysis.response_charts.grouping import ChartSettings, Tabulated, chart_of, tabulate
from pipeline.analysis.response_charts.response_chart import SAFETY, Looked, ResponseChart, Run, axis_of

__all__ = [
    "PROCESS_CHARTS",
    "SAFETY",
    "ChartCache",
    "ChartSettings",
    "Looked",
    "ResponseChart",
    "Run",
    "Tabulated",
    "axis_of",
    "chart_of",
    "tabulate",
]
