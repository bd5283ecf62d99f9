"""A mesh file of an object, read as one solid: bounded in size, in metres, z upwards, closed or refused."""

from __future__ import annotations

import io
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from pipeline.errors import InputError
from pipeline.quantities import LENGTHS, Array

if TYPE_CHECKING:
    from trimesh import Trimesh

FORMATS = ("obj", "ply", "stl")
"""Endings of the files that are read."""

MOST_BYTES = 256 << 20
"""Bytes of a file, some two million triangles: parsing needs ten times as much memory."""

MOST_POINTS = 5_000_000
"""Points and triangles of a mesh; a binary file packs more of them into its bytes than a text."""

SMALLEST, LARGEST = 0.0005, 50.0
"""Largest extent of an object [m], as of its height in the table of what is plausible."""

FLAT = 1e-9
"""Share of the box around it below which a body has no volume."""

MOST_BODIES = 1000
"""Separate bodies of one object; more are the crumbs of a scan."""

"""What is done with a file of several bodies: refused, the largest is taken, or all count."""

UPWARDS = {
    "z": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "y": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "x": ((0, 0, -1), (0, 1, 0), (1, 0, 0)),
    "-z": ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
    "-y": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "-x": ((0, 0, 1), (0, 1, 0), (-1, 0, 0)),
}
"""Axes of a file that may point upwards, and the rotation by which they do."""


class MeshError(InputError):
    """A mesh that cannot be used: the message names file, what is wrong and the remedy."""


@dataclass(frozen=True, slots=True)
class SolidMesh:
    """Mesh of an object as it was drawn, in m, z upwards.

    Attributes
    ----------
    file : str
        Its name.
    points : ndarray, shape (n, 3)
        That were scanned.
    solid : Trimesh
        Closed, normals outwards: the mesh itself, or its convex hull.
    closed : bool
        Whether it is the mesh itself.
    shell : ndarray, shape (3,)
        Centre of the surface; of a cloud of points, their mean.
    shares : tuple of float
        Of each body in the volume, the largest first; cavities are taken off.
    notes : tuple of str
        What was mended or left out.
    """

    file: str
    points: Array
    solid: Trimesh
    closed: bool
    shell: Array
    shares: tuple[float, ...]
    notes: tuple[str, ...]


def read_mesh(path: Path, *, unit: str = "m", up: str = "z", hull: bool = False, bodies: str = "one") -> SolidMesh:
    """Read a mesh, and refuse what is no solid.

    Parameters
    ----------
    path : Path
        An OBJ, PLY or STL file.
    unit : {"m", "cm", "mm", "in", "ft"}
        Of its coordinates, which no such file names.
    up : {"z", "y", "x", "-z", "-y", "-x"}
        The axis of the file that points upwards.
    hull : bool
        Whether the convex hull stands for a mesh that is not closed, or for a cloud of points.
    bodies : {"one", "largest", "all"}
        What is done with several bodies.

    Returns
    -------
    SolidMesh
        Whose volume is larger than 0.

    Raises
    ------
    MeshError
        For a file that is missing, too large or no mesh, numbers that are not finite, a surface that is not closed,
        several bodies, no volume, and a size that nothing in a museum has.
    """
    points, faces = _parsed(path)
    if not np.isfinite(points).all():
        row = int(np.argmax(~np.isfinite(points).all(axis=1)))
        raise MeshError(f"{path.name}: point {row + 1} is no finite number; delete it, and close the mesh again")
    points = points @ np.array(UPWARDS[up], float).T * LENGTHS[unit]
    if len(points) == 0 or (extent := float(np.ptp(points, axis=0).max())) == 0.0:
        raise MeshError(f"{path.name}: it holds no points, or all in one place; export the mesh again")
    if not SMALLEST <= extent <= LARGEST:
        raise MeshError(
            f"{path.name}: it is {extent:.4g} m large in unit {unit!r}, and nothing from {SMALLEST:g} to {LARGEST:g} "
            "m; say --unit m, cm, mm or in as it was exported"
        )
    mesh, notes = _merged(points, faces)
    fault = _open(mesh)
    if not fault:
        solid, shares, more = _bodies(path.name, mesh, bodies)
        return SolidMesh(path.name, _array(solid.vertices), solid, True, _array(solid.centroid), shares, notes + more)
    if not hull:
        raise MeshError(f"{path.name}: {fault}; --hull takes its convex hull instead, as a judgement")
    shell = mesh.centroid if len(mesh.faces) else mesh.vertices.mean(axis=0)
    note = f"{fault}: its convex hull stands for it (judgement), which is too heavy for what is hollow"
    return SolidMesh(
        path.name, _array(mesh.vertices), _hull(path.name, mesh), False, _array(shell), (1.0,), (*notes, note)
    )


