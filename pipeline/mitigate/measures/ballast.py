"""Ballast in the base of an object, which lowers its centre of gravity."""

from collections.abc import Mapping

from pipeline.mitigate.measures.base import NOT_FREE, SPARE, Measure, with_parameters
from pipeline.mitigate.proposals import Candidate, Deficiency, Proposal, refused
from pipeline.mitigate.trials import Trial, TrialRunner
from pipeline.models.common import N_
from pipeline.quantities import Quantity
from pipeline.records import Estimate, Origin, Scene, Support
from pipeline.records import phrases as say


class Ballast(Measure):
    """Lower its centre of gravity by ballast: as much as the push asks for, run again with all that is uncertain.

    References
    ----------
    Agbabian et al. (1991), sec. 2.1 (A_max/g > B/H'); where it slides first, friction in place of A_max/g.
    """

    name = "ballast"
    gives = ("mass", "height", "cg_height")
    limits = 2
    limit_unit = "-"
    parameters = (
        Quantity("mass", "kg", "mass of the ballast", 0.0, 1e5, exclusive=True),
        Quantity("height", "m", "height of its centre above the base", 0.0, 100.0),
    )

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:
        """Lower its centre of gravity: (m h + M H) / (m + M) with the ballast's mass M [kg] and height H [m].

        The ballast lies below the critical section, which bears no more than before.
        """
        mass, cg = scene.parameters["mass"], scene.parameters["cg_height"]
        ballast, at = parameters["mass"], parameters["height"]

        def lowered(own: float, height: float) -> float:
            return (own * height + ballast * at) / (own + ballast)

        note = "height of the centre of gravity with the ballast"
        ends = [lowered(own, height) for own in (mass.low, mass.high) for height in (cg.low, cg.high)]
        value = lowered(mass.value, cg.value)
        return with_parameters(scene, cg_height=Estimate(value, "m", Origin.DERIVED, min(ends), max(ends), note))

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose the least ballast with which it does not rock at the worst of what is uncertain."""
        scene = one.scene
        if scene.support is not Support.FREESTANDING:
            return NOT_FREE
        if not {"half_width", "cg_height", "mass"} <= set(scene.parameters):
            return refused(N_("its base, its mass or its centre of gravity is not known"))
        if not one.rocks:
            return refused(N_("it does not rock: a lower centre of gravity does not help"))
        if self.row.classes and scene.object_class not in self.row.classes:
            return refused(N_("objects of its kind have no room for ballast"))
        mass, cg, half = (scene.parameters[name] for name in ("mass", "cg_height", "half_width"))
        at = self.row.limit_high * cg.value
        # At the worst of what is uncertain: the heaviest and highest body, and the least height that may be left.
        left = half.low / runner.tilt(scene)
        if left <= at:
            return refused(N_("no ballast brings its centre of gravity low enough"))
        needed = SPARE * mass.high * (cg.high - left) / (left - at)
        share = needed / mass.value
        if share > self.row.limit:
            return refused(f"{say.BALLAST(share=share)}; {say.SHARE_ALLOWED(limit=self.row.limit)}")
        numbers = {"mass": (max(needed, 0.0), "kg"), "height": (at, "m")}
        lowered = self.in_place(one, numbers)
        numbers["cg_height"] = (lowered.parameters["cg_height"].value, "m")
        return Proposal((Candidate(numbers, (Trial(lowered),), mark_of="standing"),))
