"""The rows of a museum's own database, read in one snapshot that cannot write, one by one.

PostgreSQL: a transaction that is REPEATABLE READ and READ ONLY, with the server's own limits of time. SQLite: the file
is opened for reading only, in one transaction, and interrupted when the time is over. Any other database of SQLAlchemy:
the strictest isolation level that it offers, a transaction that is rolled back, and a limit of time between two blocks
of rows; there, give Kouros an account that may only read.
"""

from __future__ import annotations

import re
import sqlite3
import time
import uuid
import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any
from urllib.parse import quote

from sqlalchemy import (
    Connection,
    CursorResult,
    Engine,
    Inspector,
    column,
    create_engine,
    inspect,
    quoted_name,
    select,
)
from sqlalchemy import table as table_clause
from sqlalchemy.exc import DBAPIError, SQLAlchemyError
from sqlalchemy.pool import NullPool

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.address import Address, expand_secrets
from pipeline.collection.sources.delimited import FIELD_LIMIT
from pipeline.collection.sources.rows import Row, as_text

FETCH = 200
"""Rows that are in memory at a time."""

LOCK_SECONDS = 10.0
"""How long a locked SQLite file is waited for."""

_STEPS = 10_000
"""Instructions of SQLite between two looks at the clock."""

_BEGIN = re.compile(r"(?:\s|\(|--[^\n]*\n|/\*.*?\*/)*(?:select|with|values|table)\b", re.I | re.S)
_QUOTED = re.compile(r"""'[^']*'|"[^"]*\"""")
_OBSCURE = re.compile(r"--|/\*|[\\`$#]")
_UNUSABLE = re.compile("[\x00\ud800-\udfff]")


class _TimedOutError(Exception):
    pass


class _Clock:
    def __init__(self, seconds: float) -> None:
        self._end = time.monotonic() + seconds

    def left(self) -> float:
        return self._end - time.monotonic()

    def check(self) -> None:
        if self.left() <= 0:
            raise _TimedOutError("time is over")


def read_database(
    url: str,
    *,
    query: str | None = None,
    table: str | None = None,
    columns: Sequence[str] | None = None,
    optional: Sequence[str] = (),
    order_by: str | None = None,
    timeout_seconds: float = 600.0,
    environment: Mapping[str, str] | None = None,
) -> Iterator[Row]:
    """Yield the names of the columns (number 0) and then every row; a row's line is its number.

    Values are as they are in the database, by `as_text`; a UUID is its text, a date beyond the years 1 to 9999 what
    PostgreSQL writes for it. Binary values, arrays, structures and texts with broken characters give their cell a
    fault.

    Parameters
    ----------
    url : str
        Of SQLAlchemy, with ${NAME} for secrets (`expand_secrets`).
    query : str or None
        One SELECT (or WITH, VALUES, TABLE), in the order that it says; or
    table : str or None
        A table or a view, as name or schema.name, exactly as the database lists it.
    columns : sequence of str, or None
        Of the table, all where left out.
    optional : sequence of str
        Further columns, which the table may lack.
    order_by : str or None
        The table's column with the object number: the order of the rows; ties and, where it is left out, all rows
        follow the primary key.
    timeout_seconds : float
        In s, for all of it, what is done with the rows included.
    environment : mapping of str to str, or None
        Where ${NAME} is looked up, the process's own unless given.

    Yields
    ------
    Row
        First the header.

    Raises
    ------
    CollectionError
        Naming the database without its secrets, the row reached, and the remedy.
    """
    address = expand_secrets(url, environment)
    reached = 0
    try:
        with ExitStack() as stack:
            clock = _Clock(timeout_seconds)
            connection = _open(address, clock, stack)
            if query is not None and table is None:
                _check_query(query, address)
                options = {"yield_per": FETCH, "no_parameters": True}
                result = connection.exec_driver_sql(query.strip().rstrip("; \t\r\n"), execution_options=options)
                if not result.returns_rows:
                    raise CollectionError(f"{address.shown}: the query gives no rows; begin it with SELECT")
                names = list(result.keys())
            elif table is not None and query is None:
                result, names = _select(connection, address, table, columns, optional, order_by)
            else:
                raise CollectionError(f"{address.shown}: needs either a query or a table, and not both")
            stack.callback(_let_go, result.cursor)
            stack.callback(result.close)
            yield Row(0, 0, names)
            for block in result.partitions(FETCH):
                for values in block:
                    reached += 1
                    yield _row(reached, values)
                clock.check()
    except (SQLAlchemyError, OSError, UnicodeError, ImportError, _TimedOutError) as problem:
        # Not chained: what the driver says may hold the secrets.
        raise _explained(problem, address, reached, timeout_seconds) from None


