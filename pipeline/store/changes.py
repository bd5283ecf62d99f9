"""Comparison of two stored runs: objects, inputs, motions, decisions, settings and versions, and verdicts."""

from collections.abc import Iterable, Mapping, Set
from functools import cached_property
from sys import intern
from typing import Any, NamedTuple, get_type_hints

from sqlalchemy import Connection, select

from pipeline.analysis.house.matching import rests_on
from pipeline.records import (
    Decision,
    DecisionChange,
    FieldChange,
    InputChange,
    MotionChange,
    Move,
    ObjectChange,
    ObjectPlace,
    Outline,
    Ruled,
    RunChanges,
    Scene,
    Verdict,
    VerdictChange,
)
from pipeline.store import codec
from pipeline.store.news import Causes, MotionKey, Seen, news
from pipeline.store.pages import found_of, load_members
from pipeline.store.results import DamagedRunError, Digests, fetch, outline_of, outlines
from pipeline.store.sound import CODE, DISPLAY, HOUSE, HOUSE_RULES, KERNELS, LEVELS, RULES, TABLES
from pipeline.store.tables import RUN, RUN_DECISION, RUN_MOTION, RUN_PAGE


class _InRun(NamedTuple):
    """An object of a run: key of its page, gallery, title, whether on display, digest of its record, and its result."""

    page: str
    gallery: str
    title: str
    on_display: bool
    digest: str
    key: str
    at: int

    def outline(self, number: str, found: Mapping[str, tuple[Digests, ...]]) -> Outline:
        return outline_of(number, self.gallery, self.digest, found[self.key][self.at])

    def seen(self, outline: Outline) -> Seen:
        return Seen(self.title, self.gallery, self.on_display, outline.floor, outline.brief)


def changes(connection: Connection, old: str, new: str) -> RunChanges:
    """Return what changed between two runs, both of which are stored; see `runs.compare_runs`."""
    return _Comparison(connection, old, new).made()


