"""A mount that clamps an object at its base."""

from collections.abc import Mapping
from functools import partial

from pipeline.mitigate.measures.base import NOT_FREE, UNKNOWN_SECTION, Measure, held, knows_section
from pipeline.mitigate.measures.fixings import HOLDS, force_and_moment
from pipeline.mitigate.proposals import Deficiency, Proposal
from pipeline.mitigate.trials import TrialRunner
from pipeline.records import Scene, Support


class Fasten(Measure):
    """Clamp it at its base: it neither rocks nor slides, and its critical section must bear the push.

    References
    ----------
    Agbabian et al. (1991), sec. 2.3.
    """

    name = "fasten"
    gives = HOLDS

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:  # noqa: ARG002
        """Return it held at its base."""
        return held(scene)

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose a mount for the force and the moment of the push."""
        if one.scene.support is not Support.FREESTANDING:
            return NOT_FREE
        if not knows_section(one.scene):
            return UNKNOWN_SECTION
        return self.one_trial(one, {}, finish=partial(force_and_moment, one.scene, runner))
