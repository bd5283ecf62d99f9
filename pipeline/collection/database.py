"""One way to a database: embedded SQLite by default, PostgreSQL where the museum has a server."""

import errno
import os
import re
import shutil
import sqlite3
import weakref
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache, partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any
from urllib.parse import quote

from sqlalchemy import Engine, MetaData, create_engine, event
from sqlalchemy.engine import URL, ExceptionContext, make_url
from sqlalchemy.exc import ArgumentError, DisconnectionError, OperationalError
from sqlalchemy.pool import NullPool, QueuePool
from sqlalchemy.util import LRUCache

from pipeline.errors import InputError, KourosError

Database = Engine
"""An open database, for those floors that hand it on without speaking SQL."""

METADATA = MetaData(
    # Named constraints: a migration can drop what it can name.
    naming_convention={
        "ix": "ix_%(table_name)s_%(column_0_N_name)s",
        "uq": "uq_%(table_name)s_%(column_0_N_name)s",
        "ck": "ck_%(table_name)s_%(constraint_name)s",
        "fk": "fk_%(table_name)s_%(column_0_N_name)s_%(referred_table_name)s",
        "pk": "pk_%(table_name)s",
    }
)
"""All of Kouros's own tables, the inventory's (here) and the results' (in store)."""

PATIENCE_S = 10.0
"""How long is waited for another process that has SQLite's file locked."""


def database_url(where: str | Path) -> URL:
    """Turn a path or a URL into a database URL; a path means an SQLite file.

    Parameters
    ----------
    where : str or Path
        The path, or the URL.

    Returns
    -------
    sqlalchemy.URL
        Of SQLite or PostgreSQL.

    Raises
    ------
    InputError
        For what is no URL, and for one of a kind that Kouros does not keep its own tables in.
    """
    text = str(where)
    try:
        url = make_url(text) if "://" in text else URL.create("sqlite", database=text)
    except (ArgumentError, ValueError):
        # The address may hold a password: neither it nor what is said of it is repeated.
        raise InputError(
            "the address of Kouros's own database cannot be read; write postgresql://user:${NAME}@host:port/database, "
            "with what is special in a password percent-encoded, or the path of an SQLite file"
        ) from None
    if url.get_backend_name() not in {"sqlite", "postgresql"}:
        raise InputError(f"Kouros keeps its own tables in SQLite or PostgreSQL, not in {url.get_backend_name()!r}")
    return url.set(drivername="postgresql+psycopg") if url.drivername == "postgresql" else url


def open_database(where: str | Path, *, keeping: int = 0) -> Engine:
    """Open Kouros's own database, making the folder of an SQLite file where it is missing.

    Parameters
    ----------
    where : str or Path
        Its path, or its URL.
    keeping : int
        How many connections wait to be used again, for who answers many small questions.  By default a connection is
        opened for each piece of work and closed after it: a night holds none while it computes.
    """
    url = database_url(where)
    lite = url.get_backend_name() == "sqlite"
    if lite and url.database:
        Path(url.database).parent.mkdir(parents=True, exist_ok=True)
    if keeping:
        # What SQLite keeps open is looked at by `_same_file`; a server may have ended a connection.
        engine = create_engine(
            url, poolclass=QueuePool, pool_size=keeping, max_overflow=-1, pool_use_lifo=True, pool_pre_ping=not lite
        )
    else:
        engine = create_engine(url, poolclass=NullPool)
    if lite:
        event.listen(engine, "connect", _prepare_sqlite)
        if keeping:
            event.listen(engine, "checkout", partial(_same_file, Path(str(url.database))))
        _share(engine)
    return engine


@cache
def _common() -> Engine:
    """The engine whose dialect all files have in common; it has asked SQLite for its version."""
    engine = create_engine("sqlite://", poolclass=NullPool)
    event.listen(engine, "handle_error", _say_no_room)
    engine.connect().close()
    return engine


_COMPILED: LRUCache[Any, Any] = LRUCache(1000)


def _share(engine: Engine) -> None:
    """Let a file's engine take statements that were compiled for another one: they are kept by dialect."""
    engine.dialect = _common().dialect
    engine.update_execution_options(compiled_cache=_COMPILED)


class DatabaseFileError(KourosError):
    """The file of the database cannot be read or written: the disk is full, or another program holds it."""

    exit_code = 1


class DamagedDatabaseError(KourosError):
    """The file of the database is damaged, so that SQLite itself cannot make sense of it."""

    exit_code = 5


def _damaged(file: str, problem: object) -> DamagedDatabaseError:
    return DamagedDatabaseError(
        f"the database {file} is damaged ({problem}): restore it from a backup, and see whether the disk is sound; "
        "what Kouros finds it finds again, but nobody else knows your decisions and your own measurements"
    )


_NO_SCHEMA = re.compile(r"no such (table|column)|could not decode to UTF-8|has no column named", re.IGNORECASE)
"""What SQLite says where its file holds other tables, or other bytes, than were written."""


def verify_file(engine: Engine, *, whole: bool = False) -> None:
    """Have SQLite look at the structure of its file; a server looks after its own.

    Parameters
    ----------
    engine : Engine
        Kouros's own database.
    whole : bool, optional
        Also whether every index of the large tables says what its table says, which takes twice as long.

    Raises
    ------
    DamagedDatabaseError
        Saying what is wrong.
    """
    if engine.dialect.name != "sqlite":
        return
    with engine.connect() as connection, damage_told(str(engine.url.database)):
        looks = ["integrity_check"] if whole else ["quick_check", *(f"integrity_check('{name}')" for name in _SMALL)]
        for look in looks:
            said = connection.exec_driver_sql(f"PRAGMA {look}").scalars().all()
            if said != ["ok"]:
                raise _damaged(str(engine.url.database), "; ".join(map(str, said[:3])))


