"""Summary of a night, for programs: the document of `kouros run --json`, of summary.json and of the hooks."""

import errno
import json
import math
import os
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from pipeline.errors import FAULT, KourosError, fault_words
from pipeline.records import RunChanges
from pipeline.report.pages.news import kind_counts, news_line, sentences, shared_causes
from pipeline.resources import replacing

SUMMARY = "summary.json"
"""The file beside a report's index."""

LISTED = 1000
"""Changes of each kind that the file lists; `kouros diff --json` has all."""

FULL = frozenset({errno.ENOSPC, errno.EDQUOT})
"""Errors of a disk, or of somebody's share of one, that is full."""

_AWAY = ("ESTALE", "ENOTCONN", "ENODEV", "ENXIO", "EIO", "EHOSTDOWN", "EHOSTUNREACH", "ETIMEDOUT", "EREMOTEIO")
_REMEDIES = {
    errno.EROFS: "the disk of {file} can only be read now, as is done to a disk that failed: see to the disk, have "
    "it mounted for writing, then run again",
    errno.EACCES: "Kouros may not use {file}: give its account the right to, then run again",
    errno.EPERM: "Kouros may not use {file}: give its account the right to, then run again",
} | {
    getattr(errno, name): "the disk or share of {file} does not answer: see whether it is there and mounted, then run "
    "again"
    for name in _AWAY
    if hasattr(errno, name)
}
"""Errors of disks, and what people can do about them."""

_KINDS = ("objects", "added", "removed", "moved", "inputs", "verdicts", "motions", "decisions", "settings", "versions")


@dataclass(frozen=True)
class Stores:
    """Objects that are not on display and were assessed all the same: act + watch + fine + cannot are all of them."""

    act: int
    watch: int
    fine: int
    cannot: int
    findings: int
    measures: Mapping[str, int]


@dataclass(frozen=True)
class Summary:
    """What a run did, for one screen and for programs.

    Attributes
    ----------
    run_id : str
        Of the run.
    started, finished : str
        ISO 8601, UTC.
    version : str
        Of Kouros.
    museum, site : str
        Their names.
    objects : int
        Of the run; those on display are act + watch + fine + cannot, and the numbers besides are theirs.
    on_display, galleries, assessed, cannot, act, watch, fine, findings : int
        How many of each.
    measures : mapping of str to int
        How many of each measure.
    missing : mapping of str to int
        Why objects could not be assessed, with how many of each.
    first : sequence of str
        Lines of the first objects that are not settled.
    stands_by : mapping of str to int
        How many by where it is known from what they stand on: an `Origin`.
    open_for : mapping of str to int
        About how many one measurement may change what is decided, by the parameter that is to be measured.
    check : int
        Of those to act on, how many have a record that is to be checked first.
    levels : sequence of mapping
        Of each level of shaking its name, its return period (years, None where the manifest has none), and how many
        objects are to be acted on, to be watched and fine at it.
    faults : int
        How many objects Kouros itself failed on; the log has the tracebacks.
    fresh : int
        Of the assessed, those whose results were found now; the others' rest on nothing that has changed.
    stores : Stores or None
        What is not on display, where it was asked for.
    reading : mapping or None
        What was refused and is doubted of the museum's records, see `readings.told`; None: not known.
    worth : int or None
        How many measurements would settle a verdict, None where that was not asked.
    survey_seconds : float
        What asking cost, in s.
    decisions : mapping of str to int
        How many of each kind are in force.
    doubted : sequence of str
        Those of them that must be looked at again, with the reasons.
    efforts : sequence of mapping
        What the verdicts of each model took, see `pipeline.analysis.refinement.Effort`.
    report : Path or None
        The report's index, None for a dry run.
    latest : Path or None
        The link to the newest report, where there is one.
    exit_code : int
        Of the command: 0, or 3 of a strict run where objects could not be assessed.
    changes : RunChanges or None
        Since the run before.
    """

    run_id: str
    started: str
    finished: str
    version: str
    museum: str
    site: str
    objects: int
    on_display: int
    galleries: int
    assessed: int
    cannot: int
    act: int
    watch: int
    fine: int
    findings: int
    measures: Mapping[str, int]
    missing: Mapping[str, int]
    first: Sequence[str]
    stands_by: Mapping[str, int]
    open_for: Mapping[str, int] = field(default_factory=dict)
    check: int = 0
    levels: Sequence[Mapping[str, Any]] = ()
    faults: int = 0
    fresh: int = 0
    stores: "Stores | None" = None
    reading: Mapping[str, Any] | None = None
    worth: int | None = None
    survey_seconds: float = 0.0
    decisions: Mapping[str, int] = field(default_factory=dict)
    doubted: Sequence[str] = ()
    efforts: Sequence[Mapping[str, Any]] = ()
    report: Path | None = None
    latest: Path | None = None
    exit_code: int = 0
    changes: RunChanges | None = field(default=None, repr=False)


