"""Motions written as a site that everything can read, and words put into a manifest that a person wrote."""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Mapping, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import tomlkit

from pipeline.motions.errors import Judgement, refusal
from pipeline.motions.manifest import MANIFEST, SiteTable, load_manifest, manifest_file
from pipeline.motions.processing import EAST
from pipeline.motions.record import ESTIMATED, NO_VERTICAL, Record
from pipeline.motions.responses import load_obspy
from pipeline.records import Motion
from pipeline.resources import replacing

_CODES = ("HN1", "HN2", "HNZ")
"""Channels of the files that are written: x, y, z."""


def write_site(
    folder: Path,
    motions: Sequence[tuple[str, Motion]],
    site: SiteTable,
    *,
    licence: str,
    why: str,
    compact: bool = False,
    dry_run: bool = False,
) -> Path:
    """Write motions as CSV files, or as small MiniSEED files, with a manifest beside them.

    Parameters
    ----------
    folder : Path
        Where to; it is made where there is none.
    motions : sequence of (str, Motion)
        Each with the name of its level; a level's motions are combined by the largest demand.
    site : SiteTable
        Where they belong; its x axis is theirs.
    licence : str
        Where a motion's source does not end in its own ("...; licence: ...").
    why : str
        A comment at the top of the manifest, such as the command that wrote it.
    compact : bool
        MiniSEED in whole mm/s2, a twentieth of the size, instead of every digit.
    dry_run : bool
        Write the same to a folder that goes at once, and return where the manifest would be.

    Returns
    -------
    Path
        The manifest.

    Raises
    ------
    MotionError
        Where the folder has a manifest already.

    Notes
    -----
    Every sample is written with 17 digits and read back bit for bit; the time step to its last digit.  Compact files
    hold the acceleration to 1 mm/s2 and the velocity that it adds up to within half of that in a time step, so that
    nothing drifts.  The velocity that a motion starts with stands in the manifest (`start_m_s`), to its last digit.
    """
    _unwritten(folder)
    if dry_run:
        with TemporaryDirectory(prefix="kouros-dry-run-") as name:
            write_site(Path(name), motions, site, licence=licence, why=why, compact=compact)
        return folder / MANIFEST
    folder.mkdir(parents=True, exist_ok=True)
    document = tomlkit.document()
    document.add(tomlkit.comment(why))
    document.add("site", tomlkit.item(site.model_dump(exclude_none=True)))
    levels = tomlkit.aot()
    for level in dict.fromkeys(level for level, _ in motions):
        table = tomlkit.table()
        table.update({"name": level, "combine": "max"})
        records = tomlkit.aot()
        for number, (of, motion) in enumerate(motions, start=1):
            if of == level:
                file = f"motion-{number}.{'mseed' if compact else 'csv'}"
                record = _record(folder, file, motion, site.x_azimuth, licence)
                records.append(tomlkit.item(record))
        table.add("record", records)
        levels.append(table)
    document.add("level", levels)
    manifest = folder / MANIFEST
    manifest.write_text(tomlkit.dumps(document), encoding="utf-8")
    load_manifest(manifest)
    return manifest


def write_records(
    folder: Path,
    site: SiteTable,
    level: Mapping[str, Any],
    records: Sequence[tuple[Record, str]],
    files: Mapping[str, Path],
    *,
    why: Sequence[str],
    beside: Mapping[str, str],
    dry_run: bool = False,
) -> Path:
    """Write records as they are, their files copied, with a manifest beside them.

    Parameters
    ----------
    folder : Path
        Where to; it is made where there is none.
    site : SiteTable
        Where they belong.
    level : mapping
        The table of the one level, without its records.
    records : sequence of (Record, str)
        Each with the reason why it is here, a comment above it.
    files : mapping of str to Path
        Where the files that the records name are copied from.
    why : sequence of str
        Comments at the top of the manifest.
    beside : mapping of str to str
        Texts that are written beside it, by the names of their files.
    dry_run : bool
        Write the same to a folder that goes at once, and return where the manifest would be.

    Returns
    -------
    Path
        The manifest.

    Raises
    ------
    MotionError
        Where the folder has a manifest already, or a file of a record has the name of one that is written.
    """
    _unwritten(folder)
    if dry_run:
        with TemporaryDirectory(prefix="kouros-dry-run-") as name:
            write_records(Path(name), site, level, records, files, why=why, beside=beside)
        return folder / MANIFEST
    for name in (MANIFEST, *beside):
        if name in files:
            raise refusal(files[name], name, "a record's file has the name of one that is written", "rename it")
    document = tomlkit.document()
    for line in why:
        document.add(tomlkit.comment(line))
    document.add("site", tomlkit.item(site.model_dump(exclude_none=True)))
    table = tomlkit.table()
    table.update(level)
    tables = tomlkit.aot()
    for record, reason in records:
        one = tomlkit.table()
        one.add(tomlkit.comment(reason))
        one.update(record.model_dump(mode="json", exclude_defaults=True))
        tables.append(one)
    table.add("record", tables)
    levels = tomlkit.aot()
    levels.append(table)
    document.add("level", levels)
    for name, original in files.items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(original, folder / name)
    folder.mkdir(parents=True, exist_ok=True)
    for name, text in beside.items():
        (folder / name).write_text(text, encoding="utf-8")
    file = folder / MANIFEST
    file.write_text(tomlkit.dumps(document), encoding="utf-8")
    load_manifest(file)
    return file


