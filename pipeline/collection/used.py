"""What an object's record says of a doubtful field, and what is used of it, in words and SI units."""

from __future__ import annotations

from pipeline.collection.measured import FIELDS_FILLED
from pipeline.collection.record import KINDS, plausible
from pipeline.quantities import figures
from pipeline.records import Item

SHOWN, AWAY, YES, NO = "on display", "not on display", "yes", "no"
"""What is used of a flag."""

_LONGEST = 200
_SIZES = ("height_m", "width_m", "depth_m", "mass_kg")


def characters_of(item: Item, field: str) -> str:
    """Return the characters of the museum's record that a field rests on; "" where they are not kept."""
    written = "; ".join(of.written for of in item.provenance if of.field == field)
    if not item.dimensions or field not in ("dimensions", *FIELDS_FILLED):
        return written[:_LONGEST]
    if written in item.dimensions:
        return item.dimensions[:_LONGEST]
    # A column and a text speak of it.
    return f"{written[:_LONGEST]} | {item.dimensions[:_LONGEST]}"


def used_of(item: Item, field: str) -> str:
    """Return what is used of a field; "" where nothing is."""
    if field == "dimensions":
        return ", ".join(filter(None, (_size(item, name) for name in _SIZES)))
    kind = KINDS.get(field)
    value = getattr(item, field, None)
    if kind is None or value is None:
        return ""
    if kind in ("number", "integer"):
        return f"{figures(value, 4)} {plausible()[field].unit}".removesuffix(" -")
    if kind == "flag":
        return (SHOWN if value else AWAY) if field == "on_display" else (YES if value else NO)
    if kind in ("polygon", "list"):
        return f"{len(value)} points" if value else ""
    return str(value)[:_LONGEST]


def _size(item: Item, name: str) -> str:
    used = used_of(item, name)
    return used and f"{name.rpartition('_')[0]} {used}"
