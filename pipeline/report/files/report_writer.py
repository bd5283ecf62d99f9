"""A report put together from its sheets: pages, exports and index, built aside and named when it is whole.

What an earlier report holds of a sheet that has not changed is taken from there: its page by a link to the same file,
its rows of the exports by copying their bytes.  A report remembers in ``.sheets.json`` what of it is which sheet's.
"""

import os
import shutil
from collections.abc import Mapping, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from functools import cache
from hashlib import sha256
from pathlib import Path
from types import TracebackType
from typing import Any, Self

from markupsafe import Markup
from pydantic import TypeAdapter, ValidationError

from pipeline.records import RunChanges, RunRecord, Sheet, Standing, Tally
from pipeline.report.errors import ReportError
from pipeline.report.files.exports import HEADERS, TABLES, TEXT_FILES, WORKBOOK, WORKBOOK_ROWS, schema_of, workbook
from pipeline.report.files.page_renderer import Drawn, Pen, drawn
from pipeline.report.files.table_files import TableFile
from pipeline.report.files.text_files import TextFile
from pipeline.report.language import speaking
from pipeline.report.pages.compose import anchor_of, museum_view, page_head, page_name
from pipeline.report.pages.environment import environment, fill
from pipeline.report.pages.reading import (
    FILES,
    INVENTORY,
    READING,
    Doubts,
    has_reading,
    reading_view,
    write_doubts,
    write_key,
)
from pipeline.report.pages.since import since_view
from pipeline.report.pages.views import Entry, Pointer, State
from pipeline.report.plots.traces import trace
from pipeline.report.text import clean, short
from pipeline.resources import aside_of, naming, page_version

SHEETS = ".sheets.json"
"""File of a report that says what of it is which sheet's."""


@dataclass(frozen=True, slots=True)
class Placed:
    """Where a report holds a sheet.

    key    : of everything that its page and its rows depend on
    texts  : by file, where its bytes begin and how many they are
    tables : by table, where its rows begin and how many they are
    """

    key: str
    entry: Entry
    texts: Mapping[str, tuple[int, int]]
    tables: Mapping[str, tuple[int, int]]


@dataclass(frozen=True)
class Shelved:
    """An earlier report, as far as its sheets can be used again."""

    folder: Path
    sheets: Mapping[str, Placed] = field(default_factory=dict)

    @classmethod
    def read(cls, folder: Path) -> "Shelved":
        """Return what a report holds; nothing where it holds none, or says so in a way that is not understood."""
        try:
            listed = _adapter().validate_json((folder / SHEETS).read_bytes())
            if all(folder.joinpath(name).is_file() for name in (*TEXT_FILES, *(f"{name}.parquet" for name in TABLES))):
                return cls(folder, {placed.key: placed for placed in listed})
        except (OSError, ValidationError):
            pass
        return cls(folder)

    def get(self, key: str) -> Placed | None:
        """Return where a sheet is, if its page is there."""
        placed = self.sheets.get(key)
        return placed if placed is not None and (self.folder / placed.entry.sheet.page).is_file() else None


@cache
def _adapter() -> TypeAdapter[list[Placed]]:
    return TypeAdapter(list[Placed])


def sheet_key(pen: Pen, sheet: Sheet, decisions: Sequence[Standing]) -> str:
    """Return the digest of everything that a sheet's page and rows depend on."""
    own = (sheet.key, sheet.run, sheet.made, sheet.gallery, sheet.on_display, sheet.number, sheet.of, list(decisions))
    return sha256(repr((page_version(), pen.identity, own)).encode("utf-8", "surrogatepass")).hexdigest()


