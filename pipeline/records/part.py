"""What a run finds: results, one for each object whatever it is called; and the pages on which objects are shown."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from pipeline.records.fragility import Fragility
from pipeline.records.measurement_request import MeasurementRequest
from pipeline.records.result import Assessment, Finding, Recommendation, Spacing
from pipeline.records.scene import Estimate, Support


@dataclass(frozen=True, slots=True)
class Found:
    """Everything that was found about some objects.

    wishes  : what is worth measuring; None where the run did not ask
    needing : by object number and name of the model, for how many of its analyses any history was run
    """

    assessments: tuple[Assessment, ...]
    wishes: tuple[MeasurementRequest, ...] | None = None
    spacings: tuple[Spacing, ...] = ()
    needing: Mapping[str, Mapping[str, int]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Result:
    """What was found about one object, whatever its number, its place and its title, which are empty in all of it.

    object_class, rule, support, models, parameters, assumptions, missing, skipped, floor : see `Scene`
    needing : by name of the model, for how many of its analyses any history was run
    wishes  : what is worth measuring on it; None where the run did not ask
    fault, aside : see `Assessment`
    """

    object_class: str
    rule: str
    support: Support
    models: tuple[str, ...]
    parameters: Mapping[str, Estimate]
    assumptions: tuple[str, ...]
    missing: tuple[str, ...]
    skipped: Mapping[str, str]
    floor: str
    findings: tuple[Finding, ...] = ()
    recommendations: tuple[Recommendation, ...] = ()
    fragilities: tuple[Fragility, ...] = ()
    needing: Mapping[str, int] = field(default_factory=dict)
    wishes: tuple[MeasurementRequest, ...] | None = None
    fault: str = ""
    aside: bool = False


@dataclass(frozen=True, slots=True)
class Urgent:
    """An object on display that fails, as a list of the worst shows it, with the key that sorts it among others.

    open : model and level of each of its findings that does not pass
    """

    order: tuple[int, bool, bool, str, float, str, str]
    object_number: str
    title: str
    gallery: str
    outcome: str
    open: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True)
class Errors:
    """Numerical errors of verdicts of one kind: how many verdicts, and the relative errors that are known.

    sizes : error over demand, in two digits as "1.2e-05" -> how often
    """

    verdicts: int
    sizes: Mapping[str, int]
    worst: float = 0.0


@dataclass(frozen=True, slots=True)
class Tally:
    """What a page adds to the totals of a run.

    states   : objects on display by state: act, open, unknown (cannot be assessed), safe
    measures : recommendations for them by title
    missing  : why they could not be assessed, with how many of each
    first    : the worst objects on display, the worst first
    efforts  : by the title of each model, by what its verdicts were decided
    worth, waste, wished : measurements that would settle something, that would not, and the objects of the former
    faults   : objects that Kouros itself failed on
    stored   : objects that are not on display by state, "aside" for those that were not assessed
    stored_measures : recommendations for them by title
    findings, stored_findings : how many there are, of objects that are on display and that are not
    verdicts : of all objects, by what they are
    """

    states: Mapping[str, int]
    measures: Mapping[str, int]
    missing: Mapping[str, int]
    first: tuple[Urgent, ...]
    decided: Mapping[str, Errors]
    fidelities: Mapping[str, int]
    efforts: Mapping[str, Mapping[str, int]]
    surveyed: bool
    worth: int = 0
    waste: int = 0
    wished: int = 0
    faults: int = 0
    stored: Mapping[str, int] = field(default_factory=dict)
    stored_measures: Mapping[str, int] = field(default_factory=dict)
    findings: int = 0
    stored_findings: int = 0
    verdicts: Mapping[str, int] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Outline:
    """One object in as much as two runs are compared by.

    item, scene : digests of the record, and of what else it was run with
    verdicts    : model, level and the worst verdict of each
    """

    object_number: str
    gallery: str
    floor: str
    item: str
    scene: str
    verdicts: tuple[tuple[str, str, str], ...]


@dataclass(frozen=True, slots=True)
class Page:
    """A page of a run: which objects are shown on it, in which order.

    key          : digest of its objects' numbers, places, records and results
    gallery      : "" for objects that are not on display
    number, of   : which of its gallery's pages it is, from 1, and how many there are
    run, made    : the run that found the newest of its results, perhaps an earlier one, and when (ISO 8601, UTC)
    """

    key: str
    gallery: str
    on_display: bool
    number: int
    of: int
    run: str
    made: str
