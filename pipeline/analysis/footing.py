"""Footing: how far it is from the projected centre of gravity to the edges about which an object rocks.

A tilt test says it best, then a contact polygon, then the sides of a base.  Of a base that is itself only assumed from
the overall size, not all may bear (tables/contacts.csv).
"""

import re
from collections.abc import Mapping
from dataclasses import replace
from functools import cache, cached_property, lru_cache
from math import exp, hypot, log, radians, tan
from typing import Self

from pydantic import BaseModel, Field, model_validator

from pipeline.errors import InputError
from pipeline.records import ContactPolygon, Estimate, Item, Origin
from pipeline.records import phrases as say
from pipeline.tables import table
from pipeline.tables.assumed import READ
from pipeline.tables.rows import Entries, Number, Optional, any_of, checked

ALONG = {
    "half_base_width": 0.0,
    "half_base_width_other": 180.0,
    "half_base_depth": 90.0,
    "half_base_depth_other": 270.0,
}
"""Half widths along an object's own axes, and their directions in its contact polygon [degrees from x towards y]."""

HALVES = ("half_width", "half_width_other", *ALONG)
"""All half widths that a scene may have."""


def half_widths(
    item: Item, object_class: str, width: Estimate | None, depth: Estimate | None, cg_height: Estimate | None
) -> dict[str, Estimate]:
    """Return the half widths of an object.

    Parameters
    ----------
    item : Item
        Its record.
    object_class : str
        Row of tables/classes.csv; "" where the museum's own row says of its base what bears.
    width, depth : Estimate or None
        Sides of its base, m; None where they are not known.
    cg_height : Estimate or None
        Height of its centre of gravity, m.

    Returns
    -------
    dict of str to Estimate
        half_width, towards the nearest edge, with half_width_other opposite of it where that differs; and those ALONG
        its own axes where its orientation is known.  Empty where nothing is known of its base.
    """
    found: dict[str, Estimate] = {}
    if item.contact_polygon:
        found = _of_polygon(item)
    elif width is not None and depth is not None:
        found = _of_sides(_borne(width, item, object_class), _borne(depth, item, object_class))
    if item.tilt_angle_deg is not None and cg_height is not None:
        found = tilted(found, tan(radians(item.tilt_angle_deg)), cg_height)
    if item.orientation_deg is None:
        found = {name: half for name, half in found.items() if name not in ALONG}
    return found


def base_extents(item: Item) -> tuple[Estimate, Estimate] | None:
    """Return how wide and deep an object's contact polygon is [m]; None where none is recorded."""
    if not item.contact_polygon:
        return None
    width, depth = ContactPolygon.around(item.contact_polygon).extents
    return Estimate.measured(width, "m"), Estimate.measured(depth, "m")


def _of_sides(width: Estimate, depth: Estimate) -> dict[str, Estimate]:
    narrow = min(width, depth, key=lambda side: side.value)
    low, high = min(width.low, depth.low), min(width.high, depth.high)
    origins = {side.origin for side in (width, depth)}
    origin = next((one for one in (Origin.ASSUMED, Origin.STATED) if one in origins), Origin.MEASURED)
    note = "; ".join(dict.fromkeys(side.note for side in (width, depth) if side.note))
    source = narrow.source or width.source or depth.source
    half = Estimate(0.5 * narrow.value, "m", origin, 0.5 * low, 0.5 * high, note, source)
    # Along its own axes each half counts in its direction; where nothing is known of them, the narrow one.
    return {"half_width": half, "half_base_width": _half(width), "half_base_depth": _half(depth)}


def _half(side: Estimate) -> Estimate:
    return replace(side, value=0.5 * side.value, low=0.5 * side.low, high=0.5 * side.high)


def _of_polygon(item: Item) -> dict[str, Estimate]:
    outline = ContactPolygon.around(item.contact_polygon)
    least = ContactPolygon.around(item.contact_polygon_least) if item.contact_polygon_least else outline
    nearest, way = outline.narrowest()
    found = {"half_width": _between(nearest, min(least.narrowest()[0], least.reach(way)))}
    opposite = (way + 180.0) % 360.0
    found["half_width_other"] = _between(outline.reach(opposite), least.reach(opposite))
    return found | {name: _between(outline.reach(angle), least.reach(angle)) for name, angle in ALONG.items()}


def _between(value: float, least: float) -> Estimate:
    if least >= value:
        return Estimate.measured(value, "m", say.POLYGON())
    return Estimate(value, "m", Origin.DERIVED, least, value, say.POLYGON_LEAST(value=value, least=least))


def tilted(found: Mapping[str, Estimate], slope: float, cg_height: Estimate) -> dict[str, Estimate]:
    """Return half widths of which the least is what a tilt test says.

    Parameters
    ----------
    found : mapping of str to Estimate
        Half widths that are known otherwise, m.
    slope : float
        Tangent of the angle at which it begins to tip: half width over height of the centre of gravity [-].
    cg_height : Estimate
        Height of the centre of gravity, m; the half width is proportional to it.

    Returns
    -------
    dict of str to Estimate
        half_width, and what was found of the others: none is less.
    """
    low, value, high = (slope * height for height in (cg_height.low, cg_height.value, cg_height.high))
    note = say.TILTED(slope=slope)
    tested = Estimate(value, "m", Origin.DERIVED, low, high, note, "tilt test", "cg_height")
    own = [name for name in ALONG if name in found]
    nearest = min(own, key=lambda name: found[name].value, default="")
    out = {"half_width": tested}
    for name, half in found.items():
        if name == nearest or (name != "half_width" and half.value <= value):
            out[name] = tested
        elif name != "half_width":
            # Of all edges the test found the nearest.
            out[name] = replace(half, low=max(half.low, min(value, half.value)))
    return out


