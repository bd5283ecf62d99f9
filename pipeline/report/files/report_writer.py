"""A report put together from its pages: exports and index, built aside and named when it is whole.

What an earlier report holds of a page that has not changed is taken from there by a link to the same files, after their
checksums were compared; the exports of the whole are put together from the parts of its pages.
"""

import os
import shutil
from collections.abc import Mapping, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import ExitStack, suppress
from dataclasses import replace
from hashlib import sha256
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from markupsafe import Markup

from pipeline.planning.plan import PlanTerms
from pipeline.records import DecisionStatus, Page, Photo, RunChanges, RunRecord, Tally
from pipeline.report.errors import ReportError
from pipeline.report.files.concatenation import concatenate, ranked
from pipeline.report.files.exports import EXPORTS, PARTS_OF_PAGE, WORKBOOK, part_of, write_exports_workbook
from pipeline.report.files.manifest import (
    PARTS,
    FileSum,
    KeptPage,
    PreviousReport,
    ReportManifest,
    part_files,
    sum_of,
    write_manifest,
)
from pipeline.report.files.object_list import LISTED, OBJECTS, SHOWN, is_list_file, listed_pages, turned, turns
from pipeline.report.files.page_renderer import PageRenderer, RenderedPage, drawn
from pipeline.report.files.plan_files import PLAN_FILES, PLANNED_FROM, gathered_from, write_plan_table
from pipeline.report.files.ranks import KEYS, ranks_of
from pipeline.report.files.walk_sheet import sheet_file
from pipeline.report.language import speaking
from pipeline.report.pages.class_curves import FILE as CLASS_CURVES
from pipeline.report.pages.class_curves import class_curves, curves_csv
from pipeline.report.pages.compose import anchor_of, museum_view, page_head, page_name
from pipeline.report.pages.environment import environment, fill, script_of
from pipeline.report.pages.errand_views import plan_page
from pipeline.report.pages.further import further_pages
from pipeline.report.pages.news import news_pages, news_view, page_file, together
from pipeline.report.pages.reading import (
    IMAGES,
    INVENTORY,
    READING,
    Doubts,
    is_reading_file,
    reading_view,
    write_doubts,
)
from pipeline.report.pages.since import since_view
from pipeline.report.pages.views import Pointer, State
from pipeline.report.plots.traces import trace
from pipeline.report.text import clean, short
from pipeline.resources import aside_of, naming, page_version


def page_key(
    renderer: PageRenderer,
    page: Page,
    decisions: Sequence[DecisionStatus],
    photos: Mapping[str, Photo] | None = None,
) -> str:
    """Return the digest of everything that a page and its parts of the exports depend on.

    Parameters
    ----------
    renderer : PageRenderer
        What draws it, see `PageRenderer.identity`.
    page : Page
        All its fields count.
    decisions : sequence of DecisionStatus
        Those about its objects, as they stand.
    photos : mapping of str to Photo, optional
        Pictures of its objects by number, with or without their content.
    """
    shown = [(number, photo.name) for number, photo in sorted((photos or {}).items())]
    return _key(renderer, page, list(decisions), *filter(None, [shown]))


def _key(renderer: PageRenderer, *own: object) -> str:
    return sha256(repr((page_version(), renderer.identity, *own)).encode("utf-8", "surrogatepass")).hexdigest()


