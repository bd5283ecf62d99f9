"""The rows of a sheet of an .xlsx or .ods workbook: typed cells as texts, and a fault for what was never typed in."""

from __future__ import annotations

import re
import warnings
import zipfile
import zlib
from collections.abc import Collection, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from datetime import date, datetime, time
from io import BufferedReader
from math import isfinite
from pathlib import Path
from typing import Any, BinaryIO, Literal, NamedTuple

from pydantic import Field

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.base import FileSource, Name, Request
from pipeline.collection.sources.delimited import HeadedSettings
from pipeline.collection.sources.files import stream_of
from pipeline.collection.sources.headings import MERGED
from pipeline.collection.sources.heads import joined_heads, numbered_heads
from pipeline.collection.sources.opendocument import OpenBook, OpenCell, OpenPage
from pipeline.collection.sources.rows import Row, TypedNumber, as_text
from pipeline.collection.sources.sheets import one_below_another
from pipeline.collection.sources.shown import is_moment, shown
from pipeline.collection.sources.workbook import (
    COLUMN_LIMIT,
    OLE,
    SAVE_AGAIN,
    Range,
    Survey,
    check_archive,
    check_kind,
    is_open_document,
    survey,
)

_DAMAGE = (
    ArithmeticError,
    AttributeError,
    EOFError,
    LookupError,
    NotImplementedError,
    OSError,
    RuntimeError,
    SyntaxError,  # what XML parsers raise
    TypeError,
    ValueError,
    zipfile.BadZipFile,
    zlib.error,
)
"""What reading a damaged or hostile workbook ends in."""

# Line ends and tabs, as the file format writes them in a text.
_ESCAPED = re.compile("_x00(09|0[aA]|0[dD])_")
_UNUSABLE = re.compile("[\x00\ud800-\udfff]")
_ZEROS = re.compile("0{2,20}")
_MEASURED = re.compile(r"[\d.,/\s\u00bc-\u00be]{0,20}\d[\d.,/\s\u00bc-\u00be]{0,20}(?:[a-z\"]{1,3}\.?)?", re.IGNORECASE)
"""A number, with or without a unit."""


def read_sheet(
    source: str | Path | BinaryIO,
    file: str,
    *,
    sheet: str | None = None,
    header_row: int = 1,
    header_rows: int = 1,
    key: str | None = None,
    texts: Collection[str] = (),
) -> Iterator[Row]:
    """Yield the header (number 0) and then every row of a sheet that is not blank; a row's line is its number there.

    Each row has as many cells as the header has names: missing ones are empty, and a row with anything beyond has a
    fault. Whole numbers are written without a decimal point; a format of zeros only ("0000") keeps its leading zeros, a
    date without a time is a date; no other format counts (50 % is 0.5), but in the columns of texts: there a number is
    the text that the sheet shows, 1913.20 and not 1913.2. In the column of the objects' numbers a date has a fault, for
    a spreadsheet made it of something else. Formulas are never computed, and the value that was once saved beside them
    is never trusted: such cells have a fault, and so have error values, times without a date's meaning (durations), and
    cells that are hidden behind one that is merged across columns, or that holds a number. Words that are merged down a
    column, such as a room beside all that stands in it, hold for each of its rows. Hidden rows are read like all
    others. A header cell that holds any of these is an error of the whole sheet.

    Parameters
    ----------
    source : str, Path or binary stream
        The workbook; a stream can be taken back (seek).
    file : str
        Its name in messages.
    sheet : str or None
        The sheet's name; may be left out where only one sheet is visible.
    header_row : int
        The row (from 1) that names the columns; what stands above it is left out.
    header_rows : int
        How many rows name them together (`heads.joined_heads`); cells that are merged there are no fault.
    key : str or None
        The column of the objects' numbers.
    texts : collection of str
        Columns that hold texts, among them numbers that are names.

    Yields
    ------
    Row
        First the header.

    Raises
    ------
    CollectionError
        For a file that is missing, no workbook, protected, damaged or beyond the limits of `workbook`, and for a sheet
        that is not there or has no header.
    """
    with ExitStack() as stack:
        stream = stream_of(source, file, stack)
        try:
            stream.seek(0)
            check_kind(stream, file)
            archive = stack.enter_context(zipfile.ZipFile(stream))
            check_archive(archive, file)
            page = _page(_load(stream, archive, file), file, sheet)
            if isinstance(page, OpenPage):
                found = page.survey()
            else:
                with archive.open(page._worksheet_path) as part:
                    found = survey(part, file, page.title)
        except CollectionError:
            raise
        except _DAMAGE as problem:
            raise _damaged(file, problem) from problem
        page.reset_dimensions()  # what a sheet says of its own size is often wrong
        if found.last_row and found.last_row < header_row:
            raise CollectionError(f"{file}: {page.title!r} ends in row {found.last_row}; say which row is the header")
        if found.last_row:
            yield from _rows(page, file, header_row, header_rows, found, _Named(key, frozenset(texts)))


