"""News of objects in plain words: what a night found changed, one object a line."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

from pipeline.records import Band, Brief, DecisionKind, NewsKind, ObjectChange, Ruled, RunChanges, Settled, State
from pipeline.report.language import _, moment, ngettext, parted, said
from pipeline.report.pages.chances import band_word, class_title
from pipeline.report.pages.news_words import TITLE, to_do, was_done
from pipeline.report.pages.scene_words import stated_told, word_told
from pipeline.report.pages.survey_words import missing_words
from pipeline.report.pages.views import Pointer
from pipeline.report.text import clean, count, plain, short, words

KEPT = 100
"""Objects with news that a status keeps."""

OPEN = 8
"""Lines that the index and the landing page show; the page of the news has all."""

ON_A_PAGE = 500
"""Lines on a page of the news."""

STEM = "news"

ALIKE = 3
"""Objects from which on the same news of them is one line."""

NAMED = 5
"""Objects that such a line names."""

_ONE_BY_ONE = frozenset({NewsKind.DANGER, NewsKind.WORSE, NewsKind.LOST, NewsKind.STILL})
"""News that somebody acts on."""

_FIELDS = 3
_SIZES = frozenset({"height_m", "width_m", "depth_m"})


@dataclass(frozen=True, slots=True)
class NewsLine:
    """News of one object: "Fixed: 1922.9 Amphora (clamped)".

    Attributes
    ----------
    kind : NewsKind
        Of what kind it is.
    head : str
        The kind in words.
    number, title, gallery : str
        Of the object.
    view : Pointer or None
        Where the report has it.
    text : str
        What follows its title, with the colon or the bracket that it begins with.
    by : str
        Who said what was done about it, and when; "" where that is in the text or unknown.
    """

    kind: NewsKind
    head: str
    number: str
    title: str
    gallery: str
    view: Pointer | None
    text: str
    by: str = ""

    @property
    def sentence(self) -> str:
        """The line as a sentence, with who said what was done, for places without markup."""
        return self.told_of(f"{self.number} {self.title}".rstrip())

    def told_of(self, named: str) -> str:
        """Return the line as a sentence about what is named."""
        begun = f"{self.head}: {named}"
        if not self.by:
            return plain(begun + self.ended)
        whole = parted((begun + self.text.removesuffix("."), self.by))
        return plain(whole if whole.endswith(".") else f"{whole}.")

    @property
    def ended(self) -> str:
        """The text with its full stop: one, where it ends in somebody's initials."""
        return self.text if self.text.endswith(".") else f"{self.text}."


@dataclass(frozen=True, slots=True)
class NewsGroup:
    """News that is the same of its objects, or news of one."""

    lines: tuple[NewsLine, ...]

    @property
    def named(self) -> tuple[NewsLine, ...]:
        """The objects that are named."""
        return self.lines[:NAMED]

    @property
    def first(self) -> NewsLine:
        """What is said of the first object, which is said of all."""
        return self.lines[0]

    @property
    def gallery(self) -> str:
        """Where they all are; "" where not all are in one."""
        return self.first.gallery if len({line.gallery for line in self.lines}) == 1 else ""

    @property
    def more(self) -> str:
        """How many are not named; "" for none."""
        left = len(self.lines) - len(self.named)
        return _("and %(more)s more") % {"more": count(left)} if left else ""

    @property
    def sentence(self) -> str:
        """The news in a sentence, for places without markup."""
        others = [f"{line.number} {line.title}".rstrip() for line in self.named[1:]]
        named = ", ".join((f"{self.first.number} {self.first.title}".rstrip(), *others))
        return self.first.told_of(" ".join(filter(None, (named, self.more))))


def together(lines: Sequence[NewsLine]) -> tuple[NewsGroup, ...]:
    """Return news with what is the same of several objects together, in the order of the first of them."""
    alike: dict[object, list[NewsLine]] = {}
    for at, line in enumerate(lines):
        apart = at if line.kind in _ONE_BY_ONE else ""
        alike.setdefault((line.kind, line.text, line.by, apart), []).append(line)
    found: list[NewsGroup] = []
    for some in alike.values():
        found += [NewsGroup(tuple(some))] if len(some) >= ALIKE else [NewsGroup((line,)) for line in some]
    return tuple(found)


