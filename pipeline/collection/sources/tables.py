"""A folder of CSV files as a source: the tables of one export, such as objects, dimensions and locations, to be joined.

They are laid into a database of SQLite of their own, which is gone afterwards, and read as any database is.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, closing, contextmanager
from dataclasses import replace
from itertools import chain
from pathlib import Path
from sqlite3 import Connection, connect
from tempfile import TemporaryDirectory
from typing import Literal

from pydantic import Field

from pipeline.collection.errors import CollectionError
from pipeline.collection.limits import STANDARD, Limits
from pipeline.collection.sources.base import Opened, Request, Source
from pipeline.collection.sources.database import Database, QuerySettings
from pipeline.collection.sources.delimited import Encoding, read_delimited
from pipeline.collection.sources.files import unreadable

MOST = 200
"""Tables of one folder."""

_ENDINGS = frozenset({".csv", ".tsv"})
_OF_ARCHIVE = "meta.xml"
"""What is in a folder whose tables are .txt: a Darwin Core archive that was unpacked."""
_MOST_COLUMNS = 2000
_UNSAFE = re.compile(r"[^\w-]", re.ASCII)


class TablesSettings(QuerySettings):
    """How a folder of CSV files is read: a file's name without its ending is that of its table."""

    format: Literal["tables"] = Field(description="The kind of source.")
    encoding: Encoding = Field(description="How the letters of all files are coded.")
    delimiter: str = Field(pattern=r'^[^"\r\n\x00]$', description="The one character between two cells of all files.")


class Tables(Source):
    """A folder of CSV files."""

    name = "tables"
    title = "a folder of CSV files"
    Settings = TablesSettings

    def recognises(self, where: str, head: bytes) -> bool:  # noqa: ARG002
        """Say whether it is a folder in which CSV files are."""
        path = Path(where)
        return path.is_dir() and bool(files_of(path))

    @contextmanager
    def open(self, request: Request) -> Iterator[Opened]:
        """Open the folder; its files are read once, as they are then."""
        own, folder = request.settings, Path(request.where)
        with (
            as_database(folder, own.encoding, own.delimiter, request.limits) as url,
            Database().open(replace(request, where=url)) as opened,
        ):
            yield replace(opened, name=folder.name)


def files_of(folder: Path) -> list[Path]:
    """Return the CSV files of a folder, those of its own folders left out, by name; of an archive its .txt too."""
    try:
        endings = _ENDINGS | ({".txt"} if (folder / _OF_ARCHIVE).is_file() else set())
        return sorted(p for p in folder.iterdir() if p.suffix.casefold() in endings and p.is_file())
    except OSError as problem:
        raise unreadable(folder, problem) from problem


@contextmanager
def as_database(folder: Path, encoding: str, delimiter: str, limits: Limits = STANDARD) -> Iterator[str]:
    """Lay the CSV files of a folder into a database of SQLite, which is gone when the block is left.

    Parameters
    ----------
    folder : Path
        With a file for each table.
    encoding : str
        Of all files.
    delimiter : str
        Between two cells, of all files; a .tsv has tabs.
    limits : Limits
        Bytes that all files together, and rows that any of them, may have.

    Yields
    ------
    str
        Its address.  All columns are texts; an empty cell is NULL, so that it joins nothing.

    Raises
    ------
    CollectionError
        For a folder without CSV files or with more than `MOST`, for files that are too large, and for a row that is
        broken, naming file and line: what is joined to a row that is left out would be missing unsaid.
    """
    files = files_of(folder)
    if not 0 < len(files) <= MOST:
        raise CollectionError(f"{folder}: {len(files)} CSV files; name a folder with the tables of one export")
    names: dict[str, Path] = {}
    for file in files:
        # SQLite tells no capital from a small letter.
        other = names.setdefault(file.stem.casefold(), file)
        if other is not file:
            raise CollectionError(f"{folder}: {other.name} and {file.name} would be one table; rename one of them")
    try:
        size = sum(file.stat().st_size for file in files)
    except OSError as problem:
        raise unreadable(folder, problem) from problem
    if size > limits.bytes:
        raise CollectionError(
            f"{folder}: {size:,} bytes of CSV files, more than {limits.bytes:,}; leave out the tables that tell "
            "neither sizes nor places, or raise [limits] megabytes"
        )
    with TemporaryDirectory(prefix="kouros-tables-") as home:
        # Of any folder's name only what means nothing in an address.
        path = Path(home) / f"{_UNSAFE.sub('_', folder.name)[:80] or 'tables'}.sqlite"
        with closing(connect(path)) as database:
            for file in files:
                _fill(database, file, encoding, "\t" if file.suffix.casefold() == ".tsv" else delimiter, limits.rows)
            database.commit()
        yield f"sqlite:///{path}"


