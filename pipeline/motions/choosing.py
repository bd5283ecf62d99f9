"""A suite of motions chosen and scaled from the records of folders for a target spectrum, with what it reaches."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from pipeline.errors import InputError
from pipeline.motions.blas import one_thread
from pipeline.motions.candidates import CandidateRecord, FoundRecords, read_candidates
from pipeline.motions.doubts import LARGEST_SCALE
from pipeline.motions.errors import refusal
from pipeline.motions.selection import Aim, ChosenRows, choose, correlation
from pipeline.motions.spectra import psa
from pipeline.motions.targets import TargetSpectrum
from pipeline.quantities import Array, G, counted

PERIODS = (0.1, 2.0)
"""s, compared unless the caller says otherwise: the furniture and what bends, up to what slides and rocks."""

COUNT = 11
"""Motions of a suite unless the caller says otherwise (ASCE/SEI 7-22, 16.2.2)."""

ACCEPTED = 0.10
"""How far a suite's mean, and its 84th percentile over its mean, may be off the target's at any period."""

_POINTS = 40


@dataclass(frozen=True, slots=True)
class SuiteWish:
    """What a suite shall be.

    Attributes
    ----------
    periods : (float, float)
        In s, from and to.
    count : int
        How many motions.
    largest_scale : float
        No record is scaled by more than this, or by less than one over it.
    per_event, per_station : int or None
        How many motions of one earthquake, and of one station, it may have; None: as many as fit.
    seed : int
        Of the draws of the search.
    """

    periods: tuple[float, float] = PERIODS
    count: int = COUNT
    largest_scale: float = LARGEST_SCALE
    per_event: int | None = None
    per_station: int | None = None
    seed: int = 0

    def __post_init__(self) -> None:
        low, high = self.periods
        if not 0.01 <= low < high <= 10.0:
            raise InputError(f"periods: two from 0.01 to 10 s, the shorter first, not {low:g},{high:g}")
        if self.count < 1:
            raise InputError(f"count: at least 1 motion, not {self.count}")
        if not (np.isfinite(self.largest_scale) and self.largest_scale >= 1.0):
            raise InputError(f"max-scale: a number from 1, not {self.largest_scale:g}")
        if self.seed < 0:
            raise InputError(f"seed: a whole number from 0, not {self.seed}")


@dataclass(frozen=True, eq=False)
class SuiteMotion:
    """A motion of a suite.

    Attributes
    ----------
    candidate : CandidateRecord
        The record, as recorded.
    scale : float
        The one factor of its three components.
    misfit : float
        Root mean square of how far its spectrum is from the target's, in natural logarithm.
    why : str
        What speaks for it.
    """

    candidate: CandidateRecord
    scale: float
    misfit: float
    why: str

    @property
    def pga(self) -> float:
        """Of the larger horizontal component, scaled [m/s2]."""
        return self.scale * self.candidate.pga

    @property
    def pgv(self) -> float:
        """Of the larger horizontal component, scaled [m/s]."""
        return self.scale * self.candidate.pgv


@dataclass(frozen=True, eq=False)
class Suite:
    """A suite, the target that it is for, and how it meets it.

    Attributes
    ----------
    found : FoundRecords
        What it was chosen from.
    target : TargetSpectrum
        What it was chosen for.
    wish : SuiteWish
        What was asked for.
    motions : tuple of SuiteMotion
        The suite.
    periods : array, shape (m,)
        Where spectra were compared, in s.
    spectra_g : array, shape (k, m)
        Of the scaled motions, in g.
    lacking : tuple of str
        In words, why it does not meet what was asked for; none where it does.
    """

    found: FoundRecords
    target: TargetSpectrum
    wish: SuiteWish
    motions: tuple[SuiteMotion, ...]
    periods: Array
    spectra_g: Array
    lacking: tuple[str, ...]

    @property
    def ratio(self) -> Array:
        """The geometric mean of the spectra over the target's median, (m,)."""
        return np.asarray(np.exp(np.log(self.spectra_g).mean(axis=0) - self.target.at(self.periods)[0]))

    @property
    def arithmetic_ratio(self) -> Array:
        """The arithmetic mean of the spectra, which building codes compare, over the target's, (m,)."""
        return np.asarray(self.spectra_g.mean(axis=0) / np.exp(self.target.at(self.periods)[0]))

    @property
    def spread(self) -> Array:
        """The standard deviation of the natural logarithm of the spectra, (m,); zero for one motion."""
        if len(self.motions) < 2:
            return np.zeros_like(self.periods)
        return np.asarray(np.log(self.spectra_g).std(axis=0, ddof=1))

    @property
    def spread_off(self) -> Array | None:
        """How much larger the spread is than the target's, (m,); None where the target has none."""
        wanted = self.target.at(self.periods)[1]
        return None if wanted is None else np.asarray(self.spread - wanted)


