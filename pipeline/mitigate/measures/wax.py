"""Museum wax or putty under an object: how much holds it, and whether there is room for it."""

from collections.abc import Mapping
from functools import cache, partial
from math import pi
from typing import Literal

import numpy as np

from pipeline.analysis.verdicts import judge
from pipeline.mitigate.measures.base import NOT_FREE, UNKNOWN_SECTION, Measure, held, knows_section, round_up
from pipeline.mitigate.measures.fixings import HOLDS, force_and_moment
from pipeline.mitigate.proposals import Deficiency, Proposal, refused
from pipeline.mitigate.trials import TrialRunner
from pipeline.quantities import G
from pipeline.records import Check, Estimate, Motion, Origin, Scene, Support, Verdict
from pipeline.tables import Range, table
from pipeline.tables.rows import RangeRow, Text, checked

WAX = "museum wax"
CHECKS = ("Wax, sideways", "Wax, uplift", "Shaking that wax holds")
"""What wax is asked, in the words of a report."""

LEVER = 2.0 / 3.0
"""Moment about an edge of an elastic layer, per its area, its strength, and its distance from the edge.

The tension grows evenly from the edge to the far side, where it is the strength: the integral of (t x / 2b) x over the
width 2b, by the area, is 2/3 t b.
"""


class Wax(Measure):
    """Hold it by museum wax: it neither rocks nor slides while the wax holds, and its section bears the push.

    References
    ----------
    Agbabian et al. (1991), sec. 2.3 (held at its base); strengths: tables/fixings.csv.
    """

    name = "wax"
    gives = ("area", *HOLDS)
    limits = 1
    limit_unit = "-"
    phrases = CHECKS

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:  # noqa: ARG002
        """Return it held at its base."""
        return held(scene)

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose the area of wax that holds it at the low end of the wax's strength."""
        scene = one.scene
        if scene.support is not Support.FREESTANDING:
            return NOT_FREE
        if not knows_section(scene) or not {"half_width", "cg_height"} <= set(scene.parameters):
            return UNKNOWN_SECTION
        held_up_to = strengths(WAX)["acceleration"].low
        if runner.push > held_up_to:
            return refused(f"wax is known to hold up to {held_up_to / G:.2g} g; the shaking is {runner.push / G:.2g} g")
        area, room = round_up(wax_area(scene, runner), 1e-5), self.row.limit * footing(scene)
        if area > room:
            return refused(f"it would need {1e4 * area:.3g} cm2 of wax; its footing has room for {1e4 * room:.3g} cm2")
        finish = partial(force_and_moment, scene, runner)
        checks = tuple(("", check) for check in wax_checks(scene, runner, area))
        return self.one_trial(one, {"area": (area, "m2")}, finish=finish, checks=checks)


class FixingStrength(RangeRow):
    """A row of fixings.csv: a strength of a fixing, in the unit of its column."""

    fixing: Text
    property: Literal["tension", "shear", "acceleration"]
    unit: Literal["Pa", "m/s2"]


@cache
def strengths(fixing: str) -> dict[str, Range]:
    """Return the rows of fixings.csv for one fixing, by property.

    Raises
    ------
    TableError
        For a row that cannot be used.
    """
    rows = checked(FixingStrength, table("fixings"), "fixings.csv", named="fixing")
    return {row.property: row.range for row in rows if row.fixing == fixing}


def uplift_moment(scene: Scene, runner: TrialRunner) -> tuple[float, float]:
    """Return the largest moment that lifts the base off [N m], the weight holding it down: best, and worst.

    Notes
    -----
    m (|a_h| h - N b) about the nearer edge, over time and in any direction.  It rises with h and falls with b, and
    where it lifts at all it rises with m: the worst is at the high m and h and the low b together.
    """
    p = scene.parameters
    mass, cg, half = p["mass"], p["cg_height"], p["half_width"]

    def moment(m: float, h: float, b: float) -> float:
        def largest(motion: Motion) -> float:
            push, weight = runner.shaken[motion.hash]
            return float(np.max(m * (push * h - weight * b)))

        return max(0.0, runner.largest(largest))

    best = moment(mass.value, cg.value, half.value)
    return best, moment(mass.high, cg.high, half.low)


def wax_area(scene: Scene, runner: TrialRunner) -> float:
    """Return the area of wax [m2] that holds the object at the low end of the wax's strength."""
    strength = strengths(WAX)
    shear = scene.parameters["mass"].high * runner.push / strength["shear"].low
    tension = uplift_moment(scene, runner)[1] / (LEVER * scene.parameters["half_width"].low * strength["tension"].low)
    return max(shear, tension)


def footing(scene: Scene) -> float:
    """Return the area of the footing [m2]: a round one across the narrower side, the least that it may be."""
    return pi * scene.parameters["half_width"].low ** 2


def wax_checks(scene: Scene, runner: TrialRunner, area: float) -> tuple[Check, ...]:
    """Return whether an area of wax [m2] holds: sideways, against uplift, and by the published fragility."""
    strength = strengths(WAX)
    mass, half = scene.parameters["mass"], scene.parameters["half_width"]
    moment, worst = uplift_moment(scene, runner)
    sideways_title, uplift_title, shaking_title = CHECKS
    sideways = (mass.value * runner.push, mass.high * runner.push)
    return (
        _check(sideways_title, sideways, _times(strength["shear"], area, "N")),
        _check(uplift_title, (moment, worst), _times(strength["tension"], LEVER * area * half.low, "N m")),
        _check(shaking_title, (runner.push, runner.push), _times(strength["acceleration"], 1.0, "m/s2")),
    )


def _times(strength: Range, factor: float, unit: str) -> Estimate:
    low, value, high = (factor * end for end in (strength.low, strength.value, strength.high))
    return Estimate(value, unit, Origin.ASSUMED, low, high, source=strength.source)


def _check(title: str, demand: tuple[float, float], capacity: Estimate) -> Check:
    best, worst = demand
    found = judge(best, best, worst, capacity)
    return Check("wax", title, best, capacity.unit, capacity.value, found.utilisation, found.verdict is Verdict.PASS)
