"""A museum's file -> items: every row becomes an item, or is rejected with its number, its reason and the remedy."""

from __future__ import annotations

import hashlib
import stat
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from io import BufferedReader, TextIOWrapper
from pathlib import Path
from typing import Any

from pipeline.collection.cells import Cells
from pipeline.collection.errors import CollectionError
from pipeline.collection.mapping import DIAMETER, ColumnMap, Mapping, check_header
from pipeline.collection.record import KINDS, NUMBER_LIMIT, TEXT_LIMIT
from pipeline.collection.sources.delimited import RECORD_LIMIT, read_rows
from pipeline.collection.sources.rows import Row
from pipeline.records import Item, Problem

FILE_LIMIT = 1 << 30
"""Bytes of a file (1 GiB)."""

ROW_LIMIT = 5_000_000
"""Data rows of a file."""

NOWHERE = "Location not recorded"
"""The gallery of an object whose location is empty."""

_UTF8_MARK = b"\xef\xbb\xbf"


@dataclass(frozen=True, slots=True)
class Rejected:
    """A row that was kept out: row 1 is the first below the header, line 1 the first of the file."""

    file: str
    row: int
    line: int
    field: str
    message: str
    remedy: str


@dataclass(frozen=True, slots=True)
class Reading:
    """What a file held: ``rows`` is always the number of items and of rejected rows together.

    source  : the file's name, without its folder
    sha256  : of the file's bytes
    mapping : name of the mapping; museum and credit as the mapping gives them
    """

    items: tuple[Item, ...]
    rows: int
    rejected: tuple[Rejected, ...]
    source: str
    sha256: str
    mapping: str
    museum: str
    credit: str = ""


def read_items(path: str | Path, mapping: Mapping) -> Reading:
    """Read a museum's file, row by row.

    A value that cannot be accepted is None in its item, which keeps the reason as a problem; only rows that are broken,
    have no object number or repeat one are rejected.

    raises : CollectionError for a file that is missing, unreadable, too large, empty or not in its encoding;
             MappingError where the mapping's columns are not the file's
    """
    where = Path(path)
    with _open(where) as binary:
        digest = _identify(binary, where.name, mapping.source.encoding)
        # "utf-8-sig" also reads files without the mark.
        encoding = "utf-8-sig" if mapping.source.encoding == "utf-8" else mapping.source.encoding
        stream = TextIOWrapper(binary, encoding=encoding, errors="surrogateescape", newline="")
        rows = read_rows(stream, where.name, mapping.source.delimiter, mapping.source.encoding)
        header = next(rows, None)
        if header is None:
            raise CollectionError(f"{where.name}: empty collection: the file holds no header; export it again")
        desk = _Desk(where.name, mapping, header)
        for row in rows:
            desk.take(row)
    if not desk.rows:
        raise CollectionError(f"{where.name}: empty collection: a header and no data rows; export it again")
    return Reading(
        items=tuple(desk.items),
        rows=desk.rows,
        rejected=tuple(desk.rejected),
        source=where.name,
        sha256=digest,
        mapping=mapping.name,
        museum=mapping.museum.name,
        credit=mapping.museum.credit,
    )