class Edition:
    """A report that is being put together; leaving the block without `finish` removes all of it.

    folder  : a new folder; it appears only when everything in it is written
    earlier : reports whose sheets may be used again
    raises  : ReportError if the folder exists
    """

    def __init__(self, folder: Path, pen: Pen, earlier: Shelved | None = None) -> None:
        if folder.exists():
            raise ReportError(f"{folder} exists already; a report never overwrites another: name a new folder")
        self.folder, self.pen = folder, pen
        self._earlier = earlier or Shelved(folder)
        self._partial = aside_of(folder)
        self._placed: list[Placed] = []
        self._repeated = False
        self._stack = ExitStack()
        self._texts: dict[str, TextFile] = {}
        self._tables: dict[str, TableFile] = {}

    def __enter__(self) -> Self:
        with ExitStack() as stack:
            stack.enter_context(naming(self.folder))
            self._partial.mkdir(parents=True)
            stack.callback(shutil.rmtree, self._partial, ignore_errors=True)
            earlier = self._earlier.folder
            for name in TEXT_FILES:
                self._texts[name] = TextFile(self._partial / name, HEADERS.get(name, b""), earlier / name)
                stack.callback(self._texts[name].close)
            for name in TABLES:
                file = f"{name}.parquet"
                self._tables[name] = TableFile(self._partial / file, schema_of(name), earlier / file)
                stack.callback(self._tables[name].close)
            self._stack = stack.pop_all()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stack.__exit__(kind, error, trace)

    def _close(self) -> None:
        files: list[TextFile | TableFile] = [*self._texts.values(), *self._tables.values()]
        for file in files:
            file.close()

    def has(self, key: str) -> bool:
        """Say whether the earlier report has a sheet."""
        return self._earlier.get(key) is not None

    def repeat(self, keys: Sequence[str]) -> bool:
        """Take everything from the earlier report, if these are all of its sheets; say whether they are."""
        earlier = self._earlier
        if not keys or list(earlier.sheets) != list(keys) or not all(self.has(key) for key in keys):
            return False
        self._close()
        for name in (*TEXT_FILES, *(f"{name}.parquet" for name in TABLES)):
            (self._partial / name).unlink()
            _same(earlier.folder / name, self._partial / name)
        if (earlier.folder / WORKBOOK).is_file():
            _same(earlier.folder / WORKBOOK, self._partial / WORKBOOK)
        for placed in earlier.sheets.values():
            page = placed.entry.sheet.page
            _same(earlier.folder / page, self._partial / page)
        self._placed = list(earlier.sheets.values())
        self._repeated = True
        return True

    def reuse(self, key: str) -> None:
        """Take a sheet from the earlier report, which has it."""
        placed = self._earlier.sheets[key]
        page = placed.entry.sheet.page
        _same(self._earlier.folder / page, self._partial / page)
        texts = {name: self._texts[name].take(*where) for name, where in placed.texts.items()}
        tables = {name: self._tables[name].take(*where) for name, where in placed.tables.items()}
        self._placed.append(Placed(key, placed.entry, texts, tables))

    def add(self, key: str, made: Drawn) -> None:
        """Add a sheet that was drawn for this report."""
        (self._partial / made.entry.sheet.page).write_bytes(made.page)
        texts = {name: self._texts[name].add(content) for name, content in made.fragment.texts.items()}
        tables = {name: self._tables[name].add(content) for name, content in made.fragment.tables.items()}
        self._placed.append(Placed(key, made.entry, texts, tables))

    def finish(
        self,
        head: RunRecord,
        tally: Tally,
        changes: RunChanges | None,
        links: Mapping[str, Pointer],
        beside: Mapping[str, str] | None = None,
        doubts: Doubts | None = None,
    ) -> Path:
        """Write the index and the pages that all share, and give the report its name.

        head    : the run as it ended, without its objects; its decisions are those about objects that it does not have
        tally   : of all sheets together
        changes : since the run before, for the index; None where there was none
        links   : the objects that the index names as changed, by number
        beside  : further files of the report, by name
        doubts  : gives what reading refused and doubts, if that is known
        returns : the path of index.html
        raises  : ReportError where two galleries' files would have one name
        """
        fits = all(table.rows <= WORKBOOK_ROWS for table in self._tables.values())
        has_book = (self._partial / WORKBOOK).is_file() if self._repeated else fits
        # The exports are still being written meanwhile.
        shared = self._shared(head, tally, changes, links, has_book=has_book)
        for name, text in [*shared, *(beside or {}).items()]:
            (self._partial / name).write_text(text, encoding="utf-8", newline="\n")
        if doubts is not None:
            self._read(head, doubts)
        self._close()
        if fits and not self._repeated:
            workbook(self._partial, head.started)
        (self._partial / SHEETS).write_bytes(_adapter().dump_json(self._placed))
        self._partial.rename(self.folder)
        return self.folder / "index.html"

    def _read(self, head: RunRecord, doubts: Doubts) -> None:
        """Write the page and the list of what reading refused and doubts, or take those of the earlier report."""
        own = (page_version(), self.pen.identity, sorted(head.settings[READING].items()), head.settings.get(INVENTORY))
        key = sha256(repr(own).encode("utf-8", "surrogatepass")).hexdigest()
        write_key(self._partial, key)
        if has_reading(self._earlier.folder, key):
            for name in FILES:
                _same(self._earlier.folder / name, self._partial / name)
            return
        page, table = FILES
        with speaking(self.pen.language):
            listed = write_doubts(self._partial / table, doubts())
            sheet = Sheet("", "", True, 1, 1, head.run_id, head.finished, {})
            context = {"museum": page_head(head, sheet), "reading": reading_view(head.settings), "listed": listed}
            text = fill(environment(self.pen.language), page, context | {"here": "reading", "units": self.pen.units})
        (self._partial / page).write_text(text, encoding="utf-8", newline="\n")

    def _shared(
        self,
        head: RunRecord,
        tally: Tally,
        changes: RunChanges | None,
        links: Mapping[str, Pointer],
        *,
        has_book: bool,
    ) -> list[tuple[str, str]]:
        pen = self.pen
        with speaking(pen.language):
            since = None if changes is None else since_view(changes, links, pen.units)
            entries = [placed.entry for placed in self._placed]
            museum = museum_view(head, entries, tally, pen.units, since, workbook=has_book)
            env = environment(pen.language)
            shared: dict[str, Any] = {"museum": museum, "units": pen.units, "State": State}
            traces = {
                view.anchor: Markup(trace(motion, pen.units, view.anchor))  # noqa: S704 - svg.py escapes all text itself
                for view, motion in zip(museum.motions, head.motions, strict=True)
            }
            shaken = drawn([key for motion in museum.motions for key in motion.charts], pen.drawings)
            hashes = [motion.hash[:16] for motion in head.motions]
            measured = drawn([key for key in pen.drawings if not any(h in key for h in hashes)], pen.drawings)
            return [
                ("index.html", fill(env, "index.html", shared | {"here": "index"})),
                ("method.html", fill(env, "method.html", shared | measured | {"here": "method"})),
                ("motion.html", fill(env, "motion.html", shared | shaken | {"here": "motion", "traces": traces})),
            ]


def _same(source: Path, target: Path) -> None:
    # A link costs nothing, and pages are never changed; a file system without links gets a copy.
    with suppress(OSError):
        os.link(source, target)
        return
    shutil.copyfile(source, target)


def link_to(sheet: Sheet, object_number: str, title: str) -> Pointer:
    """Return an object of a sheet as the index names it, of which only number and title are known."""
    page = page_name(sheet.gallery, sheet.number, on_display=sheet.on_display)
    return Pointer(clean(object_number), short(title, 80), page, anchor_of(object_number), "", State.ACT)
