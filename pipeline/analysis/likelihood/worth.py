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

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from pipeline.analysis.likelihood.draws import Draw
from pipeline.quantities import Array
from pipeline.records import Sampling

PARTS = 4
"""Parts of its range, as likely as each other, in which a number may be found."""


def most_telling(
    harmed: NDArray[np.bool_],
    taken: NDArray[np.intp],
    uncertain: Mapping[str, NDArray[np.bool_]],
    target: float,
    sampling: Sampling,
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

    Returns
    -------
    names : list of str
        "" where no number alone would change the decision.
    worth : ndarray, shape (m,)
        By how much the expected loss falls, in units of the loss by harm; doing something costs as much as harm of the
        target probability.
    moves : ndarray, shape (m,)
        Probability that it is found where something else is decided than without it.
    """
    from scipy.special import betainc

    n, m = harmed.shape
    names, worth, moves = [""] * m, np.zeros(m), np.zeros(m)
    counted = np.arange(n)[:, None] < taken
    acts = np.where(taken > 0, (harmed & counted).sum(axis=0) / np.maximum(taken, 1), 0.0) >= target
    # The best of many that tell nothing looks as if it did: each part of each number has to be that much more certain.
    tried = PARTS * np.maximum(np.sum([*uncertain.values()], axis=0), 1) if uncertain else np.ones(m)
    certainty = 1.0 - (1.0 - sampling.certainty) / tried
    for name, mask in sorted(uncertain.items()):
        some = np.flatnonzero(mask & (taken > 0))
        if some.size == 0:
            continue
        shares = np.array([Draw(at, sampling.samples).share(name) for at in range(n)])
        part = np.minimum((PARTS * shares).astype(int), PARTS - 1)
        better, moved = np.zeros(some.size), np.zeros(some.size)
        for at in range(PARTS):
            mine = counted[:, some] & (part == at)[:, None]
            there, hurt = mine.sum(axis=0), (harmed[:, some] & mine).sum(axis=0)
            a, b = hurt + 0.5, there - hurt + 0.5
            below = betainc(a, b, target)
            p = hurt / np.maximum(there, 1)
            otherwise = np.where(acts[some], below >= certainty[some], 1.0 - below >= certainty[some])
            better += np.where(otherwise, np.abs(p - target) * there / taken[some], 0.0)
            moved += np.where(otherwise, there / taken[some], 0.0)
        for at, value, share in zip(some.tolist(), better.tolist(), moved.tolist(), strict=True):
            if value > worth[at]:
                names[at], worth[at], moves[at] = name, value, share
    return names, worth, moves
