"""Records of a folder that a suite may be chosen from, and those that it may not, with the reason."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from pipeline.motions.errors import MotionError, refusal
from pipeline.motions.grouping import FileTrace, channels, grouped
from pipeline.motions.intensity import measures
from pipeline.motions.manifest import MANIFEST, NO_RECORDS, SiteTable, load_manifest
from pipeline.motions.processing import EAST, Processed
from pipeline.motions.reading import open_traces, own_unit
from pipeline.motions.record import Record
from pipeline.motions.responses import channels_known
from pipeline.motions.site import prepare
from pipeline.records import Motion

MOST = 20_000
"""Files of a folder that are looked at."""

USABLE = 1.25
"""A record filtered at f is trusted up to the period 1 / (USABLE f), the rule of the NGA databases."""

_SAME_EVENT = 600.0
"""s, how far apart records of one earthquake may have started."""

_UNSCALED: dict[str, Any] = {"scale": None, "scale_to_pga_g": None, "scale_to_target": None}


@dataclass(frozen=True, eq=False)
class CandidateRecord:
    """A record of three components that was read and processed, as recorded.

    Attributes
    ----------
    folder : Path
        Where it was found.
    record : Record
        The manifest's table of it, without a scale; its files lie inside that folder.
    motion : Motion
        What was made of it.
    pga : float
        In m/s2, of the larger horizontal component.
    pgv : float
        In m/s, of the larger horizontal component; by its agency's velocity, where there is one.
    station : str or None
        Network and station, where its files say them.
    event : int or None
        Which of the folder's earthquakes it is of, by the time; None where its files do not say the time.
    """

    folder: Path
    record: Record
    motion: Motion
    pga: float
    pgv: float
    station: str | None
    event: int | None

    @property
    def recording(self) -> tuple[str, int] | None:
        """What two versions of one recording have in common, such as the raw and the processed one."""
        return None if self.station is None or self.event is None else (self.station, self.event)


@dataclass(frozen=True, slots=True)
class Unusable:
    """What was found and cannot be used.

    Attributes
    ----------
    name : str
        The record, or the file.
    reason : str
        What is wrong with it, and the remedy where there is one.
    chosen : bool
        Whether it is sound, and another one of the same shaking was taken, such as the acceleration in place of the
        velocity.
    """

    name: str
    reason: str
    chosen: bool = False


@dataclass(frozen=True, eq=False)
class FoundRecords:
    """What folders hold.

    Attributes
    ----------
    candidates : tuple of CandidateRecord
        In the order of their files, or of the manifest.
    unusable : tuple of Unusable
        What else there is, but for words and responses.
    site : SiteTable or None
        The site of the first manifest, where there is one.
    """

    candidates: tuple[CandidateRecord, ...]
    unusable: tuple[Unusable, ...]
    site: SiteTable | None


@dataclass(frozen=True, eq=False)
class _Read:
    folder: Path
    record: Record
    done: Processed
    station: str | None
    start: float | None


def read_candidates(folders: Sequence[Path], longest_period: float, leave: Sequence[Path] = ()) -> FoundRecords:
    """Read every record of folders that a suite may be chosen from; what cannot be used never stops the rest.

    A folder with a manifest has the records that it names, as it says; their scales are left out.  In any other one,
    files of one station and time are a record, with counts brought to an acceleration by the StationXML that knows
    their channels.

    Parameters
    ----------
    folders : sequence of Path
        The folders, with what is below them.
    longest_period : float
        In s; a record whose high-pass takes that away is not used.
    leave : sequence of Path
        Files that are no records, such as the target.

    Returns
    -------
    FoundRecords

    Raises
    ------
    MotionError
        For a folder that is none, or whose manifest cannot be used, or two sites whose axes differ.
    """
    sites: list[SiteTable] = []
    unusable: list[Unusable] = []
    read: list[_Read] = []
    for folder in folders:
        if not folder.is_dir():
            raise refusal(folder, "folder", "there is no such folder", "name a folder of record files, or a site's")
        file = folder / MANIFEST
        if file.is_file():
            manifest = load_manifest(file)
            sites.append(manifest.site)
            named = [
                (f"level[{i}].record[{j}]", r) for i, v in enumerate(manifest.level) for j, r in enumerate(v.record)
            ]
        else:
            named = _unnamed(folder, {path.resolve() for path in leave}, unusable)
        for place, record in named:
            try:
                if any(record.name == one.record.name for one in read):
                    raise refusal(folder, f"record {record.name!r}", "there is another of this name", "rename one")
                azimuth = sites[0].x_azimuth if sites else EAST
                read.append(_read(folder, place, record, azimuth, longest_period))
            except MotionError as problem:
                unusable.append(Unusable(record.name, str(problem)))
    if len({one.x_azimuth for one in sites} | ({EAST} if len(sites) < len(folders) else set())) > 1:
        raise refusal(folders[0], "site.x_azimuth", "the folders' axes differ", "give sites of one x_azimuth")
    events = _events([one.start for one in read])
    candidates = (_candidate(one, event) for one, event in zip(read, events, strict=True))
    return FoundRecords(tuple(candidates), tuple(unusable), sites[0] if sites else None)


def _candidate(one: _Read, event: int | None) -> CandidateRecord:
    found, velocity = measures(one.done.motion), one.done.velocity
    pgv = found["pgv"] if velocity is None else float(np.abs(velocity[:2]).max())
    return CandidateRecord(one.folder, one.record, one.done.motion, found["pga"], pgv, one.station, event)


def _read(folder: Path, place: str, record: Record, azimuth: float, longest: float) -> _Read:
    where = f"record {record.name!r}"
    if record.vertical is not None and len(record.components) == 2:
        wrong = "has no vertical component, and three are asked for"
        raise refusal(folder, where, wrong, "give the vertical's file")
    v_max = record.v_max_cm_s
    if v_max is not None:
        if record.scale_to_pga_g is not None or record.scale_to_target:
            wrong = "belongs to a scale that is not a number"
            raise refusal(folder, f"{where}, v_max_cm_s", wrong, "leave it out: the PGV takes its place")
        v_max /= record.scale or 1.0
    unscaled = record.model_copy(update=_UNSCALED | {"v_max_cm_s": v_max})
    done = prepare(folder / MANIFEST, place, unscaled, None, azimuth)
    corner = done.corners[0]
    if corner is not None and USABLE * corner * longest > 1.0:
        wrong = f"its high-pass at {corner:.3g} Hz leaves periods up to {1.0 / (USABLE * corner):.2g} s"
        raise refusal(folder, where, wrong, f"give a longer record, or choose up to less than {longest:g} s")
    if not done.motion.acceleration[:2].any():
        raise refusal(folder, where, "has no horizontal shaking", "take another")
    stats = open_traces(folder / record.files[0], [])[0].stats
    station = f"{stats.network}.{stats.station}" if stats.station else None
    unknown = stats.get("kouros", {}).get("start", "record") == "unknown" or stats.starttime.timestamp == 0.0
    return _Read(folder, unscaled, done, station, None if unknown else float(stats.starttime.timestamp))


def _events(starts: Sequence[float | None]) -> list[int | None]:
    known = sorted(start for start in starts if start is not None)
    first: list[float] = []
    for start in known:
        if not first or start - first[-1] > _SAME_EVENT:
            first.append(start)
    return [None if s is None else sum(begin <= s for begin in first) for s in starts]


def _unnamed(folder: Path, leave: set[Path], unusable: list[Unusable]) -> list[tuple[str, Record]]:
    """Records of files that no manifest names, with the names that they are given."""
    paths = sorted(path for path in folder.rglob("*") if path.is_file() and not path.is_symlink())
    names = [path.relative_to(folder).as_posix() for path in paths[:MOST] if path.resolve() not in leave]
    names = [name for name in names if not any(part.startswith(".") for part in name.split("/"))]
    if len(paths) > MOST:
        unusable.append(Unusable(folder.name, f"holds {len(paths):,} files, of which the first {MOST:,} are looked at"))
    return records_of(folder, names, unusable)


def records_of(folder: Path, names: Sequence[str], unusable: list[Unusable]) -> list[tuple[str, Record]]:
    """Return the records that files hold together, with the names that they are given.

    Parameters
    ----------
    folder : Path
        In which the files are.
    names : sequence of str
        Of the files, relative to the folder; StationXML among them brings counts to an acceleration.
    unusable : list of Unusable
        What is no record, or not a whole one, is added to it.

    Returns
    -------
    list of (str, Record)
        In the order of the files.
    """
    responses: dict[str, set[str]] = {}
    traces: list[tuple[str, list[Any]]] = []
    for name in names:
        if Path(name).suffix.lower() in NO_RECORDS:
            continue
        known = channels_known(folder / name) if name.lower().endswith(".xml") else None
        if known is not None:
            responses[name] = known
            continue
        try:
            traces.append((name, open_traces(folder / name, [])))
        except MotionError as problem:
            unusable.append(Unusable(name, str(problem)))
    records: list[tuple[str, Record]] = []
    for of, found in grouped(traces):
        called = _called(of, found, {record.name for _, record in records})
        if len(found) != 3:
            reason = f"has {len(found)} channels; the three components of one place are a record"
            unusable.append(Unusable(called, reason))
            continue
        try:
            records.append((called, _record(folder, called, found, responses)))
        except ValidationError as problem:
            first = problem.errors()[0]["msg"].removeprefix("Value error, ")
            unusable.append(Unusable(called, f"{first}; or name it in a manifest, see `kouros motions entries`"))
    return records


def _called(of: str, found: Sequence[FileTrace], taken: set[str]) -> str:
    start = min(trace.stats.starttime for _, trace in found)
    name = of.strip(".") or found[0][0]
    if start.timestamp and not any(name == file for file, _ in found):
        name = f"{name} {start.strftime('%Y-%m-%d %H:%M')}"
    again = (f"{name} ({number})" for number in range(2, MOST))
    return name if name not in taken else next(one for one in again if one not in taken)


def _record(folder: Path, name: str, found: Sequence[FileTrace], responses: dict[str, set[str]]) -> Record:
    traces = [trace for _, trace in found]
    files = tuple(dict.fromkeys(file for file, _ in found))
    silent = [trace for trace in traces if own_unit(trace.stats)[0] in {"", "counts"} and not own_unit(trace.stats)[1]]
    ids = {trace.id for trace in traces}
    response = next((file for file, known in responses.items() if ids <= known), None) if silent else None
    # A response makes an acceleration of counts, and K-NET publishes nothing but counts: both are raw.
    raw = response is not None or all(trace.stats._format == "KNET" for trace in traces)
    components: dict[str, dict[str, Any]] = {
        one.code: {"axis": one.axis, **({"orientation": one.orientation} if one.by_code else {})}
        for one in channels(traces)
    }
    start = min(trace.stats.starttime for trace in traces)
    when = f", {start.strftime('%Y-%m-%d %H:%M:%S')}" if start.timestamp else ""
    station = f"{traces[0].stats.network}.{traces[0].stats.station}".strip(".") or files[0]
    paths = [*files, *([] if response is None else [response])]
    return Record.model_validate(
        {
            "name": name[:500],
            "files": files,
            **({} if response is None else {"response": response}),
            "components": components,
            **({"processed": False} if raw else {}),
            "source": f"station {station}{when}, by its files; say whose record it is, and of which earthquake"[:500],
            "licence": "its files do not say: ask before you pass it on",
            "sha256": {path: hashlib.sha256((folder / path).read_bytes()).hexdigest() for path in paths},
        }
    )
