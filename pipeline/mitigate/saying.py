"""What is said besides the sentence of a measure: what comes first, who does it, and what is to be found out before."""

import re

from pipeline.analysis.furniture import row_of_loads
from pipeline.analysis.told import held_as_displayed
from pipeline.mitigate.measures import Measure
from pipeline.mitigate.measures.base import knows_section
from pipeline.mitigate.measures.clearance import FOURFOLD, FOURFOLD_IN_CASE, TWICE, TWICE_IN_CASE, hung_by
from pipeline.mitigate.measures.fixings import FINISHED, finishes, on_glass
from pipeline.mitigate.proposals import STANDING, Candidate, Deficiency, Numbers
from pipeline.mitigate.trials import TrialRunner
from pipeline.quantities import G
from pipeline.records import Estimate, Furniture, Mount, Origin, Scene
from pipeline.records import phrases as say
from pipeline.tables import Range
from pipeline.tables.assumed import AssumedValues
from pipeline.tables.limit_rows import limit

ONLY_HERE = "At another level of shaking it is not enough, and nothing that was tried is enough at all of them."
"""Follows the sentence of a measure that holds at one level only."""

AT_BEST = (
    "It holds by the best estimates, and not at the worse ends of all that is assumed: "
    "have its mass, its base and its weakest section measured first."
)
"""Follows the sentence of a measure whose models pass by the best estimates only."""

SIZED = "It holds so by the best estimates of weight, base and strength: weigh it and measure its base first."
"""Follows the sentence of a fixing that has its factor of safety by the best estimates, and whose models all pass."""

AT_BEST_WEIGHED = (
    "It holds by the best estimates, and not at the worse ends of all that is assumed: "
    "have its base and its weakest section measured first."
)
SIZED_WEIGHED = "It holds so by the best estimates of base and strength: measure its base first."
"""The same of what was weighed: nobody weighs it again."""

ONLY_AT_BEST, ONLY_SIZED = (AT_BEST, AT_BEST_WEIGHED), (SIZED, SIZED_WEIGHED)

HEAVIEST = (
    "That is for {heaviest}, the most that it may weigh; by the best estimate it weighs {weight}: "
    "weigh it first: if it is lighter, the mount may be lighter in proportion."
)
"""Follows the sentence of a measure that is built for a force, where its mass is assumed and may be twice the best."""

OF_MEAN = "That is for the mean of the earthquakes: in the worst of them it moves {worst}."
"""Follows the sentence of a measure that gives room, where the mean of the motions of a level decides."""

UPPER_FIRST = "First fix each upper body to the one that it stands on: loose, it falls sooner than all together."
"""Comes before the sentence of a measure for two bodies and more that are followed as one."""

EACH_PIECE = "Do it for each of its pieces: what follows is worked out for all of them as one body."
"""The same for pieces that stand beside each other and are followed as one."""

HELD_FIRST = (
    "First record the brace, clips or ties that its record tells of as installed: until then they do not count."
)
"""Comes before the sentence of a measure for what is held by more than its base, as the words for its display say."""

UNWEIGHED = 2.0
"""Largest over best estimate of an assumed mass from which on whoever builds for a force is told so."""

STANDS_ON = "See that what it stands on is fastened itself: nobody says that it is."
"""Follows the sentence of a measure that fixes as much to furniture of which nobody says whether it is fastened."""

ENGINEERED = 1780.0
"""Force [N] from which on a fixing is no mount-maker's: 400 lb.

ASCE 7-16, sec. 13.1.4, asks for no design of components on the floor up to that weight, and FEMA E-74 (2012) gives
details for anybody to follow up to it, and an engineer's beyond.
"""

ENGINEER = (
    "Have an engineer design this: it is more than a mount-maker's fixing, and more than a plinth, a case, a floor or "
    "a wall is known to take."
)
"""Comes before the sentence of a measure whose force is beyond that."""

