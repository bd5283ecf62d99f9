"""A plan: the errands of a museum, which of them to do, and what that takes and avoids."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from math import fsum

from pipeline.planning.choice import EffortLimits, ErrandChoice, ErrandWork, choose
from pipeline.planning.efforts import TRADES, Efforts, EffortSpan
from pipeline.planning.errands import Advised, Errand, errands_of


@dataclass(frozen=True)
class PlanTerms:
    """What a plan rests on besides what was found: what measures take, and what there is.

    Parameters
    ----------
    efforts : Efforts
        What measures take.
    limits : EffortLimits
        What there is.
    currency : str
        In which costs are told; "" where the museum names none.
    """

    efforts: Efforts
    limits: EffortLimits = field(default_factory=EffortLimits)
    currency: str = ""


@dataclass(frozen=True)
class EffortCorner:
    """A corner of the curve of what is left against effort: hours, cost, and what is avoided up to there."""

    hours: float
    cost: float
    avoided: float


@dataclass(frozen=True)
class ErrandPlan:
    """The errands of a museum, and which of them to do.

    Attributes
    ----------
    errands : tuple of Errand
        All, in walking order.
    choice : ErrandChoice
        What to do.
    ranks : mapping of int to int
        Of each errand that may be chosen, its place from 1 in the order of what avoids most for an hour.
    curve : tuple of EffortCorner
        What that order avoids, from nothing on: no choice avoids more for its hours.
    loss : float
        What is expected to be lost as everything stands, in objects of class C; of all objects on display of which it
        is known how likely harm is, advised or not.
    terms : PlanTerms
        What it rests on.
    """

    errands: tuple[Errand, ...]
    choice: ErrandChoice
    ranks: Mapping[int, int]
    curve: tuple[EffortCorner, ...]
    loss: float
    terms: PlanTerms

    @cached_property
    def chosen(self) -> tuple[Errand, ...]:
        """What to do, in walking order."""
        return tuple(self.errands[at] for at in sorted(self.choice.chosen))

    @cached_property
    def best_first(self) -> tuple[int, ...]:
        """Places of what to do, what avoids most for an hour first; nothing stands before what it needs."""
        return tuple(sorted(self.choice.chosen, key=lambda at: (self.ranks.get(at, len(self.errands)), at)))

    def together(self, places: Iterable[int]) -> list[tuple[int, ...]]:
        """Return errands by what is done in one gallery, or one case of it, by one measure; as the first of each."""
        groups: dict[tuple[str, str, str, str, bool, bool], list[int]] = {}
        for at in places:
            one = self.errands[at]
            groups.setdefault((one.gallery, one.case, one.title, one.trade, one.needs is None, one.check), []).append(
                at
            )
        return [tuple(those) for those in groups.values()]

    @property
    def away(self) -> tuple[int, ...]:
        """Places of the errands that take objects from view and are not chosen."""
        return tuple(at for at, one in enumerate(self.errands) if one.away and at not in self.choice.chosen)

    def share_of(self, avoided: float) -> float:
        """Return which share of the expected loss a part of it is."""
        return avoided / self.loss if self.loss > 0.0 else 0.0

    @property
    def share(self) -> float:
        """Share of the expected loss that is avoided."""
        return self.share_of(self.choice.avoided)

    @property
    def most(self) -> float:
        """Share of the expected loss that all errands that may be chosen avoid."""
        return self.share_of(self.curve[-1].avoided)

    @property
    def visits(self) -> EffortSpan:
        """Hours of setting out in the galleries."""
        once = self.terms.efforts.visit.hours_of(1)
        times = len(self.choice.galleries)
        return EffortSpan(times * once.value, times * once.low, times * once.high)

    @cached_property
    def hours(self) -> EffortSpan:
        """What the plan takes of hours, setting out included."""
        return summed((self.visits, *(one.hours for one in self.chosen)))

    @cached_property
    def cost(self) -> EffortSpan:
        """What it costs."""
        once = self.terms.efforts.visit.cost_of(1)
        times = len(self.choice.galleries)
        return summed(
            (EffortSpan(times * once.value, times * once.low, times * once.high), *(one.cost for one in self.chosen))
        )

    @cached_property
    def by_trade(self) -> dict[str, EffortSpan]:
        """Hours by trade; those that nothing is asked of are left out."""
        found = {
            trade: [one.hours for one in self.chosen if one.trade == trade]
            + ([self.visits] if trade == self.terms.efforts.visit.trade else [])
            for trade in TRADES
        }
        return {trade: summed(spans) for trade, spans in found.items() if summed(spans).high > 0.0}


def summed(spans: Iterable[EffortSpan]) -> EffortSpan:
    """Return the sum of some amounts."""
    listed = list(spans)
    return EffortSpan(
        fsum(one.value for one in listed), fsum(one.low for one in listed), fsum(one.high for one in listed)
    )


def plan_of(found: Iterable[Advised], loss: float, order: Mapping[str, int], terms: PlanTerms) -> ErrandPlan:
    """Return the plan for some objects.

    Parameters
    ----------
    found : iterable of Advised
        The objects to act on, and what is advised for each.
    loss : float
        What is expected to be lost of all objects, in objects of class C.
    order : mapping of str to int
        Place of each gallery on the way.
    terms : PlanTerms
        What measures take, and what there is.

    Returns
    -------
    ErrandPlan
    """
    errands = errands_of(found, terms.efforts, order)
    work = ErrandWork(errands, terms.efforts.visit, away=terms.limits.away)
    ranks, curve = _ordered(work)
    return ErrandPlan(errands, choose(work, terms.limits), ranks, curve, loss, terms)


def _ordered(work: ErrandWork) -> tuple[dict[int, int], tuple[EffortCorner, ...]]:
    ranks: dict[int, int] = {}
    corners = [EffortCorner(0.0, 0.0, 0.0)]
    visits = len(work.galleries)
    for one in work.bundles:
        for node in one.nodes:
            if node >= visits:
                ranks[work.places[node - visits]] = len(ranks) + 1
        if one.gain > 0.0:
            last = corners[-1]
            costs = fsum(work.costs[node] for node in one.nodes)
            corners.append(EffortCorner(last.hours + one.effort, last.cost + costs, last.avoided + one.gain))
    return ranks, tuple(corners)


def gallery_order(counts: Mapping[str, Sequence[int]]) -> dict[str, int]:
    """Return the place of each gallery on the way: as the index lists them, the one with the most to do first.

    Parameters
    ----------
    counts : mapping of str to sequence of int
        By gallery how many objects are to act on, to watch, and cannot be assessed.
    """
    ordered = sorted(counts, key=lambda name: (*(-number for number in counts[name]), name))
    return {name: place for place, name in enumerate(ordered)}
