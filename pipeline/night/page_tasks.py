"""Tasks of workers that show: a page of the report, or its totals alone."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial

from pipeline.analysis.faults import Fault, fitting
from pipeline.night.context import RunContext
from pipeline.records import DecisionStatus, Found, Page, Photo, Tally
from pipeline.report.files.page_renderer import PageRenderer, RenderedPage
from pipeline.store.pages import Members, found_of


@dataclass(frozen=True)
class PageTask:
    """A page to be rendered.

    Attributes
    ----------
    page
        Where it belongs.
    members
        Its objects.
    results
        Theirs by key, as they are kept.
    decisions
        About its objects, as they stand.
    draw
        Whether it is wanted itself; else its totals alone.
    photos
        Pictures of its objects by number.
    """

    page: Page
    members: Members
    results: Mapping[str, bytes]
    decisions: tuple[DecisionStatus, ...] = field(default=())
    draw: bool = True
    photos: Mapping[str, Photo] = field(default_factory=dict)


@dataclass(frozen=True)
class Rendered:
    """What came of a `PageTask`: the totals, the page where it was wanted, and the objects that Kouros failed on."""

    tally: Tally
    page: RenderedPage | None = None
    faults: tuple[Fault, ...] = ()


def render_page(context: RunContext, task: PageTask) -> Rendered:
    """Render a page; an object that Kouros fails on is shown as one that cannot be assessed, and told."""
    found = found_of(task.members, task.results)
    if not task.draw:
        return Rendered(context.renderer.tally(found))
    if context.stock is not None and task.page.on_display:
        context.stock.keep(task.page, found)
    faults: list[Fault] = []
    # What renders is made outside of any object's guard: a language without a catalogue is nobody's fault here.
    shown, page = fitting(found, partial(_drawn, context.renderer, task), faults)
    return Rendered(page.tally if shown is found else context.renderer.tally(shown), page, tuple(faults))


def _drawn(renderer: PageRenderer, task: PageTask, found: Found) -> RenderedPage:
    return renderer.draw(task.page, found, task.decisions, task.photos)
