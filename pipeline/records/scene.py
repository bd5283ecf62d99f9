"""An object of the collection, and where it stands with the estimates its models are run with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields
from enum import StrEnum


class Support(StrEnum):
    """How an object is held."""

    FREESTANDING = "freestanding"
    FASTENED = "fastened"
    HUNG = "hung"
    SUSPENDED = "suspended"
    ISOLATED = "isolated"


class Origin(StrEnum):
    """Where a number comes from."""

    MEASURED = "measured"
    DERIVED = "derived"
    ASSUMED = "assumed"


SECTION_SHAPES: Mapping[str, str] = {
    **dict.fromkeys(("round", "circle", "circular", "solid round"), "round"),
    **dict.fromkeys(("hollow round", "ring", "tube"), "hollow round"),
    **dict.fromkeys(("rectangle", "rectangular", "square", "legs"), "rectangle"),
}
"""What a museum may call the shape of a cross-section, and which shape that is."""


@dataclass(frozen=True, slots=True)
class Problem:
    """Something wrong with a record: which field, what is wrong, and what mends it."""

    field: str
    message: str
    remedy: str = ""


@dataclass(frozen=True, slots=True)
class Provenance:
    """Where one quantity of a record comes from.

    field   : the quantity, such as height_m
    origin  : measured (the museum recorded it) or derived (from another of its measurements)
    written : the characters it was read from, with their unit, such as "8 1/2 in"
    note    : which part it is of, or what it was derived from
    """

    field: str
    origin: Origin
    written: str
    note: str = ""


@dataclass(frozen=True, slots=True)
class Item:
    """One object of the collection.  Lengths in m, mass in kg, stress in Pa, frequency in Hz; None where not recorded.

    Everything recorded here was measured or stated by the museum, as ``provenance`` tells of each quantity; what Kouros
    assumes lives in the scene.  ``dimensions`` is the museum's own text where they were read from one.  ``problems``
    keeps what the import could not accept or doubts, so that nothing is lost and nothing silently defaulted.
    """

    object_number: str
    gallery: str
    title: str = ""
    object_name: str = ""
    classification: str = ""
    medium: str = ""
    aat: str = ""
    dimensions: str = ""
    case: str = ""
    position_x_m: float | None = None
    position_y_m: float | None = None
    orientation_deg: float | None = None
    support: Support | None = None
    isolator: str = ""
    height_m: float | None = None
    base_width_m: float | None = None
    base_depth_m: float | None = None
    width_m: float | None = None
    depth_m: float | None = None
    cg_height_m: float | None = None
    mass_kg: float | None = None
    material: str = ""
    base_material: str = ""
    surface_material: str = ""
    friction: float | None = None
    frequency_hz: float | None = None
    damping: float | None = None
    suspension_length_m: float | None = None
    wall_surface: str = ""
    back_surface: str = ""
    section_shape: str = ""
    section_width_m: float | None = None
    section_depth_m: float | None = None
    section_wall_m: float | None = None
    section_height_m: float | None = None
    section_count: int | None = None
    allowable_stress_pa: float | None = None
    condition: float | None = None
    clearance_m: float | None = None
    susceptible: bool | None = None
    value_class: str = ""
    on_display: bool = True
    provenance: tuple[Provenance, ...] = ()
    problems: tuple[Problem, ...] = ()


ITEM_FIELDS = tuple(f.name for f in fields(Item))


@dataclass(frozen=True, slots=True)
class Estimate:
    """A number with its range and where it comes from.

    ``low`` and ``high`` span what the number may be; a measured number has no span.  ``note`` names the field it was
    derived from or the default that was assumed; ``source`` says who says so.
    """

    value: float
    unit: str
    origin: Origin
    low: float
    high: float
    note: str = ""
    source: str = ""

    @classmethod
    def measured(cls, value: float, unit: str, note: str = "") -> Estimate:
        """Return a number that the museum recorded."""
        return cls(value, unit, Origin.MEASURED, value, value, note)


@dataclass(frozen=True, slots=True)
class Scene:
    """An object where it stands: its class, its support, and the estimates its models are run with.

    parameters : by name (SI), for example half_width, cg_height, friction_static, length, clearance
    missing    : the fields without which no model can be run, in the museum's words
    skipped    : models that do not apply, with the reason
    floor      : of the building that it stands on; "" for the ground
    """

    item: Item
    object_class: str
    rule: str
    support: Support
    models: tuple[str, ...]
    parameters: Mapping[str, Estimate]
    assumptions: tuple[str, ...] = ()
    missing: tuple[str, ...] = ()
    skipped: Mapping[str, str] = field(default_factory=dict)
    floor: str = ""
