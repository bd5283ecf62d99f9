"""What crosses a border: code in stored files, names of files, policies of pages, passwords."""

from __future__ import annotations

import ast
import re
import unicodedata
import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import settings as trying
from hypothesis import strategies as st
from sqlalchemy import create_engine, inspect, make_url, text

from pipeline.collection.errors import MappingError
from pipeline.collection.mapping import load_mapping
from pipeline.motions.errors import MotionError
from pipeline.motions.manifest import load_manifest
from pipeline.motions.reading import LARGEST, open_traces
from pipeline.report import Language
from pipeline.report.files.manifest import _redirect
from pipeline.report.pages.landing import landing_page
from pipeline.report.text import slug
from pipeline.resources import SMALL, small_text
from pipeline.settings import SettingsError, load_settings
from tests.operations.conftest import environment
from tests.operations.conftest import museum as museum  # noqa: PLC0414 - fixtures
from tests.operations.conftest import shaking as shaking  # noqa: PLC0414
from tests.report.conftest import report as report  # noqa: PLC0414
from tests.soak import examples
from tests.warm import kouros_process

pytestmark = pytest.mark.slow_file

PACKAGE = Path(__file__).parents[2] / "pipeline"

RUNS_CODE = {"pickle", "cPickle", "dill", "cloudpickle", "marshal", "shelve", "joblib", "code", "pty"}
"""Modules whose files or functions run code that was stored."""

CALLS = {"eval", "exec", "compile", "__import__", "read_pickle", "to_pickle", "system", "popen"}
"""Functions that do; `re.compile` is another one."""

KNOWN = {
    ("execute/processes.py", "pickle"): "between processes of our own, through pipes, never in a file",
    ("collection/guessing/database.py", "compile"): "of a SELECT that is proposed, to text, by SQLAlchemy",
}
"""What looks like it and is not, and why."""


def trees() -> Iterator[tuple[str, ast.AST]]:
    for file in sorted(PACKAGE.rglob("*.py")):
        yield file.relative_to(PACKAGE).as_posix(), ast.parse(file.read_text(encoding="utf-8"))


def test_nothing_that_is_stored_is_code() -> None:
    """No pickle, no eval, no shell, no unverified certificate in the package; numba's own cache is numba's."""
    found = []
    for name, tree in trees():
        for node in ast.walk(tree):
            if isinstance(node, ast.Import | ast.ImportFrom):
                modules = [node.module or ""] if isinstance(node, ast.ImportFrom) else [one.name for one in node.names]
                found += [(name, module) for module in modules if module.split(".")[0] in RUNS_CODE]
            if isinstance(node, ast.Call):
                called = node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
                words = {word.arg: getattr(word.value, "value", None) for word in node.keywords}
                owner = getattr(getattr(node.func, "value", None), "id", "")
                found += [(name, called)] if called in CALLS and owner not in ("re", "platform") else []
                found += (
                    [(name, "allow_pickle")] if owner == "np" and called == "load" and words["allow_pickle"] else []
                )
                found += [(name, word) for word in ("shell", "allow_pickle") if words.get(word)]
                found += [(name, "verify")] if words.get("verify", True) is False else []
    assert set(found) == KNOWN.keys()


@trying(deadline=None, max_examples=examples(500))
@given(st.text(max_size=300), st.text(max_size=300))
def test_a_name_of_a_file_is_a_slug_and_a_hash_whatever_a_gallery_is_called(first: str, second: str) -> None:
    """Never a folder, never a reserved name, never longer than a file system takes, and no two alike."""
    name = slug(first)
    assert re.fullmatch(r"[a-z0-9][a-z0-9-]{0,59}-[0-9a-f]{8}", name)
    if first != second and unicodedata.normalize("NFC", first) != unicodedata.normalize("NFC", second):
        assert slug(second) != name


def policy(page: str) -> dict[str, str]:
    [content] = re.findall(r'<meta http-equiv="Content-Security-Policy" content="([^"]*)"/>', page)
    assert page.index("Content-Security-Policy") < page.index("<title>")
    parts = [part.strip().partition(" ") for part in content.replace("&#39;", "'").split(";")]
    return {name: value for name, _, value in parts}


def test_every_page_has_a_policy_that_lets_nothing_in(report: Path, tmp_path: Path) -> None:
    good = {"run_id": "r", "finished": "", "report": "r/index.html"}
    landing = landing_page({"state": "good", "since": "", "message": "", "last_good": good}, "Museum", Language())
    pages = [path.read_text(encoding="utf-8") for path in report.glob("*.html")]
    pages += [landing, _redirect(Path("r"), tmp_path / "latest.html").read_text(encoding="utf-8")]
    assert len(pages) > 6
    for page in pages:
        allowed = policy(page)
        assert allowed.pop("default-src") == allowed.pop("base-uri") == allowed.pop("form-action") == "'none'"
        assert re.fullmatch(r"('sha256-[A-Za-z0-9+/=]+')?", allowed.pop("script-src", ""))
        assert allowed in ({"style-src": "'unsafe-inline'", "img-src": "data:"}, {})


