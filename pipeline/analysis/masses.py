"""What tables alone say of an object: its mass where nobody weighed it, clearance, friction, damping.

What is made of metal is sheet, cast hollow, or of rods, and what is made of papier-mâché or fibreglass is a shell: it
fills far less than the same thing of wood or clay.  What makes it lighter makes its critical section thinner too, so
that one must not be counted without the other.
"""

import re
from collections.abc import Mapping
from functools import cache, lru_cache
from math import pi

from pipeline.records import Estimate, Furniture, Item, Origin, Support
from pipeline.records import phrases as say
from pipeline.tables import Range
from pipeline.tables.assumed import UNKNOWN, AssumedValues, span, tables_of
from pipeline.tables.assumed_rows import Material, ObjectClass
from pipeline.tables.bending_rows import bending
from pipeline.tables.body_rows import SCREEN, BodyRow
from pipeline.tables.fill_rows import fill_of

_FRAMED = (5.0, 15.0, 40.0)
"""Mass of a square metre of a framed work [kg/m2], by judgement: low, best, high."""

_SUSPENDED = (0.5, 8.0, 60.0)
"""The same of what hangs from above, over its outline: from a mobile of sheet and wire to a chandelier of crystal."""

_CLOTH = (0.3, 1.5, 5.0)
"""The same of cloth on a wall whose thickness nobody recorded: from a silk banner over a tapestry to a pile carpet."""

_SCREEN = (2.0, 5.0, 15.0)
"""The same of a folding screen that stands: paper or silk over a lattice of wood, to leather and lacquered boards."""


CLOTH, FRAMED = "paper", "framed"
"""The material of cloth and leather, and the class of what a frame holds."""


def mass_of(
    item: Item,
    row: ObjectClass,
    material: Material,
    support: Support,
    shape: BodyRow | None = None,
    *,
    thick: bool = True,
) -> Estimate | None:
    """Return the mass of an object [kg]: as recorded, else by what fills its outline, else by its area where it hangs.

    Parameters
    ----------
    item : Item
        Its record.
    row : ObjectClass
        Its class.
    material : Material
        What it is made of.
    support : Support
        How it is held.
    shape : BodyRow or None
        What is known of its shape besides its class: how much of its outline it fills goes before its material, and a
        folding screen is as thin as what hangs.
    thick : bool
        Whether its depth is recorded: of cloth on a wall an assumed one says nothing.

    Returns
    -------
    Estimate or None
        None where its sizes or its class do not say it.
    """
    if item.mass_kg is not None:
        return Estimate.measured(item.mass_kg, "kg")
    box, own = _outline(item, row), None if shape is not None else _shell_fill(item, row, material)
    screen = shape is not None and shape.body == SCREEN
    fill = own or row.filled
    # A slab of stone weighs many times as much as a picture of its size; of what nobody knows what it is made, either.
    by_volume = fill is not None and item.depth_m is not None and material.name != UNKNOWN
    cloth = material.name == CLOTH and row.name != FRAMED and support is Support.HUNG and not thick
    wall = (_CLOTH, say.MASS_OF_CLOTH) if cloth else (_FRAMED, say.MASS_OF_FRAMED)
    face = {Support.HUNG: wall, Support.SUSPENDED: (_SUSPENDED, say.MASS_OF_SUSPENDED)}
    per_area, face_phrase = (_SCREEN, say.MASS_OF_SCREEN) if screen else face.get(support, (None, None))
    if per_area and face_phrase and item.height_m and item.width_m and (screen or cloth or not by_volume):
        area, (low, best, high) = item.height_m * item.width_m, per_area
        note = face_phrase(mass=per_area)
        return Estimate.assumed(best * area, low * area, high * area, "kg", note, "judgement")
    if fill is None or box is None:
        return None
    density = material.density_range
    phrase = say.MASS_OF_SHELL if own else say.MASS_OF_CLASS if row.aside else say.MASS
    note = phrase(material=material.told, density=density.value, fill=fill.value, aside=row.aside.strip(" ()"))
    low, high = box * fill.low * density.low, box * fill.high * density.high
    return Estimate.assumed(box * fill.value * density.value, low, high, "kg", note, density.source)


def solid_mass(item: Item, row: ObjectClass, material: Material) -> Estimate | None:
    """Return the mass below which a thing of sheet or a shell is hollow, and its critical section with it [kg].

    Parameters
    ----------
    item, row, material : Item, ObjectClass, Material
        As of `mass_of`.

    Returns
    -------
    Estimate or None
        None where its section is recorded, or nothing says that it may be hollow.
    """
    box, filled = _outline(item, row), row.filled
    if item.section_width_m is not None or box is None or filled is None or _shell_fill(item, row, material) is None:
        return None
    mass = box * filled.value * material.density_range.value
    return Estimate(mass, "kg", Origin.ASSUMED, mass, mass, say.SOLID(mass=mass), "judgement")


