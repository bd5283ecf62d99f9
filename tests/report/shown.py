"""The views of a whole run in memory: what its pages show, before any template."""

from dataclasses import dataclass, replace

from pipeline.records import RunRecord
from pipeline.report.pages.compose import compose, museum_view
from pipeline.report.pages.museum_views import GalleryView, MotionView, MuseumView
from pipeline.report.pages.tallies import tally, total
from pipeline.report.pages.views import DecisionsView, Pointer, StateCounts
from pipeline.report.render import pages_of
from pipeline.report.units import Units


@dataclass(frozen=True)
class Shown:
    """The index and the galleries' pages, in the order of the index."""

    museum: MuseumView
    galleries: tuple[GalleryView, ...]

    @property
    def counts(self) -> StateCounts:
        """Of the whole museum."""
        return self.museum.counts

    @property
    def first(self) -> tuple[Pointer, ...]:
        """The most urgent objects."""
        return self.museum.first

    @property
    def decisions(self) -> DecisionsView:
        """Of the whole museum."""
        return self.museum.decisions

    @property
    def motions(self) -> tuple[MotionView, ...]:
        """The motions of the run."""
        return self.museum.motions


def shown(record: RunRecord, units: Units | None = None) -> Shown:
    """Return what the report of a run shows."""
    chosen = units or Units()
    levels = {f.level for a in record.assessments for f in a.findings}
    pages, entries, tallies = {}, [], []
    left = list(record.decisions)
    for sheet, found in pages_of(record):
        numbers = {a.scene.item.object_number for a in found.assessments}
        mine = tuple(s for s in left if s.decision.object_number in numbers)
        left = [s for s in left if s not in mine]
        part = replace(
            record, assessments=found.assessments, wishes=found.wishes, spacings=found.spacings, decisions=mine
        )
        made = compose(part, sheet, chosen, several=len(levels) > 1)
        pages[made.gallery.page.file] = made.gallery
        entries.append(made.entry)
        tallies.append(tally(found))
    head = replace(record, assessments=(), wishes=None, spacings=(), decisions=tuple(left))
    museum = museum_view(head, entries, total(tallies), chosen, None, workbook=True)
    rows = (*museum.rows, *((museum.stores,) if museum.stores else ()))
    return Shown(museum, tuple(pages[row.pages[0].file] for row in rows))
