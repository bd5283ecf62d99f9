"""Changes from one run to another, their causes, and what people are told of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import StrEnum
from typing import Any

from pipeline.records.decision import Decision
from pipeline.records.likelihood import Band
from pipeline.records.result import State, Verdict


@dataclass(frozen=True, slots=True)
class Brief:
    """What a run says of an object, in short.

    Attributes
    ----------
    state : State or None
        Where it stands; None where an earlier version of Kouros did not keep that.
    band : str
        The word for how likely harm is, a `Band`; "" where nobody asked.
    measure, advice : str
        Row of tables/measures.csv that is advised first, and its title; "" for nothing.
    missing : str
        What is not recorded that its models need, the first of it; "" for nothing.
    check : bool
        Whether its sizes are to be checked before anything is done about it.
    """

    state: State | None = None
    band: str = ""
    measure: str = ""
    advice: str = ""
    missing: str = ""
    check: bool = False


class NewsKind(StrEnum):
    """Kind of news of an object, in the order in which it is told."""

    DANGER = "danger"
    WORSE = "worse"
    LOST = "lost"
    STILL = "still"
    FIXED = "fixed"
    BETTER = "better"
    NEW = "new"
    GONE = "gone"
    MOVED = "moved"
    DECIDED = "decided"


@dataclass(frozen=True, slots=True)
class Settled:
    """A decision about an object that is new in force, or no longer in force.

    Attributes
    ----------
    new : bool
        Whether it is new.
    measure : str
        Row of tables/measures.csv that it says is installed; "" for another decision.
    matter, who : str
        What was decided, and by whom.
    kind, object_class : str
        The `DecisionKind`, and the row of tables/classes.csv that it says the object is; "" where not known, or none.
    about : str
        What follows of the matter: which finding it is about, a product, its last day.
    date : str
        The day it was made (ISO 8601); "" where not known.
    """

    new: bool
    measure: str
    matter: str
    who: str
    kind: str = ""
    object_class: str = ""
    about: str = ""
    date: str = ""

    @classmethod
    def of(cls, decision: Decision, *, new: bool) -> Settled:
        """Return a decision as news tells it."""
        named = (decision.kind.value, decision.object_class, decision.about, decision.date)
        return cls(new, decision.measure, decision.matter, decision.who, *named)


@dataclass(frozen=True, slots=True)
class Ruled:
    """A house rule of which something is new for an object, or holds for it no longer.

    Attributes
    ----------
    new : bool
        Whether it is new.
    who, date : str
        Who says so, and when (ISO 8601).
    classes, about : tuple of str
        What it is for: rows of tables/classes.csv, and the museum's own galleries, numbers and materials.
    states : mapping of str to str
        What it states, by the keys of kouros.toml; "" for what is a number.
    back : tuple of str
        Who took it back, when (ISO 8601) and why; empty where nobody did.
    """

    new: bool
    who: str
    date: str
    classes: tuple[str, ...] = ()
    about: tuple[str, ...] = ()
    states: Mapping[str, str] = field(default_factory=dict)
    back: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class ObjectChange:
    """An object about which there is news.

    Attributes
    ----------
    object_number, title, gallery : str
        As the records have them, or had them where the object is gone.
    before, after : Brief or None
        What either run says of it; None where it was not on display.
    came_from : str or None
        Its gallery before, where it moved; else None.
    recorded : bool
        Whether the newer run's records still have it.
    decided : tuple of Settled
        Decisions about it that were made or ended.
    fields : tuple of str
        Fields of its record that changed.
    ruled : tuple of Ruled
        House rules that are new for it, or hold for it no longer.
    """

    object_number: str
    title: str
    gallery: str
    before: Brief | None
    after: Brief | None
    came_from: str | None = None
    recorded: bool = True
    decided: tuple[Settled, ...] = ()
    fields: tuple[str, ...] = ()
    ruled: tuple[Ruled, ...] = ()

    @property
    def installed(self) -> tuple[str, ...]:
        """The measures that are newly said to be installed."""
        return tuple(one.measure for one in self.decided if one.new and one.measure)

    @property
    def kind(self) -> NewsKind | None:
        """What kind of news it is; None for none."""
        was, now = self.before, self.after
        if was is None or now is None:
            return self._display(now) if was is not now else self._besides()
        if was.state is None or now.state is None:
            return self._besides()
        if State.UNKNOWN in (was.state, now.state):
            return self._known(was.state, now.state)
        if self.installed and was.state is now.state is State.ACT:
            return NewsKind.STILL
        before, after = _size(was), _size(now)
        if after > before:
            return NewsKind.WORSE
        if after < before:
            ended = now.state is State.FINE or (self.installed and now.state is not State.ACT)
            return NewsKind.FIXED if was.state is State.ACT and ended else NewsKind.BETTER
        return self._besides()

    def _display(self, now: Brief | None) -> NewsKind:
        if now is None:
            return NewsKind.GONE
        return NewsKind.DANGER if now.state is State.ACT else NewsKind.NEW

    def _known(self, was: State, now: State) -> NewsKind | None:
        if was is now:
            return self._besides()
        if now is State.UNKNOWN:
            return NewsKind.LOST
        return NewsKind.WORSE if now is State.ACT else NewsKind.BETTER

    def _besides(self) -> NewsKind | None:
        if self.came_from is not None and self.after is not None:
            return NewsKind.MOVED
        return NewsKind.DECIDED if self.decided else None

    @property
    def order(self) -> tuple[int, int, str, str]:
        """Sort key: the kind, what is likeliest to come to harm, gallery and number."""
        kind = self.kind
        band = _BANDS.get("" if self.after is None else self.after.band, len(_BANDS))
        return (len(_KINDS) if kind is None else _KINDS.index(kind), band, self.gallery, self.object_number)


_KINDS = tuple(NewsKind)
_BANDS = {band.value: at for at, band in enumerate(Band)}
_SIZES = {State.FINE: 0, State.WATCH: 1, State.ACT: 2}


def _size(brief: Brief) -> tuple[int, int]:
    """Return how bad it stands; words for probabilities count only of what is acted on: a proof beats them."""
    state = brief.state or State.FINE
    return _SIZES.get(state, 0), -_BANDS.get(brief.band, 0) if state is State.ACT else 0


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
