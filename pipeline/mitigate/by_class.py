"""What is advised for objects that may be of several classes, tried for each of them as if it were installed."""

from collections.abc import Mapping, Sequence
from dataclasses import replace

from pipeline.analysis.context import Context
from pipeline.analysis.furniture import fastened, loose
from pipeline.analysis.likelihood.sampling import FEWEST, likelihoods
from pipeline.analysis.verdicts import LevelMotions
from pipeline.mitigate.catalogue import MeasureCatalogue
from pipeline.mitigate.installed import InstalledMeasure, Placed, PlacedAs, placed_more, stood_of
from pipeline.mitigate.measures.remove import LAST_RESORTS
from pipeline.mitigate.saying import ANCHORED
from pipeline.mitigate.trials import HarmAim, most_sampled
from pipeline.records import Recommendation, Scene

NAMED_FIRST = "Say first what it is: for another class that is possible this is not enough."
"""Follows the sentence of a measure that is enough for the class that an object is taken for, and not for all."""


def for_every_class(
    objects: Sequence[Placed],
    advice: Sequence[Sequence[Recommendation]],
    levels: Sequence[LevelMotions],
    context: Context,
    aim: HarmAim,
    catalogue: MeasureCatalogue,
) -> list[list[Recommendation]]:
    """Say of each measure how likely harm is that it leaves whatever the object is, and whether that is too likely.

    A measure is sought for the class that an object is taken for, and then put in place on the object as each class
    that it may be of.  Where the mixture stays at the aim or above, the sentence says that naming it comes first.

    Parameters
    ----------
    objects
        As they stand.
    advice
        For each object.
    levels
        The shaking of their floor.
    context
        Where it is run.
    aim
        How unlikely harm has to become.
    catalogue
        The measures that there are.

    Returns
    -------
    list of list of Recommendation
        For each object, in the order of ``advice``.
    """
    out = [list(some) for some in advice]
    asked = [
        (index, at)
        for index, one in enumerate(objects)
        if one.may_be
        for at, found in enumerate(out[index])
        if found.measure not in LAST_RESORTS and found.remaining is not None
    ]
    if not asked:
        return out
    # What is advised alike at several levels is tried once.
    tried: dict[tuple[int, str, tuple[tuple[str, float], ...], bool], int] = {}
    stands: list[Placed] = []
    places = []
    for index, at in asked:
        found = out[index][at]
        firm = found.sentence.startswith(ANCHORED)
        key = (index, found.measure, tuple(sorted(found.parameters.items())), firm)
        if key not in tried:
            tried[key] = len(stands)
            stands.append(_with(objects[index], found, catalogue, firm=firm))
        places.append(tried[key])
    sampling = most_sampled(aim)
    left = likelihoods(stood_of(stands), len(stands), levels, sampling, context.executor, telling=False, first=FEWEST)
    by_level = [{one.level: one.expected for one in those} for those in left]
    for (index, at), place in zip(asked, places, strict=True):
        out[index][at] = _told(out[index][at], by_level[place], aim)
    return out


def _with(one: Placed, found: Recommendation, catalogue: MeasureCatalogue, *, firm: bool) -> Placed:
    """Return an object with a measure in place, as each class that it may be of; firm: in fastened furniture."""
    measure = InstalledMeasure(found.measure, found.parameters, "as advised")

    def put(stands: Placed) -> Placed:
        if firm:
            above = None if stands.above is None else _fastened(stands.above)
            stands = replace(stands, scene=_fastened(stands.scene), above=above)
        return placed_more(stands, [measure], catalogue)

    each = tuple(PlacedAs(kind.classes, kind.chance, put(kind.placed)) for kind in one.may_be)
    return replace(each[0].placed, may_be=each)


def _fastened(scene: Scene) -> Scene:
    return fastened(scene) if loose(scene) else scene


def _told(found: Recommendation, left: Mapping[str, float], aim: HarmAim) -> Recommendation:
    # What no model is run for any more is harmed by nothing.
    remaining = left.get(found.level, 0.0)
    short = max(left.values(), default=0.0) >= aim.target
    return replace(found, remaining=remaining, sentence=f"{found.sentence} {NAMED_FIRST}" if short else found.sentence)
