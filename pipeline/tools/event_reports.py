"""What people find after an earthquake, from a file or at the desk: kept in one place, of an object the newest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from pathlib import Path

from pipeline.event.found import STATES, FoundObject, read_found
from pipeline.operations.workspace import Workspace
from pipeline.records import Page
from pipeline.store.event_reports import EventReport, add_event_reports, event_reports
from pipeline.store.pages import load_members
from pipeline.tools.decisions import person_here


@dataclass(frozen=True, slots=True)
class ReportsTaken:
    """How many reports a file has, and of how many of them that was not known yet."""

    reports: int
    new: int

    @property
    def sentence(self) -> str:
        """It in a sentence."""
        known = self.reports - self.new
        return f"{self.reports:,} reports were taken" + (f", {known:,} of which were known." if known else ".")


def known_objects(workspace: Workspace, pages: Sequence[Page]) -> dict[str, int]:
    """Return the places of objects on display by number, in the order of the stock; no result is read.

    Parameters
    ----------
    workspace : Workspace
        Of the museum.
    pages : sequence of Page
        Of the run.
    """
    with workspace.engine.connect() as connection:
        found = [load_members(connection, page.key) for page in pages if page.on_display]
    pairs = [pair for one in found for pair in zip(one.column("object_number"), one.column("on_display"), strict=True)]
    return {number: at for at, number in enumerate(number for number, shown in pairs if shown)}


def found_states(reports: Mapping[str, Sequence[EventReport]], known: Mapping[str, int]) -> dict[str, str]:
    """Return what was found by object number: of each the newest report, of those that are on display."""
    return {name: some[-1].state for name, some in reports.items() if name in known and some[-1].state in STATES}


def take_reports(
    workspace: Workspace, event: str, file: Path, known: Mapping[str, int], *, dry_run: bool = False
) -> tuple[ReportsTaken, dict[str, str]]:
    """Take what a file says was found, and return how much that is, and all that is known now by object number.

    Parameters
    ----------
    workspace : Workspace
        Of the museum.
    event : str
        Name of the earthquake's folder.
    file : Path
        See `read_found`.
    known : mapping of str to int
        As of `known_objects`.
    dry_run : bool
        Write nothing.

    Raises
    ------
    InputError
        For a file that cannot be used: nothing of it is kept.
    """
    said = read_found(file, known)
    before = event_reports(workspace.engine, event)
    here, now = person_here(), datetime.now(UTC).isoformat(timespec="seconds")
    all_of_it = [report_of(event, name, one, one.who or here, now) for name, one in said.items()]
    new = [one for one in all_of_it if _last(before, one.object_number) != one.said]
    if not dry_run:
        add_event_reports(workspace.engine, new)
    states = found_states(before, known) | {name: one.state for name, one in said.items()}
    return ReportsTaken(len(all_of_it), len(new)), states


def report_of(event: str, number: str, found: FoundObject, who: str, now: str) -> EventReport:
    """Return a report to be written down."""
    return EventReport(0, event, number, found.state, found.moved_m, found.note, who, now)


def _last(reports: Mapping[str, Sequence[EventReport]], number: str) -> tuple[str, float | None, str] | None:
    some = reports.get(number)
    return some[-1].said if some else None
