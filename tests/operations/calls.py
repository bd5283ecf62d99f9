"""Disturbs a verb of Kouros at one system call after another, and looks at what is left; a program of its own.

`python -m tests.operations.calls PLAN`, with `c/disturb.c` preloaded; one line of JSON to standard output for each
attack.  Every attack is a process that is forked from this one, which has had nights already and so starts warm.
"""

from __future__ import annotations

import ctypes
import json
import os
import shutil
import signal
import sqlite3
import sys
import tempfile
import threading
from collections.abc import Iterator
from contextlib import closing, suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from sqlalchemy import select

from pipeline.collection.database import open_database
from pipeline.operations.report_status import FAILED, GOOD, RESERVE, RUNNING, status
from pipeline.settings import load_settings
from pipeline.store.pages import load_members
from pipeline.store.results import damaged as damaged_results
from pipeline.store.tables import PAGE, RESULT
from pipeline.store.verifying import verify_table
from tests.museum import COLUMNS, edit, workspace

from .conftest import within
from .disturbed import last, objects, whole

COUNT, KILL, FULL = 0, 1, 2
"""What is done at a call, as `disturb.c` names it."""

WAYS = {"kill": KILL, "full disk": FULL}

VERBS = {
    "run": ("run",),
    "import": ("import", "export.csv"),
    "decide": ("decide", "1", "accept", "--why", "the case is rebuilt next year"),
    "prune": ("prune",),
    "report": ("report",),
}

SETTINGS = {"runs = 0": "runs = 1", "reports = 0": "reports = 1", 'file = ""': 'file = "kouros.jsonl"'}
"""What is changed before the third night: it tidies up after itself, and keeps a log."""

LONGEST = 60.0
"""Seconds after which a night hangs."""

LAST = 0.3
"""Height [m] of the vase in the third night."""

_OURS = frozenset({".kouros-kept", ".kouros.lock", ".pages.json", RESERVE})


@dataclass(frozen=True)
class Base:
    """A museum after two good nights, tonight's records in place, and what an undisturbed third night finds."""

    folder: Path
    before: dict[str, dict[str, str]]
    after: dict[str, dict[str, str]]
    record: Any


@dataclass(frozen=True)
class Outcome:
    """What came of an attack.

    call  : the call that was disturbed, and the file
    code  : how the verb ended, -9 where it was killed
    wrong : what should not be so, "" for nothing
    """

    verb: str
    way: str
    at: int
    call: str
    code: int
    wrong: str


def rows(height: float) -> list[str]:
    """A vase, a plate and a vase of unknown height, of which the first has another height each night."""
    return [f"1,Hall,Vase,{height},0.2,0.2", "2,Room,Plate,0.03,0.3,0.3", "3,Room,Vase,,0.2,0.2"]


def prepared(folder: Path, site: str) -> Base:
    """Let a museum have its two good nights, and a copy of it the undisturbed third one."""
    folder.mkdir(parents=True)
    workspace(folder, rows(0.4), site=site)
    # It slides, it may tip, and in the third night it slides again: what is told of it is another each time.
    for height in (0.4, 0.6, LAST):
        export = "\n".join([COLUMNS, *rows(height)]) + "\n"
        (folder / "export.csv").write_text(export, encoding="utf-8")
        if height != LAST:
            assert within(folder, "run").returncode == 0
    before = objects(folder / "reports" / "latest")
    for old, new in SETTINGS.items():
        edit(folder / "kouros.toml", f"\n{old}\n", f"\n{new}\n")
    undisturbed = Path(shutil.copytree(folder, folder.parent / "undisturbed", symlinks=True))
    assert within(undisturbed, "run").returncode == 0
    after = objects(undisturbed / "reports" / "latest")
    assert after != before
    return Base(folder, before, after, last(str(undisturbed / "kouros.sqlite")))


def forked(folder: Path, words: tuple[str, ...], at: int = 0, way: int = COUNT, calls: int = -1) -> tuple[int, str]:
    """Run a verb in a process of its own; return how it ended, and what it said."""
    with tempfile.TemporaryFile() as said:
        child = os.fork()
        if not child:
            signal.alarm(int(LONGEST))  # Its default is to end the process, with a signal that is not the kill's.
            if at or calls >= 0:
                ctypes.CDLL(None).disturb(str(folder).encode(), ctypes.c_long(at), way, calls)
            code = 99
            with suppress(BaseException):
                # What is printed past the streams of Python, such as an exception that nobody took.
                os.dup2(said.fileno(), 2)
                done = within(folder, *words)
                said.write((done.stdout + done.stderr).encode())
                code = done.returncode
            said.flush()
            os._exit(code)
        _, status = os.waitpid(child, 0)
        said.seek(0)
        return os.waitstatus_to_exitcode(status), said.read().decode(errors="replace")


def counted(base: Base, scratch: Path, verb: str) -> list[str]:
    """Return the calls of an undisturbed verb, each with its file."""
    folder = _copy(base, scratch)
    with tempfile.TemporaryFile() as calls:
        code, said = forked(folder, VERBS[verb], calls=calls.fileno())
        assert code == 0, said
        calls.seek(0)
        return calls.read().decode().splitlines()


def _copy(base: Base, scratch: Path) -> Path:
    folder = scratch / "museum"
    shutil.rmtree(folder, ignore_errors=True)
    return Path(shutil.copytree(base.folder, folder, symlinks=True))


