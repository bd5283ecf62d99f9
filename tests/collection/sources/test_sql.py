"""A museum's database is read in one snapshot, never written, and no message holds its password."""

from __future__ import annotations

import gc
import sqlite3
import threading
import time
from collections.abc import Iterator
from datetime import date, datetime
from decimal import Decimal
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from psycopg import ServerCursor
from sqlalchemy import Connection, Engine, make_url, text

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources import sql
from pipeline.collection.sources.rows import Row, as_text
from pipeline.collection.sources.sql import FETCH, read_database

from .conftest import Museum

# ---------------------------------------------------------------------------------------------------------------------
# Rows


def test_a_table_is_read_in_the_order_of_its_numbers(museum: Museum) -> None:
    header, *rows = museum.read(table="objects", columns=["height", "number"], order_by="number")
    assert header == Row(0, 0, ["height", "number"])
    assert len(rows) == 3 * FETCH
    assert rows[4] == Row(5, 5, ["0.5", "N 0004"])
    assert [row.cells[1] for row in rows] == sorted(row.cells[1] for row in rows)
    assert [row.cells[0] for row in museum.read(table="objects")[1:]] == [row.cells[1] for row in rows]  # by its key


def test_a_query_has_its_own_order_and_its_percent_and_colon_signs(museum: Museum) -> None:
    rows = museum.read(
        query="SELECT number, ':a %s %% ;' AS \"a;b\" FROM objects WHERE title LIKE 'Bust 1_' ORDER BY number DESC; "
    )
    assert rows[0].cells == ["number", "a;b"]
    assert [row.cells for row in rows[1:3]] == [["N 0019", ":a %s %% ;"], ["N 0018", ":a %s %% ;"]]
    assert len(rows) == 11


def test_a_view_is_as_good_as_a_table(museum: Museum) -> None:
    museum.run("CREATE VIEW shown AS SELECT number FROM objects WHERE height < 1")
    assert len(museum.read(table="shown", order_by="number")) == 1 + 8


def test_one_of_query_and_table(museum: Museum) -> None:
    museum.refused("needs either a query or a table")
    museum.refused("needs either a query or a table", query="SELECT 1", table="objects")


def test_rows_are_fetched_in_blocks(museum: Museum) -> None:
    """The whole of ten million rows would be some GB and take minutes: the first is there at once."""
    begin = time.perf_counter()
    rows = read_database(
        museum.url,
        query="WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n WHERE i < 10000000) SELECT i FROM n",
    )
    assert [next(rows).cells for _ in range(3)] == [["i"], ["1"], ["2"]]
    rows.close()  # type: ignore[attr-defined]
    assert time.perf_counter() - begin < 20
    assert museum.count() == 3 * FETCH


HOSTILE = (
    'a"b',
    "a'; DROP TABLE objects; --",
    "a]b`c",
    "%s %(x)s :y ?",
    "Größe ☃ 高さ",
    "SELECT",
    "a.b",
    "  ",
    "back\\slash",
    "new\nline",
    "x" * 63,
    "öä" * 15,
)


def test_hostile_names_come_back(museum: Museum) -> None:
    for name in HOSTILE:
        quoted = '"' + name.replace('"', '""') + '"'
        with museum.writer.begin() as connection:
            cursor: Any = connection.connection.cursor()
            cursor.execute(f"CREATE TABLE {quoted} ({quoted} INTEGER, other INTEGER)")
            cursor.execute(f"INSERT INTO {quoted} VALUES (1, 2)")  # noqa: S608
            cursor.close()
        rows = museum.read(table=name, columns=["other", name], order_by=name)
        assert [row.cells for row in rows] == [["other", name], ["2", "1"]]
        assert museum.count() == 3 * FETCH


def test_names_longer_than_the_server_keeps(postgresql_museum: Museum, sqlite_museum: Museum) -> None:
    """PostgreSQL cuts names at 63 bytes: the cut name is the one that there is. SQLite keeps all of them."""
    for museum in (postgresql_museum, sqlite_museum):
        with museum.writer.begin() as connection:
            connection.connection.cursor().execute(f'CREATE TABLE "{"t" * 100}" ("{"c" * 100}" INTEGER)')
    assert sqlite_museum.read(table="t" * 100, columns=["c" * 100])[0].cells == ["c" * 100]
    postgresql_museum.refused("has no table or view 'ttt", table="t" * 100)
    assert postgresql_museum.read(table="t" * 63)[0].cells == ["c" * 63]


