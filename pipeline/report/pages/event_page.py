"""The page of an earthquake that has just happened, and the sheets to walk with: one for each gallery."""

from collections.abc import Sequence
from dataclasses import dataclass

from pipeline.event.answer import Answer, GalleryAnswer, ObjectAnswer
from pipeline.event.message import ReportedEarthquake
from pipeline.report.language import Language, _, ngettext, said, speaking
from pipeline.report.pages.compose import PageHead
from pipeline.report.pages.environment import environment, fill
from pipeline.report.text import clean, count, short, slug
from pipeline.report.units import percent

FIRST = 60
"""Objects that the page lists in each of its lists; the table beside it has all."""

LIKELY, POSSIBLE = 0.5, 0.1
"""Probabilities from which on a state is told as likely and as possible, as the words of `[likelihood]` begin."""


@dataclass(frozen=True, slots=True)
class EventObject:
    """An object in a list: where it is, and what has probably become of it, in words and as a chance."""

    number: str
    title: str
    gallery: str
    case: str
    told: str
    harm: str
    fallen: str
    moved: str
    loss: str


@dataclass(frozen=True, slots=True)
class EventGallery:
    """A gallery in the order of what is lost: how many objects are down, in which range, and its sheet."""

    name: str
    floor: str
    objects: str
    fallen: str
    low: str
    high: str
    loss: str
    make_safe: str
    unknown: int
    sheet: str


@dataclass(frozen=True, slots=True)
class EventView:
    """The page; all texts are ready to be shown.

    Attributes
    ----------
    lede : str
        How many objects are down, with the range.
    facts : tuple[tuple[str, str], ...]
        Names and values of the earthquake and of the shaking.
    notes : tuple of str
        What a reader has to know of these numbers.
    safe, first, aftershock : tuple of EventObject
        Lists of objects.
    rests : str
        What the probabilities are from.
    """

    name: str
    scenario: bool
    lede: str
    facts: tuple[tuple[str, str], ...]
    notes: tuple[str, ...]
    unknown: str
    looked: str
    galleries: tuple[EventGallery, ...]
    safe: tuple[EventObject, ...]
    first: tuple[EventObject, ...]
    aftershock: tuple[EventObject, ...]
    rests: str = ""


def event_page(
    answer: Answer,
    quake: ReportedEarthquake,
    distance_km: float | None,
    head: PageHead,
    language: Language,
    ran: tuple[int, str] = (0, ""),
) -> str:
    """Return the page as HTML.

    Parameters
    ----------
    answer : Answer
        What the shaking did.
    quake : ReportedEarthquake
        Which it was.
    distance_km : float or None
        Of its epicentre from the museum.
    head : PageHead
        Of the run that the answer rests on.
    language : Language
        The reader's.
    ran : (int, str)
        Of how many objects the models were run for this answer, and under what.
    """
    with speaking(language):
        view = event_view(answer, quake, distance_km, ran)
        return fill(environment(language), "event.html", {"museum": head, "event": view, "here": "event"})


def event_sheets(answer: Answer, quake: ReportedEarthquake, head: PageHead, language: Language) -> dict[str, str]:
    """Return a sheet to print for each gallery, by file name."""
    by_gallery: dict[str, list[ObjectAnswer]] = {}
    for one in answer.objects:
        by_gallery.setdefault(one.gallery, []).append(one)
    out = {}
    with speaking(language):
        env = environment(language)
        for gallery in answer.galleries:
            those = sorted(by_gallery[gallery.name], key=lambda one: not one.make_safe)
            context = {
                "museum": head,
                "here": "event",
                "name": clean(quake.name or quake.id),
                "gallery": _gallery(gallery),
                "objects": [(_object(one), one.make_safe) for one in those],
            }
            out[sheet_name(gallery.name)] = fill(env, "event_sheet.html", context)
    return out


def sheet_name(gallery: str) -> str:
    """Return the file name of a gallery's sheet."""
    return f"sheet-{slug(gallery)}.html"


def event_view(
    answer: Answer, quake: ReportedEarthquake, distance_km: float | None, ran: tuple[int, str] = (0, "")
) -> EventView:
    """Return what the page shows."""
    shaken = [one for one in answer.objects if one.probability is not None]
    safe = sorted((one for one in shaken if one.make_safe), key=lambda one: -one.danger * (one.moved + one.fallen))
    weaker = sorted((one for one in shaken if one.aftershock), key=lambda one: -one.moved * (one.value + one.danger))
    unknown = answer.unknown
    return EventView(
        name=clean(quake.name or quake.id) or _("An earthquake"),
        scenario=quake.scenario,
        lede=lede(answer),
        facts=tuple(_facts(answer, quake, distance_km)),
        notes=tuple(clean(note) for note in answer.shaking.notes),
        unknown=""
        if not unknown
        else ngettext(
            "Of {count} object nothing is known: go and see.",
            "Of {count} objects nothing is known: go and see.",
            unknown,
        ).format(count=count(unknown)),
        looked=_looked(sum(bool(one.reported) for one in answer.objects)),
        galleries=tuple(_gallery(one) for one in answer.galleries),
        safe=_listed(safe),
        first=_listed(shaken),
        aftershock=_listed(weaker),
        rests=_rests(*ran),
    )


