"""The sheets of an OpenDocument spreadsheet (.ods), with cells for `xlsx`: values, and what is seen of them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from datetime import date, datetime, timedelta
from functools import cached_property
from itertools import islice
from typing import Any
from zipfile import ZipFile

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.workbook import COLUMN_LIMIT, RANGE_LIMIT, ROW_NUMBER_LIMIT, SAVE_AGAIN, Survey
from pipeline.collection.sources.xml_records import forget, local_name, safely_parsed

CONTENT = "content.xml"
"""The part with all sheets."""

_OFFICE = "{urn:oasis:names:tc:opendocument:xmlns:office:1.0}"
_TABLE = "{urn:oasis:names:tc:opendocument:xmlns:table:1.0}"
_TEXT = "{urn:oasis:names:tc:opendocument:xmlns:text:1.0}"
_STYLE = "{urn:oasis:names:tc:opendocument:xmlns:style:1.0}"
_CELLS = (f"{_TABLE}table-cell", f"{_TABLE}covered-table-cell")


@dataclass(slots=True)
class OpenCell:
    """A cell as openpyxl has them, and its text as the sheet shows it.

    Attributes
    ----------
    value : object
        None where it is empty.
    data_type : str
        "f" of a formula, else "n".
    number_format : str
        Nothing is known of it.
    seen : str or None
        The text that the sheet shows of a number.
    """

    value: Any = None
    data_type: str = "n"
    number_format: str = "General"
    seen: str | None = None


_EMPTY = OpenCell()


class OpenBook:
    """A spreadsheet.

    Parameters
    ----------
    archive : ZipFile
        That stays open while it is read.
    file : str
        Its name in messages.
    """

    def __init__(self, archive: ZipFile, file: str) -> None:
        kind = archive.read("mimetype")[:200] if "mimetype" in archive.namelist() else b""
        if b"spreadsheet" not in kind:
            raise CollectionError(f"{file}: a document of an office program, but no spreadsheet; {SAVE_AGAIN}")
        manifest = archive.read("META-INF/manifest.xml") if "META-INF/manifest.xml" in archive.namelist() else b""
        if b"encryption-data" in manifest:
            raise CollectionError(
                f"{file}: protected by a password; open it with the password, save it without one and read that"
            )
        self._archive, self._file = archive, file

    @cached_property
    def worksheets(self) -> list[OpenPage]:
        """Its sheets in their order."""
        hidden, out = set[str](), list[OpenPage]()
        with self._archive.open(CONTENT) as part:
            for event, element in safely_parsed(part, (f"{_STYLE}style", f"{_TABLE}table", f"{_TABLE}table-row")):
                _no_doctype(element, self._file)
                if event == "start" and element.tag == f"{_TABLE}table" and _outermost(element):
                    state = "hidden" if element.get(f"{_TABLE}style-name") in hidden else "visible"
                    name = element.get(f"{_TABLE}name", "")
                    out.append(OpenPage(self._archive, self._file, len(out), name, state))
                elif event == "end":
                    if element.tag == f"{_TABLE}table-row":
                        forget(element)
                    elif any(one.get(f"{_TABLE}display") == "false" for one in element):
                        hidden.add(element.get(f"{_STYLE}name"))
        return out


@dataclass
class OpenPage:
    """A sheet.

    Attributes
    ----------
    archive, file : ZipFile, str
        What it is of.
    at : int
        Its place among the sheets, from 0.
    title, sheet_state : str
        Its name, and "visible" or "hidden".
    """

    archive: ZipFile
    file: str
    at: int
    title: str
    sheet_state: str

    def reset_dimensions(self) -> None:
        """Do nothing: no sheet says of its own size."""

    def survey(self) -> Survey:
        """Go once through the sheet: where its last cells are, and which are merged or belong to a formula."""
        found = Survey()
        for line, row in self._rows():
            column = 1
            for element in row:
                many = _repeated(element, "columns")
                if _holds(element):
                    found.last_row, found.last_column = line, max(found.last_column, column + many - 1)
                    if found.last_column > COLUMN_LIMIT:
                        raise self._refused(f"has more than {COLUMN_LIMIT:,} columns that hold anything")
                for ranges, what in ((found.merged, "spanned"), (found.computed, "matrix")):
                    down, across = _spans(element, what)
                    if (down, across) != (1, 1):
                        ranges.append((line, column, line + down - 1, column + across - 1))
                        if len(ranges) > RANGE_LIMIT:
                            raise self._refused(f"has more than {RANGE_LIMIT:,} merged cells or array formulas")
                column += many
        return found

    def iter_rows(
        self, *, min_row: int = 1, max_row: int | None = None, max_col: int = COLUMN_LIMIT
    ) -> Iterator[tuple[OpenCell, ...]]:
        """Yield the cells of the rows from min_row on, blank ones between too."""
        due, blank = min_row, (_EMPTY,) * max_col
        for line, row in self._rows():
            if max_row is not None and line > max_row:
                break
            if line < due:
                continue
            while due < line:
                yield blank
                due += 1
            cells: list[OpenCell] = []
            for element in row:
                many = min(_repeated(element, "columns"), max_col - len(cells))
                cells += [_cell(element) if _holds(element) else _EMPTY] * many
            yield (*cells, *(_EMPTY,) * (max_col - len(cells)))
            due += 1
        while max_row is not None and due <= max_row:
            yield blank
            due += 1

    def _rows(self) -> Iterator[tuple[int, list[Any]]]:
        """Yield the number of each row that holds anything or has merged cells, and its cells."""
        line, at = 0, -1
        with self.archive.open(CONTENT) as part:
            for event, element in safely_parsed(part, (f"{_TABLE}table", f"{_TABLE}table-row")):
                _no_doctype(element, self.file)
                is_row = element.tag == f"{_TABLE}table-row"
                if not is_row and event == "start":
                    at += _outermost(element)
                if event == "start" or not is_row:
                    continue
                if at > self.at:
                    return
                if at == self.at:
                    many = _repeated(element, "rows")
                    cells = [one for one in element if one.tag in _CELLS]
                    told = any(_holds(one) or _spans(one, "spanned") != (1, 1) for one in cells)
                    if line + many > ROW_NUMBER_LIMIT and told:
                        raise self._refused(f"has more than {ROW_NUMBER_LIMIT:,} rows")
                    for place in islice(range(line + 1, line + many + 1), many if told else 0):
                        yield place, cells
                    line += many
                forget(element)

    def _refused(self, what: str) -> CollectionError:
        return CollectionError(f"{self.file}: the sheet {self.title!r} {what}; {SAVE_AGAIN}")


def _outermost(table: Any) -> bool:
    return not any(one.tag in _CELLS for one in table.iterancestors())


def _no_doctype(element: Any, file: str) -> None:
    if element.getroottree().docinfo.doctype:
        raise CollectionError(f"{file}: holds a document type declaration, which no workbook needs; {SAVE_AGAIN}")


def _count(element: Any, attribute: str) -> int:
    said = element.get(f"{_TABLE}number-{attribute}", "1")
    return max(1, int(said)) if said.isdecimal() and len(said) < 8 else 1


def _repeated(element: Any, what: str) -> int:
    return _count(element, f"{what}-repeated")


def _spans(element: Any, what: str) -> tuple[int, int]:
    """Return over how many rows and columns a cell goes: "spanned" where it is merged, "matrix" its formula."""
    infix = "" if what == "spanned" else "matrix-"
    return _count(element, f"{infix}rows-spanned"), _count(element, f"{infix}columns-spanned")


def _holds(element: Any) -> bool:
    if element.tag != _CELLS[0]:
        return False
    return element.get(f"{_TABLE}formula") is not None or _value(element) is not None


def _cell(element: Any) -> OpenCell:
    value = _value(element)
    if element.get(f"{_TABLE}formula") is not None:
        return OpenCell(value, "f")
    seen = _shown(element) if isinstance(value, int | float) and not isinstance(value, bool) else None
    return OpenCell(value, seen=seen or None)


def _value(element: Any) -> Any:
    try:
        return _typed(element)
    except ValueError:
        # What its attributes say is no date or number: what is seen is a text.
        return _shown(element) or None


def _typed(element: Any) -> Any:
    kind = element.get(f"{_OFFICE}value-type", "")
    if kind in ("float", "percentage", "currency"):
        number = float(element.get(f"{_OFFICE}value", "nan"))
        return int(number) if number.is_integer() and abs(number) < 1e15 else number
    if kind == "boolean":
        return element.get(f"{_OFFICE}boolean-value") == "true"
    if kind == "date":
        said = element.get(f"{_OFFICE}date-value", "")
        return datetime.fromisoformat(said) if "T" in said else date.fromisoformat(said)
    if kind == "time":
        return timedelta()  # what is no moment: xlsx says so
    text = element.get(f"{_OFFICE}string-value") or _shown(element)
    return text or None


def _shown(element: Any) -> str:
    """Return the text of a cell, without notes on it."""
    return "\n".join("".join(_pieces(one)) for one in element if one.tag == f"{_TEXT}p")


def _pieces(element: Any) -> Iterator[str]:
    yield element.text or ""
    for one in element:
        name = local_name(one)
        if name == "s":
            count = one.get(f"{_TEXT}c", "1")
            yield " " * (min(int(count), 100) if count.isdecimal() else 1)
        elif name in ("tab", "line-break"):
            yield "\t" if name == "tab" else "\n"
        elif name not in ("annotation", "note"):
            yield from _pieces(one)
        yield one.tail or ""
