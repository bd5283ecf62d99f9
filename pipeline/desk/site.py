"""What all pages of the desk share: workspace, newest run, decisions, filled-in pages; renewed when they change."""

import gc
import logging
import time
from collections import OrderedDict
from collections.abc import Hashable
from pathlib import Path
from threading import Lock
from typing import NamedTuple

from pipeline.desk.event_facts import EventDesk
from pipeline.desk.object_facts import ObjectDesk, ObjectFacts
from pipeline.desk.run_facts import RunFacts
from pipeline.operations.workspace import Workspace, open_workspace
from pipeline.records import Decision
from pipeline.report.pages.environment import environment, fragments
from pipeline.settings import load_settings
from pipeline.settings.operations import ServeSettings
from pipeline.store.decisions import read_decisions
from pipeline.store.desk import ErrandWord, errand_words, newest_ids
from pipeline.store.sound import whole_runs

logger = logging.getLogger(__name__)

AT_ONCE = 2
"""Pages that are filled in at a time: Python computes one after the other, and more only get in each other's way."""

LOOK = 2.0
"""Seconds after which it is looked whether there is a newer run."""


class DeskState(NamedTuple):
    """What pages rest on: the run, when the settings changed, the newest ids of what people said, earthquakes."""

    run_id: str
    changed: int
    newest: tuple[int, ...]
    shaken: bool


class DeskSite:
    """The state of the desk.

    Parameters
    ----------
    config : Path
        The settings' file.
    serving : ServeSettings, optional
        In place of those of the file.
    """

    def __init__(self, config: Path, serving: ServeSettings | None = None) -> None:
        self.config = config
        self._changed = config.stat().st_mtime_ns
        self.workspace: Workspace = open_workspace(load_settings(config), keeping=AT_ONCE)
        self.serving = serving or self.workspace.settings.serve
        self.objects = ObjectDesk()
        self.events = EventDesk(self.workspace)
        self._lock = Lock()
        self._looked = 0.0
        self._run: RunFacts | None = None
        self._kept = False
        self._read: tuple[int, ...] = ()
        self._log: dict[str, tuple[Decision, ...]] = {}
        self._words: dict[str, tuple[ErrandWord, ...]] = {}

    def close(self) -> None:
        """Close the connections that wait to be used again."""
        self.workspace.engine.dispose()

    @property
    def run(self) -> RunFacts:
        """The newest run as of the last look (`look`): every page looks once before anything of it is filled in.

        Raises
        ------
        DeskError
            Where there is none.
        """
        return self._run or self.look()

    def look(self) -> RunFacts:
        """Look whether there is a newer run or the settings changed; return the newest run.

        Raises
        ------
        DeskError
            Where there is none.
        """
        with self._lock:
            changed = self.config.stat().st_mtime_ns
            if changed != self._changed:
                self.workspace = Workspace(load_settings(self.config), self.workspace.engine)
                self.events = EventDesk(self.workspace)
                self._changed, self._run = changed, None
            now = time.monotonic()
            if self._run is None or now - self._looked > LOOK:
                runs = whole_runs(self.workspace.engine)
                if self._run is None or runs[:1] != [self._run.run_id]:
                    self._run = RunFacts(self.workspace)
                    self.environment = environment(self._run.language)
                    self.fragment = fragments(self.environment, "desk/_fields.html")
                    self._settle()
                    logger.info("the desk shows run %s", self._run.run_id)
                self._looked = time.monotonic()
            return self._run

    def _settle(self) -> None:
        """Spare what is kept of a run from being looked through, again and again, for what nobody needs any more."""
        # What was kept of the run before is garbage now; before the first there was none of it.
        if self._kept:
            gc.unfreeze()
        gc.collect()
        gc.freeze()
        self._kept = True

    @property
    def state(self) -> DeskState:
        """What all pages but those of earthquakes rest on: where it is as before, they say the same as before.

        Raises
        ------
        DeskError
            Where there is no run.
        """
        run = self.look()
        return DeskState(run.run_id, self._changed, newest_ids(self.workspace.engine), self.events.there)

    def _renew(self, newest: tuple[int, ...] | None = None) -> tuple[int, ...]:
        """Read decisions and words anew where there are newer ones; return the newest ids.

        newest : the newest ids, where somebody has just asked for them
        """
        newest = newest or newest_ids(self.workspace.engine)
        ids = newest[:2]
        with self._lock:
            if ids != self._read:
                found: dict[str, tuple[Decision, ...]] = {}
                for one in read_decisions(self.workspace.engine):
                    found[one.object_number] = (*found.get(one.object_number, ()), one)
                self._log, self._words, self._read = found, errand_words(self.workspace.engine), ids
        return newest

    def log(self, number: str) -> tuple[Decision, ...]:
        """Return all decisions about an object, by id."""
        self._renew()
        return self._log.get(number, ())

    @property
    def words(self) -> dict[str, tuple[ErrandWord, ...]]:
        """What was said of errands."""
        self._renew()
        return self._words

    def facts(self, number: str, newest: tuple[int, ...] | None = None) -> ObjectFacts:
        """Return an object.

        Parameters
        ----------
        number : str
            The museum's.
        newest : tuple of int, optional
            The newest ids of what people said (`newest_ids`), where somebody has just asked for them.

        Raises
        ------
        NotThereError
            Where there is none of that number.
        """
        run, newest = self.run, self._renew(newest)
        return self.objects.facts(run, number, self._log.get(number, ()), pictured=newest[2] > 0)


class KeptPages:
    """The pages that were asked for last, all of one state of the museum.

    Parameters
    ----------
    most : int
        Characters of all pages together that are kept.
    """

    def __init__(self, most: int) -> None:
        self._most = most
        self._state: Hashable = None
        self._pages: OrderedDict[Hashable, str] = OrderedDict()
        self._length = 0
        self._lock = Lock()

    def get(self, state: Hashable, key: Hashable) -> str | None:
        """Return a page as it is in a state; None where nobody asked for it since that began."""
        with self._lock:
            if state != self._state or key not in self._pages:
                return None
            self._pages.move_to_end(key)
            return self._pages[key]

    def keep(self, state: Hashable, key: Hashable, page: str) -> None:
        """Keep a page.

        Parameters
        ----------
        state : Hashable
            As it was before anything of the page was looked up, so that what changed meanwhile is shown next time.
        """
        with self._lock:
            if state != self._state:
                self._state, self._length = state, 0
                self._pages.clear()
            self._length += len(page) - len(self._pages.pop(key, ""))
            self._pages[key] = page
            while self._length > self._most:
                self._length -= len(self._pages.popitem(last=False)[1])
