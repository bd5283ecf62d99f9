"""Texts that many objects of a page share: listed once, numbered, and cited by a short link wherever they count."""

from collections import Counter
from collections.abc import Callable, Collection, Hashable, Iterable, Sequence
from dataclasses import dataclass, fields
from itertools import groupby
from operator import attrgetter
from typing import Generic, TypeVar

from markupsafe import Markup

from pipeline.records import Finding
from pipeline.report.language import _, parted
from pipeline.report.pages.views import NumberView, ObjectView
from pipeline.report.text import escaped

_HEAD = 48
"""The longest beginning of a note (up to its colon) that is repeated in front of its number."""

_TITLES = 1000
"""The same where it names measures: all of them were tried, and are to be told."""


@dataclass(frozen=True, slots=True)
class PageNote:
    """One entry of a page's list; ``label`` is its number there, such as "A5", and its id."""

    label: str
    text: str
    source: str


class Notes:
    """The texts of one kind on one page.

    Parameters
    ----------
    letter : str
        What the numbers of this list begin with, so that two lists are told apart on paper.
    headed : bool
        Whether a citation repeats the beginning of the text, up to its colon.
    most : int
        The longest beginning that is repeated.
    texts : iterable of (str, str)
        (text, source) as often as each is used; what is used once is not listed but written where it is used.
    """

    def __init__(
        self, letter: str, texts: Iterable[tuple[str, str]], *, headed: bool = True, most: int = _HEAD
    ) -> None:
        uses: Counter[str] = Counter()
        sources: dict[str, dict[str, None]] = {}
        for text, source in texts:
            uses[text] += 1
            if source:
                sources.setdefault(text, {})[source] = None
        shared = [text for text, times in uses.items() if times > 1]
        self.listed = tuple(
            PageNote(f"{letter}{i}", text, parted(sources.get(text, ()))) for i, text in enumerate(shared, 1)
        )
        self._headed, self._most = headed, most
        self._places = {note.text: at for at, note in enumerate(self.listed)}
        self._tags = {
            (n.text, cited): f" {escaped(n.label) if cited else _link(n.label, n.label)}"
            for n in self.listed
            for cited in (False, True)
        }
        self._cited: dict[tuple[str, ...], Markup] = {}

    def cite(self, texts: Iterable[str]) -> Markup:
        """Return the texts in one line: a link to the list for what is listed there, the others in full.

        What stands one after the other there is one link: "friction; mass A4 to A5".
        """
        key = tuple(texts)
        if key not in self._cited:
            parts = map(self._run, self._runs(key))
            self._cited[key] = Markup(escaped(_("; ")).join(parts))  # noqa: S704 - all parts are escaped
        return self._cited[key]

    def _runs(self, texts: Sequence[str]) -> list[list[str]]:
        runs: list[list[str]] = []
        for text in texts:
            place = self._places.get(text)
            follows = bool(runs) and place is not None and self._places.get(runs[-1][-1]) == place - 1
            # A text without a short beginning would not be told apart in a longer link.
            if follows and self._head(text) and self._head(runs[-1][0]) and self._headed:
                runs[-1].append(text)
            else:
                runs.append([text])
        return runs

    def _run(self, texts: Sequence[str]) -> str:
        if texts[0] not in self._places:
            return escaped(texts[0])
        first, last = (self.listed[self._places[text]].label for text in (texts[0], texts[-1]))
        heads = parted(filter(None, map(self._head, texts))) if self._headed else ""
        labels = first if first == last else _("%(first)s to %(last)s") % {"first": first, "last": last}
        return _link(first, f"{heads} {labels}".strip())

    def _head(self, text: str) -> str:
        head, colon, _rest = text.partition(":")
        return head if colon and len(head) <= self._most else ""

    def tag(self, text: str, source: str, *, cited: bool = False) -> str:
        """Return " A5" for a text that is listed, as a link where none stands beside, or it and its source in brackets.

        Escaped already.
        cited : whether a link to it stands beside
        """
        if text in self._places:
            return self._tags[text, cited]
        told = parted((text, source)) if text and source else text or source
        return escaped(f" ({told})") if told else ""


