"""The sheet to walk a gallery with: what to do there object by object, in few words, and the number to set."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from string import Formatter

from pipeline.mitigate.by_class import NAMED_FIRST
from pipeline.mitigate.saying import ANCHORED, EACH_PIECE, ENGINEER, HELD_FIRST, UPPER_FIRST
from pipeline.planning.errands import deciding
from pipeline.quantities import sorting_key
from pipeline.records import Assessment, Recommendation
from pipeline.report.language import _, parted, said
from pipeline.report.pages.chances import name_of
from pipeline.report.pages.decided import Decided
from pipeline.report.pages.plainly import times_weight, weighed_first
from pipeline.report.pages.views import ObjectView, PageView, State, SurveyView, TaskView
from pipeline.report.text import cased, clean, short, words
from pipeline.report.units import Units, by_hand

WORDS = 8
"""Words at most that say what to do: what is read while walking."""

_TITLE = 60
"""Characters of a title: two lines of its column."""

_PLACE = 24
"""Characters of a case before it: less than a line."""

_ROUGHER = frozenset({"surface", "grip_pad"})
"""Measures by which an object slides less: more friction is better."""

# Who walks with the sheet sets dots in a case that is loose, or starts on an engineer's work, if nothing says so.
_BEFORE: tuple[tuple[str, Callable[[], str]], ...] = (
    (ANCHORED, lambda: _("first have what it stands in fastened")),
    (HELD_FIRST, lambda: _("first record what holds it now")),
    (UPPER_FIRST, lambda: _("first fix its upper body")),
    (EACH_PIECE, lambda: _("for each piece")),
    (ENGINEER, lambda: _("an engineer designs it")),
)

_FOLLOWS = frozenset({"movement", "margin", "acceleration", "rotation", "cg_height"})
"""Numbers in the sentences of measures that follow from a measure: nobody sets them."""


@dataclass(frozen=True, slots=True)
class WalkRow:
    """An object on the sheet.

    Attributes
    ----------
    number : str
        Of the object.
    title : str
        Of the object, behind the case that it is in.
    what : str
        What to do, in `WORDS` words at most.
    numbers : str
        What comes before, and what to set, such as "4 pieces; to hold 19 kg"; "" for nothing.
    ask : str
        What is worth measuring on an object to act on, "" for nothing.
    photo : str
        The file of its picture in the report, "" for none.
    """

    number: str
    title: str
    what: str
    numbers: str = ""
    ask: str = ""
    photo: str = ""


@dataclass(frozen=True, slots=True)
class WalkView:
    """The sheet of a page of a gallery: first what to act on, then what is worth a measurement.

    Attributes
    ----------
    gallery : str
        Its name, "" where none is recorded.
    page : PageView
        The page of the report that it belongs to.
    act, measure : tuple of WalkRow
        No object is in both.
    left, unknown : tuple of str
        Numbers of the other objects: of those that need nothing now, and of those that cannot be assessed.
    decided : str
        The day of the newest decision that it counts (ISO 8601); "" for none.
    """

    gallery: str
    page: PageView
    act: tuple[WalkRow, ...]
    measure: tuple[WalkRow, ...]
    left: tuple[str, ...] = ()
    unknown: tuple[str, ...] = ()
    decided: str = ""


def walk_view(
    name: str,
    page: PageView,
    pairs: Sequence[tuple[Assessment, ObjectView]],
    tasks: Sequence[TaskView],
    survey: Sequence[SurveyView],
    decided: Decided,
    units: Units,
) -> WalkView:
    """Return the sheet of a page, in the order in which the page lists what to do first and what to measure first.

    What is done alike goes case by case, and then by number: whoever carries what it takes walks once.  What
    people accepted or overruled is on no sheet.

    Parameters
    ----------
    name : str
        Of the gallery.
    page : PageView
        Its page.
    pairs : sequence of (Assessment, ObjectView)
        The objects by urgency.
    tasks, survey : sequence of TaskView, of SurveyView
        What the page lists first.
    decided : Decided
        Say which measures are settled.
    units : Units
        The reader's.
    """
    open_ = {view.anchor: (found, view) for found, view in pairs if not view.settled}
    advice = {anchor: _advice(found, decided) for anchor, (found, view) in open_.items() if view.state is State.ACT}
    listed = [
        view.anchor
        for task in tasks
        for view in sorted(task.objects, key=_on_the_way)
        if view.anchor in advice and _measure(advice[view.anchor]) == task.measure
    ]
    # Besides, so that none is lost: what fails at another level than that for which something is advised.
    act = tuple(_act(open_[anchor][1], advice[anchor], units) for anchor in dict.fromkeys([*listed, *advice]))
    asked = [view.anchor for one in survey for view in one.objects]
    asked += [anchor for anchor, (_found, view) in open_.items() if view.open_for]
    measure = tuple(
        _measuring(open_[anchor][1]) for anchor in dict.fromkeys(asked) if anchor in open_ and anchor not in advice
    )
    told = {row.number for row in (*act, *measure)}
    others = sorted(
        (view for _found, view in pairs if view.number not in told), key=lambda view: sorting_key(view.number)
    )
    unknown = tuple(view.number for view in others if view.state is State.UNKNOWN and not view.settled)
    left = tuple(view.number for view in others if view.number not in unknown)
    newest = decided.newest([found.scene.item.object_number for found, _view in pairs])
    return WalkView(name, page, act, measure, left, unknown, newest)


def _on_the_way(view: ObjectView) -> tuple[bool, str, str]:
    return not view.place, sorting_key(view.place), sorting_key(view.number)


def _advice(found: Assessment, decided: Decided) -> Recommendation | None:
    """Return what is advised where harm is likeliest, or else first of what nobody has settled."""
    left = [one for one in found.recommendations if not decided.covered(found, one.level)]
    first = deciding(found)
    return first if first in left else next(iter(left), None)


def _measure(advice: Recommendation | None) -> str:
    return "" if advice is None else advice.measure


def _act(view: ObjectView, advice: Recommendation | None, units: Units) -> WalkRow:
    chance, asked = view.chance, _asked(view)
    if chance is not None and chance.slender:
        # What is advised for sizes that nobody believes is not built.
        return WalkRow(view.number, _title(view), few(_("Check its sizes first")), photo=_photo(view))
    if advice is not None:
        what, numbers = said(clean(advice.title)), numbers_to_set(advice, units)
        if NAMED_FIRST in advice.sentence:
            asked = [_("What it is"), *asked]
        elif weighed_first(advice):
            asked = [_("Weight"), *asked]
    else:
        unnamed = chance is not None and chance.unnamed
        what, numbers = _("Say first what it is") if unnamed else _("No measure found: ask an engineer"), ""
    return WalkRow(view.number, _title(view), few(what), numbers, few(asked[0]) if asked else "", _photo(view))


def _measuring(view: ObjectView) -> WalkRow:
    asked = _asked(view)
    # The heading above says that it is to be measured.
    return WalkRow(view.number, _title(view), few(", ".join(asked)), photo=_photo(view))


def _asked(view: ObjectView) -> list[str]:
    wishes = [wish.what for wish in view.wishes if not wish.waste]
    return wishes or ([name_of(view.open_for)] if view.open_for else [])


def _photo(view: ObjectView) -> str:
    return "" if view.photo is None else view.photo.file


def _title(view: ObjectView) -> str:
    """Return the title, behind the case that the object is in: whoever walks looks for that first."""
    return " · ".join(filter(None, (view.place and short(cased(view.place), _PLACE), short(view.title, _TITLE))))


def few(text: str) -> str:
    """Return a text in `WORDS` words at most."""
    parts = text.split()
    return " ".join(parts[:WORDS]) + ("…" if len(parts) > WORDS else "")


def numbers_to_set(advice: Recommendation, units: Units) -> str:
    """Return what is to be done before a measure, and the numbers that somebody sets, in the order of its sentence.

    Parameters
    ----------
    advice : Recommendation
        With its numbers in SI.
    units : Units
        The reader's.
    """
    named = dict.fromkeys(name for _text, name, _form, _how in Formatter().parse(advice.sentence) if name)
    told = [phrase() for sentence, phrase in _BEFORE if sentence in advice.sentence]
    write, pieces, of_weight = by_hand(units), "", times_weight(advice)
    for name in named:
        # The page has the moment too; whoever buys a clamp asks what it must hold.
        beside = name == "moment" and "force" in advice.parameters
        if name in advice.parameters and name not in _FOLLOWS and not beside:
            text = write(name, advice.parameters[name], advice.units.get(name, ""))
            if name == "size" and pieces:
                # The sign of a diameter: 4 x 2 cm would be a strip as well.
                told[-1] = f"{pieces} × Ø {text}"
                continue
            if name == "second" and "height" in advice.parameters:
                told[-1] = _("%(parts)s and %(last)s") % {"parts": told[-1], "last": text}
                continue
            pieces = text if name == "pieces" else pieces
            if name in ("weight", "heaviest") and of_weight:
                continue
            if name == "force" and of_weight:
                told.append(_("to hold %(number)s") % {"number": of_weight})
                continue
            plainly = {"times": _("%(number)s times its weight"), "pieces": _("%(number)s pieces")}
            plainly |= {"force": _("hold %(number)s in all") if pieces else _("to hold %(number)s")}
            plainly |= {"clearance": _("%(number)s free all round")}
            plainly |= {"friction": _("friction %(number)s or more")} if advice.measure in _ROUGHER else {}
            told.append(plainly[name] % {"number": text} if name in plainly else f"{words(clean(name))} {text}")
    return parted(told)