class _Desk:
    """Where the rows of one file are looked at, one after the other."""

    def __init__(self, file: str, mapping: Mapping, header: Row) -> None:
        names = [cell.strip() for cell in header.cells]
        check_header(mapping, file, names)
        self._file = file
        self._decimal = mapping.source.decimal
        self._columns: list[tuple[str, ColumnMap, list[int]]] = []
        for field, column in mapping.columns.items():
            places = [names.index(source) for source in column.sources if source in names]
            if places:
                self._columns.append((field, column, places))
        self._stores = {name.strip().casefold() for name in mapping.display.not_on_display}
        self._seen: dict[str, int] = {}
        self.items: list[Item] = []
        self.rejected: list[Rejected] = []
        self.rows = 0

    def take(self, row: Row) -> None:
        self.rows += 1
        if self.rows > ROW_LIMIT:
            raise CollectionError(f"{self._file}: more than {ROW_LIMIT:,} rows; export only the objects on display")
        message, remedy = row.fault
        if message:
            self._reject(row, "", message, remedy)
            return
        place = f"{self._file}, row {row.number} (line {row.line})"
        cells = Cells(place, self._decimal)
        values = {
            field: _READ[KINDS.get(field, "number")](cells, field, column, [row.cells[i] for i in places])
            for field, column, places in self._columns
        }
        number = values["object_number"]
        if not number:
            self._reject(row, "object_number", "the object has no number", "give it one in the museum's database")
        elif len(number) > NUMBER_LIMIT:
            message = f"an object number of {len(number)} characters, more than {NUMBER_LIMIT}"
            self._reject(row, "object_number", message, "see whether the cells of this row were shifted")
        elif number in self._seen:
            message = f"object number {number!r} was given in row {self._seen[number]} already; only that row is kept"
            self._reject(row, "object_number", message, "give each object its own number, and export one row an object")
        else:
            self._seen[number] = row.number
            self.items.append(self._item(values, cells))

    def _item(self, values: dict[str, Any], cells: Cells) -> Item:
        diameter = values.pop(DIAMETER, None)
        for field in ("width_m", "depth_m"):
            if values.get(field) is None:
                values[field] = diameter
        said = values.pop("on_display", None)
        gallery = values["gallery"]
        on_display = gallery.casefold() not in self._stores and said is not False
        if not gallery:
            gallery, on_display = NOWHERE, False
            remedy = "record its current location; until then it counts as not on display"
            cells.problems.append(Problem("gallery", f"{cells.place}: the location is empty", remedy))
        values.update(gallery=gallery, on_display=on_display, problems=tuple(cells.problems))
        return Item(**values)

    def _reject(self, row: Row, field: str, message: str, remedy: str) -> None:
        where = f"{self._file}, row {row.number} (line {row.line}): {message}"
        self.rejected.append(Rejected(self._file, row.number, row.line, field, where, remedy))


def _text(cells: Cells, field: str, column: ColumnMap, texts: Sequence[str]) -> str:
    # An object number is never cut: two that begin alike would become one.
    return cells.text(field, column, texts, limit=RECORD_LIMIT if field == "object_number" else TEXT_LIMIT)


_READ: dict[str, Callable[[Cells, str, ColumnMap, Sequence[str]], Any]] = {
    "text": _text,
    "number": Cells.number,
    "integer": Cells.integer,
    "choice": Cells.choice,
    "flag": Cells.flag,
}


def _open(path: Path) -> BufferedReader:
    try:
        state = path.stat()
        if not stat.S_ISREG(state.st_mode):
            raise CollectionError(f"{path}: not a file; name the museum's export itself")
        if state.st_size > FILE_LIMIT:
            raise CollectionError(
                f"{path}: {state.st_size:,} bytes, more than {FILE_LIMIT:,}; export fewer columns or objects"
            )
        return path.open("rb")
    except OSError as problem:
        raise CollectionError(
            f"{path}: cannot be read: {problem.strerror or problem}; see whether the path is right, the share is "
            "mounted and Kouros may read it"
        ) from problem


def _identify(binary: BufferedReader, file: str, encoding: str) -> str:
    try:
        mark = binary.read(len(_UTF8_MARK))
        binary.seek(0)
        digest = hashlib.file_digest(binary, "sha256").hexdigest()
        binary.seek(0)
    except OSError as problem:
        raise CollectionError(
            f"{file}: reading stopped: {problem.strerror or problem}; see whether the disk or network share is there"
        ) from problem
    if mark == _UTF8_MARK and encoding != "utf-8":
        raise CollectionError(
            f'{file}: begins with the mark of UTF-8, and the mapping says {encoding}; say encoding = "utf-8" there'
        )
    return digest
