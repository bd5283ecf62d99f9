"""Secrets of a database's address come from the environment, and go into no message."""

from __future__ import annotations

import time
import traceback
import uuid
from collections.abc import Iterator
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from sqlalchemy import make_url, text

from pipeline.collection.errors import CollectionError
from pipeline.collection.sources.address import expand_secrets
from tests.soak import examples

from .conftest import Museum

SECRET = "p@ss/w:rd %41'x"


def test_secrets_come_from_the_environment_only() -> None:
    environment = {"USER_1": "reader", "PASSWORD": SECRET, "HOST": "db.example.org", "DB": "museum/2"}
    address = expand_secrets("postgresql://${USER_1}:${PASSWORD}@${HOST}:5432/${DB}?options=${PASSWORD}", environment)
    url = address.url
    assert (url.username, url.password, url.host, url.port) == ("reader", SECRET, "db.example.org", 5432)
    assert (url.database, url.query["options"]) == ("museum/2", SECRET)
    assert address.shown == "postgresql://${USER_1}:***@${HOST}:5432/${DB}"
    for said in (repr(address), str(address), f"{address}"):
        assert said == "Address('postgresql://${USER_1}:***@${HOST}:5432/${DB}')"
    whole = expand_secrets("${DATABASE}", {"DATABASE": "postgresql://reader:geheim@host/db"})
    assert (whole.url.password, whole.shown) == ("geheim", "${DATABASE}")
    assert "geheim" not in repr(whole)


def test_addresses_that_cannot_be_expanded() -> None:
    word = "gehe" + "im"  # in two parts: a traceback shows the lines of this file
    for url, match in (
        ("postgresql://reader:${ABSENT}@host/db", r"names \$\{ABSENT\}, which the environment lacks"),
        ("${ABSENT}", r"names \$\{ABSENT\}, which the environment lacks"),
        ("postgresql://reader:${A B}@host/db", r"a \$\{ that is no"),
        (f"postgresql//{word}", "cannot be read; write it as"),
        (f"postgresql://reader:{word}@host:port/db", "cannot be read; write it as"),
        ("${BROKEN}", "cannot be read; write it as"),
    ):
        with pytest.raises(CollectionError, match=match) as caught:
            expand_secrets(url, {"BROKEN": word})
        assert word not in "".join(traceback.format_exception(caught.value))


@settings(max_examples=examples(100), deadline=None)
@given(st.text(st.characters(exclude_categories=["Cs"]), min_size=6, max_size=30))
def test_no_password_is_ever_in_a_message(password: str) -> None:
    address = expand_secrets("mysql://reader:${P}@host/db?ssl_key=${P}", {"P": password})
    assert address.url.password == password
    for message in (password, f"failed for {password!r}", f"dsn://reader:{password}@host", f"PWD={password};x"):
        assert password not in address.clean(message)


def test_what_looks_like_a_password_is_cleaned_too() -> None:
    address = expand_secrets("mssql+pyodbc:///?odbc_connect=DRIVER%3Dx%3BPWD%3Dgeheim", {})
    assert "geheim" not in address.shown
    for said in ("DRIVER=x;PWD=geheim", "Pwd = 'geheim'", "x://reader:geheim@host", 'password: "geheim"'):
        assert "geheim" not in address.clean(f"login failed ({said})")


@pytest.fixture
def guarded(postgresql_museum: Museum) -> Iterator[Museum]:
    """A server that asks for a password."""
    with postgresql_museum.writer.connect() as connection:
        rules = Path(connection.execute(text("SHOW hba_file")).scalar_one())
    before = rules.read_text()
    role = f"reader_{uuid.uuid4().hex[:8]}"
    rules.write_text(f"local all {role} scram-sha-256\nhost all {role} all scram-sha-256\n{before}")
    quoted = "'" + SECRET.replace("'", "''") + "'"
    postgresql_museum.run(
        "CREATE TABLE o (n INTEGER)",
        f"CREATE ROLE {role} LOGIN PASSWORD {quoted}".replace("%", "%%"),
        "SELECT pg_reload_conf()",
    )
    url = make_url(postgresql_museum.url).set(username=role, password="x")
    yield Museum(
        url.render_as_string(hide_password=False).replace(":x@", ":${MUSEUM_PASSWORD}@"), postgresql_museum.writer
    )
    postgresql_museum.run(f"DROP ROLE {role}")
    rules.write_text(before)
    postgresql_museum.run("SELECT pg_reload_conf()")


def test_a_wrong_password_and_no_permission(guarded: Museum, monkeypatch: pytest.MonkeyPatch) -> None:
    for _ in range(50):  # until the server has read its rules again
        monkeypatch.setenv("MUSEUM_PASSWORD", "never " + SECRET)
        try:
            guarded.read(query="SELECT 1")
        except CollectionError:
            break
        time.sleep(0.1)
    with pytest.raises(CollectionError, match=r"does not let Kouros in: .*password authentication failed") as caught:
        guarded.read(query="SELECT 1")
    said = "".join(traceback.format_exception(caught.value))
    assert SECRET not in said
    assert "***@" in str(caught.value)
    monkeypatch.setenv("MUSEUM_PASSWORD", SECRET)
    assert guarded.read(query="SELECT 1")[1].cells == ["1"]
    guarded.refused("does not let Kouros in: permission denied for table o", table="o")
    monkeypatch.delenv("MUSEUM_PASSWORD")
    guarded.refused(r"names \$\{MUSEUM_PASSWORD\}, which the environment lacks", table="o")
