"""An elastomeric pad that an object is mounted on, which lets it turn a little."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import product

from pipeline.mitigate.measures.base import (
    DAMPING,
    FREQUENCY,
    UNKNOWN_SECTION,
    Measure,
    exactly,
    held,
    isolated,
    knows_section,
    with_parameters,
)
from pipeline.mitigate.proposals import Candidate, Deficiency, Numbers, Proposal, refused
from pipeline.mitigate.rows import Isolator
from pipeline.mitigate.trials import Bodies, Trial, TrialRunner
from pipeline.models.common import N_
from pipeline.models.stress import STRESS
from pipeline.quantities import Quantity
from pipeline.records import Estimate, Origin, Scene, Support


class RotationalIsolator(Measure):
    """Mount it on an elastomeric pad that lets it turn a little and spares its base.

    The stress is that of a rigid body under the acceleration of its centre of gravity on the pad.

    References
    ----------
    Agbabian et al. (1991), sec. 2.6.
    """

    name = "rotational_isolator"
    gives = ("frequency", "damping", "rotation", "rotation_limit", "acceleration")
    limits = 1
    limit_unit = "rad"
    parameters = (
        FREQUENCY,
        DAMPING,
        Quantity("rotation_limit", "rad", "how far it may turn", 0.0, 1.5, exclusive=True),
    )
    isolator = "rotational_isolator"
    mounts = True

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:
        """Return the pad: ``frequency`` [Hz], ``damping`` [-] and ``rotation_limit`` [rad].

        The inertia is that of a uniform body about the middle of its base: I = m h^2 + m (b^2 + h^2) / 3, so that
        I / (m h^2) = 1 + (b^2 / h^2 + 1) / 3, at the ends of what b/h may be.
        """
        cg = scene.parameters["cg_height"]
        half = scene.parameters.get("half_width")
        slopes = (0.5, 0.5, 0.5) if half is None else (half.value / cg.value, half.low / cg.high, half.high / cg.low)
        ratio, low, high = (1.0 + (slope**2 + 1.0) / 3.0 for slope in slopes)
        uniform = "a uniform body about the middle of its base"
        found = {
            "frequency": exactly(parameters["frequency"], "Hz", "frequency of its pad"),
            "damping": exactly(parameters["damping"], "-", "damping of its pad"),
            "inertia_ratio": Estimate(ratio, "-", Origin.DERIVED, low, high, uniform),
            "rotation_limit": exactly(parameters["rotation_limit"], "rad", "largest turn that its mount allows"),
        }
        return isolated(with_parameters(scene, **found), self.isolator)

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose each pad of the catalogue."""
        scene = one.scene
        refusal = _unsuited(scene)
        if refusal is not None:
            return refusal
        candidates = []
        for pad in runner.catalogue(self.isolator):
            numbers = self._numbers(pad)
            turning = self.in_place(one, numbers)
            rotation, share = runner.on_pad(pad, _bodies(turning))
            told = {"rotation": (rotation, "rad"), "acceleration": (share * runner.push, "m/s2")}
            cg = scene.parameters["cg_height"]
            amplified = replace(cg, value=share, low=share, high=share, unit="-", note="on its pad")
            bent = replace(with_parameters(held(scene), amplification=amplified), models=("stress",))
            candidates.append(Candidate({**numbers, **told}, (Trial(turning), Trial(bent))))
        if not candidates:
            return refused(N_("the catalogue has no rotational isolator"))
        return Proposal(tuple(candidates), N_("on none of the pads does it turn and bend little enough"))

    def prepare(self, objects: Sequence[Deficiency], runner: TrialRunner) -> None:
        """Run all objects that it will be proposed for on each pad at once."""
        suited = [one for one in objects if _unsuited(one.scene) is None]
        for pad in runner.catalogue(self.isolator):
            numbers = self._numbers(pad)
            runner.on_pads(pad, [_bodies(self.in_place(one, numbers)) for one in suited])

    def _numbers(self, pad: Isolator) -> Numbers:
        return {
            "frequency": (pad.frequency, "Hz"),
            "damping": (pad.damping, "-"),
            "rotation_limit": (self.row.limit, "rad"),
        }


def _unsuited(scene: Scene) -> Proposal | None:
    if scene.support not in (Support.FREESTANDING, Support.FASTENED):
        return refused(N_("it does not stand"))
    if not knows_section(scene) or "cg_height" not in scene.parameters:
        return UNKNOWN_SECTION
    if STRESS.applies(held(scene)):
        return refused(N_("it is flexible itself: no model has a flexible object on a pad that turns"))
    return None


def _bodies(turning: Scene) -> Bodies:
    """Return the best estimates of an object on a pad, and all ends of what is uncertain."""
    cg, ratio = turning.parameters["cg_height"], turning.parameters["inertia_ratio"]
    return (cg.value, ratio.value), *product((cg.low, cg.high), (ratio.low, ratio.high))
