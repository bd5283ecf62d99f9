"""A site: its levels of shaking with their processed motions, and what a report shows of them."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from pipeline.motions.errors import MotionError, refusal
from pipeline.motions.intensity import measures, strong_part
from pipeline.motions.keeping import keep, recall
from pipeline.motions.manifest import FloorTable, Record, load_manifest, manifest_file
from pipeline.motions.processing import process, starting_velocity
from pipeline.motions.reading import read_record
from pipeline.records import Motion, MotionSummary

PICTURE_POINTS = 600
PICTURE_MARGIN = 5.0


@dataclass(frozen=True, slots=True)
class SiteMotion:
    """A processed motion with its measures (SI, see `intensity.measures`) and where it comes from."""

    motion: Motion
    measures: dict[str, float]
    licence: str
    source: str


@dataclass(frozen=True, slots=True)
class Level:
    """A level of shaking; ``approved_by`` is empty when nobody answers for it, ``approved_on`` is an ISO date."""

    name: str
    return_period_years: float | None
    combine: str
    approved_by: str
    approved_on: str
    motions: tuple[SiteMotion, ...]


@dataclass(frozen=True, slots=True)
class Site:
    """A site as its manifest describes it; degrees north and east, vs30 in m/s where it is known."""

    name: str
    folder: Path
    latitude: float
    longitude: float
    vs30: float | None
    levels: tuple[Level, ...]
    floors: tuple[FloorTable, ...]


def read_site(folder: str | Path, *, kept: Path | None = None) -> Site:
    """Read, check and process everything that a site's manifest names.

    folder : the site's folder, or its manifest.toml
    kept   : where processed motions are kept between nights; None keeps nothing
    raises : MotionError (exit code 4) naming the file, the place in it and the remedy
    """
    file = manifest_file(folder)
    manifest = load_manifest(file)
    levels = tuple(
        Level(
            name=level.name,
            return_period_years=level.return_period_years,
            combine=level.combine,
            approved_by=level.approved_by,
            approved_on="" if level.approved_on is None else level.approved_on.isoformat(),
            motions=tuple(
                _site_motion(file, f"level[{i}].record[{j}]", record, kept) for j, record in enumerate(level.record)
            ),
        )
        for i, level in enumerate(manifest.level)
    )
    site = manifest.site
    return Site(site.name, file.parent, site.latitude, site.longitude, site.vs30, levels, manifest.floor)


def read_motion(path: str | Path) -> list[Motion]:
    """Return the processed motions of a site's folder or manifest file, in the manifest's order.

    raises : MotionError, as `read_site`
    """
    return [one.motion for level in read_site(path).levels for one in level.motions]


def summaries(site: Site) -> tuple[MotionSummary, ...]:
    """Return what a report shows of each motion, in the manifest's order, with thinned series for its picture."""
    return tuple(
        MotionSummary(
            name=one.motion.name,
            hash=one.motion.hash,
            level=level.name,
            source=one.source,
            dt=one.motion.dt,
            samples=one.motion.samples,
            measures=one.measures,
            steps=one.motion.steps,
            approved_by=level.approved_by,
            approved_on=level.approved_on,
            licence=one.licence,
            series=thinned(one.motion),
        )
        for level in site.levels
        for one in level.motions
    )


def thinned(motion: Motion, points: int = PICTURE_POINTS) -> dict[str, tuple[float, ...]]:
    """Return the strong part of a motion (D5-95 and 5 s on both sides) with few enough points for a picture.

    returns : t [s from the motion's first sample] and x, y, z [m/s2], all of one length, at most ``points``.  Each bin
              of samples is drawn as its smallest and largest value, in the order in which they occur: peaks survive.
    """
    start, end = strong_part(motion)
    if start == end:
        end = motion.duration
    a = max(0, int(np.floor((start - PICTURE_MARGIN) / motion.dt)))
    b = min(motion.samples, int(np.ceil((end + PICTURE_MARGIN) / motion.dt)) + 1)
    part = motion.acceleration[:, a:b]
    n = part.shape[1]
    if n <= points:
        times = (a + np.arange(n)) * motion.dt
        return {"t": tuple(times.tolist())} | {axis: tuple(part[i].tolist()) for i, axis in enumerate("xyz")}
    edges = np.linspace(0, n, points // 2 + 1).astype(int).tolist()
    t: list[float] = []
    rows: tuple[list[float], ...] = ([], [], [])
    for first, last in pairwise(edges):
        width = float(last - first)
        t += [(a + first + 0.25 * width) * motion.dt, (a + first + 0.75 * width) * motion.dt]
        for row, values in zip(rows, part[:, first:last], strict=True):
            low, high = int(np.argmin(values)), int(np.argmax(values))
            row += [float(values[i]) for i in sorted((low, high))]
    return {"t": tuple(t)} | {axis: tuple(row) for axis, row in zip("xyz", rows, strict=True)}


def _site_motion(file: Path, key: str, record: Record, kept: Path | None) -> SiteMotion:
    known = None if kept is None else recall(kept, record)
    if known is not None:
        return SiteMotion(*known, record.licence, record.source)
    recording = read_record(file.parent, record)
    try:
        motion = process(recording, record)
        start = starting_velocity(recording, record)
    except MotionError:
        raise
    except ValueError as error:
        raise refusal(file, key, str(error), "mend that key of the manifest") from error
    measured = measures(motion, start)
    if kept is not None:
        keep(kept, record, (motion, measured))
    return SiteMotion(motion, measured, record.licence, record.source)
