"""Numbers that tables alone say, by a few words of a record: clearance, friction, damping."""

from functools import cache, lru_cache

from pipeline.records import Estimate
from pipeline.tables.assumed import AssumedValues, span, tables_of
from pipeline.tables.bending_rows import bending

# What depends on a table and a few words only is worked out once, not for every object of a collection.


@lru_cache(maxsize=4096)
def clearance_of(values: AssumedValues, object_class: str) -> Estimate | None:
    """Return the free distance around an object of a class [m]; None where its row says none."""
    row = values.classes[object_class]
    if row.room is None:
        return None
    low, value, high = (100.0 * v for v in (row.room.low, row.room.value, row.room.high))
    note = f"clearance: {value:g} cm ({low:g} to {high:g}) to neighbour, wall or edge, assumed for: {row.told}"
    return Estimate.assumed(row.room.value, row.room.low, row.room.high, "m", note, row.room.source)


@lru_cache(maxsize=4096)
def friction_of(values: AssumedValues, material: str, surface: str) -> Estimate:
    """Return the friction of a material on a surface [-]; "" for either where nobody says it."""
    rows = values.friction_of(material, surface)
    found = span(rows)
    pair = f"{material or 'any material'} on {surface or 'any floor'}"
    note = f"friction: {found.value:g} ({found.low:g} to {found.high:g}), {tables_of(rows)} for {pair}; not measured"
    return Estimate.assumed(found.value, found.low, found.high, "-", note, found.source)


@lru_cache(maxsize=4096)
def wall_damping_of(values: AssumedValues, wall: str, back: str) -> Estimate:
    """Return the damping of a work against its wall [-], by wall and back surface; "" where nobody says it."""
    rows = values.damping_of(wall, back)
    found = span(rows)
    note = f"damping of {back or 'its back'} on {wall or 'the wall'} ({tables_of(rows)})"
    if not wall and not back:
        least = min(rows, key=lambda row: row.low)
        pair = f"{least.back_surface.lower()} on {least.wall_surface.lower()}"
        note = f"damping against the wall: {pair}, the least of {tables_of(rows)}; wall and back surfaces not recorded"
    # With nothing known of its back the lowest damping counts.
    return Estimate.assumed(found.value if back else found.low, found.low, found.high, "-", note, found.source)


@cache
def own_damping() -> Estimate:
    """Return the damping of an object that bends [-]."""
    found = bending("damping")
    low, value, high = (100.0 * v for v in (found.low, found.value, found.high))
    note = f"damping of the object itself: {value:g} % ({low:g} to {high:g} %), assumed"
    return Estimate.assumed(found.value, found.low, found.high, "-", note, found.source)
