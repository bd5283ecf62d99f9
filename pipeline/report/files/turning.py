"""From a gallery's page to the one before it and the one behind it, in the order of the catalogue, and to its parts.

Which these are is known only when all pages are there, and is no part of what a page is found again by: another name
next door must not have it drawn anew.  So pages leave room, between two marks, that is filled in when all is there.
"""

import re
from collections.abc import Sequence

from markupsafe import Markup

from pipeline.report.language import _
from pipeline.report.pages.views import Entry, PageView
from pipeline.report.text import clean, plain, short

NEAR = 2
"""Parts of a gallery on either side that have a link of their own, besides the first and the last."""

_ROW = Markup('<p class="turn screen">{}</p>')
_ROOM = re.compile(rb"(<!--turn-->).*?(<!--/turn-->)", re.DOTALL)


def turns(entries: Sequence[Entry]) -> list[str]:
    """Return what the room on each page is filled with, as HTML.

    Parameters
    ----------
    entries : sequence of Entry
        Of the pages, in their order; those of what is not on display follow each other, apart from the galleries.
    """
    out = [""] * len(entries)
    for shown in (True, False):
        row = [at for at, entry in enumerate(entries) if entry.on_display == shown]
        for place, at in enumerate(row):
            links = []
            if place:
                links.append(_link(_("Previous:"), "prev", entries[row[place - 1]]))
            if place + 1 < len(row):
                links.append(_link(_("Next:"), "next", entries[row[place + 1]]))
            # The parts of a gallery follow each other: its first one is as many places before as it has a number.
            first = place - entries[at].page.number + 1
            parts = [entries[one].page for one in row[first : first + entries[at].page.of]]
            told = [_numbered(parts, entries[at].page.number), links]
            out[at] = "".join(str(_ROW.format(Markup(" ").join(one))) for one in told if one)
    return out


def _numbered(parts: Sequence[PageView], own: int) -> list[Markup]:
    """Return the links to the parts of a gallery: the first, the last, and those near a page of it."""
    out: list[Markup] = []
    for part in parts if len(parts) > 1 else ():
        ends = f"{plain(part.first)} – {plain(part.last)}"
        if part.number == own:
            out.append(Markup('<strong aria-current="page">{}</strong>').format(part.number))
        elif part.number in (1, len(parts)) or abs(part.number - own) <= NEAR:
            out.append(Markup('<a href="{}" title="{}">{}</a>').format(part.file, ends, part.number))
        elif abs(part.number - own) == NEAR + 1:
            out.append(Markup("<span>…</span>"))
    return out


def _link(word: str, which: str, entry: Entry) -> Markup:
    name = _("Not on display") if not entry.on_display else short(clean(entry.name), 60) or _("No gallery recorded")
    part = ""
    if entry.page.of > 1:
        part = ", " + _("part %(number)s of %(of)s") % {"number": entry.page.number, "of": entry.page.of}
    link = Markup('<span><span class="soft">{}</span> <a rel="{}" href="{}"><bdi>{}</bdi>{}</a></span>')
    return link.format(word, which, entry.page.file, name, part)


def turned(content: bytes, links: str) -> bytes:
    """Return a page with its room filled in, whatever it was filled with before."""
    own = links.encode("utf-8", "replace")
    return _ROOM.sub(lambda found: found[1] + own + found[2], content)
