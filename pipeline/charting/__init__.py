"""Response charts: a model's response under one motion, tabulated along one of its parameters, with error bounds."""

from pipeline.charting.grouping import Settings, tabulate
from pipeline.charting.response_chart import Looked, ResponseChart
from pipeline.charting.shelf import SHELF, Shelf

__all__ = ["SHELF", "Looked", "ResponseChart", "Settings", "Shelf", "tabulate"]
