"""Findings -> changed chains, run again -> recommendations: the least intrusive measure that passes."""

from pipeline.mitigate.advise import advise

__all__ = ["advise"]
