"""Status of the last report: good, being renewed, or stale because tonight's run failed; for programs and for people.

A published report is never touched again, so that this is said beside it: in reports/status.json, and on the landing
page reports/index.html, which links to the last good report.
"""

import json
import os
import re
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from pipeline.operations.presentation import presentation
from pipeline.operations.run_summary import SUMMARY, Summary, exit_code_of, write_aside
from pipeline.report import Language, ReportError
from pipeline.report.pages.landing import MARK, landing_page
from pipeline.settings import Settings

STATUS = "status.json"
"""The file in the folder of reports that says how the last report stands."""

LANDING = "index.html"

_RENDERED = re.compile(r"(\d{8}T\d{6}\.\d{3}-\d+)(-\d+)?")
"""A run's id, and which rendering of it a folder holds."""

GOOD, RUNNING, FAILED = "good", "running", "failed"


@dataclass(frozen=True)
class LastGood:
    """The last report that is whole.

    Attributes
    ----------
    run_id : str
        Of the run that made it.
    finished : str
        ISO 8601, UTC; empty where its run did not say.
    report : str
        Its index, from the folder of reports on.
    reading : mapping or None
        What its records' reading came to, as summary.json beside it says; None where that is not known.
    """

    run_id: str
    finished: str
    report: str
    reading: Mapping[str, Any] | None = None


@dataclass(frozen=True)
class Status:
    """How the last report stands (schemas/status.schema.json).

    Attributes
    ----------
    state : str
        "good"; "running" while a run is at work, or after one that was killed; "failed".
    since : str
        When the state began, ISO 8601, UTC.
    pid : int
        Of the process that said so.
    last_good : LastGood or None
        None before the first good night.
    kind, message : str
        Of the failure; empty where there was none.
    exit_code : int
        Of the failure; 0 where there was none.
    began : str
        When the run began that said so, ISO 8601, UTC; empty where no run did.
    """

    state: str
    since: str
    pid: int
    last_good: LastGood | None = None
    kind: str = ""
    message: str = ""
    exit_code: int = 0
    began: str = ""

    @property
    def stale(self) -> bool:
        """Whether the last good report is older than the last attempt at a newer one."""
        return self.state != GOOD


def mark_running(settings: Settings) -> None:
    """Say that a run of the whole collection has begun; should it be killed, this stays."""
    now = _now()
    _write(settings, Status(RUNNING, now, os.getpid(), last_good(settings), began=now))


def mark_good(settings: Settings, summary: Summary) -> None:
    """Say that tonight's report is the last good one.

    Parameters
    ----------
    settings : Settings
        Of which the folder of reports counts.
    summary : Summary
        Of the run that made it.

    Raises
    ------
    ValueError
        For a run without a report.
    """
    if summary.report is None:
        raise ValueError("a run without a report is not the last good one")
    root = _root(settings)
    report = summary.report.resolve().relative_to(root.resolve()).as_posix()
    good = LastGood(summary.run_id, summary.finished, report, summary.reading)
    _write(settings, Status(GOOD, _now(), os.getpid(), good, began=_began(settings)))


def mark_failed(settings: Settings, problem: BaseException, message: str) -> None:
    """Say that tonight's run failed, and why; the last good report stays what it is.

    Parameters
    ----------
    settings : Settings
        Of which the folder of reports counts.
    problem : BaseException
        What ended the run.
    message : str
        Without secrets, for everybody who may read the reports.
    """
    good, kind = last_good(settings), type(problem).__name__
    code = exit_code_of(problem)
    _write(settings, Status(FAILED, _now(), os.getpid(), good, kind, message, code, _began(settings)))


def _began(settings: Settings) -> str:
    # A run that fails before it said that it is running began just now, and brought nothing into the inventory.
    now = status(settings)
    return now.began if now is not None and now.state == RUNNING and now.pid == os.getpid() else _now()


def renew(settings: Settings) -> None:
    """Say the same as before of the report that `latest` points at now."""
    now = status(settings)
    if now is not None:
        _write(settings, now)


def status(settings: Settings) -> Status | None:
    """Return how the last report stands; None where nobody said it yet, or where the file cannot be read."""
    try:
        plain: Any = json.loads((_root(settings) / STATUS).read_text(encoding="utf-8"))
        good = plain.pop("last_good")
        known = Status(**plain, last_good=None if good is None else LastGood(**good))
    except (OSError, ValueError, TypeError, KeyError, AttributeError):
        return None
    return replace(known, last_good=last_good(settings) or known.last_good)


def last_good(settings: Settings) -> LastGood | None:
    """Return the report that `latest` points at, or, where links cannot be made, the one that was last said."""
    root = _root(settings)
    said = _said(root)
    link = root / "latest"
    if link.is_symlink() and (link / LANDING).is_file():
        folder = link.resolve()
        rendered = _RENDERED.fullmatch(folder.name)
        run = rendered[1] if rendered else folder.name
        told = _told(folder)
        finished = str(told.get("finished") or (said.finished if said is not None and said.run_id == run else ""))
        return LastGood(run, finished, f"{folder.name}/{LANDING}", told.get("reading"))
    return said if said is not None and (root / said.report).is_file() else None


def _said(root: Path) -> LastGood | None:
    try:
        said: Mapping[str, Any] | None = json.loads((root / STATUS).read_text(encoding="utf-8"))["last_good"]
        return None if said is None else LastGood(**said)
    except (OSError, ValueError, TypeError, KeyError):
        return None


def _told(folder: Path) -> Mapping[str, Any]:
    """Return what a report's summary.json says; nothing where it cannot be read."""
    try:
        found: Any = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    return found if isinstance(found, dict) else {}


def _write(settings: Settings, now: Status) -> None:
    root = _root(settings)
    root.mkdir(parents=True, exist_ok=True)
    try:
        spoken = presentation(settings)["language"]
    except ReportError:  # A catalogue that cannot be read may be the very failure that is told.
        spoken = Language()
    page = root / LANDING
    # Somebody else's page is not ours to replace.
    if not page.exists() or MARK in page.read_text(encoding="utf-8", errors="replace"):
        write_aside(page, landing_page(asdict(now), settings.museum.name, spoken))
    write_aside(root / STATUS, json.dumps(asdict(now), indent=2) + "\n")


def _root(settings: Settings) -> Path:
    return settings.path(settings.report.folder)


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