def _outline(item: Item, row: ObjectClass) -> float | None:
    """Return the volume [m3] that a thing takes up; None where its sizes do not say it."""
    across, along = item.width_m or item.depth_m, item.depth_m or item.width_m
    if not (item.height_m and across and along):
        return None
    return item.height_m * across * along * (0.25 * pi if row.round else 1.0)


def _shell_fill(item: Item, row: ObjectClass, material: Material) -> Range | None:
    """Return how much of its outline fills.csv says that it fills; a museum's own row of the class goes before."""
    return None if row.own else fill_of(row.name, material.name, item.height_m or 0.0)


_BASES = tuple(
    re.compile(pattern, re.IGNORECASE)
    for pattern in (
        r"\b(?:base|socle|zoccolo|peana|Sockel)\W+(?:of|en|de|in|di|aus)\W+(\w+)",
        r"\b(?:on|with|sur|su|auf|mit|con|sobre)\W+((?:\w+\W+){1,5}?)(?:base|socle|plinth|Sockel|peana)\b",
        r"[;,]\W*((?:\w+\W+){1,3}?)(?:base|socle|plinth|Sockel|peana)\b",
    )
)
"""Words for what a thing stands on that belongs to it: "bronze on a marble base", "hide; wooden base"."""


@lru_cache(maxsize=4096)
def _base_in(values: AssumedValues, text: str) -> str:
    told = (group for found in _BASES for match in found.finditer(text) for group in match.groups())
    plain = (re.sub(r"\bwooden\b", "wood", group, flags=re.IGNORECASE) for group in told)
    stuff = next((one for group in plain if (one := values.material_in(group)) is not None), None)
    return "" if stuff is None else stuff.friction_as


def base_of(values: AssumedValues, item: Item) -> str:
    """Return as what a thing slides by the words for its base; "" where there are none.

    values : the tables that know the words
    """
    told = item.base_material.strip()
    known = {row.pair[0] for row in values.friction}
    if told and told.lower() not in known:
        stuff = values.material_in(told)
        return told if stuff is None else stuff.friction_as or told
    return told or _base_in(values, item.medium)


ON_ANY: Mapping[Furniture | None, str] = {
    Furniture.SHOWCASE: "anything in a showcase",
    Furniture.SHELF: "any shelf",
    Furniture.PEDESTAL: "any pedestal",
}
"""What is said of a surface that nobody tells, by what it is on; of others "any floor"."""

# What depends on a table and a few words only is worked out once, not for every object of a collection.


@lru_cache(maxsize=4096)
def clearance_of(values: AssumedValues, object_class: str) -> Estimate | None:
    """Return the free distance around an object of a class [m]; None where its row says none."""
    row = values.classes[object_class]
    if row.room is None:
        return None
    note = say.CLEARANCE(room=row.room, told=row.told)
    return Estimate.assumed(row.room.value, row.room.low, row.room.high, "m", note, row.room.source)


@lru_cache(maxsize=4096)
def friction_of(values: AssumedValues, material: str, surface: str, furniture: Furniture | None = None) -> Estimate:
    """Return the friction of a material on a surface [-]; "" for either where nobody says it.

    furniture : on which the surface is, of one that nobody says
    """
    rows = values.friction_of(material, surface, furniture)
    found = span(rows)
    of, on = material or "any material", surface or ON_ANY.get(furniture, "any floor")
    note = f"{say.FRICTION(friction=found, tables=tables_of(rows), material=of, surface=on)}; {say.NOT_MEASURED()}"
    return Estimate.assumed(found.value, found.low, found.high, "-", note, found.source)


@lru_cache(maxsize=4096)
def wall_damping_of(values: AssumedValues, wall: str, back: str) -> Estimate:
    """Return the damping of a work against its wall [-], by wall and back surface; "" where nobody says it."""
    rows = values.damping_of(wall, back)
    found = span(rows)
    note = say.DAMPING_ON(back=back or "its back", wall=wall or "the wall", tables=tables_of(rows))
    if not wall and not back:
        least = min(rows, key=lambda row: row.low)
        pair = {"back": least.back_surface.lower(), "wall": least.wall_surface.lower()}
        note = f"{say.DAMPING_LEAST(**pair, tables=tables_of(rows))}; {say.SURFACES_NOT_RECORDED()}"
    # With nothing known of its back the lowest damping counts.
    return Estimate.assumed(found.value if back else found.low, found.low, found.high, "-", note, found.source)


@cache
def own_damping() -> Estimate:
    """Return the damping of an object that bends [-]."""
    found = bending("damping")
    note = say.OWN_DAMPING(damping=found)
    return Estimate.assumed(found.value, found.low, found.high, "-", note, found.source)
