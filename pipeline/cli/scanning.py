"""The verb `kouros scan`: what a mesh says of an object."""

import json
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from pipeline.cli.console import aligned
from pipeline.cli.shared import as_json
from pipeline.quantities import figures

if TYPE_CHECKING:
    from pipeline.meshes import Scan
    from pipeline.records import ContactPolygon

# Named here too, so that --help does not wait for the meshes to load.
UNITS = ("m", "cm", "mm", "in", "ft")
AXES = ("z", "y", "x", "-z", "-y", "-x")
BODIES = ("one", "largest", "all")

SENSES = {"x": 0.0, "-x": 180.0, "y": 90.0, "-y": 270.0}
"""Along the object's width and depth, both ways, in degrees."""


@click.command()
@click.argument("file", type=click.Path(path_type=Path))
@click.option("--density", type=click.FloatRange(1.0, 22_600.0), help="kg/m3; without it no mass is told.")
@click.option("--unit", type=click.Choice(UNITS), default="m", show_default=True, help="Of the file's coordinates.")
@click.option("--up", type=click.Choice(AXES), default="z", show_default=True, help="The axis that points upwards.")
@click.option("--depth", type=click.FloatRange(1e-3, 100.0), default=0.5, show_default=True, help="Contact depth, mm.")
@click.option(
    "--settle",
    type=click.FloatRange(0.0, 180.0),
    default=5.0,
    show_default=True,
    help="Degrees that it may be turned by to where it rests on its lowest points; 0 takes it as it was drawn.",
)
@click.option("--hull", is_flag=True, help="Take the convex hull of a mesh that is not closed, as a judgement.")
@click.option(
    "--bodies", type=click.Choice(BODIES), default="one", show_default=True, help="What to do with separate bodies."
)
@as_json
def scan(
    file: Path,
    density: float | None,
    unit: str,
    up: str,
    depth: float,
    settle: float,
    hull: bool,
    bodies: str,
    as_json: bool,
) -> None:
    """Measure a mesh (OBJ, PLY, STL): mass, centre of gravity, gyration radii, and the polygon that it stands on.

    The contact polygon is told for no contact depth (the three points that a rigid body rests on), the stated one and
    four times that.  Where they differ much, a tilt test settles it.

    Example: kouros scan vase.stl --unit mm --density 2400
    """
    from pipeline.meshes import scan_object

    found = scan_object(
        file, density=density, unit=unit, up=up, depth=depth / 1000.0, settle=settle, hull=hull, bodies=bodies
    )
    click.echo(json.dumps(_document(found), indent=2) if as_json else "\n".join(_lines(found)))


def _half_widths(polygon: "ContactPolygon | None") -> dict[str, Any] | None:
    if polygon is None:
        return None
    least, angle = polygon.narrowest()
    return {sense: polygon.reach(way) for sense, way in SENSES.items()} | {"narrowest": least, "narrowest_deg": angle}


def _document(found: "Scan") -> dict[str, Any]:
    contacts = [
        {
            "depth_m": one.depth,
            "holds": one.polygon is not None,
            "half_widths_m": _half_widths(one.polygon),
            "scanned_points_only_m": _half_widths(one.scanned),
            "polygon_m": None if one.polygon is None else one.polygon.corners,
        }
        for one in found.contacts
    ]
    return {
        "file": found.file,
        "closed": found.closed,
        "mass_kg": found.mass,
        "mass_shares": found.shares,
        "volume_m3": found.volume,
        "fill": found.fill,
        "size_m": found.size,
        "cg_height_m": found.cg_height,
        "cg_height_hollow_m": found.cg_height_hollow,
        "gyration_radii_m": found.gyration,
        "leaned_deg": found.leaned,
        "contact_depth_m": found.contact.depth,
        "contact_polygon_m": found.polygon.corners,
        "half_widths_m": _half_widths(found.polygon),
        "contacts": contacts,
        "notes": found.notes,
        "record": asdict(found.record),
    }


def _lines(found: "Scan") -> list[str]:
    width, deep, high = found.size
    mass = "unknown without --density" if found.mass is None else f"{figures(found.mass, 4)} kg"
    kind = "closed mesh, taken as solid" if found.closed else "convex hull of an open mesh: judgement"
    lines = [
        f"{found.file}: {kind}",
        f"size      {figures(width, 4)} x {figures(deep, 4)} x {figures(high, 4)} m (width, depth, height)",
        f"mass      {mass}; {figures(found.volume, 4)} m3, {found.fill:.0%} of the box around it",
    ]
    if len(found.shares) > 1:
        lines.append("bodies    " + ", ".join(f"{share:.1%}" for share in found.shares) + " of the mass")
    lines += [
        f"cg        {figures(found.cg_height, 4)} m above the base; {figures(found.cg_height_hollow, 4)} m as a shell",
        "gyration  " + ", ".join(figures(radius, 4) for radius in found.gyration) + " m about width, depth, height",
        f"turned    {found.leaned:.2g} degrees, to rest on its lowest points",
        "",
        "Half widths of the contact polygon, mm:",
    ]
    rows = []
    for one in found.contacts:
        widths = _half_widths(one.polygon)
        names = (*SENSES, "narrowest")
        cells = [f"{1000.0 * widths[name]:.1f}" for name in names] if widths else ["-"] * len(names)
        stated = " (stated)" if one is found.contact else ""
        rows.append([f"{1000.0 * one.depth:g}{stated}", *cells])
    lines += aligned(["depth mm", *SENSES, "narrowest"], rows, words={0})
    lines += ["", "For the record (m):", *(f"  {name}: {text}" for name, text in asdict(found.record).items())]
    lines += [f"Note: {note}" for note in found.notes]
    return lines
