"""What is known of the shape of a thing besides its class: a post, a folding screen, a block of one stone, a pair."""

from collections.abc import Callable
from dataclasses import replace

from pipeline.analysis.mounts import MountGuess
from pipeline.records import Estimate, Furniture, Item, Support
from pipeline.records import phrases as say
from pipeline.tables.assumed import READ
from pipeline.tables.assumed_rows import Material, ObjectClass
from pipeline.tables.body_rows import ON_EDGE, PAIR, SCREEN, STANDS, BodyRow, body_of

SOFT = ("inflated", "feathers")
"""Materials of which rocking harms nothing: judgement."""


_FOLDED = (0.2, 0.1, 0.4)
"""Depth over height of a folding screen as it stands: leaves of 0.4 of its height, folded by 15 to 75 degrees."""

_FOOT = (0.25, 0.12, 0.4)
"""The same of a stand that bears a flat thing, such as a shield: as deep as keeps it upright (judgement)."""

LEAF, FLAT = 0.05, 0.2
"""Depth over height below which the recorded depth of a folding screen is that of one leaf, and that of a thing on a
stand is its own and not that of the stand: judgement."""


def stands_deep(shape: BodyRow) -> Callable[[float], Estimate] | None:
    """Return what says how deep a body of some height stands [m], where its depth is not that; None of others."""
    said = {SCREEN: (_FOLDED, say.SCREEN_FOLDED), **dict.fromkeys(STANDS, (_FOOT, say.STAND_FOOT))}.get(shape.body)
    if said is None:
        return None
    shares, phrase = said

    def deep(height: float) -> Estimate:
        best, low, high = (share * height for share in shares)
        return Estimate.assumed(best, low, high, "m", phrase(share=shares), "judgement")

    return deep


def as_it_stands(item: Item, shape: BodyRow | None) -> Item:
    """Return a record without a depth that is no footing: of one leaf of a folding screen, of a shield on its stand.

    Parameters
    ----------
    item : Item
        The record.
    shape : BodyRow or None
        What is known of its shape.
    """
    if shape is None or (shape.body != SCREEN and shape.body not in STANDS):
        return item
    thin = (item.depth_m or 0.0) < (LEAF if shape.body == SCREEN else FLAT) * (item.height_m or 0.0)
    return replace(item, depth_m=None) if thin and (shape.body == SCREEN or item.depth_m) else item


def on_floor(item: Item, shape: BodyRow | None) -> Item:
    """Return a record as it is, and of two bodies with both on the floor: the lower one is no furniture.

    Parameters
    ----------
    item : Item
        The record.
    shape : BodyRow or None
        What is known of its shape.
    """
    if shape is None or shape.body != PAIR or item.furniture not in (None, Furniture.PEDESTAL):
        return item
    return replace(item, furniture=Furniture.FLOOR, furniture_anchorage=None)


def body(
    item: Item, row: ObjectClass, words: str, support: Support, mount: MountGuess | None, material: Material
) -> BodyRow | None:
    """Return what is known of the shape of a thing besides its class.

    Parameters
    ----------
    item : Item
        Its record.
    row : ObjectClass
        Its class.
    words : str
        Why it is of that, beginning with the rule.
    support, mount : Support, MountGuess or None
        How it is held.
    material : Material
        What it is made of.

    Returns
    -------
    BodyRow or None
        None for what does not stand, and for what a museum's own row says.
    """
    stands = support in (Support.FREESTANDING, Support.FASTENED) and (mount is None or mount.stands)
    if row.own or not stands:
        return None
    text = f"{item.object_name[:READ]} {item.title[:READ]}"
    found = body_of(text, words.partition(":")[0], row.name, material.name, item.height_m or 0.0)
    # How thick a frame is says nothing of what an altarpiece stands on.
    return None if found is not None and found.body in ON_EDGE and item.depth_m is None else found
