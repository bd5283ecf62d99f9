"""How likely an object comes to harm, in words, and as columns of an export."""

from dataclasses import dataclass

from pipeline.records import Assessment, Band, Harm, Likelihood
from pipeline.report.language import _
from pipeline.report.text import clean


@dataclass(frozen=True, slots=True)
class ChanceView:
    """How likely an object comes to harm: the word for it, what it is likeliest to do, and the numbers behind that.

    level : of shaking, at which that is likeliest
    """

    band: str
    sentence: str
    numbers: str
    level: str


def chance_view(assessment: Assessment) -> ChanceView | None:
    """Return what is said of how likely an object comes to harm; None where nobody knows."""
    found = assessment.likelihood
    if found is None:
        return None
    share = f"{found.probability:.0%}" if found.samples and found.probability >= _LEAST else _("below 1 %")
    numbers = _("%(share)s ± %(error)s of %(samples)s samples of all that is uncertain") % {
        "share": share,
        "error": f"{100.0 * found.error:.1f} %",
        "samples": found.samples,
    }
    others = [f"{_STATES[Harm(name)]()} {p:.0%}" for name, p in found.states.items() if p >= _LEAST]
    more = f": {', '.join(others)}" if others else ""
    return ChanceView(_BANDS[found.band](), _sentence(found), f"{numbers}{more}.", clean(found.level))


def chance_columns(assessment: Assessment) -> dict[str, str | float | None]:
    """Return the columns of an export that tell how likely an object comes to harm; empty where nobody knows."""
    found = assessment.likelihood
    states = {} if found is None else found.states
    return {
        "probability": None if found is None else found.probability,
        "probability_error": None if found is None else found.error,
        "band": "" if found is None else found.band.value,
        "harm": "" if found is None else found.harm,
        "harm_level": "" if found is None else found.level,
        **{f"p_{state.value}": states.get(state.value) for state in Harm},
    }


_LEAST = 0.01

# Looked up in the language of the page.
_BANDS = {
    Band.ALMOST_CERTAIN: lambda: _("almost certain"),
    Band.LIKELY: lambda: _("likely"),
    Band.POSSIBLE: lambda: _("possible"),
    Band.UNLIKELY: lambda: _("unlikely"),
    Band.VERY_UNLIKELY: lambda: _("very unlikely"),
}
_STATES = {
    Harm.SHIFTS: lambda: _("shifts"),
    Harm.LEAVES: lambda: _("leaves its place or hits something"),
    Harm.ROCKS: lambda: _("rocks"),
    Harm.FALLS: lambda: _("falls"),
    Harm.BREAKS: lambda: _("breaks"),
}


def _sentence(found: Likelihood) -> str:
    """Say what is likeliest to harm it, and how likely any harm is."""
    band = _BANDS[found.band]()
    if not found.harm:
        return _("That it comes to harm is %(band)s.") % {"band": band}
    return _("That it comes to harm is %(band)s; it most likely %(harm)s.") % {
        "band": band,
        "harm": _STATES[Harm(found.harm)](),
    }