def test_a_settings_file_without_end_is_refused(tmp_path: Path) -> None:
    file = tmp_path / "kouros.toml"
    with file.open("wb") as stream:
        stream.truncate(SMALL + 1)
    with pytest.raises(SettingsError, match=r"more than 8,388,608 bytes.*its size"):
        load_settings(file)
    file.write_text("a = " + "[" * 100_000, encoding="utf-8")
    with pytest.raises(SettingsError, match="not valid TOML"):
        load_settings(file)
    file.write_bytes(b"[museum]\r\nname = 'x'\r\n")
    assert small_text(file) == "[museum]\nname = 'x'\n"


def test_every_other_input_without_end_is_refused_before_it_is_read(tmp_path: Path) -> None:
    """Sparse files, which take no room: a mapping, a manifest, a record of a motion."""
    mapping, manifest, record = (tmp_path / name for name in ("mapping.toml", "manifest.toml", "record.mseed"))
    for file, size in ((mapping, SMALL), (manifest, SMALL), (record, LARGEST)):
        with file.open("wb") as stream:
            stream.truncate(size + 1)
    with pytest.raises(MappingError, match=r"mapping\.toml: cannot be read: more than 8,388,608 bytes; .*size"):
        load_mapping(mapping)
    with pytest.raises(MotionError, match=r"manifest\.toml: .*more than 8,388,608 bytes"):
        load_manifest(tmp_path)
    with pytest.raises(MotionError, match=r"record\.mseed: .*268,435,457 bytes are more than a record has"):
        open_traces(record, [])


SECRET = "geheim-7f3a"


def everything(folder: Path) -> Iterator[tuple[str, bytes]]:
    """Yield all files below a folder, with what is packed in workbooks."""
    for path in folder.rglob("*"):
        if path.is_file():
            yield str(path), path.read_bytes()
            if path.suffix == ".xlsx":
                with zipfile.ZipFile(path) as packed:
                    yield from ((f"{path}/{name}", packed.read(name)) for name in packed.namelist())


def test_a_password_stands_nowhere(museum: Callable[..., Path], postgresql_url: str) -> None:
    """A night on PostgreSQL with a password in both addresses, then some that fail; all that is left is searched.

    The test's server lets everybody in, so that the password may be anything.
    """
    server = make_url(postgresql_url).set(drivername="postgresql+psycopg")
    maker = create_engine(server, isolation_level="AUTOCOMMIT")
    with maker.connect() as connection:
        # Other tests leave their inventories in the session's own.
        connection.execute(text("CREATE DATABASE borders"))
    maker.dispose()
    ours = make_url(postgresql_url).set(drivername="postgresql", password=SECRET, database="borders")
    theirs = (
        ours.set(password="${MUSEUM_PW}")
        .render_as_string(hide_password=False)
        .replace("%24%7BMUSEUM_PW%7D", "${MUSEUM_PW}")
    )
    admin = create_engine(server.set(database="borders"))
    with admin.begin() as connection:
        connection.execute(text("CREATE TABLE holdings (object_number text PRIMARY KEY, gallery text, height_m float)"))
        connection.execute(text("INSERT INTO holdings VALUES ('1', 'A', 0.4), ('2', 'A', 0.3)"))
    folder = museum(more='[logs]\nfile = "logs/kouros.jsonl"\n')
    file = folder / "kouros.toml"
    settings = file.read_text(encoding="utf-8").replace('source = "export.csv"', f'source = "{theirs}"')
    file.write_text(settings, encoding="utf-8")
    (folder / "mapping.toml").write_text(
        '[source]\nformat = "sql"\ntable = "holdings"\n[museum]\nname = "Test"\n'
        '[columns.object_number]\ncolumn = "object_number"\n[columns.gallery]\ncolumn = "gallery"\n'
        '[columns.height_m]\ncolumn = "height_m"\nunit = "m"\n',
        encoding="utf-8",
    )
    secret = {"KOUROS_DATABASE": ours.render_as_string(hide_password=False), "MUSEUM_PW": SECRET}
    dead = ours.set(host="127.0.0.1", port=9, query={})
    attempts = [
        (secret, ["--log-json", "-v", "run", "--json"], 0),
        (secret, ["check", "--json"], 0),
        (secret | {"KOUROS_DATABASE": dead.render_as_string(hide_password=False)}, ["run"], 2),
        (secret | {"KOUROS_DATABASE": f"postgresql://u:{SECRET}@host:port/x"}, ["--log-json", "run"], 2),
        (secret | {"KOUROS_DATABASE": f"nonsense://u:{SECRET}@host/x"}, ["check"], 2),
    ]
    for known, words, code in attempts:
        done = kouros_process(tuple(words), folder, environment(known))
        assert done.returncode == code, (words, done.stderr)
        assert SECRET not in done.stdout + done.stderr, words
    searched = list(everything(folder))
    assert any(name.endswith("kouros.jsonl") for name, _ in searched)
    assert any(name.endswith("status.json") for name, _ in searched)
    assert [name for name, data in searched if SECRET.encode() in data] == []
    with admin.connect() as connection:
        for table in inspect(connection).get_table_names():
            rows = connection.execute(text(f'SELECT t::text FROM "{table}" t')).scalars().all()  # noqa: S608
            assert not any(SECRET in row for row in rows), table
        assert connection.execute(text("SELECT count(*) FROM run")).scalar() == 1
    admin.dispose()
