"""Photographs of the objects of a run, gathered before its pages are drawn."""

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pipeline.cache import Cache
from pipeline.collection.inventory.records import images
from pipeline.images.album import Album, GatheredPhotos, Refused
from pipeline.images.limits import ImageLimits
from pipeline.operations.workspace import Workspace
from pipeline.quantities import counted
from pipeline.records import Doubt, Photo, Progress
from pipeline.records.run import DOUBTFUL
from pipeline.report.pages.reading import IMAGES


class Photographs:
    """The photographs of a run: what they are called, by object, and what became of them.

    Parameters
    ----------
    workspace : Workspace or None
        Of the museum; None: nothing has a photograph.
    """

    def __init__(self, workspace: Workspace | None) -> None:
        self._images = {} if workspace is None else images(workspace.engine)
        self._album = None if workspace is None or not self._images else _album(workspace)
        self._found = GatheredPhotos()
        self._lost: set[str] = set()

    def gather(self, numbers: Sequence[str], progress: Progress, *, whole: bool) -> None:
        """See to the photographs of some objects.

        Parameters
        ----------
        numbers : sequence of str
            Of the objects.
        progress : Progress
            Is told how far it is.
        whole : bool
            Whether these are all that are shown of the museum.
        """
        if self._album is not None:
            self._images = {number: self._images[number] for number in numbers if number in self._images}
            self._found = self._album.gather(list(self._images.values()), progress, whole=whole)

    def recall(self) -> None:
        """Take what is kept of the photographs, without looking again."""
        if self._album is not None:
            self._found = self._album.recalled(list(self._images.values()))

    def known(self, numbers: Sequence[str]) -> dict[str, Photo]:
        """Return the pictures of some objects without their content, as a page depends on them."""
        named = ((number, self._found.photos.get(self._images.get(number, ""))) for number in numbers)
        return {number: photo for number, photo in named if photo is not None}

    def of(self, numbers: Sequence[str]) -> dict[str, Photo]:
        """Return the pictures of some objects with their content; what was lost meanwhile is not there."""
        out = {}
        for number, photo in self.known(numbers).items():
            whole = self._album and self._album.photo(self._images[number], photo)
            if whole:
                out[number] = whole
            else:
                self._lost.add(number)
        return out

    def lost(self, numbers: Sequence[str]) -> bool:
        """Say whether a picture of some objects was lost between gathering and drawing: the page is tried again."""
        return bool(self._lost.intersection(numbers))

    def told(self) -> dict[str, Any]:
        """Return how many photographs are not shown for a fault of theirs, and a digest of why; empty for none."""
        refused = self._refused()
        if not refused:
            return {}
        said = repr([(one.object_number, one.message) for one in refused])
        digest = hashlib.sha256(said.encode("utf-8", "surrogatepass")).hexdigest()[:16]
        return {"images": len(refused), IMAGES: digest}

    def notes(self) -> list[str]:
        """Return, in sentences, what settings keep from being shown, and what waits for the next night."""
        found = self._found
        out = [
            f"{counted(number, 'photograph')} at {host} {'was' if number == 1 else 'were'} not fetched: [images] hosts "
            "does not name it."
            for host, number in sorted(found.unnamed.items())[:8]
        ]
        if len(found.unnamed) > 8:
            out.append(f"So it is with {counted(len(found.unnamed) - 8, 'other host')}.")
        if found.unset:
            out.append(f"{counted(found.unset, 'photograph')} not looked for: [images] folder names no folder.")
        if found.left:
            out.append(f"{counted(found.left, 'photograph')} left for the next night: [images] minutes was over.")
        return out

    def _refused(self) -> list[Doubt]:
        return list(_doubts(self._images, self._found.refused))


def image_doubts(workspace: Workspace) -> Iterator[Doubt]:
    """Yield the photographs that cannot be shown, as far as is kept, without looking again."""
    named = images(workspace.engine)
    if named:
        yield from _doubts(named, _album(workspace).recalled(list(named.values())).refused)


def _album(workspace: Workspace) -> Album:
    settings, said = workspace.settings, workspace.settings.images
    limits = ImageLimits(
        folder=settings.path(said.folder) if said.folder else None,
        hosts=said.hosts,
        side=said.pixels,
        most_bytes=round(1e6 * said.megabytes),
        most_pixels=round(1e6 * said.megapixels),
        seconds=said.seconds,
        minutes=said.minutes,
        ask_again_days=said.ask_again_days,
    )
    return Album(Cache(settings.kept), limits)


def _doubts(named: Mapping[str, str], refused: Mapping[str, Refused]) -> Iterator[Doubt]:
    for number, image in named.items():
        if image in refused:
            one = refused[image]
            yield Doubt(DOUBTFUL, None, None, number, "image", f"its photograph: {one.message}", one.remedy, image)
