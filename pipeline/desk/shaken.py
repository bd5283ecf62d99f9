"""After an earthquake: where to look first, and one tap for what was found; the rest is sorted anew by it."""

from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from threading import Lock
from typing import Any

from pipeline.desk.asking import Asked, DeskAnswer, address, page_number
from pipeline.desk.event_facts import EventFacts
from pipeline.desk.guard import DeskError, NotThereError, StaleError
from pipeline.desk.saying import signed
from pipeline.errors import InputError, KourosError
from pipeline.event.answer import ObjectAnswer
from pipeline.event.found import NOTE_LIMIT, STATES, FoundObject, distance_said
from pipeline.report.language import said
from pipeline.report.pages.event_page import told_of
from pipeline.report.text import short
from pipeline.report.units import Units, percent
from pipeline.store.event_reports import EventReport, add_event_reports
from pipeline.tools.decisions import person_here
from pipeline.tools.event import answer_again
from pipeline.tools.event_folders import report_of

SHOWN = 100
"""Objects of a gallery on one page."""

_ONE_AT_A_TIME = Lock()


@dataclass(frozen=True, slots=True)
class FoundView:
    """What somebody found of an object, in words: the state, how far it has moved, a note, who and when."""

    state: str
    words: str
    note: str
    who: str
    when: str


@dataclass(frozen=True, slots=True)
class ShakenObject:
    """An object of a gallery after an earthquake.

    Attributes
    ----------
    at : int
        Its place on the page, by which it is found again.
    told : str
        What has probably become of it, in words.
    chance : str
        Of any harm, as a share of a hundred; "" where nobody knows.
    version : int
        Id of the newest report, which whoever reports must have seen.
    """

    at: int
    number: str
    title: str
    case: str
    told: str
    chance: str
    make_safe: bool
    aftershock: bool
    found: tuple[FoundView, ...]
    version: int

    @property
    def last(self) -> FoundView | None:
        """What was found last."""
        return self.found[-1] if self.found else None


def event_page(asked: Asked) -> DeskAnswer:
    """Show the galleries, where most is lost first."""
    return DeskAnswer("event.html", _event_context(asked, asked.query))


def gallery_page(asked: Asked) -> DeskAnswer:
    """Show the objects of a gallery, each with one tap for what was found."""
    return DeskAnswer("event_gallery.html", _gallery_context(asked, asked.query))


def say_found(asked: Asked) -> DeskAnswer:
    """Keep what somebody found of an object.  No lock is waited for: a night at work does not stop it."""
    form = asked.form
    number = form.get("number", "")
    try:
        signed(asked)
        facts = asked.site.events.facts(form.get("event", ""))
        ours = facts.numbers.get(number)
        if ours is None:
            raise NotThereError(f"object {number[:60]!r} is not on display in the newest run")
        found = _found(form, asked.site.run.units)
        now = datetime.now(UTC).isoformat(timespec="seconds")
        seen = form.get("version", "")
        last = int(seen) if seen.isdecimal() and len(seen) < 16 else 0
        with _ONE_AT_A_TIME:
            report = report_of(facts.event.name, ours, found, asked.name, now)
            others = add_event_reports(asked.site.workspace.engine, [report], {ours: last})
        if others:
            raise StaleError(_stale(number, others[0], asked.site.run.units))
    except NotThereError:
        raise
    except KourosError as problem:
        context = _gallery_context(asked, form, problem=str(problem), typed=form)
        return DeskAnswer("event_gallery.html", context, _status(problem))
    here = {name: form.get(name, "") for name in ("event", "gallery", "page")}
    who = "" if asked.who.known else asked.name
    place = form.get("at", "")
    anchor = f"#o{place}" if place.isdecimal() and len(place) < 7 else ""
    return DeskAnswer(to=address("/event/gallery", **here, who=who, saved="found") + anchor)


def say_again(asked: Asked) -> DeskAnswer:
    """Work out the answer again, by all that was found."""
    form = asked.form
    try:
        facts = asked.site.events.facts(form.get("event", ""))
        with _ONE_AT_A_TIME:
            answer_again(asked.site.workspace, facts.event.name)
    except NotThereError:
        raise
    except KourosError as problem:
        return DeskAnswer("event.html", _event_context(asked, form, problem=str(problem)), _status(problem))
    kept = {name: form.get(name, "") for name in ("event", "who")}
    if "gallery" in form:
        # A gallery without a name is one too.
        return DeskAnswer(to=address("/event/gallery", **kept, gallery=form["gallery"], saved="again"))
    return DeskAnswer(to=address("/event", **kept, saved="again"))


