"""A low-friction pad, on which an object that is clamped too hard may slide."""

from collections.abc import Mapping
from dataclasses import replace

from pipeline.mitigate.measures.base import (
    CLEARANCE,
    FRICTION,
    Measure,
    cleared,
    held,
    isolated,
    knows_section,
    on_surface,
    round_up,
)
from pipeline.mitigate.proposals import Candidate, Deficiency, Proposal, refused
from pipeline.mitigate.trials import Trial, TrialRunner
from pipeline.models.common import N_
from pipeline.records import Scene, Support


class FrictionIsolator(Measure):
    """Let it slide on a low-friction pad; first it must not rock, whatever the friction.

    References
    ----------
    Agbabian et al. (1991), sec. 2.6.
    """

    name = "friction_isolator"
    gives = ("friction", "clearance", "movement")
    limits = 1
    limit_unit = "m"
    parameters = (FRICTION, CLEARANCE)
    isolator = "friction_isolator"

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:
        """Return the pad of ``friction`` [-] under it, with ``clearance`` [m] around."""
        return isolated(cleared(on_surface(scene, parameters), parameters), self.isolator)

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose the pads of the catalogue that keep to the room that there is."""
        scene = one.scene
        if scene.support not in (Support.FREESTANDING, Support.FASTENED):
            return refused(N_("it does not stand"))
        if not {"half_width", "cg_height"} <= set(scene.parameters):
            return refused(N_("whether it rocks is not known"))
        half, cg = scene.parameters["half_width"], scene.parameters["cg_height"]
        if runner.lift > half.low / cg.high:
            return refused(N_("it may rock: a low friction never excuses that"))
        upright = replace(scene, support=Support.FREESTANDING, models=("rocking",))
        candidates = []
        for response in runner.isolated(self.isolator):
            pad = response.isolator
            room = round_up(response.stroke)
            if room > min(self.row.limit, pad.stroke):
                continue
            numbers = {"friction": (pad.friction, "-"), "clearance": (room, "m"), "movement": (response.stroke, "m")}
            trials = [Trial(upright), Trial(self.in_place(one, numbers))]
            if knows_section(scene):
                trials.append(Trial(held(scene), response))
            marks = {level: ("sliding", pad.friction, moved) for level, moved in response.strokes.items()}
            candidates.append(Candidate(numbers, tuple(trials), marks=marks))
        if not candidates:
            return refused(N_("no low-friction pad keeps to the room that there is"))
        return Proposal(tuple(candidates))