def test_schemas(postgresql_museum: Museum) -> None:
    postgresql_museum.run(
        'CREATE SCHEMA "a.b; --"', 'CREATE TABLE "a.b; --"."c.d" (n INTEGER)', 'INSERT INTO "a.b; --"."c.d" VALUES (7)'
    )
    assert postgresql_museum.read(table="a.b; --.c.d")[1].cells == ["7"]
    postgresql_museum.refused("has no table or view 'nowhere.c.d'", table="nowhere.c.d")


def test_tables_that_are_not_there(museum: Museum) -> None:
    for name in [
        "absent",
        "objects; DROP TABLE objects",
        'objects" --',
        "(SELECT 1)",
        "",
        "objects\x01",
        "main.absent",
    ]:
        assert "'objects'" in museum.refused("has no table or view", table=name)
        assert museum.count() == 3 * FETCH


def test_columns_that_are_not_there(museum: Museum) -> None:
    museum.refused(
        "objects has no column 'weight'; name one of its columns: 'number', 'title'",
        table="objects",
        columns=["weight"],
    )
    museum.refused("has no column '1; --'", table="objects", order_by="1; --")
    museum.refused("no such column: .*; see whether its name is right", query="SELECT weight FROM objects")
    museum.refused("no such table: .*; see whether", query="SELECT 1 FROM absent")
    header, *_ = museum.read(table="objects", columns=["number"], optional=["weight", "title"])
    assert header.cells == ["number", "title"]


# ---------------------------------------------------------------------------------------------------------------------
# Values


def test_values_of_postgresql(postgresql_museum: Museum) -> None:
    (_, row) = postgresql_museum.read(
        query="SELECT 79::float8, 79.10::numeric, true, null, date '2020-02-29', timestamp '2020-02-29 10:00:00', "
        "'a\tb', uuid '12345678-1234-5678-1234-567812345678', date '0044-03-15 BC', timestamp 'infinity', "
        "'\\x00ff'::bytea, array[1, 2], '{\"a\": 1}'::json, 'NaN'::float8, interval '1 day'"
    )
    assert row.cells[:10] == [
        "79", "79.1", "true", "", "2020-02-29", "2020-02-29T10:00:00", "a\tb", "12345678-1234-5678-1234-567812345678",
        "0044-03-15 BC", "infinity",
    ]  # fmt: skip
    assert row.cells[10:] == [""] * 5
    assert sorted(row.faults) == [10, 11, 12, 13, 14]
    assert row.faults[11] == (
        "cannot be read: a value of the kind list", "select it as a text or a number, or leave it out",
    )  # fmt: skip


def test_values_of_sqlite(sqlite_museum: Museum, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sql, "FIELD_LIMIT", 10)
    (_, row) = sqlite_museum.read(
        query="SELECT 79.0, 0.1, 5, NULL, 'a', x'00ff', CAST(x'61ff62' AS TEXT), char(0), 1e999, 'a text that is long'"
    )
    assert row.cells == ["79", "0.1", "5", "", "a", "", "", "", "", ""]
    assert {place: fault[0] for place, fault in row.faults.items()} == {
        5: "cannot be read: a value of the kind bytes",
        6: "holds a character that is none",
        7: "holds a character that is none",
        8: "cannot be read: inf is no number that was measured",
        9: "a text of more than 10 characters",
    }


def test_a_date_of_sqlite_is_the_text_that_it_holds(sqlite_museum: Museum) -> None:
    sqlite_museum.run("CREATE TABLE o (d DATE)", "INSERT INTO o VALUES ('about 1900'), ('2020-01-01')")
    assert [row.cells for row in sqlite_museum.read(table="o", order_by="d")[1:]] == [["2020-01-01"], ["about 1900"]]


TEXTS = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\x00"), max_size=40)


@settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(
    st.lists(
        st.tuples(
            TEXTS,
            st.integers(-(2**63), 2**63 - 1),
            st.floats(allow_nan=False, allow_infinity=False),
            st.none() | TEXTS,
        ),
        min_size=1,
        max_size=5,
    )
)
def test_values_come_back_as_the_same_texts(values_museum: Museum, rows: list[tuple[Any, ...]]) -> None:
    """What as_text makes of the values themselves is the truth."""
    with values_museum.writer.begin() as connection:
        connection.execute(text("DELETE FROM o"))
        insert(connection, rows)
    found = values_museum.read(table="o", columns=["t", "i", "f", "e"], order_by="n")
    assert [row.cells for row in found[1:]] == [[as_text(value) for value in row] for row in rows]
    assert not any(row.faults for row in found)


def insert(connection: Connection, rows: list[tuple[Any, ...]]) -> None:
    statement = text("INSERT INTO o VALUES (:n, :t, :i, :f, :e)")
    connection.execute(statement, [dict(zip("ntife", (n, *row), strict=True)) for n, row in enumerate(rows)])


@pytest.fixture(params=["sqlite", "postgresql"])
def values_museum(request: pytest.FixtureRequest) -> Museum:
    found: Museum = request.getfixturevalue(f"{request.param}_museum")
    found.run("CREATE TABLE o (n INTEGER PRIMARY KEY, t TEXT, i BIGINT, f DOUBLE PRECISION, e TEXT)")
    return found


