"""Scene -> which models, with which parameters, and why the others not; equal work only once."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.furniture import FurnitureFilter, filter_of
from pipeline.analysis.verdicts import EAST, capacity_of
from pipeline.models import MODELS
from pipeline.quantities import Array
from pipeline.records import Model, Scene

Indices = NDArray[np.intp]
"""Places in another array, (n,)."""


@dataclass(frozen=True)
class Spans:
    """What analyses look at: parameter sets, first with the best estimates, then at all corners of what is uncertain.

    Attributes
    ----------
    rows : Indices
        (v, a) rows of the work's values; a is 2 where an object is shaken along each of its own axes in turn, of which
        the larger demand counts.
    starts : Indices
        (m,) where each analysis begins.
    """

    rows: Indices
    starts: Indices

    @cached_property
    def lengths(self) -> Indices:
        """How many parameter sets each analysis has, (m,)."""
        return np.diff(np.append(self.starts, self.rows.shape[0]))

    def take(self, chosen: Indices) -> "Spans":
        """Return those of some analyses, in their order."""
        lengths = self.lengths[chosen]
        starts = np.concatenate([[0], np.cumsum(lengths)[:-1]]).astype(np.intp)
        at = np.arange(int(lengths.sum())) + np.repeat(self.starts[chosen] - starts, lengths)
        return Spans(self.rows[at], starts)

    def each(self, column: Array) -> Array:
        """Return a demand (k,) set by set, (v,): the larger of an object's own axes."""
        out = column[self.rows[:, 0]]
        for other in self.rows.T[1:]:
            out = np.maximum(out, column[other])
        return out

    def highest(self, column: Array) -> Array:
        """Return the highest demand of each analysis, (m,)."""
        return np.asarray(np.maximum.reduceat(self.each(column), self.starts))

    def lowest(self, column: Array) -> Array:
        """Return the lowest demand of each analysis, (m,)."""
        return np.asarray(np.minimum.reduceat(self.each(column), self.starts))

    def furthest(self, steps: NDArray[np.int8]) -> NDArray[np.int8]:
        """Return the largest of steps (k,) of each analysis, (m,)."""
        return np.asarray(np.maximum.reduceat(steps[self.rows].max(axis=1), self.starts))

    def best(self, column: Array) -> Array:
        """Return the demand of each analysis by its best estimates, (m,)."""
        return np.asarray(column[self.rows[self.starts]].max(axis=1))

    def spread(self, each: Array) -> Array:
        """Return what is said of each analysis, (m,), set by set, (v,)."""
        return np.repeat(each, self.lengths)


@dataclass(frozen=True)
class Work:
    """All analyses of one model in one kind of furniture: parameter sets, and which of them each scene asked for.

    Attributes
    ----------
    values : mapping of str to Array
        By parameter, (k,) sets, each once for those that ask the same of it.
    angles : Array
        (k,) degrees from x towards y along which each is shaken; NaN: in both directions, or the worst counts.
    scenes : Indices
        (m,) index of the scene of each analysis.
    spans : Spans
        Which sets each analysis looks at.
    furniture : FurnitureFilter or None
        What they all stand in; None: it does nothing to the shaking.
    """

    model: Model
    values: Mapping[str, Array]
    angles: Array
    scenes: Indices
    spans: Spans
    furniture: FurnitureFilter | None = None

    @property
    def size(self) -> int:
        """How many parameter sets there are, k."""
        return self.angles.size

    @cached_property
    def first(self) -> Indices:
        """Of each parameter set the first that is the same, (k,): what is run is run for that one."""
        first, place = unique_rows(np.column_stack([*self.values.values(), self.angles]))
        return first[place]

    @cached_property
    def searched(self) -> NDArray[np.bool_]:
        """Of which parameter sets the model searches a band, (k,)."""
        ends = [(self.values[lower], self.values[upper]) for lower, upper in self.model.searched.items()]
        return np.any([upper > lower for lower, upper in ends], axis=0) if ends else np.zeros(self.size, dtype=bool)

    def some(self, rows: Indices) -> dict[str, Array]:
        """Return the parameters of some rows."""
        return {name: column[rows] for name, column in self.values.items()}

    def by_angle(self, rows: Indices) -> list[tuple[float | None, Indices]]:
        """Return some rows, grouped by the angle that they are shaken along; None: NaN."""
        angles = self.angles[rows]
        free = np.isnan(angles)
        out: list[tuple[float | None, Indices]] = [(None, rows[free])] if free.any() else []
        if not free.all():
            turned = rows[~free]
            order = np.argsort(self.angles[turned], kind="stable")
            each, first = np.unique(self.angles[turned][order], return_index=True)
            parts = np.split(turned[order], first[1:])
            out += [(float(angle), part) for angle, part in zip(each, parts, strict=True)]
        return out