def holds_triangles(path: Path) -> bool:
    """Return whether a mesh file has a surface at all: a cloud of points has none that could be open.

    Parameters
    ----------
    path : Path
        As of `read_mesh`.

    Returns
    -------
    bool
        Closed or not.

    Raises
    ------
    MeshError
        For a file that is missing, too large or no mesh.
    """
    return len(_parsed(path)[1]) > 0


def _parsed(path: Path) -> tuple[Array, Any]:
    """Return points and triangles of a file as they stand in it."""
    import trimesh

    kind = path.suffix.lower().lstrip(".")
    if kind not in FORMATS:
        raise MeshError(f"{path.name}: no {', '.join(FORMATS[:-1])} or {FORMATS[-1]} file; export the mesh as one")
    try:
        size = path.stat().st_size
        if size > MOST_BYTES:
            raise MeshError(
                f"{path.name}: {size >> 20:,} MiB, more than {MOST_BYTES >> 20} MiB; export it with fewer triangles: "
                "a million are enough"
            )
        data = path.read_bytes()
    except OSError as problem:
        raise MeshError(f"{path.name}: cannot be read: {problem.strerror}; see whether the file is there") from problem
    try:
        # From memory, without a resolver: a mesh must not open other files (materials, textures).
        read: Any = trimesh.load(io.BytesIO(data), file_type=kind, process=False, skip_materials=True)
        parts = list(read.geometry.values()) if isinstance(read, trimesh.Scene) else [read]
        meshes = [(_array(p.vertices), np.asarray(getattr(p, "faces", _none()), np.int64)) for p in parts]
        points = np.concatenate([_none(float), *(v for v, _ in meshes)])
        starts = np.cumsum([0, *(len(v) for v, _ in meshes)])
        faces = np.concatenate([_none(), *(f + start for (_, f), start in zip(meshes, starts, strict=False))])
    except Exception as problem:  # noqa: BLE001 - whatever a parser trips over, the file is what cannot be read
        said = f"{type(problem).__name__}: {str(problem)[:120]}"
        raise MeshError(f"{path.name}: no {kind.upper()} mesh that can be read ({said}); export it again") from None
    if max(len(points), len(faces)) > MOST_POINTS:
        raise MeshError(
            f"{path.name}: {max(len(points), len(faces)):,} points or triangles, more than {MOST_POINTS:,}; "
            "export it with fewer"
        )
    if len(faces) and not 0 <= int(faces.min()) <= int(faces.max()) < len(points):
        raise MeshError(f"{path.name}: a triangle names a point that is not there; export the mesh again")
    return points, faces


def _none(kind: type = np.int64) -> Any:
    return np.zeros((0, 3), kind)


def _array(values: Any) -> Array:
    return np.array(values, dtype=np.float64)


def _merged(points: Array, faces: Any) -> tuple[Trimesh, tuple[str, ...]]:
    """Return the mesh with equal points made one, without triangles that have no three points or are there twice."""
    import trimesh

    mesh = trimesh.Trimesh(points, faces, process=False)
    mesh.merge_vertices(merge_tex=True, merge_norm=True)
    if not len(mesh.faces):
        return mesh, ()
    corners = np.sort(mesh.faces, axis=1)
    real = np.asarray((np.diff(corners, axis=1) > 0).all(axis=1))
    mesh.update_faces(real & mesh.unique_faces())
    lost = len(real) - len(mesh.faces)
    return mesh, (f"{lost:,} triangles without an area, or there twice, were left out",) if lost else ()


