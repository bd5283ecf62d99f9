"""The collection cut into sheets: what is worked on, stored and shown as one piece.

A sheet is a gallery.  A gallery of more than MOST objects is cut into several, in the order of cases and numbers, at
objects that their own numbers choose, so that one object more or less moves no other cut; a case is never cut.
"""

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache

from pipeline.collection.catalogue import Listed
from pipeline.jobs.desk import Brief
from pipeline.jobs.levels import Storey, floor_name
from pipeline.kernels import KERNEL_VERSION
from pipeline.records import Decision, DecisionKind
from pipeline.resources import digest_of
from pipeline.settings import Settings

MOST = 1_000
"""Objects on a sheet at most, unless one case holds more: a page that a browser shows at once, a piece of seconds."""

LEAST = 500
"""Objects on a sheet before a cut is looked for, where a gallery is cut at all."""

_CHOSEN = 32
"""One object in so many is where a cut may be."""

_ELSEWHERE = frozenset({"cli", "collection", "execute", "motions", "report"})
"""Folders of the package that results do not rest on, or whose own result is a part of the key: items, motions."""


@dataclass(frozen=True, slots=True)
class Part:
    """The objects of one sheet, before anything is known about them; the gallery is "" of what is not on display."""

    gallery: str
    on_display: bool
    number: int
    of: int
    objects: tuple[Listed, ...]


def cut(objects: Sequence[Listed], settings: Settings) -> list[Part]:
    """Cut a collection into sheets: galleries by name, then what is not on display, floor by floor."""
    groups: dict[tuple[bool, str], list[Listed]] = {}
    for one in objects:
        # What is not on display shares pages, but not with what stands on another floor.
        place = one.gallery if one.on_display else floor_name(settings, one.gallery)
        groups.setdefault((one.on_display, place), []).append(one)
    out: list[Part] = []
    stored: list[list[Listed]] = []
    for (on_display, place), members in sorted(groups.items(), key=lambda group: (not group[0][0], group[0][1])):
        pieces = list(_pieces(members))
        if on_display:
            out += [Part(place, True, n, len(pieces), tuple(piece)) for n, piece in enumerate(pieces, 1)]
        else:
            stored += pieces
    return out + [Part("", False, n, len(stored), tuple(piece)) for n, piece in enumerate(stored, 1)]


def _pieces(members: Sequence[Listed]) -> Iterator[list[Listed]]:
    if len(members) <= MOST:
        yield list(members)
        return
    piece: list[Listed] = []
    for company in _companies(members):
        full = len(piece) + len(company) > MOST
        if piece and (full or (len(piece) >= LEAST and _chosen(company[0]))):
            yield piece
            piece = []
        piece += company
    if piece:
        yield piece


def _companies(members: Sequence[Listed]) -> Iterator[list[Listed]]:
    """Yield what must stay together: the objects of a case, and each other object by itself."""
    company: list[Listed] = []
    for one in sorted(members, key=lambda m: (m.gallery, m.case, m.object_number)):
        if company and (not one.case or (one.gallery, one.case) != (company[0].gallery, company[0].case)):
            yield company
            company = []
        company.append(one)
    yield company


def _chosen(one: Listed) -> bool:
    text = one.object_number.encode("utf-8", "surrogatepass")
    return hashlib.blake2b(text, digest_size=2).digest()[0] % _CHOSEN == 0


@cache
def _code() -> str:
    return digest_of(kinds=(".py", ".csv"), but=_ELSEWHERE)


class Keys:
    """The key of a sheet: a digest of everything that what is found about it depends on.

    bases : by floor, the digest of what results depend on besides the objects and the decisions about them
    """

    def __init__(self, brief: Brief, rules: str) -> None:
        analysis = brief.analysis.model_dump(exclude={"workers", "fragility"})
        # The order of a set is another in every process.
        measures = [repr(replace(m, classes=frozenset())) + repr(sorted(m.classes)) for m in brief.means.measures]
        means = (measures, repr(brief.means.isolators))
        asked = (sorted(analysis.items()), rules, means, brief.surveyed, brief.fragile)
        shared = repr((_code(), KERNEL_VERSION, asked))
        self.bases = {
            name: hashlib.sha256(f"{shared}{_shaking(storey)!r}".encode("utf-8", "surrogatepass")).hexdigest()
            for name, storey in brief.storeys.items()
        }

    def of(self, part: Part, floor: str, decisions: Mapping[str, Sequence[Decision]]) -> str:
        """Return the key of a part; which of its gallery's sheets it is does not matter.

        decisions : those in force, by object number
        """
        digest = hashlib.sha256(self.bases[floor].encode())
        for one in part.objects:
            digest.update(f"{one.object_number}\0{one.digest}\0".encode("utf-8", "surrogatepass"))
            for decision in decisions.get(one.object_number, ()):
                # The others never change what is computed.
                if decision.kind in (DecisionKind.CLASS, DecisionKind.INSTALLED):
                    digest.update(repr(decision).encode("utf-8", "surrogatepass"))
        return digest.hexdigest()


def _shaking(storey: Storey) -> list[object]:
    out: list[object] = [storey.x_azimuth]
    for level in storey.levels:
        motions = [(m.motion.hash, m.motion.name, m.motion.start, m.motion.v_max) for m in level.motions]
        out.append((level.name, level.combine, level.return_period_years, motions))
    return out
