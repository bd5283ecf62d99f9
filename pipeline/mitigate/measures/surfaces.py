"""Rougher surfaces under an object: one of the paper's Table 3, or a non-slip pad."""

from abc import ABC
from collections.abc import Mapping
from typing import ClassVar

from pipeline.analysis.footing import rolling
from pipeline.analysis.scene_parameters import material_of
from pipeline.mitigate.measures.base import FRICTION, NOT_FREE, Measure, movement, on_surface
from pipeline.mitigate.proposals import Candidate, Deficiency, Proposal, refused
from pipeline.mitigate.trials import Trial, TrialRunner
from pipeline.models.common import N_
from pipeline.records import Furniture, Scene, Support


class _RougherSurface(Measure, ABC):
    """A surface that it does not slide on so far; it must not rock there.

    References
    ----------
    Agbabian et al. (1991), sec. 2.2 and Table 3.
    """

    gives: ClassVar[tuple[str, ...]] = ("friction", "movement")
    limits = 1
    limit_unit = "-"
    parameters = (FRICTION,)

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:
        """Return it on a surface of ``friction`` [-]."""
        return on_surface(scene, parameters)

    @staticmethod
    def unsuited(one: Deficiency) -> Proposal | None:
        """Return why no surface suits it, None where one may."""
        if one.scene.support is not Support.FREESTANDING:
            return NOT_FREE
        if rolling(one.scene.item, one.scene.object_class) is not None:
            return refused(N_("it rolls, whatever its wheels stand on"))
        if one.rocks:
            return refused(N_("it may rock: a surface that holds it does not keep it upright"))
        return None


FUMING = frozenset({"plywood"})
"""Surfaces of Table 3 that give off acids: in the air of a case these corrode lead and bronze, shell and some glasses.

AIC Wiki, Safe and Harmful Materials for Use in Exhibits: plywood gives off formic and acetic acid.
"""


class Surface(_RougherSurface):
    """Put it on the least rough surface of Table 3 that is rougher than its own and holds its base well enough."""

    name = "surface"
    gives = ("friction", "movement", "surface")

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose the surfaces of Table 3 for the material of its base, least rough first."""
        refusal = self.unsuited(one)
        if refusal:
            return refusal
        item = one.scene.item
        material = (item.base_material or material_of(item, runner.values).friction_as).strip().lower()
        least = one.scene.parameters["friction_static"].low
        # What only a handbook or judgement says of a pair is too wide a range to advise it by.
        measured = (row for row in runner.values.friction if row.own or row.table == row.printed)
        pairs = [(row.low, row.surface_material) for row in measured if row.object_material.lower() == material]
        rougher = sorted(pair for pair in pairs if least < pair[0] <= self.row.limit)
        harmless = [pair for pair in rougher if pair[1].lower() not in FUMING]
        if one.scene.furniture is Furniture.SHOWCASE and rougher and not harmless:
            return refused(N_("in a case plywood gives off acids that corrode metals, shell and glass"))
        candidates = []
        for friction, surface in harmless if one.scene.furniture is Furniture.SHOWCASE else rougher:
            numbers = {"friction": (friction, "-")}
            trial = Trial(self.in_place(one, numbers))
            words = {"surface": surface.lower()}
            candidates.append(Candidate(numbers, (trial,), words=words, finish=movement, mark_of="sliding"))
        if not candidates:
            return refused(N_("Table 3 has no rougher surface for the material of its base"))
        return Proposal(tuple(candidates))


class GripPad(_RougherSurface):
    """Put it on a non-slip pad."""

    name = "grip_pad"

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:  # noqa: ARG002
        """Propose a pad of the friction of the row."""
        refusal = self.unsuited(one)
        if refusal:
            return refusal
        return self.one_trial(one, {"friction": (self.row.limit, "-")}, finish=movement, mark_of="sliding")