class ReportWriter:
    """A report that is being put together; leaving the block without `finish` removes all of it.

    Parameters
    ----------
    folder : Path
        A new folder; it appears only when everything in it is written.
    renderer : PageRenderer
        What draws the pages of the run.
    previous : PreviousReport, optional
        Whose pages may be used again.
    listed : int
        Rows on a page of the list of all objects.

    Raises
    ------
    ReportError
        If the folder exists.
    """

    def __init__(
        self, folder: Path, renderer: PageRenderer, previous: PreviousReport | None = None, listed: int = SHOWN
    ) -> None:
        if folder.exists():
            raise ReportError(f"{folder} exists already; a report never overwrites another: name a new folder")
        self.folder, self.renderer, self._listed = folder, renderer, listed
        self._previous = previous or PreviousReport(folder)
        self._partial = aside_of(folder)
        self._pages: list[KeptPage] = []
        self._files: dict[str, FileSum] = {}
        self._stack = ExitStack()

    def __enter__(self) -> Self:
        with ExitStack() as stack:
            stack.enter_context(naming(self.folder))
            stack.callback(shutil.rmtree, self._partial, ignore_errors=True)
            (self._partial / PARTS).mkdir(parents=True)
            self._stack = stack.pop_all()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stack.__exit__(kind, error, trace)

    def look(self, keys: Sequence[str]) -> None:
        """See at once which of some pages the earlier report has, before `has` is asked of each."""
        self._previous.look(keys)

    def has(self, key: str) -> bool:
        """Say whether the earlier report has a page, all its files as they were written."""
        return self._previous.get(key) is not None

    def reuse(self, key: str) -> Tally:
        """Take a page from the earlier report, which has it, and return what it adds to the totals."""
        page = self._previous.get(key)
        if page is None:
            raise KeyError(key)
        # Two galleries whose files would have one name are refused at the end; a linked file is never written into.
        if page.entry.page.file not in self._files:
            self._link(*page.files)
        self._pages.append(page)
        return page.tally

    def add(self, key: str, rendered: RenderedPage) -> Tally:
        """Add a page that was drawn for this report, and return what it adds to the totals."""
        page = rendered.entry.page.file
        if page not in self._files:
            self._write(page, rendered.page)
            for name, export in zip(part_files(page), PARTS_OF_PAGE, strict=True):
                self._write(name, rendered.parts[export])
            if rendered.sheet is not None:
                self._write(sheet_file(page), rendered.sheet)
            for name, content in rendered.images.items():
                # By their names they are what they were: another page, or the earlier report, may have them too.
                if name not in self._files and self._previous.has(name):
                    self._link(name)
                elif name not in self._files:
                    self._write(name, content)
        self._pages.append(KeptPage(key, rendered.entry, rendered.tally, tuple(rendered.images)))
        return rendered.tally

    def finish(
        self,
        head: RunRecord,
        tally: Tally,
        changes: RunChanges | None,
        links: Mapping[str, Pointer],
        beside: Mapping[str, str] | None = None,
        doubts: Doubts | None = None,
        terms: PlanTerms | None = None,
    ) -> Path:
        """Write the exports, the index and the pages that all share, and give the report its name.

        Parameters
        ----------
        head : RunRecord
            The run as it ended, without its objects; its decisions are those about objects that it does not have.
        tally : Tally
            Of all pages together.
        changes : RunChanges or None
            Since the run before, for the index; None where there was none.
        links : mapping of str to Pointer
            The objects that the index names as changed, by number.
        beside : mapping of str to str, optional
            Further files of the report, by name.
        doubts : callable, optional
            Gives what reading refused and doubts, if that is known.
        terms : PlanTerms, optional
            What the plan rests on; without it there is none, as where nobody knows how likely harm is.

        Returns
        -------
        Path
            Of index.html.

        Raises
        ------
        ReportError
            Where two galleries' files would have one name.
        """
        self._turn()
        # Copying, checksums and compression leave this thread to work.
        with ThreadPoolExecutor() as pool:
            made = self._exporting(pool)
            self._list(head)
            plan = "" if terms is None else self._plan(head, terms, made)
            self._files |= {name: one.result() for name, one in made.items()}
        self._workbook(head)
        for name, text in [*self._shared(head, tally, changes, links, plan=plan), *(beside or {}).items()]:
            self._write(name, text.encode())
        curves = class_curves(tally)
        if curves:
            self._write(CLASS_CURVES, curves_csv(curves).encode())
        reading = "" if doubts is None else self._read(head, doubts)
        files = dict(sorted(self._files.items()))
        write_manifest(self._partial, ReportManifest(tuple(self._pages), reading, files, plan))
        self._partial.rename(self.folder)
        return self.folder / "index.html"

    def _write(self, name: str, content: bytes) -> None:
        target = self._partial / name
        target.parent.mkdir(exist_ok=True)
        target.write_bytes(content)
        self._files[name] = FileSum(len(content), sha256(content).hexdigest())

    def _link(self, *names: str) -> None:
        """Take files over from the earlier report, whose checksums were compared."""
        for name in names:
            if name in self._files:
                continue
            (self._partial / name).parent.mkdir(exist_ok=True)
            _link_or_copy(self._previous.folder / name, self._partial / name)
            self._files[name] = self._previous.manifest.files[name]

    def _turn(self) -> None:
        """Say on each page which gallery is before it and which behind it, where that is not what it says already."""
        with speaking(self.renderer.language):
            links = turns([page.entry for page in self._pages])
        for at, (page, told) in enumerate(zip(self._pages, links, strict=True)):
            if page.turn == told:
                continue
            file = self._partial / page.entry.page.file
            content = turned(file.read_bytes(), told)
            # It may be the very file of the earlier report, which stays as it is.
            file.unlink()
            self._write(page.entry.page.file, content)
            self._pages[at] = replace(page, turn=told)

    @property
    def _same(self) -> bool:
        """Whether the earlier report has the same pages."""
        return [page.key for page in self._pages] == self._previous.pages

    def _parts(self, kind: str) -> list[Path]:
        at = PARTS_OF_PAGE.index(kind)
        return [self._partial / part_files(page.entry.page.file)[at] for page in self._pages]

    def _exporting(self, pool: ThreadPoolExecutor) -> dict[str, Future[FileSum]]:
        """Begin to write the exports of the whole report; take those of the earlier one if it has the same pages."""
        taken = set(filter(self._previous.has, EXPORTS)) if self._same else set()
        self._link(*taken)
        left = [name for name in EXPORTS if name not in taken]
        # Of all these the ranks take longest to find, and need this thread no more than they do.
        ranks = pool.submit(ranks_of, self._parts(KEYS)) if any(map(ranked, left)) else None

        def made(name: str) -> FileSum:
            own = ranks.result() if ranks is not None and ranked(name) else None
            return concatenate(self._partial / name, self._parts(part_of(name)), own)

        # What the plan is made of comes first.
        return {name: pool.submit(made, name) for name in sorted(left, key=lambda name: name not in PLANNED_FROM)}

    def _workbook(self, head: RunRecord) -> None:
        if self._same and self._previous.has(WORKBOOK):
            self._link(WORKBOOK)
        elif write_exports_workbook(self._partial, head.started):
            self._files[WORKBOOK] = sum_of(self._partial / WORKBOOK)

    def _list(self, head: RunRecord) -> None:
        """Write the list of all objects, or take that of the earlier report if it has the same pages."""
        files = [name for name in self._previous.manifest.files if is_list_file(name)]
        if self._same and files and self._previous.has(*files):
            self._link(*files)
            return
        pages, rows = listed_pages(self._parts(LISTED), self._listed)
        with speaking(self.renderer.language):
            shown = page_head(head, Page("", "", True, 1, 1, head.run_id, head.finished))
            context: dict[str, Any] = {"museum": shown, "here": OBJECTS, "pages": pages}
            context["planned"] = self.renderer.planned
            context |= script_of(OBJECTS)
            env = environment(self.renderer.language)
            for number, (page, own) in enumerate(zip(pages, rows, strict=True), 1):
                text = fill(env, f"{OBJECTS}.html", context | {"number": number, "rows": Markup(own)})  # noqa: S704
                self._write(page.file, text.encode())

    def _read(self, head: RunRecord, doubts: Doubts) -> str:
        """Write the page and the list of what reading refused and doubts, or take those of the earlier report."""
        said = (sorted(head.settings[READING].items()), head.settings.get(INVENTORY), head.settings.get(IMAGES))
        key = _key(self.renderer, *said)
        files = [name for name in self._previous.manifest.files if is_reading_file(name)]
        if key == self._previous.manifest.reading and self._previous.has(*files):
            self._link(*files)
            return key
        table, language = f"{READING}.csv", self.renderer.language
        with speaking(language):
            listed = write_doubts(self._partial / table, doubts(), self.renderer.units)
            self._files[table] = sum_of(self._partial / table)
            shown = page_head(head, Page("", "", True, 1, 1, head.run_id, head.finished))
            context: dict[str, Any] = {"museum": shown, "reading": reading_view(head.settings), "listed": listed}
            context |= {"here": "reading", "units": self.renderer.units, "planned": self.renderer.planned}
            for number, page in enumerate(listed.pages, 1):
                text = fill(environment(language), f"{READING}.html", context | {"number": number})
                self._write(page, text.encode())
        return key

    def _plan(self, head: RunRecord, terms: PlanTerms, made: Mapping[str, Future[FileSum]]) -> str:
        """Write the page and the list of errands, or take those of the earlier report."""
        key = _key(self.renderer, [page.key for page in self._pages], terms)
        if key == self._previous.manifest.plan and self._previous.has(*PLAN_FILES):
            self._link(*PLAN_FILES)
            return key
        page, table = PLAN_FILES
        for name in made.keys() & set(PLANNED_FROM):
            made[name].result()
        plan = gathered_from(self._partial).plan(terms)
        # An unchanged night takes it over: like a gallery's page it says when its results were found.
        shown = page_head(head, Page("", "", True, 1, 1, head.run_id, head.finished))
        self._write(page, plan_page(plan, shown, self.renderer.language).encode())
        write_plan_table(self._partial / table, plan)
        self._files[table] = sum_of(self._partial / table)
        return key

    def _shared(
        self, head: RunRecord, tally: Tally, changes: RunChanges | None, links: Mapping[str, Pointer], *, plan: str
    ) -> list[tuple[str, str]]:
        units, drawings = self.renderer.units, self.renderer.drawings
        with speaking(self.renderer.language):
            since = None if changes is None else since_view(changes, links, units)
            entries = [page.entry for page in self._pages]
            museum = museum_view(head, entries, tally, units, since, workbook=WORKBOOK in self._files)
            env = environment(self.renderer.language)
            further, left_out = further_pages(env, head, tally, entries)
            shared: dict[str, Any] = {"museum": museum, "units": units, "State": State, "further": further}
            shared["planned"] = bool(plan)
            news = None if changes is None else news_view(changes, links)
            listed = news_pages(news)
            told: dict[str, Any] = shared | {"news": news, "files": [page_file(at + 1) for at in range(len(listed))]}
            traces = {
                view.anchor: trace(motion, units, view.anchor)
                for view, motion in zip(museum.motions, head.motions, strict=True)
            }
            shaken = drawn([key for motion in museum.motions for key in motion.charts], drawings)
            hashes = [motion.hash[:16] for motion in head.motions]
            measured = drawn([key for key in drawings if not any(h in key for h in hashes)], drawings)
            return [
                ("index.html", fill(env, "index.html", told | {"here": "index", "left_out": left_out})),
                *(
                    (file, fill(env, "news.html", told | {"here": "news", "groups": together(lines), "number": number}))
                    for number, (file, lines) in enumerate(zip(told["files"], listed, strict=True), 1)
                ),
                ("method.html", fill(env, "method.html", shared | measured | {"here": "method"})),
                ("motion.html", fill(env, "motion.html", shared | shaken | {"here": "motion", "traces": traces})),
                *(
                    (page.file, fill(env, "further.html", shared | {"here": page.file, "page": page}))
                    for page in further
                ),
            ]


def _link_or_copy(source: Path, target: Path) -> None:
    # A link costs nothing, and files of a report are never changed; a file system without links gets a copy.
    with suppress(OSError):
        os.link(source, target)
        return
    shutil.copyfile(source, target)


def link_to(page: Page, object_number: str, title: str) -> Pointer:
    """Return an object of a page as the index names it, of which only number and title are known."""
    file = page_name(page.gallery, page.number, on_display=page.on_display)
    return Pointer(clean(object_number), short(title, 80), file, anchor_of(object_number), "", State.ACT)
