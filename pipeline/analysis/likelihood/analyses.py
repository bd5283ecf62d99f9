"""Analyses of objects in joint samples: the models that each requires, on what is drawn of its numbers and its class.

An object may be of several classes for which something else is computed.  Which of them it is is drawn like its
numbers: each class has a part of the shares of one role, as wide as its chance, and in a sample the models of the class
are run in whose part the sample's share lies.

Other classes that an object may be of: its scene as each of them, where something else is computed for it.

What a person decided, an identifier or a rule of the museum's own says is certain.  Where the record names no class, an
object is taken for the one that `classify` falls back to, and that has what the others leave.
"""

from collections.abc import Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.classify import classify
from pipeline.analysis.furniture import FurnitureFilter, filter_of
from pipeline.analysis.house.matching import HouseRules
from pipeline.analysis.likelihood.draws import Draw, JointDraws, Ranges, direction
from pipeline.analysis.plan import Indices, own_angle, requirements, unique_rows
from pipeline.analysis.rule_table import RuleTable
from pipeline.analysis.verdicts import capacity_of, utilisation
from pipeline.models.rigid_body import rocking_harms
from pipeline.quantities import Array
from pipeline.records import Columns, Estimate, Excitation, Harm, Model, Motion, Scene
from pipeline.records.likelihood import CLASS
from pipeline.tables.assumed import assumed

STATES = tuple(Harm)

HARMFUL = (Harm.LEAVES, Harm.FALLS, Harm.BREAKS)
"""States that harm whatever reaches them; rocking does where neither the museum nor its class says that it does not."""

Transfer = tuple[str, tuple[tuple[str, float], ...]]
"""An isolator that passes the motion on: its model, and its parameters by name."""

Groups = Mapping[tuple[FurnitureFilter | None, Transfer | None], Sequence["Analyses"]]
"""Analyses by what their shaking passes through."""


@dataclass(frozen=True)
class Kind:
    """A class that an object may be of, or several for which the same is computed.

    Attributes
    ----------
    classes : tuple of str
        Their names; () where it is certain.
    start, end : float
        Between which shares of the role `CLASS` a sample has the object be that: 0 to 1 where it is certain.
    """

    classes: tuple[str, ...] = ()
    start: float = 0.0
    end: float = 1.0

    @property
    def chance(self) -> float:
        """How likely it is of one of them."""
        return self.end - self.start


CERTAIN = Kind()


@dataclass(frozen=True)
class Stood:
    """A scene as it is shaken.

    Attributes
    ----------
    of : int
        Which object it belongs to.
    scene : Scene
        What is run.
    isolator : Transfer or None
        What passes the motion of its furniture on to it.
    kind : Kind
        What the object is where this is run.
    """

    of: int
    scene: Scene
    isolator: Transfer | None = None
    kind: Kind = CERTAIN


def kinds_of(stood: Iterable[Stood]) -> dict[int, tuple[Kind, ...]]:
    """Return of each object whose class is not certain what it may be, the likeliest class first."""
    out: dict[int, tuple[Kind, ...]] = {}
    for one in stood:
        known = out.get(one.of, ())
        if one.kind is not CERTAIN and one.kind not in known:
            out[one.of] = (*known, one.kind)
    return out


def grouped(stood: Sequence[Stood], x_azimuth: float) -> Groups:
    """Return the analyses of scenes by what their shaking passes through.

    Parameters
    ----------
    x_azimuth : float
        Degrees clockwise from north of the x axis of the motions.

    Returns
    -------
    Groups
    """
    groups: dict[tuple[FurnitureFilter | None, Transfer | None], list[Analyses]] = {}
    for model, furniture, members in requirements([one.scene for one in stood])[0]:
        by_isolator: dict[Transfer | None, list[Stood]] = {}
        for at in members:
            by_isolator.setdefault(stood[at].isolator, []).append(stood[at])
        for isolator, those in by_isolator.items():
            for angle, alike in _turned(model, those, x_azimuth):
                groups.setdefault((furniture, isolator), []).append(_analyses(model, alike, angle))
    return groups


@dataclass(frozen=True)
class Harmful:
    """Which states harm objects.

    Attributes
    ----------
    ever : ndarray of bool, shape (s, m)
        Each object, whatever it is.
    others : tuple of (int, Kind, ndarray of bool, shape (s,))
        The object, what it may be, and the states that harm it then, of those for which that is not the same.
    """

    ever: NDArray[np.bool_]
    others: tuple[tuple[int, Kind, NDArray[np.bool_]], ...] = ()

    def at(self, draw: Draw) -> NDArray[np.bool_]:
        """Return the states that harm each object as it is in a sample, (s, m)."""
        if not self.others:
            return self.ever
        share, out = draw.share(CLASS), self.ever.copy()
        for of, kind, states in self.others:
            if kind.start <= share < kind.end:
                out[:, of] = states
        return out