TOO_MUCH = (
    "That is more than such furniture is known to take: have it fixed to a board or a frame over its whole width, or "
    "stand it elsewhere."
)
"""Follows the sentence of a measure that asks more of a case, a plinth or a shelf than that takes (furniture.csv)."""

PERHAPS_TOO_MUCH = "Light furniture of this kind cannot take that: see first what it is made of."
"""Follows the sentence of a measure that asks for more than the low end of what its furniture takes."""

ON_GLASS = (
    "It stands on glass, into which nothing is screwed: have the mount hold on to the edges of its shelf, or stand it "
    "on a solid deck."
)
"""Follows the sentence of a mount that is made for what stands on glass."""

LID = "Its lid lies loose: hold that too, by dots of wax or a tie."
"""Follows the sentence of a measure for what has a lid and is told to be held."""

UNSEEN = "Nobody knows its weakest part: whoever makes the mount must see that it bears that."
"""Follows the sentence of a measure that holds an open frame, whose weakest section is not known."""

CREEPS = "So heavy a thing creeps on it: look at it twice a year, and hold it otherwise once it has moved."
"""Follows the sentence of a measure that sticks down what some would trust to no wax (limits.csv, stuck_mass)."""

IN_WARMTH = "Wax and putty give way in warmth: not under hot lamps, and not in the sun."
"""Follows the sentence of a measure that sticks something down."""

BY_HAND = "Try by hand whether it holds: where it gives, use more."
"""Follows the sentence of dots under what is so light that more of them cost less than to weigh it."""

SAID_AS_IT_IS = (
    TOO_MUCH, PERHAPS_TOO_MUCH, STANDS_ON, ON_GLASS, LID, UNSEEN, CREEPS, IN_WARMTH, BY_HAND, TWICE, FOURFOLD,
    TWICE_IN_CASE, FOURFOLD_IN_CASE,
)  # fmt: skip
"""Of what follows the ones that a page says as they are."""

ANCHORED = "Fasten what it stands in to the floor or a wall first."
"""Comes before the sentence of a measure that is enough only where its furniture is fastened too."""

_LIDDED = re.compile(
    r"\b(?:with (?:\w+ )?(?:lid|cover)|and (?:lid|cover)|lidded|covered|mit deckel|deckel(?:vase|dose|pokal|krug)|"
    r"avec couvercle|con coperchio|coperchiat[ao]|con tapa|com tampa|met deksel|cu capac|με καπάκι)\b|蓋付|共蓋",
    re.IGNORECASE,
)
"""What says that a vessel has a lid."""

_WITH_LIDS = frozenset({"vessel", "stemmed_glass", "dish", "object"})


def said_besides(
    measure: Measure,
    candidate: Candidate,
    one: Deficiency,
    numbers: Numbers,
    runner: TrialRunner,
    *,
    at_best: bool,
) -> tuple[tuple[str, ...], tuple[str, ...], dict[str, tuple[float, str]]]:
    """Return what is said before and after the sentence of a measure, and the numbers that these ask for.

    Parameters
    ----------
    measure, candidate : Measure, Candidate
        What is advised.
    one : Deficiency
        The object.
    numbers : mapping of str to (float, str)
        Those of the recommendation.
    runner : TrialRunner
        The shaking.
    at_best : bool
        Whether its models pass by the best estimates only.
    """
    scene, values = one.scene, runner.values
    mass = scene.parameters.get("mass")
    first: list[str] = []
    more: list[str] = []
    added: dict[str, tuple[float, str]] = {}
    if held_as_displayed(scene.item, scene.support):
        first.append(HELD_FIRST)
    if {say.TWO_BODIES(), say.STACKED()} & set(scene.assumptions):
        first.append(UPPER_FIRST)
    if say.PIECES() in scene.assumptions:
        first.append(EACH_PIECE)
    asked, takes = _asked(measure, scene, numbers), _takes(scene, values)
    if asked >= ENGINEERED:
        first.append(ENGINEER)
    elif takes is not None and asked >= takes.low:
        more.append(TOO_MUCH if asked >= takes.value else PERHAPS_TOO_MUCH)
    if measure.for_room:
        more.append(hung_by(scene).strip())
    more += [said for said, holds in _besides(measure, scene, values) if holds]
    if measure.for_room and "clearance" in numbers and any(level.of_mean for level in runner.levels):
        worst = runner.farthest(scene)
        if worst > numbers.get("movement", (0.0, "m"))[0]:
            added["worst"] = (worst, "m")
            more.append(OF_MEAN)
    # The force on pieces is told by the best estimate of its mass, their number by the worst.
    if "force" in numbers and "pieces" not in numbers and mass is not None and _unweighed(mass):
        added |= {"heaviest": (mass.high, "kg"), "weight": (mass.value, "kg")}
        more.append(HEAVIEST)
    if at_best or candidate.at_best:
        light = measure.sticks and mass is not None and mass.high <= limit("slight_mass").value
        weighed = mass is not None and mass.origin is not Origin.ASSUMED
        more.append(ONLY_AT_BEST[weighed] if at_best else BY_HAND if light else ONLY_SIZED[weighed])
    return tuple(first), tuple(filter(None, more)), added


