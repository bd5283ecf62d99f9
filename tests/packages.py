"""Packages of others, as a package manager leaves them in a folder."""

from pathlib import Path


def install(folder: Path, package: str, source: str, points: str, version: str = "1.0") -> None:
    """Put a module of one file there, with its name and version and its entry points."""
    (folder / f"{package}.py").write_text(source, encoding="utf-8")
    told = folder / f"{package}-{version}.dist-info"
    told.mkdir()
    (told / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {package}\nVersion: {version}\n", encoding="utf-8")
    (told / "entry_points.txt").write_text(points, encoding="utf-8")
