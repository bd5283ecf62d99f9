"""The nouns that every floor shares: motions, items, scenes, models, findings, decisions, runs and their changes."""

from pipeline.records.change import (
    Cause,
    CauseKind,
    DecisionChange,
    FieldChange,
    InputChange,
    MotionChange,
    Move,
    ObjectPlace,
    RunChanges,
    VerdictChange,
)
from pipeline.records.contact_polygon import ContactPolygon
from pipeline.records.decision import Basis, Decision, DecisionKind, DecisionStatus, in_force
from pipeline.records.fragility import Fragility
from pipeline.records.likelihood import Band, Harm, IfClass, Likelihood, Sampling
from pipeline.records.measurement_request import MeasurementRequest
from pipeline.records.model import Bounds, ChartAxis, ChartFigure, Columns, Figure, Model, Trials
from pipeline.records.motion import Excitation, Motion, MotionSummary
from pipeline.records.news import Brief, NewsKind, ObjectChange, Ruled, Settled
from pipeline.records.numerics import Numerics
from pipeline.records.part import Errors, Found, Outline, Page, Result, Tally, Urgency, Urgent
from pipeline.records.photo import Photo
from pipeline.records.picture import Axis, Chart, Curve, Mark, Zone
from pipeline.records.protocols import Executor, Progress, Silent
from pipeline.records.reading import Account, Doubt
from pipeline.records.result import Assessment, Check, Finding, Recommendation, Spacing, Verdict
from pipeline.records.run import RunRecord
from pipeline.records.scene import (
    ITEM_FIELDS,
    SECTION_SHAPES,
    Anchorage,
    Estimate,
    Furniture,
    Hanging,
    Item,
    Mount,
    Origin,
    Problem,
    Provenance,
    Scene,
    Support,
    times_too_thin,
    too_thin,
)
from pipeline.records.state import State, standing, state_of

__all__ = [
    "ITEM_FIELDS",
    "SECTION_SHAPES",
    "Account",
    "Anchorage",
    "Assessment",
    "Axis",
    "Band",
    "Basis",
    "Bounds",
    "Brief",
    "Cause",
    "CauseKind",
    "Chart",
    "ChartAxis",
    "ChartFigure",
    "Check",
    "Columns",
    "ContactPolygon",
    "Curve",
    "Decision",
    "DecisionChange",
    "DecisionKind",
    "DecisionStatus",
    "Doubt",
    "Errors",
    "Estimate",
    "Excitation",
    "Executor",
    "FieldChange",
    "Figure",
    "Finding",
    "Found",
    "Fragility",
    "Furniture",
    "Hanging",
    "Harm",
    "IfClass",
    "InputChange",
    "Item",
    "Likelihood",
    "Mark",
    "MeasurementRequest",
    "Model",
    "Motion",
    "MotionChange",
    "MotionSummary",
    "Mount",
    "Move",
    "NewsKind",
    "Numerics",
    "ObjectChange",
    "ObjectPlace",
    "Origin",
    "Outline",
    "Page",
    "Photo",
    "Problem",
    "Progress",
    "Provenance",
    "Recommendation",
    "Result",
    "Ruled",
    "RunChanges",
    "RunRecord",
    "Sampling",
    "Scene",
    "Settled",
    "Silent",
    "Spacing",
    "State",
    "Support",
    "Tally",
    "Trials",
    "Urgency",
    "Urgent",
    "Verdict",
    "VerdictChange",
    "Zone",
    "in_force",
    "standing",
    "state_of",
    "times_too_thin",
    "too_thin",
]
