"""Fixings that hold an object by a number of pieces: what is asked of them, and the fewest that hold it."""

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import inf, nan, pi
from typing import ClassVar

import numpy as np

from pipeline.analysis.footing import rolling
from pipeline.analysis.model_runs import run_model
from pipeline.analysis.scene_parameters import material_of
from pipeline.mitigate.fixing_rows import FixingStrength, fixing_strengths
from pipeline.mitigate.measures.base import (
    NOT_FREE,
    UNKNOWN_SECTION,
    Measure,
    bends,
    held,
    knows_section,
    may_be_held,
)
from pipeline.mitigate.proposals import Candidate, Deficiency, Numbers, Proposal, refused
from pipeline.mitigate.trials import Trial, TrialRunner
from pipeline.models.common import N_
from pipeline.models.stress import FLEXIBLE_STRESS
from pipeline.records import Check, Estimate, Finding, Item, Scene, Support
from pipeline.records import phrases as say
from pipeline.records.numerics import HISTORIES
from pipeline.tables.assumed import AssumedValues
from pipeline.tables.finish_rows import FinishRow, finishes_in
from pipeline.tables.surface_rows import surfaces_in

HOLDS = ("force", "moment")
"""Numbers of a measure that holds an object at its base."""

SIDEWAYS, TIPPING = "What the fixing holds sideways", "What the fixing holds against tipping"
"""What a fixing is asked, in the words of a report."""


ROUNDING = 1e-9
"""Relative, by which what is just enough may come out short."""

CLOTH = N_("paper, textile or leather")
"""What is said of the row "paper" of materials.csv, which is of all these."""

HARMLESS = "Nothing is known against it on such a material."
"""What is said of a fixing on a material that it neither harms nor needs care on."""


FINISHED = (
    "It has paint, gilding or lacquer: have a conservator say first where it may be touched; nothing may press on "
    "such a layer, rub it or stick to it."
)
"""Follows the sentence of a measure that touches a thing whose surface comes off."""

UNSCREWED = frozenset({"glass"})
"""Surfaces into which nobody screws: rows of surfaces.csv, in small letters."""


def force_and_moment(scene: Scene, runner: TrialRunner, findings: Sequence[Finding]) -> Numbers:
    """Return what a fixing at the base must hold, without the help of the weight.

    Parameters
    ----------
    scene : Scene
        The object as it stands.
    runner : TrialRunner
    findings : sequence of Finding
        Of the object held at its base; a flexible one pushes by its pseudo-acceleration.

    Returns
    -------
    mapping of str to (float, str)
        ``force`` [N] and ``moment`` [N m].

    References
    ----------
    Agbabian et al. (1991), sec. 2.3.
    """
    push = runner.push
    if any(f.model == FLEXIBLE_STRESS.name for f in findings):
        best, most = _pseudo_acceleration(scene, runner)
        frequency = scene.parameters["frequency"]
        # All ends of an estimated frequency, its damping and its furniture at once are one resonance upon another: no
        # mount is made for that.
        push = max(push, most if frequency.low == frequency.high else best)
    force = scene.parameters["mass"].high * push
    return {"force": (force, "N"), "moment": (force * scene.parameters["cg_height"].high, "N m")}


def _pseudo_acceleration(scene: Scene, runner: TrialRunner) -> tuple[float, float]:
    """Return what its oscillator feels [m/s2], in the worst direction: by the best estimates, and at most."""
    return _pseudo_accelerations([scene], runner)[0]


