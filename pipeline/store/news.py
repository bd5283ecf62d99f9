"""News of objects from one run to another, one by one; what changed for all at once only as a number; and why."""

from collections import Counter
from collections.abc import Iterable, Mapping, Set
from typing import NamedTuple

from pipeline.records import (
    Brief,
    Cause,
    CauseKind,
    DecisionChange,
    DecisionKind,
    FieldChange,
    InputChange,
    NewsKind,
    ObjectChange,
    Ruled,
    Settled,
)
from pipeline.store.sound import HOUSE

MotionKey = tuple[str, str, str]
"""Level, floor and name of a motion."""

GROUND = "the ground"

_INERT = frozenset({"problems", "position_x_m", "position_y_m", "value", "on_loan", "image", "image_credit"})
"""Fields of an item that no model and no rule reads."""


class Causes:
    """All that changed from one run to another, ready to be asked about one verdict.

    Two causes that coincide are both named: the runs cannot tell which of them moved the verdict.  Where it is known
    which objects rest on house rules (``housed``), these are no cause for any other.
    """

    def __init__(
        self,
        inputs: Iterable[InputChange],
        decisions: Iterable[DecisionChange],
        motions: tuple[Mapping[MotionKey, tuple[str, ...]], Mapping[MotionKey, tuple[str, ...]]],
        settings: Iterable[FieldChange],
        versions: Iterable[FieldChange],
        housed: Set[str] | None = None,
    ) -> None:
        self._inputs = {change.object_number: change for change in inputs}
        self._decisions: dict[str, list[DecisionChange]] = {}
        for change in decisions:
            # The others never change what is computed.
            if change.decision.kind in (DecisionKind.CLASS, DecisionKind.INSTALLED):
                self._decisions.setdefault(change.decision.object_number, []).append(change)
        self._motions = motions
        settings, versions = list(settings), list(versions)
        self._settings = [(change.name, Cause(CauseKind.SETTINGS, _said(change))) for change in settings]
        self._housed = housed
        self._versions = [Cause(CauseKind.VERSION, _said(change)) for change in versions]
        self._shaken: dict[tuple[str, str, str], tuple[Cause, ...]] = {}

    def of(self, object_number: str, level: str, floor_before: str, floor_after: str) -> tuple[Cause, ...]:
        """Return what changed for the verdicts of an object at a level, in the order of `CauseKind`."""
        found = [Cause(CauseKind.INPUT, name) for name in self.fields(object_number)]
        found += [
            Cause(CauseKind.DECISION, f"{'made' if change.new else 'ended'}: {_decided(change)}")
            for change in self._decisions.get(object_number, ())
        ]
        if floor_before != floor_after:
            found.append(Cause(CauseKind.FLOOR, f"{floor_before or GROUND} -> {floor_after or GROUND}"))
        found += self._shaking(level, floor_before, floor_after)
        housed = self._housed is None or object_number in self._housed
        return (*found, *(cause for name, cause in self._settings if housed or name != HOUSE), *self._versions)

    def fields(self, object_number: str) -> tuple[str, ...]:
        """Return the fields of an object's record that changed and that something computed may rest on."""
        change = self._inputs.get(object_number)
        if change is None:
            return ()
        # What is of the scene follows from the item, a decision or Kouros's own code: each of these is told for itself.
        return tuple(f.name for f in change.fields if "." not in f.name and f.name not in _INERT)

    def _shaking(self, level: str, floor_before: str, floor_after: str) -> tuple[Cause, ...]:
        key = (level, floor_before, floor_after)
        if key not in self._shaken:
            before, after = self._motions
            # Under another floor the motion is another in any case; it is a cause where that floor's own changed.
            floors = {floor_before, floor_after}
            both = before.keys() | after.keys() if floor_before == floor_after else before.keys() & after.keys()
            names = {k[2] for k in both if k[0] == level and k[1] in floors and before.get(k) != after.get(k)}
            self._shaken[key] = tuple(Cause(CauseKind.MOTION, name) for name in sorted(names))
        return self._shaken[key]


def _said(change: FieldChange) -> str:
    was, now = ("none" if value is None else str(value) for value in (change.before, change.after))
    return f"{change.name}: {was} -> {now}"


def _decided(change: DecisionChange) -> str:
    return f"{change.decision.matter} ({change.decision.id})"


ONE_BY_ONE = 200
"""Objects at most that one change of house rules moves and that are told one by one; of more their number is told."""


class Seen(NamedTuple):
    """An object as one run has it: its title, where it is, whether it is on display, and what is said of it."""

    title: str
    gallery: str
    on_display: bool
    floor: str
    brief: Brief

    @property
    def shown(self) -> Brief | None:
        """What is said of it on display; None where it is not there."""
        return self.brief if self.on_display else None


def news(
    before: Mapping[str, Seen],
    after: Mapping[str, Seen],
    decisions: Iterable[DecisionChange],
    causes: Causes,
    *,
    shared: bool,
    ruled: Mapping[str, tuple[Ruled, ...]] | None = None,
) -> tuple[tuple[ObjectChange, ...], dict[str, int]]:
    """Return news of objects in the order in which it is told, and how much there is that all have in common.

    What changed only because motions, floors, settings or Kouros itself did is counted by its kind: a thousand objects
    that one motion makes worse are one piece of news.

    Parameters
    ----------
    before, after : mapping of str to Seen
        By number, the objects that may have changed, and those that decisions are about.
    decisions : iterable of DecisionChange
        Made or ended.
    causes : Causes
        All that changed.
    shared : bool
        Whether anything changed that verdicts of objects have in common.
    ruled : mapping of str to tuple of Ruled, optional
        By number, house rules that are new for an object, or hold for it no longer.
    """
    ruled = ruled or {}
    about: dict[str, list[Settled]] = {}
    for change in decisions:
        about.setdefault(change.decision.object_number, []).append(Settled.of(change.decision, new=change.new))
    found: list[ObjectChange] = []
    moved: list[ObjectChange] = []
    counts: Counter[NewsKind] = Counter()
    for number in before.keys() | after.keys():
        was, now = before.get(number), after.get(number)
        one = _change(number, was, now, tuple(about.get(number, ())), causes, ruled.get(number, ()))
        kind = one.kind
        if kind is None:
            continue
        if was is not None and now is not None and _in_common(one, was, now, shared=shared):
            if one.ruled:
                moved.append(one)
            else:
                counts[kind] += 1
        else:
            found.append(one)
    if len(moved) <= ONE_BY_ONE:
        found += moved
    else:
        counts.update(one.kind for one in moved if one.kind is not None)
    return tuple(sorted(found, key=lambda one: one.order)), {
        kind.value: counts[kind] for kind in NewsKind if counts[kind]
    }


def _change(
    number: str,
    was: Seen | None,
    now: Seen | None,
    decided: tuple[Settled, ...],
    causes: Causes,
    ruled: tuple[Ruled, ...],
) -> ObjectChange:
    last = now or was
    if last is None:
        raise ValueError(f"{number!a} is in neither of the runs")
    moved = was is not None and now is not None and was.gallery != now.gallery
    return ObjectChange(
        number,
        last.title,
        last.gallery,
        None if was is None else was.shown,
        None if now is None else now.shown,
        was.gallery if moved and was is not None else None,
        now is not None,
        decided,
        causes.fields(number),
        ruled,
    )


def _in_common(one: ObjectChange, was: Seen, now: Seen, *, shared: bool) -> bool:
    """Say whether nothing of the object itself changed, but something did that others rest on too."""
    own = one.fields or one.decided or one.came_from is not None or was.on_display != now.on_display
    return not own and (shared or was.floor != now.floor)
