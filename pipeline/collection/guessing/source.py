"""How a source is read, as far as it shows it by itself, and the columns that it has then."""

from __future__ import annotations

import re
import zlib
from collections.abc import Generator, Iterator, Mapping
from contextlib import closing, contextmanager, suppress
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Any, BinaryIO, cast

from pipeline.collection.errors import CollectionError
from pipeline.collection.guessing.columns import Column, candidates, columns_of
from pipeline.collection.guessing.headings import has_headings, heads_first
from pipeline.collection.guessing.json_lists import objects_in
from pipeline.collection.guessing.long_rows import long_form_of
from pipeline.collection.guessing.notes import GuessNotes
from pipeline.collection.guessing.table_heads import SNIFFED, opened_file, set_head, web_page
from pipeline.collection.guessing.text_files import (
    LOOKED_AT,
    delimiter_of,
    encoding_of,
    first_label,
    first_lines,
    starts_of,
    table_head,
)
from pipeline.collection.limits import STANDARD
from pipeline.collection.mapping import Mapping as Proposal
from pipeline.collection.mapping import load_mapping
from pipeline.collection.opening import open_source
from pipeline.collection.sources.dumps import dump_as_database
from pipeline.collection.sources.files import head_of, unreadable
from pipeline.collection.sources.folders import Folder, files_in
from pipeline.collection.sources.headings import HEADING, first_text, is_heading, under_headings
from pipeline.collection.sources.json_objects import Json
from pipeline.collection.sources.long_form import COLUMNS as LONG_COLUMNS
from pipeline.collection.sources.long_form import gathered
from pipeline.collection.sources.registry import recognised, source_named
from pipeline.collection.sources.rows import Row
from pipeline.collection.sources.tables import as_database, files_of
from pipeline.collection.sources.xml_objects import record_path
from pipeline.collection.sources.xml_records import XML_FILES

READ = 2000
"""Rows that the guess is made from."""

SOME_VALUES = 20
"""Values of a file of JSON from which it is told where it lists objects."""

_HEADED = ("csv", "tsv", "fixed", "xlsx", "html")
"""Formats of tables that people write, with headings between their rows perhaps."""


# ---------------------------------------------------------------------------------------------------------------------
# Files


def source_of(path: Path, told: GuessNotes) -> dict[str, Any]:
    """Return how a file is read: the section [source] of its mapping.

    Parameters
    ----------
    path : Path
        The file, or a folder of records.
    told : GuessNotes
        What is said of it; grows.

    Returns
    -------
    dict
        Without the sheet of a workbook.

    Raises
    ------
    CollectionError
        For a file that cannot be read, or is of no kind that is known.
    """
    if path.is_dir():
        kind = recognised(str(path), b"")
        if kind is not None:
            return _known(kind.name, path, told)
        raise CollectionError(
            f"{path}: a folder without CSV, JSON or XML files; name the museum's export itself, or the folder with its "
            "tables"
        )
    try:
        head = head_of(path, SNIFFED)
    except OSError as problem:
        raise unreadable(path, problem) from problem
    except zlib.error as problem:
        raise CollectionError(f"{path.name}: packed by gzip, and damaged ({problem}); export it again") from problem
    kind = recognised(str(path), head)
    if kind is not None:
        return _known(kind.name, path, told)
    if head.lstrip(b"\xef\xbb\xbf\xff\xfe \t\r\n\x00").startswith(b"<"):
        raise CollectionError(
            f"{path.name}: a web page or a workbook in the form of a page, whatever its name says; open it in a "
            "spreadsheet program and save it as an .xlsx workbook or as CSV"
        )
    if head.lstrip(b"\xef\xbb\xbf \t\r\n")[:1] in (b"{", b"["):
        raise CollectionError(
            f"{path.name}: JSON that holds no object with names and values; export the objects as a list of such, or "
            "as CSV or Excel, and try again"
        )
    if head[:2] in (b"\xff\xfe", b"\xfe\xff") and head.decode("utf-16", "ignore").lstrip()[:1] in ("{", "["):
        raise CollectionError(f"{path.name}: JSON in UTF-16; save it as UTF-8, and try again")
    if what := _foreign(head):
        raise CollectionError(f"{path.name}: {what}, and try again")
    encoding = told.choices.get("encoding") or encoding_of(head)
    try:
        # A character that the end of what was read cuts in two is no fault.
        text = head.decode(encoding, "ignore")
    except LookupError as problem:
        raise CollectionError(f"--choose encoding: there is no encoding {encoding!r}; try utf-8 or cp1252") from problem
    label = "" if {"delimiter", "header_row"} & told.choices.keys() else first_label(text)
    if label:
        told.sure.append(f"{encoding}, records of labelled lines, each from {label!r} on")
        return {"format": "cards", "encoding": encoding, "first": label}
    delimiter = told.choices.get("delimiter", "").replace("tab", "\t") or delimiter_of(text)
    source: dict[str, Any] = {"format": "tsv", "encoding": encoding}
    starts = () if "delimiter" in told.choices else starts_of(text)
    if starts:
        rows = first_lines(text, starts, LOOKED_AT + 60)
        if table_head(rows).known > table_head(first_lines(text, delimiter, LOOKED_AT + 60)).known:
            source |= {"format": "fixed", "starts": list(starts)}
            told.sure.append(f"{encoding}, cells below each other, from characters {', '.join(map(str, starts))} on")
            set_head(source, rows, told)
            return source
    if delimiter != "\t":
        source = {"format": "csv", "encoding": encoding, "delimiter": delimiter}
    told.sure.append(f"{encoding}, cells parted by {delimiter!r}")
    set_head(source, first_lines(text, delimiter, LOOKED_AT + 60), told)
    return source


