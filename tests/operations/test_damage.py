"""What is kept cannot rot unnoticed: single damages to everything that a night keeps and reads again."""

from __future__ import annotations

import os
import re
import shutil
import sqlite3
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from random import Random

import pytest

from pipeline.cache import CacheWarning
from pipeline.cli.console import Console
from pipeline.collection.database import open_database
from pipeline.errors import DamageWarning, KourosError
from pipeline.night.run import run
from pipeline.operations.workspace import open_workspace
from pipeline.records import Decision, DecisionKind
from pipeline.report.errors import ReportWarning
from pipeline.report.files import exports
from pipeline.report.files.manifest import MANIFEST, PARTS
from pipeline.settings import KEPT, load_settings, template
from pipeline.store.decisions import add_decision
from pipeline.store.tables import METADATA
from pipeline.store.verifying import tables, verify_table
from pipeline.tools.doctor_checks import examine
from pipeline.tools.synthetic import synthesise
from tests.museum import small

pytestmark = pytest.mark.slow_file

LONG = pytest.mark.long("test_no_damage_to_what_is_kept_goes_unnoticed")
SILENT = Console(quiet=True)
DAILY = "KOUROS_DAMAGES" not in os.environ
DAMAGES = int(os.environ.get("KOUROS_DAMAGES", "21"))
"""As many as damage nearly one file of each kind; `make soak` does a thousand."""
SHARES = 5
"""Of these `make test` does one share: all four kinds, to files and to the database."""
SEED = 17
DATABASE = "kouros.sqlite"
EXPORTS = ("findings.csv", "objects.csv", "recommendations.csv")
COLUMNS = ("object_number", "gallery", "title", "height_m", "width_m", "depth_m")
MAPPING = """
[source]
format = "csv"
encoding = "utf-8"
delimiter = ","
[museum]
name = "Test"
""" + "".join(
    f'[columns.{name}]\ncolumn = "{name}"\n' + ('unit = "m"\n' if name.endswith("_m") else "") for name in COLUMNS
)


def write_export(folder: Path, changed: float = 0.0) -> None:
    """Write twenty vases in four rooms, of which one may be higher tonight."""
    rows = [
        f"{room}.{n},Room {room},Vase,{0.3 + 0.05 * n + (0.0 if room or n else changed):.3f},0.15,0.15"
        for room in range(4)
        for n in range(5)
    ]
    (folder / "export.csv").write_text("\n".join([",".join(COLUMNS), *rows]) + "\n", encoding="utf-8")


