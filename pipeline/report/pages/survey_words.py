"""Survey in words, what is worth measuring: for one object, for a gallery as a list, for the museum in a sentence."""

from collections.abc import Iterable, Mapping, Sequence

from pipeline.analysis.survey import ENDS, measurables
from pipeline.records import Assessment, MeasurementRequest, Tally, times_too_thin
from pipeline.report.language import _, local, ngettext, said
from pipeline.report.pages.views import ObjectView, SurveyView, WishView
from pipeline.report.text import clean, count, words
from pipeline.report.units import Units, percent, significant

SURVEY_SECONDS = "survey_seconds"
"""The setting of a run that says what its survey cost."""


def wish_views(wishes: Iterable[MeasurementRequest], units: Units) -> tuple[WishView, ...]:
    """Return what is worth measuring on one object, what settles most first; what settles nothing comes last."""
    order = [m.field for m in measurables()]
    ordered = sorted(wishes, key=lambda w: (-w.gain, order.index(w.field)))
    return tuple(
        WishView(
            what=_label(one.field),
            effect=_effect(one),
            now="" if one.low is None or one.high is None else units.pair(one.low, one.high, one.unit),
            waste=one.settles_nothing,
        )
        for one in ordered
    )


def errands(
    pairs: Sequence[tuple[Assessment, ObjectView]], wishes: Mapping[str, Sequence[MeasurementRequest]]
) -> tuple[SurveyView, ...]:
    """Group what is worth measuring in a gallery by quantity, for one tool serves many objects."""
    how = {m.field: said(m.how) for m in measurables()}
    order = list(how)
    found: dict[str, list[tuple[float, MeasurementRequest, ObjectView]]] = {}
    for assessment, view in pairs:
        item = assessment.scene.item
        for request in wishes.get(item.object_number, ()):
            if item.on_display and not request.settles_nothing and request.gallery == item.gallery:
                found.setdefault(request.field, []).append((request.gain, request, view))
    ranked = sorted(found.items(), key=lambda entry: (-sum(e[0] for e in entry[1]), order.index(entry[0])))
    out = []
    for name, entries in ranked:
        entries.sort(key=lambda entry: -entry[0])
        settles, unlocks = sum(w.settles for _g, w, _v in entries), sum(w.unlocks for _g, w, _v in entries)
        objects = tuple(view for _gain, _request, view in entries)
        out.append(SurveyView(_label(name), how.get(name, ""), _gain(settles, unlocks), objects))
    return tuple(out)


def survey_sentence(tally: Tally, seconds: float) -> str:
    """Say how many measurements would settle something, and what finding that out cost; "" where it was not asked."""
    if not tally.surveyed:
        return ""
    phrase = ngettext("%(count)s measurement", "%(count)s measurements", tally.worth)
    measurements = phrase % {"count": count(tally.worth)}
    on = ngettext("on %(count)s object", "on %(count)s objects", tally.wished) % {"count": count(tally.wished)}
    told = [
        _("%(measurements)s %(objects)s may change what is decided.") % {"measurements": measurements, "objects": on}
        if tally.worth
        else _("No one measurement would change what is decided.")
    ]
    if tally.waste:
        others = ngettext(
            "%(count)s other alone would settle nothing.", "%(count)s others alone would settle nothing.", tally.waste
        )
        told.append(others % {"count": count(tally.waste)})
    if seconds:
        told.append(_("Finding this out took %(seconds)s\u00a0s.") % {"seconds": local(f"{seconds:.1f}")})
    return " ".join(told)


def missing_words(missing: str) -> str:
    """Return what is missing in a record as who keeps it says it."""
    times = times_too_thin(missing)
    if times is not None:
        told = _(
            "how it is held (it is %(times)s times as high as it is deep: "
            "it cannot stand by itself, or a measure is wrong)"
        )
        return told % {"times": times}
    return said(words(missing))


def _label(field: str) -> str:
    label = next((m.label for m in measurables() if m.field == field), "")
    return said(label) if label else words(clean(field))


def _effect(request: MeasurementRequest) -> str:
    if request.unlocks:
        return _("without it nothing can be said")
    if request.settles_nothing:
        return _("alone it settles nothing")
    if request.drawn:
        return _("changes what is decided with a chance of %(share)s") % {"share": percent(min(request.settles, 1.0))}
    if request.open == 1:
        # The mean over three trials that either settle the verdict or do not: a whole number of them.
        return _("settles it in %(number)s of %(trials)s trials") % {
            "number": round(request.settles * len(ENDS)),
            "trials": len(ENDS),
        }
    return _("settles %(settles)s of %(open)s open verdicts on average") % {
        "settles": significant(request.settles, 2),
        "open": request.open,
    }


def _gain(settles: float, unlocks: int) -> str:
    told = []
    if settles:
        about = max(1, round(settles))
        told.append(_("may change what is decided for %(count)s of them") % {"count": count(about)})
    if unlocks:
        phrase = ngettext("makes %(count)s check possible", "makes %(count)s checks possible", unlocks)
        told.append(phrase % {"count": count(unlocks)})
    return ", ".join(told)
