"""Earlier runs and reports are removed when there are enough newer ones; the last good ones never are."""

import re
import shutil
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime, timedelta
from pathlib import Path

from pipeline.operations.dry_run import rehearsed
from pipeline.operations.report_status import last_good
from pipeline.operations.workspace import Workspace, locked, open_workspace
from pipeline.resources import aside_of
from pipeline.settings import Settings
from pipeline.settings.operations import Retention
from pipeline.store.pages import remove_runs
from pipeline.store.runs import FINISHED, RunSummary, list_runs
from pipeline.store.sound import whole_runs

_RUN = r"(?P<run>(?P<day>\d{8})T(?P<time>\d{6})\.\d{3}-\d+)"
_REPORT = re.compile(rf"{_RUN}(-\d+)?")
_OURS = frozenset({".html", ".csv", ".jsonl", ".json", ".parquet", ".xlsx", ".arrow", ".pdf"})
_ALWAYS = ("index.html", "findings.jsonl", "objects.csv")


@dataclass(frozen=True)
class Pruned:
    """What was removed, or would be.

    Attributes
    ----------
    runs : tuple of str
        Run ids, the oldest first.
    reports : tuple of str
        Names of folders, the oldest first.
    kept : tuple of str
        Folders that are old enough, and why they stay all the same.
    """

    runs: tuple[str, ...] = ()
    reports: tuple[str, ...] = ()
    kept: tuple[str, ...] = ()


def prune(settings: Settings, *, dry_run: bool = False, ahead: bool = False) -> Pruned:
    """Remove the runs and report folders beyond [retention].

    The last good run, its report and what `latest` points at always stay, and so does every folder that is not wholly
    Kouros's own.  An unfinished run goes only where a good one followed it.

    Parameters
    ----------
    settings : Settings
        Of which `[retention]` counts.
    dry_run : bool
        Remove nothing, and say what would be.
    ahead : bool
        Remove what is dated later than now too, of a clock that was wrong, where another good run is shown.

    Returns
    -------
    Pruned
        What was removed, or would be.

    Raises
    ------
    LockedError
        Where a run is at work.
    """
    limits = settings.retention
    if not (limits.runs or limits.reports or limits.days or ahead):
        return Pruned()
    with rehearsed(settings, dry_run) as lent, locked(lent):
        workspace = open_workspace(lent)
        sacred = _sacred(workspace)
        there = list_runs(workspace.engine)
        wrong = _ahead(there, workspace.settings) if ahead else frozenset()
        runs = _old_runs([run for run in there if run.run_id not in wrong], sacred, limits)
        runs += [run.run_id for run in there if run.run_id in wrong]
        folders, kept = _old_reports(workspace.reports, sacred - wrong, limits, wrong)
        if not dry_run:
            # The folders first: where the disk is full, the database can only then write what it removes.
            for folder in folders:
                _remove(folder)
            remove_runs(workspace.engine, runs)
        return Pruned(tuple(runs), tuple(sorted(folder.name for folder in folders)), tuple(kept))


def _sacred(workspace: Workspace) -> frozenset[str]:
    """Return the runs that stay whatever the limits say."""
    good = last_good(workspace.settings)
    shown = _REPORT.fullmatch(good.report.split("/")[0]) if good else None
    return frozenset(
        [*whole_runs(workspace.engine)[:1], *([good.run_id] if good else []), *([shown["run"]] if shown else [])]
    )


def _ahead(runs: Sequence[RunSummary], settings: Settings) -> frozenset[str]:
    """Return the runs that are dated later than now, but for the one whose report is shown."""
    good = last_good(settings)
    now = datetime.now(UTC)
    if good is None or any(run.run_id == good.run_id and (_when(run.started) or now) > now for run in runs):
        return frozenset()
    return frozenset(run.run_id for run in runs if (_when(run.started) or now) > now)


def _old_runs(runs: Sequence[RunSummary], sacred: frozenset[str], limits: Retention) -> list[str]:
    finished = [run for run in runs if run.status == FINISHED]
    good = max((run.started for run in finished if run.run_id in sacred), default="")
    old = {
        run.run_id
        for place, run in enumerate(finished)
        if run.run_id not in sacred and _beyond(place, limits.runs, _when(run.started), limits.days)
    }
    staying = [run.started for run in finished if run.run_id not in old]
    oldest = min(staying, default="")
    # A run that was cut off may be wanted yet, unless a good one came after it and it is older than all that stays.
    old |= {run.run_id for run in runs if run.status != FINISHED and run.started < min(good, oldest)}
    return [run.run_id for run in reversed(runs) if run.run_id in old]


def _old_reports(
    root: Path, sacred: frozenset[str], limits: Retention, wrong: frozenset[str]
) -> tuple[list[Path], list[str]]:
    found = [(match, folder) for folder in _inside(root) if (match := _REPORT.fullmatch(folder.name))]
    found.sort(key=lambda one: one[1].name, reverse=True)
    old, kept = [], []
    for place, (match, folder) in enumerate(found):
        when = _when(f"{match['day']}T{match['time']}")
        if match["run"] not in wrong and (
            match["run"] in sacred or not _beyond(place, limits.reports, when, limits.days)
        ):
            continue
        strange = _strange(folder)
        if strange:
            kept.append(f"{folder.name}: {strange}")
        else:
            old.append(folder)
    return old, kept


def _beyond(place: int, most: int, when: datetime | None, days: float) -> bool:
    if most and place >= most:
        return True
    return bool(days) and when is not None and datetime.now(UTC) - when > timedelta(days=days)


def _when(text: str) -> datetime | None:
    try:
        moment = datetime.fromisoformat(text)
    except ValueError:
        return None
    return moment if moment.tzinfo else moment.replace(tzinfo=UTC)


def _inside(root: Path) -> Iterator[Path]:
    if root.is_dir():
        yield from (one for one in root.iterdir() if one.is_dir() and not one.is_symlink())


def _strange(folder: Path) -> str:
    """Say what in a folder Kouros did not make, "" for nothing."""
    for name in _ALWAYS:
        if not (folder / name).is_file():
            return f"it holds no {name}, and so is no report of Kouros"
    for path in folder.rglob("*"):
        if path.is_symlink() or not (path.is_dir() or path.suffix in _OURS):
            return f"it holds {path.relative_to(folder).as_posix()!r}, which Kouros did not make"
    return ""


def _remove(folder: Path) -> None:
    # Out of sight by one rename first, so that nobody opens half a report.
    aside = aside_of(folder)
    folder.rename(aside)
    shutil.rmtree(aside)
