"""What a site's manifest says of earthquakes and places, as QuakeML and GeoJSON."""

from pathlib import Path

from pipeline.motions.catalogues import as_geojson, as_quakeml
from pipeline.motions.manifest import load_manifest
from pipeline.operations.workspace import UsageError
from pipeline.resources import replacing


def export(folder: Path, quakeml: Path | None, geojson: Path | None, *, dry_run: bool = False) -> list[Path]:
    """Write the earthquakes of a site's records, and the site with its stations.

    Parameters
    ----------
    folder : Path
        The site's folder, or its manifest.toml.
    quakeml, geojson : Path or None
        Where to; None writes none.
    dry_run : bool
        Write nothing.

    Returns
    -------
    list of Path
        What was written, or would be.

    Raises
    ------
    UsageError
        Where no file is named, or one is there already.
    MotionError
        For a manifest that cannot be used.
    """
    wanted = {path: kind for path, kind in ((quakeml, "QuakeML"), (geojson, "GeoJSON")) if path is not None}
    if not wanted:
        raise UsageError("name a file: --quakeml FILE, --geojson FILE, or both")
    manifest = load_manifest(folder, begun=True)
    for path in wanted:
        if path.exists():
            raise UsageError(f"{path} is there already, and nothing is overwritten; name another file")
    for path, kind in wanted.items() if not dry_run else ():
        text = as_quakeml(record for _, record in manifest.records()) if kind == "QuakeML" else as_geojson(manifest)
        with replacing(path) as aside:
            aside.write_text(text, encoding="utf-8")
    return list(wanted)
