"""Check whether the next night can run, and what to mend if not."""

import hashlib
import warnings
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import cache, partial
from pathlib import Path
from tempfile import TemporaryDirectory
from time import monotonic

from pipeline.collection.inventory import galleries, latest_import, read_inventory
from pipeline.collection.sources.registry import is_address
from pipeline.errors import KourosError
from pipeline.night.reading_summary import in_line, told, unsaid
from pipeline.night.source_state import mapping_of
from pipeline.operations.dry_run import DryRunWarning, read_only
from pipeline.operations.report_status import last_good
from pipeline.operations.secrets import hider
from pipeline.operations.workspace import Workspace, locked, open_workspace
from pipeline.quantities import counted
from pipeline.records import Item
from pipeline.settings import Settings, load_settings
from pipeline.tools import doctor_checks as checkup
from pipeline.tools.doctor_checks import look_at_house_rules

LONGEST = 10.0
"""Seconds that objects are tried for: some 100,000 of them."""


@dataclass(frozen=True)
class Diagnosis:
    """One thing looked at: whether it is well ("ok", "warning", "wrong"), and what mends it."""

    what: str
    state: str
    message: str


def diagnose(file: Path, *, migrate: bool = False) -> list[Diagnosis]:
    """Look at everything a night needs; every look is made, whatever the others found, and nothing is written.

    Parameters
    ----------
    migrate : bool, optional
        Bring the tables of the database to this version first.

    Returns
    -------
    list of Diagnosis
    """
    try:
        settings = load_settings(file)
    except ValueError as problem:
        return [Diagnosis("settings", "wrong", str(problem))]
    found = [Diagnosis("settings", "ok", str(file))]
    # SQLite needs a file for the tables that are not there yet.
    with TemporaryDirectory(prefix="kouros-check-") as folder:
        try:
            workspace, state, message = _opened(settings, Path(folder), migrate=migrate)
        except Exception as problem:  # noqa: BLE001 - a doctor reports whatever a database driver raises
            said = str(problem) if isinstance(problem, KourosError) else f"{type(problem).__name__}: {problem}"
            found.append(Diagnosis("database", "wrong", hider(settings)(said)))
            return [*found, *_each(settings, None)]
        found.append(Diagnosis("database", state, hider(settings)(message)))
        return [*found, *_each(settings, workspace)]


def _opened(settings: Settings, folder: Path, *, migrate: bool) -> tuple[Workspace, str, str]:
    """Return the workspace, to be read only, with the state of its database and a message."""
    if migrate:
        with locked(settings):
            open_workspace(settings)
    with warnings.catch_warnings(record=True) as warned:
        warnings.simplefilter("always", DryRunWarning)
        engine = read_only(settings, folder, "looking")
    said = [str(one.message) for one in warned if issubclass(one.category, DryRunWarning)]
    if said:
        return Workspace(settings, engine), "warning", "; ".join(said)
    return Workspace(settings, engine), "ok", f"{engine.dialect.name}, tables up to date"


def _each(settings: Settings, workspace: Workspace | None) -> list[Diagnosis]:
    looks: list[tuple[str, Callable[[], tuple[str, str]]]] = [
        ("collection", lambda: _collection(settings)),
        ("motions", lambda: _motions(settings)),
    ]
    if workspace is not None:
        items = cache(partial(read_inventory, workspace.engine))
        looks += [
            ("tables", lambda: _tables(workspace)),
            ("measures", lambda: _measures(workspace)),
            ("inventory", lambda: _inventory(workspace, items())),
            ("objects", lambda: _objects(workspace, items())),
            *([("house rules", lambda: look_at_house_rules(workspace, items()))] if settings.house else []),
        ]
    looks += checkup.looks(settings, workspace)
    hide = hider(settings)
    out = []
    for what, look in looks:
        try:
            state, message = look()
        except Exception as problem:  # noqa: BLE001 - one thing that is broken must not hide the others
            state, message = "wrong", str(problem) or type(problem).__name__
        out.append(Diagnosis(what, state, hide(message)))
    return out


STALE_D = 31.0
"""Days after which an export is told to be old: one that is made by hand comes once a month (judgement)."""


def _collection(settings: Settings) -> tuple[str, str]:
    wanted = settings.collection
    mapping_of(settings, wanted.mapping)
    if not wanted.source:
        return "ok", "no source: the inventory is used as it was last imported"
    if is_address(wanted.source):
        return "ok", f"a database, mapping {wanted.mapping}; `kouros import --dry-run` asks it"
    source = settings.path(wanted.source)
    if not source.exists():
        return "wrong", f"{source} is not there; export the collection to it, or change [collection] source"
    text = f"{source.name}, mapping {wanted.mapping}"
    # Of a folder its files say how old the export is, and of these the newest.
    files = [source, *(one for one in source.iterdir() if one.is_file())] if source.is_dir() else [source]
    age = (datetime.now(UTC).timestamp() - max(one.stat().st_mtime for one in files)) / 86_400.0
    if age < STALE_D:
        return "ok", text
    return "warning", f"{text}; written {age:.0f} days ago: see whether the export is still made"


