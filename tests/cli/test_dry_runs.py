"""A dry run of any verb leaves everything byte for byte as it was, and says what the real one then does."""

from __future__ import annotations

import hashlib
import shutil
import sqlite3
import subprocess
import sys
import warnings
from collections.abc import Sequence
from contextlib import chdir
from pathlib import Path

import click
import pytest
from alembic.command import upgrade
from alembic.config import Config
from click.testing import CliRunner
from sqlalchemy import create_engine, inspect, text

from pipeline.cli import kouros
from pipeline.cli.commands import ALL
from pipeline.collection.database import database_url, open_database, open_for_reading
from pipeline.collection.inventory import versions
from pipeline.errors import KourosError
from pipeline.motions import read_motion
from pipeline.operations.dry_run import NOTHING
from pipeline.resources import resource
from pipeline.settings import KEPT
from pipeline.store.migrate import revisions
from pipeline.tools.synthetic import synthesise
from tests.museum import COLUMNS, OF_MOTIONS, ROWS, workspace

pytestmark = pytest.mark.slow_file

MORE = [*ROWS, "4,B,Cup,0.1,0.08,0.08"]
SHEET = "object_number,gallery,height_m,mass_kg\n3,B,0.31,2\n9,B,0.2,\n"

LEFT = pytest.mark.long("test_looking_writes_nothing_beside_a_database_either")

Said = tuple[int, str, str]
"""Exit code, what was printed, and the error or the warnings."""


def say(folder: Path, *words: str) -> Said:
    """Run a command in a folder, in this process."""
    with chdir(folder), warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always")
        done = CliRunner().invoke(kouros, ["-q", *words])
    problem = done.exception
    if problem is None or isinstance(problem, SystemExit):
        return done.exit_code, done.stdout, done.stderr + "".join(str(w.message) for w in warned)
    assert isinstance(problem, KourosError), f"{words}: {problem!r}"
    return problem.exit_code, done.stdout, str(problem)


def digest(folder: Path) -> dict[str, str]:
    """What is in a folder: of each file a hash, of each link where it points; times are left out."""
    found = {}
    for path in sorted(folder.rglob("*")):
        name = path.relative_to(folder).as_posix()
        if path.is_symlink():
            found[name] = f"-> {path.readlink()}"
        else:
            found[name] = "folder" if path.is_dir() else hashlib.sha256(path.read_bytes()).hexdigest()
    return found


