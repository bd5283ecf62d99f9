"""Open a source of records, whatever its kind, as rows of texts with the digest of what was read."""

from __future__ import annotations

import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path

from pipeline.collection.errors import CollectionError
from pipeline.collection.limits import STANDARD, Limits
from pipeline.collection.mapping import Mapping
from pipeline.collection.record import KINDS
from pipeline.collection.sources.base import HEAD, Opened, Request, Source
from pipeline.collection.sources.files import head_of
from pipeline.collection.sources.headings import under_headings, without_heads
from pipeline.collection.sources.long_form import gathered
from pipeline.collection.sources.registry import is_address, recognised, source_named


@contextmanager
def open_source(where: str | Path, mapping: Mapping, limits: Limits = STANDARD) -> Iterator[Opened]:
    """Open a museum's file or database.

    Parameters
    ----------
    where : str or Path
        Path of a file, or an address.
    mapping : Mapping
        How it is read.
    limits : Limits
        Bytes, rows and seconds that are accepted.

    Yields
    ------
    Opened
        Its rows and their digest.

    Raises
    ------
    CollectionError
        For a source that cannot be opened, naming it (never a password) and the remedy; its rows raise the same while
        they are read.
    """
    source = source_named(mapping.source.format)
    if source is None:
        raise CollectionError(f"{mapping.name}: there is no source of format {mapping.source.format!r} here")
    if source.is_file:
        _check(where, mapping, source)
    wanted = list(mapping.wanted())
    request = Request(
        where=str(where),
        settings=mapping.source,
        columns=tuple(dict.fromkeys(column for _, column, may_lack in wanted if not may_lack)),
        optional=tuple(dict.fromkeys(column for _, column, may_lack in wanted if may_lack)),
        key_column=mapping.columns["object_number"].sources[0],
        limits=limits,
        texts=tuple(
            name for field, one in mapping.columns.items() if KINDS.get(field) == "text" for name in one.sources
        ),
    )
    long = mapping.source.long
    with source.open(request) as opened:
        rows = without_heads(opened.rows)
        if getattr(mapping.source, "headings", False):
            rows = under_headings(rows, opened.name, getattr(mapping.source, "first_heading", ""))
        yield replace(opened, rows=rows if long is None else gathered(rows, long, opened.name))


def _check(where: str | Path, mapping: Mapping, source: Source) -> None:
    """Refuse what is surely of another kind than the mapping says."""
    if is_address(where):
        raise CollectionError(
            f'a database, and the mapping {mapping.name} reads {source.name}; say format = "sql" and a query '
            "or table in its [source]"
        )
    head = b""
    # What cannot be read is told by who reads it.
    with suppress(OSError, zlib.error):
        head = head_of(Path(where), HEAD)
    other = recognised(str(where), head)
    if other is not None and other.name != source.name and not source.recognises(str(where), head):
        raise CollectionError(
            f"{Path(where).name}: {other.title}, and the mapping {mapping.name} reads {source.name}; say "
            f'format = "{other.name}" in its [source], or let `kouros import FILE --guess` propose a mapping'
        )