@contextmanager
def inspected(
    url: str, *, timeout_seconds: float = 60.0, environment: Mapping[str, str] | None = None
) -> Iterator[Inspector]:
    """Open a museum's database to see which tables it has.

    Parameters
    ----------
    url : str
        As of `read_database`.
    timeout_seconds : float
        In s, for all of it.
    environment : mapping of str to str, or None
        Where ${NAME} is looked up, the process's own unless given.

    Yields
    ------
    Inspector
        SQLAlchemy's own.

    Raises
    ------
    CollectionError
        As `read_database`.
    """
    address = expand_secrets(url, environment)
    try:
        with ExitStack() as stack, warnings.catch_warnings():
            warnings.simplefilter("ignore")  # on types that SQLAlchemy does not know, which do not matter here
            yield inspect(_open(address, _Clock(timeout_seconds), stack))
    except (SQLAlchemyError, OSError, UnicodeError, ImportError, _TimedOutError) as problem:
        raise _explained(problem, address, 0, timeout_seconds) from None


def _let_go(cursor: Any) -> None:
    """Close a driver's cursor: SQLAlchemy tries once only, which fails where the server has ended the connection."""
    with suppress(Exception):  # most often it is closed already, which some drivers mind
        cursor.close()


def _row(number: int, values: Sequence[Any]) -> Row:
    cells: list[str] = []
    faults: dict[int, tuple[str, str]] = {}
    for place, value in enumerate(values):
        text = ""
        try:
            text = as_text(str(value) if isinstance(value, uuid.UUID) else value)
        except (TypeError, ValueError) as problem:
            faults[place] = (f"cannot be read: {problem}", "select it as a text or a number, or leave it out")
        if _UNUSABLE.search(text):
            faults[place] = ("holds a character that is none", "mend the text in the database")
        elif len(text) > FIELD_LIMIT:
            faults[place] = (f"a text of more than {FIELD_LIMIT:,} characters", "leave the column out, or shorten it")
        cells.append("" if place in faults else text)
    return Row(number, number, cells, faults=faults)


# ---------------------------------------------------------------------------------------------------------------------
# Opening


def _open(address: Address, clock: _Clock, stack: ExitStack) -> Connection:
    return _GUARDS.get(address.url.get_backend_name(), _open_other)(address, clock, stack)


def _connect(engine: Engine, stack: ExitStack) -> Connection:
    stack.callback(engine.dispose)
    # Leaving rolls back.
    return stack.enter_context(engine.connect())


def _open_postgresql(address: Address, clock: _Clock, stack: ExitStack) -> Connection:
    url = address.url
    if url.drivername == "postgresql":
        url = url.set(drivername="postgresql+psycopg")
    arguments: dict[str, Any] = {}
    if url.get_driver_name() in ("psycopg", "psycopg2"):
        # A server that is gone without a word must not be waited for.
        arguments = {
            "connect_timeout": max(2, min(30, int(clock.left()))),
            "client_encoding": "utf8",
            "application_name": "kouros",
            "keepalives_idle": 30,
            "keepalives_interval": 10,
            "keepalives_count": 3,
        }
    engine = create_engine(url, poolclass=NullPool, hide_parameters=True, connect_args=arguments)
    connection = _connect(engine, stack)
    connection = connection.execution_options(isolation_level="REPEATABLE READ", postgresql_readonly=True)
    milliseconds = max(1, int(1000 * clock.left()))
    for limit in ("statement_timeout", "idle_in_transaction_session_timeout", "lock_timeout"):
        connection.exec_driver_sql(f"SET LOCAL {limit} = {milliseconds}")
    connection.exec_driver_sql("SELECT 1")  # from here on everything is seen as it is now
    if url.get_driver_name() == "psycopg":
        _keep_strange_dates(connection)
    return connection


