"""Furniture that is fastened, so that it neither slides nor rocks with what stands in it."""

from collections.abc import Mapping

from pipeline.analysis.furniture import FREQUENCY, fastened, loose
from pipeline.mitigate.measures.base import Measure
from pipeline.mitigate.proposals import UNCONCERNED, Deficiency, Proposal, refused
from pipeline.mitigate.trials import TrialRunner
from pipeline.models.common import N_
from pipeline.records import Scene


class Anchor(Measure):
    """Fasten its furniture to the floor or a wall: it shakes what stands in it as its own frequency makes it."""

    name = "anchor"
    for_room = True

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:  # noqa: ARG002
        """Return it in furniture that is fastened."""
        return fastened(scene)

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:  # noqa: ARG002
        """Propose it where its furniture is known not to be fastened."""
        if not loose(one.scene):
            unsaid = one.scene.anchorage is None and FREQUENCY in one.scene.parameters
            return refused(N_("nobody says that what it stands in is not fastened")) if unsaid else UNCONCERNED
        return self.one_trial(one, {}, finish=lambda _: {})
