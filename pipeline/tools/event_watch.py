"""A drop folder: each message or record that comes into it is answered once, and what cannot be used is refused once.

What became of each file is kept beside the answers, by its size, its time and its content: whoever watches next, and a
job of cron, goes on from there.  The files themselves are never touched.
"""

import hashlib
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from time import sleep, time
from typing import Any

from pipeline.errors import KourosError
from pipeline.event.message import LARGEST, CutOffError, MessageError
from pipeline.event.reading import is_message
from pipeline.motions.errors import MotionError
from pipeline.operations.workspace import LockedError, UsageError, open_workspace
from pipeline.resources import replacing
from pipeline.settings import Settings
from pipeline.tools.event import EventDone, answer_event
from pipeline.tools.event_folders import EVENTS

SETTLED = 2.0
"""Seconds for which a file has to stay as it is before it is read: judgement."""

PATIENCE = 60.0
"""Seconds for which one that is not whole has to stay as it is before it is refused, and not waited for: judgement.
Even then it is read again when it changes."""

EVERY = 1.0
"""Seconds between two looks."""

SEEN = "watched.json"
"""File beside the answers: what became of each file."""

_UNFINISHED = (".tmp", ".part", ".partial", ".crdownload", ".filepart", ".download", ".swp", "~")


@dataclass(frozen=True)
class Dropped:
    """Files that were answered together, and what came of them.

    Attributes
    ----------
    files : tuple of Path
        Of one earthquake.
    done : EventDone or None
        The answer; None where they were refused.
    refusal : str
        Why they were, and the remedy; "" where they were answered.
    later : bool
        Whether they are tried again: what is wrong is not in them.
    """

    files: tuple[Path, ...]
    done: EventDone | None = None
    refusal: str = ""
    later: bool = False


Stat = tuple[int, int]
"""Size and time of a file."""


class DropFolder:
    """A folder that messages about earthquakes come into.

    Parameters
    ----------
    settings : Settings
        Of the museum.
    folder : Path
        Files in it are answered one by one, its records together; those in a folder below it are of one earthquake.
    at : (float, float) or None
        As of `answer_event`.
    seconds : float
        As of `answer_event`.
    """

    def __init__(
        self,
        settings: Settings,
        folder: Path,
        at: tuple[float, float] | None = None,
        *,
        seconds: float = 0.0,
    ) -> None:
        if not folder.is_dir():
            raise UsageError(f"--watch {folder}: is no folder; make it, and let messages be put there")
        self._folder = folder
        self._kept = settings.path(EVENTS) / SEEN
        self._settings, self._at, self._seconds = settings, at, seconds
        self._before: dict[Path, Stat] = {}
        self._said: dict[Path, str] = {}
        self._seen = _read(self._kept)
        self.pending = False

    @contextmanager
    def alone(self) -> Iterator[None]:
        """Hold the folder: nobody else answers from it meanwhile.

        Raises
        ------
        LockedError
            Where another process watches for this museum.
        """
        from filelock import FileLock, Timeout

        self._kept.parent.mkdir(parents=True, exist_ok=True)
        lock = FileLock(self._kept.with_name(".watched.lock"), timeout=0)
        try:
            lock.acquire()
        except Timeout as problem:
            raise LockedError(f"another process watches already and holds {lock.lock_file}; end it first") from problem
        try:
            self._seen = _read(self._kept)
            yield
        finally:
            lock.release()

    def look(self, now: float | None = None) -> list[Dropped]:
        """Answer what has come and is whole, and return what came of it.

        Parameters
        ----------
        now : float or None
            By the clock, s; None: this machine's.
        """
        clock = time() if now is None else now
        stats = dict(_files(self._folder))
        # A file whose time lies ahead of the clock has settled when two looks saw it the same.
        settled = {
            file
            for file, (size, when) in stats.items()
            if size
            and (clock - 1e-9 * when >= SETTLED or (1e-9 * when > clock and self._before.get(file) == (size, when)))
        }
        self._before = stats
        self.pending = any(file not in settled and not self._was_seen(file, stat) for file, stat in stats.items())
        fresh = {file for file, (_, when) in stats.items() if clock - 1e-9 * when < PATIENCE}
        return [self._tried(group, fresh) for group in self._groups(stats, settled)]

    def _groups(self, stats: Mapping[Path, Stat], settled: set[Path]) -> Iterator[tuple[Path, ...]]:
        """Yield files that belong together, of which at least one is new and all are whole."""
        by_folder: dict[Path, list[Path]] = {}
        for file in sorted(stats):
            by_folder.setdefault(file.parent, []).append(file)
        for folder, files in by_folder.items():
            new = [file for file in files if not self._was_seen(file, stats[file])]
            if folder != self._folder:
                if new and settled.issuperset(files):
                    yield tuple(files)
                continue
            messages = {file: is_message(file) for file in files if file in settled}
            yield from ((file,) for file in new if messages.get(file))
            records = [file for file in new if messages.get(file) is False]
            others = [
                file for file in files if file not in new and file.suffix.lower() == ".xml" and not messages.get(file)
            ]
            # StationXML alone shakes nothing: it waits for its record.
            if any(file.suffix.lower() != ".xml" for file in records) and all(
                file in settled for file in new if not messages.get(file)
            ):
                yield (*records, *others)

    def _was_seen(self, file: Path, stat: Stat) -> bool:
        kept = self._seen.get(str(file.resolve()))
        if kept is None:
            return False
        if (kept["size"], kept["time"]) == stat:
            return True
        # Touched, or copied once more: its content tells.
        same = kept["size"] == stat[0] and stat[0] <= LARGEST and kept["digest"] == _digest(file)
        if same:
            kept["time"] = stat[1]
        return bool(same)

    def _tried(self, files: tuple[Path, ...], fresh: set[Path]) -> Dropped:
        try:
            # Opened anew each time: a night may have ended meanwhile.
            workspace = open_workspace(self._settings)
            done = answer_event(workspace, files, at=self._at, seconds=self._seconds)
            return self._remembered(Dropped(files, done))
        except CutOffError as problem:
            if fresh.intersection(files):
                return self._later(files, problem)
            return self._remembered(Dropped(files, refusal=str(problem)))
        except (MessageError, MotionError) as problem:
            return self._remembered(Dropped(files, refusal=str(problem)))
        except (KourosError, OSError) as problem:
            # No run yet, no place of the museum, a full disk: that is not of the file.
            return self._later(files, problem)
        except Exception as problem:  # noqa: BLE001 - a fault of Kouros in one message must not end the watch
            return self._remembered(
                Dropped(files, refusal=f"Kouros failed on it ({type(problem).__name__}: {problem})")
            )

    def _later(self, files: tuple[Path, ...], problem: Exception) -> Dropped:
        return Dropped(files, refusal=str(problem), later=True)

    def _remembered(self, came: Dropped) -> Dropped:
        for file in came.files:
            facts = file.stat()
            told = came.refusal or (came.done.folder.name if came.done else "")
            self._seen[str(file.resolve())] = {
                "size": facts.st_size,
                "time": facts.st_mtime_ns,
                "digest": _digest(file),
                "refused": bool(came.refusal),
                "told": told,
            }
        self._kept.parent.mkdir(parents=True, exist_ok=True)
        with replacing(self._kept) as aside:
            aside.write_text(json.dumps(self._seen, indent=1, ensure_ascii=False), encoding="utf-8", errors="replace")
        return came

    def news(self, came: Dropped) -> bool:
        """Say whether something is worth telling: what waits for the same reason as before is not."""
        said = self._said.get(came.files[0])
        self._said[came.files[0]] = came.refusal
        return not came.later or said != came.refusal


