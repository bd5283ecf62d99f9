"""Pieces of metal or line that hold an object: pins, clips, clamps, brackets, and ties of monofilament."""

import re
from collections.abc import Mapping
from dataclasses import replace
from math import cos, inf, pi

from pipeline.analysis.classify import models_of
from pipeline.mitigate.measures.adhesives import LEVER
from pipeline.mitigate.measures.base import exactly, with_parameters
from pipeline.mitigate.measures.fixings import Fixing, HoldingDemand, Reach
from pipeline.mitigate.proposals import Deficiency, Proposal, refused
from pipeline.mitigate.trials import TrialRunner
from pipeline.models.common import N_
from pipeline.records import Furniture, Scene, Support

BEARING = 0.25
"""Share of the pieces round an object that bear a push at least.

Of four, one where the push goes straight at it; of two between which it goes each bears cos 45 of its strength, which
is more together.
"""

INCLINED = cos(0.25 * pi)
"""Share of the force in a tie at 45 degrees that holds sideways."""

BLOCKED = 2.0
"""Friction that stands for pins round a foot: the most that a model takes."""


class Pins(Fixing):
    """Keep it from sliding by padded pins round its foot: only what does not rock, as they hold nothing down."""

    name = "pins"
    screwed = True

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:  # noqa: ARG002
        """Return it free to rock and not to slide; its section bears the push."""
        blocked = with_parameters(scene, friction_static=exactly(BLOCKED, "-", "pins round its foot: it cannot slide"))
        models = dict.fromkeys((*models_of(Support.FREESTANDING), *models_of(Support.FASTENED), *scene.models))
        return replace(blocked, models=tuple(models))

    def reach(self, scene: Scene, pieces: int, size: float, worst: bool) -> Reach:  # noqa: ARG002
        """Return the pins that bear at a time."""
        return Reach(BEARING * pieces, inf)

    def unsuited(self, scene: Scene, demand: HoldingDemand, worst: bool) -> str:  # noqa: ARG002
        """Say that it may rock."""
        lifts = demand.worst_moment if worst else demand.moment
        return N_("it may rock: pins do not hold it down") if lifts > 0.0 else ""


class _RoundTheBase(Fixing):
    """Pieces evenly round its base, which hold it down and from sliding."""

    def reach(self, scene: Scene, pieces: int, size: float, worst: bool) -> Reach:  # noqa: ARG002
        """Return the pieces that bear at a time, and their moment about an edge of the base."""
        half = scene.parameters["half_width"]
        return Reach(BEARING * pieces, LEVER * pieces * (half.low if worst else half.value))


class Clips(_RoundTheBase):
    """Hold its foot by padded clips bent over it."""

    name = "clips"
    screwed = True


class Clamps(_RoundTheBase):
    """Clamp its base by padded clamps."""

    name = "clamps"
    screwed = True


class Ties(Fixing):
    """Tie it down to all sides by monofilament at about its centre of gravity, to eyes in what it stands on."""

    name = "ties"
    screwed = True
    at_foot = False

    def reach(self, scene: Scene, pieces: int, size: float, worst: bool) -> Reach:  # noqa: ARG002
        """Return the ties that pull at a time, and their moment about the base."""
        cg = scene.parameters["cg_height"]
        pulls = BEARING * INCLINED * pieces
        return Reach(pulls, pulls * (cg.low if worst else cg.value))


FLAT_BACKED = 0.8
"""Depth over width up to which a thing has a back that a wall is behind: judgement.

A globe and a telescope on its tripod are as deep as wide, and stand in the room."""

CASES = "cabinet"
"""Class of what stands at a wall whatever its plan."""

_AT_A_WALL = re.compile(
    r"\b(?:against|at|to|along) (?:\w+ ){0,2}wall|an der Wand|contre le mur|contro (?:la )?(?:parete|il muro)|"
    r"contra la pared|tegen de muur|壁際",
    re.IGNORECASE,
)
"""What says of a display that a wall is behind it."""


_IF_TOLD = ("table", "object")
"""Classes of which some stand at a wall, where their display says so: consoles, pier tables, presses (judgement)."""


class Brackets(Fixing):
    """Fix its top to the wall behind it."""

    name = "brackets"
    at_foot = False

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose them for what stands on the floor: the back of a case, a pedestal or a shelf is no wall."""
        if one.scene.support is Support.FREESTANDING and one.scene.furniture not in (None, Furniture.FLOOR):
            return refused(N_("it does not stand on the floor, at a wall that it could be fixed to"))
        sides = (one.scene.item.width_m, one.scene.item.depth_m)
        deep = all(sides) and (sides[1] or 0.0) > FLAT_BACKED * (sides[0] or 0.0)
        if deep and one.scene.object_class != CASES and not _AT_A_WALL.search(one.scene.item.displayed):
            return refused(N_("it is about as deep as wide: nothing says that it stands at a wall"))
        return super().propose(one, runner)

    def suits(self, scene: Scene) -> bool:
        """Say whether it is of a class that stands at a wall, or of one that may and is said to."""
        told = scene.object_class in _IF_TOLD and _AT_A_WALL.search(scene.item.displayed) is not None
        return told or super().suits(scene)

    def reach(self, scene: Scene, pieces: int, size: float, worst: bool) -> Reach:  # noqa: ARG002
        """Return all of them, and their moment about the base."""
        cg = scene.parameters["cg_height"]
        # Twice the height of the centre of gravity, where the height itself is not recorded.
        top = scene.item.height_m or 2.0 * (cg.low if worst else cg.value)
        return Reach(float(pieces), pieces * top)