_SIGNS = (
    (b"%PDF", 0, "a PDF, which holds pages and no table; export the list as CSV or Excel"),
    (b"SQLite format 3\0", 0, "an SQLite database; name it as an address (sqlite:///path/of/the/file)"),
    (b"Standard Jet DB", 4, "a database of Access; export its table or query of the objects as CSV or Excel"),
    (b"Standard ACE DB", 4, "a database of Access; export its table or query of the objects as CSV or Excel"),
    (b"HBAM", 14, "a database of FileMaker; export its records as CSV, Excel or XML"),
    (b"{\\rtf", 0, "a text document; export the list as CSV or Excel"),
)
"""How files begin that programs of museums leave, at which byte, and what each is."""


_PROGRAM = re.compile(
    # What may stand before: comments and what it takes from other files.
    rb"(?:\xef\xbb\xbf)?\s*(?:(?://[^\n]*|/\*.{0,4000}?\*/|[\"']use \w+[\"'];?|import\s[^\n]*"
    rb"|(?:export\s+)?(?:type|interface)\s[^}]{0,8000}\})\s*){0,60}(?:export\s+default\s*[\[{]|module\.exports\s*=|(?:export\s+)?(?:const|let|var)\s+[\w$]+)",
    re.DOTALL,
)
"""How a file of JavaScript or TypeScript begins that holds values."""


def _foreign(head: bytes) -> str:
    """Say of a file what it is and what to do with it where it is no text; "" where it may be one."""
    if _PROGRAM.match(head[:20_000]):
        return (
            "a program of JavaScript and no export; save the list that it holds as JSON (node -e "
            "'console.log(JSON.stringify(require(\"./FILE\")))'), or export the objects as CSV or Excel"
        )
    for sign, at, what in _SIGNS:
        if head[at : at + len(sign)] == sign:
            return what
    even, odd = (head[at:100:2].count(0) > 40 for at in (0, 1))
    # In UTF-16 every other byte of Latin letters is none.
    if b"\0" in head and head[:2] not in (b"\xff\xfe", b"\xfe\xff") and even == odd:
        return "no text, and of no kind that Kouros knows; export the objects as CSV, Excel or XML"
    return ""