@dataclass(frozen=True, slots=True)
class NewsView:
    """All news since the run before, or what of it is kept.

    Attributes
    ----------
    before : str
        When the run before began, ISO 8601; "" where there was none.
    lines : tuple of NewsLine
        In the order in which they are told.
    total : int
        How many there are.
    counts : tuple of (str, str)
        The kinds in words, with how many of each.
    shared : tuple of (str, str)
        The same of what changed for many objects at once.
    because : str
        Of what; "" for nothing.
    changed : bool
        Whether anything at all changed, news or not.
    """

    before: str
    lines: tuple[NewsLine, ...]
    total: int
    counts: tuple[tuple[str, str], ...]
    shared: tuple[tuple[str, str], ...]
    because: str
    changed: bool = True

    @property
    def brief(self) -> "tuple[NewsGroup, ...]":
        """The first of the news, what is alike together."""
        return together(self.lines)[:OPEN]

    @property
    def more(self) -> int:
        """How many objects the first of the news do not name."""
        return self.total - sum(len(group.named) for group in self.brief)


def news_view(changes: RunChanges, objects: Mapping[str, Pointer]) -> NewsView:
    """Return all news since the run before.

    Parameters
    ----------
    changes : RunChanges
        Since that run.
    objects : mapping of str to Pointer
        By number, where the report has them; what is gone has none.
    """
    return NewsView(
        before=clean(changes.started),
        lines=tuple(news_line(one, objects.get(one.object_number)) for one in changes.objects),
        total=len(changes.objects),
        counts=told_counts(kind_counts(changes)),
        shared=told_counts(changes.shared),
        because=because(shared_causes(changes)),
        changed=bool(changes),
    )


def kept_view(kept: Mapping[str, Any]) -> NewsView:
    """Return news as a summary keeps it (`objects`, `counts`, `shared`, `because`, `since`), in the reader's language.

    Raises
    ------
    ValueError, TypeError, KeyError
        Where it was changed by hand.
    """
    counts = {NewsKind(kind): int(number) for kind, number in kept["counts"].items()}
    return NewsView(
        before=clean(str(kept["since"])),
        lines=tuple(news_line(_of_row(row)) for row in kept["objects"][:KEPT]),
        total=sum(counts.values()),
        counts=told_counts(counts),
        shared=told_counts(kept["shared"]),
        because=because([str(one) for one in kept["because"]]),
    )


def _of_row(row: Mapping[str, Any]) -> ObjectChange:
    # An earlier version of Kouros told of no house rules.
    told = {field.name: row[field.name] for field in fields(ObjectChange) if field.name != "ruled"}
    told["ruled"] = row.get("ruled", ())
    for side in ("before", "after"):
        known = told[side]
        if known is not None:
            told[side] = Brief(**known | {"state": None if known["state"] is None else State(known["state"])})
    told |= {"decided": tuple(Settled(**one) for one in told["decided"]), "fields": tuple(told["fields"])}
    told["ruled"] = tuple(
        Ruled(**one | {key: tuple(one.get(key, ())) for key in ("classes", "about", "back")}) for one in told["ruled"]
    )
    return ObjectChange(**told)


def sentences(changes: RunChanges, most: int = OPEN) -> list[str]:
    """Return the news in sentences: the first lines, how many more there are, and what changed for many at once."""
    shown = together([news_line(one) for one in changes.objects])[:most]
    told = [group.sentence for group in shown]
    more = len(changes.objects) - sum(len(group.lines) for group in shown)
    if more:
        told.append(
            ngettext("And %(shown)s more object.", "And %(shown)s more objects.", more) % {"shown": count(more)}
        )
    if changes.shared:
        told.append(shared_sentence(told_counts(changes.shared), because(shared_causes(changes))))
    return told


def shared_sentence(shared: Sequence[tuple[str, str]], why: str) -> str:
    """Say what changed for many objects at once."""
    return _("Because of %(why)s, for many objects at once: %(counts)s.") % {
        "why": why,
        "counts": ", ".join(f"{head} {number}" for head, number in shared),
    }


def kind_counts(changes: RunChanges) -> dict[str, int]:
    """Return how much news there is of each kind, in the order in which it is told."""
    found = Counter(one.kind for one in changes.objects)
    return {kind.value: found[kind] for kind in NewsKind if found[kind]}


