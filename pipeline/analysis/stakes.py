r"""What is at stake where an object comes to harm: what it is worth to the museum, and the people beside it.

The expected loss counts in losses of an object that the museum calls C,

.. math::

    P(\text{harm}) \, w + P(\text{falls}) \, c \, w_p \left(1 - e^{-m g h / E}\right)

with w the weight of its value or class of value, w_p that of a person, c a share for what falls within a closed case,
and m g h the energy of a fall from its centre of gravity to the floor: a roll of bread of 12 g hurts nobody, and a
sculpture of 11 t anybody.  Weights are rows of tables/stakes.csv.
"""

from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, replace
from enum import StrEnum
from functools import cache
from math import exp

from pipeline.analysis.furniture import SHELF_HEIGHT
from pipeline.analysis.told import SLENDEREST_CLOCK, as_displayed, longcase
from pipeline.quantities import G
from pipeline.records import Assessment, Furniture, Harm, Mount, Scene, Support
from pipeline.tables import Range, table
from pipeline.tables.assumed import assumed
from pipeline.tables.rows import RangeRow, Text, checked

SLENDER = 6.0
"""How many times as high as it is deep what stands by itself may be before its record is to be looked at: judgement.

What is beyond lies, leans, is held, or one of its measures is wrong."""

SLENDER_FIGURE = 9.0
"""The same of statues and figures, which are as slender as people, and mostly on a base of their own."""

_FIGURES = ("statue", "standing_figure")

SLENDER_BOWL = 2.5
"""The same of plates, dishes and bowls: of 157 at the Carnegie Museum of Art all but five are less than 1.75 times as
high as they are deep, and those five are exchanged sides, a plate on its edge, or a digit that is missing."""

_BOWLS = ("dish",)
_BOWL_RULES = ("deep-bowl",)
"""Classes, and rules of others, of what is as broad as a bowl."""


_AIRY = ("mobile", "mobile-wire")
"""Rules of things of sheet and wire with so much air between them that their weight says nothing of their size."""


class Stake(RangeRow):
    """A row of stakes.csv: a weight [-], or an energy [J]."""

    name: Text
    unit: Text


class Term(StrEnum):
    """What an object's worth rests on."""

    CLASS = "class"
    VALUE = "value"
    IRREPLACEABLE = "irreplaceable"
    ON_LOAN = "on loan"


@dataclass(frozen=True, slots=True)
class Worth:
    """What an object is worth to the museum.

    Attributes
    ----------
    weight : float
        In objects that the museum calls C.
    terms : tuple of Term
        What it rests on; none where nothing is recorded.
    """

    weight: float
    terms: tuple[Term, ...]


VALUE_PER_C = "value_per_c"
"""Row of stakes.csv, and key of a run's settings: the money that counts as one object of class C."""

_MONEY: ContextVar[float] = ContextVar("value_per_c", default=0.0)


@contextmanager
def counting(value_per_c: float) -> Iterator[None]:
    """Count money as the museum does, until the end of the block.

    Parameters
    ----------
    value_per_c : float
        What an object of class C is worth in its money; 0 where it does not say it.
    """
    token = _MONEY.set(value_per_c)
    try:
        yield
    finally:
        _MONEY.reset(token)


@cache
def stakes() -> dict[str, Range]:
    """Return the rows of tables/stakes.csv by name."""
    return {row.name: row.range for row in checked(Stake, table("stakes"), "stakes.csv", named="name")}


def worth_of(scene: Scene) -> Worth:
    """Return what an object is worth to the museum, and what that rests on.

    Its value in money where that is recorded, within bounds, else its class of value; more where it is irreplaceable or
    on loan.
    """
    rows, item = stakes(), scene.item
    named = f"class_{item.value_class.strip().lower()}"
    terms: list[Term] = []
    if item.value is not None:
        in_c = item.value / (_MONEY.get() or rows[VALUE_PER_C].value)
        weight = min(max(in_c, rows["value_least"].value), rows["value_most"].value)
        terms.append(Term.VALUE)
    elif named in rows and item.value_class.strip():
        weight = rows[named].value
        terms.append(Term.CLASS)
    else:
        weight = rows["class_unknown"].value
    for recorded, term in ((item.irreplaceable, Term.IRREPLACEABLE), (item.on_loan, Term.ON_LOAN)):
        if recorded:
            weight *= rows[term.name.lower()].value
            terms.append(term)
    return Worth(weight, tuple(terms))


