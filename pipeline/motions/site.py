"""A site: its levels of shaking with their processed motions."""

from __future__ import annotations

import logging
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from time import perf_counter

import numpy as np

from pipeline.cache import MOTIONS, Cache, CacheEntry, key_of
from pipeline.errors import InputError
from pipeline.motions.blas import one_thread
from pipeline.motions.corner_range import FACTORS, corner_range_of
from pipeline.motions.errors import Judgement, MotionError, judged, refusal
from pipeline.motions.filtering import remove_baseline
from pipeline.motions.hazard_file import read_hazard
from pipeline.motions.intensity import integrate, measures
from pipeline.motions.likeness import unlike
from pipeline.motions.manifest import (
    GROUND_FLOOR,
    LEAST_FOR_MEAN,
    FloorTable,
    Manifest,
    TargetTable,
    load_manifest,
    manifest_file,
)
from pipeline.motions.plausibility import doubt_motion, doubt_recorded, quick
from pipeline.motions.processing import Processed, cut, process
from pipeline.motions.pulses import PERIODS, shahi_baker_pulse
from pipeline.motions.quality import cut_off
from pipeline.motions.reading import Recording, read_record
from pipeline.motions.record import Record
from pipeline.quantities import Array
from pipeline.records import Motion
from pipeline.records.fragility import HazardCurve
from pipeline.supports import TRANSMITTED, refined
from pipeline.supports.floor import carried

logger = logging.getLogger(__name__)


@dataclass(frozen=True, slots=True)
class SiteMotion:
    """A processed motion with its measures and where it comes from.

    Attributes
    ----------
    motion : Motion
        What objects are shaken by.
    measures : dict of str to float
        In SI, as `measured` names them.
    licence : str
        Under which the record may be used.
    source : str
        Whose record it is.
    """

    motion: Motion
    measures: dict[str, float]
    licence: str
    source: str


@dataclass(frozen=True, slots=True)
class Level:
    """A level of shaking: its motions, how they are combined, and who answers for it.

    Attributes
    ----------
    name : str
        As the manifest has it.
    return_period_years : float or None
        In years, where it is known.
    combine : str
        "max" or "mean", as `manifest.LevelTable` explains.
    approved_by : str
        The engineer who answers for it; "" where nobody does.
    approved_on : str
        The ISO date of that; "" where nobody does.
    motions : tuple of SiteMotion
        In the manifest's order.
    """

    name: str
    return_period_years: float | None
    combine: str
    approved_by: str
    approved_on: str
    motions: tuple[SiteMotion, ...]

    @property
    def caution(self) -> str:
        """What a code would say against how the motions are combined; "" where nothing."""
        if self.combine != "mean" or len(self.motions) >= LEAST_FOR_MEAN:
            return ""
        return (
            f"codes let the mean decide from {LEAST_FOR_MEAN} motions on, and there are {len(self.motions)}: "
            f'use combine = "max"'
        )


@dataclass(frozen=True, slots=True)
class Site:
    """A site as its manifest describes it, with the processed motions of the ground.

    Attributes
    ----------
    file : Path
        The manifest.
    manifest : Manifest
        What it says.
    levels : tuple of Level
        The levels of shaking, as the ground feels them.
    kept : Path or None
        Where processed motions are kept between nights; None keeps nothing.
    hazard : HazardCurve or None
        Of the ground, where the manifest names its file.
    """

    file: Path
    manifest: Manifest
    levels: tuple[Level, ...]
    kept: Path | None = None
    hazard: HazardCurve | None = None

    @property
    def name(self) -> str:
        """What the site is called."""
        return self.manifest.site.name

    @property
    def folder(self) -> Path:
        """Where its manifest lies."""
        return self.file.parent

    @property
    def floors(self) -> tuple[str, ...]:
        """The names of the floors above the ground."""
        return tuple(floor.name for floor in self.manifest.floor)


