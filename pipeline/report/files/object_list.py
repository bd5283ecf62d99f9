"""The list of all objects of a report: every page keeps the rows of its own, and all are sorted together by number.

From a gallery's page to the one before it and the one behind it, in the order of the catalogue, and to its parts.

Which these are is known only when all pages are there, and is no part of what a page is found again by: another name
next door must not have it drawn anew.  So pages leave room, between two marks, that is filled in when all is there.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from jinja2 import Environment
from markupsafe import Markup

from pipeline.quantities import sorting_key
from pipeline.report.language import _
from pipeline.report.pages.environment import fill
from pipeline.report.pages.views import Entry, PageView
from pipeline.report.text import clean, plain, short

LISTED = "listed.arrow"
"""The part of a page with the rows of its objects in the list of all; no export."""

OBJECTS = "objects"
"""Stem of the list's files."""

SHOWN = 5_000
"""Rows on a page of the list, which a phone shows and searches at once."""

_FILE = re.compile(rf"{OBJECTS}(?:-\d+)?\.html")


@dataclass(frozen=True, slots=True)
class ListPage:
    """A page of the list: its file, its first and its last number."""

    file: str
    first: str
    last: str


def is_list_file(name: str) -> bool:
    """Say whether a file of a report is a page of the list of all objects."""
    return bool(_FILE.fullmatch(name))


@cache
def _schema() -> Any:
    import pyarrow as pa

    return pa.schema([(name, pa.large_string()) for name in ("key", "number", "row")])


def listed_rows(env: Environment, context: Mapping[str, Any]) -> list[str]:
    """Return what the list says of each object of a page: rows of an HTML table.

    Parameters
    ----------
    env : jinja2.Environment
        Of the templates.
    context : mapping of str to any
        As of the page.

    Returns
    -------
    list of str
        In the order of the page's objects.
    """
    # Of texts of the museum no angle bracket is left: each row begins with the tag, and with nothing else.
    _, *rows = fill(env, "_listed.html", context).split("<tr")
    return [f"<tr{row}" for row in rows]


def listed_part(numbers: Sequence[str], rows: Sequence[str]) -> bytes:
    """Return the rows of the objects of a page as a file.

    Parameters
    ----------
    numbers : sequence of str
        Of the objects.
    rows : sequence of str
        What the list says of each: a row of an HTML table.

    Returns
    -------
    bytes
        A table in Arrow's format of files.
    """
    import pyarrow as pa

    columns = ([sorting_key(number) for number in numbers], numbers, rows)
    sink = pa.BufferOutputStream()
    with pa.ipc.new_file(sink, _schema()) as out:
        out.write_table(pa.table([pa.array(one, pa.large_string()) for one in columns], schema=_schema()))
    return bytes(sink.getvalue().to_pybytes())


def listed_pages(parts: Sequence[Path], shown: int = SHOWN) -> tuple[list[ListPage], Iterator[str]]:
    """Return the pages of the list of all objects, one at least, and the rows of each in turn.

    Parameters
    ----------
    parts : sequence of Path
        The files with the rows of each page of the report.
    shown : int
        Rows on a page of the list.

    Returns
    -------
    list of ListPage
        In the order of the objects' numbers.
    iterator of str
        For each page its rows, one behind the other.

    Raises
    ------
    OSError
        Where a part cannot be read.
    """
    import pyarrow as pa
    import pyarrow.compute as pc

    tables = [_schema().empty_table()]
    for part in parts:
        with pa.memory_map(str(part)) as source, pa.ipc.open_file(source) as file:
            tables.append(file.read_all())
    # In one piece: what lies in many is put together anew for every page that is taken from it.
    every = pa.concat_tables(tables).combine_chunks()
    tables.clear()
    order = pc.sort_indices(every, sort_keys=[("key", "ascending"), ("number", "ascending")])
    pages = [order.slice(begin, shown) for begin in range(0, max(1, len(order)), shown)]
    ends = [
        every["number"].take(page.take([0, len(page) - 1])).to_pylist() if len(page) else ["", ""] for page in pages
    ]
    named = [ListPage(page_file(at), *both) for at, both in enumerate(ends, 1)]
    return named, ("".join(every["row"].take(page).to_pylist()) for page in pages)


def page_file(at: int) -> str:
    """Return the file of a page of the list, counted from 1: the first one's has no number."""
    return f"{OBJECTS}.html" if at == 1 else f"{OBJECTS}-{at}.html"


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
