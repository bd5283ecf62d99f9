"""A dump of a database as SQL, of MySQL, PostgreSQL, SQLite or SQL Server: its tables, to be joined as those of one.

Nothing of it is executed: names of columns and rows are read from CREATE TABLE, INSERT and COPY, and laid into a
database of SQLite of their own, which is gone afterwards. What else a dump holds is passed over.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import closing, contextmanager
from dataclasses import replace
from pathlib import Path
from sqlite3 import connect
from tempfile import TemporaryDirectory
from typing import Literal

from pydantic import Field

from pipeline.collection.errors import CollectionError
from pipeline.collection.limits import STANDARD, Limits
from pipeline.collection.sources.base import Opened, Request, Source
from pipeline.collection.sources.database import Database, QuerySettings
from pipeline.collection.sources.delimited import Encoding
from pipeline.collection.sources.files import unreadable
from pipeline.collection.sources.heads import numbered_heads
from pipeline.collection.sources.tables import lay

_STATEMENT = re.compile(rb"(?:CREATE\s+TABLE|INSERT\s+INTO|COPY\s+[\w.\"]+\s*\()", re.IGNORECASE)
_BEGINS = re.compile(
    rb"(?:\xef\xbb\xbf)?\s*(?:--|/\*|#|CREATE\s|INSERT\s|DROP\s|SET\s|PRAGMA\s|BEGIN|USE\s)", re.IGNORECASE
)
_TOKEN = re.compile(
    r"(?P<none>\s+|--[^\n]*|\#[^\n]*|/\*(?:.|\n)*?\*/)"
    r"|(?P<text>[NE]?'(?:[^'\\]|''|\\(?:.|\n))*'|\"(?:[^\"\\]|\"\"|\\(?:.|\n))*\")"
    r"|(?P<plain>[NE]?'(?:[^']|'')*')"
    r"|(?P<name>`(?:[^`]|``)*`|\[[^\]\n]{1,128}\])"
    r"|(?P<number>[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)"
    r"|(?P<word>[^\W\d][\w$]*)"
    r"|(?P<sign>.)",
    re.IGNORECASE,
)
_NO_BACKSLASH = re.compile(
    r"PostgreSQL database dump|PRAGMA |SET ANSI_NULLS|standard_conforming_strings\s*=\s*on", re.IGNORECASE
)
_ESCAPED = {"n": "\n", "t": "\t", "r": "\r", "0": "", "b": "", "Z": ""}
_ESCAPE = re.compile(r"\\(.)", re.DOTALL)
_NO_COLUMN = frozenset(
    {"primary", "key", "unique", "constraint", "foreign", "index", "fulltext", "check", "spatial", "exclude", "like"}
)
_COPY = re.compile(r"COPY\s+([\w.\"]+)\s*\(([^)]*)\)\s+FROM\s+stdin;[^\n]*\n", re.IGNORECASE)
_SHOWN = 60


class DumpSettings(QuerySettings):
    """How a dump is read."""

    format: Literal["dump"] = Field(description="The kind of source.")
    encoding: Encoding = Field(default="utf-8", description="How its letters are coded.")


class Dump(Source):
    """A dump of a database."""

    name = "dump"
    title = "a dump of a database"
    Settings = DumpSettings

    def recognises(self, where: str, head: bytes) -> bool:
        """Say whether it is a text of statements that make or fill tables."""
        if "://" in where or b"\0" in head or not _BEGINS.match(head):
            return False
        return _STATEMENT.search(head) is not None or Path(where).suffix.casefold() == ".sql"

    @contextmanager
    def open(self, request: Request) -> Iterator[Opened]:
        """Open the dump; it is read once, as it is then."""
        path = Path(request.where)
        with (
            dump_as_database(path, request.settings.encoding, request.limits) as url,
            Database().open(replace(request, where=url)) as opened,
        ):
            yield replace(opened, name=path.name)


@contextmanager
def dump_as_database(path: Path, encoding: str, limits: Limits = STANDARD) -> Iterator[str]:
    """Lay the tables of a dump into a database of SQLite, which is gone when the block is left.

    Parameters
    ----------
    path : Path
        The dump.
    encoding : str
        Of its letters.
    limits : Limits
        Bytes that it, and rows that any of its tables, may have.

    Yields
    ------
    str
        Its address.  All columns are texts; NULL and an empty text are NULL.

    Raises
    ------
    CollectionError
        For a file that cannot be read or is too large, one without a row, and a row that has not as many values as its
        table has columns.
    """
    try:
        size = path.stat().st_size
        if size > limits.bytes:
            raise CollectionError(f"{path.name}: {size:,} bytes, more than {limits.bytes:,}; raise [limits] megabytes")
        text = path.read_bytes().decode(encoding, "replace").removeprefix("\ufeff")
    except OSError as problem:
        raise unreadable(path.name, problem) from problem
    found = _DumpTables(text, path.name, limits.rows).read()
    if not any(rows for _, rows in found.values()):
        raise CollectionError(f"{path.name}: a dump without a row; export the tables with what is in them")
    with TemporaryDirectory(prefix="kouros-dump-") as home:
        file = Path(home) / "dump.sqlite"
        with closing(connect(file)) as database:
            for name, (columns, rows) in found.items():
                lay(database, name, columns, rows)
            database.commit()
        yield f"sqlite:///{file}"


class _DumpTables:
    """Reads the tables of a dump: of each its columns, and its rows."""

    def __init__(self, text: str, file: str, most: int) -> None:
        self._text, self._file, self._most = text, file, most
        self._at = 0
        self._escapes = not _NO_BACKSLASH.search(text[:20_000])
        self._found: dict[str, tuple[list[str], list[list[str | None]]]] = {}
        self._kind = self._said = ""

    def read(self) -> dict[str, tuple[list[str], list[list[str | None]]]]:
        while self._next():
            if self._kind != "word":
                continue
            word = self._said.casefold()
            if word == "create":
                self._create()
            elif word == "insert":
                self._insert()
            elif word == "copy":
                self._copy()
        return self._found

    def _line(self) -> int:
        return self._text.count("\n", 0, self._at) + 1

    def _next(self) -> bool:
        while self._at < len(self._text):
            found = _TOKEN.match(self._text, self._at)
            if found is None:
                return False
            self._kind, self._said = str(found.lastgroup), found[0]
            if self._kind == "text" and not self._escapes and self._said[-2:-1] == "\\":
                # A backslash is a sign like any other there, and ends no quotation.
                found = re.compile(r"[NE]?'(?:[^']|'')*'", re.IGNORECASE).match(self._text, self._at) or found
                self._said = found[0]
            if (self._kind == "plain" and self._escapes) or (self._kind == "sign" and self._said in ("'", '"', "`")):
                raise CollectionError(
                    f"{self._file}, line {self._line()}: a quotation that is never closed; export the dump again"
                )
            self._at = found.end()
            if self._kind != "none":
                return True
        return False

    def _name(self) -> str:
        """Return the name that the token, and those behind it that points join, say: the last of them."""
        name = self._unquoted()
        while self._text[self._at : self._at + 1] == ".":
            self._next()
            self._next()
            name = self._unquoted()
        return name

    def _unquoted(self) -> str:
        token = self._said
        return token[1:-1] if token[:1] in '`"[' else token

    def _create(self) -> None:
        words = []
        while self._next() and self._said not in ("(", ";"):
            if self._kind == "word" and self._said.casefold() in ("table", "if", "not", "exists", "temporary"):
                words.append(self._said.casefold())
                continue
            if "table" not in words:
                return
            name = self._name()
        if self._said != "(" or "table" not in words:
            return
        columns: list[str] = []
        depth, first = 1, True
        while depth and self._next():
            if self._kind == "sign" and self._said in "()":
                depth += 1 if self._said == "(" else -1
            elif self._kind == "sign" and self._said == "," and depth == 1:
                first = True
                continue
            elif first and depth == 1 and not (self._kind == "word" and self._said.casefold() in _NO_COLUMN):
                columns.append(self._unquoted())
            first = False
        self._found.setdefault(name, (columns, []))

    def _insert(self) -> None:
        while (
            self._next() and self._kind == "word" and self._said.casefold() in ("into", "ignore", "low_priority", "or")
        ):
            pass
        name = self._name()
        columns: list[str] = []
        if not self._next():
            return
        if self._said == "(":
            while self._next() and self._said != ")":
                if self._said != ",":
                    columns.append(self._unquoted())
            self._next()
        if self._said.casefold() not in ("values", "value"):
            return
        known, rows = self._found.setdefault(name, (columns, []))
        while self._next() and self._said == "(":
            line = self._at
            cells = self._values()
            # Without CREATE TABLE the columns have no names.
            names = columns or known or numbered_heads(len(cells))
            if len(cells) != len(names):
                self._at = line
                raise CollectionError(
                    f"{self._file}, line {self._line()}: a row of {name[:_SHOWN]!r} has {len(cells)} values for "
                    f"{len(names)} columns; export the dump again with its CREATE TABLE"
                )
            if not known:
                known += names
            row = dict(zip(names, cells, strict=True))
            known += [one for one in names if one not in known]
            rows.append([row.get(one) for one in known])
            if len(rows) > self._most:
                raise CollectionError(f"{self._file}: more than {self._most:,} rows; raise [limits] rows")
            if self._text[self._at : self._at + 1] != "," and not (self._next() and self._said == ","):
                break
            if self._said != ",":
                self._next()

    def _values(self) -> list[str | None]:
        cells: list[str | None] = []
        depth, said, filled = 1, None, False
        while depth and self._next():
            if self._kind == "sign" and self._said == "(":
                depth += 1
            elif self._kind == "sign" and self._said == ")":
                depth -= 1
            elif self._kind == "sign" and self._said == "," and depth == 1:
                cells.append(said)
                said, filled = None, False
                continue
            elif not filled:
                said, filled = self._value(), self._kind != "sign"
        return [*cells, said]

    def _value(self) -> str | None:
        if self._kind in ("text", "plain"):
            start = self._said.index("'") if "'" in self._said[:2] else 0
            quote, text = self._said[start], self._said[start + 1 : -1]
            text = text.replace(quote * 2, quote)
            if self._escapes or self._said[:1] in "eE":
                text = _ESCAPE.sub(lambda one: _ESCAPED.get(one[1], one[1]), text)
            return text or None
        word = self._said.casefold()
        return None if self._kind == "sign" or word in ("null", "default", "cast", "convert") else self._said

    def _copy(self) -> None:
        found = _COPY.match(self._text, self._at - len(self._said))
        if found is None:
            return
        names = [one.strip().strip('"') for one in found[2].split(",")]
        name = found[1].rpartition(".")[2].strip('"')
        _, rows = self._found[name] = names, []
        at = found.end()
        while at < len(self._text):
            end = self._text.find("\n", at)
            line = self._text[at : end if end >= 0 else len(self._text)].rstrip("\r")
            at = end + 1 if end >= 0 else len(self._text)
            if line == "\\.":
                break
            cells = [
                None if one == "\\N" else _ESCAPE.sub(lambda e: _ESCAPED.get(e[1], e[1]), one)
                for one in line.split("\t")
            ]
            self._at = at
            if len(cells) != len(names):
                raise CollectionError(
                    f"{self._file}, line {self._line() - 1}: a row of {name[:_SHOWN]!r} has {len(cells)} values for "
                    f"{len(names)} columns; export the dump again"
                )
            rows.append([one or None for one in cells])
        self._at = at
