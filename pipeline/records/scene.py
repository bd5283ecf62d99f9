"""Object of the collection, and the scene in which it stands with the estimates its models are run with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from enum import StrEnum


class Support(StrEnum):
    """Way in which an object is held."""

    FREESTANDING = "freestanding"
    FASTENED = "fastened"
    HUNG = "hung"
    SUSPENDED = "suspended"
    ISOLATED = "isolated"


class Hanging(StrEnum):
    """Way in which a work hangs: on one hook or wire, on two hooks or D-rings, on a cleat, by security hardware."""

    WIRE = "wire"
    TWO_HOOKS = "two_hooks"
    CLEAT = "cleat"
    SECURITY = "security"
    FIXED = "fixed"


class Mount(StrEnum):
    """Way in which a thing is held that lies in a case, or that cannot stand by itself."""

    LYING = "lying"
    STANDING = "standing"
    LEANING = "leaning"
    RESTING = "resting"
    SECURED = "secured"
    UNKNOWN = "unknown"


class Furniture(StrEnum):
    """Furniture that an object stands on or in, or that it hangs from."""

    FLOOR = "floor"
    SHOWCASE = "showcase"
    PEDESTAL = "pedestal"
    SHELF = "shelf"
    WALL = "wall"
    RAIL = "rail"


class SurfaceMaterial(StrEnum):
    """Surface that an object stands on, as friction.csv names it, in small letters."""

    TERRAZZO = "terrazzo"
    MOSAIC = "mosaic"
    STONE = "stone"
    CONCRETE = "concrete"
    WOOD = "wood"
    PLYWOOD = "plywood"
    FORMICA = "formica"
    GLASS = "glass"
    ACRYLIC = "acrylic"
    METAL = "metal"
    ALUMINUM = "aluminum"
    CARPET = "carpet"
    FABRIC = "fabric"
    FELT = "felt"
    RUBBER = "rubber"


class Anchorage(StrEnum):
    """Whether furniture is fastened to its floor or a wall."""

    ANCHORED = "anchored"
    UNANCHORED = "unanchored"


class Origin(StrEnum):
    """Origin of a number: in the record of the object, derived from it, stated by a house rule, or assumed."""

    MEASURED = "measured"
    DERIVED = "derived"
    STATED = "stated"
    ASSUMED = "assumed"


SECTION_SHAPES: Mapping[str, str] = {
    **dict.fromkeys(("round", "circle", "circular", "solid round"), "round"),
    **dict.fromkeys(("hollow round", "ring", "tube"), "hollow round"),
    **dict.fromkeys(("rectangle", "rectangular", "square", "legs"), "rectangle"),
}
"""What a museum may call the shape of a cross-section, and which shape that is."""


@dataclass(frozen=True, slots=True)
class Problem:
    """Something wrong with a record.

    Attributes
    ----------
    field, message, remedy : str
        Which field, what is wrong, and what mends it.
    """

    field: str
    message: str
    remedy: str = ""


@dataclass(frozen=True, slots=True)
class Provenance:
    """Provenance of one quantity of a record.

    Attributes
    ----------
    field : str
        The quantity, such as height_m.
    origin : Origin
        Measured (the museum recorded it) or derived (from another of its measurements).
    written : str
        The characters it was read from, with their unit, such as "8 1/2 in".
    note : str
        Which part it is of, or what it was derived from.
    """

    field: str
    origin: Origin
    written: str
    note: str = ""


@dataclass(frozen=True, slots=True)
class Item:
    """One object of the collection; None and "" where the museum recorded nothing.

    Everything recorded here was measured or stated by the museum, as ``provenance`` tells of each quantity; what Kouros
    assumes lives in the scene.  schemas/item.schema.json says what each field may hold.

    Attributes
    ----------
    object_number, gallery, title, object_name, classification, medium, aat : str
        As the museum names, places and classes it; aat are identifiers of the Getty AAT.
    dimensions : str
        The museum's own text where they were read from one.
    case : str
        The display case or plinth that it stands in or on.
    displayed : str
        How it is displayed, in the museum's words.
    position_x_m, position_y_m, orientation_deg : float or None
        In the gallery, m towards east and north, and the direction of its width, degrees clockwise from north.
    support, isolator : Support or None, str
        How it is held, and by which isolator.
    hanging, furniture : Hanging or None, Furniture or None
        How it hangs, and what it stands on or in or hangs from.
    furniture_anchorage : Anchorage or None
        Whether that is fastened to its floor or a wall.
    height_m, base_width_m, base_depth_m, width_m, depth_m, cg_height_m : float or None
        Extents, those of the footing, and the height of the centre of gravity above the base, m.
    contact_polygon, contact_polygon_least : tuple of (float, float)
        Points of the outline on which it stands, and of the least that it may be, m about the projected centre of
        gravity: x along its width, y a quarter turn counter-clockwise from it seen from above; () where not recorded.
    tilt_angle_deg : float or None
        At which it begins to tip over its nearest edge, degrees: atan(half width / height of the centre of gravity).
    mass_kg : float or None
        In kg.
    material, base_material, surface_material : str
        Of the object, its base, and what it stands on.
    friction, frequency_hz, damping : float or None
        Static friction [-], lowest frequency [Hz], damping ratio [-].
    suspension_length_m, wall_surface, back_surface : float or None, str, str
        Of what hangs: its length [m], and the surfaces of the wall and of its back.
    section_shape, section_width_m, section_depth_m, section_wall_m, section_height_m, section_count
        Weakest cross-section: its shape, sizes and height [m], and how many there are.
    allowable_stress_pa : float or None
        In Pa.
    condition : float or None
        From 0 (ruin) to 1 (sound).
    clearance_m : float or None
        To the nearest neighbour or edge, m.
    susceptible, value_class, on_display : bool or None, str, bool
        Whether rocking itself damages it, the museum's class of value, and whether it is on display.
    value : float or None
        What it is valued at, in the museum's own money.
    irreplaceable, on_loan : bool or None
        Whether nothing could take its place, and whether it belongs to somebody else.
    image, image_credit : str
        Where its photograph is (a file, a URL, an address of IIIF), and who is to be credited for that.
    provenance : tuple of Provenance
        Of each quantity.
    problems : tuple of Problem
        What the import could not accept or doubts, so that nothing is lost and nothing silently defaulted.
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
    displayed: str = ""
    position_x_m: float | None = None
    position_y_m: float | None = None
    orientation_deg: float | None = None
    support: Support | None = None
    isolator: str = ""
    hanging: Hanging | None = None
    furniture: Furniture | None = None
    furniture_anchorage: Anchorage | None = None
    height_m: float | None = None
    base_width_m: float | None = None
    base_depth_m: float | None = None
    contact_polygon: tuple[tuple[float, float], ...] = ()
    contact_polygon_least: tuple[tuple[float, float], ...] = ()
    tilt_angle_deg: float | None = None
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
    value: float | None = None
    irreplaceable: bool | None = None
    on_loan: bool | None = None
    image: str = ""
    image_credit: str = ""
    on_display: bool = True
    provenance: tuple[Provenance, ...] = ()
    problems: tuple[Problem, ...] = ()

    @property
    def called(self) -> str:
        """What people know it by: its title, or else what it is."""
        return self.title or self.object_name


