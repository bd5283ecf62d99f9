"""What changed between two stored runs: objects, inputs, motions, decisions, settings and versions, and verdicts."""

from collections.abc import Mapping
from functools import cached_property
from typing import Any

from sqlalchemy import ColumnElement, Connection, and_, case, exists, func, or_, select
from sqlalchemy.sql.expression import FromClause

from pipeline.records import (
    Decision,
    DecisionChange,
    FieldChange,
    InputChange,
    MotionChange,
    Move,
    ObjectPlace,
    RunChanges,
    Verdict,
    VerdictChange,
)
from pipeline.store import codec
from pipeline.store.causes import Causes, MotionKey
from pipeline.store.reuse import CODE, KERNELS, LEVELS, RULES
from pipeline.store.tables import FINDING, RUN, RUN_DECISION, RUN_MOTION, RUN_SCENE

_SEVERITY = {Verdict.PASS: 0, Verdict.UNDETERMINED: 1, Verdict.FAIL: 2}
_BY_SEVERITY = {severity: verdict for verdict, severity in _SEVERITY.items()}


def changes(connection: Connection, old: str, new: str) -> RunChanges:
    """Return what changed between two runs, both of which are stored; see `runs.compare_runs`."""
    return _Comparison(connection, old, new).made()


class _Comparison:
    """The parts of one comparison; those that others need are worked out once."""

    def __init__(self, connection: Connection, old: str, new: str) -> None:
        self.connection, self.old, self.new = connection, old, new
        self.before, self.after = (_run(connection, run_id) for run_id in (old, new))

    def made(self) -> RunChanges:
        return RunChanges(
            self.old,
            self.new,
            added=self._only_in(self.new, self.old),
            removed=self._only_in(self.old, self.new),
            moved=self._moved(),
            inputs=self.inputs,
            verdicts=self._verdicts(),
            motions=self._motions(),
            decisions=self.decisions,
            settings=_differing(_settings(self.before), _settings(self.after)),
            versions=_differing(_versions(self.before), _versions(self.after)),
            started=self.before["started"],
        )

    def _only_in(self, run_id: str, other: str) -> tuple[ObjectPlace, ...]:
        here, there = RUN_SCENE.alias(), RUN_SCENE.alias()
        same = exists().where(there.c.run_id == other, there.c.object_number == here.c.object_number)
        query = select(here.c.object_number, here.c.gallery).where(here.c.run_id == run_id, ~same)
        places = (ObjectPlace(*row) for row in self.connection.execute(query))
        return tuple(sorted(places, key=lambda place: (place.gallery, place.object_number)))

    def _in_both(self) -> tuple[FromClause, FromClause, ColumnElement[bool]]:
        before, after = RUN_SCENE.alias(), RUN_SCENE.alias()
        runs = and_(before.c.run_id == self.old, after.c.run_id == self.new)
        return before, after, and_(runs, before.c.object_number == after.c.object_number)

    def _moved(self) -> tuple[Move, ...]:
        before, after, same = self._in_both()
        query = select(after.c.object_number, before.c.gallery, after.c.gallery)
        rows = self.connection.execute(query.where(same, before.c.gallery != after.c.gallery))
        return tuple(sorted((Move(*row) for row in rows), key=lambda move: (move.after, move.object_number)))

    @cached_property
    def inputs(self) -> tuple[InputChange, ...]:
        before, after, same = self._in_both()
        # The columns' text is equal exactly where the values are, so that the database finds the few that differ.
        differs = or_(*(before.c[name] != after.c[name] for name in ("item", *_SCENE)))
        columns = [side.c[name] for name in ("item", *_SCENE) for side in (before, after)]
        found = []
        for was, item, *pairs in self.connection.execute(select(*columns).where(same, differs)):
            fields = [f for f in _differing(_plain("item", was), _plain("item", item)) if f.name not in _OTHERWISE]
            for i, name in enumerate(_SCENE):
                one, other = _plain(name, pairs[2 * i]), _plain(name, pairs[2 * i + 1])
                if name == "parameters":
                    fields += [FieldChange(f"parameters.{f.name}", f.before, f.after) for f in _differing(one, other)]
                elif one != other:
                    fields.append(FieldChange(f"scene.{name}", one, other))
            if fields:
                found.append(InputChange(item.object_number, item.gallery, tuple(fields)))
        return tuple(sorted(found, key=lambda change: (change.gallery, change.object_number)))

    @cached_property
    def decisions(self) -> tuple[DecisionChange, ...]:
        sides: list[dict[int, Decision]] = []
        for run_id in (self.old, self.new):
            query = select(RUN_DECISION.c.decision).where(RUN_DECISION.c.run_id == run_id)
            sides.append({row.decision.id: row.decision for row in self.connection.execute(query)})
        before, after = sides
        ended = [DecisionChange(before[key], new=False) for key in before.keys() - after.keys()]
        made = [DecisionChange(after[key], new=True) for key in after.keys() - before.keys()]
        return tuple(sorted((*ended, *made), key=lambda change: (change.decision.object_number, change.decision.id)))

    @cached_property
    def motions(self) -> tuple[Mapping[MotionKey, tuple[str, ...]], Mapping[MotionKey, tuple[str, ...]]]:
        """The hashes of the samples by level, floor and name, before and after."""
        sides: list[dict[MotionKey, tuple[str, ...]]] = []
        for run_id in (self.old, self.new):
            hashes: dict[MotionKey, tuple[str, ...]] = {}
            columns = (RUN_MOTION.c.level, RUN_MOTION.c.floor, RUN_MOTION.c.name, RUN_MOTION.c.hash)
            query = select(*columns).where(RUN_MOTION.c.run_id == run_id).order_by(RUN_MOTION.c.position)
            for level, floor, name, motion_hash in self.connection.execute(query):
                hashes[level, floor, name] = (*hashes.get((level, floor, name), ()), motion_hash)
            sides.append(hashes)
        return sides[0], sides[1]

    def _motions(self) -> tuple[MotionChange, ...]:
        before, after = self.motions
        keys = sorted(key for key in before.keys() | after.keys() if before.get(key) != after.get(key))
        return tuple(MotionChange(*key, before.get(key), after.get(key)) for key in keys)

    def _verdicts(self) -> tuple[VerdictChange, ...]:
        severity = case(_SEVERITY, value=FINDING.c.verdict)
        worst_before = func.max(case((FINDING.c.run_id == self.old, severity)))
        worst_after = func.max(case((FINDING.c.run_id == self.new, severity)))
        before, after, same = self._in_both()
        named = (FINDING.c.object_number, after.c.gallery, FINDING.c.model, FINDING.c.level)
        floors = (before.c.floor, after.c.floor)
        query = (
            select(*named, *floors, worst_before, worst_after)
            .join_from(FINDING, after, FINDING.c.object_number == after.c.object_number)
            .join(before, before.c.object_number == after.c.object_number)
            .where(FINDING.c.run_id.in_((self.old, self.new)), same)
            .group_by(*named, *floors)
            .having(worst_before.is_distinct_from(worst_after))
        )
        causes = Causes(
            self.inputs,
            self.decisions,
            self.motions,
            _differing(_settings(self.before), _settings(self.after)),
            _differing(_versions(self.before), _versions(self.after)),
        )
        found = (
            VerdictChange(
                number,
                gallery,
                model,
                level,
                _BY_SEVERITY.get(was),
                _BY_SEVERITY.get(now),
                causes.of(number, level, floor_was, floor_now),
            )
            for number, gallery, model, level, floor_was, floor_now, was, now in self.connection.execute(query)
        )
        return tuple(sorted(found, key=lambda c: (c.gallery, c.object_number, c.level, c.model)))


