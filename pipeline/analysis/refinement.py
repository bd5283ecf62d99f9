"""The search for the least fidelity that decides: from bounds over charts to histories, as verdicts need (`auto`).

Each analysis asks whether its highest demand, over its parameter sets, is within the capacity (it passes) and whether
its lowest is above it (it fails).  Every parameter set has an interval in which its history lies for certain, or
within the error that a chart states; both questions are answered as soon as the intervals answer them, and only the
sets of analyses that are still open, and of those only the ones that the answer hangs on, are taken a step further.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.context import Context
from pipeline.analysis.demands import Demands, Step, bounded, chart, integrate
from pipeline.analysis.plan import Indices, Spans, Work
from pipeline.analysis.verdicts import LevelMotions, Mask, capacity_of, exceeds
from pipeline.models.common import largest_push
from pipeline.quantities import Array
from pipeline.records import Estimate, Numerics, Scene
from pipeline.records.numerics import AUTO, CHART


@dataclass(frozen=True)
class DemandCase:
    """The analyses of a work that one of the model's outputs counts for.

    analyses : (m,) places in the work's list
    spans    : their parameter sets
    capacity : low, best, high, (m,) each
    estimates: (m) of them, with where they come from
    """

    output: str
    analyses: Indices
    spans: Spans
    capacity: tuple[Array, Array, Array]
    estimates: Sequence[Estimate]

    @classmethod
    def of(cls, work: Work, output: str, analyses: Indices, capacities: Sequence[Estimate]) -> "DemandCase":
        """Return the case of some analyses with their capacities.

        Parameters
        ----------
        work
            That the analyses belong to.
        output
            Of the work's model, that counts for them.
        analyses
            (m,) places in the work's list.
        capacities
            Of each of them, in the unit of the output.

        Returns
        -------
        Case
            With their parameter sets.
        """
        spans = work.spans if analyses.size == work.scenes.size else work.spans.take(analyses)
        ends = tuple(np.array([getattr(c, end) for c in capacities]) for end in ("low", "value", "high"))
        return cls(output, analyses, spans, (ends[0], ends[1], ends[2]), capacities)

    def take(self, chosen: Indices) -> "DemandCase":
        """Return a part of the analyses.

        Parameters
        ----------
        chosen
            (p,) places in the case.

        Returns
        -------
        Case
            Of these, in their order.
        """
        low, best, high = self.capacity
        capacity = (low[chosen], best[chosen], high[chosen])
        estimates = [self.estimates[at] for at in chosen]
        return DemandCase(self.output, self.analyses[chosen], self.spans.take(chosen), capacity, estimates)


@dataclass(frozen=True)
class Known:
    """What the intervals answer of each analysis, (m,) each."""

    passes: Mask
    may_pass: Mask
    fails: Mask
    may_fail: Mask

    @property
    def open(self) -> Mask:
        """Whose verdict could still be another; undetermined is a verdict too."""
        return np.asarray(~self.passes & ~self.fails & (self.may_pass | self.may_fail))


@dataclass
class Effort:
    """What the verdicts of one model took.

    analyses : objects times levels
    decided  : of which by a certificate (a bound), a chart, histories
    sets     : parameter sets times motions, each once however many objects share it
    verdicts : how many of these were integrated because a verdict hung on them
    numbers  : and because an advice or a report needs the number, or what the object does, although the verdict stood
    needing  : analyses for which any history was run
    """

    analyses: int = 0
    decided: list[int] = field(default_factory=lambda: [0, 0, 0])
    sets: int = 0
    verdicts: int = 0
    numbers: int = 0
    needing: int = 0

    def plain(self) -> dict[str, int]:
        """Return the counts by name."""
        names = ("certificate", "chart", "history")
        return {
            "analyses": self.analyses,
            **dict(zip(names, self.decided, strict=True)),
            "needing_history": self.needing,
            "sets": self.sets,
            "histories_for_verdicts": self.verdicts,
            "histories_for_numbers": self.numbers,
        }

    def add(self, other: "Effort") -> None:
        """Add what another level or floor took."""
        self.analyses += other.analyses
        self.decided = [a + b for a, b in zip(self.decided, other.decided, strict=True)]
        self.sets += other.sets
        self.verdicts += other.verdicts
        self.numbers += other.numbers
        self.needing += other.needing


@dataclass
class FidelitySearch:
    """One work under the motions of one level.

    found   : what is known under each motion
    decided : of each analysis of the work, the step at which its verdict stood
    """

    work: Work
    level: LevelMotions
    context: Context
    numerics: Numerics
    found: list[Demands]
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
        found = [bounded(work, motion, outputs, context.executor, whole=auto) for motion in level.motions]
        effort = Effort(analyses=work.scenes.size, sets=work.size * len(found))
        decided = np.zeros(work.scenes.size, dtype=np.int8)
        return cls(work, level, context, numerics, found, decided, effort)

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
            self._up(Step.CHART, self._numbers(part))
            self.effort.numbers += self._up(Step.HISTORY, self._numbers(part))
        model = self.work.model
        if model.exact and model.rests is not None and case.output == model.demand:
            governing, rows = self.governing(part)
            moving = [
                np.unique(rows[governing == at][found.high[part.output][rows[governing == at]] > model.rests])
                for at, found in enumerate(self.found)
            ]
            self.effort.numbers += self._up(Step.HISTORY, moving)

    def governing(self, case: DemandCase) -> tuple[Indices, Indices]:
        """Return under which motion the best estimates of each analysis demand most.

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
        for at, found in enumerate(self.found):
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
        low, _, high = case.capacity
        output, lowest = case.output, self.work.model.least_of(case.output)
        spans, over, found = case.spans, self.level.over, self.found
        return Known(
            passes=~exceeds(over([spans.highest(one.high[output]) for one in found]), low),
            may_pass=~exceeds(over([spans.highest(one.low[output]) for one in found]), low),
            fails=exceeds(over([spans.lowest(one.low[lowest]) for one in found]), high),
            may_fail=exceeds(over([spans.lowest(one.high[lowest]) for one in found]), high),
        )

    def _look_up(self, case: DemandCase) -> None:
        """Look up in charts what the open verdicts hang on."""
        known = self._known(case)
        still = np.flatnonzero(known.open)
        if still.size:
            part = case.take(still)
            self._up(Step.CHART, [self._hanging(part, known, still, found) for found in self.found])
            self.decided[part.analyses] = Step.CHART

    def _integrate(self, case: DemandCase) -> None:
        """Integrate what the open verdicts hang on, the strongest motions first: the others may not be needed."""
        pushes = [largest_push(motion.excitation(None)) for motion in self.level.motions]
        for at in np.argsort(np.negative(pushes), kind="stable"):
            known = self._known(case)
            still = np.flatnonzero(known.open)
            if still.size == 0:
                return
            case = case.take(still)
            rows = self._hanging(case, known, still, self.found[at])
            self.effort.verdicts += self._up(Step.HISTORY, [rows if at == i else rows[:0] for i in range(len(pushes))])
            self.decided[case.analyses] = Step.HISTORY

    def _hanging(self, part: DemandCase, known: Known, chosen: Indices, found: Demands) -> Indices:
        """Return the rows of open analyses that their verdicts hang on under a motion."""
        rows, spread = part.spans.rows, part.spans.spread
        lowest = self.work.model.least_of(part.output)
        if self.level.combine == "mean":
            needed = found.low[part.output][rows] < found.high[part.output][rows]
        else:
            # Of a maximum only this counts: on which side of the capacity's ends each demand lies.
            needed = np.zeros(rows.shape, dtype=bool)
            ends = ((part.output, known.may_pass, part.capacity[0]), (lowest, known.may_fail, part.capacity[2]))
            for output, asked, capacity in ends:
                low, high = found.low[output], found.high[output]
                limit = spread(capacity)[:, None]
                straddles = (low[rows] <= limit) & (high[rows] > limit)
                needed |= straddles & np.repeat(asked[chosen], part.spans.lengths)[:, None]
        return np.unique(rows[needed])

    def _unknown(self, case: DemandCase, found: Demands) -> Indices:
        rows = np.unique(case.spans.rows)
        return rows[found.low[case.output][rows] < found.high[case.output][rows]]

    def _numbers(self, part: DemandCase) -> list[Indices]:
        """Return the rows that may have a say in the range of the demand, and are no better known than by a bound."""
        output, spans = part.output, part.spans
        least, mean = self.work.model.least_of(output), self.level.combine == "mean"
        # Of a maximum, what lies below the lowest that it can be under any one motion is never heard of.
        lowest = np.max([spans.lowest(found.low[least]) for found in self.found], axis=0)
        out = []
        for found in self.found:
            low, high = found.low[output], found.high[output]
            heard = mean | (high[spans.rows] > spans.spread(lowest)[:, None])
            rows = np.unique(spans.rows[heard])
            out.append(rows[(found.step[rows] == Step.BOUND) & (low[rows] < high[rows])])
        return out

    def _up(self, step: Step, rows: Sequence[Indices]) -> int:
        """Take rows under each motion to a step; return how many were integrated."""
        fresh = [(r[f.step[r] < step], f) for r, f in self._with(rows)]
        if step is Step.CHART:
            charts = self.context.charts
            self.context.executor.map(lambda one: chart(one[1], one[0], charts, self.numerics), fresh)
            return 0
        return sum(integrate(found, some, self.context, self.numerics) for some, found in fresh)


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
        The motions.
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
    search = FidelitySearch.begin(work, level, tuple(outputs), context, numerics)
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
