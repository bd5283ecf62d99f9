"""A mount made for an object, which holds its base."""

from collections.abc import Mapping
from functools import partial

from pipeline.mitigate.measures.base import NOT_FREE, UNKNOWN_SECTION, Measure, held, may_be_held
from pipeline.mitigate.measures.fixings import HOLDS, force_and_moment
from pipeline.mitigate.proposals import Candidate, Deficiency, Proposal
from pipeline.mitigate.trials import Trial, TrialRunner
from pipeline.records import Scene, Support


class Fasten(Measure):
    """Hold its base by a mount made for it: it neither rocks nor slides, and its critical section must bear the push.

    References
    ----------
    Agbabian et al. (1991), sec. 2.3.
    """

    name = "fasten"
    gives = HOLDS
    fastens = True
    touches = True

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:  # noqa: ARG002
        """Return it held at its base."""
        return held(scene)

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose a mount for the force and the moment of the push."""
        if one.scene.support is not Support.FREESTANDING:
            return NOT_FREE
        if not may_be_held(one.scene):
            return UNKNOWN_SECTION
        finish = partial(force_and_moment, one.scene, runner)
        trial = Trial(self.in_place(one, {}))
        return Proposal(tuple(Candidate({}, (trial,), finish=finish, at_best=at_best) for at_best in (False, True)))
