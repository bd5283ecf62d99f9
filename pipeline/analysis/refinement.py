"""The search for the least fidelity that decides: from bounds over charts to histories, as verdicts need (`auto`).

Each analysis asks whether its highest demand, over its parameter sets, is within the capacity (it passes) and whether
its lowest is above it (it fails).  Every parameter set has an interval in which its history lies for certain, or
within the error that a chart states; both questions are answered as soon as the intervals answer them, and only the
sets of analyses that are still open, and of those only the ones that the answer hangs on, are taken a step further.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.cases import DemandCase, Effort, Known, together
from pipeline.analysis.context import Context
from pipeline.analysis.demands import Demands, Step, bounded, chart, integrate
from pipeline.analysis.furnished import furnished
from pipeline.analysis.plan import Indices, Work
from pipeline.analysis.verdicts import LevelMotions, Mask, capacity_of, exceeds
from pipeline.models.common import largest_push
from pipeline.quantities import Array
from pipeline.records import Numerics, Scene
from pipeline.records.numerics import AUTO, CHART

_Ends = tuple[Array, Array, Array, Array]

GLANCE = 0.05
"""Share by which a scan may be below a history: directions 10 degrees beside the worst lose 1.5 % of what is linear."""

_PASSING, _FAILING = "may_pass", "may_fail"

_BOTH = frozenset({_PASSING, _FAILING})


@dataclass
class FidelitySearch:
    """One work under the motions of one level, as each variant of its furniture passes them on.

    Attributes
    ----------
    found : list of Demands
        What is known under each motion of every variant, those by the best estimates first.
    cells : tuple[tuple[int, ...], ...]
        Of each variant, the place in ``found`` of each motion of the level.
    decided : NDArray[np.int8]
        Of each analysis of the work, the step at which its verdict stood.
    """

    work: Work
    level: LevelMotions
    context: Context
    numerics: Numerics
    found: list[Demands]
    cells: tuple[tuple[int, ...], ...]
    decided: NDArray[np.int8]
    effort: Effort

    @classmethod
    def begin(
        cls, work: Work, level: LevelMotions, outputs: Sequence[str], context: Context, numerics: Numerics
    ) -> "FidelitySearch":
        """Bound everything.

        Parameters
        ----------
        work
            Analyses (m,) of one model.
        level
            The motions.
        outputs
            Names of the model's outputs that count.
        context
            Where it runs, and what was computed before.
        numerics
            How finely.

        Returns
        -------
        FidelitySearch
            At its first step; no verdict is looked for yet.
        """
        auto = numerics.fidelity == AUTO
        # The least over what a model searches is an output of its own.
        outputs = tuple(dict.fromkeys([*outputs, *map(work.model.least_of, outputs)]))
        # The best estimates keep their places, motion by motion; of the others each different one is looked at once.
        every, places = list(level.motions), {motion.hash: at for at, motion in enumerate(level.motions)}
        cells = [tuple(range(len(every)))]
        for some in level.others:
            for motion in some:
                if places.setdefault(motion.hash, len(every)) == len(every):
                    every.append(motion)
            cells.append(tuple(places[motion.hash] for motion in some))
        # Of few sets under many motions each motion is worth a core: a searched spectrum is of one motion.
        # The bound of a searched band is all that there is to know of it, at any fidelity.
        whole = auto or bool(work.searched.any())
        each = partial(bounded, work, outputs=outputs, executor=context.executor, whole=whole)
        found = context.executor.map(each, every)
        effort = Effort(analyses=work.scenes.size, sets=work.size * len(found))
        decided = np.zeros(work.scenes.size, dtype=np.int8)
        return cls(work, level, context, numerics, found, tuple(cells), decided, effort)

    @property
    def best(self) -> list[Demands]:
        """What is known under each motion of the level, as the best estimates of the furniture pass it on."""
        return self.found[: len(self.level.motions)]

    def each(self, columns: Sequence[Array]) -> list[Array]:
        """Return the demands (m,) of the level under each variant, from those of each of ``found``."""
        return [self.level.over([columns[at] for at in cells]) for cells in self.cells]

    def decide(self, case: DemandCase) -> Known:
        """Go on until the verdict of every analysis of the case stands.

        Parameters
        ----------
        case
            The analyses (m,).

        Returns
        -------
        Known
            Their verdicts.
        """
        if self.numerics.fidelity == CHART:
            self._up(Step.CHART, [self._unknown(case, found) for found in self.found])
        if self.numerics.fidelity != AUTO:
            rows = [self._unknown(case, found) for found in self.found]
            self.effort.verdicts += self._up(Step.HISTORY, [r[f.step[r] == Step.BOUND] for r, f in self._with(rows)])
            # Without `auto` nothing is decided before the last step.
            steps = [case.spans.furthest(found.step) for found in self.found]
            self.decided[case.analyses] = np.max(steps, axis=0)
        else:
            self._look_up(case)
        self._integrate(case)
        return self._known(case)

    def tell(self, case: DemandCase, known: Known) -> None:
        """Find the numbers of what does not pass: the highest demand, that of the best estimates, what the object does.

        Nobody needs more of what passes than that it stays below its capacity.

        Parameters
        ----------
        case, known
            The analyses (m,), and their verdicts as `decide` returned them.
        """
        chosen = np.flatnonzero(~known.passes)
        if chosen.size == 0:
            return
        part = case.take(chosen)
        if self.numerics.fidelity == AUTO:
            banded = self._banded(part)
            if banded.any():
                self._tell_bests(part.take(np.flatnonzero(banded)))
            if not banded.all():
                self._tell_range(part.take(np.flatnonzero(~banded)))
        model = self.work.model
        if model.exact and model.rests is not None and case.output == model.demand:
            governing, rows = self.governing(part)
            moving = [
                np.unique(rows[governing == at][found.high[part.output][rows[governing == at]] > model.rests])
                for at, found in enumerate(self.found)
            ]
            self.effort.numbers += self._up(Step.HISTORY, moving)

    def governing(self, case: DemandCase) -> tuple[Indices, Indices]:
        """Return under which motion the best estimates of each analysis, and of its furniture, demand most.

        Parameters
        ----------
        case
            The analyses (m,).

        Returns
        -------
        motion : ndarray of int
            (m,) places in the level's motions.
        row : ndarray of int
            (m,) rows of the work's values.
        """
        bests = case.spans.rows[case.spans.starts]
        most = np.full(bests.shape[0], -np.inf)
        motion, row = np.zeros(bests.shape[0], dtype=np.intp), bests[:, 0].copy()
        for at, found in enumerate(self.best):
            high = found.points(case.output)[1]
            for side in bests.T:
                larger = high[side] > most
                most[larger], motion[larger], row[larger] = high[side][larger], at, side[larger]
        return motion, row

    def count(self, case: DemandCase) -> None:
        """Add to the effort by what the analyses of a case were decided, and how many needed any history.

        Parameters
        ----------
        case
            The analyses (m,), decided.
        """
        for step in Step:
            self.effort.decided[step] += int(np.count_nonzero(self.decided[case.analyses] == step))
        self.effort.needing += int(np.count_nonzero(self.needed(case)))

    def needed(self, case: DemandCase) -> Mask:
        """Return for which analyses of a case any history was run.

        Parameters
        ----------
        case
            The analyses (m,), decided.

        Returns
        -------
        ndarray of bool
            (m,).
        """
        steps = [case.spans.furthest(found.step) for found in self.found]
        return np.asarray(np.max(steps, axis=0) == Step.HISTORY)

    def _with(self, rows: Sequence[Indices]) -> list[tuple[Indices, Demands]]:
        return list(zip(rows, self.found, strict=True))

    def _known(self, case: DemandCase) -> Known:
        return together(self._known_each(case, [self._ends(case, found) for found in self.found]))

    @staticmethod
    def _ends(case: DemandCase, found: Demands) -> _Ends:
        """Return, (m,) each, between what the highest demand of each analysis lies, and between what the lowest."""
        spans, output = case.spans, case.output
        least = found.work.model.least_of(output)
        low, high = found.low, found.high
        return (
            spans.highest(low[output]),
            spans.highest(high[output]),
            spans.lowest(low[least]),
            spans.lowest(high[least]),
        )

    def _known_each(self, case: DemandCase, ends: Sequence[_Ends]) -> list[Known]:
        """Return what is known under each variant, of the ends of the demands under each motion."""
        low, _, high = case.capacity
        return [
            Known(
                passes=~exceeds(most_high, low),
                may_pass=~exceeds(least_high, low),
                fails=exceeds(least_low, high),
                may_fail=exceeds(most_low, high),
            )
            for least_high, most_high, least_low, most_low in zip(*map(self.each, zip(*ends, strict=True)), strict=True)
        ]

    def _look_up(self, case: DemandCase) -> None:
        """Look up in charts what the open verdicts hang on."""
        each = self._known_each(case, [self._ends(case, found) for found in self.found])
        still = np.flatnonzero(together(each).open)
        if still.size:
            part, some = case.take(still), [one.take(still) for one in each]
            self._up(Step.CHART, [self._hanging(part, some, at) for at in range(len(self.found))])
            self.decided[part.analyses] = Step.CHART

    def _integrate(self, case: DemandCase) -> None:
        """Integrate what the open verdicts hang on, in an order in which the last motions may not be needed."""
        ends = [self._ends(case, found) for found in self.found]
        each = self._known_each(case, ends)
        for at, asked in self._order():
            still = np.flatnonzero(together(each).open)
            if still.size == 0:
                return
            if still.size < case.analyses.size:
                case, each = case.take(still), [one.take(still) for one in each]
                ends = [(a[still], b[still], c[still], d[still]) for a, b, c, d in ends]
            rows = self._hanging(case, each, at, asked)
            self.decided[case.analyses] = Step.HISTORY
            if rows.size:
                self.effort.verdicts += self._up(Step.HISTORY, self._only(at, rows))
                ends[at] = self._ends(case, self.found[at])
                each = self._known_each(case, ends)

    def _only(self, at: int, rows: Indices) -> list[Indices]:
        """Return some rows under one motion, and none under the others."""
        return [rows if at == other else rows[:0] for other in range(len(self.found))]

    def _order(self) -> list[tuple[int, frozenset[str]]]:
        """Return which motions are integrated one after the other, and which questions are asked of each.

        The strongest come first.  Where furniture has variants, whether all pass is asked first, for which one that is
        too strong is enough, and then whether all fail, for which one variant is enough whose motions are mild.
        """
        pushes = [largest_push(found.motion.excitation(None)) for found in self.found]
        strongest = np.argsort(np.negative(pushes), kind="stable").tolist()
        if len(self.cells) == 1:
            return [(at, _BOTH) for at in strongest]
        mild = sorted(self.cells, key=lambda cells: max(pushes[at] for at in cells))
        mildest = dict.fromkeys(at for cells in mild for at in strongest if at in cells)
        return [(at, frozenset({_PASSING})) for at in strongest] + [(at, frozenset({_FAILING})) for at in mildest]

    def _hanging(self, part: DemandCase, each: Sequence[Known], at: int, asked: frozenset[str] = _BOTH) -> Indices:
        """Return the rows of open analyses that their verdicts hang on under a motion."""
        rows, lengths = part.spans.rows, part.spans.lengths
        found, lowest = self.found[at], self.work.model.least_of(part.output)
        known = together(each)
        here = [one for one, cells in zip(each, self.cells, strict=True) if at in cells]
        # A variant that is known to pass, or to fail, has nothing more to say to that.
        passing = known.may_pass & ~np.logical_and.reduce([one.passes for one in here]) & (_PASSING in asked)
        failing = known.may_fail & ~np.logical_and.reduce([one.fails for one in here]) & (_FAILING in asked)
        if self.level.combine == "mean":
            open_ = found.low[part.output][rows] < found.high[part.output][rows]
            needed = open_ & np.repeat(passing | failing, lengths)[:, None]
        else:
            # Of a maximum only this counts: on which side of the capacity's ends each demand lies.
            needed = np.zeros(rows.shape, dtype=bool)
            ends = ((part.output, passing, part.capacity[0]), (lowest, failing, part.capacity[2]))
            for output, wanted, capacity in ends:
                low, high = found.low[output], found.high[output]
                limit = part.spans.spread(capacity)[:, None]
                straddles = (low[rows] <= limit) & (high[rows] > limit)
                needed |= straddles & np.repeat(wanted, lengths)[:, None]
        return np.unique(rows[needed])

    def _unknown(self, case: DemandCase, found: Demands) -> Indices:
        rows = np.unique(case.spans.rows)
        return rows[found.low[case.output][rows] < found.high[case.output][rows]]

    def _banded(self, part: DemandCase) -> Mask:
        """Return of which analyses something is searched for over a band."""
        return np.asarray(part.spans.highest(self.work.searched.astype(np.float64)) > 0.0)

    def _tell_bests(self, part: DemandCase) -> None:
        """Find the demand of the best estimates alone.

        The ends of the range are bounds: one over bands is wide, and the worst of all directions of a band is dear.
        """
        bests = np.unique(part.spans.rows[part.spans.starts])
        asked = [bests if at in self.cells[0] else bests[:0] for at in range(len(self.found))]
        self.effort.numbers += self._up(Step.HISTORY, asked)

    def _tell_range(self, part: DemandCase) -> None:
        """Find the range of the demand, first by charts, then by histories of what may still have a say in it.

        The best estimates come first; then of furniture's variants the bare floor, under which the demand is mostly
        the least, and the strongest: most of the others are known then to lie in between.  No verdict hangs on the ends
        that variants make: they are scanned.  What answers smoothly is scanned at first, whatever it is.
        """
        every = range(len(self.found))
        ends = [self._ends(part, found) for found in self.found]
        self._up(Step.CHART, [self._heard(part, ends, at) for at in every])
        for at in every:
            ends[at] = self._ends(part, self.found[at])
        bests = np.unique(part.spans.rows[part.spans.starts])
        smooth, alone = self.work.model.flips is None and self.level.combine != "mean", len(self.cells) == 1
        asked_of = [(at, True) for at in self.cells[0]]
        if not alone:
            strongest = (at for at, asked in self._order() if _PASSING in asked)
            asked_of += [(at, False) for at in dict.fromkeys((*self.cells[0], *self.cells[-1], *strongest))]
        scanned = [bests[:0] for _ in every]
        for at, best in asked_of:
            rows = self._heard(part, ends, at)
            if best and not alone:
                rows = np.intersect1d(rows, bests)
            if rows.size:
                exactly = best and not smooth
                numerics = self.numerics.integrated if exactly else self.numerics.scanning
                self.effort.numbers += self._up(Step.HISTORY, self._only(at, rows), numerics)
                ends[at] = self._ends(part, self.found[at])
            if best and smooth:
                scanned[at] = rows
        self._confirm(part.output, scanned)

    def _confirm(self, output: str, scanned: Sequence[Indices]) -> None:
        """Integrate what was only scanned under the motions that may govern it."""
        most = np.max([found.high[output] for found in self.best], axis=0)
        for rows, found in zip(scanned, self.found, strict=True):
            near = rows[found.high[output][rows] >= (1.0 - GLANCE) * most[rows]]
            if near.size:
                self.effort.numbers += integrate(found, near, self.context, self.numerics.integrated)

    def _heard(self, part: DemandCase, ends: Sequence[_Ends], at: int) -> Indices:
        """Return the rows that may have a say in the range under a motion, and are no better known than by a bound."""
        found, spans = self.found[at], part.spans
        low, high = found.low[part.output], found.high[part.output]
        least_high, most_high, least_low, most_low = map(self.each, zip(*ends, strict=True))
        top, bottom = np.max(least_high, axis=0), np.min(most_low, axis=0)
        heard = np.zeros(spans.rows.shape, dtype=bool)
        for variant, cells in enumerate(self.cells):
            if at not in cells:
                continue
            # Of a maximum, what lies below the lowest that it can be under any one motion is never heard of.
            lowest = np.max([ends[cell][2] for cell in cells], axis=0)
            # A variant is heard of where the demand under it may be the lowest of all, or the highest.
            least, most = (least_low[variant] < bottom) | (variant == 0), most_high[variant] > top
            limit = spans.spread(np.where(least, lowest, np.where(most, np.maximum(lowest, top), np.inf)))[:, None]
            heard |= np.isfinite(limit) if self.level.combine == "mean" else high[spans.rows] > limit
        rows = np.unique(spans.rows[heard])
        return np.asarray(rows[(found.step[rows] == Step.BOUND) & (low[rows] < high[rows])])

    def _up(self, step: Step, rows: Sequence[Indices], numerics: Numerics | None = None) -> int:
        """Take rows under each motion to a step, as finely as asked or as verdicts; return how many were integrated."""
        fresh = [(r[f.step[r] < step], f) for r, f in self._with(rows)]
        if step is Step.CHART:
            charts = self.context.charts
            if self.level.passed_on and self.numerics.fidelity == AUTO:
                # Charts of all that furniture may pass on would be dearer than the few histories that are asked for.
                site = {motion.hash for motion in self.level.told}
                fresh = [(rows, found) for rows, found in fresh if found.motion.hash in site]
            self.context.executor.map(lambda one: chart(one[1], one[0], charts, self.numerics), fresh)
            return 0
        finely = numerics or self.numerics.integrated
        return sum(integrate(found, some, self.context, finely) for some, found in fresh)


@dataclass(frozen=True)
class Examined:
    """A work under a level with its verdicts."""

    search: FidelitySearch
    cases: tuple[tuple[DemandCase, Known], ...]


def examine(
    work: Work,
    scenes: Sequence[Scene],
    level: LevelMotions,
    context: Context,
    numerics: Numerics,
    *,
    outcomes: bool = True,
    watch: Callable[[FidelitySearch], None] = lambda _: None,
) -> Examined:
    """Find the verdicts of all analyses of a work under the motions of a level, and the numbers that go with them.

    Parameters
    ----------
    work
        Analyses (m,) of one model.
    scenes
        Those that the work refers to.
    level
        The motions of the floor, or of what stands on it; the furniture that the work is in passes the former on.
    context
        Where it runs, and what was computed before.
    numerics
        How finely.
    outcomes
        Whether to find the numbers of what does not pass, too.
    watch
        Called when everything is bounded, before anything is looked up or integrated.

    Returns
    -------
    Examined
        The verdicts by output that counts, and the search that found them.
    """
    capacities = [capacity_of(work.model, scenes[index]) for index in work.scenes]
    outputs: dict[str, list[int]] = {}
    for at, (output, _) in enumerate(capacities):
        outputs.setdefault(output, []).append(at)
    shaken = furnished(level, work.furniture, context.executor)
    search = FidelitySearch.begin(work, shaken, tuple(outputs), context, numerics)
    watch(search)
    cases = []
    for output, members in outputs.items():
        case = DemandCase.of(work, output, np.array(members, dtype=np.intp), [capacities[at][1] for at in members])
        known = search.decide(case)
        if outcomes:
            search.tell(case, known)
        cases.append((case, known))
    for case, _ in cases:
        search.count(case)
    return Examined(search, tuple(cases))
