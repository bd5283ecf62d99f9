"""A second fixing at the lower corners of what hangs on a wall: nothing is left that swings, slaps or lifts off."""

from collections.abc import Mapping

from pipeline.mitigate.measures.base import SPARE, Measure, exactly, rehung, with_parameters
from pipeline.mitigate.proposals import Candidate, Deficiency, Proposal, refused
from pipeline.mitigate.trials import Trial, TrialRunner
from pipeline.models.common import N_
from pipeline.models.hanger_load import pull
from pipeline.records import Hanging, Scene, Support


class Restrain(Measure):
    """Fix a hung object to the wall at its lower corners too: what is left is the load on its fixings.

    References
    ----------
    Agbabian et al. (1991), sec. 2.4 (swinging is what is to be prevented).
    """

    name = "restrain"
    gives = ("force",)
    for_room = True

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:  # noqa: ARG002
        """Return it fixed to its wall above and below."""
        return rehung(scene, Hanging.FIXED)

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose fixings for the force of the push."""
        scene = one.scene
        if scene.support is not Support.HUNG:
            return refused(N_("it does not hang on a wall"))
        mass = scene.parameters.get("mass")
        if mass is None:
            return refused(N_("its mass is not known, so the force on the fixings cannot be given"))
        fixed = self.in_place(one, {})
        # Its fixings are built for the force that they are told.
        strength = SPARE * fixed.parameters["amplification"].high * runner.largest(pull)
        built = exactly(strength, "-", "strength of fixings that are built for the force")
        trial = Trial(with_parameters(fixed, hanger_strength=built))
        return Proposal((Candidate({"force": (mass.high * runner.push, "N")}, (trial,)),))
