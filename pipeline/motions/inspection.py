"""One record of a site, looked at closely: before and after, spectra, target, pulse."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from pipeline.motions.errors import refusal
from pipeline.motions.intensity import integrate, measures
from pipeline.motions.manifest import TargetTable, load_manifest, manifest_file
from pipeline.motions.processing import Processed
from pipeline.motions.pulses import HalfCycle, WaveletPulse, shahi_baker_pulse, velocity_half_cycles
from pipeline.motions.record import Record
from pipeline.motions.site import measured, prepare
from pipeline.motions.spectra import COMPONENTS, Spectrum, response_spectra, standard_periods
from pipeline.records import Motion

SPECTRUM_POINTS = 120
"""Periods of the spectra of an inspection."""

HALF_CYCLES = 5
"""Half-cycles of the velocity that are listed for each horizontal component, the largest first."""


@dataclass(frozen=True, eq=False)
class Inspection:
    """A record of a manifest with all that a seismologist asks of it.

    Attributes
    ----------
    site : str
        What the site is called.
    x_azimuth : float
        Of the site's x axis, degrees clockwise from north.
    level : str
        The level of shaking, or "floor NAME".
    place : str
        The record's key path in the manifest.
    before, motion : Motion
        As recorded (mean removed, turned and scaled alike), and processed; the same span where the record is not
        resampled.
    filtered : bool
        Whether anything was filtered or corrected here; a record processed by its source is not.
    corners : (float or None, float or None)
        Of high-pass and low-pass in Hz; None where there was none.
    measures_before, measures : mapping of str to float
        `intensity.measures` of what was recorded, `site.measured` of what is used.
    spectra_before : mapping of str to Spectrum
        Of x, y and z at 5 % damping.
    spectra : mapping of str to Spectrum
        Of all components at 5 %, of RotD100 at all the dampings asked for.
    target : TargetTable or None
        The level's spectrum, where it has one.
    pulse : WaveletPulse or None
        The strongest candidate of Shahi and Baker (2014), pulse-like or not; None without shaking.
    half_cycles : mapping of str to tuple of HalfCycle
        For "x" and "y", the largest half-cycles of the velocity.
    """

    site: str
    x_azimuth: float
    level: str
    place: str
    before: Motion
    motion: Motion
    filtered: bool
    corners: tuple[float | None, float | None]
    measures_before: Mapping[str, float]
    measures: Mapping[str, float]
    spectra_before: Mapping[str, Spectrum]
    spectra: Mapping[str, Spectrum]
    target: TargetTable | None
    pulse: WaveletPulse | None
    half_cycles: Mapping[str, tuple[HalfCycle, ...]]


def inspect(
    folder: str | Path,
    name: str = "",
    damping: tuple[float, ...] = (0.02, 0.05, 0.10),
    *,
    done: Processed | None = None,
) -> list[Inspection]:
    """Read and process the records of a manifest anew, and look at each.

    Parameters
    ----------
    folder : str or Path
        The site's folder, or its manifest.toml.
    name : str
        Only the record of that name; "" for all, those of the floors included.
    damping : tuple of float
        Ratios to critical of the RotD100 spectra.
    done : Processed or None
        What came of the record of that name, where it was processed just now.

    Returns
    -------
    list of Inspection
        In the manifest's order.

    Raises
    ------
    MotionError
        As `site.read_site`, and where no record has that name.
    """
    file = manifest_file(folder)
    manifest = load_manifest(file)
    targets = {record.name: (level.name, level.target) for level in manifest.level for record in level.record}
    targets |= {record.name: (f"floor {floor.name}", None) for floor in manifest.floor for record in floor.records}
    chosen = [(key, record) for key, record in manifest.records() if name in {"", record.name}]
    if not chosen:
        known = ", ".join(repr(record.name) for _, record in manifest.records())
        raise refusal(file, "record", f"there is no record {name!r}", f"its records are {known}")
    return [
        _inspected(file, manifest.site.name, manifest.site.x_azimuth, k, r, *targets[r.name], damping, done)
        for k, r in chosen
    ]


def _inspected(
    file: Path,
    site: str,
    x_azimuth: float,
    key: str,
    record: Record,
    level: str,
    target: TargetTable | None,
    damping: tuple[float, ...],
    done: Processed | None,
) -> Inspection:
    if done is None:
        done = prepare(file, key, record, target, x_azimuth)
    motion, before = done.motion, done.before
    periods = standard_periods(SPECTRUM_POINTS)
    v = integrate(motion)[0] if done.velocity is None else done.velocity
    return Inspection(
        site=site,
        x_azimuth=x_azimuth,
        level=level,
        place=key,
        before=before,
        motion=motion,
        filtered=done.filtered,
        corners=done.corners,
        measures_before=measures(before),
        measures=measured(motion, done.velocity),
        spectra_before=response_spectra(before, periods, 0.05, "xyz"),
        spectra=response_spectra(motion, periods, 0.05, [one for one in COMPONENTS if one != "rotd100"])
        | response_spectra(motion, periods, damping, ["rotd100"]),
        target=target,
        pulse=shahi_baker_pulse(v, motion.dt) if v[:2].any() else None,
        half_cycles={axis: _largest(motion, row) for row, axis in enumerate("xy")},
    )


def _largest(motion: Motion, row: int) -> tuple[HalfCycle, ...]:
    cycles = velocity_half_cycles(motion.acceleration[row], motion.dt, motion.start[row])
    order = np.argsort([-abs(cycle.peak) for cycle in cycles], kind="stable")
    return tuple(cycles[i] for i in order[:HALF_CYCLES])
