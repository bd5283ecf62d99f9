"""One page drawn: its HTML, its part of the exports, what the index says of it and what it adds to the totals."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from jinja2 import Environment
from markupsafe import Markup

from pipeline.analysis.stakes import VALUE_PER_C, counting
from pipeline.records import DecisionStatus, Found, Page, Photo, RunRecord, Tally
from pipeline.report.files.exports import FindingRows, page_exports
from pipeline.report.files.object_list import LISTED, listed_part, listed_rows
from pipeline.report.files.walk_sheet import sheet_file, sheet_pdf
from pipeline.report.language import Language, speaking
from pipeline.report.pages.compose import compose, page_head
from pipeline.report.pages.describe import Sayings
from pipeline.report.pages.environment import environment, fill, script_of
from pipeline.report.pages.notes import page_notes
from pipeline.report.pages.photo_views import photo_file
from pipeline.report.pages.tallies import tally
from pipeline.report.pages.views import Entry, FigureView, State
from pipeline.report.plots.chart import PATTERNS, Drawing
from pipeline.report.units import Units


@dataclass(frozen=True)
class RenderedPage:
    """A page as a report holds it; it can be pickled.

    Attributes
    ----------
    page : bytes
        Its HTML.
    entry : Entry
        What the index says of it.
    tally : Tally
        What it adds to the totals of the run.
    parts : mapping of str to bytes
        What it adds to each export, by the names of `PARTS_OF_PAGE`.
    sheet : bytes or None
        To walk the gallery with, as PDF; none for what is not on display.
    images : mapping of str to bytes
        Pictures of its objects, by the names of their files.
    """

    page: bytes
    entry: Entry
    tally: Tally
    parts: Mapping[str, bytes]
    sheet: bytes | None = None
    images: Mapping[str, bytes] = field(default_factory=dict)


@dataclass(frozen=True)
class PageRenderer:
    """What draws the pages of one run: what they share is made once.

    Attributes
    ----------
    head : RunRecord
        The run without its objects, with all its charts and motions.
    paper : str
        Of the sheets to walk with, "A4" or "Letter".
    planned : bool
        Whether the report has a plan, to which its pages lead.
    """

    head: RunRecord
    units: Units
    language: Language
    paper: str = "A4"
    planned: bool = False

    def draw(
        self,
        page: Page,
        found: Found,
        decisions: Sequence[DecisionStatus],
        photos: Mapping[str, Photo] | None = None,
    ) -> RenderedPage:
        """Return a page and what it adds to the report; the same results give the same bytes.

        Parameters
        ----------
        page : Page
            Which page it is.
        found : Found
            What was found about its objects.
        decisions : sequence of DecisionStatus
            Those about its objects.
        photos : mapping of str to Photo, optional
            Pictures of its objects by number, with their content.

        Returns
        -------
        RenderedPage
            Page, entry, tally, parts of the exports and the sheet to walk with.

        Raises
        ------
        ReportError
            Where the results cannot be shown (see `compose`).
        """
        record = replace(
            self.head,
            assessments=found.assessments,
            wishes=found.wishes,
            spacings=found.spacings,
            decisions=tuple(decisions),
        )
        with speaking(self.language), counting(self._value_per_c):
            made = compose(
                record,
                page,
                self.units,
                self._sayings,
                several=len({m.level for m in self.head.motions}) > 1,
                photos=photos or {},
            )
            gallery = made.gallery
            head = page_head(self.head, page)
            context: dict[str, Any] = {"museum": head, "units": self.units, "State": State}
            context |= {"here": "gallery", "gallery": gallery, "sheet": sheet_file(gallery.page.file)}
            context |= {"pictured": bool(photos), "planned": self.planned}
            if gallery.counts.aside:
                text = fill(self._environment, "aside.html", context)
            else:
                context |= {**drawn(gallery.charts, self.drawings), **script_of("gallery")}
                text = fill(self._environment, "gallery.html", context | {"notes": page_notes(gallery.objects)})
            parts = page_exports(record, page.run, gallery.page.file, made.anchor, made.key, self.units, self._rows)
            rows = listed_rows(self._environment, context)
            parts[LISTED] = listed_part([o.number for o in gallery.objects], rows)
            images = {photo_file(photo): photo.content for photo in (photos or {}).values()}
            sheet = None
            if made.walk is not None:
                sheet = sheet_pdf(made.walk, head, self.language, self.paper, images)
        return RenderedPage(text.encode(), made.entry, self.tally(found), parts, sheet, images)

    def tally(self, found: Found) -> Tally:
        """Return what the objects of a page add to the totals of the run."""
        with counting(self._value_per_c):
            return tally(found)

    @property
    def _value_per_c(self) -> float:
        return float(self.head.settings.get(VALUE_PER_C, 0.0))

    @cached_property
    def identity(self) -> str:
        """What all pages say of the run and how they say it, as one digest."""
        head = self.head
        said = (
            repr(self.units), self.paper, self.planned, self.language.code, self.language.digest, head.museum,
            head.settings.get("credit"), head.version, head.demonstration, self._value_per_c,
            [(m.hash, m.name, m.level, m.floor, m.approved_by, m.approved_on) for m in head.motions],
            sorted(head.charts),
        )  # fmt: skip
        return hashlib.sha256(repr(said).encode("utf-8", "surrogatepass")).hexdigest()

    @cached_property
    def drawings(self) -> dict[str, Drawing]:
        """The charts of the run, ready to be put on pages; each has the same name on every page."""
        motions = [motion.hash[:16] for motion in self.head.motions]
        with speaking(self.language):
            return {
                # Those of no motion show what accuracy costs, where somebody measured it.
                key: Drawing(chart, self.units, f"{'c' if any(m in key for m in motions) else 'm'}{i}")
                for i, (key, chart) in enumerate(self.head.charts.items())
            }

    @cached_property
    def _sayings(self) -> Sayings:
        return Sayings(self.head.motions, self.units)

    @cached_property
    def _rows(self) -> FindingRows:
        return FindingRows()

    @cached_property
    def _environment(self) -> Environment:
        return environment(self.language)


def drawn(keys: Sequence[str], drawings: Mapping[str, Drawing]) -> dict[str, Any]:
    """Return what a page needs to show these charts: their symbols, the charts themselves, and the marking of them."""
    mine = {key: drawings[key] for key in keys}
    symbols = Markup("").join((PATTERNS, *(d.symbol() for d in mine.values())))

    def figure(view: FigureView, subject: str) -> Markup:
        return mine[view.chart].figure(view.spots, subject)

    def bare(key: str) -> Markup:
        return mine[key].figure((), "")

    return {"drawings": mine, "symbols": symbols, "figure": figure, "bare": bare}