def read_site(folder: str | Path, *, kept: Path | None = None) -> Site:
    """Read, check and process the records of the ground that a site's manifest names.

    Parameters
    ----------
    folder : str or Path
        The site's folder, or its manifest.toml.
    kept : Path or None
        Where processed motions are kept between nights; None keeps nothing.

    Returns
    -------
    Site
        The manifest, and its levels with the processed motions.

    Raises
    ------
    MotionError
        Exit code 4; naming the file, the place in it and the remedy.
    """
    file = manifest_file(folder)
    manifest = load_manifest(file)
    return _levelled(Site(file, manifest, (), kept, _hazard(file, manifest)))


def with_corner(site: Site, factor: float) -> Site:
    """Return a site with the high-pass corner of each record of the ground that is filtered here times a factor.

    Parameters
    ----------
    site : Site
        The site, with the motions of the ground.
    factor : float
        Above 0; records that their source processed, and those that are not filtered, stay as they are.

    Returns
    -------
    Site

    Raises
    ------
    InputError
        For a factor that is not above 0, and where no record of the site is filtered here.
    MotionError
        As `read_site`.
    """
    if not (np.isfinite(factor) and factor > 0.0):
        raise InputError(f"a factor of the corner must be above 0, not {factor:g}")
    tables = []
    for table, level in zip(site.manifest.level, site.levels, strict=True):
        others = [corner_range_of(one.motion.steps) for one in level.motions]
        records = tuple(
            one if other is None else one.model_copy(update={"highpass_hz": factor / FACTORS[0] * other.highpass_hz[0]})
            for one, other in zip(table.record, others, strict=True)
        )
        tables.append(table.model_copy(update={"record": records}))
    if not any(corner_range_of(one.motion.steps) for level in site.levels for one in level.motions):
        raise InputError(f"{site.file}: no record of the ground is filtered here, so that no corner was chosen")
    return _levelled(replace(site, manifest=site.manifest.model_copy(update={"level": tuple(tables)})))


def _levelled(site: Site) -> Site:
    """The site with the motions of the ground, as its manifest asks for them."""
    levels = tuple(
        Level(
            name=level.name,
            return_period_years=level.return_period_years,
            combine=level.combine,
            approved_by=level.approved_by,
            approved_on="" if level.approved_on is None else level.approved_on.isoformat(),
            motions=tuple(
                _site_motion(site, f"level[{i}].record[{j}]", record, level.target)
                for j, record in enumerate(level.record)
            ),
        )
        for i, level in enumerate(site.manifest.level)
    )
    return replace(site, levels=levels)


def _hazard(file: Path, manifest: Manifest) -> HazardCurve | None:
    name = manifest.site.hazard
    if name is None:
        return None
    folder = file.parent.resolve()
    path = folder / name
    if not path.resolve().is_relative_to(folder):
        wrong = f"{name!r} is a link out of the site's folder"
        raise refusal(file, "site.hazard", wrong, "copy the file into the folder")
    if not path.is_file():
        raise refusal(file, "site.hazard", f"there is no file {name!r}", "put it beside the manifest or mend its name")
    return read_hazard(path)


def levels_at(site: Site, floor: str) -> tuple[Level, ...]:
    """Return the levels of shaking as a floor feels them: the ground's motions carried up, or records made there.

    Parameters
    ----------
    site : Site
        The site, with the motions of the ground.
    floor : str
        A name of `site.floors`, or "ground".

    Returns
    -------
    tuple of Level
        The levels of the site, each with the motions of that floor.

    Raises
    ------
    InputError
        For a floor that the manifest does not have.
    MotionError
        As `read_site`, of records made on the floor.
    """
    if floor == GROUND_FLOOR:
        return site.levels
    for number, table in enumerate(site.manifest.floor):
        if table.name == floor:
            return tuple(replace(level, motions=_on_floor(site, number, table, level)) for level in site.levels)
    known = ", ".join([GROUND_FLOOR, *site.floors])
    raise InputError(f"{site.file}: there is no floor {floor!r}; it has {known}")


def _on_floor(site: Site, number: int, table: FloorTable, level: Level) -> tuple[SiteMotion, ...]:
    if table.records:
        several = isinstance(table.record, tuple)
        return tuple(
            _site_motion(site, f"floor[{number}].record{f'[{j}]' if several else ''}", record, None)
            for j, record in enumerate(table.records)
            if record.level in {None, level.name}
        )
    return tuple(_carried(site, table, one) for one in level.motions)


