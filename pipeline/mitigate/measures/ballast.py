"""Ballast in the base of an object, which lowers its centre of gravity."""

from collections.abc import Mapping, Sequence

from pipeline.mitigate.measures.base import SPARE, Measure, with_parameters
from pipeline.mitigate.measures.fixings import touched
from pipeline.mitigate.proposals import Candidate, Deficiency, Proposal, refused
from pipeline.mitigate.trials import Trial, TrialRunner
from pipeline.models.common import N_
from pipeline.quantities import Quantity
from pipeline.records import Estimate, Item, Origin, Scene, Support
from pipeline.records import phrases as say
from pipeline.tables.limit_rows import limit
from pipeline.tables.rows import any_of

STEPS = (0.2, 0.4, 0.7, 1.0)
"""Ballast that is tried, over the most that there may be."""

SEEN_THROUGH = frozenset({"glass"})
"""Materials that no ballast is put into: rows of materials.csv."""

LYING = 1.25
"""Length over the other sizes from which a vessel is one that lies: judgement."""

_ON_ITS_SIDE = any_of([
    *("on its side", "on their side", "on their sides", "lying", "liegend", "auf der Seite", "couché", "couchée"),
    *("sur le côté", "coricato", "coricata", "su un fianco", "disteso", "tumbado", "tumbada", "acostado", "acostada"),
    *("de lado", "deitado", "deitada", "πλαγιασμένο", "πλαγιαστό", "横置き", "横たえ"),
])  # fmt: skip
"""What says of a vessel that it lies."""


class Ballast(Measure):
    """Lower its centre of gravity by ballast.

    Where harm has to be excluded, by so much that it does not rock at all at the worst of what is uncertain.  That is
    many times what keeps it from falling: where harm has to become unlikely, the least that does it is sought.

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
        """Propose the least ballast with which it does not rock, or as little as makes harm unlikely enough."""
        refusal = self._unsuited(one, runner)
        if refusal:
            return refused(refusal)
        if not runner.aims:
            needed = self._never_rocking(one, runner)
            return refused(needed) if isinstance(needed, str) else self._of(one, (needed,))
        remains = runner.once(self.row.name, dict[int, float]).get(one.index)
        most = self._most(one)
        if remains is not None:
            return refused(say.HARM_REMAINS_WITH_BALLAST(mass=most, chance=remains))
        return self._of(one, tuple(step * most for step in STEPS))

    def prepare(self, objects: Sequence[Deficiency], runner: TrialRunner) -> None:
        """Find out of all at once for which the most ballast is enough: of most it is not, and no less is tried."""
        if not runner.aims:
            return
        asked = [one for one in objects if not self._unsuited(one, runner)]
        trials = [Trial(self._with(one, self._most(one))) for one in asked]
        left = runner.remaining(trials)
        runner.once(self.row.name, dict[int, float]).update(
            (one.index, max((each.expected for each in some.values()), default=1.0))
            for one, some in zip(asked, left, strict=True)
            if not runner.reaches_aim([some])
        )

    def _most(self, one: Deficiency) -> float:
        return min(limit("ballast_mass").value, self.row.limit * one.scene.parameters["mass"].value)

    def _unsuited(self, one: Deficiency, runner: TrialRunner) -> str:
        scene = one.scene
        if scene.support is not Support.FREESTANDING:
            return N_("it does not stand free")
        if not {"half_width", "cg_height", "mass"} <= set(scene.parameters):
            return N_("its base, its mass or its centre of gravity is not known")
        if not one.rocks:
            return N_("it does not rock: a lower centre of gravity does not help")
        if (self.row.classes and scene.object_class not in self.row.classes) or _lies(scene.item):
            return N_("objects of its kind have no room for ballast")
        if touched(scene.item, runner.values) in SEEN_THROUGH:
            return N_("ballast in glass is seen, and presses on its wall")
        return ""

    def _never_rocking(self, one: Deficiency, runner: TrialRunner) -> float | str:
        """Return the ballast with which it does not rock at the worst of what is uncertain [kg]; in words why none."""
        scene = one.scene
        mass, cg, half = (scene.parameters[name] for name in ("mass", "cg_height", "half_width"))
        at = self.row.limit_high * cg.value
        # At the worst of what is uncertain: the heaviest and highest body, and the least height that may be left.
        left = half.low / runner.tilt(scene)
        if left <= at:
            return N_("no ballast brings its centre of gravity low enough")
        needed = SPARE * mass.high * (cg.high - left) / (left - at)
        share = needed / mass.value
        if share > self.row.limit:
            return f"{say.BALLAST(share=share)}; {say.SHARE_ALLOWED(limit=self.row.limit)}"
        return max(needed, 0.0)

    def _with(self, one: Deficiency, ballast: float) -> Scene:
        at = self.row.limit_high * one.scene.parameters["cg_height"].value
        return self.change(one.scene, {"mass": ballast, "height": at})

    def _of(self, one: Deficiency, amounts: Sequence[float]) -> Proposal:
        candidates = []
        for ballast in amounts:
            lowered = self._with(one, ballast)
            numbers = {
                "mass": (ballast, "kg"),
                "height": (self.row.limit_high * one.scene.parameters["cg_height"].value, "m"),
                "cg_height": (lowered.parameters["cg_height"].value, "m"),
            }
            candidates.append(Candidate(numbers, (Trial(lowered),), mark_of="standing"))
        return Proposal(tuple(candidates))


def _lies(item: Item) -> bool:
    """Say whether a vessel lies on its side: what is put into it lies on its wall, and runs out at its mouth."""
    plan = [side for side in (item.width_m, item.depth_m) if side]
    long = len(plan) > 1 and max(plan) > LYING * max(min(plan), item.height_m or 0.0)
    return long or _ON_ITS_SIDE.search(f"{item.title}; {item.displayed}") is not None