def _looked(number: int) -> str:
    if not number:
        return ""
    return ngettext(
        "What was found of {count} object is counted; of the others these are probabilities.",
        "What was found of {count} objects is counted; of the others these are probabilities.",
        number,
    ).format(count=count(number))


def _rests(number: int, under: str) -> str:
    """Return in words what the probabilities are from."""
    words = _(
        "The probabilities are from the curves of the last run, at the peak acceleration and velocity of this "
        "earthquake, over the range that these may have."
    )
    if not number:
        none = _("No model was run again.")
        return f"{words} {none}"
    more = ngettext(
        "Of the {count} object of which most is lost all models were run again, under {under}.",
        "Of the {count} objects of which most is lost all models were run again, under {under}.",
        number,
    ).format(count=count(number), under=clean(under))
    return f"{words} {more}"


def lede(answer: Answer) -> str:
    """Return in a sentence how many objects are down."""
    words = _("Of {objects} objects on display about {fallen} have probably fallen; in 9 of 10 cases {low} to {high}.")
    down = answer.count
    return words.format(
        objects=count(len(answer.objects)),
        fallen=count(round(down.fallen)),
        low=count(down.low),
        high=count(down.high),
    )


def _facts(answer: Answer, quake: ReportedEarthquake, distance_km: float | None) -> list[tuple[str, str]]:
    shaking = answer.shaking
    low, high = shaking.pga_range()
    facts = []
    if quake.time is not None:
        facts.append((_("Time"), f"{quake.time:%Y-%m-%d %H:%M:%S} UTC"))
    if quake.magnitude is not None:
        facts.append((_("Magnitude"), f"{quake.magnitude:.1f}"))
    if distance_km is not None:
        facts.append((_("Epicentre"), _("{km}\u00a0km from the museum").format(km=f"{distance_km:.0f}")))
    between = _("{value}; in 9 of 10 cases {low} to {high}")
    facts.append(
        (
            _("Peak acceleration here"),
            between.format(value=f"{shaking.pga_g:.3f} g", low=f"{low:.3f}", high=f"{high:.3f} g"),
        )
    )
    if shaking.pgv_cm_s is not None:
        low, high = shaking.pgv_range()
        facts.append(
            (
                _("Peak velocity here"),
                between.format(
                    value=f"{shaking.pgv_cm_s:.1f}\u00a0cm/s", low=f"{low:.1f}", high=f"{high:.1f}\u00a0cm/s"
                ),
            )
        )
    facts.append((_("From"), clean(shaking.origin)))
    return facts


def _listed(objects: Sequence[ObjectAnswer]) -> tuple[EventObject, ...]:
    return tuple(_object(one) for one in objects[:FIRST])


def _percent(value: float) -> str:
    return percent(value) if value >= 0.01 or value == 0.0 else "<1\u00a0%"


def _object(one: ObjectAnswer) -> EventObject:
    known = one.probability is not None
    return EventObject(
        clean(one.number),
        short(one.title),
        clean(one.gallery),
        clean(one.case),
        told_of(one),
        _percent(one.probability or 0.0) if known else "?",
        _percent(one.fallen) if known else "?",
        _percent(one.moved) if known else "?",
        f"{one.expected_loss:.2f}" if known else "?",
    )


def told_of(one: ObjectAnswer) -> str:
    """Return in words what has probably become of an object."""
    if one.reported:
        return _("found: {state}").format(state=said(one.reported))
    if one.probability is None:
        return _("not known")
    if one.fallen >= LIKELY:
        return _("likely fallen")
    if one.probability >= LIKELY:
        return _("likely harmed")
    if one.moved >= LIKELY:
        return _("likely moved")
    if one.fallen >= POSSIBLE:
        return _("possibly fallen")
    if one.probability >= POSSIBLE:
        return _("possibly harmed")
    return _("possibly moved") if one.moved >= POSSIBLE else _("probably as it was")


def _gallery(one: GalleryAnswer) -> EventGallery:
    return EventGallery(
        clean(one.name),
        clean(one.floor),
        count(one.objects),
        f"{one.count.fallen:.1f}",
        count(one.count.low),
        count(one.count.high),
        f"{one.expected_loss:.1f}",
        count(one.make_safe),
        one.unknown,
        sheet_name(one.name),
    )