def _open(mesh: Trimesh) -> str:
    """Say why a mesh is no solid; "" where it is one."""
    if not len(mesh.faces):
        return f"a cloud of {len(mesh.vertices):,} points without triangles; make a closed surface of them"
    if not mesh.is_watertight:
        _, times = np.unique(mesh.edges_sorted, axis=0, return_counts=True)
        return (
            f"the surface is not closed ({int((times != 2).sum()):,} edges without exactly two triangles); close its "
            "holes in the program that made it"
        )
    if not mesh.is_winding_consistent:
        return "some triangles are inside out; recalculate the normals outwards in the program that made it"
    return ""


def _hull(file: str, mesh: Trimesh) -> Trimesh:
    """Return the convex hull as a solid.  trimesh's own would need another library to turn its triangles outwards."""
    import trimesh
    from scipy.spatial import ConvexHull, QhullError

    points = _array(mesh.vertices)
    try:
        hull = ConvexHull(points)
    except (QhullError, ValueError):
        hull = None
    if hull is None or hull.volume <= FLAT * float(np.prod(np.ptp(points, axis=0))):
        raise MeshError(f"{file}: its points lie in one plane, so that it has no volume; scan all of it")
    faces = hull.simplices.copy()
    a, b, c = (points[faces[:, at]] for at in range(3))
    inwards = (np.cross(b - a, c - a) * hull.equations[:, :3]).sum(axis=1) < 0.0
    faces[inwards] = faces[inwards][:, ::-1]
    return trimesh.Trimesh(points, faces, process=False)


def _bodies(file: str, mesh: Trimesh, bodies: str) -> tuple[Trimesh, tuple[float, ...], tuple[str, ...]]:
    """Return the solid with normals outwards, the shares of its bodies, and notes; cavities belong to their bodies."""
    from trimesh.util import concatenate

    parts = mesh.split(only_watertight=False)
    if len(parts) > MOST_BODIES:
        raise MeshError(f"{file}: {len(parts):,} separate bodies, more than {MOST_BODIES}; delete what is no object")
    # trimesh divides by the volume for the centre of gravity: of a flat body there is none.
    with np.errstate(divide="ignore", invalid="ignore"):
        parts = sorted(parts, key=lambda part: -abs(part.volume))
    least = FLAT * float(np.prod(mesh.extents))
    solids: list[Trimesh] = []
    cavities: list[Trimesh] = []
    notes: list[str] = []
    for part in parts:
        if abs(part.volume) <= least:
            notes.append("a body without volume was left out")
        elif (part.volume < 0.0) != (parts[0].volume < 0.0) and any(_within(part, other) for other in solids):
            cavities.append(part)
        else:
            solids.append(part)
    if not solids:
        raise MeshError(f"{file}: it has no volume; scan all of it, or recalculate the normals")
    if len(solids) > 1 and bodies == "one":
        volumes = np.abs([one.volume for one in solids])
        shown = ", ".join(f"{share:.2%}" for share in volumes[:5] / volumes.sum())
        raise MeshError(
            f"{file}: {len(solids)} separate bodies ({shown} of the volume{', ...' if len(solids) > 5 else ''}); unite "
            "them, or say --bodies all where they are one object, --bodies largest where the others are left-overs"
        )
    if bodies == "largest" and len(solids) > 1:
        notes.append(f"{len(solids) - 1} smaller bodies were left out")
        solids = solids[:1]
        cavities = [one for one in cavities if _within(one, solids[0])]
    elif len(solids) > 1:
        notes.append(f"{len(solids)} bodies count as one object; where two overlap, that counts twice")
    if cavities:
        notes.append(f"{len(cavities)} closed cavities are taken off")
    turned = [one for one in solids if one.volume < 0.0] + [one for one in cavities if one.volume > 0.0]
    for one in turned:
        one.invert()
    whole: Any = concatenate([*solids, *cavities])
    volumes = np.array([one.volume for one in solids])
    return whole, tuple((volumes / volumes.sum()).tolist()), tuple(notes)


def _within(part: Trimesh, other: Trimesh) -> bool:
    return bool((part.bounds[0] >= other.bounds[0]).all() and (part.bounds[1] <= other.bounds[1]).all())