def _unwritten(folder: Path) -> None:
    if (folder / MANIFEST).exists():
        remedy = "choose another folder, or remove it"
        raise refusal(folder, MANIFEST, "is there already, and nothing is overwritten", remedy)


def _record(folder: Path, file: str, motion: Motion, azimuth: float, licence: str) -> dict[str, Any]:
    compact = file.endswith(".mseed")
    if compact:
        _write_compact(folder / file, motion)
    else:
        (folder / file).write_text(motion_csv(motion, azimuth), encoding="ascii")
    source, _, own = motion.source.partition("; licence: ")
    digest = hashlib.sha256((folder / file).read_bytes()).hexdigest()
    components: dict[str, Any] = {code: {"axis": axis} for code, axis in zip(_CODES, "xyz", strict=True)}
    if compact:
        for component, told in zip(components.values(), (azimuth, (azimuth - 90.0) % 360.0, "up"), strict=True):
            component["orientation"] = told
    absent = NO_VERTICAL in motion.steps
    if absent:
        del components["HNZ"]
    for row, component in zip(motion.acceleration, components.values(), strict=not absent):
        if not row.any():
            component["silent"] = True
    # What was judged once, or is a test signal, is not judged again.
    told = "; ".join(motion.steps)[:460] or "as it was given"
    return {
        "name": motion.name[:500],
        "files": [file],
        "components": components,
        **({"units": "mm/s2"} if compact else {}),
        **({"vertical": "absent"} if absent else {"vertical": "estimated"} if ESTIMATED in motion.steps else {}),
        "processed": True,
        "accept": dict.fromkeys(("clipping", "filled", "cut_off", "size", "drift"), f"written by Kouros: {told}"),
        "source": (source or "Kouros")[:500],
        "licence": (own or licence)[:500],
        "sha256": {file: digest},
        **({"start_m_s": list(motion.start)} if any(motion.start) else {}),
        **({} if motion.v_max is None else {"v_max_cm_s": 100.0 * motion.v_max}),
    }


def _write_compact(file: Path, motion: Motion) -> None:
    """MiniSEED of whole mm/s2, packed; what rounding adds up to is carried on, so that the velocity does not drift."""
    obspy = load_obspy()
    whole = np.round(np.cumsum(1000.0 * motion.acceleration, axis=1))
    data = np.diff(whole, axis=1, prepend=0.0).astype(np.int32)
    stream = obspy.Stream(
        obspy.Trace(np.ascontiguousarray(row), {"channel": code, "delta": motion.dt})
        for row, code in zip(data, _CODES, strict=True)
        if code != "HNZ" or NO_VERTICAL not in motion.steps
    )
    stream.write(str(file), format="MSEED", encoding="STEIM2", reclen=4096)


def motion_csv(motion: Motion, x_azimuth: float = EAST) -> str:
    """Return a motion as a table that `formats.table` reads: time in s, x, y and z in m/s2, 17 digits.

    Parameters
    ----------
    motion : Motion
        What is written.
    x_azimuth : float
        Of the motion's x axis, degrees clockwise from north.

    Returns
    -------
    str
        The lines of the file, each with its end.
    """
    second = (x_azimuth - 90.0) % 360.0
    lines = ["# processed: yes", f"time (s), HN1 {x_azimuth:g} deg (m/s2), HN2 {second:g} deg (m/s2), HNZ up (m/s2)"]
    t = motion.dt * np.arange(motion.samples)
    lines += [f"{at:.17g}, {x:.17g}, {y:.17g}, {z:.17g}" for at, x, y, z in zip(t, *motion.acceleration, strict=True)]
    return "\n".join(lines) + "\n"


def accept(path: Path, name: str, judgements: Mapping[Judgement, str]) -> None:
    """Write into a manifest that refusals of one record were judged and overruled; all else stays as it was.

    Parameters
    ----------
    path : Path
        The site's folder, or its manifest.toml.
    name : str
        The record.
    judgements : mapping of str to str
        The reason of each refusal that is overruled, by its name.

    Raises
    ------
    MotionError
        Where there is no manifest, or no record of it has that name.
    """
    file = manifest_file(path)
    document = tomlkit.parse(file.read_text(encoding="utf-8"))
    for record in _records(document):
        if record.get("name") == name:
            record.setdefault("accept", tomlkit.inline_table()).update(judgements)
            with replacing(file) as aside:
                aside.write_text(tomlkit.dumps(document), encoding="utf-8")
            return
    raise refusal(file, "record", f"there is no record {name!r}", "name one of the manifest")


def _records(document: Any) -> list[Any]:
    found = [record for level in document.get("level", ()) for record in level.get("record", ())]
    for floor in document.get("floor", ()):
        own = floor.get("record", ())
        found += [own] if isinstance(own, dict) else list(own)
    return found