def harmful_states(stood: Sequence[Stood], count: int) -> Harmful:
    """Return which states harm each object."""
    each: dict[tuple[int, Kind], NDArray[np.bool_]] = {}
    for one in stood:
        harms = (*HARMFUL, Harm.ROCKS) if rocking_harms(one.scene) else HARMFUL
        states = np.array([state in harms for state in STATES])
        # What stands on an isolator comes after it.
        each[one.of, one.kind] = states
    ever = np.zeros((len(STATES), count), dtype=bool)
    for (of, _), states in each.items():
        ever[:, of] |= states
    others = tuple((of, kind, states) for (of, kind), states in each.items() if np.any(states != ever[:, of]))
    return Harmful(ever, others)


def possible_states(groups: Groups, count: int) -> NDArray[np.bool_]:
    """Return which states each object can reach, (s, m)."""
    possible = np.zeros((len(STATES), count), dtype=bool)
    for (furniture, _), those in groups.items():
        tips = (Harm.FALLS,) if furniture is not None and furniture.loose is not None else ()
        for one in those:
            for state in (*one.model.reachable, *tips):
                possible[STATES.index(state), one.of] = True
    return possible


def _turned(model: Model, stood: Sequence[Stood], x_azimuth: float) -> Iterator[tuple[float | None, list[Stood]]]:
    """Yield those that are turned alike, by the angle of their width; None: nobody says it."""
    by_angle: dict[float | None, list[Stood]] = {}
    for one in stood:
        angle = own_angle(model, one.scene, x_azimuth)
        by_angle.setdefault(None if np.isnan(angle) else angle, []).append(one)
    yield from by_angle.items()


