"""The totals of a run, and what each page adds to them."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from math import inf, isfinite, isnan, log, log1p

from pipeline import records
from pipeline.analysis.stakes import expected_loss, to_check, value_of
from pipeline.records import Assessment, Errors, Finding, Found, Tally, Urgency, Urgent, Verdict
from pipeline.report.pages.chances import open_for
from pipeline.report.pages.class_curves import curve_sums
from pipeline.report.pages.views import STATES, Judged, State
from pipeline.report.text import encodable
from pipeline.tables import table

state_of = records.state_of

_GRAVE = ("overturn", "break")
_GRAVER = 1e6
"""By how much more what overturns or breaks counts than what does not: more than any difference of value."""

_ALIKE = log1p(0.01)
"""Losses are told apart by steps of a hundredth: finer than that no sample tells them."""

_MOST = 1e300
"""Loss from which on all are alike: of numbers that no record may have, a product may be no number."""

_ORDER = tuple(State)
_JUDGED = {Verdict.FAIL: Judged.FAILS, Verdict.UNDETERMINED: Judged.OPEN, Verdict.PASS: Judged.PASSES}
_SIZES = tuple(Judged)


def at_level(assessment: Assessment, level: str) -> Assessment:
    """Return an object with what was found about it at one level of shaking alone."""
    return replace(
        assessment,
        findings=tuple(f for f in assessment.findings if f.level == level),
        likelihoods=tuple(one for one in assessment.likelihoods if one.level == level),
    )


def finding_state(finding: Finding) -> Judged:
    """Return what one finding's verdict says."""
    return _JUDGED[finding.verdict]


def grave(finding: Finding) -> bool:
    """Say whether a failing finding means that the object overturns or breaks, which no repair undoes."""
    return finding.verdict is Verdict.FAIL and finding.outcome.strip().lower().startswith(_GRAVE)


def finding_order(finding: Finding) -> tuple[int, bool, float, str, str]:
    """Sort key of an object's findings: the most urgent first."""
    return (
        _SIZES.index(finding_state(finding)),
        not grave(finding),
        -_size(finding.utilisation),
        finding.title,
        finding.level,
    )


def urgency(assessment: Assessment, *, settled: bool = False) -> Urgency:
    """Sort key of objects: state; settled; records to be checked first; expected loss; ease; how likely harm is.

    Losses within a hundredth of each other count as equal, and the one comes first for which less is to be done.  Ties
    are settled by object number and gallery, so that the same run always gives the same order.

    Parameters
    ----------
    assessment : Assessment
        Of the object.
    settled : bool
        Whether people accepted or overruled all that does not pass: it comes after what nobody has looked at.

    Returns
    -------
    Urgency
        The smaller the more urgent.
    """
    item, found = assessment.scene.item, assessment.likelihood
    if found is not None:
        loss, size = expected_loss(assessment), found.probability
        ease = min((_ease().get(r.measure, inf) for r in assessment.recommendations), default=inf)
    else:
        # Where no probabilities are asked for, what overturns or breaks, then what is worth most, then what fails most.
        failing = [f for f in assessment.findings if f.verdict is Verdict.FAIL]
        loss = value_of(assessment.scene) * (_GRAVER if any(map(grave, failing)) else 1.0)
        size = max((_size(f.utilisation) for f in failing or assessment.findings), default=0.0)
        ease = 0.0
    return (
        _ORDER.index(state_of(assessment)),
        settled,
        to_check(assessment),
        inf if loss <= 0.0 else float(-round(log(min(loss, _MOST)) / _ALIKE)),
        ease,
        -size,
        encodable(item.object_number),
        encodable(item.gallery),
    )


@cache
def _ease() -> dict[str, float]:
    """Return the order of measures, the least intrusive first; one of the museum's own table comes after these."""
    return {row["measure"]: float(row["order"]) for row in table("measures")}


def _size(utilisation: float | None) -> float:
    # Not knowing how far beyond the limit an object is must never push it down the list.
    return inf if utilisation is None or isnan(utilisation) else utilisation


MOST = 50
"""Objects that are kept as the worst: more than a list names, for some of them may be settled by people."""


def tally(found: Found) -> Tally:
    """Count what was found about the objects of a page."""
    findings = [f for a in found.assessments for f in a.findings]
    shown = [a for a in found.assessments if a.scene.item.on_display]
    stored = [a for a in found.assessments if not a.scene.item.on_display]
    states = Counter(state_of(a) for a in shown)
    reasons = (reason for a in shown if not a.assessed for reason in a.scene.missing)
    useful = [w for w in found.wishes or () if not w.settles_nothing]
    return Tally(
        states={state.value: states[state] for state in STATES},
        measures=dict(Counter(r.title for a in shown for r in a.recommendations)),
        missing=dict(Counter(reasons)),
        first=_worst(_urgent(a) for a in shown if state_of(a) is State.ACT),
        decided=_decided(findings),
        fidelities=dict(Counter(f.fidelity for f in findings)),
        efforts=_efforts(found),
        surveyed=found.wishes is not None,
        worth=len(useful),
        waste=len(found.wishes or ()) - len(useful),
        wished=len({w.object_number for w in useful}),
        faults=sum(bool(a.fault) for a in found.assessments),
        stored=dict(Counter(state_of(a).value for a in stored)),
        stored_measures=dict(Counter(r.title for a in stored for r in a.recommendations)),
        findings=sum(len(a.findings) for a in shown),
        stored_findings=sum(len(a.findings) for a in stored),
        verdicts=dict(Counter(f.verdict.value for f in findings)),
        stands_by=dict(Counter(a.scene.stands_by.value for a in shown if a.scene.stands_by is not None)),
        open_for=dict(Counter(open_for(a) for a in shown if open_for(a))),
        curves=curve_sums(shown),
        check=sum(state_of(a) is State.ACT and to_check(a) for a in shown),
        levels=_by_level(shown),
    )


