"""Status of the last report: good, being renewed, or stale because tonight's run failed; for programs and for people.

A published report is never touched again, so that this is said beside it: in reports/status.json, and on the landing
page reports/index.html, which links to the last good report.
"""

import json
import os
import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, TypedDict

from pipeline.operations.run_summary import FULL, SUMMARY, Summary, exit_code_of, is_fault, write_aside
from pipeline.operations.workspace import Workspace
from pipeline.planning.plan import PlanTerms
from pipeline.quantities import counted
from pipeline.report import Language, ReportError, Units, language
from pipeline.report.pages.landing import MARK, landing_page
from pipeline.report.pages.news import KEPT
from pipeline.resources import replacing
from pipeline.settings import Settings


class Presentation(TypedDict):
    """How a report is written: what `render` is told."""

    units: Units
    language: Language
    paper: str
    planned: bool


def presentation(settings: Settings) -> Presentation:
    """Return the units, the language and the paper that the settings ask for, and whether they ask for a plan.

    Parameters
    ----------
    settings : Settings
        Of which `[report]` and `[likelihood]` count.

    Returns
    -------
    Presentation
        What `render` is told.

    Raises
    ------
    ReportError
        For a language without a catalogue, or with a damaged one.
    """
    asked = settings.report
    folder = settings.path(asked.catalogues) if asked.catalogues else None
    return {
        "units": Units(length=asked.length),
        "language": language(asked.language, folder),
        "paper": asked.paper,
        "planned": bool(settings.likelihood.samples),
    }


def terms_of(workspace: Workspace) -> PlanTerms | None:
    """Return what the plan of a report rests on; None where nobody asks how likely harm is: there is no plan then."""
    return workspace.plan_terms if workspace.settings.likelihood.samples else None


STATUS = "status.json"
"""The file in the folder of reports that says how the last report stands."""

LANDING = "index.html"

_RENDERED = re.compile(r"(\d{8}T\d{6}\.\d{3}-\d+)(-\d+)?")
"""A run's id, and which rendering of it a folder holds."""

GOOD, RUNNING, FAILED, INTERRUPTED = "good", "running", "failed", "interrupted"

RESERVE = ".kouros-reserve"
"""A file in the folder of reports whose room is given up where a full disk would leave a failed night untold."""

RESERVED = 256 << 10
"""Its bytes: several landing pages."""

NIGHTS = 60
"""Runs that are kept: a few for each of the days that the landing page shows."""

_NIGHT = ("began", "ended", "state", "run_id")


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
    counts : mapping or None
        Objects on display to act on, to watch, that nobody can assess ("unknown"), and that are fine; from there too.
    news : mapping or None
        What its night found changed: the first objects, how many of each kind; None where there was nothing to compare
        with.
    """

    run_id: str
    finished: str
    report: str
    reading: Mapping[str, Any] | None = None
    counts: Mapping[str, int] | None = None
    news: Mapping[str, Any] | None = None


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
    fault : bool
        Whether Kouros itself failed, and nobody else can mend it.
    began : str
        When the run began that said so, ISO 8601, UTC; empty where no run did.
    nights : sequence of mapping
        The last runs of the whole collection that ended or were cut off, the oldest first: "began" and "ended" (ISO
        8601, UTC; ended empty where nobody knows), "state" (good, failed, interrupted) and "run_id" (empty where none
        was made). Retention of runs and reports leaves them.
    """

    state: str
    since: str
    pid: int
    last_good: LastGood | None = None
    kind: str = ""
    message: str = ""
    exit_code: int = 0
    began: str = ""
    nights: Sequence[Mapping[str, str]] = ()
    fault: bool = False

    @property
    def stale(self) -> bool:
        """Whether the last good report is older than the last attempt at a newer one."""
        return self.state != GOOD