@dataclass(frozen=True)
class Plan:
    """What to run, and for each scene which models were not run and why."""

    work: tuple[Work, ...]
    skipped: tuple[Mapping[str, str], ...]


def plan(scenes: Sequence[Scene], x_azimuth: float = EAST) -> Plan:
    """Choose the models of each scene and gather their parameter sets, each once for all that ask the same of it.

    Parameters
    ----------
    x_azimuth : float, optional
        Degrees clockwise from north of the x axis of the motions.

    Returns
    -------
    Plan
    """
    required, skipped = requirements(scenes)
    work = (
        replace(_gather(model, scenes, which, x_azimuth), furniture=furniture) for model, furniture, which in required
    )
    return Plan(tuple(work), skipped)


Required = tuple[Model, FurnitureFilter | None, list[int]]
"""A model, a kind of furniture, and the places of the scenes in it that the model is run for."""


def requirements(scenes: Sequence[Scene]) -> tuple[list[Required], tuple[Mapping[str, str], ...]]:
    """Return which models are run for which scenes, by furniture, and for each scene why the others are not."""
    reasons: dict[Hashable, tuple[tuple[int, ...], Mapping[str, str]]] = {}
    chosen: list[dict[FurnitureFilter | None, list[int]]] = [{} for _ in MODELS]
    skipped = []
    for index, scene in enumerate(scenes):
        key = _kind(scene)
        if key not in reasons:
            reasons[key] = _choose(scene)
        models, why = reasons[key]
        skipped.append(why)
        furniture = filter_of(scene)
        for model in models:
            chosen[model].setdefault(furniture, []).append(index)
    required = [
        (model, furniture, which)
        for model, groups in zip(MODELS, chosen, strict=True)
        for furniture, which in groups.items()
    ]
    return required, tuple(skipped)


def _kind(scene: Scene) -> Hashable:
    # All that the choice of models may look at (see Model.applies): scenes alike in it are decided once.
    known = scene.parameters
    return (
        scene.object_class,
        scene.support,
        scene.hanging,
        scene.mount,
        scene.models,
        scene.missing,
        scene.rule,
        scene.item.isolator,
        tuple(known),
        known.get("frequency"),
    )


def _choose(scene: Scene) -> tuple[tuple[int, ...], Mapping[str, str]]:
    reasons = [_reason(model, scene) for model in MODELS]
    chosen = tuple(at for at, reason in enumerate(reasons) if not reason)
    return chosen, {model.title: reason for model, reason in zip(MODELS, reasons, strict=True) if reason}


def _reason(model: Model, scene: Scene) -> str:
    if scene.missing:
        return f"not recorded: {', '.join(scene.missing)}"
    tried = model.name in scene.models
    # What a model estimates for itself is known where it is tried: elsewhere its lack is no reason.
    reason = model.applies(scene) if tried or model.estimates is None else ""
    if not reason and isinstance(model.capacity, str) and model.capacity not in scene.parameters:
        reason = f"not recorded: {model.capacity.replace('_', ' ')}"
    if not reason and not tried:
        return "; ".join(filter(None, (f"not required: {scene.rule.partition(': ')[2]}", model.unasked)))
    return reason


