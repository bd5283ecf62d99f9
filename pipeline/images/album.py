"""The photographs of a museum as small pictures, kept from night to night: only what is new or changed is looked at.

Of every photograph it is kept by what its state is known again (of a file its size and times, of an address the ETag
that its host gave, and when it was asked), and what became of it.  The pictures lie in the cache by their content.
"""

import hashlib
import os
import stat
import time
from collections import Counter
from collections.abc import Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path
from threading import Lock, local
from typing import Any, NamedTuple

import numpy as np

from pipeline.cache import DAY, THUMBNAILS, Cache, CacheEntry, key_of
from pipeline.errors import fault_words
from pipeline.images.decoding import VERSION, Decoder
from pipeline.images.fetching import Fetched, Fetcher, Hosts, is_document, pictures_of
from pipeline.images.limits import ImageError, ImageLimits
from pipeline.records import Photo, Progress

_INDEX = "index"
_SCHEMES = ("https://", "http://")
_ENOUGH = 5
"""Times that a host may fail to answer, one after the other, before it is left alone for the night."""
_WORKERS = 4


class Refused(NamedTuple):
    """A photograph that is not shown, and why."""

    image: str
    message: str
    remedy: str


@dataclass
class GatheredPhotos:
    """What became of the photographs.

    Attributes
    ----------
    photos : dict of str to Photo
        By what the records call them; without their content.
    refused : dict of str to Refused
        The same of those that cannot be shown.
    left : int
        How many are left for the next night, because this one's time was over.
    unnamed : Counter of str
        Hosts that the settings do not name, and how many photographs they have.
    unset : int
        Files that were not looked for, because no folder is named.
    worked : int
        How many were read or asked for now.
    """

    photos: dict[str, Photo] = field(default_factory=dict)
    refused: dict[str, Refused] = field(default_factory=dict)
    left: int = 0
    unnamed: Counter[str] = field(default_factory=Counter)
    unset: int = 0
    worked: int = 0


