"""Results of a run, one for each object whatever it is called; and the pages on which objects are shown."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from pipeline.records.change import Brief
from pipeline.records.fragility import Fragility
from pipeline.records.likelihood import Likelihood
from pipeline.records.result import Assessment, Finding, MeasurementRequest, Recommendation, Spacing
from pipeline.records.scene import Anchorage, Estimate, Furniture, Hanging, Mount, Origin, Support


@dataclass(frozen=True, slots=True)
class Found:
    """Everything that was found about some objects.

    Attributes
    ----------
    assessments : tuple of Assessment
        One for each object.
    wishes : tuple of MeasurementRequest or None
        What is worth measuring; None where the run did not ask.
    spacings : tuple of Spacing
        Of the neighbours among them.
    needing : mapping of str to mapping
        By object number and name of the model, for how many of its analyses any history was run.
    """

    assessments: tuple[Assessment, ...]
    wishes: tuple[MeasurementRequest, ...] | None = None
    spacings: tuple[Spacing, ...] = ()
    needing: Mapping[str, Mapping[str, int]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Result:
    """Findings about one object, whatever its number, its place and its title, which are empty in all of it.

    Attributes
    ----------
    object_class, rule, support, models, parameters, assumptions, missing, skipped, floor
        See `Scene`.
    hanging, furniture, statements, furniture_origin, anchorage, chances, mount, mount_origin
        See `Scene`.
    findings : tuple of Finding
        One for each demand and level.
    recommendations : tuple of Recommendation
        What would help.
    fragilities, fault, aside, likelihoods
        See `Assessment`.
    needing : mapping of str to int
        By name of the model, for how many of its analyses any history was run.
    wishes : tuple of MeasurementRequest or None
        What is worth measuring on it; None where the run did not ask.
    check : bool
        Whether its sizes are to be checked before anything is done about it.
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
    hanging: Hanging | None = None
    furniture: Furniture | None = None
    statements: tuple[str, ...] = ()
    findings: tuple[Finding, ...] = ()
    recommendations: tuple[Recommendation, ...] = ()
    fragilities: tuple[Fragility, ...] = ()
    needing: Mapping[str, int] = field(default_factory=dict)
    wishes: tuple[MeasurementRequest, ...] | None = None
    fault: str = ""
    aside: bool = False
    furniture_origin: Origin | None = None
    anchorage: Anchorage | None = None
    likelihoods: tuple[Likelihood, ...] = ()
    chances: tuple[tuple[str, float], ...] = ()
    mount: Mount | None = None
    mount_origin: Origin | None = None
    check: bool = False


Urgency = tuple[int, bool, bool, float, float, float, str, str]
"""What sorts an object among others, the most urgent first: state; whether people settled it; whether its record is to
be checked first; expected loss in steps, falling; ease of what is advised; how likely harm is, falling; object number
and gallery."""


@dataclass(frozen=True, slots=True)
class Urgent:
    """An object on display that fails, as a list of the worst shows it.

    Attributes
    ----------
    order : Urgency
        The key that sorts it among others.
    object_number, title, gallery, outcome : str
        As the list shows them.
    open : tuple of (str, str)
        Model and level of each of its findings that does not pass.
    """

    order: Urgency
    object_number: str
    title: str
    gallery: str
    outcome: str
    open: tuple[tuple[str, str], ...] = ()


@dataclass(frozen=True, slots=True)
class Errors:
    """Numerical errors of verdicts of one kind.

    Attributes
    ----------
    verdicts : int
        How many verdicts.
    sizes : mapping of str to int
        Error over demand [-], in two digits as "1.2e-05" -> how often; of those that are known.
    worst : float
        The largest of them [-].
    """

    verdicts: int
    sizes: Mapping[str, int]
    worst: float = 0.0


@dataclass(frozen=True, slots=True)
class Tally:
    """A page's share of the totals of a run.

    Attributes
    ----------
    states : mapping of str to int
        Objects on display by state: act, watch, unknown (cannot be assessed), fine.
    measures : mapping of str to int
        Recommendations for them by title.
    missing : mapping of str to int
        Why they could not be assessed, with how many of each.
    first : tuple of Urgent
        The worst objects on display, the worst first.
    decided : mapping of str to Errors
        Errors of their verdicts, by what these were decided.
    fidelities : mapping of str to int
        Verdicts by fidelity.
    efforts : mapping of str to mapping
        By the title of each model, by what its verdicts were decided.
    surveyed : bool
        Whether measurements were asked for.
    worth, waste, wished : int
        Measurements that would settle something, that would not, and the objects of the former.
    faults : int
        Objects that Kouros itself failed on.
    stored : mapping of str to int
        Objects that are not on display by state, "aside" for those that were not assessed.
    stored_measures : mapping of str to int
        Recommendations for them by title.
    findings, stored_findings : int
        How many there are, of objects that are on display and that are not.
    verdicts : mapping of str to int
        Of all objects, by what they are.
    stands_by : mapping of str to int
        Objects on display by where it is known from what they stand on, see `Scene.stands_by`.
    open_for : mapping of str to int
        Objects on display about which one measurement may change what is decided, by what is to be measured.
    curves : mapping of str to mapping of str to int
        Of the fragility of harm of objects on display, by class: what `pipeline.report.pages.class_curves` adds up.
    check : int
        Of the objects on display to be acted on, those whose record is to be checked first.
    levels : mapping of str to mapping of str to int
        Where there are several levels of shaking: objects on display with findings, by level and their state at it.
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
    stands_by: Mapping[str, int] = field(default_factory=dict)
    open_for: Mapping[str, int] = field(default_factory=dict)
    curves: Mapping[str, Mapping[str, int]] = field(default_factory=dict)
    check: int = 0
    levels: Mapping[str, Mapping[str, int]] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Outline:
    """One object in as much as two runs are compared by.

    Attributes
    ----------
    object_number, gallery, floor : str
        Which object, and where it stands.
    item, scene : str
        Digests of the record, and of what else it was run with.
    verdicts : tuple of (str, str, str)
        Model, level and the worst verdict of each.
    brief : Brief
        What is said of it in short.
    """

    object_number: str
    gallery: str
    floor: str
    item: str
    scene: str
    verdicts: tuple[tuple[str, str, str], ...]
    brief: Brief


@dataclass(frozen=True, slots=True)
class Page:
    """A page of a run: which objects are shown on it, in which order.

    Attributes
    ----------
    key : str
        Digest of its objects' numbers, places, records and results.
    gallery : str
        "" for objects that are not on display.
    on_display : bool
        Whether its objects are.
    number, of : int
        Which of its gallery's pages it is, from 1, and how many there are.
    run, made : str
        The run that found the newest of its results, perhaps an earlier one, and when (ISO 8601, UTC).
    """

    key: str
    gallery: str
    on_display: bool
    number: int
    of: int
    run: str
    made: str
