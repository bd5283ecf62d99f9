"""Why a verdict may have changed: everything that it rests on and that is not what it was."""

from collections.abc import Iterable, Mapping

from pipeline.records import Cause, CauseKind, DecisionChange, DecisionKind, FieldChange, InputChange

MotionKey = tuple[str, str, str]
"""Level, floor and name of a motion."""

GROUND = "the ground"

_INERT = frozenset({"problems", "position_x_m", "position_y_m", "value", "on_loan", "image", "image_credit"})
"""Fields of an item that no model and no rule reads."""


class Causes:
    """All that changed from one run to another, ready to be asked about one verdict.

    Two causes that coincide are both named: the runs cannot tell which of them moved the verdict.
    """

    def __init__(
        self,
        inputs: Iterable[InputChange],
        decisions: Iterable[DecisionChange],
        motions: tuple[Mapping[MotionKey, tuple[str, ...]], Mapping[MotionKey, tuple[str, ...]]],
        settings: Iterable[FieldChange],
        versions: Iterable[FieldChange],
    ) -> None:
        self._inputs = {change.object_number: change for change in inputs}
        self._decisions: dict[str, list[DecisionChange]] = {}
        for change in decisions:
            # The others never change what is computed.
            if change.decision.kind in (DecisionKind.CLASS, DecisionKind.INSTALLED):
                self._decisions.setdefault(change.decision.object_number, []).append(change)
        self._motions = motions
        settings, versions = list(settings), list(versions)
        self._settings = [Cause(CauseKind.SETTINGS, _said(change)) for change in settings]
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
        return (*found, *self._shaking(level, floor_before, floor_after), *self._settings, *self._versions)

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
