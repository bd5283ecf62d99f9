"""What is removed of earlier nights, and what never is."""

from __future__ import annotations

import os
import random
import subprocess
import time
from dataclasses import replace
from datetime import UTC, datetime, timedelta
from pathlib import Path

import pytest

from pipeline.cache import KINDS
from pipeline.operations.report_status import last_good
from pipeline.operations.retention import Pruned, prune
from pipeline.operations.workspace import (
    IMPORTS,
    LockedError,
    Workspace,
    locked,
    open_workspace,
)
from pipeline.report import publish
from pipeline.settings import KEPT, Retention, Settings
from pipeline.store.runs import commit_run, list_runs
from pipeline.store.sound import SELECTION
from tests.report import builder
from tests.soak import SOAK

NOW = datetime.now(UTC)


def museum(folder: Path, limits: Retention) -> Workspace:
    return open_workspace(Settings(home=folder, retention=limits))


def night(
    workspace: Workspace, hours_ago: float, *, part: bool = False, finished: bool = True, report: bool = True
) -> str:
    """Store a run of a while ago, with the files of its report; the newest whole one is the latest."""
    began = NOW - timedelta(hours=hours_ago)
    run_id = f"{began:%Y%m%dT%H%M%S}.{began.microsecond // 1000:03d}-77"
    record = replace(
        builder.record(),
        run_id=run_id,
        started=began.isoformat(),
        finished=began.isoformat() if finished else "",
        assessments=(),
        charts={},
        motions=(),
        wishes=None,
        settings={SELECTION: part},
    )
    commit_run(workspace.engine, record, [], counts={})
    if report and finished:
        folder = workspace.reports / run_id
        folder.mkdir(parents=True)
        for name in ("index.html", "findings.jsonl", "objects.csv", "findings.xlsx"):
            (folder / name).write_text(run_id, encoding="utf-8")
        if not part:
            publish(folder, workspace.reports)
    return run_id


def runs(workspace: Workspace) -> list[str]:
    return [run.run_id for run in list_runs(workspace.engine)]


def folders(workspace: Workspace) -> list[str]:
    return sorted(path.name for path in workspace.reports.iterdir() if path.name != "latest")


def test_nothing_is_removed_where_nothing_is_asked(tmp_path: Path) -> None:
    workspace = museum(tmp_path, Retention())
    ids = [night(workspace, hours) for hours in (30_000, 1)]
    assert prune(workspace.settings) == Pruned()
    assert runs(workspace) == ids[::-1]


def test_the_newest_stay_and_a_dry_run_removes_nothing(tmp_path: Path) -> None:
    workspace = museum(tmp_path, Retention(runs=2, reports=3))
    ids = [night(workspace, hours) for hours in (5, 4, 3, 2, 1)]
    foreseen = prune(workspace.settings, dry_run=True)
    assert foreseen == Pruned(tuple(ids[:3]), tuple(ids[:2]))
    assert (runs(workspace), folders(workspace)) == (ids[::-1], ids)
    assert prune(workspace.settings) == foreseen
    assert (runs(workspace), folders(workspace)) == (ids[:2:-1], ids[2:])
    assert (workspace.reports / "latest").resolve().name == ids[-1]
    assert prune(workspace.settings) == Pruned()


def test_age_removes_all_but_the_last_good_one(tmp_path: Path) -> None:
    """A museum whose nights failed for months: its last good run and report are old, and stay."""
    workspace = museum(tmp_path, Retention(days=1))
    old, good = night(workspace, 500), night(workspace, 400)
    assert prune(workspace.settings) == Pruned((old,), (old,))
    assert runs(workspace) == folders(workspace) == [good]


def test_parts_of_the_collection_do_not_push_out_the_last_whole_run(tmp_path: Path) -> None:
    workspace = museum(tmp_path, Retention(runs=1, reports=1))
    good = night(workspace, 9)
    parts = [night(workspace, hours, part=True) for hours in (3, 2, 1)]
    prune(workspace.settings)
    assert runs(workspace) == [parts[-1], good]
    assert folders(workspace) == [good, parts[-1]]


def test_what_latest_points_at_stays_whatever_the_database_says(tmp_path: Path) -> None:
    """Somebody went back to an older report by hand."""
    workspace = museum(tmp_path, Retention(runs=1, reports=1))
    ids = [night(workspace, hours) for hours in (3, 2, 1)]
    publish(workspace.reports / ids[0], workspace.reports)
    prune(workspace.settings)
    assert runs(workspace) == [ids[2], ids[0]]
    assert folders(workspace) == [ids[0], ids[2]]
    good = last_good(workspace.settings)
    assert good is not None
    assert good.run_id == ids[0]


def test_a_run_that_was_cut_off_waits_for_a_good_one(tmp_path: Path) -> None:
    workspace = museum(tmp_path, Retention(runs=1))
    stale = night(workspace, 9, finished=False)
    good = night(workspace, 5)
    pending = night(workspace, 1, finished=False)
    assert prune(workspace.settings).runs == (stale,)
    assert runs(workspace) == [pending, good]


