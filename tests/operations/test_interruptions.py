"""Nights that are killed, run out of disk, or lose their database: a whole report stays, nothing is lost or doubled.

The museum had a good night; then its records changed, and the second night is disturbed.  After that the published
report must be whole, last night's or tonight's, and the run that is resumed must find what an undisturbed one finds.
"""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import sqlite3
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

from pipeline.collection import database
from pipeline.collection.database import open_database
from pipeline.store.runs import list_runs
from tests.soak import some

from .conftest import command, environment, within
from .disturbed import Nights, last, objects, whole

pytestmark = pytest.mark.slow_file

KILLS = int(os.environ.get("KOUROS_KILLS", "1"))
"""How many runs are killed; `make soak` kills fifty."""


@pytest.fixture
def museum(nights: Nights, tmp_path: Path) -> Path:
    """A copy of that museum, to be disturbed."""
    return Path(shutil.copytree(nights.folder, tmp_path / "museum", symlinks=True))


def resumes(folder: Path, nights: Nights) -> None:
    """Check that the run is finished by --resume, with what an undisturbed night finds, once."""
    done = within(folder, "run", "--resume")
    assert done.returncode == 0, done.stderr
    assert whole(folder, nights)
    assert last(str(folder / "kouros.sqlite")) == nights.record
    finished = [run for run in list_runs(open_database(str(folder / "kouros.sqlite"))) if run.status == "finished"]
    assert len(finished) in (2, 3)  # three where the kill came after the report was published
    assert not [p.name for p in (folder / "reports").iterdir() if p.name.endswith(".partial")]
    again = within(folder, "run")
    assert (
        "0 objects new, 0 gone, 0 moved, 0 changed; of single checks 0 no longer pass, 0 failed and pass, 0 are"
        in again.stdout
    )


@pytest.mark.parametrize("number", range(KILLS))
def test_a_kill_at_any_moment(museum: Path, nights: Nights, number: int) -> None:
    """SIGKILL, at moments spread over the run by chance with a fixed seed; the later half of it is where it writes."""
    moment = random.Random(20_261_121 + number).uniform(0.25, 1.1) * nights.seconds
    process = subprocess.Popen(
        command("run"),
        cwd=museum,
        env=environment({}),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
    try:
        process.wait(moment)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()
    whole(museum, nights)
    resumes(museum, nights)


@pytest.fixture(scope="session")
def small_disk(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    """A file system of a few megabytes, as only root may make one."""
    folder = tmp_path_factory.mktemp("small")
    made = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", "size=24m", "tmpfs", str(folder)],
        capture_output=True,
        text=True,
        check=False,
    )
    if made.returncode:
        pytest.skip(f"no small disk can be made here: {made.stderr.strip() or 'mount was refused'}")
    yield folder
    subprocess.run(["umount", "--lazy", str(folder)], check=False)


@pytest.mark.parametrize("room", some([0, 150_000, 500_000], 2))
def test_a_full_disk_at_any_stage(nights: Nights, small_disk: Path, room: int) -> None:
    """With so many bytes left the run fails earlier or later, says so, and leaves last night's report as it was."""
    folder = small_disk / "museum"
    shutil.rmtree(folder, ignore_errors=True)
    (small_disk / "filling").unlink(missing_ok=True)
    shutil.copytree(nights.folder, folder, symlinks=True)
    state = os.statvfs(small_disk)
    with (small_disk / "filling").open("wb") as stream:
        stream.write(b"\0" * max(0, state.f_bavail * state.f_frsize - room))
    done = within(folder, "run")
    if done.returncode == 0:
        assert whole(folder, nights)
    else:
        assert "space" in done.stderr or "full" in done.stderr, done.stderr
        assert "Traceback" not in done.stderr
        assert not whole(folder, nights)
        # The room that a good night kept for that lets the page say it, however full the disk is.
        said = json.loads((folder / "reports" / "status.json").read_text(encoding="utf-8"))
        assert (said["state"], said["nights"][-1]["state"]) == ("failed", "failed")
        page = (folder / "reports" / "index.html").read_text(encoding="utf-8")
        assert "The last night failed" in page
        assert "kouros prune" in page
    (small_disk / "filling").unlink()
    resumes(folder, nights)


def test_a_locked_database_is_named_and_the_report_stays(
    museum: Path, nights: Nights, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(database, "PATIENCE_S", 0.2)
    with sqlite3.connect(museum / "kouros.sqlite", isolation_level=None) as other:
        other.execute("BEGIN EXCLUSIVE")
        done = within(museum, "run")
        assert done.returncode != 0
        assert "locked" in done.stderr
        assert "Traceback" not in done.stderr
        assert objects(museum / "reports" / "latest") == nights.before
        other.execute("ROLLBACK")
    resumes(museum, nights)
