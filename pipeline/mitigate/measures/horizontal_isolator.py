"""A horizontal isolator under a plinth or a case, for all that stand on it."""

from collections.abc import Mapping, Sequence
from math import isfinite

from pipeline.mitigate.measures.base import (
    DAMPING,
    FREQUENCY,
    MARGIN,
    Measure,
    exactly,
    held,
    isolated,
    knows_section,
    round_up,
    with_parameters,
)
from pipeline.mitigate.proposals import IT, STANDING, Candidate, Deficiency, Option, Proposal, refused
from pipeline.mitigate.trials import IsolatorResponse, Trial, TrialRunner
from pipeline.quantities import Quantity
from pipeline.records import Scene, Support

FREE, FASTENED = "It may stand free on it.", "It must be fastened to it."
"""How an object stands on an isolator."""


class HorizontalIsolator(Measure):
    """Put what they stand on onto a horizontal isolator: the shortest stroke that keeps each standing and whole.

    A stiff isolator passes much on and needs little stroke, a soft one the other way round, and friction trades the
    one for the other as well: of the catalogue those are tried that keep to the stroke that the place has, by the
    length of their stroke.  Each object on it stands as it does, or where that fails is fastened to it; all its
    models are run on what the isolator passes on.

    References
    ----------
    Agbabian et al. (1991), sec. 2.6 and Figure 6.
    """

    name = "horizontal_isolator"
    gives = ("frequency", "damping", "friction", "stroke", "acceleration", "what", "how")
    limits = 1
    limit_unit = "m"
    parameters = (
        FREQUENCY,
        DAMPING,
        Quantity("friction", "-", "friction of the isolator", 0.0, 2.0),
        Quantity("stroke", "m", "how far it can move", 0.0, 10.0, exclusive=True),
    )
    shared = True
    isolator = "horizontal_isolator"
    phrases = (FREE, FASTENED, IT)

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:
        """Return the isolator: ``frequency`` [Hz], ``damping`` [-], ``friction`` [-] and ``stroke`` [m]."""
        found = {q.name: exactly(parameters[q.name], q.unit, f"{q.name} of its isolator") for q in self.parameters}
        return isolated(with_parameters(scene, **found), self.isolator)

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose isolators for one object that stands alone."""
        return self.propose_shared((one,), runner)

    def propose_shared(self, objects: Sequence[Deficiency], runner: TrialRunner) -> Proposal:
        """Propose the isolators of the catalogue that keep to their stroke, shortest first."""
        for one in objects:
            refusal = _unsuited(one.scene)
            if refusal:
                return refused(refusal if len(objects) == 1 else f"{one.number} shares its case: {refusal}")
        candidates = []
        for response in runner.isolated(self.isolator):
            isolator = response.isolator
            stroke = round_up(MARGIN * response.stroke)
            if stroke > min(self.row.limit, isolator.stroke):
                continue
            numbers = {
                "frequency": (isolator.frequency, "Hz"),
                "damping": (isolator.damping, "-"),
                "friction": (isolator.friction, "-"),
                "stroke": (stroke, "m"),
                "acceleration": (response.acceleration, "m/s2"),
            }
            moving = Trial(self.in_place(objects[0], numbers))
            options = tuple((one, _options(one.scene, response)) for one in objects)
            marks = {level: ("isolator", isolator.frequency, felt) for level, felt in response.accelerations.items()}
            candidates.append(Candidate(numbers, (moving,), options, marks=marks))
        if not candidates:
            longest = f" and none under {100 * self.row.limit:.0f} cm" if isfinite(self.row.limit) else ""
            return refused(f"the catalogue has no horizontal isolator that keeps to its stroke{longest}")
        among = f" for all {len(objects)} objects of its case" if len(objects) > 1 else ""
        reason = f"no isolator of the catalogue passes on little enough within its stroke{among}"
        return Proposal(tuple(candidates), reason)


def _unsuited(scene: Scene) -> str:
    if scene.support not in STANDING:
        return "it does not stand"
    if {"stroke", "rotation_limit"} & set(scene.parameters):
        # The frequency and the damping are the isolator's then, and its own are not at hand.
        return "it stands on an isolator already: have that one changed"
    if not knows_section(scene) and not _can_stand(scene):
        return "neither its base nor its critical section is known"
    return ""


def _can_stand(scene: Scene) -> bool:
    known = {"half_width", "cg_height", "friction_static"} <= set(scene.parameters)
    return scene.support is Support.FREESTANDING and known


def _options(scene: Scene, response: IsolatorResponse) -> tuple[Option, ...]:
    options = []
    if _can_stand(scene):
        options.append(Option(Trial(scene, response), FREE))
    if knows_section(scene):
        options.append(Option(Trial(held(scene), response), FASTENED))
    return tuple(options)
