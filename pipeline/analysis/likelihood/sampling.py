"""Probabilities of harm, by joint sampling: as many samples of each object as its word takes, and no more.

A sample is a motion of the level, scaled by the scatter of the models, through furniture that is drawn, on a body that
is drawn.  All models that an object requires are run on the same sample, so that their states come together as they
would in one earthquake, and an object is harmed where any of them harms it.  Objects in the same kind of furniture
share the shaking of a sample, which is found once for all of them.

Where nobody says how an object is turned, the direction is drawn too, and a body is shaken along both of its axes at
once: a round one tips in any direction, and one plane alone would miss a third of its falls (of 150 bodies in six
degrees of freedom 37 % fell where one plane through the same motion said 25 %).
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache, partial
from itertools import pairwise
from math import ceil, log2

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.furniture import FurnitureFilter
from pipeline.analysis.likelihood.draws import ONE_CAUSE, Draw, Ranges
from pipeline.analysis.likelihood.shaking import direction, drawn_motion, through
from pipeline.analysis.likelihood.worth import most_telling
from pipeline.analysis.loose import FINEST
from pipeline.analysis.plan import Indices, own_angle, requirements, unique_rows
from pipeline.analysis.transmission import transmit
from pipeline.analysis.verdicts import LevelMotions, capacity_of, utilisation
from pipeline.models.rigid_body import rocking_harms
from pipeline.quantities import Array
from pipeline.records import Columns, Estimate, Excitation, Executor, Harm, Likelihood, Model, Motion, Sampling, Scene

FIRST = 64
"""Samples that are taken of every object."""

FEWEST = 16
"""The same where one question alone is asked: none of 16 harmed says below 10 % with a probability of 0.93."""

STATES = tuple(Harm)

HARMFUL = (Harm.LEAVES, Harm.FALLS, Harm.BREAKS)
"""States that harm whatever reaches them; rocking does where neither the museum nor its class says that it does not."""

Transfer = tuple[str, tuple[tuple[str, float], ...]]
"""An isolator that passes the motion on: its model, and its parameters by name."""


ACTS = 2
"""Which of the edges between words is that from which on something is done: "possible"."""

PART = 8
"""Samples that one who works runs in one go."""

_REMEMBERED = 4 * FEWEST
"""Shakings of samples that are remembered, of 0.3 MB each as a rule: of what measures are tried in."""

Groups = Mapping[tuple[FurnitureFilter | None, Transfer | None], Sequence["_Analyses"]]
"""Analyses by what their shaking passes through."""


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
    """

    of: int
    scene: Scene
    isolator: Transfer | None = None


def likelihoods(
    stood: Sequence[Stood],
    count: int,
    levels: Sequence[LevelMotions],
    sampling: Sampling,
    executor: Executor,
    *,
    telling: bool = True,
    first: int = FIRST,
) -> list[tuple[Likelihood, ...]]:
    """Return how likely objects come to harm at each level.

    Parameters
    ----------
    stood
        Their scenes; those on an isolator, and others of which a part feels something else, several for an object.
    count
        How many objects there are.
    levels
        The motions of their floor.
    sampling
        How many samples, and the words.
    executor
        Where the samples are run.
    telling
        Whether to find what one measurement would tell.
    first
        Samples that are taken of every object.

    Returns
    -------
    list of tuple of Likelihood
        Of each object one for each level; none of one for which no model is run.
    """
    groups, harmful = grouped(stood, levels[0].x_azimuth), harmful_states(stood, count)
    uncertain = _uncertain((one for those in groups.values() for one in those), count) if telling else {}
    out: list[tuple[Likelihood, ...]] = [() for _ in range(count)]
    asked = sorted({at for those in groups.values() for one in those for at in one.of.tolist()})
    for level in levels:
        counted = _counted(groups, count, np.array(asked, dtype=np.intp), harmful, level, sampling, executor, first)
        bits = np.concatenate(counted.bits) if counted.bits else np.zeros((0, count), dtype=bool)
        names, worth, moves = most_telling(bits, counted.taken, uncertain, sampling.edges[ACTS], sampling)
        for at in asked:
            best = names[at], float(worth[at]), float(moves[at])
            out[at] = (*out[at], counted.told(at, level.name, harmful[:, at], sampling, best))
    return out


def grouped(stood: Sequence[Stood], x_azimuth: float) -> Groups:
    """Return the analyses of scenes by what their shaking passes through.

    x_azimuth : degrees clockwise from north of the x axis of the motions
    """
    groups: dict[tuple[FurnitureFilter | None, Transfer | None], list[_Analyses]] = {}
    for model, furniture, members in requirements([one.scene for one in stood])[0]:
        by_isolator: dict[Transfer | None, list[Stood]] = {}
        for at in members:
            by_isolator.setdefault(stood[at].isolator, []).append(stood[at])
        for isolator, those in by_isolator.items():
            for angle, alike in _turned(model, those, x_azimuth):
                groups.setdefault((furniture, isolator), []).append(_analyses(model, alike, angle))
    return groups