def attacked(base: Base, scratch: Path, verb: str, way: str, at: int, call: str) -> Outcome:
    """Disturb a verb at one of its calls, look at what is there, and have the next night."""
    folder = _copy(base, scratch)
    code, said = forked(folder, VERBS[verb], at, WAYS[way])
    wrong = "; ".join(_wrong(base, folder, verb, way, code, said, resume=bool(at % 2)))
    return Outcome(verb, way, at, call, code, wrong)


def _wrong(base: Base, folder: Path, verb: str, way: str, code: int, said: str, *, resume: bool) -> Iterator[str]:
    if "Traceback" in said:
        yield f"a traceback: {said[-1500:]}"
    if way == "kill" and code != -signal.SIGKILL:
        yield f"ended with {code} before it was killed"
    if way == "full disk":
        if code not in (0, 1):
            yield f"ended with {code}: {said}"
        if code == 1 and not ("room" in said and str(folder) in said):
            yield f"names no file, or no remedy: {said}"
    try:
        tonight = whole(folder, base)
        if verb != "run" and tonight:
            yield "another report was published"
        if code == 0 and verb == "run" and not tonight:
            yield "it did not fail, and published nothing"
    except (AssertionError, OSError, ValueError) as problem:
        yield f"the published report is not whole: {problem!r}"
    yield from _status(folder)
    code, said = forked(folder, ("run", "--resume") if resume else ("run",))
    if code != 0:
        yield f"the next night ended with {code}: {said}"
        return
    try:
        if not whole(folder, base):
            yield "the next night published nothing"
    except (AssertionError, OSError, ValueError) as problem:
        yield f"the next report is not whole: {problem!r}"
    # What was decided is in force, or not; it changes nothing that is found.
    found = last(str(folder / "kouros.sqlite"))
    if replace(found, decisions=()) != replace(base.record, decisions=()):
        yield "the next night found something else"
    yield from _database(folder / "kouros.sqlite")
    yield from _status(folder, GOOD)
    left = [str(path.relative_to(folder)) for path in folder.rglob("*") if _litter(path.name)]
    if left:
        yield f"left behind: {left}"
    reports = [path.name for path in (folder / "reports").iterdir() if path.is_dir() and not path.is_symlink()]
    if len(reports) != 1:
        yield f"reports beyond those kept: {reports}"


def _status(folder: Path, *states: str) -> Iterator[str]:
    """What is said of the last report is of the one that is shown."""
    said = status(load_settings(folder / "kouros.toml"))
    shown = (folder / "reports" / "latest").resolve().name
    if said is None or said.last_good is None or said.last_good.report != f"{shown}/index.html":
        yield f"shown is {shown}, said is {said}"
    elif said.state not in (states or (GOOD, RUNNING, FAILED)):
        yield f"it says that it is {said.state}"
    elif states and f'href="{shown}/index.html"' not in (folder / "reports" / "index.html").read_text("utf-8"):
        yield "the landing page links to another report"


def _litter(name: str) -> bool:
    return name.endswith((".partial", "-journal", "-wal")) or (name.startswith(".") and name not in _OURS)


def _database(file: Path) -> Iterator[str]:
    with closing(sqlite3.connect(file)) as connection:
        if connection.execute("PRAGMA integrity_check").fetchall() != [("ok",)]:
            yield "the database is damaged"
        if connection.execute("PRAGMA foreign_key_check").fetchall():
            yield "the database names what it does not hold"
        orphans = "SELECT count(*) FROM page WHERE key NOT IN (SELECT key FROM run_page)"
        if connection.execute(orphans).fetchone() != (0,):
            yield "the database holds pages of no run"
    engine = open_database(str(file))
    with engine.connect() as connection:
        there = set(connection.execute(select(RESULT.c.key)).scalars())
        pages = connection.execute(select(PAGE.c.key)).scalars().all()
        damaged = [one.row for one in verify_table(engine, "page")]
        named = {key for page in set(pages) - set(damaged) for key in load_members(connection, page).wanted}
    if there != named:
        yield f"results of no page: {len(there - named)}, pages without their results: {len(named - there)}"
    if damaged or [*damaged_results(engine)]:
        yield "the database holds what was not written"
    engine.dispose()


def main() -> None:
    """Carry out a plan: {"folder", "site", "attacks": {verb: {way: [start, stride]}}}, and at the swap in any case."""
    plan = json.loads(sys.argv[1])
    scratch = Path(plan["folder"]).resolve()
    base = prepared(scratch / "base" / "museum", plan["site"])
    assert threading.active_count() == 1, "a process with threads is not to be forked"
    for verb, ways in plan["attacks"].items():
        calls = counted(base, scratch, verb)
        print(json.dumps({"verb": verb, "calls": calls}), flush=True)
        for way, (start, stride) in ways.items():
            swap = next((at for at, call in enumerate(calls, 1) if call == "rename reports/latest"), 0)
            for at in sorted({*range(start, len(calls) + 1, stride), *((swap, swap + 1) if swap else ())}):
                outcome = attacked(base, scratch, verb, way, at, calls[at - 1])
                print(json.dumps(asdict(outcome)), flush=True)


if __name__ == "__main__":
    main()
