"""Order of objects, the worst first."""

from dataclasses import replace
from functools import cache
from math import inf, isnan, log, log1p

from pipeline import records
from pipeline.analysis.stakes import expected_loss, to_check, value_of
from pipeline.records import Assessment, Finding, Urgency, Verdict
from pipeline.report.pages.views import Judged, State
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
