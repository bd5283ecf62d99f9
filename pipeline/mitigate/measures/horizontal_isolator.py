"""A horizontal isolator under a plinth or a case, for all that stand on it."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import inf, isfinite

from pipeline.analysis.stakes import proportion
from pipeline.mitigate.isolation import IsolatorResponse
from pipeline.mitigate.measures.base import (
    DAMPING,
    FREQUENCY,
    Measure,
    exactly,
    held,
    isolated,
    knows_section,
    round_up,
    with_parameters,
)
from pipeline.mitigate.proposals import IT, STANDING, Candidate, Deficiency, Option, Proposal, refused
from pipeline.mitigate.trials import Trial, TrialRunner
from pipeline.models.common import N_, lift_ratios
from pipeline.quantities import Quantity
from pipeline.records import Check, Estimate, Scene, Support
from pipeline.records import phrases as say

GENERIC = "a horizontal isolator (a generic one: ask a maker for a product like it)"
"""What stands for an isolator of which no maker is named."""

PLATFORM, LOAD = "Lifting of the isolator's platform", "Load on the isolator"
"""What an isolator is asked besides its own model, in the words of a report."""

OUT_OF_PROPORTION = refused(
    N_(
        "an isolator is out of proportion: neither its class of value, as recorded, "
        "nor the danger of its fall is worth one"
    )
)
"""Of what counts less than an isolator does (tables/stakes.csv)."""

STEP = 0.05
"""To which the width of a platform is rounded up [m]."""

FREE, FASTENED = "It may stand free on it.", "It must be fastened to it."
"""How an object stands on an isolator."""


class HorizontalIsolator(Measure):
    """Put what they stand on onto a horizontal isolator: the shortest stroke that keeps each standing and whole.

    A stiff isolator passes much on and needs little stroke, a soft one the other way round, and friction trades the
    one for the other as well: of the catalogue those are tried that keep to the stroke that the place has, by the
    length of their stroke, which is that at the 84th percentile of the suite.  The platform must not lift off at the
    end of the stroke, under the push and the vertical motion, and the load must be one that the maker allows.  Each
    object on it stands as it does, or where that fails is fastened to it; all its models are run on what the isolator
    passes on.

    References
    ----------
    Agbabian et al. (1991), sec. 2.6 and Figure 6.
    """

    name = "horizontal_isolator"
    gives = ("frequency", "damping", "friction", "stroke", "platform", "load", "acceleration", "product", "what", "how")
    limits = 2
    limit_unit = "m"
    parameters = (
        FREQUENCY,
        DAMPING,
        Quantity("friction", "-", "friction of the isolator", 0.0, 2.0),
        Quantity("stroke", "m", "how far it can move", 0.0, 10.0, exclusive=True),
    )
    shared = True
    isolator = "horizontal_isolator"
    phrases = (FREE, FASTENED, IT, GENERIC, PLATFORM, LOAD)

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
                return refused(refusal if len(objects) == 1 else say.SHARES_CASE(number=one.number, refusal=refusal))
        if runner.aims and proportion(one.scene for one in objects) < 1.0:
            return OUT_OF_PROPORTION
        load, candidates, why = Load.of([one.scene for one in objects]), [], ""
        for response in runner.isolated(self.isolator):
            isolator = response.isolator
            stroke = round_up(response.stroke)
            if stroke > min(self.row.limit, isolator.stroke):
                continue
            width = isolator.platform_width or self._width(load.width(response, stroke, isolator.platform_mass))
            checks = load.checks(response, stroke, width)
            short = [check for check in checks if not check.passes]
            if short or width > self.row.limit_high:
                why = say.MORE_THAN_BORNE(check=short[0].title.lower()) if short else self._too_wide(width)
                continue
            numbers = {
                "frequency": (isolator.frequency, "Hz"),
                "damping": (isolator.damping, "-"),
                "friction": (isolator.friction, "-"),
                "stroke": (stroke, "m"),
                "platform": (width, "m"),
                "load": (load.mass, "kg"),
                "acceleration": (response.acceleration, "m/s2"),
            }
            moving = Trial(self.in_place(objects[0], numbers))
            options = tuple((one, _options(one.scene, response)) for one in objects)
            marks = {level: ("isolator", isolator.frequency, felt) for level, felt in response.accelerations.items()}
            words = {"product": f"{isolator.name} of {isolator.maker}" if isolator.maker else GENERIC}
            told = tuple(("", check) for check in checks)
            candidates.append(Candidate(numbers, (moving,), options, checks=told, words=words, marks=marks))
        if not candidates and why:
            return refused(why)
        if not candidates:
            if isfinite(self.row.limit):
                return refused(say.NO_ISOLATOR_UNDER(stroke=self.row.limit))
            return refused(N_("the catalogue has no horizontal isolator that keeps to its stroke"))
        reason = N_("no isolator of the catalogue passes on little enough within its stroke")
        if len(objects) > 1:
            reason = say.NO_ISOLATOR_FOR_ALL(objects=len(objects))
        return Proposal(tuple(candidates), reason)

    @staticmethod
    def _width(needed: float) -> float:
        return round_up(max(needed, STEP), STEP)

    def _too_wide(self, width: float) -> str:
        return f"{say.PLATFORM(width=width)}; {say.LENGTH_ALLOWED(limit=self.row.limit_high)}"


@dataclass(frozen=True)
class Load:
    """Load of what stands on an isolator.

    Attributes
    ----------
    masses, heights : tuple of Estimate
        Of each object: its mass [kg] and the height of its centre of gravity [m].
    """

    masses: tuple[Estimate, ...]
    heights: tuple[Estimate, ...]

    @classmethod
    def of(cls, scenes: Sequence[Scene]) -> "Load":
        """Return the load that objects are; each with its mass and its centre of gravity."""
        masses, heights = ([scene.parameters[name] for scene in scenes] for name in ("mass", "cg_height"))
        return cls(tuple(masses), tuple(heights))

    @property
    def mass(self) -> float:
        """Of all together [kg], by the best estimates."""
        return sum(mass.value for mass in self.masses)

    def height(self, platform_mass: float) -> tuple[float, float]:
        """Return the height of the centre of gravity of all with the platform, which lies at 0 [m]: best, and worst.

        The worst is that of the tallest being heaviest and the others lightest, all as high as they may be.
        """
        pairs = sorted(zip(self.heights, self.masses, strict=True), key=lambda pair: pair[0].high, reverse=True)
        best = sum(height.value * mass.value for height, mass in pairs) / (self.mass + platform_mass)
        worst = 0.0
        for tall in range(1, len(pairs) + 1):
            weights = [mass.high if at < tall else mass.low for at, (_, mass) in enumerate(pairs)]
            moment = sum(weight * height.high for weight, (height, _) in zip(weights, pairs, strict=True))
            worst = max(worst, moment / (sum(weights) + platform_mass))
        return best, worst

    def width(self, response: IsolatorResponse, stroke: float, platform_mass: float) -> float:
        """Return the width of the platform [m] from which on it does not lift off, all at its worse end.

        Notes
        -----
        About an edge, with the load s off the middle at the end of its stroke, of what the isolator passes on:
        m h |a_h| <= m (g + a_z) (W/2 - s).  The vertical motion passes an isolator unchanged.
        """
        return 2.0 * (self.height(platform_mass)[1] * lift_of(response) + stroke)

    def checks(self, response: IsolatorResponse, stroke: float, width: float) -> tuple[Check, ...]:
        """Return whether a platform of a width [m] stays down, and whether its maker allows the load."""
        isolator = response.isolator
        arm = max(0.5 * width - stroke, 0.0)
        leans, worst = (height * lift_of(response) for height in self.height(isolator.platform_mass))
        kind = isolator.kind
        used = leans / arm if arm > 0.0 else inf
        out = [Check(kind, PLATFORM, leans, "m", arm, used, worst <= arm * (1.0 + 1e-9))]
        if isolator.maker:
            least, most = (sum(getattr(mass, end) for mass in self.masses) for end in ("low", "high"))
            allowed = isolator.load_least <= least and most <= isolator.load_most
            out.append(Check(kind, LOAD, self.mass, "kg", isolator.load_most, self.mass / isolator.load_most, allowed))
        return tuple(out)


def lift_of(response: IsolatorResponse) -> float:
    """Return the largest |a_h| / (g + a_z) of what an isolator passes on [-]; infinite where the load loses contact."""
    return max(max(lift_ratios(m.excitation(None))) for level in response.shaking for m in level.every)


def _unsuited(scene: Scene) -> str:
    if scene.support not in STANDING:
        return N_("it does not stand")
    if not {"mass", "cg_height"} <= set(scene.parameters):
        return N_("its mass or its centre of gravity is not known, so its platform cannot be checked")
    if {"stroke", "rotation_limit"} & set(scene.parameters):
        # The frequency and the damping are the isolator's then, and its own are not at hand.
        return N_("it stands on an isolator already: have that one changed")
    if not knows_section(scene) and not _can_stand(scene):
        return N_("neither its base nor its critical section is known")
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
