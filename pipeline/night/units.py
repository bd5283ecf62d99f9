"""The collection cut into sheets: what is worked on, stored and shown as one piece.

A sheet is a gallery.  A gallery of more than MOST objects is cut into several, in the order of cases and numbers, at
objects that their own numbers choose, so that one object more or less moves no other cut; a case is never cut.
"""

import hashlib
from bisect import bisect_left, bisect_right
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from itertools import accumulate

from pipeline.collection.listing import Listed, Listing, Run
from pipeline.night.context import Brief
from pipeline.night.floors import Storey, floor_name
from pipeline.records import Decision, DecisionKind
from pipeline.resources import code_version
from pipeline.settings import Settings

MOST = 1_000
"""Objects on a sheet at most, unless one case holds more: a page that a browser shows at once, a piece of seconds."""

LEAST = 500
"""Objects on a sheet before a cut is looked for, where a gallery is cut at all."""

_CHOSEN = 32
"""One object in so many is where a cut may be."""


@dataclass(frozen=True, slots=True)
class Part:
    """The objects of one sheet, before anything is known about them; the gallery is "" of what is not on display."""

    gallery: str
    on_display: bool
    number: int
    of: int
    objects: Listing


@dataclass(frozen=True)
class Sheets:
    """A collection cut into sheets.

    objects : of all parts, one behind the other
    """

    objects: Listing
    parts: tuple[Part, ...]

    def holding(self, numbers: Collection[str]) -> dict[str, Part]:
        """Return the parts that objects are in, by number and in the objects' order; others are left out."""
        ends = list(accumulate(len(part.objects) for part in self.parts))
        places = self.objects.places(numbers)
        return {number: self.parts[bisect_right(ends, at)] for number, at in places.items()}


def cut(objects: Listing, settings: Settings) -> Sheets:
    """Cut a collection into sheets: galleries by name, then what is not on display, floor by floor.

    objects : sorted by `listing.order`
    """
    groups: dict[tuple[bool, str], list[Run]] = {}
    for run in objects.runs:
        # What is not on display shares pages, but not with what stands on another floor.
        place = run.gallery if run.on_display else floor_name(settings, run.gallery)
        groups.setdefault((not run.on_display, place), []).append(run)
    arranged = objects.joined(run for group in sorted(groups) for run in groups[group])
    out: list[Part] = []
    stored: list[Listing] = []
    start = 0
    for absent, place in sorted(groups):
        end = start + sum(run.end - run.start for run in groups[absent, place])
        pieces = _pieces(arranged[start:end])
        start = end
        if absent:
            stored += pieces
        else:
            out += [Part(place, True, n, len(pieces), piece) for n, piece in enumerate(pieces, 1)]
    out += [Part("", False, n, len(stored), piece) for n, piece in enumerate(stored, 1)]
    return Sheets(arranged, tuple(out))


def _pieces(members: Listing) -> list[Listing]:
    if len(members) <= MOST:
        return [members]
    begins = members.companies()
    ends = [*begins[1:].tolist(), len(members)]
    out, start, company = [], 0, 0
    while start < len(members):
        # The first that must not be on this piece, unless it is alone there, and the first that need not.
        full = max(bisect_right(ends, start + MOST), company + 1)
        least = max(bisect_left(begins, start + LEAST), company + 1)
        company = next((at for at in range(least, full) if _chosen(members[int(begins[at])])), full)
        end = int(begins[company]) if company < len(begins) else len(members)
        out.append(members[start:end])
        start = end
    return out


def _chosen(one: Listed) -> bool:
    text = one.object_number.encode("utf-8", "surrogatepass")
    return hashlib.blake2b(text, digest_size=2).digest()[0] % _CHOSEN == 0


class Keys:
    """The key of a sheet: a digest of everything that what is found about it depends on."""

    def __init__(self, brief: Brief, rules: str) -> None:
        analysis = brief.analysis.model_dump(exclude={"workers", "fragility"})
        # The order of a set is another in every process.
        measures = [repr(replace(m, classes=frozenset())) + repr(sorted(m.classes)) for m in brief.means.measures]
        means = (measures, repr(brief.means.isolators))
        # Whether stores are asked for says which charts pay, and so which verdicts are read from one.
        asked = (sorted(analysis.items()), rules, means, brief.surveyed, brief.fragile, brief.stores)
        shared = repr((code_version(), asked))
        self._stores = brief.stores
        self._shaken = {name: _digest(f"{shared}{_shaking(storey)!r}") for name, storey in brief.storeys.items()}
        # What is left aside is only classed: no motion and no fineness has a say in it.
        self._aside = {
            name: _digest(repr((code_version(), rules, brief.surveyed, "aside", name))) for name in brief.storeys
        }

    def basis(self, part: Part, floor: str) -> str:
        """Return the digest of what is found of a part besides its objects and the decisions about them."""
        return self._shaken[floor] if part.on_display or self._stores else self._aside[floor]

    def of(self, part: Part, floor: str, decisions: Sequence[Decision]) -> str:
        """Return the key of a part; which of its gallery's sheets it is does not matter.

        decisions : those in force about its objects
        """
        digest = hashlib.sha256(self.basis(part, floor).encode() + part.objects.digest())
        for decision in decisions:
            # The others never change what is computed.
            if decision.kind in (DecisionKind.CLASS, DecisionKind.INSTALLED):
                digest.update(repr(decision).encode("utf-8", "surrogatepass"))
        return digest.hexdigest()


def _digest(text: str) -> str:
    return hashlib.sha256(text.encode("utf-8", "surrogatepass")).hexdigest()


def _shaking(storey: Storey) -> list[object]:
    out: list[object] = [storey.x_azimuth]
    for level in storey.levels:
        motions = [(m.motion.hash, m.motion.name, m.motion.start, m.motion.v_max) for m in level.motions]
        out.append((level.name, level.combine, level.return_period_years, motions))
    return out
