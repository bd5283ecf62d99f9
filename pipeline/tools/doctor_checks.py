"""Checks of a doctor besides the inputs: the last night, the machine, the house rules, and all that is kept."""

import os
import shutil
import warnings
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from pipeline.analysis.house.matching import HouseEffect, HouseRules
from pipeline.cache import Cache
from pipeline.collection.database import database_url, open_for_reading, verify_file
from pipeline.errors import KourosError, near
from pipeline.extensions import ExtensionWarning, extension_versions
from pipeline.models import MODELS
from pipeline.night.house_effects import each_effect
from pipeline.operations.hooks import look, named
from pipeline.operations.report_status import FAILED, GOOD, RUNNING, last_good, reports_lost, status
from pipeline.operations.secrets import hider
from pipeline.operations.workspace import LOCK, LockedError, Workspace, locked
from pipeline.quantities import counted
from pipeline.records import Item, Progress
from pipeline.report.files.manifest import verify_report
from pipeline.report.files.sheet_fonts import fonts_here
from pipeline.settings import Settings
from pipeline.store import migrate
from pipeline.store.decisions import decisions_in_force
from pipeline.store.runs import list_runs
from pipeline.store.sound import whole_runs
from pipeline.store.verifying import tables, verify_columns, verify_table

SPACE = 1_000_000_000
"""Bytes of free disk below which a night may fail to write, whatever its last report weighed."""

OVERDUE_H = 36.0
"""Hours after which a nightly run is missing: a day, and the half of one for a night that was put off."""

Found = tuple[str, str]
"""State ("ok", "warning", "wrong") and message."""

Look = tuple[str, Callable[[], Found]]


def looks(settings: Settings, workspace: Workspace | None) -> Iterator[Look]:
    """Yield what to look at, by name; each look returns what it found, and may raise.

    Parameters
    ----------
    settings : Settings
        What is looked at.
    workspace : Workspace or None
        None where it could not be opened: less is looked at.

    Yields
    ------
    Look
        A name, and the look.
    """
    yield "disk", lambda: _disk(settings)
    yield "permissions", lambda: _permissions(settings)
    yield "kernels", _kernels
    yield "extensions", _extensions
    yield "lock", lambda: _lock(settings)
    yield "last report", lambda: _last_report(settings, workspace)
    yield "retention", lambda: _retention(settings)
    yield "hooks", lambda: _hooks(settings)
    yield "log", lambda: _log(settings)
    if settings.report.language[:2] in ("ja", "ko", "zh"):
        yield "fonts", _fonts
    if workspace is not None:
        yield "clock", lambda: _clock(workspace)


def _there(folder: Path) -> Path:
    """Return the folder, or the nearest one above it that exists."""
    while not folder.exists():
        folder = folder.parent
    return folder


def _disk(settings: Settings) -> Found:
    """Room for another report as large as the last one, and for the database to grow by half."""
    wanted = float(SPACE)
    good = last_good(settings)
    reports = settings.path(settings.report.folder)
    if good is not None:
        folder = (reports / good.report).parent
        wanted += 2.0 * sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())
    database = None if "://" in settings.database else Path(settings.database)
    if database is not None and database.is_file():
        wanted += 0.5 * database.stat().st_size
    places = {_there(folder) for folder in (reports, settings.home, *([database.parent] if database else []))}
    free, place = min((shutil.disk_usage(place).free, str(place)) for place in places)
    text = f"{free / 1e9:.1f} GB free at {place}, {wanted / 1e9:.1f} GB wanted for the next night"
    return ("ok", text) if free >= wanted else ("warning", f"{text}; make room, or set [retention]")


def _permissions(settings: Settings) -> Found:
    folders = [settings.home, settings.path(settings.report.folder), settings.kept]
    if settings.logs.file:
        folders.append(settings.path(settings.logs.file).parent)
    if "://" not in settings.database:
        folders.append(Path(settings.database).parent)
    closed = sorted({str(_there(f)) for f in folders if not os.access(_there(f), os.W_OK | os.X_OK)})
    if closed:
        return "wrong", f"{', '.join(closed)} cannot be written; change its permissions, or the folder in kouros.toml"
    file = settings.home / "kouros.toml"
    if os.name == "posix" and file.is_file() and file.stat().st_mode & 0o002:
        return "warning", f"everybody may change {file}, and with it the programs that hooks start: chmod o-w"
    return "ok", "reports, database, log and what is kept between nights can be written"


def _fonts() -> tuple[str, str]:
    here = fonts_here()
    if here:
        return "ok", f"{here[0].name} goes into the sheets to walk with"
    return "warning", (
        "this machine has no font of this script that may go into the sheets to walk with: a reader without one of its "
        "own shows empty cells; install one, such as Debian's fonts-ipafont-gothic, fonts-nanum or fonts-wqy-microhei"
    )