def _known(kind: str, path: Path, told: GuessNotes) -> dict[str, Any]:
    """Return how a source of a known kind is read; of plain JSON and XML, where it lists the objects."""
    if kind == "xml":
        return {"format": kind, "records": _xml_records(path, told)}
    if kind == "html":
        return web_page(path, told)
    source = source_named(kind)
    if not isinstance(source, Json):
        return {"format": kind}
    file = files_in(path, source.patterns, deep=True)[0] if path.is_dir() else path
    with opened_file(file) as binary:
        found = [value for _, value in islice(source.values_of(binary, file.name), SOME_VALUES)]
    return {"format": kind} | objects_in(found, told.choices.get("records"), told.sure)


def _xml_files(path: Path) -> Iterator[tuple[str, BinaryIO]]:
    if path.is_dir():
        yield from Folder(path, XML_FILES, STANDARD.bytes).each()
        return
    with opened_file(path) as binary:
        yield path.name, binary


def _xml_records(path: Path, told: GuessNotes) -> str:
    where = told.choices.get("records", "")
    if not where:
        at, others = record_path(partial(_xml_files, path), path.name)
        where = "/".join(at)
        if others:
            told.doubts.append(
                f"each {where!r} is taken for an object; nothing is read of {', '.join(map(repr, others[:20]))}: "
                "--choose records=PATH takes another"
            )
    told.sure.append(f"each {where!r} is an object")
    return where


@contextmanager
def laid(path: Path, source: dict[str, Any], told: GuessNotes) -> Iterator[str]:
    """Lay the tables of a folder of CSV files, or of a dump, into a database; yield its address.

    Parameters
    ----------
    path : Path
        Of the folder or the dump.
    source : dict
        The section [source], which grows.
    told : GuessNotes
        What is said of it; grows.
    """
    if source["format"] == "tables":
        source |= delimited_of(path, told)
        with as_database(path, source["encoding"], source["delimiter"]) as url:
            yield url
        return
    source["encoding"] = told.choices.get("encoding") or encoding_of(head_of(path, SNIFFED))
    with dump_as_database(path, source["encoding"]) as url:
        yield url


def delimited_of(folder: Path, told: GuessNotes) -> dict[str, str]:
    """Return encoding and delimiter of a folder's CSV files, by the largest of them."""
    largest = max(files_of(folder), key=lambda file: file.stat().st_size)
    quiet = GuessNotes({key: what for key, what in told.choices.items() if key in ("encoding", "delimiter")})
    found = source_of(largest, quiet)
    if found["format"] not in ("csv", "tsv"):
        raise CollectionError(f"{largest}: no CSV file, whatever its name; leave it out of the folder")
    told.sure += quiet.sure[:1]
    return {"encoding": found["encoding"], "delimiter": found.get("delimiter", "\t")}


_AGAIN = 0.1
"""Share of the object numbers of a sheet that may stand on another one too."""


def workbook(path: Path, sheet: str | None, told: GuessNotes) -> tuple[dict[str, Any], list[Column]]:
    """Return how a workbook is read, and the columns of its sheet: the one named, or most like an inventory."""
    from pipeline.collection.sources.xlsx import first_rows, visible_sheets

    def read(title: str | None, quietly: GuessNotes) -> tuple[dict[str, Any], list[Column]]:
        source: dict[str, Any] = {"format": "xlsx"} | ({} if title is None else {"sheet": title})
        numbered = enumerate(first_rows(path, title, LOOKED_AT + 60), start=1)
        set_head(source, [(number, cells) for number, cells in numbered if any(map(str.strip, cells))], quietly)
        return source, columns_in(path, source)

    there = visible_sheets(path)
    if sheet is not None or len(there) == 1:
        return read(sheet, told)
    best: tuple[tuple[bool, int, int], str, dict[str, Any], list[Column], GuessNotes] | None = None
    fault: CollectionError | None = None
    read_so: dict[str, tuple[dict[str, Any], list[Column]]] = {}
    for title in there:
        quietly = GuessNotes(told.choices)
        try:
            source, columns = read(title, quietly)
        except CollectionError as problem:
            fault = fault or problem
            continue
        read_so[title] = {key: what for key, what in source.items() if key != "sheet"}, columns
        fields = candidates(columns)
        likeness = "object_number" in fields, len(fields), max((len(c.values) for c in columns), default=0)
        if best is None or likeness > best[0]:
            best = likeness, title, source, columns, quietly
    if best is None:
        raise fault or CollectionError(
            f"{path.name}: no sheet of the workbook is visible; show the one with the objects"
        )
    _, title, source, columns, quietly = best
    alike = _alike(title, read_so)
    others = ", ".join(repr(one) for one in there if one not in alike)
    if len(alike) > 1:
        source = {**read_so[title][0], "sheets": alike}
        columns = columns_in(path, source)
        told.sure.append(f"{len(alike)} sheets with the same columns are read one below another, from {alike[0]!r} on")
        told.doubts += [f"nothing is read of the sheets {others}: --table takes one of them alone"] * bool(others)
    else:
        told.doubts.append(
            f"of {len(there)} sheets {title!r} looks most like the inventory and is read; --table takes another: "
            f"{others}"
        )
    told.doubts += quietly.doubts
    told.questions += quietly.questions
    told.sure += quietly.sure
    return source, columns


