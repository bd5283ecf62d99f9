"""A fresh, migrated database for each test: once SQLite in a file, once PostgreSQL."""

from collections.abc import Callable, Iterator
from pathlib import Path
from uuid import uuid4

import pytest
from sqlalchemy import URL, Engine, create_engine, make_url, text

from pipeline.collection.database import database_url, open_database
from pipeline.store.migrate import upgrade
from tests.museum import with_tables


@pytest.fixture(scope="session")
def tables_on_server(postgresql_databases: Callable[[], str]) -> str:
    """The name of a database on the server in which all tables are, and no row."""
    engine = open_database(postgresql_databases())
    upgrade(engine)
    engine.dispose()
    return str(engine.url.database)


@pytest.fixture(params=["sqlite", "postgresql"])
def empty_url(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[URL]:
    """A database without tables."""
    if request.param == "sqlite":
        yield database_url(tmp_path / "kouros.db")
        return
    server = database_url(str(make_url(request.getfixturevalue("postgresql_url")).render_as_string(False)))
    name = f"store_{uuid4().hex}"
    # Whoever wants the tables gets a copy of a database that has them: to make them takes most of such a test.
    like = request.getfixturevalue("tables_on_server") if "engine" in request.fixturenames else "template1"
    administrator = create_engine(server, isolation_level="AUTOCOMMIT")
    with administrator.connect() as connection:
        connection.execute(text(f"CREATE DATABASE {name} TEMPLATE {like}"))
    yield server.set(database=name)
    with administrator.connect() as connection:
        connection.execute(text(f"DROP DATABASE {name} WITH (FORCE)"))
    administrator.dispose()


@pytest.fixture
def empty(empty_url: URL) -> Iterator[Engine]:
    engine = open_database(empty_url.render_as_string(hide_password=False))
    yield engine
    engine.dispose()


@pytest.fixture
def engine(empty: Engine) -> Engine:
    if empty.dialect.name == "sqlite":
        with_tables(Path(str(empty.url.database)))
    upgrade(empty)
    return empty
