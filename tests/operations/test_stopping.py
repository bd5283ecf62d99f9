"""Ctrl-C and SIGTERM: the command ends at once, says so, and the next one goes on."""

from __future__ import annotations

import json
import shutil
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from pipeline.operations.report_status import Status, status
from pipeline.operations.run_summary import exit_code_of, words_of
from pipeline.operations.stopping import Stopped, uninterrupted
from pipeline.settings import load_settings
from pipeline.tools.initialise import demonstration
from tests.museum import workspace
from tests.soak import soaked

from .conftest import command, environment, validate, within
from .disturbed import Nights, last, rows, whole

pytestmark = pytest.mark.slow_file

SECONDS = 2.0
"""Within which a command that is stopped has ended."""

SLOW = 5.0
"""How many times as long it may take on a machine that has other things to do: two cores, two test processes."""


def stopped(folder: Path, *words: str, until: Callable[[], Any], number: int = signal.SIGINT, **more: str) -> Any:
    """Start a command, stop it when something is seen, and return how it ended, with what it said and how long after.

    until : is asked every few milliseconds
    """
    process = subprocess.Popen(
        command(*words), cwd=folder, env=environment(more), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    try:
        deadline = time.monotonic() + 60.0
        while process.poll() is None and time.monotonic() < deadline and not until():
            time.sleep(0.005)
        process.send_signal(number)
        began = time.monotonic()
        _, said = process.communicate(timeout=60)
        return process.returncode, said, time.monotonic() - began
    finally:
        process.kill()


def standing(folder: Path) -> Status:
    now = status(load_settings(folder / "kouros.toml"))
    assert now is not None
    validate(json.loads((folder / "reports" / "status.json").read_text("utf-8")), "status")
    return now


@pytest.fixture
def museum(nights: Nights, tmp_path: Path) -> Path:
    """A museum after a good night, with other records tonight."""
    return Path(shutil.copytree(nights.folder, tmp_path / "museum", symlinks=True))


@pytest.mark.parametrize(
    ("number", "code", "words"),
    [pytest.param(signal.SIGINT, 130, "by hand", marks=soaked), (signal.SIGTERM, 143, "SIGTERM")],
)
def test_a_night_that_is_stopped_says_so_and_goes_on(
    museum: Path, nights: Nights, tmp_path: Path, number: int, code: int, words: str
) -> None:
    """While kernels are compiled, into an empty cache, Python would not hear of the signal for half a minute."""
    versions = len(list((museum / "imports").iterdir()))

    def read() -> bool:
        return len(list((museum / "imports").glob("*.csv"))) > versions

    ended = stopped(museum, "run", until=read, number=number, KOUROS_CACHE=str(tmp_path / "empty"))
    assert ended[0] == code, ended
    assert ended[2] < SECONDS * SLOW
    assert "kouros: stopped" in ended[1]
    assert "Traceback" not in ended[1]
    now = standing(museum)
    assert (now.state, now.kind, now.exit_code) == ("failed", "Stopped", code)
    assert words in now.message
    assert words in (museum / "reports" / "index.html").read_text(encoding="utf-8")
    assert not whole(museum, nights)
    # What that run read is in the inventory: the source is not asked again, and need not even be there.
    (museum / "export.csv").rename(tmp_path / "export.csv")
    assert within(museum, "run", "--resume").returncode == 0
    assert whole(museum, nights)
    assert last(str(museum / "kouros.sqlite")) == nights.record
    assert not list(museum.rglob("*.partial"))
    assert standing(museum).state == "good"


@pytest.mark.long("test_a_night_that_is_stopped_says_so_and_goes_on")
def test_a_first_demonstration_that_is_stopped(tmp_path: Path, shaking: Path) -> None:
    folder = tmp_path / "kouros-demo"
    folder.mkdir()
    workspace(folder, rows(0.4), site=str(shaking))
    cache = {"KOUROS_CACHE": str(tmp_path / "empty")}
    ended = stopped(tmp_path, "demo", until=(folder / "reports" / "status.json").exists, **cache)
    assert ended[0] == 130, ended
    assert ended[2] < SECONDS * SLOW
    now = standing(folder)
    assert (now.state, now.last_good) == ("failed", None)
    assert "by hand" in now.message
    assert within(folder, "run", "--resume").returncode == 0
    first = standing(folder)
    assert first.state == "good"
    assert within(tmp_path, "demo").returncode == 0
    assert standing(folder).last_good != first.last_good


def test_a_signal_after_the_swap_comes_too_late() -> None:
    with uninterrupted():
        signal.raise_signal(signal.SIGINT)
        signal.raise_signal(signal.SIGTERM)
    with pytest.raises(KeyboardInterrupt):
        signal.raise_signal(signal.SIGINT)


def test_what_stops_by_hand_is_said_in_words() -> None:
    assert words_of(KeyboardInterrupt()) == "it was stopped by hand"
    assert [exit_code_of(KeyboardInterrupt()), exit_code_of(Stopped(signal.SIGTERM))] == [130, 143]


def test_settings_of_a_demonstration_are_whole_or_not_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A first demonstration that dies while it writes them leaves none, and the next one writes them."""
    with monkeypatch.context() as patch:
        patch.setattr(Path, "replace", lambda *_: (_ for _ in ()).throw(KeyboardInterrupt))
        with pytest.raises(KeyboardInterrupt):
            demonstration(tmp_path)
    assert not list(tmp_path.iterdir())
    assert demonstration(tmp_path).demonstration
