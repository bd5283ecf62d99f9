"""How likely an object comes to harm, in words, and as columns of an export."""

from dataclasses import dataclass
from functools import cache

from pipeline.analysis.classify import object_classes
from pipeline.analysis.stakes import Term, Worth, doubtful, expected_loss, ill_weighed, to_check
from pipeline.analysis.survey import measurables, size_behind
from pipeline.models.rigid_body import rocking_harms
from pipeline.records import Assessment, Band, Harm, IfClass, Likelihood, Mount, Recommendation, Scene, Support
from pipeline.records.likelihood import CLASS
from pipeline.report.language import _, local, said
from pipeline.report.text import clean, words
from pipeline.report.units import percent

ACTED = (Band.ALMOST_CERTAIN, Band.LIKELY, Band.POSSIBLE)
"""Words for what something is done about."""

_RATHER = (Band.ALMOST_CERTAIN, Band.LIKELY)
"""Words for what rather happens than not."""

MOUNT = "mount"
"""What is asked where nobody recorded how a mount holds an object."""

_LEAST_MORE = 0.05
"""By how much rocking must be likelier than falling for it to be said that rocking counts."""

_LOST = (Harm.FALLS, Harm.BREAKS)
"""What no repair undoes."""


@dataclass(frozen=True, slots=True)
class ChanceView:
    """How likely an object comes to harm, what it is likeliest to do, and the numbers behind that.

    level : of shaking, at which that is likeliest;  check : why its record is to be looked at first, "" for no reason;
    ask : what one would measure, or say, to decide otherwise;  classes : what it may be, and how likely harm is then;
    unnamed : whether naming it decides first, for the class that it is taken for would not be acted on;
    share : the probability of harm as people read it;  percent : the same as a number, 0 to 100;  lost : whether it is
    likely that it falls or breaks;  slender : whether its record is to be checked, for it hardly stands like that
    """

    sentence: str
    numbers: str
    level: str
    check: str = ""
    ask: str = ""
    classes: str = ""
    unnamed: bool = False
    share: str = ""
    percent: float = 0.0
    lost: bool = False
    slender: bool = False


def chance_view(assessment: Assessment) -> ChanceView | None:
    """Return what is said of how likely an object comes to harm; None where nobody knows."""
    found = assessment.likelihood
    if found is None:
        return None
    numbers = _("%(share)s ± %(error)s of %(samples)s samples") % {
        "share": _percent(found.probability),
        "error": percent(found.error, 1),
        "samples": found.samples,
    }
    likely = ((name, p) for name, p in found.states.items() if p >= _LEAST)
    others = [f"{state_word(Harm(name), assessment.scene)} {_percent(p)}" for name, p in likely]
    more = f": {', '.join(others)}" if others else ""
    slender = doubtful(assessment.scene)
    check = ""
    if slender:
        check = _(
            "Check its record first: it is %(times)s times as high as it is deep, "
            "and such a thing hardly stands like that."
        )
        check %= {"times": local(f"{slender:.1f}")}
    ill = ill_weighed(assessment.scene)
    if ill:
        check = " ".join(filter(None, (check, _("Check its record first: its weight does not go with its size."))))
    unnamed = _unnamed(found)
    if unnamed:
        asked = _(" or ").join(f"“{class_title(name)}”" for one in found.classes for name in one.classes)
        check = " ".join(filter(None, (check, _("Say first what it is: %(classes)s?") % {"classes": asked})))
    classes = ", ".join(map(_if_class, found.classes))
    return ChanceView(
        _sentence(found, assessment.scene),
        " ".join(filter(None, (f"{numbers}{more}.", _by_rocking(assessment.scene, found)))),
        clean(found.level),
        check,
        _asked(assessment),
        classes,
        unnamed,
        _percent(found.probability),
        round(100.0 * found.probability, 1),
        bool(found.harm) and found.band in _RATHER and Harm(found.harm) in _LOST,
        bool(slender) or ill,
    )


def _by_rocking(scene: Scene, found: Likelihood) -> str:
    """Say that rocking itself counts as harm, where more rocks than falls; "" elsewhere."""
    rocks, falls = (found.states.get(state.value, 0.0) for state in (Harm.ROCKS, Harm.FALLS))
    if not rocking_harms(scene) or rocks - falls < _LEAST_MORE:
        return ""
    return _(
        "Rocking counts as harm to it, as an edge that lifts strikes back and may chip; where it would do no harm, "
        "record that it is not susceptible, and falling alone will count."
    )


def class_title(name: str) -> str:
    """Return what people call a class of objects, such as "Painting or framed work"."""
    return said(clean(object_classes().get(name, name.replace("_", " "))))


def _unnamed(found: Likelihood) -> bool:
    """Say whether something is done about it only for what else it may be."""
    if not found.classes or found.band not in ACTED:
        return False
    return found.classes[0].band is not None and found.classes[0].band not in ACTED


