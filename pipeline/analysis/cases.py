"""Analyses of a work that one output counts for, what is known of their verdicts, and what these took."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from pipeline.analysis.plan import Indices, Spans, Work
from pipeline.analysis.verdicts import Mask
from pipeline.quantities import Array
from pipeline.records import Estimate


@dataclass(frozen=True)
class DemandCase:
    """The analyses of a work that one of the model's outputs counts for.

    Attributes
    ----------
    analyses : Indices
        (m,) places in the work's list.
    spans : Spans
        Their parameter sets.
    capacity : (Array, Array, Array)
        Low, best, high, (m,) each.
    estimates : sequence of Estimate
        (m) of them, with where they come from.
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

    def take(self, chosen: Indices) -> "Known":
        """Return that of some analyses."""
        return Known(self.passes[chosen], self.may_pass[chosen], self.fails[chosen], self.may_fail[chosen])


def together(each: Sequence[Known]) -> Known:
    """Return what is known under all variants together: it passes, or fails, where it does so under each of them."""
    if len(each) == 1:
        return each[0]
    both = np.logical_and.reduce
    return Known(
        passes=both([one.passes for one in each]),
        may_pass=both([one.may_pass for one in each]),
        fails=both([one.fails for one in each]),
        may_fail=both([one.may_fail for one in each]),
    )


@dataclass
class Effort:
    """What the verdicts of one model took.

    Attributes
    ----------
    analyses : int
        Objects times levels.
    decided : list of int
        Of which by a certificate (a bound), a chart, histories.
    sets : int
        Parameter sets times motions, each once however many objects share it.
    verdicts : int
        How many of these were integrated because a verdict hung on them.
    numbers : int
        And because an advice or a report needs the number, or what the object does, although the verdict stood.
    needing : int
        Analyses for which any history was run.
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
