"""A whole run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pipeline.records.decision import DecisionStatus
from pipeline.records.measurement_request import MeasurementRequest
from pipeline.records.motion import MotionSummary
from pipeline.records.picture import Chart
from pipeline.records.result import Assessment, Spacing


@dataclass(frozen=True, slots=True)
class RunRecord:
    """A whole run, as the store gives it back: all that the reports need, and nothing is computed again.

    Attributes
    ----------
    run_id : str
        Its name.
    started, finished : str
        ISO 8601.
    version : str
        Of the code.
    site, museum : str
        As the settings name them.
    level_notes : tuple of str
        What a reader should know of the levels of shaking.
    settings : mapping
        Those it was run with.
    assessments : tuple of Assessment
        One for each object.
    charts : mapping of str to Chart
        By key.
    motions : tuple of MotionSummary
        Of all levels and floors.
    demonstration : bool
        Whether it is of the bundled collection.
    decisions : tuple of DecisionStatus
        Those in force about its objects, and about objects that the inventory has no more.
    wishes : tuple of MeasurementRequest or None
        What is worth measuring, what settles most first; None where the run did not ask.
    spacings : tuple of Spacing
        Of the neighbours in the galleries whose places are known.
    """

    run_id: str
    started: str
    finished: str
    version: str
    site: str
    museum: str
    level_notes: tuple[str, ...]
    settings: Mapping[str, Any]
    assessments: tuple[Assessment, ...]
    charts: Mapping[str, Chart]
    motions: tuple[MotionSummary, ...]
    demonstration: bool = False
    decisions: tuple[DecisionStatus, ...] = ()
    wishes: tuple[MeasurementRequest, ...] | None = None
    spacings: tuple[Spacing, ...] = ()