def _carried(site: Site, table: FloorTable, ground: SiteMotion) -> SiteMotion:
    motion = ground.motion

    def up() -> Measured:
        made = carry(motion, table).called(f"{motion.name}, floor {table.name}")
        return made, measured(made)

    told = (motion.name, motion.steps, motion.source, motion.start, motion.v_max)
    key = key_of(motion.hash, *told, table.model_dump_json())
    return SiteMotion(*_kept(site.kept, key, up), ground.licence, ground.source)


Measured = tuple[Motion, dict[str, float]]
"""A processed motion and its measures."""


def _kept(folder: Path | None, key: str, make: Callable[[], Measured]) -> Measured:
    """Return what is kept under a key, else make it and keep it; no folder keeps nothing."""
    if folder is None:
        return make()
    cache = Cache(folder)
    found = cache.get(MOTIONS, key)
    logger.debug("motion %s: %s", key, "not kept" if found is None else "kept")
    if found is not None:
        said = dict(found.said)
        measures = said.pop("measures")
        return Motion(acceleration=found.arrays["acceleration"], **said), measures
    motion, measures = make()
    said = {name: getattr(motion, name) for name in ("dt", "name", "steps", "source", "start", "v_max")}
    cache.put(MOTIONS, key, CacheEntry(said | {"measures": measures}, {"acceleration": motion.acceleration}))
    return motion, measures


@one_thread()
def carry(motion: Motion, table: FloorTable) -> Motion:
    """Return a motion of the ground as a floor feels it, by the method of the manifest's table.

    Parameters
    ----------
    motion : Motion
        Of the ground.
    table : FloorTable
        The floor, with its height ratio.

    Returns
    -------
    Motion
        Of the floor; one that passes through modes has as many samples as they need.

    Raises
    ------
    ValueError
        For a table of records, which are not computed.
    """
    if table.height_ratio is None:
        raise ValueError(f"floor {table.name!r} has records of its own")
    passed = partial(
        carried, motion, table.height_ratio, table.period_s, table.damping, table.stiffness_ratio, table.modes
    )
    return passed(1) if table.modes is None else refined(passed, TRANSMITTED)


def motions_of(path: str | Path, kept: Path | None = None) -> list[Motion]:
    """Return the processed motions of a site's folder or manifest file, in the manifest's order.

    Parameters
    ----------
    path : str or Path
        The site's folder, or its manifest.toml.
    kept : Path or None
        A folder in which processed motions are kept for the next time; None keeps none.

    Returns
    -------
    list of Motion
        Those of the ground.

    Raises
    ------
    MotionError
        Naming the file, the place in it and the remedy.
    """
    file = manifest_file(path)
    manifest = load_manifest(file)
    motions = []
    for i, level in enumerate(manifest.level):
        for j, record in enumerate(level.record):
            # Kept apart from what a night keeps, as it has no measures.
            identity = _identity(record, level.target, manifest.site.x_azimuth, "without measures")
            place = f"level[{i}].record[{j}]"
            make = partial(prepare, file, place, record, level.target, manifest.site.x_azimuth)
            motions.append(_kept(kept, identity, partial(_bare, make))[0])
    return motions


def _bare(make: Callable[[], Processed]) -> Measured:
    return make().motion, {}


def _identity(record: Record, target: TargetTable | None, x_azimuth: float, *more: str) -> str:
    return key_of(record.model_dump_json(), "" if target is None else target.model_dump_json(), str(x_azimuth), *more)


