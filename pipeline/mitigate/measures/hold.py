"""A mount that holds what lies in a case or cannot stand by itself."""

from collections.abc import Mapping

from pipeline.mitigate.measures.base import Measure, held, round_up
from pipeline.mitigate.measures.fixings import SIDEWAYS
from pipeline.mitigate.proposals import Candidate, Deficiency, Proposal, refused
from pipeline.mitigate.trials import Trial, TrialRunner
from pipeline.models.common import N_
from pipeline.models.hanger_load import pull
from pipeline.quantities import G
from pipeline.records import Check, Mount, Scene


class Hold(Measure):
    """Hold it on its mount by clips, wire or screws, made for its weight in any direction and its inertia.

    References
    ----------
    Agbabian et al. (1991), sec. 2.3: F = m A.
    """

    name = "hold"
    gives = ("times",)
    fastens = True
    touches = True

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:  # noqa: ARG002
        """Return it held by its mount."""
        return held(scene)

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose a mount for the largest pull of the levels."""
        scene = one.scene
        if scene.mount is None:
            return refused(N_("it neither lies nor is held by a mount"))
        if scene.mount is Mount.SECURED:
            return refused(N_("its mount holds it already: have that made stronger"))
        times = round_up(runner.largest(pull), 0.1)
        mass = scene.parameters.get("mass")
        checks: tuple[tuple[str, Check], ...] = ()
        if mass is not None:
            asked, bears = mass.value * runner.push, mass.high * times * G
            checks = (("", Check(self.name, SIDEWAYS, asked, "N", bears, asked / bears, passes=True)),)
        numbers = {"times": (times, "-")}
        return Proposal((Candidate(numbers, (Trial(self.in_place(one, numbers)),), checks=checks),))
