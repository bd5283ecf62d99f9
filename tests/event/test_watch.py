"""`kouros event --watch`: a drop folder, in a museum after a night."""

from __future__ import annotations

import json
import os
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from pipeline.operations.workspace import LockedError
from pipeline.resources import resource
from pipeline.settings import load_settings
from pipeline.tools.event_folders import EVENTS
from pipeline.tools.event_watch import PATIENCE, SETTLED, DropFolder
from tests.cli.test_dry_runs import digest, say
from tests.event.messages import DATA, PARK, alert
from tests.event.test_command import MAP, museum, night, shown
from tests.soak import soaked

__all__ = ["museum", "night"]

WORDS = ("event", "--watch", "drop", "--at", "37.77,-122.47")


@pytest.fixture
def drop(museum: Path) -> Path:
    folder = museum / "drop"
    folder.mkdir()
    return folder


def put(folder: Path, name: str, content: bytes, ago: float = 10.0) -> Path:
    """Put a file there as if it had come some seconds ago."""
    file = folder / name
    file.parent.mkdir(exist_ok=True)
    file.write_bytes(content)
    then = time.time() - ago
    os.utime(file, (then, then))
    return file


def watching(museum: Path, at: tuple[float, float] = PARK) -> DropFolder:
    return DropFolder(load_settings(museum / "kouros.toml"), museum / "drop", at)


def test_each_message_is_answered_once_and_every_version_is_kept(museum: Path, drop: Path) -> None:
    first = put(drop, "alert.xml", alert().encode())
    watch = watching(museum)
    (came,) = watch.look()
    assert came.files == (first,)
    assert came.done is not None
    assert shown(came.done) == came.done.folder.resolve()
    assert watch.look() == []
    put(drop, "grid.xml", MAP.read_bytes())
    (mapped,) = watch.look()
    assert mapped.done is not None
    assert shown(mapped.done) == mapped.done.folder.resolve()
    assert came.done.folder.is_dir(), "every version is kept"
    before = digest(museum / EVENTS)
    # The same once more under another name, and touched: who watches next knows both, and nothing changes.
    put(drop, "alert.xml", alert().encode(), ago=5.0)
    put(drop, "grid-2.xml", MAP.read_bytes())
    (again,) = watching(museum).look()
    assert again.done is not None
    assert again.done.again
    after = digest(museum / EVENTS)
    changed = {name for name in after if after[name] != before.get(name)}
    assert changed <= {"watched.json"}


def test_what_is_half_written_waits_until_it_is_whole(museum: Path, drop: Path) -> None:
    whole = MAP.read_bytes()
    watch = watching(museum)
    put(drop, "grid.xml", whole[:1500], ago=0.0)
    assert watch.look() == []
    assert watch.pending
    # It stands still for a while, and is not given up.
    put(drop, "grid.xml", whole[:1500], ago=SETTLED + 1.0)
    (waits,) = watch.look()
    assert (waits.done, waits.later) == (None, True)
    assert "still being written" in waits.refusal
    assert [watch.news(waits), watch.news(waits)] == [True, False], "it is said once"
    put(drop, "grid.xml", whole)
    (came,) = watch.look()
    assert came.done is not None
    # What nobody ends is refused, once.
    put(drop, "cut.xml", whole[:1500], ago=PATIENCE + 1.0)
    (cut,) = watch.look()
    assert (cut.done, cut.later) == (None, False)
    assert watch.look() == []
    for name in ("grid.xml.part", ".hidden.xml", "grid.xml~"):
        put(drop, name, whole)
    assert watch.look() == []


