"""Evidence of trials: whether their findings pass, for sure or by the best estimates, and why not."""

from collections.abc import Mapping, Sequence
from math import isinf

from pipeline.analysis.verdicts import capacity_of
from pipeline.mitigate.proposals import Candidate
from pipeline.mitigate.trials import Trial
from pipeline.models import model_named
from pipeline.models.common import N_
from pipeline.records import Check, Finding, Likelihood, Scene, Verdict
from pipeline.records import phrases as say

TIGHT = 0.1
"""Share of a demand within which a bound of it says as much as the demand."""


def passes(findings: Sequence[Finding]) -> bool:
    """Say whether something was run and all of it passes, at every corner of what is uncertain."""
    return bool(findings) and all(finding.verdict is Verdict.PASS for finding in findings)


def passes_at_best(findings: Sequence[Finding]) -> bool:
    """Say whether something was run and all of it passes by the best estimates."""
    return bool(findings) and all(_at_best(finding) for finding in findings)


def _at_best(finding: Finding) -> bool:
    return finding.utilisation is not None and finding.utilisation <= 1.0


def checks(findings: Sequence[Finding], before: Sequence[Finding], *, at_best: bool = False) -> tuple[Check, ...]:
    """Return the findings of a trial as evidence, each beside the demand before the measure.

    Parameters
    ----------
    at_best : bool, optional
        Whether they were asked to pass by the best estimates only.

    Returns
    -------
    tuple of Check
    """
    demands = {finding.model: finding.demand for finding in before}
    every = (
        Check(
            model=finding.model,
            title=finding.title,
            demand=finding.demand or 0.0,
            unit=finding.unit,
            capacity=finding.capacity or 0.0,
            utilisation=finding.utilisation or 0.0,
            passes=_at_best(finding) if at_best else finding.verdict is Verdict.PASS,
            before=demands.get(finding.model),
        )
        for finding in findings
    )
    # Of two trials on the floor each judges the furniture that is not fastened.
    return tuple(dict.fromkeys(every))


def why_not(scene: Scene, findings: Sequence[Finding]) -> str:
    """Say in words what a trial still fails by: the worst of what its uncertain inputs give, against its capacity."""
    worst = [(_worst(scene, finding), finding) for finding in findings if finding.verdict is not Verdict.PASS]
    if not worst:
        return N_("none of its models can be run then")
    times, finding = max(worst, key=lambda pair: pair[0])
    error, demand = finding.error or 0.0, finding.demand or 0.0
    if finding.low == finding.high and finding.utilisation is not None and not isinf(finding.utilisation):
        return say.REACHES(check=finding.title.lower(), times=finding.utilisation)
    if finding.fidelity == "bound" and error and (isinf(error) or error > TIGHT * demand):
        return say.MAY_BE_MORE(check=finding.title.lower())
    if finding.high is not None and isinf(finding.high):
        return say.NOTHING_LIMITS(check=finding.title.lower())
    if times == float("inf"):
        return say.NOTHING_LEFT(check=finding.title.lower())
    best = finding.utilisation or 0.0
    phrase = say.MAY_REACH_AND_DOES if times > 1.05 * best else say.MAY_REACH
    return phrase(check=finding.title.lower(), times=times, best=best)


def _worst(scene: Scene, finding: Finding) -> float:
    _, capacity = capacity_of(model_named(finding.model), scene)
    return (finding.high or 0.0) / capacity.low if capacity.low > 0.0 else float("inf")


def shortfall(
    failing: Sequence[Trial],
    candidate: Candidate,
    results: Mapping[int, Sequence[Finding]],
    left: Mapping[int, Mapping[str, Likelihood]],
) -> str:
    """Say in words why a candidate is not enough: the first trial that fails, or a check.

    Parameters
    ----------
    left : Mapping[int, Mapping[str, Likelihood]]
        Of each trial that was drawn how likely harm remains, by level.

    Returns
    -------
    str
    """
    if failing:
        remains = [one.expected for one in left.get(id(failing[0]), {}).values()]
        if remains:
            return say.HARM_REMAINS(chance=max(remains))
        return why_not(failing[0].scene, results[id(failing[0])])
    short: list[Check] = [check for _, check in candidate.checks if not check.passes]
    return say.NOT_ENOUGH(check=short[0].title.lower()) if short else ""
