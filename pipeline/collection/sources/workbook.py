"""The outside of an .xlsx workbook: is it one, is it safe to open, and what in its XML would a reader lose?"""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from typing import IO, BinaryIO
from xml.parsers import expat
from zipfile import ZIP_DEFLATED, ZIP_STORED, ZipFile, ZipInfo

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.delimited import RECORD_LIMIT

ENTRIES_LIMIT = 10_000
"""Files inside a workbook."""

ENTRY_LIMIT = 1 << 30
"""Bytes of one of them, unpacked (1 GiB)."""

TOTAL_LIMIT = 4 << 30
"""Bytes of all of them, unpacked."""

WHOLE_LIMIT = 32 << 20
"""Bytes of a part that is read into memory as a tree: the list of sheets, the styles, the relations."""

STRINGS_LIMIT = 256 << 20
"""Bytes of the texts of all cells, which are kept in memory."""

RATIO_LIMIT = 200
"""Bytes unpacked for one byte packed, of a part of more than RATIO_FROM bytes; a sheet of zeros reaches about 100."""

RATIO_FROM = 16 << 20

COLUMN_LIMIT = 1_000
"""Columns that hold anything."""

ROW_NUMBER_LIMIT = 1_048_576
"""Rows of a sheet, in the file format itself."""

RANGE_LIMIT = 100_000
"""Merged cells and array formulas of a sheet, together."""

SAVE_AGAIN = "open it in a spreadsheet program and save it as an .xlsx workbook"
"""What mends most workbooks."""

OLE = b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1"
"""How files of the old Office begin, and workbooks that are protected by a password."""

_MAIN = "http://schemas.openxmlformats.org/spreadsheetml/2006/main"
_WHOLE = re.compile(r"\[Content_Types\]\.xml|.*\.rels|xl/workbook\.xml|xl/styles\.xml|xl/theme/.*|docProps/.*", re.I)
_REFERENCE = re.compile(r"([A-Z]{1,3})([1-9][0-9]{0,6})")

Range = tuple[int, int, int, int]
"""First row, first column, last row, last column, all counted from 1."""


def check_kind(stream: BinaryIO, file: str) -> None:
    """Refuse what is not a zip archive, and say what it is.

    Parameters
    ----------
    stream : binary stream
        At the file's beginning.
    file : str
        Its name in messages.

    Raises
    ------
    CollectionError
        Naming the file, what it is, and how to make a workbook of it.
    """
    start = stream.read(8)
    if start == OLE:
        # Both kinds are compound files; the protected one has a stream of this name.
        while block := stream.read(1 << 20):
            if "EncryptedPackage".encode("utf-16-le") in start + block:
                raise CollectionError(
                    f"{file}: protected by a password; open it with the password, save it without one and read that"
                )
            start = block[-64:]
        raise CollectionError(f"{file}: an old .xls workbook (or another old Office file); {SAVE_AGAIN}")
    if start[:4] in (b"\x09\x08\x10\x00", b"\x09\x04\x06\x00", b"\x09\x02\x06\x00", b"\x09\x00\x04\x00"):
        raise CollectionError(f"{file}: an old .xls workbook; {SAVE_AGAIN}")
    if start[:2] != b"PK":
        raise CollectionError(f"{file}: not an .xlsx workbook, whatever its name says; {SAVE_AGAIN}")
    stream.seek(0)


def check_archive(archive: ZipFile, file: str) -> None:
    """Refuse an archive that is no workbook, is encrypted, or would unpack to more than the limits.

    What an entry claims is held by zipfile while it is read: no byte beyond the claimed size is given out, and a claim
    that is too small fails the checksum.

    Parameters
    ----------
    archive : ZipFile
        The file.
    file : str
        Its name in messages.

    Raises
    ------
    CollectionError
        Naming the file, what is wrong and the remedy.
    """
    entries = archive.infolist()
    names = {entry.filename for entry in entries}
    if "xl/workbook.bin" in names:
        raise CollectionError(f"{file}: a workbook, but not an .xlsx one; {SAVE_AGAIN}")
    if "[Content_Types].xml" not in names and not is_open_document(archive):
        raise CollectionError(
            f"{file}: a zip archive, but no workbook; {SAVE_AGAIN}; where CSV files are in it, unpack it and name "
            "the folder"
        )
    if len(entries) > ENTRIES_LIMIT:
        raise CollectionError(f"{file}: {len(entries):,} parts inside, more than {ENTRIES_LIMIT:,}; {SAVE_AGAIN}")
    for entry in entries:
        _check_entry(entry, file)
    total = sum(entry.file_size for entry in entries)
    if total > TOTAL_LIMIT:
        raise CollectionError(
            f"{file}: {total:,} bytes unpacked, more than {TOTAL_LIMIT:,}; export fewer columns or objects"
        )


def is_open_document(archive: ZipFile) -> bool:
    """Whether an archive is a spreadsheet of LibreOffice (.ods), and none of Excel."""
    names = archive.namelist()
    return "content.xml" in names and "[Content_Types].xml" not in names


def _check_entry(entry: ZipInfo, file: str) -> None:
    name = entry.filename[:100]
    if entry.flag_bits & 0x1:
        raise CollectionError(f"{file}: {name!r} in it is encrypted; save the workbook without a password")
    if entry.compress_type not in (ZIP_STORED, ZIP_DEFLATED):
        raise CollectionError(f"{file}: {name!r} in it is packed in a way that no workbook is; {SAVE_AGAIN}")
    limit = ENTRY_LIMIT
    if _WHOLE.fullmatch(entry.filename):
        limit = WHOLE_LIMIT
    elif "sharedstrings" in entry.filename.casefold():
        limit = STRINGS_LIMIT
    if entry.file_size > limit:
        raise CollectionError(
            f"{file}: {name!r} in it has {entry.file_size:,} bytes unpacked, more than {limit:,}; "
            "export fewer columns or objects"
        )
    if entry.file_size > RATIO_FROM and entry.file_size > RATIO_LIMIT * entry.compress_size:
        raise CollectionError(
            f"{file}: {name!r} in it would unpack to more than {RATIO_LIMIT} times its size, as no sheet of objects "
            "does; delete rows and columns that are empty but formatted, and save it again"
        )


