"""The rows of a CSV file, one by one, with every broken row named and the rest kept."""

from __future__ import annotations

import csv
import re
from codecs import BOM_UTF8
from collections import deque
from collections.abc import Iterator
from contextlib import contextmanager
from io import BufferedReader, TextIOBase, TextIOWrapper
from typing import Annotated, ClassVar, Literal, Self

from pydantic import Field, model_validator

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.base import FileSource, Request, SourceSettings
from pipeline.collection.sources.facts import FactRows, spread
from pipeline.collection.sources.heads import joined_heads, numbered_heads
from pipeline.collection.sources.rows import Row
from pipeline.collection.sources.sideways import turned
from pipeline.errors import InputError

# In all but UTF-16 (Excel's "Unicode text") the line ends survive a broken byte, so that it spoils one row only.
Encoding = Literal[
    "utf-8",
    "utf-16",
    "ascii",
    "cp437",
    "cp850",
    "cp1250",
    "cp1251",
    "cp1252",
    "cp1253",
    "cp1254",
    "iso-8859-1",
    "iso-8859-2",
    "iso-8859-15",
    "mac-roman",
    "koi8-r",
    "big5",
    "euc-jp",
    "euc-kr",
    "gb18030",
    "shift-jis",
]
FIELD_LIMIT = 1 << 20
"""Characters of one cell: eight times what the csv module takes unasked, which a text of the museum's may exceed."""

RECORD_LIMIT = 16 << 20
"""Characters of one row; a file without line ends must not fill the memory."""

RESCUE_LIMIT = 64 << 20
"""Characters that may be read again after broken rows, all together: broken quotes in every row must not take hours."""

MOST_STARTS = 500
"""Columns of a printed list."""

_ROWS, _TOGETHER = 256, 1 << 20
"""Rows, and characters, after which those that were read are given on."""

_FINE = ("", "")

_UNDECODED = re.compile("[\udc80-\udcff]")


class _Lines:
    """The lines of a stream, which can be taken back to the second line of the row that was being read.

    line   : how many were read, from the file's first on
    length : characters of the row so far;  plain : whether all are of the encoding and none is NUL
    """

    def __init__(self, stream: TextIOBase, file: str) -> None:
        # The stream lives as long as its lines: else it would close the file.
        self._stream, self._readline = stream, stream.readline
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
        if "\x00" in line or (not line.isascii() and _UNDECODED.search(line)):
            self.plain = False
        return line

    def begin(self) -> None:
        self._record, self.length, self.plain = [], 0, True

    def rewind(self) -> None:
        """Read on from the second line of the row: a quotation mark that is never closed spoils its own line only."""
        again = self._record[1:]
        del self._record[1:]
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


class _Table:
    """A CSV file that is being read."""

    def __init__(self, binary: BufferedReader, file: str, delimiter: str | tuple[int, ...], encoding: str) -> None:
        self._file, self._encoding = file, encoding
        binary.seek(_mark(binary, file, encoding))
        stream = TextIOWrapper(binary, encoding=encoding, errors="surrogateescape", newline="")
        self._lines = _Lines(stream, file)
        self._reader: Iterator[list[str]] = (
            csv.reader(self._lines, delimiter=delimiter, strict=True)
            if isinstance(delimiter, str)
            else (cut_at(delimiter, line) for line in self._lines)
        )

    def some(self) -> list[tuple[int, list[str], tuple[str, str]]]:
        """Return some rows that are not blank: their first line, their cells, why they cannot be used; none at the end.

        The limit of the csv module is the whole process's, and is not left changed while the rows are used.
        """
        out: list[tuple[int, list[str], tuple[str, str]]] = []
        characters = 0
        lines, file = self._lines, self._file
        with _field_limit():
            while characters < _TOGETHER and len(out) < _ROWS:
                lines.begin()
                start = lines.line + 1
                cells: list[str] = []
                try:
                    cells = next(self._reader)
                    fault = _FINE if lines.plain else _cell_fault(cells, self._encoding)
                except StopIteration:
                    break
                except csv.Error as problem:
                    fault = _row_fault(problem, lines.length)
                    lines.rewind()
                except UnicodeDecodeError as problem:
                    raise CollectionError(
                        f"{file}, near line {start}: byte {problem.object[problem.start]:#04x} cannot be read as "
                        f"{self._encoding}: {problem.reason}; name the file's encoding in the mapping, [source] "
                        "encoding"
                    ) from problem
                except OSError as problem:
                    raise _stopped(file, start, problem) from problem
                characters += lines.length
                if cells or fault[0]:
                    out.append((start, cells, fault))
        return out