class Album:
    """The pictures that are kept.

    Parameters
    ----------
    cache : Cache
        Where they are kept.
    limits : ImageLimits
        Where photographs may be, and how much is spent on them.
    """

    def __init__(self, cache: Cache, limits: ImageLimits) -> None:
        self._cache, self.limits = cache, limits
        self._fetcher = Fetcher(Hosts(limits.hosts), limits.most_bytes, limits.seconds)
        kept = cache.get(THUMBNAILS, key_of(_INDEX, VERSION, limits.side), lasting=True)
        said: Mapping[str, Any] = {} if kept is None else kept.said
        self._known: dict[str, dict[str, Any]] = dict(said.get("known", {}))
        self._made: dict[str, list[Any]] = dict(said.get("made", {}))
        self._lock = Lock()
        self._mute: Counter[str] = Counter()
        self._own = local()

    # -----------------------------------------------------------------------------------------------------------------
    # A night

    def gather(self, images: Sequence[str], progress: Progress, *, whole: bool = True) -> GatheredPhotos:
        """See to all photographs, and keep what was made.

        Parameters
        ----------
        images : sequence of str
            What the records call them.
        progress : Progress
            Is told how far it is.
        whole : bool
            Whether these are all of the museum: then what is kept of others is removed.

        Returns
        -------
        GatheredPhotos
            What became of each.
        """
        out, todo = GatheredPhotos(), []
        wanted = list(dict.fromkeys(filter(None, images)))
        for image in wanted:
            state = self._state(image, out)
            if state is None:
                continue
            if not state or not self._taken(image, state, out):
                todo.append((image, state))
        until = time.monotonic() + 60.0 * self.limits.minutes
        out.worked = len(todo)
        with ExitStack() as stack:
            decoders: list[Decoder] = []
            stack.callback(_close, decoders)
            self._own = local()

            def work(one: tuple[str, dict[str, Any]]) -> None:
                image, state = one
                if time.monotonic() > until:
                    self._late(image, state, out)
                    return
                if not hasattr(self._own, "decoder"):
                    self._own.decoder = self._decoder()
                    decoders.append(self._own.decoder)
                self._settle(image, state, out, self._own.decoder)

            with ThreadPoolExecutor(min(_WORKERS, max(1, len(todo)))) as pool:
                for done, _ in enumerate(pool.map(work, todo), 1):
                    progress.step("photographs", done, len(todo))
        if todo or (whole and self._known.keys() - set(wanted)):
            self._keep(set(wanted) if whole else None)
        return out

    def photo(self, image: str, known: Photo) -> Photo | None:
        """Return a picture with its content, made anew where it was lost meanwhile; None where that cannot be."""
        kept = self._cache.get(THUMBNAILS, key_of("picture", known.name), lasting=True)
        if kept is not None:
            return Photo(known.name, known.width, known.height, kept.arrays["jpeg"].tobytes())
        out, decoder = GatheredPhotos(), self._decoder()
        try:
            self._made.clear()
            self._settle(image, {}, out, decoder)
        finally:
            decoder.close()
        found = out.photos.get(image)
        kept = None if found is None or found.name != known.name else self._picture(found.name)
        return None if kept is None else Photo(known.name, known.width, known.height, kept.arrays["jpeg"].tobytes())

    def recalled(self, images: Sequence[str]) -> GatheredPhotos:
        """Return what is kept of photographs, without looking again."""
        out = GatheredPhotos()
        for image in images:
            self._shown(image, self._known.get(image, {}), out)
        return out

    def _decoder(self) -> Decoder:
        return Decoder(self.limits.side, self.limits.most_pixels, self.limits.seconds)

    def _picture(self, name: str) -> CacheEntry | None:
        return self._cache.get(THUMBNAILS, key_of("picture", name), lasting=True)

    def _state(self, image: str, out: GatheredPhotos) -> dict[str, Any] | None:
        """Return by what the state of a photograph is known again, {} where it is to be asked; None: leave it."""
        if image.casefold().startswith(_SCHEMES):
            try:
                host = self._fetcher.allows(image)
            except ImageError as problem:
                out.refused[image] = Refused(image, problem.what, problem.remedy)
                return None
            if host:
                out.unnamed[host] += 1
                return None
            return {"checked": 0.0}
        if self.limits.folder is None:
            out.unset += 1
            return None
        try:
            facts = _file(self.limits.folder, image, self.limits.most_bytes)[1]
        except ImageError as problem:
            out.refused[image] = Refused(image, problem.what, problem.remedy)
            self._known[image] = {"why": [problem.what, problem.remedy]}
            return None
        return {"sign": [facts.st_size, facts.st_mtime_ns, facts.st_ctime_ns, facts.st_ino]}

    def _taken(self, image: str, state: Mapping[str, Any], out: GatheredPhotos) -> bool:
        """Take what is kept of a photograph, if its state is as it was."""
        known = self._known.get(image)
        if known is None:
            return False
        if "sign" in state:
            if known.get("sign") != state["sign"]:
                return False
        elif not 0.0 <= time.time() - float(known.get("checked", 0.0)) < DAY * self.limits.ask_again_days:
            return False
        return self._shown(image, known, out)

    def _shown(self, image: str, known: Mapping[str, Any], out: GatheredPhotos) -> bool:
        if known.get("why"):
            out.refused[image] = Refused(image, *known["why"])
            return True
        picture = known.get("picture")
        if not picture or not self._there(picture[0]):
            return False
        out.photos[image] = Photo(*picture)
        return True

    def _late(self, image: str, state: Mapping[str, Any], out: GatheredPhotos) -> None:
        with self._lock:
            out.left += 1
            if "sign" not in state:
                # What a host gave before is shown until there is time to ask it again.
                self._shown(image, self._known.get(image, {}), out)

    def _settle(self, image: str, state: Mapping[str, Any], out: GatheredPhotos, decoder: Decoder) -> None:
        """Look at one photograph; what it ends in is its own."""
        known = self._known.get(image, {})
        try:
            told = self._look(image, known, decoder)
        except ImageError as problem:
            why = [problem.what, problem.remedy]
            if not problem.lasting and known.get("picture"):
                # A host that does not answer tonight takes no picture away.
                told = dict(known)
            else:
                told = {**state, "why": why} | (
                    {"checked": time.time()} if problem.lasting and "sign" not in state else {}
                )
            with self._lock:
                out.refused.setdefault(image, Refused(image, *why))
        except Exception as problem:  # noqa: BLE001 - whatever it is, it is this photograph's, and told
            why = [f"Kouros failed on it, which is not your fault: {fault_words(problem)}", "please tell its makers"]
            told = {"why": why}
        with self._lock:
            self._known[image] = told
            if told.get("picture"):
                self._shown(image, told, out)
            else:
                out.refused[image] = Refused(image, *told["why"])

    def _look(self, image: str, known: Mapping[str, Any], decoder: Decoder) -> dict[str, Any]:
        if self.limits.folder is None or image.casefold().startswith(_SCHEMES):
            return self._asked(image, known, decoder)
        path, facts = _file(self.limits.folder, image, self.limits.most_bytes)
        content = _content(path, self.limits.most_bytes)
        sign = [facts.st_size, facts.st_mtime_ns, facts.st_ctime_ns, facts.st_ino]
        return {"sign": sign, "picture": self._made_of(content, decoder)}

    def _asked(self, url: str, known: Mapping[str, Any], decoder: Decoder) -> dict[str, Any]:
        host = url.split("/")[2]
        if self._mute[host] >= _ENOUGH:
            raise ImageError(f"{host} did not answer {_ENOUGH} times", "it is tried again", lasting=False)
        try:
            told = self._answered(url, known, decoder)
        except ImageError as problem:
            with self._lock:
                self._mute[host] = 0 if problem.lasting else self._mute[host] + 1
            raise
        with self._lock:
            self._mute[host] = 0
        return told | {"checked": time.time()}

    def _answered(self, url: str, known: Mapping[str, Any], decoder: Decoder) -> dict[str, Any]:
        answer, at = self._of_address(url, known), url
        if answer.content is not None and is_document(answer.content, answer.kind):
            at, answer = self._of_document(answer.content, known)
        if answer.content is None:
            return dict(known)
        picture = self._made_of(answer.content, decoder)
        return {"picture": picture, "etag": answer.etag, "modified": answer.modified, "at": at}

    def _of_address(self, url: str, known: Mapping[str, Any]) -> Fetched:
        """Ask for what stands at an address; nothing is sent where the picture that is kept came from this state."""
        picture = known.get("picture")
        same = picture and known.get("at") == url and self._there(picture[0])
        return self._fetcher.get(url, known.get("etag", "") if same else "", known.get("modified", "") if same else "")

    def _of_document(self, content: bytes, known: Mapping[str, Any]) -> tuple[str, Fetched]:
        problem: ImageError | None = None
        for address in pictures_of(content, self.limits.side):
            try:
                answer = self._of_address(address, known)
            except ImageError as fault:
                problem = problem or fault
                continue
            if answer.content is None or not is_document(answer.content, answer.kind):
                return address, answer
        raise problem or ImageError("names no picture of IIIF", "give the address of a photograph")

    def _there(self, name: str) -> bool:
        return self._cache.has(THUMBNAILS, key_of("picture", name), lasting=True)

    def _made_of(self, content: bytes, decoder: Decoder) -> list[Any]:
        digest = hashlib.sha256(content).hexdigest()
        with self._lock:
            made = self._made.get(digest)
        if made is not None and self._there(made[0]):
            return made
        photo = decoder.picture(content)
        entry = CacheEntry({}, {"jpeg": np.frombuffer(photo.content, np.uint8)})
        self._cache.put(THUMBNAILS, key_of("picture", photo.name), entry, lasting=True)
        made = [photo.name, photo.width, photo.height]
        with self._lock:
            self._made[digest] = made
        return made

    def _keep(self, wanted: set[str] | None) -> None:
        """Keep what is known, and where all photographs were seen to, remove what is of none of them."""
        if wanted is not None:
            self._known = {image: told for image, told in self._known.items() if image in wanted}
        names = {told["picture"][0] for told in self._known.values() if told.get("picture")}
        self._made = {digest: made for digest, made in self._made.items() if made[0] in names}
        index = key_of(_INDEX, VERSION, self.limits.side)
        said = {"known": self._known, "made": self._made}
        self._cache.put(THUMBNAILS, index, CacheEntry(said), lasting=True)
        if wanted is not None:
            self._cache.keep_only(THUMBNAILS, {index, *(key_of("picture", name) for name in names)})


