"""What one measurement would tell: the value of knowing a single uncertain number, from samples that are there already.

Samples are sorted by the share that they drew of a number.  Where harm is too likely in all of them together and for
certain unlikely enough in those of some values (or the other way round), whoever measured that number and found it
there would decide otherwise.  By how much decisions get better, expected over what the measurement may find, is the
expected value of the information about that number.

References
----------
Strong, M. and Oakley, J. E. (2013). An efficient method for computing single-parameter partial expected value of
perfect information. Medical Decision Making 33, 755-766.
"""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.likelihood.draws import shares
from pipeline.quantities import Array
from pipeline.records import Sampling
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
