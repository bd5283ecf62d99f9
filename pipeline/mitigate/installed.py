"""Measures that are installed: the scene of an object as it stands now, and what an isolator passes on to it.

The changes are those by which a measure is verified before it is advised (`Measure.change`).
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import fsum
from typing import Any

from pipeline.analysis.assess import LevelMotions, assess
from pipeline.analysis.context import Context
from pipeline.analysis.furnished import furnished
from pipeline.analysis.furniture import FurnitureFilter, filter_of
from pipeline.analysis.likelihood.analyses import CERTAIN, Kind, Stood, Transfer
from pipeline.analysis.likelihood.sampling import likelihoods
from pipeline.analysis.transmission import transmit
from pipeline.mitigate.catalogue import MeasureCatalogue, own_catalogue
from pipeline.mitigate.measures.base import held
from pipeline.models import model_named, tips
from pipeline.models.rocking import ROCKING
from pipeline.models.sliding import SLIDING
from pipeline.models.unanchored import UNANCHORED
from pipeline.records import UNTOLD_ISOLATOR, Finding, Likelihood, Numerics, Sampling, Scene, Support
from pipeline.records.phrases import STANDS_AS

ON_TOP = "Under the motion that its isolator passes on"


@dataclass(frozen=True, slots=True)
class InstalledMeasure:
    """A measure that is installed: its name in the catalogue, its parameters [SI], and who says so."""

    name: str
    parameters: Mapping[str, float]
    words: str


@dataclass(frozen=True, slots=True)
class Placed:
    """An object as it stands.

    Attributes
    ----------
    scene : Scene
        Its scene, or that of the isolator under it.
    above : Scene or None
        The object as it stands on the isolator; None where there is none.
    isolator : str
        Model of the isolator; "" for none.
    may_be : tuple of PlacedAs
        It as each class that it may be of, the one of `scene` first; () where that is certain or makes no difference.
    """

    scene: Scene
    above: Scene | None = None
    isolator: str = ""
    may_be: "tuple[PlacedAs, ...]" = ()

    def passing(self) -> Transfer:
        """Return what passes the motion on: the kind of the isolator, and its parameters by name."""
        known = self.scene.parameters
        names = (q.name for q in model_named(self.isolator).needs if q.name in known)
        return self.isolator, tuple((name, known[name].value) for name in names)


@dataclass(frozen=True, slots=True)
class PlacedAs:
    """An object as one of the classes that it may be of.

    Attributes
    ----------
    classes : tuple of str
        The class, or several for which the same is computed.
    chance : float
        How likely it is of that; those of an object need not add up to 1.
    placed : Placed
        It as such, as it stands.
    """

    classes: tuple[str, ...]
    chance: float
    placed: Placed


def placed(scene: Scene, measures: Sequence[InstalledMeasure], catalogue: MeasureCatalogue | None = None) -> Placed:
    """Return an object with its measures in place, one after the other.

    What is done to an object that stands on an isolator is done to it, not to the isolator.  A measure that is not in
    the catalogue any more, or whose change needs what is not known of the object, changes nothing, and the scene's
    assumptions say so.

    Parameters
    ----------
    scene : Scene
        The object without them.
    measures : sequence of InstalledMeasure
        In the order in which they were decided.
    catalogue : MeasureCatalogue, optional
        What the museum has; Kouros's own where it is left out.

    Returns
    -------
    Placed
    """
    return placed_more(Placed(scene), measures, catalogue)


def placed_more(
    stands: Placed, measures: Sequence[InstalledMeasure], catalogue: MeasureCatalogue | None = None
) -> Placed:
    """Return an object with more measures in place than it stands with: see `placed`."""
    catalogue = catalogue or own_catalogue()
    for installed in measures:
        before = stands.scene if stands.above is None else stands.above
        try:
            measure = catalogue.named(installed.name)
            before = _told_now(before) if measure.isolator else before
            after = measure.change(before, installed.parameters)
        except KeyError as unknown:
            said = f"{installed.name} is installed ({installed.words}), but is not computed: {unknown} is not known"
            scene = replace(stands.scene, assumptions=(*stands.scene.assumptions, said))
            stands = replace(stands, scene=scene)
            continue
        after = _told(before, after, installed.words)
        if measure.isolator:
            stands = Placed(after, held(before) if measure.mounts else before, measure.isolator)
        elif stands.above is not None:
            stands = replace(stands, above=after)
        else:
            stands = Placed(after)
    return stands


def _told_now(scene: Scene) -> Scene:
    """Return what stands on an isolator by its record as on the floor: that which is written down goes under it."""
    if UNTOLD_ISOLATOR not in scene.missing:
        return scene
    missing = tuple(one for one in scene.missing if one != UNTOLD_ISOLATOR)
    return replace(scene, support=Support.FREESTANDING, missing=missing)


def _told(before: Scene, after: Scene, words: str) -> Scene:
    """Say of each number that changed who says so, and drop what was assumed in its place."""
    new = {name: e for name, e in after.parameters.items() if e != before.parameters.get(name)}
    told = {name: replace(e, note=f"{e.note}; {words}" if e.note else words) for name, e in new.items()}
    old = {before.parameters[name].note for name in new if name in before.parameters}
    if after.support is not before.support:
        old |= {text for text in before.assumptions if text.startswith("support: ")}
    kept = tuple(text for text in after.assumptions if text not in old)
    rule = f"{after.rule}{STANDS_AS}{words}" if after.support is not before.support else after.rule
    return replace(after, parameters={**after.parameters, **told}, assumptions=kept, rule=rule)


def assess_above(
    objects: Sequence[Placed],
    levels: Sequence[LevelMotions],
    context: Context,
    numerics: Numerics,
) -> list[tuple[list[Finding], Mapping[str, str]]]:
    """Run what stands on isolators on what these pass on; each isolator is run once, however many stand on it.

    Parameters
    ----------
    objects : sequence of Placed
    levels : sequence of LevelMotions
        The shaking of the floor; an isolator stands in the furniture of its object, which passes that on to it.
    context : Context
        Where models are run.
    numerics : Numerics
        How finely.

    Returns
    -------
    list of (list of Finding, mapping of str to str)
        For each object its findings on the isolator and the models left out there; nothing where it has none.  A
        finding names the motion of the site, and lies on no chart: those are drawn for that motion itself.
    """
    out: list[tuple[list[Finding], Mapping[str, str]]] = [([], {}) for _ in objects]
    groups: dict[tuple[Transfer, FurnitureFilter | None], list[tuple[int, Scene]]] = {}
    for index, one in enumerate(objects):
        if one.above is not None:
            groups.setdefault((one.passing(), filter_of(one.scene)), []).append((index, one.above))
    for (transfer, furniture), members in groups.items():
        passed = [_passed(furnished(level, furniture), transfer) for level in levels]
        for index, above in members:
            found: list[Finding] = []
            skipped: dict[str, str] = {}
            for scene, on_top in _shaken(above, transfer[0]):
                under = passed if on_top else levels
                plan, judged = assess([scene], under, context, numerics)
                # Its furniture is judged with the isolator, which stands in it.
                own = [finding for finding in judged[0] if finding.model != UNANCHORED.name]
                found += [_told_above(finding) for finding in own] if on_top else own
                skipped |= plan.skipped[0]
            out[index] = found, skipped
    return out


def likely(
    objects: Sequence[Placed], levels: Sequence[LevelMotions], sampling: Sampling, context: Context
) -> list[tuple[Likelihood, ...]]:
    """Return how likely objects come to harm as they stand, those on isolators by what these do and pass on.

    Parameters
    ----------
    objects : sequence of Placed
    levels : sequence of LevelMotions
        The shaking of the floor.
    sampling : Sampling
        How many samples, and the words.
    context : Context
        Where they are run.

    Returns
    -------
    list of tuple of Likelihood
        Of each object one for each level.
    """
    return likelihoods(stood_of(objects), len(objects), levels, sampling, context.executor)


def stood_of(objects: Sequence[Placed]) -> list[Stood]:
    """Return the scenes of objects as joint samples shake them: those on isolators by what these do and pass on."""
    stood: list[Stood] = []
    for at, one in enumerate(objects):
        if not one.may_be:
            stood += _stood(at, one, CERTAIN)
        whole, start = fsum(each.chance for each in one.may_be), 0.0
        for number, each in enumerate(one.may_be, start=1):
            end = 1.0 if number == len(one.may_be) else start + each.chance / whole
            stood += _stood(at, each.placed, Kind(each.classes, start, end))
            start = end
    return stood


def _stood(at: int, one: Placed, kind: Kind) -> Iterator[Stood]:
    yield Stood(at, one.scene, kind=kind)
    if one.above is not None:
        passed = one.passing()
        for scene, on_top in _shaken(one.above, passed[0]):
            yield Stood(at, scene, passed if on_top else None, kind)


def _passed(level: LevelMotions, transfer: Transfer) -> LevelMotions:
    kind, parameters = transfer
    given: dict[str, Any] = dict(parameters)
    return level.through(lambda motion: (transmit(kind, motion, **given),))


def _shaken(above: Scene, kind: str) -> list[tuple[Scene, bool]]:
    """Return what of an object is run, and whether under what its isolator passes on, or else as its floor shakes."""
    if kind != "friction_isolator":
        return [(above, True)]
    # On a low-friction pad it slides with the pad, and a low friction never excuses rocking (paper, 2.6): it is asked
    # for by the model that lets nothing slide.
    rocks = (ROCKING.name,) if any(tips(name) for name in above.models) else ()
    rest = tuple(name for name in above.models if not tips(name) and name != SLIDING.name)
    both = [(replace(above, models=rocks), False), (replace(above, models=rest), True)]
    return [(scene, on_top) for scene, on_top in both if scene.models]


def _told_above(finding: Finding) -> Finding:
    return replace(finding, note=f"{finding.note}; {ON_TOP}" if finding.note else ON_TOP)