def _keep_strange_dates(connection: Connection) -> None:
    """Let dates that Python cannot hold (44 BC, infinity) come as the server's text instead of ending the reading."""
    from psycopg import DataError
    from psycopg.types import datetime as loaders

    driver: Any = connection.connection.driver_connection
    kinds: dict[str, Any] = {
        "date": loaders.DateLoader,
        "timestamp": loaders.TimestampLoader,
        "timestamptz": loaders.TimestamptzLoader,
    }

    def lenient(strict: Any) -> Any:
        class Lenient(strict):  # type: ignore[misc]
            def load(self, data: Any) -> Any:
                try:
                    return super().load(data)
                except DataError:
                    return bytes(data).decode()

        return Lenient

    for name, strict in kinds.items():
        driver.adapters.register_loader(name, lenient(strict))


def _open_sqlite(address: Address, clock: _Clock, stack: ExitStack) -> Connection:
    if address.url.get_driver_name() != "pysqlite":
        return _open_other(address, clock, stack)
    path = Path(address.url.database or "")
    if not path.is_file():
        raise CollectionError(
            f"{address.shown}: there is no such file; write sqlite:/// and the path, with a fourth stroke where it "
            "begins at the root"
        )

    def create() -> sqlite3.Connection:
        opened = sqlite3.connect(
            f"file:{quote(str(path.resolve()))}?mode=ro",
            uri=True,
            timeout=max(0.0, min(LOCK_SECONDS, clock.left())),
            isolation_level=None,
            check_same_thread=False,  # a generator may be closed by another thread
        )
        # A byte that is not UTF-8 spoils its own cell only.
        opened.text_factory = lambda data: data.decode("utf-8", "surrogateescape")
        opened.set_progress_handler(lambda: int(clock.left() <= 0), _STEPS)
        opened.execute("PRAGMA query_only = ON")
        return opened

    connection = _connect(create_engine("sqlite://", creator=create, poolclass=NullPool, hide_parameters=True), stack)
    connection.exec_driver_sql("BEGIN")
    connection.exec_driver_sql("SELECT count(*) FROM sqlite_master")  # the snapshot begins with the first reading
    return connection


def _open_other(address: Address, clock: _Clock, stack: ExitStack) -> Connection:
    clock.check()
    connection = _connect(create_engine(address.url, poolclass=NullPool, hide_parameters=True), stack)
    try:
        driver: Any = connection.connection.dbapi_connection
        levels = connection.dialect.get_isolation_level_values(driver)
    except NotImplementedError:
        return connection
    for level in ("REPEATABLE READ", "SNAPSHOT", "SERIALIZABLE"):
        if level in levels:
            return connection.execution_options(isolation_level=level)
    return connection


_GUARDS: dict[str, Callable[[Address, _Clock, ExitStack], Connection]] = {
    "postgresql": _open_postgresql,
    "sqlite": _open_sqlite,
}


# ---------------------------------------------------------------------------------------------------------------------
# Queries and tables


def _check_query(query: str, address: Address) -> None:
    """Refuse what is more than one statement, or none that reads; that nothing is written is the transaction's work."""
    if not _BEGIN.match(query):
        raise CollectionError(f"{address.shown}: the query must begin with SELECT or WITH, and only read")
    inner = query.strip().rstrip("; \t\r\n")
    if ";" in _QUOTED.sub("", inner) or (";" in inner and _OBSCURE.search(inner)):
        raise CollectionError(
            f"{address.shown}: the query may be one statement only; leave out every semicolon but the last, and "
            "comments with a semicolon"
        )


def _select(
    connection: Connection,
    address: Address,
    name: str,
    columns: Sequence[str] | None,
    optional: Sequence[str],
    order_by: str | None,
) -> tuple[CursorResult[Any], list[str]]:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # on types that SQLAlchemy does not know, which do not matter here
        inspector = inspect(connection)
        schema, table = _find(inspector, address, name)
        there = [str(found["name"]) for found in inspector.get_columns(table, schema=schema)]
        key = inspector.get_pk_constraint(table, schema=schema).get("constrained_columns") or []
    wished = there if columns is None else [*columns, *(each for each in optional if each in there)]
    names = list(dict.fromkeys(wished))
    for wanted in (*names, *([] if order_by is None else [order_by])):
        if wanted not in there:
            known = ", ".join(repr(each) for each in there[:80])
            raise CollectionError(f"{address.shown}: {name} has no column {wanted!r}; name one of its columns: {known}")
    # Some databases fold names to capitals; SQLAlchemy quotes those itself, where it must.
    always = None if connection.dialect.requires_name_normalize else True
    source = table_clause(
        quoted_name(table, always),
        *(column(quoted_name(each, always)) for each in there),
        schema=None if schema is None else quoted_name(schema, always),
    )
    order = dict.fromkeys([*([] if order_by is None else [order_by]), *(each for each in key if each in there)])
    statement = select(*(source.c[each] for each in names)).order_by(*(source.c[each] for each in order))
    return connection.execute(statement, execution_options={"yield_per": FETCH}), names


