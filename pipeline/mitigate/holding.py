"""What holds an object at its base: the force and moment that it must bear, and whether wax or putty does."""

from collections.abc import Sequence
from functools import cache
from itertools import product
from math import pi

import numpy as np

from pipeline.analysis.response import respond
from pipeline.analysis.verdicts import judge
from pipeline.mitigate.bench import Bench
from pipeline.models.stress import FLEXIBLE_STRESS
from pipeline.records import Check, Estimate, Finding, Motion, Origin, Scene, Verdict
from pipeline.tables import Range, spread, table

WAX = "museum wax"
WAX_CHECKS = ("Wax, sideways", "Wax, uplift", "Shaking that wax holds")
"""What wax is asked, in the words of a report."""

LEVER = 2.0 / 3.0
"""Moment about an edge of an elastic layer, per its area, its strength, and its distance from the edge.

The tension grows evenly from the edge to the far side, where it is the strength: the integral of (t x / 2b) x over the
width 2b, by the area, is 2/3 t b.
"""


@cache
def strengths(fixing: str) -> dict[str, Range]:
    """Return the rows of fixings.csv for one fixing, by property.

    raises : TableError for a row whose range is not in order
    """
    rows = [row for row in table("fixings") if row["fixing"] == fixing]
    return {row["property"]: spread(row, "value", "low", "high", f"fixings.csv, {fixing}") for row in rows}


def force_and_moment(scene: Scene, bench: Bench, findings: Sequence[Finding]) -> tuple[float, float]:
    """Return what a fixing at the base must hold: force [N], and moment [N m] without the help of the weight.

    findings : of the object held at its base; a flexible one pushes by its pseudo-acceleration
    """
    bends = any(f.model == FLEXIBLE_STRESS.name for f in findings)
    push = max(bench.push, _pseudo_acceleration(scene, bench)) if bends else bench.push
    force = scene.parameters["mass"].high * push
    return force, force * scene.parameters["cg_height"].high


def _pseudo_acceleration(scene: Scene, bench: Bench) -> float:
    """Return the largest that its oscillator feels [m/s2], in any direction, at all ends of what is uncertain."""
    f, zeta = scene.parameters["frequency"], scene.parameters["damping"]
    ends = [(f.value, zeta.value), *product((f.low, f.high), (zeta.low, zeta.high))]
    frequencies, dampings = [one for one, _ in ends], [other for _, other in ends]

    def largest(motion: Motion) -> float:
        rows = respond("oscillator", motion, angle=None, frequency=frequencies, damping=dampings)
        return float(rows["pseudo_acceleration"].max())

    return bench.most(largest)


def uplift_moment(scene: Scene, bench: Bench) -> tuple[float, float]:
    """Return the largest moment that lifts the base off [N m], the weight holding it down: best, and worst.

    m (|a_h| h - N b) about the nearer edge, over time and in any direction.  It rises with h and falls with b, and
    where it lifts at all it rises with m: the worst is at the high m and h and the low b together.
    """
    p = scene.parameters
    mass, cg, half = p["mass"], p["cg_height"], p["half_width"]

    def moment(m: float, h: float, b: float) -> float:
        def largest(motion: Motion) -> float:
            push, weight = bench.shaken[motion.hash]
            return float(np.max(m * (push * h - weight * b)))

        return max(0.0, bench.most(largest))

    best = moment(mass.value, cg.value, half.value)
    return best, moment(mass.high, cg.high, half.low)


def wax_area(scene: Scene, bench: Bench) -> float:
    """Return the area of wax [m2] that holds the object at the low end of the wax's strength."""
    strength = strengths(WAX)
    shear = scene.parameters["mass"].high * bench.push / strength["shear"].low
    tension = uplift_moment(scene, bench)[1] / (LEVER * scene.parameters["half_width"].low * strength["tension"].low)
    return max(shear, tension)


def footing(scene: Scene) -> float:
    """Return the area of the footing [m2]: a round one across the narrower side, the least that it may be."""
    return pi * scene.parameters["half_width"].low ** 2


def wax_checks(scene: Scene, bench: Bench, area: float) -> tuple[Check, ...]:
    """Return whether an area of wax [m2] holds: sideways, against uplift, and by the published fragility."""
    strength = strengths(WAX)
    mass, half = scene.parameters["mass"], scene.parameters["half_width"]
    moment, worst = uplift_moment(scene, bench)
    sideways_title, uplift_title, shaking_title = WAX_CHECKS
    sideways = (mass.value * bench.push, mass.high * bench.push)
    return (
        _check(sideways_title, sideways, _times(strength["shear"], area, "N")),
        _check(uplift_title, (moment, worst), _times(strength["tension"], LEVER * area * half.low, "N m")),
        _check(shaking_title, (bench.push, bench.push), _times(strength["acceleration"], 1.0, "m/s2")),
    )


def _times(strength: Range, factor: float, unit: str) -> Estimate:
    low, value, high = (factor * end for end in (strength.low, strength.value, strength.high))
    return Estimate(value, unit, Origin.ASSUMED, low, high, source=strength.source)


def _check(title: str, demand: tuple[float, float], capacity: Estimate) -> Check:
    best, worst = demand
    found = judge(best, best, worst, capacity)
    return Check("wax", title, best, capacity.unit, capacity.value, found.utilisation, found.verdict is Verdict.PASS)
