"""The collection cut into pages: a gallery, or parts of a large one, in the order of the catalogue."""

from bisect import bisect_right
from collections.abc import Sequence
from dataclasses import dataclass

from pipeline.collection.listing import Listing, Run
from pipeline.night.floors import floor_name
from pipeline.quantities import sorting_key
from pipeline.settings import Settings

MOST = 1_000
"""Objects on a page at most, unless one case holds more: what a browser shows at once."""

STORED = 250
"""Of what is not on display: it is looked up, and a page of it is scrolled through by hand."""


@dataclass(frozen=True, slots=True)
class PagePart:
    """The objects of one page, before anything is known about them.

    Attributes
    ----------
    gallery
        "" for objects that are not on display.
    floor
        That they stand on, "" for the ground.
    number, of
        Which of its gallery's pages it is, from 1, and how many there are.
    """

    gallery: str
    on_display: bool
    floor: str
    number: int
    of: int
    objects: Listing


def paged(objects: Listing, settings: Settings, most: int = MOST, stored: int = STORED) -> list[PagePart]:
    """Cut a collection into pages: galleries by name, as people count, then what is not on display, floor by floor.

    What is not on display is in the order of its numbers, where nothing is computed of it.

    Parameters
    ----------
    objects
        Sorted by `listing.order`.
    settings
        Say which gallery is on which floor.
    most, stored
        Objects on a page of a gallery, and of what is not on display; a case that is assessed is not cut.
    """
    groups: dict[tuple[bool, str], list[Run]] = {}
    for run in objects.runs:
        # What is not on display shares pages, but not with what stands on another floor.
        place = run.gallery if run.on_display else floor_name(settings, run.gallery)
        groups.setdefault((not run.on_display, place), []).append(run)
    out: list[PagePart] = []
    away: list[tuple[str, Listing]] = []
    # Gallery 2 comes before Gallery 19.
    for absent, place in sorted(groups, key=lambda group: (group[0], sorting_key(group[1]), group[1])):
        members = objects.joined(groups[absent, place])
        if not absent:
            floor, pieces = floor_name(settings, place), _pieces(members, most)
            out += [PagePart(place, True, floor, n, len(pieces), piece) for n, piece in enumerate(pieces, 1)]
        elif settings.display.stores:
            away += [(place, piece) for piece in _pieces(members, stored)]
        else:
            members = members.by(sorting_key)
            away += [(place, members[at : at + stored]) for at in range(0, len(members), stored)]
    out += [PagePart("", False, floor, n, len(away), piece) for n, (floor, piece) in enumerate(away, 1)]
    return out


def _pieces(members: Listing, most: int) -> Sequence[Listing]:
    begins = [*members.companies().tolist(), len(members)]
    out, start = [], 0
    while start < len(members):
        # The last case that ends on this page, or the one that is alone there.
        end = begins[bisect_right(begins, start + most) - 1]
        if end <= start:
            end = begins[bisect_right(begins, start)]
        out.append(members[start:end])
        start = end
    return out
