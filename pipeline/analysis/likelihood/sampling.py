"""Probabilities of harm, by joint sampling: as many samples of each object as its word takes, and no more.

A sample is a motion of the level, scaled by the scatter of the models, through furniture that is drawn, on a body that
is drawn.  All models that an object requires are run on the same sample, so that their states come together as they
would in one earthquake, and an object is harmed where any of them harms it.  Objects in the same kind of furniture
share the shaking of a sample, which is found once for all of them.

Where nobody says how an object is turned, the direction is drawn too, and a body is shaken along both of its axes at
once: a round one tips in any direction, and one plane alone would miss a third of its falls (of 150 bodies in six
degrees of freedom 37 % fell where one plane through the same motion said 25 %).

What one measurement would tell: the value of knowing a single uncertain number, from samples that are there already.

Samples are sorted by the share that they drew of a number.  Where harm is too likely in all of them together and for
certain unlikely enough in those of some values (or the other way round), whoever measured that number and found it
there would decide otherwise.  By how much decisions get better, expected over what the measurement may find, is the
expected value of the information about that number.

References
----------
Strong, M. and Oakley, J. E. (2013). An efficient method for computing single-parameter partial expected value of
perfect information. Medical Decision Making 33, 755-766.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache, partial
from itertools import pairwise
from math import ceil, log2

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.furniture import FurnitureFilter
from pipeline.analysis.likelihood.analyses import (
    STATES,
    Analyses,
    Groups,
    Harmful,
    Kind,
    Stood,
    Transfer,
    grouped,
    harmful_states,
    kinds_of,
    possible_states,
)
from pipeline.analysis.likelihood.draws import ONE_CAUSE, Draw, drawn_motion, shares, through
from pipeline.analysis.loose import FINEST
from pipeline.analysis.plan import Indices
from pipeline.analysis.transmission import transmit
from pipeline.analysis.verdicts import LevelMotions
from pipeline.quantities import Array
from pipeline.records import Executor, Harm, IfClass, Likelihood, Motion, Sampling
from pipeline.records.likelihood import CLASS

PARTS = 4
"""Parts of its range, as likely as each other, in which a number may be found."""


def most_telling(
    harmed: NDArray[np.bool_],
    taken: NDArray[np.intp],
    uncertain: Mapping[str, NDArray[np.bool_]],
    target: float,
    sampling: Sampling,
    classes: Mapping[int, Sequence[float]] | None = None,
) -> tuple[list[str], Array, Array]:
    """Return the number of each object that is best measured, and what that is worth.

    Parameters
    ----------
    harmed : ndarray of bool, shape (n, m)
        Whether each sample harmed each object.
    taken : ndarray of int, shape (m,)
        How many of them were taken of each, from the first on.
    uncertain : mapping of str to ndarray of bool, shape (m,)
        By parameter, of which objects it is a range.
    target : float
        Probability from which on something is done about harm.
    sampling : Sampling
        How certain the probability of a part has to be.
    classes : mapping of int to sequence of float, optional
        Of the objects whose class is not certain the ends of the shares of `CLASS`, class by class: the one question
        more, what it is.

    Returns
    -------
    names : list of str
        "" where no number alone would change the decision; `CLASS` for what it is.
    worth : ndarray, shape (m,)
        By how much the expected loss falls, in units of the loss by harm; doing something costs as much as harm of the
        target probability.
    moves : ndarray, shape (m,)
        Probability that it is found where something else is decided than without it.
    """
    n, m = harmed.shape
    names, worth, moves = [""] * m, np.zeros(m), np.zeros(m)
    asked = {at: ends for at, ends in (classes or {}).items() if taken[at]}
    # The best of many that tell nothing looks as if it did: each part of each number has to be that much more certain.
    tried = PARTS * np.sum([*uncertain.values()], axis=0) if uncertain else np.zeros(m, dtype=int)
    for at, ends in asked.items():
        tried[at] += len(ends)
    certainty = 1.0 - (1.0 - sampling.certainty) / np.maximum(tried, 1)
    counted = np.arange(n)[:, None] < taken

    def better(name: str, some: NDArray[np.intp], part: NDArray[np.intp]) -> None:
        """Keep what knowing a number is worth where that is the most; part : (n, objects) or (n, 1)."""
        values = _worth(harmed[:, some], counted[:, some], part, target, certainty[some])
        for at, value, share in zip(some.tolist(), *values, strict=True):
            if value > worth[at]:
                names[at], worth[at], moves[at] = name, value, share

    for name, mask in sorted(uncertain.items()):
        some = np.flatnonzero(mask & (taken > 0))
        if some.size:
            better(name, some, np.minimum((PARTS * shares(name, n, sampling.samples)).astype(int), PARTS - 1)[:, None])
    if asked:
        share = shares(CLASS, n, sampling.samples)
        part = np.array([np.searchsorted(ends, share, "right") for ends in asked.values()])
        better(CLASS, np.array([*asked]), part.T)
    return names, worth, moves


def _worth(
    harmed: NDArray[np.bool_],
    counted: NDArray[np.bool_],
    part: NDArray[np.intp],
    target: float,
    certainty: Array,
) -> tuple[list[float], list[float]]:
    """Return of objects what it is worth to know in which part a sample lies, and how likely that moves a decision.

    harmed, counted : (n, m) which samples harmed each, and were taken of it;  part : (n, m) or (n, 1) where each lies
    """
    from scipy.special import betainc

    taken = counted.sum(axis=0)
    acts = (harmed & counted).sum(axis=0) / taken >= target
    value, moved = np.zeros(taken.size), np.zeros(taken.size)
    for at in range(int(part.max(initial=-1)) + 1):
        mine = counted & (part == at)
        there, hurt = mine.sum(axis=0), (harmed & mine).sum(axis=0)
        below = betainc(hurt + 0.5, there - hurt + 0.5, target)
        p = hurt / np.maximum(there, 1)
        otherwise = np.where(acts, below >= certainty, 1.0 - below >= certainty)
        value += np.where(otherwise, np.abs(p - target) * there / taken, 0.0)
        moved += np.where(otherwise, there / taken, 0.0)
    return value.tolist(), moved.tolist()


FIRST = 64
"""Samples that are taken of every object."""

FEWEST = 16
"""The same where one question alone is asked: none of 16 harmed says below 10 % with a probability of 0.93."""

ACTS = 2
"""Which of the edges between words is that from which on something is done: "possible"."""

PART = 8
"""Samples that one who works runs in one go."""

_REMEMBERED = 4 * FEWEST
"""Shakings of samples that are remembered, of 0.3 MB each as a rule: of what measures are tried in."""


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
        Their scenes; several for an object on an isolator, for others of which a part feels something else, and for one
        that may be of several classes.
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
    groups, harmful, kinds = grouped(stood, levels[0].x_azimuth), harmful_states(stood, count), kinds_of(stood)
    uncertain = _uncertain((one for those in groups.values() for one in those), count) if telling else {}
    out: list[tuple[Likelihood, ...]] = [() for _ in range(count)]
    asked = sorted({at for those in groups.values() for one in those for at in one.of.tolist()})
    for level in levels:
        counted = _counted(groups, count, np.array(asked, dtype=np.intp), harmful, level, sampling, executor, first)
        bits = np.concatenate(counted.bits) if counted.bits else np.zeros((0, count), dtype=bool)
        classes = {at: [kind.end for kind in some] for at, some in kinds.items()} if telling else {}
        names, worth, moves = most_telling(bits, counted.taken, uncertain, sampling.edges[ACTS], sampling, classes)
        for at in asked:
            best = names[at], float(worth[at]), float(moves[at])
            ifs = _if_class(kinds.get(at, ()), bits[:, at], int(counted.taken[at]), sampling)
            out[at] = (*out[at], counted.told(at, level.name, sampling, best, ifs))
    return out


def _if_class(kinds: Sequence[Kind], harmed: NDArray[np.bool_], taken: int, sampling: Sampling) -> tuple[IfClass, ...]:
    """Return how likely harm is if an object is of each class that it may be of, of its own samples."""
    drawn = shares(CLASS, taken, sampling.samples)
    out = []
    for kind in kinds:
        mine = (kind.start <= drawn) & (drawn < kind.end)
        n, hurt = int(mine.sum()), int((harmed[:taken] & mine).sum())
        p = hurt / n if n else None
        out.append(IfClass(kind.classes, kind.chance, p, n, None if p is None else sampling.band(p)))
    return tuple(out)


@dataclass
class _Counted:
    """Samples so far: of each object how many were taken (m,), harmed it (m,), and reached each state (s, m).

    hurt : how often each state harmed it, (s, m);  possible : whether it can reach each state, (s, m);  bits : by part
    of the samples, which harmed it, (n, m)
    """

    taken: Indices
    harmed: Indices
    reached: NDArray[np.intp]
    hurt: NDArray[np.intp]
    possible: NDArray[np.bool_]
    bits: list[NDArray[np.bool_]]

    def told(
        self, at: int, level: str, sampling: Sampling, telling: tuple[str, float, float], classes: tuple[IfClass, ...]
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
        often = self.hurt[:, at].copy()
        # What falls has rocked before.
        rocks, falls = STATES.index(Harm.ROCKS), STATES.index(Harm.FALLS)
        often[rocks] = max(0, often[rocks] - often[falls])
        likeliest, at_worst = max((n, i) for i, n in enumerate(often.tolist()))
        named = STATES[at_worst].value if likeliest else ""
        return Likelihood(level, share, error, taken, sampling.band(share), named, states, *telling, classes)


def _counted(
    groups: Groups,
    count: int,
    asked: Indices,
    harmful: Harmful,
    level: LevelMotions,
    sampling: Sampling,
    executor: Executor,
    first: int,
) -> _Counted:
    done = _Counted(
        np.zeros(count, dtype=np.intp),
        np.zeros(count, dtype=np.intp),
        np.zeros((len(STATES), count), dtype=np.intp),
        np.zeros((len(STATES), count), dtype=np.intp),
        possible_states(groups, count),
        [],
    )
    wanted = np.zeros(count, dtype=bool)
    wanted[asked] = True
    for start, end in pairwise(_stages(sampling.samples, first)):
        parts = [range(at, min(at + PART, end)) for at in range(start, end, PART)]
        work = partial(sampled, groups=groups, wanted=wanted, harmful=harmful, level=level, most=sampling.samples)
        for reached, hurt, harmed in executor.map(work, parts):
            done.reached += reached
            done.hurt += hurt
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
    harmful: Harmful,
    level: LevelMotions,
    most: int,
) -> tuple[Indices, Indices, NDArray[np.bool_]]:
    """Run some samples of the objects that are wanted.

    Returns
    -------
    reached, hurt : ndarray of int, shape (s, m)
        How often each object reached each state, and was harmed by it.
    harmed : ndarray of bool, shape (n, m)
        Which samples harmed which object.
    """
    draws = [Draw(number, most) for number in numbers]
    reached = np.zeros((len(draws), *harmful.ever.shape), dtype=bool)
    for (furniture, isolator), those in groups.items():
        chosen = [one.chosen(draws, wanted) for one in those]
        shaken = [
            _felt(level.motions, furniture, isolator, draw) if any(which[at].size for which in chosen) else None
            for at, draw in enumerate(draws)
        ]
        felt = [None if one is None else one[0] for one in shaken]
        for one, which in zip(those, chosen, strict=True):
            one.run(felt, draws, which, reached)
            for at, told in enumerate(shaken):
                if told is not None and told[1]:
                    reached[at, STATES.index(Harm.FALLS), one.of[which[at]]] = True
    hurts = np.stack([states & harmful.at(draw) for states, draw in zip(reached, draws, strict=True)])
    harmed = np.asarray(hurts.any(axis=1))
    return np.sum(reached, axis=0, dtype=np.intp), np.sum(hurts, axis=0, dtype=np.intp), harmed


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


def _uncertain(analyses: Iterable[Analyses], count: int) -> dict[str, NDArray[np.bool_]]:
    """Return by parameter of which objects it is a range that a measurement would settle, (m,)."""
    out: dict[str, NDArray[np.bool_]] = {}
    for one in analyses:
        for ranges in (*one.ways[0], one.capacity, one.room):
            name = ONE_CAUSE.get(ranges.name, ranges.name)
            mine = out.setdefault(name, np.zeros(count, dtype=bool))
            mine[one.of[one.uncertain(ranges)]] = True
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
