"""The seismologist's desk: list, look at, process, accept and export the records of a site."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pipeline.motions.catalogues import as_geojson, as_quakeml
from pipeline.motions.corner_range import corner_range_of
from pipeline.motions.doubts import doubts
from pipeline.motions.errors import Judgement, MotionError
from pipeline.motions.manifest import GROUND_FLOOR, load_manifest, manifest_file
from pipeline.motions.site import levels_at, prepare, read_site
from pipeline.motions.writing import accept, write_site
from pipeline.operations.workspace import UsageError
from pipeline.report import Units
from pipeline.resources import replacing

if TYPE_CHECKING:
    from pipeline.motions.inspection import Inspection


@dataclass(frozen=True)
class MotionRow:
    """One motion of a site in a line; "" or None where there is none.

    Attributes
    ----------
    level, floor, name : str
        What it is called, and where and at which level of shaking it is felt.
    dt, duration : float
        Time step and length in s.
    pga : float
        In m/s2, of the larger horizontal component, as `pgv` and `pgd`.
    pgv : float
        In m/s.
    pgd : float
        In m.
    duration_5_95 : float
        In s.
    pulse_period : float or None
        In s, of a pulse-like motion.
    approved_by : str
        The engineer who answers for the level.
    hash : str
        Of the processed motion.
    """

    level: str
    floor: str
    name: str
    dt: float
    duration: float
    pga: float
    pgv: float
    pgd: float
    duration_5_95: float
    pulse_period: float | None
    approved_by: str
    hash: str


def listed(folder: Path) -> list[MotionRow]:
    """Return the motions of a site, those of its floors after those of the ground.

    Parameters
    ----------
    folder : Path
        The site's folder, or its manifest.toml.

    Returns
    -------
    list of MotionRow
        One for each motion.

    Raises
    ------
    MotionError
        For a site that cannot be used.
    """
    site = read_site(folder)
    return [
        MotionRow(
            level=level.name,
            floor="" if floor == GROUND_FLOOR else floor,
            name=one.motion.name,
            dt=one.motion.dt,
            duration=one.motion.duration,
            pga=one.measures["pga"],
            pgv=one.measures["pgv"],
            pgd=one.measures["pgd"],
            duration_5_95=one.measures["duration_5_95"],
            pulse_period=one.measures.get("pulse_period"),
            approved_by=level.approved_by,
            hash=one.motion.hash,
        )
        for floor in (GROUND_FLOOR, *site.floors)
        for level in levels_at(site, floor)
        for one in level.motions
    ]


def show(folder: Path, name: str, page: Path, units: Units) -> "tuple[list[Inspection], Path]":
    """Look at the records of a site and write the page of it.

    Parameters
    ----------
    folder : Path
        The site's folder, or its manifest.toml.
    name : str
        Of one record, or "" for all.
    page : Path
        Where the page is written to.
    units : Units
        Those of the page.

    Returns
    -------
    list of Inspection
        One for each record.
    Path
        The page.

    Raises
    ------
    MotionError
        For a site that cannot be used, or has no such record.
    """
    from pipeline.motions.inspection import inspect
    from pipeline.report.pages.record_page import render_record

    found = inspect(folder, name)
    return found, render_record(found, page, units)


def described(one: "Inspection") -> dict[str, Any]:
    """Return an inspection as plain values for programs: measures in SI, corners in Hz, spectra in m/s2, the pulse."""
    return {
        "name": one.motion.name,
        "level": one.level,
        "place": one.place,
        "dt": one.motion.dt,
        "samples": one.motion.samples,
        "hash": one.motion.hash,
        "filtered": one.filtered,
        "highpass_hz": one.corners[0],
        "lowpass_hz": one.corners[1],
        "other_corners": (other := corner_range_of(one.motion.steps)) and asdict(other),
        "measures_before": dict(one.measures_before),
        "measures": dict(one.measures),
        "spectra": {
            name: {
                "periods_s": spectrum.periods.tolist(),
                "damping": spectrum.damping.tolist(),
                "psa": spectrum.pseudo_acceleration.tolist(),
            }
            for name, spectrum in one.spectra.items()
        },
        "pulse": one.pulse
        and {
            "is_pulse": one.pulse.is_pulse,
            "indicator": one.pulse.indicator,
            "period_s": one.pulse.period,
            "angle_deg": one.pulse.angle,
            "pgv": one.pulse.pgv,
            "pulse_pgv": one.pulse.pulse_pgv,
            "method": one.pulse.method,
        },
        "doubts": list(doubts(one.motion.steps)),
        "steps": list(one.motion.steps),
    }


def entries(folder: Path) -> list[str]:
    """Return the entries that a site's manifest needs for the record files beside it, see `motions.entries`.

    Parameters
    ----------
    folder : Path
        The site's folder, or its manifest.toml.

    Returns
    -------
    list of str
        TOML to be pasted into the manifest.

    Raises
    ------
    MotionError
        For a folder without a manifest, or one that cannot be used.
    """
    from pipeline.motions.entries import entries as found

    return found(folder)


def process(folder: Path, out: Path, name: str, *, dry_run: bool = False) -> Path:
    """Process the records of a site's ground and write them as a site of their own.

    Parameters
    ----------
    folder : Path
        The site's folder, or its manifest.toml.
    out : Path
        The folder of the new site.
    name : str
        Of one record, or "" for all.
    dry_run : bool
        Write nothing.

    Returns
    -------
    Path
        The new manifest.

    Raises
    ------
    UsageError
        For a record that the site does not have.
    MotionError
        For a site that cannot be used, or where the new one is there already.
    """
    site = read_site(folder)
    chosen = [(v.name, one.motion) for v in site.levels for one in v.motions if name in {"", one.motion.name}]
    if not chosen:
        names = ", ".join(repr(one.motion.name) for v in site.levels for one in v.motions)
        raise UsageError(f"there is no record {name!r} on the ground of {site.file}; its records are {names}")
    why = f"Processed by Kouros from {site.name}; the steps stand with each record."
    return write_site(out, chosen, site.manifest.site, licence="as the original", why=why, dry_run=dry_run)


def overrule(folder: Path, name: str, reason: str, *, dry_run: bool = False) -> Sequence[str]:
    """Overrule, with a reason, the refusals of one record that are a matter of judgement; the manifest keeps it.

    Parameters
    ----------
    folder : Path
        The site's folder, or its manifest.toml.
    name : str
        Of the record.
    reason : str
        Why it is used all the same.
    dry_run : bool
        Leave the manifest as it is.

    Returns
    -------
    sequence of str
        What was refused, in words, one for each refusal overruled; none where nothing was refused.

    Raises
    ------
    UsageError
        For a record that the manifest does not have.
    MotionError
        For what is corrupt.
    """
    file = manifest_file(folder)
    manifest = load_manifest(file)
    found = [(key, record) for key, record in manifest.records() if record.name == name]
    if not found:
        known = ", ".join(repr(record.name) for _, record in manifest.records())
        raise UsageError(f"{file}: there is no record {name!r}; its records are {known}")
    (key, record), overruled = found[0], dict[Judgement, str]()
    targets = {r.name: level.target for level in manifest.level for r in level.record}
    while True:
        try:
            granted = record.model_copy(update={"accept": record.accept | dict.fromkeys(overruled, reason)})
            prepare(file, key, granted, targets.get(name), manifest.site.x_azimuth)
        except MotionError as refused:
            if not refused.judgement or refused.judgement in overruled:
                raise
            overruled[refused.judgement] = str(refused)
        else:
            break
    if overruled and not dry_run:
        accept(file, name, dict.fromkeys(overruled, reason))
    return tuple(overruled.values())


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
