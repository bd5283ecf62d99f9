"""The pages of a run: how the decisions about what is on them stand, and the report that they are drawn into."""

from collections.abc import Generator, Iterator, Sequence
from contextlib import AbstractContextManager, closing
from dataclasses import dataclass
from typing import Any

from pipeline.collection.inventory import fields_since
from pipeline.night.decision_review import now, standing
from pipeline.night.page_tasks import PageTask, Rendered, render_page
from pipeline.night.photographs import Photographs
from pipeline.night.scheduler import PlannedPage, Scheduler
from pipeline.records import Decision, DecisionStatus, Found, Page, Photo, Progress, RunChanges, Tally
from pipeline.report.files.manifest import PreviousReport
from pipeline.report.files.report_writer import ReportWriter, link_to, page_key
from pipeline.report.pages.since import mentioned
from pipeline.report.pages.tallies import total
from pipeline.report.pages.views import Pointer
from pipeline.store.pages import found_of, page_row


@dataclass
class _PublishedPage:
    """A page of the run, now that all results on it are known.

    Attributes
    ----------
    planned
        What is on it.
    page
        Where it belongs.
    standing
        The decisions about its objects, as they stand.
    row
        Of the database, where it is not there yet and was made already.
    photographed
        Whether an object on it has a picture.
    """

    planned: PlannedPage
    page: Page
    standing: tuple[DecisionStatus, ...]
    row: dict[str, Any] | None = None
    photographed: bool = False


