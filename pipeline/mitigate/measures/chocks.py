"""Wheels and castors that are kept from rolling."""

from collections.abc import Mapping

from pipeline.analysis.footing import rolling
from pipeline.mitigate.measures.base import Measure, movement, with_parameters
from pipeline.mitigate.proposals import UNCONCERNED, Deficiency, Proposal
from pipeline.mitigate.trials import TrialRunner
from pipeline.records import Estimate, Scene, Support
from pipeline.records import phrases as say

CHOCKED = (0.2, 0.4, 0.6)
"""Friction of what stands on wheels that do not turn, as of wood or rubber on a floor: judgement."""


class Chocks(Measure):
    """Keep its wheels from turning: then it slides as any other thing does, and may tip."""

    name = "chocks"
    gives = ("movement",)
    for_room = True

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:  # noqa: ARG002
        """Return it on wheels that do not turn."""
        low, best, high = CHOCKED
        grips = Estimate.assumed(best, low, high, "-", say.CHOCKED(friction=CHOCKED), "judgement")
        return with_parameters(scene, friction_static=grips)

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:  # noqa: ARG002
        """Propose it for what stands on wheels and whose friction nobody measured."""
        stands = one.scene.support is Support.FREESTANDING and one.scene.item.friction is None
        if not stands or rolling(one.scene.item, one.scene.object_class) is None:
            return UNCONCERNED
        return self.one_trial(one, {}, finish=movement, mark_of="sliding")
