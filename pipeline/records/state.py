"""Where an object stands, by what was found about it: to act on, to watch, fine, or nobody can say."""

from __future__ import annotations

from collections.abc import Sequence
from enum import StrEnum

from pipeline.records.likelihood import Band, Likelihood
from pipeline.records.result import Assessment, Finding, Verdict


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