# What of an assumed base bears ----------------------------------------------------------------------------------------


class Bearing(BaseModel):
    """How much of the base that is assumed of an object may really bear (a row of tables/contacts.csv).

    Attributes
    ----------
    words : Entries
        In an object's name, title, medium or display, by which it is known; * is up to three words.
    classes : Entries
        With words the classes whose words they are, () for any; else those of which it is assumed.
    taller_than : Number
        Height from which its words count [m]: a mascot of a car does not roll.
    rolling : Optional
        Friction that keeps it from rolling away [-], None where it does not roll.
    """

    contact: str
    title: str
    words: Entries
    classes: Entries
    taller_than: Number = Field(ge=0.0)
    share: Number = Field(gt=0.0, le=1.0)
    low: Number = Field(gt=0.0)
    high: Number = Field(le=1.0)
    rolling: Optional
    rolling_low: Optional
    rolling_high: Optional
    source: str = Field(min_length=1)

    @model_validator(mode="after")
    def _in_order(self) -> Self:
        if not self.low <= self.share <= self.high:
            raise InputError(f"low <= share <= high does not hold ({self.low:g} {self.share:g} {self.high:g})")
        ends = (self.rolling_low, self.rolling, self.rolling_high)
        known = [end for end in ends if end is not None]
        if len(known) not in (0, len(ends)) or known != sorted(known):
            raise InputError("rolling_low <= rolling <= rolling_high does not hold; fill all three, or none")
        return self

    @cached_property
    def rolls(self) -> Estimate | None:
        """What keeps it from rolling away, as a friction [-]; None where it does not roll."""
        if self.rolling is None or self.rolling_low is None or self.rolling_high is None:
            return None
        note = say.ROLLS(friction=(self.rolling_low, self.rolling, self.rolling_high), contact=self.title)
        source = f"contacts.csv, {self.contact} ({self.source})"
        return Estimate.assumed(self.rolling, self.rolling_low, self.rolling_high, "-", note, source)


@cache
def bearings() -> tuple[Bearing, ...]:
    """Return the rows of tables/contacts.csv.

    Returns
    -------
    tuple of Bearing
        In the order of the table.

    Raises
    ------
    TableError
        For a row that cannot be used.
    """
    return checked(Bearing, table("contacts"), "contacts.csv", named="contact")


def bearing_of(item: Item, object_class: str) -> Bearing | None:
    """Return how much of an assumed base bears.

    Parameters
    ----------
    item : Item
        Whose words are looked at first.
    object_class : str
        Row of tables/classes.csv.

    Returns
    -------
    Bearing or None
        None for a class of which no base is assumed.
    """
    assumed = (row for row in bearings() if object_class in row.classes and not row.words)
    return _named(item, object_class) or next(assumed, None)


def rolling(item: Item, object_class: str) -> Bearing | None:
    """Return on what an object rolls away, by its words; None for what does not, or is said to be kept from it.

    Parameters
    ----------
    item : Item
        Its record.
    object_class : str
        Row of tables/classes.csv.
    """
    found = on_wheels(item, object_class)
    return None if found is None or _KEPT.search(item.displayed) else found


def on_wheels(item: Item, object_class: str) -> Bearing | None:
    """Return the wheels that an object stands on, kept from rolling or not; None of what has none: as `rolling`."""
    found = _named(item, object_class)
    return None if found is None or found.rolls is None else found


def _named(item: Item, object_class: str) -> Bearing | None:
    told = "; ".join(text[:READ] for text in (item.object_name, item.title, item.medium, item.displayed))
    return _told(told, object_class, item.height_m or 0.0)


# Asked of an object when it is classed, and by each measure that is tried on it.
@lru_cache(maxsize=4096)
def _told(text: str, object_class: str, height: float) -> Bearing | None:
    for pattern, row in _patterns():
        if (not row.classes or object_class in row.classes) and height >= row.taller_than and pattern.search(text):
            return row
    return None


_KEPT = re.compile(
    r"\b(?:chocked|chocks?|blocked|on (?:\w+ )?blocks|locked|brakes? (?:is |are )?(?:on|set|applied)|off its wheels|"
    r"in (?:castor|caster) cups|in gear|axle stands|jacked up|scotched|wheel stops?|buffer stops?|verkeilt|"
    r"Hemmschuhe?n?|Unterlegkeile?n?|festgestellt|gebremst|aufgebockt|calée?s?|bloquée?s?|freinée?s?|bloccat[aeio]|"
    r"frenat[aeio]|calzad[ao]s?|bloquead[ao]s?|frenad[ao]s?)\b",
    re.IGNORECASE,
)
"""What is said of wheels that do not roll."""


@cache
def _patterns() -> tuple[tuple[re.Pattern[str], Bearing], ...]:
    return tuple((any_of(row.words), row) for row in bearings() if row.words)


def _borne(side: Estimate, item: Item, object_class: str) -> Estimate:
    """Return as much of an assumed side as may bear; what was measured is left as it is.

    How narrow a base is and how much of it bears have nothing to do with each other: as with `Sizes.spread` what each
    is away from its best estimate adds up as squares, in the logarithm.  Both at their ends at once made the least half
    width of a statue a sixth of its plan.
    """
    row = bearing_of(item, object_class)
    if not object_class or side.origin is not Origin.ASSUMED or side.low == side.high or row is None:
        return side
    note = f"{say.BEARS(share=(row.low, row.share, row.high), contact=row.title)}; {side.note}"
    low = exp(-hypot(log(side.value / side.low), log(row.share / row.low)))
    high = exp(hypot(log(side.high / side.value), log(row.high / row.share)))
    value = row.share * side.value
    return replace(side, value=value, low=low * value, high=high * value, note=note)
