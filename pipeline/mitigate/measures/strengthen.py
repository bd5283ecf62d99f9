"""A critical section that is made thicker."""

from collections.abc import Mapping
from dataclasses import replace
from functools import partial
from math import inf

from pipeline.mitigate.measures.base import (
    SPARE,
    UNKNOWN_SECTION,
    Measure,
    held,
    knows_section,
    round_up,
    with_parameters,
)
from pipeline.mitigate.measures.fixings import HOLDS, force_and_moment
from pipeline.mitigate.proposals import Deficiency, Proposal, refused
from pipeline.mitigate.trials import Trial, TrialRunner
from pipeline.models.common import N_
from pipeline.quantities import G, Quantity
from pipeline.records import Scene, Support
from pipeline.records import phrases as say

MODULI = ("section_modulus", "section_modulus_width", "section_modulus_depth")


class Strengthen(Measure):
    """Make its critical section thicker, as much as the push asks for, and hold it at its base.

    References
    ----------
    Agbabian et al. (1991), sec. 4.
    """

    name = "strengthen"
    gives = ("enlargement", "section_modulus", *HOLDS)
    limits = 1
    limit_unit = "-"
    parameters = (Quantity("enlargement", "-", "size of the section, times its own", 1.0, 100.0),)

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:
        """Hold it at its base, its section ``enlargement`` times as thick: area with the square, moduli the cube."""
        times = parameters["enlargement"]
        powers = {"area": 2, **dict.fromkeys(MODULI, 3)}
        known = {name: power for name, power in powers.items() if name in scene.parameters}
        found = {name: scene.parameters[name].times(*(times**power,) * 3) for name, power in known.items()}
        if "frequency" in scene.parameters:
            # With the root of the second moment, the fourth power, if all that bends is made thicker; less if not.
            f = scene.parameters["frequency"]
            found["frequency"] = replace(f, high=max(f.high, times**2 * f.value), note="")
        return held(with_parameters(scene, **found))

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose the least enlargement that bears the push at the worst of what is uncertain."""
        scene = one.scene
        if scene.support not in (Support.FREESTANDING, Support.FASTENED):
            return refused(N_("it does not stand"))
        if not knows_section(scene):
            return UNKNOWN_SECTION
        mass, area, modulus, allowed = (
            scene.parameters[name] for name in ("mass", "area", "section_modulus", "allowable_stress")
        )
        (now,) = runner.run([Trial(held(scene))])
        # Held as it is, its tension and self-weight make up the bending, which falls with the cube of the size.
        tension = max(f.high or 0.0 for f in now)
        solid = scene.parameters.get("solid_mass")
        weight = max(mass.high, 0.0 if solid is None else solid.value) * G / area.value
        bending = max(tension + weight, 0.0)
        times = round_up(SPARE * (bending / allowed.low) ** (1.0 / 3.0)) if allowed.low > 0.0 else inf
        if times <= 1.0:
            return refused(N_("its critical section is strong enough as it is"))
        if times > self.row.limit:
            return refused(f"{say.LARGER_SECTION(times=times)}; {say.TIMES_ALLOWED(limit=self.row.limit)}")
        numbers = {"enlargement": (times, "-"), "section_modulus": (times**3 * modulus.value, "m3")}
        return self.one_trial(one, numbers, finish=partial(force_and_moment, scene, runner))