def visible_sheets(path: Path) -> tuple[str, ...]:
    """Return the names of a workbook's sheets that are not hidden, in their order.

    Parameters
    ----------
    path : Path
        The workbook.

    Returns
    -------
    tuple of str
        The names.

    Raises
    ------
    CollectionError
        As `read_sheet` for the workbook itself.
    """
    with _workbook(path) as book:
        return tuple(page.title for page in book.worksheets if page.sheet_state == "visible")


def first_rows(path: Path, sheet: str | None, most: int) -> list[list[str]]:
    """Return the texts of a sheet's first rows as they stand, merged or not, to see which of them is the header.

    Parameters
    ----------
    path : Path
        The workbook.
    sheet : str or None
        The sheet's name; may be left out where only one is visible.
    most : int
        Rows.

    Returns
    -------
    list of list of str
        What is no text, number or date is empty.

    Raises
    ------
    CollectionError
        As `read_sheet` for the workbook itself.
    """
    with _workbook(path) as book:
        page = _page(book, path.name, sheet)
        page.reset_dimensions()
        out = []
        for row in page.iter_rows(min_row=1, max_row=most, max_col=COLUMN_LIMIT):
            cells, faults = [""] * len(row), dict[int, tuple[str, str]]()
            for place, cell in enumerate(row):
                if cell.value is not None:
                    _take(cell, place, cells, faults)
            out.append(cells)
        return out


@contextmanager
def _workbook(path: Path) -> Iterator[Any]:
    """Open a workbook, and say of damage that is met within the block that it is that."""
    with ExitStack() as stack:
        try:
            stream = stream_of(path, path.name, stack)
            check_kind(stream, path.name)
            archive = stack.enter_context(zipfile.ZipFile(stream))
            check_archive(archive, path.name)
            yield _load(stream, archive, path.name)
        except CollectionError:
            raise
        except _DAMAGE as problem:
            raise _damaged(path.name, problem) from problem


def _load(stream: BinaryIO, archive: zipfile.ZipFile, file: str) -> Any:
    if is_open_document(archive):
        return OpenBook(archive, file)
    import openpyxl

    if not openpyxl.DEFUSEDXML:
        raise CollectionError(
            f"{file}: the guard against hostile XML is switched off; install defusedxml and unset OPENPYXL_DEFUSEDXML"
        )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # on styles and extensions, which do not matter here
        return openpyxl.load_workbook(stream, read_only=True, keep_links=False, data_only=False)


def _page(book: Any, file: str, sheet: str | None) -> Any:
    there = ", ".join(repr(page.title) for page in book.worksheets[:50]) or "none"
    if sheet is None:
        visible = [page for page in book.worksheets if page.sheet_state == "visible"]
        if len(visible) == 1:
            return visible[0]
        raise CollectionError(
            f'{file}: {len(visible)} visible sheets; say which one to read: sheet = "its name" in the mapping\'s '
            f"[source], which `kouros import FILE --guess` writes. Its sheets are {there}"
        )
    for page in book.worksheets:
        if page.title == sheet:
            return page
    raise CollectionError(f"{file}: has no sheet {sheet!r}; name one of its sheets: {there}")


def _damaged(file: str, problem: BaseException, row: int = 0) -> CollectionError:
    where = f", row {row}" if row else ""
    problem = problem.__cause__ or problem  # openpyxl wraps what it meets
    said = (str(problem).splitlines() or [type(problem).__name__])[0][:200]
    if isinstance(problem, zipfile.BadZipFile | zlib.error | EOFError):
        said += " (it may be cut off: then export or copy it again)"
    return CollectionError(f"{file}{where}: the workbook is damaged: {said}; {SAVE_AGAIN}")


class _Ranges:
    """Cells that belong to ranges, found row by row from top to bottom."""

    def __init__(self, ranges: list[Range], file: str, width: int, *, but_first: bool) -> None:
        self._waiting = sorted((there for there in ranges if there[1] <= width), reverse=True)
        self._open: list[Range] = []
        self._file = file
        self._width = width
        self._but_first = but_first

    def columns(self, row: int) -> dict[int, str]:
        """Index of the column (from 0) -> the range's name, of the row's cells that are in a range."""
        while self._waiting and self._waiting[-1][0] <= row:
            self._open.append(self._waiting.pop())
        self._open = [there for there in self._open if there[2] >= row]
        if len(self._open) > self._width:
            raise CollectionError(f"{self._file}, row {row}: merged cells or array formulas overlap; {SAVE_AGAIN}")
        return {
            column - 1: _name(there)
            for there in self._open
            for column in range(there[1], min(there[3], self._width) + 1)
            if not (self._but_first and (row, column) == there[:2])
        }


