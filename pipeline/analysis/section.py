"""Critical section: its shape and sizes, recorded or as its class assumes them, and what bending asks of it."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import pi

from pipeline.errors import InputError
from pipeline.records import SECTION_SHAPES, Estimate, Item, Origin
from pipeline.records import phrases as say
from pipeline.tables import Range
from pipeline.tables.assumed_rows import ObjectClass

OF_CLASS = {"stem": ("round", 1), "ankles": ("round", 2), "foot": ("rectangle", 1), "legs": ("rectangle", 4)}
"""Shape and number of the sections that classes.csv names."""

PLAN = "plan"
"""Section of what is as wide and as deep from its foot up, a slab or a pillar: a share of either side of its base."""


@dataclass(frozen=True, slots=True)
class Section:
    """The weakest section of an object.

    Attributes
    ----------
    shape : str
        round, hollow round, rectangle, or ring: the foot of a vessel, whose wall is ``width``.
    width, depth : Estimate
        [m].
    count : int
        How many there are side by side.
    wall : float
        [m], 0 where it is solid; of a ring the outer diameter.
    note : str
        Where it comes from, in words.
    """

    shape: str
    width: Estimate
    depth: Estimate
    count: int
    wall: float
    note: str

    def at(self, end: str) -> tuple[float, float]:
        """Return area [m2] and weaker section modulus [m3] at an end of its size: "low", "value" or "high"."""
        return section_properties(self.shape, getattr(self.width, end), getattr(self.depth, end), self.count, self.wall)

    def inertia(self, end: str) -> float:
        """Return the weaker second moment of area [m4] at an end of its size: the modulus times half the thickness."""
        sides = (self.wall,) if self.shape == "ring" else (getattr(self.width, end), getattr(self.depth, end))
        across = sides[:1] if self.shape in ("round", "hollow round") else sides
        return 0.5 * min(across) * self.at(end)[1]

    def estimates(self, oriented: bool) -> dict[str, Estimate]:
        """Return area and section modulus, and where the object's axes are known the moduli along them.

        Area and modulus vary together: the range of the section is carried by the modulus, which bending feels.
        """
        size, deep = self.width, self.depth
        (area, modulus), low, high = self.at("value"), self.at("low")[1], self.at("high")[1]
        found = {
            "area": Estimate(area, "m2", size.origin, area, area, self.note, size.source),
            "section_modulus": Estimate(modulus, "m3", size.origin, low, high, self.note, size.source),
        }
        if oriented and self.shape == "rectangle" and size.value != deep.value:
            # Both sides of the section were measured: it bends the less, the longer the side along the push.
            sides = (("section_modulus_width", size, deep), ("section_modulus_depth", deep, size))
            for name, along, across in sides:
                least, value, most = (
                    self.count * rectangle_modulus(getattr(along, end), getattr(across, end), self.wall)
                    for end in ("low", "value", "high")
                )
                found[name] = Estimate(value, "m3", size.origin, least, most, self.note, size.source)
        return found


@dataclass(frozen=True, slots=True)
class KnownSection:
    """A section, None where there is none; what must be recorded to know it, and what is doubtful, in words."""

    section: Section | None = None
    missing: Sequence[str] = ()
    doubts: Sequence[str] = ()


def section_of(item: Item, row: ObjectClass, width: Estimate | None, depth: Estimate | None) -> KnownSection:
    """Return the weakest section of an object: as recorded, or as its class assumes it.

    Parameters
    ----------
    item : Item
        Its record.
    row : ObjectClass
        Its class.
    width, depth : Estimate or None
        Sides of its base [m].

    Returns
    -------
    KnownSection
    """
    missing: list[str] = []
    doubts: list[str] = []
    if item.section_width_m is not None:
        size = Estimate.measured(item.section_width_m, "m")
        deep = Estimate.measured(item.section_depth_m or item.section_width_m, "m")
        shape = SECTION_SHAPES.get(item.section_shape.strip().casefold() or "rectangle", "")
        if shape == "hollow round" and item.section_wall_m is None:
            missing.append("wall of its weakest section")
        elif shape:
            note = say.SECTION_RECORDED(shape=item.section_shape or shape)
            return KnownSection(Section(shape, size, deep, item.section_count or 1, item.section_wall_m or 0.0, note))
        else:
            doubts.append(say.SECTION_UNKNOWN(shape=repr(item.section_shape)))
    if row.critical is None or width is None or depth is None:
        return KnownSection(None, missing, doubts)
    narrow = min(width, depth, key=lambda e: e.value)
    kind = row.section
    across = min(item.width_m or item.depth_m or narrow.value, item.depth_m or item.width_m or narrow.value)
    if min(narrow.low, across) <= 0.0:
        # What has no width has no section either.
        return KnownSection(None, missing, doubts)
    of_base = kind in ("foot", "legs", "ring", PLAN)
    what = "wall of its foot" if kind == "ring" else f"critical section ({kind})"
    of = "narrower base side" if of_base else "narrower side"
    size = share_of(row, row.critical, narrow.value if of_base else across, "m", what, of)
    if kind == "ring":
        # The size is the wall; the ring's outside is the base.
        return KnownSection(Section("ring", size, narrow, 1, narrow.value, size.note), missing, doubts)
    if kind == PLAN:
        # A slab of 92 x 24 cm bends as one, and not as a post of 24 x 24 cm.
        size, deep = (share_of(row, row.critical, side.value, "m", what, "base side") for side in (width, depth))
        # As deep as wide it may be round, a column, which is the weaker.
        shape = "round" if width.value == depth.value else "rectangle"
        return KnownSection(Section(shape, size, deep, 1, 0.0, size.note), missing, doubts)
    shape, count = OF_CLASS[kind]
    return KnownSection(Section(shape, size, size, count, 0.0, size.note), missing, doubts)


def share_of(row: ObjectClass, share: Range, base: float, unit: str, what: str, of: str) -> Estimate:
    """Return a share of a recorded dimension, as the row of the class assumes it."""
    note = say.SHARE(what=what, share=share, of=of, told=row.told)
    low, value, high = share.low * base, share.value * base, share.high * base
    return Estimate(value, unit, Origin.ASSUMED, low, high, note, share.source)


def section_properties(shape: str, width: float, depth: float, count: int, wall: float) -> tuple[float, float]:
    """Return area [m2] and weaker section modulus [m3] of ``count`` equal sections side by side.

    round: solid of diameter width, or hollow where wall > 0; rectangle: width x depth, hollow where wall > 0;
    ring: width is the wall and wall the outer diameter (a vessel's foot)
    raises : ValueError for another shape
    """
    if shape == "ring":
        width, wall = wall, min(width, 0.5 * wall)
        shape = "round"
    if shape in ("round", "hollow round"):
        inner = max(width - 2.0 * wall, 0.0) if wall > 0.0 else 0.0
        area = 0.25 * pi * (width**2 - inner**2)
        modulus = pi * (width**4 - inner**4) / (32.0 * width)
    elif shape == "rectangle":
        narrow, wide = min(width, depth), max(width, depth)
        inner = max(narrow - 2.0 * wall, 0.0) * max(wide - 2.0 * wall, 0.0) if wall > 0.0 else 0.0
        area = narrow * wide - inner
        modulus = rectangle_modulus(narrow, wide, wall)
    else:
        raise InputError(f"section_shape {shape!r} is not known; use round, hollow round, rectangle or ring")
    return count * area, count * modulus


def rectangle_modulus(along: float, across: float, wall: float) -> float:
    """Return the section modulus [m3] of a rectangle, hollow where wall > 0, for a push along one side [m]."""
    inner_along = max(along - 2.0 * wall, 0.0) if wall > 0.0 else 0.0
    inner_across = max(across - 2.0 * wall, 0.0) if wall > 0.0 else 0.0
    return (across * along**3 - inner_across * inner_along**3) / (6.0 * along)
