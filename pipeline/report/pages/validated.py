"""The page of a validation: how often the models are right about bodies that really fell or stood."""

from collections.abc import Sequence
from dataclasses import dataclass

from pipeline.records import Axis, Chart, Curve
from pipeline.report.language import Language, speaking
from pipeline.report.pages.environment import environment, fill
from pipeline.report.plots.chart import PATTERNS, Drawing
from pipeline.report.text import clean
from pipeline.report.units import Units


@dataclass(frozen=True, slots=True)
class ReliabilityView:
    """A bin of the reliability diagram: how many runs, the probability that was stated, the share that fell."""

    runs: int
    stated: float
    observed: float


@dataclass(frozen=True, slots=True)
class PredictionView:
    """A prediction and its scores.

    Attributes
    ----------
    name : str
        What predicts.
    accuracy, brier : float
        As `pipeline.verification.validation.Score` has them.
    coverage : str
        Observed and stated, or "" where it states no probability.
    confusion : (int, int, int, int)
        Fell as was said, fell unsaid, stood as was said, stood though it was to fall.
    bins : sequence of ReliabilityView
        Empty where it states no probability.
    """

    name: str
    accuracy: float
    brier: float
    coverage: str
    confusion: tuple[int, int, int, int]
    bins: Sequence[ReliabilityView] = ()


@dataclass(frozen=True, slots=True)
class ValidatedBody:
    """A body of an experiment: what was fitted for it, what is doubtful of it, and every prediction of it."""

    name: str
    facts: Sequence[tuple[str, str]]
    notes: Sequence[str]
    predictions: Sequence[PredictionView]


@dataclass(frozen=True, slots=True)
class ValidationView:
    """An experiment that the models were held against: what is said of it, and its bodies."""

    title: str
    version: str
    facts: Sequence[tuple[str, str]]
    bodies: Sequence[ValidatedBody]
    priors: Sequence[tuple[str, str, str]]


def validation_page(view: ValidationView, language: Language | None = None) -> str:
    """Return the page as HTML.

    Parameters
    ----------
    view : ValidationView
        What it shows.
    language : Language, optional
        English where none is given.

    Returns
    -------
    str
        One file that needs no other.
    """
    spoken = language or Language()
    with speaking(spoken):
        drawings = [_reliability(body, at) for at, body in enumerate(view.bodies)]
        symbols = PATTERNS
        for one in drawings:
            symbols += one.symbol()
        pictures = [one.figure((), "") for one in drawings]
        context = {"view": view, "pictures": pictures, "captions": [d.caption for d in drawings]}
        return clean(fill(environment(spoken), "validation.html", {**context, "symbols": symbols}))


def _reliability(body: ValidatedBody, at: int) -> Drawing:
    curves = [Curve("as stated", (0.0, 1.0), (0.0, 1.0))]
    curves += [
        Curve(one.name, tuple(b.stated for b in one.bins), tuple(b.observed for b in one.bins))
        for one in body.predictions
        if len(one.bins) > 1
    ]
    chart = Chart(
        key=f"reliability:{at}",
        title=f"Reliability of what is said of {body.name}",
        caption="Runs are put together by the probability of overturning that was stated; where it is reliable, as "
        "large a share of them fell, and the line lies on the straight one.",
        x=Axis("Probability that was stated", "-"),
        y=Axis("Share that overturned", "-"),
        curves=tuple(curves),
    )
    return Drawing(chart, Units(), f"v{at}")