def _alike(title: str, read: Mapping[str, tuple[dict[str, Any], list[Column]]]) -> list[str]:
    """Return the sheets that are lists of further objects in the columns of one, itself among them.

    A copy, or the list of the year before, has its object numbers again and is none.
    """
    how, columns = read[title]
    found = candidates(columns).get("object_number", ())
    number = found[0].name if found else ""
    names = sorted(column.name for column in columns)
    seen: set[str] = set()
    out = []
    for other, (its, own) in sorted(read.items(), key=lambda one: one[0] != title):
        numbers = {text for column in own if column.name == number for text in column.filled}
        again = len(numbers & seen) > _AGAIN * len(numbers)
        if its == how and sorted(column.name for column in own) == names and numbers and not again:
            out.append(other)
            seen |= numbers
    return [one for one in read if one in out] if number else [title]


def columns_in(path: Path, source: dict[str, Any]) -> list[Column]:
    """Return the columns of a file that is read in some way.

    Parameters
    ----------
    path : Path
        The file.
    source : dict
        The section [source]; what its rows show of it is added.

    Returns
    -------
    list of Column
        With what their first READ rows hold.

    Raises
    ------
    CollectionError
        For a file without a row that can be used.
    """
    with open_source(path, _plain_mapping(source)) as opened:
        if source["format"] not in _HEADED:
            return _filled(path.name, opened.rows)
        some = list(islice(opened.rows, READ + 1))
    first = _above_the_names(path, source) if some and source.get("header_row", 1) > 1 else ""
    if has_headings(some[1:], first) and HEADING not in map(str.strip, some[0].cells):
        source["headings"] = True
        if heads_first(some[1:], first) and not is_heading(some[1]):
            source["first_heading"] = first
        some = list(under_headings(iter(some), path.name, source.get("first_heading", "")))
    return _filled(path.name, iter(some))


def _above_the_names(path: Path, source: dict[str, Any]) -> str:
    """Return the one text of the row above the names of the columns, as a room's name; "" where there is none."""
    row = None
    # A row without texts is no header.
    with suppress(CollectionError):
        higher = source | {"header_row": source["header_row"] - 1, "header_rows": 1}
        with open_source(path, _plain_mapping(higher)) as above:
            row = next(above.rows, None)
    alone = row is not None and sum(bool(cell.strip()) for cell in row.cells) == 1
    return first_text(row)[:200] if row is not None and alone else ""


def _plain_mapping(source: Mapping[str, Any]) -> Proposal:
    return Proposal.model_validate(
        {
            "source": dict(source),
            "museum": {"name": "-"},
            "columns": {"object_number": {"column": "-"}, "gallery": {"column": "-"}},
        }
    )


