"""The choice of errands that avoids the most expected loss within limits: hours, cost, and hours of a trade.

Bundles: what is done together, in the order of what avoids most for the effort.

Nothing is done before what it needs, so that errands are the nodes of a forest.  Of every tree the set that holds its
root and has the largest ratio of gain to effort is a bundle, then of what is left, and so on: a node takes the best
bundle of its children in as long as that has a larger ratio than itself (Horn 1972, "Single-machine job sequencing with
treelike precedence ordering", SIAM J. Appl. Math. 23).  Bundles in falling order of their ratios are the corners of the
concave hull of all that can be gained for an effort: no choice whatever lies above it.
"""

import os
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cached_property
from math import fsum, inf
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from pipeline.errors import InputError
from pipeline.planning.efforts import TRADES, EffortRow
from pipeline.planning.errands import Errand
from pipeline.quantities import Array

if TYPE_CHECKING:
    from scipy.sparse import csr_array


# Read where a plan is made: they take half a second, and most of what reads this module makes none.


@dataclass(slots=True)
class Bundle:
    """Nodes that are done together, the one that the others need first; their gain and effort."""

    nodes: list[int]
    gain: float
    effort: float

    @property
    def ratio(self) -> float:
        """Gain for the effort; endless for what costs none, and the least of all for what gains nothing."""
        if self.gain <= 0.0:
            return -1.0
        return self.gain / self.effort if self.effort > 0.0 else inf


def bundles(parents: Sequence[int], gains: Sequence[float], efforts: Sequence[float]) -> list[Bundle]:
    """Return the bundles of a forest, the one with the largest ratio first.

    Parameters
    ----------
    parents : sequence of int
        Of each node the one that it needs, which stands before it; -1 for none.
    gains, efforts : sequence of float
        Of each node, not negative.

    Returns
    -------
    list of Bundle
        Those that gain nothing are the last.  Of equal ratios what stands first comes first; what needs another never
        comes before it.
    """
    below: list[list[Bundle]] = [[] for _ in parents]
    done: list[Bundle] = []
    for node in range(len(parents) - 1, -1, -1):
        waiting = sorted(below[node], key=_order)
        mine = Bundle([node], gains[node], efforts[node])
        taken = 0
        while taken < len(waiting) and waiting[taken].ratio >= mine.ratio:
            best = waiting[taken]
            mine.nodes += best.nodes
            mine.gain += best.gain
            mine.effort += best.effort
            taken += 1
        below[node] = []
        (done if parents[node] < 0 else below[parents[node]]).extend([mine, *waiting[taken:]])
    return sorted(done, key=_order)


def _order(bundle: Bundle) -> tuple[float, int]:
    return -bundle.ratio, bundle.nodes[0]


EXACT = 3_000
"""Errands and visits up to which the choice is searched through; of more the relaxed problem guides it."""

NODES = 2_000
"""Nodes of the search, at most: a number and not a time, so that the same plan comes of the same objects anywhere."""

CUTS = 200
"""Cutting planes of the relaxed problem, at most."""

SECONDS = 60.0
"""A guard beyond any search of that many nodes that was seen."""

Taken = NDArray[np.bool_]
"""Of every node whether it is taken."""

_HAIR = 1e-9
"""Of a limit or a gain, what is rounding."""


@dataclass(frozen=True)
class EffortLimits:
    """What there is; None where nothing limits it.

    Attributes
    ----------
    hours : float or None
        Of all trades together [h].
    cost : float or None
        In the museum's currency.
    trades : mapping of str to float
        Hours of single trades [h].
    away : bool
        Whether errands that take objects from view may be chosen.

    Raises
    ------
    InputError
        For a trade that there is not, and for what is negative or not finite.
    """

    hours: float | None = None
    cost: float | None = None
    trades: Mapping[str, float] = field(default_factory=dict)
    away: bool = False

    def __post_init__(self) -> None:
        for name in self.trades:
            if name not in TRADES:
                raise InputError(f"there is no trade {name!r}; use one of {', '.join(TRADES)}")
        named = {"hours": self.hours, "cost": self.cost, **{f"hours of {k}": v for k, v in self.trades.items()}}
        for what, value in named.items():
            if value is not None and not (np.isfinite(value) and value >= 0.0):
                raise InputError(f"the {what} there are must be a number from 0 on, not {value:g}")

    @property
    def open(self) -> bool:
        """Whether nothing is limited."""
        return self.hours is None and self.cost is None and not self.trades