def _gather(model: Model, scenes: Sequence[Scene], chosen: Sequence[int], x_azimuth: float) -> Work:
    """Return the parameter sets of the scenes that a model is run for."""
    axes = model.axes if model.directions == 1 else ({},)
    angles = np.array([own_angle(model, scenes[index], x_azimuth) for index in chosen])
    turned = ~np.isnan(angles)
    two_sided = "half_width_other" in (q.name for q in model.needs)
    turn = np.array([360.0 if two_sided and "half_width_other" in scenes[at].parameters else 180.0 for at in chosen])
    if not turned.any():
        axes = ({},)
    names = [q.name for q in model.needs]
    defaults = {q.name: np.nan if q.default is None else q.default for q in model.needs}
    # After the model's own parameters come those that take their places along an object's own axes.
    own = [(at, name, other) for at, axis in enumerate(axes) for name, other in axis.items()]
    pairs = [(name, name) for name in names] + [(other, name) for _, name, other in own]
    columns = [_estimates(model, [scenes[index] for index in chosen], pair, defaults[pair[1]]) for pair in pairs]
    base, low, high = (np.column_stack([column[i] for column in columns]) for i in range(3))
    uncertain = low < high
    for _, name, _ in own:
        uncertain[turned, names.index(name)] = False
    uncertain[~turned, len(names) :] = False
    ratios, of = _proportions(scenes, chosen, pairs, names)
    uncertain &= np.isnan(ratios)
    one_ended = _bands(model, names, base, low, high, uncertain)
    sets, analysis = corners(base, low, high, uncertain, one_ended)
    tied = ~np.isnan(ratios[analysis])
    sets[tied] = (ratios[analysis] * np.take_along_axis(sets, of[analysis], axis=1))[tied]
    along = []
    for at in range(len(axes)):
        one = sets[:, : len(names)].copy()
        for place, (axis, name, _) in enumerate(own, start=len(names)):
            if axis == at:
                one[turned[analysis], names.index(name)] = sets[turned[analysis], place]
        # What has one half width is the same, turned by half a turn.
        angle = np.where(turned, (angles + 90.0 * at) % turn, np.nan)[analysis]
        along.append(np.column_stack([one, angle]))
    asked = _questions(model, scenes, chosen, analysis, along)[analysis]
    every = np.concatenate([np.column_stack([one, asked]) for one in along])
    first, where = unique_rows(every)
    unique = every[first]
    return Work(
        model,
        {name: np.ascontiguousarray(unique[:, i]) for i, name in enumerate(names)},
        np.ascontiguousarray(unique[:, len(names)]),
        np.array(chosen, dtype=np.intp),
        Spans(where.reshape(len(axes), -1).T, np.searchsorted(analysis, np.arange(len(chosen)))),
    )


def _questions(
    model: Model, scenes: Sequence[Scene], chosen: Sequence[int], analysis: Indices, along: Sequence[Array]
) -> Array:
    """Return a number for each analysis that it shares with those of the very same sets and capacity, (m,).

    Those are answered alike.  Others may ask for some of the same sets, but how closely a set is looked at is the
    matter of each alone: what is found of an object must not hang on which others happen to be looked at with it.
    """
    numbers: dict[Hashable, int] = {}
    table = np.concatenate(along, axis=1)
    ends = np.searchsorted(analysis, np.arange(len(chosen) + 1))
    out = np.empty(len(chosen))
    for at, index in enumerate(chosen):
        output, capacity = capacity_of(model, scenes[index])
        own = (output, capacity.low, capacity.value, capacity.high, table[ends[at] : ends[at + 1]].tobytes())
        out[at] = numbers.setdefault(own, len(numbers))
    return out


def own_angle(model: Model, scene: Scene, x_azimuth: float) -> float:
    """Return the direction of an object's width, or across it, degrees from x towards y; NaN: not known or needed."""
    orientation = scene.item.orientation_deg
    if orientation is None or model.directions != 1:
        return np.nan
    # Azimuths go clockwise from north, angles from x towards y, which is counter-clockwise.
    return x_azimuth - orientation + (90.0 if model.across else 0.0)


def _estimates(
    model: Model, scenes: Sequence[Scene], pair: tuple[str, str], default: float
) -> tuple[list[float], list[float], list[float]]:
    """Return value, low and high of a parameter of each scene, of the second of a pair where the first is not known.

    Where neither is, the default; of a range as much as the model counts on.
    """
    value, low, high = [], [], []
    for scene in scenes:
        estimate = scene.parameters.get(pair[0]) or scene.parameters.get(pair[1])
        if estimate is None:
            value.append(default)
            low.append(default)
            high.append(default)
        else:
            counted = model.counted(pair[1], estimate)
            value.append(counted.value)
            low.append(counted.low)
            high.append(counted.high)
    return value, low, high