@dataclass(frozen=True)
class Analyses:
    """Analyses of one model on scenes that are turned alike.

    Attributes
    ----------
    of : (m,) the object of each
    start, end : (m,) of each the shares of the role `CLASS` at which its object is what is run
    angle : of their width, degrees from x towards y; None: drawn
    ways : by direction, the parameters that a body has along it
    tied : by direction, parameters that go up and down with another one: by name the other one's, and how many times
           it, (m,)
    """

    model: Model
    of: Indices
    start: Array
    end: Array
    angle: float | None
    ways: tuple[tuple[Ranges, ...], ...]
    tied: tuple[Mapping[str, tuple[str, Array]], ...]
    wider: Array
    output: tuple[str, ...]
    capacity: Ranges
    room: Ranges

    @cached_property
    def outputs(self) -> frozenset[str]:
        """The different outputs that are held against capacities."""
        return frozenset(self.output)

    @cached_property
    def _certain(self) -> bool:
        return bool(np.all(self.start <= 0.0) and np.all(self.end >= 1.0))

    def chosen(self, draws: Sequence[Draw], wanted: NDArray[np.bool_]) -> list[Indices]:
        """Return by sample the places of those whose objects are wanted, and are in it what is run here."""
        mine = np.flatnonzero(wanted[self.of])
        if self._certain:
            return [mine] * len(draws)
        start, end = self.start[mine], self.end[mine]
        shares = (draw.share(CLASS) for draw in draws)
        return [mine[(start <= share) & (share < end)] for share in shares]

    def uncertain(self, ranges: Ranges) -> NDArray[np.bool_]:
        """Return of which a measurement would settle a parameter; where the class is not certain, of the likeliest."""
        free = np.isnan(self.tied[0][ranges.name][1]) if ranges.name in self.tied[0] else np.True_
        return np.asarray((ranges.low < ranges.high) & free & (self.start <= 0.0))

    def run(
        self,
        felt: Sequence[Motion | None],
        each: Sequence[Draw],
        chosen: Sequence[Indices],
        reached: NDArray[np.bool_],
    ) -> None:
        """Add what is reached in some samples, (n, s, objects), by those at some places.

        Parameters
        ----------
        felt
            What each sample shakes them by; None: nothing of it is chosen.
        each
            The samples.
        chosen
            Of each sample who is run.
        reached
            Filled in.
        """
        model, where = self.model, np.concatenate(chosen)
        if where.size == 0:
            return
        draws = JointDraws(each, np.repeat(np.arange(len(each)), [which.size for which in chosen]))
        for at, way in enumerate(self.ways):
            values = self._values(way, self.tied[at], draws, where, wide=bool(at) and self.angle is None)
            excitations = [
                None if one is None else self._excitation(one, draw, at) for one, draw in zip(felt, each, strict=True)
            ]
            # What it shows to rest need not be integrated: of all hung works it leaves one of six.
            moving = [_moving(model, *one) for one in _by_sample(excitations, draws.of, values)]
            some = np.flatnonzero(np.concatenate(moving))
            if some.size == 0:
                continue
            # Of those that are the same in a sample one is run.
            first, of_each = unique_rows(np.column_stack([draws.of[some], *(one[some] for one in values.values())]))
            runs = {name: one[some[first]] for name, one in values.items()}
            ran = [model.run(*one, 1, False) for one in _by_sample(excitations, draws.of[some[first]], runs)]
            columns = {name: np.concatenate([one[name] for one in ran])[of_each] for name in ran[0]}
            mine, drawn = where[some], draws.take(some)
            capacity, room = (one.at(drawn, mine) for one in (self.capacity, self.room))
            for state, mask in model.reached(columns, self._exceeded(columns, mine, capacity), room).items():
                reached[drawn.of[mask], STATES.index(state), self.of[mine[mask]]] = True

    def _excitation(self, felt: Motion, draw: Draw, way: int) -> Excitation:
        if self.model.directions != 1 or (self.model.resultant and self.angle is None):
            return felt.excitation(None)
        turned = direction(draw) + (90.0 if self.model.across else 0.0) if self.angle is None else self.angle
        return felt.excitation(turned + 90.0 * way)

    def _values(
        self,
        way: Sequence[Ranges],
        tied: Mapping[str, tuple[str, Array]],
        draws: JointDraws,
        chosen: Indices,
        *,
        wide: bool,
    ) -> dict[str, Array]:
        values = {one.name: one.at(draws, chosen) for one in way}
        for name, (other, times) in tied.items():
            mine = times[chosen]
            values[name] = np.where(np.isnan(mine), values[name], mine * values[other])
        for name in _HALVES if wide else ():
            if name in values:
                values[name] = self.wider[chosen] * values[name]
        return {name: np.ascontiguousarray(one) for name, one in values.items()}

    def _exceeded(self, columns: Columns, chosen: Indices, capacity: Array) -> NDArray[np.bool_]:
        demand = np.empty(chosen.size)
        if len(self.outputs) == 1:
            return ~(utilisation(columns[self.output[0]], capacity) <= 1.0)
        for output in self.outputs:
            mine = np.array([self.output[at] == output for at in chosen])
            demand[mine] = columns[output][mine]
        # What could not be followed may be anything.
        return ~(utilisation(demand, capacity) <= 1.0)


def _by_sample(
    excitations: Sequence[Excitation | None], of: Indices, values: Mapping[str, Array]
) -> Iterator[tuple[Excitation, dict[str, Array]]]:
    """Yield what shakes each sample with the values (n,) that are of it; those of a sample stand together."""
    bounds = np.searchsorted(of, np.arange(len(excitations) + 1)).tolist()
    for excitation, start, end in zip(excitations, bounds[:-1], bounds[1:], strict=True):
        if excitation is not None and start < end:
            yield excitation, {name: one[start:end] for name, one in values.items()}


_HALVES = ("half_width", "half_width_other")


def _moving(model: Model, excitation: Excitation, values: Mapping[str, Array]) -> NDArray[np.bool_]:
    if model.certificate is None or model.rests is None:
        return np.ones(next(iter(values.values())).size, dtype=bool)
    return np.asarray(model.certificate(excitation, values) > model.rests)


