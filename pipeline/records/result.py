"""What a run finds and advises."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

from pipeline.records.fragility import Fragility
from pipeline.records.picture import Mark
from pipeline.records.scene import Origin, Scene


class Verdict(StrEnum):
    """What a finding says."""

    PASS = "pass"  # noqa: S105
    FAIL = "fail"
    UNDETERMINED = "undetermined"


DEMANDS, BOUNDS = "demands", "bounds"
"""What the ends of a range are: demands that were found, or bounds between which these lie for certain."""


@dataclass(frozen=True, slots=True)
class Finding:
    """One demand set against one capacity (contract "A finding").

    low, high : the range of the demand over the best estimates and all corners of the uncertain inputs
    range_is  : "demands" where low and high are; "bounds" where these lie between low and high for certain and were
                not looked for, because nothing hangs on them
    outcome   : what the object does by the best estimates beyond its capacity ("rocks"); "" where it stays within
    sentence  : what it means, with {demand}, {capacity}, {low} and {high} to be filled in the reader's units
    title     : the failure in the field's words ("Rocking", "Sliding")
    screen    : the paper's closed-form criterion in words; reported, never deciding
    """

    object_number: str
    gallery: str
    level: str
    model: str
    title: str
    demand_name: str
    demand: float | None
    unit: str
    low: float | None
    high: float | None
    capacity: float | None
    capacity_origin: Origin | None
    utilisation: float | None
    verdict: Verdict
    fidelity: str
    error: float | None
    decided_by: str
    motion: str
    motion_hash: str
    sentence: str
    screen: str = ""
    outcome: str = ""
    note: str = ""
    assumptions: tuple[str, ...] = ()
    mark: Mark | None = None
    range_is: str = DEMANDS
    version: str = ""


@dataclass(frozen=True, slots=True)
class Check:
    """One model run again on the changed chain, as evidence that a recommendation works.

    demand : after the measure
    before : the demand of the same model without it; None where the model had nothing to say then
    """

    model: str
    title: str
    demand: float
    unit: str
    capacity: float
    utilisation: float
    passes: bool
    before: float | None = None


@dataclass(frozen=True, slots=True)
class Recommendation:
    """A measure for one object, with the evidence of the models run again on the changed chain.

    measure    : identity of the row in tables/measures.csv
    parameters : what to build or buy, by name with unit, such as {"clearance_m": 0.14}
    sentence   : the advice in words, with {parameter} placeholders to be filled in the reader's units
    checks     : the models run again; every one passes, except for removal, which has none
    rejected   : the less intrusive measures that were tried or do not apply, and why not
    """

    object_number: str
    gallery: str
    level: str
    measure: str
    title: str
    sentence: str
    parameters: Mapping[str, float]
    units: Mapping[str, str]
    checks: tuple[Check, ...]
    rejected: tuple[str, ...] = ()
    mark: Mark | None = None
    source: str = ""


@dataclass(frozen=True, slots=True)
class Assessment:
    """One object with everything that was found about it.

    fragilities : one for each way to fail, what fails first to begin with; none where they were not asked for
    fault       : where Kouros itself failed on the object, what went wrong and where; "" where it did not
    aside       : whether it was left aside, because it is not on display: nothing of it was computed
    """

    scene: Scene
    findings: tuple[Finding, ...]
    recommendations: tuple[Recommendation, ...]
    fragilities: tuple[Fragility, ...] = ()
    fault: str = ""
    aside: bool = False

    @property
    def assessed(self) -> bool:
        """Whether at least one verdict could be reached."""
        return bool(self.findings) and not self.scene.missing


@dataclass(frozen=True, slots=True)
class Spacing:
    """Two neighbours under one level of shaking; lengths in m.

    gap        : between their outlines, along the line between their centres
    needed     : by how much they come closer along that line at most, moving together under one motion; None where
                 only their bound was needed or can be had
    low, high  : its range over their uncertain measures
    radial     : their largest displacement relative to each other in any direction
    together   : the sum of how far each of them moves at most: they never come closer than by this
    decided_by : "bound" where the gap is at least ``together``, else "history"
    note       : what a reader should know
    """

    gallery: str
    level: str
    first: str
    second: str
    gap: float
    needed: float | None
    low: float | None
    high: float | None
    radial: float | None
    together: float
    verdict: Verdict
    decided_by: str
    motion: str = ""
    note: str = ""