def test_bad_files_are_refused_once_with_the_reason(museum: Path, drop: Path) -> None:
    put(drop, "bad.xml", MAP.read_bytes().replace(b'magnitude="6.9"', b'magnitude="0"'))
    put(drop, "notes.txt", b"the earth shook")
    put(drop, "cancel.xml", alert(kind="delete").encode())
    put(drop, "bomb.xml", b'<!DOCTYPE a [<!ENTITY b "c">]><shakemap_grid/>')
    code, out, message = say(museum, *WORDS, "--once")
    assert code == 3
    assert out == ""
    told = dict(line.split(": refused: ", 1) for line in message.splitlines() if ": refused: " in line)
    assert set(told) == {"bad.xml", "notes.txt", "cancel.xml", "bomb.xml"}
    assert "wait for the next version" in told["bad.xml"]
    assert "earlier answers stay" in told["cancel.xml"]
    assert "document type or entities" in told["bomb.xml"]
    assert say(museum, *WORDS, "--once") == (0, "", ""), "they are not tried for ever"
    assert [path.name for path in (museum / EVENTS).iterdir() if path.is_dir()] == []
    # One that is mended is.
    put(drop, "bad.xml", MAP.read_bytes())
    code, out, _ = say(museum, *WORDS, "--once")
    assert code == 0
    assert out.startswith("bad.xml: After Loma Prieta")


def test_a_record_waits_for_its_stationxml_and_a_folder_is_one_earthquake(museum: Path, drop: Path) -> None:
    site = resource("site_motions", "demo")
    for file in [*site.glob("*.mseed"), site / "CI.CLC.xml"]:
        put(drop, f"own/{file.name}", file.read_bytes())
    put(drop, "CI.CLC.xml", (site / "CI.CLC.xml").read_bytes())
    watch = watching(museum, (35.81574, -117.59751))
    (came,) = watch.look()
    assert came.done is not None, came.refusal
    assert {file.parent.name for file in came.files} == {"own"}
    assert "own record" in came.done.document["shaking"]["from"]


def test_without_a_run_it_waits_for_one(museum: Path, drop: Path) -> None:
    settings = museum / "kouros.toml"
    (museum / "kouros.sqlite").rename(museum / "away.sqlite")
    put(drop, "grid.xml", MAP.read_bytes())
    watch = DropFolder(load_settings(settings), drop, PARK)
    (waits,) = watch.look()
    assert waits.later
    assert "kouros run" in waits.refusal
    (museum / "kouros.sqlite").unlink()
    (museum / "away.sqlite").rename(museum / "kouros.sqlite")
    (came,) = watch.look()
    assert came.done is not None


@pytest.mark.parametrize(("number", "code"), [pytest.param(signal.SIGINT, 130, marks=soaked), (signal.SIGTERM, 143)])
def test_it_goes_on_until_it_is_stopped_and_ends_cleanly(
    number: signal.Signals, code: int, museum: Path, drop: Path
) -> None:
    """A real process: it answers what comes, nobody else watches meanwhile, and a signal ends it within seconds."""
    words = [sys.executable, "-c", "from pipeline.cli import main; main()", *WORDS, "--json"]
    with subprocess.Popen(words, cwd=museum, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        assert process.stderr is not None
        assert process.stderr.readline() == "watching drop; Ctrl-C ends it\n"
        put(drop, "grid.xml", MAP.read_bytes())
        said = json.loads(process.stdout.readline())
        assert (said["refused"], said["again"], said["event"]["magnitude"]) == (None, False, 6.9)
        with pytest.raises(LockedError, match="another process watches"), watching(museum).alone():
            pass
        process.send_signal(number)
        out, error = process.communicate(timeout=20)
    assert process.returncode == code
    assert (out, "Traceback" in error) == ("", False)
    assert not list((museum / EVENTS).glob("*/.*"))
    shutil.rmtree(museum / EVENTS / said["event"]["folder"].split("/")[1])


def test_words_that_do_not_go_together_are_refused(museum: Path, drop: Path) -> None:
    for words in (["--once"], [*WORDS[1:], str(DATA / "loma_prieta_grid.xml")], [*WORDS[1:], "--drill"]):
        assert say(museum, "event", *words)[0] == 2
    code, _, message = say(museum, "event", "--watch", "nowhere")
    assert (code, "is no folder" in message) == (2, True)
