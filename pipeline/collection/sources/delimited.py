"""The rows of a CSV file, one by one, with every broken row named and the rest kept."""

from __future__ import annotations

import csv
import re
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from io import TextIOBase

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.rows import Row

FIELD_LIMIT = 1 << 20
"""Characters of one cell."""

RECORD_LIMIT = 16 << 20
"""Characters of one row; a file without line ends must not fill the memory."""

RESCUE_LIMIT = 64 << 20
"""Characters that may be read again after broken rows, all together: broken quotes in every row must not take hours."""

_ROWS, _TOGETHER = 256, 1 << 20
"""Rows, and characters, after which those that were read are given on."""

_FINE = ("", "")

_UNDECODED = re.compile("[\udc80-\udcff]")


class _Lines:
    """The lines of a stream, which can be taken back to the second line of the row that was being read.

    length : characters of the row so far;  plain : whether all are ASCII and none is NUL
    """

    def __init__(self, stream: TextIOBase, file: str) -> None:
        self._readline = stream.readline
        self._file = file
        self._ahead: deque[str] = deque()
        self._record: list[str] = []
        self.length = 0
        self._rescued = 0
        self.line = 0
        self.plain = True

    def __iter__(self) -> _Lines:
        return self

    def __next__(self) -> str:
        line = self._ahead.popleft() if self._ahead else self._readline(RECORD_LIMIT + 1)
        if not line:
            raise StopIteration
        self.line += 1
        self._record.append(line)
        self.length += len(line)
        if self.length > RECORD_LIMIT:
            raise CollectionError(
                f"{self._file}, line {self.line}: a row of more than {RECORD_LIMIT:,} characters; this is not a table "
                "with one object a row, or a quotation mark is never closed: export it again"
            )
        if not line.isascii() or "\x00" in line:
            self.plain = False
        return line

    def begin(self) -> None:
        self._record, self.length, self.plain = [], 0, True

    def rewind(self) -> None:
        """Read on from the second line of the row: a quotation mark that is never closed spoils its own line only."""
        again = self._record[1:]
        self._rescued += sum(map(len, again))
        if self._rescued > RESCUE_LIMIT:
            raise CollectionError(
                f"{self._file}, line {self.line}: too many rows with broken quotation marks; export the file again"
            )
        self._ahead.extendleft(reversed(again))
        self.line -= len(again)


@contextmanager
def _field_limit() -> Iterator[None]:
    # The csv module keeps this limit for the whole process.
    before = csv.field_size_limit(FIELD_LIMIT)
    try:
        yield
    finally:
        csv.field_size_limit(before)


def read_rows(stream: TextIOBase, file: str, delimiter: str, encoding: str) -> Iterator[Row]:
    """Yield the header (number 0) and then every row that is not blank, whole or broken.

    stream : opened with newline="" and errors="surrogateescape", so that a byte that is none of the encoding's is seen
    raises : CollectionError for a header that cannot be read, a row beyond RECORD_LIMIT, a stream that fails
    """
    lines = _Lines(stream, file)
    reader = csv.reader(lines, delimiter=delimiter, strict=True)
    number, width = 0, 0
    while True:
        # The limit of the csv module is the whole process's, and is not left changed while the rows are used.
        with _field_limit():
            records = list(_records(lines, reader, file, encoding))
        if not records:
            return
        for start, cells, found in records:
            fault = found
            if number == 0:
                if fault[0]:
                    raise CollectionError(f"{file}, line {start}: the header cannot be read: {fault[0]}; {fault[1]}")
                width = len(cells)
            elif not fault[0] and len(cells) != width:
                fault = (
                    f"{len(cells)} cells, the header has {width}",
                    "see whether a cell with a delimiter lacks its quotation marks, or cells were shifted",
                )
            yield Row(number, start, cells, fault)
            number += 1


def _records(
    lines: _Lines, reader: Iterator[list[str]], file: str, encoding: str
) -> Iterator[tuple[int, list[str], tuple[str, str]]]:
    """Yield some rows that are not blank: their first line, their cells, and why they cannot be used."""
    characters = count = 0
    while not count or (characters < _TOGETHER and count < _ROWS):
        lines.begin()
        start = lines.line + 1
        cells: list[str] = []
        try:
            cells = next(reader)
            fault = _FINE if lines.plain else _cell_fault(cells, encoding)
        except StopIteration:
            return
        except csv.Error as problem:
            lines.rewind()
            fault = (
                f"not a row of a CSV file: {problem}",
                "close every quotation mark, double those inside a cell, and see whether the file was cut off",
            )
        except UnicodeDecodeError as problem:
            raise CollectionError(
                f"{file}, near line {start}: byte {problem.object[problem.start]:#04x} cannot be read as {encoding}: "
                f"{problem.reason}; name the file's encoding in the mapping, [source] encoding"
            ) from problem
        except OSError as problem:
            raise CollectionError(
                f"{file}, near line {start}: reading stopped: {problem.strerror or problem}; see whether the disk or "
                "the network share is there and import again"
            ) from problem
        characters += lines.length
        if cells or fault[0]:
            count += 1
            yield start, cells, fault


def _cell_fault(cells: list[str], encoding: str) -> tuple[str, str]:
    for column, cell in enumerate(cells, start=1):
        broken = _UNDECODED.search(cell)
        if broken:
            byte = ord(broken.group()) - 0xDC00
            return (
                f"byte {byte:#04x} at character {broken.start() + 1} of cell {column} cannot be read as {encoding}",
                "name the file's encoding in the mapping, [source] encoding, or mend the cell",
            )
        if "\x00" in cell:
            return f"a NUL byte in cell {column}", "the file is damaged or binary: export it again"
    return "", ""