def proportion(scenes: Iterable[Scene]) -> float:
    """Return by how much things are worth an isolator: by class, irreplaceability, and danger to people; 1: just so.

    Money and loans do not count here: what is advised for an object does not change with the rate of insurance.
    """
    rows, total = stakes(), 0.0
    for scene in scenes:
        plain = replace(scene, item=replace(scene.item, value=None, on_loan=None))
        total += worth_of(plain).weight + danger_of(scene)
    return total / rows["isolator"].value


def value_of(scene: Scene) -> float:
    """Return what an object is worth to the museum, in objects that it calls C."""
    return worth_of(scene).weight


def danger_of(scene: Scene) -> float:
    """Return what its fall is to the people beside it, in objects that the museum calls C.

    It falls from as high as its centre of gravity lies above the floor on which people stand: that above its base, and
    that of the furniture that it stands on.
    """
    mass, height = (scene.parameters.get(name) for name in ("mass", "cg_height"))
    if mass is None:
        return 0.0
    rows = stakes()
    high = rows["hung_height"].value if height is None else height.value + _stands_at(scene)
    share = rows["in_a_case"].value if scene.furniture is Furniture.SHOWCASE else 1.0
    return share * rows["person"].value * (1.0 - exp(-mass.value * G * high / rows["energy"].value))


def _stands_at(scene: Scene) -> float:
    """Return the height of what an object stands on above the floor [m]."""
    known = scene.parameters.get(SHELF_HEIGHT)
    if known is not None:
        return known.value
    row = None if scene.furniture is None else assumed().furniture.get(scene.furniture.value)
    return 0.0 if row is None or row.shelf_height is None else row.shelf_height


def expected_loss(assessment: Assessment) -> float:
    """Return what is lost on average, in objects that the museum calls C, at the level that decides.

    Parameters
    ----------
    assessment : Assessment
        Of an object; of one whose likelihood nobody knows nothing is expected.

    Returns
    -------
    float
        See the formula at the top of this module.
    """
    found = assessment.likelihood
    if found is None:
        return 0.0
    falls = found.states.get(Harm.FALLS.value, 0.0)
    return found.probability * value_of(assessment.scene) + falls * danger_of(assessment.scene)


def to_check(assessment: Assessment) -> bool:
    """Say whether the record of an object is to be checked before anything is done about it."""
    scene = assessment.scene
    return assessment.likelihood is not None and (doubtful(scene) > 0.0 or ill_weighed(scene))


def ill_weighed(scene: Scene) -> bool:
    """Say whether the recorded mass and sizes cannot both be true: what is built for them would not fit the object."""
    airy = scene.rule.partition(":")[0] in _AIRY
    return scene.item.mass_kg is not None and not airy and any(one.field == "mass_kg" for one in scene.item.problems)


def doubtful(scene: Scene) -> float:
    """Return how many times as high as it is deep an object is whose record is to be looked at first; else 0.

    One whose base or whose support is recorded stands as it is; what lies, leans or is held does not stand at all.
    """
    item = scene.item
    if scene.mount not in (None, Mount.STANDING):
        return 0.0
    sides = [side for side in (item.width_m, item.depth_m) if side]
    # What its words for the display say counts as recorded: a report is made from the record as it was read.
    said = as_displayed(item).support is not None
    if scene.support is not Support.FREESTANDING or said or not item.height_m or not sides:
        return 0.0
    if item.base_width_m or item.base_depth_m or item.contact_polygon or item.tilt_angle_deg is not None:
        return 0.0
    ratio = item.height_m / min(sides)
    return ratio if ratio >= _slenderest(scene) else 0.0


def _slenderest(scene: Scene) -> float:
    if scene.object_class in _BOWLS or scene.rule.partition(":")[0] in _BOWL_RULES:
        return SLENDER_BOWL
    if longcase(scene.item, scene.object_class):
        return SLENDEREST_CLOCK
    return SLENDER_FIGURE if scene.object_class in _FIGURES else SLENDER
