"""Changes since the run before, as the index page says them."""

from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any

from pipeline.records import Cause, CauseKind, FieldChange, InputChange, RunChanges, Verdict, VerdictChange
from pipeline.report.language import _, moment, parted, said
from pipeline.report.pages.views import ChangeView, Pointer, SinceView, TurnView
from pipeline.report.text import clean, count, short, words
from pipeline.report.units import Units

MOST = 12
"""Lines of one kind that the page shows; `kouros diff --json` has all."""

_UNITS = {"m": "m", "kg": "kg", "hz": "Hz", "pa": "Pa"}


def _why(kind: CauseKind) -> str:
    told = {
        CauseKind.INPUT: _("record of the object"),
        CauseKind.DECISION: _("decision"),
        CauseKind.FLOOR: _("floor"),
        CauseKind.MOTION: _("motion"),
        CauseKind.SETTINGS: _("settings"),
        CauseKind.VERSION: _("version of Kouros"),
    }
    return told[kind]


def since_view(changes: RunChanges, objects: Mapping[str, Pointer], units: Units) -> SinceView:
    """Return the section "since the last run".

    Parameters
    ----------
    objects : mapping of str to Pointer
        By object number, those that `mentioned` names; what is gone has none.

    Returns
    -------
    SinceView
    """
    worse = [_turn(change, objects) for change in changes.worsened]
    fixed = [_turn(change, objects) for change in changes.fixed]
    causes = Counter(cause.kind for change in changes.verdicts for cause in {c.kind: c for c in change.causes}.values())
    told = [(_why(kind), count(causes[kind])) for kind in CauseKind if causes[kind]]
    unknown = sum(not change.causes for change in changes.verdicts)
    return SinceView(
        before=clean(moment(changes.started)),
        changed=bool(changes),
        worse=_cut(worse),
        fixed=_cut(fixed),
        counts=tuple((title, count(number)) for title, number in _counts(changes) if number),
        causes=(*told, *([(_("not found"), count(unknown))] if unknown else [])),
        lists=_lists(changes, objects, units),
    )


def mentioned(changes: RunChanges) -> set[str]:
    """Return the numbers of the objects that the section names, and of those about which there is news."""
    lists: list[Sequence[Any]] = [
        changes.worsened, changes.fixed, changes.others, changes.added, changes.moved, changes.inputs,
    ]  # fmt: skip
    named = {change.object_number for change in changes.objects}
    named |= {change.object_number for found in lists for change in found[:MOST]}
    return named | {change.decision.object_number for change in changes.decisions[:MOST]}


def _counts(changes: RunChanges) -> list[tuple[str, int]]:
    return [
        (_("verdicts that passed and no longer do"), len(changes.worsened)),
        (_("verdicts that failed and pass"), len(changes.fixed)),
        (_("verdicts otherwise changed"), len(changes.others)),
        (_("objects new"), len(changes.added)),
        (_("objects gone"), len(changes.removed)),
        (_("objects moved"), len(changes.moved)),
        (_("objects otherwise changed"), len(changes.inputs)),
        (_("motions"), len(changes.motions)),
        (_("decisions"), len(changes.decisions)),
        (_("settings"), len(changes.settings)),
        (_("versions"), len(changes.versions)),
    ]


def _cut(turns: Sequence[TurnView]) -> tuple[tuple[TurnView, ...], int]:
    return tuple(turns[:MOST]), max(len(turns) - MOST, 0)


def _turn(change: VerdictChange, objects: Mapping[str, Pointer]) -> TurnView:
    return TurnView(
        number=clean(change.object_number),
        view=objects.get(change.object_number),
        gallery=clean(change.gallery),
        model=words(clean(change.model)),
        level=clean(change.level),
        before=_verdict(change.before),
        after=_verdict(change.after),
        causes=tuple(_cause(cause) for cause in change.causes) or (_("nothing that the runs keep differs"),),
    )