def _name(there: Range) -> str:
    from openpyxl.utils import get_column_letter as letter

    return f"{letter(there[1])}{there[0]}:{letter(there[3])}{there[2]}"


class _Named(NamedTuple):
    """Columns whose numbers are names: that of the objects' numbers, and all of texts."""

    key: str | None
    texts: frozenset[str]

    def places(self, header: list[str]) -> dict[int, bool]:
        """Return where they are (from 0), and whether the column is that of the objects' numbers."""
        names = [name.strip() for name in header]
        return {at: name == self.key for at, name in enumerate(names) if name == self.key or name in self.texts}


def _rows(page: Any, file: str, header_row: int, header_rows: int, found: Survey, named: _Named) -> Iterator[Row]:
    last, width = found.last_row, found.last_column
    filled = _Ranges(found.computed, file, width, but_first=False)
    hidden = _Ranges(found.merged, file, width, but_first=True)
    body = header_row + header_rows if header_row else 1
    down = {_name(there) for there in found.merged if there[1] == there[3] and there[0] >= body}
    above: dict[int, tuple[str, tuple[str, str] | None]] = {}
    rows = page.iter_rows(min_row=header_row or 1, max_row=last, max_col=width)
    # Where no cell is part of others, a row whose cells hold nothing is none: some sheets hold a million of them.
    alone = not found.merged and not found.computed
    names = 0
    number = 0
    heads: list[list[str]] = []
    places: dict[int, bool] = {}
    if not header_row:
        names = width
        places = named.places(numbered_heads(width))
        yield Row(0, 1, numbered_heads(width))
    for line in range(header_row or 1, last + 1):
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")  # a date that cannot be becomes an error value, which gets a fault
                row = next(rows)
                if alone and line >= body and all(cell.value is None for cell in row):
                    continue
                cells, faults = [""] * width, dict[int, tuple[str, str]]()
                for place, cell in enumerate(row):
                    if cell.value is not None:
                        _take(cell, place, cells, faults, places.get(place))
        except (*_DAMAGE, StopIteration) as problem:
            raise _damaged(file, problem, line) from problem
        for place, where in filled.columns(line).items():
            cells[place], faults[place] = "", _formula(f"belongs to the formula of {where}")
        used = max((place + 1 for place in range(width) if place in faults or cells[place].strip()), default=0)
        merged = hidden.columns(line)
        if down:
            held = {at: where for at, where in merged.items() if where in down}
            _fill_down(held, above, cells, faults, blank=not used)
        for place, where in merged.items():
            if where not in down and (line >= body or header_rows == 1):
                cells[place], faults[place] = "", _hidden(where)
        if line < body:
            heads.append(cells)
            names = max(names, _header_width(file, line, cells, faults))
            if len(heads) == header_rows:
                head = joined_heads([row[:names] for row in heads]) if header_rows > 1 else cells[:names]
                places = named.places(head)
                yield Row(0, header_row, head)
        elif used:
            number += 1
            fault = ("", "")
            if used > names:
                fault = (
                    f"{used} cells, the header has {names}",
                    "give every column that holds anything a name, and see whether cells were shifted",
                )
            yield Row(number, line, cells[:names], fault, {at: why for at, why in faults.items() if at < names})


def _fill_down(
    merged: Mapping[int, str],
    above: dict[int, tuple[str, tuple[str, str] | None]],
    cells: list[str],
    faults: dict[int, tuple[str, str]],
    *,
    blank: bool,
) -> None:
    """Give the cells that are merged with one above them what that one holds, but in a row that is blank but for them.

    A number is not given: a room holds all that stands in it, but a height is of one object, and nobody says of which.

    above : column (from 0) -> text and fault of the last cell of its own; changed in place, as the row is
    """
    for place, cell in enumerate(cells):
        if place not in merged:
            above[place] = cell, faults.get(place)
        elif not blank:
            text, fault = above[place]
            if _MEASURED.fullmatch(text.strip()):
                text, fault = "", _hidden(merged[place])
            cells[place] = text
            if fault is not None:
                faults[place] = fault


