"""What a scan says of an object: mass, centre of gravity, gyration radii and the contact polygon with its doubt.

A rigid body on a plane rests on a facet of its convex hull: three points as a rule, whatever area seems to touch.  What
bears besides them depends on how far surface, padding and dirt give way: the contact depth.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from pipeline.errors import InputError
from pipeline.meshes.reading import MeshError, SolidMesh, read_mesh
from pipeline.quantities import Array
from pipeline.records import ContactPolygon

if TYPE_CHECKING:
    from trimesh import Trimesh

DEPTH = 0.0005
"""Contact depth [m] where none is stated: dirt, padding and the noise of a good scanner; judgement."""

SPAN = 4.0
"""The contact depth may be as many times as large, or nothing at all; judgement."""

SETTLE = 5.0
"""Degrees by which a mesh may lean as it was drawn, against the pose in which it rests."""

LEVEL = 1e-6
"""Share of the extent by which points of one facet may differ in height."""

CORNERS = 32
"""Corners of a polygon that goes into a record: of a round foot that is 0.5 % of the half width."""


@dataclass(frozen=True, slots=True)
class Contact:
    """What touches at one contact depth.

    Attributes
    ----------
    depth : float
        How deep the lowest point sinks in, m.
    polygon : ContactPolygon or None
        Of the surface below that; None where it does not hold the centre of gravity.
    scanned : ContactPolygon or None
        Of the scanned points below that alone: where it is much smaller, the mesh is too coarse for this depth.
    """

    depth: float
    polygon: ContactPolygon | None
    scanned: ContactPolygon | None


@dataclass(frozen=True, slots=True)
class ScanRecord:
    """Cells of the object record that a scan fills in, under the names of its fields, in m.

    Attributes
    ----------
    cg_height_m, contact_polygon, contact_polygon_least : str
        Numbers, and polygons as `ContactPolygon.text` writes them.
    mass_kg : str
        "" without a density.
    """

    cg_height_m: str
    mass_kg: str
    contact_polygon: str
    contact_polygon_least: str


@dataclass(frozen=True, slots=True)
class Scan:
    """An object as its mesh describes it, at rest, of one density.

    Attributes
    ----------
    file : str
        The mesh.
    closed : bool
        Whether its surface is closed; if not, all is of its convex hull, a judgement.
    shares : tuple of float
        Of its separate bodies in the mass, the largest first.
    size : tuple of float
        Width, depth and height as it rests, m.
    volume, fill : float
        In m3, and as a share of the box around it.
    mass : float or None
        In kg; None without a density.
    cg_height, cg_height_hollow : float
        Centre of gravity above the base, m: of a solid, and of a shell of one thickness.
    gyration : tuple of float
        Radii of gyration about axes along width, depth and height through the centre of gravity, m.
    leaned : float
        Degrees that it was turned by from as it was drawn to where it rests.
    contact : Contact
        At the stated depth.
    contacts : tuple of Contact
        From the least depth to the largest.
    notes : tuple of str
        What was mended, left out or is doubtful.
    """

    file: str
    closed: bool
    shares: tuple[float, ...]
    size: tuple[float, float, float]
    volume: float
    fill: float
    mass: float | None
    cg_height: float
    cg_height_hollow: float
    gyration: tuple[float, float, float]
    leaned: float
    contact: Contact
    contacts: tuple[Contact, ...]
    notes: tuple[str, ...]

    @property
    def polygon(self) -> ContactPolygon:
        """The contact polygon at the stated depth."""
        return _held(self.contact.polygon)

    @property
    def record(self) -> ScanRecord:
        """What goes into the object's record."""
        least = self.contacts[0].polygon
        return ScanRecord(
            cg_height_m=f"{self.cg_height:.5f}",
            mass_kg="" if self.mass is None else f"{self.mass:.5g}",
            contact_polygon=self.polygon.inscribed(CORNERS).text,
            contact_polygon_least="" if least is None else least.inscribed(CORNERS).text,
        )


def _held(polygon: ContactPolygon | None) -> ContactPolygon:
    if polygon is None:
        raise InputError("the contact polygon does not hold the centre of gravity")
    return polygon


def scan_object(
    path: Path,
    *,
    density: float | None = None,
    unit: str = "m",
    up: str = "z",
    depth: float = DEPTH,
    settle: float = SETTLE,
    hull: bool = False,
    bodies: str = "one",
) -> Scan:
    """Return what a mesh says of an object.

    Parameters
    ----------
    path : Path
        An OBJ, PLY or STL file.
    density : float, optional
        In kg/m3; without it no mass is told.
    unit, up, hull, bodies
        As of `read_mesh`.
    depth : float
        Contact depth, m.
    settle : float
        Degrees that it may be turned by to rest on a facet of its hull; 0 takes it as it was drawn.
    hull : bool
        As of `read_mesh`.

    Returns
    -------
    Scan
        Its polygon holds the centre of gravity.

    Raises
    ------
    MeshError
        As `read_mesh`, for a depth that is not above 0 or above a tenth of the height, a mesh that does not rest near
        where it was drawn, and a polygon that does not hold the centre of gravity.
    """
    mesh = read_mesh(path, unit=unit, up=up, hull=hull, bodies=bodies)
    solid, points, hollow, leaned = _at_rest(mesh, settle)
    size = solid.extents
    if not 0.0 < depth <= 0.1 * size[2]:
        raise MeshError(
            f"{mesh.file}: a contact depth of {1000.0 * depth:g} mm on a height of {1000.0 * size[2]:.4g} mm; give "
            "one above 0 and up to a tenth of it, such as 0.5 mm"
        )
    depths = (0.0 if settle else depth / SPAN, depth, SPAN * depth)
    contacts = tuple(_contact(solid, points, one) for one in depths)
    if contacts[1].polygon is None:
        raise MeshError(
            f"{mesh.file}: at a contact depth of {1000.0 * depth:g} mm the contact polygon does not hold the centre of "
            "gravity: as it was drawn it would fall over; level it, say which axis points up (--up), or let it settle "
            "(--settle)"
        )
    # Inertia of a solid of density 1, about its centre of gravity.
    inertia = np.diag(solid.moment_inertia) / solid.volume
    height = float(solid.center_mass[2])
    return Scan(
        file=mesh.file,
        closed=mesh.closed,
        shares=mesh.shares,
        size=(float(size[0]), float(size[1]), float(size[2])),
        volume=float(solid.volume),
        fill=float(solid.volume / np.prod(size)),
        mass=None if density is None else density * float(solid.volume),
        cg_height=height,
        cg_height_hollow=hollow,
        gyration=tuple(np.sqrt(np.maximum(inertia, 0.0)).tolist()),
        leaned=leaned,
        contact=contacts[1],
        contacts=contacts,
        notes=(*mesh.notes, *_doubts(contacts)),
    )