LIKELY = 0.1
"""Probability above which a class that an object is not taken for is named beside its own."""

ITEM_FIELDS = tuple(f.name for f in fields(Item))


@dataclass(frozen=True, slots=True)
class Estimate:
    """A number with its range and where it comes from.

    Attributes
    ----------
    value : float
        The best, in ``unit``.
    unit : str
        SI, or "-".
    origin : Origin
        Whether it was measured, derived, stated by a house rule or assumed.
    low, high : float
        What the number may be between, in ``unit``; a measured number has no span.
    note : str
        The field it was derived from or the default that was assumed.
    source : str
        Who says so.
    per : str
        The parameter that it is proportional to: of a range of both, they go up and down together; "" for none.
    cause : str
        The parameter that shares the cause of its range, so that both are high together; "" for none.
    """

    value: float
    unit: str
    origin: Origin
    low: float
    high: float
    note: str = ""
    source: str = ""
    per: str = ""
    cause: str = ""

    def times(self, low: float, best: float, high: float, note: str = "") -> Estimate:
        """Return the number with its ends and its best value each multiplied by a factor.

        Parameters
        ----------
        low, best, high : float
            The factors [-].
        note : str
            What it says then, see the class.

        Returns
        -------
        Estimate
        """
        return replace(self, value=best * self.value, low=low * self.low, high=high * self.high, note=note)

    @classmethod
    def measured(cls, value: float, unit: str, note: str = "") -> Estimate:
        """Return a number that the museum recorded.

        Parameters
        ----------
        value : float
            In that unit.
        unit : str
            SI, or "-".
        note : str
            See the class.

        Returns
        -------
        Estimate
            Without a span.
        """
        return cls(value, unit, Origin.MEASURED, value, value, note)

    @classmethod
    def assumed(cls, value: float, low: float, high: float, unit: str, note: str, source: str) -> Estimate:
        """Return a number that nobody recorded.

        Parameters
        ----------
        value, low, high : float
            In that unit.
        unit : str
            SI, or "-".
        note, source : str
            See the class.

        Returns
        -------
        Estimate
            With its range.
        """
        return cls(value, unit, Origin.ASSUMED, low, high, note, source)