def harmful_states(stood: Sequence[Stood], count: int) -> NDArray[np.bool_]:
    """Return which states harm each object, (s, m)."""
    harmful = np.zeros((len(STATES), count), dtype=bool)
    for one in stood:
        harms = (*HARMFUL, Harm.ROCKS) if rocking_harms(one.scene) else HARMFUL
        harmful[:, one.of] = [state in harms for state in STATES]
    return harmful


def possible_states(groups: Groups, count: int) -> NDArray[np.bool_]:
    """Return which states each object can reach, (s, m)."""
    possible = np.zeros((len(STATES), count), dtype=bool)
    for (furniture, _), those in groups.items():
        tips = (Harm.FALLS,) if furniture is not None and furniture.loose is not None else ()
        for one in those:
            for state in (*one.model.reachable, *tips):
                possible[STATES.index(state), one.of] = True
    return possible


@dataclass
class _Counted:
    """Samples so far: of each object how many were taken (m,), harmed it (m,), and reached each state (s, m).

    possible : whether it can reach each state, (s, m);  bits : by part of the samples, which harmed it, (n, m)
    """

    taken: Indices
    harmed: Indices
    reached: NDArray[np.intp]
    possible: NDArray[np.bool_]
    bits: list[NDArray[np.bool_]]

    def told(
        self, at: int, level: str, harmful: NDArray[np.bool_], sampling: Sampling, telling: tuple[str, float, float]
    ) -> Likelihood:
        taken, harmed = int(self.taken[at]), int(self.harmed[at])
        share = harmed / taken
        # Jeffreys's: a probability is not known to be nothing because nothing was seen.
        a, b = harmed + 0.5, taken - harmed + 0.5
        error = float(np.sqrt(a * b / (a + b) ** 2 / (a + b + 1.0)))
        reached = self.reached[:, at]
        states = {
            s.value: int(n) / taken for s, n, may in zip(STATES, reached, self.possible[:, at], strict=True) if may
        }
        often = np.where(harmful, reached, 0)
        # What falls has rocked before.
        rocks, falls = STATES.index(Harm.ROCKS), STATES.index(Harm.FALLS)
        often[rocks] = max(0, often[rocks] - often[falls])
        likeliest, at_worst = max((n, i) for i, n in enumerate(often.tolist()))
        named = STATES[at_worst].value if likeliest else ""
        return Likelihood(level, share, error, taken, sampling.band(share), named, states, *telling)


def _counted(
    groups: Groups,
    count: int,
    asked: Indices,
    harmful: NDArray[np.bool_],
    level: LevelMotions,
    sampling: Sampling,
    executor: Executor,
    first: int,
) -> _Counted:
    done = _Counted(
        np.zeros(count, dtype=np.intp),
        np.zeros(count, dtype=np.intp),
        np.zeros((len(STATES), count), dtype=np.intp),
        possible_states(groups, count),
        [],
    )
    wanted = np.zeros(count, dtype=bool)
    wanted[asked] = True
    for start, end in pairwise(_stages(sampling.samples, first)):
        parts = [range(at, min(at + PART, end)) for at in range(start, end, PART)]
        work = partial(sampled, groups=groups, wanted=wanted, harmful=harmful, level=level, most=sampling.samples)
        for reached, harmed in executor.map(work, parts):
            done.reached += reached
            done.bits.append(harmed)
            done.harmed += harmed.sum(axis=0)
        done.taken += (end - start) * wanted
        wanted = wanted & ~_certain(done, sampling)
        if not wanted.any():
            break
    return done


def sampled(
    numbers: Sequence[int],
    *,
    groups: Groups,
    wanted: NDArray[np.bool_],
    harmful: NDArray[np.bool_],
    level: LevelMotions,
    most: int,
) -> tuple[Indices, NDArray[np.bool_]]:
    """Return of those wanted how often some samples reach each state, (s, m), and which harm each object, (n, m)."""
    total, harmed = np.zeros(harmful.shape, dtype=np.intp), np.zeros((len(numbers), wanted.size), dtype=bool)
    for at, number in enumerate(numbers):
        draw = Draw(number, most)
        reached = np.zeros_like(harmful)
        for (furniture, isolator), those in groups.items():
            some = [one for one in those if wanted[one.of].any()]
            if not some:
                continue
            felt, falls = _felt(level.motions, furniture, isolator, draw)
            for one in some:
                one.run(felt, draw, wanted, reached)
                if falls:
                    reached[STATES.index(Harm.FALLS), one.of[wanted[one.of]]] = True
        total += reached
        harmed[at] = (reached & harmful).any(axis=0)
    return total, harmed


def _felt(
    motions: tuple[Motion, ...], furniture: FurnitureFilter | None, isolator: Transfer | None, draw: Draw
) -> tuple[Motion, bool]:
    # Measures are tried under the first samples again and again, on an isolator or under later ones hardly ever.
    find = _felt_before if isolator is None and draw.number < FEWEST else _shaken
    return find(motions, furniture, isolator, draw)