def _cause(cause: Cause) -> str:
    what = words(clean(cause.what)) if cause.kind is CauseKind.INPUT else clean(cause.what)
    return f"{_why(cause.kind)}: {short(what, 120)}"


def _lists(
    changes: RunChanges, objects: Mapping[str, Pointer], units: Units
) -> tuple[tuple[str, tuple[ChangeView, ...], int], ...]:
    lists: list[tuple[str, list[ChangeView]]] = [
        (_("Other verdicts"), [_other(v, objects) for v in changes.others]),
        (_("New"), [_change(p.object_number, p.gallery, objects) for p in changes.added]),
        (
            _("Gone"),
            [
                _change(
                    p.object_number,
                    _("was in %(gallery)s") % {"gallery": p.gallery} if p.gallery else _named(""),
                    objects,
                )
                for p in changes.removed
            ],
        ),
        (
            _("Moved"),
            [_change(m.object_number, f"{_named(m.before)} → {_named(m.after)}", objects) for m in changes.moved],
        ),
        (_("Otherwise changed"), [_change(i.object_number, _fields(i, units), objects) for i in changes.inputs]),
        (
            _("Motions"),
            [_change("", f"{m.name}, {_level(m.level)}{_floor(m.floor)}", objects) for m in changes.motions],
        ),
        (
            _("Decisions"),
            [
                _change(
                    c.decision.object_number,
                    (_("made") if c.new else _("no longer in force"))
                    + f": {said(c.decision.matter)}, {c.decision.who}",
                    objects,
                )
                for c in changes.decisions
            ],
        ),
        (_("Settings"), [_change("", _field(f, units), objects) for f in changes.settings]),
        (_("Versions"), [_change("", _field(f, units), objects) for f in changes.versions]),
    ]
    return tuple((title, tuple(found[:MOST]), max(len(found) - MOST, 0)) for title, found in lists if found)


def _named(gallery: str) -> str:
    return gallery or _("no gallery recorded")


def _floor(name: str) -> str:
    return ", " + _("floor %(floor)s") % {"floor": name} if name else ""


def _level(name: str) -> str:
    return _("level %(level)s") % {"level": name}


def _verdict(verdict: str | None) -> str:
    told = {Verdict.PASS: _("pass"), Verdict.FAIL: _("fail"), Verdict.UNDETERMINED: _("undetermined")}
    return told[Verdict(verdict)] if verdict else _("none")


def _change(number: str, text: str, objects: Mapping[str, Pointer]) -> ChangeView:
    return ChangeView(clean(number), objects.get(number), short(text, 300))


def _other(change: VerdictChange, objects: Mapping[str, Pointer]) -> ChangeView:
    turn = _turn(change, objects)
    text = f"{turn.model}, {_level(turn.level)}: {turn.before} → {turn.after} ({'; '.join(turn.causes)})"
    return _change(change.object_number, text, objects)


def _fields(change: InputChange, units: Units) -> str:
    # What follows from the record is told only where nothing of the record itself changed.
    own = [field for field in change.fields if "." not in field.name]
    return parted(_field(field, units) for field in own or change.fields)


def _field(change: FieldChange, units: Units) -> str:
    name = change.name.removeprefix("parameters.").removeprefix("scene.")
    before, after = (_value(name, value, units) for value in (change.before, change.after))
    if before == after:
        return _("%(what)s: another range or source") % {"what": f"{words(name)} {after}"}
    return f"{words(name)} {before} → {after}"


def _value(name: str, value: Any, units: Units) -> str:
    if isinstance(value, dict) and {"value", "unit"} <= value.keys():
        return units.text(float(value["value"]), value["unit"])
    unit = _UNITS.get(name.rpartition("_")[2], "")
    if unit and isinstance(value, float):
        return units.text(value, unit)
    return _("none") if value is None or value == "" else short(str(value), 60)
