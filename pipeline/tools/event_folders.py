"""Folders of earthquakes, one version of each shown, and what people find in the galleries after one."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from pipeline.event.found import STATES, FoundObject, read_found
from pipeline.event.message import ReportedEarthquake, SiteShaking
from pipeline.event.reading import is_same
from pipeline.operations.workspace import Workspace
from pipeline.records import Page
from pipeline.report.files.event_files import ANSWER, BRIEF
from pipeline.report.files.manifest import LINK, PAGE
from pipeline.report.text import slug
from pipeline.resources import small_text
from pipeline.store.codec import StoreError
from pipeline.store.event_reports import EventReport, add_event_reports, event_reports
from pipeline.store.pages import load_members
from pipeline.tools.decisions import person_here

EVENTS = "events"
"""Folder beside the settings that holds every answer: a folder for each earthquake, in it one for each version."""

CHANCES = "models.json"
"""File of an answer for which models were run again: what they found, so that it need not be run for a report."""


@dataclass(frozen=True)
class EventQuestion:
    """What an answer is of, besides the run and what was found: enough to answer it anew without its messages.

    Attributes
    ----------
    quake : ReportedEarthquake
        Which it was.
    site : (float, float)
        Of the museum, degrees north and east.
    rank : (int, float)
        How much its message is believed, and its version.
    shaking : SiteShaking
        Of the ground as the messages have it, before anybody looked.
    source : str
        Digest of what it is from.
    """

    quake: ReportedEarthquake
    site: tuple[float, float]
    rank: tuple[int, float]
    shaking: SiteShaking
    source: str

    def packed(self) -> dict[str, Any]:
        """Return it JSON-ready."""
        time = self.quake.time
        return asdict(self) | {"quake": asdict(self.quake) | {"time": None if time is None else time.isoformat()}}

    @classmethod
    def of_packed(cls, said: Mapping[str, Any]) -> EventQuestion:
        """Return what `packed` gave.

        Raises
        ------
        KeyError, TypeError, ValueError
            For what it never gave.
        """
        quake, shaking = dict(said["quake"]), dict(said["shaking"])
        if quake["time"] is not None:
            quake["time"] = datetime.fromisoformat(quake["time"])
        shaking["notes"] = tuple(shaking["notes"])
        north, east = said["site"]
        rank, version = said["rank"]
        return cls(
            ReportedEarthquake(**quake), (float(north), float(east)), (int(rank), float(version)),
            SiteShaking(**shaking), str(said["source"]),
        )  # fmt: skip


@dataclass(frozen=True, slots=True)
class KeptEvent:
    """An earthquake whose answer is shown.

    Attributes
    ----------
    name : str
        Of its folder.
    folder : Path
        Of the version that is shown.
    brief : mapping
        That version without its objects.
    written : float
        When it was written, seconds since 1970.
    """

    name: str
    folder: Path
    brief: Mapping[str, Any]
    written: float

    @property
    def title(self) -> str:
        """What the earthquake is called; "" where nobody calls it anything."""
        said = self.brief.get("event", {})
        return str(said.get("name") or said.get("id") or "")


def kept_events(root: Path) -> list[KeptEvent]:
    """Return the earthquakes of which an answer is shown, the one answered last first.

    Parameters
    ----------
    root : Path
        The folder `EVENTS`.
    """
    found = []
    for there in sorted(root.iterdir()) if root.is_dir() else ():
        name = shown_name(there) if there.is_dir() else ""
        brief = there / name / BRIEF
        if name and brief.is_file() and (there / name / ANSWER).is_file():
            found.append(KeptEvent(there.name, there / name, kept_document(brief), brief.stat().st_mtime))
    return sorted(found, key=lambda one: -one.written)


def shown_name(folder: Path) -> str:
    """Return the name of the version that an earthquake's folder shows; "" for none."""
    link, page = folder / LINK, folder / PAGE
    if link.is_symlink():
        return link.readlink().name
    # Where links cannot be made a page leads there.
    return small_text(page).partition("url=")[2].partition("/")[0] if page.is_file() else ""


def shown_brief(folder: Path) -> Mapping[str, Any]:
    """Return the answer that an earthquake's folder shows, without its objects; nothing where there is none."""
    name = shown_name(folder) if folder.is_dir() else ""
    file = folder / name / BRIEF
    return kept_document(file) if name and file.is_file() else {}


def kept_document(file: Path) -> Mapping[str, Any]:
    """Return a document of an answer.

    Raises
    ------
    StoreError
        For one that is damaged.
    """
    try:
        said = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError) as problem:
        raise StoreError(f"{file}: an earlier answer that is damaged ({problem}); remove its folder") from problem
    if not isinstance(said, dict):
        raise StoreError(f"{file}: an earlier answer that is damaged; remove its folder")
    return said


def rank_shown(folder: Path) -> tuple[int, float]:
    """Return how much the answer is believed that an earthquake's folder shows, (0, 0) where there is none."""
    said = shown_brief(folder).get("event", {}).get("rank")
    return (int(said[0]), float(said[1])) if isinstance(said, list) and len(said) == 2 else (0, 0.0)


def event_folder(root: Path, quake: ReportedEarthquake, now: datetime | None = None) -> str:
    """Return the name of an earthquake's folder: one that is there already where another agency sent it.

    Parameters
    ----------
    root : Path
        The folder `EVENTS`.
    quake : ReportedEarthquake
        Which it is.
    now : datetime or None
        By the clock; None: this machine's.
    """
    if quake.time is not None and quake.latitude is not None and quake.longitude is not None and root.is_dir():
        for there in sorted(root.iterdir()):
            said = shown_brief(there).get("event", {})
            try:
                time = datetime.fromisoformat(said["time"])
                other = ReportedEarthquake(latitude=said["latitude"], longitude=said["longitude"], time=time)
                apart = quake.apart(other)
            except (KeyError, TypeError, ValueError):
                continue
            if apart is not None and is_same(apart):
                return there.name
    # Of what nobody says when it was, all of one day is one earthquake.
    when = f"{now or datetime.now(UTC):%Y%m%d}-" if quake.time is None else f"{quake.time:%Y%m%dT%H%M%S}-"
    return f"{when}{slug(quake.id or quake.name or 'by hand')}"


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