def watch(folder: DropFolder, tell: Callable[[Dropped], None], *, once: bool, every: float = EVERY) -> int:
    """Answer what comes into a folder until somebody stops it, or what is there once.

    Parameters
    ----------
    folder : DropFolder
        The folder.
    tell : callable
        Is told what came of files.
    once : bool
        Look once, wait for what is being written as long as it settles, and end.
    every : float
        Seconds between two looks.

    Returns
    -------
    int
        How many were refused, or have to wait.
    """
    refused = 0
    with folder.alone():
        looks = 0
        while True:
            came = folder.look()
            for one in came:
                if folder.news(one):
                    tell(one)
            looks += 1
            if once and (not folder.pending or looks * every > SETTLED + every):
                return refused + sum(bool(one.refusal) for one in came)
            refused += sum(bool(one.refusal) and not one.later for one in came)
            sleep(every)


def _files(folder: Path) -> Iterator[tuple[Path, Stat]]:
    """Yield the files of a folder and of those in it, with size and time; not what is hidden, linked or unfinished."""
    for entry in _entries(folder):
        if entry.is_dir(follow_symlinks=False):
            inner: Sequence[os.DirEntry[str]] = [one for one in _entries(Path(entry.path)) if one.is_file()]
        else:
            inner = [entry] if entry.is_file() else []
        for one in inner:
            try:
                facts = one.stat()
            except OSError:
                continue  # It was taken away meanwhile.
            yield Path(one.path), (facts.st_size, facts.st_mtime_ns)


def _entries(folder: Path) -> list[os.DirEntry[str]]:
    try:
        with os.scandir(folder) as found:
            return [one for one in found if not (one.name.startswith(".") or one.name.endswith(_UNFINISHED))]
    except OSError:
        return []


def _digest(file: Path) -> str:
    with file.open("rb") as stream:
        return hashlib.file_digest(stream, "sha256").hexdigest()


def _read(file: Path) -> dict[str, dict[str, Any]]:
    """Return what is known of files; nothing where that is lost: all are answered again, which changes nothing."""
    try:
        said = json.loads(file.read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}
    names = {"size", "time", "digest", "refused", "told"}
    sound = isinstance(said, dict) and all(isinstance(one, dict) and names <= one.keys() for one in said.values())
    return said if sound else {}
