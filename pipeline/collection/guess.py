"""A first mapping for a museum's file, guessed from its columns: a proposal to look at, never used unseen."""

from __future__ import annotations

import csv
import re
import zlib
from collections.abc import Generator, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass, field
from functools import cache, cached_property
from itertools import islice
from pathlib import Path
from typing import Annotated, cast
from unicodedata import normalize

import tomlkit
from pydantic import AfterValidator

from pipeline.collection.dimensions import parse
from pipeline.collection.errors import CollectionError
from pipeline.collection.guessed_display import flag_column, number_column, stores
from pipeline.collection.mapping import MAPPABLE, WRITTEN, Mapping
from pipeline.collection.opening import open_source
from pipeline.collection.record import units_of
from pipeline.collection.sources.address import expand_secrets
from pipeline.collection.sources.files import head_of, unreadable
from pipeline.collection.sources.registry import is_address, recognised
from pipeline.collection.sources.rows import Row
from pipeline.errors import InputError
from pipeline.tables import table
from pipeline.tables.rows import Entries, checked

LOOKED_AT = 2000
"""Rows that the guess is made from."""

FEWEST = 5
"""Numbers in eighths or sixteenths from which a column is taken to be in inches."""

SNIFFED = 1 << 18
"""Bytes from which encoding and delimiter are told."""

