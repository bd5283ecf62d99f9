"""Sizes of an object: those recorded, and those assumed from a recorded one by the proportions of its class."""

from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import exp, hypot, log

from pipeline.analysis.shapes import faceless
from pipeline.records import Estimate, Item, Origin, Support
from pipeline.records import phrases as say
from pipeline.tables.assumed_rows import WHEN_HELD, ObjectClass
from pipeline.tables.proportion_rows import proportions

SIZES = ("height", "width", "depth")
"""Sizes of an object as it stands, as parameters of a scene and, with _m, as fields of a record."""

PLAN = ("width", "depth")
"""Those of its plan."""


def sizes_known(item: Item) -> dict[str, float]:
    """Return the sizes [m] that a record has."""
    found = ((name, getattr(item, f"{name}_m")) for name in SIZES)
    return {name: size for name, size in found if size}


def ratio_of(row: ObjectClass, size: str, known: Mapping[str, float]) -> Estimate | None:
    """Return a size that nobody recorded, as a multiple of one that somebody did.

    Parameters
    ----------
    row : ObjectClass
        Its class.
    size : str
        Which of `SIZES`.
    known : mapping of str to float
        Those that are recorded [m].

    Returns
    -------
    Estimate or None
        [m], of the proportion that says most; None where none of those recorded says anything.
    """
    # Of what lies or is held by a mount the size that nobody recorded is how thick it is.
    of = {min(known, key=known.__getitem__)} if WHEN_HELD in row.models and known else known.keys()
    able = [p for p in proportions().get((row.name, size), ()) if p.of in of and p.above <= known[p.of]]
    for one in able:
        last = max(p.above for p in able if p.of == one.of)
        if one.above == last and len(known) >= one.known:
            best, low, high = (times * known[one.of] for times in (one.value, one.low, one.high))
            note = say.SIZE(size=size, share=one, of=one.of, told=row.told)
            return Estimate.assumed(best, low, high, "m", note, f"proportions.csv ({one.source})")
    return None


def face_of(item: Item) -> Estimate | None:
    """Return the height of what hangs and has a length and a width alone, as rugs and scrolls do.

    A text that gives a length and no height leaves open which side is up; the record holds the length as a depth.

    Parameters
    ----------
    item : Item
        Of what hangs flat.

    Returns
    -------
    Estimate or None
        [m]: its length, between the one side and the other; None where the record tells a height, or only one side.
    """
    if not faceless(item) or item.width_m is None or item.depth_m is None:
        return None
    low, high = sorted((item.width_m, item.depth_m))
    note = f"{say.FACE(length=item.depth_m)}; {say.FACE_TURNED(other=low)}"
    return Estimate.assumed(item.depth_m, low, high, "m", note, "judgement")


def _plan_known(size: str, known: Mapping[str, float]) -> bool:
    # Of what is round one of them says both; where neither is known, its width is assumed.
    return size == "depth" or (size == "width" and "depth" in known)


@dataclass(frozen=True)
class Sizes:
    """Sizes of an object, recorded or assumed.

    Attributes
    ----------
    item : Item
        Its record.
    assumed : mapping of str to Estimate
        By name, those that are not recorded and could be assumed [m].
    round : bool
        Whether it is as deep as it is wide.
    """

    item: Item
    assumed: Mapping[str, Estimate] = field(default_factory=dict)
    round: bool = False

    @classmethod
    def of(cls, item: Item, row: ObjectClass, *, deep: Callable[[float], Estimate] | None = None) -> "Sizes":
        """Return the sizes of an object of a class; ``deep`` says how deep one of its height stands [m]."""
        hung = face_of(item) if row.support == Support.HUNG else None
        if hung is not None:
            item = replace(item, depth_m=None)
        known = sizes_known(item)
        # What is round is as deep as it is wide, whether that is known or assumed.
        asked = [name for name in SIZES if known and name not in known and not (row.round and _plan_known(name, known))]
        found = {name: ratio_of(row, name, known) if name != "height" or hung is None else hung for name in asked}
        if deep is not None and "depth" in found and item.height_m is not None:
            found["depth"] = deep(item.height_m)
        return cls(item, {name: one for name, one in found.items() if one is not None}, row.round)

    @cached_property
    def filled(self) -> Item:
        """The record with the best estimates in place of what is not recorded."""
        return replace(self.item, **{f"{name}_m": one.value for name, one in self.assumed.items()})  # type: ignore[arg-type]

    def used(self, names: Collection[str]) -> dict[str, Estimate]:
        """Return those of some sizes that are assumed, in one order however they are named: pages number them in it."""
        return {name: one for name, one in self.assumed.items() if name in names}

    @property
    def narrow(self) -> str:
        """The smaller size of its plan; "" where neither is known nor assumed."""
        sides = {name: getattr(self.filled, f"{name}_m") for name in PLAN}
        return min((name for name, size in sides.items() if size), key=sides.__getitem__, default="")

    def spread(self, estimate: Estimate, names: Iterable[str], power: float = 1.0, cause: str = "") -> Estimate:
        """Return what was found with the best estimates of some sizes, as uncertain as these make it.

        The factors have nothing to do with each other, so that their percentiles add up as squares, in the logarithm.

        Parameters
        ----------
        estimate : Estimate
            Found with `filled`.
        names : iterable of str
            The sizes that it hangs on; those recorded change nothing.
        power : float
            By which power of each it grows.
        cause : str
            The parameter that shares its cause, with which it goes up and down.

        Returns
        -------
        Estimate
        """
        # What is round grows with its width twice.
        times = Counter("width" if self.round and name == "depth" else name for name in names)
        some = {self.assumed[name]: power * count for name, count in times.items() if name in self.assumed}
        if not some:
            return estimate
        least, most = [_away(estimate, "low")], [_away(estimate, "high")]
        for size, grows in some.items():
            down, up = sorted((grows * _away(size, "low"), grows * _away(size, "high")))
            least.append(down)
            most.append(up)
        low, high = estimate.value * exp(-hypot(*least)), estimate.value * exp(hypot(*most))
        return replace(estimate, low=low, high=high, origin=Origin.ASSUMED, cause=cause)


def _away(estimate: Estimate, end: str) -> float:
    """Return how far an end of a range is from the best estimate, in the logarithm."""
    ratio: float = getattr(estimate, end) / estimate.value
    return log(ratio)