def _shaken(
    motions: tuple[Motion, ...], furniture: FurnitureFilter | None, isolator: Transfer | None, draw: Draw
) -> tuple[Motion, bool]:
    felt, falls = through(drawn_motion(motions, draw), furniture, draw)
    if isolator is None:
        return felt, falls
    # What slips jumps between samples.
    return transmit(isolator[0], felt, refine=max(1, ceil(felt.dt / FINEST - 1e-9)), **dict(isolator[1])), falls


_felt_before = lru_cache(maxsize=_REMEMBERED)(_shaken)


def _uncertain(analyses: Iterable["_Analyses"], count: int) -> dict[str, NDArray[np.bool_]]:
    """Return by parameter of which objects it is a range that a measurement would settle, (m,)."""
    out: dict[str, NDArray[np.bool_]] = {}
    for one in analyses:
        for ranges in (*one.ways[0], one.capacity, one.room):
            name = ONE_CAUSE.get(ranges.name, ranges.name)
            mine = out.setdefault(name, np.zeros(count, dtype=bool))
            free = np.isnan(one.tied[0][ranges.name][1]) if ranges.name in one.tied[0] else True
            mine[one.of[(ranges.low < ranges.high) & free]] = True
    return out


def _stages(samples: int, first: int) -> list[int]:
    first = min(first, samples)
    return [0, *(first * 2**k for k in range(round(log2(samples / first)) + 1))]


def _certain(done: _Counted, sampling: Sampling) -> NDArray[np.bool_]:
    """Say of which objects the word is as certain as is asked, by Jeffreys's interval."""
    from scipy.special import betainc

    taken = np.maximum(done.taken, 1)
    ends = np.minimum(np.array([sampling.ends(share) for share in (done.harmed / taken).tolist()]).T, 1.0)
    a, b = done.harmed + 0.5, done.taken - done.harmed + 0.5
    inside = betainc(a, b, ends[1]) - betainc(a, b, ends[0])
    return np.asarray(inside >= sampling.certainty)


def _turned(model: Model, stood: Sequence[Stood], x_azimuth: float) -> Iterator[tuple[float | None, list[Stood]]]:
    """Yield those that are turned alike, by the angle of their width; None: nobody says it."""
    by_angle: dict[float | None, list[Stood]] = {}
    for one in stood:
        angle = own_angle(model, one.scene, x_azimuth)
        by_angle.setdefault(None if np.isnan(angle) else angle, []).append(one)
    yield from by_angle.items()


@dataclass(frozen=True)
class _Analyses:
    """Analyses of one model on scenes that are turned alike.

    Attributes
    ----------
    of : (m,) the object of each
    angle : of their width, degrees from x towards y; None: drawn
    ways : by direction, the parameters that a body has along it
    tied : by direction, parameters that go up and down with another one: by name the other one's, and how many times
           it, (m,)
    """

    model: Model
    of: Indices
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

    def run(self, felt: Motion, draw: Draw, wanted: NDArray[np.bool_], reached: NDArray[np.bool_]) -> None:
        """Add what is reached in a sample, (s, objects), by the objects that are wanted."""
        model, chosen = self.model, np.flatnonzero(wanted[self.of])
        if chosen.size == 0:
            return
        turned = direction(draw) + (90.0 if model.across else 0.0) if self.angle is None else self.angle
        for at, way in enumerate(self.ways):
            values = self._values(way, self.tied[at], draw, chosen, wide=bool(at) and self.angle is None)
            along = None if model.directions != 1 or (model.resultant and self.angle is None) else turned + 90.0 * at
            excitation = felt.excitation(along)
            # What it shows to rest need not be integrated: of all hung works it leaves one of six.
            moves = _moving(model, excitation, values)
            if not moves.any():
                continue
            some = chosen[moves]
            # Of those that are the same one is run.
            first, of_each = unique_rows(np.column_stack([one[moves] for one in values.values()]))
            ran = model.run(excitation, {name: one[moves][first] for name, one in values.items()}, 1, False)
            columns = {name: column[of_each] for name, column in ran.items()}
            capacity, room = (one.at(draw, some) for one in (self.capacity, self.room))
            for state, mask in model.reached(columns, self._exceeded(columns, some, capacity), room).items():
                reached[STATES.index(state), self.of[some]] |= mask

    def _values(
        self, way: Sequence[Ranges], tied: Mapping[str, tuple[str, Array]], draw: Draw, chosen: Indices, *, wide: bool
    ) -> dict[str, Array]:
        values = {one.name: one.at(draw, chosen) for one in way}
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


_HALVES = ("half_width", "half_width_other")


def _moving(model: Model, excitation: Excitation, values: Mapping[str, Array]) -> NDArray[np.bool_]:
    if model.certificate is None or model.rests is None:
        return np.ones(next(iter(values.values())).size, dtype=bool)
    return np.asarray(model.certificate(excitation, values) > model.rests)


def _analyses(model: Model, stood: Sequence[Stood], angle: float | None) -> _Analyses:
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
    return _Analyses(
        model,
        np.array([one.of for one in stood], dtype=np.intp),
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
