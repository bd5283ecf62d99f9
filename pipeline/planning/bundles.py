r"""Bundles: what is done together, in the order of what avoids most for the effort.

Nothing is done before what it needs, so that errands are the nodes of a forest.  Of every tree the set that holds its
root and has the largest ratio of gain to effort is a bundle, then of what is left, and so on: a node takes the best
bundle of its children in as long as that has a larger ratio than itself (Horn 1972, "Single-machine job sequencing with
treelike precedence ordering", SIAM J. Appl. Math. 23).  Bundles in falling order of their ratios are the corners of the
concave hull of all that can be gained for an effort: no choice whatever lies above it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf


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
