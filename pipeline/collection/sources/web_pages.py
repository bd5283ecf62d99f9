"""Tables of web pages, and workbooks that programs save as pages (.xls) or as XML of Excel 2003.

A cell over several columns is followed by empty ones; words over several rows, such as a room's, hold for each of them.
A table within a cell is a table of its own.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from html.parser import HTMLParser
from io import BufferedReader, TextIOWrapper
from typing import ClassVar, Literal

from pydantic import Field

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.base import FileSource, Request, SourceSettings
from pipeline.collection.sources.delimited import Encoding, HeadedSettings
from pipeline.collection.sources.heads import joined_heads, numbered_heads
from pipeline.collection.sources.rows import Row

MOST_CELLS = 5_000_000
"""Cells of all tables of a page."""

MOST_SPANNED = 100
"""Rows or columns that one cell may reach over."""

_PIECE = 1 << 16
_DIGITS = 7
_LARGEST = 256 << 20
_BEGINS = re.compile(
    rb"(?:\xef\xbb\xbf)?\s*(?:<!--.{0,2000}?-->\s*)?(?:<\?xml[^>]{0,200}\?>\s*)?(?:<\?mso[^>]{0,200}\?>\s*)?"
    # In XML of museums a table may be anything: one of a page has rows or a caption right below.
    rb"<(?:!doctype html|html|table(?:\s[^>]{0,500})?>\s*<(?:tr|thead|tbody|caption|colgroup)[\s>]"
    rb"|(?:\w+:)?workbook[^>]{0,2000}urn:schemas-microsoft-com:office:spreadsheet)",
    re.IGNORECASE | re.DOTALL,
)
_UNSEEN = frozenset({"script", "style", "title", "template"})
_CELLS = frozenset({"td", "th", "cell"})
_ROWS = frozenset({"tr", "row"})
_BREAKS = frozenset({"br", "p", "li", "div"})


class PageSettings(HeadedSettings):
    """How a table of a web page is read."""

    format: Literal["html"] = Field(description="The kind of source.")
    encoding: Encoding = Field(default="utf-8", description="How its letters are coded.")
    table: int = Field(default=1, ge=1, le=1000, description="Which of its tables, from the first on.")


class WebPage(FileSource):
    """A table of a web page."""

    name = "html"
    title = "a web page"
    Settings: ClassVar[type[SourceSettings]] = PageSettings

    def recognises(self, where: str, head: bytes) -> bool:  # noqa: ARG002
        """Say whether it begins as pages with tables do, or as workbooks that are written as XML."""
        return _BEGINS.match(head) is not None

    def rows(self, binary: BufferedReader, file: str, request: Request) -> Iterator[Row]:
        """Yield the header and the rows of the table.

        Parameters
        ----------
        binary, file, request : BufferedReader, str, Request
            As of `FileSource.rows`.

        Yields
        ------
        Row
            First the header.

        Raises
        ------
        CollectionError
            For a page without the table, and one that is too large.
        """
        own: PageSettings = request.settings
        tables = page_tables(binary, file, own.encoding)
        if len(tables) < own.table:
            raise CollectionError(f"{file}: has {len(tables)} tables; say in the mapping which, [source] table")
        table = tables[own.table - 1]
        width = max(len(cells) for _, cells in table)
        if width * len(table) > MOST_CELLS:
            # One long row makes all others as long.
            raise CollectionError(f"{file}: {len(table):,} rows of up to {width:,} cells; export the list as CSV")
        return own.straight(_rows(table, width, own), file)


def _rows(table: list[tuple[int, list[str]]], width: int, own: PageSettings) -> Iterator[Row]:
    first, many = own.head
    whole = [(line, [*cells, *[""] * (width - len(cells))]) for line, cells in table]
    heads = [cells for _, cells in whole[first - 1 : first - 1 + many]] if first else []
    yield Row(0, 1, numbered_heads(width) if not first else joined_heads(heads) if many > 1 else (heads or [[]])[0])
    below = (pair for pair in whole[first - 1 + many if first else 0 :] if any(map(str.strip, pair[1])))
    for number, (line, cells) in enumerate(below, start=1):
        if cells not in heads:
            yield Row(number, line, cells)


def page_tables(binary: BufferedReader, file: str, encoding: str) -> list[list[tuple[int, list[str]]]]:
    """Return the tables of a page that hold anything: of each its rows, with the line where each begins.

    Parameters
    ----------
    binary : BufferedReader
        The page.
    file : str
        Its name in messages.
    encoding : str
        Of its letters.

    Returns
    -------
    list of list of (int, list of str)

    Raises
    ------
    CollectionError
        For a page that is too large, and one that fails.
    """
    binary.seek(0)
    stream = TextIOWrapper(binary, encoding=encoding, errors="replace")
    reader = _PageTables(file)
    try:
        size = 0
        while piece := stream.read(_PIECE):
            size += len(piece)
            if size > _LARGEST:
                raise CollectionError(f"{file}: more than {_LARGEST:,} characters; export the list as CSV or Excel")
            reader.feed(piece.lstrip("\ufeff") if size == len(piece) else piece)
        reader.close()
    except OSError as problem:
        raise CollectionError(f"{file}: reading stopped: {problem}; see whether the disk is there") from problem
    finally:
        stream.detach()
    return [table for table in reader.tables if any(cell.strip() for _, cells in table for cell in cells)]


class _OpenTable:
    """A table whose end has not come: its rows, the cells of the last of them, and what hangs down into the next."""

    def __init__(self) -> None:
        self.rows: list[tuple[int, list[str]]] = []
        self.text: list[str] | None = None
        self.span = (1, 1)
        self.down: dict[int, tuple[int, str]] = {}

    def begin_row(self, line: int) -> None:
        self.end_cell()
        self.rows.append((line, []))

    def begin_cell(self, line: int, at: int | None, span: tuple[int, int]) -> None:
        self.end_cell()
        if not self.rows:
            self.rows.append((line, []))
        cells = self.rows[-1][1]
        self._hang(cells)
        if at is not None:
            cells += [""] * (at - 1 - len(cells))
        self.text, self.span = [], span

    def end_cell(self) -> None:
        if self.text is None:
            return
        cells = self.rows[-1][1]
        text = re.sub(r"[ \t\r\f\xa0]+", " ", "".join(self.text)).strip()
        text = re.sub(r"[;,]?\s*\n\s*", "; ", text)
        across, down = self.span
        if down > 1:
            self.down |= {len(cells) + at: (down - 1, text if at == 0 else "") for at in range(across)}
        cells += [text, *[""] * (across - 1)]
        self.text = None

    def _hang(self, cells: list[str]) -> None:
        while len(cells) in self.down:
            left, text = self.down.pop(at := len(cells))
            if left > 1:
                self.down[at] = left - 1, text
            cells.append(text)


class _PageTables(HTMLParser):
    def __init__(self, file: str) -> None:
        super().__init__(convert_charrefs=True)
        self._file = file
        self._open: list[_OpenTable] = []
        self._unseen = self._cells = 0
        self.tables: list[list[tuple[int, list[str]]]] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        name = tag.rpartition(":")[2]
        if name in _UNSEEN:
            self._unseen += 1
        elif name == "table":
            self._open.append(_OpenTable())
            self.tables.append(self._open[-1].rows)
        elif not self._open:
            return
        elif name in _ROWS:
            self._open[-1].begin_row(self.getpos()[0])
        elif name in _CELLS:
            said = {key.rpartition(":")[2]: value or "" for key, value in attrs}
            at = _number(said.get("index"), 0) or None
            # In Excel's XML how many more, in a page how many.
            across = _number(said.get("colspan"), 1) + _number(said.get("mergeacross"), 0)
            down = _number(said.get("rowspan"), 1) + _number(said.get("mergedown"), 0)
            self._cells += across
            if self._cells > MOST_CELLS:
                raise CollectionError(f"{self._file}: more than {MOST_CELLS:,} cells; export fewer objects")
            self._open[-1].begin_cell(self.getpos()[0], at, (across, down))
        elif name in _BREAKS and self._open[-1].text:
            self._open[-1].text.append("\n")

    def handle_endtag(self, tag: str) -> None:
        name = tag.rpartition(":")[2]
        if name in _UNSEEN:
            self._unseen = max(0, self._unseen - 1)
        elif self._open and name in _CELLS:
            self._open[-1].end_cell()
        elif self._open and name == "table":
            self._open.pop().end_cell()

    def handle_data(self, data: str) -> None:
        if self._open and not self._unseen and self._open[-1].text is not None:
            # A line that ends within a text is a blank; what <br> parts are several texts.
            self._open[-1].text.append(data.replace("\r", " ").replace("\n", " "))


def _number(text: str | None, otherwise: int) -> int:
    text = (text or "").strip()
    return min(int(text), MOST_SPANNED) if text.isdecimal() and len(text) < _DIGITS else otherwise