_UNIT = re.compile(r"[\s_(\[]+(mm|cm|m|in|inch|inches|ft|kg|g|lb|lbs|oz)[\s)\]]*$", re.IGNORECASE)
_UNITS = {"inch": "in", "inches": "in", "lbs": "lb"}
_NUMBER = re.compile(r"[+-]?\d+([.,]\d+)?", re.ASCII)
_TENTHS = re.compile(r"\d*[.,][1-46-9]")
_SIXTEENTHS = re.compile(r"\d*[.,](?:0625|125|1875|3125|375|4375|5625|625|6875|8125|875|9375)")


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
    """

    text: str
    mapping: Mapping
    doubts: tuple[str, ...]


@dataclass
class _Column:
    """A column, whole when it is asked about."""

    name: str
    values: list[str] = field(default_factory=list)

    @cached_property
    def filled(self) -> list[str]:
        return [value.strip() for value in self.values if value.strip()]

    @cached_property
    def numbers(self) -> list[str]:
        return [value for value in self.filled if _NUMBER.fullmatch(value)]

    @cached_property
    def dimensional(self) -> float:
        """Share of its texts that hold a dimension with a unit."""
        some = self.filled[:200]
        return sum(any(p.unit for p in parse(text).parts) for text in some) / len(some) if some else 0.0


def guess(where: str | Path, table: str | None = None) -> Guess:
    """Propose a mapping for a museum's file or database.

    Parameters
    ----------
    where : str or Path
        Path of a file, or the URL of a database, which is only read.
    table : str or None
        The sheet of a workbook, or the table, view or SELECT of a database; may be left out where there is one, and of
        several sheets the one that looks most like an inventory is taken.

    Returns
    -------
    Guess
        The mapping, and what to look at.

    Raises
    ------
    CollectionError
        For a source that cannot be read, that shows no column with the objects' numbers, or of whose tables one must be
        named.
    """
    doubts: list[str] = []
    if is_address(where):
        name = expand_secrets(str(where)).shown
        source, columns = _of_database(str(where), name, table)
    else:
        path = Path(where)
        name = path.name
        source = _source(path)
        if source["format"] == "xlsx":
            source, columns = _of_workbook(path, table, doubts)
        elif table is not None:
            raise CollectionError(f"{name}: has neither sheets nor tables; leave --table out")
        else:
            columns = _columns(path, source)
    decimal = "," if _commas(columns) and source.get("delimiter") != "," else "."
    if decimal == ",":
        source["decimal"] = decimal
    found = _fields(columns)
    numbers = [column for column in columns if _field_of(column) == "object_number"]
    chosen = number_column(numbers, doubts)
    if chosen is not None:
        found["object_number"] = chosen
    if "object_number" not in found:
        found["object_number"] = _unique(name, columns)
        doubts.append(f"object numbers are taken from {found['object_number'].name!r}, where each row has another one")
    used = {id(column) for column in found.values()}
    flag = flag_column(
        found.pop("on_display", None), [c for c in columns if id(c) not in used], found.get("gallery"), doubts
    )
    if flag is not None:
        found["on_display"] = flag
    document = tomlkit.document()
    document.add(tomlkit.comment(f"Guessed from the columns of {_line(name)}. Look at every line; units above all."))
    document["source"] = source
    document["museum"] = {"name": "Our museum"}
    document["columns"] = _mapped(found, doubts)
    texts = _texts_of_dimensions(columns, found)
    if texts:
        document["dimensions"] = {"columns": texts}
    if flag is None and stores(found.get("gallery")):
        document["display"] = {"not_on_display": stores(found.get("gallery"))}
    text = tomlkit.dumps(document)
    mapping = Mapping.model_validate(document.unwrap())
    return Guess(text, mapping, tuple(doubts))


def _line(text: str) -> str:
    return " ".join(text.split())


def _of_database(url: str, name: str, table: str | None) -> tuple[dict[str, str], list[_Column]]:
    """Return how a database is read, and its columns."""
    from pipeline.collection.sources.sql import read_database, tables

    if table is None:
        there = tables(url)
        if len(there) != 1:
            known = ", ".join(map(repr, there[:50])) or "none"
            raise CollectionError(
                f"{name}: say by --table which of its tables holds the objects, or give a SELECT there; it has {known}"
                + (f" and {len(there) - 50} more" if len(there) > 50 else "")
            )
        table = there[0]
    is_query = len(table.split()) > 1 and table.split()[0].lower() in ("select", "with")
    source = {"format": "sql", "query" if is_query else "table": table}
    rows = read_database(url, query=table if is_query else None, table=None if is_query else table)
    with closing(cast(Generator[Row], rows)):
        return source, _filled(name, rows)


def _of_workbook(path: Path, sheet: str | None, doubts: list[str]) -> tuple[dict[str, str], list[_Column]]:
    """Return how a workbook is read, and the columns of its sheet: the one named, or most like an inventory."""
    from pipeline.collection.sources.xlsx import visible_sheets

    there = visible_sheets(path)
    if sheet is None and len(there) == 1:
        return {"format": "xlsx"}, _columns(path, {"format": "xlsx"})
    if sheet is not None:
        source = {"format": "xlsx", "sheet": sheet}
        return source, _columns(path, source)
    best: tuple[tuple[bool, int, int], str, list[_Column]] | None = None
    fault: CollectionError | None = None
    for title in there:
        try:
            columns = _columns(path, {"format": "xlsx", "sheet": title})
        except CollectionError as problem:
            fault = fault or problem
            continue
        fields = _fields(columns)
        likeness = "object_number" in fields, len(fields), max((len(c.values) for c in columns), default=0)
        if best is None or likeness > best[0]:
            best = likeness, title, columns
    if best is None:
        raise fault or CollectionError(
            f"{path.name}: no sheet of the workbook is visible; show the one with the objects"
        )
    others = ", ".join(repr(title) for title in there if title != best[1])
    doubts.append(
        f"of {len(there)} sheets {best[1]!r} looks most like the inventory and is read; --table takes another: {others}"
    )
    return {"format": "xlsx", "sheet": best[1]}, best[2]


def _source(path: Path) -> dict[str, str]:
    try:
        head = head_of(path, SNIFFED)
    except OSError as problem:
        raise unreadable(path, problem) from problem
    except zlib.error as problem:
        raise CollectionError(f"{path.name}: packed by gzip, and damaged ({problem}); export it again") from problem
    kind = recognised(str(path), head)
    if kind is not None:
        return {"format": kind.name}
    encoding = _encoding(head)
    # A character that the end of what was read cuts in two is no fault.
    text = head.decode(encoding, "ignore")
    delimiter = _delimiter(text)
    if delimiter == "\t":
        return {"format": "tsv", "encoding": encoding}
    return {"format": "csv", "encoding": encoding, "delimiter": delimiter}


def _encoding(head: bytes) -> str:
    if head.startswith((b"\xff\xfe", b"\xfe\xff")):
        return "utf-16"
    try:
        head.decode("utf-8")
    except UnicodeDecodeError as problem:
        if problem.start < len(head) - 4:
            return "cp1252"
    return "utf-8"


def _delimiter(text: str) -> str:
    try:
        return csv.Sniffer().sniff(text[:65536], ",;\t|").delimiter
    except csv.Error:
        header = text.partition("\n")[0]
        return max(",;\t|", key=header.count)


def _columns(path: Path, source: dict[str, str]) -> list[_Column]:
    plain = Mapping.model_validate(
        {
            "source": source,
            "museum": {"name": "-"},
            "columns": {"object_number": {"column": "-"}, "gallery": {"column": "-"}},
        }
    )
    with open_source(path, plain) as opened:
        return _filled(path.name, opened.rows)


def _filled(name: str, rows: Iterator[Row]) -> list[_Column]:
    header = next(rows, None)
    if header is None:
        raise CollectionError(f"{name}: empty: there is no header to guess from")
    columns = [_Column(cell.strip()) for cell in header.cells]
    for row in islice(rows, LOOKED_AT):
        if not row.fault[0]:
            for column, cell in zip(columns, row.cells, strict=True):
                column.values.append(cell)
    return [column for column in columns if column.name]


def _plain(name: str) -> str:
    spaced = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", normalize("NFC", name))
    return re.sub(r"[\s_.:\-]+", " ", spaced).strip().casefold()


def _mappable(field: str) -> str:
    if field not in (*MAPPABLE, "dimensions"):
        raise InputError(f"is {field!r}, which is no field that a column can be mapped to")
    return field


@dataclass(frozen=True, slots=True)
class _ColumnNames:
    field: Annotated[str, AfterValidator(_mappable)]
    names: Entries


@cache
def _names() -> dict[str, str]:
    rows = checked(_ColumnNames, table("column_names"), "column_names.csv", named="field")
    return {_plain(name): row.field for row in rows for name in row.names}


def _fields(columns: Sequence[_Column]) -> dict[str, _Column]:
    """Return the fields whose columns are told by their names; of two for one field, the one that is filled more."""
    found: dict[str, _Column] = {}
    for column in columns:
        name = _field_of(column)
        if name is None or name == "dimensions":
            continue
        if name not in found or len(column.filled) > len(found[name].filled):
            found[name] = column
    return found


def _field_of(column: _Column) -> str | None:
    bare = _UNIT.sub("", column.name)
    own = column.name if column.name in MAPPABLE else None
    return own or _names().get(_plain(column.name)) or _names().get(_plain(bare))


def _unique(name: str, columns: Sequence[_Column]) -> _Column:
    for column in columns:
        if column.filled and len(set(column.filled)) == len(column.values):
            return column
    raise CollectionError(
        f"{name}: no column looks like object numbers; write a mapping by hand, from a copy of one that "
        "`kouros import --presets` lists"
    )


def _commas(columns: Sequence[_Column]) -> bool:
    numbers = [number for column in columns for number in column.numbers]
    return sum("," in n for n in numbers) > sum("." in n for n in numbers)


def _mapped(found: dict[str, _Column], doubts: list[str]) -> tomlkit.items.Table:
    out = tomlkit.table()
    for name in MAPPABLE:
        if name == "gallery" and name not in found:
            out[name] = {"constant": "Location not recorded"}
            doubts.append("no column tells where an object is: all are in one gallery until you name one")
        column = found.get(name)
        if column is None:
            continue
        entry = tomlkit.table()
        entry["column"] = column.name
        units = units_of(name)
        if units:
            unit = _unit(column, units, doubts)
            if unit is None:
                continue
            entry["unit"] = unit
            if any(float(n.replace(",", ".")) == 0.0 for n in column.numbers):
                entry["missing"] = [0.0]
        if name == "aat":
            entry = tomlkit.table()
            entry["columns"] = [column.name]
        out[name] = entry
    return out


def _unit(column: _Column, units: object, doubts: list[str]) -> str | None:
    told = _UNIT.search(column.name)
    unit = _UNITS.get(told[1].lower(), told[1].lower()) if told else None
    if unit is not None and unit in units:  # type: ignore[operator]
        return unit
    filled = column.filled
    if filled and len(column.numbers) < 0.5 * len(filled):
        if column.dimensional > 0.5:
            return WRITTEN
        doubts.append(f"column {column.name!r} holds neither numbers nor lengths with units: left out")
        return None
    if "kg" in units:  # type: ignore[operator]
        doubts.append(f"column {column.name!r} tells no unit: kilograms are taken")
        return "kg"
    sixteenths = sum(bool(_SIXTEENTHS.fullmatch(n)) for n in column.numbers)
    tenths = sum(bool(_TENTHS.fullmatch(n)) for n in column.numbers)
    inches = sixteenths >= FEWEST and sixteenths > 3 * tenths
    doubts.append(
        f"column {column.name!r} tells no unit: "
        + ("inches are taken, for it has eighths and sixteenths" if inches else "centimetres are taken")
    )
    return "in" if inches else "cm"


def _texts_of_dimensions(columns: Sequence[_Column], found: dict[str, _Column]) -> list[str]:
    """Return the columns called dimensions that hold some; else the one whose texts are mostly such."""
    free = [column for column in columns if column.name not in {used.name for used in found.values()}]
    named = [c.name for c in free if _names().get(_plain(c.name)) == "dimensions" and c.dimensional > 0.2]
    if named:
        return named
    texts = [c for c in free if len(c.filled) > 0.2 * len(c.values) and len(c.numbers) < 0.5 * len(c.filled)]
    best = max(texts, key=lambda c: c.dimensional, default=None)
    return [best.name] if best is not None and best.dimensional > 0.6 else []
