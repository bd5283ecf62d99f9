"""Monitor of a night: the log, the mark on the last report, the hooks, and tidying up after a good one."""

import logging
import sys
from collections.abc import Callable, Mapping
from dataclasses import asdict
from datetime import UTC, datetime
from threading import Lock
from time import perf_counter
from typing import Any

from pipeline import __version__
from pipeline.collection.errors import ShrunkError
from pipeline.operations.event_log import note
from pipeline.operations.hooks import tell
from pipeline.operations.report_status import last_good, mark_failed
from pipeline.operations.retention import prune
from pipeline.operations.run_summary import Summary, exit_code_of, summary_document, words_of
from pipeline.operations.stopping import stoppable
from pipeline.operations.workspace import LockedError
from pipeline.quantities import counted
from pipeline.records import RunChanges
from pipeline.report.pages.news import sentences
from pipeline.settings import Settings
from pipeline.settings.operations import Event

TOLD = 100
"""Changes of each kind that a hook is told; summary.json beside the report has more."""


def watched(settings: Settings, work: Callable[[], Summary], hide: Callable[[str], str], *, whole: bool) -> Summary:
    """Do a night's work, and say what became of it wherever the settings want to hear it.

    Parameters
    ----------
    settings : Settings
        With log, hooks and retention.
    work : callable
        The run itself.
    hide : callable
        Takes the secrets out of a text.
    whole : bool
        Whether it is of the whole collection; a part, and a dry run, are logged only.

    Returns
    -------
    Summary
        What the work returns.

    Raises
    ------
    BaseException
        What the work raises; what fails beside it is said and logged, and raises nothing.
    """
    began = perf_counter()
    ended = Lock()

    def failed(problem: BaseException) -> None:
        # Once: where the night is stopped, by the main thread, or else by the one that ends the process.
        if ended.acquire(blocking=False):
            _failed(settings, problem, hide, whole=whole, seconds=perf_counter() - began)

    with stoppable(failed):
        note("run.started", version=__version__, museum=settings.museum.name, whole=whole)
        try:
            summary = work()
            ended.acquire(blocking=False)
        except LockedError as problem:
            # The other run says how the report stands.
            note("run.locked", level=logging.WARNING, message=str(problem), exit_code=problem.exit_code)
            raise
        except BaseException as problem:
            failed(problem)
            raise
        _finished(settings, summary, hide, whole=whole, seconds=perf_counter() - began)
    return summary


def _failed(
    settings: Settings, problem: BaseException, hide: Callable[[str], str], *, whole: bool, seconds: float
) -> None:
    shrunk = isinstance(problem, ShrunkError)
    message = hide(words_of(problem) or type(problem).__name__)
    code = exit_code_of(problem)
    note(
        "run.shrunk" if shrunk else "run.failed",
        level=logging.ERROR,
        kind=type(problem).__name__,
        message=message,
        exit_code=code,
        seconds=round(seconds, 3),
    )
    if not whole:
        return
    _beside(
        "to say it on the landing page, which still shows the night before,",
        lambda: mark_failed(settings, problem, message),
        hide,
    )
    if isinstance(problem, Exception):  # Who stops a run by hand knows of it.
        event: Event = "shrunk" if shrunk else "failed"
        words = f"The run published nothing: {message}" if shrunk else f"The run failed: {message}"
        error = {"kind": type(problem).__name__, "message": message}
        _tell(settings, event, _document(settings, event, words, code, error, None), hide)


def _finished(settings: Settings, summary: Summary, hide: Callable[[str], str], *, whole: bool, seconds: float) -> None:
    changes = summary.changes
    counts = {name: getattr(summary, name) for name in ("objects", "assessed", "cannot", "act", "watch", "fine")}
    note(
        "run.finished",
        run=summary.run_id,
        seconds=round(seconds, 3),
        exit_code=summary.exit_code,
        **counts,
        findings=summary.findings,
        not_on_display=summary.objects - summary.on_display,
        refused=None if summary.reading is None else summary.reading["refused"],
        doubtful=None if summary.reading is None else summary.reading["doubtful"],
        objects_changed=None if changes is None else len(changes.objects) + sum(changes.shared.values()),
        verdicts_changed=None if changes is None else len(changes.verdicts),
        report=None if summary.report is None else str(summary.report),
    )
    if not whole:
        return
    if changes is not None and (changes.objects or changes.shared or changes.verdicts):
        words = " ".join([*sentences(changes), *_verdicts_said(changes)])
        root = settings.path(settings.report.folder)
        plain = summary_document(summary, most=TOLD, base=root)
        document = _document(settings, "changed", words, plain["exit_code"], None, plain)
        _tell(settings, "changed", document, hide)
    _beside("tidying up", lambda: _tidy(settings), hide)


def _verdicts_said(changes: RunChanges) -> list[str]:
    if not changes.verdicts:
        return []
    objects = len({change.object_number for change in changes.verdicts})
    return [
        f"{counted(len(changes.verdicts), 'verdict')} of {counted(objects, 'object')} changed: "
        f"{len(changes.worsened):,} passed and no longer, {len(changes.fixed):,} failed and now pass, "
        f"{len(changes.others):,} otherwise."
    ]


def tell_shaken(settings: Settings, message: str, answer: Mapping[str, Any], hide: Callable[[str], str]) -> None:
    """Tell hooks what an earthquake probably did.

    Parameters
    ----------
    settings : Settings
        With log and hooks.
    message : str
        What happened, in a sentence.
    answer : mapping
        As `kouros event --json` prints it; its objects are not sent, only where they are.
    hide : callable
        Takes the secrets out of a text.
    """
    note("event.answered", message=message, folder=answer["event"]["folder"])
    told = {name: answer[name] for name in ("event", "shaking", "expected", "galleries")}
    _tell(settings, "shaken", _document(settings, "shaken", message, 0, None, None) | {"earthquake": told}, hide)


def _tidy(settings: Settings) -> None:
    done = prune(settings)
    if done.runs or done.reports:
        note("pruned", runs=list(done.runs), reports=list(done.reports))


def _document(
    settings: Settings,
    event: Event,
    message: str,
    exit_code: int,
    error: dict[str, str] | None,
    summary: dict[str, Any] | None,
) -> dict[str, Any]:
    good = last_good(settings)
    return {
        "event": event,
        "time": datetime.now(UTC).isoformat(timespec="seconds"),
        "version": __version__,
        "museum": settings.museum.name,
        "message": message,
        "exit_code": exit_code,
        "error": error,
        "summary": summary,
        "last_good": None if good is None else asdict(good),
    }


def _tell(settings: Settings, event: Event, document: dict[str, Any], hide: Callable[[str], str]) -> None:
    for told in tell(settings.hooks, event, document, hide):
        if told.problem:
            note("hook.failed", level=logging.ERROR, about=event, hook=told.hook, message=told.problem)
            print(f"kouros: {told.hook} was not told: {told.problem}", file=sys.stderr)
        else:
            note("hook.told", about=event, hook=told.hook)


def _beside(what: str, work: Callable[[], None], hide: Callable[[str], str]) -> None:
    try:
        work()
    except Exception as problem:  # noqa: BLE001 - the night itself is over; what is beside it must not change its end
        said = hide(words_of(problem))
        note("beside.failed", level=logging.ERROR, what=what, message=said)
        print(f"kouros: {what} failed: {said}", file=sys.stderr)