def _at_rest(mesh: SolidMesh, settle: float) -> tuple[Trimesh, Array, float, float]:
    """Return solid and points as it rests, about the projected centre of gravity on the base at z = 0.

    With them, the height of its shell's centre [m], and how far it was turned [degrees].
    """
    from scipy.spatial.transform import Rotation

    turn, leaned = np.eye(3), 0.0
    if settle:
        normal, leaned = _facet_below(mesh, settle)
        across = np.cross(normal, [0.0, 0.0, -1.0])
        sine = float(np.linalg.norm(across))
        if sine > 0.0:
            turn = Rotation.from_rotvec(across / sine * np.radians(leaned)).as_matrix()
    turned = mesh.points @ turn.T
    centre = turn @ np.asarray(mesh.solid.center_mass)
    shift = np.array([centre[0], centre[1], turned[:, 2].min()])
    place = np.eye(4)
    place[:3, :3], place[:3, 3] = turn, -shift
    solid = mesh.solid.copy()
    solid.apply_transform(place)
    return solid, turned - shift, float((turn @ mesh.shell - shift)[2]), leaned


def _facet_below(mesh: SolidMesh, settle: float) -> tuple[Array, float]:
    """Return the outward normal of the hull's facet that it rests on, and how far that is from pointing down."""
    from scipy.spatial import ConvexHull
    from trimesh.triangles import points_to_barycentric

    vertices = np.asarray(mesh.solid.vertices)
    hull = ConvexHull(vertices)
    normals, corners = hull.equations[:, :3], vertices[hull.simplices]
    leaning = np.degrees(np.arccos(np.clip(-normals[:, 2], -1.0, 1.0)))
    centre = np.asarray(mesh.solid.center_mass)
    above = ((centre - corners[:, 0]) * normals).sum(axis=1, keepdims=True)
    foot = centre - above * normals
    # A facet without an area has no such coordinates, and nothing rests on it.
    with np.errstate(divide="ignore", invalid="ignore"):
        inside = (points_to_barycentric(corners, foot) >= -LEVEL).all(axis=1)
    if not inside.any():
        raise MeshError(
            f"{mesh.file}: no facet of its hull is under its centre of gravity; take it as drawn: --settle 0"
        )
    chosen = int(np.where(inside, leaning, np.inf).argmin())
    if leaning[chosen] > settle:
        raise MeshError(
            f"{mesh.file}: as it was drawn it would fall over; it rests {leaning[chosen]:.1f} degrees from there, more "
            f"than {settle:g}: say which axis points up (--up), or allow more (--settle)"
        )
    return normals[chosen], float(leaning[chosen])


def _contact(solid: Trimesh, points: Array, depth: float) -> Contact:
    from trimesh.intersections import slice_faces_plane

    level = LEVEL * float(np.max(solid.extents))
    scanned = _outline(points[points[:, 2] <= depth + level])
    if depth == 0.0:
        return Contact(depth, scanned, scanned)
    below, *_ = slice_faces_plane(solid.vertices, solid.faces, [0.0, 0.0, -1.0], [0.0, 0.0, depth])
    return Contact(depth, _outline(np.asarray(below)), scanned)


def _outline(points: Array) -> ContactPolygon | None:
    try:
        return ContactPolygon.around([(float(x), float(y)) for x, y, _ in points])
    except InputError:
        return None


def _doubts(contacts: tuple[Contact, ...]) -> list[str]:
    """Return what the contact polygons leave in doubt."""
    first, stated, last = contacts
    out = []
    if first.polygon is None:
        out.append(
            f"at a contact depth of {1000.0 * first.depth:g} mm the contact polygon does not hold the centre of gravity"
        )
    wide, drawn = _held(last.polygon).narrowest()[0], _held(stated.polygon).narrowest()[0]
    tight = 0.0 if first.polygon is None else first.polygon.narrowest()[0]
    if wide > 1.2 * tight:
        out.append(
            f"the half width hangs on the contact depth: {1000.0 * tight:.3g} to {1000.0 * wide:.3g} mm where it is "
            "narrowest; a tilt test would settle it"
        )
    scanned = 0.0 if stated.scanned is None else stated.scanned.narrowest()[0]
    if scanned < 0.8 * drawn:
        out.append(
            f"the mesh is coarse for this depth: the scanned points alone give {1000.0 * scanned:.3g} mm where the "
            f"surface between them gives {1000.0 * drawn:.3g} mm"
        )
    return out