@dataclass(frozen=True)
class ErrandChoice:
    """Errands that were chosen.

    Attributes
    ----------
    chosen : frozenset of int
        Their places in the list.
    galleries : frozenset of str
        Those that are visited.
    avoided : float
        What they avoid together, in objects of class C.
    bound : float
        What no choice within the limits can avoid more of.
    """

    chosen: frozenset[int]
    galleries: frozenset[str]
    avoided: float
    bound: float

    @property
    def gap(self) -> float:
        """Share of the bound that is missing at most; 0 where it is proven that nothing better can be chosen."""
        missing = self.bound - self.avoided
        return missing / self.bound if missing > 1e-6 * self.bound > 0.0 else 0.0


class ErrandWork:
    """Visits and errands as the nodes of a forest: an errand needs its visit, and what has to be done first.

    Parameters
    ----------
    errands : sequence of Errand
        In walking order.
    visit : EffortRow
        What setting out in a gallery takes.
    away : bool
        Whether those that take objects from view are among them.
    """

    def __init__(self, errands: Sequence[Errand], visit: EffortRow, *, away: bool = False) -> None:
        self.errands = errands
        mine = [at for at, one in enumerate(errands) if away or not one.away]
        self.galleries = list(dict.fromkeys(errands[at].gallery for at in mine))
        rooms = {name: at for at, name in enumerate(self.galleries)}
        self.places = mine
        place_of = {at: len(rooms) + node for node, at in enumerate(mine)}
        some = [errands[at] for at in mine]
        once, free = visit.hours_of(1), visit.cost_of(1)
        number = len(rooms)
        needed = (one.needs for one in some)
        self.parents = [-1] * number + [
            rooms[one.gallery] if needs is None else place_of[needs] for one, needs in zip(some, needed, strict=True)
        ]
        self.gains = np.array([0.0] * number + [one.avoided for one in some])
        self.hours = np.array([once.value] * number + [one.hours.value for one in some])
        self.costs = np.array([free.value] * number + [one.cost.value for one in some])
        trades = [visit.trade] * number + [one.trade for one in some]
        self.trades = {name: np.array([one == name for one in trades]) for name in TRADES}

    @cached_property
    def bundles(self) -> list[Bundle]:
        """What is done together, in the order of what avoids most for an hour."""
        return self.bundled(self.hours)

    def bundled(self, effort: Array) -> list[Bundle]:
        """Return what is done together, in the order of what avoids most for an effort (nodes,)."""
        return bundles(self.parents, self.gains.tolist(), effort.tolist())

    @cached_property
    def levels(self) -> list[NDArray[np.intp]]:
        """The nodes that need nothing, those that need one of these, and so on."""
        depth = np.zeros(len(self.parents), dtype=np.intp)
        for node, parent in enumerate(self.parents):
            depth[node] = 0 if parent < 0 else depth[parent] + 1
        return [np.flatnonzero(depth == one) for one in range(int(depth.max(initial=-1)) + 1)]

    def limited(self, limits: EffortLimits) -> tuple[Array, Array]:
        """Return what every node takes of what is limited (limits, nodes), and how much of it there is (limits,)."""
        rows, most = [], []
        for taken, limit in ((self.hours, limits.hours), (self.costs, limits.cost)):
            if limit is not None:
                rows.append(taken)
                most.append(limit)
        for name, limit in sorted(limits.trades.items()):
            rows.append(np.where(self.trades[name], self.hours, 0.0))
            most.append(limit)
        return np.array(rows).reshape(len(rows), len(self.parents)), np.array(most)

    def choice(self, taken: Taken, bound: float) -> ErrandChoice:
        """Return the nodes that are taken as errands."""
        number = len(self.galleries)
        nodes = np.flatnonzero(taken).tolist()
        errands = frozenset(self.places[node - number] for node in nodes if node >= number)
        visited = frozenset(self.errands[at].gallery for at in errands)
        avoided = fsum(self.gains[node] for node in nodes)
        return ErrandChoice(errands, visited, avoided, max(bound, avoided))


