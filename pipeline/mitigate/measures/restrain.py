"""What hangs is kept from swinging: a second fixing at the lower corners on a wall, stays of what hangs from above."""

from collections.abc import Mapping
from dataclasses import replace
from typing import ClassVar

from pipeline.mitigate.measures.base import SPARE, Measure, exactly, rehung, with_parameters
from pipeline.mitigate.measures.restraints import INCLINED
from pipeline.mitigate.proposals import Candidate, Deficiency, Proposal, refused
from pipeline.mitigate.trials import Trial, TrialRunner
from pipeline.models.common import N_
from pipeline.models.hanger_load import pull
from pipeline.records import Hanging, Scene, Support

MOBILE = "mobile"
"""How the reason of a class begins by whose rules a thing is a mobile."""


class Restrain(Measure):
    """Fix a hung object to the wall at its lower corners too: what is left is the load on its fixings.

    References
    ----------
    Agbabian et al. (1991), sec. 2.4 (swinging is what is to be prevented).
    """

    name = "restrain"
    gives = ("force",)
    for_room = True
    support: ClassVar[Support] = Support.HUNG
    elsewhere: ClassVar[str] = N_("it does not hang on a wall")
    share: ClassVar[float] = 1.0

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:  # noqa: ARG002
        """Return it fixed to its wall above and below."""
        return rehung(scene, Hanging.FIXED)

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose fixings for the force of the push."""
        scene = one.scene
        if scene.support is not self.support:
            return refused(self.elsewhere)
        mass = scene.parameters.get("mass")
        if mass is None:
            return refused(N_("its mass is not known, so the force on the fixings cannot be given"))
        fixed = self.in_place(one, {})
        # Its fixings are built for the force that they are told.
        strength = SPARE * fixed.parameters["amplification"].high * runner.largest(pull)
        built = exactly(strength, "-", "strength of fixings that are built for the force")
        trial = Trial(with_parameters(fixed, hanger_strength=built))
        return Proposal((Candidate({"force": (mass.high * runner.push / self.share, "N")}, (trial,)),))


class Stays(Restrain):
    """Stay what hangs from above to all sides: it moves with the building, and each stay may have to bear the push.

    References
    ----------
    FEMA E-74 (2012), sec. 6.4.9, is that on light fixtures, 6.4.9.3 on pendant ones.
    """

    name = "stays"
    support = Support.SUSPENDED
    elsewhere = N_("it does not hang from above")
    # A line bears tension alone, and at 45 degrees more of it than the push.
    share = INCLINED

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:
        """Return it fixed: what is left is the load on what holds it."""
        return super().change(replace(scene, support=Support.HUNG), parameters)

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose stays for the force of the push, but for what is made to move."""
        if one.scene.rule.startswith(MOBILE):
            return refused(N_("it is made to move: stays would still it"))
        return super().propose(one, runner)
