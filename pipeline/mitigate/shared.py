"""Measures on a support that several objects may share: an isolator under a plinth or a case."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from math import isfinite

from pipeline.mitigate.bench import Bench, Carried, Trial
from pipeline.mitigate.changes import held, knows_section
from pipeline.mitigate.means import Measure
from pipeline.mitigate.measures import MARGIN, on_floor, up
from pipeline.mitigate.offers import Need, Offer, Proposal, Way, refused
from pipeline.records import Scene, Support

Share = Callable[[Sequence[Need], Bench, Measure], Proposal]

STANDING = (Support.FREESTANDING, Support.FASTENED, Support.ISOLATED)

FREE, FASTENED = "It may stand free on it.", "It must be fastened to it."
"""How an object stands on an isolator."""

IT = "it"
"""What is put on an isolator where nothing shares it."""

NAMED = 12
"""Objects of a case that a sentence names; of more it says how many."""


def case_of(scene: Scene) -> tuple[str, str] | None:
    """Return the plinth or case that a standing object shares, None where it is not recorded."""
    item = scene.item
    return (item.gallery, item.case) if item.case.strip() and scene.support in STANDING else None


def horizontal_isolator(unit: Sequence[Need], bench: Bench, measure: Measure) -> Proposal:
    """Put what they stand on onto a horizontal isolator: the shortest stroke that keeps each standing and whole.

    A stiff isolator passes much on and needs little stroke, a soft one the other way round, and friction trades the
    one for the other as well: of the catalogue those are tried that keep to the stroke that the place has, by the
    length of their stroke.  Each object on it stands as it does, or where that fails is fastened to it; all its
    models are run on what the isolator passes on.
    """
    for need in unit:
        refusal = _standing(need.scene)
        if refusal:
            return refused(refusal if len(unit) == 1 else f"{need.number} shares its case: {refusal}")
    offers = []
    for carried in bench.carried("horizontal_isolator"):
        isolator = carried.isolator
        stroke = up(MARGIN * carried.stroke)
        if stroke > min(measure.limit, isolator.stroke):
            continue
        numbers = {
            "frequency": (isolator.frequency, "Hz"),
            "damping": (isolator.damping, "-"),
            "friction": (isolator.friction, "-"),
            "stroke": (stroke, "m"),
            "acceleration": (carried.acceleration, "m/s2"),
        }
        moving = on_floor(unit[0], measure, numbers)
        stands = tuple((need, _ways(need.scene, carried)) for need in unit)
        marks = {level: ("isolator", isolator.frequency, felt) for level, felt in carried.accelerations.items()}
        offers.append(Offer(numbers, (Trial(moving),), stands, marks=marks))
    if not offers:
        longest = f" and none under {100 * measure.limit:.0f} cm" if isfinite(measure.limit) else ""
        return refused(f"the catalogue has no horizontal isolator that keeps to its stroke{longest}")
    among = f" for all {len(unit)} objects of its case" if len(unit) > 1 else ""
    return Proposal(tuple(offers), f"no isolator of the catalogue passes on little enough within its stroke{among}")


def _standing(scene: Scene) -> str:
    if scene.support not in STANDING:
        return "it does not stand"
    if {"stroke", "rotation_limit"} & set(scene.parameters):
        # The frequency and the damping are the isolator's then, and its own are not at hand.
        return "it stands on an isolator already: have that one changed"
    if not knows_section(scene) and not _can_stand(scene):
        return "neither its base nor its critical section is known"
    return ""


def _can_stand(scene: Scene) -> bool:
    known = {"half_width", "cg_height", "friction_static"} <= set(scene.parameters)
    return scene.support is Support.FREESTANDING and known


def _ways(scene: Scene, carried: Carried) -> tuple[Way, ...]:
    ways = []
    if _can_stand(scene):
        ways.append(Way(Trial(replace(scene), carried), FREE))
    if knows_section(scene):
        ways.append(Way(Trial(held(scene), carried), FASTENED))
    return tuple(ways)


def company(unit: Sequence[Need], need: Need, unknown: Sequence[str]) -> str:
    """Say what is put on the isolator: the object, or its case with the others in it.

    unknown : numbers of objects in the case that could not be assessed
    """
    if case_of(need.scene) is None:
        return IT
    others = [other.number for other in unit if other is not need]
    with_ = f", with {listed(others)} in it," if others else ""
    open_ = f" (not checked: {listed(unknown)})" if unknown else ""
    return f"case {need.scene.item.case.strip()}{with_}{open_}"


def listed(numbers: Sequence[str]) -> str:
    """Return "A, B and C"; of many the first, and how many more."""
    shown = list(numbers[:NAMED])
    if len(numbers) > NAMED:
        shown.append(f"{len(numbers) - NAMED} more")
    return shown[0] if len(shown) == 1 else f"{', '.join(shown[:-1])} and {shown[-1]}"


SHARED: Mapping[str, Share] = {"horizontal_isolator": horizontal_isolator}
"""What each row of measures.csv that acts on a support proposes for all that stand on it."""