def _if_class(one: IfClass) -> str:
    """Say what an object may be, and how likely harm is then."""
    named = _(" or ").join(words(clean(name)) for name in one.classes)
    told = {"what": named, "chance": local(f"{one.chance:.2f}")}
    if one.probability is None or one.samples < _TELLING:
        return _("%(what)s (%(chance)s): too few samples to tell") % told
    return _("%(what)s (%(chance)s): harm %(share)s") % (told | {"share": _percent(one.probability)})


def _asked(assessment: Assessment) -> str:
    """Say what is to be found out where that alone may change what is decided; "" for nothing."""
    parameter, scene = open_for(assessment), assessment.scene
    if parameter == CLASS:
        return _("Say what it is.")
    if parameter == MOUNT:
        return _("Say whether its mount holds it by clips, wire or screws, or only carries it.")
    return _("Measure: %(what)s") % {"what": name_of(size_behind(scene, parameter) or parameter)} if parameter else ""


def worth_words(scene: Scene, worth: Worth) -> str:
    """Say what an object counts where losses are compared, and what that rests on."""
    item = scene.item
    told = {
        Term.CLASS: _("class %(name)s") % {"name": clean(item.value_class)},
        Term.VALUE: _("valued at %(money)s") % {"money": local(f"{item.value or 0.0:,.0f}")},
        Term.IRREPLACEABLE: _("irreplaceable"),
        Term.ON_LOAN: _("on loan"),
    }
    rests = ", ".join(told[term] for term in worth.terms) or _("nothing is recorded of its value")
    return _("counts %(weight)s: %(rests)s") % {"weight": local(f"{worth.weight:.3g}"), "rests": rests}


def left_over(advice: Recommendation) -> str:
    """Say how likely harm is that a measure leaves; "" where its checks exclude it, and where nobody drew it."""
    if advice.remaining is None:
        return ""
    said_so = _("A chance of %(share)s remains that it comes to harm.")
    return " " + said_so % {"share": _percent(advice.remaining)}


def _percent(probability: float) -> str:
    return percent(probability) if probability >= _LEAST else _("below 1 %")


def open_for(assessment: Assessment) -> str:
    """Return what alone may change what is decided about an object: a parameter, CLASS or MOUNT; "" for nothing."""
    found = assessment.likelihood
    parameter = "" if found is None else found.open_for
    # Nobody measures the friction of what a mount carries: how that grips is looked at.
    return MOUNT if parameter == "friction_static" and assessment.scene.mount is Mount.UNKNOWN else parameter


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
        "open_for": open_for(assessment),
        "worth": found.worth if found is not None and found.open_for else None,
        "expected_loss": None if found is None else expected_loss(assessment),
        "check_sizes": to_check(assessment),
    }


@cache
def _measured() -> dict[str, str]:
    """Return what one would measure, by parameter: of several fields that tell it the first."""
    out: dict[str, str] = {}
    for row in measurables():
        for name in row.parameters:
            out.setdefault(name, row.label)
    return out


def name_of(parameter: str) -> str:
    """Say what one would measure, or look at, to know a parameter, CLASS or MOUNT."""
    if parameter == CLASS:
        return _("What it is")
    if parameter == MOUNT:
        return _("How its mount holds it")
    return said(_measured()[parameter]) if parameter in _measured() else words(parameter)


_LEAST = 0.01
_TELLING = 16
"""Samples of one class from which on its probability is told: none of 16 harmed says below 10 % with one of 0.93."""

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
    Harm.ROCKS: lambda: _("rocks"),
    Harm.FALLS: lambda: _("falls"),
    Harm.BREAKS: lambda: _("breaks"),
}


def band_word(band: Band) -> str:
    """Return the word for a probability."""
    return _BANDS[band]()


# What leaves its place does it by the way in which it is held.
_LEAVES = {
    Support.HUNG: lambda: _("swings against something"),
    Support.SUSPENDED: lambda: _("swings against something"),
    Support.ISOLATED: lambda: _("hits something"),
}


def state_word(state: Harm, scene: Scene) -> str:
    """Return a state in words, of an object that is held as the scene says."""
    if state is Harm.LEAVES:
        support = scene.support
        return _LEAVES[support]() if support in _LEAVES else _("slides off or into something")
    return _STATES[state]()


def _sentence(found: Likelihood, scene: Scene) -> str:
    """Say what is likeliest to harm it, and how likely any harm is."""
    band = _BANDS[found.band]()
    if not found.harm:
        return _("Harm is %(band)s.") % {"band": band}
    # What need not happen is not told as if it did.
    said_so = (
        _("Harm is %(band)s; it most likely %(harm)s.")
        if found.band in _RATHER
        else _("Harm is %(band)s; if it comes to that, it most likely %(harm)s.")
    )
    return said_so % {"band": band, "harm": state_word(Harm(found.harm), scene)}