def mark_running(settings: Settings) -> None:
    """Say that a run of the whole collection has begun; should it be killed, this stays."""
    now, before = _now(), status(settings)
    nights = _nights(before)
    if before is not None and before.state == RUNNING:
        # Runs follow one another under a lock: that one is gone.
        nights = _with(nights, INTERRUPTED, before.began or before.since, "")
    _write(settings, Status(RUNNING, now, os.getpid(), last_good(settings), began=now, nights=nights))


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
    told = _kept(_told(summary.report.resolve().parent))
    good = LastGood(summary.run_id, summary.finished, report, summary.reading, **told)
    now, began = _now(), _began(settings)
    nights = _with(_nights(status(settings)), GOOD, began, now, summary.run_id)
    _write(settings, Status(GOOD, now, os.getpid(), good, began=began, nights=nights))
    _reserve(root / RESERVE)


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
    code, now, began = exit_code_of(problem), _now(), _began(settings)
    # Who stops a run interrupts it; nothing failed.
    outcome = FAILED if isinstance(problem, Exception) else INTERRUPTED
    nights = _with(_nights(status(settings)), outcome, began, now)
    failed = Status(FAILED, now, os.getpid(), good, kind, message, code, began, nights, is_fault(problem))
    try:
        _write(settings, failed)
    except OSError as full:
        reserve = _root(settings) / RESERVE
        if full.errno not in FULL or not reserve.is_file():
            raise
        reserve.unlink()
        _write(settings, failed)


def _reserve(file: Path) -> None:
    """Keep some room of the disk for the page that says that a night failed for want of it."""
    with suppress(OSError):  # Where there is no room for that, nothing is lost yet.
        if not file.is_file() or file.stat().st_size < RESERVED:
            with replacing(file) as aside:
                # A disk that packs what it holds would keep none for noughts.
                aside.write_bytes(os.urandom(RESERVED))


def _nights(known: Status | None) -> list[Mapping[str, str]]:
    """Return the nights that a status keeps, as far as they can be read."""
    kept = [] if known is None or not isinstance(known.nights, list | tuple) else known.nights
    whole = [night for night in kept if isinstance(night, dict) and night.keys() == set(_NIGHT)]
    return [night for night in whole if all(isinstance(text, str) for text in night.values())]


def _with(
    nights: Sequence[Mapping[str, str]], state: str, began: str, ended: str, run_id: str = ""
) -> list[Mapping[str, str]]:
    told = dict(zip(_NIGHT, (began, ended, state, run_id), strict=True))
    return [*nights, told][-NIGHTS:]


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
        return LastGood(run, finished, f"{folder.name}/{LANDING}", told.get("reading"), **_kept(told))
    return said if said is not None and (root / said.report).is_file() else None


def reports_lost(settings: Settings, runs: int) -> str:
    """Say that none of the reports that were made is where they are; "" where one is, or none was made.

    Parameters
    ----------
    settings : Settings
        Of which the folder of reports counts.
    runs : int
        Nights of the whole collection that the database knows.

    Returns
    -------
    str
    """
    if not runs or last_good(settings) is not None:
        return ""
    return (
        f"{_root(settings)} holds no report, though {counted(runs, 'night')} of the whole collection ended well: see "
        "whether its drive is mounted, or [report] folder is another now"
    )


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


def _kept(told: Mapping[str, Any]) -> dict[str, Any]:
    """Return the numbers and the first news of a report's summary; None for what it does not say."""
    counts = {name: told.get(of) for name, of in _COUNTED.items()}
    changes = told.get("changes")
    news = None
    if isinstance(changes, dict) and isinstance(changes.get("news"), dict) and isinstance(changes.get("objects"), list):
        news = {
            "since": changes.get("started", ""),
            "counts": changes["news"].get("counts", {}),
            "because": changes["news"].get("because", []),
            "shared": changes.get("shared", {}),
            "objects": changes["objects"][:KEPT],
        }
    return {"counts": counts if all(isinstance(n, int) for n in counts.values()) else None, "news": news}


_COUNTED = {"act": "act", "watch": "watch", "unknown": "cannot", "fine": "fine"}


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
        write_aside(page, landing_page(asdict(now), settings.museum.name, spoken, settings.museum.time_zone))
    write_aside(root / STATUS, json.dumps(asdict(now), indent=2) + "\n")


def _root(settings: Settings) -> Path:
    return settings.path(settings.report.folder)


def _now() -> str:
    return datetime.now(UTC).isoformat(timespec="seconds")
