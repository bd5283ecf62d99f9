"""Folders of earthquakes: one for each beside the settings, in it one for each version, of which one is shown."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from datetime import UTC, datetime
from pathlib import Path
from typing import Any

from pipeline.event.message import ReportedEarthquake, SiteShaking
from pipeline.event.reading import is_same
from pipeline.report.files.event_files import ANSWER, BRIEF
from pipeline.report.files.publish import LINK, PAGE
from pipeline.report.text import slug
from pipeline.resources import small_text
from pipeline.store.codec import StoreError

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
