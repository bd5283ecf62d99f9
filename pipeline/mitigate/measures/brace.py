r"""A brace that holds a tall object at or above its middle as well as at its base.

A bar of height L, fixed at its base and held at a height a as well, under an even push w along it, bears most either
at its base or at the brace,

.. math::

    M = \max\left(\frac{w (L - a)^2}{2}, \left|\frac{w a^2}{8} - \frac{w (L - a)^2}{4}\right|\right)
      \le \frac{1}{4} \, \frac{w L^2}{2} \qquad \text{for } a \ge L / 2

a quarter of what it bears at its base where nothing else holds it.  Its lowest natural frequency rises by
(3.927 / 1.875)^2 = 4.39 where the brace is at its top.  A brace gives, and a figure is no even bar: the quarter may be
a half, and the factor on the frequency 2.

Held at two heights, 0.4 and 0.8 of its own, it bears most where it stands out beyond the upper one,

.. math:: M = \frac{w (0.2 L)^2}{2} = 0.04 \, \frac{w L^2}{2}

and its lowest natural frequency is 12 times as high; neither contact bears more than 0.43 of the push.

References
----------
Blevins, R. D. (1979). Formulas for natural frequency and mode shape. Van Nostrand Reinhold. Table 8-1: fixed and free,
fixed and held.
"""

from collections.abc import Mapping
from typing import ClassVar

from pipeline.mitigate.measures.base import (
    NOT_FREE,
    UNKNOWN_SECTION,
    Measure,
    held,
    knows_section,
    with_parameters,
)
from pipeline.mitigate.proposals import Candidate, Deficiency, Proposal, refused
from pipeline.mitigate.trials import Trial, TrialRunner
from pipeline.models.common import N_
from pipeline.records import Estimate, Scene, Support
from pipeline.records import phrases as say
from pipeline.tables.limit_rows import BRACED, HELD_ABOVE, ends_of

LEVER, AT_TWO = ends_of("braced_bending"), (0.04, 0.08, 0.2)
"""Bending over that without the brace, held at one height and at two: low, best, high.

The best of the one is the bound of an even bar, and the low end of the other; the others are judgement.
"""

STIFFER, STIFFER_AT_TWO = ends_of("braced_stiffness"), (3.0, 5.0, 12.0)
"""Factor on its lowest natural frequency: low, best, high; the last is of an even bar, the others judgement."""

ABOVE, BELOW, TOP = 1.2, 0.8, 1.6
"""Heights of the brace, and of the lower and the upper of two, over that of the centre of gravity."""


class Brace(Measure):
    """Brace it from behind at or above its middle, and hold its base: it neither rocks nor slides, and bends less."""

    name = "brace"
    gives: ClassVar[tuple[str, ...]] = ("force", "height")
    limits = 1
    limit_unit = "m"
    fastens = True
    touches = True
    bending, stiffer = LEVER, STIFFER
    heights: ClassVar[tuple[float, ...]] = (ABOVE,)

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:  # noqa: ARG002
        """Return it held at its base, its section bending a quarter as much, and swaying faster."""
        scene = held(scene)
        found = {"lever": _braced(scene.parameters["lever"], self.bending, LEVER)}
        if "frequency" in scene.parameters:
            found["frequency"] = _braced(scene.parameters["frequency"], self.stiffer, STIFFER)
        return with_parameters(scene, **found)

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose a brace for the push of its mass."""
        scene = one.scene
        # What is fastened at its base may be held above its middle as well.
        if scene.mount is not None or scene.support not in (Support.FREESTANDING, Support.FASTENED):
            return NOT_FREE
        if self.row.classes and scene.object_class not in self.row.classes:
            return refused(N_("objects of its kind cannot be braced so"))
        note = scene.parameters["lever"].note if "lever" in scene.parameters else ""
        # What its record says to be held above its base at one height may be held at two.
        if BRACED in note or (HELD_ABOVE in note and len(self.heights) == 1):
            return refused(N_("it is braced already"))
        if not knows_section(scene) or "cg_height" not in scene.parameters:
            return UNKNOWN_SECTION
        # Twice the height of the centre of gravity, where the height itself is not recorded.
        tall = scene.item.height_m or 2.0 * scene.parameters["cg_height"].value
        if tall < self.row.limit:
            return refused(say.TOO_LOW_TO_BRACE(height=self.row.limit))
        cg = scene.parameters["cg_height"].value
        numbers = {"force": (scene.parameters["mass"].high * runner.push, "N")}
        numbers |= {name: (at * cg, "m") for name, at in zip(self.gives[1:], self.heights, strict=True)}
        trial = Trial(self.in_place(one, numbers))
        return Proposal(tuple(Candidate(numbers, (trial,), at_best=at_best) for at_best in (False, True)))


class Armature(Brace):
    """Hold it along its back at two heights, and at its base: it neither rocks nor slides, and hardly bends."""

    name = "armature"
    gives = ("force", "height", "second")
    bending, stiffer = AT_TWO, STIFFER_AT_TWO
    heights = (BELOW, TOP)


def _braced(estimate: Estimate, factors: tuple[float, float, float], once: tuple[float, float, float]) -> Estimate:
    """Return an estimate with a brace; once: the factors that it has already where it is held above its base."""
    if HELD_ABOVE in estimate.note:
        low, best, high = (factor / one for factor, one in zip(factors, once, strict=True))
    else:
        low, best, high = factors
    return estimate.times(low, best, high, ", ".join(filter(None, (estimate.note, BRACED))))
