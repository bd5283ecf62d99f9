r"""What is at stake where an object comes to harm: what it is worth to the museum, and the people beside it.

The expected loss counts in losses of an object that the museum calls C,

.. math::

    P(\text{harm}) \, w + P(\text{falls}) \, w_p \left(1 - e^{-m g h / E}\right)

with w the weight of its class of value, w_p that of a person, and m g h the energy of a fall from its centre of gravity
to what it stands on: a roll of bread of 12 g hurts nobody, and a sculpture of 11 t anybody.  Weights are rows of
tables/stakes.csv.
"""

from functools import cache
from math import exp

from pipeline.quantities import G
from pipeline.records import Assessment, Harm, Scene, Support
from pipeline.tables import Range, table
from pipeline.tables.rows import RangeRow, Text, checked

SLENDER = 6.0
"""How many times as high as it is deep what stands by itself may be before its record is to be looked at: judgement.

What is beyond lies, leans, is held, or one of its measures is wrong."""

SLENDER_FIGURE = 9.0
"""The same of statues and figures, which are as slender as people, and mostly on a base of their own."""

_FIGURES = ("statue", "standing_figure")


class Stake(RangeRow):
    """A row of stakes.csv: a weight [-], or an energy [J]."""

    name: Text
    unit: Text


@cache
def stakes() -> dict[str, Range]:
    """Return the rows of tables/stakes.csv by name."""
    return {row.name: row.range for row in checked(Stake, table("stakes"), "stakes.csv", named="name")}


def value_of(scene: Scene) -> float:
    """Return what an object is worth to the museum, in objects that it calls C."""
    rows = stakes()
    return rows.get(f"class_{scene.item.value_class.strip().lower()}", rows["class_unknown"]).value


def danger_of(scene: Scene) -> float:
    """Return what its fall is to the people beside it, in objects that the museum calls C."""
    mass, height = (scene.parameters.get(name) for name in ("mass", "cg_height"))
    if mass is None:
        return 0.0
    # What hangs falls from about the height of eyes.
    high = 1.5 if height is None else height.value
    return stakes()["person"].value * (1.0 - exp(-mass.value * G * high / stakes()["energy"].value))


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


def doubtful(scene: Scene) -> float:
    """Return how many times as high as it is deep an object is whose record is to be looked at first; else 0.

    One whose base or whose support is recorded stands as it is.
    """
    item = scene.item
    sides = [side for side in (item.width_m, item.depth_m) if side]
    if scene.support is not Support.FREESTANDING or item.support is not None or not item.height_m or not sides:
        return 0.0
    if item.base_width_m or item.base_depth_m or item.contact_polygon or item.tilt_angle_deg is not None:
        return 0.0
    ratio = item.height_m / min(sides)
    return ratio if ratio >= (SLENDER_FIGURE if scene.object_class in _FIGURES else SLENDER) else 0.0
