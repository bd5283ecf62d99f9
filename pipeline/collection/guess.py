"""A first mapping for a museum's file or database, guessed from its columns: to be looked at, never used unseen."""

from __future__ import annotations

from collections.abc import Generator, Iterator, Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Any, cast

import tomlkit

from pipeline.collection.errors import CollectionError
from pipeline.collection.guessing.columns import Column, candidates, columns_of
from pipeline.collection.guessing.columns import texts_of_dimensions as texts_among
from pipeline.collection.guessing.fields import Fields, Question, decimal_of
from pipeline.collection.guessing.long_rows import long_form_of
from pipeline.collection.guessing.names import bare
from pipeline.collection.guessing.text_files import LOOKED_AT, delimiter_of, encoding_of, first_lines, head_of
from pipeline.collection.guessing.words import stores_among
from pipeline.collection.mapping import MAPPABLE, PRESETS, load_mapping, preset_names
from pipeline.collection.mapping import Mapping as Proposal
from pipeline.collection.opening import open_source
from pipeline.collection.sources.address import expand_secrets
from pipeline.collection.sources.files import unreadable
from pipeline.collection.sources.long_form import COLUMNS as LONG_COLUMNS
from pipeline.collection.sources.long_form import gathered
from pipeline.collection.sources.registry import is_address, recognised
from pipeline.collection.sources.rows import Row
from pipeline.quantities import counted

READ = 2000
"""Rows that the guess is made from."""

SNIFFED = 1 << 18
"""Bytes from which encoding and delimiter are told."""

MOST_STORES = 200
"""Places that are listed as stores at most."""

_TABLES = ("csv", "tsv", "xlsx", "sql")
"""Formats whose columns are the museum's own."""

_FORMATS = {"lido": "lido", "adlib": "adlib", "museumplus_ria": "museumplus", "linked_art": "linked_art"}
"""Preset -> the format of which it reads any file, for Kouros itself names the columns."""


@dataclass(frozen=True)
class Guess:
    """A proposed mapping: as TOML with comments, ready to be used, and what a person should look at.

    Attributes
    ----------
    text : str
        The mapping file.
    mapping : Mapping
        The same, ready to read with.
    doubts : tuple of str
        What was guessed without a sign of it in the file.
    questions : tuple of Question
        What may be chosen otherwise, by the key that the choice has.
    sure : tuple of str
        What the source itself says.
    """

    text: str
    mapping: Proposal
    doubts: tuple[str, ...]
    questions: tuple[Question, ...] = ()
    sure: tuple[str, ...] = ()


@dataclass
class _Told:
    """What is said of a guess on its way."""

    choices: Mapping[str, str]
    doubts: list[str] = field(default_factory=list)
    questions: list[Question] = field(default_factory=list)
    sure: list[str] = field(default_factory=list)


def guess(where: str | Path, table: str | None = None, choices: Mapping[str, str] | None = None) -> Guess:
    """Propose a mapping for a museum's file or database.

    Parameters
    ----------
    where : str or Path
        Path of a file, or the URL of a database, which is only read.
    table : str or None
        The sheet of a workbook, or the table, view or SELECT of a database; where it is left out, the one that looks
        most like an inventory is taken, and a database's dimensions and places are joined to it.
    choices : mapping of str to str
        What a person has chosen: a field and its column ("object_number": "Inv."; "-" for none), a field's unit
        ("height_m.unit": "cm"), "header_row", "header_rows", "encoding", "delimiter", "decimal".

    Returns
    -------
    Guess
        The mapping, and what to look at.

    Raises
    ------
    CollectionError
        For a source that cannot be read, that shows no column with the objects' numbers, and for a choice that cannot
        be; with the option that helps.
    """
    told = _Told(dict(choices or {}))
    _check_choices(told.choices)
    if is_address(where):
        name = expand_secrets(str(where)).shown
        preset, source, columns = _of_database(str(where), name, table, told)
        if preset is not None:
            return _of_preset(preset, columns, told)
    else:
        path = Path(where)
        name = path.name
        source = _source(path, told)
        if source["format"] == "xlsx":
            source, columns = _of_workbook(path, table, told)
        elif table is not None:
            raise CollectionError(f"{name}: has neither sheets nor tables; leave --table out")
        elif source["format"] not in _TABLES:
            kind = str(source["format"])
            preset = next((one for one in preset_names() if _FORMATS.get(one) == kind), None)
            columns = _columns(path, source)
            if preset is not None:
                told.sure.append(f"{name} is of the format {kind}, whose preset {preset!r} is taken")
                return _of_preset(preset, columns, told)
        else:
            columns = _columns(path, source)
    columns = _gathered(name, source, columns, told)
    decimal = told.choices.get("decimal") or decimal_of(columns)
    if decimal == "," and source.get("delimiter") != ",":
        source["decimal"] = decimal
        told.sure.append("decimal comma, as most numbers have it")
    return _written(name, source, columns, told)


