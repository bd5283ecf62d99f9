"""What changed since the run before, as the index page says it."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from pipeline.records import Cause, CauseKind, FieldChange, InputChange, RunChanges, VerdictChange
from pipeline.report.text import clean, count, short, words
from pipeline.report.units import Units
from pipeline.report.views import ChangeView, ObjectView, SinceView, TurnView

MOST = 12
"""Lines of one kind that the page shows; `kouros diff --json` has all."""

_WHY = {
    CauseKind.INPUT: "record of the object",
    CauseKind.DECISION: "decision",
    CauseKind.FLOOR: "floor",
    CauseKind.MOTION: "motion",
    CauseKind.SETTINGS: "settings",
    CauseKind.VERSION: "version of Kouros",
}
_UNITS = {"m": "m", "kg": "kg", "hz": "Hz", "pa": "Pa"}


def since_view(changes: RunChanges, objects: Mapping[str, ObjectView], units: Units) -> SinceView:
    """Return the section "since the last run".

    objects : by object number, those of the page; what is gone has none
    """
    worse = [_turn(change, objects) for change in changes.worsened]
    fixed = [_turn(change, objects) for change in changes.fixed]
    causes = Counter(cause.kind for change in changes.verdicts for cause in {c.kind: c for c in change.causes}.values())
    told = [(_WHY[kind], count(causes[kind])) for kind in CauseKind if causes[kind]]
    unknown = sum(not change.causes for change in changes.verdicts)
    return SinceView(
        before=clean(changes.started[:16].replace("T", " ")),
        changed=bool(changes),
        worse=_cut(worse),
        fixed=_cut(fixed),
        counts=tuple((title, count(number)) for title, number in _counts(changes) if number),
        causes=(*told, *([("not found", count(unknown))] if unknown else [])),
        lists=_lists(changes, objects, units),
    )


def _counts(changes: RunChanges) -> list[tuple[str, int]]:
    return [
        ("verdicts worse", len(changes.worsened)),
        ("verdicts fixed", len(changes.fixed)),
        ("verdicts otherwise changed", len(changes.others)),
        ("objects new", len(changes.added)),
        ("objects gone", len(changes.removed)),
        ("objects moved", len(changes.moved)),
        ("objects otherwise changed", len(changes.inputs)),
        ("motions", len(changes.motions)),
        ("decisions", len(changes.decisions)),
        ("settings", len(changes.settings)),
        ("versions", len(changes.versions)),
    ]


def _cut(turns: Sequence[TurnView]) -> tuple[tuple[TurnView, ...], int]:
    return tuple(turns[:MOST]), max(len(turns) - MOST, 0)


def _turn(change: VerdictChange, objects: Mapping[str, ObjectView]) -> TurnView:
    return TurnView(
        number=clean(change.object_number),
        view=objects.get(change.object_number),
        gallery=clean(change.gallery),
        model=words(clean(change.model)),
        level=clean(change.level),
        before=str(change.before or "none"),
        after=str(change.after or "none"),
        causes=tuple(_cause(cause) for cause in change.causes) or ("nothing that the runs keep differs",),
    )


def _cause(cause: Cause) -> str:
    what = words(clean(cause.what)) if cause.kind is CauseKind.INPUT else clean(cause.what)
    return f"{_WHY[cause.kind]}: {short(what, 120)}"


def _lists(
    changes: RunChanges, objects: Mapping[str, ObjectView], units: Units
) -> tuple[tuple[str, tuple[ChangeView, ...], int], ...]:
    lists: list[tuple[str, list[ChangeView]]] = [
        ("Other verdicts", [_other(v, objects) for v in changes.others]),
        ("New", [_change(p.object_number, p.gallery, objects) for p in changes.added]),
        ("Gone", [_change(p.object_number, f"was in {p.gallery}", objects) for p in changes.removed]),
        ("Moved", [_change(m.object_number, f"{m.before} → {m.after}", objects) for m in changes.moved]),
        ("Otherwise changed", [_change(i.object_number, _fields(i, units), objects) for i in changes.inputs]),
        ("Motions", [_change("", f"{m.name}, level {m.level}{_floor(m.floor)}", objects) for m in changes.motions]),
        (
            "Decisions",
            [
                _change(
                    c.decision.object_number,
                    f"{'made' if c.new else 'no longer in force'}: {c.decision.matter}, {c.decision.who}",
                    objects,
                )
                for c in changes.decisions
            ],
        ),
        ("Settings", [_change("", _field(f, units), objects) for f in changes.settings]),
        ("Versions", [_change("", _field(f, units), objects) for f in changes.versions]),
    ]
    return tuple((title, tuple(found[:MOST]), max(len(found) - MOST, 0)) for title, found in lists if found)


def _floor(name: str) -> str:
    return f", floor {name}" if name else ""


def _change(number: str, text: str, objects: Mapping[str, ObjectView]) -> ChangeView:
    return ChangeView(clean(number), objects.get(number), short(text, 300))


def _other(change: VerdictChange, objects: Mapping[str, ObjectView]) -> ChangeView:
    turn = _turn(change, objects)
    text = f"{turn.model}, level {turn.level}: {turn.before} → {turn.after} ({'; '.join(turn.causes)})"
    return _change(change.object_number, text, objects)


def _fields(change: InputChange, units: Units) -> str:
    # What follows from the record is told only where nothing of the record itself changed.
    own = [field for field in change.fields if "." not in field.name]
    return "; ".join(_field(field, units) for field in own or change.fields)


def _field(change: FieldChange, units: Units) -> str:
    name = change.name.removeprefix("parameters.").removeprefix("scene.")
    return f"{words(name)} {_value(name, change.before, units)} → {_value(name, change.after, units)}"


def _value(name: str, value: Any, units: Units) -> str:
    if isinstance(value, dict) and {"value", "unit"} <= value.keys():
        return units.text(float(value["value"]), value["unit"])
    unit = _UNITS.get(name.rpartition("_")[2], "")
    if unit and isinstance(value, float):
        return units.text(value, unit)
    return "none" if value is None or value == "" else short(str(value), 60)