@contextmanager
def damage_told(where: str | Path) -> Iterator[None]:
    """Turn what SQLite says of tables and texts that are not what was written into a `DamagedDatabaseError`."""
    try:
        yield
    except OperationalError as problem:
        if "://" in str(where) or not _NO_SCHEMA.search(str(problem.orig)):
            raise
        raise _damaged(str(where), problem.orig) from problem


_SMALL = (
    "item",
    "import_batch",
    "supplement",
    "decision",
    "run",
    "run_motion",
    "run_decision",
    "run_page",
    "run_chart",
)
"""Tables that are found by their indexes where nobody would miss a row; results and pages are made again."""


def _say_no_room(context: ExceptionContext) -> None:
    """Raise what a full disk is everywhere else for what SQLite says of it, what is damage, and what others hold."""
    problem, engine = context.original_exception, context.engine
    file = "" if engine is None else engine.url.database or ""
    # Of the extended codes the last eight bits are the kind.
    kind = getattr(problem, "sqlite_errorcode", 0) & 0xFF
    if kind in (sqlite3.SQLITE_CORRUPT, sqlite3.SQLITE_NOTADB):
        raise _damaged(file, problem) from problem
    if kind in (sqlite3.SQLITE_BUSY, sqlite3.SQLITE_LOCKED):
        raise DatabaseFileError(
            f"the database {file} is held by another program, and was for {PATIENCE_S:g} s: close what has it open, "
            "such as a viewer of databases or a backup, then run again"
        ) from problem
    if kind == sqlite3.SQLITE_FULL:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), file) from problem
    if kind in (sqlite3.SQLITE_IOERR, sqlite3.SQLITE_CANTOPEN) and os.access(file, os.R_OK | os.W_OK):
        remedy = "see that there is room on its disk, and that files can be made in its folder; then run again"
        raise DatabaseFileError(f"the database {file} cannot be written ({problem}): {remedy}") from problem


def open_for_reading(url: URL) -> Engine:
    """Open a database that is there so that nothing can be written to it, whoever tries, nor beside it.

    Parameters
    ----------
    url : URL
        Of the database.

    Returns
    -------
    Engine
        Of the file itself; where a process that died left a journal or a log of changes beside it, which SQLite would
        settle by writing, of a copy that goes with the engine.
    """
    if url.get_backend_name() == "sqlite":
        file = Path(str(url.database)).resolve()
        folder = _settled_apart(file) if _unsettled(file) else None
        there = file if folder is None else Path(folder.name) / file.name
        # A file whose changes go to a log of their own is locked by files beside it: without one, nobody is at work.
        mode = "ro&immutable=1" if folder is None and _is_logged(file) else "ro"
        where = f"file:{quote(str(there))}?mode={mode}"
        lite = create_engine(
            url, poolclass=NullPool, creator=lambda: sqlite3.connect(where, timeout=PATIENCE_S, uri=True)
        )
        _share(lite)
        if folder is not None:
            weakref.finalize(lite, folder.cleanup)
        return lite
    engine = create_engine(url, poolclass=NullPool)

    @event.listens_for(engine, "connect")
    def _shut(connection: Any, _record: Any) -> None:
        connection.read_only = True

    return engine


def _is_logged(file: Path) -> bool:
    """Say whether a file is in SQLite's mode WAL (bytes 18 and 19 of its header)."""
    with file.open("rb") as stream:
        return stream.read(20)[18:] == b"\x02\x02"


def _unsettled(file: Path) -> bool:
    log = file.with_name(f"{file.name}-wal")
    if log.is_file() and log.stat().st_size:
        return True
    if not file.with_name(f"{file.name}-journal").is_file():
        return False
    # A journal is a living process's, or one that died left it: only SQLite's own locks tell.
    probe = sqlite3.connect(f"file:{quote(str(file))}?mode=ro", uri=True, timeout=PATIENCE_S)
    try:
        probe.execute("SELECT count(*) FROM sqlite_master").fetchone()
    except sqlite3.OperationalError:
        return True
    finally:
        probe.close()
    return False


def _settled_apart(file: Path) -> "TemporaryDirectory[str]":
    """Copy a file with what lies beside it, and have SQLite settle the copy."""
    folder = TemporaryDirectory(prefix="kouros-reading-")
    try:
        for name in (file.name, f"{file.name}-wal", f"{file.name}-journal"):
            if file.with_name(name).is_file():
                shutil.copyfile(file.with_name(name), Path(folder.name) / name)
        copy = sqlite3.connect(Path(folder.name) / file.name)
        try:
            copy.execute("PRAGMA journal_mode = DELETE").fetchone()
        finally:
            copy.close()
    except BaseException:
        folder.cleanup()
        raise
    return folder


def _same_file(file: Path, _connection: Any, record: Any, _proxy: Any) -> None:
    """Have a kept connection opened again where another file has taken the place of its own, as a backup does."""
    try:
        there = file.stat()
    except FileNotFoundError:
        there = None
    now = None if there is None else (there.st_dev, there.st_ino)
    if record.info.setdefault("file", now) != now:
        raise DisconnectionError


def _prepare_sqlite(connection: Any, _record: Any) -> None:
    cursor = connection.cursor()
    cursor.execute("PRAGMA foreign_keys = ON")
    cursor.execute(f"PRAGMA busy_timeout = {round(PATIENCE_S * 1000)}")
    cursor.close()