def _check_choices(choices: Mapping[str, str]) -> None:
    own = ("header_row", "header_rows", "encoding", "delimiter", "decimal", "dimensions", "unit")
    for key in choices:
        if key not in own and key.removesuffix(".unit") not in MAPPABLE:
            raise CollectionError(
                f"--choose {key}: there is no such choice; choose a field of the record (such as gallery=COLUMN), its "
                f"unit (height_m.unit=cm), or one of {', '.join(own)}"
            )


def _written(name: str, source: dict[str, Any], columns: Sequence[Column], told: _Told) -> Guess:
    found = _chosen(name, columns, candidates(columns), told)
    document = tomlkit.document()
    document.add(
        tomlkit.comment(f"Guessed from the columns of {' '.join(name.split())}. Look at every line; units above all.")
    )
    document["source"] = {key: value for key, value in source.items() if key != "long"}
    if "query" in source:
        document["source"]["query"] = tomlkit.string(f"\n{source['query']}\n", multiline=True)
    if "long" in source:
        document["source"]["long"] = source["long"]
    document["museum"] = {"name": "Our museum"}
    fields, used = Fields(columns, told.choices, told.doubts, told.questions).mapped(found)
    document["columns"] = fields
    texts = texts_among(columns, used)
    wanted = told.choices.get("dimensions")
    if wanted is not None:
        texts = [] if wanted == "-" else [_column(name, columns, "dimensions", wanted)]
    if texts:
        document["dimensions"] = {"columns": [column.name for column in texts]}
    gallery = found.get("gallery")
    stores = stores_among(gallery.distinct) if gallery is not None else []
    if stores:
        document["display"] = {"not_on_display": stores[:MOST_STORES]}
        told.doubts.append(_said_of(stores))
    if "on_display" not in fields and not stores:
        told.doubts.append(
            "nothing tells what is on display: all objects are taken to be; --choose on_display=COLUMN names a column "
            "that says it, and [display] not_on_display in the mapping names stores"
        )
    if not texts and not {"height_m", "width_m", "depth_m", "diameter_m"} & set(fields):
        told.doubts.append(
            "no column with sizes was found; --choose height_m=COLUMN (and so on), or --choose dimensions=COLUMN for "
            "texts such as 12 x 5 cm"
        )
    text = tomlkit.dumps(document)
    proposal = Proposal.model_validate(document.unwrap())
    return Guess(text, proposal, tuple(told.doubts), tuple(told.questions), tuple(told.sure))


def _chosen(name: str, columns: Sequence[Column], able: Mapping[str, list[Column]], told: _Told) -> dict[str, Column]:
    """Return the column of each field: the one that was chosen, or the likeliest."""
    found = {fieldname: those[0] for fieldname, those in able.items() if fieldname in MAPPABLE}
    for key, wanted in told.choices.items():
        if key in MAPPABLE:
            found.pop(key, None)
            if wanted != "-":
                found[key] = _column(name, columns, key, wanted)
    for fieldname, those in able.items():
        if len({bare(column.name) for column in those}) > 1 and fieldname in found and fieldname not in told.choices:
            names = tuple(column.name for column in those)
            told.questions.append(
                Question(
                    fieldname, f"which column is {fieldname.removesuffix('_m').removesuffix('_kg')}?", names, names[0]
                )
            )
    number = found.get("object_number")
    if number is None:
        found["object_number"] = number = _unique(name, columns)
        told.doubts.append(f"object numbers are taken from {number.name!r}, where each row has another one")
        likely = tuple(c.name for c in columns if len(set(c.filled)) > 0.9 * len(c.values))
        told.questions.append(Question("object_number", "which column has the object numbers?", likely, number.name))
    elif len(able.get("object_number", ())) > 1 and "object_number" not in told.choices:
        others = ", ".join(repr(column.name) for column in able["object_number"][1:4])
        told.doubts.append(
            f"object numbers are taken from {number.name!r}, and not from {others}; --choose object_number=COLUMN "
            "takes another"
        )
    repeated = len(number.filled) - len(set(number.filled))
    if repeated:
        told.doubts.append(
            f"column {number.name!r} repeats {repeated} object numbers: only the first row of each is kept"
        )
    if len(number.filled) < len(number.values):
        told.doubts.append(
            f"column {number.name!r} is empty in {len(number.values) - len(number.filled)} rows, which are refused"
        )
    return found