def cut_at(starts: tuple[int, ...], line: str) -> list[str]:
    """Return the cells of a line that begin at some characters, from 1 on; none of a line of dashes."""
    if not line.strip(" -=_+|\r\n\f"):
        return []
    ends = (*(start - 1 for start in starts[1:]), len(line))
    return [line[start - 1 : end].strip() for start, end in zip(starts, ends, strict=True)]


def read_delimited(
    binary: BufferedReader,
    file: str,
    delimiter: str | tuple[int, ...],
    encoding: str,
    header_row: int = 1,
    header_rows: int = 1,
) -> Iterator[Row]:
    """Yield the header (number 0) of a CSV file and then every row that is not blank, whole or broken.

    A row whose cells are all empty is blank.

    Parameters
    ----------
    binary : BufferedReader
        The file, at its beginning.
    file : str
        Its name in messages.
    delimiter : str or tuple of int
        The one character between two cells, or the characters of a line at which cells begin, from 1 on.
    encoding : str
        How its letters are coded.
    header_row : int
        The line from which on the columns are named; what stands above it is left out. 0: no line names them, they
        are "column 1", "column 2" and so on.
    header_rows : int
        How many rows name them together (`heads.joined_heads`).

    Yields
    ------
    Row
        With a fault where it cannot be used.

    Raises
    ------
    CollectionError
        For a mark at its beginning that its encoding does not go with, a header that cannot be read, a row beyond
        RECORD_LIMIT, a file that fails.
    """
    table = _Table(binary, file, delimiter, encoding)
    number = width = 0
    heads: list[list[str]] = []
    while some := table.some():
        for start, read, found in some:
            cells, fault = read, found
            if start < header_row or not (fault[0] or any(map(str.strip, cells))):
                continue
            if number == 0 and header_row == 0:
                width, number = len(cells), 1
                yield Row(0, start, numbered_heads(width))
            elif number == 0:
                if fault[0]:
                    raise CollectionError(f"{file}, line {start}: the header cannot be read: {fault[0]}; {fault[1]}")
                heads.append(cells)
                if len(heads) < header_rows:
                    continue
                cells = heads[0] if header_rows == 1 else joined_heads(heads)
                width = len(cells)
            elif not isinstance(delimiter, str) and cells in heads:
                continue  # the head of the next printed page
            elif not fault[0] and len(cells) != width:
                fault = (
                    f"{len(cells)} cells, the header has {width}",
                    "see whether a cell with a delimiter lacks its quotation marks, or cells were shifted; where "
                    "titles stand above the names of the columns, name their line: [source] header_row",
                )
            yield Row(number, start, cells, fault)
            number += 1


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


def _row_fault(problem: csv.Error, length: int) -> tuple[str, str]:
    """Return why a row of so many characters is none, and what to do."""
    # The csv module has one class for all its errors; no shorter row can hold such a cell.
    if length > FIELD_LIMIT and "field limit" in str(problem):
        return (
            f"a cell of more than {FIELD_LIMIT:,} characters",
            "shorten it or leave its column out, and see whether a quotation mark before it is never closed",
        )
    return (
        f"not a row of a CSV file: {problem}",
        "close every quotation mark, double those inside a cell, and see whether the file was cut off",
    )


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