def _pseudo_accelerations(scenes: Sequence[Scene], runner: TrialRunner) -> list[tuple[float, float]]:
    """Return the same of several; each oscillator is run once, together with the others that are new."""
    keys = [(scene.parameters["frequency"], scene.parameters["damping"]) for scene in scenes]
    known: dict[tuple[Estimate, Estimate], tuple[float, float]] = runner.once("pseudo-accelerations", dict)
    fresh = [key for key in dict.fromkeys(keys) if key not in known]
    if fresh:
        sets = [one for f, zeta in fresh for one in _oscillators(f, zeta)]
        values = {q.name: np.ones(len(sets)) for q in FLEXIBLE_STRESS.needs}
        values |= zip(("frequency", "frequency_high", "damping"), np.transpose(sets), strict=True)
        best, most = np.zeros(len(fresh)), np.zeros(len(fresh))
        for level in runner.levels:
            ran = (run_model(FLEXIBLE_STRESS, motion, values, HISTORIES, None)[0] for motion in level.motions)
            felt = [columns["pseudo_acceleration"] for columns in ran]
            best = np.maximum(best, level.over([one[::3] for one in felt]))
            most = np.maximum(most, level.over([one.reshape(-1, 3).max(axis=1) for one in felt]))
        known.update(zip(fresh, zip(best.tolist(), most.tolist(), strict=True), strict=True))
    return [known[key] for key in keys]


def _oscillators(f: Estimate, zeta: Estimate) -> tuple[tuple[float, float, float], ...]:
    """Return the best oscillator, and all that it may be at both ends of the damping: frequencies, and damping."""
    low, high = (f.low, f.high) if f.low < f.high else (f.value, nan)
    return (f.value, nan, zeta.value), (low, high, zeta.low), (low, high, zeta.high)


@dataclass(frozen=True)
class HoldingDemand:
    """Demand on what holds an object where it stands.

    Attributes
    ----------
    force, worst_force : float
        Sideways [N], without the help of friction: by the best estimates, of its furniture too, and all that is
        uncertain at its worse end.
    moment, worst_moment : float
        That lifts the base off, the weight holding it down [N m].
    """

    force: float
    worst_force: float
    moment: float
    worst_moment: float

    @classmethod
    def of(cls, scene: Scene, runner: TrialRunner) -> "HoldingDemand":
        """Return what an object asks of its fixing.

        Notes
        -----
        m |a_h|, and m (|a_h| h - N b) about the nearer edge, over time and in any direction.  The moment rises with h
        and falls with b, and where it lifts at all it rises with m: the worst is at the high m and h and the low b
        together.  What bends is pushed by its pseudo-acceleration, as many times as that exceeds A_max.
        """
        p = scene.parameters
        mass, cg, half = p["mass"], p["cg_height"], p["half_width"]
        usual, most_pushed = runner.usual_push, runner.push
        push, worst = usual, most_pushed
        if bends(scene):
            felt, most_felt = _pseudo_acceleration(scene, runner)
            push, worst = max(push, felt), max(worst, most_felt)
        times, most = (one / of if of > 0.0 else 1.0 for one, of in ((push, usual), (worst, most_pushed)))
        return cls(
            mass.value * push,
            mass.high * worst,
            mass.value * runner.tipping(times * cg.value, half.value, usual=True),
            mass.high * runner.tipping(most * cg.high, half.low),
        )


@dataclass(frozen=True)
class Reach:
    """Reach of a fixing: what its strength is multiplied by.

    Attributes
    ----------
    sideways : float
        Of the strength in shear [m2 or -].
    tipping : float
        Of the strength in tension [m3 or m]; infinite where the fixing is not asked to.
    """

    sideways: float
    tipping: float