def _column(name: str, columns: Sequence[Column], key: str, wanted: str) -> Column:
    for column in columns:
        if column.name == wanted:
            return column
    there = ", ".join(repr(column.name) for column in columns[:80])
    raise CollectionError(f"{name}: --choose {key}: there is no column {wanted!r}; its columns are {there}")


def _unique(name: str, columns: Sequence[Column]) -> Column:
    for column in columns:
        if column.filled and len(set(column.filled)) == len(column.values):
            return column
    there = ", ".join(repr(column.name) for column in columns[:30])
    raise CollectionError(
        f"{name}: no column looks like object numbers. Its columns are {there}. Say which has them: --choose "
        "object_number=COLUMN; or where the names of the columns stand: --choose header_row=NUMBER"
    )


# ---------------------------------------------------------------------------------------------------------------------
# Files


def _source(path: Path, told: _Told) -> dict[str, Any]:
    if path.is_dir():
        kind = recognised(str(path), b"")
        if kind is not None:
            return {"format": kind.name}
        raise CollectionError(f"{path}: a folder without records; name the museum's export itself")
    try:
        with path.open("rb") as stream:
            head = stream.read(SNIFFED)
    except OSError as problem:
        raise unreadable(path, problem) from problem
    kind = recognised(str(path), head)
    if kind is not None:
        return {"format": kind.name}
    if head.lstrip(b"\xef\xbb\xbf\xff\xfe \t\r\n\x00").startswith(b"<"):
        raise CollectionError(
            f"{path.name}: XML of a kind that Kouros does not know; it knows LIDO, Adlib XML and MuseumPlus RIA. "
            "Export it as one of these, or as CSV or Excel, and try again"
        )
    encoding = told.choices.get("encoding") or encoding_of(head)
    try:
        # A character that the end of what was read cuts in two is no fault.
        text = head.decode(encoding, "ignore")
    except LookupError as problem:
        raise CollectionError(f"--choose encoding: there is no encoding {encoding!r}; try utf-8 or cp1252") from problem
    delimiter = told.choices.get("delimiter", "").replace("tab", "\t") or delimiter_of(text)
    source: dict[str, Any] = {"format": "tsv", "encoding": encoding}
    if delimiter != "\t":
        source = {"format": "csv", "encoding": encoding, "delimiter": delimiter}
    told.sure.append(f"{encoding}, cells parted by {delimiter!r}")
    _set_head(source, first_lines(text, delimiter, LOOKED_AT + 60), told)
    return source


def _set_head(source: dict[str, Any], rows: Sequence[tuple[int, list[str]]], told: _Told) -> None:
    """Say where the columns are named, where that is not the first row alone."""
    head = head_of(rows)
    row, many = head.row, head.rows
    try:
        row = int(told.choices.get("header_row", row))
        many = int(told.choices.get("header_rows", many if row == head.row else 1))
    except ValueError as problem:
        raise CollectionError(
            "--choose header_row (and header_rows): needs a number, such as header_row=4"
        ) from problem
    # A first row may come late only where blank lines stand above it, which are passed over anyway.
    if row != 1 and (row != rows[0][0] if rows else True):
        source["header_row"] = row
        told.sure.append(f"the columns are named in row {row}, below titles")
    if many > 1:
        source["header_rows"] = many
        told.sure.append(f"{many} rows name the columns together")
    if head.known < 2 and "header_row" not in told.choices:
        told.doubts.append(
            f"row {row} is taken for the names of the columns, of which few are known here; --choose header_row=NUMBER "
            "names another row"
        )
        options = tuple(str(number) for number, cells in rows[:10] if sum(map(bool, cells)) > 1)
        told.questions.append(Question("header_row", "which row names the columns?", options, str(row)))


def _of_workbook(path: Path, sheet: str | None, told: _Told) -> tuple[dict[str, Any], list[Column]]:
    """Return how a workbook is read, and the columns of its sheet: the one named, or most like an inventory."""
    from pipeline.collection.sources.xlsx import first_rows, visible_sheets

    def read(title: str | None, quietly: _Told) -> tuple[dict[str, Any], list[Column]]:
        source: dict[str, Any] = {"format": "xlsx"} | ({} if title is None else {"sheet": title})
        numbered = enumerate(first_rows(path, title, LOOKED_AT + 60), start=1)
        _set_head(source, [(number, cells) for number, cells in numbered if any(map(str.strip, cells))], quietly)
        return source, _columns(path, source)

    there = visible_sheets(path)
    if sheet is not None or len(there) == 1:
        return read(sheet, told)
    best: tuple[tuple[bool, int, int], str, dict[str, Any], list[Column], _Told] | None = None
    fault: CollectionError | None = None
    for title in there:
        quietly = _Told(told.choices)
        try:
            source, columns = read(title, quietly)
        except CollectionError as problem:
            fault = fault or problem
            continue
        fields = candidates(columns)
        likeness = "object_number" in fields, len(fields), max((len(c.values) for c in columns), default=0)
        if best is None or likeness > best[0]:
            best = likeness, title, source, columns, quietly
    if best is None:
        raise fault or CollectionError(
            f"{path.name}: no sheet of the workbook is visible; show the one with the objects"
        )
    _, title, source, columns, quietly = best
    others = ", ".join(repr(one) for one in there if one != title)
    told.doubts.append(
        f"of {len(there)} sheets {title!r} looks most like the inventory and is read; --table takes another: {others}"
    )
    told.doubts += quietly.doubts
    told.questions += quietly.questions
    told.sure += quietly.sure
    return source, columns