class Publication:
    """The pages of a run whose units have results.

    Parameters
    ----------
    scheduler
        Of the run, after its `assess`.
    photographs
        Of its objects, gathered; none are shown without.
    previous
        The report whose pages may be used again; the latest, read when it is needed, where it is left out.
    """

    def __init__(
        self, scheduler: Scheduler, photographs: Photographs | None = None, previous: PreviousReport | None = None
    ) -> None:
        self._scheduler, self._previous = scheduler, previous
        self._photographs = photographs or Photographs(None)
        self._digests = scheduler.index.digests(list(scheduler.decisions))
        self._pages = [self._settled(page) for page in scheduler.pages]

    def _settled(self, planned: PlannedPage) -> _PublishedPage:
        """Say where a page belongs, and how the decisions about it stand."""
        stands = self._standing(planned)
        if self._scheduler.is_failed(planned):
            # What is kept of it names results that are not there.
            planned.kept = None
        part, made = planned.part, planned.kept or self._scheduler.newest_of(planned)
        key = self._scheduler.key_of(planned)
        page = Page(key, part.gallery, part.on_display, part.number, part.of, made.run, made.made)
        return _PublishedPage(planned, page, stands)

    def _standing(self, planned: PlannedPage) -> tuple[DecisionStatus, ...]:
        about = self._scheduler.decisions
        mine = [decision for number in planned.numbers() for decision in about.get(number, ())] if about else []
        if not mine:
            return ()
        found = found_of(*self._scheduler.found(planned))
        return self._stands(found, sorted(mine, key=lambda decision: decision.id))

    def _stands(self, found: Found, decisions: Sequence[Decision]) -> tuple[DecisionStatus, ...]:
        digests = {number: self._digests[number] for number in {d.object_number for d in decisions}}
        engine = self._scheduler.workspace.engine
        at = now(
            found.assessments,
            self._scheduler.context.head,
            digests,
            lambda number, digest: () if digest == digests[number] else tuple(fields_since(engine, number, digest)),
        )
        return standing(decisions, at)

    @property
    def pages(self) -> tuple[Page, ...]:
        """The pages of the run."""
        return tuple(one.page for one in self._pages)

    def rows(self, *, kept: bool = False) -> Iterator[dict[str, Any]]:
        """Yield the rows of those pages that the database does not have, or, for another database, of all."""
        for one in self._pages:
            if kept or one.planned.kept is None:
                yield one.row or page_row(one.page, self._scheduler.members(one.planned))

    @property
    def standing(self) -> tuple[DecisionStatus, ...]:
        """The decisions about the objects of the run, as they stand."""
        return tuple(one for page in self._pages for one in page.standing)

    def strangers(self, *, whole: bool) -> tuple[DecisionStatus, ...]:
        """Return the decisions about objects that the collection does not have any more.

        whole : whether the run is of all objects: else what is not in it is not gone
        """
        if not whole:
            return ()
        decisions = self._scheduler.decisions
        gone = [d for number, mine in decisions.items() if number not in self._digests for d in mine]
        at = now((), self._scheduler.context.head, {}, lambda _number, _digest: ())
        return standing(sorted(gone, key=lambda d: d.id), at)

    # -----------------------------------------------------------------------------------------------------------------
    # The report

    def writer(self) -> ReportWriter:
        """Return the report that the pages go into; it is entered before `publish`, and finished after it."""
        reports, head = self._scheduler.workspace.reports, self._scheduler.context.head
        previous = self._previous or PreviousReport.read(reports / "latest")
        return ReportWriter(reports / head.run_id, self._scheduler.context.renderer, previous)

    def publish(self, writer: ReportWriter, progress: Progress) -> Tally:
        """Put every page into the report, and return the totals."""
        context = self._scheduler.context
        keys = [page_key(context.renderer, one.page, one.standing, self._known(one)) for one in self._pages]
        writer.look(keys)
        reused = [writer.has(key) for key in keys]
        left = [page for page, there in zip(self._pages, reused, strict=True) if not there]
        tallies = []
        with self._rendered(left, draw=True) as rendered:
            for at, (one, key, there) in enumerate(zip(self._pages, keys, reused, strict=True)):
                progress.step("pages", at, len(keys))
                if there:
                    tallies.append(writer.reuse(key))
                    continue
                came = next(rendered)
                self._scheduler.failed(came.faults)
                if came.page is None:
                    raise ValueError("a page that was to be rendered was not")
                # A page on which an object failed is tried again every night.
                again = came.faults or self._scheduler.is_failed(one.planned)
                again = again or (one.photographed and self._photographs.lost(one.planned.numbers()))
                writer.add(f"{key}:{context.head.run_id}" if again else key, came.page)
                tallies.append(came.tally)
        progress.step("pages", len(keys), len(keys))
        return total(tallies)

    def _known(self, one: _PublishedPage) -> dict[str, Photo]:
        known = self._photographs.known(one.planned.numbers())
        one.photographed = bool(known)
        return known

    def tally(self, progress: Progress) -> Tally:
        """Return the totals without a report."""
        tallies = []
        with self._rendered(self._pages, draw=False) as rendered:
            for at, came in enumerate(rendered):
                progress.step("pages", at + 1, len(self._pages))
                tallies.append(came.tally)
        return total(tallies)

    def _rendered(self, pages: Sequence[_PublishedPage], *, draw: bool) -> AbstractContextManager[Generator[Rendered]]:
        return closing(self._each_rendered(pages, draw=draw))

    def _each_rendered(self, pages: Sequence[_PublishedPage], *, draw: bool) -> Generator[Rendered]:
        objects = sum(len(page.planned.part.objects) for page in pages)
        scheduler = self._scheduler
        with scheduler.staff.workers(objects, scheduler.context, showing=True) as (workers, context):
            tasks = (self._page_task(page, draw=draw) for page in pages)
            with closing(workers.each(render_page, context, tasks)) as done:
                yield from done

    def _page_task(self, one: _PublishedPage, *, draw: bool) -> PageTask:
        members, results = self._scheduler.found(one.planned)
        if one.planned.kept is None and draw:
            one.row = page_row(one.page, members)
        photos = self._photographs.of(one.planned.numbers()) if draw and one.photographed else {}
        return PageTask(one.page, members, results, one.standing, draw, photos)

    def links(self, changes: RunChanges | None) -> dict[str, Pointer]:
        """Return where the objects are that the index names as changed, by number."""
        named = set() if changes is None else mentioned(changes)
        out: dict[str, Pointer] = {}
        for one in self._pages if named else ():
            mine = named.intersection(one.planned.numbers())
            if mine:
                items = self._scheduler.index.items(sorted(mine))
                out |= {number: link_to(one.page, number, item.called) for number, item in items.items()}
        return out
