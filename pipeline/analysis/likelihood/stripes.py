r"""Fragility curves by joint samples under stripes of shaking: the motions of a floor, scaled to several intensities.

All motions are scaled to the peak acceleration of a stripe.  Each stripe has its own samples: a balanced part of the
one Sobol' sequence, the same for all objects, so that the counts of its stripes are independent of each other, and
those of an object of whoever else is asked for.  Stripes lie on a ladder with even steps in the logarithm.  Each object
climbs it in coarse steps: up until nearly all samples harm it and half of them bring it to each state that harms, or
its last two stripes tell that this is out of reach; down until none harms it.  Where its curve is steep, the steps
between are run too.

The samples hold all that is uncertain of the object and the scatter of the models, and of what differs from earthquake
to earthquake as much as so few motions show: of n motions, drawn from many, the expected variance among themselves is
(n - 1) / n of that of all, so that 1 / n of the stated one is added.

References
----------
Baker, J. W. (2015). Efficient analytical fragility function fitting using dynamic structural analysis. Earthquake
Spectra 31(1), 579-599 (multiple stripe analysis).
Jalayer, F. and Cornell, C. A. (2009). Alternative non-linear demand estimation methods for probability-based seismic
assessments. Earthquake Engineering & Structural Dynamics 38, 951-972.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from math import ceil, exp, hypot, log, log2, sqrt

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.fragility.counts import FLATTEST, CountFit, fit_counts
from pipeline.analysis.fragility.curve import ENOUGH, NINETY, stated
from pipeline.analysis.fragility.hazard import Hazard
from pipeline.analysis.fragility.objects import Stripe, hazards_of, with_rate
from pipeline.analysis.fragility.published import in_si, published
from pipeline.analysis.fragility.scaling import FACTORS
from pipeline.analysis.likelihood.analyses import (
    STATES,
    Groups,
    Harmful,
    Stood,
    grouped,
    harmful_states,
    possible_states,
)
from pipeline.analysis.likelihood.draws import Draw, scatter, which_motion
from pipeline.analysis.likelihood.sampling import PART, sampled
from pipeline.analysis.verdicts import LevelMotions
from pipeline.quantities import Array
from pipeline.records import Executor, Fragility, Motion, Sampling
from pipeline.records.fragility import ABOVE, BELOW, FLAT, HARM, HazardCurve, Measure

EACH = 16
"""Samples of a stripe at least; a power of two, so that each part of the sequence is balanced."""

STEP = 0.75
"""Coarse steps of the ladder at most, in ln of the intensity: of a curve as steep as the models' scatter it is 3 times
the dispersion."""

BETWEEN = 3
"""Fine steps of a coarse one."""

STEEP = 0.5
"""Rise of a probability within a coarse step from which on the fine ones are run."""

NEARLY, HALF = 0.9, 0.5
"""Shares of the samples of a stripe from which on nearly all are harmed, and the median of a state is passed."""

SHORT = -0.5
"""Normal deviate at the top of the ladder, by the last two stripes, up to which half of the samples are out of reach:
0.5 off, which is what 16 samples leave open."""

KINDS = (HARM, *(state.value for state in STATES))
"""What there is a curve of."""


@dataclass(frozen=True)
class _Ladder:
    """Stripes: rising peak accelerations (p,) [m/s2], the motions, and their peaks [m/s2], [m/s]."""

    intensity: Array
    motions: tuple[Motion, ...]
    accelerations: tuple[float, ...]
    velocities: tuple[float, ...]
    x_azimuth: float

    @classmethod
    def of(cls, stripes: Sequence[Stripe], x_azimuth: float) -> "_Ladder | None":
        each: dict[str, tuple[Motion, float, float]] = {}
        for stripe in stripes:
            for motion, pga, pgv in zip(stripe.motions, stripe.intensities, stripe.velocities, strict=True):
                if pga > 0.0 and pgv > 0.0:
                    each[motion.hash] = (motion, pga, pgv)
        if not each:
            return None
        motions, peaks, speeds = zip(*each.values(), strict=True)
        low, high = log(FACTORS[0] * min(peaks)), log(FACTORS[-1] * max(peaks))
        steps = BETWEEN * ceil((high - low) / STEP)
        return cls(np.exp(np.linspace(low, high, steps + 1)), motions, peaks, speeds, x_azimuth)

    @cached_property
    def coarse(self) -> range:
        """The places of the coarse stripes."""
        return range(0, self.intensity.size, BETWEEN)

    def level(self, place: int) -> LevelMotions:
        """Return the motions, all scaled to the peak acceleration of a stripe."""
        to = float(self.intensity[place])
        scaled = (m.scaled(to / pga, "to a stripe") for m, pga in zip(self.motions, self.accelerations, strict=True))
        return LevelMotions("", "max", tuple(scaled), self.x_azimuth)


@dataclass
class _Counts:
    """Samples so far: taken (p, n, m), and how many reached what (p, n, kinds, m), of p stripes and n motions."""

    taken: NDArray[np.intp]
    reached: NDArray[np.intp]

    def floats(self) -> tuple[Array, Array]:
        """Return what was taken and reached as numbers."""
        return self.taken.astype(float), self.reached.astype(float)

    def share(self, place: int) -> Array:
        """Return the share that reached what at a stripe, (kinds, m); NaN where none were taken."""
        taken, reached = self.taken[place].sum(axis=0), self.reached[place].sum(axis=0)
        return np.where(taken > 0, reached / np.maximum(taken, 1), np.nan)

    def deviate(self, place: int) -> Array:
        """Return the normal deviate of that share, of none and of all half a sample off, (kinds, m); NaN for none."""
        from scipy.special import ndtri

        taken, reached = self.taken[place].sum(axis=0), self.reached[place].sum(axis=0)
        return np.where(taken > 0, ndtri((reached + 0.5) / (taken + 1.0)), np.nan)


def sampled_fragilities(
    stood: Sequence[Stood],
    count: int,
    stripes: Sequence[Stripe],
    x_azimuth: float,
    sampling: Sampling,
    executor: Executor,
    *,
    chosen: Sequence[bool] | None = None,
    told: HazardCurve | None = None,
) -> list[tuple[Fragility, ...]]:
    """Return fragility curves of objects: of harm as a whole, and of each state that they can reach.

    Parameters
    ----------
    stood
        Their scenes, as `likelihoods` has them.
    count
        How many objects there are.
    stripes
        The levels of the floor: all their motions are taken together.
    x_azimuth
        Degrees clockwise from north of the x axis of the motions.
    sampling
        A stripe has as many samples as 1/32 of those, `EACH` at least.
    executor
        Where the samples are run.
    chosen
        Which objects are asked for; None: all.
    told
        The hazard curve of the floor; None where the levels' return periods are to tell it.

    Returns
    -------
    list of tuple of Fragility
        Of each object that of harm first, then those of states, by `Harm`; none where no model is run.
    """
    out: list[tuple[Fragility, ...]] = [() for _ in range(count)]
    ladder = _Ladder.of(stripes, x_azimuth)
    stood = [one for one in stood if chosen is None or chosen[one.of]]
    groups = grouped(stood, x_azimuth)
    asked = np.zeros(count, dtype=bool)
    for one in (one for those in groups.values() for one in those):
        asked[one.of] = True
    if ladder is None or not asked.any():
        return out
    harmful, possible = harmful_states(stood, count), possible_states(groups, count) & asked
    counts = _climbed(groups, ladder, possible, harmful, max(EACH, sampling.samples // 32), executor)
    curves = _Curves.of(ladder, counts)
    hazards, why = hazards_of(stripes, told)
    possible = np.vstack([asked, possible])
    first: dict[int, Stood] = {}
    for each in stood:
        first.setdefault(each.of, each)
    for at in np.flatnonzero(asked).tolist():
        kinds = np.flatnonzero(possible[:, at]).tolist()
        out[at] = tuple(curves.told(kind, at, first[at], hazards, why) for kind in kinds)
    return out


def _climbed(
    groups: Groups,
    ladder: _Ladder,
    possible: NDArray[np.bool_],
    harmful: Harmful,
    each: int,
    executor: Executor,
) -> _Counts:
    """Run each object at as many stripes as its curves take.

    possible : which states it can reach, (s, m)
    """
    places, motions, count = ladder.intensity.size, len(ladder.motions), possible.shape[1]
    asked = possible.any(axis=0)
    looked_for = np.vstack([asked, possible & harmful.ever])
    enough = np.array([NEARLY, *[HALF] * len(STATES)])[:, None]
    counts = _Counts(
        np.zeros((places, motions, count), dtype=np.intp), np.zeros((places, motions, len(KINDS), count), dtype=np.intp)
    )
    run = partial(_run, counts=counts, groups=groups, ladder=ladder, harmful=harmful, each=each, executor=executor)
    start = ladder.coarse[len(ladder.coarse) // 2]
    run({start: np.asarray(asked)})
    here, wanted = start, np.array(asked)
    before: Array | None = None
    while here + BETWEEN < places:
        share, drawn = counts.share(here), counts.deviate(here)
        left = (places - 1 - here) // BETWEEN
        reaches: NDArray[np.bool_] = np.isfinite(drawn) if before is None else drawn + left * (drawn - before) > SHORT
        wanted = wanted & np.any(looked_for & (share < enough) & reaches, axis=0)
        if not wanted.any():
            break
        here, before = here + BETWEEN, drawn
        run({here: wanted})
    here, wanted = start, np.array(asked)
    while here - BETWEEN >= 0:
        wanted = wanted & (counts.share(here)[0] > 0.0)
        if not wanted.any():
            break
        here -= BETWEEN
        run({here: wanted})
    fine: dict[int, NDArray[np.bool_]] = {}
    for low in ladder.coarse[:-1]:
        rise: Array = counts.share(low + BETWEEN)[0] - counts.share(low)[0]
        # NaN where either was not run.
        steep: NDArray[np.bool_] = np.asarray(rise > STEEP)
        if steep.any():
            fine.update(dict.fromkeys(range(low + 1, low + BETWEEN), steep))
    run(fine)
    return counts


def _run(
    wanted: Mapping[int, NDArray[np.bool_]],
    *,
    counts: _Counts,
    groups: Groups,
    ladder: _Ladder,
    harmful: Harmful,
    each: int,
    executor: Executor,
) -> None:
    """Run the samples of some stripes, each for those objects that are wanted there."""
    most = 2 ** ceil(log2(each * ladder.intensity.size))
    tasks: list[tuple[int, int, Sequence[int]]] = []
    levels = {place: ladder.level(place) for place in wanted}
    for place in wanted:
        by_motion: dict[int, list[int]] = {}
        for number in range(place * each, (place + 1) * each):
            by_motion.setdefault(which_motion(len(ladder.motions), Draw(number, most)), []).append(number)
        for motion, those in by_motion.items():
            tasks += [(place, motion, those[at : at + PART]) for at in range(0, len(those), PART)]

    def sample(
        task: tuple[int, int, Sequence[int]],
    ) -> tuple[NDArray[np.intp], NDArray[np.intp], NDArray[np.bool_]]:
        place, _, numbers = task
        return sampled(numbers, groups=groups, wanted=wanted[place], harmful=harmful, level=levels[place], most=most)

    for (place, motion, numbers), (reached, _, harmed) in zip(tasks, executor.map(sample, tasks), strict=True):
        counts.taken[place, motion] += len(numbers) * wanted[place]
        counts.reached[place, motion, 0] += harmed.sum(axis=0)
        counts.reached[place, motion, 1:] += reached


@dataclass(frozen=True)
class _Curves:
    """Curves through the counts: by measure, of each kind, with the dispersion from record to record."""

    ladder: _Ladder
    counts: _Counts
    fits: Mapping[Measure, Sequence[CountFit]]

    @classmethod
    def of(cls, ladder: _Ladder, counts: _Counts) -> "_Curves":
        places, motions, count = counts.taken.shape
        taken, reached = counts.floats()
        by_pga = taken.sum(axis=1), reached.sum(axis=1)
        ratios = np.array(ladder.velocities) / np.array(ladder.accelerations)
        speeds = (ladder.intensity[:, None] * ratios).ravel()
        each = taken.reshape(-1, count), reached.reshape(places * motions, len(KINDS), count)
        least = scatter()
        # What the models scatter by is in the samples: no curve is steeper than that.
        fits: dict[Measure, Sequence[CountFit]] = {
            "pga": [fit_counts(ladder.intensity, by_pga[0], by_pga[1][:, k], least) for k in range(len(KINDS))],
            "pgv": [fit_counts(speeds, each[0], each[1][:, k], least) for k in range(len(KINDS))],
        }
        return cls(ladder, counts, fits)

    def told(self, kind: int, at: int, stood: Stood, hazards: Mapping[Measure, Hazard], why: str) -> Fragility:
        """Return the curve of one kind of one object."""
        fits = {measure: _Fit.of(measure, some[kind], at, self._motions) for measure, some in self.fits.items()}
        pga, pgv = fits["pga"], fits["pgv"]
        taken = self.counts.taken[:, :, at].sum(axis=1)
        tried = self.ladder.intensity[taken > 0]
        bound, end = self._bound(kind, at, pga, tried)
        chosen: Measure = "pgv" if pgv.likelihood > pga.likelihood + 1e-9 else "pga"
        beside = published(stood.scene) if kind == 0 else None
        modelling = stated("modelling").value
        found = Fragility(
            object_number=stood.scene.item.object_number,
            model="",
            title="",
            median=end if bound else pga.median,
            low=end if bound else pga.ends[0],
            high=end if bound else pga.ends[2],
            bound=bound,
            dispersion=hypot(stated("record").value, modelling) if bound else pga.dispersion,
            record=stated("record").value if bound else pga.record,
            stated=self._motions < ENOUGH,
            inputs=0.0 if bound else pga.inputs,
            modelling=modelling,
            motions=self._motions,
            returns=False,
            published="" if beside is None else beside.what,
            published_median=None if beside is None else in_si(beside),
            state=KINDS[kind],
            samples=int(taken.sum()),
            error=None if bound else pga.error,
            dispersion_error=None if bound else pga.dispersion_error,
            deviance=None if bound or not pga.degrees else pga.deviance,
            goodness=None if bound or not pga.degrees else pga.goodness,
            degrees=0 if bound else pga.degrees,
            measure="pga" if bound else chosen,
            median_pgv=None if bound else pgv.median,
            dispersion_pgv=None if bound else pgv.dispersion,
            stripes=self._stripes(kind, at),
        )
        # A curve that is told in one measure only is answered in that.
        by = chosen if chosen in hazards else next(iter(hazards), chosen)
        fit = fits[by]
        return with_rate(found, hazards.get(by), why, fit.ends, (fit.record, fit.dispersion))

    @property
    def _motions(self) -> int:
        return len(self.ladder.motions)

    def _bound(self, kind: int, at: int, fit: "_Fit", tried: Array) -> tuple[str, float]:
        """Return "" where the median lies among the stripes that were run, else on which side it is, and of what."""
        low, high = float(tried[0]), float(tried[-1])
        reached = int(self.counts.reached[:, :, kind, at].sum())
        if reached == 0:
            return ABOVE, high
        if reached == int(self.counts.taken[:, :, at].sum()):
            return BELOW, low
        if not fit.flat and low <= fit.median <= high:
            return "", fit.median
        first, last = (float(self.counts.share(place)[kind, at]) for place in self._ends(at))
        # As few as half are reached at the strongest that was tried.
        if fit.median > high or last < HALF:
            return ABOVE, high
        return (BELOW, low) if fit.median < low or first > HALF else (FLAT, high)

    def _ends(self, at: int) -> tuple[int, int]:
        """Return the lowest and the highest stripe that an object was run at."""
        places = np.flatnonzero(self.counts.taken[:, :, at].any(axis=1))
        return int(places[0]), int(places[-1])

    def _stripes(self, kind: int, at: int) -> tuple[tuple[float, int, int], ...]:
        """Return what was seen at each stripe."""
        taken, reached = self.counts.taken[:, :, at].sum(axis=1), self.counts.reached[:, :, kind, at].sum(axis=1)
        rows = zip(self.ladder.intensity.tolist(), taken.tolist(), reached.tolist(), strict=True)
        return tuple((float(f"{a:.6g}"), n, k) for a, n, k in rows if n)


@dataclass(frozen=True)
class _Fit:
    """A curve of one object in one measure, with all that the samples do not hold; what is missing is NaN."""

    median: float
    ends: tuple[float, float, float]
    dispersion: float
    record: float
    inputs: float
    error: float
    dispersion_error: float | None
    likelihood: float
    deviance: float
    degrees: int
    goodness: float
    flat: bool

    @classmethod
    def of(cls, measure: Measure, fit: CountFit, at: int, motions: int) -> "_Fit":
        median, counted, error = float(fit.median[at]), float(fit.dispersion[at]), float(fit.error[at])
        modelling, record = stated("modelling").value, stated("record" if measure == "pga" else "record_velocity").value
        # What differs between the motions is not a part of what is not known of the object.
        own = sqrt(max(counted**2 - record**2 * (motions - 1) / motions, scatter() ** 2)) if counted > 0.0 else counted
        inputs = sqrt(max(own**2 - scatter() ** 2, 0.0))
        own = hypot(inputs, modelling)
        whole = sqrt(max(counted**2, own**2) + record**2 / motions)
        unsure = NINETY * hypot(own, record / sqrt(motions), error)
        again = float(fit.dispersion_error[at])
        return cls(
            median,
            (median * exp(-unsure), median, median * exp(unsure)),
            whole,
            sqrt(whole**2 - own**2),
            inputs,
            error,
            again if again == again else None,  # noqa: PLR0124 - NaN: it is at an end of what is allowed
            float(fit.likelihood[at]),
            float(fit.deviance[at]),
            int(fit.degrees[at]),
            float(fit.goodness[at]),
            counted >= FLATTEST * (1.0 - 1e-9),
        )
