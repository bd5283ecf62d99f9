"""What changed between two stored runs: objects, inputs, motions, verdicts."""

from dataclasses import dataclass

from sqlalchemy import ColumnElement, Connection, and_, case, exists, func, or_, select
from sqlalchemy.sql.expression import FromClause

from pipeline.records import Verdict
from pipeline.store import codec
from pipeline.store.tables import FINDING, RUN_MOTION, RUN_SCENE

_SEVERITY = {Verdict.PASS: 0, Verdict.UNDETERMINED: 1, Verdict.FAIL: 2}
_BY_SEVERITY = {severity: verdict for verdict, severity in _SEVERITY.items()}


@dataclass(frozen=True, slots=True)
class ObjectPlace:
    """An object and the gallery it is in, or was in where it is gone."""

    object_number: str
    gallery: str


@dataclass(frozen=True, slots=True)
class InputChange:
    """An object of both runs whose record or estimates differ: in the fields of the item and in the parameters named.

    A parameter is named "parameters.half_width"; the other parts of the scene by their own name ("support").
    """

    object_number: str
    gallery: str
    fields: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class MotionChange:
    """A motion of a level whose samples changed; None on the side where there was no motion of that name.

    before, after : hashes of the samples, in order, where one name stands for several motions of the level
    """

    level: str
    name: str
    before: tuple[str, ...] | None
    after: tuple[str, ...] | None


@dataclass(frozen=True, slots=True)
class VerdictChange:
    """A verdict of an object of both runs that changed; None on the side where the model gave no finding.

    Where a model gives several findings at a level (tension, shear), its verdict is the worst of them.
    """

    object_number: str
    gallery: str
    model: str
    level: str
    before: Verdict | None
    after: Verdict | None


@dataclass(frozen=True, slots=True)
class RunChanges:
    """All that changed from one run to another, each in the order of gallery and object number."""

    old: str
    new: str
    added: tuple[ObjectPlace, ...]
    removed: tuple[ObjectPlace, ...]
    inputs: tuple[InputChange, ...]
    verdicts: tuple[VerdictChange, ...]
    motions: tuple[MotionChange, ...]

    def __bool__(self) -> bool:
        """Whether anything changed."""
        return bool(self.added or self.removed or self.inputs or self.verdicts or self.motions)


def changes(connection: Connection, old: str, new: str) -> RunChanges:
    """Return what changed between two runs, both of which are stored; see `runs.compare_runs`."""
    return RunChanges(
        old,
        new,
        added=_only_in(connection, new, old),
        removed=_only_in(connection, old, new),
        inputs=_inputs(connection, old, new),
        verdicts=_verdicts(connection, old, new),
        motions=_motions(connection, old, new),
    )


def _only_in(connection: Connection, run_id: str, other: str) -> tuple[ObjectPlace, ...]:
    here, there = RUN_SCENE.alias(), RUN_SCENE.alias()
    same = exists().where(there.c.run_id == other, there.c.object_number == here.c.object_number)
    rows = connection.execute(select(here.c.object_number, here.c.gallery).where(here.c.run_id == run_id, ~same))
    return tuple(sorted((ObjectPlace(*row) for row in rows), key=lambda place: (place.gallery, place.object_number)))


def _in_both(old: str, new: str) -> tuple[FromClause, FromClause, ColumnElement[bool]]:
    before, after = RUN_SCENE.alias(), RUN_SCENE.alias()
    same = and_(before.c.run_id == old, after.c.run_id == new, before.c.object_number == after.c.object_number)
    return before, after, same


_INPUTS = ("support", "floor", "object_class", "models", "parameters")


def _inputs(connection: Connection, old: str, new: str) -> tuple[InputChange, ...]:
    before, after, same = _in_both(old, new)
    # The columns' text is equal exactly where the values are, so that the database finds the few that differ.
    differs = or_(*(before.c[name] != after.c[name] for name in ("item", *_INPUTS)))
    columns = (before.c.item, after.c.item, *(side.c[name] for name in _INPUTS for side in (before, after)))
    found = []
    for was, item, *pairs in connection.execute(select(*columns).where(same, differs)):
        names = _differing("item", was, item)
        for i, name in enumerate(_INPUTS):
            if name == "parameters":
                names += [f"parameters.{key}" for key in _differing(name, pairs[2 * i], pairs[2 * i + 1])]
            elif pairs[2 * i] != pairs[2 * i + 1]:
                names.append(name)
        found.append(InputChange(item.object_number, item.gallery, tuple(dict.fromkeys(names))))
    return tuple(sorted(found, key=lambda change: (change.gallery, change.object_number)))


def _differing(column: str, before: object, after: object) -> list[str]:
    hint = RUN_SCENE.c[column].type.hint  # type: ignore[attr-defined]  # a column of the type Json
    was, now = codec.plain(hint, before), codec.plain(hint, after)
    return [key for key in {**was, **now} if key not in was or key not in now or was[key] != now[key]]


def _verdicts(connection: Connection, old: str, new: str) -> tuple[VerdictChange, ...]:
    severity = case(_SEVERITY, value=FINDING.c.verdict)
    worst_before = func.max(case((FINDING.c.run_id == old, severity)))
    worst_after = func.max(case((FINDING.c.run_id == new, severity)))
    _, after, same = _in_both(old, new)
    query = (
        select(FINDING.c.object_number, after.c.gallery, FINDING.c.model, FINDING.c.level, worst_before, worst_after)
        .join_from(FINDING, after, FINDING.c.object_number == after.c.object_number)
        .where(FINDING.c.run_id.in_((old, new)), same)
        .group_by(FINDING.c.object_number, after.c.gallery, FINDING.c.model, FINDING.c.level)
        .having(worst_before.is_distinct_from(worst_after))
    )
    found = (
        VerdictChange(number, gallery, model, level, _BY_SEVERITY.get(was), _BY_SEVERITY.get(now))
        for number, gallery, model, level, was, now in connection.execute(query)
    )
    return tuple(sorted(found, key=lambda c: (c.gallery, c.object_number, c.level, c.model)))


def _motions(connection: Connection, old: str, new: str) -> tuple[MotionChange, ...]:
    sides: list[dict[tuple[str, str], tuple[str, ...]]] = []
    for run_id in (old, new):
        hashes: dict[tuple[str, str], tuple[str, ...]] = {}
        columns = (RUN_MOTION.c.level, RUN_MOTION.c.name, RUN_MOTION.c.hash)
        query = select(*columns).where(RUN_MOTION.c.run_id == run_id).order_by(RUN_MOTION.c.position)
        for level, name, motion_hash in connection.execute(query):
            hashes[level, name] = (*hashes.get((level, name), ()), motion_hash)
        sides.append(hashes)
    before, after = sides
    keys = sorted(key for key in before.keys() | after.keys() if before.get(key) != after.get(key))
    return tuple(MotionChange(*key, before.get(key), after.get(key)) for key in keys)
