"""Motions by whatever names them: a site that comes with Kouros, a site's folder, a manifest, or a record file."""

from __future__ import annotations

from pathlib import Path

from pipeline.motions.candidates import MOST, Unusable, records_of
from pipeline.motions.errors import refusal
from pipeline.motions.manifest import MANIFEST
from pipeline.motions.processing import EAST
from pipeline.motions.record import Record
from pipeline.motions.site import motions_of, prepare
from pipeline.records import Motion
from pipeline.resources import BUNDLED, resource


def read_motion(path: str | Path, kept: Path | None = None) -> list[Motion]:
    """Return the processed motions of a site, or of a record file.

    A record file is read with what belongs to it in its folder: the files of the other components, and StationXML. Its
    x axis points east, and it is processed as a record of a manifest of which nothing is said but what its files say.

    Parameters
    ----------
    path : str or Path
        "demo" or "demo_suite", the sites that come with Kouros; a site's folder, its manifest.toml, or a file of a
        record in any format that Kouros reads. A folder of one of those names is meant by "./demo".
    kept : Path or None
        A folder in which processed motions of a site are kept for the next time; None keeps none.

    Returns
    -------
    list of Motion
        Of a site those of the ground, in the manifest's order; floors are passed on by ``transmit``. Of a file the
        records that it is of, mostly one.

    Raises
    ------
    MotionError
        Naming the file, the place in it and the remedy.
    """
    if isinstance(path, str) and path in BUNDLED:
        return motions_of(resource("site_motions", path), kept)
    file = Path(path)
    if not file.exists():
        remedy = f"give a site's folder with its {MANIFEST}, a record's file, or one of {', '.join(BUNDLED)}"
        raise refusal(file, "path", "there is no such file or folder", remedy)
    if file.is_dir() or file.suffix.lower() == ".toml":
        return motions_of(file, kept)
    place = file.parent / MANIFEST
    return [prepare(place, f"record {name!r}", record, None, EAST).motion for name, record in _records(file)]


def _records(file: Path) -> list[tuple[str, Record]]:
    """Records that a file is of: alone, or with others of its folder."""
    beside = sorted(one.name for one in file.parent.iterdir() if one.is_file() and not one.name.startswith("."))
    if len(beside) > MOST:
        wrong = f"is among {len(beside):,} files, more than {MOST:,} that would be looked at"
        raise refusal(file, "file", wrong, "put the record's files into a folder of their own")
    responses = [name for name in beside if name.lower().endswith(".xml") and name != file.name]
    reasons: list[str] = []
    for names in ([file.name, *responses], list(dict.fromkeys([file.name, *beside]))):
        unusable: list[Unusable] = []
        found = [one for one in records_of(file.parent, names, unusable) if file.name in one[1].files]
        if found:
            return found
        reasons = [f"{one.name}: {one.reason}" for one in unusable if one.name not in responses]
    why = "; ".join(reasons[:3]) or "no channel was found in it"
    wrong = f"is no whole record: {why}"
    raise refusal(file, "file", wrong, "give a file of a record of three components, or a site's folder")
