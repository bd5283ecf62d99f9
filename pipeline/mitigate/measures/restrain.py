"""A second fixing that keeps what hangs on a wall from swinging."""

from collections.abc import Mapping

from pipeline.mitigate.measures.base import Measure, held, knows_section
from pipeline.mitigate.proposals import Candidate, Deficiency, Proposal, refused
from pipeline.mitigate.trials import Trial, TrialRunner
from pipeline.records import Check, Scene, Support


class Restrain(Measure):
    """Fix a hung object to the wall as well: nothing is left that swings; the fixings bear the push.

    References
    ----------
    Agbabian et al. (1991), sec. 2.4 (swinging is what is to be prevented).
    """

    name = "restrain"
    gives = ("force",)
    for_room = True

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:  # noqa: ARG002
        """Return it held."""
        return held(scene)

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose fixings for the force of the push."""
        scene = one.scene
        if scene.support is not Support.HUNG:
            return refused("it does not hang on a wall")
        mass = scene.parameters.get("mass")
        if mass is None:
            return refused("its mass is not known, so the force on the fixings cannot be given")
        checks = tuple(
            (f.level, Check("swing", f.title, 0.0, f.unit, f.capacity or 0.0, 0.0, True, f.demand))
            for f in one.findings
            if f.model == "swing"
        )
        trials = (Trial(held(scene)),) if knows_section(scene) else ()
        return Proposal((Candidate({"force": (mass.high * runner.push, "N")}, trials, checks=checks),))
