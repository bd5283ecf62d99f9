"""The folder into which filled-in surveys are put: a night takes them up first, and never fails on one."""

import logging
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from pipeline.errors import KourosError, fault_words
from pipeline.operations.dry_run import rehearsed
from pipeline.operations.event_log import note
from pipeline.operations.workspace import locked, open_workspace
from pipeline.quantities import counted
from pipeline.settings import Settings
from pipeline.tools.sheet_answers import SheetTaken, bounded, take_sheet
from pipeline.tools.sheet_heads import OTHER_BOOKS

TAKEN, REFUSED = "taken", "refused"
"""Folders in it: of what was taken up, and of what was refused, with the reasons."""

ENDINGS = (".xlsx", ".csv", *OTHER_BOOKS)
"""Of the others than the first two it is said that they are not read: nobody else tells who put them there."""

SETTLING = 60.0
"""Seconds in which a file that cannot be read may still be on its way into the folder."""

OPEN = 86_400.0
"""Seconds for which the lock beside a workbook says that somebody has it open; an older one was left by a crash."""

_LONGEST = 4_000


@dataclass(frozen=True)
class InboxFile:
    """A file of the folder, and what became of it.

    Attributes
    ----------
    name : str
        Of the file.
    words : str
        What became of it, in a line.
    ok : bool
        Whether it was taken up; cells of it may have been refused all the same.
    """

    name: str
    words: str
    ok: bool


def take_inbox(settings: Settings, config: Path, *, dry_run: bool = False) -> list[InboxFile]:
    """Take up what lies in the folder that the settings name, the oldest first.

    What was taken goes into the folder "taken" in it; what was refused into "refused", with its reason in a text beside
    it, and so do the copies in which refused cells are marked.  A file that is taken twice changes nothing more.

    Parameters
    ----------
    settings : Settings
        Of the workspace.
    config : Path
        Their file, which gets the house rules.
    dry_run : bool
        Only say what would be taken; no file is moved.

    Returns
    -------
    list of InboxFile
        What became of each file; nothing raises.
    """
    if not settings.survey.inbox:
        return []
    inbox = settings.path(settings.survey.inbox)
    try:
        files = _waiting(inbox)
    except OSError as problem:
        return [_told(inbox.name, f"the folder {inbox} cannot be read: {problem.strerror}; see to it", ok=False)]
    out = []
    for file in files:
        try:
            out.append(_one(settings, config, file, dry_run=dry_run))
        except Exception as problem:  # noqa: BLE001 - no file that somebody drops there ends a night
            out.append(_told(file.name, f"is left there: {fault_words(problem)}", ok=False))
    return out


def _waiting(inbox: Path) -> list[Path]:
    """Return the files that wait; hidden ones, locks of spreadsheet programs, and links are none."""
    found = [
        file
        for file in inbox.iterdir()
        if file.suffix.lower() in ENDINGS
        and not file.name.startswith((".", "~$"))
        and file.is_file()
        and not file.is_symlink()
    ]
    return sorted(found, key=lambda file: (file.stat().st_mtime_ns, file.name))


def _opened(file: Path) -> bool:
    """Say whether a spreadsheet program has a file open: Excel and LibreOffice each put a lock beside it."""
    for lock in (file.with_name(f"~${file.name}"), file.with_name(f".~lock.{file.name}#")):
        try:
            if datetime.now().timestamp() - lock.stat().st_mtime < OPEN:
                return True
        except OSError:
            continue
    return False


def _one(settings: Settings, config: Path, file: Path, *, dry_run: bool) -> InboxFile:
    if _opened(file):
        return _told(file.name, "is left there until the next night: somebody has it open", ok=False)
    try:
        with rehearsed(settings, dry_run) as lent, locked(lent):
            taken = take_sheet(open_workspace(lent), config, file, dry_run=dry_run, beside=file.parent / REFUSED)
    except KourosError as problem:
        if getattr(problem, "exit_code", 0) == 6:
            # Another run holds the lock: this is no fault of the file.
            raise
        return _refused(file, str(problem), dry_run=dry_run)
    words = _in_words(taken, dry_run=dry_run)
    if taken.empty:
        first = taken.faults[0]
        return _refused(file, f"all of it, {counted(len(taken.faults), 'cell')}; {first}", dry_run=dry_run)
    if not dry_run:
        _moved(file, TAKEN)
    return _told(file.name, words, ok=True)


def _refused(file: Path, why: str, *, dry_run: bool) -> InboxFile:
    if not dry_run and datetime.now().timestamp() - file.stat().st_mtime < SETTLING:
        return _told(file.name, f"is left there until the next night, as it is new: {why}", ok=False)
    if not dry_run:
        target = _moved(file, REFUSED)
        target.with_name(f"{target.name}.txt").write_text(f"{why[:_LONGEST]}\n", encoding="utf-8", errors="replace")
    return _told(file.name, f"{'would be refused' if dry_run else 'refused'}: {why}", ok=False)


def _moved(file: Path, folder: str) -> Path:
    """Move a file into a folder beside it, under a name that nothing there has."""
    target = file.parent / folder / f"{datetime.now():%Y%m%dT%H%M%S}-{bounded(file.stem)}{file.suffix}"
    target.parent.mkdir(exist_ok=True)
    first, number = target.stem, 2
    while target.exists():
        target = target.with_name(f"{first}-{number}{target.suffix}")
        number += 1
    file.replace(target)
    return target


def _in_words(taken: SheetTaken, *, dry_run: bool) -> str:
    measured = 0 if taken.changes is None else len(taken.changes.changed)
    parts = [
        f"{counted(measured, 'object')} given measurements" if measured else "",
        f"{counted(len(taken.decisions), 'decision')}" if taken.decisions else "",
        f"{counted(taken.rules.count('[[house]]'), 'house rule')}" if taken.rules else "",
        f"{counted(len(taken.faults), 'refused cell')}{f' (see {taken.marked})' if taken.marked else ''}"
        if taken.faults
        else "",
    ]
    said = ", ".join(filter(None, parts)) or "nothing new in it"
    return f"{'would be taken up' if dry_run else 'taken up'}: {said}"


def _told(name: str, words: str, *, ok: bool) -> InboxFile:
    # In a line each, whatever a file is called.
    name, words = ("".join(c if c.isprintable() else "?" for c in text) for text in (name, words))
    note("survey.inbox", level=logging.INFO if ok else logging.WARNING, file=name, message=words)
    return InboxFile(name, words, ok)
