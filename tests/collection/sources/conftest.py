"""A museum's database, as it writes it: an SQLite file, or a database on a real PostgreSQL server."""

from __future__ import annotations

import uuid
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from sqlalchemy import URL, Engine, create_engine, make_url, text
from sqlalchemy.pool import NullPool

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.rows import Row
from pipeline.collection.sources.sql import FETCH, read_database


class Museum:
    """A database with an object table, its address, and a way to write to it as the museum does."""

    def __init__(self, url: str, writer: Engine) -> None:
        self.url = url
        self.writer = writer

    def run(self, *statements: str) -> None:
        with self.writer.begin() as connection:
            for statement in statements:
                connection.exec_driver_sql(statement)

    def count(self) -> int:
        with self.writer.connect() as connection:
            return int(connection.execute(text("SELECT count(*) FROM objects")).scalar_one())

    def read(self, **options: Any) -> list[Row]:
        return list(read_database(self.url, **options))

    def refused(self, match: str, **options: Any) -> str:
        with pytest.raises(CollectionError, match=match) as caught:
            self.read(**options)
        return str(caught.value)


@pytest.fixture
def sqlite_museum(tmp_path: Path) -> Iterator[Museum]:
    url = URL.create("sqlite", database=str(tmp_path / "the museum's 100% & #1?.db"))
    writer = create_engine(url)
    with writer.connect() as connection:
        connection.exec_driver_sql("VACUUM")  # makes the file
    yield Museum(url.render_as_string(), writer)
    writer.dispose()


@pytest.fixture(scope="module")
def server(postgresql_url: str) -> Iterator[Engine]:
    """A database of this module's own."""
    given = make_url(postgresql_url).set(drivername="postgresql+psycopg")
    name = f"museum_{uuid.uuid4().hex}"
    administrator = create_engine(given, isolation_level="AUTOCOMMIT", poolclass=NullPool)
    with administrator.connect() as connection:
        connection.execute(text(f"CREATE DATABASE {name}"))
    engine = create_engine(given.set(database=name))
    yield engine
    engine.dispose()
    with administrator.connect() as connection:
        connection.execute(text(f"DROP DATABASE {name} WITH (FORCE)"))


@pytest.fixture
def postgresql_museum(server: Engine) -> Museum:
    """The same database, emptied."""
    # As a museum writes its address: without the name of the driver.
    url = server.url.set(drivername="postgresql").render_as_string(hide_password=False)
    found = Museum(url, server)
    found.run(
        'DROP SCHEMA IF EXISTS public, "a.b; --" CASCADE',
        "CREATE SCHEMA public",
        "GRANT USAGE ON SCHEMA public TO public",
    )
    return found


@pytest.fixture(params=["sqlite", "postgresql"])
def museum(request: pytest.FixtureRequest) -> Museum:
    found: Museum = request.getfixturevalue(f"{request.param}_museum")
    found.run("CREATE TABLE objects (number VARCHAR(80) PRIMARY KEY, title TEXT, height NUMERIC(8, 3))")
    with found.writer.begin() as connection:
        connection.execute(
            text("INSERT INTO objects VALUES (:n, :t, :h)"),
            [{"n": f"N {n:04}", "t": f"Bust {n}", "h": n / 8} for n in reversed(range(3 * FETCH))],
        )
    return found
