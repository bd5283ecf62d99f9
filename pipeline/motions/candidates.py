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
from pipeline.motions.grouping import Found, channels, grouped
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

_UNSCALED: dict[str, Any] = {"scale": None, "scale_to_pga_g": None, "scale_to_target": None, "v_max_cm_s": None}


@dataclass(frozen=True, eq=False)
class Candidate:
    """A record of three components that was read and processed, as recorded.

    Attributes
    ----------
    record : Record
        The manifest's table of it, without a scale; its files lie inside the folder that was looked at.
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
    """

    name: str
    reason: str


@dataclass(frozen=True, eq=False)
class Folder:
    """What a folder holds.

    Attributes
    ----------
    candidates : tuple of Candidate
        In the order of their files, or of the manifest.
    unusable : tuple of Unusable
        What else there is, but for words and responses.
    site : SiteTable or None
        The site of its manifest, where it has one.
    """

    candidates: tuple[Candidate, ...]
    unusable: tuple[Unusable, ...]
    site: SiteTable | None


def read_candidates(folder: Path, longest_period: float, leave: Sequence[Path] = ()) -> Folder:
    """Read every record of a folder that a suite may be chosen from; what cannot be used never stops the rest.

    A folder with a manifest has the records that it names, as it says; their scales are left out.  In any other one,
    files of one station and time are a record, with counts brought to an acceleration by the StationXML that knows
    their channels.

    Parameters
    ----------
    folder : Path
        The folder, with what is below it.
    longest_period : float
        In s; a record whose high-pass takes that away is not used.
    leave : sequence of Path
        Files that are no records, such as the target.

    Returns
    -------
    Folder

    Raises
    ------
    MotionError
        For a folder that is none, or whose manifest cannot be used.
    """
    if not folder.is_dir():
        raise refusal(folder, "folder", "there is no such folder", "name a folder of record files, or a site's")
    file = folder / MANIFEST
    site: SiteTable | None = None
    unusable: list[Unusable] = []
    named: list[tuple[str, Record]] = []
    if file.is_file():
        manifest = load_manifest(file)
        site = manifest.site
        named = [(f"level[{i}].record[{j}]", r) for i, v in enumerate(manifest.level) for j, r in enumerate(v.record)]
    else:
        named = _found(folder, {path.resolve() for path in leave}, unusable)
    read: list[tuple[Record, Processed, str | None, float | None]] = []
    azimuth = EAST if site is None else site.x_azimuth
    for place, record in named:
        try:
            read.append(_read(file, place, record, azimuth, longest_period))
        except MotionError as problem:
            unusable.append(Unusable(record.name, str(problem)))
    events = _events([start for *_, start in read])
    candidates = (_candidate(*one[:3], event) for one, event in zip(read, events, strict=True))
    return Folder(tuple(candidates), tuple(unusable), site)


def _candidate(record: Record, done: Processed, station: str | None, event: int | None) -> Candidate:
    found = measures(done.motion)
    pgv = found["pgv"] if done.velocity is None else float(np.abs(done.velocity[:2]).max())
    return Candidate(record, done.motion, found["pga"], pgv, station, event)


def _read(
    file: Path, place: str, record: Record, azimuth: float, longest: float
) -> tuple[Record, Processed, str | None, float | None]:
    where = f"record {record.name!r}"
    if record.vertical == "absent":
        wrong = "has no vertical component, and three are asked for"
        raise refusal(file.parent, where, wrong, "give the vertical's file")
    if record.v_max_cm_s is not None:
        wrong = "its v_max_cm_s belongs to the scale that it has"
        raise refusal(file, f"{where}, v_max_cm_s", wrong, "leave it out: the PGV takes its place")
    unscaled = record.model_copy(update=_UNSCALED)
    done = prepare(file, place, unscaled, None, azimuth)
    corner = done.corners[0]
    if corner is not None and USABLE * corner * longest > 1.0:
        wrong = f"its high-pass at {corner:.3g} Hz leaves periods up to {1.0 / (USABLE * corner):.2g} s"
        raise refusal(file.parent, where, wrong, f"give a longer record, or choose up to less than {longest:g} s")
    if not done.motion.acceleration[:2].any():
        raise refusal(file.parent, where, "has no horizontal shaking", "take another")
    stats = open_traces(file.parent / record.files[0], [])[0].stats
    station = f"{stats.network}.{stats.station}" if stats.station else None
    unknown = stats.get("kouros", {}).get("start", "record") == "unknown" or stats.starttime.timestamp == 0.0
    return unscaled, done, station, None if unknown else float(stats.starttime.timestamp)


def _events(starts: Sequence[float | None]) -> list[int | None]:
    known = sorted(start for start in starts if start is not None)
    first: list[float] = []
    for start in known:
        if not first or start - first[-1] > _SAME_EVENT:
            first.append(start)
    return [None if s is None else sum(begin <= s for begin in first) for s in starts]


def _found(folder: Path, leave: set[Path], unusable: list[Unusable]) -> list[tuple[str, Record]]:
    """Records of files that no manifest names, with the names that they are given."""
    paths = sorted(path for path in folder.rglob("*") if path.is_file() and not path.is_symlink())
    names = [path.relative_to(folder).as_posix() for path in paths[:MOST] if path.resolve() not in leave]
    names = [name for name in names if not any(part.startswith(".") for part in name.split("/"))]
    if len(paths) > MOST:
        unusable.append(Unusable(folder.name, f"holds {len(paths):,} files, of which the first {MOST:,} are looked at"))
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


def _called(of: str, found: Sequence[Found], taken: set[str]) -> str:
    start = min(trace.stats.starttime for _, trace in found)
    name = of.strip(".") or found[0][0]
    if start.timestamp and not any(name == file for file, _ in found):
        name = f"{name} {start.strftime('%Y-%m-%d %H:%M')}"
    again = (f"{name} ({number})" for number in range(2, MOST))
    return name if name not in taken else next(one for one in again if one not in taken)


def _record(folder: Path, name: str, found: Sequence[Found], responses: dict[str, set[str]]) -> Record:
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