def _proportions(
    scenes: Sequence[Scene], chosen: Sequence[int], columns: Sequence[tuple[str, str]], names: Sequence[str]
) -> tuple[Array, Indices]:
    """Return which parameters go up and down with another one: how many times that they are, and its column, (m, n).

    NaN for those that stand by themselves.
    """
    ratios = np.full((len(chosen), len(columns)), np.nan)
    of = np.zeros(ratios.shape, dtype=np.intp)
    for row, index in enumerate(chosen):
        known = scenes[index].parameters
        tied = {name for name, estimate in known.items() if estimate.per}
        for column, pair in enumerate(columns if tied else ()):
            name = next((name for name in pair if name in known), "")
            if name in tied and (of_name := known[name].per) in names and known[of_name].value:
                ratios[row, column] = known[name].value / known[of_name].value
                of[row, column] = names.index(of_name)
    return ratios, of


def _bands(
    model: Model, names: Sequence[str], base: Array, low: Array, high: Array, uncertain: NDArray[np.bool_]
) -> tuple[int, ...]:
    """Make one corner of both ends of what a model searches by itself; return the columns that have only that one.

    The best estimate of what is known as a range is a band without width, for which the search is made already.
    """
    columns = [(names.index(lower), names.index(upper)) for lower, upper in model.searched.items()]
    for lower, upper in columns:
        known = uncertain[:, lower]
        base[known, upper] = base[known, lower]
        high[known, upper] = high[known, lower]
        high[known, lower] = low[known, lower]
        uncertain[known, upper] = True
    return tuple(column for pair in columns for column in pair)


def corners(
    base: Array, low: Array, high: Array, uncertain: NDArray[np.bool_], one_ended: Sequence[int] = ()
) -> tuple[Array, Indices]:
    """Return the best estimates (m, n), each followed by every combination of the ends of its uncertain inputs.

    Of k uncertain inputs there are 2^k corners; objects have at most six in any model.  All of them, because an input
    that is harmless on its own may not be so where another is at its worst: with one input at a time at an end, 151 of
    819 decided verdicts changed where two were.  A demand that rises or falls with each input, whatever the others are,
    is largest and least at a corner, so that of uplift, tension and compression the whole range is covered.  Of others,
    such as how far a pendulum swings, only the ends are, and not what lies between them.  What a model searches by
    itself (see Model.searched) has one corner, the band.
    one_ended : columns of which only high is an end
    returns : (v, n) parameter sets, and of which analysis (v,) each is
    """
    sets, analyses = [base], [np.arange(base.shape[0])]
    patterns, pattern = np.unique(uncertain, axis=0, return_inverse=True)
    for at, varied in enumerate(patterns):
        which = np.flatnonzero(varied)
        if which.size == 0:
            continue
        members = np.flatnonzero(pattern.reshape(-1) == at)
        ends = np.array(list(product(*((True,) if at in one_ended else (False, True) for at in which))))
        own = np.repeat(members, ends.shape[0])
        one = base[own].copy()
        one[:, which] = np.where(np.tile(ends, (members.size, 1)), high[own][:, which], low[own][:, which])
        sets.append(one)
        analyses.append(own)
    analysis = np.concatenate(analyses)
    order = np.argsort(analysis, kind="stable")
    return np.concatenate(sets)[order], analysis[order]


def unique_rows(matrix: Array) -> tuple[Indices, Indices]:
    """Return where each different row is first, (k,), and which of them each row is, (n,).

    By their bytes, which takes half to a seventh of the time that `numpy.unique` takes to sort them.
    """
    # Bit for bit, so that NaN (not given) equals NaN.
    text, width = np.ascontiguousarray(matrix).tobytes(), matrix.itemsize * matrix.shape[1]
    seen: dict[bytes, int] = {}
    of_each = np.array(
        [seen.setdefault(text[at : at + width], len(seen)) for at in range(0, len(text), width)], np.intp
    )
    # A row is the first of its kind where its number is larger than all before it.
    first = np.flatnonzero(of_each > np.concatenate([[-1], np.maximum.accumulate(of_each)[:-1]]))
    return first, of_each