def _filled(name: str, rows: Iterator[Row]) -> list[Column]:
    header = next(rows, None)
    if header is None:
        raise CollectionError(f"{name}: empty: there is no header to guess from")
    whole: list[list[str]] = []
    fault: tuple[str, str] | None = None
    for row in islice(rows, READ):
        if row.fault[0]:
            fault = fault or (f"line {row.line}: {row.fault[0]}", row.fault[1])
        else:
            whole.append(row.cells)
    if not whole:
        why, remedy = fault or ("no rows of data stand below the names of columns", "export it again")
        raise CollectionError(
            f"{name}: no row can be used. {why}; {remedy}. Where the columns are named elsewhere, say it: "
            "--choose header_row=NUMBER; or how cells are parted: --choose delimiter=tab"
        )
    return columns_of(header.cells, whole)


def objects_of(name: str, source: dict[str, Any], columns: list[Column], told: GuessNotes) -> list[Column]:
    """Return the columns of objects, where those that are there are of single measurements."""
    long = long_form_of(columns)
    if long is None:
        return columns
    source["long"] = long.model_dump(exclude_none=True, exclude_defaults=True)
    told.sure.append(
        f"cells hold several measurements, parted by {long.separator!r}: {long.type!r} says which, {long.value!r} how "
        "much"
        if long.separator
        else f"each part of an object has a row of its own, and {long.part!r} says which: they are gathered by "
        f"{long.object!r}, the object itself counts"
        if long.sides
        else f"a row has several measurements, in numbered columns: {long.type!r} and its like say which, "
        f"{long.value!r} and its like how much"
        if any(one.type for one in long.again)
        else f"each measurement has a row of its own: {long.type!r} says which, {long.value!r} how much; they are "
        f"gathered by {long.object!r}"
    )
    if long.unit is None and not long.sides:
        told.doubts.append(f"no column tells the unit of {long.value!r}: its numbers are refused where they name none")
    rows = [
        Row(number, number, list(cells))
        for number, cells in enumerate(zip(*(column.values for column in columns), strict=True), start=1)
    ]
    read = _filled(name, gathered(iter([Row(0, 0, [column.name for column in columns]), *rows]), long, name))
    return [column for column in read if column.filled or column.name not in LONG_COLUMNS]


# ---------------------------------------------------------------------------------------------------------------------
# Databases


def database(
    url: str, name: str, table: str | None, told: GuessNotes
) -> tuple[str | None, dict[str, Any], list[Column]]:
    """Return the preset that reads a database, or else how it is read; and its columns."""
    from pipeline.collection.guessing.database import joined, object_tables
    from pipeline.collection.guessing.presets import preset_for
    from pipeline.collection.sources.schema import tables_of
    from pipeline.collection.sources.sql import read_database

    is_query = table is not None and len(table.split()) > 1 and table.split()[0].lower() in ("select", "with")
    query = table if is_query else None
    if not is_query:
        there = tables_of(url)
        preset = preset_for(there) if table is None else None
        if preset is not None:
            told.sure.append(f"its tables are those of the preset {preset!r}, which is taken")
            with open_source(url, load_mapping(preset)) as opened:
                return preset, {}, _filled(name, opened.rows)
        else:
            able = object_tables(there)
            known = ", ".join(repr(one.shown) for one in there[:50]) or "none"
            known += f" and {len(there) - 50} more" if len(there) > 50 else ""
            if table is None and not able and len(there) != 1:
                raise CollectionError(
                    f"{name}: no table names object numbers; say by --table which of its tables holds the objects, or "
                    f"give a SELECT there; it has {known}"
                )
            objects = next((one for one in there if table in (one.shown, one.name)), None)
            if table is None:
                objects = (able or list(there))[0]
                table = objects.shown
                if len(able) > 1:
                    others = ", ".join(repr(one.shown) for one in able[1:20])
                    told.doubts.append(f"table {table!r} looks most like the objects; --table takes another: {others}")
            if objects is not None:
                made = joined(url, there, objects)
                if made is not None:
                    query = made.query
                    told.doubts += made.said
    source = {"format": "sql", **({"query": query} if query is not None else {"table": table})}
    rows = read_database(url, query=query, table=None if query is not None else table)
    with closing(cast(Generator[Row], rows)):
        return None, source, _filled(name, rows)
