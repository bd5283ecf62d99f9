"""Photographs on a page: the file beside it, its size, and who is to be credited for it."""

from collections import Counter
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from pipeline.records import Item, Photo
from pipeline.report.text import short

FOLDER = "images"
"""Of a report, in which the pictures are."""

_CREDIT = 300
"""Characters of a credit line."""


@dataclass(frozen=True, slots=True)
class PhotoView:
    """A picture as a page shows it.

    Attributes
    ----------
    file : str
        Its address from the page.
    credit : str
        Who is to be credited for it, "" where nobody is named.
    """

    file: str
    width: int
    height: int
    credit: str

    def within(self, side: int) -> tuple[int, int]:
        """Return the width and the height that it has within a square, never larger than it is."""
        scale = min(1.0, side / max(self.width, self.height))
        return max(1, round(scale * self.width)), max(1, round(scale * self.height))


def photo_file(photo: Photo) -> str:
    """Return the file of a picture, from the folder of the report."""
    return f"{FOLDER}/{photo.name}.jpg"


def photo_view(item: Item, photos: Mapping[str, Photo]) -> PhotoView | None:
    """Return the picture of an object; None where there is none."""
    photo = photos.get(item.object_number)
    if photo is None:
        return None
    return PhotoView(photo_file(photo), photo.width, photo.height, short(item.image_credit, _CREDIT))


def credits_of(views: Iterable[PhotoView | None]) -> tuple[tuple[str, int], ...]:
    """Return the credit lines of a page, and how many pictures each is of; the most frequent first."""
    found = Counter(view.credit for view in views if view is not None and view.credit)
    return tuple(found.most_common())