@settings(max_examples=15, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(st.decimals(-(10**9), 10**9, allow_nan=False, places=6), st.dates(), st.datetimes(), st.booleans())
def test_exact_numbers_dates_and_flags(
    typed_museum: Museum, number: Decimal, day: date, moment: datetime, flag: bool
) -> None:
    with typed_museum.writer.begin() as connection:
        connection.execute(text("DELETE FROM p"))
        connection.execute(
            text("INSERT INTO p VALUES (:number, :day, :moment, :flag)"),
            {"number": number, "day": day, "moment": moment, "flag": flag},
        )
    assert typed_museum.read(table="p")[1].cells == [as_text(value) for value in (number, day, moment, flag)]


@pytest.fixture
def typed_museum(postgresql_museum: Museum) -> Museum:
    postgresql_museum.run("CREATE TABLE p (number NUMERIC, day DATE, moment TIMESTAMP, flag BOOLEAN)")
    return postgresql_museum


# ---------------------------------------------------------------------------------------------------------------------
# Nothing is written


def test_other_statements_are_refused(museum: Museum) -> None:
    for query in [
        "DELETE FROM objects",
        "  /* SELECT */ DROP TABLE objects",
        "EXPLAIN ANALYZE DELETE FROM objects",
        "PRAGMA user_version = 7",
        "ATTACH 'other.db' AS other",
        "",
    ]:
        museum.refused("the query must begin with SELECT or WITH", query=query)


def test_several_statements_are_refused(museum: Museum) -> None:
    for query in [
        "SELECT 1; DELETE FROM objects",
        "SELECT 1;; DROP TABLE objects;",
        "SELECT 'a''; b'; COMMIT; DELETE FROM objects; --'",
        "SELECT 'a\\'; DELETE FROM objects; --'",
        "SELECT 1 --'\n; DELETE FROM objects --'",
        "SELECT /* ' */ 1; DELETE FROM objects /* ' */",
        "SELECT $$'$$; DELETE FROM objects; SELECT $$'$$",
    ]:
        museum.refused("one statement only", query=query)
        assert museum.count() == 3 * FETCH


WRITES = {
    "sqlite": (
        "WITH x AS (SELECT 1) DELETE FROM objects",
        "WITH x AS (SELECT 1) INSERT INTO objects SELECT 'Z', 'z', 1 RETURNING number",
    ),
    "postgresql": (
        "WITH x AS (INSERT INTO objects VALUES ('Z', 'z', 1) RETURNING number) SELECT * FROM x",
        "WITH x AS (SELECT 1) DELETE FROM objects RETURNING number",
        "SELECT * INTO copied FROM objects",
        "SELECT setval('counted', 7)",
        "SELECT wipe()",
        "SELECT set_config('transaction_read_only', 'off', true), wipe()",
        "SELECT lo_create(7)",
    ),
}


def test_the_transaction_cannot_write(museum: Museum) -> None:
    kind = make_url(museum.url).get_backend_name()
    if kind == "postgresql":
        museum.run(
            "CREATE SEQUENCE counted",
            "CREATE FUNCTION wipe() RETURNS integer LANGUAGE sql VOLATILE AS 'DELETE FROM objects; SELECT 1'",
        )
    for query in WRITES[kind]:
        # Some fail as writing, some as no cursor's statement: what counts is that all fail and nothing changes.
        museum.refused("would write|cannot be read", query=query)
        assert museum.count() == 3 * FETCH
    if kind == "postgresql":
        with museum.writer.connect() as connection:
            assert connection.execute(text("SELECT is_called FROM counted")).scalar_one() is False
            assert connection.execute(text("SELECT to_regclass('copied')")).scalar_one() is None


def test_a_file_of_sqlite_is_left_as_it_was(sqlite_museum: Museum, tmp_path: Path) -> None:
    sqlite_museum.run("CREATE TABLE o (n INTEGER)")
    path = Path(make_url(sqlite_museum.url).database or "")
    before = path.read_bytes()
    sqlite_museum.read(table="o")
    assert path.read_bytes() == before
    assert [each.name for each in tmp_path.iterdir()] == [path.name]


# ---------------------------------------------------------------------------------------------------------------------
# One snapshot


def test_what_others_write_meanwhile_is_not_seen(museum: Museum) -> None:
    """A writer renames every object after the first block; SQLite lets one write beside a reader in its WAL mode."""
    if make_url(museum.url).get_backend_name() == "sqlite":
        with museum.writer.connect() as connection:
            connection.exec_driver_sql("PRAGMA journal_mode = WAL")
    rows = read_database(museum.url, table="objects", columns=["title"], order_by="number")
    seen = [next(rows).cells[0] for _ in range(2)]
    museum.run("UPDATE objects SET title = 'changed'", "DELETE FROM objects WHERE number > 'N 0300'")
    seen += [row.cells[0] for row in rows]
    assert seen[1:] == [f"Bust {n}" for n in range(3 * FETCH)]
    assert museum.count() == 301


def test_the_snapshot_begins_before_the_query(postgresql_museum: Museum, monkeypatch: pytest.MonkeyPatch) -> None:
    postgresql_museum.run("CREATE TABLE o (n INTEGER)", "INSERT INTO o VALUES (1)")
    check = sql._check_query

    def write_meanwhile(query: str, address: Any) -> None:
        check(query, address)
        postgresql_museum.run("INSERT INTO o VALUES (2)")

    monkeypatch.setattr(sql, "_check_query", write_meanwhile)
    assert len(postgresql_museum.read(query="SELECT n FROM o")) == 2


def test_a_file_that_another_program_writes(sqlite_museum: Museum, monkeypatch: pytest.MonkeyPatch) -> None:
    sqlite_museum.run("CREATE TABLE o (n INTEGER)")
    monkeypatch.setattr(sql, "LOCK_SECONDS", 0.2)
    writer = sqlite3.connect(make_url(sqlite_museum.url).database or "", isolation_level=None, check_same_thread=False)
    writer.execute("BEGIN EXCLUSIVE")
    sqlite_museum.refused("another program writes to it: database is locked; read when that program is done", table="o")
    monkeypatch.setattr(sql, "LOCK_SECONDS", 10.0)
    release = threading.Timer(0.3, lambda: writer.execute("COMMIT"))
    release.start()
    assert len(sqlite_museum.read(table="o")) == 1  # waited for
    release.join()
    writer.close()


# ---------------------------------------------------------------------------------------------------------------------
# What goes wrong on the way


def test_time_is_limited_on_the_server(postgresql_museum: Museum) -> None:
    begin = time.perf_counter()
    postgresql_museum.refused("more time was needed", query="SELECT pg_sleep(30)", timeout_seconds=0.5)
    assert time.perf_counter() - begin < 10


def test_time_is_limited_in_sqlite(sqlite_museum: Museum) -> None:
    sqlite_museum.run("CREATE TABLE o (n INTEGER)")
    endless = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT count(*) FROM n"
    begin = time.perf_counter()
    sqlite_museum.refused("more time was needed", query=endless, timeout_seconds=0.5)
    assert time.perf_counter() - begin < 10


def test_time_is_limited_over_all_blocks(museum: Museum) -> None:
    rows = read_database(museum.url, table="objects", order_by="number", timeout_seconds=1.0)
    for _ in range(FETCH + 1):
        next(rows)
    time.sleep(1.1)
    with pytest.raises(CollectionError, match=f"after row {FETCH}: .*more time was needed|after row {FETCH}: the conn"):
        list(rows)
    # The server has ended the idle connection; the driver's cursor is closed all the same.
    assert all(each.closed for each in gc.get_objects() if issubclass(type(each), ServerCursor))


def test_a_server_that_goes_away(postgresql_museum: Museum, server: Engine) -> None:
    postgresql_museum.run("CREATE TABLE o AS SELECT generate_series(1, 5000) AS n")
    rows = read_database(postgresql_museum.url, table="o", order_by="n")
    for _ in range(FETCH):
        next(rows)
    ended = text("SELECT count(pg_terminate_backend(pid)) FROM pg_stat_activity WHERE application_name = 'kouros'")
    with server.connect() as connection:
        assert connection.execute(ended).scalar_one() == 1
    with pytest.raises(CollectionError, match=f"after row {FETCH}: the connection was lost: .*read again") as caught:
        list(rows)
    assert caught.value.exit_code == 5


def test_no_transaction_is_left_behind(postgresql_museum: Museum, server: Engine) -> None:
    postgresql_museum.run("CREATE TABLE o AS SELECT generate_series(1, 5000) AS n")
    rows = read_database(postgresql_museum.url, table="o")
    next(rows)
    rows.close()  # type: ignore[attr-defined]
    open_ones = text("SELECT count(*) FROM pg_stat_activity WHERE application_name = 'kouros' AND state <> 'idle'")
    with server.connect() as connection:
        for _ in range(50):  # the server notices a closed connection a moment later
            if not connection.execute(open_ones).scalar_one():
                return
            time.sleep(0.1)
    pytest.fail("the connection is still open")


def test_files_that_are_none(tmp_path: Path) -> None:
    def refused(url: str, match: str) -> None:
        with pytest.raises(CollectionError, match=match):
            list(read_database(url, query="SELECT 1"))

    (tmp_path / "text.db").write_text("number,title\n" * 100)
    refused(f"sqlite:///{tmp_path}/text.db", "it is no SQLite file, or an encrypted one")
    refused(f"sqlite:///{tmp_path}/absent.db", "there is no such file")
    assert not (tmp_path / "absent.db").exists()
    refused("sqlite://", "there is no such file")
    refused("nosuch://host/db", "no such kind of database is known")
    refused("mssql+pyodbc://host/db", "the driver for this kind of database is not installed .*pyodbc")
    refused("not an address", r"write it as kind://user:\$\{PASSWORD\}@host/database")


def test_databases_of_another_kind_are_read_with_what_sqlalchemy_offers(
    postgresql_museum: Museum, monkeypatch: pytest.MonkeyPatch
) -> None:
    """PostgreSQL as if Kouros knew nothing of it: still a snapshot, and rolled back."""
    monkeypatch.setattr(sql, "_GUARDS", {})
    postgresql_museum.run("CREATE TABLE objects (n INTEGER)", "INSERT INTO objects SELECT generate_series(1, 1000)")
    url = postgresql_museum.url.replace("postgresql:", "postgresql+psycopg:", 1)
    rows = read_database(url, query="SELECT n, current_setting('transaction_isolation') FROM objects")
    assert [next(rows).cells for _ in range(2)][1] == ["1", "repeatable read"]
    postgresql_museum.run("DELETE FROM objects")
    assert len(list(rows)) == 999
    assert postgresql_museum.count() == 0
    with pytest.raises(CollectionError, match=f"after row {FETCH}: more time was needed"):
        list(Slow(url))


class Slow:
    """A reader that takes its time with the first block."""

    def __init__(self, url: str) -> None:
        self._url = url

    def __iter__(self) -> Iterator[Row]:
        rows = read_database(self._url, query="SELECT generate_series(1, 1000)", timeout_seconds=0.3)
        yield next(rows)
        time.sleep(0.4)
        yield from rows