def _found(form: Mapping[str, str], units: Units) -> FoundObject:
    state, note, moved = form.get("state", ""), form.get("note", "").strip(), form.get("moved", "").strip()
    if state not in STATES:
        raise DeskError("say what you found: standing, moved, fallen or broken")
    if len(note) > NOTE_LIMIT:
        raise DeskError(f"a note has at most {NOTE_LIMIT} characters: say it shorter")
    if not moved:
        return FoundObject(state, None, note)
    if state != "moved":
        raise DeskError("a distance goes with moved: leave it out, or write it into the note")
    return FoundObject(state, distance_said(moved, units.length), note)


def _stale(number: str, other: EventReport, units: Units) -> str:
    view = _view(other, units)
    return (
        f"{other.who} has said since of {number}: {view.words} ({view.when}). Nothing of yours was saved: tap again if "
        "yours holds."
    )


def _status(problem: KourosError) -> int:
    return 409 if isinstance(problem, StaleError) else 422 if isinstance(problem, InputError) else 503


def _event_context(asked: Asked, query: Mapping[str, str], *, problem: str = "") -> dict[str, Any]:
    facts = asked.site.events.facts(query.get("event", ""))
    rows = []
    for gallery in facts.document["galleries"]:
        looked = sum(bool(facts.found(one.number)) for one in facts.galleries.get(gallery["gallery"], ()))
        rows.append((gallery, looked, f"{gallery['fallen']:.1f}"))
    return _shared(asked, facts, query, problem) | {"galleries": rows, "earlier": facts.others}


def _gallery_context(
    asked: Asked, query: Mapping[str, str], *, problem: str = "", typed: Mapping[str, str] | None = None
) -> dict[str, Any]:
    facts = asked.site.events.facts(query.get("event", ""))
    name = query.get("gallery", "")
    if name not in facts.galleries:
        raise NotThereError(f"there is no gallery {name[:60]!r} in this answer")
    # What is to be made safe comes first, as on its sheet.
    walk = sorted(facts.galleries[name], key=lambda one: not one.make_safe)
    page = page_number(query)
    units = asked.site.run.units
    shown = [_object(one, at, facts, units) for at, one in enumerate(walk)][SHOWN * (page - 1) : SHOWN * page]
    return _shared(asked, facts, query, problem) | {
        "name": name, "objects": shown, "page": page, "more": len(walk) > SHOWN * page, "typed": dict(typed or {}),
        "total": len(walk), "looked": sum(bool(facts.found(one.number)) for one in walk), "unit": units.length,
        "states": [(state, said(state)) for state in STATES],
    }  # fmt: skip


def _shared(asked: Asked, facts: EventFacts, query: Mapping[str, str], problem: str) -> dict[str, Any]:
    down = facts.document["expected"]
    return {
        "event": facts.event, "title": facts.event.title, "problem": problem,
        "exercise": bool(facts.document["event"].get("scenario")), "down": down, "fallen": f"{down['fallen']:.0f}",
        "open": facts.open, "saved": query.get("saved", ""),
        # After an earthquake no tap is lost for want of a name.
        "by": query.get("who", "")[:200] or asked.who.name or person_here(),
    }  # fmt: skip


def _object(one: ObjectAnswer, at: int, facts: EventFacts, units: Units) -> ShakenObject:
    reports = facts.found(one.number)
    chance = "" if one.probability is None or one.reported else percent(one.probability)
    return ShakenObject(
        at, one.number, short(one.title), one.case, told_of(one), chance, one.make_safe, one.aftershock,
        tuple(_view(report, units) for report in reports), reports[-1].id if reports else 0,
    )  # fmt: skip


def _view(report: EventReport, units: Units) -> FoundView:
    words = said(report.state)
    if report.moved_m is not None:
        words = f"{words} {units.text(report.moved_m, 'm')}"
    return FoundView(report.state, words, report.note, report.who, f"{report.recorded[:16].replace('T', ' ')} UTC")
