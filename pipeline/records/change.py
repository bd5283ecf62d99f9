"""Changes from one run to another, and their causes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from pipeline.records.decision import Decision
from pipeline.records.news import ObjectChange
from pipeline.records.result import Verdict


@dataclass(frozen=True, slots=True)
class ObjectPlace:
    """An object and the gallery it is in, or was in where it is gone.

    Attributes
    ----------
    object_number, gallery : str
        As the inventory has them.
    """

    object_number: str
    gallery: str


@dataclass(frozen=True, slots=True)
class Move:
    """An object of both runs that changed its gallery.

    Attributes
    ----------
    object_number : str
        As the inventory has it.
    before, after : str
        Its galleries.
    """

    object_number: str
    before: str
    after: str


@dataclass(frozen=True, slots=True)
class FieldChange:
    """A named value before and after.

    Attributes
    ----------
    name : str
        Of the field, setting or version.
    before, after : Any
        JSON-ready; None where there was none.
    """

    name: str
    before: Any
    after: Any


@dataclass(frozen=True, slots=True)
class InputChange:
    """An object of both runs whose record or estimates differ.

    Attributes
    ----------
    object_number, gallery : str
        As the inventory has them.
    fields : tuple of FieldChange
        Of the item by their names; of the scene as "scene.support", its parameters as "parameters.half_width"; the
        gallery is not among them (see `Move`), nor the floor that follows from it.
    """

    object_number: str
    gallery: str
    fields: tuple[FieldChange, ...]


@dataclass(frozen=True, slots=True)
class MotionChange:
    """A motion of a level on a floor whose samples changed.

    Attributes
    ----------
    level, floor, name : str
        Where it is felt ("" for the ground), and what it is called.
    before, after : tuple of str or None
        Hashes of the samples, in order, where one name stands for several motions of the level; None on the side where
        there was none of that name.
    """

    level: str
    floor: str
    name: str
    before: tuple[str, ...] | None
    after: tuple[str, ...] | None


class CauseKind(StrEnum):
    """Kind of a cause why a verdict may have changed, in the order in which causes are named."""

    INPUT = "input"
    DECISION = "decision"
    FLOOR = "floor"
    MOTION = "motion"
    SETTINGS = "settings"
    VERSION = "version"


@dataclass(frozen=True, slots=True)
class Cause:
    """One thing that changed and that a verdict rests on.

    Attributes
    ----------
    kind : CauseKind
        Of what kind it is.
    what : str
        The field, motion, setting or decision.
    """

    kind: CauseKind
    what: str


@dataclass(frozen=True, slots=True)
class VerdictChange:
    """A verdict of an object of both runs that changed.

    Where a model gives several findings at a level (tension, shear), its verdict is the worst of them.

    Attributes
    ----------
    object_number, gallery, model, level : str
        Which verdict.
    before, after : Verdict or None
        None on the side where the model gave no finding.
    causes : tuple of Cause
        All that changed of what the verdict rests on; empty where nothing that the runs keep differs.
    """

    object_number: str
    gallery: str
    model: str
    level: str
    before: Verdict | None
    after: Verdict | None
    causes: tuple[Cause, ...] = ()

    @property
    def fixed(self) -> bool:
        """Whether it failed and passes."""
        return self.before is Verdict.FAIL and self.after is Verdict.PASS

    @property
    def worsened(self) -> bool:
        """Whether it passed and does no longer."""
        return self.before is Verdict.PASS and self.after in (Verdict.FAIL, Verdict.UNDETERMINED)


@dataclass(frozen=True, slots=True)
class DecisionChange:
    """A decision that is new in force, or no longer in force.

    Attributes
    ----------
    decision : Decision
        The decision itself.
    new : bool
        Whether it is new.
    """

    decision: Decision
    new: bool


@dataclass(frozen=True, slots=True)
class RunChanges:
    """All that changed from one run to another, each in the order of gallery and object number.

    Attributes
    ----------
    old, new : str
        The runs' names.
    added, removed : tuple of ObjectPlace
        Objects of one run alone.
    moved : tuple of Move
        Objects in another gallery.
    inputs : tuple of InputChange
        Objects with other records or estimates.
    verdicts : tuple of VerdictChange
        Verdicts that differ.
    motions : tuple of MotionChange
        Motions that differ.
    decisions : tuple of DecisionChange
        Decisions that are new, or no longer in force.
    settings, versions : tuple of FieldChange
        Of the runs themselves, by name, those only that verdicts rest on.
    started : str
        When the older run began (ISO 8601).
    objects : tuple of ObjectChange
        News of objects one by one, in the order in which it is told.
    shared : mapping of str to int
        How many objects there is news of only because motions, floors, settings or Kouros itself changed, by the kind
        of the news: these are not among the objects.
    """

    old: str
    new: str
    added: tuple[ObjectPlace, ...] = ()
    removed: tuple[ObjectPlace, ...] = ()
    moved: tuple[Move, ...] = ()
    inputs: tuple[InputChange, ...] = ()
    verdicts: tuple[VerdictChange, ...] = ()
    motions: tuple[MotionChange, ...] = ()
    decisions: tuple[DecisionChange, ...] = ()
    settings: tuple[FieldChange, ...] = ()
    versions: tuple[FieldChange, ...] = ()
    started: str = ""
    objects: tuple[ObjectChange, ...] = ()
    shared: Mapping[str, int] = field(default_factory=dict)

    def __bool__(self) -> bool:
        """Whether anything changed."""
        objects = self.objects or self.shared or self.added or self.removed or self.moved or self.inputs
        return bool(objects or self.verdicts or self.motions or self.decisions or self.settings or self.versions)

    @property
    def fixed(self) -> tuple[VerdictChange, ...]:
        """The verdicts that were fail and are pass."""
        return tuple(change for change in self.verdicts if change.fixed)

    @property
    def worsened(self) -> tuple[VerdictChange, ...]:
        """The verdicts that were pass and are fail or undetermined."""
        return tuple(change for change in self.verdicts if change.worsened)

    @property
    def others(self) -> tuple[VerdictChange, ...]:
        """The other verdicts that changed."""
        return tuple(change for change in self.verdicts if not (change.fixed or change.worsened))
