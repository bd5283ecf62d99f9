"""Where the columns of a table are named, as [source] says it: of files with delimiters, workbooks and web pages."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import closing, contextmanager
from io import BufferedReader
from pathlib import Path
from typing import Any, BinaryIO, cast

from pipeline.collection.errors import CollectionError
from pipeline.collection.guessing.facts import facts_of
from pipeline.collection.guessing.notes import GuessNotes
from pipeline.collection.guessing.questions import Question
from pipeline.collection.guessing.text_files import LOOKED_AT, encoding_of, is_sideways, table_head
from pipeline.collection.limits import STANDARD
from pipeline.collection.sources.files import head_of, unpacked, unreadable
from pipeline.collection.sources.web_pages import page_tables

SNIFFED = 1 << 18
"""Bytes from which encoding and delimiter are told."""


@contextmanager
def opened_file(file: Path) -> Iterator[BinaryIO]:
    """Open a file, unpacked where it was packed by gzip.

    Parameters
    ----------
    file : Path
        Its path.

    Yields
    ------
    BinaryIO
    """
    try:
        with file.open("rb") as packed, closing(unpacked(packed, file.name, STANDARD.bytes)) as binary:
            yield binary
    except OSError as problem:
        raise unreadable(file, problem) from problem


def set_head(source: dict[str, Any], rows: Sequence[tuple[int, list[str]]], told: GuessNotes) -> None:
    """Say where the columns are named, where that is not the first row alone.

    Parameters
    ----------
    source : dict
        The section [source], which grows.
    rows : sequence of (int, list of str)
        The first rows that are not blank, each with its number.
    told : GuessNotes
        What is said of it; grows.
    """
    several = next((at for at, (_, cells) in enumerate(rows) if sum(bool(cell.strip()) for cell in cells) > 1), 0)
    if rows and "header_row" not in told.choices and is_sideways(rows[several:]):
        source |= {"sideways": True} | ({"header_row": rows[several][0]} if several else {})
        told.sure.append("objects stand side by side: each column is one, and the first cell of each row names a field")
        return
    head = table_head(rows)
    row, many = head.row, head.rows
    try:
        row = int(told.choices.get("header_row", row))
        many = int(told.choices.get("header_rows", many if row == head.row else 1))
    except ValueError as problem:
        raise CollectionError(
            "--choose header_row (and header_rows): needs a number, such as header_row=4"
        ) from problem
    if row == 0:
        source["header_row"] = 0
        told.doubts.append(
            "no row names the columns, for the first one is written as those below it: they are numbered, and their "
            "cells tell what each is; --choose header_row=1 takes the first row for names"
        )
        told.questions.append(Question("header_row", "which row names the columns?", ("0", "1"), "0"))
        return
    # A first row may come late only where blank lines stand above it, which are passed over anyway.
    if row != 1 and (row != rows[0][0] if rows else True):
        source["header_row"] = row
        told.sure.append(f"the columns are named in row {row}, below titles")
    if many > 1:
        source["header_rows"] = many
        told.sure.append(f"{many} rows name the columns together")
    facts = facts_of([cells for _, cells in rows], next((at for at, (n, _) in enumerate(rows) if n == row), 0))
    if many == 1 and facts is not None:
        source["facts"] = facts.model_dump()
        told.sure.append(
            f"each fact of an object has a row of its own: {facts.field!r} says which, {facts.value!r} what it is; "
            f"they are gathered by {facts.object!r}"
        )
        return
    if head.known < 2 and "header_row" not in told.choices:
        told.doubts.append(
            f"row {row} is taken for the names of the columns, of which few are known here; --choose header_row=NUMBER "
            "names another row"
        )
        options = tuple(str(number) for number, cells in rows[:10] if sum(map(bool, cells)) > 1)
        told.questions.append(Question("header_row", "which row names the columns?", options, str(row)))


def web_page(path: Path, told: GuessNotes) -> dict[str, Any]:
    """Return how the table of a web page is read in which the most fields are named.

    Parameters
    ----------
    path : Path
        The page.
    told : GuessNotes
        What is said of it; grows.
    """
    head = head_of(path, SNIFFED)
    encoding = told.choices.get("encoding") or encoding_of(head)
    with opened_file(path) as binary:
        tables = page_tables(cast(BufferedReader, binary), path.name, encoding)
    able = {at: _counted(table) for at, table in enumerate(tables) if sum(len(cells) > 1 for _, cells in table) > 1}
    if not able:
        raise CollectionError(
            f"{path.name}: a web page without a table; name the museum's export itself, or export the list as CSV or "
            ".xlsx"
        )
    best = max(able, key=lambda at: (table_head(able[at]).known, len(able[at])))
    source: dict[str, Any] = {"format": "html", "encoding": encoding} | ({"table": best + 1} if best else {})
    if len(able) > 1:
        told.doubts.append(f"of {len(able)} tables of the page number {best + 1} looks most like the objects")
    set_head(source, able[best], told)
    return source


def _counted(table: Sequence[tuple[int, list[str]]]) -> list[tuple[int, list[str]]]:
    """Return the first rows that are not blank, by their numbers in the table: several may stand on one line."""
    rows = enumerate(table[: LOOKED_AT + 60], start=1)
    return [(number, cells) for number, (_, cells) in rows if any(map(str.strip, cells))]
