"""Looking at runs that are over: render one again, compare two."""

from pathlib import Path
from typing import TypedDict

from pipeline.jobs.outcome import SUMMARY, write_aside
from pipeline.jobs.standing import renew
from pipeline.jobs.workspace import UsageError, locked, open_workspace
from pipeline.records import RunChanges
from pipeline.report import Language, Units, language, publish, render
from pipeline.settings import Settings
from pipeline.store.reuse import whole_runs
from pipeline.store.runs import compare_runs, load_run


def render_again(settings: Settings, run_id: str | None) -> Path:
    """Render a run from the store into a new folder; the newest of the whole collection becomes the latest report.

    returns : the report's index
    """
    with locked(settings):
        workspace = open_workspace(settings)
        whole = whole_runs(workspace.engine)
        record = load_run(workspace.engine, run_id or (whole[0] if whole else None))
        # As on the night itself: against the whole run before it, and a part of the collection against none.
        at = whole.index(record.run_id) if record.run_id in whole else len(whole)
        before = whole[at + 1 : at + 2]
        changes = compare_runs(workspace.engine, before[0], record.run_id) if before else None
        index = render(record, _free(workspace.reports / record.run_id), changes=changes, **manner(settings))
        told = workspace.reports / record.run_id / SUMMARY
        if told.is_file():
            write_aside(index.with_name(SUMMARY), told.read_text(encoding="utf-8"))
        if [record.run_id] == whole[:1]:
            publish(index.parent, workspace.reports)
            renew(settings)
        return index


class Manner(TypedDict):
    """How a report is written: what `render` is told."""

    units: Units
    language: Language


def manner(settings: Settings) -> Manner:
    """Return the units and the language that the settings ask for.

    raises : ReportError for a language without a catalogue, or with a damaged one
    """
    asked = settings.report
    folder = settings.path(asked.catalogues) if asked.catalogues else None
    return {"units": Units(length=asked.length), "language": language(asked.language, folder)}


def _free(folder: Path) -> Path:
    # A report never overwrites another one.
    number = 2
    candidate = folder
    while candidate.exists():
        candidate = folder.with_name(f"{folder.name}-{number}")
        number += 1
    return candidate


def compare(settings: Settings, old: str | None, new: str | None) -> RunChanges:
    """Return what changed between two runs; the last two of the whole collection where none is named.

    raises : UsageError where there are not two runs yet
    """
    engine = open_workspace(settings).engine
    runs = whole_runs(engine)
    if new is None:
        if not runs or (old is None and len(runs) < 2):
            raise UsageError(
                f"there are {len(runs)} finished runs of the whole collection and two are needed; "
                "make another with `kouros run`"
            )
        new = runs[0]
    return compare_runs(engine, old or runs[1], new)