def _analyses(model: Model, stood: Sequence[Stood], angle: float | None) -> Analyses:
    scenes = [one.scene for one in stood]
    names = [q.name for q in model.needs]
    defaults = {q.name: np.nan if q.default is None else q.default for q in model.needs}
    axes = model.axes if model.directions == 1 and not (model.resultant and angle is None) else ({},)
    ways, tied = [], []
    for axis in axes:
        # What is known along its own axis takes the place of what is known of it as a whole.
        known = [
            {n: s.parameters.get(axis.get(n, n) if angle is not None else n) or s.parameters.get(n) for n in names}
            for s in scenes
        ]
        ways.append(tuple(Ranges.of(name, [one[name] for one in known], defaults[name]) for name in names))
        tied.append(_ties(scenes, known))
    capacities = [capacity_of(model, scene) for scene in scenes]
    named = model.capacity if isinstance(model.capacity, str) else ""
    return Analyses(
        model,
        np.array([one.of for one in stood], dtype=np.intp),
        np.array([one.kind.start for one in stood]),
        np.array([one.kind.end for one in stood]),
        angle,
        tuple(ways),
        tuple(tied),
        np.array([_aspect(scene) for scene in scenes]),
        tuple(output for output, _ in capacities),
        Ranges.of(named or "clearance", [estimate for _, estimate in capacities], np.nan),
        Ranges.of("clearance", [scene.parameters.get("clearance") for scene in scenes], np.inf),
    )


def _ties(scenes: Sequence[Scene], known: Sequence[Mapping[str, Estimate | None]]) -> dict[str, tuple[str, Array]]:
    """Return of parameters that are in proportion to another one which, and how many times that, (m,); NaN: not."""
    out: dict[str, tuple[str, Array]] = {}
    for at, (scene, those) in enumerate(zip(scenes, known, strict=True)):
        for name, estimate in those.items():
            if estimate is None or not estimate.per or estimate.per not in those:
                continue
            other = scene.parameters.get(estimate.per)
            if other is not None and other.value:
                times = out.setdefault(name, (estimate.per, np.full(len(scenes), np.nan)))[1]
                times[at] = estimate.value / other.value
    return out


def _aspect(scene: Scene) -> float:
    """Return how much wider an object is across its narrow side than along it, 1 where nobody says it."""
    item = scene.item
    for width, depth in ((item.base_width_m, item.base_depth_m), (item.width_m, item.depth_m)):
        if width and depth:
            return max(width, depth) / min(width, depth)
    return 1.0


LEAST = 0.05
"""Chance below which a class is left out, and the others weighed alone: judgement, 0.02 to 0.1.

Below it a class has 3 samples of 64, which tell nothing of it, and harm that only it may come to stays unlikely."""


class MayBe(NamedTuple):
    """A class that an object may be of, or several for which the same is computed.

    Attributes
    ----------
    classes : tuple of str
        Their names.
    chance : float
        How likely it is of one of them; those of an object need not add up to 1.
    scene : Scene
        The object as one of them.
    """

    classes: tuple[str, ...]
    chance: float
    scene: Scene


def scenes_by_class(scene: Scene, rules: RuleTable | None = None, house: HouseRules | None = None) -> list[MayBe]:
    """Return the scenes of an object as each class that it may be of, the one that it is taken for first.

    Parameters
    ----------
    scene : Scene
        The object as `classify` returned it.
    rules, house
        As `classify` got them.

    Returns
    -------
    list of MayBe
        None where its class is certain or makes no difference, and where nothing can be computed for the class that it
        is taken for.  A class for which nothing can be computed is not among them.
    """
    named = (assumed() if rules is None else rules.values).classes
    others = [(name, p) for name, p in scene.chances if name != scene.object_class and p >= LEAST and name in named]
    if not others or not scene.models or scene.missing:
        return []
    first = scene.chances[0]
    # Where the record says nothing it is no guess but what is left.
    mine = first[1] if first[0] == scene.object_class else max(1.0 - sum(p for _, p in others), LEAST)
    each = [(scene.object_class, mine, scene)]
    each += [
        (name, p, classify(scene.item, rules, (name, "another class that is possible"), house)) for name, p in others
    ]
    runs = _runs([one for *_, one in each])
    if not runs[0]:
        return []
    alike: dict[Hashable, MayBe] = {}
    for (name, p, one), some in zip(each, runs, strict=True):
        if some:
            known = alike.get(key := computed(one))
            alike[key] = (
                MayBe((name,), p, one)
                if known is None
                else known._replace(classes=(*known.classes, name), chance=known.chance + p)
            )
    return list(alike.values()) if len(alike) > 1 else []


def _runs(scenes: Sequence[Scene]) -> list[bool]:
    """Say of scenes whether any model is run on them."""
    some = {at for _, _, members in requirements(scenes)[0] for at in members}
    return [at in some for at in range(len(scenes))]


def computed(scene: Scene) -> Hashable:
    """Return all of a scene of an object that joint samples of it look at."""
    known = sorted(scene.parameters.items())
    return (
        *(scene.support, scene.models, scene.hanging, filter_of(scene)),
        tuple((name, one.low, one.value, one.high, one.per) for name, one in known),
    )