_SCENE = ("support", "object_class", "models", "parameters")
"""What an object is run with besides its item; the floor has a cause of its own."""

_OTHERWISE = frozenset({"gallery", "provenance"})
"""Fields of an item that are told otherwise (as a move) or only say where another field comes from."""


def _run(connection: Connection, run_id: str) -> Mapping[str, Any]:
    columns = (RUN.c.started, RUN.c.version, RUN.c.settings)
    return dict(connection.execute(select(*columns).where(RUN.c.run_id == run_id)).mappings().one())


def _plain(column: str, value: object) -> Any:
    return codec.plain(RUN_SCENE.c[column].type.hint, value) if column in _JSON else value  # type: ignore[attr-defined]


_JSON = ("item", "models", "parameters")


def _differing(was: Mapping[str, Any], now: Mapping[str, Any]) -> tuple[FieldChange, ...]:
    return tuple(FieldChange(key, was.get(key), now.get(key)) for key in {**was, **now} if was.get(key) != now.get(key))


def _settings(run: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings that verdicts rest on, by the names that they have in kouros.toml."""
    kept = run["settings"]
    analysis = kept.get("analysis") or {}
    found = {f"analysis.{name}": value for name, value in analysis.items() if name != "workers"}
    found["site.folder"] = kept.get("site")
    found["collection.rules"] = kept.get(RULES)
    found |= {f"levels.{name}": how for name, how in (kept.get(LEVELS) or {}).items()}
    return found


def _versions(run: Mapping[str, Any]) -> dict[str, Any]:
    kept = run["settings"]
    return {"Kouros": run["version"], "kernels": kept.get(KERNELS), "code and tables": kept.get(CODE)}
