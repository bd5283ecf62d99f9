"""The object record at the border: kinds and units of its fields, its JSON form and its JSON Schema."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum
from functools import cache
from hashlib import blake2b
from typing import Any, get_type_hints

from pydantic import TypeAdapter

from pipeline.quantities import LENGTHS, MASSES
from pipeline.records import ITEM_FIELDS, Anchorage, Furniture, Hanging, Item, Problem, Provenance, Support
from pipeline.tables import table
from pipeline.tables.rows import Number, checked

_CHOICES: Mapping[Any, type[StrEnum]] = {kind | None: kind for kind in (Support, Hanging, Furniture, Anchorage)}

KINDS: Mapping[str, str] = {
    name: {
        str: "text",
        float | None: "number",
        int | None: "integer",
        bool: "flag",
        bool | None: "flag",
        **dict.fromkeys(_CHOICES, "choice"),
        tuple[tuple[float, float], ...]: "polygon",
        tuple[Provenance, ...]: "list",
        tuple[Problem, ...]: "list",
    }[hint]
    for name, hint in get_type_hints(Item).items()
}
"""Field of Item -> "text", "number", "integer", "flag", "choice", "polygon" or "list", as its type hint says."""

STRUCTURED = frozenset({"polygon", "list"})
"""Kinds whose values are kept as JSON."""

CHOICES: Mapping[str, type[StrEnum]] = {
    name: _CHOICES[hint] for name, hint in get_type_hints(Item).items() if hint in _CHOICES
}
"""Field of Item of the kind "choice" -> its vocabulary."""

REQUIRED = ("object_number", "gallery")
"""The only fields that every record must have."""

TEXT_LIMIT = 2000
"""Characters that are kept of a text."""

NUMBER_LIMIT = 600
"""Characters of the longest object number: with four bytes each a database can still index them."""

_MEANINGS = {
    "object_number": "The museum's own number of the object; unique.",
    "gallery": "Current location.",
    "title": "Title as the museum gives it; text is never markup.",
    "object_name": "What kind of thing it is, such as vase or bust.",
    "classification": "The museum's classification.",
    "medium": "Material and technique in the museum's words.",
    "aat": "Getty AAT identifiers of its kind, material and technique, separated by spaces.",
    "dimensions": "Dimensions and weight in the museum's words, where they were read from a text.",
    "case": "Display case or plinth it stands in or on.",
    "displayed": "How it is displayed, in the museum's words, such as hung from the ceiling.",
    "position_x_m": "Position in the gallery, towards x (east).",
    "position_y_m": "Position in the gallery, towards y (north).",
    "orientation_deg": "Direction of the object's width, clockwise from north.",
    "support": "How the object is held.",
    "isolator": "Name of the isolator it stands on, if any.",
    "hanging": "How it hangs.",
    "furniture": "What it stands on or in, or hangs from.",
    "furniture_anchorage": "Whether that furniture is fastened to its floor or a wall.",
    "height_m": "Height.",
    "base_width_m": "Width of the footing.",
    "base_depth_m": "Depth of the footing.",
    "contact_polygon": "Points of the outline on which it stands, about the projected centre of gravity: x along its "
    "width, y a quarter turn counter-clockwise seen from above.",
    "contact_polygon_least": "The least that the outline may be, such as the three points that a rigid body rests on.",
    "tilt_angle_deg": "Angle of a tilt test at which it begins to tip over its nearest edge.",
    "width_m": "Largest width.",
    "depth_m": "Largest depth.",
    "cg_height_m": "Height of the centre of gravity above the base.",
    "mass_kg": "Mass.",
    "material": "Main material.",
    "base_material": "Material of the footing.",
    "surface_material": "Material of the surface it stands on.",
    "friction": "Coefficient of friction between footing and surface.",
    "frequency_hz": "Lowest natural frequency.",
    "damping": "Ratio to critical damping.",
    "suspension_length_m": "Length from the pivot to the centre of gravity.",
    "wall_surface": "Surface of the wall behind a hung object.",
    "back_surface": "Back of a hung object.",
    "section_shape": "Shape of the weakest cross-section.",
    "section_width_m": "Width of the weakest cross-section.",
    "section_depth_m": "Depth of the weakest cross-section.",
    "section_wall_m": "Wall thickness of a hollow cross-section.",
    "section_height_m": "Height of the weakest cross-section above the base.",
    "section_count": "How many such cross-sections share the load (legs, pins).",
    "allowable_stress_pa": "Stress that the weakest material may bear.",
    "condition": "Condition, from 0 (ruin) to 1 (sound).",
    "clearance_m": "Room to the nearest neighbour or edge.",
    "susceptible": "Whether rocking itself damages it.",
    "value_class": "The museum's own class of value.",
    "value": "What it is valued at, as for insurance, in the museum's own money.",
    "irreplaceable": "Whether nothing could take its place.",
    "on_loan": "Whether it is on loan to the museum.",
    "image": "Its photograph: a file below the folder of images, a URL, an IIIF image or manifest.",
    "image_credit": "Licence or credit line of its photograph.",
    "on_display": "Whether it is on display now; only then it is assessed.",
    "provenance": "Where each quantity comes from: how it was recorded, and the characters it was read from.",
    "problems": "What the import could not accept, or doubts.",
}


@dataclass(frozen=True, slots=True)
class Plausible:
    """The range that a quantity can have in a museum, ends included, in ``unit``; the reason says why."""

    low: Number
    high: Number
    unit: str
    reason: str


@cache
def plausible() -> Mapping[str, Plausible]:
    """Return the plausible range of every numeric field and of diameter_m (tables/plausible.csv).

    Returns
    -------
    mapping of str to Plausible
        By field.

    Raises
    ------
    TableError
        For a row that cannot be read.
    """
    rows = table("plausible")
    limits = checked(Plausible, rows, "plausible.csv", named="field")
    return {row["field"]: one for row, one in zip(rows, limits, strict=True)}


def units_of(field: str) -> Mapping[str, float]:
    """Return the units that a mapping may name for a field, with their factors to SI; empty where none is needed."""
    limits = plausible().get(field)
    return {"m": LENGTHS, "kg": MASSES}.get(limits.unit, {}) if limits else {}


@cache
def _items() -> TypeAdapter[list[Item]]:
    return TypeAdapter(list[Item])


def to_records(items: list[Item]) -> list[dict[str, Any]]:
    """Return items as JSON-ready records, one key for each field of Item; floats are the same floats."""
    out: list[dict[str, Any]] = _items().dump_python(items, mode="json")
    return out


@cache
def _item() -> TypeAdapter[Item]:
    return TypeAdapter(Item)


def digest_of(item: Item) -> str:
    """Return a digest of what is recorded: a field that a later Kouros adds leaves those of old records alone.

    Parameters
    ----------
    item : Item
        The record.

    Returns
    -------
    str
        128 bits as hexadecimal digits.
    """
    return blake2b(_item().dump_json(item, exclude_defaults=True), digest_size=16).hexdigest()


INDIVIDUAL = (
    "object_number", "gallery", "dimensions", "position_x_m", "position_y_m", "value", "on_loan", "image",
    "image_credit", "provenance", "problems",
)  # fmt: skip
"""Fields that tell one object from others that are alike: nothing computed of an object by itself rests on them."""

_INDIVIDUAL = set(INDIVIDUAL)


def assessment_digest_of(item: Item) -> str:
    """Return a digest of what the assessment of an object by itself rests on: all fields but INDIVIDUAL ones.

    The title is one of them, as the classification reads it.  Objects that share it are found to do the same under the
    same shaking, by the same rules and settings.

    Parameters
    ----------
    item : Item
        The record.

    Returns
    -------
    str
        128 bits as hexadecimal digits.
    """
    told = _item().dump_json(item, exclude=_INDIVIDUAL, exclude_defaults=True)
    return blake2b(told, digest_size=16).hexdigest()


def to_items(records: list[Any]) -> list[Item]:
    """Return the items of records that `to_records` made.

    Parameters
    ----------
    records : list
        Plain values.

    Returns
    -------
    list of Item
        In the same order.

    Raises
    ------
    pydantic.ValidationError
        A ValueError, naming record and field.
    """
    return _items().validate_python(records)


def item_schema() -> dict[str, Any]:
    """Return the JSON Schema (2020-12) of an object record, derived from Item; units and ranges in the descriptions."""
    derived = TypeAdapter(Item).json_schema(mode="serialization")
    for name, part in derived["$defs"].items():
        closed = {"additionalProperties": False} if part["type"] == "object" else {}
        derived["$defs"][name] = {key: value for key, value in part.items() if key != "description"} | closed
    properties = {}
    for name in ITEM_FIELDS:
        shape = {k: v for k, v in derived["properties"][name].items() if k != "title"}
        properties[name] = {"description": _describe(name), **_limited(name, shape)}
    return {
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Object record",
        "description": "One object of a collection; quantities in SI units, null where not recorded.",
        "type": "object",
        "additionalProperties": False,
        "required": list(REQUIRED),
        "properties": properties,
        "$defs": derived["$defs"],
    }


def _describe(name: str) -> str:
    limits = plausible().get(name)
    if limits is None:
        return _MEANINGS[name]
    unit = "" if limits.unit == "-" else f" {limits.unit}"
    return f"{_MEANINGS[name]} From {limits.low:g} to {limits.high:g}{unit}: {limits.reason}."


def _limited(name: str, shape: dict[str, Any]) -> dict[str, Any]:
    if KINDS[name] == "text":
        cap = {"maxLength": NUMBER_LIMIT if name == "object_number" else TEXT_LIMIT}
        return {**shape, **cap, **({"minLength": 1} if name in REQUIRED else {})}
    limits = plausible().get(name)
    if limits is None:
        return shape
    if KINDS[name] == "polygon":
        sides = [{"minimum": limits.low, "maximum": limits.high, "type": "number"}] * 2
        point = {**shape["items"], "prefixItems": sides}
        return {**shape, "items": point}
    first, *others = shape["anyOf"]
    return {**shape, "anyOf": [{**first, "minimum": limits.low, "maximum": limits.high}, *others]}