def _of_preset(name: str, columns: Sequence[Column], told: _Told) -> Guess:
    """Return a preset, and what the source leaves empty of what it reads."""
    text = (PRESETS / f"{name}.toml").read_text(encoding="utf-8")
    proposal = load_mapping(name)
    filled = {column.name for column in columns if column.filled}

    def tells(*fields: str) -> bool:
        read = [proposal.columns[one] for one in fields if one in proposal.columns]
        return any(one.constant is not None or filled & set(one.sources) for one in read)

    if not tells("object_number"):
        told.doubts.append("no record tells object numbers: export them")
    if not tells("gallery"):
        told.doubts.append(
            "no record tells where an object is: export the current location, or put a constant in [columns.gallery]"
        )
    texts = () if proposal.dimensions is None else proposal.dimensions.columns
    if not tells("height_m", "width_m", "depth_m", "diameter_m") and not filled & set(texts):
        told.doubts.append("no record tells sizes: export the dimensions too")
    places = proposal.columns["gallery"].sources
    stores = stores_among(_joined(columns, places, proposal.columns["gallery"].separator))
    if stores:
        document = tomlkit.parse(text)
        document["display"] = {"not_on_display": stores[:MOST_STORES]}
        text = tomlkit.dumps(document)
        told.doubts.append(_said_of(stores))
    elif not tells("on_display"):
        told.doubts.append("nothing tells what is on display: name stores in the mapping, [display] not_on_display")
    return Guess(text, Proposal.model_validate(tomlkit.parse(text).unwrap()), tuple(told.doubts), (), tuple(told.sure))


def _joined(columns: Sequence[Column], names: Sequence[str], separator: str) -> list[str]:
    """Return the different texts that some columns give together."""
    read = [next(column for column in columns if column.name == name) for name in names]
    rows = zip(*(column.values for column in read), strict=True)
    return list(dict.fromkeys(separator.join(filter(None, map(str.strip, row))) for row in rows))


def _said_of(stores: Sequence[str]) -> str:
    shown = ", ".join(map(repr, stores[:5])) + (", ..." if len(stores) > 5 else "")
    return f"{counted(len(stores), 'place')} counted as stores, by their names: {shown}"


def _columns(path: Path, source: Mapping[str, Any]) -> list[Column]:
    with open_source(path, _plain_mapping(source)) as opened:
        return _filled(path.name, opened.rows)


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
    fault = ("no rows of data stand below the names of columns", "export it again")
    for row in islice(rows, READ):
        if row.fault[0]:
            fault = (f"line {row.line}: {row.fault[0]}", row.fault[1])
        else:
            whole.append(row.cells)
    if not whole:
        raise CollectionError(
            f"{name}: no row can be used. {fault[0]}; {fault[1]}. Where the columns are named elsewhere, say it: --choose "
            "header_row=NUMBER; or how cells are parted: --choose delimiter=tab"
        )
    return columns_of(header.cells, whole)


def _gathered(name: str, source: dict[str, Any], columns: list[Column], told: _Told) -> list[Column]:
    """Return the columns of objects, where those that are there are of single measurements."""
    long = long_form_of(columns)
    if long is None:
        return columns
    source["long"] = long.model_dump(exclude_none=True)
    told.sure.append(
        f"each measurement has a row of its own: {long.type!r} says which, {long.value!r} how much; they are gathered "
        f"by {long.object!r}"
    )
    if long.unit is None:
        told.doubts.append(f"no column tells the unit of {long.value!r}: its numbers are refused where they name none")
    rows = [
        Row(number, number, list(cells))
        for number, cells in enumerate(zip(*(column.values for column in columns), strict=True), start=1)
    ]
    read = _filled(name, gathered(iter([Row(0, 0, [column.name for column in columns]), *rows]), long, name))
    return [column for column in read if column.filled or column.name not in LONG_COLUMNS]


# ---------------------------------------------------------------------------------------------------------------------
# Databases


def _of_database(
    url: str, name: str, table: str | None, told: _Told
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
