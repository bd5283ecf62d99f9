"""Numbers of one record that cannot all be true: what is refused, what is only doubted, and why."""

from __future__ import annotations

from collections.abc import Mapping
from math import radians, tan
from typing import Any

from pipeline.collection.unit_audit import SOLID
from pipeline.quantities import figures
from pipeline.records import SECTION_SHAPES, ContactPolygon, Problem
from pipeline.records import phrases as say
from pipeline.tables.assumed import assumed

HEAVIEST = 22_600.0
"""Density of osmium [kg/m3], the heaviest thing there is: no object is heavier than a box of it."""

LIGHTEST = 0.1
"""Mass of an object over the box around it [kg/m3]: a mobile of wire reaches it; air itself has 1.2."""

HOLLOW = 0.0005
"""What share of its box the emptiest object fills with its own material: an open umbrella, a mobile; judgement."""

_TOLERANCE = 1.03
"""Two rounded measurements of the same thing."""

_ROUGHLY = 1.2
"""A tilt test beside a base and a centre of gravity that were measured with a rule."""


def contradictions(values: Mapping[str, Any]) -> list[tuple[str, Problem]]:
    """Return what contradicts itself in a record.

    Parameters
    ----------
    values : mapping
        The fields of the record in SI; None where not recorded.

    Returns
    -------
    list of (str, Problem)
        The field to leave out ("" where all is kept), and the problem.
    """
    out = []
    height = values.get("height_m")
    for field, what in (("cg_height_m", "centre of gravity"), ("section_height_m", "weakest section")):
        value = values.get(field)
        if value is not None and height is not None and value > height * _TOLERANCE:
            message = say.LIES_ABOVE(size=what, above=value, height=height)
            out.append((field, Problem(field, message, f"{say.MEASURE_BOTH()}; {say.HEIGHT_USED()}")))
    for field, largest in (("base_width_m", "width_m"), ("base_depth_m", "depth_m")):
        value, most = values.get(field), values.get(largest)
        across = max(filter(None, (values.get("width_m"), values.get("depth_m"))), default=None)
        if value is not None and most is not None and across is not None and value > across * _TOLERANCE:
            message = say.BASE_WIDER(base=value, widest=across)
            remedy = f"{say.MEASURE_BOTH()}; {say.BASE_USED()}"
            out.append(("", Problem(field, message, remedy)))
    out += _contact(values)
    shape = str(values.get("section_shape") or "").strip()
    if shape and shape.casefold() not in SECTION_SHAPES:
        message = f"{shape[:40]!r} is no shape of a section that Kouros knows"
        remedy = f"record one of {', '.join(sorted(set(SECTION_SHAPES.values())))}; it is not used until then"
        out.append(("", Problem("section_shape", message, remedy)))
    out += _density(values)
    return out


def _contact(values: Mapping[str, Any]) -> list[tuple[str, Problem]]:
    """Return what contradicts the contact polygon and the tilt test."""
    out = []
    polygon = ContactPolygon.around(values["contact_polygon"]) if values.get("contact_polygon") else None
    if polygon is not None:
        for extent, field in zip(polygon.extents, ("width_m", "depth_m"), strict=True):
            most = values.get(field)
            if most is not None and extent > most * _TOLERANCE:
                message = (
                    f"the contact polygon is {figures(extent, 4)} m across where the object itself is "
                    f"{figures(most, 4)} m"
                )
                remedy = "see whether unit and axes of the polygon are right (x along the width); the polygon is used"
                out.append(("", Problem("contact_polygon", message, remedy)))
    least, tilt = values.get("contact_polygon_least"), values.get("tilt_angle_deg")
    if least and polygon is None:
        message = "the least that the contact polygon may be is recorded, and the polygon itself is not"
        out.append(("contact_polygon_least", Problem("contact_polygon_least", message, "record both")))
    height = values.get("cg_height_m")
    base = values.get("base_width_m") if polygon is None else 2.0 * polygon.narrowest()[0]
    if tilt is not None and height is not None and base is not None:
        half = height * tan(radians(tilt))
        if half > 0.5 * base * _ROUGHLY:
            message = (
                f"it tips at {figures(tilt, 4)} degrees, as if its base were {figures(2.0 * half, 4)} m wide; recorded "
                f"are {figures(base, 4)} m"
            )
            remedy = "measure base, height of the centre of gravity and tilt again; the tilt test is used"
            out.append(("", Problem("tilt_angle_deg", message, remedy)))
    return out


def _density(values: Mapping[str, Any]) -> list[tuple[str, Problem]]:
    sides = [float(values.get(side) or 0.0) for side in ("height_m", "width_m", "depth_m")]
    mass = values.get("mass_kg")
    if mass is None or not all(sides):
        return []
    density = mass / (sides[0] * sides[1] * sides[2])
    box = " x ".join(figures(side, 3) for side in sides)
    told = f"{figures(mass, 4)} kg in a box of {box} m is {figures(density, 3)} kg/m3"
    remedy = "weigh and measure it again; the mass is left out until then"
    if not LIGHTEST <= density <= HEAVIEST:
        limit = "osmium, the heaviest metal" if density > HEAVIEST else "a mobile of wire"
        than = "heavier" if density > HEAVIEST else "lighter"
        return [("mass_kg", Problem("mass_kg", f"{told}, {than} than {limit}: mass or size is wrong", remedy))]
    materials = assumed().materials_in(str(values.get("material") or values.get("medium") or ""))
    if not materials:
        return []
    most, least = max(materials, key=lambda one: one.density_high), min(materials, key=lambda one: one.density_low)
    if density > SOLID * most.density_high:
        than = f"{density / most.density:.2g} times as heavy as a solid block of {most.name}"
        return [("mass_kg", Problem("mass_kg", f"{told}, {than}: mass, size or material is wrong", remedy))]
    if density < HOLLOW * least.density_low:
        than = f"{density / least.density:.1g} of a solid block of {least.name}"
        message = f"{told}, {than}: as if mass or size were in another unit; it is used"
        return [("", Problem("mass_kg", message, "weigh and measure it again, and correct what is wrong"))]
    return []