@pytest.fixture(scope="module")
def museum(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A museum after two nights, with a decision made between them; tonight one of its objects has changed.

    It is moved away: each copy of it is put where it was, so that its source is known to be the same.
    """
    folder = tmp_path_factory.mktemp("damage") / "museum"
    folder.mkdir()
    synthesise("sine", ["amplitude=1.2", "frequency=2", "cycles=2"], folder / "site")
    write_export(folder)
    (folder / "mapping.toml").write_text(MAPPING, encoding="utf-8")
    text = small(template(museum="Test", source="export.csv", mapping="mapping.toml", site="site"))
    (folder / "kouros.toml").write_text(text.split("\n[logs]")[0], encoding="utf-8")
    settings = load_settings(folder / "kouros.toml")
    run(settings, SILENT)
    engine = open_workspace(settings).engine
    add_decision(
        engine,
        Decision(0, "1.1", DecisionKind.ACCEPT, "Curator", "2031-05-01", "It stands.", "2031-05-01T12:00:00+00:00"),
    )
    run(settings, SILENT)
    write_export(folder, changed=0.01)
    return folder.rename(folder.with_name("kept"))


@dataclass(frozen=True)
class Night:
    """What came of a night: the report without what tells one run from another, what was said, why it was refused."""

    report: dict[str, str]
    said: tuple[str, ...]
    refused: str


RUN_ID = re.compile(r"\d{8}T\d{6}\.\d{3}-\d+(-\d+)?")
TIME = re.compile(r"\d{4}-\d\d-\d\d[T ]\d\d:\d\d(:\d\d(\.\d+)?)?(\+00:00|Z| UTC)?|\d+(\.\d+)? (s|seconds)\b")


def night(folder: Path) -> Night:
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        try:
            run(load_settings(folder / "kouros.toml"), SILENT)
        except KourosError as problem:
            return Night({}, (), f"{type(problem).__name__}: {problem}")
    said = tuple(str(w.message) for w in caught if issubclass(w.category, DamageWarning | CacheWarning | ReportWarning))
    report = (folder / "reports" / "latest").resolve()
    files = (*report.glob("*.html"), *map(report.joinpath, EXPORTS))
    found = {file.name: file.read_text(encoding="utf-8") for file in files}
    return Night({name: TIME.sub("T", RUN_ID.sub("R", text)) for name, text in found.items()}, said, "")


def kept_files(folder: Path) -> list[Path]:
    """Return what a night reads again besides the database: the cache, and what it uses of the last report."""
    report = (folder / "reports" / "latest").resolve()
    files = [*(folder / KEPT).rglob("*.kept"), report / MANIFEST, *report.glob("*.html"), *(report / PARTS).iterdir()]
    return sorted(file.resolve().relative_to(folder.resolve()) for file in (*files, *map(report.joinpath, EXPORTS)))


def flip(data: bytearray, chance: Random) -> None:
    data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)


def digit(data: bytearray, chance: Random) -> None:
    places = [at for at, byte in enumerate(data) if byte in b"0123456789"]
    if places:
        at = chance.choice(places)
        data[at] = chance.choice(sorted(set(b"0123456789") - {data[at]}))


def zeros(data: bytearray, chance: Random) -> None:
    at = chance.randrange(len(data))
    data[at : at + 64] = bytes(len(data[at : at + 64]))


def cut(data: bytearray, chance: Random) -> None:
    del data[chance.randrange(len(data)) :]


KINDS: tuple[Callable[[bytearray, Random], None], ...] = (flip, digit, zeros, cut)


@dataclass(frozen=True)
class Damage:
    """A damage by number: to which file, of which kind."""

    number: int
    file: Path
    kind: Callable[[bytearray, Random], None]

    def __str__(self) -> str:
        return f"{self.number}: {self.kind.__name__} of {self.file}"

    def do(self, folder: Path) -> bool:
        """Damage the copy of a museum, and say whether any byte is another."""
        path = folder / self.file
        before = path.read_bytes()
        data = bytearray(before)
        if data:
            self.kind(data, Random(f"{SEED} {self.number}"))
        # Another file in its place: what is linked elsewhere stays.
        path.unlink()
        path.write_bytes(data)
        return bytes(data) != before


def damages(folder: Path) -> Iterator[Damage]:
    """Yield the damages: two of three to the database, mostly not cut, the others to every other file in turn.

    Every day it is one of three to the database.
    """
    others = kept_files(folder)
    Random(SEED).shuffle(others)
    # A file of each kind comes before a second one of any: folder and ending tell what wrote it.
    seen: Counter[tuple[Path, str]] = Counter()
    turns = {}
    for file in others:
        kind = file.parent, file.suffix
        turns[file] = seen[kind]
        seen[kind] += 1
    others.sort(key=turns.__getitem__)
    for number in range(DAMAGES):
        if DAILY:
            turn = number // 3
            yield (
                Damage(number, others[(number - turn) % len(others)], KINDS[number % 4])
                if number % 3 < 2
                else Damage(number, Path(DATABASE), KINDS[turn % 4])
            )
        elif number % 3:
            yield Damage(number, Path(DATABASE), KINDS[number // 3 % 4 if number % 3 == 1 else number // 3 % 2])
        else:
            yield Damage(number, others[number // 3 % len(others)], KINDS[number // 3 % 4])


def content(folder: Path) -> list[object] | None:
    """Return all that the database says; None where that cannot be read.  It tells harmless bytes from used ones."""
    try:
        with sqlite3.connect(f"file:{folder / DATABASE}?mode=ro", uri=True) as connection:
            connection.text_factory = bytes
            schema = connection.execute("SELECT type, name, tbl_name, sql FROM sqlite_master").fetchall()
            # Nothing asks for the name of a constraint.
            told: list[object] = [(*of, re.sub(rb"CONSTRAINT \S+", b"", sql or b"")) for *of, sql in schema]
            names = connection.execute("SELECT name FROM sqlite_master WHERE type = 'table' ORDER BY 1").fetchall()
            for (name,) in names:
                told.append(connection.execute(f"SELECT * FROM {name.decode()}").fetchall())  # noqa: S608
            return told
    except (sqlite3.Error, UnicodeDecodeError):
        return None


@pytest.mark.parametrize("shares", [(0,), pytest.param((1, 2, 3, 4), marks=LONG)])
def test_no_damage_to_what_is_kept_goes_unnoticed(
    museum: Path, shares: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    # The workbook, which is made of the exports and compared here with nothing, is a sixth of such a night.
    monkeypatch.setattr(exports, "WORKBOOK_ROWS", 0)
    place = museum.with_name("museum")

    def copy() -> Path:
        shutil.rmtree(place, ignore_errors=True)
        return Path(shutil.copytree(museum, place, symlinks=True))

    whole = night(copy())
    assert whole.report
    assert not whole.said
    settings = load_settings(place / "kouros.toml")
    assert not list(examine(settings, SILENT))
    known = content(museum)
    outcomes: Counter[str] = Counter()
    unnoticed, unseen = [], []
    for damage in damages(museum):
        if damage.number % SHARES not in shares:
            continue
        folder = copy()
        if not damage.do(folder):
            outcomes["nothing changed"] += 1
            continue
        used = damage.file != Path(DATABASE) or content(folder) != known
        seen = list(examine(settings, SILENT))
        if used and not seen:
            unseen.append(str(damage))
        came = night(folder)
        same = came.report == whole.report
        outcomes["refused" if came.refused else "said" if came.said else "equal" if same else "in silence"] += 1
        # What changed since the run before cannot be said where that is damaged: the exports are the same even then.
        listed = all(came.report.get(name) == whole.report[name] for name in EXPORTS)
        if not came.refused and not (listed and (came.said or same)):
            unnoticed.append(f"{damage}: {came.said}")
    print(dict(outcomes))
    assert not unnoticed
    assert not unseen


def test_another_value_in_any_column_is_found(museum: Path, tmp_path: Path) -> None:
    """Of every table one row, value by value: also where SQLite itself has nothing to complain of."""
    shutil.copy(museum / DATABASE, tmp_path / DATABASE)
    engine = open_database(tmp_path / DATABASE)
    assert {table.name for table in METADATA.tables.values() if "seal" in table.c} <= set(tables())
    missed: list[str] = []
    tried: Counter[str] = Counter()
    with closing(sqlite3.connect(tmp_path / DATABASE, isolation_level=None)) as connection:
        # Rows of this one are known by their key only; its checksums have a test of their own.
        for name in set(tables()) - {"source_row"}:
            found = connection.execute(f"SELECT rowid, * FROM {name} LIMIT 1")  # noqa: S608
            # Where the key is a number, it is the row's own.
            alias, *columns = (column for column, *_ in found.description)
            for row, *values in found.fetchall():
                for column, before in zip(columns, values, strict=True):
                    change = f'UPDATE {name} SET "{column}" = ? WHERE rowid = ?'  # noqa: S608
                    connection.execute(change, (another(before), row))
                    tried[name] += 1
                    if not list(verify_table(engine, name)):
                        missed.append(f"{name}.{column}")
                    connection.execute(change, (before, another(before) if column == alias else row))
    assert {"run", "run_motion", "run_decision", "run_page", "decision", "import_batch", "reading"} <= tried.keys()
    # A state's beginning counts where it makes the objects of now more or fewer; SQLite takes 1001 for a yes as well.
    assert set(missed) <= {"item.since", "item.on_display"}


def another(value: object) -> object:
    """Return another value of the same kind."""
    if isinstance(value, str | bytes) and value:
        return value[:-1] + value[:1] * 2
    return value + 1000 if isinstance(value, int | float) else 7