def choose_suite(
    folders: Sequence[Path], target: TargetSpectrum, wish: SuiteWish | None = None, leave: Sequence[Path] = ()
) -> Suite:
    """Choose and scale records of folders for a target spectrum.

    Parameters
    ----------
    folders : sequence of Path
        Each with record files, or a site.
    target : TargetSpectrum
        What the suite is for.
    wish : SuiteWish or None
        What it shall be; None: the defaults.
    leave : sequence of Path
        Files in the folders that are no records.

    Returns
    -------
    Suite
        The best that there is, with what is lacking.

    Raises
    ------
    MotionError
        For folders with no record that can be used.
    InputError
        For periods outside of the target.
    """
    wish = wish or SuiteWish()
    periods = np.geomspace(*wish.periods, _POINTS)
    at = target.conditioned_at
    fixed: int | None = None
    if at is not None and wish.periods[0] <= at <= wish.periods[1]:
        fixed = int(np.argmin(np.abs(np.log(periods / at))))
        periods[fixed] = at
    mean, sd = target.at(periods)
    found = read_candidates(folders, wish.periods[1], leave)
    if not found.candidates:
        told = "; ".join(f"{one.name}: {one.reason}" for one in found.unusable[:3]) or "there are no files"
        raise refusal(folders[0], "records", f"none can be used ({told})", "give records of three components")
    with one_thread():
        logs = np.log(np.array([psa(one.motion, periods, 0.05, target.component) for one in found.candidates]) / G)
    aim = Aim(mean, sd, None if sd is None else correlation(periods, at), fixed)
    groups: list[tuple[Sequence[object], int]] = [([one.recording for one in found.candidates], 1)]
    if wish.per_event is not None:
        groups.append(([one.event for one in found.candidates], wish.per_event))
    if wish.per_station is not None:
        groups.append(([one.station for one in found.candidates], wish.per_station))
    chosen = choose(logs, aim, wish.count, largest_scale=wish.largest_scale, groups=groups, seed=wish.seed)
    motions = tuple(_motion(found.candidates, logs, aim, chosen, place) for place in range(len(chosen.rows)))
    scaled = np.array([logs[row] + np.log(one.scale) for row, one in zip(chosen.rows, motions, strict=True)])
    suite = Suite(found, target, wish, motions, periods, np.exp(scaled.reshape(len(motions), -1)), ())
    return replace(suite, lacking=tuple(_lacking(suite, logs, aim)))


def _motion(
    candidates: Sequence[CandidateRecord], logs: Array, aim: Aim, chosen: ChosenRows, place: int
) -> SuiteMotion:
    row, rival = chosen.rows[place], chosen.rivals[place]
    # Digits that a person reads in the manifest; what they leave out is far below what a spectrum is known to.
    scale = float(f"{chosen.factors[place]:.4g}")
    if rival is None:
        why = "no other record may take its place"
    else:
        other = candidates[rival[0]].record.name
        why = f"the suite's misfit is {chosen.misfit:.3g}; with the next best in its place, {other}, {rival[1]:.3g}"
    off = float(np.sqrt(np.mean((logs[row] + np.log(scale) - aim.mean) ** 2)))
    return SuiteMotion(candidates[row], scale, off, why)


def _lacking(suite: Suite, logs: Array, aim: Aim) -> list[str]:
    found: list[str] = []
    wish, number = suite.wish, len(suite.motions)
    if number < wish.count:
        limit = np.log(wish.largest_scale)
        weak = int((np.abs((aim.mean - logs).mean(axis=1)) > limit).sum())
        told = f"{counted(number, 'motion')} can be chosen, and {wish.count} are asked for"
        if weak:
            told += f"; {weak} more would be scaled beyond {wish.largest_scale:g}: stronger records, or --max-scale"
        found.append(f"{told}; one recording counts once")
    if not number:
        return found
    ratio = suite.ratio
    for outside, word, remedy in (
        (ratio < 1.0 - ACCEPTED, "below", "more"),
        (ratio > 1.0 + ACCEPTED, "above", "less"),
    ):
        if outside.any():
            at = suite.periods[outside]
            worst = float(np.abs(ratio - 1.0)[outside].max())
            found.append(
                f"the mean is up to {worst:.0%} {word} the target at periods from {at[0]:.2g} to {at[-1]:.2g} s: "
                f"records with {remedy} shaking there beside the others"
            )
    off = suite.spread_off
    if off is not None and (np.abs(off) > np.log(1.0 + ACCEPTED)).any():
        worst = int(np.argmax(np.abs(off)))
        kind = "more" if off[worst] < 0.0 else "less"
        found.append(
            f"the spread of ln sa is {suite.spread[worst]:.2f} at {suite.periods[worst]:.2g} s, and "
            f"{suite.spread[worst] - off[worst]:.2f} in the target: records that differ {kind} there"
        )
    return found
