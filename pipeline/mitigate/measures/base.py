"""The contract of a measure, and what several of them share."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from math import ceil, isfinite
from typing import ClassVar

from pipeline.analysis.classify import models_of
from pipeline.analysis.flexibility import concentration
from pipeline.analysis.hanging import OF_HANGING, hanging_estimates, hanging_of
from pipeline.analysis.scene_parameters import material_of
from pipeline.mitigate.proposals import Candidate, Deficiency, Numbers, Proposal, refused
from pipeline.mitigate.rows import MeasureRow
from pipeline.mitigate.trials import Trial, TrialRunner
from pipeline.models import settled_by_room
from pipeline.models.common import N_
from pipeline.models.sliding import SLIDING
from pipeline.models.stress import FLEXIBLE_STRESS
from pipeline.quantities import Quantity
from pipeline.records import Check, Estimate, Finding, Hanging, Item, Mount, Origin, Scene, Support, Verdict

MARGIN = 1.1
"""Room asked for over the largest demand of the uncertain inputs: the error of the motion is not in it."""

SPARE = 1.01
"""Margin on sizes that are found in closed form and then run: 1 %, so that rounding never decides."""

NOT_FREE = refused(N_("it does not stand free"))
UNKNOWN_FREQUENCY = refused(N_("how fast it sways is only estimated: its natural frequency must be measured first"))
UNKNOWN_SECTION = refused(
    N_("its mass or critical section is not known, so the stress of a held base cannot be checked")
)

SECTION = ("mass", "lever", "area", "section_modulus", "allowable_stress")
"""What must be known for the stress of a critical section."""

FRICTION = Quantity("friction", "-", "friction of the surface", 0.0, 2.0, exclusive=True)
CLEARANCE = Quantity("clearance", "m", "room on all sides", 0.0, 100.0)
FREQUENCY = Quantity("frequency", "Hz", "natural frequency", 0.0, 100.0, exclusive=True)
DAMPING = Quantity("damping", "-", "ratio to critical damping", 0.0, 1.0)


@dataclass(frozen=True)
class Measure(ABC):
    """A measure: everything about it but the words and limits of its row of measures.csv.

    In order to write a measure:

    1. Derive a class from `Measure`, in a file of its own, and give it a `name`: that by which tables, decisions and
       exports know it.
    2. Say in `gives` for which numbers and words its sentence may ask, in `limits` how many limits its row needs (0 to
       2: ``limit``, ``limit_high``) and in `limit_unit` their unit.
    3. Implement `propose`: from what was found of an object to the things to build or buy, gentlest first, each with
       the trials that it must pass.  It decides nothing itself: the search runs the trials and takes the first
       candidate of which all trials and checks pass.  Where it does not suit, it says why (`refused`).
    4. Implement `change`: the scene of an object with the measure in place.  Trials and measures that people say are
       installed (`kouros decide NUMBER installed NAME`) are the same change.
    5. Say in `parameters` what `change` must be told of one that is installed; `numbers` of a candidate have them all.
    6. Where it acts on what several objects stand on, set `shared` and implement `propose_shared`, which proposes for
       all objects of a case at once.  Where it stands between object and floor, name the model of it in `isolator`.
    7. Where it is worth advising although only the assumed room, or furniture that may fall, leaves a verdict open, set
       `for_room`; where it
       holds an object and may be advised by the best estimates, before any isolator, set `fastens`.
    8. Where running many objects at once is cheaper, do that in `prepare`.
    9. Name the class in `pipeline.mitigate.measures.MEASURES`, and give it a row in tables/measures.csv.  In another
       package, name the class in the entry points of the group ``kouros.measures`` and give it its `own_row`.

    A museum's row of another name (column ``like``) is another instance of the same class, with a `row` of its own.

    Parameters
    ----------
    row : MeasureRow
        Name, order, limits, words and source.

    Attributes
    ----------
    name : str
        Small letters, digits and "_".
    gives : tuple of str
        Names that its sentence may have in braces.
    limits : int
        How many limits its row needs.
    limit_unit : str
        Unit of the limits, SI or "-"; "" where there are none.
    parameters : tuple of Quantity
        What must be known of one that is installed.
    shared : bool
        Whether all objects of a case share it.
    for_room : bool
        Whether it is worth advising where only the assumed room, or furniture that may fall, leaves the verdict open.
    fastens : bool
        Whether it holds an object: where nothing else is sure, it is advised if it passes by the best estimates.
    sticks : bool
        Whether it sticks an object down by wax or putty.
    touches : bool
        Whether something presses on the object, rubs it or sticks to it: what is painted or gilded is told so.
    isolator : str
        Model of what it puts under an object; "" for nothing.
    mounts : bool
        Whether an object is held on that isolator, in place of standing on it as it stood.
    last_resort : bool
        Whether it is always possible, and comes after all others.
    phrases : tuple of str
        What reports show of it that is neither in its row nor a name: for the catalogues of translations.
    own_row : mapping of str to str, or None
        Its row, as measures.csv would have it; None where that has one.
    """

    name: ClassVar[str]
    gives: ClassVar[tuple[str, ...]] = ()
    limits: ClassVar[int] = 0
    limit_unit: ClassVar[str] = ""
    parameters: ClassVar[tuple[Quantity, ...]] = ()
    shared: ClassVar[bool] = False
    for_room: ClassVar[bool] = False
    fastens: ClassVar[bool] = False
    sticks: ClassVar[bool] = False
    touches: ClassVar[bool] = False
    isolator: ClassVar[str] = ""
    mounts: ClassVar[bool] = False
    last_resort: ClassVar[bool] = False
    phrases: ClassVar[tuple[str, ...]] = ()
    own_row: ClassVar[Mapping[str, str] | None] = None

    row: MeasureRow

    @abstractmethod
    def propose(self, one: Deficiency, runner: TrialRunner) -> Proposal:
        """Propose something for one object.

        Parameters
        ----------
        one : Deficiency
            The object, and what was found of it.
        runner : TrialRunner
            The shaking that it has to bear, and what isolators there are.

        Returns
        -------
        Proposal
        """

    @abstractmethod
    def change(self, scene: Scene, parameters: Mapping[str, float]) -> Scene:
        """Return the scene of an object with the measure in place.

        Parameters
        ----------
        scene : Scene
            As it stands.
        parameters : mapping of str to float
            By name [SI]: at least those of `parameters`.

        Returns
        -------
        Scene

        Raises
        ------
        KeyError
            Where a parameter of the measure or of the scene is not known.
        """

    def propose_shared(self, objects: Sequence[Deficiency], runner: TrialRunner) -> Proposal:
        """Propose something for all objects that stand in one case, or for one that stands alone.

        Parameters
        ----------
        objects : sequence of Deficiency
        runner : TrialRunner

        Returns
        -------
        Proposal
        """
        return self.propose(objects[0], runner)

    def prepare(self, objects: Sequence[Deficiency], runner: TrialRunner) -> None:  # noqa: B027
        """Run for all objects at once what proposals for each of them then find done."""

    def charted(self, scenes: Sequence[Scene]) -> list[Scene]:  # noqa: ARG002
        """Return scenes with the measure in place that one response chart could serve, of many objects."""
        return []

    def called(self, item: Item) -> tuple[str, str, str]:  # noqa: ARG002
        """Return name, title and sentence of the measure as an object is advised it."""
        return self.row.name, self.row.title, self.row.sentence

    def in_place(self, one: Deficiency, numbers: Numbers) -> Scene:
        """Return the scene of an object on its floor with the measure in place."""
        return self.change(one.scene, {name: value for name, (value, _) in numbers.items()})

    def one_trial(
        self,
        one: Deficiency,
        numbers: Numbers,
        *,
        finish: Callable[[Sequence[Finding]], Numbers],
        checks: tuple[tuple[str, Check], ...] = (),
        mark_of: str = "",
    ) -> Proposal:
        """Return the proposal of a single candidate whose only trial is the object with the measure in place."""
        trial = Trial(self.in_place(one, numbers))
        return Proposal((Candidate(numbers, (trial,), checks=checks, finish=finish, mark_of=mark_of),))


def may_be_held(scene: Scene) -> bool:
    """Say whether enough is known of it to hold it: its section, or that it is an open frame which has no one such.

    Of a frame it is for whoever makes the mount to see that it bears the push.
    """
    return knows_section(scene) or _framework(scene)


def _framework(scene: Scene) -> bool:
    body = {"mass", "half_width", "cg_height"} <= scene.parameters.keys()
    return scene.mount is None and body and "section_modulus" not in scene.parameters and not scene.missing


def round_up(value: float, step: float = 0.01) -> float:
    """Round up to the next whole step, a centimetre where nothing else is said."""
    return round(step * ceil(value / step - 1e-9), 12) if isfinite(value) else value


def knows_section(scene: Scene) -> bool:
    """Say whether the stress of its critical section can be computed, or nothing of it need be weak."""
    if scene.mount is not None:
        return "mass" in scene.parameters
    return all(name in scene.parameters for name in SECTION)


def exactly(value: float, unit: str, note: str) -> Estimate:
    """Return the estimate of what is built to a number."""
    return Estimate(value, unit, Origin.DERIVED, value, value, note)


def with_parameters(scene: Scene, **found: Estimate) -> Scene:
    """Return a scene with some of its parameters replaced or added."""
    return replace(scene, parameters={**scene.parameters, **found})


GRIPPED = 100.0
"""Friction [-] of what cannot slide."""


def held(scene: Scene) -> Scene:
    """Return it held at its base: it neither rocks nor slides, and its critical section bears the push.

    What lies or is held by a mount has no section that is known to be weak, nor has an open frame: it stays where it
    is.
    """
    if scene.mount is not None or _framework(scene):
        grips = exactly(GRIPPED, "-", "held by the measure: it does not slide")
        return replace(with_parameters(scene, friction_static=grips), mount=Mount.SECURED, models=(SLIDING.name,))
    return replace(fixed_at_base(scene), support=Support.FASTENED, models=models_of(Support.FASTENED))


def fixed_at_base(scene: Scene) -> Scene:
    """Return it fixed to what it stands on: what concentrates the stress in its critical section counts."""
    concentrated = concentration(scene.item, material_of(scene.item)) if knows_section(scene) else None
    if concentrated is not None and scene.support is not Support.FASTENED:
        scene = with_parameters(scene, concentration=concentrated)
    return scene


def rehung(scene: Scene, way: Hanging) -> Scene:
    """Return a work on a wall hung in another way: what was known or assumed of how it hung is forgotten."""
    gone = {name: one for name, one in scene.parameters.items() if name in OF_HANGING}
    kept = {name: one for name, one in scene.parameters.items() if name not in gone}
    found = hanging_estimates(scene.item, hanging_of(replace(scene.item, hanging=way), scene.object_class))
    notes = {one.note for one in gone.values()}
    return replace(
        scene,
        hanging=way,
        models=models_of(Support.HUNG),
        parameters=kept | found,
        assumptions=tuple(text for text in scene.assumptions if text not in notes),
    )


def bends(scene: Scene) -> bool:
    """Say whether it is flexible where it is held at its base."""
    return "frequency" in scene.parameters and not FLEXIBLE_STRESS.applies(held(scene))


def cleared(scene: Scene, parameters: Mapping[str, float]) -> Scene:
    """Return it with room around it: ``clearance`` [m]."""
    return with_parameters(scene, clearance=exactly(parameters["clearance"], "m", "clearance given by the measure"))


def on_surface(scene: Scene, parameters: Mapping[str, float]) -> Scene:
    """Return it on another surface: ``friction`` [-]."""
    found = exactly(parameters["friction"], "-", "friction of the new surface")
    return with_parameters(scene, friction_static=found)


def isolated(scene: Scene, kind: str) -> Scene:
    """Return the scene of the isolator under it: only the isolator's own demand.

    What stands on it is run on what the isolator passes on.
    """
    return replace(scene, support=Support.ISOLATED, models=(kind,), item=replace(scene.item, isolator=kind))


def movement(findings: Sequence[Finding]) -> Numbers:
    """Return how far it moves in a trial [m]: at most, where that is within the room for sure; else as best known."""
    moves = [f for f in findings if settled_by_room(f.model)]
    far = [(f.high if f.verdict is Verdict.PASS else f.demand) or 0.0 for f in moves]
    return {"movement": (max(far, default=0.0), "m")}