def told_counts(counts: Mapping[Any, int]) -> tuple[tuple[str, str], ...]:
    """Return the kinds in words, with how many of each."""
    return tuple((_head(NewsKind(kind)), count(number)) for kind, number in counts.items())


_HOUSE = "house"
"""Setting that people state at the desk: they do not call it one."""


def shared_causes(changes: RunChanges) -> list[str]:
    """Return what changed of what many objects rest on: "motions", "settings", "versions"; else it was the floors."""
    found = [name for name in ("motions", "settings", "versions") if getattr(changes, name)]
    if "settings" in found and all(one.name.partition(".")[0] == _HOUSE for one in changes.settings):
        found[found.index("settings")] = _HOUSE
    return found or (["floors"] if changes.shared else [])


def because(causes: Sequence[str]) -> str:
    """Say what changed of what many objects rest on."""
    told = {
        "motions": _("the earthquake used"),
        "settings": _("settings"),
        _HOUSE: _("house rules"),
        "versions": _("another version of Kouros"),
        "floors": _("floors"),
    }
    return ", ".join(told[cause] for cause in causes)


def page_file(at: int) -> str:
    """Return the file of a page of the news, counted from 1: the first one's has no number."""
    return f"{STEM}.html" if at == 1 else f"{STEM}-{at}.html"


def news_pages(view: NewsView | None) -> list[tuple[NewsLine, ...]]:
    """Return the lines of each page of the news: one page at least."""
    lines = () if view is None else view.lines
    return [lines[begin : begin + ON_A_PAGE] for begin in range(0, max(1, len(lines)), ON_A_PAGE)]


def news_line(one: ObjectChange, view: Pointer | None = None) -> NewsLine:
    """Return the line about an object.

    Raises
    ------
    ValueError
        For an object about which there is no news.
    """
    kind = one.kind
    if kind is None:
        raise ValueError(f"there is no news of {one.object_number!a}")
    return NewsLine(
        kind,
        _head(kind),
        clean(one.object_number),
        short(one.title, TITLE),
        short(one.gallery, TITLE) or _("no gallery recorded"),
        view,
        _text(kind, one),
        _by(one),
    )


def _head(kind: NewsKind) -> str:
    told = {
        NewsKind.DANGER: _("New and in danger"),
        NewsKind.WORSE: _("Worse"),
        NewsKind.LOST: _("Can no longer be assessed"),
        NewsKind.STILL: _("Still in danger"),
        NewsKind.FIXED: _("Fixed"),
        NewsKind.BETTER: _("Better"),
        NewsKind.NEW: _("New on display"),
        NewsKind.GONE: _("Gone from display"),
        NewsKind.MOVED: _("Moved"),
        NewsKind.DECIDED: _("Decided"),
    }
    return told[kind]


def _text(kind: NewsKind, one: ObjectChange) -> str:
    now = one.after
    if kind is NewsKind.GONE:
        gone = _("not on display any more") if one.recorded else _("no longer in the records")
        return f" ({gone})"
    if kind is NewsKind.MOVED:
        return _moved(one)
    if kind is NewsKind.DECIDED or now is None:
        return f": {_decided(one)}"
    why = _why(one)
    bracket = f" ({why})" if why else ""
    if kind is NewsKind.FIXED:
        return bracket + ("" if now.state is State.FINE else f": {_stands(now)}")
    if kind is NewsKind.DANGER:
        return f": {to_do(now)}"
    if kind is NewsKind.STILL:
        turned = _turned(one.before, now) if one.before and one.before.band != now.band else ""
        told = to_do(now)
        if now.measure in one.installed:
            told = _("that is not enough: %(what)s") % {"what": told}
        return f"{bracket}: {f'{turned}: ' if turned else ''}{told}"
    if kind is NewsKind.NEW:
        return f": {_stands(now)}{_missing(now)}"
    if kind is NewsKind.LOST:
        return f"{bracket}{_missing(now)}"
    advice = f": {to_do(now)}" if kind is NewsKind.WORSE and now.state is State.ACT else ""
    return f": {_turned(one.before or Brief(), now)}{bracket}{advice}"


def _turned(was: Brief, now: Brief) -> str:
    """Say what an object was and what it is."""
    if was.state is now.state and was.band and now.band:
        return _("harm was %(before)s, and is %(after)s") % {"before": _band(was), "after": _band(now)}
    if was.state is State.UNKNOWN:
        return _("could not be assessed, is %(after)s") % {"after": _stands(now)}
    return _("was %(before)s, is %(after)s") % {"before": _stands(was), "after": _stands(now)}