def _besides(measure: Measure, scene: Scene, values: AssumedValues) -> tuple[tuple[str, bool], ...]:
    """Return what may follow the sentence of a measure that touches an object, each with whether it holds."""
    item, stands = scene.item, scene.support in STANDING
    mass = scene.parameters.get("mass")
    heavy = mass is not None and mass.value >= limit("takes_along").value
    on_furniture = scene.furniture not in (None, Furniture.FLOOR) and scene.anchorage is None
    made = measure.fastens and not measure.sticks and stands and scene.mount in (None, Mount.STANDING)
    frame = made and scene.mount is None and not knows_section(scene)
    lidded = scene.object_class in _WITH_LIDS and _LIDDED.search(f"{item.object_name} {item.title} {item.medium}")
    return (
        (IN_WARMTH, measure.sticks),
        (CREEPS, measure.sticks and mass is not None and mass.value >= limit("stuck_mass").low),
        (FINISHED, measure.touches and stands and bool(finishes(item, values))),
        (ON_GLASS, made and on_glass(item)),
        (UNSEEN, frame),
        (LID, measure.fastens and bool(lidded)),
        (STANDS_ON, measure.fastens and stands and heavy and on_furniture),
    )


def _asked(measure: Measure, scene: Scene, numbers: Numbers) -> float:
    """Return the force [N] that a measure asks of its fixings, the larger one of sideways and upwards.

    By the best estimate of its mass: of what nobody weighed the most that it may weigh says nothing of who does it.
    """
    mass = scene.parameters.get("mass")
    if "times" in numbers and mass is not None:
        # A mount that holds a thing in any direction is told in times its weight.
        return numbers["times"][0] * mass.value * G
    if "force" not in numbers:
        return 0.0
    force, _ = numbers["force"]
    share = mass.value / mass.high if mass is not None and "pieces" not in numbers and mass.high > 0.0 else 1.0
    half = scene.parameters.get("half_width")
    pull = 0.0
    if measure.fastens and "moment" in numbers and half is not None and half.value > 0.0:
        # The pieces on the one side of the base pull what those on the other press.
        pull = numbers["moment"][0] / (2.0 * half.value)
    return max(force, pull) * share


def _takes(scene: Scene, values: AssumedValues) -> Range | None:
    """Return the force [N] that what an object stands on takes; None where nothing is known against it."""
    row = None if scene.furniture is None else values.furniture.get(scene.furniture.value)
    return row_of_loads(row).range("takes") if row is not None and scene.support in STANDING else None


def _unweighed(mass: Estimate) -> bool:
    return mass.origin is Origin.ASSUMED and mass.high >= UNWEIGHED * mass.value