class _Comparison:
    """The parts of one comparison; those that others need are worked out once."""

    def __init__(self, connection: Connection, old: str, new: str) -> None:
        self.connection, self.old, self.new = connection, old, new
        self.before, self.after = (_run(connection, run_id) for run_id in (old, new))

    def made(self) -> RunChanges:
        objects, shared = self._news()
        return RunChanges(
            self.old,
            self.new,
            added=self._only_in(self._outlines[1], self._outlines[0]),
            removed=self._only_in(*self._outlines),
            moved=self._moved(),
            inputs=self.inputs,
            verdicts=self._verdicts(),
            motions=self._motions(),
            decisions=self.decisions,
            settings=self.settings,
            versions=self.versions,
            started=self.before["started"],
            objects=objects,
            shared=shared,
        )

    @cached_property
    def _places(self) -> tuple[dict[str, _InRun], dict[str, _InRun]]:
        """Where the objects are, by number, before and after, of those pages that only one of the two runs has."""
        sides = []
        for run_id in (self.old, self.new):
            query = select(RUN_PAGE.c.key).where(RUN_PAGE.c.run_id == run_id).order_by(RUN_PAGE.c.position)
            sides.append(list(self.connection.execute(query).scalars()))
        before, after = (set(side) for side in sides)
        # What both have cannot have changed.
        return (
            self._on([key for key in sides[0] if key not in after]),
            self._on([key for key in sides[1] if key not in before]),
        )

    def _on(self, pages: Iterable[str]) -> dict[str, _InRun]:
        found: dict[str, _InRun] = {}
        for page in pages:
            members = load_members(self.connection, page)
            told = zip(*map(members.column, _NAMED), members.digests, members.results, strict=True)
            found |= {
                number: _InRun(page, intern(gallery), title, shown, digest, *result)
                for number, gallery, title, shown, digest, result in told
            }
        return found

    @cached_property
    def _outlines(self) -> tuple[dict[str, Outline], dict[str, Outline]]:
        """The objects of those pages that are not what they were, by number, before and after."""
        before, after = self._places
        same = {number for number, place in after.items() if number in before and before[number][1:] == place[1:]}
        sides = []
        for places in (before, after):
            left = {number: place for number, place in places.items() if number not in same}
            sides.append(self._outlined(left))
        return sides[0], sides[1]

    def _outlined(self, places: Mapping[str, _InRun]) -> dict[str, Outline]:
        found = outlines(self.connection, {place.key for place in places.values()})
        return {number: place.outline(number, found) for number, place in places.items()}

    @cached_property
    def _both(self) -> list[tuple[Outline, Outline]]:
        before, after = self._outlines
        return [(before[number], now) for number, now in after.items() if number in before]

    def _only_in(self, here: Mapping[str, Outline], there: Mapping[str, Outline]) -> tuple[ObjectPlace, ...]:
        places = (ObjectPlace(o.object_number, o.gallery) for number, o in here.items() if number not in there)
        return tuple(sorted(places, key=lambda place: (place.gallery, place.object_number)))

    def _moved(self) -> tuple[Move, ...]:
        moves = (
            Move(now.object_number, was.gallery, now.gallery) for was, now in self._both if was.gallery != now.gallery
        )
        return tuple(sorted(moves, key=lambda move: (move.after, move.object_number)))

    @cached_property
    def _differing_scenes(self) -> tuple[dict[str, Scene], dict[str, Scene]]:
        """The scenes of objects that are in both runs and not the same, by number, before and after."""
        differing = {now.object_number for was, now in self._both if (was.item, was.scene) != (now.item, now.scene)}
        if not differing:
            return {}, {}
        was, now = (self._scenes(places, differing) for places in self._places)
        return was, now

    def _ruled(self) -> dict[str, tuple[Ruled, ...]]:
        """Return by number the house rules that are new for an object, or hold for it no longer."""
        rules = [run["settings"].get(HOUSE_RULES) for run in (self.before, self.after)]
        # A run of an earlier version does not say which it had.
        if None in rules or rules[0] == rules[1]:
            return {}
        # One that was taken back stays in the list, and says by whom.
        back = {(rule["words"], rule["source"], str(rule["states"])): rule["back"] for rule in rules[1]
                if rule.get("back")}  # fmt: skip
        rules = [[rule for rule in some if not rule.get("back")] for some in rules]
        found = {}
        for number, scene in self._differing_scenes[1].items():
            sides = (self._differing_scenes[0][number], scene)
            before, after = (
                [rule | {"back": []} for rule in some if rests_on(side, rule["words"], rule["source"])]
                for some, side in zip(rules, sides, strict=True)
            )
            told = [ruled_of(rule, new=True) for rule in after if rule not in before]
            told += [
                ruled_of(rule | {"back": back.get((rule["words"], rule["source"], str(rule["states"])), [])}, new=False)
                for rule in before
                if rule not in after
            ]
            if told:
                found[number] = tuple(told)
        return found

    def _housed(self) -> frozenset[str] | None:
        """Return the objects that differ and rest on a house rule in either run; None where a run does not say."""
        rules = [run["settings"].get(HOUSE_RULES) for run in (self.before, self.after)]
        if None in rules:
            return None
        sides = list(zip(self._differing_scenes, rules, strict=True))
        return frozenset(
            number
            for number in self._differing_scenes[1]
            if any(rests_on(scenes[number], rule["words"], rule["source"]) for scenes, some in sides for rule in some)
        )

    @cached_property
    def inputs(self) -> tuple[InputChange, ...]:
        was, now = self._differing_scenes
        found = []
        for number, scene in now.items():
            before = was[number]
            items = (codec.plain(_HINTS["item"], side.item) for side in (before, scene))
            fields = [f for f in _differing(*items) if f.name not in _OTHERWISE]
            for name in _SCENE:
                one, other = (codec.plain(_HINTS[name], getattr(side, name)) for side in (before, scene))
                if name == "parameters":
                    fields += [FieldChange(f"parameters.{f.name}", f.before, f.after) for f in _differing(one, other)]
                elif one != other:
                    fields.append(FieldChange(f"scene.{name}", one, other))
            if fields:
                found.append(InputChange(number, scene.item.gallery, tuple(fields)))
        return tuple(sorted(found, key=lambda change: (change.gallery, change.object_number)))

    def _scenes(self, places: Mapping[str, _InRun], numbers: Set[str]) -> dict[str, Scene]:
        """Return the scenes of some objects."""
        found: dict[str, Scene] = {}
        for page in dict.fromkeys(places[number].page for number in sorted(numbers)):
            members = load_members(self.connection, page)
            kept, broken = fetch(self.connection, members.wanted)
            if broken:
                raise DamagedRunError(f"result {broken[0][:12]} changed in the database since it was written")
            scenes = (a.scene for a in found_of(members, {k: one.found for k, one in kept.items()}).assessments)
            found |= {scene.item.object_number: scene for scene in scenes if scene.item.object_number in numbers}
        return found

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

    @cached_property
    def settings(self) -> tuple[FieldChange, ...]:
        return _differing(_settings(self.before), _settings(self.after))

    @cached_property
    def versions(self) -> tuple[FieldChange, ...]:
        return _differing(_versions(self.before), _versions(self.after))

    @cached_property
    def causes(self) -> Causes:
        return Causes(self.inputs, self.decisions, self.motions, self.settings, self.versions, self._housed())

    def _news(self) -> tuple[tuple[ObjectChange, ...], dict[str, int]]:
        sides = []
        for places, found in zip(self._places, self._outlines, strict=True):
            sides.append({number: places[number].seen(outline) for number, outline in found.items()})
        before, after = sides
        # A decision that changes nothing leaves its object's page as it is.
        quiet = {c.decision.object_number for c in self.decisions} - before.keys() - after.keys()
        same = self._unchanged(quiet)
        shared = bool(self.motions[0] != self.motions[1] or self.settings or self.versions)
        return news(before | same, after | same, self.decisions, self.causes, shared=shared, ruled=self._ruled())

    def _unchanged(self, numbers: Set[str]) -> dict[str, Seen]:
        """Return those of some objects that are in both runs as they were."""
        left = set(numbers)
        places: dict[str, _InRun] = {}
        query = select(RUN_PAGE.c.key).where(RUN_PAGE.c.run_id == self.new).order_by(RUN_PAGE.c.position)
        for page in self.connection.execute(query).scalars().all() if left else ():
            here = self._on([page])
            places |= {number: here[number] for number in left & here.keys()}
            left -= here.keys()
            if not left:
                break
        return {number: places[number].seen(outline) for number, outline in self._outlined(places).items()}

    def _verdicts(self) -> tuple[VerdictChange, ...]:
        causes, found = self.causes, []
        for was, now in self._both:
            before, after = ({(model, level): verdict for model, level, verdict in o.verdicts} for o in (was, now))
            for model, level in dict.fromkeys([*before, *after]):
                one, other = (side.get((model, level)) for side in (before, after))
                if one != other:
                    number, why = now.object_number, causes.of(now.object_number, level, was.floor, now.floor)
                    found.append(VerdictChange(number, now.gallery, model, level, _verdict(one), _verdict(other), why))
        return tuple(sorted(found, key=lambda c: (c.gallery, c.object_number, c.level, c.model)))


