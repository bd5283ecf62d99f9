"""Adaptive nodes: cells are halved until what they predict at held-out points agrees with what the model gives there.

A cell has seven nodes.  The cubic through the first, third, fifth and seventh predicts the other three, which the model
is run at as well; where the prediction is good enough the cell is kept, with all seven for its lookups, and otherwise
its halves have four of their seven nodes already.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from pipeline.kernels.lookup import CUBIC, POINTS, UNIT, cubic_weights
from pipeline.quantities import Array

Integers = NDArray[np.int64]

DEPTH = 15
"""How often the axis is halved at most."""

BEGIN = 3
"""How often the axis is halved before any cell is trusted."""

UNITS = UNIT * 2**DEPTH
"""The length of the axis in smallest distances between nodes."""

SMALL = 0.01
"""Share of the largest value of an output below which errors count as if the value were that large."""

SAFETY = 2.0
"""What the error at the held-out points is multiplied by to be the reported one.

They are three, and the worst point lies between them.  On the other hand they become nodes, which makes the
interpolation that is used better than the one that was measured: at a kink by two, elsewhere by sixteen.
"""

CLAIM = 0.1
"""Share of the error allowed below which none is reported: three points cannot vouch for less."""

MOST_NODES = 6_000
"""Analyses after which a chart is left as it is."""


@dataclass(frozen=True)
class ChartCells:
    """The cells of a chart, along its axis.

    edges    : (cells + 1,), from 0 to UNITS
    values   : (cells, 7, outputs)
    bounds   : (cells, outputs), the error that the lookups in a cell may have by interpolation
    own      : (cells,), the largest error of the model itself at the nodes, of its first output
    note     : (cells,) int64, the bits of the notes at the nodes
    resolved : (cells,) bool, whether the bounds are within the tolerance
    nodes    : how many analyses it took
    """

    edges: Array
    values: Array
    bounds: Array
    own: Array
    note: Integers
    resolved: NDArray[np.bool_]
    nodes: int


Analyses = Callable[[Integers], Array]
"""Places (n,) on the axis, 0 to UNITS -> the outputs, the error of the first of them, the note: (n, outputs + 2)."""


class _Nodes:
    """All analyses so far, by place."""

    def __init__(self, analyse: Analyses) -> None:
        self._analyse = analyse
        self._places = np.empty(0, dtype=np.int64)
        self._rows = np.empty((0, 0))

    def __len__(self) -> int:
        return self._places.size

    def at(self, places: Integers) -> Array:
        """Return the rows at places of any shape; what is not known yet is run, in one call."""
        fresh = np.setdiff1d(places, self._places)
        if fresh.size:
            rows = self._analyse(fresh)
            known = np.concatenate([self._places, fresh])
            order = np.argsort(known)
            self._rows = np.concatenate([self._rows.reshape(-1, rows.shape[1]), rows])[order]
            self._places = known[order]
        return self._rows[np.searchsorted(self._places, places)]


def _predict(values: Array) -> Array:
    """Return what the cubic through every other node of each cell says at all of them; (cells, 7, outputs)."""
    weights = np.empty((POINTS, CUBIC))
    for i in range(POINTS):
        cubic_weights(0.5 * i, weights[i])
    return np.asarray(np.einsum("ai,cio->cao", weights, values[:, ::2]))


def refine(analyse: Analyses, tolerance: float, most_nodes: int = MOST_NODES, counted: int | None = None) -> ChartCells:
    """Halve cells until their error is below ``tolerance`` times the value there, or no more analyses may be run.

    analyse    : runs the model; its outputs are magnitudes
    tolerance  : of max(value, SMALL x the largest value), of every output that counts
    most_nodes : of the first cells and of halving them; the worst are halved first where not all can be
    counted    : how many of the outputs count, the first ones; None: all
    returns    : the cells; those that could not be resolved have the bounds that they have
    """
    nodes = _Nodes(analyse)
    size = UNITS // 2**BEGIN
    begin = np.arange(0, UNITS, size)
    grid = np.arange(POINTS)
    done: list[tuple[Integers, Array, Array, Array, Integers, NDArray[np.bool_]]] = []
    floor: Array | None = None
    while begin.size:
        rows = nodes.at(begin[:, None] + size // UNIT * grid)
        values = rows[..., :-2]
        if floor is None:
            # From the first cells alone: a tighter tolerance halves the same cells and more.
            floor = SMALL * values.max(axis=(0, 1))
        allowed = tolerance * np.maximum(values.min(axis=1), floor)
        bounds = SAFETY * np.abs(_predict(values) - values).max(axis=1)
        bad = (bounds > allowed)[:, :counted].any(axis=1)
        # Not even halvings that quartered the error could mend a jump, or chaos: leave it early.
        hopeless = (bounds > allowed * (size / UNIT) ** 2)[:, :counted].any(axis=1)
        halved = bad & ~hopeless & (size > UNIT)
        # Halving a cell adds the six midpoints of its nodes.
        room = max(0, most_nodes - len(nodes)) // UNIT
        if np.count_nonzero(halved) > room:
            share = np.divide(bounds, allowed, out=np.full_like(bounds, np.inf), where=allowed > 0.0)
            share = share[:, :counted].max(axis=1)
            halved[np.argsort(np.where(halved, -share, 0.0), kind="stable")[room:]] = False
        stay = ~halved
        note = np.bitwise_or.reduce(rows[stay, :, -1].astype(np.int64), axis=1)
        bounds = np.maximum(bounds, CLAIM * allowed)
        done.append((begin[stay], values[stay], bounds[stay], rows[stay, :, -2].max(axis=1), note, ~bad[stay]))
        size //= 2
        begin = np.ravel(begin[halved, None] + np.array([0, size]))
    starts, values, bounds, own, note, resolved = (np.concatenate(column) for column in zip(*done, strict=True))
    order = np.argsort(starts)
    edges = np.append(starts[order], UNITS).astype(np.float64)
    return ChartCells(edges, values[order], bounds[order], own[order], note[order], resolved[order], len(nodes))
