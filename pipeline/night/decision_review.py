"""Review of decisions: one whose grounds changed must be looked at again."""

from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from math import isinf

from pipeline.analysis.classify import object_classes
from pipeline.records import (
    Assessment,
    Basis,
    Decision,
    DecisionKind,
    DecisionStatus,
    Finding,
    MotionSummary,
    RunRecord,
    Verdict,
)

MORE = 1.1
"""How many times its utilisation at the time of a decision a finding may reach before the decision is in doubt."""

_RESTING = (DecisionKind.ACCEPT, DecisionKind.VERDICT)
"""Kinds of decisions that rest on findings, and are nothing without them."""

_BESIDE = frozenset({"provenance", "image", "image_credit"})
"""Fields on which no decision rests: where a number was read from may change without the number."""

_SEVERITY = {Verdict.PASS: 0, Verdict.UNDETERMINED: 1, Verdict.FAIL: 2}


@dataclass(frozen=True)
class Now:
    """What a run found, and the inventory of now, for the objects that were decided about.

    digests : of the records, by object number; an object without one is gone
    changed : object number and digest of its record then -> the fields that changed since, as far as that is known
    today   : ISO 8601
    """

    assessments: Mapping[str, Assessment]
    motions: Collection[MotionSummary]
    digests: Mapping[str, str]
    changed: Callable[[str, str], Collection[str]]
    today: str


def now(
    assessments: Iterable[Assessment],
    head: RunRecord,
    digests: Mapping[str, str],
    changed: Callable[[str, str], Collection[str]],
) -> Now:
    """Return what decisions are held against after a run; today is the day on which it began.

    assessments : of the objects decided about
    head        : the run, for its motions and its day
    """
    found = {assessment.scene.item.object_number: assessment for assessment in assessments}
    return Now(found, head.motions, digests, changed, head.started[:10])


def standing(decisions: Iterable[Decision], at: Now) -> tuple[DecisionStatus, ...]:
    """Return the decisions, each with the reasons for which it must be looked at again."""
    return tuple(DecisionStatus(decision, tuple(dict.fromkeys(_doubts(decision, at)))) for decision in decisions)


def _doubts(decision: Decision, at: Now) -> Iterable[str]:
    if decision.until and at.today > decision.until:
        yield f"the risk was accepted until {decision.until} only"
    if decision.object_class and decision.object_class not in object_classes():
        yield f"there is no class {decision.object_class} any more, so that it is not used"
    digest = at.digests.get(decision.object_number)
    if digest is None:
        yield "the object is no longer in the inventory"
        return
    if digest != decision.digest:
        fields = list(at.changed(decision.object_number, decision.digest))
        told = [name for name in fields if name not in _BESIDE]
        if told or not fields:
            yield f"its record has changed{': ' if told else ''}{', '.join(told)}"
    assessment = at.assessments.get(decision.object_number)
    if assessment is None or decision.kind is DecisionKind.CLASS:
        return
    if assessment.aside:
        # What it rests on was not computed, so that nothing can be held against it.
        if decision.kind in _RESTING:
            yield "the object is not on display, and was not assessed"
        return
    yield from _shaken(decision, assessment, at.motions)
    yield from _judged(decision, assessment)


def _shaken(decision: Decision, assessment: Assessment, motions: Collection[MotionSummary]) -> Iterable[str]:
    floor = assessment.scene.floor
    for basis in decision.basis:
        if basis.motion_hash not in {m.hash for m in motions if (m.level, m.floor) == (basis.level, floor)}:
            yield f"the motion {basis.motion} of level {basis.level} has changed"


def _judged(decision: Decision, assessment: Assessment) -> Iterable[str]:
    found = {(f.model, f.level, f.title): f for f in assessment.findings}
    looked_at = {(b.model, b.level, b.title): b for b in decision.basis}
    rests = decision.kind in _RESTING
    for key, basis in looked_at.items():
        finding = found.get(key)
        where = f"{basis.title}, level {basis.level}"
        if finding is None:
            # A measure or another class takes models away, and is meant to.
            if rests:
                yield f"{where}: there is no such finding any more"
        elif _SEVERITY[finding.verdict] > _SEVERITY[basis.verdict]:
            yield f"{where}: {basis.verdict} then, {finding.verdict} now"
        elif _more(decision, basis, finding):
            yield f"{where}: utilisation {_written(basis.utilisation)} then, {_written(finding.utilisation)} now"
    if decision.kind is DecisionKind.ACCEPT:
        for key, finding in found.items():
            if key not in looked_at and finding.verdict is not Verdict.PASS and decision.concerns(*key[:2]):
                yield f"{finding.title}, level {finding.level}: {finding.verdict} now, and was not looked at then"


def _written(utilisation: float | None) -> str:
    return "∞" if utilisation is None or isinf(utilisation) else f"{utilisation:.2f}"


def _more(decision: Decision, basis: Basis, finding: Finding) -> bool:
    if basis.utilisation is None or finding.utilisation is None:
        return False
    # Of what passes only that counts which the decision names: else a hundredth of the limit would matter.
    counts = finding.verdict is not Verdict.PASS or decision.model
    return bool(counts) and finding.utilisation > MORE * basis.utilisation