def _kernels() -> Found:
    from pipeline.kernels import KERNEL_VERSION, cache_folder

    folder = Path(cache_folder())
    if not os.access(_there(folder), os.W_OK):
        return "warning", f"{folder} cannot be written, so that every run compiles anew; set KOUROS_CACHE"
    compiled = sum(1 for _ in folder.rglob("*.nbc")) if folder.is_dir() else 0
    others = sum(1 for other in folder.parent.glob("kernels-*") if other != folder)
    text = f"version {KERNEL_VERSION}, {counted(compiled, 'piece')} of compiled code in {folder}"
    return "ok", f"{text}; {counted(others, 'folder')} of other versions may be deleted" if others else text


def _extensions() -> Found:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ExtensionWarning)
        problems = MODELS.problems
    if problems:
        return "warning", "; ".join(problems)
    installed = [f"{one.name} of {one.distribution} {one.version} ({one.group})" for one in extension_versions()]
    return "ok", ", ".join(installed) or "no other package brings parts of its own"


def _lock(settings: Settings) -> Found:
    if not (settings.home / LOCK).is_file():
        # To take it would make the file.
        return "ok", "no other run is at work"
    try:
        with locked(settings, sweeping=False):
            return "ok", "no other run is at work"
    except LockedError as problem:
        now = status(settings)
        holder = f" (process {now.pid}, since {now.since})" if now is not None and now.state == RUNNING else ""
        return "warning", f"{problem}{holder}"


def _last_report(settings: Settings, workspace: Workspace | None) -> Found:
    now = status(settings)
    good = last_good(settings)
    lost = "" if workspace is None else reports_lost(settings, len(whole_runs(workspace.engine)))
    if lost:
        return "warning", lost
    if good is None:
        said = f"; the last attempt failed: {now.message}" if now is not None and now.state == FAILED else ""
        return "warning", f"there is no good report yet{said}; `kouros run` makes one"
    text = f"{good.report}, of {good.finished or 'a run that did not say when'}"
    if now is not None and now.state == FAILED:
        return "warning", f"stale: {text}; the run of {now.since} failed: {now.message}"
    if now is not None and now.state == RUNNING and _lock(settings)[0] == "ok":
        return "warning", f"stale: {text}; the run that began at {now.since} was interrupted; run again"
    try:
        age = (datetime.now(UTC) - datetime.fromisoformat(good.finished)).total_seconds() / 3600.0
    except (ValueError, TypeError):
        return "ok", text
    if age < 0.0:
        return "warning", f"{text}, later than now: a clock was wrong then, or is now"
    if age > OVERDUE_H:
        return "warning", f"{text}, {age / 24.0:.1f} days ago; see whether the nightly run is still started"
    return "ok", f"{text}, {age:.1f} hours ago" + ("" if now is None or now.state == GOOD else "; a run is at work")


def _retention(settings: Settings) -> Found:
    limits = settings.retention
    if not (limits.runs or limits.reports or limits.days):
        return "warning", "every run and every report is kept for ever; set [retention] before the disk is full"
    said = [
        counted(limits.runs, "run") if limits.runs else "",
        counted(limits.reports, "report") if limits.reports else "",
        f"{limits.days:g} {'day' if limits.days == 1 else 'days'}" if limits.days else "",
    ]
    return "ok", f"{', '.join(filter(None, said))} kept at most; the last good ones always"


def _hooks(settings: Settings) -> Found:
    hooks = named(settings.hooks)
    if not hooks:
        return "ok", "none: nobody is told"
    wrong = [f"{name}: {problem}" for name, hook in hooks for problem in (look(hook),) if problem]
    if wrong:
        return "wrong", "; ".join(wrong)
    return "ok", f"{len(hooks)} found and not tried: {', '.join(name for name, _ in hooks)}"


def _log(settings: Settings) -> Found:
    if not settings.logs.file:
        return "ok", "none is kept; `kouros --log-json` writes one to standard error"
    path = settings.path(settings.logs.file)
    if path.exists() and not (path.is_file() and os.access(path, os.W_OK)):
        return "wrong", f"{path} cannot be written; change its permissions or [logs] file"
    return "ok", f"{path}, {counted(settings.logs.keep + 1, 'file')} of {settings.logs.megabytes:g} MB at most"


def _clock(workspace: Workspace) -> Found:
    now = datetime.now(UTC)
    runs = list_runs(workspace.engine)
    if runs and datetime.fromisoformat(runs[0].started) > now:
        told = f"the last run is of {runs[0].started}, later than now ({now.isoformat()})"
        return "wrong", f"{told}; set the clock, or where it is right now: run, then `kouros prune --ahead`"
    return "ok", now.isoformat(timespec="seconds")


@dataclass(frozen=True)
class Rot:
    """Something kept that is not what was written.

    Attributes
    ----------
    what
        "database", "cache" or "report".
    where
        The file, or the table and the row.
    why
        What is wrong with it; "" where the seal says no more than that.
    remedy
        What mends it.
    """

    what: str
    where: str
    why: str
    remedy: str


