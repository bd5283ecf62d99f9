"""Findings and advice of a run, what it asks to be measured, and where each object stands by them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

from pipeline.records.fragility import Fragility
from pipeline.records.likelihood import Band, Likelihood
from pipeline.records.picture import Mark
from pipeline.records.scene import Origin, Scene


class Verdict(StrEnum):
    """Verdict of a finding."""

    PASS = "pass"  # noqa: S105
    FAIL = "fail"
    UNDETERMINED = "undetermined"


DEMANDS, BOUNDS = "demands", "bounds"
"""What the ends of a range are: demands that were found, or bounds between which these lie for certain."""


@dataclass(frozen=True, slots=True)
class Finding:
    """One demand set against one capacity (contract "A finding").

    Attributes
    ----------
    object_number, gallery, level, model : str
        Of what it is a finding.
    title : str
        The failure in the field's words ("Rocking", "Sliding").
    demand_name : str
        The output of the model.
    demand : float or None
        In ``unit``; None where it could not be computed.
    unit : str
        Of demand, low, high, capacity and error.
    low, high : float or None
        The range of the demand over the best estimates and all corners of the uncertain inputs.
    capacity : float or None
        In ``unit``; None where it is not known.
    capacity_origin : Origin or None
        Where the capacity comes from.
    utilisation : float or None
        Demand over capacity [-].
    verdict : Verdict
        What follows.
    fidelity : str
        At which the demand was found, see `Numerics`.
    error : float or None
        Numerical error of the demand, estimated, in ``unit``; of a bound, how much less it may be.
    decided_by : str
        By what the verdict was settled.
    motion, motion_hash : str
        Name and hash of the motion that governs.
    sentence : str
        What it means, with {demand}, {capacity}, {low} and {high} to be filled in the reader's units.
    screen : str
        The paper's closed-form criterion in words; reported, never deciding.
    outcome : str
        What the object does by the best estimates beyond its capacity ("rocks"); "" where it stays within.
    note : str
        What a reader should know.
    assumptions : tuple of str
        What was assumed for it.
    mark : Mark or None
        Its place on a chart.
    range_is : str
        "demands" where low and high are; "bounds" where these lie between low and high for certain and were not looked
        for, because nothing hangs on them.
    version : str
        Of Kouros, by which it was found.
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

    Attributes
    ----------
    model, title : str
        The model, and the failure in words.
    demand : float
        After the measure, in ``unit``.
    unit : str
        Of demand, capacity and before.
    capacity : float
        In ``unit``.
    utilisation : float
        Demand over capacity [-].
    passes : bool
        Whether the measure works against it.
    before : float or None
        The demand of the same model without it; None where the model had nothing to say then.
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

    Attributes
    ----------
    object_number, gallery, level : str
        For what it is advised.
    measure : str
        Identity of the row in tables/measures.csv.
    title : str
        Of the measure, in words.
    sentence : str
        The advice in words, with {parameter} placeholders to be filled in the reader's units.
    parameters : mapping of str to float
        What to build or buy, by name with unit, such as {"clearance_m": 0.14}.
    units : mapping of str to str
        Of the parameters.
    checks : tuple of Check
        The models run again; every one passes, except for removal, which has none.
    rejected : tuple of str
        The less intrusive measures that were tried or do not apply, and why not.
    mark : Mark or None
        Its place on a chart.
    source : str
        Who says so.
    remaining : float or None
        Probability of harm that remains with it; None where its checks exclude harm within all that is uncertain, and
        where nobody drew it.
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
    remaining: float | None = None


@dataclass(frozen=True, slots=True)
class Assessment:
    """One object with everything that was found about it.

    Attributes
    ----------
    scene : Scene
        The object where it stands.
    findings : tuple of Finding
        One for each demand and level.
    recommendations : tuple of Recommendation
        What would help.
    fragilities : tuple of Fragility
        One for each way to fail, what fails first to begin with; none where they were not asked for.
    fault : str
        Where Kouros itself failed on the object, what went wrong and where; "" where it did not.
    aside : bool
        Whether it was left aside, because it is not on display: nothing of it was computed.
    likelihoods : tuple of Likelihood
        How likely it comes to harm, one for each level; none where that was not asked for.
    """

    scene: Scene
    findings: tuple[Finding, ...]
    recommendations: tuple[Recommendation, ...]
    fragilities: tuple[Fragility, ...] = ()
    fault: str = ""
    aside: bool = False
    likelihoods: tuple[Likelihood, ...] = ()

    @property
    def likelihood(self) -> Likelihood | None:
        """How likely it comes to harm at the level that decides: where that is likeliest; None where nobody knows."""
        told = self.likelihoods
        # Asked twenty times of an object, which mostly has one.
        return told[0] if len(told) == 1 else max(told, key=lambda one: one.probability, default=None)

    @property
    def assessed(self) -> bool:
        """Whether at least one verdict could be reached."""
        return bool(self.findings) and not self.scene.missing


