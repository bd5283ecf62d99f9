"""Further pages of a report, each brought by another package under an entry point of the group ``kouros.pages``::

    [project.entry-points."kouros.pages"]
    loans = "kouros_loans:PAGE"        # PAGE = FurtherPage("loans", content)

What such a page must keep to:

1. The entry point names a `FurtherPage`.  Its name is of a-z, 0-9 and hyphens; the page is ``page_NAME.html`` of the
   report, in the navigation of the index and of all pages that are written every night.
2. ``content(head, tally, entries)`` is called once a report, in the process that writes it, when all other pages are
   there.  `head` is the run without its objects, `tally` the totals of all pages, `entries` what the index says of
   each.  The exports and the database are not open to it.
3. It returns a `PageContent`: a title, and a Jinja template with its context.  What the context says is escaped; HTML
   that was made elsewhere goes in as `markupsafe.Markup`, and whoever makes it answers for it.  A name that the context
   does not have is an error.
4. No page of a report runs a script or loads anything: its Content-Security-Policy refuses both.  Styles of its own and
   pictures as ``data:`` addresses are let in.
5. The same run gives the same bytes: no clock, no chance, nothing from the network.
6. It changes nothing that it is given, and writes no file.
7. Whatever it raises, the report goes on without it: a `ReportWarning` and the index say so.
"""

import re
import warnings
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from jinja2 import Environment
from markupsafe import Markup

from pipeline.errors import fault_words
from pipeline.extensions import Registry
from pipeline.records import RunRecord, Tally
from pipeline.report.errors import ReportError, ReportWarning
from pipeline.report.pages.views import Entry
from pipeline.report.text import plain

GROUP = "kouros.pages"


@dataclass(frozen=True)
class PageContent:
    """What a further page says.

    Attributes
    ----------
    title : str
        Its heading, and its link in the navigation.
    template : str
        In Jinja; what stands below the heading.
    context : mapping of str to Any
        What the template names.
    """

    title: str
    template: str = "{{ body }}"
    context: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class FurtherPage:
    """A page that another package brings; see the contract above."""

    name: str
    content: Callable[[RunRecord, Tally, Sequence[Entry]], PageContent]


@dataclass(frozen=True)
class FurtherView:
    """A further page that was made: its file, its title, its HTML."""

    file: str
    title: str
    body: Markup


def _checked(value: object) -> FurtherPage:
    if not isinstance(value, FurtherPage):
        raise ReportError(f"{value!r} is no FurtherPage: name one (see pipeline.report.pages.further)")
    if not re.fullmatch("[a-z0-9-]{1,40}", value.name):
        raise ReportError(f"its name {value.name!r} is not of a-z, 0-9 and hyphens: give it another")
    return value


PAGES: Registry[FurtherPage] = Registry(GROUP, (), _checked)


def further_pages(
    env: Environment, head: RunRecord, tally: Tally, entries: Sequence[Entry]
) -> tuple[tuple[FurtherView, ...], tuple[str, ...]]:
    """Return the further pages of a report, and why others are left out."""
    made: list[FurtherView] = []
    problems: list[str] = []
    for page in PAGES:
        try:
            content = page.content(head, tally, entries)
            body = Markup(env.from_string(content.template).render(content.context))  # noqa: S704 - escaped by env
            made.append(FurtherView(f"page_{page.name}.html", plain(content.title), body))
        except Exception as problem:  # noqa: BLE001 - whatever another package raises must not stop a night
            told = f"the further page {page.name!r} could not be made and is left out: {fault_words(problem)}"
            warnings.warn(told, ReportWarning, stacklevel=2)
            problems.append(told)
    return tuple(made), (*PAGES.problems, *problems)