class HeadedSettings(SourceSettings):
    """How the names of columns stand in a table."""

    header_row: int | None = Field(
        default=None,
        ge=0,
        le=100,
        description="The row (or line) of the column names, below titles; 1. 0: no row names them, and they "
        'are "column 1", "column 2" and so on.',
    )
    header_rows: int | None = Field(
        default=None, ge=1, le=4, description="How many rows name the columns together, as where cells are merged; 1."
    )
    headings: bool = Field(
        default=False,
        description="Rows that hold one text alone, such as a room's name across a list, head the rows below them: "
        'the column "heading" has it for each of these.',
    )
    first_heading: str = Field(
        default="",
        max_length=200,
        description="The heading of the rows above the first of them, where it stands above the names of the columns.",
    )
    sideways: bool = Field(
        default=False,
        description="Objects stand side by side: each column is one, and the first cell of each row names a field.",
    )
    facts: FactRows | None = Field(
        default=None,
        description="Where each fact of an object has a row: which columns tell the object, the field, the value.",
    )

    @property
    def head(self) -> tuple[int, int]:
        """The row of the names of the columns, and how many rows name them."""
        return (1 if self.header_row is None else self.header_row), self.header_rows or 1

    def straight(self, rows: Iterator[Row], file: str) -> Iterator[Row]:
        """Return the rows of objects, turned where they stand side by side, gathered where each fact has a row.

        Parameters
        ----------
        rows : iterator of Row
            The header first.
        file : str
            The source's name in messages.

        Yields
        ------
        Row
        """
        rows = turned(rows, file) if self.sideways else rows
        return rows if self.facts is None else spread(rows, self.facts, file)


class CsvSettings(HeadedSettings):
    """How a CSV file is read."""

    format: Literal["csv"] = Field(description="The kind of source.")
    encoding: Encoding = Field(description="How its letters are coded; Excel's older exports use cp1252.")
    delimiter: str = Field(
        pattern=r'^[^"\r\n\x00]$', description="The one character between two cells: a comma, a semicolon or a tab."
    )

    @property
    def between(self) -> str:
        """What parts the cells, as `read_delimited` takes it."""
        return self.delimiter


class TsvSettings(HeadedSettings):
    """How a file with tabs between its cells is read."""

    format: Literal["tsv"] = Field(description="The kind of source.")
    encoding: Encoding = Field(description="How its letters are coded; Excel's Unicode text is utf-16.")

    @property
    def between(self) -> str:
        """As of `CsvSettings`."""
        return "\t"


class FixedSettings(HeadedSettings):
    """How a text is read whose cells begin at the same places of each line, as those of printed lists do."""

    format: Literal["fixed"] = Field(description="The kind of source.")
    encoding: Encoding = Field(description="How its letters are coded.")
    starts: tuple[Annotated[int, Field(ge=1, le=FIELD_LIMIT)], ...] = Field(
        min_length=2, max_length=MOST_STARTS, description="At which character of a line each column begins, from 1 on."
    )

    @model_validator(mode="after")
    def _rising(self) -> Self:
        if list(self.starts) != sorted(set(self.starts)):
            raise InputError("[source] starts needs each column's first character, from left to right")
        return self

    @property
    def between(self) -> tuple[int, ...]:
        """As of `CsvSettings`."""
        return self.starts


class Csv(FileSource):
    """Text with one character between two cells, and quotation marks where that is in a cell."""

    name = "csv"
    title = "a CSV file"
    Settings: ClassVar[type[SourceSettings]] = CsvSettings

    def recognises(self, where: str, head: bytes) -> bool:  # noqa: ARG002
        """Plain text may be anything."""
        return False

    def rows(self, binary: BufferedReader, file: str, request: Request) -> Iterator[Row]:
        """Yield the header and the rows.

        Parameters
        ----------
        binary, file, request : BufferedReader, str, Request
            As of `FileSource.rows`.

        Yields
        ------
        Row
            First the header.
        """
        own: CsvSettings | TsvSettings | FixedSettings = request.settings
        row, many = own.head
        return own.straight(read_delimited(binary, file, own.between, own.encoding, row, many), file)


class Fixed(Csv):
    """Text with its cells below each other, parted by blanks alone; lines of dashes and repeated heads are no rows."""

    name = "fixed"
    title = "a text with its cells below each other"
    Settings = FixedSettings


class Tsv(Csv):
    """The same with tabs."""

    name = "tsv"
    title = "a file with tabs between its cells"
    Settings = TsvSettings
