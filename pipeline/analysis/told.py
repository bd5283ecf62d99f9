"""How a thing is held by what its record says besides: its footing, its furniture, its isolator."""

from dataclasses import replace

from pipeline.records import Furniture, Item, Support
from pipeline.tables.assumed_rows import WHEN_HELD, ObjectClass

SLENDEREST = 9.0
"""Height over the smaller plan dimension from which nothing stands by itself: it lies, leans, hangs or is held."""

_TO_STAND_ON = (Furniture.FLOOR, Furniture.SHOWCASE, Furniture.PEDESTAL, Furniture.SHELF)


def as_told(item: Item, row: ObjectClass) -> Item:
    """Return a record with the support that the rest of it tells, where it does not name one.

    What has a footing that was measured stands on it, whatever things of its class usually do, and so does what usually
    hangs where its record names furniture to stand on.  What has an isolator stands on that.

    Parameters
    ----------
    item : Item
        The record, with what house rules say of its support.
    row : ObjectClass
        Its class.
    """
    if item.support is not None or item.hanging is not None:
        return item
    if item.isolator.strip():
        return replace(item, support=Support.ISOLATED)
    footing = item.base_width_m or item.base_depth_m or item.contact_polygon or item.tilt_angle_deg is not None
    hangs = row.support in (Support.HUNG, Support.SUSPENDED)
    stands = footing or (hangs and item.furniture in _TO_STAND_ON)
    usual = row.support is Support.FREESTANDING and WHEN_HELD not in row.models
    if not stands or (usual and not too_slender(item)):
        return item
    return replace(item, support=Support.FREESTANDING)


def too_slender(item: Item) -> float:
    """Return how many times as high as deep a thing is that by that cannot stand by itself; else 0."""
    plan = [d for d in (item.base_width_m or item.width_m, item.base_depth_m or item.depth_m) if d]
    times = item.height_m / min(plan) if plan and item.height_m is not None else 0.0
    return times if times > SLENDEREST else 0.0
