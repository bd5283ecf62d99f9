"""Looking at runs that are over: render one again, compare two."""

from pathlib import Path

from pipeline.night.photographs import Photographs
from pipeline.night.reading_summary import doubts_of
from pipeline.operations.report_status import presentation, renew, terms_of
from pipeline.operations.run_summary import SUMMARY
from pipeline.operations.workspace import UsageError, locked, open_workspace
from pipeline.quantities import counted
from pipeline.records import RunChanges
from pipeline.report import publish
from pipeline.report.files.page_renderer import PageRenderer
from pipeline.report.files.report_writer import ReportWriter
from pipeline.report.render import draw_all
from pipeline.settings import Settings
from pipeline.store.pages import load_page
from pipeline.store.runs import changes_since, compare_runs, load_head
from pipeline.store.sound import whole_runs


def render_again(settings: Settings, run_id: str | None) -> Path:
    """Render a run from the store into a new folder; the newest of the whole collection becomes the latest report.

    Nothing is computed again, and one page at a time is in memory.

    Parameters
    ----------
    settings : Settings
        Of the workspace.
    run_id : str or None
        None: the newest of the whole collection.

    Returns
    -------
    Path
        The report's index.
    """
    with locked(settings):
        workspace = open_workspace(settings)
        engine, whole = workspace.engine, whole_runs(workspace.engine)
        head, pages = load_head(engine, run_id or (whole[0] if whole else None))
        # As on the night itself: against the whole run before it, and a part of the collection against none.
        at = whole.index(head.run_id) if head.run_id in whole else len(whole)
        before = whole[at + 1 : at + 2]
        changes = changes_since(engine, before[0], head.run_id) if before else None
        found = ((page, load_page(engine, page.key)) for page in pages)
        told = workspace.reports / head.run_id / SUMMARY
        beside = {SUMMARY: told.read_text(encoding="utf-8")} if told.is_file() else {}
        renderer = PageRenderer(head, **presentation(settings))
        with ReportWriter(_free(workspace.reports / head.run_id), renderer) as writer:
            photographs = Photographs(workspace)
            photographs.recall()
            doubts, terms = doubts_of(workspace, head), terms_of(workspace)
            index = draw_all(writer, head, found, changes, beside, doubts, terms, photographs.of)
        if [head.run_id] == whole[:1]:
            publish(index.parent, workspace.reports)
            renew(settings)
        return index


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

    Parameters
    ----------
    settings : Settings
        Of the workspace.
    old, new : str or None
        Ids of the runs.

    Returns
    -------
    RunChanges
        From the old one to the new one.

    Raises
    ------
    UsageError
        Where there are not two runs yet.
    """
    engine = open_workspace(settings).engine
    runs = whole_runs(engine)
    if new is None:
        if not runs or (old is None and len(runs) < 2):
            there = f"there {'is' if len(runs) == 1 else 'are'} {counted(len(runs), 'finished run')}"
            raise UsageError(f"{there} of the whole collection and two are needed; make another with `kouros run`")
        new = runs[0]
    return compare_runs(engine, old or runs[1], new)
