"""A validation as a page and as the document that `kouros validate --json` prints."""

from __future__ import annotations

from typing import Any

from pipeline import __version__
from pipeline.quantities import counted
from pipeline.report.pages.validated import (
    PredictionView,
    ReliabilityView,
    ValidatedBody,
    ValidationView,
    validation_page,
)
from pipeline.verification.odds import Prior, friction_of, priors
from pipeline.verification.validation import BodyValidation, Score, Validation


def document(found: Validation) -> dict[str, Any]:
    """Return a validation as JSON has it: accuracies, Brier scores and the fitted numbers of each body.

    Parameters
    ----------
    found : Validation
        What was found.

    Returns
    -------
    dict
        `always_stands` and `pgv_threshold` are accuracies; `coverage` is the share of runs whose outcome was among
        those named to 90 %, and `stated` what that should be.
    """
    return {
        "runs": len(found.experiment.runs),
        "folds": len(set(found.experiment.folds)),
        "fitted_on": found.trained_on,
        "bodies": [
            {
                "name": one.name,
                "always_stands": one.standing.accuracy,
                "pgv_threshold": one.threshold.accuracy,
                "fitted": {
                    "accuracy": one.fitted.accuracy,
                    "brier": one.fitted.brier,
                    "parameters": {
                        "half_width_m": one.parameters.half_width,
                        "restitution_factor": one.parameters.restitution,
                    },
                },
                "unfitted": {
                    "accuracy": one.unfitted.accuracy,
                    "brier": one.unfitted.brier,
                    "coverage": one.unfitted.coverage,
                    "stated": one.unfitted.stated,
                },
                "others": {name: {"accuracy": s.accuracy, "brier": s.brier} for name, s in one.others.items()},
            }
            for one in found.bodies
        ],
    }


def page(found: Validation) -> str:
    """Return the page of a validation as HTML."""
    said = found.experiment.said
    turned = "unknown, so any" if said.direction == "unknown" else f"{said.direction:g} degrees"
    facts = [
        ("Source", said.source),
        ("Licence", said.licence),
        ("Runs", f"{counted(len(found.experiment.runs), 'run')} of {len(set(found.experiment.folds)):,} motions"),
        ("Fitted on", found.trained_on),
        ("Table", f"{counted(said.axes, 'axis', 'axes')}; direction of the bodies {turned}"),
        ("Motions", f"high-pass at {said.high_pass_hz:g} Hz" if said.high_pass_hz else "as they were recorded"),
    ]
    view = ValidationView(
        title=said.title,
        version=__version__,
        facts=facts,
        bodies=[_body(found, at) for at in range(len(found.bodies))],
        priors=[(one.quantity.replace("_", " "), _words(one), one.source) for one in priors().values()],
    )
    return validation_page(view)


def _words(prior: Prior) -> str:
    if prior.distribution == "uniform":
        return f"uniform, {prior.first:g} to {prior.second:g}"
    if prior.distribution == "normal":
        return f"normal, mean {prior.first:g}, standard deviation {prior.second:g}"
    return f"lognormal, median {prior.first:g}, standard deviation of the logarithm {prior.second:g}"


def _body(found: Validation, at: int) -> ValidatedBody:
    one, said = found.bodies[at], found.experiment.said.body[at]
    shape = said.mesh if said.mesh is not None else " x ".join(f"{size:g} m" for size in said.sizes if size is not None)
    facts = [("Shape", shape), *((("Mass", f"{said.mass_kg:g} kg"),) if said.mass_kg is not None else ())]
    facts += [("Surface", said.surface)] if said.surface is not None else []
    friction = friction_of(said)
    between = "" if friction.low == friction.high else f" ({friction.low:g} to {friction.high:g})"
    facts += [
        ("Friction", f"{friction.value:g}{between}; {friction.source}"),
        ("Fitted half width", f"{1000.0 * one.parameters.half_width:.1f} mm"),
        ("Fitted restitution", f"{one.parameters.restitution:.2f} of Housner's"),
    ]
    return ValidatedBody(one.name, facts, one.notes, [_prediction(name, score) for name, score in predictions(one)])


def predictions(one: BodyValidation) -> list[tuple[str, Score]]:
    """Return every prediction of a body with its score, by its name in words."""
    return [
        ("it always stands", one.standing),
        ("threshold of peak velocity", one.threshold),
        ("two numbers fitted", one.fitted),
        ("nothing fitted", one.unfitted),
        *one.others.items(),
    ]


def _prediction(name: str, score: Score) -> PredictionView:
    # What says only yes or no states no probability.
    sure = all(b.stated in (0.0, 1.0) for b in score.bins)
    return PredictionView(
        name=name,
        accuracy=score.accuracy,
        brier=score.brier,
        coverage="" if sure else f"{score.coverage:.3f} ({score.stated:.3f})",
        confusion=(score.fell_as_said, score.fell_unsaid, score.stood_as_said, score.stood_unsaid),
        bins=() if sure else [ReliabilityView(b.runs, b.stated, b.observed) for b in score.bins],
    )
