"""Fragility curves of objects, and the annual rates of their failures."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import exp, hypot

import numpy as np

from pipeline.analysis.context import Context
from pipeline.analysis.fragility.curve import ENOUGH, NINETY, fit, from_span, stated
from pipeline.analysis.fragility.hazard import Hazard, NoHazardError
from pipeline.analysis.fragility.published import in_si, published
from pipeline.analysis.fragility.scaling import FACTORS, Questions, first_failures
from pipeline.analysis.furnished import best_furnished
from pipeline.analysis.furniture import FurnitureFilter
from pipeline.analysis.plan import Indices, Work
from pipeline.analysis.verdicts import capacity_of
from pipeline.models.common import N_
from pipeline.quantities import Array
from pipeline.records import Fragility, Motion, Numerics, Scene
from pipeline.records.fragility import ABOVE, FLAT, HazardCurve, Measure

DIRECTIONS = 30.0
"""Degrees between the directions tried at least: a worst one missed by half of that is 3 % of the demand."""

FINELY = Numerics("history", DIRECTIONS)
"""How each scaled motion is integrated unless said otherwise."""


BEYOND = 0.05
"""Share of a curve beyond an end of the hazard curve from which on it is said."""


@dataclass(frozen=True)
class Stripe:
    """A level of shaking as fragilities see it.

    Attributes
    ----------
    motions : tuple of Motion
        Those of the level.
    intensities : tuple of float
        Of each, peak horizontal acceleration of the floor that objects stand on, m/s2.
    return_period_years : float or None
        How rarely it comes, years.
    velocities : tuple of float
        Of each motion, peak horizontal velocity of the floor, m/s.
    """

    motions: tuple[Motion, ...]
    intensities: tuple[float, ...]
    return_period_years: float | None = None
    velocities: tuple[float, ...] = ()


def hazards_of(stripes: Sequence[Stripe], told: HazardCurve | None) -> tuple[Mapping[Measure, Hazard], str]:
    """Return the hazard curves of a floor by measure, and why there are none.

    Parameters
    ----------
    stripes
        Its levels of shaking.
    told
        The curve that takes the place of those through the levels' return periods; None where there is none.

    Returns
    -------
    mapping, str
        At most one of each measure; "" where there is any.
    """
    if told is not None:
        return {told.measure: Hazard.told(told)}, ""
    found: dict[Measure, Hazard] = {}
    measures: tuple[Measure, ...] = ("pga", "pgv")
    why = ""
    for measure in measures:
        try:
            found[measure] = hazard_of(stripes, measure)
        except NoHazardError as problem:
            why = why or str(problem)
    return found, "" if found else why


def hazard_of(stripes: Sequence[Stripe], measure: Measure = "pga") -> Hazard:
    """Return the hazard curve through the levels that have a return period, at the geometric mean of their intensities.

    Parameters
    ----------
    stripes
        Levels of shaking; those without a return period have no say.
    measure
        Whether of peak acceleration or of peak velocity.

    Returns
    -------
    Hazard
        Annual rate of exceedance against peak horizontal acceleration [m/s2] or velocity [m/s].

    Raises
    ------
    NoHazardError
        See `Hazard.of`.
    """
    told = [s for s in stripes if s.return_period_years is not None and s.motions]
    each = [s.intensities if measure == "pga" else s.velocities for s in told]
    if not all(each):
        raise NoHazardError(N_("how often it happens cannot be told by a peak velocity that nobody gave"))
    with np.errstate(divide="ignore"):
        means = [float(np.exp(np.mean(np.log(values)))) for values in each]
    return Hazard.of(means, [s.return_period_years or 0.0 for s in told], measure=measure)


def fragilities(
    scenes: Sequence[Scene],
    work: Sequence[Work],
    stripes: Sequence[Stripe],
    context: Context,
    numerics: Numerics = FINELY,
    *,
    chosen: Sequence[bool] | None = None,
    told: HazardCurve | None = None,
) -> list[tuple[Fragility, ...]]:
    """Scale every motion of every level until each object fails, in each of its ways, and fit fragility curves.

    How a level combines its motions plays no part: a curve is about single earthquakes.  Furniture is that of the best
    estimates, and level: what its range does is not in the dispersion.  What stands in furniture that is not fastened
    has no curve: what that passes on does not grow with the shaking.

    Parameters
    ----------
    scenes
        The objects as they stand.
    work
        Of the plan of these scenes.
    stripes
        The levels, with the intensity [m/s2] of each motion.
    context
        Where it runs, and who is told.
    numerics
        How finely; directions are no closer than every `DIRECTIONS` degrees.
    chosen
        Which scenes are asked for; None: all.
    told
        The hazard curve of the floor; None where the levels' return periods are to tell it.

    Returns
    -------
    list of tuple of Fragility
        Of each scene one curve for each model, the way that fails first to begin with; medians in m/s2.

    References
    ----------
    Vamvatsikos, D. and Cornell, C. A. (2002), "Incremental dynamic analysis", Earthquake Engineering & Structural
    Dynamics 31(3), 491-514.
    """
    numerics = replace(numerics, azimuth_step=max(numerics.azimuth_step, DIRECTIONS))
    work = [one for one in work if one.furniture is None or one.furniture.loose is None]
    shaking = {furniture: _scaled(stripes, furniture) for furniture in {one.furniture for one in work}}
    out: list[list[Fragility]] = [[] for _ in scenes]
    if not any(motions for motions, _ in shaking.values()):
        return [() for _ in scenes]
    hazards, why = hazards_of(stripes, told)
    hazard = hazards.get("pga")
    if hazard is None and told is not None:
        why = "how often it happens cannot be told by a hazard curve of peak velocity unless joint samples are drawn"
    for done, one in enumerate(work):
        context.progress.step("fragilities", done, len(work))
        motions, intensities = shaking[one.furniture]
        for output, members in _by_output(one, scenes, chosen).items():
            for index, found in _curves(one, output, members, scenes, motions, intensities, context, numerics):
                out[index].append(_with_rate(found, hazard, why))
    context.progress.step("fragilities", len(work), len(work))
    return [tuple(sorted(found, key=lambda f: (f.bound == ABOVE, f.median))) for found in out]


def _scaled(stripes: Sequence[Stripe], furniture: FurnitureFilter | None) -> tuple[list[Motion], Array]:
    """Return the motions of all levels with the intensities of the floor, each once, as furniture passes them on.

    What does not shake cannot be scaled.  An oscillator passes on so many times as much where its floor shakes so many
    times as much.
    """
    each = {m.hash: (m, pga) for s in stripes for m, pga in zip(s.motions, s.intensities, strict=True) if pga > 0.0}
    passed = best_furnished([motion for motion, _ in each.values()], furniture)
    return list(passed), np.array([pga for _, pga in each.values()])


def _by_output(work: Work, scenes: Sequence[Scene], chosen: Sequence[bool] | None) -> Mapping[str, Indices]:
    places: dict[str, list[int]] = {}
    for at, index in enumerate(work.scenes.tolist()):
        if chosen is None or chosen[index]:
            places.setdefault(capacity_of(work.model, scenes[index])[0], []).append(at)
    return {output: np.array(members, dtype=np.intp) for output, members in places.items()}


def _curves(
    work: Work,
    output: str,
    members: Indices,
    scenes: Sequence[Scene],
    motions: Sequence[Motion],
    intensities: Array,
    context: Context,
    numerics: Numerics,
) -> list[tuple[int, Fragility]]:
    """Return the fragility of some analyses of a work, with the scene of each."""
    which = work.scenes[members].tolist()
    questions = Questions.of(work, output, members, [capacity_of(work.model, scenes[i])[1] for i in which])
    found = [first_failures(questions, motion, context, numerics) for motion in motions]
    factors = np.column_stack([one.factor for one in found])
    returns = np.any([one.returns for one in found], axis=0).tolist()
    spans = work.spans.take(members)
    best = factors[spans.starts]
    fitted = fit(best * intensities, FACTORS[0] * intensities, FACTORS[-1] * intensities)
    inputs = _inputs(factors, spans.starts, spans.lengths)
    out = []
    for at, index in enumerate(which):
        median, measured = float(fitted.median[at]), float(fitted.dispersion[at])
        record, told = _record(measured, len(motions))
        modelling = stated("modelling").value
        # A bound has no range.
        unsure = 0.0 if fitted.bound[at] else hypot(float(inputs[at]), modelling, record / len(motions) ** 0.5)
        beside = published(scenes[index])
        out.append(
            (
                index,
                Fragility(
                    object_number=scenes[index].item.object_number,
                    model=work.model.name,
                    title=work.model.title,
                    median=median,
                    low=median * exp(-NINETY * unsure),
                    high=median * exp(NINETY * unsure),
                    bound=fitted.bound[at],
                    dispersion=hypot(record, float(inputs[at]), modelling),
                    record=record,
                    stated=not told,
                    inputs=float(inputs[at]),
                    modelling=modelling,
                    motions=len(motions),
                    returns=returns[spans.starts[at]],
                    published="" if beside is None else beside.what,
                    published_median=None if beside is None else in_si(beside),
                ),
            )
        )
    return out


def _record(measured: float, motions: int) -> tuple[float, bool]:
    """Return the dispersion from record to record, and whether it is that of the motions."""
    least = stated("record").value
    if motions >= ENOUGH and np.isfinite(measured):
        return measured, True
    return (measured, True) if measured > least else (least, False)


def _inputs(factors: Array, starts: Indices, lengths: Indices) -> Array:
    """Return the dispersion (m,) that the uncertain inputs and the uncertain capacity make, squares summed.

    Over all corners of the inputs the variance is the sum of the squares of what each of them does, halved, on its own
    and of what several do together beyond that (a two-level factorial design: Box, Hunter and Hunter 2005); with one
    input it is the square of half its span.

    Parameters
    ----------
    factors : ndarray, shape (v + 2m, n)
        As `Questions.of` orders them.  What never fails, or fails at once, is taken at the end of the scaling, so that
        the dispersion is not too large.
    starts, lengths : ndarray, shape (m,)
        Of each analysis's parameter sets among the v.
    """
    count = starts.size
    logs: Array = np.log(np.clip(factors, FACTORS[0], FACTORS[-1]))
    sets = logs.shape[0] - 2 * count
    square = np.zeros(count)
    varied = np.flatnonzero(lengths > 1)
    if varied.size:
        ends = np.ones(sets, dtype=bool)
        ends[starts] = False
        each, lasting = logs[:sets][ends], lengths[varied] - 1
        first = np.concatenate([[0], np.cumsum(lasting)[:-1]])
        mean = np.add.reduceat(each, first) / lasting[:, None]
        apart = np.add.reduceat((each - np.repeat(mean, lasting, axis=0)) ** 2, first) / lasting[:, None]
        # Under the several motions an input does different things; their mean square counts.
        square[varied] = apart.mean(axis=1) / NINETY**2
    square += (from_span(logs[sets : sets + count], logs[sets + count :]) ** 2).mean(axis=1)
    return np.asarray(np.sqrt(square))


def _with_rate(found: Fragility, hazard: Hazard | None, why: str) -> Fragility:
    """Return the fragility with the annual rate of failure, or with the reason why there is none."""
    ends = (found.low, found.median, found.high)
    return with_rate(found, hazard, why, ends, (found.record, found.dispersion))


def with_rate(
    found: Fragility,
    hazard: Hazard | None,
    why: str,
    medians: tuple[float, float, float],
    dispersions: tuple[float, float],
) -> Fragility:
    """Return a fragility with the annual rate of failure, or with the reason why there is none.

    Beyond the ends of the hazard curve nothing is made up: the rate is what the curve accounts for, its range takes in
    what may come from above its upper end, and the note says so where that is much.

    Parameters
    ----------
    found : Fragility
        Without a rate.
    hazard : Hazard or None
        Of the floor.
    why : str
        Why there is none.
    medians : (float, float, float)
        In the measure of the hazard: low, best, high.
    dispersions : (float, float)
        In that measure: that of earthquakes alone, and with all that is not known of the object.
    """
    if hazard is None:
        return replace(found, note=why)
    if found.bound == FLAT:
        return replace(found, note="how often it happens cannot be told: more shaking hardly makes it likelier")
    if found.bound:
        return replace(found, note="how often it happens cannot be told without the shaking at which it fails")
    (low, median, high), (record, whole) = medians, dispersions
    least, most = hazard.ends
    if not least <= median <= most:
        return replace(found, note="it fails at shaking too far from the hazard curve to tell how often it comes")
    rate = hazard.failures(median, whole)
    rare, often = hazard.failures(high, record), hazard.most(low, record)
    below, above = hazard.beyond(median, whole)
    note = ""
    if above > BEYOND:
        note = "its hazard curve ends before it fails for certain: the upper end of how often it happens counts that"
    if below > BEYOND:
        note = "it fails at times below the hazard curve, which is not counted: it happens at least this often"
    return replace(found, annual_rate=rate, rate_low=min(rare, rate), rate_high=max(often, rate), note=note)
