r"""A brace that holds a tall object at or above its middle as well as at its base.

A bar of height L, fixed at its base and held at a height a as well, under an even push w along it, bears most either
at its base or at the brace,

.. math::

    M = \max\left(\frac{w (L - a)^2}{2}, \left|\frac{w a^2}{8} - \frac{w (L - a)^2}{4}\right|\right)
      \le \frac{1}{4} \, \frac{w L^2}{2} \qquad \text{for } a \ge L / 2

a quarter of what it bears at its base where nothing else holds it.  Its lowest natural frequency rises by
(3.927 / 1.875)^2 = 4.39 where the brace is at its top.  A brace gives, and a figure is no even bar: the quarter may be
a half, and the factor on the frequency 2.

References
----------
Blevins, R. D. (1979). Formulas for natural frequency and mode shape. Van Nostrand Reinhold. Table 8-1: fixed and free,
fixed and held.
"""

from collections.abc import Mapping

from pipeline.mitigate.measures.base import (
    NOT_FREE,
    UNKNOWN_SECTION,
    Measure,
    held,
    knows_section,
    multiplied,
    with_parameters,
)
from pipeline.mitigate.proposals import Candidate, Deficiency, Proposal, refused
from pipeline.mitigate.trials import Trial, TrialRunner
from pipeline.models.common import N_
from pipeline.records import Estimate, Scene, Support
from pipeline.records import phrases as say

LEVER = (0.15, 0.25, 0.5)
"""Bending over that without the brace: low, best, high; the best is the bound of an even bar, the others judgement."""

STIFFER = (2.0, 3.0, 4.39)
"""Factor on its lowest natural frequency: low, best, high; the last is of an even bar, the others judgement."""

ABOVE = 1.2
"""Height of the brace over that of the centre of gravity: of what is even, 0.6 of the height."""


class Brace(Measure):
    """Brace it from behind at or above its middle, and hold its base: it neither rocks nor slides, and bends less."""

    name = "brace"
    gives = ("force", "height")
    limits = 1
    limit_unit = "m"
    fastens = True
    touches = True

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:  # noqa: ARG002
        """Return it held at its base, its section bending a quarter as much, and swaying faster."""
        scene = held(scene)
        found = {"lever": _braced(scene.parameters["lever"], LEVER)}
        if "frequency" in scene.parameters:
            found["frequency"] = _braced(scene.parameters["frequency"], STIFFER)
        return with_parameters(scene, **found)

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose a brace for the push of its mass."""
        scene = one.scene
        # What is fastened at its base may be held above its middle as well.
        if scene.mount is not None or scene.support not in (Support.FREESTANDING, Support.FASTENED):
            return NOT_FREE
        if self.row.classes and scene.object_class not in self.row.classes:
            return refused(N_("objects of its kind cannot be braced so"))
        if not knows_section(scene) or "cg_height" not in scene.parameters:
            return UNKNOWN_SECTION
        # Twice the height of the centre of gravity, where the height itself is not recorded.
        tall = scene.item.height_m or 2.0 * scene.parameters["cg_height"].value
        if tall < self.row.limit:
            return refused(say.TOO_LOW_TO_BRACE(height=self.row.limit))
        numbers = {
            "force": (scene.parameters["mass"].high * runner.push, "N"),
            "height": (ABOVE * scene.parameters["cg_height"].value, "m"),
        }
        trial = Trial(self.in_place(one, numbers))
        return Proposal(tuple(Candidate(numbers, (trial,), at_best=at_best) for at_best in (False, True)))


def _braced(estimate: Estimate, factors: tuple[float, float, float]) -> Estimate:
    return multiplied(estimate, *factors, f"{estimate.note}, with the brace" if estimate.note else "")