@one_thread()
def measured(motion: Motion, velocity: Array | None = None) -> dict[str, float]:
    """Return the measures of a motion, and those of its near-fault pulse where it has one.

    Parameters
    ----------
    motion : Motion
        What is measured.
    velocity : array, shape (3, n), or None
        In m/s as the motion's agency computed it, where it did: its peaks are the PGV.

    Returns
    -------
    dict of str to float
        Those of `intensity.measures`, and of a pulse: pulse_period [s], pulse_pgv [m/s] and pulse_angle [degrees from x
        towards y].

    References
    ----------
    Shahi, S. K. and Baker, J. W. (2014), for the pulse; see `pulses.shahi_baker_pulses`.
    """
    out = measures(motion)
    v = integrate(motion)[0] if velocity is None else velocity
    if velocity is not None:
        peaks = np.abs(velocity).max(axis=1)
        out |= {f"pgv_{axis}": float(peak) for axis, peak in zip("xyz", peaks, strict=True)}
        out |= {"pgv": float(peaks[:2].max()), "pgv_resultant": float(np.hypot(*velocity[:2]).max())}
    if motion.samples > 1 and v[:2].any() and motion.duration > PERIODS[0]:
        pulse = shahi_baker_pulse(v, motion.dt)
        if pulse.is_pulse:
            out |= {"pulse_period": pulse.period, "pulse_pgv": pulse.pulse_pgv, "pulse_angle": pulse.angle}
    return out


def _site_motion(site: Site, key: str, record: Record, target: TargetTable | None) -> SiteMotion:
    x_azimuth = site.manifest.site.x_azimuth

    def processed() -> Measured:
        done = prepare(site.file, key, record, target, x_azimuth)
        return done.motion, measured(done.motion, done.velocity)

    known = _kept(site.kept, _identity(record, target, x_azimuth), processed)
    return SiteMotion(*known, record.licence, record.source)


@one_thread()
def prepare(file: Path, key: str, record: Record, target: TargetTable | None, x_azimuth: float) -> Processed:
    """Read and process one record of a manifest.

    Parameters
    ----------
    file : Path
        The manifest.
    key : str
        The record's place in it, for messages; "" where there is none yet.
    record : Record
        What is read, and what is to be done to it.
    target : TargetTable or None
        The level's spectrum, for a record with `scale_to_target`.
    x_azimuth : float
        Of the x axis, degrees clockwise from north.

    Returns
    -------
    Processed
        The motion, beside what it was before.

    Raises
    ------
    MotionError
        As `reading.read_record`; for keys of the manifest that cannot be followed; for a record that ends or begins
        during strong shaking, unless that is accepted.
    """
    since = perf_counter()
    steps: list[str] = []

    def ask(judgement: Judgement, wrong: str, remedy: str) -> None:
        place = ", ".join(filter(None, (key, f"record {record.name!r}")))
        judged(record.accept, judgement, file, place, wrong, remedy, steps)

    try:
        recording = read_record(file.parent, record)
        # Before anything is filtered, which would hide the evidence.
        span, _ = remove_baseline(_span(recording), recording.dt)
        if doubt := doubt_recorded(span):
            ask(doubt.judgement, doubt.wrong, doubt.remedy)
        if incomplete := cut_off(span, recording.dt, recording.channels):
            ask("cut_off", incomplete, "use the whole record, or widen window_s")
        done = process(recording, record, target, x_azimuth)
    except MotionError:
        raise
    except ValueError as error:
        raise refusal(file, key or "record", str(error), "mend that key of the manifest") from error
    logger.info(
        "%s, %s, record %r: read and processed in %.2f s, %d samples of %g s",
        file, key, record.name, perf_counter() - since, done.motion.acceleration.shape[-1], done.motion.dt,
    )  # fmt: skip
    unscaled = done.motion.scaled(1.0 / done.factor, "for judging")
    velocity = None if done.velocity is None else done.velocity / done.factor
    if doubt := doubt_motion(unscaled, velocity=velocity, processed=recording.processed):
        ask(doubt.judgement, doubt.wrong, doubt.remedy)
    steps += filter(None, (quick(unscaled),))
    # A floor of a building is shaken as no ground is.
    if not key.startswith("floor[") and (said := unlike(unscaled, velocity, record)):
        steps.append(said)
    return replace(done, motion=done.motion.called(record.name, *steps)) if steps else done


def _span(recording: Recording) -> Array:
    if recording.window is None:
        return recording.data
    return cut(recording.data, recording.dt, *recording.window, recording.begins)[0]