def examine(settings: Settings, progress: Progress) -> Iterator[Rot]:
    """Compare everything kept with what was written.

    Parameters
    ----------
    settings : Settings
        Of the museum.
    progress : Progress
        Told how far it is.

    Yields
    ------
    Rot
        For each thing that is damaged, as it is found.

    Raises
    ------
    StoreError
        For a database of another version of Kouros, which is to be brought up to date first.
    """
    yield from _database(settings, progress)
    progress.step("cache", 0, 1)
    for damage in Cache(settings.kept).verify():
        yield Rot("cache", str(damage.file), damage.why, "the next night that wants it makes it again")
    progress.step("cache", 1, 1)
    latest = settings.path(settings.report.folder) / "latest"
    if latest.exists():
        progress.step("report", 0, 1)
        for file, why in verify_report(latest.resolve()):
            yield Rot("report", str(file), why, "the next night makes it again")
        progress.step("report", 1, 1)


def _database(settings: Settings, progress: Progress) -> Iterator[Rot]:
    url = database_url(settings.database)
    hide, shown = hider(settings), url.render_as_string(hide_password=True)
    if url.get_backend_name() == "sqlite" and not Path(str(url.database)).is_file():
        return
    engine = open_for_reading(url)
    looks = ["file", "columns", *tables()]
    try:
        migrate.require_head(engine)
        for at, look in enumerate(looks):
            progress.step("database", at, len(looks))
            if look == "file":
                verify_file(engine, whole=True)
            else:
                for one in verify_columns(engine) if look == "columns" else verify_table(engine, look):
                    yield Rot("database", f"{shown}, table {one.table}: {one.row}", "", one.remedy)
        progress.step("database", len(looks), len(looks))
    except KourosError as problem:
        if type(problem) is migrate.OtherVersionError:
            raise
        yield Rot("database", shown, hide(str(problem)), "restore it from a backup, and see whether the disk is sound")


_MOST = 3
"""Objects that are named of those of which the same is said."""


def look_at_house_rules(workspace: Workspace, inventory: Sequence[Item]) -> tuple[str, str]:
    """Ask the house rules about all objects.

    Parameters
    ----------
    workspace : Workspace
        Whose rules are asked.
    inventory : sequence of Item
        All objects.

    Returns
    -------
    state : {"ok", "warning", "wrong"}
        Wrong where rules tie; a warning where one matches nothing, is never taken or contradicts a record.
    message : str
        What each rule matches, and what is doubtful.
    """
    house = workspace.house
    if house is None:
        return "ok", "none"
    effects = _effects(workspace, house, inventory)
    matched = Counter(at for _, effect in effects for at in effect.matched)
    used = Counter(at for _, effect in effects for at in effect.used)
    told = [f"{house.named(at)} matches {counted(times, 'object')}" for at, times in sorted(matched.items())]
    doubts = [_idle(house, at, matched[at], inventory) for at, rule in enumerate(house.rules)
              if rule.holds and not used[at]]  # fmt: skip
    against: dict[int, list[str]] = {}
    ties: dict[str, list[str]] = {}
    for item, effect in effects:
        for at, words in effect.overruled:
            against.setdefault(at, []).append(f"{item.object_number}: {words}")
        for words in effect.ties:
            ties.setdefault(words, []).append(item.object_number)
    doubts += [
        f"{house.named(at)} contradicts the record of {counted(len(some), 'object')}: {_listed(some)}"
        for at, some in sorted(against.items())
    ]
    wrong = [
        f"{words} ({counted(len(some), 'object')}: {_listed(some)}); name more in one of them, or take one out"
        for words, some in ties.items()
    ]
    state = "wrong" if wrong else "warning" if doubts else "ok"
    return state, "; ".join([*wrong, *doubts, *told])


def _effects(workspace: Workspace, house: HouseRules, inventory: Sequence[Item]) -> list[tuple[Item, HouseEffect]]:
    came = each_effect(house, inventory, workspace.rules, decisions_in_force(workspace.engine))
    return [(item, one) for item, one in zip(inventory, came, strict=True) if isinstance(one, HouseEffect)]


def _idle(house: HouseRules, at: int, matched: int, inventory: Sequence[Item]) -> str:
    if matched:
        why = "records or other rules say it, or it is of what is held in another way"
        return f"nothing of {house.named(at)} is taken: {why}"
    there = {item.gallery for item in inventory}
    strange = [name for name in house.rules[at].gallery if name not in there]
    hint = f": there is no gallery {strange[0]!r}{near(strange[0], there)}" if strange else ""
    return f"{house.named(at)} matches nothing{hint}"


def _listed(some: Sequence[str]) -> str:
    more = f" and {len(some) - _MOST:,} more" if len(some) > _MOST else ""
    return ", ".join(some[:_MOST]) + more
