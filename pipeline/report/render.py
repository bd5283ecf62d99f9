"""A whole run that is in memory becomes a report."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

from pipeline.planning.plan import PlanTerms
from pipeline.records import Assessment, Found, Page, Photo, RunChanges, RunRecord, Spacing
from pipeline.report.files.page_renderer import PageRenderer
from pipeline.report.files.report_writer import ReportWriter, link_to, page_key
from pipeline.report.language import Language
from pipeline.report.pages.decided import by_object
from pipeline.report.pages.reading import Doubts
from pipeline.report.pages.since import mentioned
from pipeline.report.pages.tallies import total
from pipeline.report.pages.views import Pointer
from pipeline.report.units import Units


def render(
    record: RunRecord,
    folder: Path,
    *,
    units: Units | None = None,
    language: Language | None = None,
    paper: str = "A4",
    changes: RunChanges | None = None,
    doubts: Doubts | None = None,
    terms: PlanTerms | None = None,
) -> Path:
    """Write a whole report: pages and exports.  The same record gives the same bytes.

    Parameters
    ----------
    folder : Path
        A new folder; it appears only when everything in it is written.
    units : Units or None, optional
        The reader's units; centimetres where None.
    language : Language or None, optional
        Of the pages; English where None.  The exports keep the words of the run, for programs read them.
    paper : str, optional
        Of the sheets to walk with, "A4" or "Letter".
    changes : RunChanges or None, optional
        Since the run before, for the index; None where there was none.
    doubts, terms
        See `ReportWriter.finish`.

    Returns
    -------
    Path
        The path of index.html.

    Raises
    ------
    ReportError
        If the folder exists, or if the record cannot be shown (see `compose`).
    """
    head = replace(record, assessments=(), wishes=None, spacings=())
    renderer = PageRenderer(head, units or Units(), language or Language(), paper, terms is not None)
    with ReportWriter(Path(folder), renderer) as writer:
        return draw_all(writer, head, pages_of(record), changes, doubts=doubts, terms=terms)


def draw_all(
    writer: ReportWriter,
    head: RunRecord,
    pages: Iterable[tuple[Page, Found]],
    changes: RunChanges | None,
    beside: Mapping[str, str] | None = None,
    doubts: Doubts | None = None,
    terms: PlanTerms | None = None,
    photos: Callable[[Sequence[str]], Mapping[str, Photo]] | None = None,
) -> Path:
    """Draw every page of a run that is over into a report, one at a time, and finish it.

    Parameters
    ----------
    head : RunRecord
        The run without its objects, with all decisions as they stood.
    beside : mapping of str to str or None, optional
        Further files of the report, by name.
    doubts, terms
        See `ReportWriter.finish`.
    photos : Callable[[Sequence[str]], Mapping[str, Photo]] or None, optional
        Gives the pictures of some objects, by number.

    Returns
    -------
    Path
        The path of index.html.
    """
    decisions = by_object(head.decisions)
    named = set() if changes is None else mentioned(changes)
    links: dict[str, Pointer] = {}
    tallies = []
    for page, found in pages:
        titles = {a.scene.item.object_number: a.scene.item.called for a in found.assessments}
        mine = [standing for number in titles for standing in decisions.pop(number, ())]
        shown = {} if photos is None else photos(list(titles))
        rendered = writer.renderer.draw(page, found, mine, shown)
        tallies.append(writer.add(page_key(writer.renderer, page, mine, shown), rendered))
        links |= {number: link_to(page, number, title) for number, title in titles.items() if number in named}
    strangers = tuple(standing for left in decisions.values() for standing in left)
    return writer.finish(replace(head, decisions=strangers), total(tallies), changes, links, beside, doubts, terms)


def pages_of(record: RunRecord) -> list[tuple[Page, Found]]:
    """Return the objects of a run in memory by the page that they are on, one for each gallery."""
    members: dict[tuple[bool, str], list[Assessment]] = {}
    for assessment in record.assessments:
        item = assessment.scene.item
        members.setdefault((item.on_display, item.gallery if item.on_display else ""), []).append(assessment)
    between: dict[str, list[Spacing]] = {}
    for spacing in record.spacings:
        between.setdefault(spacing.gallery, []).append(spacing)
    found = []
    for (on_display, gallery), those in members.items():
        numbers = {a.scene.item.object_number for a in those}
        wishes = None if record.wishes is None else tuple(w for w in record.wishes if w.object_number in numbers)
        spacings = tuple(between.get(gallery, ())) if on_display else ()
        page = Page("", gallery, on_display, 1, 1, record.run_id, record.finished)
        found.append((page, Found(tuple(those), wishes, spacings)))
    return found