def _band(brief: Brief) -> str:
    return band_word(Band(brief.band))


def _stands(brief: Brief) -> str:
    told = {
        State.ACT: _("in danger"),
        State.WATCH: _("to be watched"),
        State.UNKNOWN: _("not possible to assess"),
        State.FINE: _("fine"),
        State.ASIDE: _("not assessed"),
    }
    return told[brief.state or State.UNKNOWN]


def _missing(brief: Brief) -> str:
    if not brief.missing:
        return ""
    what = short(missing_words(clean(brief.missing)), 120)
    # Some of what is missing is a sentence of its own.
    return f": {what}" if ": " in what.partition("(")[0] else ": " + _("not recorded: %(what)s") % {"what": what}


def _moved(one: ObjectChange) -> str:
    before, after = (short(name, TITLE) or _("no gallery recorded") for name in (one.came_from or "", one.gallery))
    return ": " + _("from %(before)s to %(after)s") % {"before": before, "after": after}


def _decided(one: ObjectChange) -> str:
    told = [
        (_("%(what)s, by %(who)s") if each.new else _("no longer in force: %(what)s, by %(who)s"))
        % {"what": short(_matter(each), 120), "who": short(each.who, 60)}
        for each in one.decided
    ]
    return parted(told)


def _matter(one: Settled) -> str:
    """Return what was decided, in the words of who decides at the desk."""
    if one.kind == DecisionKind.ACCEPT:
        return _("risk accepted") + clean(one.about)
    if one.kind == DecisionKind.CLASS:
        return _("named: %(what)s") % {"what": class_title(one.object_class)} + clean(one.about)
    return said(clean(one.matter))


def _why(one: ObjectChange) -> str:
    """Say what was done about it, or else what changed of its record; "" where neither is known."""
    done = dict.fromkeys(was_done(measure) for measure in one.installed)
    # What is recorded anew with other numbers ends and begins.
    ended = [d.measure for d in one.decided if not d.new and d.measure and d.measure not in one.installed]
    told = [*done, *(_("no longer %(done)s") % {"done": was_done(measure)} for measure in dict.fromkeys(ended))]
    if not told and one.decided:
        told = [_decided(one)]
    if not told and one.came_from is not None:
        told = [_moved(one).removeprefix(": ")]
    if not told and one.fields:
        # The text that sizes were read from says no more than they do.
        sized = any(name in _SIZES for name in one.fields)
        changed = [words(clean(name)) for name in one.fields if not (sized and name == "dimensions")]
        named = changed[:_FIELDS] + ["…"] * (len(changed) > _FIELDS)
        told = [_("its record changed: %(fields)s") % {"fields": ", ".join(named)}]
    if not one.installed:
        told += map(_rule, one.ruled)
    return ", ".join(told)


def _by(one: ObjectChange) -> str:
    """Say who said what is told of a measure that is installed, and when; "" where nothing is."""
    made = next((d for d in one.decided if d.new and d.measure and d.date), None)
    if made is None:
        return ""
    return _("said by %(who)s, %(date)s") % {"who": short(made.who, 60), "date": moment(clean(made.date))}


def _rule(one: Ruled) -> str:
    """Say which house rule holds for an object, or no longer: what for, what it states, who says so and when."""
    phrase = (
        _("house rule for %(whom)s: %(what)s, by %(who)s, %(date)s")
        if one.new
        else _("no longer the house rule for %(whom)s: %(what)s, by %(who)s, %(date)s")
    )
    whom = ", ".join([*map(class_title, one.classes), *map(clean, one.about)])
    what = ", ".join(
        f"{stated_told(name)}: {word_told(name, word)}" if word else stated_told(name)
        for name, word in one.states.items()
    )
    told = phrase % {
        "whom": short(whom, TITLE),
        "what": short(what, 120),
        "who": short(one.who, 60),
        "date": moment(clean(one.date)),
    }
    if not one.back:
        return told
    who, when, why = one.back
    ended = {"who": short(who, 60), "date": moment(clean(when)), "why": short(why, 120)}
    return ", ".join((told, _("taken back by %(who)s, %(date)s: %(why)s") % ended))