@dataclass(frozen=True)
class Fixing(Measure, ABC):
    """Hold it by as many pieces of a fixing as its weight and the shaking ask for.

    First as many as hold at the low end of their strength with all that is uncertain of the object at its worse end;
    where there are none, as many as hold the factor of the table times what is needed, all by the best estimates.  Held
    so it neither slides nor rocks, and its section must bear the push.

    References
    ----------
    Agbabian et al. (1991), sec. 2.3 (held at its base); strengths: tables/fixings.csv.
    """

    gives: ClassVar[tuple[str, ...]] = ("pieces", "size", "margin", *HOLDS, "care")
    fastens: ClassVar[bool] = True
    touches: ClassVar[bool] = True
    phrases: ClassVar[tuple[str, ...]] = (SIDEWAYS, TIPPING, HARMLESS)
    at_foot: ClassVar[bool] = True
    """Whether its pieces hold an object at its foot."""
    screwed: ClassVar[bool] = False
    """Whether its pieces are screwed to what the object stands on."""

    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:  # noqa: ARG002
        """Return it held at its base."""
        return held(scene)

    def prepare(self, objects: Sequence[Deficiency], runner: TrialRunner) -> None:
        """Find what all flexible ones feel together: one by one costs hundreds of times as much."""
        free = [one.scene for one in objects if one.scene.support is Support.FREESTANDING and knows_section(one.scene)]
        _pseudo_accelerations([scene for scene in free if bends(scene)], runner)

    @property
    def strength(self) -> FixingStrength:
        """Its row of fixings.csv, or that of the measure that it is like."""
        rows = fixing_strengths()
        return rows.get(self.row.name) or rows[self.name]

    @abstractmethod
    def reach(self, scene: Scene, pieces: int, size: float, worst: bool) -> Reach:
        """Return what the strength of a piece is multiplied by.

        Parameters
        ----------
        scene : Scene
            The object.
        pieces : int
            How many there are.
        size : float
            Diameter of each [m]; 0 where it has the one size.
        worst : bool
            Whether its base is at its worse end, and not as best known.
        """

    def room(self, scene: Scene, worst: bool) -> float:  # noqa: ARG002
        """Return the area that all pieces together may have [m2]."""
        return inf

    def unsuited(self, scene: Scene, demand: HoldingDemand, worst: bool) -> str:  # noqa: ARG002
        """Say why it cannot hold such an object, "" where it may."""
        return ""

    def ample(self, scene: Scene) -> bool:  # noqa: ARG002
        """Say whether as much of it is used as there is room for, where its weight is not known for sure."""
        return False

    def suits(self, scene: Scene) -> bool:
        """Say whether an object of its class can be held so."""
        return not self.row.classes or scene.object_class in self.row.classes

    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose the fewest and smallest pieces that hold it for sure, then those that do by the best estimates."""
        scene = one.scene
        if scene.support is not Support.FREESTANDING:
            return NOT_FREE
        if not self.suits(scene):
            return refused(N_("objects of its kind cannot be held so"))
        if not may_be_held(scene) or not {"half_width", "cg_height"} <= set(scene.parameters):
            return UNKNOWN_SECTION
        if self.at_foot and rolling(scene.item, scene.object_class) is not None:
            return refused(N_("it stands on wheels, and has no foot to be held by"))
        if self.screwed and on_glass(scene.item):
            return refused(N_("it stands on glass, into which nothing is screwed"))
        material, lies_on_it = touched(scene.item, runner.values), finishes(scene.item, runner.values)
        if material in self.strength.harms:
            return refused(say.HARMS(material=CLOTH if material == "paper" else material))
        if any(self.strength.fixing in one.harms for one in lies_on_it):
            return refused(N_("it harms paint and lacquer"))
        demand = HoldingDemand.of(scene, runner)
        care = self.strength.care if material in self.strength.care_for else "" if lies_on_it else HARMLESS
        found = (self._candidate(one, demand, care, worst) for worst in (True, False))
        candidates = tuple(candidate for candidate in found if candidate is not None)
        if candidates:
            return Proposal(candidates)
        return refused(self.unsuited(scene, demand, False) or self._short(scene, demand))

    def _sets(self, scene: Scene, worst: bool) -> Iterator[tuple[int, float]]:
        room = self.room(scene, worst)
        for pieces, size in product(self.strength.pieces, self.strength.sizes or (0.0,)):
            if pieces * dot(size) <= room * (1.0 + ROUNDING):
                yield pieces, size

    def _candidate(self, one: Deficiency, demand: HoldingDemand, care: str, worst: bool) -> Candidate | None:
        if self.unsuited(one.scene, demand, worst):
            return None
        least = 1.0 if worst else self.strength.factor
        held = ((self.holds(one.scene, demand, *some, worst), *some) for some in self._sets(one.scene, worst))
        enough = (some for some in held if some[0] >= least)
        found = max(enough, default=None) if not worst and self.ample(one.scene) else next(enough, None)
        return None if found is None else self._of(one, demand, *found[1:], at_best=not worst, care=care)

    def holds(self, scene: Scene, demand: HoldingDemand, pieces: int, size: float, worst: bool) -> float:
        """Return how many times what is needed so many pieces hold [-].

        Parameters
        ----------
        scene, demand
            The object, and what it asks.
        pieces, size
            As in `reach`.
        worst : bool
            Whether all that is uncertain of the object and the strength are at their worse ends, and not as best known.
        """
        reach, row = self.reach(scene, pieces, size, worst), self.strength
        force, moment = (demand.worst_force, demand.worst_moment) if worst else (demand.force, demand.moment)
        shear, tension = (row.shear_low, row.tension_low) if worst else (row.shear, row.tension)
        return min(_times(reach.sideways * shear, force), _times(reach.tipping * tension, moment))

    def _of(
        self, one: Deficiency, demand: HoldingDemand, pieces: int, size: float, *, at_best: bool, care: str
    ) -> Candidate:
        row, reach = self.strength, self.reach(one.scene, pieces, size, False)
        asked = (
            (SIDEWAYS, demand.force, reach.sideways * row.shear, "N"),
            (TIPPING, demand.moment, reach.tipping * row.tension, "N m"),
        )
        # A fixing that need not hold it against tipping is not asked to.
        checks = tuple(
            Check(self.name, title, needed, unit, has, needed / has, passes=True)
            for title, needed, has, unit in asked
            if has < inf
        )
        numbers: dict[str, tuple[float, str]] = {
            "pieces": (float(pieces), "-"),
            "margin": (min(_times(has, needed) for _, needed, has, _ in asked), "-"),
            "force": (demand.force, "N"),
            "moment": (demand.moment, "N m"),
        }
        if size:
            numbers["size"] = (size, "m")
        trial = Trial(self.in_place(one, numbers))
        return Candidate(
            numbers,
            (trial,),
            checks=tuple(("", check) for check in checks),
            words={"care": care},
            at_best=at_best,
        )

    def _short(self, scene: Scene, demand: HoldingDemand) -> str:
        most = max((self.holds(scene, demand, *some, False) for some in self._sets(scene, False)), default=0.0)
        if most <= 0.0:
            return N_("there is no room for it under its base")
        return say.HOLDS_AT_MOST(times=most, asked=self.strength.factor)


def on_glass(item: Item) -> bool:
    """Say whether it stands on what nobody screws into."""
    return bool(UNSCREWED.intersection(surfaces_in(item.surface_material, of_surface=True)))


def dot(size: float) -> float:
    """Return the area of a round piece [m2] of a diameter [m]."""
    return 0.25 * pi * size**2


def touched(item: Item, values: AssumedValues) -> str:
    """Return the name of the material that a fixing touches: of its base where that is recorded."""
    return (values.material_in(item.base_material) or material_of(item, values)).name


def finishes(item: Item, values: AssumedValues) -> tuple[FinishRow, ...]:
    """Return what lies on an object's surface and comes off where it is touched: paint, gilding, lacquer."""
    text = f"{item.material}; {item.medium}"
    made_of = {one.name for one in values.materials_in(text)} | {touched(item, values)}
    return finishes_in(text, frozenset(made_of))


def _times(capacity: float, demand: float) -> float:
    return capacity / demand if demand > 0.0 else inf
