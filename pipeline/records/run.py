"""A whole run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from pipeline.records.decision import Standing
from pipeline.records.measurement_request import MeasurementRequest
from pipeline.records.motion import MotionSummary
from pipeline.records.picture import Chart
from pipeline.records.result import Assessment, Spacing


@dataclass(frozen=True, slots=True)
class RunRecord:
    """A whole run, as the store gives it back: all that the reports need, and nothing is computed again.

    decisions : those in force about its objects, and about objects that the inventory has no more
    wishes    : what is worth measuring, what settles most first; None where the run did not ask
    spacings  : of the neighbours in the galleries whose places are known
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
    decisions: tuple[Standing, ...] = ()
    wishes: tuple[MeasurementRequest, ...] | None = None
    spacings: tuple[Spacing, ...] = ()
