"""Dots of microcrystalline wax or museum putty under an object."""

from math import pi

from pipeline.mitigate.measures.fixings import Fixing, Reach, dot
from pipeline.mitigate.proposals import Deficiency, Proposal, refused
from pipeline.mitigate.trials import TrialRunner
from pipeline.models.common import N_
from pipeline.records import Scene
from pipeline.tables.limit_rows import limit

LEVER = 2.0 / 3.0
"""Moment about an edge of an elastic layer, per its area, its strength, and the distance of its middle from the edge.

The tension grows evenly from the edge to the far side, where it is the strength: the integral of (t x / 2b) x over the
width 2b, by the area, is 2/3 t b.  Three and more equal pieces evenly round a circle of radius r about the middle give
t b (1 + (r/b)^2 / 2) / (1 + r/b), which is never less than 0.73 t b.
"""


class _Dots(Fixing):
    """Dots under its base: they hold by their area, of which its footing has room for a share only."""

    sticks = True
    limits = 1
    limit_unit = "-"

    def reach(self, scene: Scene, pieces: int, size: float, worst: bool) -> Reach:
        """Return the area of the dots, and their moment about an edge of the base."""
        half = scene.parameters["half_width"]
        area = pieces * dot(size)
        return Reach(area, LEVER * area * (half.low if worst else half.value))

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose dots, unless it stands on legs: its footing is taken as one, and there are only their ends."""
        row = runner.values.classes.get(one.scene.object_class)
        if row is not None and row.section == "legs":
            return refused(N_("it stands on legs, which have no room for it under them"))
        if (one.scene.item.height_m or 0.0) > limit("stuck_height").value:
            return refused(N_("it is taller than what is stuck down"))
        mass = one.scene.parameters.get("mass")
        if mass is not None and mass.value > limit("stuck_mass").value:
            return refused(N_("it is heavier than what is stuck down"))
        return super().propose(one, runner)

    def ample(self, scene: Scene) -> bool:
        """Say whether it is so light that nobody weighs it: more dots make up for that."""
        mass = scene.parameters["mass"]
        return mass.low < mass.high <= limit("slight_mass").value

    def room(self, scene: Scene, worst: bool) -> float:
        """Return the share of its footing: a round one across the narrower side, the least that it may be."""
        half = scene.parameters["half_width"]
        return self.row.limit * pi * (half.low if worst else half.value) ** 2


class Wax(_Dots):
    """Hold it by dots of microcrystalline wax."""

    name = "wax"


class Putty(_Dots):
    """Hold it by pads of museum putty."""

    name = "putty"
