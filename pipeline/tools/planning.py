"""The plan of the newest run, on other terms than the report's: other hours, other galleries, other files."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from pipeline.errors import near
from pipeline.operations.report_status import presentation
from pipeline.operations.workspace import UsageError, Workspace
from pipeline.planning.choice import EffortLimits
from pipeline.planning.plan import ErrandPlan
from pipeline.records import Page, RunRecord
from pipeline.report.files.plan_files import Gathered, gathered, write_plan_sheet, write_plan_table
from pipeline.report.pages.compose import page_head
from pipeline.report.pages.errand_views import plan_page
from pipeline.resources import replacing
from pipeline.store.codec import StoreError
from pipeline.store.pages import load_page
from pipeline.store.runs import load_head
from pipeline.store.sound import whole_runs

ENDINGS = (".xlsx", ".csv", ".html")
"""Of the files that a plan is written to."""


@dataclass(frozen=True)
class Planned:
    """A plan, the run that it is of, and where it was written.

    Attributes
    ----------
    head : RunRecord
        The run without its objects.
    plan : ErrandPlan
        The plan.
    path : Path or None
        The file; None where none was asked for.
    """

    head: RunRecord
    plan: ErrandPlan
    path: Path | None = None


def plan_museum(
    workspace: Workspace,
    limits: EffortLimits,
    *,
    galleries: Sequence[str] = (),
    path: Path | None = None,
    dry_run: bool = False,
) -> Planned:
    """Choose what to do of what the newest run of the whole collection advises; nothing is computed again.

    Parameters
    ----------
    workspace : Workspace
        Whose run it is.
    limits : EffortLimits
        What there is; hours and cost that it leaves out are those of the settings.
    galleries : sequence of str
        Only these; none named means all.
    path : Path or None
        A workbook, a table or a page, by its ending; None: nothing is written.
    dry_run : bool
        Write nothing.

    Returns
    -------
    Planned
        The plan.

    Raises
    ------
    UsageError
        For a gallery that the run does not have, a file of another ending, and a run that did not ask how likely harm
        is.
    StoreError
        Where there is no run yet, or something of it is damaged.
    """
    if path is not None and path.suffix.lower() not in ENDINGS:
        raise UsageError(f"{path}: a plan is written as {', '.join(ENDINGS)}; give the file one of these endings")
    whole = whole_runs(workspace.engine)
    if not whole:
        raise StoreError("there is no finished run of the whole collection to plan by; make one with `kouros run`")
    head, pages = load_head(workspace.engine, whole[0])
    names = {page.gallery for page in pages if page.on_display}
    for name in galleries:
        if name not in names:
            raise UsageError(f"there is no gallery {name!r} in run {head.run_id}{near(name, names)}")
    found = _gathered(workspace, head, pages, galleries)
    if not found.losses:
        raise UsageError(
            f"run {head.run_id} does not know how likely harm is, so nothing can be weighed: set [likelihood] samples "
            "to 512, then `kouros run`"
        )
    terms = workspace.plan_terms
    asked = replace(
        limits,
        hours=terms.limits.hours if limits.hours is None else limits.hours,
        cost=terms.limits.cost if limits.cost is None else limits.cost,
    )
    plan = found.plan(replace(terms, limits=asked))
    if path is not None and not dry_run:
        _write(workspace, head, plan, path)
    return Planned(head, plan, path)


def _gathered(workspace: Workspace, head: RunRecord, pages: Sequence[Page], galleries: Sequence[str]) -> Gathered:
    wanted = [page for page in pages if page.on_display and (not galleries or page.gallery in galleries)]
    with workspace.engine.connect() as connection:
        loaded = ((page, load_page(connection, page.key)) for page in wanted)
        return gathered(loaded, head.decisions, presentation(workspace.settings)["units"])


def _write(workspace: Workspace, head: RunRecord, plan: ErrandPlan, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    match path.suffix.lower():
        case ".xlsx":
            write_plan_sheet(path, plan)
        case ".csv":
            with replacing(path) as aside:
                write_plan_table(aside, plan)
        case _:
            shown = page_head(head, Page("", "", True, 1, 1, head.run_id, head.finished))
            text = plan_page(plan, shown, presentation(workspace.settings)["language"], alone=True)
            with replacing(path) as aside:
                aside.write_text(text, encoding="utf-8")