def _header_width(file: str, line: int, cells: list[str], faults: dict[int, tuple[str, str]]) -> int:
    if faults:
        place = min(faults)
        raise CollectionError(
            f"{file}, row {line}: the header cannot be read: cell {place + 1} {faults[place][0]}; {faults[place][1]}; "
            "or say in the mapping's [source] which row names the columns (header_row) and how many do (header_rows)"
        )
    width = max((place + 1 for place, cell in enumerate(cells) if cell.strip()), default=0)
    if not width:
        raise CollectionError(f"{file}, row {line}: the header is empty; say which row holds the columns' names")
    return width


def _take(
    cell: Any, place: int, cells: list[str], faults: dict[int, tuple[str, str]], is_key: bool | None = None
) -> None:
    """Put the text of a cell into its place, or say why there is none; is_key is None where it is no text's column."""
    value = cell.value
    if cell.data_type == "f":
        faults[place] = _formula("holds a formula")
    elif cell.data_type == "e":
        faults[place] = (f"holds the error {str(value)[:20]}", "mend the cell, or empty it")
    elif isinstance(value, str):
        text = _ESCAPED.sub(lambda match: chr(int(match[1], 16)), value)
        if _UNUSABLE.search(text):
            faults[place] = ("holds a character that is none", "type the cell again")
        else:
            cells[place] = text
    elif is_key and is_moment(value):
        told = as_text(_as_shown(cell, value)) if isinstance(value, date | time) else str(value)
        faults[place] = (f"holds a date ({told}), which a spreadsheet made of what was typed", _TYPE_AGAIN)
    elif is_key is not None and isinstance(value, int | float) and not isinstance(value, bool):
        seen = cell.seen if isinstance(cell, OpenCell) else None
        seen = seen or (shown(value, cell.number_format or "") if isfinite(value) else None)
        if seen is not None:
            cells[place] = TypedNumber(seen)
        elif is_key:
            told = f"holds {str(value)[:40]} in the format {str(cell.number_format)[:40]!r}, which shows another text"
            faults[place] = (told, _TYPE_AGAIN)
        else:
            cells[place] = as_text(value)
    else:
        try:
            cells[place] = as_text(_as_shown(cell, value))
        except (TypeError, ValueError) as problem:
            faults[place] = (f"cannot be read: {problem}", "write it as a number, a date or a text")


def _as_shown(cell: Any, value: Any) -> Any:
    """A date without its midnight, a number with the leading zeros of its format."""
    from openpyxl.styles.numbers import is_datetime

    if isinstance(value, datetime):
        return value.date() if value.time() == time() and is_datetime(cell.number_format) == "date" else value
    if isinstance(value, int) and not isinstance(value, bool) and value >= 0:
        zeros = cell.number_format or ""
        return str(value).zfill(len(zeros)) if _ZEROS.fullmatch(zeros) else value
    return value


_TYPE_AGAIN = "format the column as text, and type the number again as the museum writes it"


def _formula(what: str) -> tuple[str, str]:
    return what, "copy the column and paste it as values; formulas are not computed here"


def _hidden(where: str) -> tuple[str, str]:
    return (
        f"{MERGED} {where}",
        "unmerge them, and fill in every row and column",
    )


class XlsxSettings(HeadedSettings):
    """How a workbook is read."""

    format: Literal["xlsx"] = Field(description="The kind of source.")
    sheet: Name | None = Field(
        default=None, description="The name of the sheet; needed where more than one is visible."
    )
    sheets: tuple[Name, ...] = Field(
        default=(),
        max_length=500,
        description="Sheets with the same columns that are read one below another, in place of sheet; the column "
        '"sheet" has their names.',
    )


class Xlsx(FileSource):
    """A sheet of a workbook of Excel or LibreOffice."""

    name = "xlsx"
    title = "a workbook"
    Settings = XlsxSettings

    def recognises(self, where: str, head: bytes) -> bool:  # noqa: ARG002
        """Say whether it begins as a ZIP archive, which a workbook is, or as an old workbook, which is refused."""
        return head.startswith((b"PK\x03\x04", OLE))

    def rows(self, binary: BufferedReader, file: str, request: Request) -> Iterator[Row]:
        """Yield the header and the rows of the sheet.

        Parameters
        ----------
        binary, file, request : BufferedReader, str, Request
            As of `FileSource.rows`.

        Yields
        ------
        Row
            First the header.
        """
        own: XlsxSettings = request.settings

        def read(sheet: str | None) -> Iterator[Row]:
            at = dict(zip(("header_row", "header_rows"), own.head, strict=True))
            rows = read_sheet(binary, file, sheet=sheet, key=request.key_column, texts=request.texts, **at)
            return own.straight(rows, file)

        return one_below_another(read, own.sheets, file) if own.sheets else read(own.sheet)