@dataclass(slots=True)
class Survey:
    """What was found in a sheet's XML.

    Attributes
    ----------
    last_row, last_column : int
        Of the last cells that hold anything; 0 where none does.
    merged : list of Range
        Merged cells, each with the cell that shows the value first.
    computed : list of Range
        Cells that an array formula or a data table fills.
    """

    last_row: int = 0
    last_column: int = 0
    merged: list[Range] = field(default_factory=list)
    computed: list[Range] = field(default_factory=list)


class _Refused(Exception):  # noqa: N818  (never leaves this module)
    pass


class _Surveyor:
    """Handlers of the elements of one sheet."""

    def __init__(self, parser: expat.XMLParserType) -> None:
        self.found = Survey()
        self._parser = parser
        self._row = self._column = self._begun = 0
        self._root = True
        parser.StartElementHandler = self._start
        parser.EndElementHandler = self._end
        parser.StartDoctypeDeclHandler = self._doctype

    def _doctype(self, *_: object) -> None:
        raise _Refused("holds a document type declaration, which no workbook needs")

    def _start(self, name: str, attributes: dict[str, str]) -> None:
        space, _, tag = name.rpartition("}")
        if self._root:
            self._root = False
            if space != _MAIN or tag != "worksheet":
                raise _Refused("is not written as a worksheet (a strict workbook perhaps)")
        self._measure()
        if space != _MAIN:
            return
        if tag == "row":
            self._begun = self._parser.CurrentByteIndex
            self._row = self._number(attributes["r"]) if "r" in attributes else self._row + 1
            self._column = 0
        elif tag == "c":
            self._cell(attributes.get("r"))
        elif tag in ("v", "is", "f"):
            self.found.last_row = max(self.found.last_row, self._row)
            self.found.last_column = max(self.found.last_column, self._column)
            if self._column > COLUMN_LIMIT:
                raise _Refused(f"has more than {COLUMN_LIMIT:,} columns that hold anything")
            if tag == "f" and attributes.get("t") in ("array", "dataTable") and "ref" in attributes:
                self._keep(self.found.computed, attributes["ref"])
        elif tag == "mergeCell":
            self._keep(self.found.merged, attributes.get("ref", ""))

    def _end(self, name: str) -> None:
        self._measure()
        if name.endswith("}row"):
            self._begun = self._parser.CurrentByteIndex

    def _measure(self) -> None:
        if self._parser.CurrentByteIndex - self._begun > RECORD_LIMIT:
            raise _Refused(f"has more than {RECORD_LIMIT:,} bytes after row {self._row} without another row")

    def _number(self, text: str) -> int:
        # Rows out of order would be lost without a word later on.
        number = int(text) if text.isdecimal() and text.isascii() and len(text) < 8 else 0
        if not self._row < number <= ROW_NUMBER_LIMIT:
            raise _Refused(f"has a row numbered {text[:20]!r} after row {self._row}")
        return number

    def _cell(self, reference: str | None) -> None:
        column = self._column + 1
        if reference is not None:
            place = _place(reference)
            if place is None or place[0] != self._row or place[1] < column:
                raise _Refused(f"has a cell {reference[:20]!r} out of its place in row {self._row}")
            column = place[1]
        if column > 16_384:
            raise _Refused(f"has more cells in row {self._row} than a sheet has columns")
        self._column = column

    def _keep(self, ranges: list[Range], reference: str) -> None:
        first, _, last = reference.partition(":")
        begin, end = _place(first), _place(last or first)
        if begin is None or end is None:
            raise _Refused(f"names cells {reference[:40]!r} that cannot be")
        if len(ranges) >= RANGE_LIMIT:
            raise _Refused(f"has more than {RANGE_LIMIT:,} merged cells or array formulas")
        ranges.append((*begin, *end))


def survey(stream: IO[bytes], file: str, sheet: str) -> Survey:
    """Go once through a sheet's XML, without keeping it, before anything is read from it.

    Parameters
    ----------
    stream : binary stream
        The sheet's XML.
    file, sheet : str
        Their names in messages.

    Returns
    -------
    Survey
        What was found.

    Raises
    ------
    CollectionError
        For a sheet that is not well-formed, declares entities, has rows or cells out of order, or is beyond the limits.
    """
    # Expat itself stops entities that grow; a document type is refused before any is used.
    parser = expat.ParserCreate(namespace_separator="}")
    surveyor = _Surveyor(parser)
    try:
        parser.ParseFile(stream)
    except _Refused as problem:
        raise CollectionError(f"{file}: the sheet {sheet!r} {problem}; {SAVE_AGAIN}") from None
    except expat.ExpatError as problem:
        raise CollectionError(f"{file}: the sheet {sheet!r} is damaged: {problem}; {SAVE_AGAIN}") from problem
    return surveyor.found


def _place(reference: str) -> tuple[int, int] | None:
    """Row and column of a cell such as "AB12"."""
    match = _REFERENCE.fullmatch(reference)
    if match is None:
        return None
    column = 0
    for letter in match[1]:
        column = 26 * column + ord(letter) - ord("A") + 1
    return int(match[2]), column