def total(tallies: Iterable[Tally]) -> Tally:
    """Return the tally of several pages together."""
    listed = list(tallies)
    return Tally(
        states=_sum(t.states for t in listed),
        measures=_sum(t.measures for t in listed),
        missing=_sum(t.missing for t in listed),
        first=_worst(urgent for t in listed for urgent in t.first),
        decided=_all_decided(listed),
        fidelities=_sum(t.fidelities for t in listed),
        efforts=_all_sums(t.efforts for t in listed),
        surveyed=bool(listed) and all(t.surveyed for t in listed),
        worth=sum(t.worth for t in listed),
        waste=sum(t.waste for t in listed),
        wished=sum(t.wished for t in listed),
        faults=sum(t.faults for t in listed),
        stored=_sum(t.stored for t in listed),
        stored_measures=_sum(t.stored_measures for t in listed),
        findings=sum(t.findings for t in listed),
        stored_findings=sum(t.stored_findings for t in listed),
        verdicts=_sum(t.verdicts for t in listed),
        stands_by=_sum(t.stands_by for t in listed),
        open_for=_sum(t.open_for for t in listed),
        curves=_all_sums(t.curves for t in listed),
        check=sum(t.check for t in listed),
        levels=_all_sums(t.levels for t in listed),
    )


def counts(found: Tally) -> dict[str, int]:
    """Return how many objects, findings and so on a run has, as the list of runs shows them."""
    objects = sum(found.states.values()) + sum(found.stored.values())
    wishes = {"wishes": found.worth + found.waste} if found.surveyed else {}
    unknown = found.states.get(State.UNKNOWN, 0) + found.stored.get(State.UNKNOWN, 0)
    return {
        "objects": objects,
        "assessed": objects - unknown - found.stored.get(State.ASIDE, 0),
        "findings": found.findings + found.stored_findings,
        **{verdict.value: found.verdicts.get(verdict.value, 0) for verdict in Verdict},
        "recommendations": sum(found.measures.values()) + sum(found.stored_measures.values()),
        **wishes,
    }


def _urgent(assessment: Assessment) -> Urgent:
    item, found = assessment.scene.item, assessment.likelihood
    worst = min(assessment.findings, key=finding_order)
    outcome = worst.outcome if found is None else f"{found.harm}, {found.band.value}"
    bad = dict.fromkeys((f.model, f.level) for f in assessment.findings if f.verdict is not Verdict.PASS)
    number, title, gallery, outcome = map(encodable, (item.object_number, item.called, item.gallery, outcome))
    return Urgent(urgency(assessment), number, title, gallery, outcome, tuple(bad))


def _by_level(shown: Sequence[Assessment]) -> dict[str, dict[str, int]]:
    levels = dict.fromkeys(f.level for a in shown for f in a.findings)
    if len(levels) < 2:
        return {}
    out = {}
    for level in levels:
        states = Counter(state_of(at_level(a, level)) for a in shown if any(f.level == level for f in a.findings))
        out[level] = {state.value: number for state, number in states.items()}
    return out


def _worst(urgent: Iterable[Urgent]) -> tuple[Urgent, ...]:
    return tuple(sorted(urgent, key=lambda one: one.order)[:MOST])


def _decided(findings: Iterable[Finding]) -> dict[str, Errors]:
    members: dict[str, list[Finding]] = {}
    for finding in findings:
        members.setdefault(finding.decided_by, []).append(finding)
    out = {}
    for by, those in members.items():
        sizes = [
            abs(f.error / f.demand)
            for f in those
            if f.error is not None and f.demand and isfinite(f.error) and isfinite(f.demand)
        ]
        # Two digits are what a page shows.
        out[by] = Errors(len(those), dict(Counter(f"{size:.1e}" for size in sizes)), max(sizes, default=0.0))
    return out


def _efforts(found: Found) -> dict[str, dict[str, int]]:
    """Count by model what its verdicts were decided by, and for how many any history was run."""
    out: dict[str, dict[str, int]] = {}
    titles: dict[str, str] = {}
    for finding in (f for a in found.assessments for f in a.findings):
        titles[finding.model] = finding.title
        counts = out.setdefault(finding.title, dict.fromkeys(("analyses", *_BY, "needing_history"), 0))
        counts["analyses"] += 1
        if finding.decided_by in _BY:
            counts[finding.decided_by] += 1
    for needing in found.needing.values():
        for model, often in needing.items():
            out[titles[model]]["needing_history"] += often
    return out


_BY = ("certificate", "chart", "history")


def _all_decided(tallies: Iterable[Tally]) -> dict[str, Errors]:
    members: dict[str, list[Errors]] = {}
    for one in tallies:
        for by, errors in one.decided.items():
            members.setdefault(by, []).append(errors)
    return {
        by: Errors(sum(e.verdicts for e in those), _sum(e.sizes for e in those), max(e.worst for e in those))
        for by, those in members.items()
    }


def _all_sums(counts: Iterable[Mapping[str, Mapping[str, int]]]) -> dict[str, dict[str, int]]:
    members: dict[str, list[Mapping[str, int]]] = {}
    for one in counts:
        for name, those in one.items():
            members.setdefault(name, []).append(those)
    return {name: _sum(those) for name, those in members.items()}


def _sum(counts: Iterable[Mapping[str, int]]) -> dict[str, int]:
    found: Counter[str] = Counter()
    for one in counts:
        found.update(one)
    return dict(found.most_common())
