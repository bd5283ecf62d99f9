"""The rows of a CSV file, one by one, with every broken row named and the rest kept."""

from __future__ import annotations

import csv
import re
from codecs import BOM_UTF8
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from io import BufferedReader, TextIOBase, TextIOWrapper

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

    line   : how many were read, from the file's first on
    length : characters of the row so far;  plain : whether all are ASCII and none is NUL
    """

    def __init__(self, stream: TextIOBase, file: str, line: int, rescued: int) -> None:
        self._readline = stream.readline
        self._file = file
        self._ahead: deque[str] = deque()
        self._record: list[str] = []
        self.length = 0
        self.rescued = rescued
        self.line = line
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

    def end(self) -> str:
        """Return the text of the row."""
        return self._record[0] if len(self._record) == 1 else "".join(self._record)

    def rewind(self) -> None:
        """Read on from the second line of the row: a quotation mark that is never closed spoils its own line only."""
        again = self._record[1:]
        del self._record[1:]
        self.rescued += sum(map(len, again))
        if self.rescued > RESCUE_LIMIT:
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


class DelimitedRows:
    """The header (number 0) of a CSV file and then every row that is not blank, whole or broken.

    Rows whose bytes are known can be passed over, see `sources.rows.Spans`.
    """

    def __init__(self, binary: BufferedReader, file: str, delimiter: str, encoding: str) -> None:
        """Begin at the first row.

        binary : the file
        raises : CollectionError for a mark at its beginning that its encoding does not go with
        """
        self._binary, self._file, self._delimiter, self._encoding = binary, file, delimiter, encoding
        # Where the row begins that is given next, in bytes; the rows and lines before it.
        self._at = _mark(binary, file, encoding)
        self.number, self.line = 0, 0
        self._width = 0
        self._rescued = 0
        self._stream: TextIOWrapper | None = None
        self._lines: _Lines | None = None
        self._reader: Iterator[list[str]] = iter(())
        # What was read and not yet given: rows, the text that each is read from, the lines up to its end.
        self._ahead: deque[tuple[Row, str, int]] = deque()
        self._texts: list[str] = []

    def __iter__(self) -> DelimitedRows:
        return self

    def __next__(self) -> Row:
        """Return the next row.

        raises : CollectionError for a header that cannot be read, a row beyond RECORD_LIMIT, a file that fails
        """
        if not self._ahead:
            self._read_on()
            if not self._ahead:
                raise StopIteration
        row, text, self.line = self._ahead.popleft()
        self.number = row.number + 1
        self._texts.append(text)
        return row

    def taken(self) -> bytes:
        """Return the bytes of the rows since the last call; none where bytes do not tell where rows begin."""
        texts, self._texts = "".join(self._texts), []
        if self._encoding == "utf-16":
            return b""
        # A byte that is none of the encoding's comes back as it was.
        content = texts.encode(self._encoding, "surrogateescape")
        self._at += len(content)
        return content

    def peek(self, size: int) -> bytes:
        """Return some bytes from where `taken` or `pass_over` left off on; fewer at the end of the file."""
        try:
            was = self._binary.tell()
            self._binary.seek(self._at)
            content = self._binary.read(size)
            if self._stream is not None:
                # It reads on from where it was.
                self._binary.seek(was)
        except OSError as problem:
            raise _stopped(self._file, self.line + 1, problem) from problem
        return content

    def pass_over(self, size: int, rows: int, lines: int) -> None:
        """Go on behind some bytes from where `taken` left off on."""
        self._at += size
        self.number += rows
        self.line += lines
        self._ahead.clear()
        if self._stream is not None and self._lines is not None:
            self._rescued = self._lines.rescued
            # Else the file would be closed with the stream.
            self._stream.detach()
            self._stream = self._lines = None

    def _begin(self) -> _Lines:
        self._binary.seek(self._at)
        self._stream = TextIOWrapper(self._binary, encoding=self._encoding, errors="surrogateescape", newline="")
        lines = _Lines(self._stream, self._file, self.line, self._rescued)
        self._reader = csv.reader(lines, delimiter=self._delimiter, strict=True)
        return lines

    def _read_on(self) -> None:
        """Read some rows ahead."""
        if self._lines is None:
            self._lines = self._begin()
        number = self.number
        # The limit of the csv module is the whole process's, and is not left changed while the rows are used.
        with _field_limit():
            for start, cells, found, text in self._records(self._lines):
                fault = found
                if number == 0:
                    if fault[0]:
                        raise CollectionError(
                            f"{self._file}, line {start}: the header cannot be read: {fault[0]}; {fault[1]}"
                        )
                    self._width = len(cells)
                elif not fault[0] and len(cells) != self._width:
                    fault = (
                        f"{len(cells)} cells, the header has {self._width}",
                        "see whether a cell with a delimiter lacks its quotation marks, or cells were shifted",
                    )
                self._ahead.append((Row(number, start, cells, fault), text, self._lines.line))
                number += 1

    def _records(self, lines: _Lines) -> Iterator[tuple[int, list[str], tuple[str, str], str]]:
        """Yield some rows that are not blank: their first line, their cells, why they cannot be used, and their text.

        The text of blank lines is that of the row that follows.
        """
        characters = count = 0
        blank: list[str] = []
        while not count or (characters < _TOGETHER and count < _ROWS):
            lines.begin()
            start = lines.line + 1
            cells: list[str] = []
            try:
                cells = next(self._reader)
                fault = _FINE if lines.plain else _cell_fault(cells, self._encoding)
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
                    f"{self._file}, near line {start}: byte {problem.object[problem.start]:#04x} cannot be read as "
                    f"{self._encoding}: {problem.reason}; name the file's encoding in the mapping, [source] encoding"
                ) from problem
            except OSError as problem:
                raise _stopped(self._file, start, problem) from problem
            characters += lines.length
            if cells or fault[0]:
                count += 1
                yield start, cells, fault, "".join((*blank, lines.end()))
                blank.clear()
            else:
                blank.append(lines.end())


def _stopped(file: str, line: int, problem: OSError) -> CollectionError:
    return CollectionError(
        f"{file}, near line {line}: reading stopped: {problem.strerror or problem}; see whether the disk or "
        "the network share is there and import again"
    )


def _mark(binary: BufferedReader, file: str, encoding: str) -> int:
    """Return how many bytes the mark of UTF-8 takes at the beginning of a file, if it is there."""
    try:
        marked = binary.read(len(BOM_UTF8)) == BOM_UTF8
    except OSError as problem:
        raise _stopped(file, 1, problem) from problem
    if marked and encoding != "utf-8":
        raise CollectionError(
            f'{file}: begins with the mark of UTF-8, and the mapping says {encoding}; say encoding = "utf-8" there'
        )
    return len(BOM_UTF8) if marked else 0


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
