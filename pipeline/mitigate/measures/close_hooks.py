"""Hooks that are closed above, so that nothing lifts off them."""

from collections.abc import Mapping

from pipeline.mitigate.measures.base import Measure, exactly, with_parameters
from pipeline.mitigate.proposals import Deficiency, Proposal, refused
from pipeline.mitigate.trials import TrialRunner
from pipeline.models.common import N_
from pipeline.records import Scene, Support, Verdict


class CloseHooks(Measure):
    """Close the hooks of a work on a wall: its hangers cannot rise out of them; it swings and slaps as before."""

    name = "close_hooks"

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:  # noqa: ARG002
        """Return it on hooks that are closed above."""
        if "hooks_open" not in scene.parameters:
            raise KeyError("hooks_open")
        return with_parameters(scene, hooks_open=exactly(0.0, "-", "hooks closed above by the measure"))

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:  # noqa: ARG002
        """Propose it where it may come off."""
        if one.scene.support is not Support.HUNG:
            return refused(N_("it does not hang on a wall"))
        if all(f.verdict is Verdict.PASS for f in one.findings if f.model == "unhooking"):
            return refused(N_("nothing lifts it off its hooks"))
        return self.one_trial(one, {}, finish=lambda _: {})
