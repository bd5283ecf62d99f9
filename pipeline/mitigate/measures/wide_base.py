"""A footing plate that an object is fixed to, so that its base is wider."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial

from pipeline.analysis.classify import models_of
from pipeline.analysis.footing import HALVES
from pipeline.mitigate.measures.base import (
    CLEARANCE,
    MARGIN,
    NOT_FREE,
    SPARE,
    UNKNOWN_SECTION,
    Measure,
    cleared,
    exactly,
    fixed_at_base,
    knows_section,
    round_up,
    with_parameters,
)
from pipeline.mitigate.measures.fixings import HOLDS, force_and_moment
from pipeline.mitigate.proposals import Deficiency, Proposal, refused
from pipeline.mitigate.trials import TrialRunner
from pipeline.models.common import N_
from pipeline.quantities import Quantity
from pipeline.records import Estimate, Scene, Support
from pipeline.records import phrases as say


class WideBase(Measure):
    """Fix it to a footing plate so wide that it does not rock, with the room that it slides in around the plate.

    Its critical section bears the push, as that of a clamped object does.

    References
    ----------
    Agbabian et al. (1991), sec. 2.1 (A_max/g > B/H'); where it slides first, friction in place of A_max/g.
    """

    name = "wide_base"
    touches = True
    gives = ("width", "clearance", *HOLDS)
    limits = 2
    limit_unit = "-"
    parameters = (Quantity("width", "m", "width of the footing plate", 0.0, 100.0, exclusive=True), CLEARANCE)

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:
        """Return it on a plate of ``width`` [m], ``clearance`` [m] around that; its section bears the push."""
        half = 0.5 * parameters["width"]
        found: dict[str, Estimate] = {}
        for name in HALVES:
            before = scene.parameters.get(name)
            if before is not None:
                found[name] = exactly(half, "m", "half of the footing plate") if before.high < half else before
        models = dict.fromkeys((*models_of(Support.FREESTANDING), *models_of(Support.FASTENED), *scene.models))
        wider = cleared(with_parameters(fixed_at_base(scene), **found), parameters)
        return replace(wider, models=tuple(models))

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose the narrowest plate on which it does not rock at the worst of what is uncertain."""
        scene = one.scene
        if scene.support is not Support.FREESTANDING:
            return NOT_FREE
        if not {"half_width", "cg_height"} <= set(scene.parameters):
            return refused(N_("its base or its centre of gravity is not known"))
        if not one.rocks:
            return refused(N_("it does not rock: a wider base does not help"))
        if not knows_section(scene):
            return UNKNOWN_SECTION
        half = scene.parameters["half_width"]
        width = round_up(SPARE * 2.0 * runner.tilt(scene) * scene.parameters["cg_height"].high)
        if width <= 2.0 * half.high:
            return refused(N_("its base may be as wide as the plate already: measure it"))
        allowed = 2.0 * self.row.limit * half.value
        if width > allowed:
            return refused(f"{say.PLATE(width=width)}; {say.LENGTH_ALLOWED(limit=allowed)}")
        room = round_up(MARGIN * (one.moves or 0.0))
        if room > self.row.limit_high:
            return refused(say.NEEDS_ROOM_AROUND(room=room, allowed=self.row.limit_high))
        numbers = {"width": (width, "m"), "clearance": (room, "m")}
        return self.one_trial(one, numbers, finish=partial(force_and_moment, scene, runner), mark_of="standing")
