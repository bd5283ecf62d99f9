"""Findings -> changed chains, run again -> recommendations: the least intrusive measure that passes."""

from pipeline.mitigate.catalogue import MeasureCatalogue, changed, measure_catalogue
from pipeline.mitigate.search import advise

__all__ = ["MeasureCatalogue", "advise", "changed", "measure_catalogue"]
