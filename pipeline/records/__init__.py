"""The nouns that every floor shares: motions, items, scenes, models, findings, recommendations, charts."""

from pipeline.records.model import Bounds, ChartAxis, Columns, Model
from pipeline.records.motion import Excitation, Motion, MotionSummary
from pipeline.records.picture import Axis, Chart, Curve, Mark, Zone
from pipeline.records.protocols import Executor, Progress
from pipeline.records.result import Assessment, Check, Finding, Recommendation, RunRecord, Verdict
from pipeline.records.scene import ITEM_FIELDS, Estimate, Item, Origin, Problem, Provenance, Scene, Support
from pipeline.records.wish import Wish

__all__ = [
    "ITEM_FIELDS",
    "Assessment",
    "Axis",
    "Bounds",
    "Chart",
    "ChartAxis",
    "Check",
    "Columns",
    "Curve",
    "Estimate",
    "Excitation",
    "Executor",
    "Finding",
    "Item",
    "Mark",
    "Model",
    "Motion",
    "MotionSummary",
    "Origin",
    "Problem",
    "Progress",
    "Provenance",
    "Recommendation",
    "RunRecord",
    "Scene",
    "Support",
    "Verdict",
    "Wish",
    "Zone",
]