def _find(inspector: Inspector, address: Address, name: str) -> tuple[str | None, str]:
    """Schema and name of a table or a view that the database itself lists."""
    if inspector.has_table(name):
        return None, name
    schemas = inspector.get_schema_names() if "." in name else []
    for place, letter in enumerate(name):
        schema, table = name[:place], name[place + 1 :]
        if letter == "." and schema in schemas and inspector.has_table(table, schema=schema):
            return schema, table
    there = sorted({*inspector.get_table_names(), *inspector.get_view_names()})
    known = ", ".join(map(repr, there[:50])) or "none"
    raise CollectionError(
        f"{address.shown}: has no table or view {name!r}; name one of its tables, or schema.table. Those of the "
        f"default schema are {known}"
    )


# ---------------------------------------------------------------------------------------------------------------------
# What went wrong

_TIME = "more time was needed than was given", "give more seconds, select fewer columns, or read at a quieter hour"
_WRITES = "it would write", "only queries that read are run"
_LOST = "the connection was lost", "see whether the server and the network are up, and read again from the beginning"
_LOGIN = "it does not let Kouros in", "see whether user and password are right and the account may read there"

_STATES: dict[str, tuple[str, str]] = {
    "57014": _TIME,
    "25P03": _TIME,
    "55P03": _TIME,
    "28P01": _LOGIN,
    "28000": _LOGIN,
    "42501": _LOGIN,
    "25006": _WRITES,
    "3D000": ("there is no such database", "see whether its name is right"),
    "42P01": ("there is no such table", "see whether its name and its schema are right"),
    "42703": ("there is no such column", "see whether its name is right"),
    "57P01": _LOST,
    "57P02": _LOST,
    "57P03": _LOST,
}
"""PostgreSQL's codes of errors."""

_WORDS: tuple[tuple[str, tuple[str, str]], ...] = (
    ("interrupted", _TIME),
    ("database is locked", ("another program writes to it", "read when that program is done")),
    ("attempt to write a readonly database", _WRITES),
    ("data-modifying", _WRITES),
    ("password authentication failed", _LOGIN),
    ("no password supplied", _LOGIN),
    ("no such table", _STATES["42P01"]),
    ("no such column", _STATES["42703"]),
    ("not a database", ("it is no SQLite file, or an encrypted one", "see whether the path is right")),
    ("malformed", ("the file is damaged", "restore it, or export the table as CSV")),
    ("Can't load plugin", ("no such kind of database is known", "see how its address begins")),
    ("unable to open", ("the file cannot be opened", "see whether Kouros may read it and its folder")),
)
"""What drivers say, where they give no code."""


def _explained(problem: Exception, address: Address, reached: int, seconds: float) -> CollectionError:
    place = f"{address.shown}, after row {reached}" if reached else address.shown
    if isinstance(problem, _TimedOutError):
        return CollectionError(f"{place}: {_TIME[0]} ({seconds:g} s); {_TIME[1]}")
    if isinstance(problem, ImportError):
        return CollectionError(
            f"{place}: the driver for this kind of database is not installed ({address.clean(problem)}); install it "
            "beside Kouros"
        )
    origin = problem.orig if isinstance(problem, DBAPIError) and problem.orig is not None else problem
    said = address.clean(origin)
    state = str(getattr(origin, "sqlstate", None) or "")
    what, remedy = _STATES.get(state) or next(
        (meaning for words, meaning in _WORDS if words in said), ("it cannot be read", "see what the database says")
    )
    lost = isinstance(problem, DBAPIError) and problem.connection_invalidated
    if lost or state.startswith("08"):
        what, remedy = _LOST
    return CollectionError(f"{place}: {what}: {said}; {remedy}")
