"""A text of records one below another, each line a field with its label, as catalogues of cards are exported.

`N° INV : D.962.4.1` and below it `APPELLATION : Pot`: a record ends where a line is blank, or where the first of its
labels comes again. A line without a label goes on with the text above it; a label that comes twice has both texts.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from io import BufferedReader, TextIOWrapper
from typing import ClassVar, Literal

from pydantic import Field

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.base import FileSource, Request, SourceSettings
from pipeline.collection.sources.delimited import RECORD_LIMIT, Encoding
from pipeline.collection.sources.rows import Row

MOST_LABELS = 2000
"""Different labels of one museum's records."""

LABELLED = re.compile(r"\s{0,8}([^\W\d_][^:=\t\n]{0,59}?)\s*[:=\t]\s*(.*)", re.DOTALL)
"""A line with a label and its text."""

_UNDECODED = re.compile("[\udc80-\udcff\x00]")


class CardSettings(SourceSettings):
    """How a text of labelled lines is read."""

    format: Literal["cards"] = Field(description="The kind of source.")
    encoding: Encoding = Field(description="How its letters are coded.")
    first: str = Field(min_length=1, description="The label with which each record begins.")


class Cards(FileSource):
    """A text of labelled lines."""

    name = "cards"
    title = "a text of labelled lines"
    Settings: ClassVar[type[SourceSettings]] = CardSettings

    def recognises(self, where: str, head: bytes) -> bool:  # noqa: ARG002
        """Plain text may be anything."""
        return False

    def rows(self, binary: BufferedReader, file: str, request: Request) -> Iterator[Row]:
        """Yield the header and the records: once for their labels, and once for the rows.

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
            For a text without a record, or with more labels than records have.
        """
        own: CardSettings = request.settings
        names: dict[str, None] = {}
        for line, record in records(binary, file, own.encoding, own.first):
            names |= dict.fromkeys(record)
            if len(names) > MOST_LABELS:
                raise CollectionError(
                    f"{file}, line {line}: more than {MOST_LABELS:,} labels; see whether each line has one, or export "
                    "the records as CSV or Excel"
                )
        if not names:
            raise CollectionError(
                f"{file}: no line begins with {own.first[:80]!r}; say in the mapping, [source] first, which label each "
                "record begins with"
            )
        yield Row(0, 1, list(names))
        for number, (line, record) in enumerate(records(binary, file, own.encoding, own.first), start=1):
            cells = ["; ".join(record.get(name, ())) for name in names]
            broken = next((name for name, cell in zip(names, cells, strict=True) if _UNDECODED.search(cell)), "")
            fault = (
                f"a sign of {broken[:80]!r} cannot be read as {own.encoding}",
                "name the file's encoding in the mapping, [source] encoding",
            )
            yield Row(number, line, cells, fault if broken else ("", ""))


def records(binary: BufferedReader, file: str, encoding: str, first: str) -> Iterator[tuple[int, dict[str, list[str]]]]:
    """Yield the records of a text, each with the line where it begins, as the texts of its labels.

    Parameters
    ----------
    binary : BufferedReader
        The file.
    file : str
        Its name in messages.
    encoding : str
        Of its letters.
    first : str
        The label with which each record begins; what stands before the first one is left out.

    Yields
    ------
    (int, dict of str to list of str)

    Raises
    ------
    CollectionError
        For a record beyond RECORD_LIMIT characters, and for a file that fails.
    """
    binary.seek(0)
    stream = TextIOWrapper(binary, encoding=encoding, errors="surrogateescape")
    record: dict[str, list[str]] = {}
    start = length = 0
    last = ""
    try:
        for number, line in enumerate(iter(lambda: stream.readline(RECORD_LIMIT + 1), ""), start=1):
            length += len(line)
            if length > RECORD_LIMIT:
                raise CollectionError(f"{file}, line {number}: a record of more than {RECORD_LIMIT:,} characters")
            found = LABELLED.fullmatch(line.lstrip("\ufeff").rstrip())
            label = "" if found is None else " ".join(found[1].split())
            if label == first or (not line.strip() and record):
                if record:
                    yield start, record
                record, start, length, last = {}, number, len(line), ""
            if label == first or (record and found is not None):
                last = label
                record.setdefault(label, []).append("" if found is None else found[2].strip())
            elif record and line.strip() and last:
                record[last][-1] = f"{record[last][-1]} {line.strip()}".strip()
        if record:
            yield start, record
    except (OSError, UnicodeDecodeError) as problem:
        raise CollectionError(
            f"{file}: reading stopped: {problem}; see whether its encoding is {encoding}"
        ) from problem
    finally:
        stream.detach()
