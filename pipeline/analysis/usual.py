"""Numbers that tables alone say, by a few words of a record: clearance, friction, damping."""

from functools import cache, lru_cache

from pipeline.records import Estimate
from pipeline.records import phrases as say
from pipeline.tables.assumed import AssumedValues, span, tables_of
from pipeline.tables.bending_rows import bending

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
def friction_of(values: AssumedValues, material: str, surface: str) -> Estimate:
    """Return the friction of a material on a surface [-]; "" for either where nobody says it."""
    rows = values.friction_of(material, surface)
    found = span(rows)
    of, on = material or "any material", surface or "any floor"
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
