"""The collection cut into units, with the keys of their results, and into pages."""

from array import array
from bisect import bisect_right
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from hashlib import blake2b
from itertools import pairwise

from pipeline.collection.listing import Listed, Listing, Run
from pipeline.collection.sealing import seal
from pipeline.night.context import RunContext
from pipeline.night.floors import Floor, floor_name
from pipeline.quantities import sorting_key
from pipeline.records import Decision, DecisionKind
from pipeline.resources import code_version
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


Decisions = Mapping[str, tuple[Decision, ...]]
"""Those in force, by object number."""


@dataclass(frozen=True, slots=True)
class PageUnits:
    """What is assessed together, of the objects of one page, in their order.

    Attributes
    ----------
    keys
        Of each unit the digest of everything that its results depend on.
    ends
        Where each ends among the objects of the page.
    """

    keys: tuple[str, ...]
    ends: "array[int]"

    def bounds(self, at: int) -> tuple[int, int]:
        """Return where a unit begins and ends among the objects of the page."""
        return (self.ends[at - 1] if at else 0), self.ends[at]

    @property
    def sizes(self) -> list[int]:
        """How many objects each unit is."""
        return [end - start for start, end in pairwise((0, *self.ends))]

    def by_object(self) -> Iterator[tuple[str, int]]:
        """Yield for each object the key of its unit, and its place in that."""
        for key, size in zip(self.keys, self.sizes, strict=True):
            for at in range(size):
                yield key, at


class UnitKeys:
    """The keys of the units of a run.

    A key is a digest of the version of the code that computes, with its libraries and tables; of the settings, the
    museum's own rules and tables, measures and isolators, and which response charts are used; of the shaking of the
    floor; of the records of the unit's objects, without what nothing computed rests on; of the decisions about them
    that change what is computed; and of what the house rules come to for them.

    Parameters
    ----------
    context
        Of the run.
    rules
        Digest of the museum's own rules of classification; "" where it has none.
    tables
        Digests of the museum's own rows of what is assumed, by table.
    house
        By object number what the house rules come to, of those for whom they come to anything.
    """

    def __init__(self, context: RunContext, rules: str, tables: Mapping[str, str], house: Mapping[str, str]) -> None:
        analysis = context.analysis.model_dump(exclude={"workers", "fragility"})
        measures = repr(context.measures)
        charts = None if context.admitted is None else sorted(context.admitted)
        told = (rules, sorted(tables.items()), measures)
        asked = (sorted(analysis.items()), context.sampling, told, context.surveyed, context.fragile, charts)
        self._shaken = {
            name: seal(code_version(), repr((asked, _shaking(floor)))) for name, floor in context.floors.items()
        }
        # What is left aside is only classed, and stands as it was installed: no motion and no fidelity has a say in it.
        self._aside = {
            name: seal(code_version(), repr((told, context.surveyed, "aside", name))) for name in context.floors
        }
        self._stores, self._house = context.stores, house

    def basis(self, part: PagePart) -> str:
        """Return the digest of what results depend on besides the objects and the decisions about them."""
        return (self._shaken if part.on_display or self._stores else self._aside)[part.floor]

    def units(self, part: PagePart, decisions: Decisions) -> PageUnits:
        """Return the units of a page.

        Parameters
        ----------
        part
            The objects of the page.
        decisions
            Those in force, by object number.
        """
        basis, objects = self.basis(part), list(part.objects)
        together = part.on_display or self._stores
        starts = part.objects.companies().tolist() if together else range(len(objects))
        bounds = list(pairwise((*starts, len(objects))))
        keys = tuple(self._key(basis, objects[start:end], decisions) for start, end in bounds)
        return PageUnits(keys, array("I", [end for _, end in bounds]))

    def neighbours(self, pages: Sequence[tuple[PagePart, PageUnits]]) -> str:
        """Return the key of the gaps between the neighbours of a gallery.

        Parameters
        ----------
        pages
            All of the gallery, each with its units.
        """
        members = [
            (key, digest)
            for part, units in pages
            for (key, _), digest in zip(units.by_object(), part.objects.column("digest"), strict=True)
        ]
        return seal("neighbours", self.basis(pages[0][0]), repr(members))

    def _key(self, basis: str, members: Sequence[Listed], decisions: Decisions) -> str:
        digest = blake2b(basis.encode(), digest_size=16)
        for one in members:
            digest.update(one.assessment_digest.encode())
            if len(members) > 1:
                # What is advised for a case may name its objects.
                digest.update(repr((one.gallery, one.object_number)).encode("utf-8", "surrogatepass"))
            for decision in decisions.get(one.object_number, ()):
                # The others never change what is computed.
                if decision.kind in (DecisionKind.CLASS, DecisionKind.INSTALLED):
                    digest.update(repr(decision).encode("utf-8", "surrogatepass"))
            digest.update(self._house.get(one.object_number, "").encode())
        return digest.hexdigest()


def _shaking(floor: Floor) -> list[object]:
    out: list[object] = [floor.name, floor.x_azimuth, floor.hazard]
    for level in floor.levels:
        motions = [
            (m.motion.hash, m.motion.name, m.motion.start, m.motion.v_max, m.measures["pga"], m.measures["pgv"])
            for m in level.motions
        ]
        out.append((level.name, level.combine, level.return_period_years, motions))
    return out