def choose(work: ErrandWork, limits: EffortLimits) -> ErrandChoice:
    """Return the errands that avoid the most within the limits.

    A 0/1 problem of which every errand needs its visit, and may need another: up to `EXACT` of them it is solved by
    `scipy.optimize.milp`, and of equal gains what takes the fewest hours, then what comes first on the way, is chosen.
    Of more the limits are relaxed to prices, by which errands are taken as long as there is room; the bound that the
    prices give tells how much is missing at most.

    Parameters
    ----------
    work : ErrandWork
        What there is to do.
    limits : EffortLimits
        What there is to do it with.

    Returns
    -------
    ErrandChoice
    """
    taking, most = work.limited(limits)
    useful = _useful(work, taking, most)
    if not useful.any() or bool(np.all(taking @ useful <= most * (1.0 + _HAIR))):
        return work.choice(useful, 0.0)
    greedy = _filled(work, useful, taking, most, work.bundles)
    if useful.size > EXACT:
        weights, bound = _relaxed(work, useful, taking, most)
        weighed = _filled(work, useful, taking, most, work.bundled(weights @ taking))
        return work.choice(max(weighed, greedy, key=lambda taken: float(work.gains[taken].sum())), bound)
    reached = float(work.gains[greedy].sum()) or float(work.gains.max())
    found, bound = _searched(work, useful, taking, most, reached)
    better = found is not None and work.gains[found].sum() >= work.gains[greedy].sum()
    return work.choice(found if found is not None and better else greedy, bound)


def _useful(work: ErrandWork, taking: Array, most: Array) -> Taken:
    """Return the nodes that avoid something and are within the limits together with all they need, and these."""
    whole = taking.copy()
    for node, parent in enumerate(work.parents):
        if parent >= 0:
            whole[:, node] += whole[:, parent]
    useful: Taken = (work.gains > 0.0) & np.all(whole <= most[:, None] * (1.0 + _HAIR), axis=0)
    for node in range(useful.size - 1, -1, -1):
        if useful[node] and work.parents[node] >= 0:
            useful[work.parents[node]] = True
    return useful


def _filled(work: ErrandWork, useful: Taken, taking: Array, most: Array, order: Sequence[Bundle]) -> Taken:
    """Return the choice that takes whatever still fits, bundle by bundle in some order and then one by one."""
    taken = np.zeros(useful.size, dtype=bool)
    room = most * (1.0 + _HAIR)
    whole = [[node for node in one.nodes if useful[node]] for one in order if one.gain > 0.0]
    single = [[node] for nodes in whole for node in nodes if work.gains[node] > 0.0]
    for nodes in (*whole, *single):
        wanted = [node for node in nodes if not taken[node]]
        if not wanted or any(_lacks(work, node, taken, wanted) for node in wanted):
            continue
        takes = taking[:, wanted].sum(axis=1)
        if np.all(takes <= room):
            taken[wanted] = True
            room -= takes
    return taken


def _lacks(work: ErrandWork, node: int, taken: Taken, wanted: Sequence[int]) -> bool:
    parent = work.parents[node]
    return parent >= 0 and not taken[parent] and parent not in wanted


def _relaxed(work: ErrandWork, useful: Taken, taking: Array, most: Array) -> tuple[Array, float]:
    r"""Return the prices of what is limited at which the least could be gained, and what no choice gains more than.

    With a price :math:`\lambda_k` on each limited thing, of which an errand takes :math:`r_k` and there is
    :math:`b_k`, no choice within the limits gains more than

    .. math::

        g(\lambda) = \sum_k \lambda_k b_k + \max_y \sum_i \Bigl(a_i - \sum_k \lambda_k r_{ki}\Bigr) y_i

    (Lagrange), where only what is needed first binds the y: the largest sum of every tree is found from its leaves.
    The least g is found by cutting planes (Kelley 1960, "The cutting-plane method for solving convex programs", J. SIAM
    8); any g bounds the choice.
    """
    # In shares of what there is; what there is nothing of no useful node takes.
    shares = taking / np.where(most > 0.0, most, 1.0)[:, None]
    total, number = float(work.gains[useful].sum()), most.size
    from scipy.optimize import linprog

    best, weights = np.inf, np.zeros(number)
    rows, above = [], []
    at = np.zeros(number)
    for _ in range(CUTS):
        reduced = np.where(useful, work.gains - at @ shares, -np.inf)
        taken, gained = _largest(work, reduced)
        bound = float(at.sum() + gained)
        if bound < best:
            best, weights = bound, at
        slope = 1.0 - shares @ taken
        rows.append([*slope, -1.0])
        above.append(float(slope @ at) - bound)
        cut = linprog(
            [*np.zeros(number), 1.0],
            A_ub=np.array(rows),
            b_ub=np.array(above),
            bounds=[*[(0.0, total)] * number, (0.0, None)],
            method="highs-ds",
        )
        if cut.x is None or best - cut.x[-1] <= 1e-6 * best:
            break
        at = np.clip(cut.x[:-1], 0.0, total)
    return weights / np.where(most > 0.0, most, 1.0), best