def _fill(database: Connection, file: Path, encoding: str, delimiter: str, most: int) -> None:
    with ExitStack() as stack:
        try:
            binary = stack.enter_context(file.open("rb"))
        except OSError as problem:
            raise unreadable(file, problem) from problem
        rows = read_delimited(binary, file.name, delimiter, encoding)
        header = next(rows, None)
        if header is None:
            return
        names = _distinct(header.cells)
        if len(names) > _MOST_COLUMNS:
            raise CollectionError(f"{file.name}: {len(names):,} columns; this is no table with one object a row")
        database.execute(f"CREATE TEMP TABLE laid ({', '.join(f'{_quoted(name)} TEXT' for name in names)})")

        def cells() -> Iterator[list[str | None]]:
            for row in rows:
                if row.fault[0]:
                    raise CollectionError(f"{file.name}, line {row.line}: {row.fault[0]}; {row.fault[1]}")
                if row.number > most:
                    raise CollectionError(
                        f"{file.name}: more than {most:,} rows; export fewer objects, or raise [limits] rows"
                    )
                yield [cell if cell.strip() else None for cell in row.cells]

        first = next(found := cells(), None)
        if first is not None:
            marks = ", ".join("?" * len(names))
            database.executemany(f"INSERT INTO laid VALUES ({marks})", chain([first], found))  # noqa: S608  # nosec B608
    _keyed(database, _quoted(file.stem), names)


def lay(database: Connection, table: str, header: list[str], rows: Sequence[Sequence[str | None]]) -> None:
    """Lay a table into a database: all columns are texts.

    Parameters
    ----------
    database : Connection
        Of SQLite.
    table : str
        Its name.
    header : list of str
        Names of its columns; those that come twice get a number.
    rows : sequence of sequence of (str or None)
        Short ones are filled up.

    Raises
    ------
    CollectionError
        For more columns than a table of objects has.
    """
    names = _distinct(header)
    if not 0 < len(names) <= _MOST_COLUMNS:
        raise CollectionError(f"table {table[:80]!r}: {len(names):,} columns; this is no table with one object a row")
    database.execute(f"CREATE TEMP TABLE laid ({', '.join(f'{_quoted(name)} TEXT' for name in names)})")
    marks = ", ".join("?" * len(names))
    whole = ([*row, *[None] * (len(names) - len(row))] for row in rows)
    database.executemany(f"INSERT INTO laid VALUES ({marks})", whole)  # noqa: S608  # nosec B608
    _keyed(database, _quoted(table), names)


def _keyed(database: Connection, table: str, names: list[str]) -> None:
    """Make a table of what was laid, with a primary key and indices: by these tables are joined."""
    linked = [name for name in names if name.casefold().endswith("id")]
    key = next((name for name in linked if _tells_apart(database, name)), None)
    columns = (f"{_quoted(name)} TEXT{' PRIMARY KEY' if name == key else ''}" for name in names)
    database.execute(f"CREATE TABLE {table} ({', '.join(columns)})")
    database.execute(f"INSERT INTO {table} SELECT * FROM laid")  # noqa: S608  # nosec B608 - quoted
    database.execute("DROP TABLE laid")
    for name in linked:
        if name != key:
            database.execute(f"CREATE INDEX {_quoted(f'{table} {name}')} ON {table} ({_quoted(name)})")


def _tells_apart(database: Connection, name: str) -> bool:
    """Whether a column has another text in each row."""
    column = _quoted(name)
    found = database.execute(f"SELECT count(*), count(DISTINCT {column}) FROM laid")  # noqa: S608  # nosec B608 - quoted
    rows, different = map(int, found.fetchone())
    return 0 < rows == different


def _distinct(header: list[str]) -> list[str]:
    """Return names for the columns, each once: SQLite tells no capital from a small letter."""
    out: list[str] = []
    seen: set[str] = set()
    for number, cell in enumerate(header, start=1):
        name = cell.strip().replace("\x00", "") or f"column {number}"
        while name.casefold() in seen:
            name = f"{name} ({number})"
        seen.add(name.casefold())
        out.append(name)
    return out


def _quoted(name: str) -> str:
    return '"' + name.replace('"', '""') + '"'