def test_a_folder_that_is_not_wholly_ours_stays(tmp_path: Path) -> None:
    workspace = museum(tmp_path, Retention(reports=1))
    noted, linked, hollow, plain, newest = [night(workspace, hours) for hours in (9, 8, 7, 6, 1)]
    root = workspace.reports
    (root / noted / "what the registrar said.docx").write_text("keep", encoding="utf-8")
    outside = tmp_path / "outside.csv"
    outside.write_text("keep", encoding="utf-8")
    (root / linked / "link.csv").symlink_to(outside)
    (root / hollow / "findings.jsonl").unlink()
    for name in ("exhibition 2031", "20310501", "20310501T030000.000-1x", ".kouros"):
        (root / name).mkdir()
    (root / "20300501T030000.000-1").symlink_to(tmp_path, target_is_directory=True)
    (root / "notes.txt").write_text("keep", encoding="utf-8")
    before = set(folders(workspace))
    done = prune(workspace.settings)
    assert done.reports == (plain,)
    assert before - set(folders(workspace)) == {plain}
    assert len(done.kept) == 3
    assert any("docx" in why for why in done.kept)
    assert outside.read_text(encoding="utf-8") == "keep"
    assert newest in folders(workspace)


def left_by(pid: int, path: Path, age: float = 0.0) -> Path:
    """What a process of that number was writing some seconds ago; reports are folders."""
    left = path.with_name(f".{path.name}.{pid}-140167345910336.kouros.partial")
    left.parent.mkdir(parents=True, exist_ok=True)
    if path.name.startswith("2031"):
        left.mkdir()
        (left / "index.html").write_text("half", encoding="utf-8")
    else:
        left.write_text("half", encoding="utf-8")
    os.utime(left, (time.time() - age, time.time() - age))
    return left


def test_what_the_dead_left_unfinished_goes_and_nothing_else(tmp_path: Path) -> None:
    """In every folder that Kouros writes in, before anything else is done there; a dry run leaves it."""
    workspace = museum(tmp_path, Retention(reports=5))
    night(workspace, 1)
    gone = subprocess.Popen(["true"])
    gone.wait()
    alive = subprocess.Popen(["sleep", "60"])
    try:
        reports, kept = workspace.reports, tmp_path / KEPT
        places = [
            reports / "20310501T030000.000-1", reports / "status.json", reports / "latest", kept / "self-test.json",
            *(kept / kind / "a.kept" for kind in KINDS), tmp_path / IMPORTS / "00001-2031-05-01.csv",
            tmp_path / "kouros.toml",
        ]  # fmt: skip
        dead = [left_by(gone.pid, place) for place in places]
        # In a container a process has the number of last night's; and numbers go round.
        dead.append(left_by(os.getpid(), reports / "index.html", age=86_400.0))
        dead.append(left_by(alive.pid, kept / "trade-off.json", age=7 * 86_400.0))
        target = reports / "a-folder-of-others"
        target.mkdir()
        (link := reports / f".latest.{gone.pid}-1.kouros.partial").symlink_to(target, target_is_directory=True)
        stay = [
            left_by(alive.pid, reports / "index.html"), left_by(os.getpid(), kept / "self-test.json"), target,
            tmp_path / f".notes.{gone.pid}.partial", tmp_path / "thesis.kouros.partial", tmp_path / ".kouros.partial",
            target / f".mine.{gone.pid}-1.kouros.partial",
        ]  # fmt: skip
        for path in stay:
            if not path.exists():
                path.write_text("mine", encoding="utf-8")
        assert not prune(workspace.settings, dry_run=True).reports
        assert all(path.exists() for path in [*dead, *stay])
        prune(workspace.settings)
        assert not [path for path in [*dead, link] if path.exists() or path.is_symlink()]
        assert all(path.exists() for path in stay)
    finally:
        alive.kill()
        alive.wait()


def test_nothing_is_removed_while_a_run_is_at_work(tmp_path: Path) -> None:
    workspace = museum(tmp_path, Retention(runs=1))
    with locked(workspace.settings), pytest.raises(LockedError):
        prune(workspace.settings)


@pytest.mark.long("test_age_removes_all_but_the_last_good_one")
def test_at_random_the_last_good_run_always_stays(tmp_path: Path) -> None:
    """A dozen museums of any history and any limits, every day half of them."""
    chance = random.Random(11)
    for number in range(12 if SOAK else 6):
        limits = Retention(
            runs=chance.choice([0, 1, 2]), reports=chance.choice([0, 1, 2]), days=chance.choice([0.0, 0.1, 2.0])
        )
        workspace = museum(tmp_path / str(number), limits)
        good = []
        for hours in sorted(chance.sample(range(1, 100), 4), reverse=True):
            part, finished = chance.random() < 0.3, chance.random() < 0.7
            run = night(workspace, hours, part=part, finished=finished)
            good += [run] if finished and not part else []
        prune(workspace.settings)
        if good:
            assert good[-1] in runs(workspace)
            assert (workspace.reports / "latest" / "index.html").read_text(encoding="utf-8") == good[-1]


def test_what_a_wrong_clock_dated_later_than_now_goes_only_when_asked(tmp_path: Path) -> None:
    """Asked by the name of it, and where a good report of another night is shown; a clock set back loses nothing."""
    workspace = museum(tmp_path, Retention())
    before, wrong = night(workspace, 2), night(workspace, -8760)
    assert prune(workspace.settings, ahead=True) == Pruned()
    good = night(workspace, 1)
    assert prune(workspace.settings) == Pruned()
    assert prune(workspace.settings, ahead=True, dry_run=True) == Pruned((wrong,), (wrong,))
    assert prune(workspace.settings, ahead=True) == Pruned((wrong,), (wrong,))
    assert (runs(workspace), folders(workspace)) == ([good, before], [before, good])