def _largest(work: ErrandWork, values: Array) -> tuple[Taken, float]:
    """Return the choice with the largest sum of values (nodes,) where only what is needed first binds it, and that."""
    parents = np.array(work.parents)
    held = values.copy()
    for nodes in work.levels[:0:-1]:
        held += np.bincount(parents[nodes], weights=np.maximum(held[nodes], 0.0), minlength=held.size)
    taken = held > 0.0
    for nodes in work.levels[1:]:
        taken[nodes] &= taken[parents[nodes]]
    return taken, float(np.maximum(held[work.levels[0]], 0.0).sum())


def _needs(work: ErrandWork) -> "csr_array":
    """Return the rows that say that nothing is done before what it needs: each times the choice is at most 0."""
    from scipy.sparse import csr_array

    nodes = np.flatnonzero(np.array(work.parents) >= 0)
    rows = np.arange(nodes.size)
    ones = np.ones(nodes.size)
    at = np.r_[rows, rows], np.r_[nodes, np.array(work.parents)[nodes]]
    return csr_array((np.r_[ones, -ones], at), shape=(nodes.size, len(work.parents)))


def _searched(
    work: ErrandWork, useful: Taken, taking: Array, most: Array, reached: float
) -> tuple[Taken | None, float]:
    """Return the best choice that the search finds, None where it finds none, and what no choice gains more than.

    reached : what some choice gains, for the scale
    """
    from scipy.optimize import Bounds, LinearConstraint, milp
    from scipy.sparse import csr_array, vstack

    needs, scale = _needs(work), np.maximum(most, 1.0)[:, None]
    rows = [needs, csr_array(taking / scale)]
    above = np.r_[np.zeros(needs.shape[0]), most / scale[:, 0]]
    limited = LinearConstraint(vstack(rows).tocsr(), -np.inf, above)
    total = float(work.gains.sum())
    # HiGHS takes 1e-6 of whatever unit for nothing.
    gains = work.gains * (1e3 / reached)
    box = Bounds(0.0, useful.astype(float))
    whole = np.ones(gains.size, dtype=np.int64)
    options: Any = {"mip_rel_gap": 0.0, "node_limit": NODES, "time_limit": SECONDS}
    with _unheard():
        first = milp(-gains, constraints=limited, bounds=box, integrality=whole, options=options)
    bound = total if first.mip_dual_bound is None else min(total, -first.mip_dual_bound * reached / 1e3)
    if first.x is None:
        return None, bound
    best = first.x > 0.5
    # Of what gains as much, what takes the fewest hours and comes first on the way.
    ways = work.hours + 1e-4 * np.arange(1, best.size + 1) / best.size
    least = LinearConstraint(csr_array(gains[None, :]), float(gains[best].sum()) * (1.0 - _HAIR))
    with _unheard():
        second = milp(ways, constraints=[limited, least], bounds=box, integrality=whole, options=options)
    if second.x is not None and first.status == 0:
        again = second.x > 0.5
        if np.all(taking @ again <= most * (1.0 + _HAIR) + _HAIR):
            best = again
    return best, bound


@contextmanager
def _unheard() -> Iterator[None]:
    """Keep what HiGHS prints whatever it is told ("transformNewIntegerFeasibleSolution") out of the standard output."""
    sys.stdout.flush()
    try:
        kept = os.dup(1)
    except OSError:
        # There is none.
        yield
        return
    try:
        with Path(os.devnull).open("wb") as nothing:
            os.dup2(nothing.fileno(), 1)
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)