@pytest.fixture(scope="module")
def museum(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A museum after two nights, with a decision, a newer export, a sheet, and reports beyond [retention]."""
    folder = tmp_path_factory.mktemp("museum")
    synthesise("sine", ["amplitude=1.2", "frequency=2", "cycles=2"], folder / "shaking")
    workspace(folder, site="shaking", sampled=True)
    for name in ("run", "run"):
        assert say(folder, name)[0] == 0
    assert say(folder, "decide", "1", "accept", "--why", "a test", "--who", "A")[0] == 0
    # A folder that all tests have in common cannot tell who wrote there.
    hashes = {motion.hash[:16] for motion in read_motion(folder / "shaking")}
    for kept in (folder / KEPT / kind for kind in OF_MOTIONS):
        common = kept.resolve()
        kept.unlink()
        kept.mkdir()
        for file in common.glob("*.kept"):
            if any(hash_ in file.name for hash_ in hashes):
                shutil.copyfile(file, kept / file.name)
    settings = folder / "kouros.toml"
    lines = settings.read_text("utf-8").replace("runs = 0", "runs = 1").replace("reports = 0", "reports = 1")
    settings.write_text(lines, encoding="utf-8")
    (folder / "export.csv").write_text("\n".join([COLUMNS, *MORE]) + "\n", encoding="utf-8")
    (folder / "short.csv").write_text("\n".join([COLUMNS, ROWS[0]]) + "\n", encoding="utf-8")
    (folder / "sheet.csv").write_text(SHEET, encoding="utf-8")
    (folder / "wrong.csv").write_text("object_number,gallery,height_m\n9,B,0.2\n", encoding="utf-8")
    # Columns in centimetres beside texts that say inches, in every row.
    rows = [f"{at},A,Vase,{at + 20},{at + 5},{at + 20} x {at + 5} in." for at in range(60)]
    (folder / "other.csv").write_text("\n".join(["n,room,title,h,w,size", *rows]) + "\n", encoding="utf-8")
    fields = (
        '[columns]\nobject_number = { column = "n" }\ngallery = { column = "room" }\ntitle = { column = "title" }\n'
    )
    sizes = "".join(f'{name}_m = {{ column = "{name[0]}", unit = "cm" }}\n' for name in ("height", "width"))
    source = '[source]\nformat = "csv"\nencoding = "utf-8"\ndelimiter = ","\n[museum]\nname = "T"\n'
    texts = '[dimensions]\ncolumns = ["size"]\n'
    (folder / "other.toml").write_text(source + fields + sizes + texts, encoding="utf-8")
    # What is added shakes in all three directions: a channel of zeros is refused as dead.
    state, head, *lines = (folder / "shaking" / "motion-1.csv").read_text("utf-8").splitlines()
    alive = [",".join([at, x, x, x]) for at, x, *_ in (line.split(",") for line in lines)]
    (folder / "alive.csv").write_text("\n".join([state, head, *alive]) + "\n", encoding="utf-8")
    manifest = folder / "shaking" / "manifest.toml"
    asked = folder / "asked"
    shutil.copytree(folder / "shaking", asked)
    lines = [line for line in manifest.read_text("utf-8").splitlines() if "cut_off" not in line]
    (asked / "manifest.toml").write_text("\n".join(lines) + "\n", encoding="utf-8")
    engine = create_engine(f"sqlite:///{folder / 'tms.sqlite'}")
    with engine.begin() as connection:
        connection.execute(text("CREATE TABLE things (object_number TEXT, gallery TEXT, title TEXT)"))
        connection.execute(text("INSERT INTO things VALUES ('a', 'A', 'Bowl'), ('b', 'B', 'Jar')"))
    engine.dispose()
    sql = '[source]\nformat = "sql"\ntable = "things"\n[museum]\nname = "T"\n'
    columns = "".join(f'[columns.{name}]\ncolumn = "{name}"\n' for name in ("object_number", "gallery", "title"))
    (folder / "tms.toml").write_text(sql + columns, encoding="utf-8")
    return folder


CONVERT = ["motions", "convert", "shaking/motion-1.csv", "--columns", "time,ew,-,-"]
DRY: Sequence[tuple[Sequence[str], int, str]] = (
    (["import", "export.csv"], 0, "inventory: 4 objects (1 new, 0 gone, 0 changed)"),
    (["import", "export.csv", "--json"], 0, '"added": 1'),
    (["import", "short.csv"], 7, "67% fewer, above the limit of 20%"),
    (["import", "short.csv", "--shrink-limit", "1"], 0, "(0 new, 2 gone, 0 changed)"),
    (["import", "absent.csv"], 5, "absent.csv"),
    (["import", "sqlite:///tms.sqlite", "--mapping", "tms.toml"], 7, "2 usable objects"),
    (["import", "sqlite:///tms.sqlite", "--mapping", "tms.toml", "--shrink-limit", "1"], 0, "2 objects (2 new, 3 gone"),
    (["import", "other.csv", "--mapping", "other.toml", "--shrink-limit", "1"], 5, '[holds] texts = "columns" or'),
    (["import", "sheet.csv", "--sheet"], 0, "sheet.csv: 1 object"),
    (["import", "wrong.csv", "--sheet"], 5, "no row fills in anything for an object of the inventory"),
    (["import", "--return-to", "1"], 0, "3 objects, as after import 1 (0 new, 0 gone, 0 changed)"),
    (["import", "--return-to", "7"], 5, "the inventory has no version 7"),
    (["import", "--versions"], 0, "3 objects"),
    (["import", "--presets"], 0, "carnegie"),
    (["import", "export.csv", "--guess"], 0, "4 rows, 4 objects, 0 refused, 0 doubtful; 4 of them as understood"),
    (["import", "sqlite:///tms.sqlite", "--guess"], 0, "2 rows, 2 objects"),
    (["run"], 0, "3  objects on display"),
    (["run", "--gallery", "B"], 0, "2  objects on display"),
    (["run", "--object", "99"], 2, "there is no object '99'"),
    (["run", "--resume", "--json"], 0, '"objects": 3'),
    (["run", "--strict"], 3, "cannot be assessed"),
    (["run", "--explain", "1"], 0, "class"),
    (["prune"], 0, "1 run and 1 report folder"),
    (["survey"], 0, "worth making: "),
    (["survey", "--out", "new/survey.xlsx", "--json"], 0, '"path": "new/survey.xlsx"'),
    (["plan", "--hours", "3", "--out", "new/plan.xlsx"], 0, "would write new/plan.xlsx"),
    (["decide", "2", "accept", "--why", "w", "--who", "A"], 0, "2: risk accepted"),
    (["decide", "1", "withdraw", "1", "--why", "w", "--who", "A"], 0, "1: "),
    (["decide", "1", "withdraw", "5", "--why", "w", "--who", "A"], 2, "has no decision '5' to withdraw"),
    (["decide", "99", "accept", "--why", "w"], 2, "there is no object '99'"),
    (["decide", "--list"], 0, "1: risk accepted"),
    (["init", "other"], 0, "other"),
    (["init"], 2, "kouros.toml is there already"),
    (["demo", "--folder", "."], 0, "3  objects on display"),
    (["motions", "synthesise", "sine", "amplitude=2", "frequency=2", "cycles=2", "--out", "new"], 0, "manifest.toml"),
    (["motions", "synthesise", "sine", "amplitude=2", "--out", "new"], 2, "sine needs frequency"),
    (
        ["motions", "add", "alive.csv", "--site", "new", "--accept", "a sine"],
        0,
        "/new/manifest.toml: 1 record",
    ),
    (["motions", "add", "absent.csv", "--site", "new"], 4, "absent.csv: file: there is nothing of this name"),
    (["motions", "export", "shaking", "--geojson", "new.geojson"], 0, "would write new.geojson"),
    (["motions", "export", "shaking"], 2, "name a file"),
    (["motions", "select", "shaking", "--target", "absent.csv"], 4, "absent.csv: file: cannot be read"),
    (["motions", "process", "shaking", "--out", "new"], 0, "manifest.toml"),
    (["motions", "process", "shaking", "--out", "shaking"], 4, "nothing is overwritten"),
    (["motions", "process", "shaking", "--record", "absent", "--accept", "w"], 2, "there is no record 'absent'"),
    ([*CONVERT, "--unit", "m/s2", "--out", "new"], 0, "would write new/motion-1.csv"),
    ([*CONVERT, "--unit", "furlong", "--out", "new"], 4, "'furlong' is no unit that is known"),
    (["event", "--pga", "0.2", "--at", "37.77,-122.47"], 0, "would write"),
    (["event"], 2, "give a file about the earthquake"),
    (["validate", "absent"], 2, "absent/experiment.toml: there is no such file"),
)


@pytest.mark.parametrize(
    ("words", "code", "told"), DRY, ids=lambda value: " ".join(value) if isinstance(value, list) else ""
)
def test_a_dry_run_writes_nothing_and_says_what_the_real_one_does(
    museum: Path, tmp_path: Path, words: list[str], code: int, told: str
) -> None:
    before = digest(museum)
    dry = say(museum, *words, "--dry-run")
    assert digest(museum) == before
    assert (dry[0], told in "".join(dry[1:])) == (code, True), dry
    ended = code in (0, 3)
    assert (NOTHING in dry[1] + dry[2]) == ended
    if words[0] in ("run", "demo") and ended:
        # The real one takes the newer export in first; the dry run says so.
        assert "--explain" in words or "1 new, 0 gone, 0 changed of 4 objects" in dry[2] or "--resume" in words
        return
    if ended and words[0] != "import":
        return
    real = say(Path(shutil.copytree(museum, tmp_path / "copy", symlinks=True)), *words)
    assert real[0] == code
    lines = {line for line in dry[1].splitlines() if "inventory:" in line or "new, " in line}
    assert lines <= set(real[1].splitlines())
    if not ended:
        assert real[2].replace(str(tmp_path / "copy"), str(museum)) == dry[2]


def test_every_verb_takes_a_dry_run_or_says_why_not(museum: Path) -> None:
    tried = {words[0] if words[0] != "motions" else " ".join(words[:2]) for words, _, _ in DRY}
    before = digest(museum)
    for command in ALL:
        below = command.commands.values() if isinstance(command, click.Group) else [None]
        for one in below:
            name = [str(command.name), *([] if one is None else [str(one.name)])]
            if " ".join(name) in tried:
                continue
            arguments = ["a"] * sum(p.required for p in (one or command).params if isinstance(p, click.Argument))
            code, _, message = say(museum, *name, *arguments, "--dry-run")
            assert (code, f"{' '.join(name)} has no --dry-run: it " in message) == (2, True), message
    assert digest(museum) == before
    code, _, message = say(museum, "--dry-run", "run")
    assert (code, "it stands after the verb" in message) == (2, True)
    code, _, message = say(museum, "import", "export.csv", "--guess", "--write", "m.toml", "--dry-run")
    assert (code, "--write writes the mapping" in message) == (2, True)


def test_what_a_dry_run_accepts_stays_refused(museum: Path) -> None:
    before = digest(museum)
    dry = say(museum, "motions", "process", "asked", "--record", "sine 2 Hz", "--accept", "a test", "--dry-run")
    assert dry[0] == 0, dry
    assert NOTHING in dry[1]
    assert digest(museum) == before


def test_a_first_dry_run_makes_no_database_and_assesses_the_source(museum: Path, tmp_path: Path) -> None:
    for name in ("kouros.toml", "mapping.toml", "export.csv"):
        shutil.copy(museum / name, tmp_path)
    shutil.copytree(museum / "shaking", tmp_path / "shaking")
    before = digest(tmp_path)
    code, out, warned = say(tmp_path, "run", "--dry-run")
    assert (code, "4  objects on display" in out, "has no tables of Kouros yet" in warned) == (0, True, True)
    code, out, warned = say(tmp_path, "import", "export.csv", "--dry-run")
    assert (code, "4 objects (4 new" in out, "has no tables of Kouros yet" in warned) == (0, True, True)
    assert digest(tmp_path) == before


def test_a_first_dry_demo_makes_no_settings(museum: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # Of the bundled rows only some, and a motion whose charts are there: all of it takes as long as the demonstration.
    from pipeline.night.importing import bundled_collection
    from pipeline.operations import workspace

    rows = bundled_collection().read_text(encoding="utf-8").splitlines()[:4]
    (tmp_path / "few.csv").write_text("\n".join(rows) + "\n", encoding="utf-8")
    monkeypatch.setattr("pipeline.night.importing.bundled_collection", lambda: tmp_path / "few.csv")
    monkeypatch.setattr(workspace, "resource", lambda *_: museum / "shaking")
    shutil.copytree(museum / ".kouros-kept", tmp_path / "kouros-demo" / ".kouros-kept")
    before = digest(tmp_path)
    code, out, warned = say(tmp_path, "demo", "--dry-run")
    assert code == 0, warned
    assert "Carnegie Museum of Art (demonstration)" in out
    assert "kouros-demo/kouros.toml is not there yet" in warned
    assert digest(tmp_path) == before


def test_a_dry_run_does_not_bring_old_tables_up_to_date(museum: Path, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(museum, tmp_path / "old", symlinks=True))
    engine = create_engine(f"sqlite:///{folder / 'kouros.sqlite'}")
    with engine.begin() as connection:
        connection.execute(text("UPDATE alembic_version SET version_num = :old"), {"old": revisions()[0]})
    engine.dispose()
    before = digest(folder)
    for words in (["run"], ["import", "export.csv"], ["prune"], ["survey"], ["decide", "--list"]):
        code, _, message = say(folder, *words, "--dry-run")
        assert (code, "a dry run does not change them" in message) == (2, True), message
    assert digest(folder) == before


LOOKS = (
    ["check"],
    ["check", "--deep"],
    ["run", "--dry-run"],
    ["run", "--explain", "1", "--dry-run"],
    ["import", "export.csv", "--dry-run"],
    ["import", "sheet.csv", "--sheet", "--dry-run"],
    ["import", "--return-to", "1", "--dry-run"],
    ["import", "export.csv", "--guess", "--dry-run"],
    ["prune", "--dry-run"],
    ["decide", "2", "accept", "--why", "w", "--who", "A", "--dry-run"],
)


@pytest.mark.parametrize("left", [*(pytest.param(left, marks=LEFT) for left in ("nothing", "log")), "journal"])
def test_looking_writes_nothing_beside_a_database_either(museum: Path, tmp_path: Path, left: str) -> None:
    """A database in SQLite's mode WAL, and what a process that was killed left beside it: read, and not settled."""
    folder = Path(shutil.copytree(museum, tmp_path / "copy", symlinks=True))
    if left == "journal":
        kill_amid_a_change(folder / "kouros.sqlite", "DELETE")
        assert (folder / "kouros.sqlite-journal").stat().st_size
    else:
        kill_amid_a_change(folder / "kouros.sqlite", "WAL")
        if left == "nothing":
            settled = sqlite3.connect(folder / "kouros.sqlite")
            settled.execute("PRAGMA wal_checkpoint(TRUNCATE)")
            settled.close()
        assert (folder / "kouros.sqlite-wal").is_file() is (left == "log")
    before = digest(folder)
    for words in LOOKS:
        code, out, message = say(folder, *words)
        assert (code, digest(folder) == before) == (0, True), (words, out, message)
    # What was committed is seen, what was not is not; then the real one settles it.
    tables = inspect(open_for_reading(database_url(folder / "kouros.sqlite"))).get_table_names()
    assert ("some" in tables, "more" in tables) == (left != "journal", False)
    assert digest(folder) == before
    assert say(folder, "import", "export.csv")[0] == 0


DYING = """
import os, sqlite3, sys
c = sqlite3.connect(sys.argv[1], isolation_level=None)
c.execute("PRAGMA journal_mode = " + sys.argv[2])
c.execute("PRAGMA cache_size = 1")
if sys.argv[2] == "WAL":
    c.execute("CREATE TABLE some AS SELECT 1 AS kept")
c.execute("BEGIN IMMEDIATE")
c.execute("CREATE TABLE more (n, t)")
c.executemany("INSERT INTO more VALUES (?, ?)", [(n, "x" * 500) for n in range(2000)])
os._exit(9)
"""


def kill_amid_a_change(file: Path, mode: str) -> None:
    """Have a process commit a change where the mode is WAL, begin another, and die."""
    assert subprocess.run([sys.executable, "-c", DYING, str(file), mode], check=False).returncode == 9


def older(folder: Path) -> None:
    """Put a database of the version before in place of the museum's."""
    (folder / "kouros.sqlite").unlink()
    engine = open_database(folder / "kouros.sqlite")
    config = Config()
    config.set_main_option("script_location", str(resource("schemas", "migrations")))
    with engine.begin() as connection:
        config.attributes["connection"] = connection
        upgrade(config, revisions()[-2])
    engine.dispose()


def test_check_migrates_only_where_it_is_told_to(museum: Path, tmp_path: Path) -> None:
    folder = Path(shutil.copytree(museum, tmp_path / "old", symlinks=True))
    older(folder)
    before = digest(folder)
    code, out, _ = say(folder, "check")
    assert (code, "looking does not change them: `kouros check --migrate`" in out) == (2, True), out
    assert "collection" in out, "the other looks are made"
    assert digest(folder) == before
    code, out, message = say(folder, "check", "--migrate")
    assert (code, "tables up to date" in out) == (0, True), (out, message)
    assert digest(folder) != before
    assert say(folder, "check", "--deep", "--migrate")[0] == 2


def test_check_of_a_museum_without_a_database_makes_none(museum: Path, tmp_path: Path) -> None:
    for name in ("kouros.toml", "mapping.toml", "export.csv"):
        shutil.copy(museum / name, tmp_path)
    shutil.copytree(museum / "shaking", tmp_path / "shaking")
    before = digest(tmp_path)
    _, out, _ = say(tmp_path, "check")
    assert "has no tables of Kouros yet" in out
    assert "nothing imported yet" in out
    assert digest(tmp_path) == before


def test_a_dry_run_reads_a_server_only(
    museum: Path, tmp_path: Path, postgresql_url: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    folder = Path(shutil.copytree(museum, tmp_path / "server", symlinks=True))
    with open_database(postgresql_url).connect().execution_options(isolation_level="AUTOCOMMIT") as server:
        server.execute(text("CREATE DATABASE rehearsed"))
    url = database_url(postgresql_url).set(database="rehearsed").render_as_string(hide_password=False)
    monkeypatch.setenv("KOUROS_DATABASE", url)
    engine = open_database(url)
    dry = say(folder, "import", "export.csv", "--dry-run")
    assert (dry[0], "(4 new" in dry[1]) == (0, True)
    assert not inspect(engine).get_table_names(), "not even the tables are made"
    assert say(folder, "import", "export.csv")[0] == 0
    made = versions(engine)
    for words, told in (
        (["import", "short.csv", "--shrink-limit", "1"], "3 gone"),
        (["import", "sheet.csv", "--sheet"], "1 object would be given"),
        (["import", "--return-to", "1"], "as after import 1"),
        (["run"], "4  objects on display"),
        (["decide", "2", "accept", "--why", "w", "--who", "A"], "risk accepted"),
    ):
        before = digest(folder)
        code, out, message = say(folder, *words, "--dry-run")
        assert (code, told in out) == (0, True), (out, message)
        assert digest(folder) == before
    assert versions(engine) == made
    engine.dispose()
