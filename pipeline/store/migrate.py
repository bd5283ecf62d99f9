"""Bring the tables of Kouros's own database to the form that this version of the code knows."""

import re
from pathlib import Path

from sqlalchemy import Connection, Engine, inspect, text
from sqlalchemy.exc import SQLAlchemyError

from pipeline.resources import resource
from pipeline.store.codec import StoreError

_LOCK = 1_263_490_899
"""Any number will do for PostgreSQL's advisory lock, as long as every Kouros takes the same one."""


def revisions() -> tuple[str, ...]:
    """Return the revisions that this version knows, oldest first; the last one is the head.

    A file of ``schemas/migrations/versions`` begins with its revision, four digits that count up.

    Raises
    ------
    FileNotFoundError
        Where the migrations are not installed.
    """
    found = (re.match(r"(\d{4})_\w+\.py$", path.name) for path in _folder().joinpath("versions").iterdir())
    return tuple(sorted(match[1] for match in found if match))


def current(engine: Engine) -> str | None:
    """Return the revision of the database, None where it has no tables of Kouros yet.

    Raises
    ------
    StoreError
        Where the database cannot be read.
    """
    try:
        with engine.connect() as connection:
            return _current(connection)
    except SQLAlchemyError as error:
        said = getattr(error, "orig", None) or error
        raise StoreError(
            f"{_where(engine)} cannot be read: {said}; see that its server runs, and that it can be reached from here"
        ) from error


def upgrade(engine: Engine) -> None:
    """Make or change the tables so that they are those of this version; at head, one look and no more.

    All of it happens in one transaction that other processes wait for: a failure leaves the database as it was.

    Parameters
    ----------
    engine : Engine
        From `collection.database.open_database`.

    Raises
    ------
    StoreError
        Where the database was made by a newer Kouros, or a migration fails.
    """
    known = revisions()
    if refuse_newer(engine, current(engine), known) == known[-1]:
        return
    # Only here, because alembic is slow to import and the tables are nearly always at head.
    from alembic import command
    from alembic.config import Config
    from alembic.util import CommandError

    config = Config()
    config.set_main_option("script_location", str(_folder()).replace("%", "%%"))
    try:
        with engine.begin() as connection:
            _wait_for_others(connection)
            if refuse_newer(engine, _current(connection), known) == known[-1]:
                return
            config.attributes["connection"] = connection
            command.upgrade(config, "head")
    except (SQLAlchemyError, CommandError) as error:
        raise StoreError(
            f"{_where(engine)} could not be brought to revision {known[-1]} and stays as it was: {error}; "
            "restore a backup, or name an empty database in kouros.toml"
        ) from error


class OtherVersionError(StoreError):
    """The tables are those of another version of Kouros."""


def require_head(engine: Engine) -> None:
    """Refuse a database whose tables are not those of this version, without changing it.

    Raises
    ------
    OtherVersionError
    """
    known, there = revisions(), current(engine)
    if there != known[-1]:
        raise OtherVersionError(
            f"{_where(engine)} has tables of revision {there}, this version of Kouros has {known[-1]}: `kouros check "
            "--migrate` brings them up to date; keep a copy of the database"
        )


def refuse_newer(engine: Engine, revision: str | None, known: tuple[str, ...]) -> str | None:
    """Return the revision of the database, if this version knows it, or there is none.

    Raises
    ------
    StoreError
        Where a newer Kouros made it.
    """
    if revision is not None and revision not in known:
        raise StoreError(
            f"{_where(engine)} has the revision {revision!r}, which this version of Kouros does not know "
            f"(its newest is {known[-1]}): a newer Kouros made it; upgrade kouros on this machine"
        )
    return revision


def _folder() -> Path:
    return resource("schemas", "migrations")


def _where(engine: Engine) -> str:
    return f"the database {engine.url.render_as_string(hide_password=True)}"


def _current(connection: Connection) -> str | None:
    if not inspect(connection).has_table("alembic_version"):
        return None
    found: str | None = connection.execute(text("SELECT version_num FROM alembic_version")).scalar()
    return found


def _wait_for_others(connection: Connection) -> None:
    if connection.dialect.name == "sqlite":
        # Python's sqlite3 begins no transaction before a CREATE TABLE: begun by hand, it covers that, and others wait.
        connection.exec_driver_sql("BEGIN IMMEDIATE")
    else:
        connection.execute(text("SELECT pg_advisory_xact_lock(:key)"), {"key": _LOCK})