def _close(decoders: Sequence[Decoder]) -> None:
    for one in decoders:
        one.close()


def _file(folder: Path, image: str, most_bytes: int) -> tuple[Path, os.stat_result]:
    """Return a photograph's file below the folder, and its facts.

    raises : ImageError for a path that leaves the folder, what is no file, and one that is too large
    """
    named = image.strip().replace("\\", "/")
    try:
        root = folder.resolve(strict=True)
    except (OSError, ValueError, RuntimeError) as problem:
        raise ImageError(f"the folder of images, {folder}, is not there", "correct [images] folder") from problem
    try:
        path = (root / named).resolve(strict=True)
        facts = path.stat()
    except FileNotFoundError as problem:
        raise ImageError(f"there is no file {named[:200]!r} below the folder of images", "put it there") from problem
    except (OSError, ValueError, RuntimeError) as problem:
        raise ImageError(f"{named[:200]!r} cannot be read", "see to its name and permissions") from problem
    if not path.is_relative_to(root):
        raise ImageError(f"{named[:200]!r} leaves the folder of images", "put the file itself below that folder")
    if not stat.S_ISREG(facts.st_mode):
        raise ImageError(f"{named[:200]!r} is no file", "name the photograph itself")
    if facts.st_size > most_bytes:
        raise ImageError(
            f"has {facts.st_size:,} bytes, and {most_bytes:,} are read", "save it smaller, or raise [images] megabytes"
        )
    return path, facts


def _content(path: Path, most_bytes: int) -> bytes:
    try:
        with path.open("rb") as stream:
            content = stream.read(most_bytes + 1)
    except OSError as problem:
        raise ImageError(
            f"{path.name[:200]!r} cannot be read: {problem.strerror}", "see to its permissions"
        ) from problem
    if len(content) > most_bytes:
        raise ImageError(f"grows while it is read, beyond {most_bytes:,} bytes", "it is tried again", lasting=False)
    return content