def _motions(settings: Settings) -> tuple[str, str]:
    from pipeline.motions.doubts import doubts as doubtful
    from pipeline.motions.errors import MotionError
    from pipeline.motions.manifest import load_manifest, unlisted
    from pipeline.motions.site import levels_at, read_site
    from pipeline.night.floors import known
    from pipeline.operations.workspace import site_folder
    from pipeline.quantities import G

    folder = site_folder(settings.home, settings.site.folder)
    try:
        site = read_site(folder)
    except MotionError as problem:
        # That a new museum has no records yet is the next thing to do; one that had a night has lost them.
        if last_good(settings) is not None or load_manifest(folder, begun=True).level:
            raise
        return "warning", f"{problem}; no night can run before"
    # What topples an object is velocity more than acceleration: both are said.
    peaks = [
        f"{m.motion.name} {m.measures['pga'] / G:.2f} g, {100.0 * m.measures['pgv']:.0f} cm/s"
        for level in site.levels
        for m in level.motions
    ]
    text = f"{site.name} ({site.folder}): {'; '.join(peaks)}"
    known(settings, site)
    every = list(site.levels)
    for floor in site.floors:
        every += levels_at(site, floor)
        text += f"; floor {floor}"
    doubts = [f"level {level.name}: {level.caution}" for level in site.levels if level.caution]
    nobody = [level.name for level in site.levels if not level.approved_by]
    flat = [record.name for _, record in site.manifest.records() if record.vertical == "absent"]
    made = [record.name for _, record in site.manifest.records() if record.vertical == "estimated"]
    if flat:
        doubts.append(f"no vertical was recorded, and none shakes anything: {', '.join(flat)}")
    if made:
        doubts.append(f"no vertical was recorded, and one is estimated: {', '.join(made)}")
    # A floor's motion made of the ground's has its steps too.
    told = (f"{m.motion.name}: {doubt}" for v in every for m in v.motions for doubt in doubtful(m.motion.steps))
    doubts += dict.fromkeys(told)
    stray = unlisted(site.file, site.manifest)
    if stray:
        doubts.append(
            f"not in the manifest: {_hashed(site.folder, stray)}; `kouros motions entries` prints their entries"
        )
    if nobody:
        doubts.append(f"nobody has approved: {', '.join(nobody)} (approved_by in the manifest)")
    return ("warning", "; ".join([text, *doubts])) if doubts else ("ok", text)


def _hashed(folder: Path, names: Sequence[str], most: int = 5) -> str:
    told = [f"{name} (sha256 {hashlib.sha256((folder / name).read_bytes()).hexdigest()})" for name in names[:most]]
    return ", ".join(told) + (f" and {len(names) - most:,} more" if len(names) > most else "")


def _tables(workspace: Workspace) -> tuple[str, str]:
    rules, own = workspace.rules, workspace.values.own
    said = [f"{counted(number, 'row')} of {name}.csv" for name, number in own.items()]
    if rules is not None and workspace.settings.collection.rules:
        said.insert(0, f"rules in {workspace.settings.collection.rules}")
    return "ok", f"your own: {', '.join(said)}" if said else "rules and assumed values are Kouros's own"


def _measures(workspace: Workspace) -> tuple[str, str]:
    from pipeline.mitigate.measures import MEASURES

    have, left_out = workspace.measures, MEASURES.problems
    text = f"{counted(len(have.measures), 'measure')}, {counted(len(have.isolators), 'isolator')}"
    # What they take is read as a night reads it.
    text += f", {counted(len(workspace.plan_terms.efforts.rows), 'effort')}"
    return "warning" if left_out else "ok", "; ".join([text, *left_out])


def _inventory(workspace: Workspace, items: Sequence[Item]) -> tuple[str, str]:
    from pipeline.night.floors import strangers

    info = latest_import(workspace.engine)
    if info is None:
        return "warning", "nothing imported yet; `kouros import FILE` does that, `kouros run` too where a source is set"
    shown = sum(galleries(items).values())
    doubts = strangers(workspace.settings.floors, {item.gallery for item in items})
    read = told(workspace, workspace.object_index())
    text = f"{counted(len(items), 'object')}, {shown:,} on display, from {info.source} on {info.imported_at}; "
    text += f"read: {in_line(read)}"
    if read is None:
        return "warning", "; ".join([text, *doubts])
    doubts += [f"{one['message']}; {one['remedy']}" for one in read["suspicions"]]
    doubts += [unsaid(read["unsaid"])] if read["unsaid"] else []
    wrong = doubts or read["refused"] or read["sheets"]
    chosen = [f"settled by choice: {one['message']}; {one['remedy']}" for one in read["choices"]]
    return "warning" if wrong else "ok", "; ".join([text, *doubts, *chosen])


def _objects(workspace: Workspace, inventory: Sequence[Item]) -> tuple[str, str]:
    """Try on every object what comes before the models: its class, its numbers, its measures, what is to be run."""
    from pipeline.analysis.faults import apart, fault
    from pipeline.analysis.plan import plan
    from pipeline.night.assessment import place
    from pipeline.store.decisions import decisions_in_force

    items, decisions = [item for item in inventory if item.on_display], decisions_in_force(workspace.engine)

    rules, measures, house = workspace.rules, workspace.measures, workspace.house

    def tried(some: Sequence[Item]) -> Sequence[Item]:
        objects = [place(item, rules, decisions.get(item.object_number, ()), measures, house) for item in some]
        plan([one.scene for one in objects])
        return some

    bad, until, looked = [], monotonic() + LONGEST, 0
    while looked < len(items) and monotonic() < until:
        some = items[looked : looked + 1000]
        looked += len(some)
        found = zip(some, apart(tried, some, lambda item: item.support), strict=True)
        bad += [fault(item, problem) for item, problem in found if isinstance(problem, Exception)]
    text = f"{looked:,} of {len(items):,} on display tried: each can be classed and planned for"
    if not bad:
        return "ok", text
    return "warning", (
        f"Kouros fails on {len(bad):,} of {looked:,} objects, such as {bad[0].object_number}: {bad[0].words}; "
        "a night goes on without them, but please tell its makers"
    )
