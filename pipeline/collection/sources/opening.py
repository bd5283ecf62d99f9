"""Open a source of records, whatever its kind, as rows of texts with the digest of what was read."""

from __future__ import annotations

import hashlib
import json
import stat
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from io import BufferedReader
from pathlib import Path

from pipeline.collection.errors import CollectionError
from pipeline.collection.limits import STANDARD, Limits
from pipeline.collection.mapping import Mapping, Source
from pipeline.collection.sources.delimited import DelimitedRows
from pipeline.collection.sources.files import unreadable
from pipeline.collection.sources.rows import Row, Spans

TIMEOUT = 600.0
"""Seconds that a database may take, where the mapping says nothing."""


_WORKBOOK = b"PK\x03\x04"
"""How a workbook begins: it is a ZIP archive."""


@dataclass(frozen=True)
class Opened:
    """A source that is open: its name for messages, its rows (the header first), and how to tell its digest.

    digest : SHA-256 of a file's bytes, or of all the rows of a database; call it when the rows are read
    spans  : the rows once more, where they can be passed over
    """

    name: str
    rows: Iterator[Row]
    digest: Callable[[], str]
    spans: Spans | None = None


def is_database(where: str | Path) -> bool:
    """Whether a source is the URL of a database and not the path of a file."""
    return "://" in str(where)


@contextmanager
def open_source(where: str | Path, mapping: Mapping, limits: Limits = STANDARD) -> Iterator[Opened]:
    """Open a museum's file or database.

    where  : path of a file, or the URL of a database
    raises : CollectionError for a source that cannot be opened, naming it (never a password) and the remedy; its rows
             raise the same while they are read
    """
    if mapping.source.format == "sql":
        yield _database(str(where), mapping, limits)
        return
    if is_database(where):
        raise CollectionError(
            f'a database, and the mapping {mapping.name} reads {mapping.source.format}; say format = "sql" and a query '
            "or table in its [source]"
        )
    path = Path(where)
    with _open(path, limits.bytes) as binary:
        digest = _digest(binary, path.name)
        source = mapping.source
        if source.format in ("csv", "tsv"):
            if binary.peek(4)[:4] == _WORKBOOK:
                raise CollectionError(
                    f"{path.name}: an Excel workbook, and the mapping {mapping.name} reads {source.format}; say "
                    'format = "xlsx" in its [source], or let `kouros import FILE --guess` propose a mapping'
                )
            rows = DelimitedRows(binary, path.name, source.delimiter or "\t", source.encoding or "utf-8")
            yield Opened(path.name, rows, lambda: digest, rows)
        else:
            yield Opened(path.name, _file_rows(binary, path.name, source), lambda: digest)


def _file_rows(binary: BufferedReader, file: str, source: Source) -> Iterator[Row]:
    if source.format == "xlsx":
        from pipeline.collection.sources.xlsx import read_sheet

        return read_sheet(binary, file, sheet=source.sheet, header_row=source.header_row or 1)
    from pipeline.collection.sources.lido import read_records

    return read_records(binary, file, languages=(source.language or "en",))


def _database(url: str, mapping: Mapping, limits: Limits) -> Opened:
    from pipeline.collection.sources.address import expand_secrets
    from pipeline.collection.sources.sql import read_database

    source = mapping.source
    wanted = list(mapping.wanted())
    rows = read_database(
        url,
        query=source.query,
        table=source.table,
        columns=[column for _, column, may_lack in wanted if not may_lack] if source.table else None,
        optional=[column for _, column, may_lack in wanted if may_lack],
        order_by=mapping.columns["object_number"].sources[0] if source.table else None,
        timeout_seconds=min(source.timeout_seconds or TIMEOUT, limits.seconds),
    )
    digest = hashlib.sha256()

    def told() -> Iterator[Row]:
        for row in rows:
            digest.update(json.dumps([row.cells, sorted(row.faults.items())], ensure_ascii=True).encode())
            yield row

    return Opened(expand_secrets(url).shown, told(), digest.hexdigest)


def _open(path: Path, most: int) -> BufferedReader:
    try:
        state = path.stat()
        if not stat.S_ISREG(state.st_mode):
            raise CollectionError(f"{path}: not a file; name the museum's export itself")
        if state.st_size > most:
            raise CollectionError(
                f"{path}: {state.st_size:,} bytes, more than {most:,}; export fewer columns or objects, "
                "or raise [limits] megabytes"
            )
        return path.open("rb")
    except OSError as problem:
        raise unreadable(path, problem) from problem


def _digest(binary: BufferedReader, file: str) -> str:
    try:
        digest = hashlib.file_digest(binary, "sha256").hexdigest()
        binary.seek(0)
    except OSError as problem:
        raise CollectionError(
            f"{file}: reading stopped: {problem.strerror or problem}; see whether the disk or network share is there"
        ) from problem
    return digest
