"""Texts that many objects of a page share: listed once, numbered, and cited by a short link wherever they count."""

from collections import Counter
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby

from markupsafe import Markup, escape

from pipeline.report.views import NumberView, ObjectView

_HEAD = 48
"""The longest beginning of a note (up to its colon) that is repeated in front of its number."""


@dataclass(frozen=True, slots=True)
class Note:
    """One entry of a page's list; ``label`` is its number there, such as "A5", and its id."""

    label: str
    text: str
    source: str


class Notes:
    """The texts of one kind on one page.

    letter : what the numbers of this list begin with, so that two lists are told apart on paper
    headed : whether a citation repeats the beginning of the text, up to its colon
    texts  : (text, source) as often as each is used; what is used once is not listed but written where it is used
    """

    def __init__(self, letter: str, texts: Iterable[tuple[str, str]], *, headed: bool = True) -> None:
        uses: Counter[str] = Counter()
        sources: dict[str, dict[str, None]] = {}
        for text, source in texts:
            uses[text] += 1
            if source:
                sources.setdefault(text, {})[source] = None
        shared = [text for text, times in uses.items() if times > 1]
        self.listed = tuple(
            Note(f"{letter}{i}", text, "; ".join(sources.get(text, ()))) for i, text in enumerate(shared, 1)
        )
        self._tags = {n.text: Markup(" ") + _link(n.label, n.label) for n in self.listed}
        self._links = {
            n.text: _link(n.label, f"{_head(n.text) if headed else ''} {n.label}".strip()) for n in self.listed
        }

    def cite(self, texts: Sequence[str]) -> Markup:
        """Return the texts in one line: a link to the list for each that is listed there, the others in full."""
        parts = [self._links.get(text) or escape(text) for text in texts]
        return Markup("; ".join(parts))  # noqa: S704 - each part is escaped above

    def tag(self, text: str, source: str) -> Markup:
        """Return " A5" as a link for a text that is listed, or the text and its source in brackets."""
        if text in self._tags:
            return self._tags[text]
        told = "; ".join(part for part in (text, source) if part)
        return escape(f" ({told})") if told else Markup()


@dataclass(frozen=True, slots=True)
class PageNotes:
    """The three lists of a gallery's page."""

    assumed: Notes
    rejected: Notes
    skipped: Notes

    def numbers(self, numbers: Sequence[NumberView]) -> Markup:
        """Return the numbers that an object was run with in one line, grouped by where they come from."""
        groups = (
            f"{escape(origin[:1].upper() + origin[1:])}: "
            + "; ".join([escape(n.text) + self.assumed.tag(n.note, n.source) for n in members])
            for origin, members in groupby(numbers, key=lambda n: n.origin)
        )
        return Markup(". ".join(groups) + "." if numbers else "")  # noqa: S704 - each part is escaped above


def page_notes(objects: Iterable[ObjectView]) -> PageNotes:
    """Collect what the objects of a page share, in the order in which the page first needs it."""
    told = [o for o in objects if o.carded]
    return PageNotes(
        assumed=Notes(
            "A",
            (
                pair
                for o in told
                for pair in (
                    *((text, "") for text in o.assumptions),
                    *((n.note, n.source) for n in o.numbers if n.note),
                )
            ),
        ),
        rejected=Notes("R", ((text, "") for o in told for m in o.measures for text in m.rejected)),
        # Objects of one kind leave out the same models for the same reasons: one note for all of an object's.
        skipped=Notes("M", ((left_out(o), "") for o in told if o.skipped), headed=False),
    )


def left_out(view: ObjectView) -> str:
    """Return the models that were not run for an object, with the reasons, in one text."""
    return "; ".join(view.skipped)


def _head(text: str) -> str:
    head, colon, _ = text.partition(":")
    return head if colon and len(head) <= _HEAD else ""


def _link(label: str, shown: str) -> Markup:
    return Markup('<a href="#{}">{}</a>').format(label, shown)
