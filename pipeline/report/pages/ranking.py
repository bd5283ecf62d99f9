"""Order of objects, the worst first."""

from math import inf, isnan

from pipeline.records import Assessment, Finding, Verdict
from pipeline.report.pages.views import State
from pipeline.report.text import encodable

_GRAVE = ("overturn", "break")
_ORDER = tuple(State)
_VERDICTS = {Verdict.FAIL: State.ACT, Verdict.UNDETERMINED: State.OPEN, Verdict.PASS: State.SAFE}


def state_of(assessment: Assessment) -> State:
    """Return where an object stands: a failure outranks all else, and no verdict at all is never called safe."""
    if assessment.aside:
        return State.ASIDE
    verdicts = {f.verdict for f in assessment.findings}
    if Verdict.FAIL in verdicts:
        return State.ACT
    if Verdict.UNDETERMINED in verdicts:
        return State.OPEN
    return State.SAFE if assessment.assessed else State.UNKNOWN


def finding_state(finding: Finding) -> State:
    """Return the state that belongs to one finding's verdict."""
    return _VERDICTS[finding.verdict]


def grave(finding: Finding) -> bool:
    """Say whether a failing finding means that the object overturns or breaks, which no repair undoes."""
    return finding.verdict is Verdict.FAIL and finding.outcome.strip().lower().startswith(_GRAVE)


def finding_order(finding: Finding) -> tuple[int, bool, float, str, str]:
    """Sort key of an object's findings: the most urgent first."""
    return (
        _ORDER.index(finding_state(finding)),
        not grave(finding),
        -_size(finding.utilisation),
        finding.title,
        finding.level,
    )


def urgency(assessment: Assessment) -> tuple[int, bool, bool, str, float, str, str]:
    """Sort key of objects: state; overturns or breaks; value class where given (A before B); largest utilisation.

    Ties are settled by object number and gallery, so that the same run always gives the same page.
    """
    item = assessment.scene.item
    decisive = [f for f in assessment.findings if finding_state(f) is state_of(assessment)]
    return (
        _ORDER.index(state_of(assessment)),
        not any(grave(f) for f in decisive),
        not item.value_class,
        encodable(item.value_class),
        -max((_size(f.utilisation) for f in decisive), default=0.0),
        encodable(item.object_number),
        encodable(item.gallery),
    )


def _size(utilisation: float | None) -> float:
    # Not knowing how far beyond the limit an object is must never push it down the list.
    return inf if utilisation is None or isnan(utilisation) else utilisation
