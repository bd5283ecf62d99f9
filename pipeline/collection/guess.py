"""A first mapping for a museum's file, guessed from its columns: a proposal to look at, never used unseen."""

from __future__ import annotations

import csv
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import cache, cached_property
from itertools import islice
from pathlib import Path
from unicodedata import normalize

import tomlkit

from pipeline.collection.dimensions import parse
from pipeline.collection.errors import CollectionError
from pipeline.collection.mapping import DIAMETER, WRITTEN, Mapping
from pipeline.collection.record import KINDS, units_of
from pipeline.collection.sources.files import unreadable
from pipeline.collection.sources.opening import open_source
from pipeline.tables import table

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

    text    : the mapping file
    mapping : the same, ready to read with
    doubts  : what was guessed without a sign of it in the file
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


def guess(path: Path) -> Guess:
    """Propose a mapping for a museum's file.

    raises : CollectionError for a file that cannot be read, or that shows no column with the objects' numbers
    """
    source = _source(path)
    columns = _columns(path, source)
    decimal = "," if _commas(columns) and source.get("delimiter") != "," else "."
    if decimal == ",":
        source["decimal"] = decimal
    doubts: list[str] = []
    found = _fields(columns)
    if "object_number" not in found:
        found["object_number"] = _unique(path, columns)
        doubts.append(f"object numbers are taken from {found['object_number'].name!r}, where each row has another one")
    document = tomlkit.document()
    document.add(tomlkit.comment(f"Guessed from the columns of {path.name}. Look at every line; units above all."))
    document["source"] = source
    document["museum"] = {"name": "Our museum"}
    document["columns"] = _mapped(found, doubts)
    texts = _texts_of_dimensions(columns, found)
    if texts:
        document["dimensions"] = {"columns": texts}
    text = tomlkit.dumps(document)
    mapping = Mapping.model_validate(document.unwrap())
    return Guess(text, mapping, tuple(doubts))


def _source(path: Path) -> dict[str, str]:
    try:
        with path.open("rb") as stream:
            head = stream.read(SNIFFED)
    except OSError as problem:
        raise unreadable(path, problem) from problem
    if head.startswith(b"PK\x03\x04"):
        return {"format": "xlsx"}
    if b"lido-schema.org" in head[:4096]:
        return {"format": "lido"}
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
        header = next(opened.rows, None)
        if header is None:
            raise CollectionError(f"{path.name}: empty: there is no header to guess from")
        columns = [_Column(name.strip()) for name in header.cells]
        for row in islice(opened.rows, LOOKED_AT):
            if not row.fault[0]:
                for column, cell in zip(columns, row.cells, strict=True):
                    column.values.append(cell)
    return [column for column in columns if column.name]


def _plain(name: str) -> str:
    spaced = re.sub(r"(?<=[a-z])(?=[A-Z])", " ", normalize("NFC", name))
    return re.sub(r"[\s_.:\-]+", " ", spaced).strip().casefold()


@cache
def _names() -> dict[str, str]:
    return {_plain(name): row["field"] for row in table("column_names") for name in row["names"].split("|")}


def _fields(columns: Sequence[_Column]) -> dict[str, _Column]:
    """Return the fields whose columns are told by their names; of two for one field, the one that is filled more."""
    found: dict[str, _Column] = {}
    for column in columns:
        bare = _UNIT.sub("", column.name)
        own = column.name if column.name in KINDS or column.name == DIAMETER else None
        name = own or _names().get(_plain(column.name)) or _names().get(_plain(bare))
        if name is None or name == "dimensions":
            continue
        if name not in found or len(column.filled) > len(found[name].filled):
            found[name] = column
    return found


def _unique(path: Path, columns: Sequence[_Column]) -> _Column:
    for column in columns:
        if column.filled and len(set(column.filled)) == len(column.values):
            return column
    raise CollectionError(
        f"{path.name}: no column looks like object numbers; write a mapping by hand, from a copy of one that "
        "`kouros import --presets` lists"
    )


def _commas(columns: Sequence[_Column]) -> bool:
    numbers = [number for column in columns for number in column.numbers]
    return sum("," in n for n in numbers) > sum("." in n for n in numbers)


def _mapped(found: dict[str, _Column], doubts: list[str]) -> tomlkit.items.Table:
    out = tomlkit.table()
    for name in (*KINDS, DIAMETER):
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
