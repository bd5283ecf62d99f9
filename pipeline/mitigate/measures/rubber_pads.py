"""Rubber pads behind a painting, which damp its swing."""

from collections.abc import Mapping, Sequence

from pipeline.analysis.masses import unframed
from pipeline.analysis.scene_parameters import material_of
from pipeline.mitigate.measures.base import DAMPING, Measure, exactly, movement, with_parameters
from pipeline.mitigate.proposals import Deficiency, Proposal, known_to_swing, refused
from pipeline.mitigate.trials import TrialRunner
from pipeline.models.common import N_
from pipeline.records import Scene, Support


class RubberPads(Measure):
    """Damp the swing of a painting by rubber pads behind its lower corners.

    References
    ----------
    Agbabian et al. (1991), sec. 2.4 and Table 4.
    """

    name = "rubber_pads"
    gives = ("damping", "movement")
    limits = 1
    limit_unit = "-"
    parameters = (DAMPING,)
    for_room = True

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:
        """Return it with ``damping`` [-]."""
        return with_parameters(scene, damping=exactly(parameters["damping"], "-", "damping of the pads"))

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:  # noqa: ARG002
        """Propose pads of the damping of the row."""
        if one.scene.support is not Support.HUNG:
            return refused(N_("it does not hang on a wall"))
        scene = one.scene
        bare = unframed(scene.item, scene.object_class, material_of(scene.item), thick=scene.item.depth_m is not None)
        if "damping" not in scene.parameters or not known_to_swing(scene) or bare:
            # A scroll flutters, and has no lower corners to be padded.
            return refused(N_("pads help only what swings, and it is not known to"))
        if one.scene.parameters["damping"].value >= self.row.limit:
            return refused(N_("it has as much damping already"))
        return self.one_trial(one, {"damping": (self.row.limit, "-")}, finish=movement, mark_of="swing")

    def charted(self, scenes: Sequence[Scene]) -> list[Scene]:
        """Return those of the scenes that pads would damp, with the pads in place."""
        hung = [scene for scene in scenes if scene.support is Support.HUNG and "damping" in scene.parameters]
        damped = {"damping": self.row.limit}
        return [self.change(s, damped) for s in hung if s.parameters["damping"].value < self.row.limit]
