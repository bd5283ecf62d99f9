"""Scans of objects: mesh files to mass, centre of gravity and contact polygon.  The only package that knows trimesh."""

from pipeline.meshes.reading import SolidMesh, read_mesh
from pipeline.meshes.scan import Contact, Scan, scan_object

__all__ = ["Contact", "Scan", "SolidMesh", "read_mesh", "scan_object"]
