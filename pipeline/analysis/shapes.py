"""Shapes that a rule may ask for, by the measures of a record: flat, tall, small and the like; bounds are judgement."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from pipeline.records import Item

FLAT = 0.12
"""Depth over the larger face dimension below which a thing is a sheet, not a body."""
PANEL = 0.1
"""Depth [m] up to which a picture in its frame may be."""
FRAME = 0.25
"""Depth over the larger face dimension up to which a picture in its frame may be."""
SLAB = 0.12
"""Depth over the larger side of the face, of a narrow face over the smaller, below which a sculpture is a slab."""
THIN = 0.2
"""Smallest over largest recorded dimension below which a thing lies rather than stands."""
TALL = 2.0
"""Height over the larger plan dimension from which a sculpture is taken as a standing figure."""
LOW = 0.5
"""Height over the larger plan dimension below which a turned thing is a bowl."""
BROAD, BAND = 0.8, 0.2
"""Larger and smaller face dimension [m] from which a textile is hung, and is no band."""
BEAD = 0.06
"""Largest dimension [m] below which a head is a small find."""
DEEP = 0.7
"""Height over the larger plan dimension from which a bowl is a vessel."""
UPRIGHT, SHALLOW = 1.0, 0.75
"""Height [m] from which a piano may be an upright one, and depth over that height up to which it is."""
SMALL = 0.4
"""Height [m] below which a sculpture, no larger otherwise, is handled as a figurine."""
LARGE = 0.6
"""Largest dimension [m] from which a figure is a statue."""
TINY = 0.2
"""Largest dimension [m] below which a find or a plaque lies in a case."""


def _plan(item: Item) -> float:
    return max(item.width_m or 0.0, item.depth_m or 0.0)


def _sizes(item: Item) -> list[float]:
    return [size for size in (item.height_m, item.width_m, item.depth_m) if size is not None]


def faceless(item: Item) -> bool:
    """Say whether a length and a width are all that is told: of what is flat, the sides of its face.

    Parameters
    ----------
    item : Item
        The record.

    Returns
    -------
    bool
    """
    return item.height_m is None and bool(item.width_m and item.depth_m)


def _flat(item: Item) -> bool:
    return faceless(item) or (item.depth_m or 0.0) <= FLAT * max(item.height_m or 0.0, item.width_m or 0.0)


def _panel(item: Item) -> bool:
    if faceless(item):
        return True
    depth = item.depth_m or 0.0
    return depth <= PANEL or depth <= FRAME * max(item.height_m or 0.0, item.width_m or 0.0)


def _slab(item: Item) -> bool:
    low, high = sorted((item.height_m or 0.0, item.width_m or 0.0))
    return item.depth_m is not None and 0.0 < item.depth_m <= SLAB * (high if low >= BAND else low)


def _thin(item: Item) -> bool:
    sizes = _sizes(item)
    return len(sizes) == 3 and min(sizes) < THIN * max(sizes)


def _tall(item: Item) -> bool:
    return item.height_m is not None and 0.0 < TALL * _plan(item) <= item.height_m


def _broad(item: Item) -> bool:
    other = item.depth_m if faceless(item) else item.height_m
    face = [size for size in (other, item.width_m) if size is not None]
    return max(face, default=0.0) >= BROAD and min(face) >= BAND


def _deep(item: Item) -> bool:
    return item.height_m is not None and 0.0 < DEEP * _plan(item) <= item.height_m


def _low(item: Item) -> bool:
    return item.height_m is not None and item.height_m < LOW * _plan(item)


def _upright(item: Item) -> bool:
    plan = [side for side in (item.width_m, item.depth_m) if side is not None]
    return item.height_m is not None and item.height_m >= UPRIGHT and min(plan, default=9.0) <= SHALLOW * item.height_m


SHAPES: Mapping[str, Callable[[Item], bool]] = {
    "flat": _flat,
    "panel": _panel,
    "slab": _slab,
    "thin": _thin,
    "round": lambda item: not _slab(item) and not _thin(item),
    "tall": _tall,
    "low": _low,
    "deep": _deep,
    "small": lambda item: item.height_m is not None and item.height_m < SMALL and max(_sizes(item)) < LARGE,
    "not-small": lambda item: (item.height_m or 0.0) >= SMALL or max(_sizes(item), default=0.0) >= LARGE,
    "large": lambda item: max(_sizes(item), default=0.0) >= LARGE,
    "not-large": lambda item: max(_sizes(item), default=0.0) < LARGE,
    "tiny": lambda item: max(_sizes(item), default=TINY) < TINY,
    "not-tiny": lambda item: max(_sizes(item), default=0.0) >= TINY,
    "bead": lambda item: max(_sizes(item), default=BEAD) < BEAD,
    "broad": _broad,
    "upright": _upright,
    "unsized": lambda item: not _sizes(item),
}
"""The measures that a row may ask for.  A record without the dimensions is no small, tall, large or tiny thing, but
a flat one."""
