"""What is known of the shape of a thing besides its class: a post, a folding screen, a block of one stone, a pair."""

from dataclasses import replace

from pipeline.analysis.mounts import MountGuess
from pipeline.records import Furniture, Item, Support
from pipeline.tables.assumed_rows import Material, ObjectClass
from pipeline.tables.body_rows import PAIR, SCREEN, BodyRow, body_of

SOFT = ("inflated", "feathers")
"""Materials of which rocking harms nothing: judgement."""


LEAF = 0.05
"""Depth over height below which the recorded depth of a folding screen is that of one leaf: judgement."""


def as_it_stands(item: Item, shape: BodyRow | None) -> Item:
    """Return a record without the depth of a single leaf, where a folding screen stands: folded it is deeper.

    Parameters
    ----------
    item : Item
        The record.
    shape : BodyRow or None
        What is known of its shape.
    """
    leaf = shape is not None and shape.body == SCREEN and (item.depth_m or 0.0) < LEAF * (item.height_m or 0.0)
    return replace(item, depth_m=None) if leaf else item


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
    text = f"{item.object_name} {item.title}"
    return body_of(text, words.partition(":")[0], row.name, material.name, item.height_m or 0.0)
