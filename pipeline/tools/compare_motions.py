"""Comparison with other motions in the place of a site's: measures, and the verdicts of the last run."""

import tempfile
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import UTC, datetime
from pathlib import Path

from pipeline.collection.database import Database, open_database
from pipeline.motions.site import Level, Site, read_site, with_corner
from pipeline.night.prepare import admit, illustrate, pictures, run_context
from pipeline.night.publication import Publication
from pipeline.night.scheduler import Scheduler
from pipeline.night.staff import Staff
from pipeline.operations.workspace import Workspace, open_workspace
from pipeline.quantities import counted
from pipeline.records import Progress, VerdictChange
from pipeline.settings import Settings
from pipeline.store import migrate
from pipeline.store.decisions import decisions_in_force
from pipeline.store.runs import commit_run, compare_runs
from pipeline.store.sound import whole_runs


@dataclass(frozen=True)
class Pair:
    """A motion and the one that would take its place; "" where one of the two sites has no counterpart.

    Attributes
    ----------
    level : str
        The level of shaking.
    before, after : str
        The motions.
    same : bool
        Whether they are the same, sample for sample.
    measures : mapping of str to (float or None, float or None)
        By name, those of both (SI); None where there is no counterpart.
    """

    level: str
    before: str
    after: str
    same: bool
    measures: Mapping[str, tuple[float | None, float | None]]


@dataclass(frozen=True)
class Swap:
    """What a swap of one site for another would change.

    Attributes
    ----------
    old, new : str
        The sites.
    pairs : sequence of Pair
        Of their motions.
    basis : str
        Which verdicts are compared, in words; why there are none, where there are none.
    verdicts : sequence of VerdictChange
        That would change.
    moved : mapping of str to int
        How many of these go from one verdict to another.
    """

    old: str
    new: str
    pairs: Sequence[Pair]
    basis: str
    verdicts: Sequence[VerdictChange]
    moved: Mapping[str, int]


def compare_sites(
    old: Path, new: Path, settings: Settings | None, progress: Progress, *, corner: float | None = None
) -> Swap:
    """Compare two sites: the measures of their motions, and the verdicts of the last run under one and the other.

    Levels are paired by name, and those left over by their place; the motions of a level by their place.

    Parameters
    ----------
    old, new : Path
        Folders of the sites, or their manifests.
    settings : Settings or None
        Of the museum whose last run is looked at; None compares measures only.
    progress : callable
        Is told what is done, of how much.
    corner : float or None
        By which the high-pass corners of the new site are multiplied, of the records that are filtered here.

    Returns
    -------
    Swap
        What would change.

    Raises
    ------
    MotionError
        For a site that cannot be used.
    """
    kept = None if settings is None else settings.kept
    before, after = read_site(old, kept=kept), read_site(new, kept=kept)
    told = str(new)
    if corner is not None:
        after, told = with_corner(after, corner), f"{new}, high-pass corners times {corner:g}"
    after = replace(after, levels=_renamed(before.levels, after.levels))
    pairs = _pairs(before.levels, after.levels)
    basis, verdicts = _verdicts(before, after, settings, progress)
    words = Counter(f"{_word(v.before)} -> {_word(v.after)}" for v in verdicts)
    return Swap(f"{before.name} ({old})", f"{after.name} ({told})", pairs, basis, verdicts, dict(words.most_common()))


def _word(verdict: object) -> str:
    return "none" if verdict is None else str(verdict)


def _renamed(before: Sequence[Level], after: Sequence[Level]) -> tuple[Level, ...]:
    """The new levels under the names of those whose place they take."""
    free = [level.name for level in before if level.name not in {other.name for other in after}]
    names = {level.name for level in before}
    return tuple(level if level.name in names or not free else replace(level, name=free.pop(0)) for level in after)


def _pairs(before: Sequence[Level], after: Sequence[Level]) -> list[Pair]:
    pairs = []
    news = {level.name: level for level in after}
    for name in dict.fromkeys([*(level.name for level in before), *news]):
        old = next((level.motions for level in before if level.name == name), ())
        new = news[name].motions if name in news else ()
        for at in range(max(len(old), len(new))):
            a, b = (side[at] if at < len(side) else None for side in (old, new))
            keys = list(dict.fromkeys([*(a.measures if a else ()), *(b.measures if b else ())]))
            pairs.append(
                Pair(
                    level=name,
                    before=a.motion.name if a else "",
                    after=b.motion.name if b else "",
                    same=bool(a and b and a.motion.hash == b.motion.hash),
                    measures={
                        key: (a.measures.get(key) if a else None, b.measures.get(key) if b else None) for key in keys
                    },
                )
            )
    return pairs


def _verdicts(
    before: Site, after: Site, settings: Settings | None, progress: Progress
) -> tuple[str, Sequence[VerdictChange]]:
    if settings is None:
        return "no kouros.toml here, so there is no run whose verdicts could change", ()
    workspace = open_workspace(settings)
    runs = whole_runs(workspace.engine)
    if not runs:
        return "there is no run yet whose verdicts could change; make one with `kouros run`", ()
    with tempfile.TemporaryDirectory() as folder:
        engine = open_database(str(Path(folder) / "swap.sqlite"))
        migrate.upgrade(engine)
        fresh = _assessed(workspace, before, "before", engine, progress)
        _assessed(workspace, after, "after", engine, progress)
        changes = compare_runs(engine, "before", "after")
        engine.dispose()
    basis = f"the verdicts of the last run, {runs[0]}"
    if fresh:
        basis += f"; run now: {counted(fresh, 'object')} that it did not have on these motions and records"
    return basis, changes.verdicts


def _assessed(workspace: Workspace, site: Site, name: str, engine: Database, progress: Progress) -> int:
    """Keep a run of the inventory on a site's motions in a database of its own; results that are there are taken over.

    Returns
    -------
    int
        How many objects had no result yet.
    """
    everything = workspace.object_index()
    with pictures(workspace, site) as drawing:
        context = run_context(workspace, site, everything, everything.objects, datetime.now(UTC))
        illustrate(context, drawing, progress)
    charts, _ = admit(workspace, context, everything, everything.objects, site.manifest.site.x_azimuth)
    decisions = decisions_in_force(workspace.engine)
    with Staff(workspace.settings.execution) as staff:
        night = Scheduler(workspace, context, everything, everything.objects, decisions, staff, charts)
        night.assess(progress, store=False)
        night.copy_results(engine)
        head = replace(context.head, run_id=name, finished=context.head.started)
        shown = Publication(night)
        commit_run(engine, head, shown.pages, shown.rows(kept=True), counts={})
    return night.fresh
