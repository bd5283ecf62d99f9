"""The motions of an earthquake, for the objects that matter most: the museum's own record, or those of its suite.

The suite's records are scaled to both peaks of the ground, by the geometric mean of the two factors, and each counts by
how well it fits: by its peak velocity over its peak acceleration, and by magnitude and distance where both are known.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import log
from time import perf_counter

import numpy as np

from pipeline.analysis.verdicts import LevelMotions
from pipeline.event.answer import Answer, chances, normals, placed
from pipeline.event.capacities import KINDS, Stock
from pipeline.event.message import ReportedEarthquake, SiteShaking
from pipeline.event.reading import OwnRecord
from pipeline.motions.record import Record
from pipeline.motions.site import Level, Site, SiteMotion
from pipeline.night.waveforms import Shaken, shaken_by, under
from pipeline.operations.workspace import Workspace
from pipeline.quantities import Array, G
from pipeline.records import Likelihood, Page
from pipeline.records.fragility import HARM

SLOTS = 16
"""Places that the records of a suite are dealt to by how well they fit: samples draw among these."""

BANDWIDTH, MAGNITUDES, DISTANCES = 0.5, 1.0, 1.0
"""Differences of ln of PGV over PGA, of magnitudes and of ln of distances at which a record counts 0.6 times as much:
judgement.  The first was tried: of 0.2 and 0.5 the errors are the same (docs/how-to/earthquake.md)."""

SAMPLES = 64
"""Samples of each object, at most: a probability of a half is told to 0.06, and a minute is all that there is."""

PRIOR = 16.0
"""Samples that the curves count as much as: judgement, from 8 to 32.  They miss the truth by 0.07 of harm on average
(docs/how-to/earthquake.md), as that many samples do; without them each object of which no sample fell would count as
half a sample fallen, and a museum of thousands as dozens."""

LEAST = 1e-4
"""Probability below which nothing is told."""

MOST = 2000
"""Objects that are run under waveforms, those first of which most is lost."""


@dataclass(frozen=True)
class Modelled:
    """Objects whose models were run under the motions of the earthquake.

    Attributes
    ----------
    chances : mapping of str to mapping of str to float
        By object number, the probability of each kind that it can reach.
    told : str
        Under what they were run, in words.
    same : bool
        Whether that is the very motion.
    """

    chances: dict[str, dict[str, float]]
    told: str
    same: bool


def modelled(
    workspace: Workspace,
    pages: Sequence[Page],
    first: Answer,
    stock: Stock,
    shaking: SiteShaking,
    quake: ReportedEarthquake,
    own: OwnRecord | None,
    seconds: float,
    *,
    distance_km: float | None,
) -> Modelled:
    """Run the models of those objects of which most is lost, under the motions of the earthquake.

    Parameters
    ----------
    workspace : Workspace
        Of the museum.
    pages : sequence of Page
        Of the run that was answered from.
    first : Answer
        The answer without them, whose order is followed.
    stock : Stock
        What it is from.
    shaking : SiteShaking
        Of the ground, by the messages, with a peak velocity.
    quake : ReportedEarthquake
        Whose magnitude counts, where it is known.
    own : OwnRecord or None
        The museum's own record.
    seconds : float
        That there are for it; what was begun is ended.
    distance_km : float or None
        Of the epicentre from the museum.

    Raises
    ------
    MotionError
        Where the site of the museum cannot be used.
    """
    until = perf_counter() + seconds
    site = workspace.site()
    if own is not None:
        shaken = _under_one(site, own)
        told = "the museum's own record"
    else:
        shaken, records = conditioned_suite(site, shaking, quake.magnitude, distance_km)
        told = f"{records} records of the site's suite, scaled to these peaks and counted by how well they fit"
    sampling = workspace.settings.likelihood.sampling
    few = replace(sampling, samples=min(sampling.samples or SAMPLES, SAMPLES))
    numbers = [one.number for one in first.objects[:MOST] if one.probability is not None and not one.reported]
    found = under(workspace, pages, numbers, shaken, few, until)
    return Modelled(_with_curves(found, stock, shaking), told, own is not None)


def _with_curves(found: Mapping[str, Likelihood], stock: Stock, shaking: SiteShaking) -> dict[str, dict[str, float]]:
    """Return by object number the probability of each kind, by its samples and by what its curves say at the peaks."""
    places = [at for at, number in enumerate(stock.numbers) if number in found]
    if not places:
        return {}
    draws = placed(replace(shaking, pga_ln_sd=0.0, pgv_ln_sd=0.0), normals())
    few = stock.capacities.some(places)
    before = np.einsum("s,ksn->kn", draws.weights, chances(few, draws, slice(0, len(places)))).T.tolist()
    out = {}
    for at, curves in zip(places, before, strict=True):
        one = found[stock.numbers[at]]
        shares = {HARM: one.probability, **one.states}
        prior = dict(zip(KINDS, curves, strict=True))
        out[stock.numbers[at]] = {
            name: min(max((share * one.samples + PRIOR * prior[name]) / (one.samples + PRIOR), LEAST), 1.0 - LEAST)
            for name, share in shares.items()
        }
    return out


def _under_one(site: Site, own: OwnRecord) -> Shaken:
    level = Level("own record", None, "max", "", "", (own.motion,))
    return shaken_by(replace(site, levels=(level,), kept=None), "own record", own.x_azimuth)


def conditioned_suite(
    site: Site, shaking: SiteShaking, magnitude: float | None, distance_km: float | None
) -> tuple[Shaken, int]:
    """Return the records of a site as they may have come at these peaks, by floor, and how many different ones.

    Parameters
    ----------
    site : Site
        The museum's.
    shaking : SiteShaking
        Of the ground, with a peak velocity.
    magnitude, distance_km : float or None
        Of the earthquake, and how far it was.
    """
    if shaking.pgv_cm_s is None:
        raise AssertionError("a peak velocity is estimated before anything is run")
    ln_a, ln_v = log(shaking.pga_g * G), log(0.01 * shaking.pgv_cm_s)
    every = [
        (motion, record)
        for level, table in zip(site.levels, site.manifest.level, strict=True)
        for motion, record in zip(level.motions, table.record, strict=True)
    ]
    peaks = np.log([[max(one.measures[name], 1e-12) for name in ("pga", "pgv")] for one, _ in every])
    weights = fitting(peaks[:, 1] - peaks[:, 0] - (ln_v - ln_a), [one for _, one in every], magnitude, distance_km)
    steps = (np.arange(SLOTS) + 0.5) / SLOTS
    dealt = np.bincount(np.minimum(np.searchsorted(np.cumsum(weights), steps), len(every) - 1), minlength=len(every))
    chosen = np.flatnonzero(dealt)
    factors = np.exp(0.5 * (ln_a - peaks[:, 0] + ln_v - peaks[:, 1]))
    motions = tuple(_scaled(every[at][0], float(factors[at])) for at in chosen.tolist())
    level = Level("conditioned", None, "mean", "", "", motions)
    of_floor = shaken_by(replace(site, levels=(level,), kept=None), "conditioned", site.manifest.site.x_azimuth)

    def shaken(floor: str) -> LevelMotions | None:
        found = of_floor(floor)
        if found is None:
            return None
        several = [motion for motion, times in zip(found.motions, dealt[chosen], strict=True) for _ in range(times)]
        return replace(found, motions=tuple(several))

    return shaken, len(chosen)


def fitting(off: Array, records: Sequence[Record], magnitude: float | None, distance_km: float | None) -> Array:
    """Return how much each record counts, together 1.

    Parameters
    ----------
    off : ndarray, shape (n,)
        By how much ln of its PGV over PGA differs from what is to be met.
    records : sequence of Record
        What the manifest says of each.
    magnitude, distance_km : float or None
        To be met; None where nobody knows.
    """
    ln = -0.5 * (off / BANDWIDTH) ** 2
    for at, record in enumerate(records):
        its = None if record.event is None else record.event.magnitude
        if its is not None and magnitude is not None:
            ln[at] -= 0.5 * ((its - magnitude) / MAGNITUDES) ** 2
        if record.distance_km and distance_km:
            ln[at] -= 0.5 * (log(record.distance_km / distance_km) / DISTANCES) ** 2
    weights = np.exp(ln - ln.max())
    return np.asarray(weights / weights.sum())


def _scaled(one: SiteMotion, factor: float) -> SiteMotion:
    motion = one.motion.scaled(factor, f"scaled by {factor:.3g} to the peaks of an earthquake")
    return replace(one, motion=motion, measures={name: one.measures[name] * factor for name in ("pga", "pgv")})
