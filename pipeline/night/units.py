"""Units: what is assessed together, one object or all in one case, and the key that its results are kept under."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from hashlib import blake2b
from itertools import pairwise

from pipeline.collection.listing import Listed
from pipeline.collection.sealing import seal
from pipeline.night.context import RunContext
from pipeline.night.floors import Floor
from pipeline.night.paging import PagePart
from pipeline.records import Decision, DecisionKind
from pipeline.resources import code_version

Decisions = Mapping[str, tuple[Decision, ...]]
"""Those in force, by object number."""


@dataclass(frozen=True, slots=True)
class Unit:
    """What is assessed together.

    Attributes
    ----------
    key
        Digest of everything that its results depend on.
    members
        Its objects, in the order of the catalogue.
    """

    key: str
    members: tuple[Listed, ...]


class UnitKeys:
    """The keys of the units of a run.

    A key is a digest of the version of the code that computes, with its libraries and tables; of the settings, the
    museum's own rules and tables, measures and isolators, and which response charts are used; of the shaking of the
    floor; of the records of the unit's objects, without what nothing computed rests on; and of the decisions about
    them that change what is computed.

    Parameters
    ----------
    context
        Of the run.
    rules
        Digest of the museum's own rules of classification; "" where it has none.
    tables
        Digests of the museum's own rows of what is assumed, by table.
    """

    def __init__(self, context: RunContext, rules: str, tables: Mapping[str, str]) -> None:
        analysis = context.analysis.model_dump(exclude={"workers", "fragility"})
        measures = repr(context.measures)
        charts = None if context.admitted is None else sorted(context.admitted)
        told = (rules, sorted(tables.items()), measures)
        asked = (sorted(analysis.items()), told, context.surveyed, context.fragile, charts)
        self._shaken = {
            name: seal(code_version(), repr((asked, _shaking(floor)))) for name, floor in context.floors.items()
        }
        # What is left aside is only classed, and stands as it was installed: no motion and no fidelity has a say in it.
        self._aside = {
            name: seal(code_version(), repr((told, context.surveyed, "aside", name))) for name in context.floors
        }
        self._stores = context.stores

    def basis(self, part: PagePart) -> str:
        """Return the digest of what results depend on besides the objects and the decisions about them."""
        return (self._shaken if part.on_display or self._stores else self._aside)[part.floor]

    def units(self, part: PagePart, decisions: Decisions) -> list[Unit]:
        """Return the units of a page, in the order of its objects.

        Parameters
        ----------
        part
            The objects of the page.
        decisions
            Those in force, by object number.
        """
        basis, objects = self.basis(part), list(part.objects)
        if not (part.on_display or self._stores):
            return [Unit(_key(basis, [one], decisions), (one,)) for one in objects]
        ends = [*part.objects.companies().tolist(), len(objects)]
        companies = (tuple(objects[start:end]) for start, end in pairwise(ends))
        return [Unit(_key(basis, members, decisions), members) for members in companies]

    def neighbours(self, part: PagePart, units: Iterable[Unit]) -> str:
        """Return the key of the gaps between the neighbours of a gallery.

        Parameters
        ----------
        part
            Any of the gallery's pages.
        units
            Of all of them.
        """
        members = [(unit.key, one.digest) for unit in units for one in unit.members]
        return seal("neighbours", self.basis(part), repr(members))


def _key(basis: str, members: Sequence[Listed], decisions: Decisions) -> str:
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
    return digest.hexdigest()


def _shaking(floor: Floor) -> list[object]:
    out: list[object] = [floor.name, floor.x_azimuth]
    for level in floor.levels:
        motions = [
            (m.motion.hash, m.motion.name, m.motion.start, m.motion.v_max, m.measures["pga"]) for m in level.motions
        ]
        out.append((level.name, level.combine, level.return_period_years, motions))
    return out
