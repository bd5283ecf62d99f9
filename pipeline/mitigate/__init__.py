"""Findings -> changed chains, run again -> recommendations: the least intrusive measure that passes."""

from pipeline.mitigate.advise import advise
from pipeline.mitigate.changes import changed
from pipeline.mitigate.means import Means, means

__all__ = ["Means", "advise", "changed", "means"]