def summary_document(summary: Summary, *, most: int | None = None, base: Path | None = None) -> dict[str, Any]:
    """Return a summary as schemas/run-summary.schema.json describes it.

    Parameters
    ----------
    summary : Summary
        Of a run.
    most : int or None
        Changes of each kind that are listed, all of them where None; how many there are is told in any case.
    base : Path or None
        Paths are told from this folder on, so that a report that is moved or published names no place of the machine.

    Returns
    -------
    dict
        JSON-ready.
    """
    plain: dict[str, Any] = dict(vars(summary))
    changes: RunChanges | None = plain.pop("changes")
    for name in ("report", "latest"):
        path: Path | None = plain[name]
        plain[name] = None if path is None else str(path if base is None else _from(path, base))
    plain["not_on_display"] = summary.objects - summary.on_display
    plain["stores"] = None if summary.stores is None else asdict(summary.stores)
    plain["changes"] = None if changes is None else _counted(changes, most)
    document: dict[str, Any] = json_ready(plain)
    return document


def _from(path: Path, base: Path) -> Path:
    # The link itself is meant, not what it points at.
    return Path(os.path.relpath(path.parent.resolve() / path.name, base.resolve()))


def _counted(changes: RunChanges, most: int | None) -> dict[str, Any]:
    counts = {kind: len(getattr(changes, kind)) for kind in _KINDS}
    counts |= {"worsened": len(changes.worsened), "fixed": len(changes.fixed)}
    plain = plain_changes(changes)
    news = {
        "counts": kind_counts(changes),
        "because": shared_causes(changes),
        "sentences": sentences(changes),
    }
    return {"counts": counts, "news": news, **{name: v[:most] if name in _KINDS else v for name, v in plain.items()}}


def plain_changes(changes: RunChanges) -> dict[str, Any]:
    """Return the changes for JSON; each verdict's says whether it is fixed or worsened, each object's is a sentence."""
    plain = asdict(changes)
    for row, one in zip(plain["objects"], changes.objects, strict=True):
        line = news_line(one)
        row |= {"kind": line.kind.value, "text": line.sentence}
    for row, change in zip(plain["verdicts"], changes.verdicts, strict=True):
        row |= {"fixed": change.fixed, "worsened": change.worsened}
    return plain


def json_ready(value: Any) -> Any:
    """Return a value of texts, numbers, lists and mappings as JSON can hold it: None for infinity and no number."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, Mapping):
        return {str(key): json_ready(one) for key, one in value.items()}
    return [json_ready(one) for one in value] if isinstance(value, list | tuple) else value


def exit_code_of(problem: BaseException) -> int:
    """Return the exit code of the command that ends with this error."""
    if not isinstance(problem, Exception):
        return getattr(problem, "exit_code", 130)  # stopped, see `pipeline.operations.stopping`
    return problem.exit_code if isinstance(problem, KourosError) else 1


def is_fault(problem: BaseException) -> bool:
    """Say whether Kouros itself is at fault: nothing that people can mend, no stop by hand, and no system's error."""
    mended = isinstance(problem, KourosError) or not isinstance(problem, Exception)
    return not mended and not (isinstance(problem, OSError) and problem.errno is not None)


def words_of(problem: BaseException) -> str:
    """Return an error in words: what people can mend as it says; a fault of Kouros as such, with its place."""
    if isinstance(problem, KeyboardInterrupt):
        return str(problem) or "it was stopped by hand"
    hint = "run again with --debug for the traceback"
    if is_fault(problem):
        return f"{FAULT}: {fault_words(problem)}; {hint}"
    if isinstance(problem, KourosError) or not isinstance(problem, OSError):
        return str(problem)
    # Of a link and of a renaming the second is what was to be made.
    file = problem.filename2 or problem.filename
    if problem.errno in _REMEDIES and file is not None:
        return f"{_REMEDIES[problem.errno].format(file=file)} ({problem.strerror})"
    if problem.errno in FULL:
        where = "the disk" if file is None else f"the disk of {file}"
        return f"no space is left on {where}: make room (`kouros prune` removes old reports), then run again"
    return f"{problem} ({type(problem).__name__}; {hint})"


def summary_text(summary: Summary, folder: Path) -> str:
    """Return the contents of summary.json, which lies beside a report's index.

    Parameters
    ----------
    summary : Summary
        Of a run.
    folder : Path
        Of the report; paths in the file are told from it.

    Returns
    -------
    str
        JSON, with a line end.
    """
    return json.dumps(summary_document(summary, most=LISTED, base=folder), indent=2, allow_nan=False) + "\n"


def write_aside(path: Path, text: str) -> None:
    """Put a file in place of another by one rename, so that nobody ever reads half of it.

    Parameters
    ----------
    path : Path
        The file.
    text : str
        What it shall hold, in UTF-8.
    """
    with replacing(path) as aside:
        aside.write_text(text, encoding="utf-8", newline="\n")