@dataclass(frozen=True, slots=True)
class Scene:
    """An object where it stands: its class, its support, and the estimates its models are run with.

    Attributes
    ----------
    item : Item
        Its record.
    object_class, rule : str
        Row of tables/classes.csv, and the rule of tables/rules.csv by which it is that.
    support : Support
        How it is held.
    models : tuple of str
        Those that are run on it.
    parameters : mapping of str to Estimate
        By name (SI), for example half_width, cg_height, friction_static, length, clearance.
    assumptions : tuple of str
        In words.
    missing : tuple of str
        The fields without which no model can be run, in the museum's words.
    skipped : mapping of str to str
        Models that do not apply, with the reason.
    floor : str
        Of the building that it stands on; "" for the ground.
    hanging, furniture : Hanging or None, Furniture or None
        How it hangs, by its record or else by a house rule, None where neither says; and what it stands on or in or
        hangs from.
    furniture_origin : Origin or None
        Where the furniture is known from: the record, a house rule, the case that the record names, or what is usual.
    statements : tuple of str
        What house rules say of it besides its numbers, and where its record overrules them, in words.
    anchorage : Anchorage or None
        Whether its furniture is fastened, by its record or else by a house rule; None where neither says.
    chances : tuple of (str, float)
        The classes that are likely at all by what its record says, with their probability, the likeliest first; ()
        where a person decided.
    mount, mount_origin : Mount or None, Origin or None
        How it is held where it lies in a case or cannot stand by itself, None of all else; and by what
        that is known.
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
    hanging: Hanging | None = None
    furniture: Furniture | None = None
    statements: tuple[str, ...] = ()
    furniture_origin: Origin | None = None
    anchorage: Anchorage | None = None
    chances: tuple[tuple[str, float], ...] = ()
    mount: Mount | None = None
    mount_origin: Origin | None = None

    @property
    def next_class(self) -> tuple[str, float] | None:
        """The next likely class and its probability, where that is likely enough to say so (`LIKELY`)."""
        others = (pair for pair in self.chances if pair[0] != self.object_class and pair[1] > LIKELY)
        return next(others, None)

    @property
    def stands_by(self) -> Origin | None:
        """Where it is known from what the object stands on; None where nobody says, or it hangs as all such do."""
        hangs = self.support in (Support.HUNG, Support.SUSPENDED)
        return None if hangs and self.furniture_origin is Origin.ASSUMED else self.furniture_origin


UNTOLD_ISOLATOR = "what its isolator does: write it down as installed (kouros decide)"
"""What is missing of an object that stands on an isolator, by its record, of which no numbers are known."""

_TOO_THIN = ("support (it is ", " times as high as it is deep: it cannot stand by itself, or a measure is wrong)")


def too_thin(times: float) -> str:
    """Return what is missing of an object that is too thin to stand, where nothing tells how it is held."""
    return f"{times:.0f}".join(_TOO_THIN)


def times_too_thin(missing: str) -> int | None:
    """Return how many times as high as deep an object is, where that is why its support is missing; else None."""
    before, after = _TOO_THIN
    times = missing.removeprefix(before).removesuffix(after)
    return int(times) if times.isdecimal() and missing == times.join(_TOO_THIN) else None