@dataclass(frozen=True, slots=True)
class PageNotes:
    """The three lists of a gallery's page, and the sources of the measures on it by their titles.

    Attributes
    ----------
    alone : frozenset of str
        Why a model was left out, where that is said of one object of the page only.
    """

    assumed: Notes
    rejected: Notes
    skipped: Notes
    alone: frozenset[str] = frozenset()
    sources: tuple[tuple[str, str], ...] = ()

    def numbers(self, numbers: Sequence[NumberView], cited: Collection[str] = ()) -> Markup:
        """Return the numbers that an object was run with in one line, grouped by where they come from.

        Parameters
        ----------
        cited : collection of str, optional
            The notes to which links stand beside.

        Returns
        -------
        Markup
        """
        between, tag = escaped(_("; ")), self.assumed.tag
        groups = [
            escaped(f"{origin[:1].upper()}{origin[1:]}: ")
            + between.join([escaped(n.text) + tag(n.note, n.source, cited=n.note in cited) for n in members])
            for origin, members in groupby(numbers, key=_origin)
        ]
        return Markup(". ".join(groups) + "." if groups else "")  # noqa: S704 - all parts are escaped

    def left_out(self, view: ObjectView) -> Markup:
        """Return the models that were not run for an object in one line, with the reasons or links to them."""
        return self.skipped.cite(_left_out(view, self.alone))


def page_notes(objects: Iterable[ObjectView]) -> PageNotes:
    """Collect what the objects of a page share, in the order in which the page first needs it."""
    told = [o for o in objects if o.carded]
    uses = Counter(text for o in told for text in o.skipped)
    alone = frozenset(text for text, times in uses.items() if times == 1)
    return PageNotes(
        assumed=Notes(
            "A",
            (
                pair
                for o in told
                for pair in (
                    *((text, "") for text in (*o.statements, *o.assumptions)),
                    *((n.note, n.source) for n in o.numbers if n.note),
                )
            ),
        ),
        rejected=Notes("R", ((text, "") for o in told for m in o.measures for text in m.rejected), most=_TITLES),
        skipped=Notes("M", ((text, "") for o in told for text in _left_out(o, alone)), headed=False),
        alone=alone,
        sources=tuple(dict.fromkeys((m.title, m.source) for o in told for m in o.measures if m.source)),
    )


def _left_out(view: ObjectView, alone: Collection[str]) -> list[str]:
    """Return the models that were not run for an object, with the reasons.

    Objects of one kind leave out the same ones for the same reasons, but for what names the object itself: first what
    is said of this one alone, then all others in one text.
    """
    own = [text for text in view.skipped if text in alone]
    others = parted(text for text in view.skipped if text not in alone)
    return [*own, others] if others else own


_origin = attrgetter("origin")


def _link(label: str, shown: str) -> str:
    return f'<a href="#{escaped(label)}">{escaped(shown)}</a>'


Made = TypeVar("Made")

MOST = 16_384
"""Things that a memory holds, of 0.2 to 3 kB: of 20,000 real objects nine findings and numbers in ten are there."""

_OWN = ("object_number", "gallery")
"""Fields of a finding that say of which object it is; nothing else of it does."""

_shared = attrgetter(*(one.name for one in fields(Finding) if one.name not in (*_OWN, "mark")))


class Memory(Generic[Made]):
    """Things by what they were made of; when there are too many it begins anew."""

    def __init__(self, most: int = MOST) -> None:
        self._most = most
        self._made: dict[Hashable, Made] = {}

    def had(self, key: Hashable, make: Callable[[], Made]) -> Made:
        """Return what was made of a key, or make it now.

        Parameters
        ----------
        key : Hashable
            Everything that it depends on.

        Returns
        -------
        Made
        """
        found = self._made.get(key)
        if found is None:
            if len(self._made) >= self._most:
                self._made.clear()
            found = self._made[key] = make()
        return found


def finding_key(finding: Finding) -> Hashable:
    """Return what a finding says, whichever object it is of: equal only for findings that are written alike."""
    told: tuple[object, ...] = _shared(finding)
    # 0.0 equals -0.0, and is not written like it.
    return (*told, *(str(value) for value in told if value == 0.0)) if 0.0 in told else told