def ruled_of(rule: Mapping[str, Any], *, new: bool) -> Ruled:
    """Return a house rule as news tells it, from what a run keeps of it."""
    classes, about = (tuple(map(str, rule[name])) for name in ("classes", "about"))
    back = tuple(map(str, rule.get("back", ())))
    return Ruled(new, rule["who"], rule["date"], classes, about, dict(rule["states"]), back)


def _verdict(text: str | None) -> Verdict | None:
    return None if text is None else Verdict(text)


_HINTS = get_type_hints(Scene)
_SCENE = ("support", "hanging", "furniture", "furniture_origin", "anchorage", "object_class", "models", "parameters")
"""What an object is run with besides its item; the floor has a cause of its own."""

_NAMED = ("object_number", "gallery", "title", "on_display")

_OTHERWISE = frozenset({"gallery", "provenance"})
"""Fields of an item that are told otherwise (as a move) or only say where another field comes from."""


def _run(connection: Connection, run_id: str) -> Mapping[str, Any]:
    columns = (RUN.c.started, RUN.c.version, RUN.c.settings)
    return dict(connection.execute(select(*columns).where(RUN.c.run_id == run_id)).mappings().one())


def _differing(was: Mapping[str, Any], now: Mapping[str, Any]) -> tuple[FieldChange, ...]:
    return tuple(FieldChange(key, was.get(key), now.get(key)) for key in {**was, **now} if was.get(key) != now.get(key))


def _settings(run: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings that verdicts rest on, by the names that they have in kouros.toml."""
    kept = run["settings"]
    analysis = kept.get("analysis") or {}
    found = {f"analysis.{name}": value for name, value in analysis.items() if name != "workers"}
    found |= {f"display.{name}": value for name, value in (kept.get(DISPLAY) or {}).items()}
    found["site.folder"] = kept.get("site")
    found["collection.rules"] = kept.get(RULES)
    found |= {f"tables.{name}": digest for name, digest in (kept.get(TABLES) or {}).items()}
    found["house"] = kept.get(HOUSE)
    found |= {f"levels.{name}": how for name, how in (kept.get(LEVELS) or {}).items()}
    return found


def _versions(run: Mapping[str, Any]) -> dict[str, Any]:
    kept = run["settings"]
    return {"Kouros": run["version"], "kernels": kept.get(KERNELS), "code and tables": kept.get(CODE)}