@dataclass(frozen=True, slots=True)
class Spacing:
    """Two neighbours under one level of shaking.

    Attributes
    ----------
    gallery, level : str
        Where they stand, and how it is shaken.
    first, second : str
        Their object numbers.
    gap : float
        Between their outlines, along the line between their centres, m.
    needed : float or None
        By how much they come closer along that line at most, moving together under one motion, m; None where only their
        bound was needed or can be had.
    low, high : float or None
        Its range over their uncertain measures, m.
    radial : float or None
        Their largest displacement relative to each other in any direction, m.
    together : float
        The sum of how far each of them moves at most, m: they never come closer than by this.
    verdict : Verdict
        Whether the gap is enough.
    decided_by : str
        "bound" where the gap is at least ``together``, else "history".
    motion : str
        Name of the motion that governs.
    note : str
        What a reader should know.
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


@dataclass(frozen=True, slots=True)
class MeasurementRequest:
    """A quantity of one object that nobody recorded, and what recording it would do.

    Attributes
    ----------
    object_number, gallery, title : str
        The object.
    field : str
        Of the object record, such as friction.
    unit : str
        Of the values.
    low, best, high : float or None
        What is assumed instead, in ``unit``; None where nothing can be assumed.
    reason : str
        What is assumed and by which source, or that it is not recorded.
    open : int
        Verdicts that are undetermined now and that it takes part in, or levels at which it may change what is decided.
    settles : float
        How many of them it would settle: of verdicts the mean over its being measured as low, best and high.
    unlocks : int
        Models that cannot be run without it.
    drawn : bool
        Whether ``settles`` is the probability that something else is decided once it is measured, from joint samples.
    """

    object_number: str
    gallery: str
    title: str
    field: str
    unit: str
    low: float | None
    best: float | None
    high: float | None
    reason: str
    open: int
    settles: float
    unlocks: int
    drawn: bool = False

    @property
    def gain(self) -> float:
        """What measuring it brings: what it would settle, and models that it would make possible."""
        return self.settles + self.unlocks

    @property
    def settles_nothing(self) -> bool:
        """Whether measuring it alone would settle nothing, wherever in its range it lies."""
        return not self.gain


class State(StrEnum):
    """Where an object stands, in the order in which the report lists it.

    act: harm is possible or likelier; watch: it is unlikely; unknown: nobody can say; fine: harm is very unlikely, or
    excluded; aside: not on display, and not assessed.
    """

    ACT = "act"
    WATCH = "watch"
    UNKNOWN = "unknown"
    FINE = "fine"
    ASIDE = "aside"


_STATES = {Band.VERY_UNLIKELY: State.FINE, Band.UNLIKELY: State.WATCH}


def state_of(assessment: Assessment) -> State:
    """Return where an object stands; see `standing`."""
    return standing(
        assessment.findings, assessment.likelihood, complete=not assessment.scene.missing, aside=assessment.aside
    )


def standing(findings: Sequence[Finding], found: Likelihood | None, *, complete: bool, aside: bool) -> State:
    """Return where an object stands: by how likely harm is, or where that was not asked for by its verdicts.

    A proof beats a probability: what passes in all its models, whatever its uncertain inputs are, is fine, unless the
    scatter of the models, which no verdict counts, makes harm possible.  It holds of the class that was run: of what
    may be of another one the probability decides.  What has no verdict at all never is fine.

    Parameters
    ----------
    findings : sequence of Finding
        About the object.
    found : Likelihood or None
        How likely it comes to harm at the level that decides; None where nobody asked.
    complete : bool
        Whether nothing is missing that its models need.
    aside : bool
        Whether it was left aside.
    """
    if aside:
        return State.ASIDE
    verdicts = {f.verdict for f in findings}
    assessed = bool(findings) and complete
    state = State.FINE if found is None else _STATES.get(found.band, State.ACT)
    proved = assessed and verdicts == {Verdict.PASS} and (found is None or not found.classes)
    if proved and state is not State.ACT:
        return State.FINE
    if found is None:
        state = State.ACT if Verdict.FAIL in verdicts else State.WATCH
    # Where some of it could not be run, only what is bad is known.
    return state if assessed or (verdicts and state is State.ACT) else State.UNKNOWN
