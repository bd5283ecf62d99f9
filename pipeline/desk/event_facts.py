"""Earthquakes as the desk shows them: the answers that are shown now, what was found since, and of which objects."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from threading import Lock
from typing import Any

from pipeline.desk.guard import NotThereError
from pipeline.event.answer import ObjectAnswer
from pipeline.operations.workspace import Workspace
from pipeline.records import Band
from pipeline.report.files.event_files import ANSWER
from pipeline.report.text import clean
from pipeline.store.event_reports import EventReport, event_reports, newest_report
from pipeline.store.runs import load_head
from pipeline.store.sound import whole_runs
from pipeline.tools.event_folders import EVENTS, KeptEvent, found_states, kept_document, kept_events, known_objects


@dataclass(frozen=True)
class EventFacts:
    """An answer to an earthquake, and what was found.

    Attributes
    ----------
    event : KeptEvent
        Which it is.
    document : mapping
        The answer for programs, without its objects.
    galleries : mapping of str to tuple of ObjectAnswer
        Objects by gallery, as sorted by the answer, numbers as pages show them.
    numbers : mapping of str to str
        The museum's own number of an object on display, by that which is shown.
    reports : mapping of str to tuple of EventReport
        All that was found, by the museum's own number.
    open : int
        Of how many objects the answer does not count yet what was found.
    others : tuple of KeptEvent
        Other earthquakes, the one answered last first.
    """

    event: KeptEvent
    document: Mapping[str, Any]
    galleries: Mapping[str, tuple[ObjectAnswer, ...]]
    numbers: Mapping[str, str]
    reports: Mapping[str, tuple[EventReport, ...]]
    open: int
    others: tuple[KeptEvent, ...]

    def found(self, shown: str) -> tuple[EventReport, ...]:
        """Return what was found of an object, by the number that is shown."""
        return self.reports.get(self.numbers.get(shown, shown), ())


class EventDesk:
    """The earthquakes of a museum, each read again when its answer changes.

    Parameters
    ----------
    workspace : Workspace
        Of the museum.
    """

    def __init__(self, workspace: Workspace) -> None:
        self._workspace = workspace
        self._root = workspace.settings.path(EVENTS)
        self._lock = Lock()
        self._answers: dict[Path, tuple[Mapping[str, Any], dict[str, tuple[ObjectAnswer, ...]]]] = {}
        self._known: tuple[str, dict[str, int]] = ("", {})
        self._reports: dict[str, tuple[int, dict[str, tuple[EventReport, ...]]]] = {}

    @property
    def there(self) -> bool:
        """Whether an earthquake was answered."""
        return self._root.is_dir() and any(one.is_dir() for one in self._root.iterdir())

    def facts(self, name: str = "") -> EventFacts:
        """Return an earthquake by the name of its folder; "" for the one that was answered last.

        Raises
        ------
        NotThereError
            Where there is none.
        """
        every = kept_events(self._root)
        event = next((one for one in every if name in ("", one.name)), None)
        if event is None:
            raise NotThereError("no such earthquake was answered yet: `kouros event` answers one")
        with self._lock:
            known = self._on_display()
            document, galleries = self._answer(event.folder)
            reports = self._found(event.name)
        counted = event.brief.get("reported", {})
        states = found_states(reports, known)
        waiting = sum(counted.get(number) != state for number, state in states.items())
        others = tuple(one for one in every if one.name != event.name)
        return EventFacts(event, document, galleries, {clean(one): one for one in known}, reports, waiting, others)

    def _on_display(self) -> dict[str, int]:
        run = (whole_runs(self._workspace.engine) or ("",))[0]
        if self._known[0] != run and run:
            self._known = run, known_objects(self._workspace, load_head(self._workspace.engine, run)[1])
        return self._known[1]

    def _found(self, name: str) -> dict[str, tuple[EventReport, ...]]:
        last = newest_report(self._workspace.engine)
        kept = self._reports.get(name)
        if kept is None or kept[0] != last:
            kept = self._reports[name] = last, event_reports(self._workspace.engine, name)
        return kept[1]

    def _answer(self, folder: Path) -> tuple[Mapping[str, Any], dict[str, tuple[ObjectAnswer, ...]]]:
        kept = self._answers.get(folder)
        if kept is None:
            document = dict(kept_document(folder / ANSWER))
            rows: dict[str, list[ObjectAnswer]] = {}
            for row in document.pop("objects"):
                one = _object(row)
                rows.setdefault(one.gallery, []).append(one)
            galleries = {name: tuple(those) for name, those in rows.items()}
            # Only the newest: an answer of 100,000 objects is large.
            self._answers = {folder: (document, galleries)}
            kept = self._answers[folder]
        return kept


def _object(row: Mapping[str, Any]) -> ObjectAnswer:
    said = dict(row)
    number = said.pop("object_number")
    band = None if said["band"] is None else Band(said.pop("band"))
    return ObjectAnswer(**{**said, "number": number, "band": band})
